# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes the captures of logic analyzers into tables with time."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from enum import Enum
from functools import partial
from importlib import import_module
from math import isfinite
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple, Protocol

from ..bulk.decode import decode_many
from ..bulk.shape import Shape
from ..bulk.table import Table
from ..channel_tables import ChannelTable
from ..encoder import Encoder
from ..errors import InputError, UsageError
from ..files.inputs import FrameBatch, Source
from ..files.layouts import find_layout, find_shape, list_layouts
from ..files.sinks import SINKS, TargetKind
from ..files.stream import (
    Output,
    SpeedColumns,
    Summary,
    count_units,
    decode_parts,
    find_target_format,
    make_plan,
)
from ..files.targets import open_for_writing
from ..packages import load
from ..reports import Interface
from .accesses import Access, Accesses
from .any_biss import BissLayout
from .clocked import CapturedFrames, Lost, find_clocked_frames
from .signal_files import open_signals
from .signals import SignalNames, Signals, read_array
from .uart import Kinds, find_exported_columns, find_replies, read_exported_bytes, read_serial_bytes

__all__ = ["Access", "BissLayout", "Capture", "CaptureSummary", "ChannelCapture", "Lost", "Probes"]

np: Any = load("numpy")

#: Digits of a time after the decimal point, in seconds: picoseconds.
_TIME_DIGITS: Final = 12

_NO_ANSWERS: Final[Mapping[str, Enum | str]] = MappingProxyType({})
#: Maximum number of lost cycles and of accesses that a summary lists.
_MOST_LISTED: Final = 1000
#: Files, or an array of samples.
Captured = Any


class Probes(NamedTuple):
    """Connection and timing of a capture.

    Attributes:
        clock: Channel of the clock (MA), by name or by number from 1. By default, a channel with a common name.
        data: Channel of the data line (SLO), or of the serial line.
        rate: Sample rate in Hz, needed if the file does not specify it.
        rest: Shortest pause of the clock between two cycles, in seconds, or in samples if the sample rate is unknown.
            The default is 1.4 periods. Use a longer one if the master pauses within a frame.
        baud: Bits per second on a serial line, if they differ from the manual, or bits per sample if the sample rate is
            unknown.
        threshold: Voltage above which the level is 1, for a table of voltages. The default is the middle of their
            range.
    """

    clock: str | int = ""
    data: str | int = ""
    rate: float | None = None
    rest: float | None = None
    baud: float | None = None
    threshold: float | None = None

    def check(self) -> None:
        """Raise UsageError unless the rates and ``rest`` are above 0 and the threshold is finite.

        None is always accepted.
        """
        for name in ("rate", "rest", "baud"):
            number = getattr(self, name)
            if number is not None and not (_is_finite(number) and number > 0):
                raise UsageError(f"{name} must be a number above 0, got {number!r}")
        if self.threshold is not None and not _is_finite(self.threshold):
            raise UsageError(f"threshold must be a number, got {self.threshold!r}")

    def names(self, is_serial: bool) -> SignalNames:
        """Return the chosen channels of the clock and the data line, or of one serial line.

        Raises UsageError if a channel is neither a name nor a number.
        """
        for channel in (self.clock, self.data):
            if not isinstance(channel, (str, int)) or isinstance(channel, bool):
                raise UsageError(f"a channel is a name or a number from 1, got {channel!r}")
        clock = None if is_serial else str(self.clock)
        return SignalNames(clock=clock, data=str(self.data))


def _is_finite(number: object) -> bool:
    """Return whether an argument is a finite number."""
    return isinstance(number, (int, float)) and not isinstance(number, bool) and isfinite(number)


class Capture(NamedTuple):
    """Contents of a capture.

    Attributes:
        table: Columns of the frames, with ``time`` in seconds, or ``sample`` if the sample rate is unknown. The time
            of a frame is the time of the first falling edge of the clock, or of the start bit of its first byte.
        lost: Cycles or bytes that contain no frame, with the reason.
        accesses: Accesses to registers over BiSS.
        others: Number of frames of other kinds, by name.
    """

    table: Table
    lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]
    others: Mapping[str, int]


