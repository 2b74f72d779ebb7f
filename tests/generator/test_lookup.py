"""Lookups in the model: an error names what is missing, and only ``find_field`` returns None."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import pytest
from codewheel.model import Device, PlacedLayout, Register, first_or_raise, member_named


def placed(device: Device, code: str) -> PlacedLayout:
    variant = device.variant(code)
    return device.layout("single_cycle_data").place(variant.parameters)


def test_field_of_a_layout(amm5: Device) -> None:
    layout = amm5.layout("single_cycle_data")
    assert layout.field("multiturn").name == "multiturn"
    with pytest.raises(LookupError, match=re.escape("there is no field of 'single_cycle_data' called 'torque'")):
        layout.field("torque")


def test_field_that_an_order_code_lacks(amm5: Device) -> None:
    """A singleturn model, ``/1``, has no revolutions to send."""
    singleturn, multiturn = placed(amm5, "AMM5A17/1SC1"), placed(amm5, "AMM5A17/65KSC1")
    assert multiturn.field("multiturn").width == 16
    assert singleturn.find_field("multiturn") is None
    with pytest.raises(LookupError, match=re.escape("there is no field of 'single_cycle_data' called 'multiturn'")):
        singleturn.field("multiturn")
    assert [field.name for field in singleturn.find_fields(["multiturn", "singleturn"])] == ["singleturn"]


@pytest.mark.parametrize(
    ("look_up", "problem"),
    [
        (lambda device: device.interface("ethernet"), "there is no interface called 'ethernet'"),
        (lambda device: device.layout("torque"), "there is no layout called 'torque'"),
        (lambda device: device.register("torque"), "there is no register called 'torque'"),
        (lambda device: device.crc("torque"), "there is no CRC called 'torque'"),
        (lambda device: device.procedure("torque"), "there is no procedure called 'torque'"),
        (lambda device: device.variant("AMM6"), "there is no order code 'AMM6'"),
    ],
)
def test_parts_of_a_device(amm5: Device, look_up: Callable[[Device], object], problem: str) -> None:
    with pytest.raises(LookupError, match=f"^{re.escape(problem)}$"):
        look_up(amm5)


def test_values_of_a_field(amm5: Device) -> None:
    fields = [field for register in amm5.registers for field in register.layout.fields if field.values]
    field = fields[0]
    value = field.values[-1]
    assert field.value_named(value.name) is value
    assert field.value_of(value.value) is value
    with pytest.raises(LookupError, match=f"there is no value of '{field.name}' called 'torque'"):
        field.value_named("torque")
    with pytest.raises(LookupError, match=f"there is no value -1 of '{field.name}'"):
        field.value_of(-1)


def test_lookup_in_a_generator() -> None:
    """A ``StopIteration`` would end the generator silently or as a ``RuntimeError`` without the name."""

    def names() -> Iterator[Register]:
        registers: tuple[Register, ...] = ()
        yield member_named(registers, "torque", "register")

    with pytest.raises(LookupError, match=re.escape("there is no register called 'torque'")):
        list(names())
    with pytest.raises(LookupError, match="there is no value left"):
        first_or_raise((), "value left")
