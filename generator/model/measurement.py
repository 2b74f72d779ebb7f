"""Measurement of a position, which is an angle or a length, and the range of the numbers that an encoder sends for it.

An offset can shift unsigned positions up to the ``highest`` of the measurement, so all of these are valid.
Signed positions end at ``highest``, and their number is the number of positions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from .expressions import Expression
from .fields import Field
from .kinds import Number
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
            counts_per_step = self.per_counts.value(parameters) if self.per_counts is not None else 1
            return Fraction(self.step_nm.value(parameters), 1000 * counts_per_step)
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


class PositionRange(NamedTuple):
    """Lowest and highest valid number in fields that could hold others.

    The number is the position, or the number of revolutions if another field counts one revolution in all its bits.
    ``name`` is the field or the join with the number, and ``fields`` are the fields that form it, most significant
    first.
    """

    name: str
    fields: tuple[Field, ...]
    lowest: Expression
    highest: Expression

    @property
    def field(self) -> Field | None:
        """The only field with the number, or None if several fields form it."""
        return self.fields[0] if len(self.fields) == 1 else None


def narrower_range(
    measurement: Measurement, position_fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of valid positions if, for some order code, the field of the position can hold other numbers.

    ``position_fields`` are the fields of the position in a frame, most significant first, and ``parameter_sets`` are
    the parameters of the order codes. The result is None if all numbers are valid, or if the range is unknown: for
    decimal digits, for a signed position without ``highest``, and for a number that is 0 in the frame but stands for
    another number.
    """
    are_numbers = all(isinstance(field.kind, Number) for field in position_fields)
    if not are_numbers:
        return None
    is_signed = len(position_fields) == 1 and position_fields[0].number.signed
    if is_signed:
        position_range = _signed_range(measurement, position_fields[0])
    else:
        position_range = _unsigned_range(measurement, position_fields, parameter_sets)
    if position_range is None or any(field.number.zero_means for field in position_range.fields):
        return None
    is_narrower = any(_is_narrower(position_range, parameters) for parameters in parameter_sets)
    return position_range if is_narrower else None


def _is_narrower(position_range: PositionRange, parameters: Mapping[str, int]) -> bool:
    """Return True if a range has fewer numbers than the width of its fields allows, but at least one.

    The result is False for order codes without the fields, whose width is 0.
    """
    width = sum(field.width.value(parameters) for field in position_range.fields)
    if width == 0:
        return False
    highest = position_range.highest.value(parameters)
    size_of_range = highest - position_range.lowest.value(parameters) + 1
    return 1 <= size_of_range < 1 << width


def _signed_range(measurement: Measurement, field: Field) -> PositionRange | None:
    """Return the range of a signed position, which has as many numbers as counts and ends at ``highest``.

    The result is None if the measurement gives no number of counts or no highest position.
    """
    total_counts = measurement.total
    highest = measurement.highest
    if total_counts is None or highest is None:
        return None
    lowest = highest - total_counts + Expression(1)
    return PositionRange(field.name, (field,), lowest, highest)


def _unsigned_range(
    measurement: Measurement, fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of a position without a sign, or None if the range is unknown.

    It is the range of the revolutions if the position has two fields, of which the low one counts exactly one
    revolution. Otherwise it is the range of the whole position, if the number of counts is known.
    """
    total_counts = measurement.total
    if total_counts is None or not fields or any(field.number.signed for field in fields):
        return None
    if _counts_turns_alone(measurement, fields, parameter_sets):
        assert measurement.turns is not None
        high_field = fields[0]
        highest_turn = measurement.turns - Expression(1)
        return PositionRange(high_field.name, (high_field,), lowest=Expression(0), highest=highest_turn)
    name = fields[0].name if len(fields) == 1 else measurement.position_name
    highest = measurement.highest or total_counts - Expression(1)
    return PositionRange(name, tuple(fields), lowest=Expression(0), highest=highest)


def _counts_turns_alone(
    measurement: Measurement, fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> bool:
    """Return True if the position has two fields, and the low one counts exactly one revolution for each order code.

    The fields of a position are listed from the most significant one.
    """
    counts_per_turn = measurement.counts_per_turn
    if len(fields) != 2 or measurement.highest is not None or counts_per_turn is None or measurement.turns is None:
        return False
    _, low_field = fields
    for parameters in parameter_sets:
        counts_in_low_field = 1 << low_field.width.value(parameters)
        if counts_per_turn.value(parameters) != counts_in_low_field:
            return False
    return True
