# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code shared by the encoder modules: positions of fields, number codes and CRCs.

The argument checks are in ``arguments``. Encoder modules import them from here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from operator import index
from typing import Any, Final, NamedTuple, Protocol, SupportsIndex, TypeVar, cast

from .arguments import (
    NO_SUCH_FLAG,
    Data,
    Rows,
    Word,
    Words,
    as_bytes,
    as_member,
    as_word,
    assert_never,
    check_bits,
    check_flag,
    check_kind,
    check_limits,
    check_power_of_two,
    check_signed,
    check_width,
    require_answer,
    shorten,
    text_number,
    too_long_error,
    whole_number,
    wrong_answer_error,
)
from .errors import RangeError

__all__ = [
    "NO_SUCH_FLAG",
    "BitField",
    "Data",
    "PositionRange",
    "Rows",
    "Word",
    "Words",
    "as_bytes",
    "as_member",
    "as_word",
    "assert_never",
    "by_class",
    "check_bits",
    "check_flag",
    "check_kind",
    "check_limits",
    "check_power_of_two",
    "check_signed",
    "check_width",
    "crc_by_xor",
    "crc_of_bits",
    "crc_of_bytes",
    "create_tuple",
    "exchange_bytes",
    "from_digits",
    "from_gray",
    "make_crc_tables",
    "require_answer",
    "shorten",
    "signed",
    "text_number",
    "to_digits",
    "to_gray",
    "too_long_error",
    "unwrap",
    "whole_number",
    "wrong_answer_error",
    "zero_for",
]

_Kind = TypeVar("_Kind")
#: The tuple class, untyped: its methods are called on tuples of any items.
_TUPLE: Final[Any] = tuple


def by_class(kind: type[_Kind]) -> type[_Kind]:
    """Make objects of the NamedTuple class ``kind`` equal only to objects of the same class.

    A plain NamedTuple also equals other tuples with the same items. Like the methods of a tuple, the new methods return
    NotImplemented for objects that are not tuples.
    """

    def is_equal(self: tuple[object, ...], other: object) -> object:
        """Compare the items if the classes are the same. No other tuple is equal to it."""
        if self.__class__ is other.__class__:
            return _TUPLE.__eq__(self, other)
        return False if isinstance(other, tuple) else NotImplemented

    def differs(self: tuple[object, ...], other: object) -> object:
        if self.__class__ is other.__class__:
            return _TUPLE.__ne__(self, other)
        return True if isinstance(other, tuple) else NotImplemented

    def compute_hash(self: tuple[object, ...]) -> int:
        return hash((self.__class__, _TUPLE.__hash__(self)))

    for name, method in (("__eq__", is_equal), ("__ne__", differs), ("__hash__", compute_hash)):
        setattr(kind, name, method)
    return kind


class _Create(Protocol):
    def __call__(self, kind: type[_Kind], values: tuple[object, ...], /) -> _Kind: ...


#: ``create_tuple(kind, values)`` creates the same NamedTuple as ``kind(*values)``, in half the time.
create_tuple: Final = cast(_Create, _TUPLE.__new__)


class BitField(NamedTuple):
    """Position of a field in the number that a frame or register forms.

    Attributes:
        name: Name of the field.
        low: Lowest bit of the field. Bit 0 is the least significant bit of the number.
        width: Number of bits.
    """

    name: str
    low: int
    width: int

    @property
    def high(self) -> int:
        """Highest bit of the field."""
        return self.low + self.width - 1

    @property
    def mask(self) -> int:
        """Mask of the field's bits."""
        return ((1 << self.width) - 1) << self.low

    def of(self, number: int) -> int:
        """Return the bits of the field in ``number``, shifted down to bit 0."""
        return (index(number) & self.mask) >> self.low


def signed(value: int, bits: int) -> int:
    """Interpret ``bits`` bits as a two's complement number: with 4 bits, 15 is -1.

    The function is called for each frame, so it is one expression. A field without bits has no sign bit.
    """
    return value - (1 << bits) if value & ((1 << bits) >> 1) else value


def zero_for(field: str, value: SupportsIndex, zero_means: int, bits: int) -> int:
    """Return the bits of a field in which 0 represents ``zero_means``: with 16, the value 16 becomes 0.

    Raises:
        RangeError: ``value`` is 0, or does not fit into ``bits`` bits.
    """
    number = whole_number(field, value)
    if number == 0:
        raise RangeError(field, number, f"1 to {zero_means}")
    if number == zero_means:
        return 0
    return check_width(field, number, bits)


def exchange_bytes(data: bytes, field_ranges: Sequence[tuple[int, int]]) -> bytes:
    """Return ``data`` with the bytes of some fields in reverse order.

    ``field_ranges`` has the first byte of each field, and the byte after the field.
    """
    for start, stop in field_ranges:
        data = data[:start] + data[start:stop][::-1] + data[stop:]
    return data


