"""The Python target: one installable, typed package without dependencies for each manufacturer.

A layout becomes a NamedTuple with ``decode`` and ``encode``, a register of one choice becomes an IntEnum with the same two, a procedure
becomes a function that gives its steps. Positions come from the model as expressions; here they only get their Python spelling.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from .. import codec
from ..expressions import Expression
from ..model import (
    Crc, Device, Digits, Erratum, Field, Interface, Join, Layout, Manufacturer, Piece, Procedure, Register, Sources, Step, Timing, Value, Variant, cite,
)
from ..render import plain, render
from . import Library
from .python_source import (
    WIDTH, Block, Call, Code, Hex, Literal, Names, attribute, call, camel, chain, docstring, expression, grouped, literal, operand, quoted, record, sentence,
    used_names,
)

#: What the package's modules are called that hold no device; a device of such a name is one of the reserved words below.
SHARED = ("_codec", "_facts", "_order_codes")

#: Names that every device module uses for itself, besides what it imports.
_MODULE = (
    "INPUTS", "TABLES", "Frame", "ALARMS", "Address", "Alarm", "BISS", "BissFacts", "BitField", "CHARACTERISTICS", "CONNECTORS", "CRCS", "CableLength", "Characteristic", "Clock",
    "Connector", "ConstantError", "Contact", "ControlField", "Crc", "CrcError", "DOCUMENTS", "DataIdFacts", "Document", "ERRATA", "Edition",
    "Erratum", "FAMILY", "Family", "Final", "IntEnum", "Interface", "LEDS", "Led", "LedState", "LengthError", "MANUAL", "Manual", "Mapping",
    "MappingProxyType", "MemoryAccess", "NamedTuple", "NamedValue", "Network", "ORDER_CODE", "OrderCode", "Part", "PartValue", "Port", "REGISTERS",
    "RS485", "RangeError", "Register", "Reply", "Request", "Revision", "Rs485Facts", "SSI", "Send", "SsiFacts", "Step", "TIMINGS", "Timeout", "Timing",
    "TypeAlias", "Union", "VARIANTS", "Variant", "Wait", "Write", "annotations", "as_bytes", "as_number", "check_interface", "check_limits",
    "check_width", "choice", "crc_by_xor", "crc_of_bits", "crc_of_bytes", "dataclasses", "decode_reply", "decode_request", "lookup", "text_number",
    "writes", "ArithmeticError", "Exception", "Ellipsis", "NotImplemented", "Warning", "ValueError",
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

#: Names that the generated classes use for themselves.
_CLASS = ("bit_fields", "cls", "count", "decode", "encode", "index", "is_as_documented", "limits", "self", "variant")
_VARIANT = ("bytes", "cls", "code", "decode", "interface", "parts", "self", "special", "tail", "unlisted")
_LOCAL = ("body", "cls", "computed", "data", "number", "remainder", "variant", "word")

#: Tables that every module has, even empty.
_ALWAYS = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")

#: The longest frame whose CRC is written out as one XOR of bytes.
_UNROLLED = 16


def generate(library: Library) -> dict[str, str]:
    """The files of every manufacturer's package; with several manufacturers each package has a folder of its own around it."""
    files: dict[str, str] = {}
    makers = library.by_manufacturer()
    for maker, devices in makers:
        folder = "python" if len(makers) == 1 else f"python/{maker.python_package}"
        for path, text in _package(maker, devices, library).items():
            files[f"{folder}/{path}"] = text
    return files


def _package(maker: Manufacturer, devices: tuple[Device, ...], library: Library) -> dict[str, str]:
    package = maker.python_package
    modules = [_Module(device) for device in devices]
    values = {
        "package": package,
        "distribution": package.replace("_", "-"),
        "title": plain(maker.title),
        "maker": maker,
        "notices": [plain(item) for item in maker.trademarks],
        "header": _header(f"the specifications of {plain(maker.title)}'s encoders"),
        "modules": modules,
        "docstring": docstring,
        "toml": _toml,
        "markdown": _markdown,
        "names": [module.name for module in modules],
        "width": WIDTH,
    }

    def made(template: str, **more: object) -> str:
        return render("python", template, values | more, own_templates=library.own_templates)

    files = {
        "LICENSE": made("LICENSE.jinja"),
        "README.md": made("README.md.jinja"),
        "pyproject.toml": made("pyproject.toml.jinja"),
        f"{package}/__init__.py": made("__init__.py.jinja"),
        f"{package}/py.typed": "",
    }
    for name in SHARED:
        files[f"{package}/{name}.py"] = made(f"{name}.py.jinja")
    for module in modules:
        header = _header(f"the specification of {plain(module.device.title)}")
        files[f"{package}/{module.name}.py"] = made("device.py.jinja", header=header, module=module)
    return files


def _header(source: str) -> str:
    return f"# Generated by codewheel from {source}.\n# Licence 0BSD: this file is yours, to use, change and pass on without any condition."


def _toml(text: str) -> str:
    return '"' + plain(text).replace("\\", "\\\\").replace('"', '\\"') + '"'


def _markdown(text: str) -> str:
    """Text of a spec as text in Markdown."""
    return "".join(f"\\{character}" if character in "\\`*_{}[]<>#|!&" else character for character in plain(text))


@dataclass(frozen=True)
class _Check:
    """A test in ``decode``: ``condition`` holds when something is wrong, ``error`` is what is raised then."""

    condition: str
    error: str


