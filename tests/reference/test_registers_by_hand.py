"""Registers of the reference, computed by hand: writes of procedures, identity, editions, and verdicts of frames."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device, Verdict
from codewheel.order_codes.labels import find_code
from codewheel.order_codes.parameters import RegisterError
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.reference.registers import (
    compare_identifying_registers,
    decode_register,
    edition_by_registers,
    identifying_addresses,
    register_writes,
    values_of_older_edition,
    without_edition_registers,
)
from codewheel.virtual.encoder import VirtualEncoder

SPECS = Path(__file__).resolve().parents[1] / "plan" / "specs"
AMM5 = "AMM5A21/65KSC1"


@pytest.fixture(scope="module")
def small() -> Device:
    devices, report = load_library([SPECS])
    assert not report.problems
    return devices[0]


# -- procedures


def writes_of(device: Device, procedure: str, code: str, arguments: Mapping[str, int]) -> list[tuple[int, int]]:
    writes = register_writes(device, device.procedure(procedure), device.variant(code), arguments)
    return [(write.address, write.value) for write in writes]


def test_bytes_that_a_procedure_writes(small: Device) -> None:
    """The level is 8Ah by default, which is fast already."""
    assert writes_of(small, "set_preset", "S16", {"position": 0x1234}) == [
        (0x48, 0x5A),
        (0x50, 0x12),
        (0x51, 0x34),
        (0x52, 0x8A),
        (0x54, 1),
        (0x48, 0),
    ]


@pytest.mark.parametrize(("zeros", "level"), [(1, 0b1_000_001_0), (5, 0b1_000_101_0), (2, 0b1_000_010_0)])
def test_a_field_is_written_between_the_others(small: Device, zeros: int, level: int) -> None:
    assert writes_of(small, "set_level", "S12", {"zeros": zeros}) == [(0x52, level)]


@pytest.mark.parametrize(
    ("procedure", "arguments", "message"),
    [
        ("set_preset", {"position": 4096}, "4096 is outside 0 to 4095"),
        ("set_preset", {"position": -1}, "-1 is outside 0 to 4095"),
        ("set_preset", {}, "the argument 'position' is missing"),
        ("set_level", {"zeros": 8}, "8 does not fit 'zeros'"),
    ],
)
def test_arguments_that_do_not_fit(small: Device, procedure: str, arguments: dict[str, int], message: str) -> None:
    with pytest.raises(codec.EncodeError) as refusal:
        writes_of(small, procedure, "S12", arguments)
    assert str(refusal.value) == message


def test_the_highest_preset_is_written(small: Device) -> None:
    assert writes_of(small, "set_preset", "S12", {"position": 4095})[1:3] == [(0x50, 0x0F), (0x51, 0xFF)]


# -- values of registers


@pytest.mark.parametrize(
    ("register", "data", "value"),
    [
        ("steps", "00", 256),
        ("steps", "FF", 255),
        ("offset", "80", -128),
        ("offset", "7F", 127),
        ("preset", "0102", 258),
    ],
)
def test_values_of_registers(small: Device, register: str, data: str, value: int) -> None:
    decoded = decode_register(small, small.variant("S16"), register, bytes.fromhex(data))
    assert decoded.values[register] == value
    assert decoded.problems == ()


@pytest.mark.parametrize(("register", "data"), [("preset", "01"), ("preset", "010203"), ("other", "01")])
def test_registers_that_cannot_be_decoded(small: Device, register: str, data: str) -> None:
    with pytest.raises(RegisterError):
        decode_register(small, small.variant("S16"), register, bytes.fromhex(data))


# -- identity and editions, with the registers of the AMM5 manual, 6.4 p.38 and p.39


def bytes_from(first_address: int, data: str) -> dict[int, int]:
    return dict(enumerate(bytes.fromhex(data), first_address))


def test_registers_of_an_order_code(devices: Mapping[str, Device]) -> None:
    """AMM5 in 78h to 7Bh, its release in 7Ch and 7Dh, which the manual does not state, and Li in 7Eh and 7Fh."""
    device, variant = devices["amm5"], find_code(devices["amm5"], AMM5).variant
    right = bytes_from(0x78, "414D4D351234") | bytes_from(0x7E, "4C69")
    assert compare_identifying_registers(device, variant, right) == ()
    assert compare_identifying_registers(device, variant, {}) == ()
    (difference,) = compare_identifying_registers(device, variant, right | {0x7B: 0x36})
    assert difference.field == "device_id.name"
    assert (difference.actual, difference.documented, difference.is_register) == (0x414D4D36, 0x414D4D35, True)
    (part,) = compare_identifying_registers(device, variant, {0x7B: 0x36})
    assert f"the given part is ......36h, {variant.code} has ......35h" in part.message
    (first_part,) = compare_identifying_registers(device, variant, {0x78: 0x40, 0x79: 0x4D})
    assert f"the given part is 404D....h, {variant.code} has 414D....h" in first_part.message
    addresses = identifying_addresses(device, variant)
    assert {0x77, 0x80}.isdisjoint(addresses)
    assert set(range(0x78, 0x80)) <= addresses


def serial_number(year: int, week: int, number: int) -> dict[int, int]:
    """Return the bytes of 44h to 47h: the decimal digits yy ww nnnnn as one number."""
    return bytes_from(0x44, f"{year * 10**7 + week * 10**5 + number:08X}")


@pytest.mark.parametrize(("week", "is_current"), [(0, False), (1, True), (30, True), (53, True), (54, False)])
def test_edition_of_a_serial_number(devices: Mapping[str, Device], week: int, is_current: bool) -> None:
    """Since revision 1.7 the digits after the year are a week, and no year has a week 0 or 54."""
    device = devices["amm5"]
    match = find_code(device, AMM5)
    edition = edition_by_registers(device, match, serial_number(18, week, 3630))
    assert (edition == device.manual.revision) == is_current
    assert is_current or float(edition) < 1.7
    decoded = decode_register(device, match.variant, "serial_number", bytes(serial_number(18, week, 3630).values()))
    differences = list(values_of_older_edition(device, decoded))
    assert len(differences) == (not is_current)
    assert all(difference.is_register for difference in differences)


def test_a_part_of_a_serial_number_does_not_show_the_edition(devices: Mapping[str, Device]) -> None:
    device = devices["amm5"]
    whole = serial_number(18, 30, 3630)
    assert bytes(whole.values()).hex().upper() == "0AE869EE"
    for missing_address in whole:
        part = {address: value for address, value in whole.items() if address != missing_address}
        with pytest.raises(ValueError, match="to infer the edition, give all of serial_number"):
            edition_by_registers(device, find_code(device, AMM5), part)
    assert without_edition_registers(device, whole | {0x43: 1, 0x48: 2}) == {0x43: 1, 0x48: 2}


# -- verdicts

VERDICTS = [
    (False, False, Verdict.USABLE, []),
    (False, True, Verdict.USABLE_WITH_WARNING, ["warning"]),
    (True, False, Verdict.NOT_USABLE, ["error"]),
    (True, True, Verdict.NOT_USABLE, ["error", "warning"]),
]


@pytest.mark.parametrize(("error", "warning", "verdict", "reports"), VERDICTS)
def test_verdict_on_a_position(small: Device, error: bool, warning: bool, verdict: Verdict, reports: list[str]) -> None:
    variant = small.variant("S12")
    placed = small.layout("word").place(variant.parameters)
    frame = codec.encode(small, placed, {"position": 5, "error": error, "warning": warning})
    # Both flags are active low, and the CRC has 6 bits.
    assert frame >> 6 == 5 << 2 | (not error) << 1 | (not warning)
    result = findings(small, variant, codec.decode(small, placed, frame))
    assert (result.verdict, [report.field for report in result.reports]) == (verdict, reports)
    assert findings(small, variant, codec.decode(small, placed, frame ^ 1)).verdict is None


def test_a_frame_without_flags_has_no_verdict(small: Device) -> None:
    variant = small.variant("S12")
    placed = small.layout("padded_word").place(variant.parameters)
    frame = codec.encode(small, placed, {"position": 5})
    assert findings(small, variant, codec.decode(small, placed, frame)).verdict is Verdict.UNKNOWN


# -- registers of a virtual encoder


class Clock:
    """Time that a test sets."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def virtual_encoder(clock: Clock) -> VirtualEncoder:
    return VirtualEncoder("S16", 5, specs=[SPECS], clock=clock)


