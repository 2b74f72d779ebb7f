"""Conditions on bits in the runtime, for every number of a few bits and compared with their definitions."""

from __future__ import annotations

from codewheel_runtime.bulk.shape import Check
from codewheel_runtime.errors import ErrorKind


def test_a_signed_number_is_within_its_limits() -> None:
    """Five bits in two's complement hold -16 to 15."""
    check = Check(0, 5, ErrorKind.RANGE, highest=7, lowest=-8)
    numbers = {number: number & 31 for number in range(-16, 16)}
    assert {number for number, bits in numbers.items() if check.is_within(bits)} == set(range(-8, 8))


def test_an_unsigned_number_is_at_most_its_limit() -> None:
    check = Check(0, 5, ErrorKind.RANGE, highest=20)
    assert {number for number in range(32) if check.is_within(number)} == set(range(21))
    assert all(Check(0, 5, ErrorKind.RANGE).is_within(number) for number in range(32))


def test_parity_of_several_places() -> None:
    """Bits 1 to 3 and bit 5 count, so 101110b has four ones. Of two bits in each place, the mask selects the lower."""
    places = ((1, 3), (5, 1))
    even, odd = (Check(0, 1, ErrorKind.RANGE, parity_of=places, odd=is_odd) for is_odd in (False, True))
    for number in range(64):
        ones = (number >> 1 & 1) + (number >> 2 & 1) + (number >> 3 & 1) + (number >> 5 & 1)
        assert (even.parity(number), odd.parity(number)) == (ones % 2, 1 - ones % 2)
    masked = Check(0, 1, ErrorKind.RANGE, parity_of=((0, 2), (2, 2)), mask=1)
    assert [masked.parity(number) for number in (0b0001, 0b0010, 0b0100, 0b1000, 0b0101)] == [1, 0, 1, 0, 0]
