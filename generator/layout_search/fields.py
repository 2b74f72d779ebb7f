"""Split bits into the position, other numbers and constants, and measure the description length of each split."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from math import e, log2
from typing import NamedTuple

from ..reference.bits import gray_to_binary
from .frames import MOST_FRAMES, RecordedFrames

#: Bits that describe one more field, whose values change or not.
_NUMBER_BITS, _CONSTANT_BITS = 8.0, 3.0
#: Most leading ones that are more likely flags that are active low than the highest bits of a position.
_MOST_FLAGS = 2
#: Bits that describe that a position is in Gray code, by interface.
_GRAY_BITS = {"ssi": 0.5}
#: Most bits of a field of a line, and so of a position.
MOST_BITS = 64
#: Bits that describe the scale of the steps of a number.
_SCALE_BITS = 4.0


@dataclass(frozen=True, slots=True)
class FoundField:
    """Bits from ``start`` to before ``end``, all of which change, or none."""

    start: int
    end: int
    changes: bool

    @property
    def width(self) -> int:
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class FrameSplit:
    """The place of the position, and the other fields in front of it and behind it.

    ``byte_order`` is set if the position has several bytes over RS-485. ``is_smooth`` is true if the values of the
    position fit a moving shaft or the positions that the user turned to.
    """

    start: int
    end: int
    is_gray: bool
    byte_order: str
    front: tuple[FoundField, ...]
    behind: tuple[FoundField, ...]
    cost: float
    is_smooth: bool

    @property
    def width(self) -> int:
        return self.end - self.start


def splits_of(recording: RecordedFrames, first: int, end: int) -> Iterator[FrameSplit]:
    """Yield every split of the bits from ``first`` to before ``end`` that has a position, with its cost in bits.

    There is a split for each place of the position, and each code or byte order in which it may be sent. The cost is
    the number of bits that describe the recording with this split, so the lowest one is the best.
    """
    step = 8 if recording.interface == "rs485" else 1

    @cache
    def fields_and_cost(fields_start: int, fields_end: int) -> tuple[tuple[FoundField, ...], float]:
        is_in_front = fields_start == first
        fields = tuple(_divide_by_change(recording, fields_start, fields_end, step))
        return fields, sum(_field_cost(recording, field, is_in_front=is_in_front) for field in fields)

    for position_start, position_end in _places_of_position(recording, first, end, step):
        width = position_end - position_start
        front, front_cost = fields_and_cost(first, position_start)
        behind, behind_cost = fields_and_cost(position_end, end)
        sent_values = recording.values(position_start, position_end)
        constant_bits = _constant_bits(recording, position_start)
        for reading in _read_in_each_code(recording, sent_values, width):
            cost, is_smooth = _position_cost(recording, reading.values, width, constant_bits)
            gray_cost = _GRAY_BITS.get(recording.interface, 1.0) if reading.is_gray else 0.0
            # Of several numbers, the widest one is rather the position.
            preference = width / 8
            yield FrameSplit(
                start=position_start,
                end=position_end,
                is_gray=reading.is_gray,
                byte_order=reading.byte_order,
                front=front,
                behind=behind,
                cost=cost + gray_cost + front_cost + behind_cost - preference,
                is_smooth=is_smooth,
            )


def _places_of_position(recording: RecordedFrames, first: int, end: int, step: int) -> Iterator[tuple[int, int]]:
    """Yield the start and end of each place for a position, in steps of a bit or a byte.

    The last step of a position changes. It begins with a step that changes, or with the first of the constant steps
    before one, so that it has all of these or none.
    """
    changing = recording.changing
    for start in range(first, end, step):
        changes_at_start = any(changing[start : start + step])
        changes_before = start > first and any(changing[start - step : start])
        can_start = start == first or changes_before or changes_at_start
        if not can_start:
            continue
        furthest_end = min(end, start + MOST_BITS)
        for position_end in range(start + step, furthest_end + 1, step):
            if any(changing[position_end - step : position_end]):
                yield start, position_end


class _Reading(NamedTuple):
    """The values of a position if it is sent in this code and byte order."""

    values: list[int]
    is_gray: bool = False
    byte_order: str = ""


def _read_in_each_code(recording: RecordedFrames, sent_values: Sequence[int], width: int) -> Iterator[_Reading]:
    """Yield the values read as binary and as Gray code or, over RS-485, in both byte orders.

    One bit is the same in both codes, and one byte in both orders.
    """
    if recording.interface != "rs485":
        yield _Reading(list(sent_values))
        if width > 1:
            yield _Reading([gray_to_binary(value) for value in sent_values], is_gray=True)
    elif width == 8:
        yield _Reading(list(sent_values))
    else:
        yield _Reading(list(sent_values), byte_order="high_byte_first")
        swapped_values = [_with_bytes_swapped(value, width // 8) for value in sent_values]
        yield _Reading(swapped_values, byte_order="low_byte_first")


def _with_bytes_swapped(two_bytes: int, byte_count: int) -> int:
    """Return the number with its bytes in reverse order: 0x3412 for 0x1234."""
    return int.from_bytes(two_bytes.to_bytes(byte_count, "big"), "little")


def _constant_bits(recording: RecordedFrames, start: int) -> int:
    """Return the number of constant bits at the beginning of a position, or 0 over RS-485.

    Constant bytes there are more likely other fields.
    """
    if recording.interface == "rs485":
        return 0
    return recording.changing[start:].index(True)


def _position_cost(
    recording: RecordedFrames, values: Sequence[int], width: int, constant_bits: int
) -> tuple[float, bool]:
    """Return the bits that describe the values of a position, and whether the values fit a moving shaft.

    They fit if the steps from value to value, or the user's positions, describe them with fewer bits than random
    values.
    """
    random_cost = constant_bits + uniform_cost(width - constant_bits, len(values))
    if recording.positions:
        moving_cost = cost_beside_positions(values, width, recording.positions[:MOST_FRAMES])
    else:
        moving_cost = smooth_cost(values, width)
    # The constant bits are described only once.
    moving_cost -= constant_bits
    is_smooth = moving_cost < random_cost
    return min(random_cost, moving_cost), is_smooth


def _divide_by_change(recording: RecordedFrames, start: int, end: int, step: int) -> Iterator[FoundField]:
    """Yield a field for each run of bits, or of bytes, that all change or that are all constant.

    ``step`` is 1 for bits and 8 for bytes. A byte changes if one of its bits does.
    """

    def does_change(place: int) -> bool:
        return any(recording.changing[place : place + step])

    for changes, places in groupby(range(start, end, step), does_change):
        # ``places`` are the starts of adjacent steps.
        first_place, *later_places = places
        last_place = later_places[-1] if later_places else first_place
        yield FoundField(start=first_place, end=last_place + step, changes=changes)


def _field_cost(recording: RecordedFrames, field: FoundField, *, is_in_front: bool) -> float:
    """Return the cost of a field other than the position: the bits that describe it and its values.

    A constant field costs its width and a few bits more, and any other also the bits of its value in each frame.
    ``is_in_front`` is true for a field in front of the position.
    """
    if not field.changes:
        are_inactive_flags = is_in_front and field.width <= _MOST_FLAGS and is_all_ones(recording, field)
        # Such flags have a lower cost, so that they are not read as the highest bits of the position.
        return field.width - 1.0 if are_inactive_flags else field.width + _CONSTANT_BITS
    values = recording.values(field.start, field.end)
    if field.width == 1:
        return _NUMBER_BITS / 2 + _cost_of_flag(values)
    # Only the position may be smooth, because the highest bits of a smooth number are smooth, too.
    return _NUMBER_BITS + uniform_cost(field.width, len(values))


def is_all_ones(recording: RecordedFrames, field: FoundField) -> bool:
    """Return True if all bits of a constant field are 1."""
    return all(recording.level(place) for place in range(field.start, field.end))


def _cost_of_flag(values: Sequence[int]) -> float:
    """Return the bits of a flag, which are few if it is seldom active."""
    share_of_ones = sum(values) / len(values)
    # Bits that describe how many of the values are 1.
    bits_of_count = log2(len(values))
    # The places of the ones take no bits if all values are equal, and else as many for each value as its entropy.
    if share_of_ones in (0.0, 1.0):
        return bits_of_count
    entropy = -share_of_ones * log2(share_of_ones) - (1 - share_of_ones) * log2(1 - share_of_ones)
    return len(values) * entropy + bits_of_count


def uniform_cost(width: int, count: int) -> float:
    """Return the bits of ``count`` random numbers."""
    return float(width * count)


def smooth_cost(values: Sequence[int], width: int) -> float:
    """Return the bits that describe values that change by similar steps, or by steps that change little.

    The first value, and with changes of steps also the first step, take ``width`` bits.
    """
    steps = [as_signed(after - before, width) for before, after in itertools.pairwise(values)]
    changes_of_steps = [as_signed(after - before, width) for before, after in itertools.pairwise(steps)]
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


def as_signed(number: int, width: int) -> int:
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
    heights = [as_signed(value - middle_value, width) for value in values]
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
    residuals = [as_signed(offset - offsets[0], width) for offset in offsets]
    mean = sum(residuals) / len(residuals)
    return [residual - mean for residual in residuals]
