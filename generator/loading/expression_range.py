"""Check that the expressions of a spec have a value. An exponent may be negative or too large."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from ..language.rules.parameters import all_parameters, uses
from ..model import Variant
from ..model.expressions import Expression, ExpressionError
from .fields import Context
from .from_mapping import Raw


def check_reach(raw: Raw, context: Context, variants: Sequence[Variant]) -> bool:
    """Report expressions without a value for an order code of their interface, and parameters that never have one."""
    problems_before = len(context.report)
    for path, interface, text in uses(dict(raw)):
        names = list(all_parameters(text, raw["parameters"]))
        formulas = [raw["parameters"][name]["equals"] for name in names if "equals" in raw["parameters"][name]]
        sets = context.parameter_sets.get(interface, ())
        # A number has the same value in each set.
        needed_sets = sets if names else sets[:1]
        pairs = product(needed_sets, (text, *formulas))
        problem = next(filter(None, (_fault(expression, parameters) for parameters, expression in pairs)), "")
        if problem:
            context.report.add("bad-expression", path, problem)
    for name, definition in raw["parameters"].items():
        if "equals" not in definition:
            continue
        problems = [_fault(definition["equals"], variant.parameters) for variant in variants]
        if problems and all(problems):
            context.report.add("bad-expression", ("parameters", name, "equals"), problems[0])
    return len(context.report) == problems_before


def _fault(text: int | str, parameters: Mapping[str, int]) -> str:
    try:
        expression = Expression.parse(text)
    except ExpressionError:
        return ""  # Reported by the rule on expressions.
    try:
        if parameters.keys() >= set(expression.parameters):  # Another name is reported by the rule on expressions.
            expression.value(parameters)
    except ExpressionError as error:
        return str(error)
    return ""
