"""Limits of a register or of one of its fields."""

from __future__ import annotations

from collections.abc import Mapping

from . import PlacedLayout, Register
from .expressions import Expression


def bounded(register: Register) -> str:
    """Return the name of the limited field or join, or an empty string if the limits apply to the whole register."""
    names = register.layout.member_names
    if register.limits_of in names:
        return register.limits_of
    return next(iter(names)) if len(names) == 1 else ""


def bounded_width(register: Register, placed: PlacedLayout) -> int:
    """Return the width of the limited field, join or register."""
    return placed.place_of(bounded(register))[1] or 8 * register.length


def representable(register: Register, placed: PlacedLayout) -> tuple[int, int]:
    """Return the lowest and highest number that fit in the limited field, join or register."""
    width = bounded_width(register, placed)
    limited_field = placed.find_field(bounded(register))
    if limited_field is not None and limited_field.field.number.signed:
        return -(1 << (width - 1)), (1 << (width - 1)) - 1
    return 0, (1 << width) - 1


def bounds(
    register: Register,
    placed: PlacedLayout,
    limits: tuple[Expression | None, Expression | None],
    parameters: Mapping[str, int],
) -> tuple[int, int]:
    """Return the lowest and highest value that may be written, from ``limits`` or otherwise from the width."""
    lowest, highest = representable(register, placed)
    limited_field = placed.find_field(bounded(register))
    if limited_field is not None:
        highest = max(highest, limited_field.field.number.zero_means)
    low, high = limits
    if low is not None:
        lowest = low.value(parameters)
    if high is not None:
        highest = high.value(parameters)
    return lowest, highest
