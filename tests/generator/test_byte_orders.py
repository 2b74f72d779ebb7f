"""Fields whose byte order is not that of their frame, in five engines, against a decoder that is written here.

The frames of MODBUS are public examples. The CRCs of the random frames are computed here.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from runpy import run_path

import pytest
from codewheel.commands.cli import main
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.model import number_from_bytes, number_to_bytes
from codewheel.reference import codec
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line
from five_engines import ENGINES, NOT_USABLE, SPECS, USABLE, Case, Import, MadeEncoder, load_made, named

pytestmark = pytest.mark.slow


def modbus_crc(data: bytes) -> bytes:
    """Return the CRC of MODBUS, low byte first."""
    rest = 0xFFFF
    for byte in data:
        rest ^= byte
        for _ in range(8):
            rest = rest >> 1 ^ (0xA001 if rest & 1 else 0)
    return bytes([rest & 0xFF, rest >> 8])


def other_crc(data: bytes) -> bytes:
    register = 0x1D0F
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            highest_bit = register & 0x8000
            register = register << 1 & 0xFFFF
            if highest_bit:
                register ^= 0x1021
    return register.to_bytes(2, "big")


def case_of(code: str, data: bytes, fault: str, error: bool, values: dict[str, int | bool]) -> Case:
    common = (code, "reply", 8 * len(data), int.from_bytes(data, "little"))
    if fault:
        return Case(*common, fault)
    return Case(*common, "", NOT_USABLE if error else USABLE, named(error=error), {**values, "error": error})


def modbus_replies() -> Iterator[Case]:
    random_ = random.Random(61)
    for _ in range(3000):
        address = random_.randrange(256)
        position, serial = random_.getrandbits(32), random_.getrandbits(48)
        speed = random_.randrange(-(1 << 15), 1 << 15)
        state = random_.choice((0x0102, 0x0201, 0x0102, 0x0201, 0x0302))
        mark = random_.choice((0x123456, 0x123456, 0x123456, 0x563412))
        error = random_.random() < 0.3
        data = bytes([address, 3, 18]) + position.to_bytes(4, "big") + speed.to_bytes(2, "little", signed=True)
        data += state.to_bytes(2, "little") + mark.to_bytes(3, "little") + bytes([error])
        data += serial.to_bytes(6, "little")
        crc = modbus_crc(data)
        sent_crc = crc if random_.random() < 0.8 else random_.choice((crc[::-1], random_.randbytes(2)))
        fault = "range" if state == 0x0302 else ""
        fault = "constant" if mark == 0x563412 else fault
        fault = "crc" if sent_crc != crc else fault
        names = {"address": address, "position": position, "speed": speed, "serial": serial}
        yield case_of("MBR", data + sent_crc, fault, error, names)


def other_replies() -> Iterator[Case]:
    random_ = random.Random(62)
    for code, turns_bits in (("BO8", 8), ("BO10", 10)):
        for _ in range(1500):
            position = random_.getrandbits(24)
            temperature = random_.randrange(-(1 << 15), 1 << 15)
            error = random_.random() < 0.3
            data = position.to_bytes(3, "little") + temperature.to_bytes(2, "big", signed=True) + bytes([not error])
            crc = other_crc(data)
            sent_crc = crc if random_.random() < 0.8 else random_.choice((crc[::-1], random_.randbytes(2)))
            singleturn_bits = 24 - turns_bits
            names = {"position": position, "turns": position >> singleturn_bits, "temperature": temperature}
            yield case_of(code, data + sent_crc, "crc" if sent_crc != crc else "", error, names)


MADE = {
    "modbus": ("address", "position", "speed", "state", "error", "serial", "unused"),
    "byte_orders": ("singleturn", "turns", "temperature", "error", "position", "unused"),
}
FRAMES: dict[str, Callable[[], Iterator[Case]]] = {"modbus": modbus_replies, "byte_orders": other_replies}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", FRAMES)
def test_every_engine_agrees(name: str, engine: str, import_generated: Import, tmp_path: Path) -> None:
    """Every frame that is accepted is encoded again, too. C also returns members that the other engines name here."""
    made = MadeEncoder(load_made(name), {"reply": MADE[name]})
    cases = list(FRAMES[name]())
    assert {case.fault for case in cases} >= {"", "crc"}
    results = [without_other_members(case) for case in ENGINES[engine](made, cases, import_generated, tmp_path)]
    expected = [without_other_members(case) for case in cases]
    differing = [
        (result, expected_case)
        for result, expected_case in zip(results, expected, strict=True)
        if result != expected_case
    ]
    assert differing[:3] == []


def without_other_members(case: Case) -> Case:
    """Return a case without the members that only C returns: named values and the rest of the position."""
    if case.values is None:
        return case
    values = {name: value for name, value in case.values.items() if name not in ("state", "singleturn", "unused")}
    return Case(case.code, case.layout, case.bits, case.number, case.fault, case.verdict, case.reports, values)


def test_public_frames_of_modbus_are_encoded_and_decoded() -> None:
    device = load_made("modbus")
    variant = device.variant("MBR")
    frames = {example.layout: example for example in device.examples}
    assert set(frames) == {"request", "read_three", "three_registers"}
    for example in device.examples:
        layout = device.layout(example.layout).place(variant.parameters)
        decoded = codec.decode_placed(device, layout, example.bytes)
        assert not decoded.problems
        number = codec.encode(device, layout, example.values)
        assert number == number_from_bytes(layout.layout, example.bytes)
        assert number_to_bytes(layout.layout, number, layout.bits) == example.bytes
        assert example.bytes[-2:] == modbus_crc(example.bytes[:-2])


OWN_ORDER = "{name: speed, bits: 16, signed: true, byte_order: low_byte_first}"


def write_specs(folder: Path, speed: str, in_second_reading: str = "") -> Path:
    """Write the spec of MODBUS with this text for the field ``speed``, and with another one in its second reading."""
    folder.mkdir()
    (folder / "manufacturer.yaml").write_bytes((SPECS / "manufacturer.yaml").read_bytes())
    text = (SPECS / "modbus.yaml").read_text(encoding="utf-8")
    (folder / "modbus.yaml").write_text(text.replace(OWN_ORDER, speed), encoding="utf-8")
    if in_second_reading:
        facts, _, _ = text.replace(OWN_ORDER, in_second_reading).partition("examples:")
        evidence = next(line for line in facts.splitlines() if line.startswith("evidence:"))
        second = facts.replace(f"{evidence}\n", "")
        (folder / "modbus.second.yaml").write_text(second, encoding="utf-8")
    return folder


def test_diff_reports_the_byte_order_of_a_field(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = write_specs(tmp_path / "before", OWN_ORDER)
    after = write_specs(tmp_path / "after", OWN_ORDER.replace(", byte_order: low_byte_first", ""))
    assert main(["diff", str(before), str(after)]) == 1
    out = " ".join(capsys.readouterr().out.split())
    assert "reply: field speed: byte order low byte first → none MBR; C, Python, XML [field-reads-otherwise]" in out


def test_a_second_reading_with_another_byte_order_disagrees(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A reading that lists the bytes of the field and joins them agrees with the byte order."""
    joined_bytes = "{name: speed_low, bits: 8}\n          - {name: speed_high, bits: 8}"
    without_order = OWN_ORDER.replace(", byte_order: low_byte_first", "")
    for name, speed, exit_code in (("same", OWN_ORDER, 0), ("other", without_order, 1)):
        folder = write_specs(tmp_path / name, OWN_ORDER, in_second_reading=speed)
        assert main(["check", str(folder)]) == exit_code
        assert ("bits 7:0 of a signed number here, bits 15:8 of a signed number in" in capsys.readouterr().out) is (
            exit_code == 1
        )
    unsigned = OWN_ORDER.replace(", signed: true", "")
    folder = write_specs(tmp_path / "bytes", unsigned, in_second_reading=joined_bytes)
    second = folder / "modbus.second.yaml"
    text = second.read_text(encoding="utf-8")
    end = text.index("      - name: three_registers")
    second.write_text(text[:end] + "        join: {speed: [speed_high, speed_low]}\n" + text[end:], encoding="utf-8")
    main(["check", str(folder)])
    assert "bits 15:8 of a number" not in capsys.readouterr().out


