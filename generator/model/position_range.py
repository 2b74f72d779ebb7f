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
    """Lowest and highest valid number in a field that could hold others.

    It is the position, or the number of revolutions if another field counts one revolution in all its bits.
    """

    field: Field
    lowest: Expression
    highest: Expression


def narrower_range(
    measurement: Measurement, layout: Layout, parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of valid positions if, for some order code, the field of the position can hold other numbers.

    ``parameter_sets`` are the parameters of the order codes. The result is None if all numbers are valid, or if the
    range is unknown: for decimal digits, for parts of one revolution in several fields, for a signed position without
    ``highest``, and for a number that is 0 in the frame but stands for another number.
    """
    fields_by_name = {field.name: field for field in layout.fields}
    position_fields = [fields_by_name[name] for name in layout.names_in(measurement.of) if name in fields_by_name]
    are_numbers = all(isinstance(field.kind, Number) for field in position_fields)
    if not are_numbers:
        return None
    is_signed = len(position_fields) == 1 and position_fields[0].number.signed
    if is_signed:
        position_range = _signed_range(measurement, position_fields[0])
    else:
        position_range = _unsigned_range(measurement, position_fields, parameter_sets)
    if position_range is None or position_range.field.number.zero_means:
        return None
    is_narrower = any(_is_narrower(position_range, parameters) for parameters in parameter_sets)
    return position_range if is_narrower else None


def _is_narrower(position_range: PositionRange, parameters: Mapping[str, int]) -> bool:
    """Return True if a range has fewer numbers than the width of its field allows, but at least one.

    The result is False for order codes without the field, whose width is 0.
    """
    width = position_range.field.width.value(parameters)
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
    return PositionRange(field, lowest, highest)


def _unsigned_range(
    measurement: Measurement, fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of a position without a sign, or None if the range is unknown.

    For a position in one field, it is the range of the field, if the number of counts is known. For a position in two
    fields, of which the low field counts exactly one revolution, it is the range of the revolutions in the high field.
    """
    total = measurement.total
    if total is None or any(field.number.signed for field in fields):
        return None
    if len(fields) == 1:
        (field,) = fields
        highest = measurement.highest or total - Expression(1)
        return PositionRange(field, lowest=Expression(0), highest=highest)
    turns = measurement.turns
    counts_per_turn = measurement.counts_per_turn
    if turns is None or counts_per_turn is None:
        return None
    if len(fields) != 2 or measurement.highest is not None:
        return None
    # The fields of a position are listed from the most significant one.
    high_field, low_field = fields
    for parameters in parameter_sets:
        if counts_per_turn.value(parameters) != 1 << low_field.width.value(parameters):
            # Both fields are parts of one revolution.
            return None
    return PositionRange(high_field, lowest=Expression(0), highest=turns - Expression(1))
