# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the cycles of a clock, and the places of their bits, from the edges of the clock and the data line.

A cycle begins with a falling edge of the clock. Then rising and falling edges alternate::

    edge of the clock           0      1       2      3       4      5
                             falls  rises   falls  rises   falls  rises
    number of the rising edge          0              1              2

All results are arrays with one element per cycle.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from ..packages import load

np: Any = load("numpy")

#: Number of periods without an edge after which the clock is idle. BiSS slaves end a cycle after 1.5 or more periods.
IDLE_PERIODS: Final = 1.4
#: Longest delay of a data line, in clock periods, for which the finder waits for the next stretch of the capture.
LONGEST_DELAY: Final = 256
#: Shortest period, as a fraction of the pause.
_SHORTEST_PERIOD: Final = 1e-6

#: Numbers of the reasons why a cycle has no frame. 0 stands for a cycle with a frame.
TOO_FEW_BITS, NO_START_BIT, STAYS_HIGH, LOW_BEFORE_CYCLE, CLOCK_GLITCH, CUT_AT_END = range(1, 7)


class LineEdges(NamedTuple):
    """Times of all edges of the clock and of the data line, and the levels of both lines before these edges."""

    clock: Any
    data: Any
    clock_level: int
    data_level: int


class Cycles(NamedTuple):
    """Cycles of the clock.

    Attributes:
        first_falling_edges: Index of the first falling edge.
        ends: Index after the last edge.
        rise_counts: Number of rising edges.
        begin_times: Time of the first falling edge.
        last_edge_times: Time of the last edge.
        next_edge_times: Time of the first edge after the cycle. Infinity if there is none.
        periods: Period of the clock.
    """

    first_falling_edges: Any
    ends: Any
    rise_counts: Any
    begin_times: Any
    last_edge_times: Any
    next_edge_times: Any
    periods: Any


class CycleBits(NamedTuple):
    """Places of the bits in each cycle.

    Attributes:
        reasons: Reason why the cycle has no frame, such as ``TOO_FEW_BITS``, or 0.
        first_rise_numbers: Number of the rising edge that shifts out the first bit.
        delays: Delay of the data line after the rising edge that shifts out a bit.
        sent_counts: Number of bits that were sent, for the message about a cycle that is too short.
    """

    reasons: Any
    first_rise_numbers: Any
    delays: Any
    sent_counts: Any


class _StartBits(NamedTuple):
    """Start bits of BiSS cycles.

    Attributes:
        levels_before: Level of the data line before the cycle.
        acknowledgement_times: Time at which the data line goes low. Infinity if it stays high.
        arrival_times: Time at which the data line rises with the start bit. Infinity if it stays low.
        last_rise_numbers: Number of the last rising edge of the clock before the start bit arrives. -1 without one.
        delays: Delay of the start bit after this edge.
        late_periods: Number of whole periods by which the acknowledgement, and therefore the data line, is late.
    """

    levels_before: Any
    acknowledgement_times: Any
    arrival_times: Any
    last_rise_numbers: Any
    delays: Any
    late_periods: Any


def find_cycles(lines: LineEdges, starts: Any, ends: Any, pause: float) -> Cycles:
    """Return the clock cycles. Cycles without a falling edge are omitted.

    Each cycle consists of the clock edges from an index in ``starts`` up to, but not including, the one in ``ends``.
    ``pause`` is the time without an edge after which a cycle has ended.
    """
    clock = lines.clock
    # The level before edge n is the first level, inverted if n is odd. If it is low, the next edge rises, and the first
    # falling edge is the one after it. True counts as 1.
    is_low_before = (starts & 1) == lines.clock_level
    first_falling_edges = starts + is_low_before
    # Time of the first edge after each cycle. After the last cycle there may be none.
    next_edge_times = np.append(clock, np.inf)[ends]
    # The end of a timeout is an edge without a cycle.
    has_fall = first_falling_edges < ends
    ends, first_falling_edges, next_edge_times = (
        ends[has_fall],
        first_falling_edges[has_fall],
        next_edge_times[has_fall],
    )
    last_edges = ends - 1
    begin_times = clock[first_falling_edges]
    last_edge_times = clock[last_edges]
    rise_counts = (ends - first_falling_edges) // 2
    # The edges of a cycle are half a period apart on average. With fewer than two rising edges, the pause shows the
    # period.
    half_period_counts = np.maximum(last_edges - first_falling_edges, 1)
    mean_periods = 2 * (last_edge_times - begin_times) / half_period_counts
    periods = np.where(rise_counts > 1, mean_periods, pause / IDLE_PERIODS)
    return Cycles(
        first_falling_edges=first_falling_edges,
        ends=ends,
        rise_counts=rise_counts,
        begin_times=begin_times,
        last_edge_times=last_edge_times,
        next_edge_times=next_edge_times,
        periods=np.maximum(periods, _SHORTEST_PERIOD * pause),
    )


