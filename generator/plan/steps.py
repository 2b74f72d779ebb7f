"""Plans for procedures: the bytes that their steps access, the argument checks, and the values read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from enum import Enum
from functools import cached_property

from ..model import (
    Argument,
    Device,
    Field,
    ModifyStep,
    Parameter,
    Piece,
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
)
from ..model.record import dataclass
from .closing_steps import closing_steps
from .codec import allowed_values, codec_of
from .limits import Limits, limited_member, limits_of
from .refusals import NotOneOf, TooWide
from .replies import Reply, reply_to


class Call(Enum):
    """Operation that a master must support."""

    READ = "read"
    WRITE = "write"
    WAIT = "wait"
    SEND = "send"


# -- values that a step writes


@dataclass(frozen=True, slots=True)
class Stated:
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


Source = Stated | InField | AsNumber | AsMember


# -- operations


@dataclass(frozen=True, slots=True)
class Writes:
    """Write a register, or one of its fields while keeping the others as read.

    ``pieces`` are the affected bytes: bits ``mask << right`` of the byte become ``(number >> left) & mask``. They are
    empty if the position of the field depends on the order code. ``teaches`` are the run-time parameters in the
    register on which limits of later steps depend. Those steps use the written value. ``closes`` is true if the write
    undoes an earlier opening step. It is then also done if a step between the two fails.
    """

    step: WriteStep | ModifyStep
    register: Register
    field: Field | None
    pieces: tuple[Piece, ...]
    value: Source
    teaches: tuple[Parameter, ...] = ()
    closes: bool = False

    @property
    def calls(self) -> tuple[Call, ...]:
        return (Call.READ, Call.WRITE) if any(item.mask != 0xFF for item in self.pieces) else (Call.WRITE,)


@dataclass(frozen=True, slots=True)
class Reads:
    """Read a register, or the bytes of one of its fields."""

    step: ReadStep
    register: Register
    field: Field | None
    pieces: tuple[Piece, ...]
    calls = (Call.READ,)


@dataclass(frozen=True, slots=True)
class Polls:
    """Read a register until the field is ``step.value``."""

    step: PollStep
    register: Register
    field: Field
    pieces: tuple[Piece, ...]
    calls = (Call.READ, Call.WAIT)


@dataclass(frozen=True, slots=True)
class Verifies:
    """Read back what ``write`` wrote, and stop if any of ``pieces`` differs."""

    write: Writes
    pieces: tuple[Piece, ...]
    calls = (Call.READ,)

    @property
    def register(self) -> Register:
        return self.write.register

    @property
    def field(self) -> Field | None:
        return self.write.field

    @property
    def step(self) -> WriteStep | ModifyStep:
        """The step that wrote the value. The manual has no step for this operation."""
        return self.write.step


@dataclass(frozen=True, slots=True)
class Waits:
    """Wait."""

    step: WaitStep
    calls = (Call.WAIT,)


@dataclass(frozen=True, slots=True)
class Sends:
    """Send a request one or more times. ``reply`` is the reply expected each time, or None if the spec has none."""

    step: SendStep
    reply: Reply | None = None

    @property
    def calls(self) -> tuple[Call, ...]:
        return (Call.WAIT, Call.SEND) if self.step.microseconds else (Call.SEND,)


Operation = Writes | Reads | Polls | Verifies | Waits | Sends


# -- argument checks


@dataclass(frozen=True, slots=True)
class Beyond:
    """The argument is outside its limits: those of the register or, if it has several meanings, of one ``meaning``."""

    register: Register
    meaning: RegisterMeaning | None
    limits: Limits


@dataclass(frozen=True, slots=True)
class Undecodable:
    """The register decoder rejects the argument, for example because a bit that must be 0 is set."""

    register: Register


ArgumentRefusal = Beyond | TooWide | NotOneOf | Undecodable


@dataclass(frozen=True, slots=True)
class Given:
    """An argument, the operation that writes it, and the reasons for which it is rejected before any write.

    Values that do not fit are also rejected when the register is encoded.
    """

    argument: Argument
    written: tuple[Writes, ...]
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True)
class Run:
    """Plan of a procedure. ``changes_frames`` is true if it writes a parameter on which frames depend."""

    procedure: Procedure
    operations: tuple[Operation, ...]
    arguments: tuple[Given, ...]
    changes_frames: bool

    @cached_property
    def reads(self) -> tuple[Reads, ...]:
        return tuple(item for item in self.operations if isinstance(item, Reads))

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """Return the operations that it needs from a master, without duplicates."""
        found = {call for item in self.operations for call in item.calls}
        return tuple(call for call in Call if call in found)


def run_of(device: Device, procedure: Procedure) -> Run:
    closing = closing_steps(device, procedure.steps)
    plain = (_operation(device, procedure, step) for step in procedure.steps)
    closed = [
        replace(item, closes=True) if isinstance(item, Writes) and index in closing else item
        for index, item in enumerate(plain)
    ]
    operations = tuple(_with_verification(_taught(device, closed)))
    writes = [item for item in operations if isinstance(item, Writes)]
    arguments = (
        _given(device, argument, tuple(item for item in writes if _argument(item.value) is argument))
        for argument in procedure.arguments
    )
    held = {(item.register, item.field) for item in device.run_time_parameters}
    registers = {name for name, _ in held}
    changes = any(
        item.register.name in registers if item.field is None else (item.register.name, item.field.name) in held
        for item in writes
    )
    return Run(procedure, operations, tuple(arguments), changes)


def _taught(device: Device, operations: Sequence[Operation]) -> Iterator[Operation]:
    """Yield the operations, with the written parameters on which later limits depend."""
    for index, item in enumerate(operations):
        if isinstance(item, Writes) and item.field is None and not isinstance(item.value, Stated):
            later = [other for other in operations[index + 1 :] if isinstance(other, Writes)]
            limits = (bound for other in later for bound in (other.register.min, other.register.max))
            names = {name for bound in limits if bound is not None for name in bound.parameters}
            held = (one for one in device.run_time_parameters if one.register == item.register.name)
            yield replace(item, teaches=tuple(one for one in held if one.name in names))
        else:
            yield item


def _with_verification(operations: Iterable[Operation]) -> Iterator[Operation]:
    """Yield the operations, with a ``Verifies`` for each write that can be read back before it takes effect.

    The manuals have no such step. On BiSS, however, a disturbed write can be echoed as if it had been stored. A written
    value takes effect when the procedure writes to a register that cannot be read, such as a command register, makes a
    closing write, or writes to the same place again.
    """
    written: list[Verifies] = []
    for item in operations:
        if isinstance(item, Writes) and (_acts(item) or any(_same_place(item, before.write) for before in written)):
            yield from written
            written.clear()
        yield item
        if isinstance(item, Writes) and _can_be_read_back(item):
            written.append(Verifies(item, tuple(_stored(item))))


def _acts(item: Writes) -> bool:
    return item.closes or not item.register.readable


def _same_place(item: Writes, before: Writes) -> bool:
    whole = item.field is None or before.field is None
    return item.register is before.register and (whole or item.field is before.field)


def _can_be_read_back(item: Writes) -> bool:
    """Return whether the register still holds the written value afterwards."""
    unused = (field for field in item.register.layout.fields if isinstance(field.kind, Unused))
    is_fixed = all(field.is_fixed for field in unused)
    return item.register.readable and not item.register.clears_itself and not item.closes and is_fixed


def _stored(item: Writes) -> Iterator[Piece]:
    """Yield the bytes with the written bits that have a meaning. Reserved bits can have any value when read."""
    for piece in item.pieces:
        mask = piece.mask & ~(_unused_bits(item.register, piece.byte) >> piece.right)
        if mask or item.register.is_accessed_whole:
            yield replace(piece, mask=mask)


def _unused_bits(register: Register, byte: int) -> int:
    """Return the bits in a byte of the register that have no meaning in the manual."""
    layout = register.layout
    number = sum(field.mask_in_place for field in layout.fields if isinstance(field.kind, Unused))
    return register.bytes_of(number)[byte]


def _operation(device: Device, procedure: Procedure, step: Step) -> Operation:
    match step:
        case WaitStep():
            return Waits(step)
        case SendStep():
            return Sends(step, reply_to(device, procedure.interface, step.data_id))
        case PollStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            return Polls(step, register, field, pieces_of(register, field))
        case ReadStep():
            register = device.register(step.register)
            of = register.layout.field(step.field) if step.field else None
            return Reads(step, register, of, pieces_of(register, of))
        case ModifyStep():
            register = device.register(step.register)
            field = register.layout.field(step.field)
            argument = _named(procedure, step)
            value = InField(argument, field) if argument is not None else Stated(step.value or 0)
            return Writes(step, register, field, pieces_of(register, field), value)
        case WriteStep():
            register = device.register(step.register)
            return Writes(step, register, None, pieces_of(register), _source(register, step, _named(procedure, step)))
        case _:
            assert_never(step)


def pieces_of(register: Register, field: Field | None = None) -> tuple[Piece, ...]:
    """Return the bytes of a field, or of a whole register, in ascending order of address.

    If a register is accessed whole, its bytes outside the field have the mask 0.
    """
    if field is not None:
        found = {item.byte: item for item in field.pieces}
        if found and register.is_accessed_whole:
            found = {byte: found.get(byte, Piece(byte, 0, 0, 0)) for byte in range(register.length)}
        return tuple(found[byte] for byte in sorted(found))
    last = register.length - 1
    low_first = register.byte_order == "low_byte_first"
    return tuple(Piece(byte, 0, 0xFF, 8 * (byte if low_first else last - byte)) for byte in range(register.length))


def _named(procedure: Procedure, step: WriteStep | ModifyStep) -> Argument | None:
    if step.value is not None:
        return None
    return next(item for item in procedure.arguments if item.name == step.value_name)


def _source(register: Register, step: WriteStep, argument: Argument | None) -> Source:
    if argument is None:
        return Stated(step.value or 0)
    member = limited_member(register)
    return AsMember(argument, member) if member else AsNumber(argument)


def _argument(value: Source) -> Argument | None:
    match value:
        case Stated():
            return None
        case InField() | AsNumber() | AsMember():
            return value.argument
        case _:
            assert_never(value)


def _given(device: Device, argument: Argument, writes: tuple[Writes, ...]) -> Given:
    refusals: list[ArgumentRefusal] = []
    for item in writes:
        # An argument that is written to the same register twice is checked only once.
        refusals += [refusal for refusal in _refusals(device, item, argument) if refusal not in refusals]
    return Given(argument, writes, tuple(refusals))


def _refusals(device: Device, item: Writes, argument: Argument) -> Iterator[ArgumentRefusal]:
    match item.value:
        case AsMember():
            # The limits of the register are checked when the member is encoded.
            if argument.meant_as:
                yield from _beyond(device, item.register, argument)
        case AsNumber():
            yield from _beyond(device, item.register, argument)
            if codec_of(device, item.register.layout).checks:
                yield Undecodable(item.register)
        case InField(field=field):
            yield from field_refusals(device, item.register, field, argument)
        case Stated():
            return
        case _:
            assert_never(item.value)


def field_refusals(
    device: Device, register: Register, field: Field, argument: Argument
) -> Iterator[TooWide | Beyond | NotOneOf]:
    """Yield the reasons to reject an argument for one field of a register. If a meaning is given, its limits apply."""
    yield TooWide(field, field.width)
    if argument.meant_as or limited_member(register) == field.name:
        yield from _beyond(device, register, argument)
    values = allowed_values(register.layout, field)
    if values:
        yield NotOneOf(field, values)


def _beyond(device: Device, register: Register, argument: Argument) -> Iterator[Beyond]:
    meaning = next((item for item in register.meanings if item.name == argument.meant_as), None)
    limits = limits_of(device, register, meaning)
    if limits.low is not None or limits.high is not None:
        yield Beyond(register, meaning, limits)
