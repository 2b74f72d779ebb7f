"""Digits without a prefix, as programs and logs print them."""

from __future__ import annotations

import json

import pytest
from codewheel.commands.cli import main
from codewheel.commands.decode.digits import bits_of_bytes, with_leading_zeros, with_prefix

Capture = pytest.CaptureFixture[str]


@pytest.mark.parametrize(
    ("text", "bits", "prefixed"),
    [
        ("7FFE", 16, "0x7FFE"),
        ("03e87f", 24, "0x03e87f"),
        ("0200", 16, "0x0200"),
        ("D03ADE68AF80", 40, "0xD03ADE68AF80"),
        # Decimal, or hexadecimal.
        ("8192", 16, "8192"),
        # Bits, decimal or hexadecimal, unless all bits of the frame are there.
        ("1010", 16, "1010"),
        ("0000000000000001", 16, "0b0000000000000001"),
        ("b0101", 16, "b0101"),
        ("0b0101", 16, "0b0101"),
        ("0,1", 16, "0,1"),
        ("0 1 0 1", 4, "0b0101"),
        ("0 1 0 1", 16, "0b0101"),
        # Two bytes, or two bits.
        ("0 1", 16, "0 1"),
        ("10 01", 16, "10 01"),
        ("1010 0101 1", 40, "0b101001011"),
        ("10100101 01", 40, "0b1010010101"),
        ("1 100 11111111", 24, "0b000000010000010011111111"),
        # As many digits as the frame has bits.
        ("10000000 110", 11, "0b10000000110"),
        # A leading zero is written, so none is omitted.
        ("1 0100 11111111", 24, "0b1010011111111"),
        ("FF FF F8 0 1", 24, "0xFF 0xFF 0xF8 0x00 0x01"),
        ("97CA FEC5", 48, "0x97CA 0xFEC5"),
        ("0F 42 4", 24, "0F 42 4"),
        ("0F 424", 24, "0F 424"),
        ("0F zz", 24, "0F zz"),
    ],
)
def test_a_prefix_shows_the_only_meaning(text: str, bits: int, prefixed: str) -> None:
    assert with_prefix(text, bits) == prefixed


@pytest.mark.parametrize(
    ("text", "padded"),
    [
        ("1 100 11111111", "01 04 FF"),
        ("00010000 00000010", "10 02"),
        ("FF FF F8 0 1", "FF FF F8 00 01"),
        # Each of these may be hex already.
        ("10 11", "10 11"),
        ("0101 0011", "0101 0011"),
        ("11111111", "11111111"),
        # A digit may be missing.
        ("0F 42 4", "0F 42 4"),
        ("1 2 3", "1 2 3"),
        ("1 11111111 111111111", "1 11111111 111111111"),
    ],
)
def test_bytes_without_their_leading_zeros(text: str, padded: str) -> None:
    assert " ".join(with_leading_zeros(text.split())) == padded


def test_a_number_with_a_few_bits_may_be_bytes() -> None:
    assert bits_of_bytes("11001000000000", 16, line_carries_bytes=True) == "11001000000000"
    assert bits_of_bytes("0b01", 16, line_carries_bytes=True) == ""
    assert bits_of_bytes("0b01", 16, line_carries_bytes=False) == "01"
    assert bits_of_bytes("0101", 16, line_carries_bytes=True) == ""
    assert bits_of_bytes("0" * 17, 16, line_carries_bytes=True) == ""


def test_a_number_that_is_too_large_has_both_meanings(capsys: Capture) -> None:
    """forum.arduino.cc/t/1165306: a program prints 24 bits of SSI from an int of 16 bits as an unsigned long."""
    assert main(["decode", "ssi:position=24", "4294945617"]) == 2
    assert "Write 0xFFFFAB51 if it is decimal, 0x4294945617 if it is hex" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("code", "text", "name", "number"),
    [
        # forum.arduino.cc/t/1376670: the sample code for the AMT21 prints "Invalid checksum. Given is: 11001000000000",
        # the bytes 00 32 as one number without its leading zeros. The last two of its bits are unused.
        ("AMT212C-V", "11001000000000", "position", 0x3200 >> 2),
        ("AMT212C-V", "0b11001000000000", "position", 0x3200 >> 2),
        # robotology/icub-firmware, pull request 420: the first bit of the two bytes of an MA730 is a dummy.
        ("MA730", "7F FE", "position", 0x7FFE),
        ("MA730", "7FFE", "position", 0x7FFE),
        # forum.arduino.cc/t/203305: Serial.println of the 18 bits of an AS5045. As hex, this is too much.
        ("AS5045", "262080", "position", 4095),
    ],
)
def test_published_notations(code: str, text: str, name: str, number: int, capsys: Capture) -> None:
    main(["decode", code, text, "--json"])
    fields = json.loads(capsys.readouterr().out)["fields"]
    assert next(field["raw"] for field in fields if field["name"] == name) == number
