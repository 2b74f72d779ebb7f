"""Measure how many bits it takes to describe the values of a field: a position that moves smoothly needs few."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from math import e, log2

#: Bits that describe the scale of the steps of a number.
_SCALE_BITS = 4.0


def uniform_cost(width: int, count: int) -> float:
    """Return the bits of ``count`` random numbers."""
    return float(width * count)


def smooth_cost(values: Sequence[int], width: int) -> float:
    """Return the bits that describe values that change by similar steps, or by steps that change little.

    The first value, and with changes of steps also the first step, take ``width`` bits.
    """
    steps = [signed(after - before, width) for before, after in itertools.pairwise(values)]
    changes_of_steps = [signed(after - before, width) for before, after in itertools.pairwise(steps)]
    by_steps = width + _spread_cost(steps, width)
    if not changes_of_steps:
        return by_steps
    by_changes = 2 * width + _spread_cost(changes_of_steps, width)
    return min(by_steps, by_changes)


def _spread_cost(numbers: Sequence[float], width: int) -> float:
    """Return the bits that describe numbers around zero with a common scale, from 0.5 to ``width`` each."""
    mean = sum(map(abs, numbers)) / len(numbers)
    # The entropy of a Laplace distribution with this mean deviation. The 0.25 keeps the entropy of equal numbers
    # finite.
    bits_each = min(log2(2 * e * (mean + 0.25)), float(width))
    return len(numbers) * max(bits_each, 0.5) + _SCALE_BITS


def signed(number: int, width: int) -> int:
    """Return a number modulo 2^width as a number from -2^(width-1) to 2^(width-1) - 1: -1 for 7 with 3 bits."""
    half = 1 << (width - 1)
    mask = (1 << width) - 1
    return ((number + half) & mask) - half


def cost_beside_positions(values: Sequence[int], width: int, positions: Sequence[float]) -> float:
    """Return the bits that describe values whose positions the user knows, in any unit and from any zero.

    The values are the positions times any factor, without a wrap, or else times one of four factors, across the wrap:
    counts or degrees, in either direction. The best of these counts.
    """
    costs = [_spread_cost(_residuals_of_line(values, width, positions), width)]
    counts_per_degree = (1 << width) / 360
    for factor in (1.0, -1.0, counts_per_degree, -counts_per_degree):
        costs.append(_spread_cost(_residuals_of_factor(values, width, positions, factor), width))
    return 2 * width + min(costs)


def _residuals_of_line(values: Sequence[int], width: int, positions: Sequence[float]) -> list[float]:
    """Return the differences of the values from the line that fits best, without a wrap.

    The line has the user's positions as x, and the values as y.
    """
    middle_position = sorted(positions)[len(positions) // 2]
    middle_value = values[list(positions).index(middle_position)]
    # Relative to the value in the middle, so that the values are as far from the wrap as possible.
    heights = [signed(value - middle_value, width) for value in values]
    mean_position, mean_height = sum(positions) / len(positions), sum(heights) / len(heights)
    # The offsets from the mean, as x and y of the line.
    x_offsets = [position - mean_position for position in positions]
    y_offsets = [height - mean_height for height in heights]
    variance = sum(x**2 for x in x_offsets)
    covariance = sum(x * y for x, y in zip(x_offsets, y_offsets, strict=True))
    slope = covariance / variance if variance else 0.0
    return [y - slope * x for x, y in zip(x_offsets, y_offsets, strict=True)]


def _residuals_of_factor(values: Sequence[int], width: int, positions: Sequence[float], factor: float) -> list[float]:
    """Return the differences of the values from the positions times a factor, across the wrap."""
    offsets = [value - round(position * factor) for value, position in zip(values, positions, strict=True)]
    residuals = [signed(offset - offsets[0], width) for offset in offsets]
    mean = sum(residuals) / len(residuals)
    return [residual - mean for residual in residuals]
