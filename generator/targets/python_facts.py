"""The facts of a device as records in Python source: what a module states besides frames and registers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..expressions import Expression
from ..model import Crc, Device, Field, Interface, Layout, Timing, cite
from ..render import plain
from .python_source import Call, Code, Hex, Literal, call, literal, quoted, record

#: Tables that every module has, even empty.
_ALWAYS = ("ALARMS", "TIMINGS", "CONNECTORS", "LEDS", "CHARACTERISTICS", "ERRATA", "DOCUMENTS")


def constant(name: str, value: Call | None) -> str:
    """The statement that gives ``name`` its value; nothing without a value."""
    if value is None:
        return ""
    start = f"{name}: Final = "
    return start + literal(value, 0, len(start))


def table(name: str, kind: str, rows: Sequence[Call]) -> str:
    """The statement that gives ``name`` a tuple of records, one a line."""
    start = f"{name}: Final[tuple[{kind}, ...]] = "
    if not rows:
        return f"{start}()"
    return start + "(\n" + "\n".join(f"    {literal(row, 4, 4, 1)}," for row in rows) + "\n)"


def family(device: Device) -> str:
    """The statement that names the family."""
    return constant("FAMILY", call("Family", device.name, plain(device.title), device.movement, plain(device.manufacturer.title)))


def manual(device: Device) -> str:
    """The statement that names the manual."""
    manual = device.manual
    editions = tuple(call("Edition", item.language, item.title, item.revision, date=item.date) for item in manual.editions)
    history = tuple(call("Revision", item.revision, item.changes, date=item.date, hardware=item.hardware, software=item.software) for item in manual.history)
    made = record(
        "Manual", {"title": manual.title, "revision": manual.revision, "date": manual.date, "language": manual.language},
        publisher=manual.publisher, editions=editions, history=history,
    )
    return constant("MANUAL", made)


def tables(device: Device) -> list[tuple[str, str]]:
    """The tables at the end of a module, each with what it holds."""
    alarms = [
        record(
            "Alarm", {"name": item.name, "meaning": item.meaning}, printed_name=item.printed_name, register=item.register, field=item.field, detected=item.detected,
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
    lost = [call("LostFigure", item.content, source=cite(item.source)) for item in device.lost_figures]
    documents = [call("Document", item.key, item.title, url=item.url) for item in device.documents]
    made = (
        ("Errors and warnings: what they mean, whether they latch, how they are cleared.", "ALARMS", "Alarm", alarms),
        ("Times that belong to the encoder as a whole.", "TIMINGS", "Timing", [timing(item) for item in device.timings]),
        ("Connectors and cables, contact by contact.", "CONNECTORS", "Connector", connectors),
        ("Lights and what their states mean.", "LEDS", "Led", leds),
        ("Hardware inputs.", "INPUTS", "Input", inputs),
        ("Tables of the manual.", "TABLES", "Table", tables),
        ("Further facts of the manual, as text.", "CHARACTERISTICS", "Characteristic", facts),
        ("What only figures show that the text at hand does not contain.", "LOST_FIGURES", "LostFigure", lost),
        ("Where the manual cannot be taken literally, and what is used instead.", "ERRATA", "Erratum", errata),
        ("Documents that sources cite by their key.", "DOCUMENTS", "Document", documents),
    )
    return [(comment, table(name, kind, rows)) for comment, name, kind, rows in made if rows or name in _ALWAYS]


def crc_record(item: Crc) -> Call:
    needed: dict[str, Literal] = {
        "name": item.name, "width": item.width, "poly": Hex(item.poly), "init": Hex(item.init), "refin": item.refin, "refout": item.refout,
        "xorout": Hex(item.xorout), "polynomial": item.polynomial,
    }
    return record("Crc", needed, note=item.note, source=cite(item.source))


def _common(interface: Interface) -> Mapping[str, str | tuple[Call, ...]]:
    return {"timings": tuple(map(timing, interface.timings)), "note": interface.note, "source": cite(interface.source)}


def _clock(interface: Interface) -> Call:
    return record("Clock", {"min_hz": interface.clock_min_hz or 0, "max_hz": interface.clock_max_hz or 0}, source=cite(interface.clock_source))


def _ssi(interface: Interface) -> Call:
    rows = tuple(
        record("CableLength", {"shorter_than_m": item.shorter_than_m, "below_hz": item.below_hz}, source=cite(item.source)) for item in interface.cable_lengths
    )
    return record(
        "SsiFacts", {"clock": _clock(interface), "alignment": interface.alignment}, output_code=interface.output_code, signals=interface.signals,
        cable_lengths=rows, alignment_source=cite(interface.alignment_source),
        output_code_source=cite(interface.output_code_source) if interface.output_code else "", **_common(interface),
    )


def _biss(interface: Interface) -> Call:
    network, timeout = interface.network, interface.timeout
    made_network = None if network is None else record(
        "Network", {"topology": network.topology, "multiple_slaves": network.multiple_slaves}, source=cite(network.source)
    )
    made_timeout = None if timeout is None else record(
        "Timeout", {"rule": timeout.rule}, half_clock_periods=timeout.half_clock_periods, at_most_ns=timeout.at_most_ns,
        typical_ns=timeout.typical_ns, printed=tuple(call("PrintedTimeout", entry.clock_hz, entry.timeout_ns) for entry in timeout.printed), source=cite(timeout.source),
    )
    control = tuple(
        record(
            "ControlField", {"name": item.name, "bits": item.bits}, meaning=item.meaning, crc=item.crc, printed_name=item.printed_name,
            values=tuple(call("NamedValue", value.name, value.value, meaning=value.meaning) for value in item.values), source=cite(item.source),
        )
        for item in interface.control_data
    )
    return record(
        "BissFacts", {"clock": _clock(interface)}, profile=interface.profile, signals=interface.signals, network=made_network,
        timeout=made_timeout, control_data=control, control_data_note=interface.control_data_note,
        description_file=interface.description_file, bank_select=interface.bank_select, **_common(interface),
    )


def _rs485(interface: Interface) -> Call | None:
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
    return record("Rs485Facts", {"port": made_port, "data_ids": ids}, memory_access=memory, **_common(interface))


def _limit(value: Expression | None) -> str:
    return "" if value is None else value.render()


def _fields(layout: Layout) -> tuple[Call, ...]:
    """What the manual says of each field; nothing where a register is one number without a name of its own."""
    if len(layout.fields) == 1 and layout.fields[0].name == layout.name and layout.fields[0].kind == "number":
        return ()
    return tuple(map(_field, layout.fields))


def _field(item: Field) -> Call:
    is_flag = item.kind == "flag"
    return record(
        "FieldFacts", {"name": item.name}, printed_name=item.printed_name, meaning=item.meaning, unit=item.unit,
        active=("low" if item.active_low else "high") if is_flag else "", when_active=item.when_active if is_flag else "",
        when_inactive=item.when_inactive if is_flag else "", default=item.default, constant=item.constant if item.kind == "constant" else None,
        signed=Code("True") if item.signed else None, zero_means=item.zero_means or None, power_of_two=Code("True") if item.power_of_two else None,
        implemented=None if item.implemented else Code("False"), reserved=item.reserved, explained_by=item.explained_by, names=item.names, note=item.note,
        source=cite(item.source),
    )


def frame_rows(device: Device) -> list[str]:
    """The entries of the table of what the fields of frames mean."""
    rows = []
    for _, layout in device.layouts():
        label = f"{quoted(layout.name)}: "
        rows.append(f"        {label}{literal(tuple(map(_field, layout.fields)), 8, 8 + len(label), 1)},")
    return rows


def register_rows(device: Device) -> list[str]:
    """The entries of the table of registers."""
    rows = []
    for item in device.registers:
        row = record(
            "Register",
            {"name": item.name, "printed_name": item.printed_name, "address": Hex(item.address), "length": item.length, "access": item.access,
             "byte_order": item.byte_order},
            default=item.default_bytes(), opened_by=item.opened_by, opened_by_field=item.opened_by_field, opened_by_value=item.opened_by_value,
            clears_itself=Code("True") if item.clears_itself else None, wait_ms=item.wait_at_least_ms,
            volatile=Code("True") if item.volatile else None, bank=item.bank, above_max=item.above_max, write_clears=item.write_clears,
            meanings=tuple(
                call("RegisterMeaning", entry.name, entry.when, entry.value, min=_limit(entry.min), max=_limit(entry.max), meaning=entry.meaning, source=cite(entry.source))
                for entry in item.meanings
            ),
            reserved=item.reserved, fields=_fields(item.layout), names=item.names, meaning=item.meaning, note=item.note, source=cite(item.source),
        )
        label = f"{quoted(item.name)}: "
        rows.append(f"        {label}{literal(row, 8, 8 + len(label), 1)},")
    return rows


def interface_facts(interface: Interface) -> Call | None:
    """The record of an interface's facts."""
    return {"ssi": _ssi, "biss": _biss, "rs485": _rs485}[interface.kind](interface)


def timing(item: Timing) -> Call:
    return record(
        "Timing", {"name": item.name, "meaning": item.meaning}, at_least_us=item.at_least_us, typical_us=item.typical_us, at_most_us=item.at_most_us,
        symbol=item.symbol, source=cite(item.source),
    )
