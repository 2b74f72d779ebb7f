# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the bytes on a serial line, from the signal of a capture or from an exported table."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Generator, Iterator
from itertools import islice
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.words import short
from ..errors import InputError
from ..packages import load
from .signals import Signals

np: Any = load("numpy")

#: A byte has a start bit, eight data bits, and a stop bit.
BITS_PER_BYTE: Final = 10


class Bytes(NamedTuple):
    """Bytes of a part of the capture, the time of each start bit, and True for each byte with a stop bit.

    ``done`` is the amount of the file that has been read.
    """

    values: Any
    times: Any
    has_stop_bits: Any
    done: int


def read_serial_bytes(signals: Signals, baud: float) -> Generator[Bytes, None, None]:
    """Yield the bytes on a serial line: eight data bits, least significant bit first, without parity.

    Args:
        signals: The line, high at rest.
        baud: Bits per second, or per sample if the sample rate is unknown.
    """
    # Without a sample rate, times are in samples.
    time_unit = signals.seconds or 1.0
    bit_time = 1 / baud / time_unit
    # The stop bit lasts at least half a bit. Then the next byte may follow at once.
    shortest_byte_time = (BITS_PER_BYTE - 0.5) * bit_time
    # An edge between two samples is seen at the second one, half a sample late on average.
    early = 0.5 if signals.is_sampled else 0.0
    # Times of the edges that are not used yet, and the level before them.
    edges, level = np.zeros(0), 1
    # Time from which a byte can begin.
    earliest_start = -np.inf
    end, done, is_first_part = 0.0, 0, True
    for part in _add_end_mark(signals):
        if part is not None:
            # The serial line is the only signal, so its index is 0.
            if is_first_part:
                level, is_first_part = part.levels[0], False
            edges = np.concatenate([edges, part.times[0]])
            end, done = part.end, part.done
        # The level before an edge with an even index is the first level. If that is 1, these edges fall. Otherwise, the
        # edges with an odd index fall.
        falls = edges[1 - level :: 2]
        if part is not None:
            # At the end of the capture, all edges are used. Before it, only those whose byte is complete.
            complete_count = int(np.searchsorted(falls, end - BITS_PER_BYTE * bit_time, "right"))
            falls = falls[:complete_count]
        starts = _choose_start_bits(falls, earliest_start, shortest_byte_time)
        if not len(starts):
            continue
        earliest_start = float(starts[-1]) + shortest_byte_time
        # The middle of eight data bits and the stop bit: a row for each byte, and a column for each bit.
        times = starts[:, None] + (bit_time * (1.5 + np.arange(9)) - early)[None, :]
        # An odd number of edges before a time inverts the first level.
        edge_counts = np.searchsorted(edges, times.ravel(), "right").reshape(times.shape)
        levels = (edge_counts & 1) ^ level
        values = (levels[:, :8] << np.arange(8)).sum(axis=1).astype(np.uint8)
        has_stop_bits = levels[:, 8] == 1
        yield Bytes(values, starts * time_unit, has_stop_bits, done)
        used_count = int(np.searchsorted(edges, earliest_start, "left"))
        edges, level = edges[used_count:], level ^ (used_count & 1)


def _choose_start_bits(falls: Any, earliest_start: float, shortest_byte_time: float) -> Any:
    """Return the falling edges that begin a byte: the first edge, then the first edge after each byte.

    A byte cannot begin before ``earliest_start``, or less than ``shortest_byte_time`` after the previous byte.
    """
    # For each falling edge, the index of the first one that can begin the next byte.
    next_indices = np.searchsorted(falls, falls + shortest_byte_time, "left").tolist()
    start_indices: list[int] = []
    index = int(np.searchsorted(falls, earliest_start, "left"))
    while index < len(falls):
        start_indices.append(index)
        index = next_indices[index]
    return falls[start_indices] if start_indices else np.zeros(0)


#: Headers of the tables exported by Saleae's serial analyzer, with the columns of the times and of the bytes.
_SALEAE_EXPORT_HEADERS: Final = (
    (("name", "type", "start_time", "duration", "data"), 2, 4),
    (("time [s]", "value"), 0, 1),
)


_BYTE_TEXT: Final = re.compile(r"0x([0-9a-fA-F]{1,2})|([0-9]{1,3})")


#: Number of rows of an export that are read at a time.
_ROWS_AT_ONCE: Final = 1 << 16


def find_exported_columns(head: bytes) -> tuple[int, int] | None:
    """Return the indices of the time and byte columns if a file is an export of serial bytes, otherwise None.

    ``head`` contains the first bytes of the file. Its first line must begin with a header that Saleae's serial analyzer
    writes.
    """
    first_line = head.decode("utf-8-sig", "replace").partition("\n")[0]
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
    line = 1
    # Empty rows are left out, but count as lines.
    while numbered_rows := [(line_number, row) for line_number, row in islice(rows, _ROWS_AT_ONCE) if row]:
        values = np.zeros(len(numbered_rows), np.uint8)
        times = np.zeros(len(numbered_rows))
        has_stop_bits = np.ones(len(numbered_rows), bool)
        for index, (line, row) in enumerate(numbered_rows):
            if len(row) <= max(time_column, byte_column):
                raise InputError(path, "the row ends early", place=f"line {line}")
            values[index] = _read_byte(row[byte_column], path, line)
            try:
                times[index] = float(row[time_column])
            except ValueError:
                reason = f"{short(row[time_column])} is not a time in seconds: export without time stamps of ISO 8601"
                raise InputError(path, reason, place=f"line {line}") from None
            # A byte without a stop bit has a cell that names a framing error.
            has_stop_bits[index] = not any("framing" in cell.lower() for cell in row)
        yield Bytes(values, times, has_stop_bits, line)


def _read_byte(cell: str, path: str, line: int) -> int:
    """Return the byte in a cell: hexadecimal such as ``0x1A``, or decimal.

    Raises InputError for other cells. ``line`` is the number of the line, for the error.
    """
    match = _BYTE_TEXT.fullmatch(cell.strip())
    if match is not None:
        hex_digits, decimal_digits = match.groups()
        number = int(hex_digits, 16) if hex_digits else int(decimal_digits)
        if number <= 255:
            return number
    reason = f"{short(cell)} is not a byte: export with hexadecimal numbers"
    raise InputError(path, reason, place=f"line {line}")


def _add_end_mark(signals: Signals) -> Iterator[Any]:
    """Yield the edges of a capture part by part, then None, which marks its end."""
    yield from signals.edges
    yield None
