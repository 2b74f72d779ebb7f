"""Frames of more than 64 bits, carried as bytes. The outputs are compared with the reference on the same spec."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.reference import codec

SPECS = [Path(__file__).parents[1] / "specs" / name for name in ("manufacturer.yaml", "wide.yaml")]
#: Fields with their widths, most significant first, as in the spec.
FIELDS = {
    "WB": {"multiturn": 32, "singleturn": 32, "error": 1, "warning": 1, "life": 6},
    "WS": {"multiturn": 32, "singleturn": 32, "first": 7, "speed": 33, "life": 8},
}


@pytest.fixture(scope="module")
def device() -> Device:
    (wide,), report = load_library(SPECS)
    assert not report
    return wide


def with_crc(word: int) -> int:
    """Append the inverted CRC-16 0x190D9, by long division."""
    remainder = word << 16
    while remainder >> 16:
        remainder ^= 0x190D9 << (remainder.bit_length() - 17)
    return word << 16 | remainder ^ 0xFFFF


@pytest.mark.parametrize("code", FIELDS)
def test_fields_are_cut_from_88_and_128_bits(code: str, device: Device) -> None:
    chance = random.Random(code)
    variant = device.variant(code)
    placed = device.interface(variant.interface).layouts[0].place(variant.parameters)
    assert placed.bits == {"WB": 88, "WS": 128}[code]
    for _ in range(200):
        word, raw = 0, {}
        for name, width in FIELDS[code].items():
            raw[name] = chance.getrandbits(width)
            word = word << width | raw[name]
        frame = with_crc(word)
        decoded = codec.decode_placed(device, placed, frame.to_bytes(placed.bits // 8, "big"))
        assert not decoded.problems
        assert {field.name: field.raw for field in decoded.fields if field.name in raw} == raw
        assert decoded.values["position"] == raw["multiturn"] << 32 | raw["singleturn"]
        disturbed = frame ^ 1 << chance.randrange(placed.bits)
        assert codec.decode_placed(device, placed, disturbed.to_bytes(placed.bits // 8, "big")).problems


def test_decode_prints_a_frame_of_88_bits(capsys: pytest.CaptureFixture[str]) -> None:
    frame = with_crc((1 << 32 | 2) << 8 | 0xC1).to_bytes(11, "big").hex(" ")
    assert (
        main(["decode", "WB", *frame.split(), *[argument for path in SPECS for argument in ("--specs", str(path))]])
        == 0
    )
    assert "4294967298" in capsys.readouterr().out


def test_a_master_has_no_rules_for_a_frame_in_bytes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["master", "WB", *[argument for path in SPECS for argument in ("--specs", str(path))]]) != 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "'word' is sent as bytes, but the rules for masters cover frames of bits" in printed


def test_a_page_counts_only_the_bits_on_the_line(tmp_path: Path) -> None:
    """70 bits at 1 MHz take 70 us. The two zeros in front of them are not sent."""
    specs = [str(SPECS[0]), str(SPECS[1].with_name("long.yaml"))]
    assert main(["generate", *specs, "-o", str(tmp_path), "--target", "docs"]) == 0
    page = (tmp_path / "docs" / "long" / "LS.md").read_text(encoding="utf-8")
    assert "70 bits at 1 MHz: 70 µs" in page
    assert "70 bits in 9 bytes, high byte first" in page
