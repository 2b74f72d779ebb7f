# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes the captures of logic analyzers into tables with time."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import suppress
from enum import Enum
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final, NamedTuple, Protocol

from ..bulk.decode import decode_many
from ..bulk.table import Table
from ..channel_tables import ChannelTable
from ..encoder import Encoder
from ..errors import InputError, UsageError
from ..files.inputs import FrameBatch, Source
from ..files.sinks import SINKS, TargetKind
from ..files.stream import (
    Output,
    SpeedColumns,
    Summary,
    decode_parts,
    find_target_format,
    make_plan,
)
from ..files.targets import open_for_writing
from ..packages import load
from ..reports import Interface
from .accesses import Access
from .any_biss import BissLayout
from .capture_frames import Captured, CaptureFrames, CaptureInput, list_paths, open_capture, open_captured_signals
from .captured_frames import Lost
from .clocked import find_clocked_frames
from .contents import Capture, CaptureSummary, ChannelCapture, Log
from .probes import Probes

__all__ = ["Access", "BissLayout", "Capture", "CaptureSummary", "ChannelCapture", "Lost", "Probes"]

np: Any = load("numpy")

#: Number of decimals of a time in seconds: picoseconds.
_TIME_DIGITS: Final = 12

_NO_ANSWERS: Final[Mapping[str, Enum | str]] = MappingProxyType({})
#: Maximum number of lost cycles and of accesses that a summary lists.
_MOST_LISTED: Final = 1000


class Captures(NamedTuple):
    """Functions that decode captures. Labels are looked up in the package ``package``."""

    package: str

    def read_capture(
        self,
        encoder: Encoder | BissLayout | str,
        source: Captured,
        *,
        clock: str | int = "",
        data: str | int = "",
        rate: float | None = None,
        rest: float | None = None,
        baud: float | None = None,
        threshold: float | None = None,
        layout: str = "",
        answers: Mapping[str, Enum | str] = _NO_ANSWERS,
    ) -> Capture:
        """Decode a capture of a logic analyzer. Needs NumPy.

        The contents show the format: sigrok, Saleae (including serial bytes), VCD, NumPy, or tables of levels or volts.

        Args:
            encoder: The encoder, its label, or a layout of BiSS frames (``biss_layout``).
            source: The file, two Saleae binary files (clock, data), or an array with a row or a number per sample.
            clock: Channel of the clock (MA), by name or by number from 1. The default is a channel with a usual name.
            data: Channel of the data line (SLO) or of the serial line, in the same way.
            rate: Sample rate in Hz, needed if the source does not specify it.
            rest: Shortest pause of the clock between two cycles, in seconds (samples if the rate is unknown).
            baud: Bits per second, or per sample if the rate is unknown. The default is the rate in the manual.
            threshold: Voltage above which the level is 1. The default is the middle of the voltages.
            layout: Kind of the replies, if there are several. The default is the most frequent one with a position.
            answers: Answers to the questions that the manual leaves open, by name.

        Returns:
            The frames with their times, lost cycles, and accesses to registers.

        Raises:
            InputError: The source is not a capture, or lacks such signals.
            UsageError: The arguments are wrong or incompatible with each other.
            OSError: A file cannot be read.
        """
        probes = Probes(clock, data, rate, rest, baud, threshold)
        return _read_capture(CaptureInput(self._find_encoder(encoder), source, probes, layout, answers))

    def decode_capture(
        self,
        encoder: Encoder | BissLayout | str,
        source: str | os.PathLike[str] | Sequence[str],
        target: str | os.PathLike[str],
        *,
        clock: str | int = "",
        data: str | int = "",
        rate: float | None = None,
        rest: float | None = None,
        baud: float | None = None,
        threshold: float | None = None,
        layout: str = "",
        answers: Mapping[str, Enum | str] = _NO_ANSWERS,
        si: bool = False,
        to: TargetKind | None = None,
        columns: Sequence[str] = (),
        limit: int | None = None,
        raw: bool = False,
        force: bool = False,
        progress: Callable[[int, int | None, int], None] | None = None,
    ) -> CaptureSummary:
        """Decode a capture of a logic analyzer into a file of columns, in bounded memory.

        Args:
            encoder, source, clock, data, rate, rest, baud, threshold, layout, answers: See ``read_capture``.
            target: The file to write, or ``-`` for CSV on standard output.
            si: Also write the position and the speed in SI units.
            to, columns, limit, raw, force, progress: See ``decode_file``.

        Returns:
            The number of frames, errors and verdicts, and the lost cycles.

        Raises:
            InputError, UsageError, OSError: See ``read_capture``.
        """
        output = Output(os.fspath(target), find_target_format(target, to), columns, raw, force, si)
        probes = Probes(clock, data, rate, rest, baud, threshold)
        capture_input = CaptureInput(self._find_encoder(encoder), source, probes, layout, answers)
        return _decode_capture(capture_input, output, limit, progress)

    def _find_encoder(self, encoder: Encoder | BissLayout | str) -> Encoder | BissLayout:
        """Return the encoder for a label. Other arguments are returned unchanged."""
        if not isinstance(encoder, str):
            return encoder
        found_encoder: Encoder = import_module(self.package).lookup(encoder)
        return found_encoder


