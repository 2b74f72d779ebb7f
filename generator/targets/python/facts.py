"""Tables of a generated module that hold the facts of a device, except its frames and registers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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
from ...model.record import dataclass
from ...plan.codec import Codec, codec_of
from ...plan.refusals import powers_of_two
from ...plan.reports import reports_of
from ...plan.values import is_number, meaning_of
from ...plan.verdicts import verdict_of
from ...say.lines import plain
from ...say.report import alarm_of, meaning, remedy, source, states
from .literals import Call, Code, Member, call, quoted, record
from .meanings import of_facts
from .records import row, rows

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
    parts = tuple(row("Part", part, open_only_with=_only(part.open_only_with)) for part in code.parts)
    return row("OrderCode", code, parts=parts)


def _only(allowed: Mapping[str, tuple[str, ...]]) -> Call | None:
    """Return the values of other parts with which a part can be combined."""
    items = ", ".join(f"{quoted(name)}: ({', '.join(map(quoted, texts))},)" for name, texts in allowed.items())
    return Call("ReadOnly", (("", Code(f"{{{items}}}")),)) if allowed else None


def tables(device: Device) -> list[Table]:
    """Return the tables at the end of a module."""
    made = (Table(comment, name, kind, rows(kind, getattr(device, name.lower()))) for comment, name, kind in _TABLES)
    return [item for item in made if item.rows or item.name in _ALWAYS]


def reports(device: Device) -> list[Call]:
    """Return the reports of the encoder in frames of the family."""
    return [_report(item.name, item.field, alarm_of(device, item.field)) for item in reports_of(device)]


def _report(name: str, item: Field, alarm: Alarm | None) -> Call:
    worth = verdict_of(item)
    return record(
        "Report",
        {"name": name, "printed_name": item.printed_name, "meaning": meaning(item, alarm)},
        remedy=remedy(item, alarm),
        makes_position=Member("Verdict", worth.name) if worth is not None else None,
        source=cite(source(item, alarm)),
    )


# -- interfaces


def interface(item: Interface) -> Call:
    match item:
        case Ssi():
            code = item.output_code
            return row(
                "SsiFacts",
                item,
                alignment=Member("Alignment", item.alignment.end),
                output_code=code.code if code is not None else "",
                alignment_source=cite(item.alignment.source),
                output_code_source=cite(code.source) if code is not None else "",
            )
        case Biss():
            return row("BissFacts", item)
        case Rs485():
            memory = tuple(row("MemoryAccess", each, busy=bool(each.busy)) for each in item.memory_access)
            return row("Rs485Facts", item, memory_access=memory)
        case Spi():
            return row("SpiFacts", item)
        case _:
            assert_never(item)


# -- fields and registers


def _field(codec: Codec, item: Field) -> Call:
    when_active, when_inactive = states(item)
    reserved = {reserved.field.name: reserved.value for reserved in codec.reserved}
    return row(
        "FieldFacts",
        item,
        **of_facts(meaning_of(item)),
        when_active=when_active,
        when_inactive=when_inactive,
        constant=codec.constants.get(item.name),
        unused=reserved.get(item.name),
        power_of_two=item.name in powers_of_two(codec),
    )


def _fields(codec: Codec) -> tuple[Call, ...]:
    """Return the facts of each field."""
    return tuple(_field(codec, item) for item in codec.layout.fields)


def _is_one_number(layout: Layout) -> bool:
    """Return whether a register is a single number of the same name."""
    first = layout.fields[0]
    own = len(layout.fields) == 1 and first.name == layout.name and first.carries_data
    return own and is_number(meaning_of(first))


def frame_rows(device: Device) -> dict[str, tuple[Call, ...]]:
    """Return the facts of the fields of frames, by the name of the frame."""
    return {layout.name: _fields(codec_of(device, layout)) for _, layout in device.layouts()}


def register_rows(device: Device) -> dict[str, Call]:
    return {item.name: _register(device, item) for item in device.registers}


def _register(device: Device, item: Register) -> Call:
    return row(
        "Register",
        item,
        default=item.default_bytes(),
        wait_ms=item.wait_at_least_ms,
        fields=() if _is_one_number(item.layout) else _fields(codec_of(device, item.layout)),
    )
