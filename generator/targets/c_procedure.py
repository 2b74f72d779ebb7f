"""A procedure in C: a constant list of steps, or a function that writes the list for given arguments."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from .. import codec
from ..model import Field, Procedure, Register, Step, cite
from ..words import sentence
from . import TargetError
from .c_source import Paragraph, c_name, described, errata_at, errata_text, mask, needs_variant, number, size_of, title, unsigned, words
from .c_views import ArgumentView, Check, CodecView, Line, ProcedureView, StepGroup

if TYPE_CHECKING:
    from .c_device import DeviceView

#: What the generated functions call their own arguments and locals.
_TAKEN = frozenset(("variant", "steps", "capacity", "count", "index", "result", "address", "transport", "out", "failure", "bytes"))


class ProcedureSource:
    def __init__(self, view: DeviceView, procedure: Procedure) -> None:
        self.view = view
        self.device = view.device
        self.maker = view.maker.name
        self.procedure = procedure
        self.names = {item.name: c_name(item.name, _TAKEN) for item in procedure.arguments}
        self.types: dict[str, str] = {}
        self.rows: list[Line] = []
        self.groups: list[StepGroup] = []
        self.filled: dict[str, ArgumentView] = {}
        self.checks: list[Check] = []
        #: What is read, in order: the member that takes it, how many bytes, what it is.
        self.reads: list[tuple[str, int, str]] = []
        #: Whether a step writes some bits of a byte, so that the byte is read first.
        self.reads_to_write = False

    def build(self) -> ProcedureView:
        name = f"{self.view.prefix}_{self.procedure.name}_steps"
        for step in self.procedure.steps:
            if step.do == "write" and step.value is None:
                self._write_argument(step)
                continue
            rows = list(self._step_rows(step))
            for call, initialiser, note in rows:
                self._add(call, note, f"{{ {initialiser} }}")
            if step.do == "read":
                self._add_read(step, len(rows))
            elif step.do == "write" and step.field:
                self.reads_to_write |= any(bits != 0xFF for _, bits, _ in self._step_bytes(self.device.register(step.register), step))
        return ProcedureView(
            name=self.view.unique(name),
            about=tuple(self._about()),
            count_macro=self.view.unique(f"{name}_count".upper()),
            count=len(self.rows),
            rows=tuple(self.rows),
            parameters=tuple((self.types.get(item.name, "uint64_t"), self.names[item.name]) for item in self.procedure.arguments),
            filled=tuple(self.filled.values()),
            checks=tuple(dict.fromkeys(self.checks)),
            groups=tuple(self.groups),
            has_loop=bool(self.filled),
            needs_variant=bool(self.filled) or needs_variant(self.checks),
            run=self.view.unique(f"{self.view.prefix}_{self.procedure.name}"),
            run_about=tuple(self._run_about()),
            read_type=self.view.unique(f"{self.view.prefix}_{self.procedure.name}_read") if self.reads else "",
            read_members=tuple(Line(f"uint8_t {name}[{length}];", note) for name, length, note in self.reads),
            read_bytes=sum(length for _, length, _ in self.reads),
            read_fills=tuple(self._read_fills()),
        )

    # -- carrying it out

    def _run_about(self) -> Iterable[Paragraph]:
        procedure = self.procedure
        *calls, last = self._calls()
        needed = f"{', '.join(calls)} and {last}" if calls else last
        yield f"Carries it out over {self.device.interface(procedure.interface).title}; the transport needs {needed}."
        written = {(step.register, step.field) for step in procedure.steps if step.do == "write"}
        if self.view.read_state and any({(item.register, ""), (item.register, item.field)} & written for item in self.device.run_time_parameters):
            yield f"The frames depend on what it writes: {self.view.read_state}() makes the variant follow."

    def _calls(self) -> list[str]:
        """The functions of a transport that the steps call."""
        does = {step.do for step in self.procedure.steps}
        uses = {
            "read_registers": bool(does & {"read", "poll"}) or self.reads_to_write,
            "write_registers": "write" in does,
            "wait_us": bool(does & {"wait", "poll"}) or any(step.do == "send" and step.microseconds for step in self.procedure.steps),
            "send_request": "send" in does,
        }
        return [name for name, used in uses.items() if used]

    def _read_fills(self) -> Iterable[str]:
        """Assignments from the bytes as they were read, one after the other."""
        places = [f"{name}[{index}]" for name, length, _ in self.reads for index in range(length)]
        yield from (f"out->{place} = bytes[{index}];" for index, place in enumerate(places))

    def _about(self) -> Iterable[Paragraph]:
        procedure = self.procedure
        yield f"{procedure.title} [{cite(procedure.source)}]."
        yield ("Before: ", sentence(procedure.precondition))
        yield from ((f"{self.names[item.name]}: ", sentence(item.meaning)) for item in procedure.arguments)
        yield ("Result: ", sentence(procedure.result))
        yield sentence(procedure.note)
        yield from (errata_text(item) for item in errata_at(self.device, f"procedures.{procedure.name}"))

    def _add_read(self, step: Step, length: int) -> None:
        register = self.device.register(step.register)
        taken = {name for name, _, _ in self.reads}
        base = c_name(register.name) if length == register.length else c_name(f"{register.name}_{step.field}")
        name = next(name for name in (base, *(f"{base}_{number}" for number in range(2, len(taken) + 3))) if name not in taken)
        what = f"{title(register)}, {title(register.layout.field(step.field))}" if step.field else title(register)
        self.reads.append((name, length, described(what, step.meaning)))

    def _add(self, call: str, note: str = "", initialiser: str = "") -> None:
        self.groups.append(StepGroup(f"steps[{len(self.rows)}] = {self.maker}_step_{call};", note))
        self.rows.append(Line(initialiser, note))

    # -- steps that write an argument

    def _write_argument(self, step: Step) -> None:
        register = self.device.register(step.register)
        source = self.view.register_source(register)
        codec_view = self.view.register_view(register).codec
        argument = next(item for item in self.procedure.arguments if item.name == step.value_name)
        meaning = next((item for item in register.meanings if item.name == argument.meant_as), None)
        if meaning is not None:
            self.checks += source.limits(meaning).checks(self.names[argument.name])
        if step.field or codec_view is None:
            self._write_field(step, register, register.layout.field(step.field) if step.field else register.layout.fields[0])
        elif not source.limited_member:
            self._write_whole(step, register)
        else:
            self._write_member(step, register, source.limited_member, codec_view)

    def _write_field(self, step: Step, register: Register, field: Field) -> None:
        """The argument is one field of the register."""
        name = self.names[step.value_name]
        self.reads_to_write |= any(piece.mask << piece.right != 0xFF for piece in field.pieces)
        self.types.setdefault(step.value_name, unsigned(field.widest))
        self.checks += self._field_checks(register, field, name)
        for index, piece in enumerate(field.pieces):
            value = f"({name} >> {piece.left}U)" if piece.left else name
            value = f"(({value} & {number(piece.mask, True)}) << {piece.right}U)" if piece.right or piece.mask != 0xFF else value
            self._add(f"write({number(register.address + piece.byte, True)}, {number(piece.mask << piece.right, True)}, (uint8_t){value})", step.meaning if index == 0 else "")

    def _field_checks(self, register: Register, field: Field, name: str) -> Iterable[Check]:
        if not field.pieces:
            raise TargetError(f"'{register.name}.{field.name}' moves with the order code; the C target cannot write it alone")
        if size_of(field.widest) != field.widest:
            yield Check(f"{name} > {mask(field.widest)}", "RANGE")
        if register.limits_of in (field.name, register.name) and len(register.layout.fields) == 1:
            yield from self.view.register_view(register).limits.checks(name)
        if field.kind == "choice":
            known = self.view.choices["reg_" + register.name, field.name].names
            yield Check(" && ".join(f"({name} != {entry})" for entry in known.values()), "RANGE")

    def _write_whole(self, step: Step, register: Register) -> None:
        """The argument is the register's number."""
        name = self.names[step.value_name]
        self.types.setdefault(step.value_name, unsigned(8 * register.length))
        self.checks += self.view.register_view(register).limits.checks(name)
        for index in range(register.length):
            place = 8 * (index if register.byte_order == "low_byte_first" else register.length - 1 - index)
            value = f"(uint8_t)({name} >> {place}U)" if place else name if register.length == 1 else f"(uint8_t){name}"
            self._add(f"write({number(register.address + index, True)}, 0xFFU, {value})", step.meaning if index == 0 else "")

    def _write_member(self, step: Step, register: Register, member: str, codec_view: CodecView) -> None:
        """The argument is a member of the register's struct, or one that sets others."""
        argument = step.value_name
        name = self.names[argument]
        self.types.setdefault(argument, self.view.register_source(register).source.type_of(member))
        if argument not in self.filled:
            value, data = (c_name(f"{argument}_{what}", self.names) for what in ("register", "bytes"))
            setter = next((setter.name for setter in codec_view.setters if setter.member == c_name(member)), "")
            setting = f"result = {setter}(variant, {name}, &{value});" if setter else f"{value}.{c_name(member)} = {name};"
            self.filled[argument] = ArgumentView(codec_view, value, data, setting)
        self.groups.append(StepGroup("", step.meaning, f"{self.view.PREFIX}_REG_{register.name.upper()}_ADDRESS", len(self.rows), self.filled[argument].bytes))
        self.rows += [Line("")] * register.length

    # -- steps that are the same every time

    def _step_rows(self, step: Step) -> Iterable[tuple[str, str, str]]:
        """For each elementary step: the call that makes it, its initialiser, and what it is for."""
        kind = f"{self.maker.upper()}_STEP_"
        if step.do == "wait":
            time = number(step.microseconds)
            yield f"wait({time})", f"{kind}WAIT, 0U, 0U, 0U, 0U, {time}", step.meaning or f"wait {step.microseconds} us at least"
            return
        if step.do == "send":
            byte, time = number(step.request[0] if step.request else 0, True), number(step.microseconds)
            about = "; ".join(filter(None, (f"data ID {words(step.data_id)}", step.meaning)))
            yield f"send({byte}, {step.times}U, {time})", f"{kind}SEND, 0U, 0xFFU, {byte}, {step.times}U, {time}", about
            return
        register = self.device.register(step.register)
        looked_at = title(register.layout.field(step.field)) if step.field else ""
        if step.do == "write":
            where = ", ".join(filter(None, (title(register), looked_at)))
            about = step.meaning or described(where, words(step.value_name))
        else:
            about = described(looked_at, step.meaning) or title(register)
        for index, (offset, bits, value) in enumerate(self._step_bytes(register, step)):
            note = about if index == 0 else ""
            address = number(register.address + offset, True)
            values = f"{address}, {number(bits, True)}, {number(value, True)}"
            if step.do == "read":
                yield f"read({address})", f"{kind}READ, {address}, 0xFFU, 0U, 1U, 0U", note
            else:
                yield f"{step.do}({values})", f"{kind}{step.do.upper()}, {values}, 1U, 0U", note

    def _step_bytes(self, register: Register, step: Step) -> Iterable[tuple[int, int, int]]:
        """The bytes of a register that a step touches: offset, the bits concerned, their value."""
        if step.field:
            field = register.layout.field(step.field)
            if not field.pieces:
                raise TargetError(f"'{register.name}.{field.name}' moves with the order code; the C target cannot reach it alone")
            for piece in field.pieces:
                yield piece.byte, piece.mask << piece.right, ((step.value or 0) >> piece.left & piece.mask) << piece.right
            return
        data = codec.number_to_bytes(register.layout, step.value or 0, 8 * register.length)
        yield from ((index, 0xFF, value) for index, value in enumerate(data))
