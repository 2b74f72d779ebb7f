"""Sections of pages about interfaces: frames, registers, procedures and so on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, Any, TypedDict

from ...model import (
    Alarm,
    Biss,
    Connector,
    DataId,
    Device,
    Example,
    Field,
    FieldGroup,
    Input,
    Interface,
    Layout,
    Led,
    MemoryAccess,
    Procedure,
    Register,
    Rs485,
)
from ...order_codes.parameters import follows_registers
from ...plan.frames import exchanges
from ...say import commands as say_commands
from ...say import interface as hardware_input
from ...say import layout as say_layout
from ...say import register as say_register
from ...say import report
from ...say.errata import needed_answers
from ...say.evidence import document, origin, other_editions
from ...say.interface import PURPOSES
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.names_and_places import addresses, title, words
from ...say.text import Code, Statement, statement
from . import fact_tables, inline_errata, layout_tables, order_code_tables, verdict_page
from .layout_tables import has_value_table
from .page_links import links_to_steps

#: Rows of a table, with Markdown cells.
Rows = list[tuple[str, ...]]
#: Parts of a section, by name in the template.
Section = dict[str, Any]


class Sections(TypedDict):
    device: Annotated[Device, "the family, with only the data relevant to this page"]
    document: Annotated[str, "manual, or spec if not all of the manual was read"]
    origin: Annotated[list[Statement], "overlays and the edition of the family"]
    usable_page: Annotated[str, "the page on verdicts"]
    errata_at: Annotated[
        Callable[..., str],
        "errata of one or more paths in the spec, in full at the first mention, then as links",
    ]
    alternatives: Annotated[list[Section], "questions that the manual leaves open: alternative, title, rows, frames"]
    interfaces: Annotated[list[Section], "the interfaces with their layouts, data IDs, cables and control frames"]
    crcs: Annotated[list[Section], "the CRCs: crc, rows"]
    registers: Annotated[list[Section], "the registers with their fields, values and facts"]
    register_rows: Annotated[Rows, "the registers in short"]
    procedures: Annotated[list[Section], "the procedures: procedure, rows, arguments"]
    alarms: Annotated[list[Section], "errors and warnings: alarm, title, rows"]
    inputs: Annotated[list[Section], "the inputs: input, title, rows"]
    connectors: Annotated[list[Section], "connectors and cables: connector, head, rows"]
    led_rows: Annotated[Rows, "the LEDs and the meaning of each state"]
    examples: Annotated[list[Section], "the worked examples: example, rows"]


def page_sections(device: Device) -> Sections:
    return {
        "device": device,
        "document": document(device),
        "origin": [*origin(device), *other_editions(device)],
        "usable_page": verdict_page.PAGE,
        "errata_at": inline_errata.ErrataLines(device),
        "alternatives": order_code_tables.alternative_sections(device),
        "interfaces": [_interface_section(device, interface) for interface in device.interfaces],
        "crcs": [{"crc": crc, "rows": fact_tables.crc_rows(device, crc)} for crc in device.crcs],
        "registers": [_register_section(device, register) for register in device.registers],
        "register_rows": [_register_row(register) for register in device.registers],
        "procedures": [_procedure_section(device, procedure) for procedure in device.procedures],
        "alarms": [_alarm_section(device, device_alarm) for device_alarm in device.alarms],
        "inputs": [_input_section(device, device_input) for device_input in device.inputs],
        "connectors": [_connector_section(connector) for connector in device.connectors],
        "led_rows": [row for led in device.leds for row in _led_rows(led)],
        "examples": [_example_section(device, example) for example in device.examples],
    }


def _alarm_section(device: Device, device_alarm: Alarm) -> Section:
    return {"alarm": device_alarm, "title": title(device_alarm), "facts": report.alarm_facts(device, device_alarm)}


def _input_section(device: Device, device_input: Input) -> Section:
    return {
        "input": device_input,
        "title": title(device_input),
        "facts": hardware_input.input_facts(device, device_input),
    }


def _example_section(device: Device, example: Example) -> Section:
    return {"example": example, "rows": fact_tables.example_facts(device, example)}


def _led_rows(led: Led) -> Iterator[tuple[str, ...]]:
    """Yield a row for each state of an LED. The first row has the name and the source of the LED."""
    for index, state in enumerate(led.states):
        name, source = (text(led.title), cited(led.source)) if index == 0 else ("", "")
        meaning = joined([text(state.meaning), *links_to_steps("", state.by_hand)])
        yield name, text(state.state), meaning, code(state.only), source


#: Keys of an interface whose errata are listed with its facts.
_KEYS_OF_FACTS = (
    "measurement",
    "clock",
    "cable_lengths",
    "timeout",
    "network",
    "port",
    "profile",
    "alignment",
    "output_code",
    "signals",
    "description_file",
)


def _interface_section(device: Device, interface: Interface) -> Section:
    groups = {group.name: group for group in device.field_groups}
    path = f"interfaces.{interface.name}"
    interface_timings = [f"{path}.{timing.name}" for timing in interface.timings]
    device_timings = [f"timings.{timing.name}" for timing in device.timings]
    used_groups = [groups[name] for name in layout_tables.used_groups(interface)]
    return {
        "interface": interface,
        "rows": list(fact_tables.interface_rows(device, interface)),
        "path": path,
        "paths": [f"{path}.{key}" for key in _KEYS_OF_FACTS],
        "timing_paths": [*interface_timings, f"{path}.timings", *device_timings],
        "data_id_rows": list(map(_data_id_row, interface.data_ids)) if isinstance(interface, Rs485) else [],
        "exchange_rows": _exchange_rows(interface),
        "layouts": [_layout_section(device, interface, layout) for layout in interface.layouts],
        "groups": [_group_section(device, interface, group) for group in used_groups],
        "memory_rows": list(map(_memory_row, interface.memory_access)) if isinstance(interface, Rs485) else [],
        "control_rows": list(fact_tables.control_rows(interface)) if isinstance(interface, Biss) else [],
    }


def _group_section(device: Device, interface: Interface, group: FieldGroup) -> Section:
    return {
        "group": group,
        "title": _group_title(group),
        "frames": layout_tables.links_to_frames_with(interface, group.name),
        "rows": layout_tables.group_rows(device, group.name),
    }


def _data_id_row(data_id: DataId) -> tuple[str, ...]:
    return (
        f"{data_id.id:X}",
        code(data_id.name),
        f"`{data_id.control:02X}h`",
        text(data_id.purpose),
        text(data_id.meaning),
        cited(data_id.source),
    )


def _exchange_rows(interface: Interface) -> Rows:
    """Return rows of request, reply, length if requests differ in it, purpose, source."""
    frame_exchanges = exchanges(interface)
    lengths = {exchange.request.bits for exchange in frame_exchanges if not exchange.request.in_bytes}
    rows: Rows = []
    for exchange in frame_exchanges:
        length = [f"{exchange.request.bits.render()} bits"] if len(lengths) > 1 else []
        purpose = PURPOSES[exchange.exchange.purpose]
        frames = [_layout_link(exchange.request), _layout_link(exchange.reply)]
        rows.append((*frames, *length, purpose, cited(exchange.exchange.source)))
    return rows


def _layout_link(layout: Layout | None) -> str:
    return link(code(layout.name), f"#layout-{layout.name}") if layout is not None else "none"


def _memory_row(access: MemoryAccess) -> tuple[str, ...]:
    return (
        text(access.access),
        f"{access.busy}",
        text(access.address),
        text(access.data),
        text(access.meaning),
        cited(access.source),
    )


def _group_title(group: FieldGroup) -> str:
    """Return our name, with the name used in the manual in parentheses."""
    return words(group.name).capitalize() + (f" ({group.printed_name})" if group.printed_name else "")


def _layout_section(device: Device, interface: Interface, layout: Layout) -> Section:
    return {
        "layout": layout,
        "head": say_layout.head(interface, layout, Code(layout.name), device.alternatives),
        "size": STYLE.phrase(statement(*say_layout.size(layout, device.alternatives))),
        "facts": [*say_layout.facts(interface, layout), *needed_answers(device, layout)],
        "rows": list(layout_tables.field_rows(device, layout)),
        "placements": layout_tables.placement_table(device, layout, interface.name),
        "delivered": follows_registers(device, layout),
    }


def _register_section(device: Device, register: Register) -> Section:
    fields = register.layout.fields
    rows = list(layout_tables.field_rows(device, register.layout))
    is_plain = len(fields) == 1 and rows[0][3:] == ("", "") and fields[0].name == register.name
    return {
        "register": register,
        "title": title(register),
        "access": say_register.access(register),
        "head": say_register.head(device, register, Code(register.name)),
        "facts": say_register.facts(device, register),
        "rows": [] if is_plain else rows,
        "value_tables": [_value_table(field, len(fields) == 1) for field in fields if has_value_table(field)],
        "joins": say_layout.joins(register.layout),
        "placements": layout_tables.placement_table(device, register.layout, register.interface),
    }


def _value_table(field: Field, is_only_field: bool) -> Section:
    return {"field": code(field.name), "rows": list(layout_tables.value_rows(field)), "alone": is_only_field}


def _procedure_section(device: Device, procedure: Procedure) -> Section:
    return {
        "procedure": procedure,
        "about": list(say_commands.about_procedure(procedure)),
        "rows": fact_tables.step_rows(device, procedure),
        "arguments": [(argument.name, say_commands.argument(device, argument)) for argument in procedure.arguments],
    }


def _connector_section(connector: Connector) -> Section:
    return {
        "connector": connector,
        "head": "Wire" if connector.kind == "cable" else "Pin",
        "rows": [(text(contact.contact), text(contact.signal), code(contact.only)) for contact in connector.contacts],
    }


def _register_row(register: Register) -> tuple[str, ...]:
    data = register.default_bytes()
    return (
        "" if register.bank is None else f"{register.bank}",
        addresses(register),
        link(code(register.name), f"#register-{register.name}"),
        say_register.access(register),
        f"`{data.hex(' ').upper()}`" if data is not None else "",
        cited(register.source),
    )
