"""Procedures carried out on paper: the register writes that come out for one order code and given arguments."""

from __future__ import annotations

from collections.abc import Mapping

from . import codec
from .model import Device, Procedure, Register, Step, Variant, Write


def register_writes(device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]) -> tuple[Write, ...]:
    """Every byte that the procedure writes, in order.

    Raises:
        EncodeError: An argument is missing or does not fit its register.
    """
    writes: list[Write] = []
    for step in procedure.steps:
        if step.do == "write":
            writes += _step_writes(device.register(step.register), step, variant, arguments, device)
    return tuple(writes)


def _step_writes(register: Register, step: Step, variant: Variant, arguments: Mapping[str, int], device: Device) -> list[Write]:
    number = step.value
    if number is None:
        if step.value_name not in arguments:
            raise codec.EncodeError(f"the argument '{step.value_name}' is missing")
        argument = arguments[step.value_name]
        placed = register.layout.place(variant.parameters)
        low = register.min.value(variant.parameters) if register.min is not None else 0
        high = register.max.value(variant.parameters) if register.max is not None else argument
        if not low <= argument <= high:
            raise codec.EncodeError(f"{argument} is outside {low} to {high}")
        number = codec.encode(device, placed, {register.limits_of: argument})
    data = codec.number_to_bytes(register.layout, number, 8 * register.length)
    return [Write(register.address + index, byte) for index, byte in enumerate(data)]