def from_gray(number: int, lowest_bit: int, width: int, excess: int = 0) -> int:
    """Convert the ``width`` bits of ``number`` that start at bit ``lowest_bit`` from Gray code to binary.

    ``excess`` is the number that the encoder sends for position 0. It is subtracted from the converted bits, and the
    difference wraps around in ``width`` bits. The other bits of ``number`` do not change.
    """
    mask = (1 << width) - 1
    gray = (number >> lowest_bit) & mask
    # Each bit of the binary number is the XOR of all Gray bits from it up to the highest.
    binary = gray
    while gray := gray >> 1:
        binary ^= gray
    other_bits = number & ~(mask << lowest_bit)
    return other_bits | (((binary - excess) & mask) << lowest_bit)


def to_gray(number: int, lowest_bit: int, width: int, excess: int = 0) -> int:
    """Convert the ``width`` bits of ``number`` that start at bit ``lowest_bit`` from binary to Gray code.

    ``excess`` is the number that the encoder sends for position 0. It is added to the bits before, and the sum wraps
    around in ``width`` bits. The other bits of ``number`` do not change.
    """
    mask = (1 << width) - 1
    binary = ((number >> lowest_bit) + excess) & mask
    gray = binary ^ (binary >> 1)
    other_bits = number & ~(mask << lowest_bit)
    return other_bits | (gray << lowest_bit)


def from_digits(number: int, lowest_bit: int, width: int, digit_bits: int, codes: Sequence[int]) -> int:
    """Convert the ``width`` bits of ``number`` that start at bit ``lowest_bit`` from separate digits to binary.

    Each digit has ``digit_bits`` bits, and ``codes`` contains the code of each digit, starting with 0, such as BCD. If
    a digit has another code, the converted bits are all 1, which is above the highest number.
    """
    mask = (1 << width) - 1
    digit_mask = (1 << digit_bits) - 1
    sent_digits = (number >> lowest_bit) & mask
    other_bits = number & ~(mask << lowest_bit)
    base = len(codes)
    value = 0
    # Places of the digits, the highest digit first.
    highest_digit_shift = (width - 1) // digit_bits * digit_bits
    for digit_shift in range(highest_digit_shift, -1, -digit_bits):
        code = (sent_digits >> digit_shift) & digit_mask
        if code not in codes:
            value = mask
            break
        value = value * base + codes.index(code)
    return other_bits | (value << lowest_bit)


def to_digits(number: int, lowest_bit: int, width: int, digit_bits: int, codes: Sequence[int]) -> int:
    """Convert the ``width`` bits of ``number`` that start at bit ``lowest_bit`` from binary to separate digits.

    Each digit has ``digit_bits`` bits, and ``codes`` contains the code of each digit, starting with 0, such as BCD.
    """
    mask = (1 << width) - 1
    value = (number >> lowest_bit) & mask
    other_bits = number & ~(mask << lowest_bit)
    sent_digits = 0
    for digit_shift in range(0, width, digit_bits):
        value, digit = divmod(value, len(codes))
        sent_digits |= codes[digit] << digit_shift
    return other_bits | ((sent_digits & mask) << lowest_bit)


def unwrap(
    previous: SupportsIndex, position: SupportsIndex, modulus: int, highest: int | None = None, lowest: int = 0
) -> int:
    """Return the count nearest to ``previous`` that equals ``position`` modulo ``modulus``.

    With a modulus of 1024, the position 2 after the count 1023 becomes the count 1026. If two counts are equally near,
    the lower one is returned. ``lowest`` and ``highest`` are the limits of ``position``, by default 0 and ``modulus -
    1``. Raises RangeError for positions outside them.
    """
    highest_position = modulus - 1 if highest is None else highest
    limits = (lowest, highest_position)
    previous = whole_number("previous", previous)
    position = check_limits("position", position, limits)
    # The shortest step to the position, from minus half of the modulus to half of it.
    half = modulus // 2
    step = (position - previous + half) % modulus - half
    return previous + step


class PositionRange(NamedTuple):
    """Range of the positions in frames of one class.

    Attributes:
        lowest: Lowest position.
        highest: Highest position.
        modulus: Number of counts after which the position wraps around. None if it never wraps around.
    """

    lowest: int
    highest: int
    modulus: int | None

    def unwrap(self, previous: int, position: int) -> int:
        """Return the count nearest to ``previous`` that corresponds to ``position``.

        If the position never wraps around, this is the position.

        Args:
            previous: Result of the previous call. On the first call, pass the first ``position``.
            position: Position in a frame of this class, in counts.

        Returns:
            The count.

        Raises:
            RangeError: ``position`` is above ``highest`` or below ``lowest``.
        """
        if self.modulus is None:
            return check_limits("position", position, (self.lowest, self.highest))
        return unwrap(previous, position, self.modulus, self.highest, self.lowest)


