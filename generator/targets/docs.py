"""The documentation: a Markdown page for each device with pictures of its layouts, and an index; read on a code host as it stands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from .. import markdown, page, page_codes, page_facts
from ..markdown import cited, code, link, text
from ..model import Device, FieldGroup, Interface, Layout, Register, Timing
from ..relevant import follows_registers
from ..render import render
from ..words import hertz, language, sentence
from ..masters import shipped_masters
from . import Library, TargetError, docs_masters

FILTERS: Mapping[str, Callable[..., Any]] = {
    "md": markdown.text, "paragraph": markdown.paragraph, "code": markdown.code, "cited": markdown.cited, "anchor": markdown.anchor, "sentence": sentence,
}



def generate(library: Library) -> dict[str, str]:
    """``docs/README.md``, and for each device ``docs/<device>.md`` with its pictures in a folder of that name, and ``docs/<device>-masters.md``."""
    try:
        masters = shipped_masters()
    except ValueError as error:
        raise TargetError(str(error)) from None
    files = {"docs/README.md": _index(library)}
    for device in library.devices:
        files[f"docs/{device.name}.md"] = _tidy(render("markdown", "device.md.jinja", _device_values(device), FILTERS, library.own_templates))
        if docs_masters.has_masters(device):
            values = {"table": markdown.table, **docs_masters.page_values(device, masters)}
            files[f"docs/{device.name}-masters.md"] = _tidy(render("markdown", "masters.md.jinja", values, FILTERS, library.own_templates))
        files |= {f"docs/{device.name}/{name}.svg": picture for name, picture in _pictures(device).items()}
    return files


def _tidy(made: str) -> str:
    """No line ends in spaces, no two empty lines follow each other, and one line end closes the file."""
    lines: list[str] = []
    for line in made.splitlines():
        if line.strip() or (lines and lines[-1]):
            lines.append(line.rstrip())
    return "\n".join(lines).rstrip() + "\n"


def _index(library: Library) -> str:
    rows = []
    for device in library.devices:
        manual = f"{text(device.manual.title)}, revision {text(device.manual.revision)}" + (f" of {device.manual.date}" if device.manual.date else "")
        titles = ", ".join(item.title for item in device.interfaces)
        masters = link("settings", f"{device.name}-masters.md") if docs_masters.has_masters(device) else ""
        rows.append([link(text(device.title), f"{device.name}.md"), text(device.manufacturer.title), titles, f"{len(device.variants)}", masters, manual])
    patterns = [
        [", ".join(code(item.code) for item in device.variants if item.interface == part.kind), link(part.title, f"{device.name}.md#interface-{part.kind}")]
        for device in library.devices
        for part in device.interfaces
    ]
    trademarks = list(dict.fromkeys(note for maker, _ in library.by_manufacturer() for note in maker.trademarks))
    values = {"rows": rows, "pattern_rows": patterns, "trademarks": trademarks, "table": markdown.table}
    return _tidy(render("markdown", "index.md.jinja", values, FILTERS, library.own_templates))


def _pictures(device: Device) -> dict[str, str]:
    made = {layout.name: page.layout_picture(device, interface, layout) for interface, layout in device.layouts()}
    made |= {name: page.group_picture(device, name) for interface in device.interfaces for name in page.used_groups(interface)}
    return made | {f"register-{item.name}": page.register_picture(device, item) for item in device.registers if page.has_picture(item)}


def _device_values(device: Device) -> dict[str, Any]:
    return {
        "device": device,
        "has_masters": docs_masters.has_masters(device),
        "table": markdown.table,
        "timing_rows": _timings,
        "errata_links": partial(page.errata_links, device),
        "table_rows": lambda item: [list(map(text, row)) for row in item.rows],
        "contents": _contents(device),
        **_identity(device),
        "interfaces": [_interface(device, item) for item in device.interfaces],
        "crcs": [{"crc": item, "rows": page_facts.crc_rows(item)} for item in device.crcs],
        "registers": [_register(device, item) for item in device.registers],
        "register_rows": [_register_row(device, item) for item in device.registers],
        "procedures": [
            {
                "procedure": item,
                "interface": device.interface(item.interface).title,
                "rows": page_facts.step_rows(device, item),
                "arguments": [page_facts.argument_line(part) for part in item.arguments],
            }
            for item in device.procedures
        ],
        "alarms": [
            {"alarm": item, "rows": page_facts.alarm_facts(device, item), "title": page.title(item.name, item.printed_name, item.names)} for item in device.alarms
        ],
        **_wiring(device),
        **_evidence(device),
    }


def _timings(timings: tuple[Timing, ...]) -> list[tuple[str, ...]]:
    return list(page_facts.timing_rows(timings))


def _contents(device: Device) -> list[tuple[str, str]]:
    parts = [("Order codes", "order-codes", True), *((item.title, f"interface-{item.kind}", True) for item in device.interfaces)]
    parts += [("CRCs", "crcs", bool(device.crcs)), ("Registers", "registers", bool(device.registers)), ("Procedures", "procedures", bool(device.procedures))]
    parts += [("Errors and warnings", "alarms", bool(device.alarms)), ("Times of the device", "timings", bool(device.timings)), ("Inputs", "inputs", bool(device.inputs))]
    parts += [("Connectors and cables", "connectors", bool(device.connectors)), ("LEDs", "leds", bool(device.leds))]
    parts += [("Characteristics, mounting, safety", "characteristics", bool(device.characteristics))]
    parts += [(item.title, f"table-{item.name}", True) for item in device.tables]
    parts += [("Worked examples", "examples", bool(device.examples)), ("Errata", "errata", bool(device.errata))]
    parts += [("Figures that were not available", "lost-figures", bool(device.lost_figures)), ("Sources", "documents", True)]
    return [(title, name) for title, name, there in parts if there]


def _identity(device: Device) -> dict[str, Any]:
    manual = device.manual
    rows = [("Manual", text(manual.title)), ("Revision", f"{text(manual.revision)}" + (f" of {manual.date}" if manual.date else ""))]
    rows += [("Language", text(language(manual.language))), ("Publisher", text(manual.publisher)), ("Manufacturer", text(device.manufacturer.title))]
    rows += [("Other edition", ", ".join(filter(None, [text(language(item.language)), text(item.title), f"revision {text(item.revision)}", item.date]))) for item in manual.editions]
    return {
        "manual_rows": [row for row in rows if row[1]],
        "part_rows": list(page_codes.part_rows(device)),
        "spelling_rows": list(page_codes.spelling_rows(device)),
        "parameter_rows": list(page_codes.parameter_rows(device)),
        "run_time_rows": list(page_codes.run_time_rows(device)),
        "code_tables": page_codes.code_tables(device),
        "measurement_rows": list(page_codes.measurement_rows(device)),
    }


def _interface(device: Device, interface: Interface) -> dict[str, Any]:
    groups = {item.name: item for item in device.field_groups}
    return {
        "interface": interface,
        "rows": list(page_facts.interface_rows(interface)),
        "paths": [f"interfaces.{interface.kind}.{name}" for name in ("clock", "timeout", "network", "port", "profile", "alignment", "output_code", "signals", "description_file")],
        "timing_paths": [f"interfaces.{interface.kind}.{item.name}" for item in interface.timings] + [f"interfaces.{interface.kind}.timings"],
        "cable_rows": [(f"{item.shorter_than_m} m", hertz(item.below_hz), cited(item.source)) for item in interface.cable_lengths],
        "data_id_rows": [
            (f"{item.id:X}", code(item.name), f"`{item.control:02X}h`", text(item.purpose), text(item.meaning), cited(item.source)) for item in interface.data_ids
        ],
        "layouts": [_layout(device, interface, item) for item in interface.layouts],
        "groups": [
            {"group": groups[name], "title": _group_title(groups[name]), "rows": page.group_rows(device, name)}
            for name in page.used_groups(interface)
        ],
        "memory_rows": [
            (text(item.access), f"{item.busy}", text(item.address), text(item.data), text(item.meaning), cited(item.source)) for item in interface.memory_access
        ],
        "control_rows": list(page_facts.control_rows(interface)),
    }


def _group_title(group: FieldGroup) -> str:
    """Our name, and in parentheses the manual's own in each language."""
    own = [group.printed_name, *(f"{key}: {name}" for key, name in group.names.items())]
    return page.title(group.name, "", {}) + (f" ({', '.join(filter(None, own))})" if any(own) else "")


