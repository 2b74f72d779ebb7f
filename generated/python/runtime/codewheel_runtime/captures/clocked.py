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
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple

from ..errors import InputError
from ..packages import load
from .accesses import ControlBits
from .bit_timing import BitTiming, refine_timing
from .signals import Edges, Signals

np: Any = load("numpy")

#: Number of periods without an edge after which the clock is idle. BiSS slaves end a cycle after 1.5 or more.
_IDLE_PERIODS: Final = 1.4
#: A pulse shorter than this fraction of a period is a glitch.
_GLITCH_FRACTION: Final = 0.15
#: Longest delay of a data line, in clock periods, for which the finder waits for the next stretch of the capture.
_LONGEST_DELAY: Final = 256
#: With fewer samples per clock period, the positions of edges are averaged, and so are the delays of all bits.
_FEW_SAMPLES_PER_PERIOD: Final = 8
#: Number of edges without a pause after which a signal is not considered a clock.
_EDGES_WITHOUT_PAUSE: Final = 1 << 22
#: Shortest pause, so that no period is 0.
_SHORTEST_PAUSE: Final = 1e-12
#: Shortest period, as a fraction of the pause.
_SHORTEST_PERIOD: Final = 1e-6
#: Number of clock edges needed to determine the clock period.
_EDGES_FOR_PERIOD: Final = 64
#: Indices of the two signals of a capture.
_CLOCK_INDEX: Final = 0
_DATA_INDEX: Final = 1


class Lost(NamedTuple):
    """Cycle or bytes in a capture that contain no frame.

    Attributes:
        time: Time of the beginning, in seconds or in samples.
        reason: Description of what was found instead of a frame.
    """

    time: float
    reason: str


class CapturedFrames(NamedTuple):
    """Frames in a stretch of a capture.

    Attributes:
        frames: The frames, in the form that ``decode_many`` expects.
        times: Beginning of each frame: the first falling edge of the clock, or the start bit of the first byte. In
            seconds, or in samples if the sample rate is unknown.
        lost: Cycles without a frame.
        done: Amount of the file that has been read.
        control: Over BiSS, the bits of register accesses.
        kind: Over RS-485, the kind of the frames. Empty if none is requested, and no valid frame was found.
        others: Number of frames of other kinds, by name.
    """

    frames: Any
    times: Any
    lost: list[Lost]
    done: int = 0
    control: ControlBits | None = None
    kind: str = ""
    others: Mapping[str, int] = MappingProxyType({})


def find_clocked_frames(
    signals: Signals, name: str, kind: Literal["biss", "ssi"], bits: int, pause: float | None = None
) -> Generator[CapturedFrames, None, None]:
    """Yield the frames of ``bits`` bits.

    Args:
        signals: The clock and the data line.
        name: Name of the file, for errors.
        kind: Interface of the encoder.
        bits: Number of bits in a frame.
        pause: Shortest pause between two cycles in seconds, or in samples if the sample rate is unknown. By default,
            1.4 periods of the clock.

    Raises:
        InputError: The clock never changes, or never pauses.
    """
    unit = signals.seconds or 1.0
    finder = _CycleFinder(
        kind=kind,
        bits=bits,
        pause=pause / unit if pause else None,
        early=0.5 if signals.is_sampled else 0.0,
        unit=unit,
    )
    # Inside the finder, times are in the unit of the edges: ``unit`` seconds, or samples.
    for part in signals.edges:
        stretch = finder.feed(part, name)
        # Without a complete cycle, there is no stretch yet.
        if stretch is not None:
            yield stretch
    if not finder.is_clocked:
        raise InputError(name, "", "the clock never changes: choose another channel with --clock")
    yield finder.finish()


class _Cycles(NamedTuple):
    """Cycles of the clock: arrays with an element for each cycle.

    Attributes:
        falls: Index of the first falling edge.
        ends: Index after the last edge.
        rises: Number of rising edges.
        begin: Time of the first falling edge.
        last: Time of the last edge.
        after: Time of the first edge after the cycle. Infinity if there is none.
        period: Period of the clock.
    """

    falls: Any
    ends: Any
    rises: Any
    begin: Any
    last: Any
    after: Any
    period: Any


