"""A device module: names for everything in it, and every part of it as the template prints it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from ..model import Crc, Device, Erratum, Field, Interface, Layout, Register, Value, cite
from ..render import plain
from ..words import sentence
from .python_expressions import (
    CODEC_FUNCTIONS, LOCAL_NAMES, REGISTER_FUNCTIONS, STEP_FUNCTIONS, among, from_pieces, interface_name, number_text,
)
from .python_facts import constant, crc_record, family, frame_rows, interface_facts, manual, register_rows, table, tables
from .python_layout import CodecBuilder
from .python_procedures import ProcedureBuilder
from .python_readme import Readme
from .python_source import WIDTH, Block, Lines, Names, attribute, camel, docstring, quoted, used_names
from .python_variants import Variants
from .python_views import Branch, Codec, CrcFunction, Dispatch, Enumeration, Fold, Section

#: What the package's modules are called that hold no device.
SHARED = ("_codec", "_facts", "_order_codes", "_registers", "_steps")

#: The module for register access over BiSS, in packages with a family that speaks it.
BISS = "biss"

#: Names that every device module uses for itself, besides what it imports.
_MODULE = (
    "ALARMS", "Address", "Any", "ArithmeticError", "BISS", "CHARACTERISTICS", "CONNECTORS", "ClassVar", "CRCS", "DOCUMENTS", "ERRATA", "Ellipsis", "Exception",
    "FAMILY", "FRAMES", "Final", "Frame", "INPUTS", "IntEnum", "LEDS", "LOST_FIGURES", "MANUAL", "Mapping", "MappingProxyType", "NamedTuple", "NotImplemented",
    "ORDER_CODE", "REGISTERS", "RS485", "Reply", "Request", "SSI", "TABLES", "TIMINGS", "TypeAlias", "Union", "VARIANTS", "ValueError", "Variant",
    "TypeError", "Warning", "Write", "annotations", "dataclasses", "decode_reply", "decode_request", "identify", "index", "isinstance", "len", "lookup",
    "overload", "type",
)

#: What a device module imports from its neighbours, where it needs it.
_IMPORTS = (
    (
        "._codec",
        (
            "BitField", "ConstantError", "CrcError", "Data", "Interface", "LengthError", "RangeError", "Word",
            *CODEC_FUNCTIONS,
        ),
    ),
    (
        "._facts",
        (
            "Alarm", "BissFacts", "CableLength", "Characteristic", "Clock", "Connector", "Contact", "ControlField", "Crc", "DataIdFacts", "Document",
            "Edition", "Erratum", "Family", "FieldFacts", "Input", "Led", "LedState", "LostFigure", "Manual", "MemoryAccess", "NamedValue", "Network", "Port",
            "PrintedTimeout", "ReadOnly", "Register", "RegisterMeaning", "Revision", "Rs485Facts", "SsiFacts", "Table", "Timeout", "Timing",
        ),
    ),
    ("._order_codes", ("OrderCode", "Part", "PartValue", "SpelledValue", "Spelling")),
    ("._registers", ("Held", *REGISTER_FUNCTIONS)),
    ("._steps", ("Modify", "Poll", "Read", "Send", "Step", "Wait", *STEP_FUNCTIONS)),
)

#: What it imports from the standard library, where it needs it.
_STANDARD = (
    ("collections.abc", ("Mapping",)),
    ("enum", ("IntEnum",)),
    ("operator", ("index",)),
    ("types", ("MappingProxyType",)),
    ("typing", ("Any", "ClassVar", "Final", "NamedTuple", "TypeAlias", "Union", "overload")),
)

#: What a module offers: its classes and functions, and its constants.
_PUBLIC = re.compile(r"^(?:class |def )?([A-Za-z]\w*)(?=[(:])", re.MULTILINE)

#: Words of names that have a spelling of their own.
_SPELLED = {"biss": "BiSS", "crc": "CRC", "eeprom": "EEPROM", "id": "ID", "ssi": "SSI"}

#: Names that the class of the variants uses for itself.
_VARIANT = ("bytes", "cls", "code", "decode", "degrees", "family", "frame_bits", "interface", "micrometres", "millimetres", "modulus", "parts", "self", "special", "special_code", "tail",
            "turns", "unlisted", "unwrap", "with_registers")


@dataclass
class Module:
    """Everything that the template of a device module prints."""

    device: Device
    taken: Names = field(default_factory=lambda: Names([*_MODULE, *(name for _, names in _IMPORTS for name in names)]))

    def __post_init__(self) -> None:
        device = self.device
        self.name = attribute(device.name, (*SHARED, BISS))
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
        self.procedures = tuple(ProcedureBuilder(self, item).build() for item in device.procedures)
        self.crcs = tuple(function for item in device.crcs for function in self._crc_functions(item))
        self.family, self.manual, self.tables = family(device), manual(device), tables(device)
        self.register_table, self.frame_table = register_rows(device), frame_rows(device)
        self.codes = Variants(self)
        self.readme = Readme(self)

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
            *self._example(),
            " ".join(self.device.manufacturer.trademarks),
        )

    def _example(self) -> Iterable[Block]:
        """A few lines that decode a frame and look at its flags before they use it."""
        for frame in self.readme.frames[:1]:
            if frame.flags:
                yield "A sound frame can report a fault of the encoder. Look at its flags before you use the position:"
            yield Lines((f'encoder = lookup("{frame.code}")', f"frame = encoder.decode({frame.text})", *frame.lines))

    def errata(self, path: str) -> list[Erratum]:
        """The errata of exactly this path and of what lies below it."""
        return [item for item in self.device.errata if any(other == path or other.startswith(f"{path}.") for other in item.affects)]

    def erratum_paragraphs(self, errata: Iterable[Erratum]) -> list[str]:
        """What a reader of the code has to know of errata; slips of wording are in the table alone."""
        found = []
        for item in errata:
            if item.severity == "wording":
                continue
            found.append(f"Erratum {item.name}, {item.status} ({cite(item.source)}). Printed: {sentence(item.printed)} Used: {sentence(item.used)}")
        return found

    def imports(self, body: str) -> list[str]:
        """The import statements that ``body`` needs."""
        used = used_names(body)
        statements = []
        for module, names in (*_STANDARD, *_IMPORTS):
            if module == _IMPORTS[0][0]:
                statements.append("")
            needed = [name for name in names if name in used]
            if needed:
                line = f"from {module} import {', '.join(needed)}"
                statements.append(line if len(line) <= WIDTH else f"from {module} import (\n" + "".join(f"    {name},\n" for name in needed) + ")")
        return statements

    def public(self, body: str) -> str:
        """The statement that names what the module offers."""
        names = sorted(set(_PUBLIC.findall(body)))
        return "__all__ = [\n" + "".join(f"    {quoted(name)},\n" for name in names) + "]"

    @property
    def interface_names(self) -> list[tuple[str, str]]:
        """The module's own name for each interface, and its member of the Enum."""
        return [(interface_name(item.kind), f"Interface.{item.kind.upper()}") for item in self.device.interfaces]

    # -------------------------------------------------------------------------------------------------------------------- CRCs

    @property
    def crc_table(self) -> str:
        return table("CRCS", "Crc", [crc_record(item) for item in self.device.crcs])

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
        codecs = tuple(
            self._codec(item, self.classes[f"layout {item.name}"], self._layout_doc(interface, item), interface.kind)
            for item in interface.layouts
        )
        kind = interface.kind.upper()
        here = f"interfaces.{interface.kind}"
        layouts = {f"{here}.{item.name}" for item in interface.layouts}
        errata = [item for item in self.errata(here) if any((path == here or path.startswith(f"{here}.")) and path not in layouts for path in item.affects)]
        notes = tuple(self.erratum_paragraphs(errata))
        return Section(interface.title, kind, constant(kind, interface_facts(interface)), notes, codecs, tuple(self._dispatches(interface, codecs)))

    def _layout_doc(self, interface: Interface, layout: Layout) -> tuple[str, list[Block]]:
        words = [_SPELLED.get(word, word) for word in layout.name.split("_")]
        title = " ".join([words[0][:1].upper() + words[0][1:], *words[1:]])
        carried = "as a string of bits" if layout.carried_as == "bits" else "as bytes"
        summary = f"{title}: sent by the {layout.sender} over {interface.title}, {carried} ({cite(layout.source)})."
        printed = f"In the manual: {sentence(layout.printed_name)}" if layout.printed_name else ""
        errata = self.errata(f"interfaces.{interface.kind}.{layout.name}")
        groups = dict.fromkeys(item.group for item in layout.fields if item.group)
        shared = dict.fromkeys(item.name for name in groups for item in self.errata(f"field_groups.{name}") if item not in errata)
        more = f"Of its parts, see ERRATA: {', '.join(shared)}." if shared else ""
        return summary, [printed, sentence(layout.note), *self.erratum_paragraphs(errata), more]

    def _codec(
        self, layout: Layout, name: str, doc: tuple[str, list[Block]], interface: str, register: Register | None = None
    ) -> Codec:
        return CodecBuilder(self, layout, name, doc, interface, register).build()

    def _dispatches(self, interface: Interface, codecs: Sequence[Codec]) -> Iterable[Dispatch]:
        several = sum(any(item.selector for item in other.layouts) for other in self.device.interfaces) > 1
        for sender, word in (("master", "request"), ("encoder", "reply")):
            members = [item for item in codecs if item.layout.sender == sender]
            if not members or not members[0].layout.selector:
                continue
            prefix = f"{interface.kind}_" if several else ""
            own_name = interface_name(interface.kind)
            yield self._dispatch(f"decode_{prefix}{word}", camel(f"{prefix}{word}"), own_name, members)

    def _dispatch(self, name: str, union: str, interface: str, members: Sequence[Codec]) -> Dispatch:
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
                ("FamilyError", "The encoder is of another family."),
                ("InterfaceError", "The encoder has another interface."),
            ]),
            indent=4,
        )
        listed = ", ".join(f"{item:X}h" for item in sorted(allowed))
        return Dispatch(
            name, interface, union, tuple(item.name for item in members), doc, least, selector.name, local, from_pieces(selector.pieces), tuple(branches), quoted(f"one of {listed}" if len(allowed) > 1 else listed), fallback,
        )

    # ---------------------------------------------------------------------------------------------------------------- registers

    def _register_view(self, register: Register) -> Codec | Enumeration:
        name = self.classes[f"register {register.name}"]
        summary = f"{register.printed_name or register.name.replace('_', ' ').capitalize()}, {self._where(register)}."
        blocks: list[Block] = [sentence(register.meaning), *self._register_notes(register), sentence(register.note), *self.erratum_paragraphs(self.errata(f"registers.{register.name}"))]
        only = register.layout.fields[0]
        if register.values and only.kind == "choice" and only.width == register.layout.bits:
            order = "little" if register.byte_order == "low_byte_first" else "big"
            return self._enum(name, summary, register.values, *blocks, length=register.length, order=order)
        return self._codec(register.layout, name, (summary, blocks), register.interface, register)

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
            place = f"{register.opened_by}.{register.opened_by_field}" if register.opened_by_field else register.opened_by
            notes.append(f"Can be written while {place} holds {register.opened_by_value}.")
        if register.clears_itself:
            notes.append("Goes back to its default by itself after a write.")
        if register.wait_at_least_ms:
            notes.append(f"Wait at least {register.wait_at_least_ms} ms after a write.")
        if register.volatile:
            notes.append("To be kept over power-off, a written value has to be saved.")
        return [" ".join(notes)] if notes else []

    @property
    def addresses(self) -> list[tuple[str, str]]:
        return [(item.name.upper(), f"0x{item.address:02X}") for item in self.device.registers]