def _layout(device: Device, interface: Interface, layout: Layout) -> dict[str, Any]:
    is_bytes = layout.carried_as == "bytes"
    size = f"{layout.widest // 8} byte{'s' * (layout.widest > 8)}" if is_bytes else f"{page.expression(layout.bits)} bits, most significant first"
    order = f", {layout.byte_order.replace('_', ' ')}" if is_bytes and layout.widest > 8 else ""
    ids = {item.id: item.name for item in interface.data_ids}
    told = ", ".join(f"{value:X} {code(ids[value])}" if value in ids else f"{value:X}" for value in layout.selects)
    gray = _gray(layout)
    gaps = f" Bits without a field are {layout.gaps}." if layout.gaps else ""
    printed = f"{text(layout.printed_name)}. " if layout.printed_name else ""
    channel = f" over data channel {layout.channel}" if layout.channel is not None else ""
    summary = f"{printed}Sent by the {layout.sender}{channel}: {size}{order}." + (f" With {code(layout.selector)} {told}." if told else "") + gray + gaps
    return {
        "layout": layout,
        "summary": summary,
        "place_head": "Place" if is_bytes else "Bits, high to low",
        "rows": list(page.field_rows(device, layout)),
        "joins": page.join_lines(layout),
        "placements": page.placement_table(device, layout, interface.kind),
        "delivered": follows_registers(device, layout),
    }


