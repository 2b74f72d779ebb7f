# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the bytes on a serial line, from the signal of a capture or from an exported table."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Generator, Iterator
from itertools import islice
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import quote
from ..errors import InputError
from ..packages import load
from .signals import Edges, Signals

np: Any = load("numpy")

_DATA_BITS: Final = 8
#: A byte has a start bit, its data bits, and a stop bit.
BITS_PER_BYTE: Final = 1 + _DATA_BITS + 1


class Bytes(NamedTuple):
    """Bytes of a part of the capture, the time of each start bit, and True for each byte with a stop bit.

    ``amount_read`` is the amount of the file that has been read.
    """

    values: Any
    times: Any
    has_stop_bits: Any
    amount_read: int


def read_serial_bytes(signals: Signals, baud: float) -> Generator[Bytes, None, None]:
    """Yield the bytes on a serial line: eight data bits, least significant bit first, without parity.

    Args:
        signals: The line, high at rest.
        baud: Bits per second, or per sample if the sample rate is unknown.
    """
    # Without a sample rate, times are in samples.
    time_unit = signals.seconds or 1.0
    # An edge between two samples is seen at the second one, half a sample late on average.
    edge_delay = 0.5 if signals.is_sampled else 0.0
    line = _SerialLine(bit_time=1 / baud / time_unit, edge_delay=edge_delay)
    amount_read = 0
    for part in _add_end_mark(signals):
        if part is not None:
            line.add(part)
            amount_read = part.amount_read
        starts = line.find_starts(is_end=part is None)
        if len(starts):
            values, has_stop_bits = line.read_bytes(starts)
            yield Bytes(values, starts * time_unit, has_stop_bits, amount_read)


class _SerialLine:
    """Edges on a serial line that do not belong to a complete byte yet.

    Args:
        bit_time: Time of a bit, in the unit of the edges.
        edge_delay: Mean time between an edge and the time that the capture gives for it.
    """

    def __init__(self, bit_time: float, edge_delay: float) -> None:
        self._bit_time = bit_time
        # The stop bit lasts at least half a bit. Then the next byte may follow at once.
        self._shortest_byte_time = (BITS_PER_BYTE - 0.5) * bit_time
        # From the start of the start bit to the middle of each data bit and of the stop bit, which follow it.
        self._bit_offsets = bit_time * (1.5 + np.arange(_DATA_BITS + 1)) - edge_delay
        self._edges = np.zeros(0)
        #: Level before the edges, and the end of the part that was added last.
        self._level = 1
        self._end = 0.0
        #: Time before which no byte can begin.
        self._earliest_start = -np.inf
        self._is_empty = True

    def add(self, part: Edges) -> None:
        """Add the edges of the next part of the capture."""
        # The serial line is the only signal, so its index is 0.
        if self._is_empty:
            self._level = part.levels[0]
            self._is_empty = False
        self._edges = np.concatenate([self._edges, part.times[0]])
        self._end = part.end

    def find_starts(self, *, is_end: bool) -> Any:
        """Return the time of each start bit whose byte is complete. At the end of the capture, this is every byte."""
        # Edges rise and fall in turn. After a high level, the first edge falls. After a low level, the second one does.
        first_falling_edge = 1 - self._level
        falling_edges = self._edges[first_falling_edge::2]
        if not is_end:
            # A byte that begins later may continue in the next part of the capture.
            last_complete_start = self._end - BITS_PER_BYTE * self._bit_time
            complete_count = int(np.searchsorted(falling_edges, last_complete_start, "right"))
            falling_edges = falling_edges[:complete_count]
        return _choose_start_bits(falling_edges, self._earliest_start, self._shortest_byte_time)

    def read_bytes(self, starts: Any) -> tuple[Any, Any]:
        """Return the bytes with these start bits, and True for each that has a stop bit. Remove their edges."""
        # A row for each byte, and a column for each of its bits.
        bit_times = starts[:, None] + self._bit_offsets[None, :]
        # An odd number of edges before a time inverts the first level.
        edge_counts = np.searchsorted(self._edges, bit_times.ravel(), "right").reshape(bit_times.shape)
        levels = (edge_counts & 1) ^ self._level
        # The least significant bit is sent first.
        weighted_bits = levels[:, :_DATA_BITS] << np.arange(_DATA_BITS)
        values = weighted_bits.sum(axis=1).astype(np.uint8)
        has_stop_bits = levels[:, _DATA_BITS] == 1
        self._earliest_start = float(starts[-1]) + self._shortest_byte_time
        self._remove_edges_before(self._earliest_start)
        return values, has_stop_bits

    def _remove_edges_before(self, time: float) -> None:
        """Remove the edges before this time, and keep the level after them."""
        used_count = int(np.searchsorted(self._edges, time, "left"))
        self._edges = self._edges[used_count:]
        self._level ^= used_count & 1


