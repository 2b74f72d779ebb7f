"""Read a line with its options, and report all of its problems, each with its column."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..language.problems import join_words, quoted, suggest_word
from ..model.key_types import LARGEST
from .checks import problems_of_fields, problems_of_options
from .fields import FieldError, number_in, read_field
from .line import POSITION, EncoderLine, LineError, LineField, LineOptions, LineProblem

INTERFACES = ("biss", "ssi", "spi", "rs485")
#: Characters of the longest line, and the highest number of fields in a line.
LONGEST = 1000
_MOST_FIELDS = 64
_ALLOWED_CHARACTERS = re.compile(r"[A-Za-z0-9_=:,. ]*")
_INTERFACE_BEGINNING = re.compile(rf"\s*({'|'.join(INTERFACES)})\s*[:,]", re.IGNORECASE)
_FREQUENCY_TEXT = re.compile(r"([0-9]{1,12})([.][0-9]{1,6})?(|k|M)(?:Hz)?")
_PREFIX_FACTORS = {"": 1, "k": 1_000, "M": 1_000_000}
#: Most bytes of the request in a line.
_LONGEST_REQUEST = 8

#: Options without a value: the interfaces that have them, and the members that they set.
_WORDS: Mapping[str, tuple[tuple[str, ...], Mapping[str, Any]]] = {
    "gray": (("biss", "ssi", "spi"), {"is_gray": True}),
    "binary": (("biss", "ssi", "spi", "rs485"), {"is_gray": False}),
    "left": (("ssi",), {"alignment": "msb_left"}),
    "right": (("ssi",), {"alignment": "lsb_right"}),
    "low_byte_first": (("spi", "rs485"), {"byte_order": "low_byte_first"}),
    "high_byte_first": (("spi", "rs485"), {"byte_order": "high_byte_first"}),
}


def is_line(text: str) -> bool:
    """Return True if a text is meant as a line: order codes and names of families have no such characters."""
    return "=" in text or _INTERFACE_BEGINNING.match(text) is not None


def parse_line(text: str) -> EncoderLine:
    """Return the encoder that a line describes. The functions that it calls add their problems to one list.

    Raises:
        LineError: The line has problems.
    """
    text = text.strip()
    if len(text) > LONGEST:
        raise LineError(text[:LONGEST], [LineProblem(1, f"the line is longer than {LONGEST} characters; shorten it")])
    allowed = _ALLOWED_CHARACTERS.match(text)
    if allowed is not None and allowed.end() < len(text):
        message = f"{quoted(text[allowed.end()])} is not a character of a line; write {_LINE_EXAMPLE}"
        raise LineError(text, [LineProblem(allowed.end() + 1, message)])
    problems: list[LineProblem] = []
    interface, head_end = _read_interface(text, problems)
    options, option_columns = _read_options(text[:head_end], interface, problems)
    fields_start = head_end + 1 if head_end else 0  # after the colon
    has_fields = fields_start <= len(text)  # False without a colon, which is a problem already.
    fields = _read_fields(text[fields_start:], fields_start + 1, interface, problems) if has_fields else []
    if fields:
        problems += problems_of_fields(fields, interface)
        problems += problems_of_options(options, option_columns, fields, interface)
    if problems:
        raise LineError(text, problems)
    return EncoderLine(text, interface, options, tuple(fields))


_LINE_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43"


def _read_interface(text: str, problems: list[LineProblem]) -> tuple[str, int]:
    """Return the interface, and the offset of the colon after its options, or 0 if the line begins with a field.

    Without a colon, the offset is the end of a line that begins with an interface. A line without an interface is read
    as one for BiSS, to find its other problems.
    """
    head, colon, _ = text.partition(":")
    word = head.partition(",")[0].strip()
    interface = word.lower()
    if interface in INTERFACES:
        if not colon:
            message = f"there is no colon after '{interface}' and its options; write {_LINE_EXAMPLE}"
            problems.append(LineProblem(len(text) + 1, message))
        return interface, len(head)
    is_field = "=" in word or interface in ("error", "warning", POSITION)
    if is_field or not colon:
        message = "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front of it"
        problems.append(LineProblem(1, message))
        return "biss", 0
    hint = suggest_word(interface, INTERFACES, "write one of")
    problems.append(LineProblem(1, f"{quoted(word)} is not an interface{hint}"))
    return "biss", len(head)


def _split_at_commas(text: str, column: int) -> Iterator[tuple[int, str]]:
    """Yield the parts of a text between commas, each with the column of its first character that is not a space."""
    for piece in text.split(","):
        leading_spaces = len(piece) - len(piece.lstrip())
        yield column + (leading_spaces if piece.strip() else 0), piece.strip()
        column += len(piece) + 1


def _read_options(head: str, interface: str, problems: list[LineProblem]) -> tuple[LineOptions, dict[str, int]]:
    """Return the options, and the column of each by its name. ``head`` is the line up to the colon."""
    options = LineOptions()
    columns: dict[str, int] = {}
    for column, piece in list(_split_at_commas(head, 1))[1:]:  # The first one is the interface.
        try:
            options = with_option(options, piece, interface)
            columns[piece.partition("=")[0].strip()] = column
        except FieldError as error:
            problems.append(LineProblem(column + error.offset, str(error)))
    return options, columns


def _read_fields(text: str, column: int, interface: str, problems: list[LineProblem]) -> list[LineField]:
    """Return the valid fields, and report the invalid fields in ``problems``.

    ``column`` is the column of the first character.
    """
    fields: list[LineField] = []
    if not text.strip():
        problems.append(LineProblem(column, f"the line has no fields; write {_LINE_EXAMPLE}"))
        return fields
    pieces = list(_split_at_commas(text, column))
    if len(pieces) > _MOST_FIELDS:
        problems.append(LineProblem(pieces[_MOST_FIELDS][0], f"write at most {_MOST_FIELDS} fields"))
    for piece_column, piece in pieces[:_MOST_FIELDS]:
        try:
            fields.append(read_field(piece, piece_column, interface))
        except FieldError as error:
            problems.append(LineProblem(piece_column + error.offset, str(error)))
    return fields


def _read_frequency(option_text: str) -> int | None:
    """Return the frequency in Hz of a text such as ``1.5MHz`` or ``800k``, or None if it is not 1 Hz to 1 GHz."""
    match = _FREQUENCY_TEXT.fullmatch(option_text)
    if match is None:
        return None
    hertz = float(match[1] + (match[2] or "")) * _PREFIX_FACTORS[match[3]]
    return round(hertz) if 1 <= hertz <= 1_000_000_000 else None


def _read_spi_mode(option_text: str) -> int | None:
    return int(option_text) if option_text in ("0", "1", "2", "3") else None


def _read_positive_number(option_text: str) -> int | None:
    """Return the number in a text, or None if it is 0, too large, or not a number."""
    number = number_in(option_text)
    is_too_large = number is not None and number >= 1 << 63
    return number if number and not is_too_large else None


def _read_hex_bytes(option_text: str) -> bytes | None:
    """Return the bytes of a text such as ``1A`` or ``0x1A02``, or None if it has other characters or is too large."""
    digits = option_text.removeprefix("0x")
    if not re.fullmatch(r"(?:[0-9A-Fa-f]{2})+", digits) or len(digits) > 2 * _LONGEST_REQUEST:
        return None
    request = bytes.fromhex(digits)
    return request if int.from_bytes(request, "big") <= LARGEST else None


#: Options with a value: the interfaces that have them, the member, its reader, and an example.
_SETTINGS: Mapping[str, tuple[tuple[str, ...], str, Callable[[str], Any], str]] = {
    "clock": (("biss", "ssi", "spi"), "clock_hz", _read_frequency, "clock=1MHz"),
    "mode": (("spi",), "mode", _read_spi_mode, "mode=1"),
    "baud": (("rs485",), "baud", _read_positive_number, "baud=2500000"),
    "request": (("rs485",), "request", _read_hex_bytes, "request=1A"),
    "counts": (("biss", "ssi", "spi", "rs485"), "counts", _read_positive_number, "counts=4096"),
    "turns": (("biss", "ssi", "spi", "rs485"), "turns", _read_positive_number, "turns=4096"),
}


def with_option(options: LineOptions, text: str, interface: str) -> LineOptions:
    """Return the options with one more, such as ``gray`` or ``clock=1MHz``. Without an interface, each option is valid.

    Raises:
        FieldError: There is no such option, or not for this interface, or its value is wrong.
    """
    name, equals, value_text = text.partition("=")
    name = name.strip()
    value_text = value_text.strip()
    is_word = name in _WORDS
    if not is_word and name not in _SETTINGS:
        known_names = [*_WORDS, *_SETTINGS]
        hint = suggest_word(name, known_names) or f"; write {join_words(known_names, 'or')}"
        raise FieldError(f"{quoted(name)} is not an option{hint} (a field belongs after the colon)")
    interfaces, *_ = _WORDS[name] if is_word else _SETTINGS[name]
    if interface and interface not in interfaces:
        raise FieldError(f"'{name}' is not an option of {interface}, only of {join_words(interfaces)}; remove it")
    if is_word:
        if equals:
            raise FieldError(f"'{name}' has no value; write only {name}", len(name))
        _, changed_members = _WORDS[name]
        return replace(options, **changed_members)
    _, member, read_value, example = _SETTINGS[name]
    value = read_value(value_text)
    if value is None:
        offset = len(name) + 1  # after "name="
        raise FieldError(f"{quoted(value_text)} is not a value of '{name}'; write it like {example}", offset)
    return replace(options, **{member: value})
