"""Statement about the unit and range of a position."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, LayoutRange, Measurement
from .text import Amount, Part, Said, parted, said


def measurement(item: Measurement) -> Said:
    """Return the counts and revolutions, or the step, and the range."""
    members = (
        (item.counts_per_turn, "counts", " per revolution"),
        (item.turns, "revolutions", ""),
        (item.step_um, "µm", " per count"),
        (item.step_nm, "nm", " per count" if item.per_counts is None else " per "),
        (item.modulus, "counts", " in total"),
    )
    known: list[tuple[Part, ...]] = [
        (Amount(value, unit), words, *_counts(item, unit)) for value, unit, words in members if value is not None
    ]
    highest = [("maximum ", item.highest)] if item.highest is not None else []
    return said(*parted([*known, *highest]), source=item.source)


def _counts(item: Measurement, unit: str) -> tuple[Amount, ...]:
    """Return the number of counts to which a length in this unit applies, if it is not one."""
    return (Amount(item.per_counts, "counts"),) if unit == "nm" and item.per_counts is not None else ()


def position_range(item: LayoutRange) -> Said:
    """Return the range of the position in one layout."""
    if not item.wraps:
        return said("never wraps around", source=item.source)
    members = ((item.turns, "revolutions", ""), (item.modulus, "counts", " in total"))
    known: list[tuple[Part, ...]] = [
        (Amount(value, unit), words) for value, unit, words in members if value is not None
    ]
    highest = [("maximum ", item.highest)] if item.highest is not None else []
    return said(*parted([*known, *highest]), source=item.source)


def own_ranges(device: Device, interface: str) -> Iterator[tuple[str, LayoutRange]]:
    """Yield the layouts of an interface in which the position has another range, with that range."""
    for layout in device.interface(interface).layouts:
        if layout.position_range is not None:
            yield layout.name, layout.position_range
