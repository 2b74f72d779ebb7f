# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code shared by the encoder modules: conversion of arguments, checks and CRCs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum, IntEnum
from functools import cache
from operator import index
from typing import Any, Final, NamedTuple, NoReturn, Protocol, SupportsIndex, TypeAlias, TypeVar, cast, get_args

from .errors import FrameError, LengthError, RangeError

#: A frame or register in bytes: any buffer of single bytes, such as one row of an array.
Data = bytes | bytearray | memoryview

#: A frame that is a string of bits: a number whose most significant bit is the first bit sent, a text of 0s and 1s,
#: or bytes that contain the number, most significant byte first.
Word = SupportsIndex | str | bytes | bytearray | memoryview

#: Many frames of bytes: an array of uint8 with one row per frame, all bytes in sequence, or a list of frames.
Rows: TypeAlias = Any

#: Many frames given as numbers: an array or a list of integers, or eight bytes per frame, least significant first.
Words: TypeAlias = Any

_Answer = TypeVar("_Answer", bound=Enum)
_Choice = TypeVar("_Choice", bound=IntEnum)
_Kind = TypeVar("_Kind")
#: The tuple class, untyped: its methods are called on tuples of any items.
_TUPLE: Final[Any] = tuple


def by_class(kind: type[_Kind]) -> type[_Kind]:
    """Make objects of the class ``kind``, a NamedTuple, equal only to objects of the same class.

    A plain NamedTuple also equals other tuples with the same items. Like the methods of a tuple, the new methods return
    NotImplemented for objects that are not tuples.
    """

    def is_equal(self: tuple[object, ...], other: object) -> object:
        """Compare the items if the classes are the same. No other tuple is equal."""
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


#: ``create(kind, values)`` creates the same NamedTuple as ``kind(*values)``, in half the time.
create: Final = cast(_Create, _TUPLE.__new__)


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


