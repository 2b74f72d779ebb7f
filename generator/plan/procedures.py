"""Procedures: an operation for each step, writes that are read back, and steps that lock a register again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from ..model import (
    Argument,
    BitSlice,
    Device,
    ModifyStep,
    Parameter,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    SendStep,
    Step,
    Unused,
    Value,
    WaitStep,
    WriteStep,
    assert_never,
    member_named,
)
from .frames import reply_to
from .limits import limited_member
from .steps import (
    AsMember,
    AsNumber,
    FixedNumber,
    InField,
    PlannedStep,
    PollRegister,
    ProcedurePlan,
    ReadRegister,
    SendRequest,
    ValueSource,
    VerifyWrite,
    WaitTime,
    WriteRegister,
    argument_of_source,
    bits_by_byte,
    checked_argument,
)


def plan_procedure(device: Device, procedure: Procedure) -> ProcedurePlan:
    """Return the plan of a procedure: an operation for each step, and one for each write that is read back.

    The plan also contains the checks of the arguments, which are made before the first operation.
    """
    # A procedure may unlock a register, write it, and lock it again. That last write gets ``locks_again=True``.
    indices_that_lock_again = _indices_of_steps_that_lock_again(device, procedure.steps)
    operations: list[PlannedStep] = []
    for index, step in enumerate(procedure.steps):
        operation = _operation_of_step(device, procedure, step)
        if index in indices_that_lock_again and isinstance(operation, WriteRegister):
            operation = replace(operation, locks_again=True)
        operations.append(operation)
    operations_with_limits = _note_changed_limits(device, operations)
    verified_operations = tuple(_add_verification(operations_with_limits))
    writes = [operation for operation in verified_operations if isinstance(operation, WriteRegister)]
    checked_arguments = [checked_argument(device, argument, writes) for argument in procedure.arguments]
    changes_frames = any(_changes_frames(device, write) for write in writes)
    return ProcedurePlan(
        procedure=procedure,
        operations=verified_operations,
        arguments=tuple(checked_arguments),
        changes_frames=changes_frames,
    )


def _changes_frames(device: Device, write: WriteRegister) -> bool:
    """Return whether a write changes a parameter on which frames depend, such as the resolution."""
    for parameter in device.run_time_parameters:
        writes_field = write.field is None or parameter.field == write.field.name
        if parameter.register == write.register.name and writes_field:
            return True
    return False


def _note_changed_limits(device: Device, operations: Sequence[PlannedStep]) -> Iterator[PlannedStep]:
    """Yield the operations. Writes that change limits of later writes list the parameters that they change.

    These are writes of an argument to a whole register, such as the resolution, that contains a parameter in the limits
    of another register, such as the preset. The parameters become ``determines_limits`` of the write.
    """
    for index, operation in enumerate(operations):
        if isinstance(operation, WriteRegister) and _writes_argument_to_whole_register(operation):
            later_operations = operations[index + 1 :]
            limiting_parameters = tuple(_limiting_parameters(device, operation.register, later_operations))
            yield replace(operation, determines_limits=limiting_parameters)
        else:
            yield operation


def _writes_argument_to_whole_register(write: WriteRegister) -> bool:
    """Return whether a write fills a whole register with an argument of the procedure."""
    return write.field is None and argument_of_source(write.value) is not None


def _limiting_parameters(
    device: Device, register: Register, later_operations: Sequence[PlannedStep]
) -> Iterator[Parameter]:
    """Yield the parameters in a register on which the limits of later writes depend."""
    limiting_names: set[str] = set()
    for operation in later_operations:
        if isinstance(operation, WriteRegister):
            argument = argument_of_source(operation.value)
            # A register can have several meanings with different limits.
            meaning_name = argument.meant_as if argument is not None else ""
            for limit in device.limits(operation.register, meaning_name):
                if limit is not None:
                    limiting_names.update(limit.parameters)
    for parameter in device.run_time_parameters:
        if parameter.register == register.name and parameter.name in limiting_names:
            yield parameter


def _add_verification(operations: Iterable[PlannedStep]) -> Iterator[PlannedStep]:
    """Yield the operations, with a ``VerifyWrite`` for each write that can be read back before it takes effect.

    The manuals have no such step, but a corrupted BiSS write can be echoed as if it had been stored. Written values
    take effect with a later write to a register that cannot be read, such as a command register, or with one that
    locks a register again. They are read back just before it, or before the same register is written again. A write
    that no such write follows is not read back.
    """
    unverified_writes: list[WriteRegister] = []
    for operation in operations:
        if not isinstance(operation, WriteRegister):
            yield operation
            continue
        overwrites_earlier = any(_writes_same_bits(operation, earlier_write) for earlier_write in unverified_writes)
        if overwrites_earlier or _makes_writes_effective(operation):
            for earlier_write in unverified_writes:
                bit_slices = tuple(_slices_to_verify(earlier_write))
                yield VerifyWrite(earlier_write, bit_slices)
            unverified_writes.clear()
        yield operation
        if _can_be_read_back(operation):
            unverified_writes.append(operation)


def _makes_writes_effective(write: WriteRegister) -> bool:
    """Return whether the encoder may use earlier written values after this write.

    This is a write to a register that cannot be read, such as a command register, or one that locks a register again.
    """
    return write.locks_again or not write.register.readable


def _writes_same_bits(write: WriteRegister, earlier_write: WriteRegister) -> bool:
    """Return whether two writes change the same bits: the same field, or a register and one of its fields."""
    has_same_register = write.register is earlier_write.register
    writes_whole_register = write.field is None or earlier_write.field is None
    return has_same_register and (writes_whole_register or write.field is earlier_write.field)


def _can_be_read_back(write: WriteRegister) -> bool:
    """Return whether a written value can be compared with the value that is read back.

    The register must be readable and keep the value, and its reserved bits, which are not compared, must have the same
    positions for every order code. Writes that lock a register again are not read back.
    """
    register = write.register
    unused_fields = [field for field in register.layout.fields if isinstance(field.kind, Unused)]
    has_fixed_unused_bits = all(field.is_fixed for field in unused_fields)
    keeps_value = register.readable and not register.clears_itself
    return keeps_value and not write.locks_again and has_fixed_unused_bits


def _slices_to_verify(write: WriteRegister) -> Iterator[BitSlice]:
    """Yield the written bits of each byte without its reserved bits, which can have any value when they are read.

    Bytes without any other bits are omitted, unless the register can only be accessed as a whole.
    """
    for bit_slice in write.bit_slices:
        unused_in_slice = _unused_bits(write.register, bit_slice.byte) >> bit_slice.low_in_byte
        compared_mask = bit_slice.mask & ~unused_in_slice
        if compared_mask or write.register.is_accessed_whole:
            yield replace(bit_slice, mask=compared_mask)


def _unused_bits(register: Register, byte_index: int) -> int:
    """Return the mask of the reserved bits in one byte of a register."""
    unused_fields = [field for field in register.layout.fields if isinstance(field.kind, Unused)]
    unused_mask = sum(field.mask_in_place for field in unused_fields)
    return register.bytes_of(unused_mask)[byte_index]


def _operation_of_step(device: Device, procedure: Procedure, step: Step) -> PlannedStep:
    """Return the operation that executes one step of a procedure, with the register, the field, and their bytes."""
    match step:
        case WaitStep():
            return WaitTime(step)
        case SendStep():
            reply = reply_to(device, procedure.interface, step.data_id)
            return SendRequest(step, reply)
        case PollStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            return PollRegister(step, register, field, bit_slices=bits_by_byte(register, field))
        case ReadStep():
            register = device.register(step.register)
            read_field = register.layout.field(step.field) if step.field else None
            return ReadRegister(step, register, read_field, bit_slices=bits_by_byte(register, read_field))
        case ModifyStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            argument = _argument_of_step(procedure, step)
            value = InField(argument, field) if argument is not None else FixedNumber(step.value or 0)
            return WriteRegister(step, register, field, bit_slices=bits_by_byte(register, field), value=value)
        case WriteStep():
            register = device.register(step.register)
            argument = _argument_of_step(procedure, step)
            source = _written_value(register, step, argument)
            return WriteRegister(step, register, field=None, bit_slices=bits_by_byte(register), value=source)
        case _:
            assert_never(step)


def _argument_of_step(procedure: Procedure, step: WriteStep | ModifyStep) -> Argument | None:
    """Return the argument that a step writes, or None if it writes a fixed value."""
    if step.value is not None:
        return None
    return member_named(procedure.arguments, step.value_name, f"argument of '{procedure.name}'")


def _written_value(register: Register, step: WriteStep, argument: Argument | None) -> ValueSource:
    """Return the source of the number that a step writes to a whole register.

    Without an argument, it is the fixed number of the step. An argument is the value of the field or joined number to
    which the limits of the register apply or, without one, the number in the whole register.
    """
    if argument is None:
        return FixedNumber(step.value or 0)
    member = limited_member(register)
    return AsMember(argument, member) if member else AsNumber(argument)


def _indices_of_steps_that_lock_again(device: Device, steps: Sequence[Step]) -> frozenset[int]:
    """Return the indices of the steps that lock a register again after an earlier step of the procedure unlocked it.

    Some registers accept writes only while another register, ``opened_by``, contains a certain number. An opening step
    writes this number. The next step that writes a different number to the same register locks it again. Steps that
    write an argument of the procedure do neither.
    """
    written_names = {step.register for step in steps if isinstance(step, WriteStep | ModifyStep)}
    used_registers = [register for register in device.registers if register.name in written_names]
    locked_registers = [register for register in used_registers if register.opened_by]
    # Names of the registers that contain the number that unlocks another register.
    names_of_open_registers: set[str] = set()
    indices_that_lock_again: set[int] = set()
    for index, step in enumerate(steps):
        # Without a fixed value, a step writes an argument.
        if not isinstance(step, WriteStep | ModifyStep) or step.value is None:
            continue
        controlled_registers = [register for register in locked_registers if _controls_access(step, register)]
        opening_numbers = [_opening_number(device, register) for register in controlled_registers]
        is_opening = step.value in opening_numbers
        if is_opening:
            names_of_open_registers.add(step.register)
        elif controlled_registers and step.register in names_of_open_registers:
            names_of_open_registers.discard(step.register)
            indices_that_lock_again.add(index)
    return frozenset(indices_that_lock_again)


def _controls_access(step: WriteStep | ModifyStep, locked_register: Register) -> bool:
    """Return whether the step writes to the register or field that opens and closes the locked register."""
    if step.register != locked_register.opened_by:
        return False
    # A WriteStep writes the whole register, and with it the field.
    return isinstance(step, WriteStep) or step.field == locked_register.opened_by_field


def _opening_number(device: Device, locked_register: Register) -> int:
    """Return the number that must be written to the register ``opened_by`` so that the locked register can be written.

    The locked register gives the name of this value, and ``opening_register`` gives its number.
    """
    opening_register = device.register(locked_register.opened_by)
    named_values: list[Value] = []
    for field in opening_register.layout.fields:
        # If no field is named, any field of the opening register can open the locked register.
        if locked_register.opened_by_field in ("", field.name):
            named_values += field.values
    value_name = locked_register.opened_by_value
    return member_named(named_values, value_name, f"value of '{opening_register.name}'").value
