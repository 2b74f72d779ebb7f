"""The range of the numbers that an encoder sends as its position.

An offset can shift unsigned positions up to the ``highest`` of the measurement, so all of these are valid.
Signed positions end at ``highest``, and their number is the number of positions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .expressions import Expression
from .fields import Field
from .kinds import Number
from .layout import Layout
from .measurement import Measurement


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
    measurement: Measurement, layout: Layout, parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of valid positions if, for some order code, the field of the position can hold other numbers.

    ``parameter_sets`` are the parameters of the order codes. The result is None if all numbers are valid, or if the
    range is unknown: for decimal digits, for a signed position without ``highest``, and for a number that is 0 in the
    frame but stands for another number.
    """
    fields_by_name = {field.name: field for field in layout.fields}
    position_fields = [
        fields_by_name[name] for name in layout.names_in(measurement.position_name) if name in fields_by_name
    ]
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
    total = measurement.total
    highest = measurement.highest
    if total is None or highest is None:
        return None
    lowest = highest - total + Expression(1)
    return PositionRange(field.name, (field,), lowest, highest)


def _unsigned_range(
    measurement: Measurement, fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of a position without a sign, or None if the range is unknown.

    It is the range of the revolutions if the position has two fields, of which the low one counts exactly one
    revolution. Otherwise it is the range of the whole position, if the number of counts is known.
    """
    total = measurement.total
    if total is None or not fields or any(field.number.signed for field in fields):
        return None
    if _counts_turns_alone(measurement, fields, parameter_sets):
        assert measurement.turns is not None
        high_field = fields[0]
        highest_turn = measurement.turns - Expression(1)
        return PositionRange(high_field.name, (high_field,), lowest=Expression(0), highest=highest_turn)
    name = fields[0].name if len(fields) == 1 else measurement.position_name
    highest = measurement.highest or total - Expression(1)
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
    low_field = fields[1]
    return all(
        counts_per_turn.value(parameters) == 1 << low_field.width.value(parameters) for parameters in parameter_sets
    )