class ChannelCapture(NamedTuple):
    """Contents of a capture of BiSS frames with several data channels.

    Attributes:
        table: Table of each channel, and columns for the whole frames.
        times: Time of each frame in seconds, or in samples if the sample rate is unknown: the first falling edge of the
            clock.
        lost: Cycles that contain no frame, with the reason.
        accesses: Accesses to registers.
    """

    table: ChannelTable
    times: Any
    lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]


class CaptureSummary(NamedTuple):
    """Counts of the frames, lost cycles and register accesses in a capture.

    Attributes:
        frames: Counts of the frames.
        lost: Number of lost cycles by reason. Only the part of the reason before a colon counts.
        first_lost: The first lost cycles, at most 1000.
        accesses: The first accesses to registers, at most 1000.
        access_count: Number of accesses.
        others: Number of frames of other kinds, by name.
    """

    frames: Summary
    lost: Mapping[str, int]
    first_lost: tuple[Lost, ...]
    accesses: tuple[Access, ...]
    access_count: int
    others: Mapping[str, int]

    @property
    def error_rate(self) -> float:
        """Fraction of the cycles that contain no valid frame, from 0 to 1."""
        lost_count = sum(self.lost.values())
        cycle_count = self.frames.frames + lost_count
        invalid_count = lost_count + sum(self.frames.faults.values())
        return invalid_count / cycle_count if cycle_count else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the counts as plain values for JSON."""
        accesses = [access._asdict() for access in self.accesses]
        lost = [cycle._asdict() for cycle in self.first_lost]
        counts = {"lost": dict(self.lost), "first_lost": lost, "accesses": accesses, "others": dict(self.others)}
        return self.frames.to_dict() | counts

    def __str__(self) -> str:
        lost = sum(self.lost.values())
        parts = [str(self.frames), f"{lost} lost"]
        if self.access_count:
            # ``count_units`` only adds an s.
            parts.append(count_units(self.access_count, "register access").replace("accesss", "accesses"))
        parts += [f"{count} {name}" for name, count in self.others.items()]
        return ", ".join(parts)


class _Log:
    """Log of the lost cycles, accesses and other frames that are found while a capture is decoded."""

    def __init__(self, limit: int | None) -> None:
        # At most this number of lost cycles and of accesses is kept, or all of them if it is None.
        self._limit = limit
        self.lost: list[Lost] = []
        self.accesses: list[Access] = []
        #: Number of all accesses, of all lost cycles by reason, and of frames of other kinds by name.
        self.access_count = 0
        self.reasons: dict[str, int] = {}
        self.others: dict[str, int] = {}
        self._finder = Accesses()

    def add(self, part: CapturedFrames) -> None:
        """Count the lost cycles, accesses and frames of other kinds in a part of the capture."""
        for cycle in part.lost:
            # After the colon, a reason quotes the received bytes, which differ each time.
            reason, _, _ = cycle.reason.partition(":")
            self.reasons[reason] = self.reasons.get(reason, 0) + 1
        # Number of lost cycles that can still be kept, or None for all of them.
        free_places = None if self._limit is None else max(self._limit - len(self.lost), 0)
        self.lost += part.lost[:free_places]
        for name, count in part.others.items():
            self.others[name] = self.others.get(name, 0) + count
        if part.control is not None:
            self._add_accesses(self._finder.feed(part.control))

    def finish(self) -> None:
        """Add the access that the end of the capture cuts off."""
        self._add_accesses(self._finder.finish())

    def _add_accesses(self, accesses: Any) -> None:
        """Count accesses, and keep the first ones."""
        for access in accesses:
            self.access_count += 1
            if self._limit is None or len(self.accesses) < self._limit:
                self.accesses.append(access)


class _CaptureFrames(NamedTuple):
    """Frames of a capture.

    Attributes:
        parts: The frames, one part of the capture after another.
        shape: Their description.
        time_column: Name of the column of times: ``time`` in seconds, or ``sample`` if the sample rate is unknown.
        total: Size of the file, if known.
    """

    parts: Generator[CapturedFrames, None, None]
    shape: Shape
    time_column: str
    total: int | None


@contextmanager
def _open_capture(
    encoder: Encoder | BissLayout,
    source: Captured,
    probes: Probes,
    layout: str,
    answers: Mapping[str, Any],
    swap_lines: bool = False,
) -> Generator[_CaptureFrames, None, None]:
    """Open a capture, and yield its frames. With ``swap_lines``, the clock and the data line are exchanged.

    Args:
        encoder: The encoder, or a layout of BiSS frames.
        source: Files, or an array of samples.
        probes: Arguments about the connection and the timing.
        layout: Kind of the replies on a serial line, or empty for the most frequent one with a position.
        answers: Answers to the questions that the manual leaves open, by name.
        swap_lines: Use the clock as the data line and the data line as the clock.

    Raises:
        UsageError: Captures are not supported for this encoder, or an argument is invalid.
        InputError: The source is not a capture, or has no such signals.
    """
    interface = encoder.interface if isinstance(encoder, Encoder) else Interface.BISS
    if interface is Interface.SPI:
        how = "let the analyzer's own SPI decoder export the words, and decode them as a file of frames"
        raise UsageError(f"{encoder.code} has the interface SPI, whose captures are not supported: {how}")
    if isinstance(encoder, Encoder) and encoder.exchanges():
        how = "let the analyzer's own serial decoder export the bytes, and decode the replies as a file of frames"
        raise UsageError(f"the replies of {encoder.code} have no data ID, so they are not found in captures: {how}")
    probes.check()
    is_serial = interface is Interface.RS485
    is_array = hasattr(source, "dtype")
    if isinstance(encoder, Encoder) and is_serial and not is_array:
        paths = _list_paths(source)
        columns = _find_exported_columns(paths)
        if columns is not None:
            with open(paths[0], "rb") as file:
                line = read_exported_bytes(file, paths[0], columns)
                yield _find_replies(encoder, line, paths[0], probes, layout, answers)
            return
    names = probes.names(is_serial)._replace(exchanged=swap_lines)
    with _open_signals(source, names, probes) as (signals, name):
        yield _find_frames(encoder, signals, name, probes, layout, answers)


def _find_exported_columns(paths: Sequence[str]) -> tuple[int, int] | None:
    """Return the indices of the time and byte columns if a capture is an export of serial bytes, otherwise None."""
    if len(paths) != 1:
        return None
    with open(paths[0], "rb") as file:
        return find_exported_columns(file.read(1000))


def _find_replies(
    encoder: Encoder, line: Any, name: str, probes: Probes, layout: str, answers: Mapping[str, Any]
) -> _CaptureFrames:
    """Return the replies of an encoder among the bytes on a serial line.

    The first part is read at once, because it shows the kind of the replies, and therefore their shape. ``line`` yields
    the bytes, and ``name`` is the name of the file, for errors. ``layout`` is the kind of the replies, or empty for the
    most frequent one with a position. ``answers`` are answers to open questions by name.

    Raises:
        InputError: No byte was sent. Or ``layout`` is empty, and there is no valid reply with a position.
    """
    kinds = _find_frame_kinds(encoder, layout, answers)
    parts = find_replies(line, name, _find_baud_rate(encoder, probes), kinds)
    first_part = next(parts)
    if not first_part.kind:
        raise InputError(name, "", f"no valid reply of {encoder.code}: check the channel, the baud rate and the code")
    return _CaptureFrames(
        parts=_prepend(first_part, parts),
        shape=kinds.replies[first_part.kind],
        time_column="time",
        total=None,
    )


def _find_frames(
    encoder: Encoder | BissLayout,
    signals: Signals,
    name: str,
    probes: Probes,
    layout: str,
    answers: Mapping[str, Any],
) -> _CaptureFrames:
    """Return the frames in the signals of a capture, with the column ``time``, or ``sample`` without a sample rate.

    ``name`` is the name of the file, for errors. ``layout`` is the kind of the frames, or empty. ``answers`` are
    answers to open questions by name.

    Raises:
        UsageError: A frame has more than 64 bits.
    """
    time_column = "sample" if signals.seconds is None else "time"
    if isinstance(encoder, Encoder) and encoder.interface is Interface.RS485:
        line = read_serial_bytes(signals, _find_baud_rate(encoder, probes))
        frames = _find_replies(encoder, line, name, probes, layout, answers)
        return frames._replace(time_column=time_column, total=signals.total)
    is_ssi = isinstance(encoder, Encoder) and encoder.interface is Interface.SSI
    interface_name: Literal["biss", "ssi"] = "ssi" if is_ssi else "biss"
    shape = find_shape(encoder, layout, answers) if isinstance(encoder, Encoder) else encoder.shape
    if shape.bits > 64:
        raise UsageError(f"frames of {shape.bits} bits do not fit into words of 64")
    parts = find_clocked_frames(signals, name, interface_name, shape.bits, probes.rest)
    return _CaptureFrames(parts, shape, time_column, total=signals.total)


def _prepend(
    first: CapturedFrames, following: Generator[CapturedFrames, None, None]
) -> Generator[CapturedFrames, None, None]:
    """Yield the first part, then those that follow."""
    yield first
    yield from following


def _find_frame_kinds(encoder: Encoder, layout: str, answers: Mapping[str, Any]) -> Kinds:
    """Return all kinds of frames on a serial line: replies from the encoder and requests from the master.

    A kind whose description needs answers to open questions is left out, unless it is the one that ``layout`` requests.
    ``layout`` is empty if no kind is requested.
    """
    wanted = find_layout(encoder, layout).name if layout else ""
    shapes: dict[str, dict[str, Shape]] = {"encoder": {}, "master": {}}
    for frame_layout in list_layouts(encoder):
        is_wanted = frame_layout.name == wanted
        if is_wanted or not frame_layout.answers:
            layout_answers: Mapping[str, Any] = answers if is_wanted else {}
            shape = find_shape(encoder, frame_layout.name, layout_answers)
            shapes[frame_layout.sender][frame_layout.name] = shape
    return Kinds(replies=shapes["encoder"], requests=shapes["master"], wanted=wanted)


def _find_baud_rate(encoder: Encoder, probes: Probes) -> float:
    """Return the bits per second: the baud rate in ``probes``, or the one in the manual."""
    if probes.baud:
        return probes.baud
    package, _, family = type(encoder).__module__.rpartition(".")
    facts = import_module(f"{package}.facts.{family}")
    return float(facts.RS485.port.baud)


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

        Formats are sigrok sessions, CSV from sigrok and Saleae, Saleae binary files, the bytes that Saleae's serial
        analyzer exports, VCD, NumPy files (``.npy``, ``.npz``), and tables of 0 and 1 or of voltages. They are
        recognized by their contents. Times of time stamps are in seconds from the first stamp.

        Args:
            encoder: The encoder, its label, or a layout of BiSS frames (``biss_layout``).
            source: The file, or two Saleae binary files, first the clock and then the data line. Or an
                array of samples: one row per sample with one column of 0 and 1 per channel, or one number per sample
                whose bits are the channels.
            clock: Channel of the clock (MA), by name or by number from 1.
            data: Channel of the data line (SLO), or of the serial line. By default, both are channels with common
                names.
            rate: Sample rate in Hz, needed if the source does not specify it.
            rest: Shortest pause of the clock between two cycles, in seconds, or in samples if the sample rate is
                unknown. The default is 1.4 periods of the clock.
            baud: Bits per second on a serial line, if they differ from the manual, or bits per sample if the sample
                rate is unknown.
            threshold: Voltage above which the level is 1, for a table of voltages. The default is the middle of their
                range.
            layout: Kind of the replies, if there are several. The default is the most frequent one with a position.
            answers: Answers to the questions that the manual leaves open, by name.

        Returns:
            The frames with their times, lost cycles, and accesses to registers.

        Raises:
            InputError: The source is not a capture, or does not contain such signals. The message says what to do.
            UsageError: The arguments are wrong or incompatible with each other.
            OSError: A file cannot be read.
        """
        return _read_capture(
            self._find_encoder(encoder), source, Probes(clock, data, rate, rest, baud, threshold), layout, answers
        )

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
        chosen_encoder = self._find_encoder(encoder)
        output = Output(os.fspath(target), find_target_format(target, to), columns, raw, force, si)
        sources = _list_paths(source)
        probes = Probes(clock, data, rate, rest, baud, threshold)
        opening = _open_capture(chosen_encoder, source, probes, layout, answers)
        report = partial(_report_exchanged_lines, chosen_encoder, source, probes, layout, answers)
        return _decode_capture(opening, chosen_encoder, sources, output, limit, progress, report)

    def _find_encoder(self, encoder: Encoder | BissLayout | str) -> Encoder | BissLayout:
        """Return the encoder for a label. Other arguments are returned unchanged."""
        if not isinstance(encoder, str):
            return encoder
        variant: Encoder = import_module(self.package).lookup(encoder)
        return variant


