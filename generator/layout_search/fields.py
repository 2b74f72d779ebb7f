"""Split bits into the position, other numbers and constants, and estimate the bits that describe each split.

The cost of a split is the number of bits that describe the fields and their values in all frames. The split with the
lowest cost is the most likely one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from math import e, log2
from typing import NamedTuple

from ..reference.bits_and_values import gray_to_binary
from .frames import MOST_COMPARED_FRAMES, RecordedFrames

#: Bits that describe a number, a flag and a constant field, in addition to their values.
_NUMBER_BITS, _FLAG_BITS, _CONSTANT_BITS = 8.0, 4.0, 3.0
#: Up to this many leading ones are more likely active-low flags than the highest bits of a position.
_MOST_FLAGS = 2
#: Bits that describe that a position is in Gray code, by interface.
_GRAY_BITS = {"ssi": 0.5}
#: Maximum number of bits of a field in a line, and therefore of a position.
MOST_BITS = 64
#: Bits that describe the scale of the steps of a number.
_SCALE_BITS = 4.0


@dataclass(frozen=True, slots=True)
class FoundField:
    """Bits from ``start`` to before ``end``, all of which change between frames, or none of them."""

    start: int
    end: int
    changes: bool

    @property
    def width(self) -> int:
        """Number of bits."""
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class FrameSplit:
    """The bits of the position, from ``position_start`` to before ``position_end``, and the other fields around it.

    ``byte_order`` is set if the position has several bytes over RS-485. ``cost`` is the number of bits that describe
    the fields and their values. ``is_smooth`` is true if the values of the position fit a moving shaft, or the
    positions to which the user turned it.
    """

    position_start: int
    position_end: int
    is_gray: bool
    byte_order: str
    fields_before: tuple[FoundField, ...]
    fields_after: tuple[FoundField, ...]
    cost: float
    is_smooth: bool

    @property
    def width(self) -> int:
        """Number of bits of the position."""
        return self.position_end - self.position_start


def possible_splits(recording: RecordedFrames, first_bit: int, end: int) -> Iterator[FrameSplit]:
    """Yield every way to split the bits from ``first_bit`` to before ``end`` into a position and other fields.

    There is a split for each place of the position, and for each code or byte order in which it may be sent. The cost
    of a split is the number of bits that describe the fields and their values, so the lowest cost is the best.
    """
    unit_bits = 8 if recording.interface == "rs485" else 1

    @cache
    def fields_and_cost(fields_start: int, fields_end: int) -> tuple[tuple[FoundField, ...], float]:
        """Return the fields from ``fields_start`` to before ``fields_end``, and their cost."""
        is_in_front = fields_start == first_bit
        fields = tuple(_divide_by_change(recording, fields_start, fields_end, unit_bits))
        return fields, sum(_field_cost(recording, field, is_in_front=is_in_front) for field in fields)

    for position_start, position_end in _places_of_position(recording, first_bit, end, unit_bits):
        width = position_end - position_start
        fields_before, cost_before = fields_and_cost(first_bit, position_start)
        fields_after, cost_after = fields_and_cost(position_end, end)
        sent_values = recording.numbers_in_bits(position_start, position_end)
        constant_bits = _constant_bits(recording, position_start)
        for reading in _read_in_each_code(recording, sent_values, width):
            position_cost, is_smooth = _position_cost(recording, reading.values, width, constant_bits)
            gray_cost = _GRAY_BITS.get(recording.interface, 1.0) if reading.is_gray else 0.0
            # Of several numbers, the widest one is most likely the position.
            bonus_for_width = width / 8
            yield FrameSplit(
                position_start=position_start,
                position_end=position_end,
                is_gray=reading.is_gray,
                byte_order=reading.byte_order,
                fields_before=fields_before,
                fields_after=fields_after,
                cost=position_cost + gray_cost + cost_before + cost_after - bonus_for_width,
                is_smooth=is_smooth,
            )


def _places_of_position(
    recording: RecordedFrames, first_bit: int, end: int, unit_bits: int
) -> Iterator[tuple[int, int]]:
    """Yield the start and the end of each place where the position can be.

    ``unit_bits`` is 8 if the position consists of whole bytes, and otherwise 1. The last bit or byte of the position
    changes between frames. The position includes either all of the constant bits before its first changing bit, or none
    of them.
    """
    bit_changes = recording.bit_changes
    for start in range(first_bit, end, unit_bits):
        changes_at_start = any(bit_changes[start : start + unit_bits])
        changes_before = start > first_bit and any(bit_changes[start - unit_bits : start])
        can_start = start == first_bit or changes_before or changes_at_start
        if not can_start:
            continue
        furthest_end = min(end, start + MOST_BITS)
        for position_end in range(start + unit_bits, furthest_end + 1, unit_bits):
            changes_at_end = any(bit_changes[position_end - unit_bits : position_end])
            if changes_at_end:
                yield start, position_end


class _Reading(NamedTuple):
    """The values of a position if it is sent in this code and byte order."""

    values: list[int]
    is_gray: bool = False
    byte_order: str = ""


def _read_in_each_code(recording: RecordedFrames, sent_values: Sequence[int], width: int) -> Iterator[_Reading]:
    """Yield the values of a position as binary numbers and as Gray code or, over RS-485, in both byte orders.

    A single bit is the same in both codes, and a single byte in both orders, so these are yielded once.
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


