# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the frames of BiSS and SSI in the edges of a clock and a data line.

A cycle begins at the first falling edge of the clock after a pause. Over SSI, each rising edge then shifts out a bit.
Over BiSS, the data line is high at rest, goes low as an acknowledgement, and rises with the start bit. CDS, the frame
and its CRC follow. The levels of the data line after the last bit of the frame are ignored.

Each bit is read in its middle, which the delay of the line shifts. Over BiSS, the start bit shows the delay, and
over SSI the first change of the data line.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple

from .inputs import InputError
from .signals import Edges, Signals

np: Any = import_module("numpy")

#: Number of periods without an edge after which the clock is idle. BiSS slaves end a cycle after 1.5 or more.
_REST: Final = 1.4
#: A pulse shorter than this fraction of a period is a glitch.
_SPIKE: Final = 0.15
#: Longest delay of a data line, in clock periods, for which the finder waits for the next stretch of the capture.
_DELAY: Final = 256
#: With fewer samples per clock period, the positions of edges are averaged, and so are the delays of some bits.
_COARSE: Final = 8
_AVERAGED: Final = 16
#: Number of edges without a pause after which a signal is not considered a clock.
_ENDLESS: Final = 1 << 22
#: Shortest pause, so that no period is 0.
_LEAST: Final = 1e-12
#: Number of edges of the clock that are needed to determine its period.
_FEW: Final = 64


class Lost(NamedTuple):
    """Cycle or bytes in a capture that contain no frame.

    Attributes:
        time: Time of the beginning, in seconds or in samples.
        reason: Description of what was found instead of a frame.
    """

    time: float
    reason: str


class Found(NamedTuple):
    """Frames in a stretch of a capture.

    Attributes:
        frames: The frames, in the form that ``decode_many`` expects.
        times: Beginning of each frame: the first falling edge of the clock, or the start bit of the first byte. In
            seconds, or in samples if the sample rate is unknown.
        lost: Cycles without a frame.
        done: Amount of the file that has been read.
        control: Over BiSS, the time, CDS bit and CDM bit of each cycle, including lost ones, whose CDS bit is -1.
        kind: Over RS-485, the kind of the frames. Empty if no valid frame was found.
        others: Number of frames of other kinds, by name.
    """

    frames: Any
    times: Any
    lost: list[Lost]
    done: int = 0
    control: tuple[Any, Any, Any] | None = None
    kind: str = ""
    others: Mapping[str, int] = MappingProxyType({})


def clocked(
    signals: Signals, name: str, kind: Literal["biss", "ssi"], bits: int, rest: float | None = None
) -> Generator[Found, None, None]:
    """Yield the frames of ``bits`` bits.

    Args:
        signals: The clock and the data line.
        name: Name of the file, for errors.
        kind: Interface of the encoder.
        bits: Number of bits in a frame.
        rest: Shortest pause between two cycles in seconds, or in samples if the sample rate is unknown. By default, 1.4
            periods of the clock.

    Raises:
        InputError: The clock never changes, or never pauses.
    """
    unit = signals.seconds or 1.0
    finder = _Cycles(kind, bits, rest / unit if rest else None, 0.5 if signals.is_sampled else 0.0, unit)
    for part in signals.edges:
        found = finder.feed(part, name)
        if found is not None:
            yield found
    if not finder.is_clocked:
        raise InputError(name, "", "the clock never changes: choose another channel with --clock")
    yield finder.finish()


