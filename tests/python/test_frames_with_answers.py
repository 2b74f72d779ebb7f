"""Frames that depend on an answer are encoded for their own encoder, also if frames of another were encoded before."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations
from typing import Any

import pytest
from test_agreement import Family, families

__all__ = ["families"]

#: Bits of the position, as in the order code of the ASC85 manual.
POSITION_BITS = {"ASC8520/SC1": 20, "ASC8525/SC1": 25}


def remainder(number: int) -> int:
    """Return the remainder of ``number`` modulo the polynomial 0x43 of BiSS, bit by bit."""
    while number.bit_length() > 6:
        number ^= 0x43 << number.bit_length() - 7
    return number


@pytest.fixture(params=[*permutations(POSITION_BITS)], ids=" then ".join)
def encoders(families: Mapping[str, Family], request: pytest.FixtureRequest) -> list[Any]:
    """Return new encoders, for which nothing was encoded yet."""
    lookup = families["asc85"].module.lookup
    return [lookup(code)._with_changes() for code in request.param]


def test_each_encoder_has_its_own_width(families: Mapping[str, Family], encoders: list[Any]) -> None:
    asc85 = families["asc85"].module
    for encoder in encoders:
        bits = POSITION_BITS[encoder.code]
        for zero_bit, below_position in ((asc85.ZeroBit.AS_PRINTED, "011"), (asc85.ZeroBit.LEFT_OUT, "11")):
            frame = asc85.SingleCycleData(encoder, zero_bit, (1 << bits) - 1, error=False, warning=False)
            # Error and warning are active low. The CRC is sent inverted, so the remainder is 0x3F.
            assert frame.encode() >> 6 == int("1" * bits + below_position, 2)
            assert remainder(frame.encode()) == 0x3F
            with pytest.raises(ValueError, match=f"position must be 0 to {(1 << bits) - 1}, got {1 << bits}"):
                frame._replace(position=1 << bits).encode()


@pytest.mark.parametrize("wrong", [None, 5, "ASC8525/SC1"])
def test_a_frame_without_an_encoder_is_refused(families: Mapping[str, Family], wrong: Any) -> None:
    asc85 = families["asc85"].module
    frame = asc85.SingleCycleData(wrong, asc85.ZeroBit.AS_PRINTED, 1, error=False, warning=False)
    with pytest.raises(TypeError, match="expected an encoder, got"):
        frame.encode()


def test_a_frame_with_a_wrong_answer_is_refused(families: Mapping[str, Family]) -> None:
    asc85 = families["asc85"].module
    encoder = asc85.lookup("ASC8525/SC1")._with_changes()
    for wrong in (None, 1, []):
        frame = asc85.SingleCycleData(encoder, wrong, 1, error=False, warning=False)
        with pytest.raises(TypeError, match="the manual leaves this open"):
            frame.encode()
