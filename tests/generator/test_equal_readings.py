"""Mistakes that a frame cannot distinguish: bits that were lost, equal evidence, and a CRC that misses a shift."""

from __future__ import annotations

import io
import json
import random
from importlib import resources
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.why.hypotheses import MISTAKES
from planted import crc, random_bits

Capture = pytest.CaptureFixture[str]
BISS = "biss:position=22,error,warning,crc=6:0x43"


def why(capsys: Capture, code: str, frame: str) -> dict[str, Any]:
    main(["decode", code, frame, "--json"])
    explained: dict[str, Any] = json.loads(capsys.readouterr().out)["why"]
    return explained


def printed(capsys: Capture, code: str, *frame: str) -> str:
    main(["decode", code, *frame])
    return " ".join(capsys.readouterr().out.split())


def test_the_schema_has_every_kind() -> None:
    schema = json.loads((resources.files("codewheel.language") / "decode.schema.json").read_text(encoding="utf-8"))
    explanation = schema["properties"]["why"]["properties"]["explanations"]["items"]
    assert set(explanation["properties"]["kind"]["enum"]) == set(MISTAKES)


def test_both_values_of_a_lost_bit_are_one_reading(capsys: Capture) -> None:
    """A word of a BML-S1G0 with the error bit, a zero, and 22 bits, behind an idle bit: its last bit is lost."""
    explained = why(capsys, "BML-S1G0-S24-2048", "0b110000111010101010100100")
    early = next(mistake for mistake in explained["explanations"] if mistake["kind"] == "bits_in_front")
    position = int("0000111010101010100100", 2)
    assert early["reads"] == {"position": position << 1}
    assert early["or_reads"] == [{"position": position << 1 | 1}]
    # By chance, the zero is one of two values, whatever the lost bit is.
    assert early["one_in"] == 2


def test_a_parity_that_the_lost_bit_makes_right_is_no_evidence(capsys: Capture) -> None:
    explained = why(capsys, "AS5048A", "0x2000")
    assert [mistake["one_in"] for mistake in explained["explanations"]] == [1, 1]
    assert all(not mistake["or_reads"] for mistake in explained["explanations"])


def test_the_answer_counts_the_readings_that_fit_equally_well(capsys: Capture) -> None:
    """An AMT22 whose two check bits and two zeros are right in three readings, and in one with a lost bit.

    The last reading is the frame of an AMT22-14, which has no zeros.
    """
    word = "0b0011010000100110"
    explained = why(capsys, "AMT22-12", word)
    assert [mistake["one_in"] for mistake in explained["explanations"]] == [8, 16, 16, 16, 4]
    assert explained["equal_readings"] == 3
    words = "The frame fits 3 of these readings equally well. The likeliest one comes first."
    assert words in printed(capsys, "AMT22-12", word)
    # The last bit is lost, or there is an additional first bit.
    assert why(capsys, "AS5045", "0b1001111101000100001")["equal_readings"] == 2
    assert why(capsys, BISS, "0b" + "01" * 15)["equal_readings"] == 0


def test_an_error_that_nothing_explains_has_a_sentence(capsys: Capture) -> None:
    """forum.arduino.cc/t/1376670: an AMT21 sends the bytes 1, 100 and 11111111, none of them a reply."""
    assert "No common mistake explains it." in printed(capsys, "AMT212C-V", "1,100,11111111,")
    assert "No common mistake" not in printed(capsys, "AMT212C-V", "54")


def test_a_word_with_fewer_hex_digits_than_bits(capsys: Capture) -> None:
    """community.simplefoc.com/t/4441: a program reads 16 of the 24 bits of an MT6701."""
    words = "The text has 2 of the 3 bytes of the frame. Missing: 1 byte, treated as leading zeros."
    assert words in printed(capsys, "MT6701", "0x287e")
    assert "error and warning were converted" not in printed(capsys, "MT6701", "0x287e")
    # With leading zeros, it is complete.
    assert "Missing" not in printed(capsys, "MT6701", "0x00287e")


def test_over_spi_the_clock_edge_is_likelier_than_inverted_bits(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three words of an MA732 with 17 clocks, read one clock early. Inverted, their parity would be right, too."""
    monkeypatch.setattr("sys.stdin", io.StringIO("0b10011100000001110\n0b01100111010100011\n0b11100100110010101\n"))
    main(["decode", "MA732", "-"])
    together = capsys.readouterr().out.rpartition("Together")[2]
    assert together.index("as with the other clock edge") < together.index("inverted")


@pytest.mark.parametrize("mistake", ["started one clock early", "started one clock late"])
def test_a_shift_and_a_crc_that_is_not_inverted(mistake: str, capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    """The CRC without inversion is also right in the shifted frames, but only there an error would be active."""
    frames = []
    # The last bit and the first are 0, so the CRC does not detect a shift. The last bit before error is 0.
    for position in range(4710, 5000, 2):
        data = f"{position:022b}11"
        frame = data + crc(data, invert=False)
        if frame.endswith("0"):
            frames.append(f"0b0{frame[:-1]}" if mistake.endswith("early") else f"0b{frame[1:]}0")
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(frames[:3])))
    main(["decode", BISS, "-"])
    _, _, together = capsys.readouterr().out.rpartition("Together, 3 of 3")
    likeliest = together.partition("\n    - ")[2].partition("\n    - ")[0]
    assert likeliest.startswith(mistake)
    assert "the CRC is not inverted" in " ".join(likeliest.split())


def test_each_part_of_a_position_may_be_in_gray_code(capsys: Capture) -> None:
    """Revolution 3 is sent as 0b0010, and count 5 as 0b0111."""
    assert "53 if each of its parts is sent in Gray code" in printed(
        capsys, "ssi:multiturn=4,singleturn=4", "0b00100111"
    )
    # Without parts, there is one reading.
    assert "each of its parts" not in printed(capsys, "ssi:position=8", "0b00100111")


def test_a_crc_that_is_not_inverted_misses_every_second_shift(capsys: Capture) -> None:
    """Without start value and inversion, a frame without its last bit 0 still is a multiple of the polynomial."""
    source = random.Random(48)
    undetected = 0
    for _ in range(400):
        data = random_bits(source, 24)
        frame = data + crc(data, invert=False)
        early = "0" + frame[:-1]
        is_valid = crc(early[:-6], invert=False) == early[-6:]
        assert is_valid == (frame[-1] == "0")
        undetected += is_valid
    assert 160 < undetected < 240
    data = f"{4711:022b}11"
    sentence = "A CRC that is not inverted does not detect a shift by one clock in half of all frames."
    assert sentence in printed(capsys, BISS, "0b" + data + crc(data, invert=False))
    assert sentence not in printed(capsys, BISS, "0b" + data[:-2] + "00" + crc(data))


def test_frames_together_have_the_same_sentence(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    datas = [f"{position:022b}11" for position in (4711, 815, 1234)]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"0b{data}{crc(data, invert=False)}\n" for data in datas)))
    main(["decode", BISS, "-"])
    together = " ".join(capsys.readouterr().out.rpartition("Together")[2].split())
    assert together.startswith(
        ", 3 of 3 frames with an error have this explanation, most likely first: - the CRC is not"
    )
    assert "does not detect a shift by one clock" in together
