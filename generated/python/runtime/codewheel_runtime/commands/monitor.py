# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command that shows an encoder over RS-485 live in a terminal, and records its readings."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections import Counter, deque
from contextlib import nullcontext
from time import monotonic, sleep
from typing import Any, NamedTuple, Protocol, TextIO

from ..codec import PositionRange
from ..encoder import Encoder
from ..link import LinkError, open_encoder
from ..reports import Interface
from .common import USAGE, CommandFailed, find_encoder, show_progress
from .record import RecordedReading, Recorder, open_recorder

#: Number of updates of the screen per second.
_UPDATES_PER_SECOND = 10
#: Time over which the speed and the rate are measured.
_SPAN_S = 0.5
#: Number of consecutive failures after which to give up if the encoder has never answered.
_GIVEN_UP = 10


class Reader(Protocol):
    """Source of frames, such as a link."""

    def read(self) -> Any:
        """Return a frame. Raises RuntimeError if no frame is valid."""
        ...


class Readings(NamedTuple):
    """Number of readings, and number of failed readings."""

    total: int
    failures: int


def monitor(package: str, options: argparse.Namespace) -> None:
    """Show live readings of an encoder, and record them.

    Raises:
        CommandFailed: The encoder has no RS-485, it never answered, or more readings failed than ``--max-errors``
            allows.
    """
    encoder = find_encoder(package, options)
    if encoder.interface is not Interface.RS485:
        is_spi = encoder.interface is Interface.SPI
        advice = "export the words that it finds, and use 'decode'" if is_spi else "use 'capture'"
        problem = f"{encoder.code} has the interface {encoder.interface.title}, and a serial port cannot send its clock"
        raise CommandFailed(f"{problem}: record it with a logic analyzer, and {advice}", USAGE)
    # On a terminal, readings are shown. In a pipe, they are written as a table.
    target = options.output if options.output or sys.stdout.isatty() else "-"
    screen_file = sys.stderr if target == "-" else sys.stdout
    try:
        with (
            show_progress(package, options.port),
            open_recorder(target, options.write, options.force) if target else nullcontext() as recorder,
            # Without retries, every error is counted.
            open_encoder(options.port, encoder, retries=0) as link,
        ):
            readings = watch(
                link,
                encoder,
                options.port,
                count=options.count,
                interval_s=options.interval,
                out=screen_file,
                recorder=recorder,
                is_shown=target != "-",
            )
    except LinkError as error:
        raise CommandFailed(error) from None
    if 100 * readings.failures > options.max_errors * readings.total:
        failures_text = f"{readings.failures} of {readings.total} readings failed"
        raise CommandFailed(f"{failures_text}; --max-errors is {options.max_errors:g}")


def watch(
    reader: Reader,
    encoder: Encoder,
    port: str,
    *,
    count: int | None = None,
    interval_s: float = 0.0,
    out: TextIO | None = None,
    recorder: Recorder | None = None,
    is_shown: bool = True,
) -> Readings:
    """Show live readings of an encoder on a port until the program is interrupted, and return their numbers.

    On a terminal, the screen is updated ten times per second. Elsewhere, only the number of failures is written at the
    end.

    Args:
        reader: The link, from which the readings come.
        count: Number of readings. By default, until interrupted.
        interval_s: Time in seconds from the start of a reading to the start of the next one.
        out: File to write to. The default is standard output. ``recorder`` records all readings.
        is_shown: Show the readings if ``out`` is a terminal.

    Raises:
        RuntimeError: The encoder never answered. This is the error that ``reader`` raised.
    """
    screen = _Screen(encoder, port, out or sys.stdout, recorder, is_shown)
    readings_done = 0
    next_start_s = 0.0
    try:
        while count is None or readings_done < count:
            if interval_s:
                next_start_s = _wait_until(next_start_s) + interval_s
            screen.show_reading_of(reader)
            readings_done += 1
    except KeyboardInterrupt:
        pass
    finally:
        screen.end()
    return Readings(screen.frames + screen.failures, screen.failures)