class _Channels(Protocol):
    """Layout of frames with several data channels: a ``ChannelLayout``, whose module imports this one."""

    @property
    def bits(self) -> int: ...

    def decode_many(self, frames: object) -> ChannelTable: ...


def read_channel_capture(layout: _Channels, source: Captured, probes: Probes) -> ChannelCapture:
    """Decode a capture of BiSS frames with several data channels. ``source`` is its files, or an array of samples."""
    probes.check_numbers()
    signal_names = probes.signal_names(has_clock=True)
    log = Log(limit=None)
    frames_of_parts: list[Any] = []
    times_of_parts: list[Any] = []
    with open_captured_signals(source, signal_names, probes) as (signals, file_name):
        parts = find_clocked_frames(
            signals, file_name, kind="biss", frame_bits=layout.bits, pause=probes.shortest_pause
        )
        for part in parts:
            log.add(part)
            frames_of_parts.append(part.frames)
            times_of_parts.append(_round_times(part.times))
    log.finish()
    return ChannelCapture(
        table=layout.decode_many(np.concatenate(frames_of_parts)),
        times=np.concatenate(times_of_parts),
        lost=tuple(log.lost_cycles),
        accesses=tuple(log.accesses),
    )


def _read_capture(capture_input: CaptureInput) -> Capture:
    """Decode a capture into one table.

    Raises InputError if the source is not a capture, and if no frame is valid because the clock and the data line are
    exchanged.
    """
    log = Log(limit=None)
    frames: list[Any] = []
    times: list[Any] = []
    with open_capture(capture_input) as capture_frames:
        # If no frame is found, or none is valid, the lines may be exchanged. If so, that error is raised instead.
        try:
            for part in capture_frames.parts:
                log.add(part)
                frames.append(part.frames)
                times.append(_round_times(part.times))
        except InputError:
            _report_exchanged_lines(capture_input)
            raise
    log.finish()
    table = decode_many(np.concatenate(frames), capture_frames.layout, capture_input.encoder)
    if not table.ok.any():
        _report_exchanged_lines(capture_input)
    table = table.with_columns(**{capture_frames.time_column: np.concatenate(times)})
    return Capture(table=table, lost=tuple(log.lost_cycles), accesses=tuple(log.accesses), others=log.other_frames)