def shorten(value: object) -> str:
    """Return ``value`` as text for a message, shortened if it is long."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def require_answer(answer_class: type[_Answer], answer: _Answer | None) -> _Answer:
    """Return ``answer`` if it answers a question that the manual leaves open, and raise TypeError otherwise.

    ``answer_class`` is the enumeration of the possible answers.
    """
    if not isinstance(answer, answer_class):
        raise wrong_answer_error(answer_class, answer)
    return answer


def wrong_answer_error(answer_class: type[Enum], answer: object) -> TypeError:
    """Return the error for an answer that is missing or not a member of the enumeration ``answer_class``."""
    answers = " or ".join(f"{answer_class.__name__}.{member.name}" for member in answer_class)
    return TypeError(f"expected {answers}, got {shorten(answer)}: the manual leaves this open")


def check_kind(kind: object, kinds: object) -> None:
    """Raise TypeError unless ``kind`` is one of ``kinds``, the classes of the frames that an encoder sends.

    ``kinds`` is a union of classes, or a single class.
    """
    sent_classes: tuple[type, ...] = get_args(kinds) or (cast(type, kinds),)
    if kind not in sent_classes:
        names = ", ".join(sent_class.__name__ for sent_class in sent_classes)
        raise TypeError(f"{shorten(kind)} is not a kind of frame that this encoder sends; it sends {names}")


def whole_number(name: str, value: SupportsIndex) -> int:
    """Return an integer of any type as an int. Raises TypeError for a bool and for other values.

    ``name`` is the name of the value, for the error.
    """
    if not isinstance(value, bool):
        try:
            return index(value)
        except TypeError:
            pass
    raise TypeError(f"{name} must be an integer, got {shorten(value)}")


def as_word(frame: Word, length: int, bits: int | None) -> int:
    """Return a frame of ``length`` bits, given as a number, text or bytes, as one number.

    ``bits`` is the number of bits received, if known. The number itself is not checked: it can be negative, or have
    more than ``length`` bits.

    Raises:
        LengthError: ``bits`` or the number of digits is not ``length``, or the number of bytes does not fit ``length``
            bits.
        RangeError: The text contains characters other than 0 and 1.
        TypeError: ``bits`` is not an integer, or the frame is not a ``Word``.
    """
    if bits is not None:
        bits = whole_number("bits", bits)
    number: SupportsIndex
    if isinstance(frame, str):
        digits = _take_binary_digits(frame)
        # A text also shows how many bits were received.
        if bits is not None and bits != len(digits):
            raise LengthError(bits, len(digits), "bits")
        bits = len(digits)
        number = int(digits or "0", 2)
    elif isinstance(frame, (bytes, bytearray, memoryview)):
        # As in files: as few bytes as possible, with leading zeros.
        data = as_bytes(frame)
        byte_count = (length + 7) // 8
        if len(data) != byte_count:
            raise LengthError(byte_count, len(data))
        number = int.from_bytes(data, "big")
    else:
        number = frame
    if bits is not None and bits != length:
        raise LengthError(length, bits, "bits")
    return whole_number("the frame", number)


def _take_binary_digits(text: str) -> str:
    """Return the binary digits of a frame, without a leading ``0b``.

    Raises RangeError if the text has other characters.

    Underscores and spaces between digits are accepted, because they make long frames readable.
    """
    digits = text.strip().removeprefix("0b").replace("_", "").replace(" ", "")
    other_characters = set(digits) - {"0", "1"}
    if other_characters:
        shortened = text if len(text) <= 80 else f"{text[:80]}..."
        raise RangeError("the frame", shortened, "a string of 0 and 1 (for hexadecimal text, use int(text, 16))")
    return digits


def too_long_error(word: int, length: int) -> FrameError:
    """Return the error for a number that is negative or has more than ``length`` bits, so it cannot be a frame."""
    return RangeError("the frame", word, "0 or more") if word < 0 else LengthError(length, word.bit_length(), "bits")


def as_bytes(data: Data) -> bytes:
    """Return a frame or register as bytes. Raises TypeError unless it is a one-dimensional buffer of single bytes."""
    if isinstance(data, bytes):
        return data
    try:
        view = memoryview(data)
    except TypeError:
        advice = "bytes.fromhex(text)" if isinstance(data, str) else "bytes or another buffer of bytes"
        raise TypeError(f"expected bytes, got {shorten(data)}: pass {advice}") from None
    # The formats of signed and unsigned bytes, and of characters. A mark of the byte order can precede them.
    has_single_bytes = view.itemsize == 1 and view.format[-1] in "Bbc"
    if view.ndim != 1 or not has_single_bytes:
        shape = "items" if view.ndim == 1 else f"items in {view.ndim} dimensions"
        raise TypeError(f"expected a row of bytes, got a buffer of {shape} of the format '{view.format}': pass bytes")
    return view.tobytes()


def assert_never(kind: NoReturn) -> NoReturn:
    """Raise AssertionError.

    Type checkers reject a call that can be reached, such as for a missing case of a ``match``.
    """
    raise AssertionError(f"no case for {kind!r}")


def check_width(field: str, value: SupportsIndex, bits: int) -> int:
    """Return ``value`` as an int. Raises RangeError unless it fits into ``bits`` bits."""
    number = value if type(value) is int else whole_number(field, value)
    # The result is 0 for a number that fits. A negative number keeps its sign when it is shifted, so it does not fit.
    if number >> bits:
        raise RangeError(field, number, f"0 to {(1 << bits) - 1}")
    return number


#: Only value of a flag that the encoder does not send, for an error.
NO_SUCH_FLAG: Final = "False, since this encoder has no such flag"


def check_flag(field: str, value: object) -> bool:
    """Return ``value`` as a bool. The numbers 0 and 1 are accepted, and so are the bools of NumPy.

    Raises RangeError for other integers, and TypeError for other values.
    """
    if type(value) is bool:
        return value
    # The bools of NumPy are not integers.
    numpy_type = getattr(value, "dtype", None)
    if getattr(numpy_type, "kind", "") == "b":
        return bool(value)
    try:
        number = index(cast(SupportsIndex, value))
    except TypeError:
        raise TypeError(f"{field} must be True or False, got {shorten(value)}") from None
    if number not in (0, 1):
        raise RangeError(field, number, "True or False")
    return number == 1


def check_bits(field: str, value: SupportsIndex, bits: int) -> int:
    """Return ``value`` as an int. Raises RangeError if it has bits outside the mask ``bits``."""
    number = value if type(value) is int else whole_number(field, value)
    if number & ~bits:
        raise RangeError(field, number, f"within the mask {bits:#x}")
    return number


def check_limits(field: str, value: SupportsIndex, limits: tuple[int, int]) -> int:
    """Return ``value`` as an int. Raises RangeError unless it is within ``limits``, which are inclusive."""
    number = value if type(value) is int else whole_number(field, value)
    lowest, highest = limits
    if not lowest <= number <= highest:
        raise RangeError(field, number, f"{lowest} to {highest}")
    return number


def check_signed(field: str, value: SupportsIndex, bits: int) -> int:
    """Return ``value`` as an int. Raises RangeError unless it fits into ``bits`` bits as two's complement."""
    number = value if type(value) is int else whole_number(field, value)
    sign_bit = (1 << bits) >> 1
    # A field without bits can only have the value 0.
    highest = sign_bit - 1 if sign_bit else 0
    if not -sign_bit <= number <= highest:
        raise RangeError(field, number, f"{-sign_bit} to {highest}")
    return number


