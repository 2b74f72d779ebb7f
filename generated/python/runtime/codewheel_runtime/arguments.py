# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Conversion and checks of arguments: frames, numbers, flags and texts."""

from __future__ import annotations

import operator
from enum import Enum, IntEnum
from typing import Any, Final, NoReturn, SupportsIndex, TypeAlias, TypeVar, cast, get_args

from .errors import FrameError, LengthError, RangeError

#: A frame or register in bytes: any buffer of single bytes, such as one row of an array.
Data = bytes | bytearray | memoryview

#: A frame of bits: a number whose most significant bit is sent first, text made of 0s and 1s, or bytes that contain
#: the number, most significant byte first.
Word = SupportsIndex | str | bytes | bytearray | memoryview

#: Many frames of bytes: an array of uint8 with one row per frame, all bytes in sequence, or a list of frames.
Rows: TypeAlias = Any

#: Many frames given as numbers: an array or a list of integers, or eight bytes per frame, least significant first.
Words: TypeAlias = Any


_Answer = TypeVar("_Answer", bound=Enum)
_Choice = TypeVar("_Choice", bound=IntEnum)


def shorten(value: object) -> str:
    """Return ``value`` as text for a message, shortened if it is long."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def require_answer(argument_name: str, answer_class: type[_Answer], answer: _Answer | None) -> _Answer:
    """Return ``answer`` if it answers a question that the manual leaves open, otherwise raise TypeError.

    ``answer_class`` is the enumeration of the possible answers, and ``argument_name`` is for the error.
    """
    if not isinstance(answer, answer_class):
        raise wrong_answer_error(argument_name, answer_class, answer)
    return answer


def wrong_answer_error(argument_name: str, answer_class: type[Enum], answer: object) -> TypeError:
    """Return the error for an answer that is missing or not a member of the enumeration ``answer_class``."""
    answers = " or ".join(f"{answer_class.__name__}.{member.name}" for member in answer_class)
    return TypeError(f"{argument_name} must be {answers}, got {shorten(answer)}: the manual leaves this open")


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
            return operator.index(value)
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

    Type checkers reject a call that can be reached, for example because a ``match`` lacks a case.
    """
    raise AssertionError(f"no case for {kind!r}")


def check_width(field: str, value: SupportsIndex, bits: int) -> int:
    """Return ``value`` as an int. Raises RangeError unless it fits into ``bits`` bits."""
    number = value if type(value) is int else whole_number(field, value)
    # The result is 0 for a number that fits. A negative number keeps its sign when it is shifted, so it does not fit.
    if number >> bits:
        raise RangeError(field, number, f"0 to {(1 << bits) - 1}")
    return number


#: The only allowed value of a flag that the encoder does not send, for an error message.
NO_SUCH_FLAG: Final = "False, since this encoder has no such flag"


def check_flag(field: str, value: object) -> bool:
    """Return ``value`` as a bool. The numbers 0 and 1 and NumPy bools are also accepted.

    Raises RangeError for other integers, and TypeError for other values.
    """
    if type(value) is bool:
        return value
    # The bools of NumPy are not integers.
    numpy_type = getattr(value, "dtype", None)
    if getattr(numpy_type, "kind", "") == "b":
        return bool(value)
    try:
        number = operator.index(cast(SupportsIndex, value))
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
    """Convert text of ``length`` characters to one number: ``0x4142`` for ``"AB"``.

    The text must be Latin-1. It has a character for each byte, so every decoded text can be encoded again. Raises
    RangeError for other characters or a different length.
    """
    allowed = f"{length} Latin-1 characters"
    try:
        data = text.encode("latin-1")
    except UnicodeEncodeError:
        raise RangeError(field, text, allowed) from None
    if len(data) != length:
        raise RangeError(field, text, allowed)
    return int.from_bytes(data, "big")
