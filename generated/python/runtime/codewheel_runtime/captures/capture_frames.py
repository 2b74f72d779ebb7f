# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Opens captures, and finds the frames in them."""

from __future__ import annotations

import os
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Literal, NamedTuple

from ..bulk.shape import FrameLayout
from ..encoder import Encoder
from ..errors import InputError, UsageError
from ..files.layouts import find_frame_kind, find_frame_layout, list_frame_kinds
from ..reports import Interface
from .any_biss import BissLayout
from .captured_frames import CapturedFrames
from .clocked import find_clocked_frames
from .probes import Probes
from .serial_bytes import find_exported_columns, read_exported_bytes, read_serial_bytes
from .signal_files import open_signals
from .signals import SignalNames, Signals, read_array
from .uart import FrameKinds, find_replies

#: Files, or an array of samples.
Captured = Any


class CaptureFrames(NamedTuple):
    """Frames of a capture.

    Attributes:
        parts: The frames, one part of the capture after another.
        layout: Their layout.
        time_column: Name of the column of times: ``time`` in seconds, or ``sample`` if the sample rate is unknown.
        total: Size of the file, if known.
    """

    parts: Generator[CapturedFrames, None, None]
    layout: FrameLayout
    time_column: str
    total: int | None


class CaptureInput(NamedTuple):
    """Capture to decode, and how to decode it.

    Attributes:
        encoder: The encoder, or a layout of BiSS frames.
        source: Files, or an array of samples.
        probes: Arguments about the connection and the timing.
        layout: Kind of the replies on a serial line, or empty for the most frequent one with a position.
        answers: Answers to the questions that the manual leaves open, by name.
        swap_lines: Exchange the clock and the data line.
    """

    encoder: Encoder | BissLayout
    source: Captured
    probes: Probes
    layout: str
    answers: Mapping[str, Any]
    swap_lines: bool = False

    @property
    def is_array(self) -> bool:
        """True if the source is an array of samples."""
        return hasattr(self.source, "dtype")


@contextmanager
def open_capture(capture_input: CaptureInput) -> Generator[CaptureFrames, None, None]:
    """Open a capture, and yield its frames.

    Raises:
        UsageError: Captures are not supported for this encoder, or an argument is invalid.
        InputError: The source is not a capture, or has no such signals.
    """
    encoder, source, probes, layout, answers, swap_lines = capture_input
    interface = encoder.interface if isinstance(encoder, Encoder) else Interface.BISS
    if interface is Interface.SPI:
        advice = "let the analyzer's own SPI decoder export the words, and decode them as a file of frames"
        raise UsageError(f"{encoder.code} has the interface SPI, whose captures are not supported: {advice}")
    if isinstance(encoder, Encoder) and encoder.exchanges():
        advice = "let the analyzer's own serial decoder export the bytes, and decode the replies as a file of frames"
        reason = f"the replies of {encoder.code} have no data ID, so they are not found in captures"
        raise UsageError(f"{reason}: {advice}")
    probes.check_numbers()
    is_serial = interface is Interface.RS485
    if isinstance(encoder, Encoder) and is_serial and not capture_input.is_array:
        paths = list_paths(source)
        columns = _find_exported_columns(paths)
        if columns is not None:
            with open(paths[0], "rb") as file:
                line = read_exported_bytes(file, paths[0], columns)
                yield _find_replies(encoder, line, paths[0], probes, layout, answers)
            return
    signal_names = probes.signal_names(has_clock=not is_serial)._replace(exchanged=swap_lines)
    with open_captured_signals(source, signal_names, probes) as (signals, name):
        yield _find_frames(encoder, signals, name, probes, layout, answers)


def _find_exported_columns(paths: Sequence[str]) -> tuple[int, int] | None:
    """Return the indices of the time and byte columns if a capture is an export of serial bytes, otherwise None."""
    if len(paths) != 1:
        return None
    with open(paths[0], "rb") as file:
        return find_exported_columns(file.read(1000))


