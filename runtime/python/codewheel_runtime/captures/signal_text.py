# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads captures in text files: tables of 0 and 1, such as CSV, and value change dumps (VCD)."""

from __future__ import annotations

import io
import re
from collections.abc import Generator, Sequence
from typing import Any, BinaryIO, Final

from ..bulk.words import quote
from ..errors import InputError
from ..packages import load
from .signals import Edges, Samples, SignalNames, Signals, pack_bits, read_samples
from .table_forms import STAMP, UNITS, TableForm, find_table_form

np: Any = load("numpy")

#: Number of bytes of text that are read at a time, which is also the limit for a line.
_BLOCK: Final = 1 << 20


def measure_size(file: BinaryIO) -> int:
    """Return the size of a file in bytes. The file position does not change."""
    offset = file.tell()
    size = file.seek(0, io.SEEK_END)
    # Reading continues where it was.
    file.seek(offset)
    return size


# Tables


def _read_blocks(file: BinaryIO, path: str, file_format: str) -> Generator[tuple[bytes, int], None, None]:
    """Yield blocks of whole lines, each with the number of bytes read so far.

    A missing line end is added to the last line.

    ``file_format`` is the format of the file, for the error about a line that is longer than a block.
    """
    remainder = b""
    bytes_read = 0
    while data := file.read(_BLOCK):
        bytes_read += len(data)
        data = remainder + data
        # End of the last whole line, or 0 if there is none.
        lines_end = data.rfind(b"\n") + 1
        if not lines_end and len(data) > _BLOCK:
            line_start = bytes_read - len(data)
            reason = f"a line is too long: this is not a {file_format} file"
            raise InputError(path, reason, place=f"offset {line_start}")
        remainder = data[lines_end:]
        if lines_end:
            yield data[:lines_end], bytes_read
    if remainder.strip():
        yield remainder + b"\n", bytes_read


#: Fraction of the voltage range by which a voltage must pass the threshold.
_HYSTERESIS: Final = 0.1


def read_table_signals(
    file: BinaryIO,
    path: str,
    first_bytes: bytes,
    signal_names: SignalNames,
    rate: float | None,
    threshold: float | None = None,
) -> Signals:
    """Return the signals of a table: columns of 0 and 1, with one row per sample, or with a time in the first column.

    Columns can also have voltages. Voltages above ``threshold`` are the level 1. By default, it is in the middle of
    their range. ``first_bytes`` contains the first bytes of the file, and ``rate`` is the chosen sample rate in Hz, or
    None.
    """
    table_form = find_table_form(path, first_bytes)
    channel_indices = signal_names.find_channels(table_form.channels, path)
    columns = [table_form.columns_before_channels + index for index in channel_indices]
    parts = _read_table_parts(file, path, table_form, columns, threshold)
    # The levels of the signals are packed, so their bits are numbered from 0.
    masks = tuple(1 << bit for bit in range(len(channel_indices)))
    edges = read_samples(parts, masks)
    total = measure_size(file)
    if table_form.has_times:
        return Signals(edges, seconds=table_form.unit, is_sampled=False, total=total)
    return Signals.at_rate(edges, rate or table_form.rate, total)


def _read_table_parts(
    file: BinaryIO, path: str, table_form: TableForm, columns: list[int], threshold: float | None
) -> Generator[Samples, None, None]:
    """Yield the levels of the rows part by part, with their times if the table has times.

    The amount read is the number of bytes so far. ``columns`` are the indices of the columns of the signals, and
    ``path`` is for errors.

    Raises:
        InputError: The times are not in ascending order, or a cell is wrong.
    """
    last_time = -np.inf
    reader = _RowReader(table_form, columns, path)
    reader.find_voltages(file, threshold)
    for block, first_line, bytes_read in reader.blocks_of_rows(file):
        times, levels = reader.read(block, first_line)
        if times is not None:
            if not (last_time <= times[0] and (np.diff(times) >= 0).all()):
                raise InputError(path, "the times are not in ascending order", place=f"from line {first_line}")
            last_time = float(times[-1])
        yield Samples(levels, amount_read=bytes_read, times=times)


