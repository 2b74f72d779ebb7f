"""Limits of registers in Python: their lowest and highest values as expressions."""

from __future__ import annotations

from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.limits import NumberLimits
from .literals import Negative, ParameterExpressions, PythonExpression, PythonOperation, number


@dataclass(frozen=True)
class LimitsFunction:
    """Function that returns the limits of a register. ``when`` names one of several meanings."""

    name: str
    when: str
    low: PythonExpression
    high: PythonExpression
    takes_variant: bool


def limit_expressions(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value. A missing limit follows from the width."""
    low, high = _limits_of_width(scope, limits)
    if limits.low is not None:
        low = scope.expression_of(limits.low)
    if limits.high is not None:
        high = scope.expression_of(limits.high)
    return low, high


def _limits_of_width(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value that the width allows.

    If 0 stands for a number above all other values, the values are 1 to this number.
    """
    if limits.signed:
        half_of_range = scope.power(limits.width - Expression(1))
        return Negative(half_of_range), PythonOperation(half_of_range, "-", number(1))
    if limits.stands_for:
        return number(1), number(limits.stands_for)
    return number(0), PythonOperation(scope.power(limits.width), "-", number(1))


def limits_depend(limits: NumberLimits) -> bool:
    """Return whether limits depend on the order code."""
    bounds = [bound for bound in (limits.low, limits.high) if bound is not None]
    # A missing limit follows from the width.
    if len(bounds) < 2:
        bounds.append(limits.width)
    return not all(bound.is_constant for bound in bounds)
