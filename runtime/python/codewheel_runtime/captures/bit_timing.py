# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Determines when the bits of each cycle are read: the edges of the clock, and the delay of the data line."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from ..packages import load

np: Any = load("numpy")

#: Maximum distance of an edge from the line through all edges, in samples. Sampling alone causes a smaller distance.
_LONGEST_DISTANCE: Final = 1.5
#: Smallest divisor, for cycles with fewer than two edges.
_SMALLEST_DIVISOR: Final = 1e-9


class BitTiming(NamedTuple):
    """Timing of the bits in some cycles. Arrays have one row per cycle.

    Attributes:
        edges: Times of the rising edges of the clock, one for each bit.
        delay: Delay of the data line after such an edge.
        half_bit: Time from a change of the data line to the middle of the bit.
    """

    edges: Any
    delay: Any
    half_bit: Any

    def find_middles(self) -> Any:
        """Return the time of the middle of each bit."""
        return self.edges + (self.delay + self.half_bit)[:, None]


class _EdgeLines(NamedTuple):
    """Straight lines through the edges of each cycle: time as a function of the edge number.

    Attributes:
        times: Times of the edges on the line.
        periods: Time between two edges on the line, as a column.
        are_even: True for cycles whose edges are all near their line.
    """

    times: Any
    periods: Any
    are_even: Any


def refine_timing(timing: BitTiming, has_edge: Any, data_edges: Any) -> BitTiming:
    """Return the timing of cycles with few samples per clock period, accurate to a fraction of a sample.

    The edges are moved onto a straight line through all edges of a cycle, and the mean delay of all bits is used as
    the delay. ``has_edge`` is False for times after the last edge of a cycle, and ``data_edges`` are the edges of the
    data line. Cycles whose edges are not on a line, because the clock is uneven, keep their timing.
    """
    lines = _fit_lines(timing.edges, has_edge)
    expected_changes = lines.times + timing.delay[:, None]
    mean_delay = timing.delay + _average_distance(expected_changes, lines.periods / 2, data_edges)
    return BitTiming(
        edges=np.where(lines.are_even[:, None], lines.times, timing.edges),
        delay=np.where(lines.are_even, mean_delay, timing.delay),
        half_bit=np.where(lines.are_even, lines.periods[:, 0] / 2, timing.half_bit),
    )


def _fit_lines(times: Any, has_edge: Any) -> _EdgeLines:
    """Return the straight lines through the clock edges of each cycle, by least squares.

    ``times`` has a row for each cycle and a column for each edge. ``has_edge`` is False for times after the last edge,
    which are ignored.
    """
    # Times after the last edge have the weight 0.
    weights = has_edge.astype(np.float64)
    edge_counts = np.maximum(weights.sum(axis=1, keepdims=True), 1)
    # Edges are numbered from 0 in each cycle.
    numbers = np.arange(times.shape[1], dtype=np.float64)[None, :]
    mean_number = (weights * numbers).sum(axis=1, keepdims=True) / edge_counts
    mean_time = (weights * times).sum(axis=1, keepdims=True) / edge_counts
    number_offsets = (numbers - mean_number) * weights
    time_offsets = times - mean_time
    # The slope of the line is the covariance of numbers and times divided by the variance of the numbers.
    covariance = (number_offsets * time_offsets).sum(axis=1, keepdims=True)
    variance = (number_offsets * number_offsets).sum(axis=1, keepdims=True)
    periods = covariance / np.maximum(variance, _SMALLEST_DIVISOR)
    # The line passes through the mean number and the mean time.
    line_times = mean_time + periods * (numbers - mean_number)
    distances = np.abs(line_times - times) * weights
    return _EdgeLines(line_times, periods, are_even=distances.max(axis=1) < _LONGEST_DISTANCE)


def _average_distance(expected_changes: Any, longest_distance: Any, data_edges: Any) -> Any:
    """Return how much later than expected the data line changes in each cycle, averaged over its bits.

    ``expected_changes`` has a row for each cycle and a column for each bit. Bits without a change within
    ``longest_distance`` of the expected time are ignored. If no bit has such a change, the result is 0.
    """
    # After the last edge, the data line never changes again: its next edge is at infinity.
    edges_and_infinity = np.append(data_edges, np.inf)
    # For each bit, the first edge that is not too early. It can still be too late.
    earliest_changes = expected_changes - longest_distance
    edge_indices = np.searchsorted(data_edges, earliest_changes.ravel())
    changes = edges_and_infinity[edge_indices].reshape(expected_changes.shape)
    distances = changes - expected_changes
    is_near = distances < longest_distance
    change_counts = np.maximum(is_near.sum(axis=1), 1)
    return np.where(is_near, distances, 0.0).sum(axis=1) / change_counts
