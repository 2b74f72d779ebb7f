"""Measurement of a position, which is an angle or a length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from .expressions import Expression
from .manual import Sources
from .part import (
    Name,
    key,
    part,
    source_key,
)

if TYPE_CHECKING:
    from fractions import Fraction


@part(
    "Range of the position in this layout, if it differs from that of the measurement, such as a "
    "48-bit reply next to 24-bit replies. It has the unit of the measurement.",
    data="Range of the position in one layout. It replaces that of the measurement.",
    needs_a_key=True,
)
class LayoutRange:
    """Range of the position in one layout, if it differs from the range of the interface.

    A position that never ``wraps`` can be any number that fits its field.
    """

    wraps: bool = key(
        "false if the position never wraps around. It can then be any number that fits its field.",
        data="False if the position never wraps around.",
        schema={"const": False},
        default=True,
        rule="measurement",
        read="measurement",
    )
    turns: Expression | None = key(
        "For an angle: number of revolutions after which the position wraps around, 1 for singleturn.",
        data="Number of distinguishable revolutions.",
        default=None,
        rule="measurement",
        read="measurement",
    )
    modulus: Expression | None = key(
        "For a length: number of counts after which the position wraps around.",
        data="Number of counts after which the position wraps around.",
        default=None,
        rule="measurement",
        read="measurement",
    )
    highest: Expression | None = key(
        "Highest position that can be sent, as under 'measurement'.",
        default=None,
        rule="measurement",
        label="highest number",
        read="measurement",
    )
    source: Sources = source_key(default=())

    @property
    def numbers(self) -> tuple[Expression, ...]:
        """The expressions in it."""
        return tuple(number for number in (self.turns, self.modulus, self.highest) if number is not None)


@part(
    "Unit and range of the position, used to convert it to turns, degrees or lengths. "
    "counts_per_turn is the exact number of counts: 2^n, not 2^n - 1.",
    data="Unit and range of the position.",
)
class Measurement:
    """Units of the field ``of``: ``counts_per_turn`` and ``turns``, or for a length its step and ``modulus``.

    The step is ``step_um`` micrometres per count, or ``step_nm`` nanometres per ``per_counts`` counts.
    ``highest`` is the highest number sent if an offset can shift positions above the total count, or if the position is
    signed.
    """

    of: Name = key(
        "Field or join that holds the position, by the name that all layouts use.",
        data="Field or join that holds the position.",
        rule="measurement",
        label="counted",
        refers_to="any-field",
    )
    counts_per_turn: Expression | None = key(
        "For an angle: counts per revolution.",
        data="Counts per revolution.",
        default=None,
        rule="measurement",
        read="measurement",
    )
    turns: Expression | None = key(
        "For an angle: number of revolutions after which the position wraps around, 1 for singleturn.",
        data="Number of distinguishable revolutions.",
        default=None,
        rule="measurement",
        read="measurement",
    )
    step_um: Expression | None = key(
        "For a length: micrometres per count, if that is a whole number. Otherwise write step_nm.",
        data="Length of one count in micrometres.",
        default=None,
        rule="measurement",
        label="step in µm",
        read="measurement",
    )
    step_nm: Expression | None = key(
        "For a length, instead of step_um: nanometres per count.",
        data="Length of per_counts counts in nanometres.",
        default=None,
        rule="measurement",
        label="step in nm",
        read="measurement",
    )
    per_counts: Expression | None = key(
        "Number of counts to which step_nm applies. With step_nm: 1000000 and per_counts: 4096, one "
        "count is 244.140625 nm. Default: 1.",
        data="Number of counts that step_nm refers to. null: one.",
        default=None,
        rule="measurement",
        label="counts per step",
        read="measurement",
    )
    modulus: Expression | None = key(
        "For a length: number of counts after which the position wraps around.",
        data="Number of counts after which the position wraps around.",
        default=None,
        rule="measurement",
        read="measurement",
    )
    highest: Expression | None = key(
        "Highest number that can be sent, if an offset shifts the positions up, or if the position is "
        "signed. With an offset, the number of positions stays the same, and the lowest position is "
        "the offset. The lowest signed position is highest - modulus + 1, such as -383999 with "
        "highest: 16000000 and modulus: 16384000. Default: the modulus minus one, or for a signed "
        "position the highest number in two's complement. A signed position with a modulus that is not "
        "a power of two has no default.",
        data="Highest number that can be sent, if an offset shifts the positions up or the position is "
        "signed. null if it is the total number of counts minus one, or for a signed position the "
        "highest that fits.",
        default=None,
        rule="measurement",
        label="highest number",
        read="measurement",
    )
    source: Sources = source_key(default=())

    @property
    def position_name(self) -> str:
        """Name of the measured field, or of the number that several fields form together."""
        return self.of

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
        """Return the exact length of one count in micrometres, or None for an angle."""
        from fractions import Fraction

        if self.step_nm is not None:
            counts = self.per_counts.value(parameters) if self.per_counts is not None else 1
            return Fraction(self.step_nm.value(parameters), 1000 * counts)
        if self.step_um is None:
            return None
        return Fraction(self.step_um.value(parameters))

    def within(self, layout_range: LayoutRange | None) -> Measurement:
        """Return the measurement with the range that a layout has, or unchanged if the layout has no range of its own.

        The units are the same in all layouts. If the position never wraps around, the result has no range. If the
        layout states only ``highest``, the result keeps the turns or the modulus.
        """
        if layout_range is None:
            return self
        source = layout_range.source or self.source
        if not layout_range.wraps:
            return replace(self, turns=None, modulus=None, highest=None, source=source)
        if layout_range.turns is None and layout_range.modulus is None:
            return replace(self, highest=layout_range.highest, source=source)
        return replace(
            self,
            turns=layout_range.turns,
            modulus=layout_range.modulus,
            highest=layout_range.highest,
            source=source,
        )