@dataclass(frozen=True)
class _Attribute:
    """An attribute of a frame or register: its type, how ``decode`` gets it and what a reader should know."""

    name: str
    type: str
    value: str
    meaning: str
    default: str = ""


@dataclass(frozen=True)
class _Part:
    """One field of a join in ``from_…``: its attribute, and the expression that takes it out of the whole."""

    name: str
    value: str


@dataclass(frozen=True)
class _Joined:
    name: str
    doc: str
    value: str
    width: str
    signature: str
    parts: tuple[_Part, ...]
    others: tuple[_Attribute, ...]


@dataclass(frozen=True)
class _Codec:
    """A layout in Python: a class, and the lines of its methods."""

    layout: Layout
    name: str
    doc: str
    source: str
    source_type: str
    source_doc: str
    takes_variant: bool
    attributes: tuple[_Attribute, ...]
    properties: tuple[tuple[str, str, str, str], ...]
    joins: tuple[_Joined, ...]
    length: str
    length_error: str
    setup: tuple[str, ...]
    crc: _Check | None
    crc_setup: str
    checks: tuple[_Check, ...]
    locals: tuple[str, ...]
    encode_checks: tuple[str, ...]
    gray: tuple[str, str, str] | None
    number: str
    finish: str
    body: str
    encode_variant: bool
    bit_fields: tuple[str, ...]
    limits: tuple[str, str] | None
    limits_doc: str
    raises: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class _Enum:
    """A set of named values; with ``length`` it is a register of so many bytes and codes itself."""

    name: str
    doc: str
    values: tuple[tuple[str, str, str], ...]
    length: int = 0
    order: str = ""
    low: int = 0


@dataclass(frozen=True)
class _CrcFunction:
    name: str
    arguments: str
    doc: str
    value: str


@dataclass(frozen=True)
class _Fold:
    name: str
    doc: str
    steps: tuple[tuple[int, str, str], ...]


@dataclass(frozen=True)
class _Branch:
    condition: str
    name: str
    arguments: str


@dataclass(frozen=True)
class _Dispatch:
    """A function that tells apart what one side sends."""

    name: str
    union: str
    members: tuple[str, ...]
    doc: str
    least: int
    selector: str
    local: str
    value: str
    branches: tuple[_Branch, ...]
    allowed: str
    fallback: str


@dataclass(frozen=True)
class _Section:
    """One interface in a device module."""

    title: str
    constant: str
    facts: str
    notes: tuple[str, ...]
    codecs: tuple[_Codec, ...]
    dispatches: tuple[_Dispatch, ...]


@dataclass(frozen=True)
class _Function:
    """A procedure."""

    name: str
    arguments: str
    doc: str
    interface: str
    steps: tuple[str, ...]


@dataclass(frozen=True)
class _Shown:
    """An example in the README: what is called, and what comes out."""

    code: str
    text: str
    shown: str
    result: str


