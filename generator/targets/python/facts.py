"""Facts of a device as records: the tables of a module, other than frames and registers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ...model import (
    Alarm,
    Biss,
    Clock,
    ControlField,
    Crc,
    Device,
    Field,
    Interface,
    Layout,
    Manual,
    OrderCode,
    Register,
    RegisterMeaning,
    Rs485,
    Spelling,
    Ssi,
    Timeout,
    assert_never,
    cite,
)
from ...plan.codec import Codec, codec_of, constant_values
from ...plan.refusals import powers_of_two
from ...plan.reports import reports_of, worth_of
from ...plan.values import is_number, meaning_of
from ...say.lines import plain
from ...say.report import alarm_of, meaning, remedy, source, states
from .literals import Call, Code, Hex, Literal, Member, call, quoted, record
from .meanings import of_facts

#: Tables that every module has, even empty.
_ALWAYS = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


#: Members of records that are enumerated, with the name of the enumeration.
_MEMBERS: Mapping[tuple[str, str], str] = {
    ("Register", "access"): "Access",
    ("Register", "byte_order"): "ByteOrder",
    ("Register", "above_max"): "AboveMax",
    ("SsiFacts", "alignment"): "Alignment",
    ("Timeout", "rule"): "TimeoutRule",
    ("DataIdFacts", "purpose"): "Purpose",
    ("Connector", "kind"): "ConnectorKind",
    ("Erratum", "status"): "Status",
    ("Erratum", "severity"): "Severity",
}


@dataclass(frozen=True)
class Table:
    """Table of a module: comment, name, class of the rows, and rows."""

    comment: str
    name: str
    kind: str
    rows: Sequence[Call]


def _row(function: str, item: object, needed: str, optional: str = "", **made: Literal) -> Call:
    """Return a record of the named members of ``item``: all required ones, and the optional ones that are not empty.

    ``made`` contains values that replace those of ``item``. Sources become citations.
    """

    def value(name: str) -> Literal:
        found: Literal = made[name] if name in made else getattr(item, name)
        if isinstance(found, str) and (function, name) in _MEMBERS:
            return Member(_MEMBERS[function, name], found) if found else None
        return cite(getattr(item, name)) if name == "source" else found

    return record(function, {n: value(n) for n in needed.split()}, **{n: value(n) for n in optional.split()})


def _rows(function: str, items: Iterable[object], needed: str, optional: str = "") -> tuple[Call, ...]:
    return tuple(_row(function, item, needed, optional) for item in items)


# -- the device


def family(device: Device) -> Call:
    return call(
        "Family",
        device.name,
        plain(device.title),
        Member("Movement", device.movement),
        plain(device.manufacturer.title),
    )


def manual(manual: Manual) -> Call:
    editions = (call("Edition", item.language, item.title, item.revision, date=item.date) for item in manual.editions)
    history = (
        call("Revision", item.revision, item.changes, date=item.date, hardware=item.hardware, software=item.software)
        for item in manual.history
    )
    return _row(
        "Manual",
        manual,
        "title revision date language",
        "publisher editions history",
        editions=tuple(editions),
        history=tuple(history),
    )


def order_code(code: OrderCode) -> Call:
    parts = (
        _row(
            "Part",
            part,
            "name meaning values",
            "open open_only_with source",
            values=_rows("PartValue", part.values, "text", "meaning source"),
            open_only_with=_only(part.open_only_with),
        )
        for part in code.parts
    )
    return _row(
        "OrderCode",
        code,
        "pattern parts",
        "special note source also_written",
        parts=tuple(parts),
        also_written=tuple(map(_spelling, code.also_written)),
    )


def _only(allowed: Mapping[str, tuple[str, ...]]) -> Call | None:
    """Return the values of other parts with which a part can be combined."""
    items = ", ".join(f"{quoted(name)}: ({', '.join(map(quoted, texts))},)" for name, texts in allowed.items())
    return Call("ReadOnly", (("", Code(f"{{{items}}}")),)) if allowed else None


def _spelling(item: Spelling) -> Call:
    values = tuple(call("SpelledValue", value.part, value.text, value.value) for value in item.values)
    return _row("Spelling", item, "pattern where", "values then source", values=values)


def tables(device: Device) -> list[Table]:
    """Return the tables at the end of a module."""
    lost = [call("LostFigure", item.content, source=cite(item.source)) for item in device.lost_figures]
    documents = [call("Document", item.key, item.title, url=item.url) for item in device.documents]
    inputs = "printed_name low high pulse_at_least_us inverts needs when_unused note names source"
    made = (
        Table(
            "Errors and warnings: their meaning, whether they are latched, and the procedures that clear them.",
            "ALARMS",
            "Alarm",
            _alarms(device),
        ),
        Table("Timings of the encoder as a whole.", "TIMINGS", "Timing", _timings(device)),
        Table("Connectors and cables, contact by contact.", "CONNECTORS", "Connector", [*_connectors(device)]),
        Table("LEDs and the meaning of their states.", "LEDS", "Led", [*_leds(device)]),
        Table("Hardware inputs.", "INPUTS", "Input", _rows("Input", device.inputs, "name meaning", inputs)),
        Table(
            "Tables of the manual.",
            "TABLES",
            "Table",
            _rows("Table", device.tables, "name title columns rows", "note source"),
        ),
        Table(
            "Further facts of the manual, as text.",
            "CHARACTERISTICS",
            "Characteristic",
            _rows("Characteristic", device.characteristics, "name value", "only source"),
        ),
        Table("Content of figures that is missing from the text of the manual.", "LOST_FIGURES", "LostFigure", lost),
        Table(
            "Errors and ambiguities in the manual, with the text that is used instead.",
            "ERRATA",
            "Erratum",
            _rows("Erratum", device.errata, "name printed used why status severity", "affects source only"),
        ),
        Table("Documents that sources cite by key.", "DOCUMENTS", "Document", documents),
    )
    return [item for item in made if item.rows or item.name in _ALWAYS]


def _alarms(device: Device) -> list[Call]:
    more = "printed_name register field detected below_mv latch implemented remedy cleared_by names source only by_hand"
    return [_row("Alarm", item, "name meaning", more, implemented=_unless(item.implemented)) for item in device.alarms]


def _unless(holds: bool) -> bool | None:
    """Return False if a condition does not hold, otherwise None, which is omitted from the record."""
    return None if holds else False


def _timings(of: Device | Interface) -> tuple[Call, ...]:
    return _rows("Timing", of.timings, "name meaning", "at_least_us typical_us at_most_us symbol source only")


def _connectors(device: Device) -> Iterator[Call]:
    for item in device.connectors:
        contacts = tuple(call("Contact", part.contact, part.signal, only=part.only) for part in item.contacts)
        interfaces = tuple(Member("Interface", name) for name in item.interfaces)
        needed = "name kind title interfaces contacts"
        yield _row("Connector", item, needed, "mating note source", interfaces=interfaces, contacts=contacts)


def _leds(device: Device) -> Iterator[Call]:
    for item in device.leds:
        states = tuple(
            call("LedState", one.state, one.meaning, only=one.only, by_hand=one.by_hand) for one in item.states
        )
        yield _row("Led", item, "name title states", "source", states=states)


def crc(item: Crc) -> Call:
    return _row(
        "Crc",
        item,
        "name width poly init refin refout xorout polynomial",
        "note source",
        poly=Hex(item.poly),
        init=Hex(item.init),
        xorout=Hex(item.xorout),
    )


def reports(device: Device) -> list[Call]:
    """Return the reports of the encoder in frames of the family."""
    return [_report(item.name, item.field, alarm_of(device, item.field)) for item in reports_of(device)]


def _report(name: str, item: Field, alarm: Alarm | None) -> Call:
    worth = worth_of(item)
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
            return _ssi(item)
        case Biss():
            return _biss(item)
        case Rs485():
            return _rs485(item)
        case _:
            assert_never(item)


def _clock(clock: Clock) -> Call:
    return _row("Clock", clock, "min_hz max_hz", "source")


def _ssi(item: Ssi) -> Call:
    code = item.output_code
    return _row(
        "SsiFacts",
        item,
        "clock alignment",
        "output_code signals cable_lengths alignment_source output_code_source timings note source",
        clock=_clock(item.clock),
        alignment=item.alignment.end,
        output_code=code.code if code is not None else "",
        cable_lengths=_rows("CableLength", item.cable_lengths, "shorter_than_m below_hz", "source"),
        alignment_source=cite(item.alignment.source),
        output_code_source=cite(code.source) if code is not None else "",
        timings=_timings(item),
    )


def _biss(item: Biss) -> Call:
    network, timeout = item.network, item.timeout
    return _row(
        "BissFacts",
        item,
        "clock",
        "profile signals network timeout control_data control_data_note description_file bank_select timings note"
        " source",
        clock=_clock(item.clock),
        network=_row("Network", network, "topology multiple_slaves", "source") if network is not None else None,
        timeout=_timeout(timeout) if timeout is not None else None,
        control_data=tuple(map(_control, item.control_data)),
        timings=_timings(item),
    )


def _timeout(item: Timeout) -> Call:
    printed = tuple(call("PrintedTimeout", entry.clock_hz, entry.timeout_ns) for entry in item.printed)
    more = "half_clock_periods at_most_ns typical_ns printed source"
    return _row("Timeout", item, "rule", more, printed=printed)


def _control(item: ControlField) -> Call:
    values = tuple(call("NamedValue", value.name, value.value, meaning=value.meaning) for value in item.values)
    return _row("ControlField", item, "name bits", "meaning crc printed_name values source", values=values)


def _rs485(item: Rs485) -> Call:
    ids = (
        _row("DataIdFacts", of, "name id control purpose", "meaning source", id=Hex(of.id), control=Hex(of.control))
        for of in item.data_ids
    )
    memory = (
        _row("MemoryAccess", of, "access busy address data meaning", "source", busy=bool(of.busy))
        for of in item.memory_access
    )
    return _row(
        "Rs485Facts",
        item,
        "port data_ids",
        "memory_access timings note source",
        port=_row("Port", item.port, "baud data_bits parity stop_bits flow_control", "source"),
        data_ids=tuple(ids),
        memory_access=tuple(memory),
        timings=_timings(item),
    )


# -- fields and registers


def _field(codec: Codec, item: Field) -> Call:
    when_active, when_inactive = states(item)
    reserved = {reserved.field.name: reserved.value for reserved in codec.reserved}
    return _row(
        "FieldFacts",
        item,
        "name",
        "printed_name meaning unit active when_active when_inactive default constant unused signed zero_means"
        " power_of_two implemented reserved explained_by names note source",
        **of_facts(meaning_of(item)),
        when_active=when_active,
        when_inactive=when_inactive,
        constant=constant_values(codec).get(item.name),
        unused=reserved.get(item.name),
        power_of_two=item.name in powers_of_two(codec) or None,
        implemented=_unless(item.implemented),
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
    return _row(
        "Register",
        item,
        "name printed_name address length access byte_order",
        "default opened_by opened_by_field opened_by_value clears_itself wait_ms volatile bank above_max write_clears"
        " meanings reserved fields names meaning note source",
        address=Hex(item.address),
        default=item.default_bytes(),
        clears_itself=item.clears_itself or None,
        wait_ms=item.wait_at_least_ms,
        volatile=item.volatile or None,
        meanings=tuple(map(_meaning, item.meanings)),
        fields=() if _is_one_number(item.layout) else _fields(codec_of(device, item.layout)),
    )


def _meaning(item: RegisterMeaning) -> Call:
    low, high = ("" if limit is None else limit.render() for limit in (item.min, item.max))
    more = {"meaning": item.meaning, "source": cite(item.source)}
    return call("RegisterMeaning", item.name, item.when, item.value, min=low, max=high, **more)
