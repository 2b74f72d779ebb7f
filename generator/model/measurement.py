"""Measurement of a position, which is an angle or a length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from .expressions import Expression
from .facts import Sources
from .record import dataclass

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True)
class LayoutRange:
    """Range of the position in one layout, if it differs from that of the interface.

    A position that never ``wraps`` can be any number that fits its field.
    """

    turns: Expression | None
    modulus: Expression | None
    highest: Expression | None
    source: Sources
    wraps: bool = True

    @property
    def numbers(self) -> tuple[Expression, ...]:
        """The expressions in it."""
        return tuple(number for number in (self.turns, self.modulus, self.highest) if number is not None)


@dataclass(frozen=True, slots=True)
class Measurement:
    """Units of the field ``of``: ``counts_per_turn`` and ``turns``, or for a length its step and ``modulus``.

    The step is ``step_um`` micrometres per count, or ``step_nm`` nanometres per ``per_counts`` counts.
    ``highest`` is the highest number sent if an offset can shift positions above the total count, or if the position is
    signed.
    """

    of: str
    counts_per_turn: Expression | None
    turns: Expression | None
    step_um: Expression | None
    modulus: Expression | None
    highest: Expression | None
    source: Sources
    step_nm: Expression | None = None
    per_counts: Expression | None = None

    @property
    def is_length(self) -> bool:
        return self.step_um is not None or self.step_nm is not None

    @property
    def steps(self) -> tuple[Expression, ...]:
        """Expressions that give the length of a count, or none for an angle."""
        return tuple(step for step in (self.step_um, self.step_nm, self.per_counts) if step is not None)

    @property
    def total(self) -> Expression | None:
        """Number of counts after which the position wraps around, or None if it is unknown."""
        if self.modulus is not None or self.counts_per_turn is None or self.turns is None:
            return self.modulus
        return self.counts_per_turn * self.turns

    def micrometres(self, parameters: Mapping[str, int]) -> Fraction | None:
        """Return the exact length of one count, or None for an angle."""
        from fractions import Fraction

        if self.step_nm is not None:
            counts = self.per_counts.value(parameters) if self.per_counts is not None else 1
            return Fraction(self.step_nm.value(parameters), 1000 * counts)
        return Fraction(self.step_um.value(parameters)) if self.step_um is not None else None

    def within(self, layout_range: LayoutRange | None) -> Measurement:
        """Return the measurement with the range of one layout. The units are the same in all layouts."""
        if layout_range is None:
            return self
        source = layout_range.source or self.source
        if not layout_range.wraps:
            return replace(self, turns=None, modulus=None, highest=None, source=source)
        turns, modulus, highest = layout_range.turns, layout_range.modulus, layout_range.highest
        if turns is None and modulus is None:
            return replace(self, highest=highest, source=source)
        return replace(self, turns=turns, modulus=modulus, highest=highest, source=source)
