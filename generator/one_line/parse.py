"""Read a line and report all of its problems, each with its column."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..language.problems import quoted, suggestion
from .checks import problems_of_fields, problems_of_options
from .fields import FieldError, read_field
from .line import POSITION, Line, LineError, LineField, LineProblem, Options
from .options import with_option

INTERFACES = ("biss", "ssi", "spi", "rs485")
#: Characters of the longest line, and the highest number of fields in a line.
LONGEST = 1000
_MOST_FIELDS = 64
_ALLOWED = re.compile(r"[A-Za-z0-9_=:,. ]*")
_BEGINNING = re.compile(rf"\s*({'|'.join(INTERFACES)})\s*[:,]", re.IGNORECASE)


def is_line(text: str) -> bool:
    """Return True if a text is meant as a line: order codes and names of families have no such characters."""
    return "=" in text or _BEGINNING.match(text) is not None


def parse_line(text: str) -> Line:
    """Return the encoder that a line describes. The functions that it calls add their problems to one list.

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
    return Line(text, interface, options, tuple(fields))


_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43"


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
            message = f"there is no colon after '{interface}' and its options; write {_EXAMPLE}"
            problems.append(LineProblem(len(text) + 1, message))
        return interface, len(head)
    is_field = "=" in word or interface in ("error", "warning", POSITION)
    if is_field or not colon:
        message = "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front of it"
        problems.append(LineProblem(1, message))
        return "biss", 0
    hint = suggestion(interface, INTERFACES, "write one of")
    problems.append(LineProblem(1, f"{quoted(word)} is not an interface{hint}"))
    return "biss", len(head)


def _split_at_commas(text: str, column: int) -> Iterator[tuple[int, str]]:
    """Yield the parts of a text between commas, each with the column of its first character that is not a space."""
    for piece in text.split(","):
        leading_spaces = len(piece) - len(piece.lstrip())
        yield column + (leading_spaces if piece.strip() else 0), piece.strip()
        column += len(piece) + 1


def _read_options(head: str, interface: str, problems: list[LineProblem]) -> tuple[Options, dict[str, int]]:
    """Return the options, and the column of each by its name. ``head`` is the line up to the colon."""
    options = Options()
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
        problems.append(LineProblem(column, f"the line has no fields; write {_EXAMPLE}"))
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