def _gray(layout: Layout) -> str:
    if not layout.gray_of:
        return ""
    when = f" where {code(layout.gray_when)} is 1, in binary where it is 0" if layout.gray_when else ""
    return f" {code(layout.gray_of)} is in Gray code{when}."


def _register(device: Device, register: Register) -> dict[str, Any]:
    fields = register.layout.fields
    rows = list(page.field_rows(device, register.layout))
    is_plain = len(fields) == 1 and rows[0][3:] == ("", "") and fields[0].name == register.name
    return {
        "register": register,
        "title": page.title(register.name, register.printed_name, register.names),
        "facts": [("Name", code(register.name)), *page_facts.register_facts(device, register)],
        "has_picture": page.has_picture(register),
        "rows": [] if is_plain else rows,
        "value_tables": [
            {"field": code(item.name), "rows": list(page.value_rows(item)), "alone": len(fields) == 1} for item in fields if page.has_value_table(item)
        ],
        "joins": page.join_lines(register.layout),
        "placements": page.placement_table(device, register.layout, register.interface),
    }


def _register_row(device: Device, register: Register) -> tuple[str, ...]:
    data = register.default_bytes()
    name = link(code(register.name), f"#register-{register.name}")
    default = f"`{data.hex(' ').upper()}`" if data is not None else ""
    bank = "" if register.bank is None else f"{register.bank}"
    return bank, page.address(register), name, page_facts.access(register), default, device.interface(register.interface).title, cited(register.source)


def _wiring(device: Device) -> dict[str, Any]:
    titles = {item.kind: item.title for item in device.interfaces}
    return {
        "inputs": [
            {"input": item, "title": page.title(item.name, item.printed_name, item.names), "rows": page_facts.input_facts(device, item)} for item in device.inputs
        ],
        "connectors": [
            {
                "connector": item,
                "interfaces": ", ".join(titles.get(kind, kind) for kind in item.interfaces) or "all interfaces",
                "head": "Wire" if item.kind == "cable" else "Pin",
                "rows": [(text(part.contact), text(part.signal), code(part.only)) for part in item.contacts],
            }
            for item in device.connectors
        ],
        "led_rows": [
            (text(item.title) if index == 0 else "", text(state.state), text(state.meaning), cited(item.source) if index == 0 else "")
            for item in device.leds
            for index, state in enumerate(item.states)
        ],
        "characteristic_rows": [(code(item.name), text(item.value), code(item.only), cited(item.source)) for item in device.characteristics],
    }


def _evidence(device: Device) -> dict[str, Any]:
    is_open = [item for item in device.errata if item.status == "open"]
    return {
        "examples": [{"example": item, "rows": page_facts.example_facts(device, item)} for item in device.examples],
        "errata_summary": f"{len(device.errata)} places where the manual cannot be taken literally; {len(is_open)} of them are open.",
        "erratum_rows": [
            (link(code(item.name), f"#erratum-{item.name}"), text(item.printed), text(item.used), item.status, page_facts.severity(item.severity)) for item in device.errata
        ],
        "errata_list": [
            {
                "erratum": item,
                "rows": [
                    ("Printed", text(item.printed)), ("Used", text(item.used)), ("Why", text(item.why)), ("Status", page_facts.status(item.status)),
                    ("Literally", page_facts.severity(item.severity)), ("Affects", ", ".join(map(code, item.affects))), ("Source", cited(item.source)),
                ],
            }
            for item in device.errata
        ],
        "lost_rows": [(text(item.content), cited(item.source)) for item in device.lost_figures],
        "document_rows": [(code(item.key), text(item.title), f"<{item.url}>" if item.url else "") for item in device.documents],
        "history_rows": [(text(item.revision), item.date, text(item.changes), text(item.hardware), text(item.software)) for item in device.manual.history],
    }
