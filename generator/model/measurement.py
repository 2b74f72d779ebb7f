"""What a position counts."""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import Expression
from .facts import Sources


@dataclass(frozen=True, slots=True)
class Measurement:
    """What ``of`` counts: ``steps_per_turn`` and ``turns`` for an angle, ``step_um`` and ``steps`` for a length.

    ``highest`` is the highest number sent, where an offset can move the positions above the steps in all.
    """

    of: str
    steps_per_turn: Expression | None
    turns: Expression | None
    step_um: Expression | None
    steps: Expression | None
    highest: Expression | None
    source: Sources
