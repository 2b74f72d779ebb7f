"""Frames whose bits or bytes are in another order, with or without a CRC, and several frames of the same form."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest
from codewheel.commands.cli import main
from planted import crc

#: 26 bits of position, error and warning, and a CRC of 6 bits: 34 bits in all, so bytes are filled up with zeros.
BISS = "biss:position=26,error,warning,crc=6:0x43"
#: 32 bits: whole bytes, and whole words of 16 bits.
WHOLE = "biss:position=24,error,warning,crc=6:0x43"
#: A word of SPI that begins with four constant bits, and contains no CRC.
CONSTANT = "spi:head=4:0xa,position=16,tail=4:0x3"


def why(capsys: pytest.CaptureFixture[str], code: str, *frame: str) -> list[dict[str, Any]]:
    """Return the explanations of a frame."""
    main(["decode", code, *frame, "--json"])
    captured = capsys.readouterr()
    data = json.loads(captured.out)
    explanations: list[dict[str, Any]] = data["why"]["explanations"] if data["why"] else []
    return explanations


def frame_of(position: int, bits: int) -> str:
    data = f"{position:0{bits}b}11"
    return data + crc(data)


def hex_bytes(bits: str) -> list[str]:
    return [f"{int(bits[place : place + 8], 2):02x}" for place in range(0, len(bits), 8)]


def test_the_bytes_of_each_word_are_swapped(capsys: pytest.CaptureFixture[str]) -> None:
    first, second, third, fourth = hex_bytes(frame_of(0x123456, 24))
    explanation = why(capsys, WHOLE, second, first, fourth, third)[0]
    assert explanation["text"] == "the two bytes of each 16-bit word are swapped"
    assert explanation["reads"] == {"position": 0x123456}


def test_a_frame_of_other_bits_is_filled_up_to_whole_words(capsys: pytest.CaptureFixture[str]) -> None:
    """34 bits are the end of three words of 16 bits. Their first 14 bits are 0."""
    data = hex_bytes(frame_of(0x2345678, 26).zfill(48))
    swapped = [data[place ^ 1] for place in range(6)]
    explanation = why(capsys, BISS, *swapped)[0]
    assert explanation["kind"] == "words_swapped"
    assert explanation["reads"] == {"position": 0x2345678}
    # 6 bits of the CRC and 14 zeros.
    assert explanation["one_in"] == 1 << 20


def test_the_bits_of_each_byte_are_reversed(capsys: pytest.CaptureFixture[str]) -> None:
    frame = frame_of(0xABCDE, 24)
    reversed_bytes = "".join(frame[place : place + 8][::-1] for place in range(0, 32, 8))
    explanation = why(capsys, WHOLE, f"0b{reversed_bytes}")[0]
    assert explanation["text"] == "the bits of each byte are in reverse order"
    assert explanation["reads"] == {"position": 0xABCDE}


#: A reply of a TS5700 with the position 7000519.
REPLY = bytes.fromhex("02 20 C7 D1 6A 5E")
REVERSED_REPLY = bytes(int(f"{byte:08b}"[::-1], 2) for byte in REPLY).hex(" ")
RS485_LINE = "rs485,low_byte_first:control=8:0x02,status=8,position=24,crc=8:0x101"


@pytest.mark.parametrize(("code", "name"), [("TS5700N8401", "singleturn"), (RS485_LINE, "position")])
def test_the_bits_of_each_byte_are_reversed_over_rs485(
    code: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    explanation = why(capsys, code, REVERSED_REPLY)[0]
    assert explanation["kind"] == "bits_reversed_in_bytes"
    assert explanation["reads"][name] == 7000519


def test_constants_contradict_a_frame_without_a_crc(capsys: pytest.CaptureFixture[str]) -> None:
    word = f"1010{0x1234:016b}0011"
    texts = {
        "all_inverted": "".join("10"[int(bit)] for bit in word),
        "bits_reversed": word[::-1],
        "bytes_reversed": word[16:] + word[8:16] + word[:8],
    }
    for kind, text in texts.items():
        explanation = next(one for one in why(capsys, CONSTANT, f"0b{text}") if one["kind"] == kind)
        assert explanation["reads"] == {"position": 0x1234}
        assert explanation["one_in"] == 1 << 8


def test_a_valid_frame_has_no_explanation(capsys: pytest.CaptureFixture[str]) -> None:
    assert not why(capsys, CONSTANT, f"0b1010{0x1234:016b}0011")
    assert not why(capsys, WHOLE, f"0b{frame_of(0x123456, 24)}")


def test_a_crc_that_is_right_by_coincidence_does_not_hide_other_constants(capsys: pytest.CaptureFixture[str]) -> None:
    """Search for a frame whose reverse has a valid CRC, but wrong zeros."""
    line = "biss:position=19,zero=5,error,warning,crc=6:0x43"
    for position in range(1, 1 << 19):
        data = f"{position:019b}0000011"
        reverse = (data + crc(data))[::-1]
        if crc(reverse[:26]) == reverse[26:] and reverse[19:24] != "00000":
            break
    kinds = [explanation["kind"] for explanation in why(capsys, line, f"0b{reverse}")]
    assert "bits_reversed" in kinds


def test_a_request_is_in_front_of_a_reply_of_the_same_form(capsys: pytest.CaptureFixture[str]) -> None:
    """Tamagawa's request to write the EEPROM, and its reply, have the same bytes: 32h, address, data, and their XOR."""
    request = ["32", "01", "5A", f"{0x32 ^ 0x01 ^ 0x5A:02X}"]
    explanation = why(capsys, "TS5700N8401", *request, *request)[0]
    names = [part["name"] for part in explanation["parts"]]
    assert names == ["request eeprom_write_request", "reply eeprom_write_reply"]


