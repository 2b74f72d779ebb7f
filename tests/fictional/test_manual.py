"""The fictional encoder's manual against its spec. Numbers are typed, or computed without the project's code."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device
from codewheel.model.registers import numbers_that_fit
from codewheel.plan.crcs import crc_functions
from codewheel.reference import codec
from codewheel.reference.registers import register_writes

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "example"

#: Polynomials as printed in the manual, including the top bit.
POSITION, TEMPERATURE = 0x190D9, 0x25


def remainder(bits: str, polynomial: int, start: int) -> str:
    """Return the inverted remainder of a long division. A start value is added to the first bits."""
    divisor = [int(digit) for digit in f"{polynomial:b}"]
    width = len(divisor) - 1
    work = [int(digit) for digit in bits] + [0] * width
    for index, digit in enumerate(f"{start:0{width}b}"):
        work[index] ^= int(digit)
    for index in range(len(bits)):
        if work[index]:
            for step, bit in enumerate(divisor):
                work[index + step] ^= bit
    return "".join(str(1 - bit) for bit in work[-width:])


def test_the_division_is_right() -> None:
    # Published check values of CRC-16/XMODEM and CRC-16/IBM-3740 over "123456789". Both are not inverted.
    message = "".join(f"{byte:08b}" for byte in b"123456789")
    assert int(remainder(message, 0x11021, 0), 2) ^ 0xFFFF == 0x31C3
    assert int(remainder(message, 0x11021, 0xFFFF), 2) ^ 0xFFFF == 0x29B1


def test_the_manual_keeps_to_its_own_arithmetic() -> None:
    """Every number in the manual's examples, except for its two mistakes."""
    text = (EXAMPLE / "manual.md").read_text(encoding="utf-8")
    position = f"{1234:012b}{65432:017b}11{37:06b}"
    for piece in (f"{1234:012b}", f"{65432:017b}", f"{37:06b}", remainder(position, POSITION, 0x5A3C)):
        assert f"`{piece}`" in text
    assert f"`{235:016b} {remainder(f'{235:016b}', TEMPERATURE, 0)}`" in text
    assert "is 00EBh" in text
    # The first mistake: FF69h is -150 in one's complement. The CRC next to it belongs to FF6Ah.
    printed, meant = f"{0xFF69:016b}", f"{-150 & 0xFFFF:016b}"
    assert f"`{printed} {remainder(meant, TEMPERATURE, 0)}`" in text
    assert remainder(printed, TEMPERATURE, 0) != remainder(meant, TEMPERATURE, 0)
    # The second: two times for one wait.
    assert "wait at least 5 ms" in " ".join(text.split())
    assert "wait at least 50 ms" in text
    assert (-1000 & (1 << 25) - 1).to_bytes(4, "big").hex(" ").upper() == "01 FF FC 18"
    assert "`01 FF FC 18`" in text
    assert (1 << 31 | 4660).to_bytes(4, "big").hex(" ").upper() == "80 00 12 34"
    assert "`80 00 12 34`" in text
    assert (800).to_bytes(2, "little") == b"\x20\x03"
    assert (-300 & 0xFFFF).to_bytes(2, "little") == b"\xd4\xfe"
    assert "20h and 03h" in text
    assert "D4h and FEh" in text
    assert (950).to_bytes(2, "little").hex(" ").upper() == "B6 03"
    assert (-250 & 0xFFFF).to_bytes(2, "little").hex(" ").upper() == "06 FF"


def test_the_spec_is_clean(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(EXAMPLE)]) == 0
    assert capsys.readouterr().out.endswith("/tv62.second.yaml\nno problems in 1 family: tv62\n")


def test_it_is_no_part_of_the_library(devices: Mapping[str, Device]) -> None:
    assert "tv62" not in devices
    assert "tolvarn" not in {device.manufacturer.name for device in devices.values()}


