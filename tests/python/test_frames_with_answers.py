"""Frames that depend on an answer are encoded for their own encoder, also if frames of another were encoded before."""

from __future__ import annotations

import copy
import pickle
from itertools import permutations
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

#: Bits of the position, as in the order code of the ASC85 manual.
POSITION_BITS = {"ASC8520/SC1": 20, "ASC8525/SC1": 25}


def remainder(number: int) -> int:
    """Return the remainder of ``number`` modulo the polynomial 0x43 of BiSS, bit by bit."""
    while number.bit_length() > 6:
        number ^= 0x43 << number.bit_length() - 7
    return number


@pytest.fixture(scope="session")
def asc85(generated_python: tuple[Path, ModuleType]) -> Any:
    """The module of the family, whose frames over BiSS depend on an answer."""
    return generated_python[1].asc85


@pytest.fixture(params=[*permutations(POSITION_BITS)], ids=" then ".join)
def encoders(asc85: Any, request: pytest.FixtureRequest) -> list[Any]:
    """Return new encoders, for which nothing was encoded yet."""
    return [asc85.lookup(code)._with_changes() for code in request.param]


def test_each_encoder_has_its_own_width(asc85: Any, encoders: list[Any]) -> None:
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
def test_a_frame_without_an_encoder_is_refused(asc85: Any, wrong: Any) -> None:
    frame = asc85.SingleCycleData(wrong, asc85.ZeroBit.AS_PRINTED, 1, error=False, warning=False)
    with pytest.raises(TypeError, match="expected an encoder, got"):
        frame.encode()


def test_a_frame_with_a_wrong_answer_is_refused(asc85: Any) -> None:
    encoder = asc85.lookup("ASC8525/SC1")._with_changes()
    for wrong in (None, 1, []):
        frame = asc85.SingleCycleData(encoder, wrong, 1, error=False, warning=False)
        with pytest.raises(TypeError, match=r"^zero_bit must be ZeroBit.* the manual leaves this open"):
            frame.encode()


def test_a_request_with_exchanged_arguments_is_refused(generated_python: tuple[Path, ModuleType]) -> None:
    """At its creation, and with the name of the argument."""
    amm5: Any = generated_python[1].amm5
    answer = amm5.AdfLayout.AS_PRINTED
    message = r"^adf_layout must be AdfLayout\.AS_PRINTED or AdfLayout\.AS_T_FORMAT, got 5: "
    for create in (
        lambda: amm5.EepromReadRequest(5, answer),
        lambda: amm5.EepromWriteRequest(5, answer, 3),
        lambda: amm5.EepromWriteRequest(5, address=5, data=3),
    ):
        with pytest.raises(TypeError, match=message):
            create()
    request = amm5.EepromWriteRequest(answer, address=5, data=3)
    assert request == pickle.loads(pickle.dumps(request)) == request._replace(address=5) == copy.deepcopy(request)
    assert amm5.EepromWriteRequest.decode(request.encode(), answer) == request
