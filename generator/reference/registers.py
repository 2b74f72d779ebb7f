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
from ..model.registers import name_with_limits, value_bounds
from ..order_codes.parameters import RegisterError, after_write
from ..say import report
from ..say.plain_text import count_with_unit
from ..say.report import register_length
from . import codec


def decode_register(device: Device, variant: Variant, name: str, data: bytes) -> codec.DecodedFrame:
    """Decode a register from its bytes in ascending order of address. Capitals in ``name`` do not matter.

    Raises:
        RegisterError: This interface does not have the register, or the register has a different length.
    """
    registers = {register.name: register for register in device.registers_over(variant.interface)}
    if name.lower() not in registers:
        for erratum in device.errata:
            message = _unknown_register_message(device, erratum, name.lower())
            if message:
                raise RegisterError(message)
        available = f"it has: {', '.join(registers)}" if registers else "it has none"
        raise RegisterError(f"{variant.code} has no register '{name}'; {available}")
    register = registers[name.lower()]
    if len(data) != register.length:
        needed = count_with_unit(register.length, "byte")
        actual = count_with_unit(len(data), "byte")
        raise RegisterError(register_length(register.name, needed, actual))
    placed = register.layout.place(variant.parameters)
    return codec.decode(device, placed, number_from_bytes(register.layout, data))


def _unknown_register_message(device: Device, erratum: Erratum, name: str) -> str:
    """Return the message if an erratum says that this edition or overlay lacks a register, or else an empty string."""
    # ``printed`` lists the registers that are not known, separated by commas.
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


#: Lowest and highest value of an argument, or None without a limit.
Limits = tuple["Expression | None", "Expression | None"]


def register_writes(
    device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]
) -> tuple[Write, ...]:
    """Return every byte that the procedure writes, in order, or the number if a register is written at once.

    The limits of later steps take the written values into account. A step that writes one field keeps the others as
    the procedure has written them, or as in the default of the register, or else 0.

    Raises:
        EncodeError: An argument is missing, does not fit its register or field, or is not a valid content.
    """
    writes: list[Write] = []
    meaning_by_argument = {argument.name: argument.meant_as for argument in procedure.arguments}
    # The current content of each register that the procedure has written.
    contents: dict[str, int] = {}
    for step in procedure.steps:
        if not isinstance(step, (WriteStep, ModifyStep)):
            continue
        register = device.register(step.register)
        placed = register.layout.place(variant.parameters)
        value = _value_of_step(step, arguments)
        if step.value is None:
            # The limits may depend on how the procedure means the argument.
            limits = device.limits(register, meaning_by_argument.get(step.value_name, ""))
            _check_argument(register, _name_of_written_field(register, step), value, placed, limits)
        if isinstance(step, ModifyStep):
            old_content = contents.get(step.register, register.default or 0)
            content = _with_field_changed(placed, step.field, value, old_content)
        elif step.value is None:
            content = _content_for_argument(device, register, placed, value)
        else:
            content = value
        contents[step.register] = content
        variant = after_write(device, variant, register, content)
        writes += _writes_of_register(register, content)
    return tuple(writes)


def _value_of_step(step: WriteStep | ModifyStep, arguments: Mapping[str, int]) -> int:
    """Return the fixed value of a step, or the argument that it names, which must be in ``arguments``."""
    if step.value is not None:
        return step.value
    if step.value_name not in arguments:
        raise codec.EncodeError(f"the argument '{step.value_name}' is missing")
    return arguments[step.value_name]


def _name_of_written_field(register: Register, step: WriteStep | ModifyStep) -> str:
    return step.field if isinstance(step, ModifyStep) else name_with_limits(register)


def _writes_of_register(register: Register, content: int) -> list[Write]:
    """Return one write per byte, or a single write of the number if the register is written at once."""
    if register.is_accessed_whole:
        return [Write(register.address, content)]
    data = number_to_bytes(register.layout, content, 8 * register.length)
    return [Write(register.address + offset, byte) for offset, byte in enumerate(data)]


def _with_field_changed(placed: PlacedLayout, field_name: str, field_value: int, old_content: int) -> int:
    """Return the content of a register with ``field_value`` in one of its fields, and the other bits as they were.

    Raises:
        EncodeError: The value does not fit, or this order code has no such field.
    """
    placed_field = placed.find_field(field_name)
    # Bits outside the mask mean that the value is too wide for the field.
    if placed_field is None or field_value & ~placed_field.mask:
        raise codec.EncodeError(f"{field_value} does not fit '{field_name}'")
    other_bits = old_content & ~(placed_field.mask << placed_field.low)
    return other_bits | (field_value << placed_field.low)


def _content_for_argument(device: Device, register: Register, placed: PlacedLayout, argument: int) -> int:
    """Return the content of a register to which an argument is written: as its limited number, or as the whole content.

    Raises:
        EncodeError: The argument does not fit, or is not a valid content.
    """
    name = name_with_limits(register)
    names_of_numbers = {field.name for field in register.layout.fields if isinstance(field.kind, Number)}
    names_of_numbers |= {join.name for join in register.layout.joins}
    if name in names_of_numbers or register.limits_of == name:
        return codec.encode(device, placed, {name: argument})
    # If a register has several fields and no limits on one of them, the argument is the number in the whole register.
    problems = codec.decode(device, placed, argument).problems
    if problems:
        raise codec.EncodeError(f"{argument:#x} is not a value of '{register.name}': {problems[0].message}")
    return argument


def _check_argument(register: Register, field_name: str, argument: int, placed: PlacedLayout, limits: Limits) -> None:
    """Check that an argument is a value of the field ``field_name``, and within the limits if they apply to this field.

    Raises:
        EncodeError: The argument is not valid.
    """
    fields = (field for field in register.layout.fields if field.name == field_name)
    allowed_values = [choice.value for field in fields for choice in field.values]
    if allowed_values and argument not in allowed_values:
        raise codec.EncodeError(f"{argument} is not a value of '{field_name}'")
    lowest, highest = value_bounds(register, placed, limits, placed.parameters)
    # The limits of a meaning apply to the field or register to which the argument is written.
    has_limits_of_meaning = limits != (register.min, register.max)
    is_limited = has_limits_of_meaning or field_name == name_with_limits(register)
    if is_limited and not lowest <= argument <= highest:
        raise codec.EncodeError(report.outside(f"{argument}", f"{lowest}", f"{highest}"))
