"""The tables of facts in a generated module, and records: calls such as ``Register(name="preset", address=0x40)``."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from types import MappingProxyType

from ...model import (
    Alarm,
    Biss,
    Clock,
    Clocked,
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
from ...plan.codec import LayoutPlan, layout_plan_of
from ...plan.frames import HeldParameter
from ...plan.limits import powers_of_two
from ...plan.values import is_number, meaning_of
from ...plan.verdicts import reports_of
from ...say import text_on_one_line
from ...say.commands_and_alarms import alarm_of, alarm_source, flag_state_meanings, meaning, remedy
from ..registry import our_runtime
from .literals import (
    CallLiteral,
    EnumMember,
    Hex,
    Literal,
    SourceText,
    is_empty,
    literal_call,
    meaning_members,
    quoted,
    record_call,
    zero_means_member,
)
from .names import DeviceNames, byte_order

#: Sources with classes of records and enumerations.
_RUNTIME_PACKAGE = our_runtime("python") / "codewheel_runtime"
_RECORD_SOURCES = (
    *sorted((_RUNTIME_PACKAGE / "facts").glob("*.py")),
    _RUNTIME_PACKAGE / "order_codes.py",
    _RUNTIME_PACKAGE / "reports.py",
)
#: Records whose required members are printed without their names.
_POSITIONAL_RECORDS = frozenset(
    "Contact Document Edition Family LedState LostFigure NamedValue PrintedTimeout RegisterMeaning Revision"
    " SpelledValue".split()
)
#: Members that are printed last, although members that were added later follow them in the class.
_PRINTED_LAST: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "SsiFacts": ("timings", "note", "source"),
        "BissFacts": ("timings", "note", "source"),
        "ControlField": ("values", "source"),
    }
)


@dataclass(frozen=True)
class RecordMember:
    """A member of a record: the names in its type, and its default.

    The type ``tuple[Contact, ...] | None`` contains the names ``tuple`` and ``Contact``.
    """

    name: str
    names_in_type: frozenset[str]
    default: object = None
    is_required: bool = False


@dataclass(frozen=True)
class RuntimeRecords:
    """The members of each record of the runtime, and the names of its enumerations."""

    members: Mapping[str, tuple[RecordMember, ...]]
    enumerations: frozenset[str]


@cache
def runtime_records() -> RuntimeRecords:
    """Return all records and enumerations of the runtime."""
    members_by_class: dict[str, tuple[RecordMember, ...]] = {}
    enumerations: set[str] = set()
    for path in _RECORD_SOURCES:
        for class_def in _record_classes(path.read_text(encoding="utf-8")):
            base_names = {ast.unparse(base) for base in class_def.bases}
            if "NamedTuple" in base_names:
                members_by_class[class_def.name] = tuple(_record_members(class_def))
            if "Enum" in base_names:
                enumerations.add(class_def.name)
    return RuntimeRecords(members_by_class, frozenset(enumerations))


def _record_classes(source: str) -> list[ast.ClassDef]:
    """Return the classes in the source of a module."""
    return [statement for statement in ast.parse(source).body if isinstance(statement, ast.ClassDef)]


def _record_members(class_def: ast.ClassDef) -> Iterator[RecordMember]:
    """Yield the members of a class, whose statements are like ``address: int`` or ``note: str = ""``."""
    for class_statement in class_def.body:
        if not isinstance(class_statement, ast.AnnAssign) or not isinstance(class_statement.target, ast.Name):
            continue
        names_in_type = [node.id for node in ast.walk(class_statement.annotation) if isinstance(node, ast.Name)]
        default: object = None
        # The default of some members is a call, which counts as None.
        if isinstance(class_statement.value, (ast.Constant, ast.Tuple)):
            default = ast.literal_eval(class_statement.value)
        yield RecordMember(
            name=class_statement.target.id,
            names_in_type=frozenset(names_in_type),
            default=default,
            is_required=class_statement.value is None,
        )


def record_from_model(class_name: str, model_part: object, **overrides: Literal) -> CallLiteral:
    """Return the call that creates the record of a part of the model, such as a register.

    It contains all required members, and other members unless they are empty or equal to their default.

    Args:
        class_name: Name of the record.
        model_part: The part of the model, which has members of the same names.
        overrides: Values that replace those of the part.
    """
    arguments: list[tuple[str, Literal]] = []
    for record_member in _in_printed_order(class_name):
        member_value = (
            overrides[record_member.name]
            if record_member.name in overrides
            else _member_literal(model_part, record_member)
        )
        if record_member.is_required:
            # An argument with an empty name is positional.
            is_positional = class_name in _POSITIONAL_RECORDS
            arguments.append(("" if is_positional else record_member.name, member_value))
        elif member_value != record_member.default and not is_empty(member_value):
            arguments.append((record_member.name, member_value))
    return CallLiteral(class_name, tuple(arguments))


def records_from_model(class_name: str, model_parts: Sequence[object]) -> tuple[CallLiteral, ...]:
    """Return a record for each part of the model."""
    return tuple(record_from_model(class_name, model_part) for model_part in model_parts)


def _in_printed_order(class_name: str) -> list[RecordMember]:
    """Return the members of a record in the order of its class, with the members in ``_PRINTED_LAST`` at the end."""
    members = runtime_records().members[class_name]
    names_at_end = _PRINTED_LAST.get(class_name, ())
    members_before = [member for member in members if member.name not in names_at_end]
    members_at_end = [member for member in members if member.name in names_at_end]
    return members_before + members_at_end


def _member_literal(model_part: object, record_member: RecordMember) -> Literal:
    """Return a member of a part of the model as a literal, according to the type of the member in the record.

    If the type is a record or an enumeration, or a tuple of these, the value becomes a call or a member of it. Sources
    become one text.
    """
    member_value = getattr(model_part, record_member.name)
    if record_member.name == "source":
        return cite(member_value)
    record_names = record_member.names_in_type & runtime_records().members.keys()
    if record_names:
        (record_name,) = record_names  # A type names at most one record.
        if isinstance(member_value, tuple):
            return records_from_model(record_name, member_value)
        return record_from_model(record_name, member_value) if member_value is not None else None
    enumerations = record_member.names_in_type & runtime_records().enumerations
    if enumerations:
        (enumeration,) = enumerations  # A type names at most one enumeration.
        if isinstance(member_value, tuple):
            return tuple(EnumMember(enumeration, name) for name in member_value)
        return EnumMember(enumeration, member_value) if member_value else None
    if isinstance(member_value, Expression):
        return member_value.render()
    if isinstance(member_value, int) and _is_hexadecimal(model_part, record_member.name):
        return Hex(member_value)
    literal_value: Literal = member_value
    return literal_value


def _is_hexadecimal(model_part: object, member_name: str) -> bool:
    """Return whether specs contain this member of a part of the model in hexadecimal."""
    part = PARTS_BY_CLASS.get(type(model_part).__name__)
    if part is None or member_name not in part.by_attribute:
        return False
    return part.by_attribute[member_name].data_type == "hex"


def record_of_held_parameter(
    device_names: DeviceNames, register: Register, held_parameter: HeldParameter
) -> CallLiteral:
    """Return the record of a parameter that is read from a register: its place, its default, its limits or codes.

    If the manual gives no factory default of the register, the record contains zeros, and ``by_order_code`` says so.
    """
    parameter = held_parameter.parameter
    record_members: dict[str, Literal] = {
        "name": device_names.attribute_by_parameter[parameter.name],
        "interface": SourceText(f"Interface.{register.interface.upper()}"),
        "address": SourceText(f"Address.{register.name.upper()}"),
        "default": register.default_bytes() or bytes(register.length),
        "order": byte_order(register),
        "low": held_parameter.field.low.constant,
        "width": held_parameter.field.widest,
        "min": parameter.min or 0,
        "max": parameter.max if parameter.max is not None else held_parameter.highest_value,
    }
    if parameter.by_code:
        record_members["codes"] = tuple((by_code.code, by_code.value) for by_code in parameter.by_code)
    if register.default is None:
        record_members["by_order_code"] = True
    if not parameter.by_code:
        record_members |= zero_means_member(meaning_of(held_parameter.field))
    return record_call("RegisterParameter", record_members)


@dataclass(frozen=True)
class FactTable:
    """A table of facts in a module. ``record_class`` is the class of its rows, which are records."""

    comment: str
    name: str
    record_class: str
    rows: Sequence[CallLiteral] = ()

    @property
    def section(self) -> str:
        """The section of the model with the content of the table."""
        return self.name.lower()


#: Tables at the end of a module, without their rows.
_TABLES_AT_END = (
    FactTable(
        comment="Errors and warnings: their meaning, whether they are latched, and the procedures that clear them.",
        name="ALARMS",
        record_class="Alarm",
    ),
    FactTable(comment="Timings of the encoder as a whole.", name="TIMINGS", record_class="Timing"),
    FactTable(comment="Connectors and cables, contact by contact.", name="CONNECTORS", record_class="Connector"),
    FactTable(comment="LEDs and the meaning of their states.", name="LEDS", record_class="Led"),
    FactTable(comment="Hardware inputs.", name="INPUTS", record_class="Input"),
    FactTable(comment="Tables of the manual.", name="TABLES", record_class="Table"),
    FactTable(comment="Further facts of the manual, as text.", name="CHARACTERISTICS", record_class="Characteristic"),
    FactTable(
        comment="Content of figures that is missing from the text of the manual.",
        name="LOST_FIGURES",
        record_class="LostFigure",
    ),
    FactTable(
        comment="Errors and ambiguities in the manual, with the text that is used instead.",
        name="ERRATA",
        record_class="Erratum",
    ),
    FactTable(comment="Documents that sources cite by key.", name="DOCUMENTS", record_class="Document"),
)
#: Tables that every module has, even empty.
_TABLES_ALWAYS_PRINTED = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


# -- the device


def family_record(device: Device) -> CallLiteral:
    """Return the record ``Family`` of a device."""
    return literal_call(
        "Family",
        device.name,
        text_on_one_line(device.title),
        EnumMember("Movement", device.movement),
        text_on_one_line(device.manufacturer.title),
    )


def order_code_record(order_code: OrderCode) -> CallLiteral:
    """Return the record ``OrderCode``, with the parts of the order code and their values."""
    part_records = []
    for part in order_code.parts:
        combinations = _allowed_combinations(part.open_only_with)
        part_records.append(record_from_model("Part", part, open_only_with=combinations))
    return record_from_model("OrderCode", order_code, parts=tuple(part_records))


def _allowed_combinations(values_by_part: Mapping[str, tuple[str, ...]]) -> CallLiteral | None:
    """Return the values of other parts of the order code with which unlisted values of a part can be combined.

    An example is ``ReadOnly({"interface": ("BiSS", "SSI",)})``. The result is None if all combinations are possible.
    """
    if not values_by_part:
        return None
    dict_items = []
    for part_name, values in values_by_part.items():
        quoted_values = ", ".join(map(quoted, values))
        # The comma makes a tuple of a single value.
        dict_items.append(f"{quoted(part_name)}: ({quoted_values},)")
    return CallLiteral("ReadOnly", (("", SourceText(f"{{{', '.join(dict_items)}}}")),))


def tables_at_end(device: Device) -> list[FactTable]:
    """Return the tables at the end of a module: tables with rows, and tables that every module has."""
    filled_tables = [_with_rows(table, device) for table in _TABLES_AT_END]
    return [table for table in filled_tables if table.rows or table.name in _TABLES_ALWAYS_PRINTED]


def _with_rows(table: FactTable, device: Device) -> FactTable:
    """Return a table with a row for each part in its section of the model."""
    return replace(table, rows=records_from_model(table.record_class, getattr(device, table.section)))


def report_records(device: Device) -> list[CallLiteral]:
    """Return the records of the reports in the frames of the family, such as errors."""
    return [_report_record(report.name, report.field, alarm_of(device, report.field)) for report in reports_of(device)]


def _report_record(name: str, field: Field, alarm: Alarm | None) -> CallLiteral:
    """Return the record ``Report``, with the meaning and the remedy of its alarm if the field has one."""
    verdict_while_active = field.kind.makes_position
    return record_call(
        "Report",
        {"name": name, "printed_name": field.printed_name, "meaning": meaning(field, alarm)},
        remedy=remedy(field, alarm),
        makes_position=EnumMember("Verdict", verdict_while_active.name) if verdict_while_active is not None else None,
        source=cite(alarm_source(field, alarm)),
    )


# -- interfaces


def interface_record(interface: Interface) -> CallLiteral:
    """Return the record with the facts of an interface, such as ``SsiFacts``."""
    match interface:
        case Ssi():
            output_code = interface.output_code
            return record_from_model(
                "SsiFacts",
                interface,
                **_clock_members(interface),
                alignment=EnumMember("Alignment", interface.alignment.end),
                output_code=output_code.code if output_code is not None else "",
                alignment_source=cite(interface.alignment.source),
                output_code_source=cite(output_code.source) if output_code is not None else "",
            )
        case Biss():
            timeouts = records_from_model("Timeout", interface.timeouts_by_code)
            return record_from_model("BissFacts", interface, **_clock_members(interface), timeouts=timeouts)
        case Rs485():
            memory = tuple(
                record_from_model("MemoryAccess", access, busy=bool(access.busy)) for access in interface.memory_access
            )
            return record_from_model("Rs485Facts", interface, memory_access=memory)
        case Spi():
            return record_from_model("SpiFacts", interface, **_clock_members(interface))
        case _:
            assert_never(interface)


def _clock_members(interface: Clocked) -> Mapping[str, Literal]:
    """Return the members ``clock``, for all order codes, and ``clocks``, for the order codes with another clock.

    If each order code has its own clock, ``clock`` has no limits.
    """
    clock = interface.clock if interface.clock is not None else Clock(source=())
    return {"clock": record_from_model("Clock", clock), "clocks": records_from_model("Clock", interface.clocks_by_code)}


# -- fields and registers


def _field_record(layout_plan: LayoutPlan, field: Field) -> CallLiteral:
    """Return the record ``FieldFacts`` of a field.

    ``constant`` and ``unused`` are the values that the manual states for a constant field and for unused bits.
    """
    when_active, when_inactive = flag_state_meanings(field)
    unused_values = {reserved.field.name: reserved.value for reserved in layout_plan.reserved}
    return record_from_model(
        "FieldFacts",
        field,
        **meaning_members(meaning_of(field)),
        when_active=when_active,
        when_inactive=when_inactive,
        constant=layout_plan.constants.get(field.name),
        unused=unused_values.get(field.name),
        power_of_two=field.name in powers_of_two(layout_plan),
        digit_code=field.kind.digit_code,
    )


def _field_records(layout_plan: LayoutPlan) -> tuple[CallLiteral, ...]:
    """Return the facts of each field."""
    return tuple(_field_record(layout_plan, field) for field in layout_plan.layout.fields)


def _is_one_number(layout: Layout) -> bool:
    """Return whether a register consists of one field that has its name and is a number."""
    if len(layout.fields) != 1:
        return False
    (only_field,) = layout.fields
    has_name_of_register = only_field.name == layout.name
    return has_name_of_register and only_field.carries_data and is_number(meaning_of(only_field))


def field_records_by_frame(device: Device) -> dict[str, tuple[CallLiteral, ...]]:
    """Return the facts of the fields in each frame, by the name of the frame."""
    return {layout.name: _field_records(layout_plan_of(device, layout)) for _, layout in device.layouts()}


def record_by_register(device: Device) -> dict[str, CallLiteral]:
    """Return the facts of each register, by its name."""
    return {register.name: _register_record(device, register) for register in device.registers}


def _register_record(device: Device, register: Register) -> CallLiteral:
    """Return the record ``Register``. A register that is a single number has no fields."""
    return record_from_model(
        "Register",
        register,
        default=register.default_bytes(),
        wait_ms=register.wait_at_least_ms,
        fields=() if _is_one_number(register.layout) else _field_records(layout_plan_of(device, register.layout)),
    )