def check_power_of_two(field: str, value: SupportsIndex) -> None:
    """Raise RangeError unless ``value`` is a power of two."""
    number = whole_number(field, value)
    # A power of two has a single 1 bit, which the AND with the number below it clears.
    without_lowest_one = number & (number - 1)
    if number < 1 or without_lowest_one:
        raise RangeError(field, number, "a power of two")


def as_member(enumeration: type[_Choice], field: str, value: SupportsIndex) -> _Choice:
    """Return the enumeration member whose number is ``value``. Raises RangeError if there is no such member."""
    number = value if type(value) is int else whole_number(field, value)
    try:
        return enumeration(number)
    except ValueError:
        members = ", ".join(str(int(member)) for member in enumeration)
        raise RangeError(field, number, f"one of {members}") from None


def text_number(field: str, text: str, length: int) -> int:
    """Return a text of ``length`` characters as one number: ``0x4142`` for ``"AB"``.

    The text must be Latin-1, which has a character for each byte, so every decoded text can be encoded again. Raises
    RangeError for other characters or a different length.
    """
    try:
        data = text.encode("latin-1")
    except UnicodeEncodeError:
        # No bytes are of the wrong length, so the error below follows.
        data = b""
    if len(data) != length:
        raise RangeError(field, text, f"{length} Latin-1 characters")
    return int.from_bytes(data, "big")


def signed(value: int, bits: int) -> int:
    """Interpret ``bits`` bits as a two's complement number: with 4 bits, 15 is -1.

    The function is called for each frame, so it is one expression. A field without bits has no sign bit.
    """
    return value - (1 << bits) if value & ((1 << bits) >> 1) else value


def zero_for(field: str, value: SupportsIndex, zero_means: int, bits: int) -> int:
    """Return the bits of a field in which 0 stands for ``zero_means``: with 16, the value 16 becomes 0.

    Raises:
        RangeError: ``value`` is 0, or does not fit into ``bits`` bits.
    """
    number = whole_number(field, value)
    if number == 0:
        raise RangeError(field, number, f"1 to {zero_means}")
    if number == zero_means:
        return 0
    return check_width(field, number, bits)


def from_gray(number: int, low: int, width: int, excess: int = 0) -> int:
    """Return ``number`` with the ``width`` bits from bit ``low`` up converted from Gray code to binary.

    ``excess`` is the number that the encoder sends for position 0. It is subtracted from the converted bits, and the
    difference wraps around in ``width`` bits. The other bits of ``number`` do not change.
    """
    mask = (1 << width) - 1
    gray = (number >> low) & mask
    # Each bit of the binary number is the XOR of all Gray bits from it up to the highest.
    binary = gray
    while gray := gray >> 1:
        binary ^= gray
    other_bits = number & ~(mask << low)
    return other_bits | (((binary - excess) & mask) << low)


