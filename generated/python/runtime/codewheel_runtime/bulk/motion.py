# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Motion of an encoder between the frames of a table: unwrapped positions and speeds."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..codec import PositionRange, shorten
from ..errors import RangeError
from ..packages import load
from .units import find_unit_size


def unwrap_positions(positions: Any, usable: Any, position_range: PositionRange, previous: int | None) -> Any:
    """Return the position of each frame as a count that continues when the position wraps around.

    A frame without a usable position has the count of the preceding frame. ``usable`` is True for usable positions.
    ``previous`` is the last count of the preceding frames, or None.

    Raises:
        RangeError: A usable position is above the highest or below the lowest that this encoder sends.
    """
    np: Any = load("numpy")
    positions = positions.astype(np.int64)
    usable_positions = positions[usable]
    if not len(usable_positions):
        return np.full(len(positions), previous or 0, np.int64)
    for extreme in (int(usable_positions.max()), int(usable_positions.min())):
        if not position_range.lowest <= extreme <= position_range.highest:
            raise RangeError("position", extreme, f"{position_range.lowest} to {position_range.highest}")
    first_position = int(usable_positions[0])
    first_count = first_position if previous is None else position_range.unwrap(previous, first_position)
    steps = np.diff(usable_positions)
    modulus = position_range.modulus
    if modulus is not None:
        # The shorter way around: from minus half of the modulus to half of it. With the modulus 360, 350 becomes -10.
        half_modulus = modulus // 2
        steps = (steps + half_modulus) % modulus - half_modulus
    # Index 0 is the count before the first usable position, and index n the count at the n-th usable position.
    count_before = first_count if previous is None else previous
    counts = np.concatenate([[count_before, first_count], first_count + np.cumsum(steps)])
    # For each frame, the number of usable positions up to it.
    usable_counts = np.cumsum(usable)
    return counts[usable_counts].astype(np.int64)


class Motion(NamedTuple):
    """Motion from each usable position to the next.

    Attributes:
        rows: Row of the later position.
        counts: Difference of the unwrapped positions.
        seconds: Time between the two. NaN if the time of the later position is not later.
    """

    rows: Any
    counts: Any
    seconds: Any


def find_motion(counts: Any, times: Any, usable: Any, previous: tuple[int, float] | None) -> Motion:
    """Return the motion between the usable positions in a table.

    ``counts`` and ``times`` are the unwrapped position and the time of each frame. ``previous`` is the unwrapped
    position and the time of the last usable frame before the table, or None.
    """
    np: Any = load("numpy")
    usable_rows = np.flatnonzero(usable)
    usable_counts = counts[usable_rows]
    usable_times = times[usable_rows]
    if previous is None:
        # No position precedes the first usable one.
        later_rows = usable_rows[1:]
    else:
        previous_count, previous_time = previous
        later_rows = usable_rows
        usable_counts = np.insert(usable_counts, 0, previous_count)
        usable_times = np.insert(usable_times, 0, previous_time)
    elapsed = np.diff(usable_times)
    # The clock can stop or be set back, and a time can be infinite.
    is_later = (elapsed > 0) & np.isfinite(elapsed)
    return Motion(rows=later_rows, counts=np.diff(usable_counts), seconds=np.where(is_later, elapsed, np.nan))


def compute_speeds(motion: Motion, unit: str, encoder: Any, count: int) -> Any:
    """Return the speed in each of ``count`` rows, in a unit such as ``degrees`` per second, or ``rpm``.

    The speed is NaN in rows without motion.
    """
    np: Any = load("numpy")
    # ``rpm`` is turns per minute. All other speeds are per second.
    is_rpm = unit == "rpm"
    seconds_per_unit_of_time = 60 if is_rpm else 1
    numerator, denominator = find_unit_size(encoder, "turns" if is_rpm else unit)
    speeds = np.full(count, np.nan)
    speeds[motion.rows] = motion.counts * (seconds_per_unit_of_time * numerator) / denominator / motion.seconds
    return speeds


def list_times(seconds: Any, count: int) -> Any:
    """Return the time of each frame.

    ``seconds`` is the time between two frames, or an array of times. ``count`` is the number of frames.

    Raises:
        ValueError: The times are not numbers, their number differs from the number of frames, or a single time is
            0, negative or infinite.
    """
    np: Any = load("numpy")
    times: Any = np.asarray(seconds)
    # The kinds of NumPy types for numbers: u and i for integers, f for floats, and O for objects such as decimals.
    if times.dtype.kind not in "uifO":
        raise ValueError(f"times must be numbers in seconds, got an array of {times.dtype}")
    try:
        # Speeds need the differences of times, and those of unsigned integers would wrap around.
        times = times.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"times must be numbers in seconds, got {shorten(seconds)}") from None
    if times.ndim == 0:
        if not 0 < times < np.inf:
            raise ValueError(f"the time between two frames must be above 0 s, got {seconds}")
        # This is the time between two frames, and the first frame is at 0.
        return np.arange(count) * times
    if times.ndim > 1:
        raise ValueError(f"expected one time per frame, got an array of the shape {times.shape}")
    if len(times) != count:
        raise ValueError(f"expected {count} times, one per frame, got {len(times)}")
    return times
