"""Errors in a decoded frame: wrong constants and parity bits, unknown values, and numbers outside their range."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Choice, Constant, Decimal, Device, Fault, Field, Parity, PlacedField, PlacedLayout
from ..model.position_range import PositionRange
from ..model.record import dataclass
from ..say import frame_texts
from .bits import bits_of_field, parity_bit
from .values import signed_or_plain


@dataclass(frozen=True, slots=True)
class FrameProblem:
    """An error in a frame, with the field in error."""

    fault: Fault
    field: str
    message: str


def problems_with_other_fields(
    placed_layout: PlacedLayout, placed_field: PlacedField, sent_value: int, frame: int
) -> Iterator[FrameProblem]:
    """Yield an error if the field is a wrong parity bit, or the selector of a different layout.

    ``sent_value`` are its bits as they are sent in ``frame``. A parity bit also covers the other bits as they are sent,
    before a conversion from Gray code.
    """
    name = placed_field.name
    kind = placed_field.field.kind
    if isinstance(kind, Parity):
        correct_bit = parity_bit(placed_layout, kind, frame)
        if sent_value != correct_bit:
            covered_names = ", ".join(field.name for field in placed_layout.find_fields(kind.of))
            message = frame_texts.wrong_parity_message(name, f"{sent_value}", covered_names, f"{correct_bit}")
            yield FrameProblem(Fault.CONSTANT, field=name, message=message)
    elif name == placed_layout.layout.selector and sent_value not in placed_layout.layout.selects:
        message = frame_texts.other_frame_message(name, f"{sent_value:X}")
        yield FrameProblem(Fault.RANGE, field=name, message=message)


def problems_of_position(device: Device, placed_layout: PlacedLayout, binary_number: int) -> Iterator[FrameProblem]:
    """Yield an error if the position in the frame is outside the range of this encoder.

    ``binary_number`` is the frame with its Gray code converted to binary. A position with separately sent digits, such
    as BCD, is not checked here.
    """
    position_range = device.range_in(placed_layout.layout)
    if position_range is None or any(field.kind.digit_code for field in position_range.fields):
        return
    message = range_message(position_range, placed_layout, binary_number)
    if message:
        yield FrameProblem(Fault.RANGE, field=position_range.name, message=message)


def problems_of_digits(
    device: Device, placed_layout: PlacedLayout, frame: int, binary_number: int
) -> Iterator[FrameProblem]:
    """Yield an error for each number with separately sent digits that has an invalid digit or is too high.

    ``frame`` is the frame as it is sent. In ``binary_number``, the same frame with converted numbers, all bits of a
    number with an invalid digit are 1, which is also too high.
    """
    position_range = device.range_in(placed_layout.layout)
    for placed_field in placed_layout.fields:
        name = placed_field.name
        code = placed_field.field.code_of_digits
        if code is None:
            continue
        highest = code.highest(placed_field.width)
        if position_range is not None and position_range.name == name:
            highest = position_range.highest.value(placed_layout.parameters)
        sent_bits = bits_of_field(placed_field, frame)
        number = bits_of_field(placed_field, binary_number)
        if number > highest:
            message = frame_texts.not_in_code_message(name, f"{sent_bits:#x}", f"{highest}", code.name)
            yield FrameProblem(Fault.RANGE, field=name, message=message)


def range_message(position_range: PositionRange, placed_layout: PlacedLayout, binary_number: int) -> str:
    """Return an error message if a position is outside the range of this encoder, or an empty string if it is inside.

    ``binary_number`` is the frame with its Gray code converted to binary. The result is also empty if the order code
    has no field for the position.
    """
    placed_fields = placed_layout.find_fields([field.name for field in position_range.fields])
    if not placed_fields:
        return ""
    lowest = position_range.lowest.value(placed_layout.parameters)
    highest = position_range.highest.value(placed_layout.parameters)
    position = 0
    for placed_field in placed_fields:
        position = position << placed_field.width | bits_of_field(placed_field, binary_number)
    number_kind = position_range.fields[0].number
    is_signed = number_kind.signed
    if is_signed:
        position = signed_or_plain(number_kind, position, placed_fields[0].width)
    if lowest <= position <= highest:
        return ""
    if is_signed:
        return frame_texts.outside_limits_message(f"{position_range.name} {position}", f"{lowest}", f"{highest}")
    return frame_texts.too_high_message(position_range.name, f"{position}", f"{highest}")


def problems_of_value(field: Field, raw: int) -> Iterator[FrameProblem]:
    """Yield an error if a field cannot have the value ``raw``, regardless of the other fields."""
    name = field.name
    match field.kind:
        case Choice(named_values):
            known_numbers = {named_value.value for named_value in named_values}
            if raw not in known_numbers:
                message = frame_texts.unknown_value_message(name, f"{raw:#x}")
                yield FrameProblem(Fault.RANGE, field=name, message=message)
        case Constant(constant):
            if raw != constant:
                message = frame_texts.wrong_constant_message(name, f"{raw:#x}", f"{constant:#x}")
                yield FrameProblem(Fault.CONSTANT, field=name, message=message)
        case Decimal() as decimal:
            if raw >= decimal.limit:
                message = frame_texts.too_many_digits_message(name, f"{raw}", f"{decimal.digits}")
                yield FrameProblem(Fault.RANGE, field=name, message=message)
