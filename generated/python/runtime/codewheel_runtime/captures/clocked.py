# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the frames of BiSS and SSI in the edges of a clock and a data line.

A cycle begins at the first falling edge of the clock after a pause. Over SSI, each rising edge then shifts out a bit.
Over BiSS, the data line is high at rest, goes low as an acknowledgement, and rises with the start bit. CDS, the frame
and its CRC follow. The levels of the data line after the last bit of the frame are ignored.

Each bit is read in its middle, which is shifted by the delay of the line. Over BiSS, the start bit shows the delay, and
over SSI the first change of the data line.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any, Final, Literal

from ..errors import InputError
from ..packages import load
from .accesses import ControlBits
from .bit_timing import BitTiming, refine_timing
from .captured_frames import CapturedFrames, Lost
from .cycle_bits import (
    CLOCK_GLITCH,
    CUT_AT_END,
    IDLE_PERIODS,
    LONGEST_DELAY,
    LOW_BEFORE_CYCLE,
    NO_START_BIT,
    STAYS_HIGH,
    TOO_FEW_BITS,
    CycleBits,
    Cycles,
    LineEdges,
    find_biss_bits,
    find_cycles,
    find_rising_edges,
    find_shortest_gaps,
    find_ssi_bits,
)
from .signals import Edges, Signals

np: Any = load("numpy")

#: A pulse shorter than this fraction of a period is a glitch.
_GLITCH_FRACTION: Final = 0.15
#: With fewer samples per clock period, the edge positions and the delays of all bits are averaged.
_FEW_SAMPLES_PER_PERIOD: Final = 8
#: Number of edges without a pause above which a signal is not considered a clock.
_EDGES_WITHOUT_PAUSE: Final = 1 << 22
#: Shortest pause, so that no period is 0.
_SHORTEST_PAUSE: Final = 1e-12
#: Number of clock edges needed to determine the clock period.
_EDGES_FOR_PERIOD: Final = 64


def find_clocked_frames(
    signals: Signals, file_name: str, kind: Literal["biss", "ssi"], frame_bits: int, pause: float | None = None
) -> Generator[CapturedFrames, None, None]:
    """Yield the frames of ``frame_bits`` bits.

    Args:
        signals: The clock and the data line.
        file_name: Name of the file, for errors.
        kind: Interface of the encoder.
        frame_bits: Number of bits in a frame.
        pause: Shortest pause between two cycles in seconds, or in samples if the sample rate is unknown. By default,
            1.4 periods of the clock.

    Raises:
        InputError: The clock never changes, or never pauses.
    """
    # Without a sample rate, times are in samples.
    time_unit = signals.seconds or 1.0
    # Inside the finder, times are in the unit of the edges: ``time_unit`` seconds, or samples.
    finder = _CycleFinder(
        kind=kind,
        frame_bits=frame_bits,
        pause=pause / time_unit if pause else None,
        # An edge between two samples is seen at the second one, half a sample late on average.
        edge_delay=0.5 if signals.is_sampled else 0.0,
        time_unit=time_unit,
    )
    for part in signals.edges:
        stretch = finder.feed(part, file_name)
        # Without a complete cycle, there is no stretch yet.
        if stretch is not None:
            yield stretch
    if not finder.is_clocked:
        raise InputError(file_name, "the clock never changes: choose another channel with --clock")
    yield finder.finish()


