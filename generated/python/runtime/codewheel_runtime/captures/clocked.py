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
        frames: The frames, in the form that ``decode_many`` expects. Over BiSS and SSI, frames of more than 64 bits
            are rows of bytes.
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
        first_falls: Index of the first falling edge.
        ends: Index after the last edge.
        rise_counts: Number of rising edges.
        begin: Time of the first falling edge.
        last: Time of the last edge.
        after: Time of the first edge after the cycle. Infinity if there is none.
        period: Period of the clock.
    """

    first_falls: Any
    ends: Any
    rise_counts: Any
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
        reasons: Reason why the cycle has no frame, such as ``_TOO_FEW_BITS``, or 0.
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
        #: Time by which an edge is earlier than its sample on average, and length of a unit of time in seconds.
        self._early = early
        self._unit = unit
        #: Edges of the cycles that are not complete, and the levels of both lines before these edges.
        self._clock, self._data = np.zeros(0), np.zeros(0)
        self._levels = (1, 1)
        #: Beginning of the capture, of which the first cycle may be cut off. Minus infinity after the first cycles.
        self._begin = -np.inf
        #: End of the capture so far, and the amount of the file that has been read.
        self._end, self._done = 0.0, 0
        #: Time without an edge of the clock after which a cycle has ended. 0 while the clock period is not known.
        self._pause = 0.0
        #: True once the clock has an edge, and True until the first stretch has arrived.
        self.is_clocked, self._is_new = False, True

    def feed(self, part: Edges, name: str) -> CapturedFrames | None:
        """Return the frames that the next stretch of the capture completes.

        Return None if it completes no cycle, or while the clock has too few edges to determine its period. Raises
        InputError if the clock has very many edges without a pause.
        """
        self._append(part)
        count = len(self._clock)
        if not self._pause:
            if count < _EDGES_FOR_PERIOD:
                return None
            self._set_pause()
        ends = self._find_cycle_ends()
        # The last cycle may continue, or its data may still arrive.
        is_last_open = not len(ends) or self._end - self._clock[-1] < _LONGEST_DELAY * self._pause
        if is_last_open:
            ends = ends[:-1]
        if len(ends):
            return self._take_cycles(ends)
        if count > _EDGES_WITHOUT_PAUSE:
            raise InputError(name, "", "the clock never rests: choose another channel with --clock")
        return None

    def _append(self, part: Edges) -> None:
        """Append the edges of the next stretch of the capture: first of the clock, then of the data line."""
        if self._is_new:
            # Only the first stretch shows the levels at the beginning.
            self._levels = (part.levels[_CLOCK_INDEX], part.levels[_DATA_INDEX])
            self._begin = part.begin
            self._is_new = False
        self._clock = np.concatenate([self._clock, part.times[_CLOCK_INDEX]])
        self._data = np.concatenate([self._data, part.times[_DATA_INDEX]])
        self._end, self._done = part.end, part.done
        self.is_clocked = self.is_clocked or len(self._clock) > 0

    def finish(self) -> CapturedFrames:
        """Return the frames at the end of the capture. Its last cycle ends there, even if no pause follows."""
        has_period = len(self._clock) > 2
        if not self._pause and has_period:
            self._set_pause()
        if not self._pause:
            # Two edges define no period, so all edges are one cycle.
            first_edge = float(self._clock[0]) if len(self._clock) else 0.0
            duration = max(self._end - first_edge, _SHORTEST_PAUSE)
            self._pause = self._chosen_pause or duration
        ends = self._find_cycle_ends() if len(self._clock) else np.zeros(0, np.int64)
        return self._take_cycles(ends, is_last=True)

    def _set_pause(self) -> None:
        """Set the time without an edge after which a cycle has ended: the chosen pause, or 1.4 usual periods."""
        # Within a cycle, two edges are one period, regardless of the duty cycle. Longer spans contain a pause.
        spans = self._clock[2:] - self._clock[:-2]
        spans_of_periods = spans[spans <= 2 * np.median(spans)]
        usual_pause = _IDLE_PERIODS * float(spans_of_periods.mean())
        pause = self._chosen_pause or usual_pause
        # Damaged files can have edges at the same time, which would make the pause 0.
        self._pause = max(pause, _SHORTEST_PAUSE)

    def _find_cycle_ends(self) -> Any:
        """Return the index after the last edge of each cycle. The last cycle can be incomplete."""
        ends = np.flatnonzero(np.diff(self._clock) > self._pause) + 1
        return np.append(ends, len(self._clock)) if len(self._clock) else ends

    def _take_cycles(self, ends: Any, is_last: bool = False) -> CapturedFrames:
        """Return the frames in the cycles that end before the edges ``ends``, and forget the edges of these cycles.

        ``ends`` are indices of clock edges. ``is_last`` is True at the end of the capture.
        """
        if not len(ends):
            return self._make_empty_result()
        starts = np.concatenate([[0], ends[:-1]])
        frames = self._find_frames(starts, ends, is_last)
        clock_end = int(ends[-1])
        data_end = self._find_data_end(clock_end, is_last)
        # An odd number of forgotten edges inverts the level before the remaining ones.
        clock_level, data_level = self._levels
        self._levels = (clock_level ^ (clock_end & 1), data_level ^ (data_end & 1))
        self._clock = self._clock[clock_end:]
        self._data = self._data[data_end:]
        self._begin = -np.inf
        return frames

    def _find_data_end(self, clock_end: int, is_last: bool) -> int:
        """Return the number of edges of the data line that belong to the cycles before the clock edge ``clock_end``.

        The data line may change after the clock stops, so its edges up to the next cycle count. While the next cycle is
        not known, its edges within the pause count.
        """
        if clock_end < len(self._clock):
            next_cycle = self._clock[clock_end]
        elif is_last:
            next_cycle = np.inf
        else:
            next_cycle = self._clock[clock_end - 1] + self._pause
        return int(np.searchsorted(self._data, next_cycle, "left"))

    def _find_frames(self, starts: Any, ends: Any, is_last: bool) -> CapturedFrames:
        """Return the frames in the clock cycles, and the lost cycles with their reasons.

        Each cycle has the clock edges from an index in ``starts`` up to, but not including, the one in ``ends``.
        ``is_last`` is True at the end of the capture, which may cut off the last cycle.
        """
        cycles = self._find_cycles(starts, ends)
        if not len(cycles.first_falls):
            return self._make_empty_result()
        bits = self._find_biss_bits(cycles) if self._is_biss else self._find_ssi_bits(cycles)
        # A glitch on the clock takes precedence over other reasons.
        has_glitch = self._find_shortest_gaps(cycles) < _GLITCH_FRACTION * cycles.period
        bits.reasons[has_glitch] = _CLOCK_GLITCH
        complete = np.flatnonzero(bits.reasons == 0)
        # Over BiSS, the CDS bit comes before the frame.
        bits_before_frame = 1 if self._is_biss else 0
        levels = self._read_levels(cycles, bits, complete, bits_before_frame + self._bits)
        lost = self._list_lost_cycles(cycles, bits)
        is_last_cycle_lost = bool(bits.reasons[-1])
        has_pause_at_end = self._end - cycles.last[-1] >= self._pause
        if is_last and is_last_cycle_lost and not has_pause_at_end:
            lost[-1] = Lost(lost[-1].time, _MESSAGES[_CUT_AT_END])
        return CapturedFrames(
            frames=_join_bits(levels[:, bits_before_frame:]),
            times=cycles.begin[complete] * self._unit,
            lost=lost,
            done=self._done,
            control=self._find_control_bits(cycles, complete, levels) if self._is_biss else None,
        )

    def _make_empty_result(self) -> CapturedFrames:
        """Return the result of a stretch without a cycle."""
        return CapturedFrames(_join_bits(np.zeros((0, self._bits), np.uint8)), np.zeros(0), [], self._done)

    def _find_control_bits(self, cycles: _Cycles, complete: Any, levels: Any) -> ControlBits:
        """Return the CDS and CDM bits of all cycles, which carry register accesses over BiSS.

        ``complete`` are the indices of the cycles with a frame, and ``levels`` the bits of these cycles, the CDS bit
        first.
        """
        cds = np.full(len(cycles.first_falls), -1, np.int64)
        cds[complete] = levels[:, 0]
        # CDM is the inverse of the clock's level during the timeout.
        clock_level, _ = self._levels
        timeout_level = clock_level ^ (cycles.ends & 1)
        return ControlBits(times=cycles.begin * self._unit, cds=cds, cdm=timeout_level ^ 1)

    def _find_cycles(self, starts: Any, ends: Any) -> _Cycles:
        """Return the clock cycles. Cycles without a falling edge are left out.

        Each cycle has the clock edges from an index in ``starts`` up to, but not including, the one in ``ends``.
        """
        clock = self._clock
        # The level before edge n is the first level, inverted if n is odd. If it is low, the next edge rises, and the
        # first falling edge is the one after it. True counts as 1.
        clock_level, _ = self._levels
        is_low_before = (starts & 1) == clock_level
        first_falls = starts + is_low_before
        # Time of the first edge after each cycle. After the last cycle there may be none.
        next_edges = np.append(clock, np.inf)[ends]
        # The end of a timeout is an edge without a cycle.
        has_fall = first_falls < ends
        ends, first_falls, next_edges = ends[has_fall], first_falls[has_fall], next_edges[has_fall]
        begin = clock[first_falls]
        last = clock[ends - 1]
        rise_counts = (ends - first_falls) // 2
        # The edges of a cycle are half a period apart on average. With fewer than two rising edges, the pause shows the
        # period.
        half_periods = np.maximum(ends - 1 - first_falls, 1)
        period = np.where(rise_counts > 1, 2 * (last - begin) / half_periods, self._pause / _IDLE_PERIODS)
        period = np.maximum(period, _SHORTEST_PERIOD * self._pause)
        return _Cycles(
            first_falls=first_falls,
            ends=ends,
            rise_counts=rise_counts,
            begin=begin,
            last=last,
            after=next_edges,
            period=period,
        )

    def _find_biss_bits(self, cycles: _Cycles) -> _Bits:
        """Return the places of the bits in each cycle.

        They follow the start bit, the first rise of the data line after its fall.

        If several reasons for a lost cycle apply, the last one that is set below counts.
        """
        start_bits = self._find_start_bits(cycles)
        data_rise = start_bits.data_rise
        # CDS and the frame need this many rising edges after the start bit.
        rises_needed = self._bits + 1
        # The start bit arrives ``late_periods`` clock periods after the slave has sent it, because of the cable.
        rise_when_sent = start_bits.rise_number - start_bits.late_periods
        rises_after_start = cycles.rise_counts - 1 - rise_when_sent
        # After the last edge, the start bit can still be on the line for its delay.
        latest_start = cycles.last + cycles.period * (start_bits.late_periods + 2)
        latest_acknowledgement = np.minimum(cycles.after, cycles.last + _LONGEST_DELAY * cycles.period)
        has_no_start = (data_rise > latest_start) | (data_rise >= cycles.after) | (start_bits.rise_number < 0)
        reasons = np.zeros(len(cycles.first_falls), np.int64)
        reasons[rises_after_start < rises_needed] = _TOO_FEW_BITS
        reasons[has_no_start] = _NO_START_BIT
        reasons[start_bits.data_fall > latest_acknowledgement] = _STAYS_HIGH
        reasons[start_bits.first_level == 0] = _LOW_BEFORE_CYCLE
        # The first rising edge after the start bit belongs to CDS, the others to bits of the frame.
        frame_bits_sent = np.maximum(rises_after_start - 1, 0)
        # Only a cycle with too few bits reports how many there were.
        sent = np.where(reasons == _TOO_FEW_BITS, frame_bits_sent, cycles.rise_counts)
        return _Bits(reasons=reasons, skipped=start_bits.rise_number + 1, delay=start_bits.delay, sent=sent)

    def _find_start_bits(self, cycles: _Cycles) -> _StartBits:
        """Return the start bits: the data line goes low as an acknowledgement, and rises with the start bit."""
        clock, first_falls = self._clock, cycles.first_falls
        # Index of the first edge of the data line in each cycle.
        first_index = np.searchsorted(self._data, cycles.begin, "left")
        _, data_level = self._levels
        # After the last edge, the data line never changes again: its next edges are at infinity.
        data_edges = np.append(self._data, [np.inf, np.inf])
        data_fall = data_edges[first_index]
        data_rise = data_edges[first_index + 1]
        # Edges of the clock from the first falling one up to this rise. The second one is rising edge 0, and every
        # second one after it rises too.
        edges_up_to_data_rise = np.searchsorted(clock, data_rise, "right") - first_falls
        rise_number = edges_up_to_data_rise // 2 - 1
        start_edge = first_falls + 1 + 2 * np.maximum(rise_number, 0)
        # The slave acknowledges at the second rising edge, three edges after the first falling one.
        second_rise = clock[np.minimum(first_falls + 3, cycles.ends - 1)]
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
        """Return the places of the bits in each cycle: one for each rising edge of the clock.

        The first change of the data line in a cycle shows its delay after the clock.
        """
        clock, first_falls = self._clock, cycles.first_falls
        last_edge = cycles.ends - 1
        first_rise = clock[np.minimum(first_falls + 1, last_edge)]
        # After its last edge, the data line never changes again: its next change is at infinity.
        data_edges = np.append(self._data, np.inf)
        first_change = data_edges[np.searchsorted(self._data, first_rise, "left")]
        # The last rising edge before this change. The first one follows the first falling edge, and every second edge
        # rises.
        rises_before_change = (np.searchsorted(clock, first_change, "right") - first_falls) // 2
        last_rise_before_change = first_falls + 1 + 2 * np.maximum(rises_before_change - 1, 0)
        measured_delay = first_change - clock[np.minimum(last_rise_before_change, last_edge)]
        is_change_in_cycle = first_change < cycles.last + cycles.period
        is_known = is_change_in_cycle & (measured_delay < cycles.period)
        reasons = np.zeros(len(first_falls), np.int64)
        reasons[cycles.rise_counts < self._bits] = _TOO_FEW_BITS
        return _Bits(
            reasons=reasons,
            skipped=np.zeros(len(first_falls), np.int64),
            delay=np.where(is_known, measured_delay, 0.0),
            sent=cycles.rise_counts,
        )

    def _find_shortest_gaps(self, cycles: _Cycles) -> Any:
        """Return the shortest time between two successive edges of each cycle, from its first falling edge on.

        If the next cycle begins with a rising edge, the time from this edge to its first falling one counts too.
        """
        gaps = np.append(np.diff(self._clock), np.inf)
        # A gap after the last edge of a cycle is a pause.
        gaps[cycles.ends - 1] = np.inf
        return np.minimum.reduceat(gaps, cycles.first_falls)

    def _list_lost_cycles(self, cycles: _Cycles, bits: _Bits) -> list[Lost]:
        """Return the cycles without a frame, with their reasons."""
        lost: list[Lost] = []
        # If no pause precedes the first cycle, the capture may have begun within it.
        may_first_be_cut = cycles.begin[0] - self._begin < self._pause
        for index in np.flatnonzero(bits.reasons):
            may_be_cut = bool(index == 0 and may_first_be_cut)
            reason = self._explain_loss(int(bits.reasons[index]), int(bits.sent[index]), may_be_cut)
            lost.append(Lost(float(cycles.begin[index]) * self._unit, reason))
        return lost

    def _read_levels(self, cycles: _Cycles, bits: _Bits, complete: Any, count: int) -> Any:
        """Return the level of the data line in the middle of each bit, with a row for each complete cycle.

        ``complete`` are the indices of the cycles with a frame, and ``count`` is the number of bits to read.
        """
        first_falls, rise_counts = cycles.first_falls[complete], cycles.rise_counts[complete]
        period = cycles.period[complete]
        # Number of the rising edge of each bit. If there are fewer edges, the period of the clock continues after the
        # last one.
        rise_numbers = bits.skipped[complete][:, None] + np.arange(count)[None, :]
        last_rise = (rise_counts - 1)[:, None]
        missing_rises = np.maximum(rise_numbers - last_rise, 0)
        # The first rising edge follows the first falling one, and every second edge rises.
        edge_indices = first_falls[:, None] + 1 + 2 * np.minimum(rise_numbers, last_rise)
        edges = self._clock[edge_indices] + missing_rises * period[:, None]
        # In sampled captures, a bit changes up to one sample before its edge is seen.
        timing = BitTiming(edges, delay=bits.delay[complete], half_bit=period / 2 - self._early)
        is_sampled = self._early > 0
        if is_sampled and len(period) and period.min() < _FEW_SAMPLES_PER_PERIOD:
            timing = refine_timing(timing, missing_rises == 0, self._data)
        middles = timing.find_middles()
        # An odd number of edges before a time inverts the first level.
        edge_counts = np.searchsorted(self._data, middles.ravel(), "right").reshape(middles.shape)
        _, data_level = self._levels
        return (edge_counts & 1) ^ data_level

    def _explain_loss(self, reason: int, bits_sent: int, may_be_cut: bool) -> str:
        """Return why a cycle has no frame, as text. ``reason`` is the number of the reason, such as ``_NO_START_BIT``.

        ``may_be_cut`` is True if the capture may begin within the cycle. ``bits_sent`` is the number of bits before the
        clock stopped.
        """
        if may_be_cut and reason in (_TOO_FEW_BITS, _NO_START_BIT, _LOW_BEFORE_CYCLE):
            return "the capture begins within this cycle"
        if reason == _TOO_FEW_BITS:
            return f"the clock stops after {bits_sent} of {self._bits} bits"
        return _MESSAGES[reason]


#: Numbers of the reasons why a cycle has no frame. 0 stands for a cycle with a frame.
_TOO_FEW_BITS, _NO_START_BIT, _STAYS_HIGH, _LOW_BEFORE_CYCLE, _CLOCK_GLITCH, _CUT_AT_END = range(1, 7)
_MESSAGES: Final = {
    _NO_START_BIT: "no start bit: the data line stays low after the acknowledgement",
    _STAYS_HIGH: "no acknowledgement: the data line stays high",
    _LOW_BEFORE_CYCLE: "the data line is low before the cycle begins",
    _CLOCK_GLITCH: "a very short pulse on the clock",
    _CUT_AT_END: "the capture ends within this cycle",
}


def _join_bits(levels: Any) -> Any:
    """Return rows of bits as numbers, with the first bit as the most significant bit.

    More than 64 bits become rows of bytes. If the bits do not fill the first byte, it begins with zeros.
    """
    bits = levels.shape[1]
    if bits > 64:
        whole_bytes = np.pad(levels.astype(np.uint8), ((0, 0), (-bits % 8, 0)))
        return np.packbits(whole_bytes, axis=1)
    words = np.zeros(len(levels), np.uint64)
    for column in range(bits):
        words = (words << np.uint64(1)) | levels[:, column].astype(np.uint64)
    return words
