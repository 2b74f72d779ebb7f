"""Plans for procedures: the bytes that their steps access, the argument checks, and the values read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from enum import Enum
from functools import cached_property

from ..model import (
    Argument,
    BitSlice,
    Device,
    Field,
    ModifyStep,
    Parameter,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    RegisterMeaning,
    SendStep,
    Step,
    Unused,
    WaitStep,
    WriteStep,
    assert_never,
    member_named,
)
from ..model.record import dataclass
from .closing_steps import closing_steps
from .codec import allowed_values, layout_plan_of
from .frames import Reply, reply_to
from .limits import NotOneOf, NumberLimits, TooWide, limited_member, limits_of


class MasterCall(Enum):
    """Operation that a master must support."""

    READ = "read"
    WRITE = "write"
    WAIT = "wait"
    SEND = "send"


# -- values that a step writes


@dataclass(frozen=True, slots=True)
class FixedNumber:
    """The same number every time."""

    number: int


@dataclass(frozen=True, slots=True)
class InField:
    """The argument, in the bits of one field."""

    argument: Argument
    field: Field


@dataclass(frozen=True, slots=True)
class AsNumber:
    """The argument, as the number in the whole register."""

    argument: Argument


@dataclass(frozen=True, slots=True)
class AsMember:
    """The argument as the field or join ``member``, from which the register is encoded."""

    argument: Argument
    member: str


ValueSource = FixedNumber | InField | AsNumber | AsMember


# -- operations


@dataclass(frozen=True, slots=True)
class WriteRegister:
    """Write a register, or one of its fields while keeping the others as read.

    ``bit_slices`` are the affected bytes, or empty if the position of the field depends on the order code. In each, the
    bits ``mask << low_in_byte`` become ``(number >> low_in_number) & mask``. If an argument is written to the whole
    register, ``determines_limits`` are the run-time parameters in it on which limits of later steps depend. They use
    the written value. ``closes`` is true if the write undoes an earlier opening step, even if a step in between fails.
    """

    step: WriteStep | ModifyStep
    register: Register
    field: Field | None
    bit_slices: tuple[BitSlice, ...]
    value: ValueSource
    determines_limits: tuple[Parameter, ...] = ()
    closes: bool = False

    @property
    def calls(self) -> tuple[MasterCall, ...]:
        writes_whole_bytes = all(bit_slice.mask == 0xFF for bit_slice in self.bit_slices)
        return (MasterCall.WRITE,) if writes_whole_bytes else (MasterCall.READ, MasterCall.WRITE)


@dataclass(frozen=True, slots=True)
class ReadRegister:
    """Read a register, or the bytes of one of its fields."""

    step: ReadStep
    register: Register
    field: Field | None
    bit_slices: tuple[BitSlice, ...]
    calls = (MasterCall.READ,)


@dataclass(frozen=True, slots=True)
class PollRegister:
    """Read a register until the field is ``step.value``."""

    step: PollStep
    register: Register
    field: Field
    bit_slices: tuple[BitSlice, ...]
    calls = (MasterCall.READ, MasterCall.WAIT)


@dataclass(frozen=True, slots=True)
class VerifyWrite:
    """Read back what ``write`` wrote, and stop if any of ``bit_slices`` differs."""

    write: WriteRegister
    bit_slices: tuple[BitSlice, ...]
    calls = (MasterCall.READ,)

    @property
    def register(self) -> Register:
        return self.write.register

    @property
    def field(self) -> Field | None:
        return self.write.field

    @property
    def step(self) -> WriteStep | ModifyStep:
        """The step that wrote the value. The manual contains no step for this operation."""
        return self.write.step


@dataclass(frozen=True, slots=True)
class WaitTime:
    """Wait."""

    step: WaitStep
    calls = (MasterCall.WAIT,)


@dataclass(frozen=True, slots=True)
class SendRequest:
    """Send a request one or more times. ``reply`` is the reply expected each time, or None if the spec has none."""

    step: SendStep
    reply: Reply | None = None

    @property
    def calls(self) -> tuple[MasterCall, ...]:
        return (MasterCall.WAIT, MasterCall.SEND) if self.step.microseconds else (MasterCall.SEND,)


PlannedStep = WriteRegister | ReadRegister | PollRegister | VerifyWrite | WaitTime | SendRequest


# -- argument checks


@dataclass(frozen=True, slots=True)
class OutsideArgumentLimits:
    """The argument is outside the limits of the register or, if it has several meanings, of one ``meaning``."""

    register: Register
    meaning: RegisterMeaning | None
    limits: NumberLimits


@dataclass(frozen=True, slots=True)
class Undecodable:
    """The register decoder rejects the argument, for example because a bit that must be 0 is set."""

    register: Register


ArgumentRefusal = OutsideArgumentLimits | TooWide | NotOneOf | Undecodable


@dataclass(frozen=True, slots=True)
class CheckedArgument:
    """An argument, the operations that write it, and the reasons for which it is rejected before any write.

    Values that do not fit are also rejected when the register is encoded.
    """

    argument: Argument
    written: tuple[WriteRegister, ...]
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True)
class ProcedurePlan:
    """Plan of a procedure. ``changes_frames`` is true if it writes a parameter on which frames depend."""

    procedure: Procedure
    operations: tuple[PlannedStep, ...]
    arguments: tuple[CheckedArgument, ...]
    changes_frames: bool

    @cached_property
    def reads(self) -> tuple[ReadRegister, ...]:
        return tuple(operation for operation in self.operations if isinstance(operation, ReadRegister))

    @cached_property
    def calls(self) -> tuple[MasterCall, ...]:
        """Operations that it needs from a master, without duplicates, in the order of ``MasterCall``."""
        needed_calls = {call for operation in self.operations for call in operation.calls}
        return tuple(call for call in MasterCall if call in needed_calls)


def run_of(device: Device, procedure: Procedure) -> ProcedurePlan:
    """Return the plan of a procedure: an operation for each step, and one for each write that is read back."""
    closing_indices = closing_steps(device, procedure.steps)
    operations: list[PlannedStep] = []
    for index, step in enumerate(procedure.steps):
        operation = _operation_of_step(device, procedure, step)
        if index in closing_indices and isinstance(operation, WriteRegister):
            operation = replace(operation, closes=True)
        operations.append(operation)
    operations = list(_with_verification(_with_taught_parameters(device, operations)))
    writes = [operation for operation in operations if isinstance(operation, WriteRegister)]
    return ProcedurePlan(
        procedure=procedure,
        operations=tuple(operations),
        arguments=tuple(_checked_argument(device, argument, writes) for argument in procedure.arguments),
        changes_frames=any(_changes_frames(device, write) for write in writes),
    )


def _changes_frames(device: Device, write: WriteRegister) -> bool:
    """Return whether a write changes a parameter that a register holds at run time and on which frames depend."""
    for parameter in device.run_time_parameters:
        writes_field = write.field is None or parameter.field == write.field.name
        if parameter.register == write.register.name and writes_field:
            return True
    return False


def _with_taught_parameters(device: Device, operations: Sequence[PlannedStep]) -> Iterator[PlannedStep]:
    """Yield the operations. Writes of an argument to a whole register get ``determines_limits``."""
    for index, operation in enumerate(operations):
        if (
            isinstance(operation, WriteRegister)
            and operation.field is None
            and not isinstance(operation.value, FixedNumber)
        ):
            taught_parameters = tuple(_taught_parameters(device, operation, operations[index + 1 :]))
            yield replace(operation, determines_limits=taught_parameters)
        else:
            yield operation


def _taught_parameters(
    device: Device, write: WriteRegister, later_operations: Sequence[PlannedStep]
) -> Iterator[Parameter]:
    """Yield the parameters in a written register on which the limits of later writes depend."""
    limiting_names: set[str] = set()
    for operation in later_operations:
        if isinstance(operation, WriteRegister):
            argument = _argument_of_source(operation.value)
            for limit in device.limits(operation.register, argument.meant_as if argument is not None else ""):
                limiting_names.update(limit.parameters if limit is not None else ())
    for parameter in device.run_time_parameters:
        if parameter.register == write.register.name and parameter.name in limiting_names:
            yield parameter


def _with_verification(operations: Iterable[PlannedStep]) -> Iterator[PlannedStep]:
    """Yield the operations, with a ``VerifyWrite`` for each write that can be read back before it takes effect.

    The manuals have no such step. On BiSS, however, a disturbed write can be echoed as if it had been stored. A written
    value takes effect when the procedure writes to a register that cannot be read, such as a command register, makes a
    closing write, or writes to the same place again. A write that no such write follows is not read back.
    """
    pending: list[VerifyWrite] = []
    for operation in operations:
        if isinstance(operation, WriteRegister):
            overwrites_pending = any(_writes_same_place(operation, verification.write) for verification in pending)
            if _makes_writes_effective(operation) or overwrites_pending:
                yield from pending
                pending.clear()
        yield operation
        if isinstance(operation, WriteRegister) and _can_be_read_back(operation):
            pending.append(VerifyWrite(operation, tuple(_meaningful_pieces(operation))))


def _makes_writes_effective(write: WriteRegister) -> bool:
    """Return whether a write lets the encoder use what was written before, such as a write to a command register."""
    return write.closes or not write.register.readable


def _writes_same_place(write: WriteRegister, earlier_write: WriteRegister) -> bool:
    """Return whether two writes change the same bits: the same field, or a register and one of its fields."""
    has_same_register = write.register is earlier_write.register
    writes_whole_register = write.field is None or earlier_write.field is None
    return has_same_register and (writes_whole_register or write.field is earlier_write.field)


def _can_be_read_back(write: WriteRegister) -> bool:
    """Return whether a write can be verified: it does not close, and the register keeps it, in fixed places."""
    register = write.register
    unused_fields = [field for field in register.layout.fields if isinstance(field.kind, Unused)]
    has_fixed_unused_bits = all(field.is_fixed for field in unused_fields)
    keeps_value = register.readable and not register.clears_itself
    return keeps_value and not write.closes and has_fixed_unused_bits


def _meaningful_pieces(write: WriteRegister) -> Iterator[BitSlice]:
    """Yield the slices without reserved bits, which can be anything when read. A whole access includes all bytes."""
    for bit_slice in write.bit_slices:
        unused_in_piece = _unused_bits(write.register, bit_slice.byte) >> bit_slice.low_in_byte
        meaningful_mask = bit_slice.mask & ~unused_in_piece
        if meaningful_mask or write.register.is_accessed_whole:
            yield replace(bit_slice, mask=meaningful_mask)


def _unused_bits(register: Register, byte_index: int) -> int:
    """Return the bits in a byte of the register that have no meaning in the manual."""
    unused_fields = [field for field in register.layout.fields if isinstance(field.kind, Unused)]
    unused_mask = sum(field.mask_in_place for field in unused_fields)
    return register.bytes_of(unused_mask)[byte_index]


def _operation_of_step(device: Device, procedure: Procedure, step: Step) -> PlannedStep:
    """Return the operation of a step in the manual, with its register, its field and their bytes."""
    match step:
        case WaitStep():
            return WaitTime(step)
        case SendStep():
            return SendRequest(step, reply_to(device, procedure.interface, step.data_id))
        case PollStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            return PollRegister(step, register, field, pieces_of(register, field))
        case ReadStep():
            register = device.register(step.register)
            read_field = register.layout.field(step.field) if step.field else None
            return ReadRegister(step, register, read_field, pieces_of(register, read_field))
        case ModifyStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            argument = _argument_of_step(procedure, step)
            value = InField(argument, field) if argument is not None else FixedNumber(step.value or 0)
            return WriteRegister(step, register, field, pieces_of(register, field), value)
        case WriteStep():
            register = device.register(step.register)
            source = _written_value(register, step, _argument_of_step(procedure, step))
            return WriteRegister(step=step, register=register, field=None, bit_slices=pieces_of(register), value=source)
        case _:
            assert_never(step)


def pieces_of(register: Register, field: Field | None = None) -> tuple[BitSlice, ...]:
    """Return the bytes of a field, or of a whole register, in ascending order of address.

    If a register is accessed whole, its bytes outside the field have the mask 0.
    """
    if field is not None:
        pieces_by_byte = {bit_slice.byte: bit_slice for bit_slice in field.bit_slices}
        if pieces_by_byte and register.is_accessed_whole:
            for byte in range(register.length):
                pieces_by_byte.setdefault(byte, BitSlice(byte, low_in_byte=0, mask=0, low_in_number=0))
        return tuple(pieces_by_byte[byte] for byte in sorted(pieces_by_byte))
    bit_slices = []
    for byte in range(register.length):
        bytes_below = byte if register.byte_order == "low_byte_first" else register.length - 1 - byte
        bit_slices.append(BitSlice(byte, low_in_byte=0, mask=0xFF, low_in_number=8 * bytes_below))
    return tuple(bit_slices)


def _argument_of_step(procedure: Procedure, step: WriteStep | ModifyStep) -> Argument | None:
    """Return the argument that a step writes, or None if it writes a fixed value."""
    if step.value is not None:
        return None
    return member_named(procedure.arguments, step.value_name, f"argument of '{procedure.name}'")


def _written_value(register: Register, step: WriteStep, argument: Argument | None) -> ValueSource:
    if argument is None:
        return FixedNumber(step.value or 0)
    member = limited_member(register)
    return AsMember(argument, member) if member else AsNumber(argument)


def _argument_of_source(value: ValueSource) -> Argument | None:
    return None if isinstance(value, FixedNumber) else value.argument


def _checked_argument(device: Device, argument: Argument, writes: Sequence[WriteRegister]) -> CheckedArgument:
    """Return an argument with the writes that use it, and the reasons to reject it, without duplicates."""
    writes_of_argument = tuple(write for write in writes if _argument_of_source(write.value) is argument)
    refusals: list[ArgumentRefusal] = []
    for write in writes_of_argument:
        # An argument that is written to the same register twice is checked only once.
        new_refusals = _argument_refusals(device, write, argument)
        refusals += [refusal for refusal in new_refusals if refusal not in refusals]
    return CheckedArgument(argument=argument, written=writes_of_argument, refusals=tuple(refusals))


def _argument_refusals(device: Device, write: WriteRegister, argument: Argument) -> Iterator[ArgumentRefusal]:
    """Yield the reasons to reject an argument before the write."""
    match write.value:
        case AsMember():
            # The limits of the register are checked when the member is encoded.
            if argument.meant_as:
                yield from _limit_refusals(device, write.register, argument)
        case AsNumber():
            yield from _limit_refusals(device, write.register, argument)
            if layout_plan_of(device, write.register.layout).checks:
                yield Undecodable(write.register)
        case InField(field=field):
            yield from field_refusals(device, write.register, field, argument)
        case FixedNumber():
            return
        case _:
            assert_never(write.value)


def field_refusals(
    device: Device, register: Register, field: Field, argument: Argument
) -> Iterator[TooWide | OutsideArgumentLimits | NotOneOf]:
    """Yield the reasons to reject an argument for one field: its width, the limits if they apply to it, its values."""
    yield TooWide(field, field.width)
    if argument.meant_as or limited_member(register) == field.name:
        yield from _limit_refusals(device, register, argument)
    valid_values = allowed_values(register.layout, field)
    if valid_values:
        yield NotOneOf(field, valid_values)


def _limit_refusals(device: Device, register: Register, argument: Argument) -> Iterator[OutsideArgumentLimits]:
    """Yield the limits of the register or, if the argument has one of its meanings, the limits of the meaning."""
    meanings = {meaning.name: meaning for meaning in register.meanings}
    meaning = meanings.get(argument.meant_as)
    limits = limits_of(device, register, meaning)
    if limits.low is not None or limits.high is not None:
        yield OutsideArgumentLimits(register, meaning, limits)
