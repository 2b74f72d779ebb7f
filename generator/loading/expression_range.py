"""Check that the expressions of a spec have a value. An exponent may be negative or too large."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..language.rules.parameters import all_parameters, uses
from ..model import Variant
from ..model.expressions import Expression, ExpressionError
from .fields import Context
from .from_mapping import Raw


def check_reach(raw: Raw, context: Context, variants: Sequence[Variant]) -> bool:
    """Report expressions without a value for an order code of their interface, and parameters that never have one."""
    before = len(context.report)
    for path, interface, text in uses(dict(raw)):
        names = list(all_parameters(text, raw["parameters"]))
        behind = [raw["parameters"][name]["equals"] for name in names if "equals" in raw["parameters"][name]]
        sets = context.parameter_sets.get(interface, ())
        # A number has the same value in each set.
        faults = (_fault(item, parameters) for parameters in sets[: None if names else 1] for item in (text, *behind))
        wrong = next(filter(None, faults), "")
        if wrong:
            context.report.add("bad-expression", path, wrong)
    for name, item in raw["parameters"].items():
        found = [_fault(item["equals"], variant.parameters) for variant in variants] if "equals" in item else []
        if found and all(found):
            context.report.add("bad-expression", ("parameters", name, "equals"), found[0])
    return len(context.report) == before


def _fault(text: int | str, parameters: Mapping[str, int]) -> str:
    try:
        found = Expression.parse(text)
    except ExpressionError:
        return ""  # Reported by the rule on expressions.
    try:
        if parameters.keys() >= set(found.parameters):  # Another name is reported by the rule on expressions.
            found.value(parameters)
    except ExpressionError as error:
        return str(error)
    return ""