class _RowReader:
    """Reader for the times and levels of rows.

    ``_first_stamp`` is the first time stamp, from which times are counted, and ``_voltages`` the converter from
    voltages to levels. Both are None if the table has no time stamps or voltages.
    """

    def __init__(self, table_form: TableForm, columns: list[int], path: str) -> None:
        self._table_form = table_form
        self._columns = columns
        self._path = path
        self._first_stamp: Any = None
        self._voltages: Voltages | None = None

    def find_voltages(self, file: BinaryIO, threshold: float | None) -> None:
        """Read the whole file to find the range of the voltages in each column, then go back to its beginning.

        Reading stops after the first block if it contains no voltages, that is, if all its cells are whole numbers or
        some are not finite. With a ``threshold``, the columns always contain voltages.
        """
        # The lowest and the highest voltage of each column, block by block.
        ranges: list[Any] = []
        for block, first_line, _ in self.blocks_of_rows(file):
            cells = self._read_numbers(block, first_line, self._columns)
            has_fractions = (cells != np.floor(cells)).any()
            has_voltages = np.isfinite(cells).all() and has_fractions
            is_first_block = not ranges
            if is_first_block and threshold is None and not has_voltages:
                break
            ranges += [cells.min(axis=0), cells.max(axis=0)]
        file.seek(0)
        if ranges:
            self._voltages = Voltages(np.min(ranges, axis=0), np.max(ranges, axis=0), threshold)

    def blocks_of_rows(self, file: BinaryIO) -> Generator[tuple[bytes, int, int], None, None]:
        """Yield blocks of rows without headers, each with the number of its first line and the bytes read so far."""
        line = 1
        for data, bytes_read in _read_blocks(file, self._path, "CSV"):
            block = data
            first_line = line
            # The headers are in the first block.
            if line == 1 and self._table_form.skipped:
                # The last piece is what follows the skipped lines.
                block = data.split(b"\n", self._table_form.skipped)[-1]
                first_line += self._table_form.skipped
            line += data.count(b"\n")
            if self._table_form.has_decimal_commas:
                block = block.replace(b",", b".")
            if block.strip():
                yield block, first_line, bytes_read

    def _read_numbers(self, block: bytes, first_line: int, columns: list[int]) -> Any:
        """Return the numbers in these columns of a block, with a row for each line.

        ``first_line`` is the number of the first line. Raises InputError if a cell is not a number.
        """
        try:
            text = io.BytesIO(block)
            delimiter = self._table_form.delimiter
            return np.loadtxt(text, delimiter=delimiter, quotechar='"', usecols=columns, ndmin=2, comments=None)
        except (ValueError, IndexError) as error:
            reason = str(error).splitlines()[0]
            if b"X" in block:
                reason = "X means that a channel was off for some time: export a part in which all channels are on"
            raise InputError(self._path, reason, place=f"from line {first_line}") from None

    def read(self, block: bytes, first_line: int) -> tuple[Any, Any]:
        """Return the times and the levels of some rows. The times are None if there are none, or if they are not used.

        Raises InputError if a cell is wrong. ``first_line`` is the number of the first row, for that error.
        """
        if not self._table_form.has_times:
            return None, self._read_levels(block, first_line)
        stamps: Any = None
        if self._table_form.is_stamped:
            stamps, block = self._split_off_stamps(block, first_line)
        table = self._read_numbers(block, first_line, [0, *self._columns])
        if not np.isfinite(table[:, 0]).all():
            raise InputError(self._path, "expected times in the first column", place=f"from line {first_line}")
        times = np.ascontiguousarray(table[:, 0]) if stamps is None else stamps
        return times, self._convert_to_levels(table[:, 1:], first_line)

    def _read_levels(self, block: bytes, first_line: int) -> Any:
        """Return the levels of rows without times. ``first_line`` is the number of the first row, for errors."""
        if self._voltages is None:
            levels = _read_regular_rows(block, self._table_form.delimiter, self._columns)
            if levels is not None:
                return levels
        return self._convert_to_levels(self._read_numbers(block, first_line, self._columns), first_line)

    def _convert_to_levels(self, cells: Any, first_line: int) -> Any:
        """Return the levels of some rows of numbers, each row as one number whose lowest bit is the first column.

        Empty cells of voltages are NaN, which is neither 0 nor 1, and raises the error.

        Raises:
            InputError: The cells are neither 0 and 1 nor voltages.
        """
        if self._voltages is not None and np.isfinite(cells).all():
            return pack_bits(self._voltages.levels(cells))
        are_levels = (cells == 0) | (cells == 1)
        if not are_levels.all():
            raise InputError(self._path, "expected columns of 0 and 1, or of voltages", place=f"from line {first_line}")
        return pack_bits(cells)

    def _split_off_stamps(self, block: bytes, first_line: int) -> tuple[Any, bytes]:
        """Return the times of rows in seconds from the first time stamp, and the rows with 0 instead of time stamps.

        The first time stamp applies to the whole file. Raises InputError if a row does not begin with a time stamp.
        """
        delimiter = (self._table_form.delimiter or " ").encode()
        stamp_texts: list[str] = []
        rows_without_stamps: list[bytes] = []
        for row in block.splitlines():
            if not row.strip():
                continue
            first_cell, _, following_cells = row.partition(delimiter)
            stamp = STAMP.match(first_cell.strip(b' "'))
            if stamp is None:
                raise InputError(
                    self._path, "expected a time stamp in the first column", place=f"from line {first_line}"
                )
            stamp_texts.append(stamp[0].decode().replace(" ", "T"))
            rows_without_stamps.append(b"0" + delimiter + following_cells)
        try:
            times = np.array(stamp_texts, "datetime64[ns]")
        except ValueError as error:
            # Not every text in the form of a time stamp is a time stamp, such as a 13th month.
            raise InputError(self._path, str(error), place=f"from line {first_line}") from None
        if self._first_stamp is None:
            self._first_stamp = times[0]
        # The differences are in nanoseconds.
        seconds = (times - self._first_stamp).astype(np.int64) / 1e9
        return seconds, b"\n".join(rows_without_stamps) + b"\n"