@dataclass
class _Module:
    """Everything that the template of a device module prints."""

    device: Device
    taken: Names = field(default_factory=lambda: Names([*_MODULE, *(name for _, names in _IMPORTS for name in names)]))

    def __post_init__(self) -> None:
        device = self.device
        self.name = attribute(device.name, ("_codec", "_facts", "_order_codes"))
        self.parameter_names = {item.name: attribute(item.name, _VARIANT) for item in device.parameters}
        self.crc_names = {item.name: self.taken.take(f"crc_{item.name}", "_") for item in device.crcs}
        self.classes: dict[str, str] = {}
        for _, layout in device.layouts():
            self.classes[f"layout {layout.name}"] = self.taken.take(camel(layout.name), "Frame")
        for register in device.registers:
            self.classes[f"register {register.name}"] = self.taken.take(camel(register.name), "Register")
        self._enum_names: dict[tuple[str, tuple[tuple[str, int], ...]], str] = {}
        self.enums: list[_Enum] = []
        self.folds: list[_Fold] = []
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
    def readme_frames(self) -> list[_Shown]:
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
            found.append(_Shown(variant.code, text, _tuple([f"frame.{attribute(name, _CLASS)}" for name in shown]), _tuple(list(map(repr, shown.values())))))
        return found

    def _example_variant(self, kind: str) -> Variant | None:
        """An order code of this interface: that of an example of the manual, else the one with the most bits."""
        codes = [example.order_code for example in self.device.examples]
        candidates = [item for item in self.device.variants if item.interface == kind]
        return max(candidates, key=lambda item: (item.code in codes, sum(item.parameters[name.name] for name in self.device.set_parameters)), default=None)

    @property
    def readme_registers(self) -> list[_Shown]:
        """The worked examples of registers."""
        found = []
        for example in self.device.examples:
            view = next((item for item in self.registers if example.kind == "register" and item.name == self.classes[f"register {example.register}"]), None)
            if isinstance(view, _Codec) and example.values:
                variant = f', lookup("{example.order_code}")' if view.takes_variant else ""
                code = f'{view.name}.decode(bytes.fromhex("{example.bytes.hex(" ").upper()}"){variant})'
                shown = [f"register.{attribute(name, _CLASS)}" for name in example.values]
                found.append(_Shown(code, "", _tuple(shown), _tuple(list(map(repr, example.values.values())))))
        return found

    @property
    def readme_procedures(self) -> list[_Shown]:
        """The worked examples of procedures."""
        found = []
        for example in self.device.examples:
            if example.kind == "procedure":
                view = next(item for item in self.procedures if item.name == self.functions_taken[example.procedure])
                arguments = [f'lookup("{example.order_code}")'] if "variant" in view.arguments else []
                arguments += map(grouped, example.arguments.values())
                result = repr(bytes(item.value for item in example.writes).hex(" "))
                found.append(_Shown(f"{view.name}({', '.join(arguments)})", "", "", result))
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
                _bare(expression(item.equals, self.parameter_names, "self")),
            )
            for item in self.device.parameters
            if item.equals is not None
        ]

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

    def _crc_functions(self, crc: Crc) -> list[_CrcFunction]:
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
                made.append(_CrcFunction(name, "number: int, bits: int", doc, f"crc_of_bits(number, bits, {shape})"))
            elif crc.form == "xor":
                made.append(_CrcFunction(name, "data: bytes", doc, f"crc_by_xor(data{f', 0x{crc.xorout:02X}' if crc.xorout else ''})"))
            else:
                made.append(_CrcFunction(name, "data: bytes", doc, f"crc_of_bytes(data, {shape})"))
        return made

    def _bits_function(self, crc: Crc) -> str:
        return self.crc_names[crc.name] + ("_of_bits" if len(self._carriers(crc)) > 1 else "")

    def _fold(self, crc: Crc, layout: Layout) -> str:
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
            self.folds.append(_Fold(name, doc, steps))
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
    def _enum(name: str, summary: str, values: Sequence[Value], *blocks: Block, length: int = 0, order: str = "", low: int = 0) -> _Enum:
        members = tuple((item.name.upper(), _number(item.value), docstring(sentence(item.meaning), indent=4) if item.meaning else "") for item in values)
        return _Enum(name, docstring(summary, *blocks, indent=4), members, length, order, low)

    # ----------------------------------------------------------------------------------------------------------------- layouts

    def _section(self, interface: Interface) -> _Section:
        codecs = tuple(self._codec(item, self.classes[f"layout {item.name}"], self._layout_doc(interface, item)) for item in interface.layouts)
        facts = {"ssi": self._ssi, "biss": self._biss, "rs485": self._rs485}[interface.kind](interface)
        kind = interface.kind.upper()
        here = f"interfaces.{interface.kind}"
        layouts = {f"{here}.{item.name}" for item in interface.layouts}
        errata = [item for item in self.errata(here) if any((path == here or path.startswith(f"{here}.")) and path not in layouts for path in item.affects)]
        notes = tuple(self.erratum_paragraphs(errata))
        return _Section(interface.title, kind, self._constant(kind, facts), notes, codecs, tuple(self._dispatches(interface, codecs)))

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

    def _codec(self, layout: Layout, name: str, doc: tuple[str, list[Block]], register: Register | None = None) -> _Codec:
        return _CodecBuilder(self, layout, name, doc, register).build()

    def _dispatches(self, interface: Interface, codecs: Sequence[_Codec]) -> Iterable[_Dispatch]:
        several = sum(any(item.selector for item in other.layouts) for other in self.device.interfaces) > 1
        for sender, word in (("master", "request"), ("encoder", "reply")):
            members = [item for item in codecs if item.layout.sender == sender]
            if not members or not members[0].layout.selector:
                continue
            prefix = f"{interface.kind}_" if several else ""
            yield self._dispatch(f"decode_{prefix}{word}", camel(f"{prefix}{word}"), members)

    def _dispatch(self, name: str, union: str, members: Sequence[_Codec]) -> _Dispatch:
        branches: list[_Branch] = []
        allowed: list[int] = []
        fallback = ""
        selector = members[0].layout.field(members[0].layout.selector)
        least = max((piece.byte + 1 for piece in selector.pieces), default=1)
        local = attribute(selector.name, _LOCAL)
        for item in members:
            arguments = "data, variant" if item.takes_variant else "data"
            if not item.layout.selector:
                fallback = f"{item.name}.decode({arguments})"
                break
            own = item.layout.field(item.layout.selector)
            value = local if own.pieces == selector.pieces else f"({_from_pieces(own.pieces)})"
            branches.append(_Branch(_among(value, item.layout.selects), item.name, arguments))
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
        return _Dispatch(
            name, union, tuple(item.name for item in members), doc, least, selector.name, local, _from_pieces(selector.pieces), tuple(branches), quoted(f"one of {listed}"), fallback,
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

    def _register_view(self, register: Register) -> _Codec | _Enum:
        name = self.classes[f"register {register.name}"]
        summary = f"{register.printed_name or register.name.replace('_', ' ')}, {self._where(register)}."
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

    def _procedure(self, item: Procedure) -> _Function:
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
        return _Function(self.functions_taken[item.name], arguments, doc, interface, steps)

    def _takes_variant(self, register: str) -> bool:
        view = self._view(register)
        return isinstance(view, _Codec) and view.takes_variant

    def _view(self, register: str) -> _Codec | _Enum:
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
            value = Code(f"0x{step.value << low:02X}") if step.value is not None else Code(_shifted(names[step.value_name], str(low)))
            mask = Code(f"0x{((1 << width) - 1) << low:02X}")
            return literal(Call("Poll" if step.do == "poll" else "Modify", (*place, ("", mask), ("", value), *meaning)), 8, 8, 1)
        written = Code(self._written(step, register, names))
        return literal(Call("*writes", (("", register.name), ("", address), ("", written), *meaning)), 8, 8, 1)

    def _written(self, step: Step, register: Register, names: Mapping[str, str]) -> str:
        view = self._view(register.name)
        if step.value is not None:
            if isinstance(view, _Enum):
                return f"{view.name}.{step.value_name.upper()}.encode()"
            return quoted(step.value.to_bytes(register.length, "little" if register.byte_order == "low_byte_first" else "big"))
        argument = names[step.value_name]
        if isinstance(view, _Enum):
            return f'choice({view.name}, "{argument}", {argument}).encode()'
        first = "variant, " if view.takes_variant else ""
        bounded = attribute(register.limits_of, _CLASS)
        if any(item.name == bounded for item in view.joins):
            return f"{view.name}.from_{bounded}({first}{argument}).encode()"
        if len(view.attributes) == 1:
            bounded = view.attributes[0].name
        return f"{view.name}({first}{bounded}={argument}).encode()"


class _CodecBuilder:
    """Builds the Python of one layout."""

    def __init__(self, module: _Module, layout: Layout, name: str, doc: tuple[str, list[Block]], register: Register | None) -> None:
        self.module = module
        self.layout = layout
        self.name = name
        self.doc = doc
        self.register = register
        self.in_bytes = layout.carried_as == "bytes"
        self.order = "little" if layout.byte_order == "low_byte_first" else "big"
        self.bytes = layout.bits.constant // 8 if self.in_bytes else 0
        crc = layout.crc_field
        self.crc = module.device.crc(crc.crc) if crc is not None else None
        self.by_piece = self.in_bytes and all(item.pieces or item.padding_of or item.kind in ("crc", "text") for item in layout.fields)
        self.by_piece = self.by_piece and not layout.gray_when and all(item.pieces for item in layout.fields if item.kind == "text")
        self.containers = {item.padding_of: item for item in layout.fields if item.padding_of} if self.by_piece else {}
        self.source = "data" if self.by_piece else "number" if self.in_bytes else "word"
        limits = [item for item in (register.min, register.max) if item is not None] if register is not None else []
        positions = [part for item in layout.fields for part in (item.low, item.width)]
        expected = [item.equals for item in layout.fields if isinstance(item.equals, Expression)]
        self.takes_variant = bool(layout.gray_when) or not all(item.is_constant for item in (layout.bits, *positions, *limits, *expected))
        self.checks: list[_Check] = []
        self.locals: list[str] = []

    def build(self) -> _Codec:
        layout = self.layout
        attributes = self._attributes()
        properties = [*self._fixed_selector(), *self._wholes(), *self._documented()]
        joins = tuple(self._join(item, attributes) for item in layout.joins)
        encode_checks = self._encode_checks()
        terms, finish, body = self._terms()
        length = f"word >> {operand(self._text(layout.bits))}" if not self.in_bytes else f"len(data) != {self.bytes}"
        length_error = f'{self._text(layout.bits)}, word.bit_length(), "bits"' if not self.in_bytes else f"{self.bytes}, len(data)"
        crc_setup, crc_check = self._crc_check()
        setup = (f'number = int.from_bytes(data, "{self.order}")',) if self.source == "number" else ()
        limits = self._limits()
        lines = (*encode_checks, *terms, finish)
        gray = self._gray()
        plain_word = finish == "return number" and gray is None
        listed = [("variant", "The encoder that the frame belongs to.")] if self.takes_variant and self.register is None else []
        listed += [("variant", "The encoder that the register belongs to.")] if self.takes_variant and self.register is not None else []
        summary, blocks = self.doc
        doc = docstring(summary, *blocks, ("Attributes", [*listed, *((item.name, item.meaning) for item in attributes)]), indent=4)
        return _Codec(
            layout=layout,
            name=self.name,
            doc=doc,
            source="data" if self.in_bytes else "word",
            source_type="bytes" if self.in_bytes else "int",
            source_doc=self._source_doc(),
            takes_variant=self.takes_variant,
            attributes=tuple(attributes),
            properties=tuple(properties),
            joins=joins,
            length=length,
            length_error=length_error,
            setup=setup,
            crc=crc_check,
            crc_setup=crc_setup,
            checks=tuple(self.checks),
            locals=tuple(self.locals),
            encode_checks=tuple(encode_checks),
            gray=gray,
            number=chain("return " if plain_word else "number = ", [_bare(terms[0])] if len(terms) == 1 else terms, 8),
            finish="" if plain_word else finish,
            body=body,
            encode_variant=gray is not None or any(re.search(r"(?<!self\.)\bvariant\b", line) for line in lines),
            bit_fields=tuple(
                literal(Call("BitField", (("", item.name), ("", self._code(item.low)), ("", self._code(item.width)))), 12, 12, 1) for item in layout.fields
            ),
            limits=limits,
            limits_doc=docstring(f"Lowest and highest value of ``{self.register.limits_of}`` that may be written.", indent=8) if limits and self.register else "",
            raises=tuple(self._raises()),
        )

    # --------------------------------------------------------------------------------------------------------------- expressions

    def _text(self, value: Expression, owner: str = "variant") -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.module.parameter_names, owner)

    def _code(self, value: Expression) -> int | Code:
        return value.constant if value.is_constant else Code(self._text(value))

    def _attribute(self, name: str) -> str:
        return attribute(name, _CLASS)

    def _mask(self, width: Expression, owner: str = "variant") -> str:
        return f"0x{(1 << width.constant) - 1:X}" if width.is_constant else f"((1 << {operand(self._text(width, owner))}) - 1)"

    def _raw(self, item: Field) -> str:
        """The expression for the bits of a field; with padding in bytes, for the whole container."""
        if self.by_piece and item.pieces:
            return _from_pieces(item.pieces, self.bytes)
        shifted = self.source if item.low == Expression(0) else f"{self.source} >> {operand(self._text(item.low))}"
        return shifted if item.low + item.width == self.layout.bits else f"{shifted} & {self._mask(item.width)}"

    def _bit(self, item: Field) -> str:
        """The expression that is not 0 when the bit is set."""
        if self.by_piece and item.pieces:
            piece = item.pieces[0]
            return f"data[{piece.byte}] & 0x{1 << piece.right:02X}"
        if item.low.is_constant:
            return f"{self.source} & 0x{1 << item.low.constant:02X}"
        return f"{self.source} >> {operand(self._text(item.low))} & 1"

    # -------------------------------------------------------------------------------------------------------------------- decode

    def _attributes(self) -> list[_Attribute]:
        """The attributes, and on the way every check of ``decode``: constants and parity first, as the model orders faults."""
        ranges: list[_Check] = []
        late: list[str] = []
        found: list[_Attribute] = []
        for item in self.layout.fields:
            if item.kind == "constant" and not (item.padding_of in self.containers and self.by_piece):
                raw = self._raw(item)
                expected = f"0x{item.constant:X}" if item.constant else "0"
                condition = f"{_compared(raw)} != {expected}" if item.constant else raw
                self.checks.append(_Check(condition, f'ConstantError("{item.name}", {raw}, {expected})'))
            elif item.kind == "parity":
                self._check_parity(item)
            elif item.carries_data:
                found += self._data(item, ranges, late)
        self.checks += ranges
        self.locals += late
        return _with_defaults(found)

    def _check_parity(self, item: Field) -> None:
        of = self.layout.field(item.parity_of)
        computed = f"({self._raw(of)}).bit_count() & 1"
        raw = self._raw(item)
        self.checks.append(_Check(f"{_compared(raw)} != ({computed})", f'ConstantError("{item.name}", {raw}, {computed})'))

    def _data(self, item: Field, ranges: list[_Check], late: list[str]) -> Iterable[_Attribute]:
        name, local, raw = self._attribute(item.name), attribute(item.name, _LOCAL), self._raw(item)
        meaning = _meaning(item, any(item.width.value(variant.parameters) == 0 for variant in self.module.device.variants))
        if item.name in self.containers:
            padding = self.containers[item.name]
            width = operand(self._text(item.width))
            condition = f"({local} := {raw}) >> {width}"
            self.checks.append(_Check(condition, f'ConstantError("{padding.name}", {local} >> {width}, 0)'))
            raw = local
        if item.name == self.layout.selector:
            yield from self._selector(item, name, local, raw, meaning, ranges)
        elif item.kind == "flag":
            yield _Attribute(name, "bool", f"not {self._bit(item)}" if item.active_low else f"bool({self._bit(item)})", meaning)
        elif item.kind == "choice":
            enum = self.module.enum_for(item, self.layout.name)
            late.append(f'{local} = choice({enum}, "{item.name}", {raw})')
            yield _Attribute(name, enum, local, meaning)
        elif item.kind == "digits":
            largest = item.digits[0].divisor * item.digits[0].modulus
            ranges.append(_Check(f"({local} := {raw}) >= {grouped(largest)}", f'RangeError("{item.name}", {local}, "at most {largest - 1}")'))
            for run in item.digits:
                yield _Attribute(self._attribute(run.name), "int", _digits(local, run, run is item.digits[0]), sentence(run.meaning or f"{run.digits} digits"))
        elif item.kind == "text":
            yield _Attribute(name, "str", self._characters(item, raw), meaning)
        elif item.signed:
            yield _Attribute(name, "int", f"signed({raw}, {self._text(item.width)})", meaning)
        elif item.zero_means:
            yield _Attribute(name, "int", f"{_compared(raw)} or {grouped(item.zero_means)}", meaning)
        else:
            yield _Attribute(name, "int", raw, meaning)

    def _selector(self, item: Field, name: str, local: str, raw: str, meaning: str, ranges: list[_Check]) -> Iterable[_Attribute]:
        selects = self.layout.selects
        listed = ", ".join(f"{value:X}h" for value in selects)
        if len(selects) == 1:
            ranges.append(_Check(f"{_compared(raw)} != {_number(selects[0])}", f'RangeError("{item.name}", {raw}, "{listed}")'))
            if item.values:
                self.module.enum_for(item, self.layout.name)
            return
        condition = f"({local} := {raw}) not in ({', '.join(map(_number, selects))})"
        ranges.append(_Check(condition, f'RangeError("{item.name}", {local}, "one of {listed}")'))
        if item.values:
            enum = self.module.enum_for(item, self.layout.name)
            yield _Attribute(name, enum, f"{enum}({local})", meaning)
        else:
            yield _Attribute(name, "int", local, meaning)

    def _characters(self, item: Field, raw: str) -> str:
        size = item.width.constant // 8
        if self.by_piece and all(piece.right == 0 and piece.mask == 0xFF for piece in item.pieces):
            places = [piece.byte for piece in reversed(item.pieces)]
            if places == list(range(places[0], places[0] + size)):
                return f'data[{places[0]}:{places[0] + size}].decode("ascii", "replace")'
        return f'({raw}).to_bytes({size}, "big").decode("ascii", "replace")'

    def _crc_check(self) -> tuple[str, _Check | None]:
        crc, item = self.crc, self.layout.crc_field
        if crc is None or item is None:
            return "", None
        mask = f"0x{crc.mask:02X}"
        if not self.in_bytes and self.layout.fold:
            whole = f"word ^ 0x{crc.xorout:02X}" if crc.xorout else "word"
            fold = self.module._fold(crc, self.layout)
            return "", _Check(f"remainder := {fold}({whole})", f"CrcError(word & {mask}, (word & {mask}) ^ remainder)")
        if not self.in_bytes:
            bits = self.layout.bits - Expression(crc.width)
            function = self.module._bits_function(crc)
            return f"computed = {function}(word >> {crc.width}, {self._text(bits)})", _Check(f"computed != (word & {mask})", f"CrcError(word & {mask}, computed)")
        size = crc.width // 8
        before = self.bytes - size
        if crc.form == "xor" and before <= _UNROLLED:
            made = " ^ ".join(f"data[{index}]" for index in range(before)) + (f" ^ 0x{crc.xorout:02X}" if crc.xorout else "")
        else:
            made = f"{self.module.crc_names[crc.name]}(data[:{before}])"
        received = f"data[{before}]" if size == 1 else f'int.from_bytes(data[{before}:], "{self.order}")'
        return f"computed = {made}", _Check(f"computed != {received}", f"CrcError({received}, computed)")

    def _source_doc(self) -> str:
        what = "register" if self.register is not None else "frame"
        if self.in_bytes:
            order = "in ascending order of address" if self.register is not None else "in the order in which they are sent"
            return f"The {what} in ``data``, its bytes {order}."
        return f"The {what} in ``word``, whose first bit sent is the most significant."

    def _raises(self) -> Iterable[tuple[str, str]]:
        yield "LengthError", f"There are too {'many or too few bytes' if self.in_bytes else 'many bits'}."
        if self.crc is not None:
            yield "CrcError", "The CRC does not belong to the other bits."
        if any("ConstantError" in item.error for item in self.checks):
            yield "ConstantError", "Bits that always hold the same value, or a parity bit, hold another."
        if any("RangeError" in item.error for item in self.checks) or any("choice(" in line for line in self.locals):
            yield "RangeError", "A field holds a value without meaning."

    def _expected(self, value: Expression | int | str | None) -> str:
        if isinstance(value, Expression):
            return operand(self._text(value, "self.variant"))
        return quoted(value) if isinstance(value, str) else str(value)

    # -------------------------------------------------------------------------------------------------------------------- encode

    def _encode_checks(self) -> list[str]:
        lines = []
        for item in self.layout.fields:
            name = self._attribute(item.name)
            if not item.carries_data or item.kind in ("flag", "text"):
                continue
            if item.name == self.layout.selector:
                if len(self.layout.selects) > 1:
                    listed = ", ".join(f"{value:X}h" for value in self.layout.selects)
                    lines.append(f"if self.{name} not in ({', '.join(map(_number, self.layout.selects))}):")
                    lines.append(f'    raise RangeError("{item.name}", int(self.{name}), "one of {listed}")')
            elif item.kind == "choice":
                lines.append(f'choice({self.module.enum_for(item, self.layout.name)}, "{item.name}", self.{name})')
            elif item.kind == "digits":
                for run in item.digits:
                    lines.append(f'check_limits("{run.name}", self.{self._attribute(run.name)}, (0, {grouped(run.modulus - 1)}))')
            elif item.signed:
                lines.append(f'check_signed("{item.name}", self.{name}, {self._text(item.width)})')
            elif not item.zero_means:
                lines.append(f'check_width("{item.name}", self.{name}, {self._text(item.width)})')
            if item.power_of_two:
                lines.append(f'check_power_of_two("{item.name}", self.{name})')
        if self.register is not None and (self.register.min is not None or self.register.max is not None):
            bounded = self._bounded(self.register)
            if bounded:
                arguments = "variant" if self.takes_variant else ""
                lines.append(f'check_limits("{self.register.limits_of}", self.{bounded}, self.limits({arguments}))')
        return lines

    def _bounded(self, register: Register) -> str:
        """The attribute that the limits bound."""
        names = [item.name for item in self.layout.data_fields] + [item.name for item in self.layout.joins]
        if register.limits_of in names:
            return self._attribute(register.limits_of)
        return self._attribute(self.layout.data_fields[0].name) if len(self.layout.data_fields) == 1 else ""

    def _limits(self) -> tuple[str, str] | None:
        register = self.register
        if register is None or (register.min is None and register.max is None):
            return None
        join = next((item for item in self.layout.joins if item.name == register.limits_of), None)
        names = join.fields if join is not None else (register.limits_of,)
        widths = [item.width for item in self.layout.fields if item.name in names]
        total = sum(widths, Expression(0)) if widths else self.layout.bits
        low = self._text(register.min) if register.min is not None else "0"
        return low, self._text(register.max) if register.max is not None else f"(1 << {operand(self._text(total))}) - 1"

    def _terms(self) -> tuple[list[str], str, str]:
        """The parts that OR together to the number, how it is finished, and what it is called before."""
        cut = self.crc.width if self.crc is not None and self.in_bytes and self.order == "big" else 0
        constants = sum(
            (item.constant or 0) << (item.low.constant - cut) for item in self.layout.fields if item.kind == "constant" and item.low.is_constant
        )
        if self.layout.selector and len(self.layout.selects) == 1:
            constants |= self._fixed(cut)
        terms = [f"0x{constants:X}"] if constants else []
        for item in self.layout.fields:
            term = self._term(item)
            if term:
                terms.append(_shifted(term, self._text(item.low - Expression(cut))))
        if self.crc is None:
            if not self.in_bytes:
                return terms, "return number", "number"
            return terms, f'return number.to_bytes({self.bytes}, "{self.order}")', "number"
        if self.in_bytes:
            size = self.crc.width // 8
            made = f'{self.module.crc_names[self.crc.name]}(body).to_bytes({size}, "{self.order}")'
            return terms, f"return body + {made}", f'body = number.to_bytes({self.bytes - size}, "{self.order}")'
        if self.layout.fold:
            inverted = f" ^ 0x{self.crc.xorout:02X}" if self.crc.xorout else ""
            return terms, f"return number | {self.module._fold(self.crc, self.layout)}(number){inverted}", "number"
        bits = self._text(self.layout.bits - Expression(self.crc.width))
        return terms, f"return number | {self.module._bits_function(self.crc)}(number >> {self.crc.width}, {bits})", "number"

    def _fixed(self, cut: int) -> int:
        """The bits of a selector that has one value only, and of its parity."""
        selector = self.layout.field(self.layout.selector)
        value = self.layout.selects[0]
        number = value << (selector.low.constant - cut)
        for item in self.layout.fields:
            if item.kind == "parity" and item.parity_of == selector.name:
                number |= (value.bit_count() & 1) << (item.low.constant - cut)
        return number

    def _term(self, item: Field) -> str:
        name = f"self.{self._attribute(item.name)}"
        fixed = self.layout.selector if len(self.layout.selects) == 1 else ""
        if fixed and fixed in (item.name, item.parity_of):
            return ""
        if item.kind == "constant":
            return f"0x{item.constant:X}" if item.constant and not item.low.is_constant else ""
        if item.kind == "crc":
            return ""
        if item.kind == "parity":
            return f"(self.{self._attribute(item.parity_of)}.bit_count() & 1)"
        if item.kind == "flag":
            return f"(not {name})" if item.active_low else f"bool({name})"
        if item.kind == "digits":
            return f"({' + '.join(_times(f'self.{self._attribute(run.name)}', run.divisor) for run in item.digits)})"
        if item.kind == "text":
            return f'text_number("{item.name}", {name}, {item.width.constant // 8})'
        if item.signed:
            return f"({name} & {self._mask(item.width)})"
        if item.zero_means:
            return f'zero_for("{item.name}", {name}, {grouped(item.zero_means)}, {self._text(item.width)})'
        return name

    # ------------------------------------------------------------------------------------------------------------- joins and more

    def _join(self, join: Join, attributes: Sequence[_Attribute]) -> _Joined:
        fields = [self.layout.field(name) for name in join.fields]
        terms: list[str] = []
        parts: list[_Part] = []
        below = Expression(0)
        name = self._attribute(join.name)
        for item in reversed(fields):
            terms.insert(0, _shifted(f"self.{self._attribute(item.name)}", self._text(below, "self.variant")))
            shifted = name if below == Expression(0) else f"{name} >> {operand(self._text(below))}"
            value = shifted if item is fields[0] else f"{shifted} & {self._mask(item.width)}"
            parts.insert(0, _Part(self._attribute(item.name), value))
            below = below + item.width
        names = {part.name for part in parts}
        listed = " and ".join(f"``{part.name}``" for part in parts)
        doc = docstring(f"{listed} as one number, ``{parts[0].name}`` most significant." if len(parts) > 1 else f"The same as {listed}.", indent=8)
        others = tuple(item for item in attributes if item.name not in names)
        arguments = ["variant: Variant"] if self.takes_variant else []
        arguments += [f"{name}: int", *(f"{item.name}: {item.type}{' = ' + item.default if item.default else ''}" for item in others)]
        signature = f"    def from_{name}(cls, {', '.join(arguments)}) -> {self.name}:"
        if len(signature) > WIDTH:
            signature = f"    def from_{name}(\n        cls,\n" + "".join(f"        {item},\n" for item in arguments) + f"    ) -> {self.name}:"
        return _Joined(name, doc, " | ".join(terms), self._text(below), signature, tuple(parts), others)

    def _gray(self) -> tuple[str, str, str] | None:
        """When a part is sent in Gray code, its place, and what it stands in."""
        if not self.layout.gray_when:
            return None
        join = next((item for item in self.layout.joins if item.name == self.layout.gray_of), None)
        fields = [self.layout.field(name) for name in (join.fields if join is not None else (self.layout.gray_of,))]
        width = sum((item.width for item in fields), Expression(0))
        name = self.module.parameter_names[self.layout.gray_when]
        return f"variant.{name}", f"{self._text(fields[-1].low)}, {self._text(width)}", self.source

    def _fixed_selector(self) -> Iterable[tuple[str, str, str, str]]:
        if self.layout.selector and len(self.layout.selects) == 1:
            item = self.layout.field(self.layout.selector)
            named = next((value for value in item.values if value.value == self.layout.selects[0]), None)
            doc = docstring(sentence(item.meaning or item.printed_name or item.name), indent=8)
            if named is not None:
                enum = self.module.enum_for(item, self.layout.name)
                yield self._attribute(item.name), enum, doc, f"{enum}.{named.name.upper()}"
            else:
                yield self._attribute(item.name), "int", doc, _number(self.layout.selects[0])

    def _wholes(self) -> Iterable[tuple[str, str, str, str]]:
        """Numbers that are read as runs of digits, as a whole."""
        for item in self.layout.fields:
            if item.kind == "digits" and item.name not in {run.name for run in item.digits}:
                runs = ", ".join(f"``{self._attribute(run.name)}``" for run in item.digits)
                value = " + ".join(_times(f"self.{self._attribute(run.name)}", run.divisor) for run in item.digits)
                yield self._attribute(item.name), "int", docstring(f"The digits of {runs}, as one number.", indent=8), value

    def _documented(self) -> Iterable[tuple[str, str, str, str]]:
        expected = [item for item in self.layout.fields if item.equals is not None]
        if expected:
            listed = ", ".join(f"{item.name} {item.equals.render() if isinstance(item.equals, Expression) else repr(item.equals)}" for item in expected)
            value = " and ".join(f"self.{self._attribute(item.name)} == {self._expected(item.equals)}" for item in expected)
            yield "is_as_documented", "bool", docstring(f"Whether it holds what the manual says: {listed}.", indent=8), value


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


