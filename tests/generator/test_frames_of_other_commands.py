"""SPI replies around their command, and frames without a CRC from another order code."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main

Capture = pytest.CaptureFixture[str]

#: A reply of the TLE5012B with the position 1234h: command, angle, safety word.
COMMAND, DATA = 0x8021, 0x9234_FE08


def why(capsys: Capture, code: str, *frames: str) -> Any:
    main(["decode", code, "--json", *frames])
    return json.loads(capsys.readouterr().out)["why"]


def first_explanation(capsys: Capture, code: str, *frames: str) -> tuple[str, Any]:
    explanation = why(capsys, code, *frames)["explanations"][0]
    return explanation["text"], explanation["reads"]


@pytest.mark.parametrize(
    ("data", "mistake"),
    [
        (DATA << 1 & 0xFFFF_FFFF, "the first bit (1) is missing"),
        (DATA << 1 & 0xFFFF_FFFF | 1, "the first bit (1) is missing"),
        (DATA >> 1, "an extra bit is in front, and the last bit is missing"),
        (DATA >> 1 | 1 << 31, "an extra bit is in front, and the last bit is missing"),
    ],
)
def test_data_are_shifted_after_an_intact_command(capsys: Capture, data: int, mistake: str) -> None:
    text, numbers = first_explanation(capsys, "TLE5012B", f"0x{COMMAND:04X}{data:08X}")
    assert text.startswith("in the bits after the command: started one clock")
    assert mistake in text
    assert numbers["position"] == 0x1234


def test_the_chance_of_shifted_data_does_not_count_the_intact_command(capsys: Capture) -> None:
    """The CRC has 8 bits, the last of which is missing. The words are those of an open question in Infineon's forum."""
    main(["decode", "TLE5012B", "8021 CDAC 1F0B"])
    printed = " ".join(capsys.readouterr().out.split())
    assert "the last bit is missing matches by chance in 1 of 128 frames, and gives bit_15 1, position 7000" in printed


@pytest.mark.parametrize(("idle", "level"), [("0000", 0), ("FFFF", 1)])
def test_only_miso_was_recorded(capsys: Capture, idle: str, level: int) -> None:
    text, numbers = first_explanation(capsys, "TLE5012B", f"0x{idle}{DATA:08X}")
    assert text == (
        f"the first 16 bits, which are sent during the command, are all {level}, as if only MISO were recorded"
    )
    assert numbers["position"] == 0x1234


def test_a_reply_to_another_command_is_named(capsys: Capture) -> None:
    """The reply contains the angular speed, register 03h."""
    main(["decode", "TLE5012B", "0x80311234FED9"])
    assert "this is a valid register_reply: add --layout register_reply" in capsys.readouterr().out


def test_a_word_of_another_order_code_without_a_crc(capsys: Capture) -> None:
    """14 bits of position, read as 12: the two lowest bits should be 0, and both parities are right with them."""
    texts = [explanation["text"] for explanation in why(capsys, "AMT22-12", "0xe329")["explanations"]]
    assert "16 bits, the frame of AMT22-14" in texts
    main(["decode", "AMT22-12", "0xe329\n0x9fff\n0x938b"])
    out = " ".join(capsys.readouterr().out.split())
    together = out.partition("Together, 3 of 3 frames with an error have this explanation")[2]
    assert together.startswith(", most likely first: - 16 bits, the frame of AMT22-14; matches by chance in 1 of 64")


MAKER = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\n"
#: The position has a CRC. The value of a register has only zeros in front, as on a dead line and in requests.
ZEROS = """\
codewheel: 1
device: zeros
manufacturer: acme
title: Replies with zeros
movement: rotary
evidence: {grade: uncorroborated, documents: {manual: test}}
manual: {title: Manual, revision: "1.0", language: en}
parameters: {}
order_code:
  pattern: "Z-{output}"
  source: "1"
  parts: [{name: output, meaning: Words, values: {S: {meaning: SPI, interface: spi}}}]
measurement: {of: position, counts_per_turn: 2^16, turns: 1, source: "1"}
crcs: [{name: spi_8, width: 8, poly: 0x1D, init: 0xFF, refin: false, refout: false, xorout: 0, source: "1"}]
interfaces:
  spi:
    source: "1"
    mode: 1
    word_bits: 24
    reply: next_word
    clock: {max_hz: 10000000, source: "1"}
    exchanges:
      - {request: position_request, reply: position_reply, purpose: position}
      - {request: read_request, reply: register_reply, purpose: read}
    layouts:
      - {name: position_request, from: master, source: "1", fields: [{name: command, bits: 24, constant: 0x003F00}]}
      - name: read_request
        from: master
        source: "1"
        fields: [{name: command, bits: 8, constant: 0x40}, {name: address, bits: 8}, {name: end, bits: 8, constant: 0}]
      - name: position_reply
        from: encoder
        source: "1"
        fields: [{name: position, bits: 16}, {name: crc, crc: spi_8}]
      - name: register_reply
        from: encoder
        source: "1"
        fields: [{name: front, bits: 8, constant: 0}, {name: data, bits: 8}, {name: behind, bits: 8, constant: 0}]
registers: [{name: gain, interface: spi, address: 9, length: 1, access: read_only, source: "1"}]
"""


@pytest.mark.parametrize(
    ("frame", "explanation", "other"),
    [
        ("0x000000", "every bit is 0: the line never changes", "this can be another frame: register_reply"),
        ("0x003F00", "this word is your own request position_request", "this can be another frame: register_reply"),
        ("0x004100", "", "this is a valid register_reply: add --layout register_reply"),
    ],
)
def test_a_dead_line_and_an_echo_are_not_a_frame_of_another_kind(
    capsys: Capture, tmp_path: Path, frame: str, explanation: str, other: str
) -> None:
    """Both fit the reply to another request, but are more likely than that reply."""
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="utf-8")
    (tmp_path / "zeros.yaml").write_text(ZEROS, encoding="utf-8")
    main(["decode", "Z-S", frame, "--specs", str(tmp_path)])
    printed = " ".join(capsys.readouterr().out.split())
    assert other in printed
    assert explanation.lower() in printed.lower()