def crc_of_bits(
    number: SupportsIndex, bits: int, *, width: int, poly: int, init: int, refout: bool, xorout: int
) -> int:
    """Return the CRC of ``width`` bits over the ``bits`` bits of ``number``, most significant bit first.

    ``poly`` is the polynomial without its highest term, and ``init`` the start value. ``refout`` reverses the bits of
    the CRC, and ``xorout`` then inverts some of them. Raises RangeError if the number has more than ``bits`` bits.
    """
    number = check_width("number", number, bits)
    highest_bit = width - 1
    mask = (1 << width) - 1
    register = init
    for bit in reversed(range(bits)):
        # The bit of the register that is shifted out, XORed with the next bit of the number.
        feedback = ((register >> highest_bit) ^ (number >> bit)) & 1
        register = (register << 1) & mask
        if feedback:
            register ^= poly
    crc = _reverse_bits(register, width) if refout else register
    return crc ^ xorout


def crc_of_bytes(data: Data, *, width: int, poly: int, init: int, refin: bool, refout: bool, xorout: int) -> int:
    """Return the CRC over whole bytes. If ``refin`` is True, the least significant bit of each byte comes first.

    ``width`` is the number of bits of the CRC. ``poly`` is the polynomial without its highest term, and ``init`` the
    start value. ``refout`` reverses the bits of the CRC, and ``xorout`` then inverts some of them.
    """
    data = as_bytes(data)
    number = 0
    for byte in data:
        next_byte = _reverse_bits(byte, 8) if refin else byte
        number = (number << 8) | next_byte
    return crc_of_bits(number, 8 * len(data), width=width, poly=poly, init=init, refout=refout, xorout=xorout)


def crc_by_xor(data: Data, xorout: int = 0) -> int:
    """Return the CRC for x^8 + 1 with start value 0: the XOR of the bytes and of ``xorout``."""
    register = 0
    for byte in as_bytes(data):
        register ^= byte
    return register ^ xorout


@cache
def make_crc_tables(
    crc: Callable[[int, int], int], covered: int, width: int, count: int, gap: int = 0
) -> tuple[Sequence[int], ...]:
    """Return one table for each 16 bits of a word. The XOR of the entries for the word is 0 if its CRC is correct.

    ``crc`` computes the CRC over the ``covered`` highest bits of the word. The CRC is in its ``width`` lowest bits, and
    ``gap`` bits are between the two. There are ``count`` tables, the first one for the lowest 16 bits.
    """
    crc_of_zero = crc(0, covered)
    # The tables XOR the CRC in the word with the CRC of its covered bits. A CRC is linear: each bit of the word changes
    # this XOR in the same way, whatever the other bits are. These are the changes, for the lowest bit first.
    changes_of_crc_bits = [1 << bit for bit in range(width)]
    changes_of_gap = [0] * gap
    changes_of_covered_bits = [crc(1 << bit, covered) ^ crc_of_zero for bit in range(covered)]
    changes = changes_of_crc_bits + changes_of_gap + changes_of_covered_bits
    table_bits = 16
    # Bits above the word are always 0.
    changes += [0] * (table_bits * count - len(changes))
    # An entry of at most 8 bits fits into a byte.
    make_table = _make_byte_table if width <= 8 else _make_table
    tables: list[Sequence[int]] = []
    for table_index in range(count):
        # The CRC of the word 0 is in the first table only, because the XOR of all tables must contain it once.
        is_first_table = table_index == 0
        first_entry = crc_of_zero if is_first_table else 0
        lowest_bit = table_bits * table_index
        changes_of_table = changes[lowest_bit : lowest_bit + table_bits]
        tables.append(make_table(first_entry, changes_of_table))
    return tuple(tables)


def _make_table(first_entry: int, changes: Sequence[int]) -> Sequence[int]:
    """Return a table with an entry for each number: ``first_entry`` XORed with the changes for its 1 bits.

    Each bit doubles the table: its second half contains the entries with this bit set.
    """
    table = [first_entry]
    for change in changes:
        table += [entry ^ change for entry in table]
    return table


def _make_byte_table(first_entry: int, changes: Sequence[int]) -> Sequence[int]:
    """Return the table of ``_make_table`` as bytes, which take less memory."""
    table = bytes([first_entry])
    for change in changes:
        table += table.translate(bytes(byte ^ change for byte in range(256)))
    return table


def _reverse_bits(value: int, width: int) -> int:
    """Return the bits of a number in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)