class _Channels(Protocol):
    """Layout of frames with several data channels, a ``ChannelLayout``, whose module imports this one."""

    @property
    def bits(self) -> int: ...

    def decode_many(self, frames: object) -> ChannelTable: ...


def read_channel_capture(layout: _Channels, source: Captured, probes: Probes) -> ChannelCapture:
    """Decode a capture of BiSS frames with several data channels. ``source`` is its files, or an array of samples."""
    probes.check()
    names = probes.names(is_serial=False)
    log = _Log(None)
    frames: list[Any] = []
    times: list[Any] = []
    with _open_signals(source, names, probes) as (signals, name):
        for part in find_clocked_frames(signals, name, "biss", layout.bits, probes.rest):
            log.add(part)
            frames.append(part.frames)
            times.append(_round_times(part.times))
    log.finish()
    table = layout.decode_many(np.concatenate(frames))
    return ChannelCapture(table, np.concatenate(times), tuple(log.lost), tuple(log.accesses))


@contextmanager
def _open_signals(source: Captured, names: SignalNames, probes: Probes) -> Generator[tuple[Signals, str], None, None]:
    """Open the signals of files or of an array, and yield them with a name for errors."""
    if hasattr(source, "dtype"):
        yield read_array(source, names, probes.rate), "the array"
        return
    paths = _list_paths(source)
    with open_signals(paths, names, probes.rate, probes.threshold) as signals:
        yield signals, paths[0] if paths else "the capture"


