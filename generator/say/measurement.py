"""Statement about the unit and range of a position."""

from __future__ import annotations

from ..model import Measurement
from .text import Amount, Said, parted, said


def measurement(item: Measurement) -> Said:
    """Return the counts and revolutions, or the step, and the range."""
    members = (
        (item.counts_per_turn, "counts", " per revolution"),
        (item.turns, "revolutions", ""),
        (item.step_um, "µm", " per count"),
        (item.modulus, "counts", " in total"),
    )
    known = [(Amount(value, unit), words) for value, unit, words in members if value is not None]
    highest = [("maximum ", item.highest)] if item.highest is not None else []
    return said(*parted([*known, *highest]), source=item.source)