def _wait_until(due_time: float) -> float:
    """Wait until a time, and return it. If that time has passed, return the current time.

    Readings therefore come at fixed intervals. After a late reading, the next interval starts with that reading.
    """
    sleep(max(0.0, due_time - monotonic()))
    return max(due_time, monotonic())


class _RecentReading(NamedTuple):
    """Time and unwrapped position of a reading. The position is None if it is not usable."""

    time: float
    position: int | None


class _Screen:
    """Last readings of an encoder, and the lines on the terminal that show them."""

    def __init__(self, encoder: Encoder, port: str, out: TextIO, recorder: Recorder | None, is_shown: bool) -> None:
        self._encoder = encoder
        self._port = port
        self._out = out
        self._recorder = recorder
        self._is_live = is_shown and out.isatty()
        self._last_frame: Any = None
        #: Last unwrapped position, and the range with which it was unwrapped.
        self._last_count: int | None = None
        self._last_range: PositionRange | None = None
        #: Readings in the last half second.
        self._recent_readings: deque[_RecentReading] = deque()
        #: Number of failures by kind, such as "no reply".
        self._failure_counts: Counter[str] = Counter()
        #: Time and number of lines of the last drawing, and text of the last error.
        self._last_drawing_time, self._drawn_line_count, self._last_error = 0.0, 0, ""
        self._start_time = monotonic()
        self.frames = self.failures = 0

    def show_reading_of(self, reader: Reader) -> None:
        """Read a frame, and show it or the failure.

        Raises the error of the reader at the tenth failure without any frame.
        """
        try:
            self.add(reader.read())
        except RuntimeError as error:
            self.fail(error)
            if not self.frames and self.failures >= _GIVEN_UP:
                raise

    def add(self, frame: Any) -> None:
        """Record and show a frame."""
        self.frames += 1
        self._last_frame = frame
        now = monotonic()
        position = frame.usable_position
        if position is not None:
            self._last_count = self._unwrap(frame.__class__, position)
        if self._recorder is not None:
            reading = RecordedReading(
                time=now - self._start_time,
                position=position,
                verdict=frame.verdict.value,
                reports=" ".join(report.name for report in frame.reports),
            )
            self._recorder.write(reading)
        usable_count = None if position is None else self._last_count
        self._recent_readings.append(_RecentReading(now, usable_count))
        while self._recent_readings and now - self._recent_readings[0].time > _SPAN_S:
            self._recent_readings.popleft()
        self._update(now)

    def fail(self, error: RuntimeError) -> None:
        """Record and show a failure."""
        self.failures += 1
        kind = _name_error(error)
        now = monotonic()
        self._failure_counts[kind] += 1
        self._last_error = str(error)
        if self._recorder is not None:
            self._recorder.write(RecordedReading(time=now - self._start_time, error=kind))
        self._update(now)

    def end(self) -> None:
        """Show the last state on a terminal, or write the number of failures elsewhere."""
        if self._is_live:
            self._draw()
        elif self.frames + self.failures:
            last_error = f"; the last error: {self._last_error}" if self._last_error else ""
            self._out.write(f"{self._describe_failures()}{last_error}\n")
            self._out.flush()

    def _unwrap(self, frame_class: type, position: int) -> int:
        """Return the count of a position in a frame of ``frame_class``, which continues when the position wraps around.

        The count starts again if the range of the positions has changed. If the range is unknown, the count equals
        the position.
        """
        try:
            position_range = self._encoder.range_of(frame_class)
        except ValueError:
            return position
        has_same_range = position_range == self._last_range
        self._last_range = position_range
        # The first position is the count from which unwrapping starts.
        previous = self._last_count if self._last_count is not None and has_same_range else position
        return position_range.unwrap(previous, position)

    def _update(self, now: float) -> None:
        """Draw the readings if a tenth of a second has passed since the last drawing."""
        if self._is_live and now - self._last_drawing_time >= 1 / _UPDATES_PER_SECOND:
            self._last_drawing_time = now
            self._draw()

    def _draw(self) -> None:
        """Draw the readings in place of the previous readings."""
        # The last column stays empty, because some terminals would begin a new line.
        column_count = shutil.get_terminal_size().columns - 1
        title_line = f"{self._encoder.code}, {self._encoder.interface.title}, {self._port}    Ctrl-C ends"
        rows = [*self._list_values(), *self._list_state()]
        lines = [title_line, *(f"{name:<10}{value}" for name, value in rows)]
        # Escape sequences: move up by some lines, and clear a line.
        move_up = f"\x1b[{self._drawn_line_count}A" if self._drawn_line_count else ""
        text = "".join(f"\r\x1b[2K{line[:column_count]}\n" for line in lines)
        self._out.write(move_up + text)
        self._out.flush()
        self._drawn_line_count = len(lines)

    def _list_values(self) -> list[tuple[str, str]]:
        """Return the rows about the last frame: pairs of label and text, such as ``("position", "4711 counts")``."""
        frame = self._last_frame
        if frame is None:
            return [("position", "-"), ("angle", "-"), ("speed", "-"), ("verdict", "-")]
        usable_position = frame.usable_position
        quantity, quantity_text = _convert_to_unit(self._encoder, usable_position)
        return [
            ("position", "-" if usable_position is None else f"{usable_position} counts"),
            (quantity, quantity_text),
            ("speed", self._measure_speed()),
            ("verdict", frame.verdict.value.replace("_", " ")),
        ]

    def _list_state(self) -> list[tuple[str, str]]:
        """Return the rows about alarms, rate and errors: pairs of label and text."""
        reports = self._last_frame.reports if self._last_frame is not None else ()
        # Times of all frames in the last half second, also of those without a usable position.
        times = [reading.time for reading in self._recent_readings]
        span = times[-1] - times[0] if times else 0.0
        # Between n times there are n - 1 readings.
        rate = (len(times) - 1) / span if span > 0 else 0.0
        return [
            ("alarms", ", ".join(report.name for report in reports) or "none"),
            ("rate", f"{rate:.0f} readings/s"),
            ("errors", self._describe_failures()),
            ("", self._last_error),
        ]

    def _describe_failures(self) -> str:
        """Return the number of failures of each kind as text, such as ``2 of 9 readings failed: 2 no reply``."""
        total = self.frames + self.failures
        counts_text = ", ".join(f"{count} {kind}" for kind, count in self._failure_counts.most_common())
        kinds_text = f": {counts_text}" if counts_text else ""
        return f"{self.failures} of {total} readings failed{kinds_text}"

    def _measure_speed(self) -> str:
        """Return the speed over the last half second with its unit, or ``-`` with fewer than two usable positions."""
        timed_counts = [
            (reading.time, reading.position) for reading in self._recent_readings if reading.position is not None
        ]
        if len(timed_counts) < 2:
            return "-"
        first_time, first_count = timed_counts[0]
        last_time, last_count = timed_counts[-1]
        if last_time <= first_time:
            return "-"
        counts_per_second = (last_count - first_count) / (last_time - first_time)
        encoder: Any = self._encoder
        if hasattr(encoder, "millimetres"):
            return f"{counts_per_second * encoder.millimetres(1):.3f} mm/s"
        if hasattr(encoder, "from_turns"):
            return f"{60 * counts_per_second / encoder.from_turns(1):.3f} rpm"
        return f"{counts_per_second:.0f} counts/s"


def _convert_to_unit(encoder: Any, position: int | None) -> tuple[str, str]:
    """Return the name and the value of a position in a unit, such as ``("angle", "12.34500°")``.

    The value is ``-`` for a position that is None, and for encoders whose manual does not state the size of a count.
    """
    measures_length = hasattr(encoder, "millimetres")
    name = "length" if measures_length else "angle"
    if position is None:
        return name, "-"
    if measures_length:
        return name, f"{encoder.millimetres(position):.4f} mm"
    if hasattr(encoder, "degrees"):
        return name, f"{encoder.degrees(position):.5f}°"
    return name, "-"


def _name_error(error: RuntimeError) -> str:
    """Return the name of an error for the screen: ``no reply`` for NoReplyError."""
    words: list[str] = []
    for character in type(error).__name__.removesuffix("Error"):
        # Each capital letter begins a word.
        if character.isupper() or not words:
            words.append("")
        words[-1] += character.lower()
    return " ".join(words)
