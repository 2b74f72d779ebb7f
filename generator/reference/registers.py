"""Decode registers by name, and list the register writes of a procedure."""

from __future__ import annotations

from collections.abc import Mapping

from ..model import (
    NOT_KNOWN,
    Device,
    Erratum,
    ModifyStep,
    Number,
    PlacedLayout,
    Procedure,
    Register,
    Variant,
    Write,
    WriteStep,
    cite,
    number_from_bytes,
    number_to_bytes,
)
from ..model.expressions import Expression
from ..model.registers import bounded, bounds
from ..order_codes.parameters import RegisterError, after_write
from ..say import report
from ..say.plain_text import counted
from ..say.report import register_length
from . import codec


def decode_register(device: Device, variant: Variant, name: str, data: bytes) -> codec.Decoded:
    """Return the value of a register from its bytes in ascending order of address.

    Raises:
        RegisterError: This interface has no such register, or the register has a different length.
    """
    registers = {register.name: register for register in device.registers_over(variant.interface)}
    if name.lower() not in registers:
        for erratum in device.errata:
            problem = _not_known(device, erratum, name.lower())
            if problem:
                raise RegisterError(problem)
        available = f"it has: {', '.join(registers)}" if registers else "it has none"
        raise RegisterError(f"{variant.code} has no register '{name}'; {available}")
    register = registers[name.lower()]
    if len(data) != register.length:
        needed, actual = counted(register.length, "byte"), counted(len(data), "byte")
        raise RegisterError(register_length(register.name, needed, actual))
    placed = register.layout.place(variant.parameters)
    return codec.decode(device, placed, number_from_bytes(register.layout, data))


def _not_known(device: Device, erratum: Erratum, name: str) -> str:
    """Return the message that this edition or overlay does not define a register, or an empty string if it does."""
    if erratum.used != NOT_KNOWN or name not in erratum.printed.split(", "):
        return ""
    # The family of the spec also has errata about its editions, which do not apply to it.
    if not erratum.overlay and not device.edition:
        return ""
    if erratum.edition:
        scope = f"in edition {device.edition} of the manual"
    else:
        scope = f"according to the overlay {erratum.overlay}"
    return f"'{name}' is unknown {scope}: {erratum.why} [{cite(erratum.source)}]"


Limits = tuple["Expression | None", "Expression | None"]


def register_writes(
    device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]
) -> tuple[Write, ...]:
    """Return every byte that the procedure writes, in order, or the number if a register is written at once.

    The limits of later steps take the written values into account.

    Raises:
        EncodeError: An argument is missing or does not fit its register.
    """
    writes: list[Write] = []
    meanings = {argument.name: argument.meant_as for argument in procedure.arguments}
    # The current value of each register that the procedure has written.
    numbers: dict[str, int] = {}
    for step in procedure.steps:
        if not isinstance(step, (WriteStep, ModifyStep)):
            continue
        register = device.register(step.register)
        limits = device.limits(register, meanings.get(step.value_name, ""))
        old_number = numbers.get(step.register, register.default or 0)
        number = _number(register, step, variant, arguments, device, limits, old_number)
        numbers[step.register] = number
        variant = after_write(device, variant, register, number)
        if register.is_accessed_whole:
            writes.append(Write(register.address, number))
        else:
            data = number_to_bytes(register.layout, number, 8 * register.length)
            writes += [Write(register.address + index, byte) for index, byte in enumerate(data)]
    return tuple(writes)


def _number(
    register: Register,
    step: WriteStep | ModifyStep,
    variant: Variant,
    arguments: Mapping[str, int],
    device: Device,
    limits: Limits,
    old_number: int,
) -> int:
    """Return the value that the step writes to the register, which held ``old_number``."""
    placed = register.layout.place(variant.parameters)
    if step.value is None and step.value_name not in arguments:
        raise codec.EncodeError(f"the argument '{step.value_name}' is missing")
    value = step.value if step.value is not None else arguments[step.value_name]
    name = step.field if isinstance(step, ModifyStep) else bounded(register)
    if step.value is None:
        _check_argument(register, name, value, placed, limits)
    if isinstance(step, ModifyStep):
        placed_field = placed.find_field(step.field)
        if placed_field is None or value & ~placed_field.mask:
            raise codec.EncodeError(f"{value} does not fit '{step.field}'")
        return old_number & ~(placed_field.mask << placed_field.low) | value << placed_field.low
    if step.value is not None:
        return value
    numbers = {field.name for field in register.layout.fields if isinstance(field.kind, Number)}
    numbers |= {join.name for join in register.layout.joins}
    if name in numbers or register.limits_of == name:
        return codec.encode(device, placed, {name: value})
    # If a register has several fields and no limits on one of them, the argument is the number in the whole register.
    for problem in codec.decode(device, placed, value).problems:
        raise codec.EncodeError(f"{value:#x} is not a value of '{register.name}': {problem.message}")
    return value


def _check_argument(register: Register, name: str, value: int, placed: PlacedLayout, limits: Limits) -> None:
    """Check that an argument is a value of the field, and within the limits of the register."""
    fields = (field for field in register.layout.fields if field.name == name)
    allowed_values = [choice.value for field in fields for choice in field.values]
    if allowed_values and value not in allowed_values:
        raise codec.EncodeError(f"{value} is not a value of '{name}'")
    low, high = bounds(register, placed, limits, placed.parameters)
    # The limits of a meaning apply to the field or register to which the argument is written.
    has_meaning = limits != (register.min, register.max)
    if (has_meaning or name == bounded(register)) and not low <= value <= high:
        raise codec.EncodeError(report.outside(f"{value}", f"{low}", f"{high}"))