class _Cycles:
    """Finder of cycles. It keeps the edges of the last cycle until the next stretch of the capture arrives."""

    def __init__(self, kind: Literal["biss", "ssi"], bits: int, rest: float | None, early: float, unit: float) -> None:
        self._is_biss, self._bits, self._given, self._early = kind == "biss", bits, rest, early
        self._begin, self._unit = -np.inf, unit
        self._clock, self._data, self._levels = np.zeros(0), np.zeros(0), (1, 1)
        self._rest = 0.0
        self._end, self._done, self.is_clocked, self._is_new = 0.0, 0, False, True

    def feed(self, part: Edges, name: str) -> Found | None:
        """Return the frames that the next stretch of the capture completes."""
        if self._is_new:
            self._levels, self._begin, self._is_new = (part.levels[0], part.levels[1]), part.begin, False
        self._clock = np.concatenate([self._clock, part.times[0]])
        self._data = np.concatenate([self._data, part.times[1]])
        self._end, self._done = part.end, part.done
        count = len(self._clock)
        self.is_clocked = self.is_clocked or count > 0
        if count < _FEW and not self._rest:
            return None
        if not self._rest:
            self._set_rest()
        ends = self._ends()
        # The last cycle may continue, or its data may still arrive.
        if not len(ends) or self._end - self._clock[-1] < _DELAY * self._rest:
            ends = ends[:-1]
        if not len(ends):
            if count > _ENDLESS:
                raise InputError(name, "", "the clock never rests: choose another channel with --clock")
            return None
        return self._cut(ends)

    def finish(self) -> Found:
        """Return the frames at the end of the capture."""
        if not self._rest and len(self._clock) > 2:
            self._set_rest()
        # Two edges have no period.
        self._rest = self._rest or self._given or max(self._end - float(self._clock[:1].sum()), _LEAST)
        return self._cut(self._ends() if len(self._clock) else np.zeros(0, np.int64), True)

    def _set_rest(self) -> None:
        # Within a cycle, two edges are one period, regardless of the duty cycle.
        spans = self._clock[2:] - self._clock[:-2]
        usual = spans[spans <= 2 * np.median(spans)]
        # Damaged files can have edges at the same time.
        self._rest = max(self._given or _REST * float(usual.mean()), _LEAST)

    def _ends(self) -> Any:
        """Return the index after the last edge of each cycle."""
        gaps = np.flatnonzero(np.diff(self._clock) > self._rest) + 1
        return np.append(gaps, len(self._clock)) if len(self._clock) else gaps

    def _cut(self, ends: Any, is_last: bool = False) -> Found:
        """Return the frames in the cycles that end at ``ends``, and forget their edges."""
        clock, levels = self._clock, self._levels
        if not len(ends):
            return Found(np.zeros(0, np.uint64), np.zeros(0), [], self._done)
        starts = np.concatenate([[0], ends[:-1]])
        found = self._frames(starts, ends, is_last)
        kept = int(ends[-1])
        # The data line may change after the clock rests, so its edges are kept up to the next cycle.
        until = clock[kept] if kept < len(clock) else np.inf if is_last else clock[kept - 1] + self._rest
        gone = int(np.searchsorted(self._data, until, "left"))
        self._levels = (levels[0] ^ (kept & 1), levels[1] ^ (gone & 1))
        self._clock, self._data = clock[kept:], self._data[gone:]
        self._begin = -np.inf
        return found

    def _frames(self, starts: Any, ends: Any, is_last: bool) -> Found:
        clock, data, unit = self._clock, self._data, self._unit
        # The first falling edge of each cycle. An edge with an even index starts from the first level.
        falls = starts + ((starts & 1) == self._levels[0])
        after = np.append(clock[ends[:-1]], np.inf) if len(ends) else np.zeros(0)
        if ends[-1] < len(clock):
            after[-1] = clock[ends[-1]]
        # The end of a time-out is an edge without a cycle.
        real = falls < ends
        starts, ends, falls, after = starts[real], ends[real], falls[real], after[real]
        if not len(falls):
            return Found(np.zeros(0, np.uint64), np.zeros(0), [], self._done)
        begin, last = clock[falls], clock[ends - 1]
        rises = (ends - falls) // 2
        period = np.where(rises > 1, 2 * (last - begin) / np.maximum(ends - 1 - falls, 1), self._rest / _REST)
        period = np.maximum(period, 1e-6 * self._rest)
        reasons = np.zeros(len(falls), np.int64)
        index = np.searchsorted(data, begin, "left")
        level = self._levels[1] ^ (index & 1)
        padded = np.append(data, [np.inf, np.inf])
        if self._is_biss:
            down, up = padded[index], padded[index + 1]
            known = np.searchsorted(clock, up, "right")
            first = (known - falls) // 2 - 1
            at = falls + 1 + 2 * np.maximum(first, 0)
            second = clock[np.minimum(falls + 3, ends - 1)]
            late = np.maximum(np.floor((np.where(np.isfinite(down), down, 0) - second) / period), 0)
            short = rises - 1 - (first - late) < self._bits + 1
            reasons[short] = _SHORT
            reasons[(up > last + period * (late + 2)) | (up >= after) | (first < 0)] = _NO_START
            reasons[down > np.minimum(after, last + _DELAY * period)] = _HIGH
            reasons[level == 0] = _LOW
            delay = up - clock[np.minimum(at, len(clock) - 1)]
            wanted, skipped = self._bits + 1, first + 1
            sent = np.where(reasons == _SHORT, np.maximum(rises - 2 - (first - late), 0), rises)
        else:
            first_rise = clock[np.minimum(falls + 1, ends - 1)]
            change = padded[np.searchsorted(data, first_rise, "left")]
            known = np.searchsorted(clock, change, "right")
            near = falls + 1 + 2 * np.maximum((known - falls) // 2 - 1, 0)
            delay = np.where(change < last + period, change - clock[np.minimum(near, ends - 1)], 0.0)
            delay = np.where(delay < period, delay, 0.0)
            reasons[rises < self._bits] = _SHORT
            wanted, skipped, sent = self._bits, np.zeros(len(falls), np.int64), rises
        gaps = np.append(np.diff(clock), np.inf)
        # A gap after the last edge of a cycle is a rest.
        gaps[ends - 1] = np.inf
        shortest = np.minimum.reduceat(gaps, falls)
        reasons[shortest < _SPIKE * period] = _SPIKED
        cut = np.zeros(len(falls), bool)
        cut[0] = begin[0] - self._begin < self._rest
        good = np.flatnonzero(reasons == 0)
        values = self._bits_of(falls[good], rises[good], skipped[good], delay[good], period[good], wanted)
        words = np.zeros(len(good), np.uint64)
        for place in range(wanted - self._bits, wanted):
            words = words << np.uint64(1) | values[:, place].astype(np.uint64)
        lost = [
            Lost(float(begin[place]) * unit, self._said(int(reasons[place]), int(sent[place]), bool(cut[place])))
            for place in np.flatnonzero(reasons)
        ]
        if lost and is_last and reasons[-1] and self._end - last[-1] < self._rest:
            lost[-1] = Lost(lost[-1].time, _MESSAGES[_CUT])
        control = None
        if self._is_biss:
            cds = np.full(len(falls), -1, np.int64)
            cds[good] = values[:, 0]
            cdm = self._levels[0] ^ (ends & 1) ^ 1
            control = (begin * unit, cds, cdm)
        return Found(words, begin[good] * unit, lost, self._done, control)

    def _bits_of(self, falls: Any, rises: Any, skipped: Any, delay: Any, period: Any, count: int) -> Any:
        """Return the levels of the data line in the middle of each bit, as an array with a row for each cycle."""
        clock, data = self._clock, self._data
        order = skipped[:, None] + np.arange(count)[None, :]
        beyond = np.maximum(order - (rises - 1)[:, None], 0)
        places = falls[:, None] + 1 + 2 * (order - beyond)
        times = clock[places]
        if beyond.any():
            times += beyond * period[:, None]
        # A bit changes up to one sample before its edge is seen.
        half = period / 2 - self._early
        if self._early and len(period) and period.min() < _COARSE:
            times, delay, half = self._refined(times, beyond == 0, delay, period)
        times += (delay + half)[:, None]
        return (np.searchsorted(data, times.ravel(), "right").reshape(times.shape) & 1) ^ self._levels[1]

    def _refined(self, times: Any, known: Any, delay: Any, period: Any) -> tuple[Any, Any, Any]:
        """Refine the times of the clock's edges, the delay, and half a bit, if there are few samples per period.

        A straight line through all edges of a cycle, and the mean of the delays of all bits, are exact to a fraction of
        a sample.
        """
        x, weight = np.arange(times.shape[1], dtype=np.float64)[None, :], known.astype(np.float64)
        count = np.maximum(weight.sum(axis=1), 1)
        mean_x, mean_y = (weight * x).sum(axis=1) / count, (weight * times).sum(axis=1) / count
        off = (x - mean_x[:, None]) * weight
        slope = (off * (times - mean_y[:, None])).sum(axis=1) / np.maximum((off * off).sum(axis=1), 1e-9)
        line = mean_y[:, None] + slope[:, None] * (x - mean_x[:, None])
        is_even = (np.abs(line - times) * weight).max(axis=1) < 1.5
        # The first edge of the data line near each bit.
        expected = line + delay[:, None]
        data = np.append(self._data, np.inf)
        near = (
            data[np.searchsorted(self._data, (expected - slope[:, None] / 2).ravel())].reshape(times.shape) - expected
        )
        is_near = near < slope[:, None] / 2
        late = np.where(is_near, near, 0.0).sum(axis=1) / np.maximum(is_near.sum(axis=1), 1)
        return (
            np.where(is_even[:, None], line, times),
            np.where(is_even, delay + late, delay),
            np.where(is_even, slope / 2, period / 2 - self._early),
        )

    def _said(self, reason: int, sent: int, is_cut: bool) -> str:
        if is_cut and reason in (_SHORT, _NO_START, _LOW):
            return "the capture begins within this cycle"
        if reason == _SHORT:
            return f"the clock stops after {sent} of {self._bits} bits"
        return _MESSAGES[reason]


_SHORT, _NO_START, _HIGH, _LOW, _SPIKED, _CUT = range(1, 7)
_MESSAGES: Final = {
    _NO_START: "no start bit: the data line stays low after the acknowledgement",
    _HIGH: "no acknowledgement: the data line stays high",
    _LOW: "the data line is low before the cycle begins",
    _SPIKED: "a very short pulse on the clock",
    _CUT: "the capture ends within this cycle",
}