def test_a_preset_is_open_while_the_key_is_in_its_register() -> None:
    memory = virtual_encoder(Clock()).memory
    assert not memory.write(0x50, 0x12)
    for key, is_open in ((0x5B, False), (0x5A, True), (0, False)):
        assert memory.write(0x48, key)
        assert memory.write(0x50, 0x12) == is_open
        assert memory.writable(0x50) == is_open
    assert (memory.writable(0x53), memory.readable(0x53)) == (False, True)
    assert (memory.writable(0x54), memory.readable(0x54)) == (True, False)
    assert (memory.readable(0x4F), memory.readable(0x5A)) == (False, False)


def test_a_number_above_its_limit_becomes_the_default() -> None:
    memory = virtual_encoder(Clock()).memory
    for value, kept in ((99, 99), (100, 7), (0, 0), (255, 7)):
        assert memory.write(0x58, value)
        assert memory.read(0x58) == kept


def test_only_saved_values_survive_without_supply() -> None:
    """The limited number is volatile until a command saves it. The steps are not volatile."""
    clock = Clock()
    encoder = virtual_encoder(clock)
    memory = encoder.memory
    for address, value in ((0x58, 50), (0x55, 9)):
        assert memory.write(address, value)
    encoder.restart()
    assert (memory.read(0x58), memory.read(0x55)) == (7, 9)
    memory.write(0x58, 50)
    clock.now = 1
    assert memory.write(0x54, 2)
    memory.write(0x58, 60)
    encoder.restart()
    assert memory.read(0x58) == 50
    clock.now = 2
    assert memory.write(0x54, 3)
    encoder.restart()
    assert (memory.read(0x58), memory.read(0x55)) == (7, 9)


@pytest.mark.parametrize(("after_s", "is_executed"), [(0.009, False), (0.0101, True)])
def test_a_command_within_the_wait_of_another_is_not_executed(after_s: float, is_executed: bool) -> None:
    """The manual of the made-up encoder demands 10 ms."""
    clock = Clock()
    encoder = virtual_encoder(clock)
    clock.now = 1
    encoder.memory.write(0x54, 1)
    encoder.memory.write(0x58, 50)
    clock.now = 1 + after_s
    encoder.memory.write(0x54, 2)
    assert encoder.memory.too_early == (not is_executed)
    encoder.memory.write(0x58, 60)
    encoder.restart()
    assert encoder.memory.read(0x58) == (50 if is_executed else 7)
