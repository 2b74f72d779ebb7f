"""Read the fields of a line, such as ``position=32``, ``error=low`` or ``crc=6:0x43``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from ..language.problems import quoted, suggest_word
from ..model.keys_and_members import LARGEST
from .line import IN_TURN, POSITION, TURNS, CrcField, FillerField, FlagField, LineField, NumberField, ParityField

#: Verdict of an active flag, by the word for it in the line.
VERDICTS = {"error": "not_usable", "warning": "usable_with_warning", "status": "usable"}
#: Widest field and widest CRC in bits.
WIDEST, _WIDEST_CRC = 64, 32
_FIELD_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}")
_NUMBER_TEXT = re.compile(r"0[xX][0-9A-Fa-f]{1,17}|0[bB][01]{1,65}|0|[1-9][0-9]{0,19}")
#: Names of fields with a special meaning.
_KNOWN_NAMES = (POSITION, IN_TURN, TURNS, "error", "warning", "zero", "unused", "parity", "crc")
#: Words for the order of the bytes, and words for a CRC over bytes.
BYTE_ORDERS = ("low_byte_first", "high_byte_first")
BYTES_WORDS = ("reflected", *BYTE_ORDERS)
#: Words after the numbers of a CRC.
_CRC_WORDS = ("inverted", "plain", *BYTES_WORDS)
_CRC_WORDS_TEXT = ":inverted, :plain, :reflected, :low_byte_first or :high_byte_first"
#: How to write other fields.
_FIELD_FORMS = "NAME=BITS for a number, NAME=low or NAME=high for a flag"


class FieldError(ValueError):
    """A text is not a field. The message says how to correct it, and ``offset`` is the index of the wrong character."""

    def __init__(self, message: str, offset: int = 0) -> None:
        super().__init__(message)
        self.offset = offset


def number_in(text: str) -> int | None:
    """Parse a decimal, hexadecimal or binary number, and return it, or None if the text is not a number.

    A number has at most 20 decimal, 17 hexadecimal or 65 binary digits. A decimal number must not begin with 0.
    """
    return int(text, 0) if _NUMBER_TEXT.fullmatch(text) else None


def read_field(text: str, column: int, interface: str) -> LineField:
    """Parse a field of a line, such as ``crc=6:0x43``, where 6 and 0x43 are its values.

    ``column`` is the column of the field in the line.

    Raises:
        FieldError: The text does not describe a field.
    """
    name, equals, value_text = text.partition("=")
    name = name.strip()
    values = [value.strip() for value in value_text.split(":")] if equals else []
    if not text.strip():
        raise FieldError("a field is missing between two commas; remove one of them")
    if not _FIELD_NAME.fullmatch(name):
        raise FieldError(f"{quoted(name)} is not a name; use letters, digits and underscores, such as position=32")
    name = _spec_name(name)
    if name == "crc":
        return _read_crc(values, column, interface)
    if name == "parity":
        return _read_parity(values, column)
    if name in ("zero", "unused"):
        # The conditional expression has the type Literal["zero", "unused"].
        return _read_filler("zero" if name == "zero" else "unused", values, column)
    if values and values[0] in ("low", "high"):
        return _read_flag(name, values, column)
    if name in ("error", "warning") and (not values or values == ["1"]):
        return _flag_of_interface(name, column, interface)
    return _read_number(name, values, column)


def _spec_name(line_name: str) -> str:
    """Convert the name of a field to the form that a spec requires: lowercase, with single underscores."""
    words = [word for word in line_name.lower().split("_") if word]
    return "_".join(words)


def _read_width(name: str, width_text: str, widest: int = WIDEST) -> int:
    """Parse the width of a field in bits, or raise a ``FieldError`` if it is not a number from 1 to ``widest``."""
    bits = number_in(width_text)
    if bits is None or not 0 < bits <= widest:
        offset = len(name) + 1  # after "name="
        raise FieldError(f"{quoted(width_text)} is not a width of '{name}'; write 1 to {widest}", offset)
    return bits


def _read_number(name: str, values: Sequence[str], column: int) -> NumberField:
    """Create a number field from its values: the width, and optionally ``signed`` or the value of a constant.

    Raises:
        FieldError: The values are missing or wrong.
    """
    if not values or values == [""]:
        hint = suggest_word(name, _KNOWN_NAMES) if name not in _KNOWN_NAMES else ""
        raise FieldError(f"'{name}' has no width; write {_FIELD_FORMS}{hint}")
    if name in ("error", "warning"):
        raise FieldError(f"'{name}' is one bit; write {name}=low or {name}=high", len(name) + 1)
    bits = _read_width(name, values[0])
    if len(values) == 1:
        return NumberField(name=name, bits=bits, column=column)
    if values[1:] == ["signed"]:
        return NumberField(name=name, bits=bits, column=column, is_signed=True)
    value = number_in(values[1])
    offset = len(name) + len(values[0]) + 2  # after "name=width:"
    if value is None or len(values) > 2:
        wrong_text = quoted(":".join(values[1:]))
        raise FieldError(f"{wrong_text} does not fit after a width; write signed, or the value of a constant", offset)
    if value >> bits:
        raise FieldError(f"{value:#x} does not fit into {bits} bits; write at most {(1 << bits) - 1:#x}", offset)
    if value > LARGEST:
        raise FieldError(f"{value:#x} is too large; write at most {LARGEST:#x}, or two constants", offset)
    if name in (POSITION, IN_TURN, TURNS):
        raise FieldError(f"'{name}' is not a constant; give the constant bits another name", offset)
    return NumberField(name=name, bits=bits, column=column, value=value)


def _read_flag(name: str, values: Sequence[str], column: int) -> FlagField:
    """Create a flag from its values: the active level, and optionally its effect on the position: ``low:error``.

    By default, the flags ``error`` and ``warning`` have the effect of the same name, and others have no effect, which
    is called ``status``.

    Raises:
        FieldError: There is no such effect.
    """
    level: Literal["low", "high"] = "low" if values[0] == "low" else "high"
    if len(values) > 1:
        effect = values[1]
    elif name in VERDICTS:
        effect = name
    else:
        effect = "status"
    if len(values) > 2 or effect not in VERDICTS:
        message = f"{quoted(':'.join(values[1:]))} is not an effect of a flag; write error, warning or status"
        offset = len(name) + len(values[0]) + 2  # after "name=low:"
        raise FieldError(message, offset)
    return FlagField(name=name, column=column, level=level, verdict=VERDICTS[effect])


def _flag_of_interface(name: str, column: int, interface: str) -> FlagField:
    """Create the flag ``error`` or ``warning`` with the active level that the interface defines: low over BiSS.

    Raises:
        FieldError: The interface defines no active level.
    """
    if interface != "biss":
        raise FieldError(f"'{name}' has no active level; write {name}=low or {name}=high")
    return FlagField(name=name, column=column, level="low", verdict=VERDICTS[name])


def _read_filler(name: Literal["zero", "unused"], values: Sequence[str], column: int) -> FillerField:
    """Create a field of zeros or unused bits from its only value, the width."""
    if len(values) != 1:
        raise FieldError(f"'{name}' takes only a width; write {name}=2 for two bits")
    width_text = values[0]
    return FillerField(name=name, bits=_read_width(name, width_text), column=column)


def _read_parity(values: Sequence[str], column: int) -> ParityField:
    """Create a parity bit from its only value, ``even`` or ``odd``."""
    if values == ["even"]:
        return ParityField("parity", column, "even")
    if values == ["odd"]:
        return ParityField("parity", column, "odd")
    raise FieldError("a parity bit is even or odd; write parity=even or parity=odd")


def _read_crc(values: Sequence[str], column: int, interface: str) -> CrcField:
    """Create a CRC from its values: width, polynomial, and optionally the start value, and words such as ``inverted``.

    By default, the start value is 0, and the CRC is inverted only over BiSS. Only over RS-485, the CRC can be
    ``reflected``, and have a byte order of its own.

    Raises:
        FieldError: The values are missing or wrong.
    """
    if len(values) < 2:
        raise FieldError("a CRC needs its width and polynomial; write crc=BITS:POLYNOMIAL, such as crc=6:0x43")
    width_text, *polynomial_and_start = values
    bits = _read_width("crc", width_text, _WIDEST_CRC)
    words: list[str] = []
    while polynomial_and_start and polynomial_and_start[-1] in _CRC_WORDS:
        words.append(polynomial_and_start.pop())
    _check_crc_words(words, bits, interface)
    is_inverted = "inverted" in words or (interface == "biss" and "plain" not in words)
    byte_orders = [word for word in words if word in BYTE_ORDERS]
    offset = len("crc=") + len(width_text) + 1  # after "crc=width:"
    if len(polynomial_and_start) not in (1, 2):
        raise FieldError(f"write crc=BITS:POLYNOMIAL:START, and after it {_CRC_WORDS_TEXT} if needed", offset)
    polynomial_text, *start_texts = polynomial_and_start
    poly = _read_polynomial(polynomial_text, bits, offset)
    init = number_in(start_texts[0]) if start_texts else 0
    highest = (1 << bits) - 1
    if init is None or init > highest:
        offset += len(polynomial_text) + 1
        raise FieldError(f"{quoted(start_texts[0])} is not a start value; write at most {highest:#x}", offset)
    return CrcField(
        name="crc",
        bits=bits,
        column=column,
        poly=poly,
        init=init,
        is_inverted=is_inverted,
        is_reflected="reflected" in words,
        byte_order=byte_orders[0] if byte_orders else "",
    )


def _check_crc_words(words: Sequence[str], bits: int, interface: str) -> None:
    """Check the words after the numbers of a CRC.

    Raises:
        FieldError: The interface or the width does not allow a word, or two words exclude each other.
    """
    for word in words:
        if words.count(word) > 1:
            raise FieldError(f"'{word}' is written twice; remove one of them")
        if word in BYTES_WORDS and interface != "rs485":
            raise FieldError(f"'{word}' is only for a CRC over RS-485, which consists of bytes; remove it")
        if word in BYTE_ORDERS and bits <= 8:
            raise FieldError(f"the CRC is one byte, so it has no byte order; remove '{word}'")
    for first_word, second_word in (("inverted", "plain"), BYTE_ORDERS):
        if first_word in words and second_word in words:
            raise FieldError(f"'{first_word}' and '{second_word}' exclude each other; remove one of them")


def _read_polynomial(polynomial_text: str, bits: int, offset: int) -> int:
    """Parse the polynomial of a CRC, and return it without its top bit: ``0x43`` for a 6-bit CRC is 3.

    The top bit may be omitted in the text. The lowest bit must be 1. ``offset`` is the index of the text in the field,
    for the error.

    Raises:
        FieldError: The text is not such a polynomial.
    """
    polynomial = number_in(polynomial_text)
    top_bit = 1 << bits
    highest = 2 * top_bit - 1
    is_even = polynomial is not None and polynomial % 2 == 0
    if polynomial is None or is_even or polynomial > highest:
        reason = f"write an odd number of at most {highest:#x}, with or without its top bit"
        raise FieldError(f"{quoted(polynomial_text)} is not a polynomial of {bits} bits; {reason}", offset)
    return polynomial & (top_bit - 1)