def _bare(text: str) -> str:
    """``text`` without parentheses around the whole of it."""
    return text[1:-1] if text.startswith("(") and text.endswith(")") and ")" not in text[:-1] else text


def _note(item: Field) -> str:
    """What a reader should know of a field that is not there for everybody, or that others explain."""
    texts = ["Not implemented." if not item.implemented else "", f"Reserved for the {item.reserved}." if item.reserved else ""]
    texts.append(f"0 on the wire stands for {item.zero_means}." if item.zero_means else "")
    texts.append("Only powers of two." if item.power_of_two else "")
    texts.append(f"Explained by {', '.join(item.explained_by)}." if item.explained_by else "")
    return " ".join(filter(None, texts))


def _with_defaults(attributes: Sequence[_Attribute]) -> list[_Attribute]:
    """The attributes; flags at the end are false unless given."""
    made: list[_Attribute] = []
    for item in reversed(attributes):
        trailing = all(other.default for other in made)
        made.insert(0, _Attribute(item.name, item.type, item.value, item.meaning, "False") if trailing and item.type == "bool" else item)
    return made


def _meaning(item: Field, may_be_missing: bool) -> str:
    texts = []
    if item.kind == "flag":
        texts.append(f"True: {item.when_active or 'active'}; False: {item.when_inactive or 'not active'}; {'low' if item.active_low else 'high'} active")
        texts.append(item.meaning)
    else:
        unit = f" ({item.unit})" if item.unit and item.unit not in item.meaning else ""
        texts.append(f"{(item.meaning or item.printed_name or item.name.replace('_', ' ')).rstrip('.')}{unit}")
    if may_be_missing:
        texts.append("0 where the encoder has none")
    texts += [_note(item), item.note]
    return " ".join(sentence(text) for text in texts if text)