def test_the_example_script_reads_it_from_the_xml(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "modbus.xml").write_text(to_xml(device_dump(load_made("modbus"))), encoding="utf-8")
    script = SPECS.parents[1] / "docs" / "example" / "decode_from_xml.py"
    arguments = [str(tmp_path / "modbus.xml"), "MBR", "three_registers", "11 03 06 AE 41 56 52 43 40 49 AD"]
    monkeypatch.setattr(sys, "argv", [str(script), *arguments])
    run_path(str(script))
    assert {f"first {0xAE41}", f"crc {0xAD49}"} <= set(capsys.readouterr().out.splitlines())


def test_the_virtual_encoder_answers_a_public_request() -> None:
    """The reply repeats the address, and its CRC is sent low byte first."""
    specs = [SPECS / "modbus.yaml", SPECS / "manufacturer.yaml"]
    line = Rs485Line(VirtualEncoder("MBR", 6120, specs=specs))
    line.receive(bytes.fromhex("01 03 00 00 00 0A CD C5"))
    assert line.send() == b""
    line = Rs485Line(VirtualEncoder("MBR", 6120, specs=specs))
    line.receive(bytes.fromhex("01 03 00 00 00 0A C5 CD"))
    reply = line.send()
    assert reply[:7] == bytes.fromhex("01 03 12 00 00 17 E8")
    assert reply[-2:] == modbus_crc(reply[:-2])
