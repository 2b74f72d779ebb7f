# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encodes one frame or register as a number."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..codec import (
    NO_SUCH_FLAG,
    as_member,
    assert_never,
    check_bits,
    check_flag,
    check_limits,
    check_power_of_two,
    check_signed,
    check_width,
    signed,
    text_number,
    to_digits,
    to_gray,
    whole_number,
    zero_for,
)
from ..errors import RangeError

if TYPE_CHECKING:
    from ..bulk.shape import Check, Column, CrcOf, FrameLayout, Unused


def encode_number(fields: Any, layout: FrameLayout, arguments: tuple[Any, ...]) -> int:
    """Return a frame as a number, including parity bits and CRC. ``fields`` is the frame with its fields as attributes.

    ``arguments`` are the encoder and the answers that the description of the frame needs.

    Raises:
        RangeError: A value does not fit its field.
    """
    number = layout.fixed
    for column in layout.columns:
        number |= _encode_field(fields, column) << column.lowest_bit
    for check in layout.checks:
        bits = check.take(number)
        if not check.is_within(bits):
            raise _limit_error(layout, check, bits)
    # A register can keep bits that belong to no field, at their places. Other unused bits are as in the manual.
    if layout.kept_mask is not None:
        number |= check_bits("unused", fields.unused, layout.kept_mask)
    elif layout.unused:
        number |= _encode_unused_bits(fields.unused, layout.unused)
    # The limits of a register apply to one value: its name in messages, and its attribute.
    if layout.limited_value is not None:
        name_in_messages, attribute = layout.limited_value
        check_limits(name_in_messages, getattr(fields, attribute), fields.limits(*arguments))
    # The parity covers the Gray code, and the CRC covers both.
    number = _convert_from_binary(number, layout)
    for check in layout.parities:
        number |= check.parity(number) << check.lowest_bit
    if layout.crc is not None:
        number |= compute_crc(number, layout.crc) << layout.crc.lowest_bit
    return number


def _convert_from_binary(number: int, layout: FrameLayout) -> int:
    """Convert the binary numbers in a frame to the codes that are sent: separate digits and Gray code."""
    for coding in layout.digit_codings:
        number = to_digits(number, *coding)
    if layout.gray is None:
        return number
    lowest_bit, width = layout.gray
    return to_gray(number, lowest_bit, width, layout.excess)


def _limit_error(layout: FrameLayout, check: Check, bits: int) -> RangeError:
    """Return the error for a field that is outside its limits.

    ``check`` contains these limits, and ``bits`` are the bits of the field.
    """
    if check.joined:
        return RangeError(layout.position, bits, f"at most {check.highest}")
    # The field of a check is the one with exactly the same bits of the frame.
    checked_bits = (check.lowest_bit, check.width)
    column = next(candidate for candidate in layout.columns if (candidate.lowest_bit, candidate.width) == checked_bits)
    field_name = column.field or column.name
    if column.value_kind == "signed":
        return RangeError(field_name, signed(bits, check.width), f"{check.lowest} to {check.highest}")
    return RangeError(field_name, bits, f"at most {check.highest}")


def _encode_unused_bits(differing: Any, unused_fields: tuple[Unused, ...]) -> int:
    """Return the unused bits of a frame at their places, with the manual's values inverted where ``differing`` has a 1.

    ``differing`` contains all unused bits side by side: ``bit_in_column`` is a bit in this number, and ``lowest_bit`` a
    bit in the frame.
    """
    mask = sum(((1 << unused.width) - 1) << unused.bit_in_column for unused in unused_fields)
    differing_bits = check_bits("unused", differing, mask)
    number = 0
    for unused in unused_fields:
        bits_to_send = (differing_bits >> unused.bit_in_column) ^ unused.value
        width_mask = (1 << unused.width) - 1
        number |= (bits_to_send & width_mask) << unused.lowest_bit
    return number


def _encode_field(fields: Any, column: Column) -> int:
    """Return the bits of a field, shifted down to bit 0. Raises RangeError if its value does not fit.

    ``fields`` is the frame, with its fields as attributes.
    """
    name = column.field or column.name
    width = column.width
    if column.value_kind == "digits":
        number = 0
        for digits_name, divisor, modulus in column.digit_groups:
            digits = check_limits(digits_name, getattr(fields, digits_name), (0, modulus - 1))
            number += digits * divisor
        return number
    value = getattr(fields, column.name)
    match column.value_kind:
        case "flag" | "not_flag":
            is_active = check_flag(name, value)
            if not width and is_active:
                raise RangeError(name, is_active, NO_SUCH_FLAG)
            is_active_high = column.value_kind == "flag"
            # True counts as 1. A flag without a bit has the width 0.
            return (is_active == is_active_high) & width
        case "text":
            return text_number(name, value, width // 8)
        case "signed":
            return check_signed(name, value, width) & ((1 << width) - 1)
        case "number" | "choice":
            return _encode_number(name, value, column)
        case _:
            assert_never(column.value_kind)


def _encode_number(name: str, value: Any, column: Column) -> int:
    """Return the bits of an unsigned number.

    Raises RangeError if it does not fit, or is not an allowed value of the field.
    """
    width = column.width
    if isinstance(column.allowed_values, type):
        return as_member(column.allowed_values, name, value)
    if column.allowed_values:
        number = whole_number(name, value)
        if number not in column.allowed_values:
            allowed = ", ".join(f"{allowed_value:X}h" for allowed_value in column.allowed_values)
            if len(column.allowed_values) > 1:
                allowed = f"one of {allowed}"
            raise RangeError(name, number, allowed)
        return number
    if column.zero_means:
        number = zero_for(name, value, column.zero_means, width)
    else:
        number = check_width(name, value, width)
    if column.power_of_two:
        check_power_of_two(name, value)
    return number


def compute_crc(number: int, crc: CrcOf) -> int:
    """Return the CRC of a frame, given as a number in which the bits of the CRC are 0."""
    if not crc.steps:
        # The CRC bits are 0, so the difference from them is the CRC.
        return crc.find_difference(number)
    # Each step folds the high bits of the number onto lower ones, at one or two places. The remainder is the CRC.
    remainder = number
    for step in crc.steps:
        high_bits = remainder >> step.shift
        remainder = (remainder & step.mask) ^ high_bits
        if step.back:
            remainder ^= high_bits << step.back
    return remainder ^ crc.xorout