def _with_bytes_swapped(number: int, byte_count: int) -> int:
    """Return a number of ``byte_count`` bytes with its bytes in reverse order: 0x3412 for 0x1234."""
    return int.from_bytes(number.to_bytes(byte_count, "big"), "little")


def _constant_bits(recording: RecordedFrames, start: int) -> int:
    """Return the number of constant bits with which a position begins, or 0 over RS-485."""
    if recording.interface == "rs485":
        return 0  # Constant bytes are more likely other fields.
    return recording.bit_changes[start:].index(True)


def _position_cost(
    recording: RecordedFrames, values: Sequence[int], width: int, constant_bits: int
) -> tuple[float, bool]:
    """Return the number of bits that describe the values of a position, and whether the values fit a moving shaft.

    They fit if it takes fewer bits to describe the steps from value to value, or the differences from the positions to
    which the user turned the shaft, than to describe random values.
    """
    random_cost = constant_bits + cost_of_random_numbers(width - constant_bits, len(values))
    if recording.positions:
        moving_cost = cost_with_known_positions(values, width, recording.positions[:MOST_COMPARED_FRAMES])
    else:
        moving_cost = cost_of_smooth_values(values, width)
    # The constant bits are part of the random cost only once.
    moving_cost -= constant_bits
    is_smooth = moving_cost < random_cost
    return min(random_cost, moving_cost), is_smooth


def _divide_by_change(recording: RecordedFrames, start: int, end: int, unit_bits: int) -> Iterator[FoundField]:
    """Yield a field for each run of adjacent bits that all change between frames, or that are all constant.

    If ``unit_bits`` is 8, the fields consist of whole bytes. A byte changes if one of its bits changes.
    """

    def does_change(first_bit: int) -> bool:
        return any(recording.bit_changes[first_bit : first_bit + unit_bits])

    for changes, adjacent_bits in groupby(range(start, end, unit_bits), does_change):
        bits_of_field = list(adjacent_bits)
        yield FoundField(start=bits_of_field[0], end=bits_of_field[-1] + unit_bits, changes=changes)


def _field_cost(recording: RecordedFrames, field: FoundField, *, is_in_front: bool) -> float:
    """Return the number of bits that describe a field other than the position, and its values in all frames.

    The value of a constant field is described once. ``is_in_front`` is true for a field before the position.
    """
    if not field.changes:
        are_inactive_flags = is_in_front and field.width <= _MOST_FLAGS and is_all_ones(recording, field)
        if are_inactive_flags:
            # A lower cost, so that they are not mistaken for the highest bits of the position.
            return field.width - 1.0
        return field.width + _CONSTANT_BITS
    values = recording.numbers_in_bits(field.start, field.end)
    if field.width == 1:
        return _FLAG_BITS + _cost_of_flag(values)
    # Only the position benefits from smooth values, because the highest bits of a smooth number are also smooth.
    return _NUMBER_BITS + cost_of_random_numbers(field.width, len(values))


def is_all_ones(recording: RecordedFrames, field: FoundField) -> bool:
    """Return whether all bits of a constant field are 1."""
    return all(recording.bit_value(bit_index) for bit_index in range(field.start, field.end))


def _cost_of_flag(values: Sequence[int]) -> float:
    """Return the number of bits that describe the values of a flag in all frames. It is small if they rarely change."""
    share_of_ones = sum(values) / len(values)
    # Bits that describe how many of the values are 1.
    bits_of_count = log2(len(values))
    are_all_equal = share_of_ones in (0.0, 1.0)
    if are_all_equal:
        return bits_of_count
    # The bits per value that describe which values are 1.
    entropy = -share_of_ones * log2(share_of_ones) - (1 - share_of_ones) * log2(1 - share_of_ones)
    return len(values) * entropy + bits_of_count


