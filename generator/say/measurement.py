"""Statement about the unit and range of a position."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, LayoutRange, Measurement
from .text import Amount, Part, Statement, parted, statement


def measurement(unit_and_range: Measurement) -> Statement:
    """Return the counts and revolutions, or the step, and the range."""
    members = (
        (unit_and_range.counts_per_turn, "counts", " per revolution"),
        (unit_and_range.turns, "revolutions", ""),
        (unit_and_range.step_um, "µm", " per count"),
        (unit_and_range.step_nm, "nm", " per count" if unit_and_range.per_counts is None else " per "),
        (unit_and_range.modulus, "counts", " in total"),
    )
    amounts: list[tuple[Part, ...]] = []
    for value, unit, words in members:
        if value is not None:
            amounts.append((Amount(value, unit), words, *_counts(unit_and_range, unit)))
    highest = [("maximum ", unit_and_range.highest)] if unit_and_range.highest is not None else []
    return statement(*parted([*amounts, *highest]), source=unit_and_range.source)


def _counts(unit_and_range: Measurement, unit: str) -> tuple[Amount, ...]:
    """Return the number of counts to which a length in this unit applies, if it is not one."""
    return (
        (Amount(unit_and_range.per_counts, "counts"),) if unit == "nm" and unit_and_range.per_counts is not None else ()
    )


def position_range(layout_range: LayoutRange) -> Statement:
    """Return the range of the position in one layout."""
    if not layout_range.wraps:
        return statement("never wraps around", source=layout_range.source)
    members = ((layout_range.turns, "revolutions", ""), (layout_range.modulus, "counts", " in total"))
    amounts: list[tuple[Part, ...]] = []
    for value, unit, words in members:
        if value is not None:
            amounts.append((Amount(value, unit), words))
    highest = [("maximum ", layout_range.highest)] if layout_range.highest is not None else []
    return statement(*parted([*amounts, *highest]), source=layout_range.source)


def own_ranges(device: Device, interface: str) -> Iterator[tuple[str, LayoutRange]]:
    """Yield the layouts of an interface in which the position has another range, with that range."""
    for layout in device.interface(interface).layouts:
        if layout.position_range is not None:
            yield layout.name, layout.position_range
