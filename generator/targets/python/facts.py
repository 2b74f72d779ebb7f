"""Tables of a generated module that hold the facts of a device, and the records in them.

The classes of the records are read from their source, so no separate list of members is needed: a member of the
class is printed if the model has it, and an enumeration or another record is printed according to its type.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from types import MappingProxyType

from ...model import (
    Alarm,
    Biss,
    Device,
    Field,
    Interface,
    Layout,
    OrderCode,
    Register,
    Rs485,
    Spi,
    Ssi,
    assert_never,
    cite,
)
from ...model.expressions import Expression
from ...model.members import PARTS_BY_CLASS
from ...model.record import dataclass
from ...plan.codec import Codec, codec_of
from ...plan.limits import powers_of_two
from ...plan.values import is_number, meaning_of
from ...plan.verdicts import reports_of, verdict_of
from ...say.plain_text import plain
from ...say.report import alarm_of, meaning, remedy, source, states
from ..shared_files import our_runtime
from .literals import Call, Code, Hex, Literal, Member, call, is_empty, of_facts, quoted, record

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
    return call(
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