class _CycleFinder:
    """Finder of cycles. It keeps the edges of the last cycle until the next stretch of the capture arrives."""

    def __init__(
        self, kind: Literal["biss", "ssi"], frame_bits: int, pause: float | None, edge_delay: float, time_unit: float
    ) -> None:
        self._is_biss = kind == "biss"
        self._frame_bits = frame_bits
        self._chosen_pause = pause
        #: Mean time between an edge and the time that the capture gives for it, and length of a time unit in seconds.
        self._edge_delay = edge_delay
        self._time_unit = time_unit
        #: Edges in the incomplete cycles, and the levels of both lines before these edges.
        self._clock_edges, self._data_edges = np.zeros(0), np.zeros(0)
        self._levels_before = (1, 1)
        #: Beginning of the capture, whose first cycle may be cut off. Minus infinity after the first cycles.
        self._capture_begin = -np.inf
        #: End of the capture so far, and the amount of the file that has been read.
        self._capture_end, self._amount_read = 0.0, 0
        #: Time without an edge of the clock after which a cycle has ended. 0 while the clock period is not known.
        self._pause = 0.0
        #: True once the clock has an edge, and True until the first stretch of the capture has arrived.
        self.is_clocked, self._is_empty = False, True

    def feed(self, part: Edges, file_name: str) -> CapturedFrames | None:
        """Return the frames that are completed by the next stretch of the capture.

        Return None if it completes no cycle, or while the clock has too few edges to determine its period. Raises
        InputError if the clock has a very large number of edges without a pause.
        """
        self._append_edges(part)
        edge_count = len(self._clock_edges)
        if not self._pause:
            if edge_count < _EDGES_FOR_PERIOD:
                return None
            self._set_pause()
        cycle_ends = self._find_cycle_ends()
        if len(cycle_ends):
            # The last cycle may continue, or its data may still arrive. It is then left for the next stretch.
            time_since_last_edge = self._capture_end - self._clock_edges[-1]
            is_last_open = time_since_last_edge < LONGEST_DELAY * self._pause
            complete_cycle_ends = cycle_ends[:-1] if is_last_open else cycle_ends
            if len(complete_cycle_ends):
                return self._take_cycles(complete_cycle_ends)
        if edge_count > _EDGES_WITHOUT_PAUSE:
            raise InputError(file_name, "the clock never rests: choose another channel with --clock")
        return None

    def _append_edges(self, part: Edges) -> None:
        """Append the edges in the next stretch of the capture, first of the clock, then of the data line."""
        if self._is_empty:
            # Only the first stretch shows the levels at the beginning.
            clock_level, data_level = part.levels
            self._levels_before = (clock_level, data_level)
            self._capture_begin = part.begin
            self._is_empty = False
        new_clock_edges, new_data_edges = part.times
        self._clock_edges = np.concatenate([self._clock_edges, new_clock_edges])
        self._data_edges = np.concatenate([self._data_edges, new_data_edges])
        self._capture_end = part.end
        self._amount_read = part.amount_read
        self.is_clocked = self.is_clocked or len(self._clock_edges) > 0

    def finish(self) -> CapturedFrames:
        """Return the frames at the end of the capture. The last cycle ends there, even if no pause follows."""
        has_period = len(self._clock_edges) > 2
        if not self._pause and has_period:
            self._set_pause()
        if not self._pause:
            # Two edges define no period, so all edges are one cycle.
            first_edge = float(self._clock_edges[0]) if len(self._clock_edges) else 0.0
            duration = max(self._capture_end - first_edge, _SHORTEST_PAUSE)
            self._pause = self._chosen_pause or duration
        return self._take_cycles(self._find_cycle_ends(), is_last=True)

    def _set_pause(self) -> None:
        """Set the time without an edge after which a cycle has ended: the chosen pause, or 1.4 usual periods."""
        # From an edge to the second one after it, a cycle has one period, regardless of its duty cycle.
        spans = self._clock_edges[2:] - self._clock_edges[:-2]
        # Much longer spans contain a pause.
        periods = spans[spans <= 2 * np.median(spans)]
        usual_pause = IDLE_PERIODS * float(periods.mean())
        pause = self._chosen_pause or usual_pause
        # Damaged files can have edges at the same time, which would make the pause 0.
        self._pause = max(pause, _SHORTEST_PAUSE)

    def _find_cycle_ends(self) -> Any:
        """Return the index after the last clock edge of each cycle. The last cycle can be incomplete."""
        edge_count = len(self._clock_edges)
        if not edge_count:
            return np.zeros(0, np.int64)
        edges_before_pause = np.flatnonzero(np.diff(self._clock_edges) > self._pause)
        return np.append(edges_before_pause + 1, edge_count)

    def _take_cycles(self, cycle_ends: Any, is_last: bool = False) -> CapturedFrames:
        """Return the frames in the cycles that end before the edges ``cycle_ends``, and forget the edges of the cycles.

        ``cycle_ends`` are indices of clock edges. ``is_last`` is True at the end of the capture.
        """
        if not len(cycle_ends):
            return self._make_empty_result()
        cycle_starts = np.concatenate([[0], cycle_ends[:-1]])
        frames = self._find_frames(cycle_starts, cycle_ends, is_last)
        clock_end = int(cycle_ends[-1])
        data_end = self._find_data_end(clock_end, is_last)
        # An odd number of forgotten edges inverts the level before the remaining ones.
        clock_level, data_level = self._levels_before
        self._levels_before = (clock_level ^ (clock_end & 1), data_level ^ (data_end & 1))
        self._clock_edges = self._clock_edges[clock_end:]
        self._data_edges = self._data_edges[data_end:]
        self._capture_begin = -np.inf
        return frames

    def _find_data_end(self, clock_end: int, is_last: bool) -> int:
        """Return the number of edges of the data line that belong to the cycles before the clock edge ``clock_end``.

        The data line may change after the clock stops, so its edges up to the next cycle are included. While the next
        cycle is not known, edges within the pause are included.
        """
        if clock_end < len(self._clock_edges):
            next_cycle = self._clock_edges[clock_end]
        elif is_last:
            next_cycle = np.inf
        else:
            next_cycle = self._clock_edges[clock_end - 1] + self._pause
        return int(np.searchsorted(self._data_edges, next_cycle, "left"))

    def _find_frames(self, starts: Any, ends: Any, is_last: bool) -> CapturedFrames:
        """Return the frames in the clock cycles, and the lost cycles with their reasons.

        Each cycle consists of the clock edges from an index in ``starts`` up to, but not including, the one in
        ``ends``. ``is_last`` is True at the end of the capture, which may cut off the last cycle.
        """
        clock_level, data_level = self._levels_before
        lines = LineEdges(self._clock_edges, self._data_edges, clock_level, data_level)
        cycles = find_cycles(lines, starts, ends, self._pause)
        if not len(cycles.first_falling_edges):
            return self._make_empty_result()
        find_bits = find_biss_bits if self._is_biss else find_ssi_bits
        cycle_bits = find_bits(lines, cycles, self._frame_bits)
        # A glitch on the clock takes precedence over other reasons.
        has_glitch = find_shortest_gaps(self._clock_edges, cycles) < _GLITCH_FRACTION * cycles.periods
        cycle_bits.reasons[has_glitch] = CLOCK_GLITCH
        # A cycle without a reason for its loss has a complete frame.
        complete_indices = np.flatnonzero(cycle_bits.reasons == 0)
        # Over BiSS, the CDS bit comes before the frame.
        bits_before_frame = 1 if self._is_biss else 0
        bits_to_read = bits_before_frame + self._frame_bits
        levels = self._read_levels(cycles, cycle_bits, complete_indices, bits_to_read)
        return CapturedFrames(
            frames=_join_bits(levels[:, bits_before_frame:]),
            times=cycles.begin_times[complete_indices] * self._time_unit,
            lost=self._list_lost_cycles(cycles, cycle_bits, is_last),
            amount_read=self._amount_read,
            control_bits=self._find_control_bits(cycles, complete_indices, levels) if self._is_biss else None,
        )

    def _make_empty_result(self) -> CapturedFrames:
        """Return the result of a stretch without a cycle."""
        return CapturedFrames(_join_bits(np.zeros((0, self._frame_bits), np.uint8)), np.zeros(0), [], self._amount_read)

    def _find_control_bits(self, cycles: Cycles, complete_indices: Any, levels: Any) -> ControlBits:
        """Return the CDS and CDM bits of all cycles, which carry register accesses over BiSS.

        ``complete_indices`` are the indices of the cycles with a frame, and ``levels`` the bits of these cycles, the
        CDS bit first.
        """
        # A lost cycle has -1 instead of its CDS bit.
        cds = np.full(len(cycles.first_falling_edges), -1, np.int64)
        cds[complete_indices] = levels[:, 0]
        # Level of the clock during the timeout, after the last edge. An odd number of edges inverts the first level.
        clock_level_before, _ = self._levels_before
        timeout_levels = clock_level_before ^ (cycles.ends & 1)
        # CDM is the inverse of this level.
        return ControlBits(times=cycles.begin_times * self._time_unit, cds=cds, cdm=timeout_levels ^ 1)

    def _list_lost_cycles(self, cycles: Cycles, cycle_bits: CycleBits, is_last: bool) -> list[Lost]:
        """Return the cycles without a frame, with their reasons.

        ``is_last`` is True at the end of the capture, which may cut off the last cycle.
        """
        lost_cycles: list[Lost] = []
        # If no pause precedes the first cycle, the capture may have begun within it.
        may_first_be_cut = bool(cycles.begin_times[0] - self._capture_begin < self._pause)
        for index in np.flatnonzero(cycle_bits.reasons):
            may_be_cut = may_first_be_cut and index == 0
            reason_number = int(cycle_bits.reasons[index])
            reason = self._explain_loss(reason_number, int(cycle_bits.sent_counts[index]), may_be_cut)
            begin_time = float(cycles.begin_times[index]) * self._time_unit
            lost_cycles.append(Lost(begin_time, reason))
        # If no pause follows the last cycle, the capture may have ended within it. This takes precedence.
        is_last_cycle_lost = bool(cycle_bits.reasons[-1])
        has_pause_at_end = self._capture_end - cycles.last_edge_times[-1] >= self._pause
        if is_last and is_last_cycle_lost and not has_pause_at_end:
            lost_cycles[-1] = lost_cycles[-1]._replace(reason=_MESSAGES[CUT_AT_END])
        return lost_cycles

    def _read_levels(self, cycles: Cycles, cycle_bits: CycleBits, complete_indices: Any, bits_to_read: int) -> Any:
        """Return the level of the data line in the middle of each bit, with a row for each complete cycle.

        ``complete_indices`` are the indices of the cycles with a frame, and ``bits_to_read`` is the number of bits to
        read.
        """
        # The results have a row for each cycle and a column for each bit. With ``[:, None]``, the values of the cycles
        # become a column, which NumPy repeats for each bit.
        complete_cycles = Cycles(*(values[complete_indices][:, None] for values in cycles))
        rise_numbers = cycle_bits.first_rise_numbers[complete_indices][:, None] + np.arange(bits_to_read)[None, :]
        # If there are fewer rising edges than bits, the period of the clock continues after the last one.
        last_rise_numbers = complete_cycles.rise_counts - 1
        missing_rises = np.maximum(rise_numbers - last_rise_numbers, 0)
        edge_indices = find_rising_edges(complete_cycles, np.minimum(rise_numbers, last_rise_numbers))
        rising_edges = self._clock_edges[edge_indices] + missing_rises * complete_cycles.periods
        periods = cycles.periods[complete_indices]
        # A change of the data line is seen late, so the middle of the bit is earlier by this delay.
        half_bits = periods / 2 - self._edge_delay
        timing = BitTiming(rising_edges, delay=cycle_bits.delays[complete_indices], half_bit=half_bits)
        is_sampled = self._edge_delay > 0
        if is_sampled and len(periods) and periods.min() < _FEW_SAMPLES_PER_PERIOD:
            timing = refine_timing(timing, has_edge=missing_rises == 0, data_edges=self._data_edges)
        middles = timing.find_middles()
        # An odd number of edges before a time inverts the first level.
        edge_counts = np.searchsorted(self._data_edges, middles.ravel(), "right").reshape(middles.shape)
        _, data_level = self._levels_before
        return (edge_counts & 1) ^ data_level

    def _explain_loss(self, reason: int, bits_sent: int, may_be_cut: bool) -> str:
        """Return why a cycle has no frame, as text. ``reason`` is the number of the reason, such as ``NO_START_BIT``.

        ``may_be_cut`` is True if the capture may begin within the cycle. ``bits_sent`` is the number of bits before the
        clock stopped.
        """
        if may_be_cut and reason in (TOO_FEW_BITS, NO_START_BIT, LOW_BEFORE_CYCLE):
            return "the capture begins within this cycle"
        if reason == TOO_FEW_BITS:
            return f"the clock stops after {bits_sent} of {self._frame_bits} bits"
        return _MESSAGES[reason]