def test_bits_without_a_prefix_that_can_only_be_bits(capsys: pytest.CaptureFixture[str]) -> None:
    """As a decimal or hexadecimal number, 32 digits would not fit into 32 bits."""
    assert main(["decode", WHOLE, frame_of(0x123456, 24), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    values = {field["name"]: field["value"] for field in data["fields"]}
    assert values["position"] == 0x123456
    # One digit less is a wrong length, and digits that are also a number are rejected.
    assert main(["decode", WHOLE, frame_of(0x123456, 24)[1:]]) == 1
    assert main(["decode", "ssi:position=24", "0101"]) == 2


def test_other_readings_of_a_position_without_counts(capsys: pytest.CaptureFixture[str]) -> None:
    """A word of an SC60228 that was read with an extra bit in front: 2000 counts look like 1000."""
    assert main(["decode", "spi:position=12,error=high,df=2,parity=even", "0x3E80"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "2000 if it was read one clock early" in printed


def test_one_repeated_bit_does_not_prove_a_repeated_word(capsys: pytest.CaptureFixture[str]) -> None:
    """The first clock carries no data, and the next bit equals the first by chance: an AS5045 read with 19 clocks."""
    word = f"{1000:012b}10000"
    word += str(word.count("1") % 2)
    explanations = why(capsys, "ssi:position=12,value=5,parity=even", f"0b1{word}")
    assert [explanation["kind"] for explanation in explanations][:1] == ["bits_in_front"]
    assert explanations[0]["reads"]["position"] == 1000


def test_a_mistake_is_made_once(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A CDS bit of 0 in front also fits a wider order code, read a bit too short, whose highest bit is 0.

    In three frames that bit would be 0 by chance only one time in eight. CDS is almost always 0.
    """
    frames = []
    for position in (0x5A5A5, 0x12345, 0x7FFFF):
        data = f"{position:019b}" + "11"
        frames.append(f"0b0{(data + crc(data))[:-1]}\n")
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(frames)))
    assert main(["decode", "iC-MU-19-0", "-"]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    together = printed[printed.index("3 of 3 frames with an error") :]
    assert together.index("started one clock early") < together.index("read 1 bit too short")


def test_frames_of_one_other_order_code_have_one_explanation(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Zeros above the position differ between order codes, so some frames fit more of them than others."""
    frames = []
    for position in (0x00005, 0x0A5A5, 0x7FFFF):
        data = f"{position:019b}" + "11"
        frames.append(f"0b{data}{crc(data)}\n")
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(frames)))
    assert main(["decode", "iC-MU-24-0", "-"]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "3 of 3 frames with an error" in printed
    assert "27 bits, the frame of" in printed[printed.index("3 of 3 frames with an error") :]