def _report_exchanged_lines(capture_input: CaptureInput) -> None:
    """Raise InputError if a capture has valid frames when the clock and the data line are exchanged.

    The caller has found no valid frames. With the lines exchanged, more than 90 % of the first cycles must be valid.
    """
    encoder = capture_input.encoder
    if isinstance(encoder, Encoder) and encoder.interface not in (Interface.BISS, Interface.SSI):
        return
    frame_count = valid_count = lost_count = 0
    with suppress(InputError), open_capture(capture_input._replace(swap_lines=True)) as swapped:
        for part in swapped.parts:
            table = decode_many(part.frames, swapped.layout, encoder)
            valid_count += int(table.ok.sum())
            frame_count += len(part.frames)
            lost_count += len(part.lost)
            if frame_count > _MOST_LISTED:
                break
    invalid_count = frame_count - valid_count + lost_count
    are_most_valid = valid_count > 9 * invalid_count
    # One frame can be valid by chance.
    if valid_count > 1 and are_most_valid:
        source_name = "the array" if capture_input.is_array else list_paths(capture_input.source)[0]
        reason = "the clock and the data line are exchanged: no frame is valid"
        raise InputError(source_name, f"{reason}, but {valid_count} are if you exchange the two channels")


def _decode_capture(
    capture_input: CaptureInput,
    output: Output,
    limit: int | None,
    progress: Callable[[int, int | None, int], None] | None,
) -> CaptureSummary:
    """Decode a capture into a file of columns, in bounded memory, and return the counts.

    ``limit`` is the maximum number of frames, and ``progress`` is called from time to time with the amount read, the
    total if known, and the number of frames. Raises UsageError if the frames have a field with the name of the column
    of times, and InputError if no frame is valid because the clock and the data line are exchanged.
    """
    log = Log(limit=_MOST_LISTED)
    encoder = capture_input.encoder
    paths = list_paths(capture_input.source)
    with open_capture(capture_input) as capture_frames, open_for_writing(output.target, paths, output.force) as file:
        time_column = capture_frames.time_column
        speed_columns = SpeedColumns(time_column, paths[0]) if output.si else None
        empty_table = _make_empty_table(capture_frames, encoder, speed_columns)
        time_columns = {time_column: np.zeros(0)}
        frame_source = Source(_make_batches(capture_frames, log), capture_frames.total, (time_column,), time_columns)
        plan = make_plan(empty_table, frame_source, output.columns, paths[0], output.raw)
        with SINKS[output.kind](file, plan) as sink:
            try:
                layout = capture_frames.layout
                frames = decode_parts(frame_source, layout, encoder, sink, limit, progress, speed_columns)
            except InputError:
                _report_exchanged_lines(capture_input)
                raise
        has_no_valid_frame = frames.frames == sum(frames.faults.values())
        if has_no_valid_frame:
            _report_exchanged_lines(capture_input)
    log.finish()
    return _summarize(frames, log)


def _make_empty_table(
    capture_frames: CaptureFrames, encoder: Encoder | BissLayout, speed_columns: SpeedColumns | None
) -> Table:
    """Return a table without frames, which shows the columns of the result.

    ``speed_columns`` adds the columns in SI units. It is None if they are not requested.

    Raises UsageError if the frames have a field with the name of the column of times.
    """
    time_column = capture_frames.time_column
    table = decode_many([], capture_frames.layout, encoder)
    if time_column in table:
        raise UsageError(f"the frames have a field '{time_column}', but this is the column of times")
    table = table.with_columns(**{time_column: np.zeros(0)})
    return table if speed_columns is None else speed_columns.extend_empty(table)


def _summarize(frames: Summary, log: Log) -> CaptureSummary:
    """Return the counts of frames together with the lost cycles and the register accesses in the log.

    The log lists only the first lost cycles and accesses, but counts all of them.
    """
    return CaptureSummary(
        frames=frames,
        lost=log.lost_by_reason,
        first_lost=tuple(log.lost_cycles),
        accesses=tuple(log.accesses),
        access_count=log.access_count,
        others=log.other_frames,
    )


def _make_batches(capture_frames: CaptureFrames, log: Log) -> Generator[FrameBatch, None, None]:
    """Yield the frames with their times, and add each part of the capture to the log."""
    for part in capture_frames.parts:
        log.add(part)
        yield FrameBatch(part.frames, part.amount_read, {capture_frames.time_column: _round_times(part.times)})


def _round_times(seconds: Any) -> Any:
    """Return times without the rounding errors of the computation, such as 3e-05 for 2.9999999999999997e-05."""
    return np.round(seconds, _TIME_DIGITS)
