"""Split bits into the position, other numbers and constants, and measure the description length of each split."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from math import log2

from ..reference.bits import gray_to_binary
from .frames import MOST_FRAMES, Recording
from .numbers import cost_beside_positions, smooth_cost, uniform_cost

#: Bits that describe one more field, whose values change or not.
_NUMBER_BITS, _CONSTANT_BITS = 8.0, 3.0
#: Most leading ones that are more likely flags that are active low than the highest bits of a position.
_MOST_FLAGS = 2
#: Bits that describe that a position is in Gray code, by interface.
_GRAY_BITS = {"ssi": 0.5}
_MOST_POSITION_BITS = 64


@dataclass(frozen=True, slots=True)
class Field:
    """Bits from ``start`` to before ``end``, all of which change, or none."""

    start: int
    end: int
    changes: bool

    @property
    def width(self) -> int:
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class Split:
    """The place of the position, and the other fields in front of it and behind it.

    ``byte_order`` is set if the position has several bytes over RS-485. ``is_smooth`` is true if the values of the
    position are those of a moving shaft, or those that the user turned to.
    """

    start: int
    end: int
    is_gray: bool
    byte_order: str
    front: tuple[Field, ...]
    behind: tuple[Field, ...]
    cost: float
    is_smooth: bool

    @property
    def width(self) -> int:
        return self.end - self.start


def splits_of(recording: Recording, first: int, end: int) -> Iterator[Split]:
    """Yield the splits of the bits from ``first`` to before ``end`` that have a position."""
    step = 8 if recording.interface == "rs485" else 1

    @cache
    def fields_of(field_start: int, field_end: int) -> tuple[tuple[Field, ...], float]:
        fields = tuple(_fields(recording, field_start, field_end, step))
        return fields, sum(_cost(recording, field, is_in_front=field_start == first) for field in fields)

    for start, position_end in _places(recording, first, end, step):
        front, front_cost = fields_of(first, start)
        behind, behind_cost = fields_of(position_end, end)
        values = recording.values(start, position_end)
        for is_gray, byte_order, read_values in _readings(recording, values, position_end - start):
            constant_bits = _constant_bits(recording, start)
            cost, is_smooth = _position_cost(recording, read_values, position_end - start, constant_bits)
            gray_bits = _GRAY_BITS.get(recording.interface, 1.0) if is_gray else 0.0
            # Of several numbers, the widest one is the position.
            preference = (position_end - start) / 8
            yield Split(
                start=start,
                end=position_end,
                is_gray=is_gray,
                byte_order=byte_order,
                front=front,
                behind=behind,
                cost=cost + gray_bits + front_cost + behind_cost - preference,
                is_smooth=is_smooth,
            )


def _places(recording: Recording, first: int, end: int, step: int) -> Iterator[tuple[int, int]]:
    """Yield the places of a position. Its last bit changes. Constant bits in front of it belong to it all, or not."""
    changing = recording.changing
    for start in range(first, end, step):
        changes_before = start > first and any(changing[start - step : start])
        if start != first and not changes_before and not any(changing[start : start + step]):
            continue
        for position_end in range(start + step, min(end, start + _MOST_POSITION_BITS) + 1, step):
            if any(changing[position_end - step : position_end]):
                yield start, position_end


def _readings(recording: Recording, values: Sequence[int], width: int) -> Iterator[tuple[bool, str, list[int]]]:
    """Yield the values in each code or byte order: whether it is Gray code, the byte order, and the values."""
    if recording.interface == "rs485":
        yield False, "high_byte_first" if width > 8 else "", list(values)
        if width > 8:
            yield False, "low_byte_first", [_swapped(value, width // 8) for value in values]
        return
    yield False, "", list(values)
    if width > 1:
        yield True, "", [gray_to_binary(value) for value in values]


def _swapped(value: int, byte_count: int) -> int:
    return int.from_bytes(value.to_bytes(byte_count, "big"), "little")


def _constant_bits(recording: Recording, start: int) -> int:
    """Return the number of constant bits at the beginning of a position. Over RS-485, they are rather other bytes."""
    if recording.interface == "rs485":
        return 0
    return recording.changing[start:].index(True)


def _position_cost(recording: Recording, values: Sequence[int], width: int, constant_bits: int) -> tuple[float, bool]:
    """Return the bits of the values of a position, and whether they are those of a moving shaft."""
    random_cost = constant_bits + uniform_cost(width - constant_bits, len(values))
    if recording.positions:
        moving_cost = cost_beside_positions(values, width, recording.positions[:MOST_FRAMES])
    else:
        moving_cost = smooth_cost(values, width)
    # The constant bits are described only once.
    moving_cost -= constant_bits
    return min(random_cost, moving_cost), moving_cost < random_cost


def _fields(recording: Recording, start: int, end: int, step: int) -> Iterator[Field]:
    """Yield the runs of bits, or of bytes, that change or not."""
    places = range(start, end, step)
    for changes, group in groupby(places, lambda place: any(recording.changing[place : place + step])):
        run = list(group)
        yield Field(run[0], run[-1] + step, changes)


def _cost(recording: Recording, field: Field, *, is_in_front: bool) -> float:
    if not field.changes:
        are_flags = is_in_front and field.width <= _MOST_FLAGS and is_all_ones(recording, field)
        return field.width - 1.0 if are_flags else field.width + _CONSTANT_BITS
    values = recording.values(field.start, field.end)
    if field.width == 1:
        return _NUMBER_BITS / 2 + _cost_of_flag(values)
    # Only the position may be smooth, because the highest bits of a smooth number are smooth, too.
    return _NUMBER_BITS + uniform_cost(field.width, len(values))


def is_all_ones(recording: Recording, field: Field) -> bool:
    """Return True if all bits of a constant field are 1."""
    return all(recording.level(place) for place in range(field.start, field.end))


def _cost_of_flag(values: Sequence[int]) -> float:
    """Return the bits of a flag, which are few if it is seldom active."""
    share = sum(values) / len(values)
    if share in (0.0, 1.0):
        return log2(len(values))
    entropy = -share * log2(share) - (1 - share) * log2(1 - share)
    return len(values) * entropy + log2(len(values))
