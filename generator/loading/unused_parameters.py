"""The rule that some fact of a spec depends on each parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..language.files import is_second
from ..language.problems import DocumentReport, join_words, quoted
from ..language.rules.walk import leaves
from ..model import Variant
from ..model.expressions import Expression, ExpressionError
from .from_mapping import Raw, parameters_of_flags, set_parameters

#: Keys whose value is an expression, and ``when``, which is a parameter in ``gray``.
EXPRESSION_KEYS = frozenset(
    (
        "bits",
        "compared_bits",
        "counts_per_turn",
        "equals",
        "excess",
        "highest",
        "label_is",
        "low_bit",
        "max",
        "min",
        "modulus",
        "per_counts",
        "step_nm",
        "step_um",
        "turns",
        "when",
        "word_bits",
    )
)
#: Highest number of different values that a message lists.
_MAX_VALUES = 4


def check_unused_parameters(raw_spec: Raw, variants: Sequence[Variant], report: DocumentReport) -> None:
    """Report each parameter of a spec that nothing depends on.

    A parameter with a formula (``equals``) and a citation is a number from the manual, which outputs print, so it may
    be unused. If the spec has another problem, nothing is reported, because the part with the problem may use the
    parameter.
    """
    # A second reading of the manual must agree with the spec, so only the spec is checked. In an older edition, the
    # fact that depends on a parameter may be missing.
    if is_second(report.document.file) or report.document.family or report.faults():
        return
    used_names = {*_names_in_expressions(raw_spec), *parameters_of_flags(raw_spec, variants)}
    names_set_by_codes = set_parameters(raw_spec)
    for name, definition in raw_spec["parameters"].items():
        is_printed_number = "equals" in definition and "source" in definition
        if name in used_names or is_printed_number:
            continue
        problem = f"nothing depends on {quoted(name)}"
        if name in names_set_by_codes:
            problem += _values_text(name, variants)
        remedy = "use it, for example in 'bits' of a field, or remove it"
        if "equals" in definition:
            remedy += ". If the manual names this number, add its 'source'"
        report.add("unused-parameter", ("parameters", name), f"{problem}; {remedy}", at_key=True)


def _names_in_expressions(raw_spec: Raw) -> Iterator[str]:
    """Yield the names of the parameters in the expressions of a spec, and in verdicts that depend on an answer."""
    for path, value in leaves(raw_spec):
        if path[-1] in EXPRESSION_KEYS and isinstance(value, str):
            try:
                yield from Expression.parse(value).parameters
            except ExpressionError:
                continue  # This is the value of a text field.
        elif "makes_position_if" in path:
            yield str(path[-1])


def _values_text(name: str, variants: Sequence[Variant]) -> str:
    """Return a text on the values that order codes set a parameter to: ``, which order codes set to 0 or 1``."""
    values = sorted({variant.parameters[name] for variant in variants})
    if not values:
        return ""
    if len(values) > _MAX_VALUES:
        return f", which order codes set to {len(values)} different values"
    return f", which order codes set to {join_words(map(str, values), 'or')}"
