"""Bits of a frame for the reference codec: unused and parity bits, joined numbers, Gray code, and CRCs bit by bit.

Parameters have their usual names: width, poly (without its top bit), init, refin, refout, xorout.
"""

from __future__ import annotations

from collections.abc import Callable

from ..model import Crc, Join, Parity, PlacedField, PlacedLayout, Unused, number_to_bytes


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def compute_bits(crc: Crc, number: int, bits: int) -> int:
    """Compute the CRC over ``bits`` bits of ``number``, one by one and most significant first.

    ``refin`` has no meaning for a string of bits and is ignored.
    """
    register, mask, poly, top_bit = crc.init, crc.mask, crc.poly, crc.width - 1
    for index in range(bits - 1, -1, -1):
        has_feedback = ((register >> top_bit) ^ (number >> index)) & 1
        register = (register << 1) & mask
        if has_feedback:
            register ^= poly
    if crc.refout:
        register = reflect(register, crc.width)
    return register ^ crc.xorout


def compute_bytes(crc: Crc, data: bytes) -> int:
    """Compute the CRC over whole bytes. With ``refin``, each byte is processed least significant bit first."""
    return compute_bits(crc, *in_order(crc, data))


def in_order(crc: Crc, data: bytes) -> tuple[int, int]:
    """Return the bits of whole bytes as a number, in the order in which the CRC processes them, and how many."""
    number = 0
    for byte in data:
        number = number << 8 | (reflect(byte, 8) if crc.refin else byte)
    return number, 8 * len(data)


def start_for(crc: Crc, number: int, bits: int, result: int) -> int:
    """Return the ``init`` with which the CRC over these bits is ``result``.

    There is exactly one if the lowest bit of ``poly`` is set, because each step can then be undone.
    """
    register, top_bit = result ^ crc.xorout, crc.width - 1
    if crc.refout:
        register = reflect(register, crc.width)
    for index in range(bits):
        sent_bit = (number >> index) & 1
        # The shift leaves the lowest bit 0, and the polynomial sets it.
        had_feedback = register & 1
        if had_feedback:
            register ^= crc.poly
        shifted_out = had_feedback ^ sent_bit
        register = (register >> 1) | (shifted_out << top_bit)
    return register


def unused_bits(placed: PlacedLayout, number: int) -> int:
    """Return the unused bits of a frame as one number. A bit is 1 if it differs from the manual."""
    differing_bits = 0
    for placed_field, low_bit in placed.unused:
        sent_bits = (number >> placed_field.low) & placed_field.mask
        differing_bits |= (sent_bits ^ documented_bits(placed_field)) << low_bit
    return differing_bits


def documented_bits(placed_field: PlacedField) -> int:
    """Return the documented value of an unused field, cut to the width of the field for this order code."""
    kind = placed_field.field.kind
    return kind.value & placed_field.mask if isinstance(kind, Unused) else 0


def parity_bit(placed: PlacedLayout, parity: Parity, number: int) -> int:
    """Return the parity bit that matches the other bits of ``number``."""
    fields = placed.find_fields(parity.of)
    ones = sum((number >> field.low & field.mask & parity.mask).bit_count() for field in fields)
    return (ones + parity.odd) & 1


def join_value(placed: PlacedLayout, join: Join, number: int) -> int:
    """Return the fields of a join as one number, with the first field most significant."""
    value = 0
    for part in placed.find_fields(join.fields):
        part_value = (number >> part.low) & part.mask
        value = (value << part.width) | part_value
    return value


def gray_to_binary(gray: int) -> int:
    """Return the number whose Gray code is ``gray``: each bit is the parity of the bits from the highest down to it."""
    binary = 0
    while gray:
        binary ^= gray
        gray >>= 1
    return binary


def binary_to_gray(binary: int) -> int:
    """Return the Gray code of ``binary``."""
    return binary ^ binary >> 1


def from_gray(placed: PlacedLayout, number: int) -> int:
    """Return ``number`` with the part that is sent in Gray code, if any, converted to binary."""
    return with_changed_part(placed, number, lambda sent: gray_to_binary(sent) - placed.gray_excess)


def to_gray(placed: PlacedLayout, number: int) -> int:
    """Return ``number`` with the part that is sent in Gray code, if any, converted to Gray code."""
    _, width = placed.place_of(placed.layout.gray_of)
    mask = (1 << width) - 1
    return with_changed_part(placed, number, lambda plain: binary_to_gray(plain + placed.gray_excess & mask))


def with_changed_part(placed: PlacedLayout, number: int, change: Callable[[int], int]) -> int:
    """Return ``number`` with the part that is sent in Gray code, if any, changed by a function. Excess bits are cut."""
    if not placed.gray:
        return number
    low, width = placed.place_of(placed.layout.gray_of)
    mask = (1 << width) - 1
    other_bits = number & ~(mask << low)
    changed_part = change((number >> low) & mask) & mask
    return other_bits | (changed_part << low)


def compute(crc: Crc, placed: PlacedLayout, number: int) -> int:
    """Return the CRC that matches the other bits of ``number``."""
    return compute_bits(crc, *covered(crc, placed, number))


def covered(crc: Crc, placed: PlacedLayout, number: int) -> tuple[int, int]:
    """Return the bits that the CRC covers as a number, in the order in which it processes them, and how many."""
    if placed.layout.crc_covers_bytes:
        data = number_to_bytes(placed.layout, number, placed.bits)
        return in_order(crc, data[: -(crc.width // 8)])
    low, bits = placed.crc_covers
    return number >> low & (1 << bits) - 1, bits
