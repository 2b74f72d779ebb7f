"""Read a line with its options, and report all of its problems by column, also of fields that do not fit together."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ..language.problems import join_words, quoted, suggest_word
from ..loading.measurement_checks import is_probably_highest
from ..model.expressions import is_power_of_two
from ..model.keys_and_members import LARGEST
from .fields import WIDEST, FieldError, number_in, read_field
from .line import (
    IN_TURN,
    POSITION,
    TURNS,
    CrcField,
    EncoderLine,
    FillerField,
    LineError,
    LineField,
    LineOptions,
    LineProblem,
    NumberField,
    ParityField,
)

#: Maximum number of bits of an RS-485 frame.
_MOST_BITS_OF_BYTES = 1024


def problems_of_fields(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of fields that are valid individually but not together, such as two with the same name."""
    names: set[str] = set()
    for field in fields:
        if not isinstance(field, FillerField) and field.name in names:
            yield LineProblem(field.column, f"a second field has the name '{field.name}'; rename one of them")
        names.add(field.name)
        if isinstance(field, CrcField) and field is not fields[-1]:
            yield LineProblem(field.column, "the CRC must be the last field; move it to the end")
        if isinstance(field, CrcField) and interface == "rs485" and field.bits % 8:
            yield LineProblem(field.column, f"the CRC has {field.bits} bits; over RS-485, write whole bytes")
        has_changing_field = any(_can_change(other_field) for other_field in fields)
        if isinstance(field, ParityField) and not has_changing_field:
            yield LineProblem(field.column, "a parity bit needs other fields that change; add them")
    yield from _problems_of_position(fields, interface)
    yield from _problems_of_length(fields, interface)


def _can_change(field: LineField) -> bool:
    """Return whether a field can differ between frames, not counting CRCs and parity bits."""
    is_constant_number = isinstance(field, NumberField) and field.value is not None
    is_constant = is_constant_number or field.name == "zero"
    is_check = isinstance(field, ParityField | CrcField)
    return not is_constant and not is_check


def _problems_of_position(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of the fields that form the position.

    It is either one field, ``position``, or ``multiturn`` followed by ``singleturn``.
    """
    index_by_name = {field.name: index for index, field in enumerate(fields)}
    if POSITION in index_by_name and (TURNS in index_by_name or IN_TURN in index_by_name):
        message = "'position' is the whole position; write either it, or multiturn and singleturn"
        yield LineProblem(fields[index_by_name[POSITION]].column, message)
    if TURNS not in index_by_name:
        return
    column = fields[index_by_name[TURNS]].column
    if IN_TURN not in index_by_name:
        yield LineProblem(column, "'multiturn' needs 'singleturn'; add singleturn=BITS")
    elif index_by_name[TURNS] > index_by_name[IN_TURN] and interface != "rs485":
        yield LineProblem(column, "'multiturn' must be before 'singleturn'; swap the two, or write position=BITS")


def _problems_of_length(fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield a problem if the frame has more or fewer bits than the interface allows, or incomplete bytes."""
    if not fields:
        return
    bits = sum(field.bits for field in fields)
    fewest_bits = 8 if interface in ("spi", "rs485") else 1
    most_bits = _MOST_BITS_OF_BYTES if interface == "rs485" else WIDEST
    if not fewest_bits <= bits <= most_bits:
        yield LineProblem(fields[0].column, f"the fields have {bits} bits; write {fewest_bits} to {most_bits}")
    elif interface == "rs485" and bits % 8:
        yield LineProblem(fields[0].column, f"the fields have {bits} bits; over RS-485, write whole bytes")


def problems_of_options(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField], interface: str
) -> Iterator[LineProblem]:
    """Yield the problems of options that contradict the fields. ``columns`` has the column of each option by name."""
    if options.is_gray:
        yield from _problems_of_gray(options, columns, fields)
    if options.counts or options.turns:
        yield from _problems_of_counts(options, columns, fields)
    yield from _problems_of_byte_order(options, fields, interface)


