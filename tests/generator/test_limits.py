"""Limits of register values, for direct writes and in procedures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.model.registers import value_bounds
from codewheel.order_codes.labels import find_code
from codewheel.order_codes.parameters import with_registers
from codewheel.reference.codec import EncodeError
from codewheel.reference.registers import register_writes

SPECS = Path(__file__).resolve().parents[1] / "c" / "specs"


def test_what_zero_stands_for_can_be_written() -> None:
    devices, _ = load_library([SPECS / "shapes.yaml"])
    register = devices[0].register("scale")
    variant = next(variant for variant in devices[0].variants if variant.interface == register.interface)
    placed = register.layout.place(variant.parameters)
    assert value_bounds(register, placed, (register.min, register.max), variant.parameters) == (1, 256)


def registers_after_resolution(device: Device, information: int, revolutions: int, position: int) -> dict[int, int]:
    """Return the registers after AM36's set_resolution, by address."""
    values = {
        "information_per_revolution": information,
        "number_of_revolutions": revolutions,
        "position": position,
    }
    variant = find_code(device, "AM3616/4096-I7").variant
    writes = register_writes(device, device.procedure("set_resolution"), variant, values)
    return {write.address: write.value for write in writes}


def test_what_a_step_writes_holds_for_the_limits_of_later_steps(devices: Mapping[str, Device]) -> None:
    """AM36 manual, 6.5 p.29: a preset is at most information per revolution times revolutions, less 1."""
    registers = registers_after_resolution(devices["am36"], 1024, 16, 16383)
    assert [registers[address] for address in range(0x50, 0x55)] == [0, 0, 0, 0x3F, 0xFF]
    for information, revolutions, position in ((1024, 16, 16384), (1, 1, 1), (2, 1, 2), (1 << 20, 1, 1 << 20)):
        with pytest.raises(EncodeError, match=f"outside 0 to {information * revolutions - 1}$"):
            registers_after_resolution(devices["am36"], information, revolutions, position)
    assert registers_after_resolution(devices["am36"], 1, 1, 0)[0x54] == 0
    # 16 bits hold 65,536 revolutions as 0, and the limit takes that into account.
    assert registers_after_resolution(devices["am36"], 1 << 20, 65536, (1 << 36) - 1)[0x50] == 0x0F


def test_a_preset_alone_keeps_to_what_the_registers_hold(devices: Mapping[str, Device]) -> None:
    device = devices["am36"]
    variant = find_code(device, "AM3616/4096-I7").variant
    procedure = device.procedure("set_preset")
    assert register_writes(device, procedure, variant, {"position": (1 << 36) - 1})
    # 4Bh to 4Dh: 1,024 positions per revolution. 4Eh and 4Fh: 16 revolutions.
    set_ = with_registers(device, variant, {0x4B: 0, 0x4C: 4, 0x4D: 0, 0x4E: 0, 0x4F: 16})
    assert register_writes(device, procedure, set_, {"position": 16383})
    with pytest.raises(EncodeError, match="16384 is outside 0 to 16383"):
        register_writes(device, procedure, set_, {"position": 16384})


@pytest.mark.parametrize("unused", [0x80, 0x10, 0x08, 0x02, 0x01])
def test_a_procedure_accepts_no_more_than_its_register(devices: Mapping[str, Device], unused: int) -> None:
    """AM36 manual, 6.5 p.25: bits 7, 4, 3, 1 and 0 of the configuration are not used and 0."""
    device = devices["am36"]
    variant = find_code(device, "AM3616/4096-I7").variant
    procedure = device.procedure("set_configuration")
    assert register_writes(device, procedure, variant, {"configuration": 0x64})[0].value == 0x64
    with pytest.raises(EncodeError, match=f"{unused:#x} is not a value of 'configuration'"):
        register_writes(device, procedure, variant, {"configuration": unused})
