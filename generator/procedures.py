"""Procedures carried out on paper: the register writes that come out for one order code and given arguments."""

from __future__ import annotations

from collections.abc import Mapping

from . import codec
from .expressions import Expression
from .limits import bounded, bounds
from .model import Device, Procedure, Register, Step, Variant, Write


Limits = tuple["Expression | None", "Expression | None"]


def register_writes(device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]) -> tuple[Write, ...]:
    """Every byte that the procedure writes, in order.

    Raises:
        EncodeError: An argument is missing or does not fit its register.
    """
    writes: list[Write] = []
    # What a register holds before: its default, then what the procedure has written.
    held: dict[str, int] = {}
    for step in procedure.steps:
        if step.do == "write":
            register = device.register(step.register)
            argument = next((item for item in procedure.arguments if item.name == step.value_name), None)
            limits = device.limits(register, argument.meant_as if argument is not None else "")
            held[step.register] = _number(register, step, variant, arguments, device, limits, held.get(step.register, register.default or 0))
            data = codec.number_to_bytes(register.layout, held[step.register], 8 * register.length)
            writes += [Write(register.address + index, byte) for index, byte in enumerate(data)]
    return tuple(writes)


def _number(register: Register, step: Step, variant: Variant, arguments: Mapping[str, int], device: Device, limits: Limits, before: int) -> int:
    """What the step writes into the register, which held ``before``."""
    placed = register.layout.place(variant.parameters)
    if step.value is None and step.value_name not in arguments:
        raise codec.EncodeError(f"the argument '{step.value_name}' is missing")
    value = step.value if step.value is not None else arguments[step.value_name]
    if step.field:
        item = placed.field(step.field)
        if item is None or value & ~item.mask:
            raise codec.EncodeError(f"{value} does not fit '{step.field}'")
        return before & ~(item.mask << item.low) | value << item.low
    if step.value is not None:
        return value
    low, high = bounds(register, placed, limits, variant.parameters)
    if not low <= value <= high:
        raise codec.EncodeError(f"{value} is outside {low} to {high}")
    name = bounded(register)
    numbers = {field.name for field in register.layout.data_fields if field.kind == "number"}
    numbers |= {join.name for join in register.layout.joins}
    # A register of several fields without limits on one of them is given as its whole number.
    return codec.encode(device, placed, {name: value}) if name in numbers or register.limits_of == name else value