def _problems_of_gray(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField]
) -> Iterator[LineProblem]:
    """Yield the problems of the option ``gray``.

    Gray code needs a position that is unsigned, has several bits, and is one number without other fields in between.
    """
    column = columns.get("gray", 1)
    positions = [field for field in fields if field.name in (POSITION, IN_TURN)]
    if not positions:
        yield LineProblem(column, "'gray' needs a position; add position=BITS, or remove gray")
    names = [field.name for field in fields]
    has_turns = TURNS in names
    # The wrong order of the two is reported separately.
    if has_turns and IN_TURN in names and names.index(IN_TURN) > names.index(TURNS) + 1:
        message = "with gray, 'singleturn' must follow 'multiturn' directly; move the fields between them"
        yield LineProblem(fields[names.index(IN_TURN)].column, message)
    for field in positions:
        if field.bits == 1 and not has_turns:
            yield LineProblem(field.column, f"'{field.name}' has one bit, which is the same in Gray code; remove gray")
        if isinstance(field, NumberField) and field.is_signed:
            yield LineProblem(field.column, f"'{field.name}' is signed, and Gray code is not; remove one of the two")
    if options.counts and not is_power_of_two(options.counts):
        message = f"Gray code with {options.counts} counts (Gray excess) is not supported; remove gray and counts"
        yield LineProblem(columns.get("counts", 1), f"{message}, and convert the number in your program")


def _problems_of_counts(
    options: LineOptions, columns: Mapping[str, int], fields: Sequence[LineField]
) -> Iterator[LineProblem]:
    """Yield the problems of the options ``counts`` (per revolution) and ``turns`` (number of revolutions)."""
    column = columns.get("counts", columns.get("turns", 1))
    positions = [field for field in fields if isinstance(field, NumberField) and field.name == POSITION]
    if not positions:
        message = "'counts' and 'turns' need a field 'position'; singleturn and multiturn already give them"
        yield LineProblem(column, message)
    if options.turns and not options.counts:
        yield LineProblem(columns.get("turns", 1), "'turns' needs the counts per revolution; add counts=NUMBER")
    for name, count in (("counts", options.counts), ("turns", options.turns)):
        if is_probably_highest(count):
            message = f"{count} is the highest value; including 0 there are {count + 1}, so write {name}={count + 1}"
            yield LineProblem(columns.get(name, 1), message)
    turns = options.turns or 1
    total_counts = options.counts * turns
    for field in positions:
        number_of_values = 1 << field.bits
        if total_counts > number_of_values:
            message = f"{options.counts} counts × {turns} turns do not fit into {field.bits} bits"
            yield LineProblem(column, f"{message}; write at most {number_of_values} counts in all")
        if field.is_signed:
            message = "a signed position has no counts in a line; remove counts, and add its range to the spec"
            yield LineProblem(column, message)


