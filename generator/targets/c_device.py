"""Everything that the template of a device prints."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from ..model import Alarm, Crc, Device, Field, Input, Interface, Manufacturer, Parameter, Register, Timing, Value, Variant, cite
from ..words import sentence
from .c_access import state_registers
from .c_crc import crc_view
from .c_identity import identities
from .c_interface import InterfaceSource
from .c_meaning import meanings
from .c_names import Names
from .c_order_codes import OpenCode, open_codes, unknown_parts
from .c_procedure import ProcedureSource
from .c_register import RegisterSource
from .c_run_time import held_in, takers
from .c_source import Paragraph, Scope, bracketed, c_name, described, errata_at, errata_text, needs_variant, number, printed, string, title, unbracketed, unsigned, words
from .c_views import AlarmView, Choice, CrcView, Function, Line, RegisterView


_Built = TypeVar("_Built")


class DeviceView:
    """One device. Names are given out in the order in which things are built, so that the order here is fixed."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.maker: Manufacturer = device.manufacturer
        self.prefix = f"{device.manufacturer.name}_{device.name}"
        self.PREFIX = self.prefix.upper()
        self.scope = Scope(self.maker.name, self.prefix, frozenset(item.name for item in device.set_parameters))
        self.names = Names()
        for name in ("variant", "order_code", "order_codes", "find_order_code", "H"):
            self.unique(f"{self.PREFIX if name == 'H' else self.prefix}_{name}")
        self.parameters: Sequence[Parameter] = device.set_parameters
        self.members = [Line(f"{self.member_type(item)} {c_name(item.name)};", self._meaning(item)) for item in device.set_parameters]
        self.members = self.members or [Line("uint8_t no_parameter;", "all order codes are alike")]
        self.derived = [self._of(lambda: self._derived(item), "parameters", item.name) for item in self._in_order_of_use()]
        self.codes = self._of(lambda: [self._code(variant) for variant in device.variants], "order_code")
        self.unlisted = self._of(self._unlisted, "order_code", "parts")
        patterns = open_codes(device)
        self.open_codes = [self._open_code(item) for item in patterns]
        self.refused_codes = any(item.code is None for item in patterns)
        self.choices: dict[tuple[str, str], Choice] = {}
        self._shared_choices: dict[str, tuple[tuple[Value, ...], Choice]] = {}
        self._interface_choices: dict[str, list[Choice]] = {}
        self._register_choices: dict[str, list[Choice]] = {}
        self._collect_choices()
        self._crc_names: dict[tuple[str, str], str] = {}
        self.crcs = [view for crc in device.crcs for view in self._of(lambda: tuple(self._crc_views(crc)), "crcs", crc.name)]
        self.interfaces = [self._of(InterfaceSource(self, item).build, "interfaces", item.kind) for item in device.interfaces]
        self._register_sources = {item.name: RegisterSource(self, item) for item in device.registers}
        self.meanings = list(meanings(self))
        self.registers = [self._register(name, item) for name, item in self._register_sources.items()]
        self.takers = list(takers(self))
        self.read_state = self.unique(f"{self.prefix}_read_state") if state_registers(self) else ""
        self.identities = identities(self)
        self.procedures = [self._of(ProcedureSource(self, item).build, "procedures", item.name) for item in device.procedures]
        self.inputs = [self._input(item) for item in device.inputs]
        self.alarms = [self._of(lambda: self._alarm(item), "alarms", item.name) for item in device.alarms]
        self.timings = [line for item in device.timings for line in self._of(lambda: tuple(self.timing(item, self.PREFIX)), "timings", item.name)]
        self.order_about = self._order_about()

    @property
    def manual(self) -> str:
        manual = self.device.manual
        editions = ", ".join(f"{item.language} {item.revision}" for item in manual.editions)
        dated = f" of {manual.date}" if manual.date else ""
        return f'"{manual.title}", revision {manual.revision}{dated} ({manual.language}' + (f"; read beside it: {editions})" if editions else ")")

    @property
    def documents(self) -> list[Paragraph]:
        return [(f"  {item.key}: ", f"{item.title}{' - ' + item.url if item.url else ''}") for item in self.device.documents]

    # -- names and macros

    def unique(self, name: str) -> str:
        """``name``, which nothing else at file scope may have: the rule ``c-name`` tells where something does."""
        return self.names.give(name)

    def _of(self, build: Callable[[], _Built], *path: str) -> _Built:
        """What ``build`` makes; the names that it gives out are those of this part of the spec."""
        with self.names.of(*path):
            return build()

    def _register(self, name: str, source: RegisterSource) -> RegisterView:
        with self.names.of("registers", name):
            view = source.build()
            self.names.give_limits(view)
        return view

    def macro(self, name: str, value: str, note: str = "") -> Line:
        return Line(f"#define {self.unique(name)} {value}", note)

    def timing(self, timing: Timing, upper: str) -> Iterable[Line]:
        for bound in ("at_least", "typical", "at_most"):
            value = getattr(timing, f"{bound}_us")
            if value is not None:
                note = described(timing.symbol, timing.meaning) + f" [{cite(timing.source)}]"
                yield self.macro(f"{upper}_{timing.name.upper()}_{bound.upper()}_US", number(value), note)

    def register_source(self, register: Register) -> RegisterSource:
        return self._register_sources[register.name]

    def register_view(self, register: Register) -> RegisterView:
        return self.registers[self.device.registers.index(register)]

    # -- parameters and order codes

    def _in_order_of_use(self) -> list[Parameter]:
        """The parameters that follow from others, each after those that it needs."""
        left = [item for item in self.device.parameters if item.equals is not None]
        known = set(self.scope.set_names)
        ordered: list[Parameter] = []
        while left:
            item = next((item for item in left if item.equals is not None and known.issuperset(item.equals.parameters)), left[0])
            left.remove(item)
            known.add(item.name)
            ordered.append(item)
        return ordered

    @staticmethod
    def member_type(item: Parameter) -> str:
        return unsigned(max(item.largest, item.max or 0).bit_length())

    def _meaning(self, item: Parameter) -> str:
        held = held_in(self, item)
        return item.meaning + (f" [{item.unit}]" if item.unit else "") + (f"; {held}" if held else "")

    def _derived(self, item: Parameter) -> Function:
        assert item.equals is not None
        kind = unsigned(max(item.largest.bit_length(), 32))
        text = self.scope.text(item.equals)
        if kind == "uint32_t" and any(term.is_power for term in item.equals.terms):
            text = f"({kind}){bracketed(text)}"
        return Function(self.unique(f"{self.prefix}_{item.name}"), kind, "", (f"return {unbracketed(text)};",), self._meaning(item), needs_variant(text))

    def _code(self, variant: Variant) -> tuple[str, str, str, str]:
        """Macro, initialiser, text and interface of an order code."""
        family = self.device.name.upper()
        stem = variant.code.upper()
        if all(item.code.upper().startswith(family) for item in self.device.variants):
            stem = stem.removeprefix(family)
        macro = self.unique(f"{self.PREFIX}_{re.sub('[^A-Z0-9]+', '_', stem).strip('_')}")
        values = ", ".join(self._value_of(item, variant) for item in self.parameters) or "0U"
        return macro, f"{{ {values} }}", variant.code, f"{self.maker.name.upper()}_INTERFACE_{variant.interface.upper() or 'NONE'}"

    @staticmethod
    def _value_of(item: Parameter, variant: Variant) -> str:
        """A parameter in an initialiser: a code, which has no unit and takes more than a byte, as the manuals print it."""
        return number(variant.parameters.get(item.name, 0), hexadecimal=not item.unit and item.largest > 0xFF, digits=4)

    def _unlisted(self) -> list[Line]:
        """A bit for each part of the order code that the manual leaves open."""
        known = [part for part in self.device.order_code.parts if part.open and part.name not in unknown_parts(self.device)]
        return [self.macro(f"{self.PREFIX}_UNLISTED_{part.name.upper()}", number(1 << index, True)) for index, part in enumerate(known)]

    def _open_code(self, item: OpenCode) -> str:
        """A line of the table of order codes with open parts."""
        code = f"{self.maker.name.upper()}_NO_CODE" if item.code is None else number(item.code)
        bits = " | ".join(f"{self.PREFIX}_UNLISTED_{name.upper()}" for name in item.unlisted) or "0U"
        return f"{{ {string(item.pattern)}, {code}, {bits} }}"

    def _order_about(self) -> list[Paragraph]:
        code = self.device.order_code
        about: list[Paragraph] = [f"Order codes: {code.pattern} [{cite(code.source)}]"]
        for part in code.parts:
            values = "; ".join(f"{value.text}" + (f" = {value.meaning}" if value.meaning else "") for value in part.values)
            about.append((f"  {part.name}: ", f"{part.meaning}: {values}"))
        for spelling in code.also_written:
            about.append(("  also written: ", f"{spelling.pattern}, as in {spelling.where} [{cite(spelling.source)}]"))
        about += [sentence(code.note), sentence(code.special)]
        if unknown_parts(self.device):
            about.append(f"Known here only as listed: {', '.join(unknown_parts(self.device))}.")
        return about + self.errata("order_code", "parameters")

    def errata(self, *paths: str) -> list[Paragraph]:
        """The errata of these parts of the spec, each once."""
        return list(dict.fromkeys(errata_text(item) for path in paths for item in errata_at(self.device, path)))

    # -- enumerations

    def choices_of_interface(self, interface: Interface) -> tuple[Choice, ...]:
        return tuple(self._interface_choices.get(interface.kind, ()))

    def choices_of_register(self, register: Register) -> tuple[Choice, ...]:
        return tuple(self._register_choices.get(register.name, ()))

    def _collect_choices(self) -> None:
        for interface, layout in self.device.layouts():
            for field in layout.fields:
                if field.kind == "choice":
                    with self.names.of("interfaces", interface.kind, "layouts", layout.name):
                        self._add_choice(layout.name, field, self._interface_choices.setdefault(interface.kind, []), layout.name)
        for register in self.device.registers:
            for field in register.layout.fields:
                if field.kind == "choice":
                    known = self._register_choices.setdefault(register.name, [])
                    sole = title(register) if len(register.layout.fields) == 1 else ""
                    with self.names.of("registers", register.name):
                        self._add_choice(f"reg_{register.name}", field, known, register.name, sole)

    def _add_choice(self, owner: str, field: Field, group: list[Choice], about: str, sole: str = "") -> None:
        """The enumeration of a field; fields of one name and the same values share theirs."""
        known = self._shared_choices.get(field.name)
        if known is not None and known[0] == field.values and not sole:
            self.choices[owner, field.name] = known[1]
            return
        base = f"{self.prefix}_{about}" if sole else f"{self.prefix}_{field.name}" if known is None else f"{self.prefix}_{about}_{field.name}"
        type_name = self.unique(base)
        is_enum = max((item.value for item in field.values), default=0) <= 0x7FFF
        names, entries = {}, []
        for item in field.values:
            entry = self.unique(f"{base.upper()}_{item.name.upper()}")
            names[item.value] = entry
            width = (field.widest + 3) // 4
            entries.append(Line(f"{entry} = 0x{item.value:0{width}X}" if is_enum else f"#define {entry} {number(item.value, True)}", self._value_note(item)))
        if is_enum and entries:
            entries = [*(Line(item.code + ",", item.note) for item in entries[:-1]), entries[-1]]
        choice = Choice(type_name, (f"Values of {sole}." if sole else "") or described(printed(field), field.meaning) or title(field), tuple(entries), names, is_enum)
        if known is None and not sole:
            self._shared_choices[field.name] = (field.values, choice)
        self.choices[owner, field.name] = choice
        group.append(choice)

    @staticmethod
    def _value_note(item: Value) -> str:
        # One word that the name of the constant has already is not said again; several are, for those who look for them.
        said = printed(item).lower() == item.name
        note = described("" if said else printed(item), item.meaning)
        return f"{note} [{cite(item.source)}]" if item.source and note else note

    # -- CRCs

    def _crc_views(self, crc: Crc) -> Iterable[CrcView]:
        uses = {layout.carried_as for _, layout in self.device.layouts() if any(field.crc == crc.name for field in layout.fields)}
        uses |= {register.layout.carried_as for register in self.device.registers if any(field.crc == crc.name for field in register.layout.fields)}
        if not uses:
            # No whole frame says how it is carried. Reflected input means something for bytes only.
            uses = {"bytes" if crc.refin else "bits"}
        for use in sorted(uses, reverse=True):
            style = ("fold" if crc.form == "fold" and crc.width <= 32 else "bits") if use == "bits" else ("xor" if crc.form == "xor" else "bytes")
            name = self.unique(f"{self.prefix}_crc_{crc.name}" + ("_bits" if use == "bits" and len(uses) > 1 else ""))
            self._crc_names[crc.name, use] = name
            view = crc_view(self.device, crc, style, name)
            if view.table:
                self.unique(f"{name}_entry")
            yield view

    def crc_name(self, crc: Crc, use: str) -> str:
        return self._crc_names[crc.name, use]

    # -- inputs and alarms

    def _input(self, item: Input) -> list[Paragraph]:
        """A hardware input, in words: nothing in the frames or registers tells its level."""
        about: list[Paragraph] = [f"{described(title(item), item.meaning)} [{cite(item.source)}]"]
        about += [("  low: ", sentence(item.low)), ("  high: ", sentence(item.high))]
        if item.pulse_at_least_us is not None:
            about.append(("  pulse: ", f"{item.pulse_at_least_us} us at least."))
        about += [("  inverts: ", sentence(item.inverts)), ("  subject to: ", sentence(item.needs))]
        about += [("  unused: ", sentence(f"connect it to {item.when_unused}") if item.when_unused else "")]
        about += [sentence(item.note)]
        return about + [errata_text(erratum) for erratum in errata_at(self.device, f"inputs.{item.name}")]

    def _alarm(self, alarm: Alarm) -> AlarmView:
        stem = f"{self.PREFIX}_ALARM_{alarm.name.upper()}"
        macros = []
        field = next((field for _, layout in self.device.layouts() for field in layout.fields if field.group == alarm.group and field.name == alarm.field and field.pieces), None)
        if alarm.group and field is not None and len(field.pieces) == 1:
            piece = field.pieces[0]
            macros.append(self.macro(f"{stem}_MASK", number(piece.mask << piece.right, True), self._place_of_alarm(alarm.group)))
        elif alarm.register:
            register = self.device.register(alarm.register)
            item = register.layout.field(alarm.field) if alarm.field else register.layout.fields[0]
            # A flag that moves with the order code has no mask of its own; the register's codec finds it.
            if item.low.is_constant and item.width.is_constant:
                bits = ((1 << item.widest) - 1) << item.low.constant
                macros.append(self.macro(f"{stem}_MASK", number(bits, True), f"in {title(register)}, {register.address:02X}h"))
        if alarm.below_mv is not None:
            macros.append(self.macro(f"{stem}_BELOW_MV", number(alarm.below_mv), "threshold in millivolts"))
        latch = "" if alarm.latch is None else "Stays until it is reset (latch)." if alarm.latch else "Goes when its cause goes (no latch)."
        cleared = ", ".join(alarm.cleared_by)
        about: list[Paragraph] = [
            f"{described(title(alarm), alarm.meaning)} [{cite(alarm.source)}]",
            " ".join(part for part in (f"Detected: {sentence(alarm.detected)}" if alarm.detected else "", latch, "" if alarm.implemented or alarm.meaning.lower() == "not implemented" else "Not implemented in this encoder.") if part),
            f"Remedy: {sentence(alarm.remedy)}" if alarm.remedy else "",
            f"Procedures that clear it: {cleared}." if cleared else "",
        ]
        about += [errata_text(item) for item in errata_at(self.device, f"alarms.{alarm.name}")]
        return AlarmView(tuple(about), tuple(macros))

    def _place_of_alarm(self, name: str) -> str:
        """Where the bits of a group of fields are, by the manual's own name for it."""
        group = next(item for item in self.device.field_groups if item.name == name)
        where = f"in {'' if group.bits <= 8 else 'its byte of '}the {words(name)}"
        return f"{where}, {printed(group)}" if printed(group) else where