def find_biss_bits(lines: LineEdges, cycles: Cycles, frame_bits: int) -> CycleBits:
    """Return the places of CDS and of the frame in each BiSS cycle. They follow the start bit.

    A cycle has no frame if its start bit is missing, or if the clock stops before the last of ``frame_bits`` bits.
    """
    start_bits = _find_start_bits(lines, cycles)
    # The clock shifts out the start bit with one rising edge, and CDS and the frame with the following ones. It has
    # shifted out the start bit ``late_periods`` before this bit arrives.
    rises_with_start_bit = start_bits.last_rise_numbers - start_bits.late_periods
    last_rise_numbers = cycles.rise_counts - 1
    bits_after_start = last_rise_numbers - rises_with_start_bit
    reasons = _find_biss_errors(cycles, start_bits, has_all_bits=bits_after_start >= 1 + frame_bits)
    # The first bit after the start bit is CDS, which does not count.
    frame_bits_sent = np.maximum(bits_after_start - 1, 0)
    return CycleBits(
        reasons=reasons,
        # The first bit arrives one period after the start bit.
        first_rise_numbers=start_bits.last_rise_numbers + 1,
        delays=start_bits.delays,
        # Only a cycle with too few bits reports how many there were.
        sent_counts=np.where(reasons == TOO_FEW_BITS, frame_bits_sent, cycles.rise_counts),
    )


def _find_biss_errors(cycles: Cycles, start_bits: _StartBits, has_all_bits: Any) -> Any:
    """Return the reason why each BiSS cycle has no frame, or 0 for a cycle with a frame.

    ``has_all_bits`` is True for the cycles whose clock shifts out a whole frame after the start bit.
    """
    # After the last edge of the clock, the start bit can still be on the line for its delay.
    latest_arrivals = cycles.last_edge_times + cycles.periods * (start_bits.late_periods + 2)
    arrives_late = start_bits.arrival_times > latest_arrivals
    arrives_after_cycle = start_bits.arrival_times >= cycles.next_edge_times
    arrives_before_first_rise = start_bits.last_rise_numbers < 0
    # The acknowledgement comes before the next cycle, and is not later than the longest delay.
    longest_delays = LONGEST_DELAY * cycles.periods
    latest_acknowledgements = np.minimum(cycles.next_edge_times, cycles.last_edge_times + longest_delays)
    # The first reason that applies counts. The data line must be high, then low, then high again, so an error in one of
    # these steps is also the cause of errors in later steps.
    reasons_in_order = {
        LOW_BEFORE_CYCLE: start_bits.levels_before == 0,
        STAYS_HIGH: start_bits.acknowledgement_times > latest_acknowledgements,
        NO_START_BIT: arrives_late | arrives_after_cycle | arrives_before_first_rise,
        TOO_FEW_BITS: ~has_all_bits,
    }
    return np.select([*reasons_in_order.values()], [*reasons_in_order], default=0)


