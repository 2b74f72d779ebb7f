"""Measurement of a position, which is an angle or a length."""

from __future__ import annotations

from .expressions import Expression
from .facts import Sources
from .record import dataclass


@dataclass(frozen=True, slots=True)
class Measurement:
    """Units of the field ``of``: ``counts_per_turn`` and ``turns``, or for a length ``step_um`` and ``modulus``.

    ``highest`` is the highest number sent if an offset can shift positions above the total count.
    """

    of: str
    counts_per_turn: Expression | None
    turns: Expression | None
    step_um: Expression | None
    modulus: Expression | None
    highest: Expression | None
    source: Sources
