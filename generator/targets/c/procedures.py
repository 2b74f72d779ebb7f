"""A procedure in C: a list of steps, constant or written for the arguments, and a function that carries it out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model import BitSlice, Procedure, Register, assert_never
from ...model.record import dataclass
from ...plan.limits import TooWide
from ...plan.procedures import plan_procedure
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
    ValueSource,
    VerifyWrite,
    WaitTime,
    WriteRegister,
    field_refusals,
)
from .. import TargetError
from .about import about_argument, about_procedure, about_run, note_of_read, note_of_step
from .comments import Paragraph
from .context import HeaderContext
from .expressions import CCast, CExpression, CName, CNumber, masked, shifted_left, shifted_right
from .names import DeclaredName, c_name, size_of, unsigned, unused_name
from .registers import FilledRegister, RegisterCode, WholeRegister

ZERO = CNumber(0)


@dataclass(frozen=True, slots=True)
class StepRow:
    """A step at ``index`` of the list: an access to one byte of a register, a wait, or a request.

    ``address`` is an expression with the macro of the register. ``mask`` and ``value`` are the bits of the byte that
    the step writes, waits for, or compares. ``continues_previous`` is True if the byte is accessed together with the
    byte of the previous step. ``note`` is the comment.
    """

    index: int
    operation: PlannedStep
    note: str
    address: str = ""
    mask: int = 0
    value: CExpression = ZERO
    continues_previous: bool = False


@dataclass(frozen=True, slots=True)
class FilledRows:
    """The steps that write all bytes of a filled register, or with the ``kind`` ``verify``, read them back.

    ``index`` is that of the first step in the list.
    """

    index: int
    kind: str
    register: FilledRegister
    note: str


@dataclass(frozen=True, slots=True)
class ArgumentCode:
    """An argument of a procedure, with its C type and name, its comment, and the reasons to reject its value."""

    checked_argument: CheckedArgument
    type: str
    name: str
    about: str
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True, slots=True)
class ReadMember:
    """A member of the struct with the bytes read: ``length`` of these bytes, from index ``first_byte`` on."""

    name: str
    first_byte: int
    length: int
    note: str


#: Names of arguments and locals in the generated functions.
_NAMES_OF_LOCALS = frozenset(
    ("variant", "steps", "capacity", "count", "index", "result", "address", "transport", "out", "failure", "bytes")
)


#: A step that accesses the bytes of a register.
RegisterAccess = WriteRegister | ReadRegister | PollRegister | VerifyWrite


class ProcedureCode:
    """The C code of a procedure, such as setting a preset.

    ``function_name`` is the name of the function that carries it out, and ``steps_function`` of the one that returns
    its steps.
    """

    def __init__(
        self, context: HeaderContext, registers: Mapping[str, RegisterCode], read_state: str, procedure: Procedure
    ) -> None:
        self.context = context
        self.register_code_by_name = registers
        self.procedure_plan = procedure_plan = plan_procedure(context.device, procedure)
        self.function_name = f"{context.prefix}_{procedure.name}"
        self.steps_function = f"{self.function_name}_steps"
        self.count_macro = f"{self.steps_function}_count".upper()
        argument_names = [argument.name for argument in procedure.arguments]
        self._c_name_by_argument = {name: c_name(name, _NAMES_OF_LOCALS) for name in argument_names}
        #: Registers that take an argument in a member, and as a whole, each by argument and register.
        self._filled_registers = dict(self._yield_filled_registers())
        self._whole_registers = dict(self._yield_whole_registers())
        #: The registers whose written value changes the limits of later steps.
        writes = [step for step in procedure_plan.operations if isinstance(step, WriteRegister)]
        self._registers_setting_limits = {write.register.name for write in writes if write.determines_limits}
        self.arguments = [self._build_argument(parameter) for parameter in procedure_plan.arguments]
        self.rows = list(self._yield_rows())
        self.step_count = sum(map(_number_of_rows, procedure_plan.operations))
        self.read_members = list(self._yield_read_members())
        self.about = about_procedure(context.device, procedure)
        #: The comment on ``function_name``.
        about_function = about_run(context.device, procedure_plan, read_state)
        self.run_about = [*self.about, *about_function, *self._document_parameters()]

    @property
    def filled(self) -> list[FilledRegister]:
        """The registers whose structs take an argument."""
        return list(self._filled_registers.values())

    @property
    def read_type(self) -> str:
        """Struct for the bytes read, or an empty string if there are none."""
        return f"{self.function_name}_read" if self.read_members else ""

    @property
    def read_bytes(self) -> int:
        """The number of bytes that the procedure reads."""
        return sum(member.length for member in self.read_members)

    @property
    def whole_registers(self) -> list[WholeRegister]:
        """The registers that an argument sets as one number, and that are decoded to check it."""
        return list(self._whole_registers.values())

    def whole_register(self, argument: ArgumentCode, register: Register) -> WholeRegister:
        """Return the register that an argument sets as one number."""
        return self._whole_registers[argument.checked_argument.argument.name, register.name]

    @property
    def variant(self) -> str:
        """The order code (variant) to pass to functions.

        If limits depend on values that the procedure has written before, it is a copy that contains these values.
        """
        return self.context.passing.argument("written") if self._registers_setting_limits else "variant"

    def update_function(self, written: FilledRegister | WholeRegister) -> str:
        """Return the function that updates the copy of the variant from the bytes written to a register.

        The result is an empty string if no limit depends on the register.
        """
        name = written.code.register.name
        return f"{self.context.prefix}_take_{name}" if name in self._registers_setting_limits else ""

    def is_checked_after_update(self, refusal: ArgumentRefusal) -> bool:
        """Return True if a check of an argument must wait until the copy of the variant is updated."""
        return bool(self._registers_setting_limits) and _has_variable_limits(refusal)

    @property
    def needs_variant(self) -> bool:
        """True if the function needs the order code to fill registers or to check arguments."""
        if self._filled_registers or self._registers_setting_limits:
            return True
        for argument in self.arguments:
            for refusal in argument.refusals:
                # The decoder of a register takes the order code.
                is_checked_by_decoder = isinstance(refusal, Undecodable)
                if is_checked_by_decoder or _has_variable_limits(refusal):
                    return True
        return False

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with the path of the procedure in the spec."""
        for name in (self.steps_function, self.count_macro, self.function_name, self.read_type):
            if name:
                yield name, ("procedures", self.procedure_plan.procedure.name)

    def _document_parameters(self) -> Iterator[Paragraph]:
        """Yield the comment on each parameter of ``function_name``, or nothing if the procedure has no arguments."""
        if self.arguments:
            yield "@param transport ", "Your bus access functions."
            yield "@param variant ", "The order code."
            yield from ((f"@param {argument.name} ", argument.about) for argument in self.arguments)
            if self.read_members:
                yield "@param out ", "The bytes read, unchanged on error."
            yield "@param failure ", "Details of a failed step, or NULL."

    # -- arguments

    def _build_argument(self, parameter: CheckedArgument) -> ArgumentCode:
        """Return an argument with the reasons to reject its value.

        Reasons that cannot occur, because the C type of the argument has no such value, are left out.
        """
        all_refusals = list(parameter.refusals)
        for write in parameter.writes:
            all_refusals += self._byte_refusals(write)
        refusals: list[ArgumentRefusal] = []
        for refusal in all_refusals:
            if refusal not in refusals and not _is_excluded_by_type(refusal):
                refusals.append(refusal)
        return ArgumentCode(
            checked_argument=parameter,
            type=self._argument_type(parameter.writes[0]),
            name=self._c_name_by_argument[parameter.argument.name],
            about=about_argument(self.context.device, parameter.argument),
            refusals=tuple(refusals),
        )

    def _byte_refusals(self, write: WriteRegister) -> Iterator[ArgumentRefusal]:
        """Yield the reasons to reject an argument that is a register of one byte, which has no encoder to check it."""
        match write.value:
            case AsMember(argument, member) if self.register_code_by_name[write.register.name].is_plain:
                field = write.register.layout.field(member)
                yield from field_refusals(self.context.device, write.register, field, argument)

    def _argument_type(self, write: WriteRegister) -> str:
        """Return the C type of the argument that a step writes, which is that of a field, a member or a register."""
        match write.value:
            case InField(field=field):
                return unsigned(field.widest)
            case AsMember(member=member) if not self.register_code_by_name[write.register.name].is_plain:
                return self.register_code_by_name[write.register.name].struct.member_type(member)
            case AsMember() | AsNumber() | FixedNumber():
                return unsigned(8 * write.register.length)
            case _:
                assert_never(write.value)

    def _yield_filled_registers(self) -> Iterator[tuple[tuple[str, str], FilledRegister]]:
        """Yield the registers whose structs take an argument, each under ``(argument, register)``.

        A register has a struct unless it is one plain byte.
        """
        for parameter in self.procedure_plan.arguments:
            argument = parameter.argument.name
            member_by_register: dict[str, str] = {}
            for write in parameter.writes:
                is_plain = self.register_code_by_name[write.register.name].is_plain
                if isinstance(write.value, AsMember) and not is_plain:
                    member_by_register[write.register.name] = write.value.member
            for index, (register, member) in enumerate(member_by_register.items()):
                # The first register of an argument needs no name of its own.
                stem = argument if index == 0 else f"{argument}_{register}"
                filled_register = FilledRegister(
                    code=self.register_code_by_name[register],
                    argument=self._c_name_by_argument[argument],
                    member=member,
                    struct_local=c_name(f"{stem}_register", self._c_name_by_argument),
                    bytes_local=c_name(f"{stem}_bytes", self._c_name_by_argument),
                )
                yield (argument, register), filled_register

    def _yield_whole_registers(self) -> Iterator[tuple[tuple[str, str], WholeRegister]]:
        """Yield the registers that an argument sets as one number, each under ``(argument, register)``.

        A register is included only if its decoder can reject the number, or if a later limit depends on the register.
        """
        for parameter in self.procedure_plan.arguments:
            argument = parameter.argument.name
            undecodable = [refusal for refusal in parameter.refusals if isinstance(refusal, Undecodable)]
            checked_registers = {refusal.register.name for refusal in undecodable}
            for write in parameter.writes:
                register = write.register.name
                is_checked = register in checked_registers or write.determines_limits
                if isinstance(write.value, AsNumber) and is_checked:
                    whole_register = WholeRegister(
                        code=self.register_code_by_name[register],
                        struct_local=c_name(f"{argument}_{register}_held", self._c_name_by_argument),
                        bytes_local=c_name(f"{argument}_{register}_sent", self._c_name_by_argument),
                        values=tuple(self._byte_value(write, bit_slice) for bit_slice in write.bit_slices),
                    )
                    yield (argument, register), whole_register

    # -- steps

    def _yield_rows(self) -> Iterator[StepRow | FilledRows]:
        """Yield the rows of the list of steps. A step on several bytes of a register has a row for each byte."""
        index = 0
        for step in self.procedure_plan.operations:
            note = note_of_step(self.context.device, step)
            if isinstance(step, (WaitTime, SendRequest)):
                yield StepRow(index=index, operation=step, note=note)
            else:
                yield from self._rows_of_register(index, step, note)
            index += _number_of_rows(step)

    def _rows_of_register(self, first_index: int, step: RegisterAccess, note: str) -> Iterator[StepRow | FilledRows]:
        """Yield the rows for the bytes of a register. Only the first row has the comment ``note``.

        If an argument fills the struct of the register, one ``FilledRows`` stands for all rows, unless the step reads
        back only some bits.

        Raises:
            TargetError: The bytes depend on the order code, or would be polled one after the other.
        """
        filled_register = self._filled_by(step)
        if filled_register is not None:
            if isinstance(step, VerifyWrite):
                yield from self._read_back(first_index, step, filled_register, note)
            else:
                yield FilledRows(first_index, kind="write", register=filled_register, note=note)
            return
        _refuse_unsupported(step)
        for index, bit_slice in enumerate(step.bit_slices):
            value = self._byte_value(step, bit_slice)
            note_of_row = note if index == 0 else ""
            yield self._build_row(step, bit_slice, value, index=first_index + index, note=note_of_row)

    def _build_row(
        self, step: RegisterAccess, bit_slice: BitSlice, value: CExpression, *, index: int, note: str
    ) -> StepRow:
        """Return the row for one byte of a register. ``value`` has the bits at their places in the byte."""
        return StepRow(
            index=index,
            operation=step,
            note=note,
            address=self._address(step.register, bit_slice.byte),
            mask=bit_slice.mask << bit_slice.low_in_byte,
            value=value,
            continues_previous=step.register.is_accessed_whole and bit_slice.byte > 0,
        )

    def _address(self, register: Register, byte: int) -> str:
        """Return the address of a byte of a register as C, such as ``ACME_X_REG_PRESET_ADDRESS + 1U``."""
        macro = f"{self.register_code_by_name[register.name].stem}_ADDRESS"
        distance = register.address_of(byte) - register.address
        return f"{macro} + {distance}U" if distance else macro

    def _read_back(
        self, first_index: int, step: VerifyWrite, filled_register: FilledRegister, note: str
    ) -> Iterator[StepRow | FilledRows]:
        """Yield the rows that read back a filled register: one ``FilledRows`` if all written bits must be the same.

        Otherwise, there is a row for each byte, which compares only some bits.
        """
        if step.bit_slices == step.write.bit_slices:
            yield FilledRows(first_index, kind="verify", register=filled_register, note=note)
            return
        for index, bit_slice in enumerate(step.bit_slices):
            written_byte = CName(f"{filled_register.bytes_local}[{bit_slice.byte}]")
            # A mask of 0 is a byte of reserved bits, which is read but not compared.
            expected = masked(written_byte, bit_slice.mask) if bit_slice.mask else ZERO
            note_of_row = note if index == 0 else ""
            yield self._build_row(step, bit_slice, expected, index=first_index + index, note=note_of_row)

    def _filled_by(self, step: RegisterAccess) -> FilledRegister | None:
        """Return the filled register that a step writes or reads back, or None if no argument fills its struct."""
        write = step.write if isinstance(step, VerifyWrite) else step
        if isinstance(write, WriteRegister) and isinstance(write.value, AsMember):
            return self._filled_registers.get((write.value.argument.name, write.register.name))
        return None

    def _byte_value(self, step: RegisterAccess, bit_slice: BitSlice) -> CExpression:
        """Return the value that a step writes to a byte, waits for, or reads back, or 0 for a step that only reads.

        It has the bits of ``bit_slice`` at their place in the byte. The other bits of the byte are 0.
        """
        if isinstance(step, ReadRegister) or not bit_slice.mask:
            return ZERO
        if isinstance(step, PollRegister):
            value: ValueSource = FixedNumber(step.step.value)
        else:
            value = step.write.value if isinstance(step, VerifyWrite) else step.value
        # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
        if isinstance(value, FixedNumber):
            bits_of_slice = (value.number >> bit_slice.low_in_number) & bit_slice.mask
            return CNumber(bits_of_slice << bit_slice.low_in_byte, hexadecimal=True)
        bits = shifted_right(CName(self._c_name_by_argument[value.argument.name]), bit_slice.low_in_number)
        if bit_slice.mask != 0xFF:
            return CCast("uint8_t", shifted_left(masked(bits, bit_slice.mask), bit_slice.low_in_byte))
        is_whole_byte = isinstance(value, AsNumber) and len(step.bit_slices) == 1
        return bits if is_whole_byte else CCast("uint8_t", bits)

    def _yield_read_members(self) -> Iterator[ReadMember]:
        """Yield a member of the struct with the bytes read for each register or field that the procedure reads.

        The name includes the field if not all bytes of the register are read. Repeated names are numbered.
        """
        used_names: set[str] = set()
        first_byte = 0
        for read in self.procedure_plan.reads:
            length = len(read.bit_slices)
            stem = read.register.name
            if length != read.register.length and read.field is not None:
                stem += f"_{read.field.name}"
            member_name = unused_name(c_name(stem), used_names)
            used_names.add(member_name)
            note = note_of_read(self.context.device, read)
            yield ReadMember(name=member_name, first_byte=first_byte, length=length, note=note)
            first_byte += length


def _refuse_unsupported(step: RegisterAccess) -> None:
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
    """Return True if a check rejects an argument outside limits that depend on the order code."""
    if not isinstance(refusal, OutsideArgumentLimits):
        return False
    return any(not bound.is_constant for _, bound in refusal.limits.bounds_to_check)


def _number_of_rows(step: PlannedStep) -> int:
    """Return the number of rows for a step: one for each byte of a register, and one for a wait or a request."""
    return 1 if isinstance(step, (WaitTime, SendRequest)) else len(step.bit_slices)


def _is_excluded_by_type(refusal: ArgumentRefusal) -> bool:
    """Return True if the type of the argument already excludes the value, as ``uint8_t`` does for an 8-bit field."""
    return isinstance(refusal, TooWide) and size_of(refusal.field.widest) == refusal.field.widest


def _place_text(step: RegisterAccess) -> str:
    """Return the register and field that a step accesses, such as ``status.error``."""
    return f"{step.register.name}.{step.field.name if step.field is not None else ''}"
