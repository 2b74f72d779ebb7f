"""Small functions of a variant that return one expression: derived parameters, limits, sizes."""

from __future__ import annotations

from ...model.expressions import Expression
from ...model.record import dataclass
from .expr import Cast, Expr, Scope
from .types import unsigned


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