def _choose_start_bits(falling_edges: Any, earliest_start: float, shortest_byte_time: float) -> Any:
    """Return the falling edges that begin a byte: the first edge, then the first edge after each byte.

    A byte cannot begin before ``earliest_start``, or less than ``shortest_byte_time`` after the previous byte.
    """
    # For each falling edge, the index of the first one that can begin the next byte.
    next_indices = np.searchsorted(falling_edges, falling_edges + shortest_byte_time, "left").tolist()
    start_indices: list[int] = []
    index = int(np.searchsorted(falling_edges, earliest_start, "left"))
    while index < len(falling_edges):
        start_indices.append(index)
        index = next_indices[index]
    return falling_edges[start_indices] if start_indices else np.zeros(0)


#: Headers of the tables exported by Saleae's serial analyzer, with the columns of the times and of the bytes.
_SALEAE_EXPORT_HEADERS: Final = (
    (("name", "type", "start_time", "duration", "data"), 2, 4),
    (("time [s]", "value"), 0, 1),
)


_BYTE_TEXT: Final = re.compile(r"0x([0-9a-fA-F]{1,2})|([0-9]{1,3})")


#: Number of rows of an export that are read at a time.
_ROWS_AT_ONCE: Final = 1 << 16


def find_exported_columns(first_bytes: bytes) -> tuple[int, int] | None:
    """Return the indices of the time and byte columns if a file is an export of serial bytes, otherwise None.

    ``first_bytes`` contains the first bytes of the file. Its first line must begin with a header that Saleae's serial
    analyzer writes.
    """
    first_line = first_bytes.decode("utf-8-sig", "replace").partition("\n")[0]
    cells = [cell.strip().strip('"').lower() for cell in first_line.split(",")]
    for header, time_column, byte_column in _SALEAE_EXPORT_HEADERS:
        if tuple(cells[: len(header)]) == header:
            return time_column, byte_column
    return None


def read_exported_bytes(file: BinaryIO, path: str, columns: tuple[int, int]) -> Generator[Bytes, None, None]:
    """Yield the bytes of a table with one byte per row, as exported by Saleae's serial analyzer.

    Raises:
        InputError: A cell is not a byte, a time is not a number, or a row has too few cells.
    """
    time_column, byte_column = columns
    text = io.TextIOWrapper(file, "utf-8-sig", "replace", newline="")
    rows = enumerate(csv.reader(text), 1)
    # The first row is the header.
    next(rows)
    line_number = 1
    # Empty rows are left out, but count as lines.
    while numbered_rows := [(line_number, row) for line_number, row in islice(rows, _ROWS_AT_ONCE) if row]:
        values = np.zeros(len(numbered_rows), np.uint8)
        times = np.zeros(len(numbered_rows))
        has_stop_bits = np.ones(len(numbered_rows), bool)
        for index, (line_number, row) in enumerate(numbered_rows):
            if len(row) <= max(time_column, byte_column):
                raise InputError(path, "the row ends early", place=f"line {line_number}")
            values[index] = _read_byte(row[byte_column], path, line_number)
            try:
                times[index] = float(row[time_column])
            except ValueError:
                reason = f"{quote(row[time_column])} is not a time in seconds: export without time stamps of ISO 8601"
                raise InputError(path, reason, place=f"line {line_number}") from None
            # A byte without a stop bit has a cell that names a framing error.
            has_stop_bits[index] = not any("framing" in cell.lower() for cell in row)
        yield Bytes(values, times, has_stop_bits, line_number)


def _read_byte(cell: str, path: str, line_number: int) -> int:
    """Return the byte in a cell: hexadecimal such as ``0x1A``, or decimal.

    Raises InputError for other cells. ``line_number`` is the number of the line, for the error.
    """
    match = _BYTE_TEXT.fullmatch(cell.strip())
    if match is not None:
        hex_digits, decimal_digits = match.groups()
        number = int(hex_digits, 16) if hex_digits else int(decimal_digits)
        if number <= 255:
            return number
    reason = f"{quote(cell)} is not a byte: export with hexadecimal numbers"
    raise InputError(path, reason, place=f"line {line_number}")


def _add_end_mark(signals: Signals) -> Iterator[Edges | None]:
    """Yield the edges of a capture part by part, then None, which marks its end."""
    yield from signals.edges
    yield None