def _problems_of_byte_order(options: LineOptions, fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of numbers of more than one byte.

    Over RS-485, their byte order must be known. Over SPI, a number that is sent low byte first must be whole bytes.
    """
    is_low_byte_first_spi = interface == "spi" and options.byte_order == "low_byte_first"
    bits_before_field = 0
    for field in fields:
        has_several_bytes = field.bits > 8 and not isinstance(field, FillerField)
        has_own_order = isinstance(field, CrcField) and field.byte_order != ""
        if interface == "rs485" and has_several_bytes and not (options.byte_order or has_own_order):
            message = f"the byte order of '{field.name}' is not known; write rs485,low_byte_first: or high_byte_first"
            yield LineProblem(field.column, message)
        if is_low_byte_first_spi and has_several_bytes and isinstance(field, NumberField):
            yield from _problems_of_swapped_number(field, bits_before_field)
        bits_before_field += field.bits


def _problems_of_swapped_number(field: NumberField, bits_before: int) -> Iterator[LineProblem]:
    """Yield the problems of a number of several bytes that is sent low byte first over SPI.

    It must be an unsigned number of whole bytes that begins after ``bits_before`` bits, whole bytes as well.
    """
    is_whole_bytes = bits_before % 8 == 0 and field.bits % 8 == 0
    if not is_whole_bytes:
        message = f"'{field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits"
        yield LineProblem(field.column, message)
    is_constant = field.value is not None
    if field.is_signed or is_constant:
        message = f"'{field.name}' is signed or a constant, and cannot be sent low byte first; write its bytes"
        yield LineProblem(field.column, message)


INTERFACES = ("biss", "ssi", "spi", "rs485")
#: Maximum number of characters, and maximum number of fields in a line.
LONGEST = 1000
_MOST_FIELDS = 64
_ALLOWED_CHARACTERS = re.compile(r"[A-Za-z0-9_=:,. ]*")
_INTERFACE_BEGINNING = re.compile(rf"\s*({'|'.join(INTERFACES)})\s*[:,]", re.IGNORECASE)
_FREQUENCY_TEXT = re.compile(r"([0-9]{1,12})([.][0-9]{1,6})?(|k|M)(?:Hz)?")
_PREFIX_FACTORS = {"": 1, "k": 1_000, "M": 1_000_000}
#: Maximum number of bytes of the request in a line.
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
    """Return whether a text is meant to be a line, and not an order code or the name of a family.

    Only a line contains an equal sign, or begins with an interface and a colon or comma.
    """
    begins_with_interface = _INTERFACE_BEGINNING.match(text) is not None
    return "=" in text or begins_with_interface


def parse_line(text: str) -> EncoderLine:
    """Parse a line, such as ``biss:position=32,error,warning,crc=6:0x43``, and return the encoder that it describes.

    Raises:
        LineError: The line has problems. The error lists all of them.
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
    lacks_colon = fields_start > len(text)  # Already reported as a problem.
    fields: list[LineField] = []
    if not lacks_colon:
        fields = _read_fields(text[fields_start:], fields_start + 1, interface, problems)
    if fields:
        problems += problems_of_fields(fields, interface)
        problems += problems_of_options(options, option_columns, fields, interface)
    if problems:
        raise LineError(text, problems)
    return EncoderLine(text, interface, options, tuple(fields))


_LINE_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43"


def _read_interface(text: str, problems: list[LineProblem]) -> tuple[str, int]:
    """Return the interface of a line, and the index of the colon after its options, and append ``problems``.

    The index is 0 if the line begins with a field, and the end of the line if the colon is missing. A line without an
    interface is treated as a BiSS line, so that its other problems are also found.
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
    """Yield the parts of a text between commas without surrounding spaces, each with its column.

    ``column`` is the column of the text in the line.
    """
    for piece in text.split(","):
        stripped_piece = piece.strip()
        leading_spaces = len(piece) - len(piece.lstrip()) if stripped_piece else 0
        yield column + leading_spaces, stripped_piece
        column += len(piece) + 1  # The comma is one character.


def _read_options(head: str, interface: str, problems: list[LineProblem]) -> tuple[LineOptions, dict[str, int]]:
    """Return the options of a line, and the column of each by its name, and append ``problems``.

    ``head`` is the line up to the colon: the interface, followed by the options.
    """
    options = LineOptions()
    column_by_option: dict[str, int] = {}
    _, *option_texts = _split_at_commas(head, column=1)
    for column, option_text in option_texts:
        try:
            options = with_option(options, option_text, interface)
            name = option_text.partition("=")[0].strip()
            column_by_option[name] = column
        except FieldError as error:
            problems.append(LineProblem(column + error.offset, str(error)))
    return options, column_by_option


def _read_fields(text: str, column: int, interface: str, problems: list[LineProblem]) -> list[LineField]:
    """Return the valid fields in a text such as ``position=32,error``, and append ``problems`` for invalid ones.

    ``column`` is the column of the text in the line.
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
    """Parse a frequency such as ``1.5MHz`` or ``800k``, and return it in Hz.

    Return None if the text is not a frequency from 1 Hz to 1 GHz.
    """
    match = _FREQUENCY_TEXT.fullmatch(option_text)
    if match is None:
        return None
    whole_part, decimals, prefix = match.groups(default="")
    hertz = float(whole_part + decimals) * _PREFIX_FACTORS[prefix]
    return round(hertz) if 1 <= hertz <= 1_000_000_000 else None


def _read_spi_mode(option_text: str) -> int | None:
    """Parse the mode of SPI, from 0 to 3, or return None for any other text."""
    return int(option_text) if option_text in ("0", "1", "2", "3") else None


def _read_positive_number(option_text: str) -> int | None:
    """Parse a number from 1 to 2^63 - 1, or return None for any other text."""
    number = number_in(option_text)
    if number is None or not 0 < number < 1 << 63:
        return None
    return number


def _read_hex_bytes(option_text: str) -> bytes | None:
    """Parse bytes such as ``1A`` or ``0x1A02``, or return None if the text is not hexadecimal or is too long."""
    digits = option_text.removeprefix("0x")
    is_hexadecimal = re.fullmatch(r"(?:[0-9A-Fa-f]{2})+", digits) is not None
    if not is_hexadecimal or len(digits) > 2 * _LONGEST_REQUEST:
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
    """Return the options with one more option, such as ``gray`` or ``clock=1MHz``.

    If ``interface`` is empty, the options of all interfaces are accepted.

    Raises:
        FieldError: The option does not exist, does not exist for this interface, or has a wrong value.
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
