"""Procedures carried out on paper: the register writes that come out for one order code and one argument."""

from __future__ import annotations

from . import codec
from .model import Device, Procedure, Register, Step, Variant, Write


def register_writes(device: Device, procedure: Procedure, variant: Variant, argument: int) -> tuple[Write, ...]:
    """Every byte that the procedure writes, in order.

    Raises:
        EncodeError: The argument does not fit its register.
    """
    writes: list[Write] = []
    for step in procedure.steps:
        if step.do == "write":
            writes += _step_writes(device.register(step.register), step, variant, argument, device)
    return tuple(writes)


def _step_writes(register: Register, step: Step, variant: Variant, argument: int, device: Device) -> list[Write]:
    number = step.value
    if number is None:
        placed = register.layout.place(variant.parameters)
        low = register.min.value(variant.parameters) if register.min is not None else 0
        high = register.max.value(variant.parameters) if register.max is not None else argument
        if not low <= argument <= high:
            raise codec.EncodeError(f"{argument} is outside {low} to {high}")
        number = codec.encode(device, placed, {register.limits_of: argument})
    data = codec.number_to_bytes(register.layout, number, 8 * register.length)
    return [Write(register.address + index, byte) for index, byte in enumerate(data)]
