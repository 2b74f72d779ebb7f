"""Read a line and report all of its problems, each with its column."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ..language.problems import quoted, suggestion
from .fields import FieldError, check_fields, read_field
from .line import IN_TURN, POSITION, Filler, Line, LineError, LineField, LineProblem, Number, Options, Parity
from .options import with_option

INTERFACES = ("biss", "ssi", "spi", "rs485")
#: Characters of the longest line, and the most fields in one.
LONGEST = 1000
_MOST_FIELDS = 64
_ALLOWED = re.compile(r"[A-Za-z0-9_=:,. ]*")
_BEGINNING = re.compile(rf"\s*({'|'.join(INTERFACES)})\s*[:,]", re.IGNORECASE)


def is_line(text: str) -> bool:
    """Return True if a text is meant as a line: order codes and names of families have no such characters."""
    return "=" in text or _BEGINNING.match(text) is not None


def parse_line(text: str) -> Line:
    """Return the encoder that a line describes.

    Raises:
        LineError: The line has problems.
    """
    text = text.strip()
    if len(text) > LONGEST:
        raise LineError(text[:LONGEST], [LineProblem(1, f"the line is longer than {LONGEST} characters; shorten it")])
    allowed = _ALLOWED.match(text)
    if allowed is not None and allowed.end() < len(text):
        message = f"{quoted(text[allowed.end()])} is not a character of a line; write {_EXAMPLE}"
        raise LineError(text, [LineProblem(allowed.end() + 1, message)])
    problems: list[LineProblem] = []
    interface, head_end = _interface(text, problems)
    options = _options(text[:head_end], interface, problems) if head_end else Options()
    fields_start = head_end + 1 if head_end else 0
    fields = _fields(text[fields_start:], fields_start + 1, interface, problems)
    problems += check_fields(fields, interface)
    problems += _problems_of_options(options, fields, interface)
    if problems:
        raise LineError(text, problems)
    return Line(text, interface, options, tuple(fields))


_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43"


def _interface(text: str, problems: list[LineProblem]) -> tuple[str, int]:
    """Return the interface, and the offset of the colon after its options, or 0 if the line begins with a field.

    A line without an interface is read as one for BiSS, to find its other problems.
    """
    head, colon, _ = text.partition(":")
    word = head.partition(",")[0].strip()
    interface = word.lower()
    if interface in INTERFACES:
        if not colon:
            message = f"there is no colon after '{interface}' and its options; write {_EXAMPLE}"
            problems.append(LineProblem(len(text) + 1, message))
        return interface, len(head) if colon else 0
    if "=" in word or word.lower() in ("error", "warning", POSITION) or not colon:
        message = "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front of it"
        problems.append(LineProblem(1, message))
        return "biss", 0
    hint = suggestion(interface, INTERFACES)
    problems.append(LineProblem(1, f"{quoted(word)} is not an interface{hint or '; write biss, ssi, spi or rs485'}"))
    return "biss", len(head)


def _pieces(text: str, column: int) -> Iterator[tuple[int, str]]:
    """Yield the parts of a text between commas, each with the column of its first character that is not a space."""
    for piece in text.split(","):
        leading_spaces = len(piece) - len(piece.lstrip())
        yield column + (leading_spaces if piece.strip() else 0), piece.strip()
        column += len(piece) + 1


def _options(head: str, interface: str, problems: list[LineProblem]) -> Options:
    options = Options()
    for column, piece in list(_pieces(head, 1))[1:]:
        try:
            options = with_option(options, piece, interface)
        except FieldError as error:
            problems.append(LineProblem(column + error.offset, str(error)))
    return options


def _fields(text: str, column: int, interface: str, problems: list[LineProblem]) -> list[LineField]:
    fields: list[LineField] = []
    if not text.strip():
        problems.append(LineProblem(column, f"the line has no fields; write {_EXAMPLE}"))
        return fields
    pieces = list(_pieces(text, column))
    if len(pieces) > _MOST_FIELDS:
        problems.append(LineProblem(pieces[_MOST_FIELDS][0], f"write at most {_MOST_FIELDS} fields"))
    for piece_column, piece in pieces[:_MOST_FIELDS]:
        try:
            fields.append(read_field(piece, piece_column, interface))
        except FieldError as error:
            problems.append(LineProblem(piece_column + error.offset, str(error)))
    return fields


def _problems_of_options(options: Options, fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the problems of options that do not fit the fields."""
    position = [field for field in fields if field.name in (POSITION, IN_TURN)]
    if options.is_gray and not position:
        yield LineProblem(1, "'gray' needs a position; add position=BITS, or remove gray")
    if options.is_gray:
        for field in fields:
            if isinstance(field, Parity):
                message = "the parity over a Gray code is not supported; write its bit as unused=1"
                yield LineProblem(field.column, message)
    for name, value in (("counts", options.counts), ("turns", options.turns)):
        if value and not any(field.name == POSITION for field in position):
            yield LineProblem(1, f"'{name}' needs a field 'position'; singleturn and multiturn already give it")
    if options.turns and not options.counts:
        yield LineProblem(1, "'turns' needs 'counts', the counts per revolution; add counts=NUMBER")
    yield from _problems_of_byte_order(options, fields, interface)


def _problems_of_byte_order(options: Options, fields: Sequence[LineField], interface: str) -> Iterator[LineProblem]:
    """Yield the numbers of several bytes whose byte order is not known, or that do not begin with a byte."""
    place = 0
    for field in fields:
        is_wide = field.bits > 8 and not isinstance(field, Filler)
        if interface == "rs485" and is_wide and not options.byte_order:
            message = f"the byte order of '{field.name}' is not known; write rs485,low_byte_first: or high_byte_first"
            yield LineProblem(field.column, message)
        is_split = interface == "spi" and options.byte_order == "low_byte_first" and isinstance(field, Number)
        if is_split and field.bits > 8 and (place % 8 or field.bits % 8):
            message = f"'{field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits"
            yield LineProblem(field.column, message)
        place += field.bits