def _find_replies(
    encoder: Encoder, line: Any, name: str, probes: Probes, layout: str, answers: Mapping[str, Any]
) -> CaptureFrames:
    """Return the replies of an encoder among the bytes on a serial line.

    The first part is read immediately, because it shows the kind of the replies, and therefore their layout. ``line``
    yields the bytes, and ``name`` is the name of the file, for errors. ``layout`` is the kind of the replies, or empty
    for the most frequent one with a position. ``answers`` are answers to open questions by name.

    Raises:
        InputError: No byte was sent. Or ``layout`` is empty, and there is no valid reply with a position.
    """
    kinds = _find_frame_kinds(encoder, layout, answers)
    parts = find_replies(line, name, _find_baud_rate(encoder, probes), kinds)
    first_part = next(parts)
    if not first_part.kind:
        raise InputError(name, f"no valid reply of {encoder.code}: check the channel, the baud rate and the code")
    return CaptureFrames(
        parts=_prepend(first_part, parts),
        layout=kinds.replies[first_part.kind],
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
) -> CaptureFrames:
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
    frame_layout = find_frame_layout(encoder, layout, answers) if isinstance(encoder, Encoder) else encoder.layout
    if frame_layout.bit_count > 64:
        raise UsageError(f"frames of {frame_layout.bit_count} bits do not fit into words of 64")
    parts = find_clocked_frames(
        signals, name, kind=interface_name, frame_bits=frame_layout.bit_count, pause=probes.shortest_pause
    )
    return CaptureFrames(parts=parts, layout=frame_layout, time_column=time_column, total=signals.total)


def _prepend(
    first: CapturedFrames, following: Generator[CapturedFrames, None, None]
) -> Generator[CapturedFrames, None, None]:
    """Yield the first part, then those that follow."""
    yield first
    yield from following


def _find_frame_kinds(encoder: Encoder, layout: str, answers: Mapping[str, Any]) -> FrameKinds:
    """Return all kinds of frames on a serial line: replies from the encoder and requests from the master.

    A kind whose description needs answers to open questions is omitted, unless ``layout`` requests it.
    ``layout`` is empty if no kind is requested.
    """
    wanted_kind = find_frame_kind(encoder, layout).name if layout else ""
    layouts_by_sender: dict[str, dict[str, FrameLayout]] = {"encoder": {}, "master": {}}
    for frame_kind in list_frame_kinds(encoder):
        is_wanted = frame_kind.name == wanted_kind
        if is_wanted or not frame_kind.answers:
            needed_answers: Mapping[str, Any] = answers if is_wanted else {}
            frame_layout = find_frame_layout(encoder, frame_kind.name, needed_answers)
            layouts_by_sender[frame_kind.sender][frame_kind.name] = frame_layout
    return FrameKinds(
        replies=layouts_by_sender["encoder"], requests=layouts_by_sender["master"], wanted_kind=wanted_kind
    )


def _find_baud_rate(encoder: Encoder, probes: Probes) -> float:
    """Return the bits per second: the baud rate in ``probes``, or the one in the manual."""
    if probes.baud:
        return probes.baud
    package, _, family = type(encoder).__module__.rpartition(".")
    facts = import_module(f"{package}.facts.{family}")
    return float(facts.RS485.port.baud)


@contextmanager
def open_captured_signals(
    source: Captured, names: SignalNames, probes: Probes
) -> Generator[tuple[Signals, str], None, None]:
    """Open the signals of files or of an array, and yield them with a name for errors."""
    if hasattr(source, "dtype"):
        yield read_array(source, names, probes.rate), "the array"
        return
    paths = list_paths(source)
    with open_signals(paths, names, probes.rate, probes.threshold) as signals:
        yield signals, paths[0] if paths else "the capture"


def list_paths(source: str | os.PathLike[str] | Sequence[str]) -> list[str]:
    """Return the paths of one or more files. Raises UsageError if the sequence is empty."""
    if isinstance(source, (str, os.PathLike)):
        return [os.fspath(source)]
    if not source:
        raise UsageError("give the file of a capture")
    return [os.fspath(path) for path in source]
