"""Data in a generated module: tables with the facts of a device, and descriptions of frames for ``decode_many``.

The classes of the records are read from their source, so no separate list of members is needed: a member of the
class is printed if the model has it, and an enumeration or another record is printed according to its type.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import Any

from ...model import (
    Alarm,
    Biss,
    Device,
    Fault,
    Field,
    Interface,
    Layout,
    OrderCode,
    Register,
    Rs485,
    Scale,
    Spi,
    Ssi,
    Verdict,
    assert_never,
    cite,
)
from ...model.expressions import Expression
from ...model.members import PARTS_BY_CLASS
from ...model.record import dataclass
from ...plan.codec import Codec, allowed_values, codec_of
from ...plan.description import Answered, Column, Name, describe
from ...plan.limits import powers_of_two
from ...plan.operations import FrameCrc
from ...plan.values import is_named, is_number, meaning_of, position_ranges
from ...plan.verdicts import Only, Reporting, reports_of, verdict_of
from ...say.plain_text import plain
from ...say.report import alarm_of, meaning, remedy, source, states
from ..registry import our_runtime
from .bits import others
from .codec import Coder
from .decode import holding
from .literals import (
    Call,
    Code,
    ConditionalItem,
    Hex,
    Literal,
    Member,
    is_empty,
    joined,
    literal,
    literal_call,
    of_facts,
    quoted,
    record,
)
from .names import byte_order

#: Sources with classes of records and enumerations.
_RUNTIME = our_runtime("python") / "codewheel_runtime"
_SOURCES = (_RUNTIME / "facts.py", _RUNTIME / "order_codes.py", _RUNTIME / "reports.py")
#: Records whose required members are printed without their names.
_POSITIONAL = frozenset(
    "Contact Document Edition Family LedState LostFigure NamedValue PrintedTimeout RegisterMeaning Revision"
    " SpelledValue".split()
)
#: Members that are printed last, although members that were added later follow them in the class.
_LAST: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"SsiFacts": ("timings", "note", "source"), "ControlField": ("values", "source")}
)
_NOTHING = object()


@dataclass(frozen=True)
class RecordMember:
    """A member of a record: the names in its type, and its default. A required member has no default."""

    name: str
    types: frozenset[str]
    default: object


@dataclass(frozen=True)
class Records:
    """The members of each record, and the names of the enumerations."""

    members: Mapping[str, tuple[RecordMember, ...]]
    enumerations: frozenset[str]


@cache
def records() -> Records:
    """Return all records and enumerations of the runtime."""
    classes = [class_def for path in _SOURCES for class_def in _classes(path.read_text(encoding="utf-8"))]
    bases = {class_def.name: set(map(ast.unparse, class_def.bases)) for class_def in classes}
    record_classes = (class_def for class_def in classes if "NamedTuple" in bases[class_def.name])
    enumerations = (name for name, base_names in bases.items() if "Enum" in base_names)
    return Records(
        members={class_def.name: tuple(_members(class_def)) for class_def in record_classes},
        enumerations=frozenset(("Interface", *enumerations)),
    )


def _classes(source: str) -> Iterator[ast.ClassDef]:
    yield from (node for node in ast.parse(source).body if isinstance(node, ast.ClassDef))


def _members(class_def: ast.ClassDef) -> Iterator[RecordMember]:
    for node in class_def.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [name_node.id for name_node in ast.walk(node.annotation) if isinstance(name_node, ast.Name)]
            is_literal = isinstance(node.value, (ast.Constant, ast.Tuple))
            default = ast.literal_eval(node.value) if node.value is not None and is_literal else None
            yield RecordMember(node.target.id, frozenset(names), default if node.value is not None else _NOTHING)


def row(function: str, model_object: object, **overrides: Literal) -> Call:
    """Return a record of a part of the model: all required members, and the others that differ from the default.

    Args:
        function: Name of the record.
        model_object: The part of the model, which has members of the same names.
        overrides: Values that replace those of the part.
    """
    arguments: list[tuple[str, Literal]] = []
    last = _LAST.get(function, ())
    for member in sorted(records().members[function], key=lambda record_member: record_member.name in last):
        value = overrides[member.name] if member.name in overrides else _value(model_object, member)
        if member.default is _NOTHING:
            arguments.append(("" if function in _POSITIONAL else member.name, value))
        elif value != member.default and not is_empty(value):
            arguments.append((member.name, value))
    return Call(function, tuple(arguments))


def rows(function: str, model_objects: tuple[object, ...]) -> tuple[Call, ...]:
    """Return a record for each item."""
    return tuple(row(function, model_object) for model_object in model_objects)


def _value(model_object: object, member: RecordMember) -> Literal:
    content = getattr(model_object, member.name)
    if member.name == "source":
        return cite(content)
    for record_name in member.types & records().members.keys():
        if isinstance(content, tuple):
            return rows(record_name, content)
        return row(record_name, content) if content is not None else None
    for kind in member.types & records().enumerations:
        if isinstance(content, tuple):
            return tuple(Member(kind, name) for name in content)
        return Member(kind, content) if content else None
    if isinstance(content, Expression):
        return content.render()
    part = PARTS_BY_CLASS.get(type(model_object).__name__)
    described = part.by_attribute.get(member.name) if part is not None else None
    if described is not None and described.shape == "hex" and isinstance(content, int):
        return Hex(content)
    value: Literal = content
    return value


#: Tables at the end of a module: comment, name, which is also that of the section of the model, and record.
_TABLES = (
    (
        "Errors and warnings: their meaning, whether they are latched, and the procedures that clear them.",
        "ALARMS",
        "Alarm",
    ),
    ("Timings of the encoder as a whole.", "TIMINGS", "Timing"),
    ("Connectors and cables, contact by contact.", "CONNECTORS", "Connector"),
    ("LEDs and the meaning of their states.", "LEDS", "Led"),
    ("Hardware inputs.", "INPUTS", "Input"),
    ("Tables of the manual.", "TABLES", "Table"),
    ("Further facts of the manual, as text.", "CHARACTERISTICS", "Characteristic"),
    ("Content of figures that is missing from the text of the manual.", "LOST_FIGURES", "LostFigure"),
    ("Errors and ambiguities in the manual, with the text that is used instead.", "ERRATA", "Erratum"),
    ("Documents that sources cite by key.", "DOCUMENTS", "Document"),
)
#: Tables that every module has, even empty.
_ALWAYS = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


@dataclass(frozen=True)
class Table:
    """Table of a module: comment, name, class of the rows, and rows."""

    comment: str
    name: str
    kind: str
    rows: Sequence[Call]


# -- the device


def family(device: Device) -> Call:
    return literal_call(
        "Family",
        device.name,
        plain(device.title),
        Member("Movement", device.movement),
        plain(device.manufacturer.title),
    )


def order_code(code: OrderCode) -> Call:
    parts = tuple(row("Part", part, open_only_with=_allowed_combinations(part.open_only_with)) for part in code.parts)
    return row("OrderCode", code, parts=parts)


def _allowed_combinations(allowed: Mapping[str, tuple[str, ...]]) -> Call | None:
    """Return the values of other parts with which a part can be combined."""
    if not allowed:
        return None
    values_by_part = ", ".join(f"{quoted(name)}: ({', '.join(map(quoted, texts))},)" for name, texts in allowed.items())
    return Call("ReadOnly", (("", Code(f"{{{values_by_part}}}")),))


def tables(device: Device) -> list[Table]:
    """Return the tables at the end of a module."""
    tables_of_device = [_table(device, *table) for table in _TABLES]
    return [table for table in tables_of_device if table.rows or table.name in _ALWAYS]


def _table(device: Device, comment: str, name: str, kind: str) -> Table:
    return Table(comment, name, kind, rows(kind, getattr(device, name.lower())))


def reports(device: Device) -> list[Call]:
    """Return the reports of the encoder in frames of the family."""
    return [_report(report.name, report.field, alarm_of(device, report.field)) for report in reports_of(device)]


def _report(name: str, field: Field, alarm: Alarm | None) -> Call:
    verdict = verdict_of(field)
    return record(
        "Report",
        {"name": name, "printed_name": field.printed_name, "meaning": meaning(field, alarm)},
        remedy=remedy(field, alarm),
        makes_position=Member("Verdict", verdict.name) if verdict is not None else None,
        source=cite(source(field, alarm)),
    )


# -- interfaces


def interface(interface: Interface) -> Call:
    match interface:
        case Ssi():
            code = interface.output_code
            return row(
                "SsiFacts",
                interface,
                alignment=Member("Alignment", interface.alignment.end),
                output_code=code.code if code is not None else "",
                alignment_source=cite(interface.alignment.source),
                output_code_source=cite(code.source) if code is not None else "",
            )
        case Biss():
            return row("BissFacts", interface)
        case Rs485():
            memory = tuple(row("MemoryAccess", access, busy=bool(access.busy)) for access in interface.memory_access)
            return row("Rs485Facts", interface, memory_access=memory)
        case Spi():
            return row("SpiFacts", interface)
        case _:
            assert_never(interface)


# -- fields and registers


def _field(codec: Codec, field: Field) -> Call:
    when_active, when_inactive = states(field)
    reserved = {reserved.field.name: reserved.value for reserved in codec.reserved}
    return row(
        "FieldFacts",
        field,
        **of_facts(meaning_of(field)),
        when_active=when_active,
        when_inactive=when_inactive,
        constant=codec.constants.get(field.name),
        unused=reserved.get(field.name),
        power_of_two=field.name in powers_of_two(codec),
    )


def _fields(codec: Codec) -> tuple[Call, ...]:
    """Return the facts of each field."""
    return tuple(_field(codec, field) for field in codec.layout.fields)


def _is_one_number(layout: Layout) -> bool:
    """Return whether a register is a single number of the same name."""
    first = layout.fields[0]
    is_single_field = len(layout.fields) == 1 and first.name == layout.name and first.carries_data
    return is_single_field and is_number(meaning_of(first))


def frame_rows(device: Device) -> dict[str, tuple[Call, ...]]:
    """Return the facts of the fields of frames, by the name of the frame."""
    return {layout.name: _fields(codec_of(device, layout)) for _, layout in device.layouts()}


def register_rows(device: Device) -> dict[str, Call]:
    return {register.name: _register(device, register) for register in device.registers}


def _register(device: Device, register: Register) -> Call:
    return row(
        "Register",
        register,
        default=register.default_bytes(),
        wait_ms=register.wait_at_least_ms,
        fields=() if _is_one_number(register.layout) else _fields(codec_of(device, register.layout)),
    )


#: Number of members that are printed without their names, by class.
_POSITIONAL_COUNTS = {"BitField": 1, "Column": 1, "Join": 1, "VerdictCause": 1, "ReportCause": 1}
#: Names of classes and members in the runtime, if they differ from those of the plan.
_RUNTIME_NAMES = {
    "Speaks": "VerdictCause",
    "Tells": "ReportCause",
    "speaks": "verdict_causes",
    "tells": "report_causes",
    "answered": "chosen_verdict",
}
#: Members that say for which encoders a cause applies.
_CONDITIONS = ("only", "chosen")


class Shape:
    """Description of one frame, as used by its template."""

    def __init__(self, coder: Coder, reporting: Reporting | None) -> None:
        self.coder, self.plan = coder, coder.plan
        self._of = describe(coder.plan, reporting)
        self.name = f"shape_of_{'register_' if coder.register is not None else ''}{coder.layout.name}"

    #: Members whose items are on separate lines.
    rows = ("columns", "joins", "unused", "checks", "parities", "verdict_causes", "report_causes", "fields")
    _planned_rows = ("joins", "unused", "checks", "parities", "speaks", "tells", "fields")

    @property
    def members(self) -> list[tuple[str, Literal]]:
        """Members that are not empty, by name, in the order in which they are printed."""
        return [(name, value) for name, value in self._members() if value not in (None, 0, "", ())]

    def _members(self) -> Iterator[tuple[str, Literal]]:
        described, coder, register = self._of, self.coder, self.coder.register
        data = {part.field.name for part in self.plan.parts}
        yield from (("bits", self._shown(described.bits)), ("length", described.length), ("order", described.order))
        yield "columns", tuple(self._column(column) for column in described.columns if column.name in data)
        for name in self._planned_rows:
            # The class of a register checks its values.
            values = self._shown(getattr(described, name)) if name != "checks" or register is None else ()
            yield _RUNTIME_NAMES.get(name, name), values
        yield "crc", self._crcs(described.crcs)
        if described.gray is not None:
            bits = literal(self._shown((described.gray.low, described.gray.width)))
            yield "gray", Code(f"{bits} if variant.{coder.gray_when} else None" if coder.gray_when else str(bits))
            yield "excess", self._shown(described.gray.excess)
        terms = [f"{value:#x} << {coder.number(place.low)}" for place, value in described.fixed]
        if len(terms) > 1:
            terms = [f"({term})" for term in terms]
        yield "fixed", Code(" | ".join(terms)) if terms else None
        yield "position", coder.measured
        if self.plan.keeps_others:
            yield "kept_mask", Code(str(others(coder.context.scope, self.plan)))
        yield "limited", (register.limits_of, coder.limited) if register is not None and coder.limited else ()
        yield "default_verdict", self._otherwise
        yield "frame", self._frame

    @property
    def _otherwise(self) -> Literal:
        """Verdict if no condition applies. Without bits that judge the position, it is unknown."""
        shown = self._shown(self._of.otherwise)
        if self._of.judging_bits is None:
            return shown
        judging_bits = self.coder.number(self._of.judging_bits)
        return Code(f"{literal(shown)} if {judging_bits} else {literal(self._shown(Verdict.UNKNOWN))}")

    @property
    def _frame(self) -> str:
        """Name of the frame, if its positions have another range than those of other frames."""
        coder = self.coder
        if coder.register is not None or not coder.measured:
            return ""
        interface = coder.context.device.interface(coder.layout_interface)
        ranges = position_ranges(coder.context.device, interface)
        is_special = len(ranges) > 1 or any(position_range.never_wraps for position_range in ranges)
        return coder.layout.name if is_special else ""

    def _column(self, shape_column: Column) -> Call:
        """Return a column with its name in messages, if that differs, and the only values of its field."""
        field, name = self.coder.layout.field(shape_column.name), self.coder.names.attribute(shape_column.name)
        values: Literal = Code(self.coder.enum(field)) if is_named(meaning_of(field)) else None
        if self.coder.selects(field):
            values = allowed_values(self.coder.layout, field)
        column_call = self._record(shape_column)
        return record(
            "Column",
            dict(column_call.arguments),
            field=shape_column.name if shape_column.name != name else "",
            values=values,
        )

    def _crcs(self, crcs: Sequence[FrameCrc]) -> Literal:
        """Return the CRC of an encoder. None without one."""
        if not crcs:
            return None
        if not crcs[0].is_optional:
            return self._crc(crcs[0])
        choices = tuple(ConditionalItem(self._crc(crc), str(self.coder.number(crc.field.width))) for crc in crcs)
        return literal_call("next", literal_call("iter", choices), Code("None"))

    def _crc(self, frame_crc: FrameCrc) -> Call:
        """Return the CRC with the function that compares it, and the means to compute it for many frames."""
        crc, coder = frame_crc.crc, self.coder
        members: dict[str, Literal] = {"low": self._shown(frame_crc.bits.low), "width": crc.width}
        if coder.layout.crc_covers_bytes:
            place = f'length={self.plan.length}, width={crc.width // 8}, order="{byte_order(coder.layout)}"'
            members["differs"] = Code(f"compare_bytes({coder.crc_name(frame_crc)}, {place})")
            members |= {"xorout": crc.xorout, "is_xor": True} if crc.is_xor else {}
        else:
            gap = f", gap={frame_crc.gap}" if frame_crc.gap else ""
            place = f"covered={coder.number(frame_crc.covered)}, width={crc.width}{gap}"
            members["differs"] = Code(f"compare_bits({coder.crc_name(frame_crc)}, {place})")
            folds = tuple(
                Call("Fold", (("shift", step.shift), ("mask", Hex(step.mask)), ("back", step.back)))
                for step in frame_crc.steps
            )
            members |= {"xorout": crc.xorout, "steps": folds} if folds else {}
        return Call("CrcOf", tuple(members.items()))

    def _shown(self, value: Any) -> Literal:
        """Return any part of the description as a literal."""
        match value:
            case Expression():
                return Code(str(self.coder.number(value)))
            case Name():
                return self.coder.names.attribute(value)
            case Enum():
                return Member("ErrorKind" if isinstance(value, Fault) else type(value).__name__, value.name)
            case Scale(numerator, denominator, offset, unit):
                # Without the class, whose name a register may have.
                return (numerator, denominator, offset, unit)
            case tuple():
                return tuple(map(self._shown, value))
            case None | bool() | int() | str():
                return value
            case Answered(parameter, verdict):
                return Code(f"Verdict.{verdict.name} if {self._member(parameter)} else None")
        conditions: list[Only | None] = [getattr(value, name, None) for name in _CONDITIONS]
        holds = [holding(only, self._member(only.parameter)) for only in conditions if only is not None]
        return ConditionalItem(self._record(value), str(joined("and", holds))) if holds else self._record(value)

    def _member(self, parameter: str) -> str:
        return f"variant.{self.coder.context.parameters[parameter]}"

    def _record(self, part: Any) -> Call:
        """Return the call of the class of the same name. A cause other than a flag has no name."""
        kind = _RUNTIME_NAMES.get(type(part).__name__, type(part).__name__)
        is_flag = not getattr(part, "mask", 0) and not getattr(part, "when", ())
        omitted = _CONDITIONS if is_flag else (*_CONDITIONS, "flag")
        members = [(member, getattr(part, member.name)) for member in fields(part) if member.name not in omitted]
        given_members = [(member.name, value) for member, value in members if value != member.default]
        arguments = [(_RUNTIME_NAMES.get(name, name), self._shown(value)) for name, value in given_members]
        count = _POSITIONAL_COUNTS.get(kind, 0)
        positional = [("", value) for _, value in arguments[:count]]
        return Call(kind, (*positional, *arguments[count:]))
