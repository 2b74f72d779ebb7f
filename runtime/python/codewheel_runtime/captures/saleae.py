# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads Saleae's binary files."""

from __future__ import annotations

import struct
from collections.abc import Generator, Sequence
from typing import Any, BinaryIO, Final

from ..errors import InputError
from ..packages import load
from .signal_text import measure_size
from .signals import SAMPLES, SignalEdges, Signals, merge_edges

np: Any = load("numpy")

#: Identification at the beginning of a file.
SALEAE_HEADER: Final = b"<SALEAE>"
#: Number of edges that are read at a time. Each takes eight bytes.
_EDGES_AT_ONCE: Final = SAMPLES // 8


class _Saleae:
    """Binary file of one digital channel, version 0 or 1. Version 1 has several chunks with gaps between them.

    ``chunks`` is their number. ``end`` is the latest end of the chunks read so far, in seconds. ``_start`` is the
    beginning of the last chunk. ``_first_chunk_header`` contains the first level and the number of edges of the first
    chunk, whose header is read when the file is opened.
    """

    def __init__(self, file: BinaryIO, path: str) -> None:
        self._file = file
        self._path = path
        # Eight bytes of identification, then two numbers. Kind 0 is a digital channel.
        version, channel_kind = struct.unpack("<8xii", self._read_exactly(16))
        is_digital = channel_kind == 0
        if not is_digital:
            raise InputError(path, "this Saleae file has analog values: export the digital channels")
        if version not in (0, 1):
            raise InputError(path, f"Saleae's binary format {version} is not supported: export as CSV")
        self._has_rate = version == 1
        self.chunks = 1
        if self._has_rate:
            (self.chunks,) = struct.unpack("<Q", self._read_exactly(8))
        # The latest end of a chunk so far, in seconds. The first level and the number of edges of the first chunk.
        self.end = 0.0
        self._first_chunk_header = (0, 0)
        if self.chunks:
            self._first_chunk_header = self._read_chunk_header()

    def _read_exactly(self, size: int) -> bytes:
        """Return the next ``size`` bytes. Raises InputError if there are fewer bytes."""
        data = self._file.read(size)
        if len(data) != size:
            raise InputError(self._path, "this Saleae file ends early")
        return data

    def _read_chunk_header(self) -> tuple[int, int]:
        """Read the header of the next chunk. Return its first level, and the number of the edges that follow.

        Raises InputError if the header is damaged.
        """
        # First level, sample rate in version 1, begin, end and number of edges.
        header_format = "<IdddQ" if self._has_rate else "<IddQ"
        header = struct.Struct(header_format)
        # The sample rate is not used, because times are in seconds.
        level, *_, begin, end, count = header.unpack(self._read_exactly(header.size))
        if not (np.isfinite(begin) and np.isfinite(end)) or level > 1:
            raise InputError(self._path, "this Saleae file is damaged")
        self._start = begin
        self.end = max(self.end, end)
        return int(level), int(count)

    def edges(self) -> Generator[SignalEdges, None, None]:
        """Yield the edges part by part. The amount read is the number of bytes so far.

        The first part has no edges, but shows the level at the beginning.
        """
        last_time = -np.inf
        level, _ = self._first_chunk_header
        yield SignalEdges(level, np.zeros(0), amount_read=self._file.tell())
        for chunk_index in range(self.chunks):
            # The header of the first chunk has already been read.
            first_level, count = self._first_chunk_header if chunk_index == 0 else self._read_chunk_header()
            if self._start < last_time:
                raise InputError(self._path, "the parts of this Saleae file are not in ascending order")
            if first_level != level:
                # The signal changed in the gap before this chunk, which is reported as an edge at its start.
                level_before = level
                level = first_level
                last_time = self._start
                yield SignalEdges(level_before, np.array([self._start]), amount_read=self._file.tell())
            while count:
                read_count = min(count, _EDGES_AT_ONCE)
                edge_times = self._read_edge_times(read_count, last_time)
                yield SignalEdges(level, edge_times, amount_read=self._file.tell())
                count -= read_count
                last_time = float(edge_times[-1])
                # An odd number of edges inverts the level.
                level ^= read_count & 1
        if self._file.read(1):
            raise InputError(self._path, "this Saleae file is damaged: more bytes follow its last edge")

    def _read_edge_times(self, count: int, last_time: float) -> Any:
        """Return the next ``count`` edge times.

        Raises InputError unless they are in ascending order, starting at ``last_time``.
        """
        # The time of each edge is a number of eight bytes.
        edge_times = np.frombuffer(self._read_exactly(8 * count), "<f8")
        are_finite = np.isfinite(edge_times).all()
        if not are_finite or edge_times[0] < last_time or (np.diff(edge_times) < 0).any():
            raise InputError(self._path, "the times of this Saleae file are not in ascending order")
        return edge_times


def read_saleae(files: Sequence[BinaryIO], paths: Sequence[str]) -> Signals:
    """Return the signals of Saleae's binary files, one per file."""
    readers = [_Saleae(file, path) for file, path in zip(files, paths, strict=True)]
    edge_streams = [reader.edges() for reader in readers]
    edges = merge_edges(edge_streams, end=lambda: max(reader.end for reader in readers))
    return Signals(edges, seconds=1.0, is_sampled=False, total=sum(map(measure_size, files)))
