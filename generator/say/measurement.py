"""What is said of a position: what it counts."""

from __future__ import annotations

from ..model import Measurement
from ..model.expressions import Expression
from .text import Said, parted, said


def measurement(item: Measurement) -> Said:
    revolutions = " revolution" if item.turns == Expression(1) else " revolutions"
    members = (
        (item.counts_per_turn, " counts in a revolution"),
        (item.turns, revolutions),
        (item.step_um, " µm to a count"),
        (item.modulus, " counts in all"),
    )
    known = [(value, words) for value, words in members if value is not None]
    highest = [("the highest ", item.highest)] if item.highest is not None else []
    return said(*parted([*known, *highest]), source=item.source)
