"""How a procedure is carried out: which bytes its steps touch, what its arguments have to be, and what it reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
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
from .closing_steps import closing_steps
from .codec import allowed_values, codec_of
from .limits import Limits, limited_member, limits_of
from .refusals import NotOneOf, TooWide
from .replies import Reply, reply_to


class Call(Enum):
    """What a master has to be able to do."""

    READ = "read"
    WRITE = "write"
    WAIT = "wait"
    SEND = "send"


# -- what a step writes


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
    """The argument, as the number that the register holds as a whole."""

    argument: Argument


@dataclass(frozen=True, slots=True)
class AsMember:
    """The argument, as the field or join ``member``, of which the register is encoded."""

    argument: Argument
    member: str


Source = Stated | InField | AsNumber | AsMember


# -- what is done


@dataclass(frozen=True, slots=True)
class Writes:
    """Write a register, or one field of it and leave the others as they were read.

    ``pieces`` are the bytes concerned: bits ``mask << right`` of the byte get ``(number >> left) & mask``. They are
    empty where the field moves with the order code. ``teaches`` are the parameters that the register holds at run time,
    where limits of later steps depend on them: there they have the value that was written. ``closes`` says that it
    undoes what a step before it has opened: it is also done where a step in between fails.
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
    """Read a register, or the bytes of one field of it."""

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
    """Read what ``write`` has written, and stop where ``pieces`` of it are not as written."""

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
        """The step whose write is read back; the manual has none for this one."""
        return self.write.step


@dataclass(frozen=True, slots=True)
class Waits:
    step: WaitStep
    calls = (Call.WAIT,)


@dataclass(frozen=True, slots=True)
class Sends:
    """Send a request so many times; ``reply`` is what has to come back each time, None where the spec does not tell."""

    step: SendStep
    reply: Reply | None = None

    @property
    def calls(self) -> tuple[Call, ...]:
        return (Call.WAIT, Call.SEND) if self.step.microseconds else (Call.SEND,)


Operation = Writes | Reads | Polls | Verifies | Waits | Sends


# -- what arguments have to be


@dataclass(frozen=True, slots=True)
class Beyond:
    """The argument is outside the limits of the register, or of the ``meaning`` that the argument gives it."""

    register: Register
    meaning: RegisterMeaning | None
    limits: Limits


@dataclass(frozen=True, slots=True)
class Undecodable:
    """The argument is no number that the register's decoder accepts, as one with a bit that is always 0."""

    register: Register


ArgumentRefusal = Beyond | TooWide | NotOneOf | Undecodable


@dataclass(frozen=True, slots=True)
class Given:
    """An argument, what writes it, and why it is refused before anything is written.

    What encodes a register refuses on top of that what it cannot hold.
    """

    argument: Argument
    written: tuple[Writes, ...]
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True)
class Run:
    """How a procedure is carried out. ``changes_frames`` says that it writes a parameter that frames depend on."""

    procedure: Procedure
    operations: tuple[Operation, ...]
    arguments: tuple[Given, ...]
    changes_frames: bool

    @cached_property
    def reads(self) -> tuple[Reads, ...]:
        return tuple(item for item in self.operations if isinstance(item, Reads))

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """What it needs of a master, each once."""
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
    """The operations, with the parameters that later limits take from what was written."""
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
    """Yield the operations, with a ``Verifies`` for each write that can be read back, before anything acts on it.

    The manuals have no such step. But over BiSS a disturbed write can come back as if it were stored. Three things act
    on it: a write to a register that cannot be read, such as a command; a write that closes; and another write to the
    same place.
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
    """Whether the register still holds, afterwards, what was written."""
    unused = (field for field in item.register.layout.fields if isinstance(field.kind, Unused))
    is_fixed = all(field.is_fixed for field in unused)
    return item.register.readable and not item.register.clears_itself and not item.closes and is_fixed


def _stored(item: Writes) -> Iterator[Piece]:
    """The bits that were written and mean something: unused ones may read as anything."""
    for piece in item.pieces:
        mask = piece.mask & ~(_unused_bits(item.register, piece.byte) >> piece.right)
        if mask:
            yield replace(piece, mask=mask)


def _unused_bits(register: Register, byte: int) -> int:
    """The bits of a byte of the register that no manual gives a meaning."""
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
    """The bytes of a field, or all of a register, in ascending order of address."""
    if field is not None:
        return tuple(sorted(field.pieces, key=lambda item: item.byte))
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
        # A register written twice refuses an argument once.
        refusals += [refusal for refusal in _refusals(device, item, argument) if refusal not in refusals]
    return Given(argument, writes, tuple(refusals))


def _refusals(device: Device, item: Writes, argument: Argument) -> Iterator[ArgumentRefusal]:
    match item.value:
        case AsMember():
            # What encodes the member knows the limits of the register.
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
    """Why an argument for one field of a register is refused; one that has a meaning has its limits."""
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