def test_every_page_of_a_source_is_in_the_contents() -> None:
    text = (EXAMPLE / "manual.md").read_text(encoding="utf-8")
    pages = dict(re.findall(r"^\| ([0-9.]+) [^|]+\| ([0-9]+) \|$", text.partition("\n## ")[0], re.MULTILINE))
    assert len(pages) == 14
    spec = (EXAMPLE / "tolvarn" / "tv62.yaml").read_text(encoding="utf-8")
    source_texts = re.findall(r"\bsource: \"?([^\",}\n]+)", spec)
    cited = {piece.strip() for source_text in source_texts for piece in source_text.split(";")}
    assert len(cited) > 10
    for piece in cited:
        section, _, page = piece.partition(" p.")
        assert pages[section] == page, piece


def frame(device: Device, code: str, layout: str, bits: str) -> codec.DecodedFrame:
    return codec.decode(
        device, device.layout(layout).place(device.variant(code).parameters), int(bits.replace(" ", ""), 2)
    )


def test_what_the_language_carries_that_no_other_family_needs(device: Device) -> None:
    crc = device.crc("position_16")
    forms = {function.crc.name: function.method.value for function in crc_functions(device)}
    assert (crc.poly_with_top_bit, crc.init, forms["position_16"], forms["temperature_5"]) == (
        POSITION,
        0x5A3C,
        "table",
        "fold",
    )
    assert [(layout.name, layout.channel) for layout in device.interface("biss").layouts] == [
        ("position_data", 1),
        ("temperature_data", 2),
    ]
    word = device.layout("ssi_word").place(device.variant("TV62-M13-S1").parameters)
    assert word.bits == 32
    assert [(field.name, field.highest_bit, field.lowest_bit) for field in word.fields] == [
        ("alarm", 31, 31),
        ("position_padding", 30, 25),
        ("position", 24, 0),
    ]
    names = {(register.bank, register.address): register.name for register in device.registers}
    assert names[1, 0] == "preset"
    assert names[2, 0] == "upper_limit"
    assert names[1, 4] == "control"
    assert names[2, 4] == "correction"
    limit = device.register("lower_limit")
    assert limit.min is not None
    assert limit.min.constant == -400


def test_the_manuals_frames(device: Device) -> None:
    decoded = frame(device, "TV62-M13-S1", "ssi_word", f"{0x01FFFC18:032b}")
    assert decoded.values["position"] == -1000
    assert decoded.values["alarm"] is False
    assert not decoded.problems
    decoded = frame(device, "TV62-S17-S1", "ssi_word", f"{0x80001234:032b}")
    assert decoded.values["position"] == 4660
    assert decoded.values["alarm"] is True
    assert not decoded.problems
    decoded = frame(
        device, "TV62-M17-B1", "position_data", "010011010010 01111111110011000 1 1 100101 0100010110000111"
    )
    assert not decoded.problems
    assert (
        decoded.values["multiturn"],
        decoded.values["singleturn"],
        decoded.values["life_counter"],
    ) == (1234, 65432, 37)
    assert decoded.values["error"] is False
    assert decoded.values["warning"] is False
    assert frame(device, "TV62-M17-B1", "temperature_data", "0000000011101011 00101").values["temperature"] == 235
    disturbed = frame(device, "TV62-M17-B1", "temperature_data", "1111111101101001 10001")
    assert [problem.fault.value for problem in disturbed.problems] == ["crc"]
    assert frame(device, "TV62-M17-B1", "temperature_data", "1111111101101010 10001").values["temperature"] == -150


def test_zeros_before_a_negative_position_are_zeros(device: Device) -> None:
    extended = f"{-1000 & 0x7FFFFFFF:032b}"
    assert [problem.fault.value for problem in frame(device, "TV62-M13-S1", "ssi_word", extended).problems] == [
        "constant"
    ]