class Voltages:
    """Converter from voltages to levels. A voltage must pass the threshold by a margin to change the level.

    ``_last_levels`` contains the level of each column in the last row that was converted, or None before the first.
    """

    def __init__(self, lowest: Any, highest: Any, threshold: float | None) -> None:
        self._threshold = (lowest + highest) / 2 if threshold is None else np.full(len(lowest), threshold)
        self._margin = (highest - lowest) * _HYSTERESIS
        self._last_levels: Any = None

    def levels(self, cells: Any) -> Any:
        """Return the level, 0 or 1, for each voltage. Successive calls must pass successive rows."""
        is_high = cells > self._threshold + self._margin
        is_low = cells < self._threshold - self._margin
        if self._last_levels is None:
            self._last_levels = cells[0] > self._threshold
        # A voltage near the threshold has the level of the last row above that is clearly high or low. Rows are
        # numbered from 1 here, and row 0 has the last levels of the previous call.
        row_numbers = np.arange(1, len(cells) + 1)[:, None]
        clear_row_numbers = np.where(is_high | is_low, row_numbers, 0)
        # In each column, the highest number so far belongs to the last clear row.
        last_clear_rows = np.maximum.accumulate(clear_row_numbers, axis=0)
        levels_from_row_0 = np.concatenate([self._last_levels[None, :], is_high])
        levels = np.take_along_axis(levels_from_row_0, last_clear_rows, axis=0)
        self._last_levels = levels[-1]
        return levels.astype(np.uint8)


def _read_regular_rows(block: bytes, delimiter: str | None, columns: list[int]) -> Any:
    """Return the levels of rows with the same form as the first row, each row as one number, or None for other rows.

    In such rows, every cell is at the same place, so reading them is much faster than parsing numbers. All rows must
    have the same length and separators, and a single 0 or 1 in each of ``columns``.
    """
    first_row = block[: block.index(b"\n") + 1]
    row_bytes = len(first_row)
    if len(block) % row_bytes:
        return None
    cells = first_row.rstrip(b"\r\n").split((delimiter or " ").encode())
    if any(column >= len(cells) or len(cells[column]) != 1 for column in columns):
        return None
    # Each cell is followed by one byte: a delimiter, or the end of the line.
    cell_offsets: list[int] = []
    next_offset = 0
    for cell in cells:
        cell_offsets.append(next_offset)
        next_offset += len(cell) + 1
    delimiter_offsets = [offset - 1 for offset in cell_offsets[1:]]
    line_end_offset = row_bytes - 1
    rows = np.frombuffer(block, np.uint8).reshape(-1, row_bytes)
    for offset in (*delimiter_offsets, line_end_offset):
        if not (rows[:, offset] == first_row[offset]).all():
            return None
    characters = rows[:, [cell_offsets[column] for column in columns]]
    # Characters below "0" wrap around, so all characters other than 0 and 1 become more than 1.
    levels = characters - np.uint8(ord("0"))
    return pack_bits(levels) if (levels <= 1).all() else None


# VCD


_VAR_DECLARATION: Final = re.compile(r"\$var\s+\S+\s+(\d+)\s+(\S+)\s+(.*?)\s*\$end", re.DOTALL)
_TIMESCALE: Final = re.compile(r"\$timescale\s+(1|10|100)\s*(s|ms|us|ns|ps|fs)\s+\$end")