def _find_start_bits(lines: LineEdges, cycles: Cycles) -> _StartBits:
    """Return the start bits. The data line goes low as an acknowledgement, and rises with the start bit."""
    clock, first_falling_edges = lines.clock, cycles.first_falling_edges
    # In each cycle, the first edge of the data line is the acknowledgement, and the second one is the start bit.
    first_data_edges = np.searchsorted(lines.data, cycles.begin_times, "left")
    # After the last edge, the data line never changes again: its next edges are at infinity.
    data_times = np.append(lines.data, [np.inf, np.inf])
    acknowledgement_times = data_times[first_data_edges]
    arrival_times = data_times[first_data_edges + 1]
    # Of the clock edges before the start bit arrives, counted from the first falling edge, every second one rises.
    clock_edges_before = np.searchsorted(clock, arrival_times, "right") - first_falling_edges
    last_rise_numbers = clock_edges_before // 2 - 1
    edges_of_last_rises = find_rising_edges(cycles, np.maximum(last_rise_numbers, 0))
    delays = arrival_times - clock[np.minimum(edges_of_last_rises, len(clock) - 1)]
    # A slave without delay acknowledges at the second rising edge, which has the number 1.
    second_rises = clock[np.minimum(find_rising_edges(cycles, 1), cycles.ends - 1)]
    # Without an acknowledgement, the delay does not matter, but it must be finite.
    finite_times = np.where(np.isfinite(acknowledgement_times), acknowledgement_times, 0)
    late_periods = np.maximum(np.floor((finite_times - second_rises) / cycles.periods), 0)
    return _StartBits(
        # An odd number of edges before the cycle inverts the first level.
        levels_before=lines.data_level ^ (first_data_edges & 1),
        acknowledgement_times=acknowledgement_times,
        arrival_times=arrival_times,
        last_rise_numbers=last_rise_numbers,
        delays=delays,
        late_periods=late_periods,
    )


def find_rising_edges(cycles: Cycles, rise_numbers: Any) -> Any:
    """Return the index of a rising edge of each cycle among all edges of the clock.

    ``rise_numbers`` are the numbers of these edges in their cycles, from 0. The first rising edge follows the first
    falling edge, and every second edge is a rising edge.
    """
    return cycles.first_falling_edges + 1 + 2 * rise_numbers


def find_ssi_bits(lines: LineEdges, cycles: Cycles, frame_bits: int) -> CycleBits:
    """Return the places of the bits in each SSI cycle: one for each rising edge of the clock.

    The first change of the data line in a cycle shows its delay relative to the clock. A cycle with fewer than
    ``frame_bits`` rising edges has no frame.
    """
    clock = lines.clock
    last_edges = cycles.ends - 1
    first_rise_times = clock[np.minimum(find_rising_edges(cycles, 0), last_edges)]
    # After its last edge, the data line never changes again: its next change is at infinity.
    data_times = np.append(lines.data, np.inf)
    change_times = data_times[np.searchsorted(lines.data, first_rise_times, "left")]
    # Of the clock edges before this change, counted from the first falling edge, every second one rises.
    clock_edges_before = np.searchsorted(clock, change_times, "right") - cycles.first_falling_edges
    last_rise_numbers = np.maximum(clock_edges_before // 2 - 1, 0)
    measured_delays = change_times - clock[np.minimum(find_rising_edges(cycles, last_rise_numbers), last_edges)]
    is_change_in_cycle = change_times < cycles.last_edge_times + cycles.periods
    is_delay_known = is_change_in_cycle & (measured_delays < cycles.periods)
    has_all_bits = cycles.rise_counts >= frame_bits
    return CycleBits(
        reasons=np.where(has_all_bits, 0, TOO_FEW_BITS),
        first_rise_numbers=np.zeros(len(cycles.first_falling_edges), np.int64),
        delays=np.where(is_delay_known, measured_delays, 0.0),
        sent_counts=cycles.rise_counts,
    )


def find_shortest_gaps(clock: Any, cycles: Cycles) -> Any:
    """Return the shortest time between two successive edges of each cycle, starting at its first falling edge.

    If the next cycle begins with a rising edge, the time from that edge to the first falling edge also counts.
    ``clock`` are the times of all edges of the clock.
    """
    gaps = np.append(np.diff(clock), np.inf)
    # A gap after the last edge of a cycle is a pause.
    gaps[cycles.ends - 1] = np.inf
    return np.minimum.reduceat(gaps, cycles.first_falling_edges)
