"""Sections of pages about interfaces: frames, registers, procedures and so on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, TypedDict

from ...model import Biss, Connector, Device, FieldGroup, Interface, Layout, Procedure, Register, Rs485
from ...order_codes.parameters import follows_registers
from ...plan.replies import exchanges
from ...say import alarm, hardware_input
from ...say import layout as say_layout
from ...say import procedure as say_procedure
from ...say import register as say_register
from ...say.alternative import needs
from ...say.evidence import document
from ...say.interface import PURPOSES
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.name import title, words
from ...say.origin import origin, other_editions
from ...say.place import addresses
from ...say.text import Code, Statement, statement
from . import fact_tables, inline_errata, layout_tables, order_code_tables, verdict_page
from .page_links import to_steps

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


def sections(device: Device) -> Sections:
    return {
        "device": device,
        "document": document(device),
        "origin": [*origin(device), *other_editions(device)],
        "usable_page": verdict_page.PAGE,
        "errata_at": inline_errata.OnPage(device),
        "alternatives": order_code_tables.alternatives(device),
        "interfaces": [_interface(device, interface) for interface in device.interfaces],
        "crcs": [{"crc": crc, "rows": fact_tables.crc_rows(device, crc)} for crc in device.crcs],
        "registers": [_register(device, register) for register in device.registers],
        "register_rows": [_register_row(register) for register in device.registers],
        "procedures": [_procedure(device, procedure) for procedure in device.procedures],
        "alarms": [
            {"alarm": device_alarm, "title": title(device_alarm), "facts": alarm.facts(device, device_alarm)}
            for device_alarm in device.alarms
        ],
        "inputs": [
            {"input": device_input, "title": title(device_input), "facts": hardware_input.facts(device, device_input)}
            for device_input in device.inputs
        ],
        "connectors": [_connector(connector) for connector in device.connectors],
        "led_rows": [
            (
                text(led.title) if index == 0 else "",
                text(state.state),
                joined([text(state.meaning), *to_steps("", state.by_hand)]),
                code(state.only),
                cited(led.source) if index == 0 else "",
            )
            for led in device.leds
            for index, state in enumerate(led.states)
        ],
        "examples": [
            {"example": example, "rows": fact_tables.example_facts(device, example)} for example in device.examples
        ],
    }


#: Keys of an interface whose errata are listed with its facts.
_FACTS = (
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


def _interface(device: Device, interface: Interface) -> Section:
    groups = {group.name: group for group in device.field_groups}
    place = f"interfaces.{interface.name}"
    return {
        "interface": interface,
        "rows": list(fact_tables.interface_rows(device, interface)),
        "path": place,
        "paths": [f"{place}.{name}" for name in _FACTS],
        "timing_paths": [f"{place}.{timing.name}" for timing in interface.timings]
        + [f"{place}.timings", *(f"timings.{timing.name}" for timing in device.timings)],
        "data_id_rows": _data_id_rows(interface) if isinstance(interface, Rs485) else [],
        "exchange_rows": _exchange_rows(interface),
        "layouts": [_layout(device, interface, layout) for layout in interface.layouts],
        "groups": [
            {
                "group": groups[name],
                "title": _group_title(groups[name]),
                "frames": layout_tables.frames_with(interface, name),
                "rows": layout_tables.group_rows(device, name),
            }
            for name in layout_tables.used_groups(interface)
        ],
        "memory_rows": _memory_rows(interface) if isinstance(interface, Rs485) else [],
        "control_rows": list(fact_tables.control_rows(interface)) if isinstance(interface, Biss) else [],
    }


def _data_id_rows(interface: Rs485) -> Rows:
    return [
        (
            f"{data_id.id:X}",
            code(data_id.name),
            f"`{data_id.control:02X}h`",
            text(data_id.purpose),
            text(data_id.meaning),
            cited(data_id.source),
        )
        for data_id in interface.data_ids
    ]


def _exchange_rows(interface: Interface) -> Rows:
    def frame(layout: Layout | None) -> str:
        return link(code(layout.name), f"#layout-{layout.name}") if layout is not None else "none"

    frame_exchanges = exchanges(interface)
    lengths = len({exchange.request.bits for exchange in frame_exchanges if not exchange.request.in_bytes}) > 1
    return [
        (
            frame(exchange.request),
            frame(exchange.reply),
            *((f"{exchange.request.bits.render()} bits",) if lengths else ()),
            PURPOSES[exchange.exchange.purpose],
            cited(exchange.exchange.source),
        )
        for exchange in frame_exchanges
    ]


def _memory_rows(interface: Rs485) -> Rows:
    return [
        (
            text(access.access),
            f"{access.busy}",
            text(access.address),
            text(access.data),
            text(access.meaning),
            cited(access.source),
        )
        for access in interface.memory_access
    ]


def _group_title(group: FieldGroup) -> str:
    """Return our name, with the name used in the manual in parentheses."""
    return words(group.name).capitalize() + (f" ({group.printed_name})" if group.printed_name else "")


def _layout(device: Device, interface: Interface, layout: Layout) -> Section:
    return {
        "layout": layout,
        "head": say_layout.head(interface, layout, Code(layout.name), device.alternatives),
        "size": STYLE.phrase(statement(*say_layout.size(layout, device.alternatives))),
        "facts": [*say_layout.facts(interface, layout), *needs(device, layout)],
        "rows": list(layout_tables.field_rows(device, layout)),
        "placements": layout_tables.placement_table(device, layout, interface.name),
        "delivered": follows_registers(device, layout),
    }


def _register(device: Device, register: Register) -> Section:
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
        "value_tables": [
            {"field": code(field.name), "rows": list(layout_tables.value_rows(field)), "alone": len(fields) == 1}
            for field in fields
            if layout_tables.has_value_table(field)
        ],
        "joins": say_layout.joins(register.layout),
        "placements": layout_tables.placement_table(device, register.layout, register.interface),
    }


def _procedure(device: Device, procedure: Procedure) -> Section:
    return {
        "procedure": procedure,
        "about": list(say_procedure.about(procedure)),
        "rows": fact_tables.step_rows(device, procedure),
        "arguments": [(argument.name, say_procedure.argument(device, argument)) for argument in procedure.arguments],
    }


def _connector(connector: Connector) -> Section:
    return {
        "connector": connector,
        "head": {"cable": "Wire"}.get(connector.kind, "Pin"),
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
