"""A device module: names for everything in it, and every part of it as the template prints it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from .. import codec
from ..expressions import Expression
from ..model import (
    Crc, Device, Erratum, Field, Interface, Layout, Measurement, Procedure, Register, Sources, Step, Timing, Value, Variant, cite,
)
from ..render import plain
from .python_layout import CLASS_NAMES, LOCAL_NAMES, CodecBuilder, among, from_pieces, moved_left, number_text
from .python_source import (
    WIDTH, Block, Call, Code, Hex, Literal, Names, attribute, bare, call, camel, docstring, expression, grouped, literal, operand, quoted, record,
    sentence, used_names,
)
from .python_views import Branch, Codec, CrcFunction, Dispatch, Enumeration, Fold, Function, Section, Shown

#: What the package's modules are called that hold no device.
SHARED = ("_codec", "_facts", "_order_codes")

#: Names that every device module uses for itself, besides what it imports.
_MODULE = (
    "ALARMS", "Address", "ArithmeticError", "BISS", "CHARACTERISTICS", "CONNECTORS", "CRCS", "DOCUMENTS", "ERRATA", "Ellipsis", "Exception",
    "FAMILY", "Final", "Frame", "INPUTS", "IntEnum", "LEDS", "MANUAL", "Mapping", "MappingProxyType", "NamedTuple", "NotImplemented",
    "ORDER_CODE", "REGISTERS", "RS485", "Reply", "Request", "SSI", "TABLES", "TIMINGS", "TypeAlias", "Union", "VARIANTS", "ValueError", "Variant",
    "Warning", "Write", "annotations", "dataclasses", "decode_reply", "decode_request", "lookup",
)

#: What a device module imports from its neighbours, where it needs it.
_IMPORTS = (
    (
        "._codec",
        (
            "BitField", "ConstantError", "CrcError", "Interface", "LengthError", "Modify", "Poll", "RangeError", "Read", "Send", "Step", "Wait",
            "as_bytes", "as_number", "check_interface", "check_limits", "check_power_of_two", "check_signed", "check_width", "choice", "crc_by_xor",
            "crc_of_bits", "crc_of_bytes", "from_gray", "signed", "text_number", "to_gray", "writes", "zero_for",
        ),
    ),
    (
        "._facts",
        (
            "Alarm", "BissFacts", "CableLength", "Characteristic", "Clock", "Connector", "Contact", "ControlField", "Crc", "DataIdFacts", "Document",
            "Edition", "Erratum", "Family", "Input", "Led", "LedState", "Manual", "MemoryAccess", "NamedValue", "Network", "Port", "Register",
            "RegisterMeaning", "Revision", "Rs485Facts", "SsiFacts", "Table", "Timeout", "Timing",
        ),
    ),
    ("._order_codes", ("OrderCode", "Part", "PartValue")),
)

#: Names that the class of the variants uses for itself.
_VARIANT = ("bytes", "cls", "code", "decode", "interface", "degrees", "micrometres", "parts", "self", "special", "tail", "turns", "unlisted")

#: Tables that every module has, even empty.
_ALWAYS = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


@dataclass
class Module:
    """Everything that the template of a device module prints."""

    device: Device
    taken: Names = field(default_factory=lambda: Names([*_MODULE, *(name for _, names in _IMPORTS for name in names)]))

    def __post_init__(self) -> None:
        device = self.device
        self.name = attribute(device.name, SHARED)
        self.parameter_names = {item.name: attribute(item.name, _VARIANT) for item in device.parameters}
        self.crc_names = {item.name: self.taken.take(f"crc_{item.name}", "_") for item in device.crcs}
        self.classes: dict[str, str] = {}
        for _, layout in device.layouts():
            self.classes[f"layout {layout.name}"] = self.taken.take(camel(layout.name), "Frame")
        for register in device.registers:
            self.classes[f"register {register.name}"] = self.taken.take(camel(register.name), "Register")
        self._enum_names: dict[tuple[str, tuple[tuple[str, int], ...]], str] = {}
        self.enums: list[Enumeration] = []
        self.folds: list[Fold] = []
        self._fold_names: dict[tuple[str, int], str] = {}
        self.functions_taken = {item.name: self.taken.take(attribute(item.name), "_steps") for item in device.procedures}
        self.sections = tuple(self._section(item) for item in device.interfaces)
        self.registers = tuple(self._register_view(item) for item in device.registers)
        self.procedures = tuple(self._procedure(item) for item in device.procedures)
        self.crcs = tuple(function for item in device.crcs for function in self._crc_functions(item))

    # ------------------------------------------------------------------------------------------------- the module as a whole

    @property
    def title(self) -> str:
        return plain(self.device.title)

    @property
    def doc(self) -> str:
        manual = self.device.manual
        revision = f"revision {manual.revision}" + (f" of {manual.date}" if manual.date else "") + f" ({manual.language})"
        return docstring(
            sentence(f"{self.device.title}, by {self.device.manufacturer.title}"),
            f"Made from the manual “{plain(manual.title)}”, {plain(revision)}. Sections and pages in this module are those of that manual; a source that "
            "begins with a language code is another edition, one that begins with another key stands in DOCUMENTS.",
            "Start with lookup(), which knows every order code. Names are those of the manual; one that Python needs for itself ends in an underscore.",
            " ".join(self.device.manufacturer.trademarks),
        )

    def errata(self, path: str) -> list[Erratum]:
        """The errata of exactly this path and of what lies below it."""
        return [item for item in self.device.errata if any(other == path or other.startswith(f"{path}.") for other in item.affects)]

    def erratum_paragraphs(self, errata: Iterable[Erratum]) -> list[str]:
        found = []
        for item in errata:
            found.append(f"Erratum {item.name}, {item.status} ({cite(item.source)}). Printed: {sentence(item.printed)} Used: {sentence(item.used)}")
        return found

    def imports(self, body: str) -> list[str]:
        """The import statements that ``body`` needs."""
        used = used_names(body)
        statements = []
        for module, names in _IMPORTS:
            needed = [name for name in names if name in used]
            if needed:
                line = f"from {module} import {', '.join(needed)}"
                statements.append(line if len(line) <= WIDTH else f"from {module} import (\n" + "".join(f"    {name},\n" for name in needed) + ")")
        return statements

    @property
    def family(self) -> str:
        device = self.device
        return self._constant("FAMILY", call("Family", device.name, plain(device.title), device.movement, plain(device.manufacturer.title)))

    @property
    def manual(self) -> str:
        manual = self.device.manual
        editions = tuple(call("Edition", item.language, item.title, item.revision, date=item.date) for item in manual.editions)
        history = tuple(call("Revision", item.revision, item.changes, date=item.date, hardware=item.hardware, software=item.software) for item in manual.history)
        made = record(
            "Manual", {"title": manual.title, "revision": manual.revision, "date": manual.date, "language": manual.language},
            publisher=manual.publisher, editions=editions, history=history,
        )
        return self._constant("MANUAL", made)

    def _constant(self, name: str, value: Call | tuple[Call, ...] | None, kind: str = "") -> str:
        if value is None:
            return ""
        start = f"{name}: {kind or 'Final'} = "
        return start + literal(value, 0, len(start))

    def _table(self, name: str, kind: str, rows: Sequence[Call]) -> str:
        start = f"{name}: Final[tuple[{kind}, ...]] = "
        if not rows:
            return f"{start}()"
        return start + "(\n" + "\n".join(f"    {literal(row, 4, 4, 1)}," for row in rows) + "\n)"

    @property
    def tables(self) -> list[tuple[str, str]]:
        """The tables at the end of the module, each with what it holds."""
        device = self.device
        alarms = [
            record(
                "Alarm", {"name": item.name, "meaning": item.meaning}, printed_name=item.printed_name, field=item.field, detected=item.detected,
                below_mv=item.below_mv, latch=None if item.latch is None else Code(str(item.latch)),
                implemented=None if item.implemented else Code("False"), remedy=item.remedy, cleared_by=item.cleared_by,
                names=item.names, source=cite(item.source),
            )
            for item in device.alarms
        ]
        connectors = [
            record(
                "Connector", {"name": item.name, "kind": item.kind, "title": item.title, "interfaces": item.interfaces,
                              "contacts": tuple(call("Contact", part.contact, part.signal, only=part.only) for part in item.contacts)},
                mating=item.mating, note=item.note, source=cite(item.source),
            )
            for item in device.connectors
        ]
        leds = [
            record("Led", {"name": item.name, "title": item.title, "states": tuple(call("LedState", s.state, s.meaning) for s in item.states)}, source=cite(item.source))
            for item in device.leds
        ]
        facts = [record("Characteristic", {"name": item.name, "value": item.value}, only=item.only, source=cite(item.source)) for item in device.characteristics]
        errata = [
            record(
                "Erratum", {"name": item.name, "printed": item.printed, "used": item.used, "why": item.why, "status": item.status, "severity": item.severity},
                affects=item.affects, source=cite(item.source),
            )
            for item in device.errata
        ]
        inputs = [
            record(
                "Input", {"name": item.name, "meaning": item.meaning}, printed_name=item.printed_name, low=item.low, high=item.high,
                pulse_at_least_us=item.pulse_at_least_us, inverts=item.inverts, needs=item.needs, when_unused=item.when_unused, note=item.note,
                names=item.names, source=cite(item.source),
            )
            for item in device.inputs
        ]
        tables = [
            record("Table", {"name": item.name, "title": item.title, "columns": item.columns, "rows": item.rows}, note=item.note, source=cite(item.source))
            for item in device.tables
        ]
        documents = [call("Document", item.key, item.title, url=item.url) for item in device.documents]
        made = (
            ("Errors and warnings: what they mean, whether they latch, how they are cleared.", "ALARMS", "Alarm", alarms),
            ("Times that belong to the encoder as a whole.", "TIMINGS", "Timing", [_timing(item) for item in device.timings]),
            ("Connectors and cables, contact by contact.", "CONNECTORS", "Connector", connectors),
            ("Lights and what their states mean.", "LEDS", "Led", leds),
            ("Hardware inputs.", "INPUTS", "Input", inputs),
            ("Tables of the manual.", "TABLES", "Table", tables),
            ("Further facts of the manual, as text.", "CHARACTERISTICS", "Characteristic", facts),
            ("Where the manual cannot be taken literally, and what is used instead.", "ERRATA", "Erratum", errata),
            ("Documents that sources cite by their key.", "DOCUMENTS", "Document", documents),
        )
        return [(comment, self._table(name, kind, rows)) for comment, name, kind, rows in made if rows or name in _ALWAYS]

    # ------------------------------------------------------------------------------------------------------ examples for the README

    @property
    def readme_frames(self) -> list[Shown]:
        """One frame of each interface, its values made up, its bits from the model."""
        found = []
        for interface, section in zip(self.device.interfaces, self.sections):
            view = next((item for item in section.codecs if item.layout.sender == "encoder"), None)
            variant = self._example_variant(interface.kind)
            if view is None or variant is None:
                continue
            placed = view.layout.place(variant.parameters)
            values = {item.name: _made_up(item.field, item.width, view.layout) for item in placed.fields if item.field.carries_data}
            number = codec.encode(self.device, placed, values)
            joined = {join.name: codec.join_value(placed, join, number) for join in view.layout.joins}
            simple = [item.name for item in placed.fields if item.field.kind in ("number", "flag") and item.name != view.layout.selector]
            shown = {name: values[name] for name in simple} | joined
            text = f"{number:#x}"
            if view.layout.carried_as == "bytes":
                text = f'bytes.fromhex("{codec.number_to_bytes(view.layout, number, placed.bits).hex(" ").upper()}")'
            found.append(Shown(variant.code, text, _tuple([f"frame.{attribute(name, CLASS_NAMES)}" for name in shown]), _tuple(list(map(repr, shown.values())))))
        return found

    def _example_variant(self, kind: str) -> Variant | None:
        """An order code of this interface: that of an example of the manual, else the one with the most bits."""
        codes = [example.order_code for example in self.device.examples]
        candidates = [item for item in self.device.variants if item.interface == kind]
        return max(candidates, key=lambda item: (item.code in codes, sum(item.parameters[name.name] for name in self.device.set_parameters)), default=None)

    @property
    def readme_registers(self) -> list[Shown]:
        """The worked examples of registers."""
        found = []
        for example in self.device.examples:
            view = next((item for item in self.registers if example.kind == "register" and item.name == self.classes[f"register {example.register}"]), None)
            if isinstance(view, Codec) and example.values:
                variant = f', lookup("{example.order_code}")' if view.takes_variant else ""
                code = f'{view.name}.decode(bytes.fromhex("{example.bytes.hex(" ").upper()}"){variant})'
                shown = [f"register.{attribute(name, CLASS_NAMES)}" for name in example.values]
                found.append(Shown(code, "", _tuple(shown), _tuple(list(map(repr, example.values.values())))))
        return found

    @property
    def readme_procedures(self) -> list[Shown]:
        """The worked examples of procedures."""
        found = []
        for example in self.device.examples:
            if example.kind == "procedure":
                view = next(item for item in self.procedures if item.name == self.functions_taken[example.procedure])
                arguments = [f'lookup("{example.order_code}")'] if "variant" in view.arguments else []
                arguments += map(grouped, example.arguments.values())
                result = repr(bytes(item.value for item in example.writes).hex(" "))
                found.append(Shown(f"{view.name}({', '.join(arguments)})", "", "", result))
        return found

    # ------------------------------------------------------------------------------------------------------------- order codes

    @property
    def order_code(self) -> str:
        code = self.device.order_code
        parts = tuple(
            record(
                "Part",
                {"name": part.name, "meaning": part.meaning,
                 "values": tuple(record("PartValue", {"text": value.text}, meaning=value.meaning, source=cite(value.source)) for value in part.values)},
                open=part.open, source=cite(part.source),
            )
            for part in code.parts
        )
        made = record("OrderCode", {"pattern": code.pattern, "parts": parts}, special=code.special, note=code.note, source=cite(code.source))
        return self._constant("ORDER_CODE", made)

    @property
    def variant_doc(self) -> str:
        set_here = []
        for item in self.device.set_parameters:
            text = self._parameter_text(item.meaning, item.unit, item.source)
            if item.read_from:
                text += f" As in register {item.read_from}, its default unless replaced: dataclasses.replace(variant, {self.parameter_names[item.name]}=...)."
            set_here.append((self.parameter_names[item.name], text))
        parts = ", ".join(part.name for part in self.device.order_code.parts)
        return docstring(
            "An encoder as its order code describes it.",
            ("Attributes", [
                ("code", "Order code, without what may follow it on the label."),
                ("interface", "How the encoder is connected."),
                ("parts", f"The parts of the order code: {parts}."),
                *set_here,
                ("unlisted", "Parts of the order code that the manual leaves open."),
                ("tail", "What followed the order code on the label."),
                ("special", f"Whether the label ends in /Sxxx. {sentence(self.device.order_code.special)}".strip()),
            ]),
            indent=4,
        )

    @staticmethod
    def _parameter_text(meaning: str, unit: str, source: Sources) -> str:
        more = ", ".join(item for item in (unit, cite(source)) if item)
        return sentence(f"{meaning.rstrip('.')} ({more})" if more else meaning)

    @property
    def set_parameters(self) -> list[str]:
        return [self.parameter_names[item.name] for item in self.device.set_parameters]

    @property
    def derived_parameters(self) -> list[tuple[str, str, str]]:
        """Parameters that follow from others: name, docstring, expression."""
        return [
            (
                self.parameter_names[item.name],
                docstring(self._parameter_text(item.meaning, item.unit, item.source), indent=8),
                bare(expression(item.equals, self.parameter_names, "self")),
            )
            for item in self.device.parameters
            if item.equals is not None
        ]

    @property
    def measured(self) -> str:
        """What the position is called whose counts are turned into turns or lengths."""
        found = next((item for item in map(self._measurement, self.device.interfaces) if item is not None), None)
        return attribute(found.of, ("self",)) if found is not None else ""

    @property
    def measures(self) -> list[tuple[str, str, str, list[tuple[str, str]]]]:
        """Methods that turn counts into something: name, type, docstring, and by interface the expression."""
        counts = self.measured
        kinds = (
            ("turns", "float", f"``{counts}``, in counts, as revolutions.", "steps_per_turn", f"{counts} / {{}}"),
            ("degrees", "float", f"``{counts}``, in counts, as degrees within one revolution.", "steps_per_turn", f"{counts} % {{0}} * 360 / {{0}}"),
            ("micrometres", "int", f"``{counts}``, in counts, as micrometres.", "step_um", f"{counts} * {{}}"),
        )
        found = []
        for name, kind, doc, part, text in kinds:
            branches = []
            for interface in self.device.interfaces:
                measurement = self._measurement(interface)
                value = getattr(measurement, part) if measurement is not None else None
                if value is not None:
                    branches.append((interface.kind.upper(), text.format(operand(self._of_self(value)))))
            if branches:
                same = len({value for _, value in branches}) == 1
                found.append((name, kind, docstring(doc, indent=8), branches[:1] if same else branches))
        return found

    def _measurement(self, interface: Interface) -> Measurement | None:
        return self.device.measurement_of(interface.kind)

    def _of_self(self, value: Expression) -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.parameter_names, "self")

    @property
    def variants(self) -> list[str]:
        return [self._variant(item) for item in self.device.variants]

    def _variant(self, variant: Variant) -> str:
        parts = tuple(variant.parts[part.name] for part in self.device.order_code.parts)
        named = {self.parameter_names[item.name]: variant.parameters[item.name] for item in self.device.set_parameters}
        positional: tuple[tuple[str, Literal], ...] = (("", variant.code), ("", Code(f"Interface.{variant.interface.upper()}")), ("", parts))
        arguments = (*positional, *named.items())
        return literal(Call("Variant", arguments), 12, 12, 1)

    @property
    def frame_kinds(self) -> list[tuple[str, str, str]]:
        """By interface what ``Variant.decode`` does: the interface, the function or class, and how the frame is given."""
        found = []
        for interface, section in zip(self.device.interfaces, self.sections):
            name = next((item.name for item in section.dispatches if item.name.endswith("reply")), "")
            if not name:
                first = next((item for item in section.codecs if item.layout.sender == "encoder"), None)
                if first is None:
                    continue
                name = f"{first.name}.decode"
                takes = first.takes_variant
                carried = first.layout.carried_as
            else:
                takes, carried = True, "bytes"
            convert = "as_bytes" if carried == "bytes" else "as_number"
            found.append((interface.kind.upper(), name, f"{convert}(frame){', self' if takes else ''}"))
        return found

    @property
    def frame_union(self) -> list[str]:
        """The classes of everything that the encoder sends."""
        return [item.name for section in self.sections for item in section.codecs if item.layout.sender == "encoder"]

    # -------------------------------------------------------------------------------------------------------------------- CRCs

    @property
    def crc_table(self) -> str:
        return self._table("CRCS", "Crc", [self._crc_record(item) for item in self.device.crcs])

    @staticmethod
    def _crc_record(item: Crc) -> Call:
        needed: dict[str, Literal] = {
            "name": item.name, "width": item.width, "poly": Hex(item.poly), "init": Hex(item.init), "refin": item.refin, "refout": item.refout,
            "xorout": Hex(item.xorout), "polynomial": item.polynomial,
        }
        return record("Crc", needed, note=item.note, source=cite(item.source))

    def _carriers(self, crc: Crc) -> set[str]:
        used = {layout.carried_as for _, layout in self.device.layouts() if layout.crc_field is not None and layout.crc_field.crc == crc.name}
        return used or {"bytes" if crc.width % 8 == 0 else "bits"}

    def _crc_functions(self, crc: Crc) -> list[CrcFunction]:
        carriers = sorted(self._carriers(crc), reverse=True)
        made = []
        for carried in carriers:
            name = self.crc_names[crc.name] + ("_of_bits" if carried == "bits" and len(carriers) > 1 else "")
            what = "``data``" if carried == "bytes" else "``bits`` bits of ``number``, most significant first"
            doc = docstring(
                f"The CRC of {crc.width} bits by {crc.polynomial} over {what} ({cite(crc.source)}).",
                sentence(crc.note), *self.erratum_paragraphs(self.errata(f"crcs.{crc.name}")), indent=4,
            )
            shape = f"width={crc.width}, poly=0x{crc.poly:02X}, init={crc.init:#x}, "
            shape += f"refin={crc.refin}, " if carried == "bytes" else ""
            shape += f"refout={crc.refout}, xorout=0x{crc.xorout:02X}"
            if carried == "bits":
                made.append(CrcFunction(name, "number: int, bits: int", doc, f"crc_of_bits(number, bits, {shape})"))
            elif crc.form == "xor":
                made.append(CrcFunction(name, "data: bytes", doc, f"crc_by_xor(data{f', 0x{crc.xorout:02X}' if crc.xorout else ''})"))
            else:
                made.append(CrcFunction(name, "data: bytes", doc, f"crc_of_bytes(data, {shape})"))
        return made

    def bits_function(self, crc: Crc) -> str:
        return self.crc_names[crc.name] + ("_of_bits" if len(self._carriers(crc)) > 1 else "")

    def fold_name(self, crc: Crc, layout: Layout) -> str:
        key = crc.name, layout.widest
        if key not in self._fold_names:
            name = f"_remainder_{crc.name}_{layout.widest}"
            self._fold_names[key] = name
            doc = docstring(
                f"What is left of up to {layout.widest} bits, CRC included, modulo {crc.polynomial}.",
                "A word is folded at multiples of the polynomial's powers, which have no more terms than itself; this takes the place of a table.",
                indent=4,
            )
            steps = tuple((step.shift, f"0x{step.mask:X}", f" ^ high << {step.back}" if step.back else "") for step in layout.fold)
            self.folds.append(Fold(name, doc, steps))
        return self._fold_names[key]

    # ------------------------------------------------------------------------------------------------------------------- enums

    def enum_for(self, item: Field, owner: str) -> str:
        """The name of the IntEnum for a field with named values; fields of the same name and values share one."""
        key = item.name, tuple((value.name, value.value) for value in item.values)
        if key not in self._enum_names:
            name = self.taken.take(camel(item.name), "Value")
            self._enum_names[key] = name
            self.enums.append(self._enum(name, sentence(item.meaning or item.printed_name or f"Values of {item.name}"), item.values))
        return self._enum_names[key]

    @staticmethod
    def _enum(name: str, summary: str, values: Sequence[Value], *blocks: Block, length: int = 0, order: str = "", low: int = 0) -> Enumeration:
        members = tuple((item.name.upper(), number_text(item.value), docstring(sentence(item.meaning), indent=4) if item.meaning else "") for item in values)
        return Enumeration(name, docstring(summary, *blocks, indent=4), members, length, order, low)

    # ----------------------------------------------------------------------------------------------------------------- layouts

    def _section(self, interface: Interface) -> Section:
        codecs = tuple(self._codec(item, self.classes[f"layout {item.name}"], self._layout_doc(interface, item)) for item in interface.layouts)
        facts = {"ssi": self._ssi, "biss": self._biss, "rs485": self._rs485}[interface.kind](interface)
        kind = interface.kind.upper()
        here = f"interfaces.{interface.kind}"
        layouts = {f"{here}.{item.name}" for item in interface.layouts}
        errata = [item for item in self.errata(here) if any((path == here or path.startswith(f"{here}.")) and path not in layouts for path in item.affects)]
        notes = tuple(self.erratum_paragraphs(errata))
        return Section(interface.title, kind, self._constant(kind, facts), notes, codecs, tuple(self._dispatches(interface, codecs)))

    def _layout_doc(self, interface: Interface, layout: Layout) -> tuple[str, list[Block]]:
        title = layout.name.replace("_", " ").capitalize()
        carried = "as a string of bits" if layout.carried_as == "bits" else "as bytes"
        summary = f"{title}: sent by the {layout.sender} over {interface.title}, {carried} ({cite(layout.source)})."
        printed = f"In the manual: {sentence(layout.printed_name)}" if layout.printed_name else ""
        errata = self.errata(f"interfaces.{interface.kind}.{layout.name}")
        groups = dict.fromkeys(item.group for item in layout.fields if item.group)
        shared = dict.fromkeys(item.name for name in groups for item in self.errata(f"field_groups.{name}") if item not in errata)
        more = f"Of its parts, see ERRATA: {', '.join(shared)}." if shared else ""
        return summary, [printed, sentence(layout.note), *self.erratum_paragraphs(errata), more]

    def _codec(self, layout: Layout, name: str, doc: tuple[str, list[Block]], register: Register | None = None) -> Codec:
        return CodecBuilder(self, layout, name, doc, register).build()

    def _dispatches(self, interface: Interface, codecs: Sequence[Codec]) -> Iterable[Dispatch]:
        several = sum(any(item.selector for item in other.layouts) for other in self.device.interfaces) > 1
        for sender, word in (("master", "request"), ("encoder", "reply")):
            members = [item for item in codecs if item.layout.sender == sender]
            if not members or not members[0].layout.selector:
                continue
            prefix = f"{interface.kind}_" if several else ""
            yield self._dispatch(f"decode_{prefix}{word}", camel(f"{prefix}{word}"), members)

    def _dispatch(self, name: str, union: str, members: Sequence[Codec]) -> Dispatch:
        branches: list[Branch] = []
        allowed: list[int] = []
        fallback = ""
        selector = members[0].layout.field(members[0].layout.selector)
        least = max((piece.byte + 1 for piece in selector.pieces), default=1)
        local = attribute(selector.name, LOCAL_NAMES)
        for item in members:
            arguments = "data, variant" if item.takes_variant else "data"
            if not item.layout.selector:
                fallback = f"{item.name}.decode({arguments})"
                break
            own = item.layout.field(item.layout.selector)
            value = local if own.pieces == selector.pieces else f"({from_pieces(own.pieces)})"
            branches.append(Branch(among(value, item.layout.selects), item.name, arguments))
            allowed += item.layout.selects
        words = plain(selector.printed_name or selector.name.replace("_", " "))
        doc = docstring(
            sentence(f"The {'reply' if union.endswith('Reply') else 'request'} in ``data``, told by its {words}"),
            ("Raises", [
                ("LengthError", "There are too many or too few bytes."),
                ("CrcError", "The CRC does not belong to the other bytes."),
                ("ConstantError", "Bits that always hold the same value, or a parity bit, hold another."),
                ("RangeError", f"There is no such {words}, or a field holds a value without meaning."),
            ]),
            indent=4,
        )
        listed = ", ".join(f"{item:X}h" for item in sorted(allowed))
        return Dispatch(
            name, union, tuple(item.name for item in members), doc, least, selector.name, local, from_pieces(selector.pieces), tuple(branches), quoted(f"one of {listed}" if len(allowed) > 1 else listed), fallback,
        )

    # --------------------------------------------------------------------------------------------------------------- interfaces

    def _common(self, interface: Interface) -> Mapping[str, str | tuple[Call, ...]]:
        return {"timings": tuple(map(_timing, interface.timings)), "note": interface.note, "source": cite(interface.source)}

    def _clock(self, interface: Interface) -> Call:
        return record("Clock", {"min_hz": interface.clock_min_hz or 0, "max_hz": interface.clock_max_hz or 0}, source=cite(interface.clock_source))

    def _ssi(self, interface: Interface) -> Call:
        rows = tuple(
            record("CableLength", {"shorter_than_m": item.shorter_than_m, "below_hz": item.below_hz}, source=cite(item.source)) for item in interface.cable_lengths
        )
        return record(
            "SsiFacts", {"clock": self._clock(interface), "alignment": interface.alignment}, output_code=interface.output_code, signals=interface.signals,
            cable_lengths=rows, **self._common(interface),
        )

    def _biss(self, interface: Interface) -> Call:
        network, timeout = interface.network, interface.timeout
        made_network = None if network is None else record(
            "Network", {"topology": network.topology, "multiple_slaves": network.multiple_slaves}, source=cite(network.source)
        )
        made_timeout = None if timeout is None else record(
            "Timeout", {"rule": timeout.rule}, half_clock_periods=timeout.half_clock_periods, at_most_ns=timeout.at_most_ns,
            typical_ns=timeout.typical_ns, source=cite(timeout.source),
        )
        control = tuple(
            record(
                "ControlField", {"name": item.name, "bits": item.bits}, meaning=item.meaning, crc=item.crc, printed_name=item.printed_name,
                values=tuple(call("NamedValue", value.name, value.value, meaning=value.meaning) for value in item.values), source=cite(item.source),
            )
            for item in interface.control_data
        )
        return record(
            "BissFacts", {"clock": self._clock(interface)}, profile=interface.profile, signals=interface.signals, network=made_network,
            timeout=made_timeout, control_data=control, control_data_note=interface.control_data_note,
            description_file=interface.description_file, bank_select=interface.bank_select, **self._common(interface),
        )

    def _rs485(self, interface: Interface) -> Call | None:
        port = interface.port
        if port is None:
            return None
        made_port = record(
            "Port", {"baud": port.baud, "data_bits": port.data_bits, "parity": port.parity, "stop_bits": port.stop_bits, "flow_control": port.flow_control},
            source=cite(port.source),
        )
        ids = tuple(
            record(
                "DataIdFacts", {"name": item.name, "id": Hex(item.id), "control": Hex(item.control), "purpose": item.purpose},
                meaning=item.meaning, source=cite(item.source),
            )
            for item in interface.data_ids
        )
        memory = tuple(
            record(
                "MemoryAccess", {"access": item.access, "busy": bool(item.busy), "address": item.address, "data": item.data, "meaning": item.meaning},
                source=cite(item.source),
            )
            for item in interface.memory_access
        )
        return record("Rs485Facts", {"port": made_port, "data_ids": ids}, memory_access=memory, **self._common(interface))

    # ---------------------------------------------------------------------------------------------------------------- registers

    def _register_view(self, register: Register) -> Codec | Enumeration:
        name = self.classes[f"register {register.name}"]
        summary = f"{register.printed_name or register.name.replace('_', ' ').capitalize()}, {self._where(register)}."
        blocks: list[Block] = [sentence(register.meaning), *self._register_notes(register), sentence(register.note), *self.erratum_paragraphs(self.errata(f"registers.{register.name}"))]
        only = register.layout.fields[0]
        if register.values and only.kind == "choice" and only.width == register.layout.bits:
            order = "little" if register.byte_order == "low_byte_first" else "big"
            return self._enum(name, summary, register.values, *blocks, length=register.length, order=order)
        return self._codec(register.layout, name, (summary, blocks), register)

    @staticmethod
    def _where(register: Register) -> str:
        last = f" to {register.last_address:02X}h" if register.length > 1 else ""
        access = {"read_only": "read only", "read_write": "read and write", "write_only": "write only"}[register.access]
        return f"register {register.address:02X}h{last}, {access} ({cite(register.source)})"

    @staticmethod
    def _register_notes(register: Register) -> list[str]:
        notes = []
        if register.length > 1:
            notes.append(f"The {'low' if register.byte_order == 'low_byte_first' else 'high'} byte is at the lowest address.")
        default = register.default_bytes()
        if default is not None:
            notes.append(f"As delivered: {default.hex(' ').upper()}.")
        if register.opened_by:
            notes.append(f"Can be written while {register.opened_by} holds {register.opened_by_value}.")
        if register.clears_itself:
            notes.append("Goes back to its default by itself after a write.")
        if register.wait_at_least_ms:
            notes.append(f"Wait at least {register.wait_at_least_ms} ms after a write.")
        if register.volatile:
            notes.append("What is written is lost at power-off unless it is saved.")
        return [" ".join(notes)] if notes else []

    @property
    def addresses(self) -> list[tuple[str, str]]:
        return [(item.name.upper(), f"0x{item.address:02X}") for item in self.device.registers]

    @property
    def register_table(self) -> list[str]:
        rows = []
        for item in self.device.registers:
            row = record(
                "Register",
                {"name": item.name, "printed_name": item.printed_name, "address": Hex(item.address), "length": item.length, "access": item.access,
                 "byte_order": item.byte_order},
                default=item.default_bytes(), opened_by=item.opened_by, opened_by_value=item.opened_by_value,
                clears_itself=Code("True") if item.clears_itself else None, wait_ms=item.wait_at_least_ms,
                volatile=Code("True") if item.volatile else None, bank=item.bank, above_max=item.above_max, write_clears=item.write_clears,
                meanings=tuple(
                    call("RegisterMeaning", entry.name, entry.when, entry.value, meaning=entry.meaning, source=cite(entry.source)) for entry in item.meanings
                ),
                reserved=item.reserved, names=item.names, meaning=item.meaning, note=item.note, source=cite(item.source),
            )
            label = f"{quoted(item.name)}: "
            rows.append(f"        {label}{literal(row, 8, 8 + len(label), 1)},")
        return rows

    # --------------------------------------------------------------------------------------------------------------- procedures

    def _procedure(self, item: Procedure) -> Function:
        names = {argument.name: attribute(argument.name, ("choice", "variant", "writes")) for argument in item.arguments}
        takes_variant = any(self._takes_variant(argument.of) for argument in item.arguments)
        interface = f"Interface.{item.interface.upper()}" if takes_variant else ""
        arguments = ", ".join((["variant: Variant"] if takes_variant else []) + [f"{name}: int" for name in names.values()])
        listed = [(names[argument.name], sentence(argument.meaning or f"Value for {argument.of}")) for argument in item.arguments]
        raises = [("RangeError", "An argument is outside the limits of its register.")] if listed else []
        if interface:
            raises.append(("ValueError", "The encoder has another interface."))
        doc = docstring(
            sentence(f"{item.title} ({cite(item.source)})"),
            sentence(f"Before: {item.precondition}") if item.precondition else "",
            sentence(f"After: {item.result}") if item.result else "",
            sentence(item.note),
            *self.erratum_paragraphs(self.errata(f"procedures.{item.name}")),
            ("Args", ([("variant", "The encoder.")] if takes_variant else []) + listed),
            ("Raises", raises),
            indent=4,
        )
        steps = tuple(self._step(step, names) for step in item.steps)
        return Function(self.functions_taken[item.name], arguments, doc, interface, steps)

    def _takes_variant(self, register: str) -> bool:
        view = self._view(register)
        return isinstance(view, Codec) and view.takes_variant

    def _view(self, register: str) -> Codec | Enumeration:
        return next(item for item in self.registers if item.name == self.classes[f"register {register}"])

    def _step(self, step: Step, names: Mapping[str, str]) -> str:
        meaning: tuple[tuple[str, str], ...] = (("", step.meaning),) if step.meaning else ()
        if step.do == "wait":
            return literal(Call("Wait", (("", step.microseconds), *meaning)), 8, 8, 1)
        if step.do == "send":
            return literal(call("Send", step.request, times=step.times, every_us=step.microseconds or None, meaning=step.meaning), 8, 8, 1)
        register = self.device.register(step.register)
        address = Code(f"Address.{register.name.upper()}")
        place: tuple[tuple[str, Code | int | str], ...] = (("", address), ("", register.length), ("", register.name))
        if step.do == "read":
            return literal(Call("Read", (*place, *meaning)), 8, 8, 1)
        if step.do == "poll" or step.field:
            item = register.layout.field(step.field)
            low, width = item.low.constant, item.width.constant
            value = Code(f"0x{step.value << low:02X}") if step.value is not None else Code(moved_left(names[step.value_name], str(low)))
            mask = Code(f"0x{((1 << width) - 1) << low:02X}")
            return literal(Call("Poll" if step.do == "poll" else "Modify", (*place, ("", mask), ("", value), *meaning)), 8, 8, 1)
        written = Code(self._written(step, register, names))
        return literal(Call("*writes", (("", register.name), ("", address), ("", written), *meaning)), 8, 8, 1)

    def _written(self, step: Step, register: Register, names: Mapping[str, str]) -> str:
        view = self._view(register.name)
        if step.value is not None:
            if isinstance(view, Enumeration):
                return f"{view.name}.{step.value_name.upper()}.encode()"
            return quoted(step.value.to_bytes(register.length, "little" if register.byte_order == "low_byte_first" else "big"))
        argument = names[step.value_name]
        if isinstance(view, Enumeration):
            return f'choice({view.name}, "{argument}", {argument}).encode()'
        first = "variant, " if view.takes_variant else ""
        bounded = attribute(register.limits_of, CLASS_NAMES)
        if any(item.name == bounded for item in view.joins):
            return f"{view.name}.from_{bounded}({first}{argument}).encode()"
        if len(view.attributes) == 1:
            bounded = view.attributes[0].name
        return f"{view.name}({first}{bounded}={argument}).encode()"


def _timing(item: Timing) -> Call:
    return record(
        "Timing", {"name": item.name, "meaning": item.meaning}, at_least_us=item.at_least_us, typical_us=item.typical_us, at_most_us=item.at_most_us,
        symbol=item.symbol, source=cite(item.source),
    )


def _made_up(item: Field, width: int, layout: Layout) -> int | str | bool:
    """A value that shows something."""
    if item.name == layout.selector:
        return layout.selects[0]
    if item.kind == "flag":
        return False
    if item.kind == "choice":
        return item.values[0].value
    if item.kind == "text":
        return "A" * (width // 8)
    if item.kind == "digits":
        return 1
    return 123456789 % (1 << width) if width > 16 else min(42, (1 << width) - 1)


def _tuple(items: Sequence[str]) -> str:
    return f"({', '.join(items)})" if len(items) != 1 else items[0]