@pytest.mark.parametrize("code", ["TV62-S13-B1", "TV62-M17-B1", "TV62-M20-B1"])
def test_every_crc_by_division_on_paper(device: Device, code: str) -> None:
    """Return the CRC with a start value, for words that begin with zeros and with ones."""
    parameters = device.variant(code).parameters
    placed = device.layout("position_data").place(parameters)
    for fill in (0, 1):
        values = {
            "multiturn": fill * (2 ** parameters["multiturn_bits"] - 1),
            "singleturn": fill * (2 ** parameters["singleturn_bits"] - 1),
            "error": False,
            "warning": True,
            "life_counter": 1,
        }
        encoded = f"{codec.encode(device, placed, values):0{placed.bits}b}"
        assert encoded[-16:] == remainder(encoded[:-16], POSITION, 0x5A3C)


@pytest.mark.parametrize(("lower", "written"), [(-300, "D4 FE"), (-400, "70 FE"), (-1, "FF FF"), (1200, "B0 04")])
def test_arguments_below_zero(device: Device, lower: int, written: str) -> None:
    writes = register_writes(
        device,
        device.procedure("set_temperature_limits"),
        device.variant("TV62-M17-B1"),
        {"upper": 800, "lower": lower},
    )
    assert bytes(write.value for write in writes[3:5]).hex(" ").upper() == written


@pytest.mark.parametrize("lower", [-401, 1201])
def test_arguments_beyond_signed_limits(device: Device, lower: int) -> None:
    with pytest.raises(codec.EncodeError, match=f"{lower} is outside -400 to 1200"):
        register_writes(
            device,
            device.procedure("set_temperature_limits"),
            device.variant("TV62-M17-B1"),
            {"upper": 800, "lower": lower},
        )


def test_what_a_signed_register_without_limits_can_hold(device: Device) -> None:
    for name, expected in (
        ("correction", (-128, 127)),
        ("serial_number", (0, 0xFFFFFFFF)),
        ("lower_limit", (-32768, 32767)),
    ):
        register = device.register(name)
        assert numbers_that_fit(register, register.layout.place(device.variant("TV62-M17-B1").parameters)) == expected


def test_decode_names_another_channel(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["decode", "--specs", str(EXAMPLE), "TV62-M17-B1", "--json"]
    assert main([*arguments, "0b01001101001001111111110011000111001010100010110000111"]) == 0
    assert json.loads(capsys.readouterr().out)["layout"] == "position_data"
    assert main([*arguments, "--layout", "temperature_data", "0b000000001110101100101"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["layout"] == "temperature_data"
    assert data["fields"][0]["value"] == 235
    assert main([*arguments, "--layout", "temperature_data", "0b111111110110100110001"]) == 1
    assert [problem["kind"] for problem in json.loads(capsys.readouterr().out)["problems"]] == ["crc"]
    assert main([*arguments, "--layout", "nothing", "0b0"]) == 2
    assert (
        capsys.readouterr().err
        == "codewheel: TV62-M17-B1 has no layout 'nothing' from the encoder; it has: position_data, temperature_data\n"
    )


@pytest.mark.slow
def test_a_layout_of_bytes_can_be_named(capsys: pytest.CaptureFixture[str]) -> None:
    """If the frame identifies its layout, the layout with the given name is used instead, and determines the error."""
    assert main(["decode", "AMM5A23/65KJP1", "--layout", "multiturn_reply", "02 20 C7 D1 6A 5E", "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["layout"] == "multiturn_reply"
    assert "range" in [problem["kind"] for problem in data["problems"]]


def test_show_says_channel_and_bank(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "--specs", str(EXAMPLE), "TV62-M17-B1"]) == 0
    text = capsys.readouterr().out
    assert max(map(len, text.splitlines())) <= 80
    flat = " ".join(text.split())
    assert "data channel 2" in flat
    facts = "Byte order: low byte first, at 00h. Default: B6 03. Limits: -400 to 1,200. First select bank 2 with bank."
    assert facts in flat
