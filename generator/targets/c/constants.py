"""Constants of a header: macros with their comments, and functions that return one expression."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Layout, Timing
from ...model.expressions import Expression
from ...model.record import dataclass
from ...say.interface import timing as said_of
from .comments import S
from .expr import Cast, Expr, Scope, number, unsigned


@dataclass(frozen=True, slots=True)
class Function:
    """A function that returns one expression. ``uses_variant`` is True if the value depends on the order code."""

    name: str
    type: str
    value: Expr
    about: str
    uses_variant: bool


def number_of(scope: Scope, name: str, expression: Expression, largest: int, about: str) -> Function:
    """Build a function for numbers up to ``largest``, in 32 bits if they fit."""
    # A product is computed before anything is subtracted from it.
    has_product = any(term.is_product for term in expression.terms)
    subtracted = min(expression.constant, 0) if has_product else 0
    bits, value = max((largest - subtracted).bit_length(), 32), scope.of(expression)
    if bits == 32 and any(term.is_power for term in expression.terms):
        value = Cast("uint32_t", value)
    return Function(name, unsigned(bits), value, about, not expression.is_constant)


def wide_number_of(scope: Scope, name: str, expression: Expression, about: str) -> Function:
    """Build a function for numbers of 64 bits."""
    value = scope.of(expression)
    is_wide = bool(expression.terms) and expression.terms[0].is_power
    return Function(name, "uint64_t", value if is_wide else Cast("uint64_t", value), about, not expression.is_constant)


@dataclass(frozen=True, slots=True)
class Macro:
    name: str
    value: str
    note: str = ""


def timing_macros(timing: Timing, stem: str) -> Iterator[Macro]:
    """Yield the bounds of a time in microseconds. The comment on the first one describes all of them."""
    note = S.sentence(said_of(timing))
    bounds = {"AT_LEAST": timing.at_least_us, "TYPICAL": timing.typical_us, "AT_MOST": timing.at_most_us}
    for bound, value in bounds.items():
        if value is not None:
            yield Macro(f"{stem}_{timing.name}_{bound}_US".upper(), number(value), note)
            note = f"see {timing.name} above"


def scale_macros(layout: Layout, stem: str) -> Iterator[Macro]:
    """Yield the numbers of each scale. They have 64 bits, so that no product overflows."""
    for field in layout.fields:
        scale, name = field.scale, f"{stem}_{field.name}".upper()
        if scale is not None:
            note = f"{field.name} in {scale.unit}: ({field.name} * NUMERATOR + OFFSET) / DENOMINATOR"
            yield Macro(f"{name}_NUMERATOR", f"INT64_C({scale.numerator})", note)
            offset = f"INT64_C({abs(scale.offset)})"
            yield Macro(f"{name}_OFFSET", f"(-{offset})" if scale.offset < 0 else offset)
            yield Macro(f"{name}_DENOMINATOR", f"INT64_C({scale.denominator})")