def cost_of_random_numbers(width: int, count: int) -> float:
    """Return the number of bits that describe ``count`` random numbers of ``width`` bits."""
    return float(width * count)


def cost_of_smooth_values(values: Sequence[int], width: int) -> float:
    """Estimate the number of bits that describe a series of values of ``width`` bits that change smoothly.

    The series is described by its first value and its first differences, or by its first value, its first difference
    and its second differences. The cheaper of the two descriptions counts.
    """
    first_differences = [as_signed(after - before, width) for before, after in itertools.pairwise(values)]
    second_differences = [as_signed(after - before, width) for before, after in itertools.pairwise(first_differences)]
    cost_by_first = width + _cost_of_residuals(first_differences, width)
    if not second_differences:
        return cost_by_first
    cost_by_second = 2 * width + _cost_of_residuals(second_differences, width)
    return min(cost_by_first, cost_by_second)


def _cost_of_residuals(numbers: Sequence[float], width: int) -> float:
    """Estimate the number of bits that describe numbers around zero: the smaller the numbers, the fewer bits.

    Each number takes 0.5 to ``width`` bits.
    """
    mean_deviation = sum(map(abs, numbers)) / len(numbers)
    # The entropy of a Laplace distribution with this mean deviation. Adding 0.25 keeps the logarithm finite if all
    # numbers are 0.
    entropy = log2(2 * e * (mean_deviation + 0.25))
    bits_per_number = max(min(entropy, float(width)), 0.5)
    return len(numbers) * bits_per_number + _SCALE_BITS


def as_signed(number: int, width: int) -> int:
    """Return the signed number of ``width`` bits that equals ``number`` modulo 2^width: -1 for 7 and 3 bits."""
    half = 1 << (width - 1)
    mask = (1 << width) - 1
    return ((number + half) & mask) - half


def cost_with_known_positions(values: Sequence[int], width: int, positions: Sequence[float]) -> float:
    """Estimate the number of bits that describe values if the user knows the position of the shaft for each of them.

    ``positions`` are in any unit and from any zero. Either the values do not wrap, and are the positions times any
    factor, or they wrap, and the positions are in counts or degrees, in either direction. The best fit counts.
    """
    costs = [_cost_of_residuals(_residuals_of_line(values, width, positions), width)]
    counts_per_degree = (1 << width) / 360
    for factor in (1.0, -1.0, counts_per_degree, -counts_per_degree):
        residuals = _residuals_of_factor(values, width, positions, factor)
        costs.append(_cost_of_residuals(residuals, width))
    return 2 * width + min(costs)


def _residuals_of_line(values: Sequence[int], width: int, positions: Sequence[float]) -> list[float]:
    """Return the differences between the values and the straight line that fits them best, if they do not wrap.

    The line is a linear regression of the values (y) over the user's positions (x).
    """
    middle_position = sorted(positions)[len(positions) // 2]
    middle_value = values[list(positions).index(middle_position)]
    # Relative to the value in the middle, so that the values are as far from the wrap as possible.
    relative_values = [as_signed(value - middle_value, width) for value in values]
    mean_position = sum(positions) / len(positions)
    mean_value = sum(relative_values) / len(relative_values)
    x_offsets = [position - mean_position for position in positions]
    y_offsets = [value - mean_value for value in relative_values]
    variance = sum(x**2 for x in x_offsets)
    covariance = sum(x * y for x, y in zip(x_offsets, y_offsets, strict=True))
    slope = covariance / variance if variance else 0.0
    # The mean is on the line, so the line passes through the offsets (0, 0).
    return [y - slope * x for x, y in zip(x_offsets, y_offsets, strict=True)]


def _residuals_of_factor(values: Sequence[int], width: int, positions: Sequence[float], factor: float) -> list[float]:
    """Return the differences between the values, which may wrap, and the user's positions times ``factor``."""
    offsets = [value - round(position * factor) for value, position in zip(values, positions, strict=True)]
    first_offset = offsets[0]
    # The position 0 of the user can be any value, so only differences between the offsets matter.
    residuals = [as_signed(offset - first_offset, width) for offset in offsets]
    mean = sum(residuals) / len(residuals)
    return [residual - mean for residual in residuals]
