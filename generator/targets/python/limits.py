"""Limits of registers in Python: their lowest and highest values as expressions."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Register
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.limits import NumberLimits, limits_of
from ...say.names_and_evidence import name_in_words
from .literals import Negative, ParameterExpressions, PythonExpression, PythonOperation, number
from .names import ModuleContext, meaning_limits


@dataclass(frozen=True)
class LimitsFunction:
    """A function that returns the limits of a register.

    If the register has several uses (meanings), ``when`` is the one that the limits apply to. Otherwise it is empty.
    """

    name: str
    when: str
    low: PythonExpression
    high: PythonExpression
    takes_variant: bool


def limits_functions(context: ModuleContext, register: Register, *, takes_variant: bool) -> Iterator[LimitsFunction]:
    """Yield the function for the limits of a register, and one for each of its meanings with limits of its own.

    ``takes_variant`` is True if the first function takes the order code.
    """
    if register.min is not None or register.max is not None:
        low, high = limit_expressions(context.scope, limits_of(context.device, register))
        yield LimitsFunction("limits", when="", low=low, high=high, takes_variant=takes_variant)
    for meaning in register.meanings:
        if meaning.min is not None or meaning.max is not None:
            limits = limits_of(context.device, register, meaning)
            low, high = limit_expressions(context.scope, limits)
            yield LimitsFunction(
                name=meaning_limits(meaning),
                when=name_in_words(meaning.name),
                low=low,
                high=high,
                takes_variant=limits_depend(limits),
            )


def limit_expressions(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value. A limit that the spec does not give follows from the width."""
    low, high = _limits_of_width(scope, limits)
    if limits.low is not None:
        low = scope.expression_of(limits.low)
    if limits.high is not None:
        high = scope.expression_of(limits.high)
    return low, high


def _limits_of_width(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value that fit in the field.

    If the bits 0 stand for a number above all others, such as 256, the values are 1 to this number.
    """
    if limits.signed:
        half_of_range = scope.power(limits.width - Expression(1))
        return Negative(half_of_range), PythonOperation(half_of_range, "-", number(1))
    if limits.number_for_zero:
        return number(1), number(limits.number_for_zero)
    return number(0), PythonOperation(scope.power(limits.width), "-", number(1))


def limits_depend(limits: NumberLimits) -> bool:
    """Return whether limits depend on the order code."""
    bounds = [bound for bound in (limits.low, limits.high) if bound is not None]
    # A limit that the spec does not give follows from the width.
    if len(bounds) < 2:
        bounds.append(limits.width)
    return not all(bound.is_constant for bound in bounds)