def _timing(item: Timing) -> Call:
    return record(
        "Timing", {"name": item.name, "meaning": item.meaning}, at_least_us=item.at_least_us, typical_us=item.typical_us, at_most_us=item.at_most_us,
        symbol=item.symbol, source=cite(item.source),
    )


def _from_pieces(pieces: Sequence[Piece], length: int = 0) -> str:
    """The number that the pieces make."""
    whole = all(piece.right == 0 and piece.mask == 0xFF for piece in pieces)
    places = [piece.byte for piece in pieces]
    if whole and len(pieces) > 3:
        if places == list(range(places[0], places[0] + len(places))):
            return _int_from(places[0], places[-1], length, "little")
        if places == list(range(places[0], places[0] - len(places), -1)):
            return _int_from(places[-1], places[0], length, "big")
    return " | ".join(map(_from_piece, pieces))


def _int_from(first: int, last: int, length: int, order: str) -> str:
    part = "data" if first == 0 and last == length - 1 else f"data[{first}:{last + 1}]"
    return f'int.from_bytes({part}, "{order}")'


def _from_piece(piece: Piece) -> str:
    text = f"data[{piece.byte}]"
    if piece.right:
        text += f" >> {piece.right}"
    if piece.mask << piece.right & 0xFF != 0xFF >> piece.right << piece.right:
        text += f" & 0x{piece.mask:X}"
    if not piece.left:
        return text
    return f"{text} << {piece.left}" if text.endswith("]") else f"({text}) << {piece.left}"


def _compared(raw: str) -> str:
    """``raw`` in parentheses where a reader might not be sure that it is taken before a comparison."""
    return f"({raw})" if " " in raw else raw


def _digits(local: str, run: Digits, first: bool) -> str:
    text = local if run.divisor == 1 else f"{local} // {grouped(run.divisor)}"
    return text if first else f"{text} % {grouped(run.modulus)}"


def _times(value: str, factor: int) -> str:
    return value if factor == 1 else f"{value} * {grouped(factor)}"


def _shifted(term: str, low: str) -> str:
    return term if low == "0" else f"{term} << {operand(low)}"


def _number(value: int) -> str:
    return str(value) if value < 10 else f"0x{value:X}"


def _among(value: str, values: Sequence[int]) -> str:
    return f"{value} == {_number(values[0])}" if len(values) == 1 else f"{value} in ({', '.join(map(_number, values))})"
