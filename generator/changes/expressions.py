"""Compare expressions by value, for all order codes, register settings and answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
    interface: str
    old: Parameters
    new: Parameters
    compared: Parameters


@dataclass(frozen=True, slots=True)
class Differing:
    """Differences of two expressions: the order codes, and each pair of numbers that occurs, once.

    ``everywhere`` is true if they differ under every setting of registers and answers.
    """

    codes: tuple[str, ...]
    values: tuple[tuple[int | None, int | None], ...]
    everywhere: bool = True


def points_of(old: Device, new: Device, shared: Mapping[str, str], renamed: Mapping[str, str]) -> tuple[Point, ...]:
    """Return all points at which to compare expressions of the two families.

    Args:
        old: The old family.
        new: The new family.
        shared: The common order codes, the new by the old.
        renamed: The renamed parameters, the new by the old.
    """
    variants = {item.code: item for item in new.variants}
    settings: list[dict[str, int]] = [{}, *_settings(new)]
    back = {name: before for before, name in renamed.items()}
    found = []
    for variant in old.variants:
        if variant.code not in shared:
            continue
        other = variants[shared[variant.code]]
        for setting in settings:
            before = {back.get(name, name): value for name, value in setting.items()}
            was, now = _at(old, variant, before), _at(new, other, setting)
            compared = {name: now.get(name, number) for name, number in was.items()}
            found.append(Point(other.code, other.interface, was, now, compared))
    return tuple(found)


def _settings(device: Device) -> Iterator[dict[str, int]]:
    """Yield settings of registers and answers: each at the ends of its range, one after the other."""
    for item in device.run_time_parameters:
        highest = item.max if item.max is not None else item.largest
        yield from ({item.name: value} for value in (item.min or 0, highest))
    for alternative in device.alternatives:
        yield from (dict(answer.sets) for answer in alternative.answers)


def _at(device: Device, variant: Variant, setting: Parameters) -> Parameters:
    known = {name: value for name, value in setting.items() if name in variant.parameters.keys() - device.definitions}
    return with_changed(device, variant, known) if known else variant.parameters


def differing(old: Expression | None, new: Expression | None, points: tuple[Point, ...]) -> Differing | None:
    """Return the differences of two expressions, or None if they are equal everywhere.

    Without a common order code, their texts are compared.
    """
    # A name that both sides use was not renamed, and has the same number on both.
    if old == new:
        return None
    if not points:
        same = (old is None) == (new is None) and (old is None or new is None or old.render() == new.render())
        return None if same else Differing((), _constants(old, new))
    found: dict[str, list[tuple[int | None, int | None]]] = {}
    for point in points:
        values = _number(old, point.compared), _number(new, point.new)
        if values[0] != values[1]:
            found.setdefault(point.code, []).append(values)
    pairs = dict.fromkeys(pair for each in found.values() for pair in each)
    here = sum(point.code in found for point in points)
    return Differing(tuple(found), tuple(pairs), here == sum(map(len, found.values()))) if found else None


def _constants(old: Expression | None, new: Expression | None) -> tuple[tuple[int | None, int | None], ...]:
    """Return the pair of numbers if the expressions are numbers or None."""
    if all(item is None or item.is_constant for item in (old, new)):
        return ((_number(old, {}), _number(new, {})),)
    return ()


def _number(expression: Expression | None, parameters: Parameters) -> int | None:
    if expression is None:
        return None
    try:
        return expression.value(parameters)
    except ExpressionError:
        return None
