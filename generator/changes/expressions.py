"""Compare expressions by value, for all order codes, register settings and answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..model import Device, Variant
from ..model.expressions import Expression, ExpressionError
from ..order_codes.run_time import with_changed

Parameters = Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Point:
    """A common order code, and its parameters under one setting of registers and answers.

    ``compared`` are the parameters for expressions of the old family. They have the new values where the old family
    has the parameter too, so that a changed parameter is reported only once. A renamed one has its old value, which is
    the same by definition.
    """

    code: str
    old: Parameters
    new: Parameters
    compared: Parameters


@dataclass(frozen=True, slots=True)
class NumberDifferences:
    """Differences of two expressions: the order codes, and each pair of numbers that occurs, once.

    ``everywhere`` is true if they differ under every setting of registers and answers.
    """

    codes: tuple[str, ...]
    values: tuple[tuple[int | None, int | None], ...]
    everywhere: bool = True


def settings_of(device: Device) -> Iterator[Parameters]:
    """Yield settings of registers and answers: the defaults, then each at the ends of its range, one by one."""
    yield {}
    for parameter in device.run_time_parameters:
        highest = parameter.max if parameter.max is not None else parameter.largest
        yield from ({parameter.name: value} for value in (parameter.min or 0, highest))
    for alternative in device.alternatives:
        yield from (answer.sets for answer in alternative.answers)


def with_setting(device: Device, variant: Variant, setting: Parameters) -> Parameters:
    """Return the parameters of an order code under a setting, without parameters that it does not have."""
    own_names = variant.parameters.keys() - device.definitions
    own_setting = {name: value for name, value in setting.items() if name in own_names}
    return with_changed(device, variant, own_setting) if own_setting else variant.parameters


def differing(old: Expression | None, new: Expression | None, points: Sequence[Point]) -> NumberDifferences | None:
    """Return the differences of two expressions, or None if they are equal everywhere.

    Without a common order code, their texts are compared.
    """
    # A name that both sides use was not renamed, and has the same number on both.
    if old == new:
        return None
    if not points:
        is_same = old is not None and new is not None and old.render() == new.render()
        return None if is_same else NumberDifferences((), _constants(old, new))
    pairs_by_code: dict[str, list[tuple[int | None, int | None]]] = {}
    for point in points:
        values = _number(old, point.compared), _number(new, point.new)
        if values[0] != values[1]:
            pairs_by_code.setdefault(point.code, []).append(values)
    pairs = dict.fromkeys(pair for code_pairs in pairs_by_code.values() for pair in code_pairs)
    differing_points = sum(point.code in pairs_by_code for point in points)
    return (
        NumberDifferences(tuple(pairs_by_code), tuple(pairs), differing_points == sum(map(len, pairs_by_code.values())))
        if pairs_by_code
        else None
    )


def _constants(old: Expression | None, new: Expression | None) -> tuple[tuple[int | None, int | None], ...]:
    """Return the pair of numbers if the expressions are numbers or None."""
    if all(expression is None or expression.is_constant for expression in (old, new)):
        return ((_number(old, {}), _number(new, {})),)
    return ()


def _number(expression: Expression | None, parameters: Parameters) -> int | None:
    if expression is None:
        return None
    try:
        return expression.value(parameters)
    except ExpressionError:
        return None
