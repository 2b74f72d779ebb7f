"""The tables of facts in a generated module: about the device, its interfaces, its fields and its registers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

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
from ...model.record import dataclass
from ...plan.codec import LayoutPlan, layout_plan_of
from ...plan.limits import powers_of_two
from ...plan.values import is_number, meaning_of
from ...plan.verdicts import reports_of
from ...say import text_on_one_line
from ...say.commands_and_alarms import alarm_of, alarm_source, flag_state_meanings, meaning, remedy
from .literals import CallLiteral, EnumMember, Literal, SourceText, literal_call, meaning_members, quoted, record
from .records import record_of, records_of


@dataclass(frozen=True)
class FactTable:
    """A table of facts in a module. ``kind`` is the class of its rows, which are records."""

    comment: str
    name: str
    kind: str
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
        kind="Alarm",
    ),
    FactTable(comment="Timings of the encoder as a whole.", name="TIMINGS", kind="Timing"),
    FactTable(comment="Connectors and cables, contact by contact.", name="CONNECTORS", kind="Connector"),
    FactTable(comment="LEDs and the meaning of their states.", name="LEDS", kind="Led"),
    FactTable(comment="Hardware inputs.", name="INPUTS", kind="Input"),
    FactTable(comment="Tables of the manual.", name="TABLES", kind="Table"),
    FactTable(comment="Further facts of the manual, as text.", name="CHARACTERISTICS", kind="Characteristic"),
    FactTable(
        comment="Content of figures that is missing from the text of the manual.",
        name="LOST_FIGURES",
        kind="LostFigure",
    ),
    FactTable(
        comment="Errors and ambiguities in the manual, with the text that is used instead.",
        name="ERRATA",
        kind="Erratum",
    ),
    FactTable(comment="Documents that sources cite by key.", name="DOCUMENTS", kind="Document"),
)
#: Tables that every module has, even empty.
_TABLES_ALWAYS_PRINTED = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


# -- the device


def family(device: Device) -> CallLiteral:
    """Return the record ``Family`` of a device."""
    return literal_call(
        "Family",
        device.name,
        text_on_one_line(device.title),
        EnumMember("Movement", device.movement),
        text_on_one_line(device.manufacturer.title),
    )


def order_code(code: OrderCode) -> CallLiteral:
    """Return the record ``OrderCode``, with the parts of the order code and their values."""
    part_records = []
    for part in code.parts:
        combinations = _allowed_combinations(part.open_only_with)
        part_records.append(record_of("Part", part, open_only_with=combinations))
    return record_of("OrderCode", code, parts=tuple(part_records))


def _allowed_combinations(allowed: Mapping[str, tuple[str, ...]]) -> CallLiteral | None:
    """Return the values of other parts of the order code with which unlisted values of a part can be combined.

    An example is ``ReadOnly({"interface": ("BiSS", "SSI",)})``. The result is None if all combinations are possible.
    """
    if not allowed:
        return None
    dict_items = []
    for part_name, values in allowed.items():
        quoted_values = ", ".join(map(quoted, values))
        # The comma makes a tuple of a single value.
        dict_items.append(f"{quoted(part_name)}: ({quoted_values},)")
    return CallLiteral("ReadOnly", (("", SourceText(f"{{{', '.join(dict_items)}}}")),))


def tables(device: Device) -> list[FactTable]:
    """Return the tables at the end of a module: tables with rows, and tables that every module has."""
    filled_tables = [_with_rows(table, device) for table in _TABLES_AT_END]
    return [table for table in filled_tables if table.rows or table.name in _TABLES_ALWAYS_PRINTED]


def _with_rows(table: FactTable, device: Device) -> FactTable:
    """Return a table with a row for each part in its section of the model."""
    return replace(table, rows=records_of(table.kind, getattr(device, table.section)))


def reports(device: Device) -> list[CallLiteral]:
    """Return the records of the reports in the frames of the family, such as errors."""
    return [_report_record(report.name, report.field, alarm_of(device, report.field)) for report in reports_of(device)]


def _report_record(name: str, field: Field, alarm: Alarm | None) -> CallLiteral:
    """Return the record ``Report``, with the meaning and the remedy of its alarm if the field has one."""
    verdict = field.kind.makes_position
    return record(
        "Report",
        {"name": name, "printed_name": field.printed_name, "meaning": meaning(field, alarm)},
        remedy=remedy(field, alarm),
        makes_position=EnumMember("Verdict", verdict.name) if verdict is not None else None,
        source=cite(alarm_source(field, alarm)),
    )


# -- interfaces


def interface(interface: Interface) -> CallLiteral:
    """Return the record with the facts of an interface, such as ``SsiFacts``."""
    match interface:
        case Ssi():
            output_code = interface.output_code
            return record_of(
                "SsiFacts",
                interface,
                **_clock_members(interface),
                alignment=EnumMember("Alignment", interface.alignment.end),
                output_code=output_code.code if output_code is not None else "",
                alignment_source=cite(interface.alignment.source),
                output_code_source=cite(output_code.source) if output_code is not None else "",
            )
        case Biss():
            timeouts = records_of("Timeout", interface.timeouts_by_code)
            return record_of("BissFacts", interface, **_clock_members(interface), timeouts=timeouts)
        case Rs485():
            memory = tuple(
                record_of("MemoryAccess", access, busy=bool(access.busy)) for access in interface.memory_access
            )
            return record_of("Rs485Facts", interface, memory_access=memory)
        case Spi():
            return record_of("SpiFacts", interface, **_clock_members(interface))
        case _:
            assert_never(interface)


def _clock_members(interface: Clocked) -> Mapping[str, Literal]:
    """Return the members ``clock``, for all order codes, and ``clocks``, for the order codes with another clock.

    If each order code has its own clock, ``clock`` has no limits.
    """
    clock = interface.clock if interface.clock is not None else Clock(source=())
    return {"clock": record_of("Clock", clock), "clocks": records_of("Clock", interface.clocks_by_code)}


# -- fields and registers


def _field_record(layout_plan: LayoutPlan, field: Field) -> CallLiteral:
    """Return the record ``FieldFacts`` of a field.

    ``constant`` and ``unused`` are the values that the manual states for a constant field and for unused bits.
    """
    when_active, when_inactive = flag_state_meanings(field)
    unused_values = {reserved.field.name: reserved.value for reserved in layout_plan.reserved}
    return record_of(
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


def frame_rows(device: Device) -> dict[str, tuple[CallLiteral, ...]]:
    """Return the facts of the fields in each frame, by the name of the frame."""
    return {layout.name: _field_records(layout_plan_of(device, layout)) for _, layout in device.layouts()}


def register_rows(device: Device) -> dict[str, CallLiteral]:
    """Return the facts of each register, by its name."""
    return {register.name: _register_record(device, register) for register in device.registers}


def _register_record(device: Device, register: Register) -> CallLiteral:
    """Return the record ``Register``. A register that is a single number has no fields."""
    return record_of(
        "Register",
        register,
        default=register.default_bytes(),
        wait_ms=register.wait_at_least_ms,
        fields=() if _is_one_number(register.layout) else _field_records(layout_plan_of(device, register.layout)),
    )
