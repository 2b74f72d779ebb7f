"""Frames of one length, as they were recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

#: Fewest frames from which a layout can be found.
FEWEST_FRAMES = 2
#: Maximum number of frames whose values are compared. A CRC must be correct in all frames.
MOST_COMPARED_FRAMES = 60
#: Fewest bits of a frame whose bits are all equal because the line is dead. In shorter frames, this may be chance.
_LEAST_EQUAL_BITS = 12


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
        """The bits in which each frame differs from the first frame. Frames that are equal to it are omitted."""
        first_frame = self.frames[0]
        return tuple(frame ^ first_frame for frame in self.frames if frame != first_frame)

    @property
    def is_dead_line(self) -> bool:
        """True if all bits of each frame are equal, and the frames are so long that this is not chance."""
        all_ones = (1 << self.bits) - 1
        return self.bits >= _LEAST_EQUAL_BITS and set(self.frames) <= {0, all_ones}

    @cached_property
    def bit_changes(self) -> tuple[bool, ...]:
        """True for each bit that differs between frames, in the order in which the bits are sent."""
        changing_bits = 0
        for difference in self.differences:
            changing_bits |= difference
        highest_bit = self.bits - 1  # It is sent first.
        return tuple(bool((changing_bits >> bit) & 1) for bit in range(highest_bit, -1, -1))

    @cached_property
    def independent_difference_count(self) -> int:
        """Number of differences that are not the XOR of others. The remaining frames prove nothing about a CRC."""
        return rank(self.differences)

    def numbers_in_bits(self, start: int, end: int) -> list[int]:
        """Return the number that the bits from ``start`` to before ``end`` form in each frame, at most 60 frames.

        Bits are counted from 0 for the first bit sent.
        """
        mask = (1 << (end - start)) - 1
        bits_behind = self.bits - end
        return [(frame >> bits_behind) & mask for frame in self.frames[:MOST_COMPARED_FRAMES]]

    def bit_value(self, bit_index: int) -> int:
        """Return the value of a constant bit. ``bit_index`` counts from 0 for the first bit sent."""
        bits_behind = self.bits - 1 - bit_index
        any_frame = self.frames[0]
        return (any_frame >> bits_behind) & 1


def rank(numbers: Sequence[int]) -> int:
    """Return how many of the numbers are not the XOR of others, which is their rank as vectors over GF(2).

    It is 2 for 0b01, 0b10 and 0b11, since 0b11 is the XOR of the other two.
    """
    # Independent numbers by their bit length, as in Gaussian elimination.
    pivot_by_length: dict[int, int] = {}
    for number in numbers:
        remaining = number
        while remaining and remaining.bit_length() in pivot_by_length:
            remaining ^= pivot_by_length[remaining.bit_length()]
        if remaining:  # It is independent of all earlier numbers.
            pivot_by_length[remaining.bit_length()] = remaining
    return len(pivot_by_length)
