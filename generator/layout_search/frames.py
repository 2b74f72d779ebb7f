"""Frames of one length, as they were recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

#: Fewest frames from which a layout can be found.
FEWEST = 2
#: Frames whose values are compared. All of them must satisfy a CRC.
MOST_FRAMES = 60


class NoLayout(ValueError):
    """The frames cannot show a layout. The message says which frames would."""


@dataclass(frozen=True)
class RecordedFrames:
    """Frames of ``bits`` bits over an interface, each as a number whose highest bit is sent first.

    ``positions`` contains the positions that the user turned to, one for each frame, or nothing.
    """

    interface: str
    bits: int
    frames: tuple[int, ...]
    positions: tuple[float, ...] = ()

    @cached_property
    def differences(self) -> tuple[int, ...]:
        """The bits in which each frame differs from the first frame. Frames that are equal to it are left out."""
        first_frame = self.frames[0]
        return tuple(frame ^ first_frame for frame in self.frames if frame != first_frame)

    @cached_property
    def changing(self) -> tuple[bool, ...]:
        """Which bits change, in the order in which they are sent."""
        changing_bits = 0
        for difference in self.differences:
            changing_bits |= difference
        highest_bit = self.bits - 1  # It is sent first.
        return tuple(bool((changing_bits >> bit) & 1) for bit in range(highest_bit, -1, -1))

    @cached_property
    def independent(self) -> int:
        """Number of frames that are not the sum of others in GF(2). Only these prove something about a CRC."""
        return rank(self.differences)

    def values(self, start: int, end: int) -> list[int]:
        """Return the number in the bits from ``start`` to before ``end``, for each of the first frames."""
        mask = (1 << (end - start)) - 1
        bits_behind = self.bits - end
        return [(frame >> bits_behind) & mask for frame in self.frames[:MOST_FRAMES]]

    def level(self, place: int) -> int:
        """Return the value of a constant bit. ``place`` counts from 0 for the first bit sent."""
        bits_behind = self.bits - 1 - place
        # A constant bit is the same in all frames.
        return (self.frames[0] >> bits_behind) & 1


def rank(numbers: Sequence[int]) -> int:
    """Return the rank of numbers as vectors over GF(2): how many of them are not the XOR of others.

    It is 2 for 0b01, 0b10 and 0b11, since 0b11 is the XOR of the other two.
    """
    # Numbers that are independent of each other, by their numbers of bits.
    pivot_by_length: dict[int, int] = {}
    for number in numbers:
        reduced = number
        while reduced and reduced.bit_length() in pivot_by_length:
            reduced ^= pivot_by_length[reduced.bit_length()]
        if reduced:
            pivot_by_length[reduced.bit_length()] = reduced
    return len(pivot_by_length)