#: Descriptions of the reasons why a cycle has no frame. The description for ``TOO_FEW_BITS`` depends on the number of
#: bits.
_MESSAGES: Final = {
    NO_START_BIT: "no start bit: the data line stays low after the acknowledgement",
    STAYS_HIGH: "no acknowledgement: the data line stays high",
    LOW_BEFORE_CYCLE: "the data line is low before the cycle begins",
    CLOCK_GLITCH: "a very short pulse on the clock",
    CUT_AT_END: "the capture ends within this cycle",
}


def _join_bits(levels: Any) -> Any:
    """Return rows of bits as numbers, with the first bit as the most significant bit.

    More than 64 bits become rows of bytes. If the bits do not fill the first byte, it begins with zeros.
    """
    bit_count = levels.shape[1]
    if bit_count > 64:
        # Zeros before the first bit, such as 7 for 65 bits, make whole bytes.
        zeros_before = -bit_count % 8
        whole_bytes = np.pad(levels.astype(np.uint8), ((0, 0), (zeros_before, 0)))
        return np.packbits(whole_bytes, axis=1)
    words = np.zeros(len(levels), np.uint64)
    for bit_index in range(bit_count):
        next_bits = levels[:, bit_index].astype(np.uint64)
        words = (words << np.uint64(1)) | next_bits
    return words
