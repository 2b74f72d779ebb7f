"""Errors that a CRC misses, compared with published figures and with every error of a short frame."""

from __future__ import annotations

from itertools import combinations
from math import comb

import pytest
from codewheel.model import Crc
from codewheel.plan.crcs import undetected_errors_of


def crc(poly: int) -> Crc:
    """Return a CRC by its polynomial with all its terms."""
    width = poly.bit_length() - 1
    return Crc(
        name="tested",
        width=width,
        poly=poly & (1 << width) - 1,
        init=0,
        refin=False,
        refout=False,
        xorout=0,
        source=(),
    )


@pytest.mark.parametrize(
    ("poly", "data", "distance"),
    [
        # Koopman, "CRC Polynomial Zoo": the longest data for which a polynomial has a Hamming distance, in a notation
        # without the last term: 9 is 13h, 21 is 43h, 2c is 59h, 97 is 12Fh, 83 is 107h, a6 is 14Dh.
        (0x13, 11, 3),
        (0x43, 57, 3),
        (0x59, 25, 4),
        (0x12F, 119, 4),
        (0x107, 119, 4),
        (0x14D, 247, 3),
        (0x1021 | 1 << 16, 32751, 4),
    ],
)
def test_the_longest_data_for_a_distance(poly: int, data: int, distance: int) -> None:
    tested = crc(poly)
    if data < 1000:
        assert undetected_errors_of(tested, data + tested.width).distance == distance
        assert undetected_errors_of(tested, data + tested.width + 1).distance < distance
    else:
        assert undetected_errors_of(tested, 200).distance == distance


def test_words_of_hamming_codes() -> None:
    """The code (63, 57) of x^6 + x + 1 has 651 words of weight 3, and the codes of 7 and 15 bits have 7 and 35."""
    assert undetected_errors_of(crc(0x43), 63).missed == 651 == 63 * 62 // 6
    assert undetected_errors_of(crc(0xB), 7).missed == 7
    assert undetected_errors_of(crc(0x13), 15).missed == 35


def test_the_exclusive_or_of_bytes() -> None:
    """Two wrong bits at the same position in two of the bytes: 8 positions for each pair."""
    for count in (3, 7, 11):
        undetected = undetected_errors_of(crc(0x101), 8 * count)
        assert (undetected.distance, undetected.missed) == (2, 8 * comb(count, 2))


def test_a_distance_beyond_what_is_counted() -> None:
    """x^16 + x^12 + x^5 + 1 has only even weights, and a distance of 4. A CRC-32 of Ethernet detects more."""
    undetected = undetected_errors_of(crc(0x104C11DB7), 60)
    assert (undetected.distance, undetected.missed) == (5, 0)


@pytest.mark.parametrize("poly", [0x43, 0x59, 0x13, 0x12F, 0x101])
@pytest.mark.parametrize("bits", [12, 18])
def test_every_error_of_a_short_frame(poly: int, bits: int) -> None:
    """Divide every error of up to four bits by the polynomial, bit by bit."""

    def divides(error: int) -> bool:
        while error.bit_length() >= poly.bit_length():
            error ^= poly << (error.bit_length() - poly.bit_length())
        return error == 0

    def error_at(places: tuple[int, ...]) -> int:
        return sum(1 << place for place in places)

    counts = {}
    for error_bits in range(1, 5):
        counts[error_bits] = sum(divides(error_at(places)) for places in combinations(range(bits), error_bits))
    distance = next((error_bits for error_bits, count in counts.items() if count), 5)
    undetected = undetected_errors_of(crc(poly), bits)
    assert (undetected.distance, undetected.missed) == (distance, counts.get(distance, 0))
