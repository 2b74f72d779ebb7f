"""What explains a frame with a fault, and counts out of degrees and millimetres."""

from __future__ import annotations

from math import tau
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

#: A sound frame of AMM5A21/65KSC1, of 45 bits, and a reply of AMM5A23/65KJP1, the example of the manual's frame.
WORD, BITS = 0x55BCD15E2, 45
REPLY = bytes.fromhex("02 00 C7 D1 6A 7E")


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        (WORD ^ ((1 << BITS) - 1), "with all bits inverted"),
        (int(f"{WORD:0{BITS}b}"[::-1], 2), "with its bits in the other order"),
        (WORD ^ 0x3F, "with the 6 bits of its CRC inverted"),
        (WORD << 1, "without its last 1 bit: clock less"),
        (WORD << 3 | 5, "without its last 3 bits: clock less"),
        (WORD >> 1, "with 1 bit more at its end, 0: clock more"),
        (WORD | 1 << BITS + 1, "by its last 45 bits alone"),
    ],
)
def test_common_mistakes_with_bits(lika: Any, frame: int, said: str) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert any(item.startswith(said) for item in lika.why(encoder, frame))
    fault = encoder.try_decode(frame)
    assert isinstance(fault, lika.FrameError)
    assert said in fault.hint


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        (bytes(byte ^ 0xFF for byte in REPLY), "with all bits inverted"),
        (REPLY[::-1], "with its bytes in the other order"),
        (b"\x02" + REPLY, "without its first 1 byte: is there an echo"),
        (REPLY + REPLY[:2], "without its last 2 bytes: did the next frame begin?"),
    ],
)
def test_common_mistakes_with_bytes(lika: Any, frame: bytes, said: str) -> None:
    assert said in lika.lookup("AMM5A23/65KJP1").try_decode(frame).hint


def test_nothing_explains_noise(lika: Any) -> None:
    assert lika.why(lika.lookup("AMM5A23/65KJP1"), b"\x55\xaa\x12") == ()
    assert lika.why(lika.lookup("AMM5A21/65KSC1"), "0101") == ()
    assert lika.CrcError(1, 2).hint == ""


def test_counts_and_angles(lika: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert encoder.radians(1 << 19) == tau / 4
    assert (encoder.from_degrees(90), encoder.from_radians(tau / 4), encoder.from_turns(2.5)) == (
        1 << 19,
        1 << 19,
        5 << 20,
    )
    for count in (0, 1, 12345, (1 << 21) - 1):
        assert encoder.from_degrees(encoder.degrees(count)) == encoder.from_radians(encoder.radians(count)) == count
    tape = lika.lookup("SMA21-SC1-0050")
    assert (tape.metres(20_000), tape.from_millimetres(50)) == (1.0, 1000)