def _read_capture(
    encoder: Encoder | BissLayout, source: Captured, probes: Probes, layout: str, answers: Mapping[str, Enum | str]
) -> Capture:
    """Decode a capture into one table.

    Raises InputError if the source is not a capture, and if no frame is valid because the clock and the data line are
    exchanged.
    """
    log = _Log(None)
    frames: list[Any] = []
    times: list[Any] = []
    with _open_capture(encoder, source, probes, layout, answers) as capture_frames:
        # If no frame is found, or none is valid, the lines may be exchanged. If so, that error is raised instead.
        try:
            for part in capture_frames.parts:
                log.add(part)
                frames.append(part.frames)
                times.append(_round_times(part.times))
        except InputError:
            _report_exchanged_lines(encoder, source, probes, layout, answers)
            raise
    log.finish()
    table = decode_many(np.concatenate(frames), capture_frames.shape, encoder)
    if not table.ok.any():
        _report_exchanged_lines(encoder, source, probes, layout, answers)
    table = table.with_columns(**{capture_frames.time_column: np.concatenate(times)})
    return Capture(table, tuple(log.lost), tuple(log.accesses), log.others)


def _report_exchanged_lines(
    encoder: Encoder | BissLayout, source: Captured, probes: Probes, layout: str, answers: Mapping[str, Enum | str]
) -> None:
    """Raise InputError if a capture has valid frames with the clock and the data line exchanged, otherwise do nothing.

    The caller has found no valid frames. With the lines exchanged, more than nine in ten of the first cycles must be
    valid.
    """
    if isinstance(encoder, Encoder) and encoder.interface not in (Interface.BISS, Interface.SSI):
        return
    frame_count = valid_count = lost_count = 0
    with suppress(InputError), _open_capture(encoder, source, probes, layout, answers, swap_lines=True) as swapped:
        for part in swapped.parts:
            valid_count += int(decode_many(part.frames, swapped.shape, encoder).ok.sum())
            frame_count += len(part.frames)
            lost_count += len(part.lost)
            if frame_count > _MOST_LISTED:
                break
    invalid_count = frame_count - valid_count + lost_count
    are_most_valid = valid_count > 9 * invalid_count
    # One frame can be valid by chance.
    if valid_count > 1 and are_most_valid:
        name = "the array" if hasattr(source, "dtype") else _list_paths(source)[0]
        reason = "the clock and the data line are exchanged: no frame is valid"
        raise InputError(name, "", f"{reason}, but {valid_count} are if you exchange the two channels")