def to_gray(number: int, low: int, width: int, excess: int = 0) -> int:
    """Return ``number`` with the ``width`` bits from bit ``low`` up converted from binary to Gray code.

    ``excess`` is the number that the encoder sends for position 0. It is added to the bits before, and the sum wraps
    around in ``width`` bits. The other bits of ``number`` do not change.
    """
    mask = (1 << width) - 1
    binary = ((number >> low) + excess) & mask
    gray = binary ^ (binary >> 1)
    other_bits = number & ~(mask << low)
    return other_bits | (gray << low)


def from_digits(number: int, low: int, width: int, digit_bits: int, codes: Sequence[int]) -> int:
    """Return ``number`` with the ``width`` bits from bit ``low`` up converted from separate digits to binary.

    Each digit has ``digit_bits`` bits, and ``codes`` has the code of each digit from 0 up, such as BCD. If a digit has
    another code, the converted bits are all 1, which is above the highest number.
    """
    mask = (1 << width) - 1
    digit_mask = (1 << digit_bits) - 1
    sent_digits = (number >> low) & mask
    other_bits = number & ~(mask << low)
    base = len(codes)
    value = 0
    # Places of the digits, the highest digit first.
    highest_place = (width - 1) // digit_bits * digit_bits
    for place in range(highest_place, -1, -digit_bits):
        code = (sent_digits >> place) & digit_mask
        if code not in codes:
            value = mask
            break
        value = value * base + codes.index(code)
    return other_bits | value << low


def to_digits(number: int, low: int, width: int, digit_bits: int, codes: Sequence[int]) -> int:
    """Return ``number`` with the ``width`` bits from bit ``low`` up converted from binary to separate digits.

    Each digit has ``digit_bits`` bits, and ``codes`` has the code of each digit from 0 up, such as BCD.
    """
    mask = (1 << width) - 1
    value = (number >> low) & mask
    other_bits = number & ~(mask << low)
    sent_digits = 0
    for place in range(0, width, digit_bits):
        value, digit = divmod(value, len(codes))
        sent_digits |= codes[digit] << place
    return other_bits | (sent_digits & mask) << low


def unwrap(
    previous: SupportsIndex, position: SupportsIndex, modulus: int, highest: int | None = None, lowest: int = 0
) -> int:
    """Return the count nearest to ``previous`` that equals ``position`` modulo ``modulus``.

    After 1023, the position 2 of 1024 is the count 1026. If two counts are equally near, the lower one is returned.
    ``lowest`` and ``highest`` are the limits of ``position``, by default 0 and ``modulus - 1``. Raises RangeError for
    positions outside them.
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
        modulus: Number of counts after which the position wraps around. None if it never does.
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
    highest_place = width - 1
    mask = (1 << width) - 1
    register = init
    for bit in reversed(range(bits)):
        # The bit of the register that is shifted out, XORed with the next bit of the number.
        feedback = ((register >> highest_place) ^ (number >> bit)) & 1
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
    # How each bit of the word changes the XOR, the lowest bit first.
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
    for lowest_bit in range(0, table_bits * count, table_bits):
        # The CRC of the word 0 is in one table only.
        first_entry = 0 if tables else crc_of_zero
        tables.append(make_table(first_entry, changes[lowest_bit : lowest_bit + table_bits]))
    return tuple(tables)


def _make_table(first: int, changes: Sequence[int]) -> Sequence[int]:
    """Return a table with an entry for each number: ``first`` XORed with the change of each 1 bit in the number.

    Each bit doubles the table: its second half contains the entries with this bit set.
    """
    table = [first]
    for change in changes:
        table += [entry ^ change for entry in table]
    return table


def _make_byte_table(first: int, changes: Sequence[int]) -> Sequence[int]:
    """Return the table of ``_make_table`` as bytes, which take less memory."""
    table = bytes([first])
    for change in changes:
        table += table.translate(bytes(byte ^ change for byte in range(256)))
    return table


def _reverse_bits(value: int, width: int) -> int:
    """Return the bits of a number in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)
