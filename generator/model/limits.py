"""Between which values a register, or the field of it that its limits bound, may lie."""

from __future__ import annotations

from collections.abc import Mapping

from . import PlacedLayout, Register
from .expressions import Expression


def bounded(register: Register) -> str:
    """The name of the field or join that the limits bound: the one named, or the only one.

    Empty for a register as a whole.
    """
    names = [*(item.name for item in register.layout.joins), *(item.name for item in register.layout.fields)]
    if register.limits_of in names:
        return register.limits_of
    return names[0] if len(names) == 1 else ""


def bounded_width(register: Register, placed: PlacedLayout) -> int:
    """The bits of what the limits bound: a field, a join, or the whole register."""
    return placed.place_of(bounded(register))[1] or 8 * register.length


def representable(register: Register, placed: PlacedLayout) -> tuple[int, int]:
    """The lowest and the highest number that what the limits bound can hold; below zero where it is a signed field."""
    width = bounded_width(register, placed)
    item = placed.field(bounded(register))
    if item is not None and item.field.number.signed:
        return -(1 << (width - 1)), (1 << (width - 1)) - 1
    return 0, (1 << width) - 1


def bounds(
    register: Register,
    placed: PlacedLayout,
    limits: tuple[Expression | None, Expression | None],
    parameters: Mapping[str, int],
) -> tuple[int, int]:
    """The lowest and the highest value that may be written: by ``limits`` where they are given, else what fits."""
    lowest, highest = representable(register, placed)
    item = placed.field(bounded(register))
    if item is not None:
        highest = max(highest, item.field.number.zero_means)
    low, high = limits
    return low.value(parameters) if low is not None else lowest, high.value(parameters) if high is not None else highest