def _decode_capture(
    opening: AbstractContextManager[_CaptureFrames],
    encoder: Encoder | BissLayout,
    sources: list[str],
    output: Output,
    limit: int | None,
    progress: Callable[[int, int | None, int], None] | None,
    report_exchanged_lines: Callable[[], None],
) -> CaptureSummary:
    """Decode a capture into a file of columns, in bounded memory, and return the counts.

    ``opening`` opens the capture, and ``sources`` are its files. ``limit`` is the maximum number of frames, and
    ``progress`` is called from time to time with the amount read, the total if known, and the number of frames. If no
    frame is valid, ``report_exchanged_lines`` can raise InputError. Raises UsageError if the frames have a field with
    the name of the column of times.
    """
    log = _Log(_MOST_LISTED)
    with opening as capture_frames, open_for_writing(output.target, sources, output.force) as file:
        time_column = capture_frames.time_column
        time_columns = {time_column: np.zeros(0)}
        # A table without frames, which shows the columns of the result.
        empty_table = decode_many([], capture_frames.shape, encoder)
        if time_column in empty_table:
            raise UsageError(f"the frames have a field '{time_column}', but this is the column of times")
        empty_table = empty_table.with_columns(**time_columns)
        add_columns = SpeedColumns(time_column, sources[0]) if output.si else None
        if add_columns is not None:
            empty_table = add_columns.check(empty_table)
        frame_source = Source(_make_batches(capture_frames, log), capture_frames.total, (time_column,), time_columns)
        plan = make_plan(empty_table, frame_source, output.columns, sources[0], output.raw)
        with SINKS[output.kind](file, plan) as sink:
            try:
                frames = decode_parts(frame_source, capture_frames.shape, encoder, sink, limit, progress, add_columns)
            except InputError:
                report_exchanged_lines()
                raise
        has_no_valid_frame = frames.frames == sum(frames.faults.values())
        if has_no_valid_frame:
            report_exchanged_lines()
    log.finish()
    return CaptureSummary(
        frames=frames,
        lost=log.reasons,
        first_lost=tuple(log.lost),
        accesses=tuple(log.accesses),
        access_count=log.access_count,
        others=log.others,
    )


def _list_paths(source: str | os.PathLike[str] | Sequence[str]) -> list[str]:
    """Return the paths of one or more files. Raises UsageError if the sequence is empty."""
    if isinstance(source, (str, os.PathLike)):
        return [os.fspath(source)]
    if not source:
        raise UsageError("give the file of a capture")
    return [os.fspath(path) for path in source]


def _make_batches(capture_frames: _CaptureFrames, log: _Log) -> Generator[FrameBatch, None, None]:
    """Yield the frames with their times, and add each part of the capture to the log."""
    for part in capture_frames.parts:
        log.add(part)
        yield FrameBatch(part.frames, part.done, {capture_frames.time_column: _round_times(part.times)})


def _round_times(seconds: Any) -> Any:
    """Return times without rounding errors of the computation, such as 3e-05 for 2.9999999999999997e-05."""
    return np.round(seconds, _TIME_DIGITS)
