"""ASC85 with and without the 0 bit of its BiSS frame: when a wrong decision is detected, and when not.

A frame is correct if it is 0x3F modulo the polynomial 0x43, since the CRC is sent inverted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy
import pytest
from test_agreement import Family, families  # noqa: F401

FRAMES = 1_000_000


def remainder(number: int) -> int:
    """Return the remainder of ``number`` modulo the polynomial 0x43, bit by bit."""
    while number.bit_length() > 6:
        number ^= 0x43 << number.bit_length() - 7
    return number


@pytest.fixture(scope="module")
def asc85(families: Mapping[str, Family]) -> Any:  # noqa: F811
    return families["asc85"].module


def random_frames(asc85: Any, code: str, answer: Any) -> tuple[Any, Any]:
    """Return a million positions, some with error and warning, and their frames."""
    source, encoder = numpy.random.default_rng(85), asc85.lookup(code)
    columns = {
        "position": source.integers(0, encoder.modulus, FRAMES, dtype=numpy.uint64),
        "error": source.random(FRAMES) < 0.1,
        "warning": source.random(FRAMES) < 0.1,
    }
    return columns["position"], encoder.encode_many(columns, zero_bit=answer).astype(numpy.uint64)


def test_a_frame_shifted_by_one_bit_never_fits() -> None:
    """By arithmetic, for every frame of any length: a correct frame is 0x3F + k * 0x43.

    Read a bit too long, it is twice that plus the next bit. Read a bit too short, it is half of that.
    """
    assert [remainder(0x3F << 1 | after) for after in (0, 1)] == [0x3D, 0x3C]
    short = [half for half in range(64) for last in (0, 1) if remainder(half << 1 | last) == 0x3F]
    assert sorted(short) == [0x1F, 0x3E]
    assert 0x3F not in short


@pytest.mark.slow
@pytest.mark.parametrize("code", ["ASC8520/SC1", "ASC8525/SC1"])
@pytest.mark.parametrize("after", [0, 1])
def test_a_receiver_that_shares_the_wrong_decision_rejects_every_frame(asc85: Any, code: str, after: int) -> None:
    """It reads as many bits as the wrong frame has: one too many, or one missing."""
    encoder, printed, left_out = asc85.lookup(code), asc85.ZeroBit.AS_PRINTED, asc85.ZeroBit.LEFT_OUT
    _, frames = random_frames(asc85, code, left_out)
    table = encoder.decode_many(frames << numpy.uint64(1) | numpy.uint64(after), zero_bit=printed)
    assert numpy.count_nonzero(table.fault == 0) == 0
    _, frames = random_frames(asc85, code, printed)
    table = encoder.decode_many(frames >> numpy.uint64(1), zero_bit=left_out)
    assert numpy.count_nonzero(table.fault == 0) == 0


@pytest.mark.slow
@pytest.mark.parametrize("code", ["ASC8520/SC1", "ASC8525/SC1"])
def test_a_word_of_the_right_length_does_not_show_the_wrong_decision(asc85: Any, code: str) -> None:
    """The CRC does not detect leading zeros, so half of all words are accepted, with half or twice the position.

    This is why there is no default. Without the 0 bit, it is every even position. With it, it is every position of the
    lower half turn.
    """
    encoder, printed, left_out = asc85.lookup(code), asc85.ZeroBit.AS_PRINTED, asc85.ZeroBit.LEFT_OUT
    position, frames = random_frames(asc85, code, left_out)
    table = encoder.decode_many(frames, zero_bit=printed)
    accepted = table.fault == 0
    assert (accepted == (position % 2 == 0)).all()
    assert (numpy.asarray(table.position)[accepted] == position[accepted] // 2).all()
    position, frames = random_frames(asc85, code, printed)
    table = encoder.decode_many(frames, zero_bit=left_out)
    accepted = table.fault == 0
    assert (accepted == (position < encoder.modulus // 2)).all()
    assert (numpy.asarray(table.position)[accepted] == position[accepted] * 2).all()


@pytest.mark.slow
def test_a_wrong_order_code_of_the_same_length_shows_in_half_of_all_frames(asc85: Any) -> None:
    """24 bits with the 0 bit and 25 bits without it both have 33 bits. Only the order code distinguishes them."""
    position, frames = random_frames(asc85, "ASC8525/SC1", asc85.ZeroBit.LEFT_OUT)
    table = asc85.lookup("ASC8524/SC1").decode_many(frames, zero_bit=asc85.ZeroBit.AS_PRINTED)
    assert ((table.fault == 0) == (position % 2 == 0)).all()


@pytest.mark.slow
def test_both_decode_their_own(asc85: Any) -> None:
    """Position 1, no error: 1, the 0 bit or none, 11, and the CRC, from 1011b and 111b times x^6 by hand."""
    encoder = asc85.lookup("ASC8525/SC1")
    for answer, bits, length in ((asc85.ZeroBit.AS_PRINTED, 0b1011, 34), (asc85.ZeroBit.LEFT_OUT, 0b111, 33)):
        frame = bits << 6 | remainder(bits << 6) ^ 0x3F
        assert encoder.decode(frame, bits=length, zero_bit=answer).position == 1
        with pytest.raises(ValueError, match=f"expected {length} bits, got {67 - length}"):
            encoder.decode(frame, bits=67 - length, zero_bit=answer)
    message = "zero_bit must be ZeroBit.AS_PRINTED or ZeroBit.LEFT_OUT, got None: the manual leaves this open"
    with pytest.raises(TypeError, match=message):
        encoder.decode(frame)
