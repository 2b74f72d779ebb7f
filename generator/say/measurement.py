"""Statement about the unit and range of a position."""

from __future__ import annotations

from ..model import Measurement
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
