"""Range of the numbers that an encoder sends as its position.

An offset can shift unsigned positions up to the ``highest`` of the measurement, so all of these are valid.
Signed positions end at ``highest``, and begin as many numbers before it as the encoder has positions.
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


def narrower_range(measurement: Measurement, layout: Layout, sets: Sequence[Mapping[str, int]]) -> PositionRange | None:
    """Return the range of a position if it is narrower_range than the width of its field for some order code.

    Parts of one revolution in several fields have no range, and signed positions have none without ``highest``.
    """
    by_name = {field.name: field for field in layout.fields}
    fields = [by_name[name] for name in layout.names_in(measurement.of) if name in by_name]
    if any(not isinstance(field.kind, Number) for field in fields):
        return None
    if len(fields) == 1 and fields[0].number.signed:
        position_range = _signed_range(measurement, fields[0])
    else:
        position_range = _unsigned_range(measurement, fields, sets)
    if position_range is None or position_range.field.number.zero_means:
        return None
    is_narrower = any(_is_narrower(position_range, parameters) for parameters in sets)
    return position_range if is_narrower else None


def _is_narrower(position_range: PositionRange, parameters: Mapping[str, int]) -> bool:
    width, highest = position_range.field.width.value(parameters), position_range.highest.value(parameters)
    return bool(width) and 0 <= highest - position_range.lowest.value(parameters) < (1 << width) - 1


def _signed_range(measurement: Measurement, field: Field) -> PositionRange | None:
    total, highest = measurement.total, measurement.highest
    if total is None or highest is None:
        return None
    return PositionRange(field, highest - total + Expression(1), highest)


def _unsigned_range(
    measurement: Measurement, fields: Sequence[Field], sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    total, turns, counts = measurement.total, measurement.turns, measurement.counts_per_turn
    if total is None or any(field.number.signed for field in fields):
        return None
    if len(fields) == 1:
        return PositionRange(fields[0], Expression(0), measurement.highest or total - Expression(1))
    if len(fields) == 2 and measurement.highest is None and counts is not None and turns is not None:
        # Both fields can also be parts of one revolution.
        is_turn = all(counts.value(parameters) == 1 << fields[1].width.value(parameters) for parameters in sets)
        return PositionRange(fields[0], Expression(0), turns - Expression(1)) if is_turn else None
    return None
