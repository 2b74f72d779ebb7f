"""A procedure in C: a list of steps, constant or written for the arguments, and a function that carries it out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import count

from ...model import BitSlice, Procedure, Register, assert_never
from ...model.record import dataclass
from ...plan.limits import TooWide
from ...plan.steps import (
    ArgumentRefusal,
    AsMember,
    AsNumber,
    CheckedArgument,
    FixedNumber,
    InField,
    OutsideArgumentLimits,
    PlannedStep,
    PollRegister,
    ReadRegister,
    SendRequest,
    Undecodable,
    VerifyWrite,
    WaitTime,
    WriteRegister,
    field_refusals,
    run_of,
)
from .. import TargetError
from .about import about_argument, about_procedure, about_run, note_of_read, note_of_step
from .comments import Paragraph
from .context import HeaderContext
from .names import (
    CCast,
    CExpression,
    CName,
    CNumber,
    DeclaredName,
    c_name,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)
from .registers import RegisterCode

#: Names of arguments and locals in the generated functions.
_NAMES_OF_LOCALS = frozenset(
    ("variant", "steps", "capacity", "count", "index", "result", "address", "transport", "out", "failure", "bytes")
)


_ZERO = CNumber(0)


@dataclass(frozen=True, slots=True)
class StepRow:
    """An elementary step at index ``at`` of the list: one byte of a register, a wait, a request.

    ``address`` is an expression with the macro of the register. ``more`` is true if the byte is accessed together with
    the byte of the step before.
    """

    at: int
    op: PlannedStep
    note: str
    address: str = ""
    mask: int = 0
    value: CExpression = _ZERO
    more: bool = False


@dataclass(frozen=True, slots=True)
class FilledRegister:
    """The local variables of a register that takes an argument: ``local`` for its struct, ``bytes`` for its bytes."""

    code: RegisterCode
    argument: str
    member: str
    local: str
    bytes: str

    @property
    def needs_setter(self) -> bool:
        """True if other members repeat it, so that a function must set it."""
        return self.code.codec is not None and self.member in self.code.codec.set_names


@dataclass(frozen=True, slots=True)
class WholeRegister:
    """The bytes of a register whose whole number is an argument, and the struct that they decode to."""

    code: RegisterCode
    local: str
    bytes: str
    values: tuple[CExpression, ...]


@dataclass(frozen=True, slots=True)
class FilledRows:
    """The steps that write the bytes of a register or read them back. ``at`` is the index of the first step."""

    at: int
    kind: str
    filled: FilledRegister
    note: str


@dataclass(frozen=True, slots=True)
class ArgumentCode:
    """An argument, its comment, and the reasons to refuse it."""

    checked: CheckedArgument
    type: str
    name: str
    about: str
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True, slots=True)
class ReadMember:
    """A member for ``length`` of the bytes read, starting with the ``first``."""

    name: str
    first: int
    length: int
    note: str


class ProcedureCode:
    """A procedure. ``function`` is the function that carries it out, ``steps`` the function that returns its steps."""

    def __init__(
        self, context: HeaderContext, registers: Mapping[str, RegisterCode], read_state: str, procedure: Procedure
    ) -> None:
        self.context = context
        self.registers = registers
        self.run = run = run_of(context.device, procedure)
        self.function = f"{context.prefix}_{procedure.name}"
        self.steps = f"{self.function}_steps"
        self.count_macro = f"{self.steps}_count".upper()
        self._names = {
            parameter.argument.name: c_name(parameter.argument.name, _NAMES_OF_LOCALS) for parameter in run.arguments
        }
        #: Both by argument and register.
        self._filled = dict(self._yield_filled_registers())
        self._whole_registers = dict(self._yield_whole_registers())
        #: Registers with parameters on which the limits of later steps depend.
        self._registers_setting_limits = {
            step.register.name for step in run.operations if isinstance(step, WriteRegister) and step.determines_limits
        }
        self.arguments = [self._build_argument(parameter) for parameter in run.arguments]
        self.rows = list(self._yield_rows())
        self.count = sum(map(_number_of_rows, run.operations))
        self.reads = list(self._yield_read_members())
        self.about = about_procedure(context.device, procedure)
        #: The comment on the function that carries it out.
        self.run_about = [*self.about, *about_run(context.device, run, read_state), *self._document_parameters()]

    @property
    def filled(self) -> list[FilledRegister]:
        return list(self._filled.values())

    @property
    def read_type(self) -> str:
        """Struct for the bytes read, or an empty string if there are none."""
        return f"{self.function}_read" if self.reads else ""

    @property
    def read_bytes(self) -> int:
        return sum(member.length for member in self.reads)

    @property
    def whole_registers(self) -> list[WholeRegister]:
        return list(self._whole_registers.values())

    def whole_register(self, argument: ArgumentCode, register: Register) -> WholeRegister:
        return self._whole_registers[argument.checked.argument.name, register.name]

    @property
    def variant(self) -> str:
        """The variant that functions receive, which is a copy if limits depend on values written earlier."""
        return self.context.passing.argument("written") if self._registers_setting_limits else "variant"

    def update_function(self, written: FilledRegister | WholeRegister) -> str:
        """Return the function that updates the copy from written bytes, or an empty string if no limit needs it."""
        name = written.code.register.name
        return f"{self.context.prefix}_take_{name}" if name in self._registers_setting_limits else ""

    def is_checked_after_update(self, refusal: ArgumentRefusal) -> bool:
        """Return True if an argument is checked only after the copy was updated, which can change its limits."""
        return bool(self._registers_setting_limits) and _has_variable_limits(refusal)

    @property
    def needs_variant(self) -> bool:
        """True if the function needs the order code to fill registers or to check arguments."""
        if self._filled or self._registers_setting_limits:
            return True
        for argument in self.arguments:
            for refusal in argument.refusals:
                if isinstance(refusal, Undecodable) or _has_variable_limits(refusal):
                    return True
        return False

    def declared(self) -> Iterator[DeclaredName]:
        for name in (self.steps, self.count_macro, self.function, self.read_type):
            if name:
                yield name, ("procedures", self.run.procedure.name)

    def _document_parameters(self) -> Iterator[Paragraph]:
        """Yield the parameters of the procedure's function, or nothing if the procedure has no arguments."""
        if self.arguments:
            yield "@param transport ", "Your bus access functions."
            yield "@param variant ", "The order code."
            yield from ((f"@param {argument.name} ", argument.about) for argument in self.arguments)
            if self.reads:
                yield "@param out ", "The bytes read, unchanged on error."
            yield "@param failure ", "Details of a failed step, or NULL."

    # -- arguments

    def _build_argument(self, parameter: CheckedArgument) -> ArgumentCode:
        """Return an argument with the reasons to refuse it, each once. Those that its type excludes are left out."""
        all_refusals = list(parameter.refusals)
        for write in parameter.written:
            all_refusals += self._byte_refusals(write)
        refusals: list[ArgumentRefusal] = []
        for refusal in all_refusals:
            if refusal not in refusals and not _is_excluded_by_type(refusal):
                refusals.append(refusal)
        return ArgumentCode(
            checked=parameter,
            type=self._argument_type(parameter.written[0]),
            name=self._names[parameter.argument.name],
            about=about_argument(self.context.device, parameter.argument),
            refusals=tuple(refusals),
        )

    def _byte_refusals(self, write: WriteRegister) -> Iterator[ArgumentRefusal]:
        """Yield the reasons to refuse an argument that is a whole register of one byte, which has no encoder."""
        match write.value:
            case AsMember(argument, member) if self.registers[write.register.name].is_plain:
                field = write.register.layout.field(member)
                yield from field_refusals(self.context.device, write.register, field, argument)

    def _argument_type(self, write: WriteRegister) -> str:
        """Return the type of the argument that a step writes: the type of the field, the member or the register."""
        match write.value:
            case InField(field=field):
                return unsigned(field.widest)
            case AsMember(member=member) if not self.registers[write.register.name].is_plain:
                return self.registers[write.register.name].struct.member_type(member)
            case AsMember() | AsNumber() | FixedNumber():
                return unsigned(8 * write.register.length)
            case _:
                assert_never(write.value)

    def _yield_filled_registers(self) -> Iterator[tuple[tuple[str, str], FilledRegister]]:
        """Yield the structs that take arguments, with their key ``(argument, register)``.

        A register has a struct if the argument is a field or join of it, and the register is not one plain byte.
        """
        for parameter in self.run.arguments:
            argument = parameter.argument.name
            member_by_register: dict[str, str] = {}
            for write in parameter.written:
                is_plain = self.registers[write.register.name].is_plain
                if isinstance(write.value, AsMember) and not is_plain:
                    member_by_register[write.register.name] = write.value.member
            for index, (register, member) in enumerate(member_by_register.items()):
                # The first register of an argument needs no name of its own.
                stem = argument if index == 0 else f"{argument}_{register}"
                filled_register = FilledRegister(
                    code=self.registers[register],
                    argument=self._names[argument],
                    member=member,
                    local=c_name(f"{stem}_register", self._names),
                    bytes=c_name(f"{stem}_bytes", self._names),
                )
                yield (argument, register), filled_register

    def _yield_whole_registers(self) -> Iterator[tuple[tuple[str, str], WholeRegister]]:
        """Yield the registers whose whole number is an argument, with their key ``(argument, register)``.

        Only those are needed whose decoder can reject the number, or on which the limit of a later step depends.
        """
        for parameter in self.run.arguments:
            argument = parameter.argument.name
            undecodable = [refusal for refusal in parameter.refusals if isinstance(refusal, Undecodable)]
            checked_registers = {refusal.register.name for refusal in undecodable}
            for write in parameter.written:
                register = write.register.name
                is_checked = register in checked_registers or write.determines_limits
                if isinstance(write.value, AsNumber) and is_checked:
                    whole_register = WholeRegister(
                        code=self.registers[register],
                        local=c_name(f"{argument}_{register}_held", self._names),
                        bytes=c_name(f"{argument}_{register}_sent", self._names),
                        values=tuple(self._byte_value(write, bit_slice) for bit_slice in write.bit_slices),
                    )
                    yield (argument, register), whole_register

    # -- steps

    def _yield_rows(self) -> Iterator[StepRow | FilledRows]:
        """Yield the steps with their index in the list. A step on several bytes of a register takes several indices."""
        index = 0
        for step in self.run.operations:
            note = note_of_step(self.context.device, step)
            if isinstance(step, (WaitTime, SendRequest)):
                yield StepRow(at=index, op=step, note=note)
            else:
                yield from self._rows_of_register(index, step, note)
            index += _number_of_rows(step)

    def _rows_of_register(
        self, first_index: int, step: WriteRegister | ReadRegister | PollRegister | VerifyWrite, note: str
    ) -> Iterator[StepRow | FilledRows]:
        """Yield the steps on the bytes of a register. Only the first has a note.

        If a struct is filled for the register, one item represents all its bytes, unless it reads back only some bits.

        Raises:
            TargetError: The bytes depend on the order code, or would be polled one after the other.
        """
        filled_register = self._filled_by(step)
        if filled_register is not None:
            if isinstance(step, VerifyWrite):
                yield from self._read_back(first_index, step, filled_register, note)
            else:
                yield FilledRows(first_index, kind="write", filled=filled_register, note=note)
            return
        _refuse_unsupported(step)
        for index, bit_slice in enumerate(step.bit_slices):
            value = self._byte_value(step, bit_slice)
            yield self._build_row(first_index + index, step, note if index == 0 else "", bit_slice, value)

    def _build_row(
        self,
        index: int,
        step: WriteRegister | ReadRegister | PollRegister | VerifyWrite,
        note: str,
        bit_slice: BitSlice,
        value: CExpression,
    ) -> StepRow:
        """Return the step on one byte of a register. ``value`` has the bits at their places in the byte."""
        return StepRow(
            at=index,
            op=step,
            note=note,
            address=self._address(step.register, bit_slice.byte),
            mask=bit_slice.mask << bit_slice.low_in_byte,
            value=value,
            more=step.register.is_accessed_whole and bit_slice.byte > 0,
        )

    def _address(self, register: Register, byte: int) -> str:
        """Return the address of a byte of a register, as its macro and the distance from it."""
        macro = f"{self.registers[register.name].stem}_ADDRESS"
        distance = register.address_of(byte) - register.address
        return f"{macro} + {distance}U" if distance else macro

    def _read_back(
        self, first_index: int, step: VerifyWrite, filled_register: FilledRegister, note: str
    ) -> Iterator[StepRow | FilledRows]:
        """Yield one row for all bytes if every bit of them counts, else one row per byte."""
        if step.bit_slices == step.write.bit_slices:
            yield FilledRows(first_index, kind="verify", filled=filled_register, note=note)
            return
        for index, bit_slice in enumerate(step.bit_slices):
            written_byte = CName(f"{filled_register.bytes}[{bit_slice.byte}]")
            # A mask of 0 is a byte of reserved bits, which is read but not compared.
            expected = masked(written_byte, bit_slice.mask) if bit_slice.mask else _ZERO
            yield self._build_row(first_index + index, step, note if index == 0 else "", bit_slice, expected)

    def _filled_by(self, step: WriteRegister | ReadRegister | PollRegister | VerifyWrite) -> FilledRegister | None:
        """Return the register whose struct a step writes or reads back, or None if it has no struct."""
        write = step.write if isinstance(step, VerifyWrite) else step
        if isinstance(write, WriteRegister) and isinstance(write.value, AsMember):
            return self._filled.get((write.value.argument.name, write.register.name))
        return None

    def _byte_value(
        self, step: WriteRegister | ReadRegister | PollRegister | VerifyWrite, bit_slice: BitSlice
    ) -> CExpression:
        """Return the value that a step writes to a byte, waits for, or reads back, or 0 for a step that only reads.

        It has the bits of ``bit_slice`` at their place in the byte. The other bits of the byte are 0.
        """
        if isinstance(step, ReadRegister) or not bit_slice.mask:
            return _ZERO
        write_or_poll = step.write if isinstance(step, VerifyWrite) else step
        value = (
            FixedNumber(write_or_poll.step.value) if isinstance(write_or_poll, PollRegister) else write_or_poll.value
        )
        # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
        if isinstance(value, FixedNumber):
            bits_of_piece = (value.number >> bit_slice.low_in_number) & bit_slice.mask
            return CNumber(bits_of_piece << bit_slice.low_in_byte, hexadecimal=True)
        bits = shifted_right(CName(self._names[value.argument.name]), bit_slice.low_in_number)
        if bit_slice.mask != 0xFF:
            return CCast("uint8_t", shifted_left(masked(bits, bit_slice.mask), bit_slice.low_in_byte))
        is_whole_byte = isinstance(value, AsNumber) and len(step.bit_slices) == 1
        return bits if is_whole_byte else CCast("uint8_t", bits)

    def _yield_read_members(self) -> Iterator[ReadMember]:
        """Yield a member for each register or field that is read. Repeated names are numbered.

        The name includes the field if not all bytes of the register are read.
        """
        used_names: set[str] = set()
        first_byte = 0
        for read in self.run.reads:
            length = len(read.bit_slices)
            stem = read.register.name
            if length != read.register.length and read.field is not None:
                stem += f"_{read.field.name}"
            member_name = _unused_name(c_name(stem), used_names)
            used_names.add(member_name)
            note = note_of_read(self.context.device, read)
            yield ReadMember(name=member_name, first=first_byte, length=length, note=note)
            first_byte += length