def read_vcd_signals(file: BinaryIO, path: str, signal_names: SignalNames) -> Signals:
    """Return the signals of a value change dump. Only its one-bit variables are channels."""
    size = measure_size(file)
    first_bytes = file.read(_BLOCK)
    header_end = re.search(rb"\$enddefinitions\s+\$end", first_bytes)
    header = first_bytes[: header_end.start()].decode("ascii", "replace") if header_end is not None else ""
    scale = _TIMESCALE.search(header)
    if header_end is None or scale is None:
        raise InputError(path, "this is not a valid VCD file: the header has no time scale or no end")
    time_unit = int(scale[1]) * UNITS[scale[2]]
    file.seek(header_end.end())
    variable_codes: list[bytes] = []
    variable_names: list[str] = []
    for bit_count, variable_code, variable_name in _VAR_DECLARATION.findall(header):
        if bit_count == "1":
            variable_codes.append(variable_code.encode())
            variable_names.append(variable_name)
    channel_indices = signal_names.find_channels(variable_names, path)
    edges = _read_changes(file, path, [variable_codes[index] for index in channel_indices])
    return Signals(edges, seconds=time_unit, is_sampled=False, total=size)


def _read_changes(file: BinaryIO, path: str, signal_codes: Sequence[bytes]) -> Generator[Edges, None, None]:
    """Yield the edges of the signals with these codes in a value change dump, block by block."""
    changes = _ValueChanges(path, signal_codes)
    for block, bytes_read in _read_blocks(file, path, "VCD"):
        yield changes.edges_in(block, bytes_read)


#: Time that precedes the first time stamp of a value change dump.
_NO_TIME: Final = -1
#: Most digits of a time.
_MAX_TIME_DIGITS: Final = 18


class _ValueChanges:
    """Reader of value changes, block by block. It keeps the level of each signal, or None while it is unknown."""

    def __init__(self, path: str, codes: Sequence[bytes]) -> None:
        self._path = path
        # The signal and its new level, by the token of a change, such as ``1!`` for the code ``!``.
        self._change_by_token: dict[bytes, tuple[int, int]] = {}
        for signal, code in enumerate(codes):
            self._change_by_token |= {b"0" + code: (signal, 0), b"1" + code: (signal, 1)}
        self._levels: list[int | None] = [None for _ in codes]
        self._begin = self._now = _NO_TIME

    def edges_in(self, block: bytes, bytes_read: int) -> Edges:
        """Return the edges in a block of whole lines. The first level of a signal is not an edge.

        ``bytes_read`` is the size of the file up to the end of the block. Changes to levels other than 0 and 1, such as
        ``x`` and ``z``, are ignored.
        """
        change_by_token = self._change_by_token
        levels = self._levels
        first_levels = [level or 0 for level in levels]
        times_by_signal: list[list[int]] = [[] for _ in levels]
        self._begin = self._now
        tokens = iter(block.split())
        for token in tokens:
            if token in change_by_token:
                signal, level = change_by_token[token]
                last_level = levels[signal]
                if last_level is None:
                    # The level was not known before, so it also holds for the time before.
                    first_levels[signal] = level
                elif last_level != level:
                    times_by_signal[signal].append(self._now)
                levels[signal] = level
            elif token[:1] in b"bBrR":
                # The value of a vector or a real number. Its code is the next token of the same line.
                next(tokens, None)
            elif token[:1] == b"#":
                self._advance(token)
        edge_times = tuple(np.array(signal_times, np.float64) for signal_times in times_by_signal)
        return Edges(tuple(first_levels), edge_times, float(self._begin), float(self._now), bytes_read)

    def _advance(self, token: bytes) -> None:
        """Set the current time to the time in ``token``, such as ``#1200``.

        Raises InputError if it is not a time, or earlier than the current time.
        """
        digits = token[1:]
        if not digits.isdigit() or len(digits) > _MAX_TIME_DIGITS:
            raise InputError(self._path, f"the time {_format_token(token)} is not a number of at most 18 digits")
        if int(digits) < self._now:
            raise InputError(self._path, f"the time {_format_token(token)} is out of order")
        self._now = int(digits)
        if self._begin == _NO_TIME:
            self._begin = self._now


def _format_token(token: bytes) -> str:
    """Return a token of a value change dump as text, for a message."""
    return quote(token.decode("ascii", "replace"))
