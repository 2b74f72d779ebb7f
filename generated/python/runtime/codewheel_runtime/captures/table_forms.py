# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Recognizes the form of a table of samples: its separator, its channels, and the unit of its times."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Final, NamedTuple

from ..errors import InputError

#: Limit for the size of a header.
HEADER: Final = 1 << 16
HINT: Final = (
    "expected a sigrok session or CSV, a Saleae CSV or binary file, VCD, a table of 0 and 1 or of voltages, "
    "or a NumPy file"
)
#: Units of time in seconds.
UNITS: Final = {
    "s": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "µs": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nanoseconds": 1e-9, "ps": 1e-12, "picoseconds": 1e-12, "fs": 1e-15, "femtoseconds": 1e-15,
}  # fmt: skip
#: ISO 8601 time stamp without its time zone, as in Saleae CSV files.
STAMP: Final = re.compile(rb"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:\.\d{1,12})?")

_TIME_HEADING: Final = re.compile(r"(?:(?:time|zeit)\s*)?[\[(]?(?P<unit>[a-zµ]*)[\])]?", re.IGNORECASE)
#: Names of a column that contains the sample number.
_NAMES_OF_SAMPLE_NUMBERS: Final = ("sample", "samples", "sample number", "index", "no", "no.", "nr", "#", "sequence")
#: Marks of a comment at the beginning of a line.
_COMMENT_MARKS: Final = (";", "#")
#: Number of rows that is enough to recognize sample numbers.
_FIRST_ROWS: Final = 4
#: Maximum number of digits in a sample number. Python does not convert text with thousands of digits.
_MOST_DIGITS: Final = 18
#: A decimal comma: a comma between two digits.
_DECIMAL_COMMA: Final = re.compile(r"(?<=\d),(?=\d)")
#: Name of the column whose unit is the time between two samples in seconds, as written by Rigol oscilloscopes.
_INCREMENT_COLUMN: Final = "increment"
_SMALLEST_INCREMENT: Final = 1e-300
_RATE_IN_HEADER: Final = re.compile(r"\s*([0-9]{1,12}(?:\.[0-9]{1,9})?)\s*([kKMG]?)(?:Hz|S/s|Sa/s)?\s*")
_UNIT_PREFIXES: Final = {"": 1.0, "k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9}


class TableForm(NamedTuple):
    """Form of a table.

    Attributes:
        delimiter: Separator of the cells. None if it is white space.
        channels: Names of the channels, or their numbers from 1.
        unit: Unit of the time column in seconds. None if there is no such column, and 0 if its times are not used.
        rate: Sample rate in Hz, if the file contains it.
        skipped: Number of lines before the first row.
        is_stamped: True if times are time stamps, which are converted to seconds from the first stamp.
        has_decimal_commas: True if numbers are written like ``0,5``.
    """

    delimiter: str | None
    channels: list[str]
    unit: float | None
    rate: float | None
    skipped: int
    is_stamped: bool
    has_decimal_commas: bool

    @property
    def has_times(self) -> bool:
        """True if the first column has times that are used."""
        return self.unit is not None and self.unit > 0

    @property
    def columns_before_channels(self) -> int:
        """Number of columns before the channels: 1 for times or sample numbers, otherwise 0."""
        return 0 if self.unit is None else 1


class _Headers(NamedTuple):
    """Headers of a table.

    Attributes:
        names: Names of the columns, or None without a header.
        units: Units of the columns, or None without a second header.
        line_count: Number of lines before the first row, without comments and empty lines.
    """

    names: list[str] | None
    units: list[str] | None
    line_count: int


def parse_rate(text: str) -> float | None:
    """Return a sample rate such as ``24 MHz`` in samples per second.

    Return None if the text is not a rate, or if the rate is 0.
    """
    match = _RATE_IN_HEADER.fullmatch(text)
    if match is None:
        return None
    number, prefix = match.groups()
    rate = float(number) * _UNIT_PREFIXES[prefix]
    return rate if rate > 0 else None


def find_table_form(path: str, first_bytes: bytes) -> TableForm:
    """Return the form of a table according to its first lines: comments, headers, and rows.

    Raises:
        InputError: The file is not a table.
    """
    if len(first_bytes) == HEADER and b"\n" not in first_bytes:
        raise InputError(path, "a line is too long: this is not a capture")
    lines = first_bytes.decode("utf-8-sig", "replace").splitlines()
    comments = [line.lstrip("; #") for line in lines if line.startswith(_COMMENT_MARKS)]
    table_lines = [line for line in lines if line.strip() and not line.startswith(_COMMENT_MARKS)]
    if not table_lines:
        raise InputError(path, f"this is not a capture: {HINT}")
    delimiter = _find_delimiter(table_lines)
    has_decimal_commas = delimiter != "," and any(map(_DECIMAL_COMMA.search, table_lines))
    if has_decimal_commas:
        table_lines = [_DECIMAL_COMMA.sub(".", line) for line in table_lines]
    cells_by_line = [_split_cells(line, delimiter) for line in table_lines]
    headers = _find_headers(cells_by_line)
    if headers is None:
        raise InputError(path, f"this is not a capture: {HINT}")
    rows = cells_by_line[headers.line_count :]
    first_rows = rows[:_FIRST_ROWS]
    has_cells = bool(first_rows and first_rows[0])
    is_stamped = has_cells and _is_stamp(first_rows[0][0])
    # Time stamps are converted to seconds.
    unit = 1.0 if is_stamped else _find_time_unit(headers, first_rows)
    has_time_column = unit is not None
    rate_in_comments = parse_rate(_find_comment(comments, "Samplerate"))
    offset_of_first_row = _find_first_row(first_bytes, headers.line_count)
    return TableForm(
        delimiter=delimiter,
        channels=_name_channels(headers, comments, first_rows or cells_by_line, has_time_column),
        unit=unit,
        rate=rate_in_comments or _find_increment_rate(headers),
        skipped=first_bytes.count(b"\n", 0, offset_of_first_row),
        is_stamped=is_stamped,
        has_decimal_commas=has_decimal_commas,
    )


def _find_delimiter(lines: Sequence[str]) -> str | None:
    """Return the separator of the cells, or None for white space.

    A comma counts only if there is no other separator, because it can be a decimal comma. The last line may be cut off,
    and the first lines can be titles, so the second-to-last line is examined, or the first of at most two lines.
    """
    sample_line = lines[-2] if len(lines) > 2 else lines[0]
    return next((mark for mark in ";\t," if mark in sample_line), None)


def _find_headers(cells_by_line: Sequence[list[str]]) -> _Headers | None:
    """Return the headers of a table from the cells of its first lines, or None if the lines are not a table.

    A line of units can follow the names of the columns. Oscilloscopes also write settings, line by line, before the
    names. The lines are not a table if there are several but no row follows them, or if the last header has fewer
    cells than the first row.
    """
    row_indices = (index for index, cells in enumerate(cells_by_line) if _is_row(cells))
    line_count = next(row_indices, len(cells_by_line))
    if not line_count:
        return _Headers(names=None, units=None, line_count=0)
    has_rows = line_count < len(cells_by_line)
    if not has_rows:
        # A capture can end after its header.
        return _Headers(names=cells_by_line[0], units=None, line_count=1) if line_count == 1 else None
    column_count = len(cells_by_line[line_count])
    last_header = cells_by_line[line_count - 1]
    if len(last_header) < column_count:
        return None
    if line_count > 1:
        line_before = cells_by_line[line_count - 2]
        # If the last header begins with the name of a time column, it has the names, and a setting precedes it.
        has_names_before_units = len(line_before) >= column_count and not _is_time(last_header[0])
        if has_names_before_units:
            return _Headers(names=line_before, units=last_header, line_count=line_count)
    return _Headers(names=last_header, units=None, line_count=line_count)


def _is_time(name: str) -> bool:
    """Return whether a name denotes a time column, such as ``TIME`` or ``Time (s)``, and is not just a unit."""
    return name.strip().lower().startswith(("time", "zeit"))


def _name_channels(
    headers: _Headers, comments: Sequence[str], first_rows: Sequence[list[str]], has_times: bool
) -> list[str]:
    """Return the names of the channels: from a comment of sigrok, from the header, or numbers from 1.

    The names in a comment are used only if there is one for each channel. ``comments`` are lines without the comment
    mark. ``first_rows`` are the cells of some rows, the first of which shows the number of channels.
    ``has_times`` is True if a column of times or of numbers precedes the channels.
    """
    first_channel = int(has_times)
    column_count = len(first_rows[0])
    channels = [str(number) for number in range(1, column_count - first_channel + 1)]
    if headers.names is not None:
        channels = headers.names[first_channel:column_count]
    labels = [label.strip() for label in _find_comment(comments, "Channels").split(",") if label.strip()]
    return labels if len(labels) == len(channels) else channels


def _find_time_unit(headers: _Headers, first_rows: Sequence[list[str]]) -> float | None:
    """Return the unit of the times in the first column, in seconds.

    It is None if there is no such column, and 0 if its times are not used, as for sample numbers.
    """
    unit: float | None = None
    if headers.names is not None:
        first_header = headers.names[0] if headers.units is None else headers.units[0]
        unit = _find_unit(first_header)
    if unit is None and _are_numbered(first_rows):
        return 0.0
    # A name such as ``TIME`` has no unit. Times with fractions are then seconds.
    is_named_time = headers.names is not None and _is_time(headers.names[0])
    if unit == 0 and is_named_time and _have_fractions(first_rows):
        return 1.0
    return unit


def _have_fractions(first_rows: Sequence[list[str]]) -> bool:
    """Return whether the first cells have a decimal point."""
    return bool(first_rows) and all("." in row[0] for row in first_rows if row)


def _find_increment_rate(headers: _Headers) -> float | None:
    """Return the sample rate from the column ``Increment``, or None without this column.

    The unit of this column is a number: the time between two samples in seconds.
    """
    if headers.names is None or headers.units is None:
        return None
    for name, unit in zip(headers.names, headers.units, strict=False):
        # The inverse of a smaller number is infinite.
        if name.lower() == _INCREMENT_COLUMN and _is_number(unit) and float(unit) > _SMALLEST_INCREMENT:
            return 1 / float(unit)
    return None


def _is_row(cells: Sequence[str]) -> bool:
    """Return whether the cells can form a row: numbers, a time stamp in front, or X for a channel that was off."""
    if not cells:
        return False
    for index, cell in enumerate(cells):
        is_value = _is_number(cell) or cell == "X"
        is_stamp_in_front = index == 0 and _is_stamp(cell)
        if not is_value and not is_stamp_in_front:
            return False
    return True


def _is_stamp(cell: str) -> bool:
    """Return whether a cell begins with a time stamp."""
    return STAMP.match(cell.encode()) is not None


def _is_number(text: str) -> bool:
    """Return whether a cell is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _are_numbered(rows: Sequence[list[str]]) -> bool:
    """Return whether the first cells of four or more rows are successive numbers, such as sample numbers.

    Rows with a single cell are ignored.
    """
    first_cells = [row[0] for row in rows if len(row) > 1]
    are_short = all(len(cell) <= _MOST_DIGITS for cell in first_cells)
    are_decimal = all(cell.isascii() and cell.isdigit() for cell in first_cells)
    if len(first_cells) < _FIRST_ROWS or not are_short or not are_decimal:
        return False
    first_number = int(first_cells[0])
    return [int(cell) for cell in first_cells] == [*range(first_number, first_number + len(first_cells))]


def _find_comment(comments: Sequence[str], name: str) -> str:
    """Return the text after the colon of the first comment that begins with ``name``, or an empty string.

    For the name ``Samplerate`` and the comment ``Samplerate: 24 MHz``, this is `` 24 MHz``.
    """
    for comment in comments:
        if comment.startswith(name):
            _, _, text = comment.partition(":")
            return text
    return ""


def _find_first_row(first_bytes: bytes, header_count: int) -> int:
    """Return the offset in bytes of the first row of a table, after its headers, comments and empty lines.

    Without a row, this is the length of ``first_bytes``.
    """
    offset = 0
    headers_left = header_count
    for line in io.BytesIO(first_bytes):
        # A byte order mark can precede the first line.
        is_comment = not line.strip() or line.lstrip(b"\xef\xbb\xbf")[:1] in (b";", b"#")
        if not is_comment:
            if not headers_left:
                return offset
            headers_left -= 1
        offset += len(line)
    return offset


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Return the cells of a line, without surrounding spaces and quotes, and without trailing empty cells."""
    cells = [cell.strip().strip('"') for cell in line.split(delimiter)]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _find_unit(header: str) -> float | None:
    """Return the unit of the first column in seconds, according to its header, such as ``Time [ms]``.

    It is 0 for a column of sample numbers or a column ``Time`` without a unit. It is None if the header is the
    name of a channel.
    """
    if header.strip().lower() in _NAMES_OF_SAMPLE_NUMBERS:
        return 0.0
    match = _TIME_HEADING.fullmatch(header.strip())
    if match is None:
        return None
    # The regular expression also matches the Greek letter for the sign of micro.
    unit = match["unit"].lower().replace("\N{GREEK SMALL LETTER MU}", "\N{MICRO SIGN}")
    if unit in UNITS:
        return UNITS[unit]
    # Without a unit, the times follow from the sample rate.
    return 0.0 if header.strip().lower() in ("time", "zeit") else None