def _unused_name(name: str, used_names: Collection[str]) -> str:
    """Return ``name``, or with the first free number at its end if it is used already: ``status_2``, ``status_3``."""
    numbered_name = name
    for number in count(2):
        if numbered_name not in used_names:
            break
        numbered_name = f"{name}_{number}"
    return numbered_name


def _refuse_unsupported(step: WriteRegister | ReadRegister | PollRegister | VerifyWrite) -> None:
    """Raise an error if the bytes of a step depend on the order code, or would be polled one after the other."""
    if not step.bit_slices:
        raise TargetError(
            f"the place of '{_place_text(step)}' depends on the order code; the C target cannot access it alone"
        )
    if isinstance(step, PollRegister) and len(step.bit_slices) > 1 and not step.register.is_accessed_whole:
        # The bytes could match one after the other, and never all at the same time.
        problem = f"'{_place_text(step)}' is spread over {len(step.bit_slices)} bytes"
        raise TargetError(f"{problem}, which the C target would poll one after the other")


def _has_variable_limits(refusal: ArgumentRefusal) -> bool:
    """Return True if an argument is refused outside limits that depend on the order code."""
    if not isinstance(refusal, OutsideArgumentLimits):
        return False
    return any(not bound.is_constant for _, bound in refusal.limits.binding)


def _number_of_rows(step: PlannedStep) -> int:
    """Return the number of elementary steps: one for each byte of a register."""
    return 1 if isinstance(step, (WaitTime, SendRequest)) else len(step.bit_slices)


def _is_excluded_by_type(refusal: ArgumentRefusal) -> bool:
    """Return True if the type of the argument already excludes the value, as ``uint8_t`` does for a field of 8 bits."""
    return isinstance(refusal, TooWide) and size_of(refusal.field.widest) == refusal.field.widest


def _place_text(step: WriteRegister | ReadRegister | PollRegister | VerifyWrite) -> str:
    return f"{step.register.name}.{step.field.name if step.field is not None else ''}"
