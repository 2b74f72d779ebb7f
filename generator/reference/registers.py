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
from ..say import count_with_unit, frame_texts
from ..say.frame_texts import register_length_message
from . import codec
from .bits import with_bits


def decode_register(device: Device, variant: Variant, name: str, data: bytes) -> codec.DecodedFrame:
    """Decode a register from its bytes in ascending order of address. Its name is not case-sensitive.

    Raises:
        RegisterError: This interface does not have the register, or the register has a different length.
    """
    registers = {register.name: register for register in device.registers_over(variant.interface)}
    register_name = name.lower()
    if register_name not in registers:
        for erratum in device.errata:
            message = _unknown_register_message(device, erratum, register_name)
            if message:
                raise RegisterError(message)
        available = f"it has: {', '.join(registers)}" if registers else "it has none"
        raise RegisterError(f"{variant.code} has no register '{name}'; {available}")
    register = registers[register_name]
    if len(data) != register.length:
        needed_length = count_with_unit(register.length, "byte")
        actual_length = count_with_unit(len(data), "byte")
        raise RegisterError(register_length_message(register.name, needed_length, actual_length))
    placed_layout = register.layout.place(variant.parameters)
    return codec.decode(device, placed_layout, number_from_bytes(register.layout, data))


def _unknown_register_message(device: Device, erratum: Erratum, name: str) -> str:
    """Return an error message if an erratum says that an edition or overlay does not describe a register.

    Return an empty string if the erratum does not apply to this register, or not to this device.
    """
    # For such an erratum, ``printed`` lists the unknown registers, separated by commas.
    concerns_register = erratum.used == NOT_KNOWN and name in erratum.printed.split(", ")
    # The device of the latest edition also has errata about older editions.
    concerns_device = bool(erratum.overlay or device.edition)
    if not concerns_register or not concerns_device:
        return ""
    if erratum.edition:
        scope = f"in edition {device.edition} of the manual"
    else:
        scope = f"according to the overlay {erratum.overlay}"
    return f"'{name}' is unknown {scope}: {erratum.why} [{cite(erratum.source)}]"


#: The lowest and the highest value of an argument, each None if there is no such limit.
Limits = tuple["Expression | None", "Expression | None"]


def register_writes(
    device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]
) -> tuple[Write, ...]:
    """Return the writes of a procedure in order: one per byte, or one per register that is written at once.

    Written values can change the limits of later steps. A step that writes only one field keeps the other bits of the
    register: as the procedure has written them before, or as in the default of the register, which is 0 if the manual
    gives none.

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
        placed_layout = register.layout.place(variant.parameters)
        value = _value_of_step(step, arguments)
        if step.value is None:
            # A register can have several meanings with different limits.
            meaning_name = meaning_by_argument.get(step.value_name, "")
            limits = device.limits(register, meaning_name)
            field_name = _name_of_written_field(register, step)
            _check_argument(value, register, field_name, placed_layout, limits)
        if isinstance(step, ModifyStep):
            old_content = contents.get(step.register, register.default or 0)
            content = _with_field_changed(placed_layout, step.field, value, old_content)
        elif step.value is None:
            content = _content_for_argument(device, register, placed_layout, value)
        else:
            content = value
        contents[step.register] = content
        variant = after_write(device, variant, register, content)
        writes += _writes_of_register(register, content)
    return tuple(writes)


def _value_of_step(step: WriteStep | ModifyStep, arguments: Mapping[str, int]) -> int:
    """Return the number that a step writes: its fixed value, or the argument that it names.

    Raises:
        EncodeError: ``arguments`` does not contain the argument.
    """
    if step.value is not None:
        return step.value
    if step.value_name not in arguments:
        raise codec.EncodeError(f"the argument '{step.value_name}' is missing")
    return arguments[step.value_name]


def _name_of_written_field(register: Register, step: WriteStep | ModifyStep) -> str:
    """Return the name of the field that a step writes. For a whole register, it is the field with its limits."""
    return step.field if isinstance(step, ModifyStep) else name_with_limits(register)


def _writes_of_register(register: Register, content: int) -> list[Write]:
    """Return one write per byte, or a single write of the number if the register is written at once."""
    if register.is_accessed_whole:
        return [Write(register.address, content)]
    data = number_to_bytes(register.layout, content, 8 * register.length)
    return [Write(register.address + offset, byte) for offset, byte in enumerate(data)]


def _with_field_changed(placed_layout: PlacedLayout, field_name: str, field_value: int, old_content: int) -> int:
    """Return the content of a register after a value is written to one of its fields. The other bits are unchanged.

    Raises:
        EncodeError: The value does not fit, or this order code has no such field.
    """
    placed_field = placed_layout.find_field(field_name)
    if placed_field is None:
        raise codec.EncodeError(f"{field_value} does not fit '{field_name}'")
    is_too_wide = field_value & ~placed_field.mask != 0
    if is_too_wide:
        raise codec.EncodeError(f"{field_value} does not fit '{field_name}'")
    return with_bits(old_content, placed_field, field_value)


def _content_for_argument(device: Device, register: Register, placed_layout: PlacedLayout, argument: int) -> int:
    """Return the content of a register to which an argument is written.

    The argument is the value of the field or joined number to which the limits of the register apply. Without such a
    field, it is the content itself.

    Raises:
        EncodeError: The argument does not fit, or is not a valid content.
    """
    name = name_with_limits(register)
    names_of_numbers = {field.name for field in register.layout.fields if isinstance(field.kind, Number)}
    names_of_numbers |= {join.name for join in register.layout.joins}
    if name in names_of_numbers or register.limits_of == name:
        return codec.encode(device, placed_layout, {name: argument})
    # The argument is the number in the whole register.
    problems = codec.decode(device, placed_layout, argument).problems
    if problems:
        first_problem = problems[0]
        raise codec.EncodeError(f"{argument:#x} is not a value of '{register.name}': {first_problem.message}")
    return argument


def _check_argument(
    argument: int, register: Register, field_name: str, placed_layout: PlacedLayout, limits: Limits
) -> None:
    """Check that an argument is a named value of the field, if it has any, and that it is within the limits.

    The limits are checked if they belong to a meaning of the register, or if the register's own limits apply to this
    field.

    Raises:
        EncodeError: The argument is not valid.
    """
    allowed_values: list[int] = []
    for field in register.layout.fields:
        if field.name == field_name:
            allowed_values += [named_value.value for named_value in field.values]
    if allowed_values and argument not in allowed_values:
        raise codec.EncodeError(f"{argument} is not a value of '{field_name}'")
    lowest, highest = value_bounds(register, placed_layout, limits, placed_layout.parameters)
    # The limits of a meaning apply to the field or register to which the argument is written.
    has_limits_of_meaning = limits != (register.min, register.max)
    is_limited = has_limits_of_meaning or field_name == name_with_limits(register)
    if is_limited and not lowest <= argument <= highest:
        raise codec.EncodeError(frame_texts.outside_limits_message(f"{argument}", f"{lowest}", f"{highest}"))
