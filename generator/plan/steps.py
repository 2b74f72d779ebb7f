"""Plans for procedures: the bytes that their steps access, the argument checks, and the values read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
    WaitStep,
    WriteStep,
    assert_never,
)
from ..model.record import dataclass
from .codec import layout_plan_of
from .frame_checks import allowed_values
from .frames import Reply
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
    """Write a register, or only one of its fields, which keeps the other bits as they were read.

    ``bit_slices`` are the affected bytes, or empty if the position of the field depends on the order code. In each, the
    bits ``mask << low_in_byte`` become ``(number >> low_in_number) & mask``. If an argument is written to the whole
    register, ``determines_limits`` are the parameters in it on which limits of later steps depend. ``locks_again`` is
    true if the write locks a register that an earlier step unlocked. It is made even if a step in between fails.
    """

    step: WriteStep | ModifyStep
    register: Register
    field: Field | None
    bit_slices: tuple[BitSlice, ...]
    value: ValueSource
    determines_limits: tuple[Parameter, ...] = ()
    locks_again: bool = False

    @property
    def calls(self) -> tuple[MasterCall, ...]:
        """Master operations that the write needs. It must read a byte first if it changes only some of its bits."""
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
    """Read back the register that ``write`` wrote, and stop the procedure if any of ``bit_slices`` differs."""

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
    """Wait for the time of the step."""

    step: WaitStep
    calls = (MasterCall.WAIT,)


@dataclass(frozen=True, slots=True)
class SendRequest:
    """Send a request one or more times. ``reply`` is the reply expected each time, or None if the spec has none."""

    step: SendStep
    reply: Reply | None = None

    @property
    def calls(self) -> tuple[MasterCall, ...]:
        """Master operations that it needs: SEND, and WAIT if the manual requires a pause between the requests."""
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
    writes: tuple[WriteRegister, ...]
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
        """Operations whose values the procedure returns to its caller."""
        return tuple(operation for operation in self.operations if isinstance(operation, ReadRegister))

    @cached_property
    def calls(self) -> tuple[MasterCall, ...]:
        """Operations that it needs from a master, without duplicates, in the order of ``MasterCall``."""
        needed_calls = {call for operation in self.operations for call in operation.calls}
        return tuple(call for call in MasterCall if call in needed_calls)


def bits_by_byte(register: Register, field: Field | None = None) -> tuple[BitSlice, ...]:
    """Return the bits of a field, or of a whole register, byte by byte in ascending order of address.

    If the register can only be accessed as a whole, bytes outside the field are included with the mask 0. The tuple is
    empty if the position of the field depends on the order code.
    """
    if field is not None:
        slices_by_byte = {bit_slice.byte: bit_slice for bit_slice in field.bit_slices}
        if slices_by_byte and register.is_accessed_whole:
            for byte in range(register.length):
                # The mask 0 selects no bit.
                slices_by_byte.setdefault(byte, BitSlice(byte, low_in_byte=0, mask=0, low_in_number=0))
        return tuple(slices_by_byte[byte] for byte in sorted(slices_by_byte))
    bit_slices = []
    for byte in range(register.length):
        bytes_below = byte if register.byte_order == "low_byte_first" else register.length - 1 - byte
        bit_slices.append(BitSlice(byte, low_in_byte=0, mask=0xFF, low_in_number=8 * bytes_below))
    return tuple(bit_slices)


def argument_of_source(value: ValueSource) -> Argument | None:
    """Return the argument that a write uses, or None if it writes a fixed number."""
    return None if isinstance(value, FixedNumber) else value.argument


def checked_argument(device: Device, argument: Argument, writes: Sequence[WriteRegister]) -> CheckedArgument:
    """Return an argument with the writes that use it, and the reasons to reject it before the first write."""
    writes_of_argument = tuple(write for write in writes if argument_of_source(write.value) is argument)
    refusals: list[ArgumentRefusal] = []
    for write in writes_of_argument:
        # An argument that is written to the same register twice is checked only once.
        new_refusals = _argument_refusals(device, write, argument)
        refusals += [refusal for refusal in new_refusals if refusal not in refusals]
    return CheckedArgument(argument=argument, writes=writes_of_argument, refusals=tuple(refusals))


def _argument_refusals(device: Device, write: WriteRegister, argument: Argument) -> Iterator[ArgumentRefusal]:
    """Yield the reasons to reject an argument: the limits and valid values of the register or field to be written."""
    match write.value:
        case AsMember():
            # The limits of the register are checked when the member is encoded.
            has_limits_of_meaning = bool(argument.meant_as)
            if has_limits_of_meaning:
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
    """Yield the reasons to reject an argument that is written to one field.

    They are the width of the field, the limits of the register or of a meaning if they apply to this field, and the
    list of valid values.
    """
    yield TooWide(field, field.width)
    has_limits_of_meaning = bool(argument.meant_as)
    has_limits_of_register = limited_member(register) == field.name
    if has_limits_of_meaning or has_limits_of_register:
        yield from _limit_refusals(device, register, argument)
    valid_values = allowed_values(register.layout, field)
    if valid_values:
        yield NotOneOf(field, valid_values)


def _limit_refusals(device: Device, register: Register, argument: Argument) -> Iterator[OutsideArgumentLimits]:
    """Yield the limits for an argument, if it has any: those of the register or of one of its meanings.

    ``meant_as`` is the name of the meaning that the argument has in the register, or empty.
    """
    meaning_by_name = {meaning.name: meaning for meaning in register.meanings}
    meaning = meaning_by_name.get(argument.meant_as)
    limits = limits_of(device, register, meaning)
    if limits.lowest is not None or limits.highest is not None:
        yield OutsideArgumentLimits(register, meaning, limits)
