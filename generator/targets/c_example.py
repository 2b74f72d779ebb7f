"""A program for one interface of a device that compiles and runs on any host: worked examples of the manual, through a simulated bus."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .. import codec
from ..examples import example_variant
from ..model import Example, Field, Interface, Layout, Procedure, Register, Variant, cite
from .c_layout import LayoutSource
from .c_source import COLUMNS, ascii_text, c_name, code, described, number, string, title, words
from .c_views import AccessView, Line, ProcedureView

if TYPE_CHECKING:
    from .c_device import DeviceView


#: What the program and the README have beside what is named after a register: the function show_frame, and variables.
_TAKEN = frozenset(("bus", "encoder", "failure", "frame", "result"))
#: As many characters of explanation fit behind a number.
_FEW = 40


@dataclass(frozen=True)
class FrameView:
    """A frame as it comes from the bus, as a word or as bytes, and what it holds.

    ``usable`` is the expression that says whether its position is to be used, empty where nothing in the frame speaks of that; ``meaning`` are the
    statements that make something of the position.
    """

    title: str
    about: str
    layout: str
    struct: str
    carried_as: str
    word: str
    bytes: tuple[str, ...]
    request: str
    length: str
    shown: tuple[str, ...]
    meaning: tuple[str, ...]
    usable: str


@dataclass(frozen=True)
class ReadView:
    """A register that is read by its name and printed."""

    title: str
    name: str
    about: str
    access: AccessView
    printed: str
    shown: tuple[str, ...]


@dataclass(frozen=True)
class RunView:
    """A procedure that is carried out, with its arguments."""

    title: str
    about: str
    procedure: ProcedureView
    arguments: str


@dataclass(frozen=True)
class ExampleView:
    """The whole program; ``memory`` is what the simulated registers hold, from the address on."""

    name: str
    title: str
    interface: str
    code: str
    macro: str
    frame: FrameView
    reads: tuple[ReadView, ...]
    run: RunView | None
    memory: tuple[Line, ...]
    sends: bool
    has_registers: bool
    size: int


def examples(view: DeviceView) -> list[ExampleView]:
    """A program for each interface, but for one of whose frames no plain one can be made up."""
    found = []
    for interface in view.device.interfaces:
        if any(layout.sender == "encoder" for layout in interface.layouts):
            with suppress(codec.EncodeError):
                found.append(ExampleBuilder(view, interface).build())
    return found


class ExampleBuilder:
    def __init__(self, view: DeviceView, interface: Interface) -> None:
        self.view = view
        self.device = view.device
        self.interface = interface
        self.given = [item for item in self.device.examples if self._is_here(item)]
        self.variant = self._variant()
        self.mine = [item for item in self.given if example_variant(self.device, item) == self.variant]

    def build(self) -> ExampleView:
        row = self.view.codes[self.device.variants.index(self.variant)]
        chosen = self._procedure()
        run, written = (self._run(*chosen), self._written(chosen[0])) if chosen is not None else (None, frozenset())
        does = {step.do for step in chosen[0].steps} if chosen is not None else set()
        registers = self._registers()
        return ExampleView(
            name=f"{self.device.name}_{self.interface.kind}",
            title=self.device.title,
            interface=self.interface.title,
            code=row[2],
            macro=row[0],
            frame=self._frame(),
            reads=tuple(self._read(register, example) for register, example in registers),
            run=run,
            memory=tuple(self._memory(registers, written)),
            sends="send" in does,
            has_registers=bool(registers) or bool(does & {"write", "read", "poll"}),
            size=max(128, *(item.last_address + 1 for item in self.device.registers)) if self.device.registers else 128,
        )

    # -- which examples

    def _is_here(self, example: Example) -> bool:
        """Whether the manual shows it for an order code with this interface."""
        if example.refused or example.kind == "crc" or example_variant(self.device, example).interface != self.interface.kind:
            return False
        if example.kind == "register":
            register = self.device.register(example.register)
            return register.interface == self.interface.kind and register.readable
        return example.kind in ("measure", "procedure") or (example.kind == "frame" and example.sender == "encoder" and bool(example.layout))

    def _variant(self) -> Variant:
        """The order code with the most examples; without any, the one of the finest resolution."""
        counted = Counter(example_variant(self.device, item).code for item in self.given)
        variants = [item for item in self.device.variants if item.interface == self.interface.kind] or list(self.device.variants)
        return max(variants, key=lambda item: (counted[item.code], sum(item.parameters.values())))

    def _registers(self) -> list[tuple[Register, Example]]:
        found: dict[str, tuple[Register, Example]] = {}
        for item in self.mine:
            # The simulated registers have no banks.
            if item.kind == "register" and self.device.register(item.register).bank is None:
                found.setdefault(item.register, (self.device.register(item.register), item))
        return list(found.values())

    def _procedure(self) -> tuple[Procedure, Example | None] | None:
        """The worked procedure that writes most; without one, the first that clears an alarm by a request."""
        # The simulated encoder is never done, so that a poll would not end.
        worked = [item for item in self.mine if item.kind == "procedure" and all(step.do != "poll" for step in self.device.procedure(item.procedure).steps)]
        if worked:
            most = max(worked, key=lambda item: len(item.writes))
            return self.device.procedure(most.procedure), most
        clearing = [self.device.procedure(name) for alarm in self.device.alarms for name in alarm.cleared_by]
        sending = [item for item in clearing if item.interface == self.interface.kind and any(step.do == "send" for step in item.steps)]
        return (sending[0], None) if sending else None

    # -- the frame

    def _frame(self) -> FrameView:
        layout, wire, about = self._on_the_line()
        source = LayoutSource(self.view, layout, f"{self.view.prefix}_{layout.name}", "")
        data = codec.number_to_bytes(layout, wire, layout.place(self.variant.parameters).bits) if layout.carried_as == "bytes" else b""
        sent = next((item for item in self.interface.data_ids if data and item.control == data[0]), None)
        name = words(layout.name)
        return FrameView(
            title=name[0].upper() + name[1:],
            about=about,
            layout=layout.name,
            struct=f"{self.view.prefix}_{layout.name}",
            carried_as=layout.carried_as,
            word=f"UINT64_C(0x{wire:X})",
            bytes=tuple(number(byte, True) for byte in data),
            request=f"{self.view.PREFIX}_{self.interface.kind.upper()}_CONTROL_{sent.name.upper()}" if sent is not None else number(data[0], True) if data else "",
            length=f"{self.view.PREFIX}_{layout.name.upper()}_LENGTH",
            shown=tuple(shown(source, "frame")),
            meaning=tuple(self._meaning(layout, 8 if layout.spoiling_flags else 4)),
            usable=" && ".join(f"!frame->{c_name(field.name)}" for field in layout.spoiling_flags),
        )

    def _on_the_line(self) -> tuple[Layout, int, str]:
        """A worked frame, one of the manual before one of another source; without any, one that is made up."""
        worked = sorted((item for item in self.mine if item.kind == "frame"), key=lambda item: any(source.document for source in item.source))
        if worked:
            layout = self.device.layout(worked[0].layout)
            wire = int(worked[0].bits, 2) if worked[0].bits else codec.number_from_bytes(layout, worked[0].bytes)
            return layout, wire, f"a worked example [{cite(worked[0].source)}]"
        measurement = self.device.measurement_of(self.interface.kind)
        layouts = [item for item in self.interface.layouts if item.sender == "encoder"]
        measured = [item for item in layouts if measurement is not None and measurement.of in _members(item)]
        layout = (measured or layouts)[0]
        values = {field.name: _plain_value(layout, field) for field in layout.data_fields if field.kind != "digits"}
        placed = layout.place(self.variant.parameters)
        if measurement is not None and measured:
            counts, about = self._position()
            parts = {name for join in layout.joins if join.name == measurement.of for name in join.fields}
            # Where the position does not fit, the frame goes without it.
            with suppress(codec.EncodeError):
                return layout, codec.encode(self.device, placed, {**{name: value for name, value in values.items() if name not in parts}, measurement.of: counts}), about
        return layout, codec.encode(self.device, placed, values), "made up, since the manual shows none"

    def _position(self) -> tuple[int, str]:
        worked = next((item for item in self.mine if item.kind == "measure" and item.counts is not None), None)
        if worked is not None and worked.counts is not None:
            return worked.counts, f"made up, with the position of a worked example [{cite(worked.source)}]"
        measurement = self.device.measurement_of(self.interface.kind)
        if measurement is None or measurement.steps_per_turn is None:
            return 1000, "made up, since the manual shows none: 1000 counts"
        return measurement.steps_per_turn.value(self.variant.parameters) // 4, "made up, since the manual shows none: a quarter of a turn"

    def _meaning(self, layout: Layout, indent: int) -> Iterable[str]:
        """What the position is in degrees or millimetres."""
        measurement = self.device.measurement_of(self.interface.kind)
        if measurement is None or measurement.of not in _members(layout):
            return
        for function in self.view.meanings:
            unit = {"degrees": "degrees", "millimetres": "mm"}.get(function.name.rsplit("_", 1)[1], "")
            if unit and function.name.removesuffix(f"_{function.name.rsplit('_', 1)[1]}") in (self.view.prefix, f"{self.view.prefix}_{self.interface.kind}"):
                kind = function.arguments.split()[0]
                yield code(f'printf("  that is %.3f {unit}\\n", {function.name}(&encoder, ({kind})frame.{c_name(measurement.of)}));', indent)

    # -- registers and procedures

    def _read(self, register: Register, example: Example) -> ReadView:
        access = self.view.register_view(register).access
        heading = f"{ascii_text(title(register))} {register.address:02X}h"
        lines = tuple(shown(self.view.register_source(register).source, "held")) if access.struct else (code('printf("  value: %u\\n", (unsigned)held);', 4),)
        parts = (f"print_registers({string(heading)},", f"{access.stem}_ADDRESS,", f"{access.stem}_LENGTH);")
        printed = _lines(parts, 4)
        return ReadView(heading, c_name(register.name, _TAKEN), f"a worked example [{cite(example.source)}]", access, printed, lines)

    def _run(self, procedure: Procedure, example: Example | None) -> RunView:
        made = self.view.procedures[self.device.procedures.index(procedure)]
        values = [example.arguments[item.name] for item in procedure.arguments] if example is not None else []
        about = f"{procedure.title} [{cite(procedure.source)}]. It changes what the encoder holds."
        named = ", ".join(f"{item.name} {value}" for item, value in zip(procedure.arguments, values))
        return RunView(described(ascii_text(procedure.title), named), about, made, "".join(f"{number(value)}, " for value in values))

    def _written(self, procedure: Procedure) -> frozenset[str]:
        return frozenset(step.register for step in procedure.steps if step.do == "write")

    def _memory(self, registers: Sequence[tuple[Register, Example]], written: frozenset[str]) -> Iterable[Line]:
        """What the registers hold at first: the worked examples, and what is delivered where the procedure writes."""
        for register, example in sorted(registers, key=lambda item: item[0].address):
            data = register.default_bytes() or bytes(register.length) if register.name in written else example.bytes
            yield Line(f"[0x{register.address:02X}] = {', '.join(number(byte, True) for byte in data)}", title(register) + (", as delivered" if register.name in written else ""))


def shown(source: LayoutSource, struct: str) -> Iterable[str]:
    """Statements that print the members of a struct, as they stand in a function."""
    for field in source.member_fields:
        member = f"{struct}.{c_name(field.name)}"
        if field.kind == "text":
            yield code(f'printf("  {field.name}: %.*s\\n", (int)sizeof({member}), {member});', 4)
        elif field.kind == "flag":
            yield code(f'printf("  {field.name}: %s\\n", {member} ? "yes" : "no");', 4)
        else:
            yield _number(field.name, member, field.signed, _known(field))
        for run in field.digits:
            yield _number(run.name, f"{struct}.{c_name(run.name)}", False)
    for join in source.layout.joins:
        yield _number(join.name, f"{struct}.{c_name(join.name)}", False)


def _number(name: str, member: str, signed: bool, known: str = "") -> str:
    value = f"({'' if signed else 'unsigned '}long long){member}"
    form = "%lld" if signed else "%llu"
    if known:
        return _lines((f'printf("  {name}: {form} (%s)\\n",', f"{value},", f"{string(known)});"), 4)
    return code(f'printf("  {name}: {form}\\n", {value});', 4)


def _known(field: Field) -> str:
    """What the values of a choice mean, where they are few."""
    values = ", ".join(f"{item.value} {ascii_text(title(item))}" for item in field.values)
    return values if field.kind == "choice" and len(values) <= _FEW else ""


def _lines(parts: Sequence[str], indent: int) -> str:
    """A call with its arguments on one line, or each on a line where they are too long."""
    margin, whole = " " * indent, " ".join(parts)
    return margin + whole if indent + len(whole) <= COLUMNS else f"\n{margin}    ".join((margin + parts[0], *parts[1:]))


def _members(layout: Layout) -> set[str]:
    return {field.name for field in layout.data_fields} | {join.name for join in layout.joins}


def _plain_value(layout: Layout, field: Field) -> int | str:
    """A value that the field can have, the plainest."""
    if field.name == layout.selector:
        return layout.selects[0]
    if field.kind == "choice":
        return field.values[0].value
    if field.kind == "text":
        return "-" * (field.widest // 8)
    return 1 if field.zero_means or field.power_of_two else 0
