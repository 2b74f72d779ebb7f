"""Words, bytes and buffers that people published because they looked wrong, each with the answer of its source."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest
from codewheel.commands.cli import main

Capture = pytest.CaptureFixture[str]


def explanations_of(capsys: Capture, code: str, *frame: str) -> list[dict[str, Any]]:
    main(["decode", code, *frame, "--json"])
    data = json.loads(capsys.readouterr().out)
    explanations: list[dict[str, Any]] = data["why"]["explanations"] if data["why"] else []
    return explanations


def printed(capsys: Capture, code: str, *frame: str) -> str:
    main(["decode", code, *frame])
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("word", "request_name"), [("0xFFFF", "position_request"), ("0x7FFD", "read_request"), ("0x4001", "read_request")]
)
def test_a_word_that_equals_its_command(word: str, request_name: str, capsys: Capture) -> None:
    """eborghi10/AS5048A, issue 3: "Read (0x3FFD) with command: 0b111111111111101, Read returned: 111111111111101"."""
    assert f"own request {request_name}, as if MISO were connected to MOSI" in printed(capsys, "AS5048A", word)


@pytest.mark.parametrize("word", ["0xFFFF", "0x7FFD", "0x4001"])
def test_an_echo_is_named_before_all_else(word: str, capsys: Capture) -> None:
    text = printed(capsys, "AS5048A", word)
    assert text.index("own request") < text.index("an error occurred")


def test_a_position_with_the_error_flag_is_no_echo(capsys: Capture) -> None:
    """odriverobotics/ODrive, issue 539: the error flag stays set, and the position is valid."""
    text = printed(capsys, "AS5048A", "0x5234")
    assert "4660 counts" in text
    assert "own request" not in text


def test_a_command_whose_zeros_are_a_right_crc(capsys: Capture) -> None:
    """The request of an MT6835 for its angle, as three drivers send it: A003h and zeros, with the CRC 0."""
    assert "own request angle_request" in printed(capsys, "MT6835", "0xA00300000000")


def test_a_command_in_the_place_of_a_reply_with_a_crc(capsys: Capture) -> None:
    """The command of a TLE5012B, 8021h, on a line that the sensor does not drive: the word ends with ones."""
    (explanation, *_) = explanations_of(capsys, "TLE5012B", "0x8021FFFFFFFF")
    assert explanation["kind"] == "echo"
    assert "angle_request" in explanation["text"]


@pytest.mark.parametrize("word", ["80 21 00 00 00 00", "0x802100000000"])
def test_zeros_after_a_command(word: str, capsys: Capture) -> None:
    """The encoder does not drive the line: neither its position nor its CRC explains the zeros."""
    (explanation,) = explanations_of(capsys, "TLE5012B", word)
    assert explanation["kind"] == "line_stuck"
    text = printed(capsys, "TLE5012B", word)
    assert "Every bit after the command is 0: the encoder does not drive the line" in text
    assert "No common mistake" not in text


@pytest.mark.parametrize("word", ["80 21 CD AC 1F 0B", "80 21 CD AC FF F6"])
def test_a_reply_that_repeats_its_command_is_no_echo(word: str, capsys: Capture) -> None:
    """infineonforums.com, thread 6107: the line carries the command 8021h, the angle and the safety word."""
    text = printed(capsys, "TLE5012B", *word.split())
    assert "19884 counts" in text
    assert "own request" not in text


def test_the_bytes_after_the_command(capsys: Capture) -> None:
    """infineonforums.com, thread 6107: a program keeps the angle CDACh and the safety word after the command 8021h.

    The CRC F6h over command and angle is divided by hand here, because the thread's CRC belongs to another transfer.
    """
    (explanation, *_) = explanations_of(capsys, "TLE5012B", "CD", "AC", "FF", "F6")
    assert explanation["kind"] == "command_left_out"
    assert explanation["reads"]["position"] == 0x4DAC
    assert explanation["one_in"] == 2**8


def test_the_word_is_between_idle_line_and_other_clocks(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    """forum.arduino.cc/t/1034091: of two bytes from an SSI encoder, bits 6 to 0 and 7 to 2 are the position.

    Three such words begin with idle line bits, which a single word does not show.
    """
    readings = [reading["reads"]["position"] for reading in explanations_of(capsys, "ssi:position=13", "8F", "A3")]
    assert readings == [4596, 1000]
    monkeypatch.setattr("sys.stdin", io.StringIO("8F A3\n8F BB\n8F D3\n"))
    main(["decode", "ssi:position=13", "-"])
    words = capsys.readouterr().out.partition("Together")[2]
    assert words.index("the first clock carries no data") < words.index("the word comes first")


def test_zeros_in_front_of_a_word_may_have_been_received(capsys: Capture) -> None:
    """The same thread, with a line that is low before the word: the two bytes are also a number of 13 bits."""
    text = printed(capsys, "ssi:position=13", "0F", "A0")
    assert "4000 counts" in text
    assert "1000 if the first clock carries no data, and the word follows" in text


def test_the_start_value_of_a_known_crc(capsys: Capture) -> None:
    """electronics.stackexchange.com/q/510006: an AS5047U sends 03h, C2h and the CRC 2Ah, where a program has 65h."""
    line = "spi:warning=high,error=high,position=14,crc=8:0x11d:0xff:inverted"
    assert "expected CRC 0x65" in printed(capsys, line, "03", "C2", "2A")
    assert explanations_of(capsys, line, "03", "C2", "2A")[0]["text"] == "the start value of the CRC is 0xc4"
    assert explanations_of(capsys, line, "03", "C2", "65") == []


@pytest.mark.parametrize(
    ("data", "kind", "position"),
    [("54", "echo", None), ("54 00 1D", "bytes_in_front", 7424), ("AB 61 AB 61", "several_frames", 8619)],
)
def test_bytes_without_a_crc(data: str, kind: str, position: int | None, capsys: Capture) -> None:
    """forum.arduino.cc/t/1156467 and 358080: an AMT21 is asked with 54h, and the program reads its own request.

    Position 1856 of thread 1376670 is 7424 with the two bits that an encoder of 12 bits leaves 0. The reply AB 61 is in
    the data sheet.
    """
    (explanation, *_) = explanations_of(capsys, "AMT212B", *data.split())
    assert explanation["kind"] == kind
    assert (explanation["reads"] or {}).get("position") == position


def test_a_request_to_another_address_is_not_surely_an_echo(capsys: Capture) -> None:
    """Only two bits of 58h are constant."""
    assert explanations_of(capsys, "AMT212B", "58") == []


def test_the_lost_first_byte_is_the_address_of_the_request(capsys: Capture) -> None:
    """The published reply of an SKM36, 40 42 00 27 25 51 51, without its address: revolution 626, count 1361."""
    (explanation, *_) = explanations_of(capsys, "SKM36", *"42 00 27 25 51 51".split())
    assert explanation["kind"] == "first_byte_lost"
    assert explanation["reads"] == {"address": 0x40, "multiturn": 626, "singleturn": 1361}


def test_echoes_of_different_requests_are_one_mistake(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that asks an AMT21 for position and revolutions in turn, with 54h and 55h, as the samples do."""
    monkeypatch.setattr("sys.stdin", io.StringIO("54 00 1D\n55 01 80\n"))
    main(["decode", "AMT212D", "-"])
    text = " ".join(capsys.readouterr().out.split())
    assert "2 of 2 frames with an error have this explanation" in text
    assert "- the bytes are whole frames: request, then reply" in text.partition("Together")[2]


