"""Explanations of a frame with an error, and counts from degrees and millimetres."""

from __future__ import annotations

import importlib
from math import tau
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

#: A valid frame of AMM5A21/65KSC1 of 45 bits, and a reply of AMM5A23/65KJP1, the example of the manual's frame.
WORD, BITS = 0x55BCD15E2, 45
REPLY = bytes.fromhex("02 00 C7 D1 6A 7E")
#: The beginnings of the explanations for a dead line.
LOW, HIGH = (f"Every bit is {level}: the line never changes." for level in (0, 1))


@pytest.fixture
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


@pytest.mark.parametrize(
    ("frame", "explanation"),
    [
        (WORD ^ ((1 << BITS) - 1), "with all bits inverted"),
        (int(f"{WORD:0{BITS}b}"[::-1], 2), "with its bits in reverse order"),
        (WORD ^ 0x3F, "with the 6 bits of its CRC inverted"),
        (WORD << 1, "without its last 1 bit: send fewer clocks"),
        (WORD << 3 | 5, "without its last 3 bits: send fewer clocks"),
        (WORD >> 1, "with 1 more bit at its end, 0: send more clocks"),
        (WORD | 1 << BITS + 1, "with only its last 45 bits"),
    ],
)
def test_common_mistakes_with_bits(lika: Any, frame: int, explanation: str) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert any(line.startswith(explanation) for line in lika.why(encoder, frame))
    fault = encoder.try_decode(frame)
    assert isinstance(fault, lika.FrameError)
    assert explanation in fault.hint


@pytest.mark.parametrize(
    ("frame", "explanation"),
    [
        (bytes(byte ^ 0xFF for byte in REPLY), "with all bits inverted"),
        (REPLY[::-1], "with its bytes in reverse order"),
        (b"\x02" + REPLY, "without its first 1 byte: check for an echo"),
        (REPLY + REPLY[:2], "without its last 2 bytes: they may belong to the next frame"),
    ],
)
def test_common_mistakes_with_bytes(lika: Any, frame: bytes, explanation: str) -> None:
    assert explanation in lika.lookup("AMM5A23/65KJP1").try_decode(frame).hint


@pytest.mark.parametrize(
    ("code", "frame", "explanation"),
    [
        ("AMM5A21/65KSC1", 0, f"{LOW} Check for a short circuit, the supply and the clock"),
        ("AMM5A21/65KSC1", (1 << 45) - 1, f"{HIGH} Check for a broken wire, the supply and the clock"),
        ("AMM5A21/65KSC1", (1 << 64) - 1, HIGH),
        ("AMM5A21/65KSC1", "0" * 45, LOW),
        ("AMM5A21/65KSC1", "", "Nothing was received"),
        ("AMM5A23/65KJP1", b"", "Nothing was received"),
        ("AMM5A23/65KJP1", bytes(6), f"{LOW} Check for a short circuit, the supply and wires A and B"),
        ("AMM5A23/65KJP1", b"\xff" * 6, f"{HIGH} Check for a broken wire, the supply and wires A and B"),
    ],
)
def test_a_dead_line_is_the_only_answer(lika: Any, code: str, frame: Any, explanation: str) -> None:
    fault = lika.lookup(code).try_decode(frame)
    assert isinstance(fault, lika.FrameError)
    assert fault.hint.startswith(explanation)
    assert len(lika.why(lika.lookup(code), frame)) == 1


def test_a_dead_line_of_ssi_may_be_a_position(lika: Any) -> None:
    encoder = lika.lookup("AMM5A23/65KBG1")
    for word, level in ((0, 0), ((1 << 39) - 1, 1)):
        assert lika.why(encoder, word)[0].startswith(f"every bit is {level}. A dead line looks the same")
    assert lika.why(encoder, 5) == ()


def test_a_disturbed_bit_comes_first(lika: Any) -> None:
    encoder = lika.lookup("AMM5A21/65KSC1")
    assert lika.why(encoder, WORD ^ 1 << 40)[0] == "with bit 40 inverted: a disturbed bit if only some frames fail"
    # x^8 + 1 reveals one of eight positions, but not the byte.
    reply = REPLY[:4] + bytes([REPLY[4] ^ 0x10]) + REPLY[5:]
    assert lika.why(lika.lookup("AMM5A23/65KJP1"), reply)[0].startswith("with one of 5 bits inverted: a disturbed bit")


def test_a_frame_that_lacks_bits_has_no_disturbed_bit(lika: Any) -> None:
    """44 of 45 bits were received. The number alone would be a frame with one inverted bit."""
    encoder = lika.lookup("AMM5A21/65KSC1")
    number = WORD ^ 1 << 10
    assert "inverted" in encoder.try_decode(number).hint
    for bits in (40, 44):
        with pytest.raises(lika.LengthError) as caught:
            encoder.decode(number, bits=bits)
        assert caught.value.hint == ""
    with pytest.raises(lika.LengthError) as caught:
        encoder.decode(0, bits=44)
    assert caught.value.hint.startswith(LOW)


def test_a_frame_without_a_crc_has_no_inverted_crc() -> None:
    """A word of SPI whose last 4 bits are always 0, and were read as 1."""
    runtime = importlib.import_module("codewheel_runtime")

    class Padded:
        frame_bits = 20
        interface = runtime.Interface.SPI

        def decode(self, frame: int) -> None:
            if frame & 0xF:
                raise runtime.ConstantError("zeros", frame & 0xF, 0)

    assert not [cause for cause in runtime.why(Padded(), 0x1234F) if "CRC" in cause]


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
