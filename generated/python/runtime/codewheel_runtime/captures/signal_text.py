# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads captures in text files: tables of 0 and 1, such as CSV, and value change dumps (VCD)."""

from __future__ import annotations

import io
import re
from collections.abc import Generator, Sequence
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import short
from ..errors import InputError
from ..packages import load
from .signals import Edges, Names, Signals, pack_bits, read_samples

np: Any = load("numpy")

#: Number of bytes of text that are read at once, which is also the limit for a line.
_BLOCK: Final = 1 << 20
#: Limit for the size of a header.
HEADER: Final = 1 << 16
HINT: Final = (
    "expected a sigrok session or CSV, a Saleae CSV or binary file, VCD, a table of 0 and 1 or of voltages, "
    "or a NumPy file"
)

_RATE: Final = re.compile(r"\s*([0-9]{1,12}(?:\.[0-9]{1,9})?)\s*([kKMG]?)(?:Hz|S/s|Sa/s)?\s*")
_PREFIXES: Final = {"": 1.0, "k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9}


def parse_rate(text: str) -> float | None:
    """Return a sample rate such as ``24 MHz`` in samples per second, or None if the text is not one or is 0."""
    match = _RATE.fullmatch(text)
    if match is None:
        return None
    return float(match[1]) * _PREFIXES[match[2]] or None


def measure_size(file: BinaryIO) -> int:
    """Return the size of a file in bytes."""
    offset = file.tell()
    size = file.seek(0, io.SEEK_END)
    # Reading continues where it was.
    file.seek(offset)
    return size


# Tables


def _read_blocks(file: BinaryIO, path: str, kind: str) -> Generator[tuple[bytes, int], None, None]:
    """Yield blocks of whole lines, and the amount read. The last line gets a line end if it has none.

    ``kind`` is the format, for the error about a line that is longer than a block.
    """
    remainder = b""
    done = 0
    while data := file.read(_BLOCK):
        done += len(data)
        data = remainder + data
        end = data.rfind(b"\n") + 1
        if not end and len(data) > _BLOCK:
            raise InputError(path, f"offset {done - len(data)}", f"a line is too long: this is not a {kind} file")
        remainder = data[end:]
        if end:
            yield data[:end], done
    if remainder.strip():
        yield remainder + b"\n", done


_UNITS: Final = {
    "s": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "µs": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nanoseconds": 1e-9, "ps": 1e-12, "picoseconds": 1e-12, "fs": 1e-15, "femtoseconds": 1e-15,
}  # fmt: skip
_TIME: Final = re.compile(r"(?:time\s*)?[\[(]?(?P<unit>[a-zµ]*)[\])]?", re.IGNORECASE)


#: Names of a column with the number of the sample.
_NUMBERS: Final = ("sample", "samples", "sample number", "index", "no", "no.", "nr", "#")
#: Time stamp of ISO 8601, as in CSV files of Saleae, without its time zone.
_STAMP: Final = re.compile(rb"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:\.\d{1,12})?")
#: Part of the range of a voltage by which it must pass the threshold.
_HYSTERESIS: Final = 0.1


class _TableForm(NamedTuple):
    """Form of a table.

    ``unit`` is the unit of the time column in seconds. It is None if there is no such column, and 0 if its times are
    not used. ``skipped`` is the number of lines before the first row. ``is_stamped`` is True if times are time stamps,
    which are converted to seconds from the first one.
    """

    delimiter: str | None
    channels: list[str]
    unit: float | None
    rate: float | None
    skipped: int
    is_stamped: bool = False


def read_table_signals(
    file: BinaryIO, path: str, head: bytes, names: Names, rate: float | None, threshold: float | None = None
) -> Signals:
    """Return the signals of a table: columns of 0 and 1, with one row per sample or a time in the first column.

    Columns can also have voltages. Those above ``threshold`` are 1. By default, it is in the middle of their range.
    """
    form = _find_table_form(path, head)
    places = names.places(form.channels, path)
    # A column of times or of numbers is in front of the channels.
    offset = int(form.unit is not None)
    parts = _read_table_parts(file, path, form, [offset + place for place in places], threshold)
    edges = read_samples(parts, tuple(1 << index for index in range(len(places))))
    total = measure_size(file)
    if form.unit:
        return Signals(edges, seconds=form.unit, is_sampled=False, total=total)
    sample_rate = rate or form.rate
    return Signals(edges, seconds=1 / sample_rate if sample_rate else None, is_sampled=True, total=total)


def _find_table_form(path: str, head: bytes) -> _TableForm:
    """Return the form of a table according to its first lines: comments, up to two headers, and rows."""
    if len(head) == HEADER and b"\n" not in head:
        raise InputError(path, "", "a line is too long: this is not a capture")
    lines = head.decode("utf-8-sig", "replace").splitlines()
    comments = [line.lstrip("; #") for line in lines if line[:1] in (";", "#")]
    rows = [line for line in lines if line.strip() and line[:1] not in (";", "#")]
    if not rows:
        raise InputError(path, "", f"this is not a capture: {HINT}")
    delimiter = max(",;\t", key=rows[0].count) if re.search("[,;\t]", rows[0]) else None
    cells = _split_cells(rows[0], delimiter)
    has_header = not _is_row(cells)
    # An oscilloscope has a second header, with units.
    unit_cells = _split_cells(rows[1], delimiter) if has_header and len(rows) > 2 else []
    has_units = bool(unit_cells) and not _is_row(unit_cells) and _is_row(_split_cells(rows[2], delimiter))
    header_count = has_header + has_units
    if has_header and len(rows) > header_count and not _is_row(_split_cells(rows[header_count], delimiter)):
        raise InputError(path, "", f"this is not a capture: {HINT}")
    # Four rows are enough to recognise numbers of samples.
    first_rows = [_split_cells(row, delimiter) for row in rows[header_count : header_count + 4]]
    is_stamped = bool(first_rows) and bool(first_rows[0]) and _is_stamp(first_rows[0][0])
    unit = _find_unit(unit_cells[0] if has_units else cells[0]) if has_header else None
    if is_stamped:
        unit = 1.0
    elif unit is None and _are_numbered(first_rows):
        unit = 0.0
    if not has_header:
        # Channels are numbered from 1. The column of times or of numbers is not a channel, so it gets 0.
        cells = [str(number) for number in range(int(unit is None), len(cells) + int(unit is None))]
    channels = cells[unit is not None :]
    labels = [label.strip() for label in _find_comment(comments, "Channels").split(",") if label.strip()]
    return _TableForm(
        delimiter=delimiter,
        channels=labels if len(labels) == len(channels) else channels,
        unit=unit,
        rate=parse_rate(_find_comment(comments, "Samplerate")),
        skipped=head.count(b"\n", 0, _find_first_row(head, header_count)),
        is_stamped=is_stamped,
    )


def _is_row(cells: list[str]) -> bool:
    """Return whether all cells can be those of a row: numbers, a time stamp, or X for a channel that was off."""
    return all(_is_number(cell) or cell == "X" or (not place and _is_stamp(cell)) for place, cell in enumerate(cells))


def _is_stamp(cell: str) -> bool:
    """Return whether a cell begins with a time stamp."""
    return _STAMP.match(cell.encode()) is not None


def _are_numbered(rows: list[list[str]]) -> bool:
    """Return whether the first cells of four or more rows are successive numbers, such as those of samples."""
    first_cells = [row[0] for row in rows if len(row) > 1]
    if len(first_cells) < 4 or not all(cell.isascii() and cell.isdigit() for cell in first_cells):
        return False
    first = int(first_cells[0])
    return [int(cell) for cell in first_cells] == [*range(first, first + len(first_cells))]


def _find_comment(comments: list[str], name: str) -> str:
    """Return the text after the colon of the first comment that begins with ``name``, or an empty string."""
    return next((comment.partition(":")[2] for comment in comments if comment.startswith(name)), "")


def _read_table_parts(
    file: BinaryIO, path: str, form: _TableForm, columns: list[int], threshold: float | None
) -> Generator[tuple[Any, int, Any], None, None]:
    """Yield the levels of some rows, the amount read, and their times, or None if the table has no times.

    Raises:
        InputError: The times are not in ascending order, or a cell is wrong.
    """
    last_time = -np.inf
    reader = _RowReader(form, columns, path)
    reader.find_voltages(file, threshold)
    for block, first_line, done in reader.blocks_of_rows(file):
        times, levels = reader.read(block, first_line)
        if times is not None:
            if not (last_time <= times[0] and (np.diff(times) >= 0).all()):
                raise InputError(path, f"from line {first_line}", "the times are not in ascending order")
            last_time = float(times[-1])
        yield levels, done, times


def _find_first_row(head: bytes, header_count: int) -> int:
    """Return the offset in bytes of the first row of a table, after its headers, comments and empty lines."""
    offset = 0
    headers_left = header_count
    for line in io.BytesIO(head):
        # A byte order mark can precede the first line.
        is_comment = not line.strip() or line.lstrip(b"\xef\xbb\xbf")[:1] in (b";", b"#")
        if not is_comment:
            if not headers_left:
                return offset
            headers_left -= 1
        offset += len(line)
    return offset


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Return the cells of a line. A separator at its end is ignored."""
    cells = [cell.strip().strip('"') for cell in line.split(delimiter)]
    return cells[:-1] if cells and not cells[-1] else cells


def _is_number(text: str) -> bool:
    """Return whether a cell is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _find_unit(name: str) -> float | None:
    """Return the unit of the first column in seconds, according to its header, such as ``Time [ms]``.

    It is 0 for a column of sample numbers, and for a column ``Time`` without a unit, whose times are not used. It is
    None for a channel.
    """
    if name.strip().lower() in _NUMBERS:
        return 0.0
    match = _TIME.fullmatch(name.strip())
    if match is None:
        return None
    # The regular expression also matches the Greek letter for the sign of micro.
    unit = match["unit"].lower().replace("\N{GREEK SMALL LETTER MU}", "\N{MICRO SIGN}")
    if unit in _UNITS:
        return _UNITS[unit]
    # Without a unit, the sample rate gives the times.
    return 0.0 if name.strip().lower() == "time" else None


class _RowReader:
    """Reader of the times and the levels of rows.

    ``_first_stamp`` is the first time stamp, from which times are counted, and ``_voltages`` the converter from
    voltages to levels. Both are None if the table has none.
    """

    def __init__(self, form: _TableForm, columns: list[int], path: str) -> None:
        self._form = form
        self._columns = columns
        self._path = path
        self._first_stamp: Any = None
        self._voltages: _Voltages | None = None

    def find_voltages(self, file: BinaryIO, threshold: float | None) -> None:
        """Read the whole file for the range of its voltages, then go back to its beginning.

        It stops at the first rows if they have no voltages: all cells are whole numbers, or some are not finite. With
        ``threshold``, the columns always have voltages.
        """
        ranges: list[Any] = []
        for block, line, _ in self.blocks_of_rows(file):
            cells = self._read_numbers(block, line, self._columns)
            is_logic = ((cells == 0) | (cells == 1)).all()
            has_voltages = np.isfinite(cells).all() and (cells != np.floor(cells)).any()
            if not ranges and threshold is None and (is_logic or not has_voltages):
                break
            ranges += [cells.min(axis=0), cells.max(axis=0)]
        file.seek(0)
        if ranges:
            self._voltages = _Voltages(np.min(ranges, axis=0), np.max(ranges, axis=0), threshold)

    def blocks_of_rows(self, file: BinaryIO) -> Generator[tuple[bytes, int, int], None, None]:
        """Yield blocks of rows without the headers, the number of their first line, and the amount read."""
        line = 1
        for data, done in _read_blocks(file, self._path, "CSV"):
            block = data
            first_line = line
            # The headers are in the first block.
            if line == 1 and self._form.skipped:
                block = data.split(b"\n", self._form.skipped)[-1]
                first_line += self._form.skipped
            line += data.count(b"\n")
            if block.strip():
                yield block, first_line, done

    def _read_numbers(self, block: bytes, line: int, columns: list[int]) -> Any:
        """Return the numbers in these columns, with a row for each line. Raises InputError for other cells."""
        try:
            text = io.BytesIO(block)
            delimiter = self._form.delimiter
            return np.loadtxt(text, delimiter=delimiter, quotechar='"', usecols=columns, ndmin=2, comments=None)
        except (ValueError, IndexError) as error:
            reason = str(error).splitlines()[0]
            if b"X" in block:
                reason = "X means that a channel was off for some time: export a part in which all channels are on"
            raise InputError(self._path, f"from line {line}", reason) from None

    def read(self, block: bytes, line: int) -> tuple[Any, Any]:
        """Return the times and the levels of some rows. Without a time column, the times are None."""
        # A unit of 0 means that times are not used.
        has_time = bool(self._form.unit)
        if not has_time:
            if self._voltages is None:
                levels = _read_regular_rows(block, self._form.delimiter, self._columns)
                if levels is not None:
                    return None, levels
            return None, self._levels(self._read_numbers(block, line, self._columns), line)
        stamps: Any = None
        if self._form.is_stamped:
            stamps, block = self._split_off_stamps(block, line)
        table = self._read_numbers(block, line, [0, *self._columns])
        if not np.isfinite(table[:, 0]).all():
            raise InputError(self._path, f"from line {line}", "expected times in the first column")
        times = np.ascontiguousarray(table[:, 0]) if stamps is None else stamps
        return times, self._levels(table[:, 1:], line)

    def _levels(self, cells: Any, line: int) -> Any:
        """Return the levels of some rows, each as one number whose lowest bit is the first column.

        Raises:
            InputError: The cells are neither 0 and 1 nor voltages.
        """
        if self._voltages is not None and np.isfinite(cells).all():
            return pack_bits(self._voltages.levels(cells))
        if not ((cells == 0) | (cells == 1)).all():
            raise InputError(self._path, f"from line {line}", "expected columns of 0 and 1, or of voltages")
        return pack_bits(cells)

    def _split_off_stamps(self, block: bytes, line: int) -> tuple[Any, bytes]:
        """Return the time stamps as seconds from the first one, and the rows with 0 in their place."""
        delimiter = (self._form.delimiter or " ").encode()
        stamp_texts: list[str] = []
        rows_without_stamps: list[bytes] = []
        for row in block.splitlines():
            if not row.strip():
                continue
            first_cell, _, following_cells = row.partition(delimiter)
            stamp = _STAMP.match(first_cell.strip(b' "'))
            if stamp is None:
                raise InputError(self._path, f"from line {line}", "expected a time stamp in the first column")
            stamp_texts.append(stamp[0].decode().replace(" ", "T"))
            rows_without_stamps.append(b"0" + delimiter + following_cells)
        times = np.array(stamp_texts, "datetime64[ns]")
        if self._first_stamp is None:
            self._first_stamp = times[0]
        seconds = (times - self._first_stamp).astype(np.int64) / 1e9
        return seconds, b"\n".join(rows_without_stamps) + b"\n"


class _Voltages:
    """Converter from voltages to levels. Noise near the threshold is ignored: a voltage must pass it by a margin.

    ``_last`` has the level of each column in the last row that was converted, or None before the first.
    """

    def __init__(self, lowest: Any, highest: Any, threshold: float | None) -> None:
        self._threshold = (lowest + highest) / 2 if threshold is None else np.full(len(lowest), threshold)
        self._margin = (highest - lowest) * _HYSTERESIS
        self._last: Any = None

    def levels(self, cells: Any) -> Any:
        """Return the level of each voltage, 0 or 1. Successive calls must have successive rows."""
        count = len(cells)
        is_high = cells > self._threshold + self._margin
        is_low = cells < self._threshold - self._margin
        if self._last is None:
            self._last = cells[0] > self._threshold
        # A voltage near the threshold has the level of the last one that is not. Rows are numbered from 1, and 0 stands
        # for the row before these.
        rows = np.where(is_high | is_low, np.arange(1, count + 1)[:, None], 0)
        last_clear = np.maximum.accumulate(rows, axis=0)
        clear_levels = np.concatenate([self._last[None, :], is_high])
        levels = np.take_along_axis(clear_levels, last_clear, axis=0)
        self._last = levels[-1]
        return levels.astype(np.uint8)


def _read_regular_rows(block: bytes, delimiter: str | None, columns: list[int]) -> Any:
    """Return the levels of rows in which every cell is at the same place, each row as one number, or None.

    This is much faster than parsing numbers. It works if all rows have the length of the first one, the same
    separators, and a single 0 or 1 in each of ``columns``.
    """
    first_row = block[: block.index(b"\n") + 1]
    row_bytes = len(first_row)
    if len(block) % row_bytes:
        return None
    cells = first_row.rstrip(b"\r\n").split((delimiter or " ").encode())
    if any(column >= len(cells) or len(cells[column]) != 1 for column in columns):
        return None
    # Each cell is followed by one byte: a delimiter, or the end of the line.
    offsets: list[int] = []
    next_offset = 0
    for cell in cells:
        offsets.append(next_offset)
        next_offset += len(cell) + 1
    rows = np.frombuffer(block, np.uint8).reshape(-1, row_bytes)
    # The byte before each cell, and that at the end of the row.
    for fixed_offset in (*(offset - 1 for offset in offsets[1:]), row_bytes - 1):
        if not (rows[:, fixed_offset] == first_row[fixed_offset]).all():
            return None
    levels = rows[:, [offsets[column] for column in columns]] - np.uint8(ord("0"))
    return pack_bits(levels) if (levels <= 1).all() else None


# VCD


_VAR: Final = re.compile(r"\$var\s+\S+\s+(\d+)\s+(\S+)\s+(.*?)\s*\$end", re.DOTALL)
_SCALE: Final = re.compile(r"\$timescale\s+(1|10|100)\s*(s|ms|us|ns|ps|fs)\s+\$end")


def read_vcd_signals(file: BinaryIO, path: str, names: Names) -> Signals:
    """Return the signals of a value change dump. Only its variables of one bit are channels."""
    size = measure_size(file)
    head = file.read(_BLOCK)
    end = re.search(rb"\$enddefinitions\s+\$end", head)
    header = head[: end.start()].decode("ascii", "replace") if end is not None else ""
    scale = _SCALE.search(header)
    if end is None or scale is None:
        raise InputError(path, "", "this is not a valid VCD file: the header has no time scale or no end")
    file.seek(end.end())
    codes: list[bytes] = []
    signal_names: list[str] = []
    for bits, code, name in _VAR.findall(header):
        if bits == "1":
            codes.append(code.encode())
            signal_names.append(name)
    places = names.places(signal_names, path)
    edges = _changes(file, path, [codes[place] for place in places])
    return Signals(edges, int(scale[1]) * _UNITS[scale[2]], False, size)


def _changes(file: BinaryIO, path: str, codes: Sequence[bytes]) -> Generator[Edges, None, None]:
    """Yield the edges of the signals with these codes."""
    changes = _ValueChanges(path, codes)
    for block, done in _read_blocks(file, path, "VCD"):
        yield changes.edges_in(block, done)


#: Time before the first time stamp of a value change dump.
_NO_TIME: Final = -1
#: Most digits of a time.
_MAX_TIME_DIGITS: Final = 18


class _ValueChanges:
    """Reader of value changes, block by block. It keeps the level of each signal, None while it is unknown."""

    def __init__(self, path: str, codes: Sequence[bytes]) -> None:
        self._path = path
        # The signal and its new level, by the token of a change, such as ``1!`` for the code ``!``.
        self._changes: dict[bytes, tuple[int, int]] = {}
        for signal, code in enumerate(codes):
            self._changes |= {b"0" + code: (signal, 0), b"1" + code: (signal, 1)}
        self._levels: list[int | None] = [None for _ in codes]
        self._begin = self._now = _NO_TIME

    def edges_in(self, block: bytes, done: int) -> Edges:
        """Return the edges in a block of whole lines. The first level of a signal is not an edge."""
        changes = self._changes
        levels = self._levels
        first_levels = [level or 0 for level in levels]
        times: list[list[int]] = [[] for _ in levels]
        self._begin = self._now
        tokens = iter(block.split())
        for token in tokens:
            if token in changes:
                signal, level = changes[token]
                last_level = levels[signal]
                if last_level is None:
                    # The level was not known before, so it also holds for the time before.
                    first_levels[signal] = level
                elif last_level != level:
                    times[signal].append(self._now)
                levels[signal] = level
            elif token[:1] in b"bBrR":
                # The value of a vector or a real number. Its code is the next token of the same line.
                next(tokens, None)
            elif token[:1] == b"#":
                self._advance(token)
        edge_times = tuple(np.array(signal_times, np.float64) for signal_times in times)
        return Edges(tuple(first_levels), edge_times, float(self._begin), float(self._now), done)

    def _advance(self, token: bytes) -> None:
        """Set the time to the one in ``token``, such as ``#1200``."""
        digits = token[1:]
        if not digits.isdigit() or len(digits) > _MAX_TIME_DIGITS:
            raise InputError(self._path, "", f"the time {_shown(token)} is not a number of at most 18 digits")
        if int(digits) < self._now:
            raise InputError(self._path, "", f"the time {_shown(token)} is out of order")
        self._now = int(digits)
        if self._begin == _NO_TIME:
            self._begin = self._now


def _shown(token: bytes) -> str:
    """Return a token for a message."""
    return short(token.decode("ascii", "replace"))