def test_two_replies_with_inactive_flags_are_two_replies(capsys: Capture) -> None:
    """The flags of both replies speak for it, not only those of the last one."""
    (explanation, *_) = explanations_of(capsys, "OrbisSerial-14", *"64 56 AB 00 64 56 AB 00".split())
    assert explanation["kind"] == "several_frames"


@pytest.mark.parametrize(
    ("code", "data", "one_in"),
    [
        ("AMM5A17/1JP1", "90 DD 7F", 256),  # only its CRC can contradict the reply 32 90 DD 7F
        ("OrbisSerial-14", "56 AB 00", 1),  # the only constant of 64 56 AB 00 is the first byte
    ],
)
def test_an_assumed_byte_proves_nothing(code: str, data: str, one_in: int, capsys: Capture) -> None:
    (explanation, *_) = explanations_of(capsys, code, *data.split())
    assert (explanation["kind"], explanation["one_in"]) == ("first_byte_lost", one_in)


def test_a_reply_of_another_order_code_is_not_only_a_number_of_revolutions(capsys: Capture) -> None:
    """The reply AB 61 in the data sheet is that of an encoder of 14 bits. The label says 12 bits."""
    text = printed(capsys, "AMT212A", "AB", "61")
    assert "add --layout turns_reply. Another reading: 16 bits, the frame of AMT212B and 3 more" in text


@pytest.mark.parametrize(
    ("line", "word", "reading"),
    [
        ("spi:position=24", "0x50FC", "5307392 if its last bits are missing, and are 0"),
        ("ssi:position=21", "01 20 0A", "663553 if the bytes are swapped"),  # 0A2001h has 20 bits
    ],
)
def test_readings_of_a_word_that_its_length_does_not_contradict(
    line: str, word: str, reading: str, capsys: Capture
) -> None:
    assert reading in printed(capsys, line, *word.split())


@pytest.mark.parametrize("word", ["0x0050FC", "0b" + "0" * 9 + "101000011111100"])
def test_a_word_with_all_its_digits_lacks_no_bits(word: str, capsys: Capture) -> None:
    assert "last bits are missing" not in printed(capsys, "spi:position=24", word)