class _StartBits(NamedTuple):
    """Start bits of BiSS cycles: arrays with an element for each cycle.

    Attributes:
        first_level: Level of the data line before the cycle.
        data_fall: Time at which the data line goes low, as an acknowledgement. Infinity if it stays high.
        data_rise: Time at which the data line rises with the start bit. Infinity if it stays low.
        rise_number: Number of the rising edge of the clock that shifts out the start bit, from 0. -1 if the data line
            rises before the first one.
        delay: Delay of the start bit after this edge.
        late_periods: Whole periods by which the acknowledgement, and so the data line, is late.
    """

    first_level: Any
    data_fall: Any
    data_rise: Any
    rise_number: Any
    delay: Any
    late_periods: Any


class _Bits(NamedTuple):
    """Bits of each cycle: arrays with an element for each cycle.

    Attributes:
        reasons: Reason why the cycle has no frame, such as ``_SHORT``, or 0.
        skipped: Number of rising edges before the first bit.
        delay: Delay of the data line after the rising edge that shifts out a bit.
        sent: Number of bits that were sent, for the message about a cycle that is too short.
    """

    reasons: Any
    skipped: Any
    delay: Any
    sent: Any


class _CycleFinder:
    """Finder of cycles. It keeps the edges of the last cycle until the next stretch of the capture arrives."""

    def __init__(self, kind: Literal["biss", "ssi"], bits: int, pause: float | None, early: float, unit: float) -> None:
        self._is_biss = kind == "biss"
        self._bits = bits
        self._chosen_pause = pause
        #: Time by which an edge can be earlier than its time on average, and length of a unit of time in seconds.
        self._early = early
        self._unit = unit
        #: Edges of the cycles that are not complete, and the levels of both lines before these edges.
        self._clock, self._data = np.zeros(0), np.zeros(0)
        self._levels = (1, 1)
        #: Beginning of the capture, of which the first cycle may be cut off. Minus infinity after the first cycles.
        self._begin = -np.inf
        #: End of the capture so far, and the amount of the file that has been read.
        self._end, self._done = 0.0, 0
        #: Time without an edge of the clock after which a cycle has ended. 0 while it is not known.
        self._rest = 0.0
        #: True once the clock has an edge, and True until the first stretch has arrived.
        self.is_clocked, self._is_new = False, True

    def feed(self, part: Edges, name: str) -> CapturedFrames | None:
        """Return the frames that the next stretch of the capture completes.

        Return None if it completes no cycle, or while the clock has too few edges to determine its period. Raises
        InputError if the clock has very many edges without a pause.
        """
        self._append(part)
        count = len(self._clock)
        if not self._rest:
            if count < _EDGES_FOR_PERIOD:
                return None
            self._set_rest()
        ends = self._find_ends()
        # The last cycle may continue, or its data may still arrive.
        is_last_open = not len(ends) or self._end - self._clock[-1] < _LONGEST_DELAY * self._rest
        if is_last_open:
            ends = ends[:-1]
        if len(ends):
            return self._take_cycles(ends)
        if count > _EDGES_WITHOUT_PAUSE:
            raise InputError(name, "", "the clock never rests: choose another channel with --clock")
        return None

    def _append(self, part: Edges) -> None:
        """Append the edges of the next stretch of the capture: first of the clock, then of the data line."""
        # Only the first stretch shows the levels at the beginning.
        if self._is_new:
            self._levels, self._begin = (part.levels[_CLOCK_INDEX], part.levels[_DATA_INDEX]), part.begin
            self._is_new = False
        self._clock = np.concatenate([self._clock, part.times[_CLOCK_INDEX]])
        self._data = np.concatenate([self._data, part.times[_DATA_INDEX]])
        self._end, self._done = part.end, part.done
        self.is_clocked = self.is_clocked or len(self._clock) > 0

    def finish(self) -> CapturedFrames:
        """Return the frames at the end of the capture. All cycles end here, even if the clock was not at rest."""
        if not self._rest and len(self._clock) > 2:
            self._set_rest()
        if not self._rest:
            # Two edges define no period, so all edges are one cycle.
            first_edge = float(self._clock[0]) if len(self._clock) else 0.0
            self._rest = self._chosen_pause or max(self._end - first_edge, _SHORTEST_PAUSE)
        ends = self._find_ends() if len(self._clock) else np.zeros(0, np.int64)
        return self._take_cycles(ends, is_last=True)

    def _set_rest(self) -> None:
        """Set the time without an edge after which a cycle has ended: the chosen pause, or 1.4 usual periods."""
        # Within a cycle, two edges are one period, regardless of the duty cycle. Longer spans contain a pause.
        spans = self._clock[2:] - self._clock[:-2]
        spans_of_periods = spans[spans <= 2 * np.median(spans)]
        # Damaged files can have edges at the same time.
        self._rest = max(self._chosen_pause or _IDLE_PERIODS * float(spans_of_periods.mean()), _SHORTEST_PAUSE)

    def _find_ends(self) -> Any:
        """Return the index after the last edge of each cycle, even if the last cycle is incomplete."""
        ends = np.flatnonzero(np.diff(self._clock) > self._rest) + 1
        return np.append(ends, len(self._clock)) if len(self._clock) else ends

    def _take_cycles(self, ends: Any, is_last: bool = False) -> CapturedFrames:
        """Return the frames in the cycles that end before the edges ``ends``, and forget the edges of these cycles."""
        if not len(ends):
            return CapturedFrames(np.zeros(0, np.uint64), np.zeros(0), [], self._done)
        starts = np.concatenate([[0], ends[:-1]])
        frames = self._find_frames(starts, ends, is_last)
        last_end = int(ends[-1])
        data_end = self._find_data_end(last_end, is_last)
        # An odd number of forgotten edges inverts the level before the remaining ones.
        clock_level, data_level = self._levels
        self._levels = (clock_level ^ (last_end & 1), data_level ^ (data_end & 1))
        self._clock = self._clock[last_end:]
        self._data = self._data[data_end:]
        self._begin = -np.inf
        return frames

    def _find_data_end(self, clock_end: int, is_last: bool) -> int:
        """Return the number of edges of the data line that belong to the cycles before the edge ``clock_end``.

        The data line may change after the clock rests, so its edges up to the next cycle belong to them. While the next
        cycle is not known, these are its edges within the pause.
        """
        if clock_end < len(self._clock):
            next_cycle = self._clock[clock_end]
        elif is_last:
            next_cycle = np.inf
        else:
            next_cycle = self._clock[clock_end - 1] + self._rest
        return int(np.searchsorted(self._data, next_cycle, "left"))

    def _find_frames(self, starts: Any, ends: Any, is_last: bool) -> CapturedFrames:
        """Return the frames in cycles with edges from ``starts`` to ``ends``, and the lost cycles with their reasons.

        ``is_last`` is True at the end of the capture, which may cut off the last cycle.
        """
        cycles = self._find_cycles(starts, ends)
        if not len(cycles.falls):
            return CapturedFrames(np.zeros(0, np.uint64), np.zeros(0), [], self._done)
        bits = self._find_biss_bits(cycles) if self._is_biss else self._find_ssi_bits(cycles)
        # A glitch on the clock takes precedence over other reasons.
        has_glitch = self._find_shortest_gaps(cycles) < _GLITCH_FRACTION * cycles.period
        bits.reasons[has_glitch] = _SPIKED
        good = np.flatnonzero(bits.reasons == 0)
        # Over BiSS, CDS is before the frame.
        front_bits = 1 if self._is_biss else 0
        levels = self._read_levels(cycles, bits, good, front_bits + self._bits)
        lost = self._list_lost_cycles(cycles, bits)
        is_cut_off = is_last and bits.reasons[-1] and self._end - cycles.last[-1] < self._rest
        if lost and is_cut_off:
            lost[-1] = Lost(lost[-1].time, _MESSAGES[_CUT])
        return CapturedFrames(
            frames=_join_bits(levels[:, front_bits:]),
            times=cycles.begin[good] * self._unit,
            lost=lost,
            done=self._done,
            control=self._find_control_bits(cycles, good, levels) if self._is_biss else None,
        )

    def _find_control_bits(self, cycles: _Cycles, good: Any, levels: Any) -> ControlBits:
        """Return the bits of register accesses. ``good`` are the indices of the cycles with the ``levels`` of bits."""
        cds = np.full(len(cycles.falls), -1, np.int64)
        cds[good] = levels[:, 0]
        # CDM is the inverse of the clock's level during the time-out.
        clock_level, _ = self._levels
        timeout_level = clock_level ^ (cycles.ends & 1)
        return ControlBits(times=cycles.begin * self._unit, cds=cds, cdm=timeout_level ^ 1)

    def _find_cycles(self, starts: Any, ends: Any) -> _Cycles:
        """Return the cycles with edges from ``starts`` to ``ends``. Cycles without a falling edge are left out."""
        clock = self._clock
        # The level before edge n is the first level, inverted if n is odd. After a low level, the next edge rises, and
        # the one after it is the first that falls.
        clock_level, _ = self._levels
        is_low_before = (starts & 1) == clock_level
        # True counts as 1.
        falls = starts + is_low_before
        # Time of the first edge after each cycle. After the last cycle there may be none.
        next_edges = np.append(clock, np.inf)[ends]
        # The end of a time-out is an edge without a cycle.
        has_fall = falls < ends
        ends, falls, next_edges = ends[has_fall], falls[has_fall], next_edges[has_fall]
        begin = clock[falls]
        last = clock[ends - 1]
        rises = (ends - falls) // 2
        # The edges of a cycle are half a period apart on average. With fewer than two rising edges, the pause shows the
        # period.
        half_periods = np.maximum(ends - 1 - falls, 1)
        period = np.where(rises > 1, 2 * (last - begin) / half_periods, self._rest / _IDLE_PERIODS)
        period = np.maximum(period, _SHORTEST_PERIOD * self._rest)
        return _Cycles(falls=falls, ends=ends, rises=rises, begin=begin, last=last, after=next_edges, period=period)

    def _find_biss_bits(self, cycles: _Cycles) -> _Bits:
        """Return the places of the bits after the start bit, the first rise of the data line after its first fall.

        If several reasons apply to a cycle, the last one that is set below counts.
        """
        start_bits = self._find_start_bits(cycles)
        data_rise = start_bits.data_rise
        # CDS and the frame need this many rising edges after the start bit.
        rises_needed = self._bits + 1
        # The slave sent the start bit ``late_periods`` edges before the one after which it arrived.
        rises_after_start = cycles.rises - 1 - (start_bits.rise_number - start_bits.late_periods)
        # After the last edge, the start bit can still be on the line for its delay.
        latest_start = cycles.last + cycles.period * (start_bits.late_periods + 2)
        latest_acknowledgement = np.minimum(cycles.after, cycles.last + _LONGEST_DELAY * cycles.period)
        has_no_start = (data_rise > latest_start) | (data_rise >= cycles.after) | (start_bits.rise_number < 0)
        reasons = np.zeros(len(cycles.falls), np.int64)
        reasons[rises_after_start < rises_needed] = _SHORT
        reasons[has_no_start] = _NO_START
        reasons[start_bits.data_fall > latest_acknowledgement] = _HIGH
        reasons[start_bits.first_level == 0] = _LOW
        # The first rising edge after the start bit belongs to CDS.
        sent = np.where(reasons == _SHORT, np.maximum(rises_after_start - 1, 0), cycles.rises)
        return _Bits(reasons=reasons, skipped=start_bits.rise_number + 1, delay=start_bits.delay, sent=sent)

    def _find_start_bits(self, cycles: _Cycles) -> _StartBits:
        """Return the start bits: the data line goes low as an acknowledgement, and rises with the start bit."""
        clock, falls = self._clock, cycles.falls
        # Index of the first edge of the data line in each cycle.
        first_index = np.searchsorted(self._data, cycles.begin, "left")
        _, data_level = self._levels
        # After the last edge, the data line never changes again: its next edges are at infinity.
        data_edges = np.append(self._data, [np.inf, np.inf])
        data_fall = data_edges[first_index]
        data_rise = data_edges[first_index + 1]
        # Edges of the clock from the first falling one up to this rise. The second one is rising edge 0, and every
        # second one after it rises too.
        edges_before_rise = np.searchsorted(clock, data_rise, "right") - falls
        rise_number = edges_before_rise // 2 - 1
        start_edge = falls + 1 + 2 * np.maximum(rise_number, 0)
        # The slave acknowledges at the second rising edge, three edges after the first falling one.
        second_rise = clock[np.minimum(falls + 3, cycles.ends - 1)]
        acknowledgement = np.where(np.isfinite(data_fall), data_fall, 0)
        late_periods = np.maximum(np.floor((acknowledgement - second_rise) / cycles.period), 0)
        return _StartBits(
            first_level=data_level ^ (first_index & 1),
            data_fall=data_fall,
            data_rise=data_rise,
            rise_number=rise_number,
            delay=data_rise - clock[np.minimum(start_edge, len(clock) - 1)],
            late_periods=late_periods,
        )

    def _find_ssi_bits(self, cycles: _Cycles) -> _Bits:
        """Return the places of the bits, one for each rising edge. The first change of the data shows the delay."""
        clock, falls = self._clock, cycles.falls
        last_edge = cycles.ends - 1
        first_rise = clock[np.minimum(falls + 1, last_edge)]
        # The index after the last edge finds infinity: the data line does not change any more.
        data_edges = np.append(self._data, np.inf)
        change_index = np.searchsorted(self._data, first_rise, "left")
        change = data_edges[change_index]
        # The rising edge before the change. The first one follows the first falling edge, and every second edge rises.
        rises_before = (np.searchsorted(clock, change, "right") - falls) // 2
        nearest_rise = falls + 1 + 2 * np.maximum(rises_before - 1, 0)
        measured_delay = change - clock[np.minimum(nearest_rise, last_edge)]
        # Without a change in the cycle, or with one more than a period after its edge, the delay is not known.
        is_known = (change < cycles.last + cycles.period) & (measured_delay < cycles.period)
        reasons = np.zeros(len(falls), np.int64)
        reasons[cycles.rises < self._bits] = _SHORT
        return _Bits(
            reasons=reasons,
            skipped=np.zeros(len(falls), np.int64),
            delay=np.where(is_known, measured_delay, 0.0),
            sent=cycles.rises,
        )

    def _find_shortest_gaps(self, cycles: _Cycles) -> Any:
        """Return the shortest time between two successive edges of each cycle, from its first falling edge on.

        If the next cycle begins with a rising edge, the time from this edge to its first falling one counts too.
        """
        gaps = np.append(np.diff(self._clock), np.inf)
        # A gap after the last edge of a cycle is a rest.
        gaps[cycles.ends - 1] = np.inf
        return np.minimum.reduceat(gaps, cycles.falls)

    def _list_lost_cycles(self, cycles: _Cycles, bits: _Bits) -> list[Lost]:
        """Return the cycles without a frame, with their reasons."""
        lost: list[Lost] = []
        # Without a rest before it, the capture may have begun within the first cycle.
        is_first_cut = cycles.begin[0] - self._begin < self._rest
        for index in np.flatnonzero(bits.reasons):
            is_cut = bool(index == 0 and is_first_cut)
            reason = self._explain_loss(int(bits.reasons[index]), int(bits.sent[index]), is_cut)
            lost.append(Lost(float(cycles.begin[index]) * self._unit, reason))
        return lost

    def _read_levels(self, cycles: _Cycles, bits: _Bits, good: Any, count: int) -> Any:
        """Return the levels of the data line in the middle of each bit, as an array with a row for each good cycle.

        ``good`` are the indices of these cycles, and ``count`` the number of bits to read, which are the columns.
        """
        falls, rises, period = cycles.falls[good], cycles.rises[good], cycles.period[good]
        # Number of the rising edge of each bit. After the last edge, the period of the clock continues.
        rise_numbers = bits.skipped[good][:, None] + np.arange(count)[None, :]
        last_rise = (rises - 1)[:, None]
        rises_beyond = np.maximum(rise_numbers - last_rise, 0)
        # The first rising edge follows the first falling one, and every second edge rises.
        edge_indices = falls[:, None] + 1 + 2 * np.minimum(rise_numbers, last_rise)
        edges = self._clock[edge_indices] + rises_beyond * period[:, None]
        # A bit changes up to one sample before its edge is seen.
        timing = BitTiming(edges, delay=bits.delay[good], half_bit=period / 2 - self._early)
        has_few_samples = self._early and len(period) and period.min() < _FEW_SAMPLES_PER_PERIOD
        if has_few_samples:
            timing = refine_timing(timing, rises_beyond == 0, self._data)
        middles = timing.find_middles()
        # An odd number of edges before a time inverts the first level.
        edge_counts = np.searchsorted(self._data, middles.ravel(), "right").reshape(middles.shape)
        _, data_level = self._levels
        return (edge_counts & 1) ^ data_level

    def _explain_loss(self, reason: int, bits_sent: int, is_cut: bool) -> str:
        """Return the reason why a cycle was lost. ``is_cut`` is True if the capture may begin within it."""
        if is_cut and reason in (_SHORT, _NO_START, _LOW):
            return "the capture begins within this cycle"
        if reason == _SHORT:
            return f"the clock stops after {bits_sent} of {self._bits} bits"
        return _MESSAGES[reason]


_SHORT, _NO_START, _HIGH, _LOW, _SPIKED, _CUT = range(1, 7)
_MESSAGES: Final = {
    _NO_START: "no start bit: the data line stays low after the acknowledgement",
    _HIGH: "no acknowledgement: the data line stays high",
    _LOW: "the data line is low before the cycle begins",
    _SPIKED: "a very short pulse on the clock",
    _CUT: "the capture ends within this cycle",
}


def _join_bits(levels: Any) -> Any:
    """Return rows of bits as numbers, the first bit as the most significant one."""
    words = np.zeros(len(levels), np.uint64)
    for column in range(levels.shape[1]):
        words = (words << np.uint64(1)) | levels[:, column].astype(np.uint64)
    return words
