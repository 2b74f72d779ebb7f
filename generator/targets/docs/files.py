"""The documentation: a Markdown page for each device with pictures of its layouts, and an index."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TypedDict

from ...masters.sheet import shipped_masters
from ...model import Biss, Device, FieldGroup, Interface, Layout, Manual, Register, Rs485, Table, TimesRead
from ...reference.parameters import follows_registers
from ...reference.parts import for_interface
from ...render import Templates, our_templates
from ...say import alarm, hardware_input, markdown
from ...say import layout as say_layout
from ...say import procedure as say_procedure
from ...say import register as say_register
from ...say.alternative import needs
from ...say.markdown import cited, code, joined, link, text
from ...say.name import full_title, heading, title, words
from ...say.origin import origin, other_editions
from ...say.place import addresses
from ...say.text import Code, Said
from ...say.words import counted, language, sentence
from .. import NO_OPTIONS, Library, Options, Target, TargetError
from . import across, by_code, changes, codes, evidence, facts, layouts, usable, waves
from . import masters as masters_page
from .patterns import patterns

#: Rows of a table; its cells are Markdown.
Rows = list[tuple[str, ...]]
#: A section of a page, by what the template calls its parts.
Section = dict[str, Any]


class Index(TypedDict):
    rows: Annotated[Rows, "a row for each family"]
    usable_page: Annotated[str, "the page that says whether a position is usable"]
    order_codes: Annotated[list[Section], "for each interface of a family: label, interface, patterns, counted, links"]
    trademarks: Annotated[list[str], "notices on trademarks"]


class Codes(TypedDict):
    manual_rows: Annotated[Rows, "the manual: title, revision, language, publisher"]
    part_rows: Annotated[Rows, "the parts of an order code and what each value stands for"]
    spelling_rows: Annotated[Rows, "labels that are written otherwise"]
    parameter_rows: Annotated[Rows, "the quantities that follow from an order code"]
    run_time_rows: Annotated[Rows, "the quantities that registers hold"]
    code_tables: Annotated[list[Section], "the listed order codes: title, head, rows"]
    measurement_rows: Annotated[Rows, "what a position counts"]


class Wiring(TypedDict):
    inputs: Annotated[list[Section], "the inputs: input, title, rows"]
    connectors: Annotated[list[Section], "connectors and cables: connector, interfaces, head, rows"]
    led_rows: Annotated[Rows, "the LEDs and what each state means"]
    characteristic_rows: Annotated[Rows, "characteristics, mounting, safety"]


class Parts(Wiring, evidence.Evidence):
    device: Annotated[Device, "the family"]
    origin: Annotated[list[Said], "what the family is beside what its manual says: overlays, another edition"]
    usable_page: Annotated[str, "the page that says whether a position is usable"]
    alternatives: Annotated[list[Section], "what the manual leaves open: alternative, title, rows, reasons, frames"]
    errata_links: Annotated[Callable[..., str], "links to the errata of a path into the spec, or of several paths"]
    interfaces: Annotated[list[Section], "the interfaces with their layouts, data IDs, cables and control frames"]
    crcs: Annotated[list[Section], "the CRCs: crc, rows"]
    registers: Annotated[list[Section], "the registers with their fields, values and facts"]
    register_rows: Annotated[Rows, "the registers in short"]
    procedures: Annotated[list[Section], "the procedures: procedure, interface, rows, arguments"]
    alarms: Annotated[list[Section], "errors and warnings: alarm, title, rows"]


class DevicePage(Parts, Codes):
    contents: Annotated[list[tuple[str, str]], "title and anchor of each section"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]


class CodePage(Parts, by_code.CodeValues):
    pass


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """``docs/README.md``, and pages across families: usable or not, which encoder, registers by address, alarms.

    For each device ``docs/<device>.md``, its pictures, ``docs/<device>-masters.md`` and ``docs/<device>-changes.md``,
    and a page for each order code in ``docs/<device>/``.
    """
    try:
        masters = shipped_masters()
    except ValueError as error:
        raise TargetError(str(error)) from None
    families = [by_code.Codes(item) for item in library.devices]
    files = {"docs/README.md": _index(library, families), f"docs/{usable.PAGE}": _usable(library), **_across(library)}
    for family in families:
        device = family.device
        own = library.own_templates
        has_masters = masters_page.has_masters(device)
        page: DevicePage = {
            **_parts(device),
            **_identity(family),
            "contents": _contents(device),
            "has_masters": has_masters,
        }
        files[f"docs/{device.name}.md"] = _tidy(TEMPLATES.render("device.md.jinja", page, own))
        files |= _by_code(family, own)
        if has_masters:
            values = masters_page.page_values(device, masters)
            files[f"docs/{device.name}-masters.md"] = _tidy(TEMPLATES.render("masters.md.jinja", values, own))
        told = changes.page_values(device)
        files[f"docs/{changes.page(device)}"] = _tidy(TEMPLATES.render("changes.md.jinja", told, own))
        files |= {f"docs/{device.name}/{name}.svg": picture for name, picture in _pictures(device).items()}
    return files


def _by_code(family: by_code.Codes, own: Path | None) -> Iterator[tuple[str, str]]:
    """A page for each order code with its pictures; those that are the same to a program share one."""
    device = family.device
    taken = {item.name for item in device.interfaces if masters_page.has_masters(for_interface(device, item.name))}
    for alike in family.alike:
        page: CodePage = {**_parts(alike.here), **by_code.values(alike, alike.interface.name in taken)}
        yield f"docs/{device.name}/{alike.name}.md", _tidy(TEMPLATES.render("code.md.jinja", page, own))
        for name, picture in by_code.pictures(alike):
            yield f"docs/{device.name}/{name}", picture


def _tidy(made: str) -> str:
    """No line ends in spaces, no two empty lines follow each other, and one line end closes the file."""
    lines: list[str] = []
    for line in made.splitlines():
        if line.strip() or (lines and lines[-1]):
            lines.append(line.rstrip())
    return "\n".join(lines).rstrip() + "\n"


def _index(library: Library, families: Sequence[by_code.Codes]) -> str:
    rows: Rows = []
    for device in library.devices:
        page, maker = link(text(device.title), f"{device.name}.md"), text(device.manufacturer.title)
        titles = ", ".join(item.title for item in device.interfaces)
        masters = link("settings", f"{device.name}-masters.md") if masters_page.has_masters(device) else ""
        manual = f"{text(device.manual.title)}, revision {_revision(device.manual)}"
        rows.append((page, maker, titles, f"{len(device.variants)}", masters, manual))
    found: list[Section] = [
        {
            "label": f"{device.name.upper()}, {part.title}",
            "patterns": ", ".join(map(code, patterns(device, of_part))),
            "counted": counted(len(of_part), "order code"),
            "interface": link(f"{device.name.upper()}, {part.title}", f"{device.name}.md#interface-{part.name}"),
            "links": [family.links[item] for item in of_part],
        }
        for family in families
        for device in [family.device]
        for part in device.interfaces
        if (of_part := [item.code for item in device.variants if item.interface == part.name])
    ]
    trademarks = list(dict.fromkeys(note for maker, _ in library.by_manufacturer() for note in maker.trademarks))
    values: Index = {"rows": rows, "usable_page": usable.PAGE, "order_codes": found, "trademarks": trademarks}
    return _tidy(TEMPLATES.render("index.md.jinja", values, library.own_templates))


def _usable(library: Library) -> str:
    return _tidy(TEMPLATES.render("usable.md.jinja", usable.page_values(library.devices), library.own_templates))


def _across(library: Library) -> dict[str, str]:
    pages: dict[str, Mapping[str, Any]] = {
        across.WHICH: across.which(library.devices),
        across.REGISTERS: across.registers(library.devices),
        across.ALARMS: across.alarms(library.devices),
    }
    return {
        f"docs/{name}": _tidy(TEMPLATES.render(f"{name}.jinja", values, library.own_templates))
        for name, values in pages.items()
    }


def _revision(manual: Manual) -> str:
    return text(manual.revision) + (f" of {manual.date}" if manual.date else "")


def _pictures(device: Device) -> dict[str, str]:
    made = {layout.name: layouts.layout_picture(device, interface, layout) for interface, layout in device.layouts()}
    made |= {
        name: layouts.group_picture(device, name)
        for interface in device.interfaces
        for name in layouts.used_groups(interface)
    }
    waves_of = ((item.name, waves.wave(device, item)) for item in device.interfaces)
    made |= {f"timing-{name}": waves.drawn(item) for name, item in waves_of if item is not None}
    return made | {
        f"register-{item.name}": layouts.register_picture(device, item)
        for item in device.registers
        if layouts.has_picture(item)
    }


def _parts(device: Device) -> Parts:
    return {
        "device": device,
        "origin": [*origin(device), *other_editions(device)],
        "usable_page": usable.PAGE,
        "alternatives": codes.alternatives(device),
        "errata_links": partial(layouts.errata_links, device),
        "interfaces": [_interface(device, item) for item in device.interfaces],
        "crcs": [{"crc": item, "rows": facts.crc_rows(item)} for item in device.crcs],
        "registers": [_register(device, item) for item in device.registers],
        "register_rows": [_register_row(device, item) for item in device.registers],
        "procedures": [
            {
                "procedure": item,
                "interface": device.interface(item.interface).title,
                "about": list(say_procedure.about(item)),
                "rows": facts.step_rows(device, item),
                "arguments": [(part.name, say_procedure.argument(device, part)) for part in item.arguments],
            }
            for item in device.procedures
        ],
        "alarms": [
            {"alarm": item, "title": full_title(item), "facts": alarm.facts(device, item)} for item in device.alarms
        ],
        **_wiring(device),
        **evidence.evidence(device),
    }


def _table_rows(table: Table) -> Rows:
    """The rows of a table of the manual."""
    return [tuple(map(text, row)) for row in table.rows]


def _contents(device: Device) -> list[tuple[str, str]]:
    parts: list[tuple[str, str, object]] = [
        ("Order codes", "order-codes", True),
        ("What the manual leaves open", "alternatives", device.alternatives),
        *((item.title, f"interface-{item.name}", True) for item in device.interfaces),
        ("CRCs", "crcs", device.crcs),
        ("Registers", "registers", device.registers),
        ("Procedures", "procedures", device.procedures),
        ("Errors and warnings", "alarms", device.alarms),
        ("Times of the device", "timings", device.timings),
        ("Inputs", "inputs", device.inputs),
        ("Connectors and cables", "connectors", device.connectors),
        ("LEDs", "leds", device.leds),
        ("Characteristics, mounting, safety", "characteristics", device.characteristics),
        *((item.title, f"table-{item.name}", True) for item in device.tables),
        ("Worked examples", "examples", device.examples),
        ("Editions of the manual", "editions", device.editions),
        ("Errata", "errata", device.errata),
        ("Figures that were not available", "lost-figures", device.lost_figures),
        ("Sources", "documents", True),
    ]
    return [(title, name) for title, name, there in parts if there]


def _identity(family: by_code.Codes) -> Codes:
    device = family.device
    manual = device.manual
    rows = [
        ("Manual", text(manual.title)),
        ("Revision", _revision(manual)),
        ("Language", text(language(manual.language))),
        ("Publisher", text(manual.publisher)),
        ("Read", _times_read(device.times_read)),
        ("Manufacturer", text(device.manufacturer.title)),
    ]
    for item in manual.editions:
        about = [text(language(item.language)), text(item.title), f"revision {text(item.revision)}", item.date]
        rows.append(("Other edition", joined(about, ", ")))
    rows.append(("Version", f"{text(device.manufacturer.version)}, {link('what each changed', changes.page(device))}"))
    return {
        "manual_rows": [row for row in rows if row[1]],
        "part_rows": list(codes.part_rows(device)),
        "spelling_rows": list(codes.spelling_rows(device)),
        "parameter_rows": list(codes.parameter_rows(device)),
        "run_time_rows": list(codes.run_time_rows(device)),
        "code_tables": codes.code_tables(device, family.links),
        "measurement_rows": list(codes.measurement_rows(device)),
    }


def _times_read(counts: TimesRead | None) -> str:
    """How many facts a second reader found alike; empty where there was none."""
    if counts is None:
        return ""
    every = counts.twice + counts.explained + counts.once
    otherwise = f", {counts.explained} otherwise for reasons that the errata give" if counts.explained else ""
    return f"Twice, and settled by the manual: {counts.twice} of {every} facts are alike in both readings{otherwise}"


#: What an interface says of itself, by which its errata are found.
_FACTS = (
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
    groups = {item.name: item for item in device.field_groups}
    place = f"interfaces.{interface.name}"
    return {
        "interface": interface,
        "rows": list(facts.interface_rows(device, interface)),
        "paths": [f"{place}.{name}" for name in _FACTS],
        "timing_paths": [f"{place}.{item.name}" for item in interface.timings] + [f"{place}.timings"],
        "data_id_rows": _data_id_rows(interface) if isinstance(interface, Rs485) else [],
        "layouts": [_layout(device, interface, item) for item in interface.layouts],
        "groups": [
            {
                "group": groups[name],
                "title": _group_title(groups[name]),
                "frames": layouts.frames_with(interface, name),
                "rows": layouts.group_rows(device, name),
            }
            for name in layouts.used_groups(interface)
        ],
        "memory_rows": _memory_rows(interface) if isinstance(interface, Rs485) else [],
        "control_rows": list(facts.control_rows(interface)) if isinstance(interface, Biss) else [],
    }


def _data_id_rows(interface: Rs485) -> Rows:
    return [
        (
            f"{item.id:X}",
            code(item.name),
            f"`{item.control:02X}h`",
            text(item.purpose),
            text(item.meaning),
            cited(item.source),
        )
        for item in interface.data_ids
    ]


def _memory_rows(interface: Rs485) -> Rows:
    return [
        (
            text(item.access),
            f"{item.busy}",
            text(item.address),
            text(item.data),
            text(item.meaning),
            cited(item.source),
        )
        for item in interface.memory_access
    ]


def _group_title(group: FieldGroup) -> str:
    """Our name, and in parentheses the manual's own in each language."""
    own = [group.printed_name, *(f"{key}: {name}" for key, name in group.names.items())]
    return words(group.name).capitalize() + (f" ({', '.join(filter(None, own))})" if any(own) else "")


def _layout(device: Device, interface: Interface, layout: Layout) -> Section:
    return {
        "layout": layout,
        "head": say_layout.head(interface, layout, Code(layout.name)),
        "facts": [*say_layout.facts(interface, layout), *needs(device, layout)],
        "rows": list(layouts.field_rows(device, layout)),
        "picture": layouts.picture_text(layout, interface.title),
        "placements": layouts.placement_table(device, layout, interface.name),
        "delivered": follows_registers(device, layout),
    }


def _register(device: Device, register: Register) -> Section:
    fields = register.layout.fields
    rows = list(layouts.field_rows(device, register.layout))
    is_plain = len(fields) == 1 and rows[0][3:] == ("", "") and fields[0].name == register.name
    return {
        "register": register,
        "title": full_title(register),
        "head": say_register.head(device, register, Code(register.name)),
        "facts": say_register.facts(device, register),
        "has_picture": layouts.has_picture(register),
        "rows": [] if is_plain else rows,
        "value_tables": [
            {"field": code(item.name), "rows": list(layouts.value_rows(item)), "alone": len(fields) == 1}
            for item in fields
            if layouts.has_value_table(item)
        ],
        "joins": say_layout.joins(register.layout),
        "placements": layouts.placement_table(device, register.layout, register.interface),
    }


def _register_row(device: Device, register: Register) -> tuple[str, ...]:
    data = register.default_bytes()
    return (
        "" if register.bank is None else f"{register.bank}",
        addresses(register),
        link(code(register.name), f"#register-{register.name}"),
        say_register.access(register),
        f"`{data.hex(' ').upper()}`" if data is not None else "",
        device.interface(register.interface).title,
        cited(register.source),
    )


def _wiring(device: Device) -> Wiring:
    titles = {item.name: item.title for item in device.interfaces}
    return {
        "inputs": [
            {"input": item, "title": full_title(item), "facts": hardware_input.facts(device, item)}
            for item in device.inputs
        ],
        "connectors": [
            {
                "connector": item,
                "interfaces": ", ".join(titles.get(kind, kind) for kind in item.interfaces) or "all interfaces",
                "head": {"cable": "Wire"}.get(item.kind, "Pin"),
                "rows": [(text(part.contact), text(part.signal), code(part.only)) for part in item.contacts],
            }
            for item in device.connectors
        ],
        "led_rows": [
            (
                text(item.title) if index == 0 else "",
                text(state.state),
                text(state.meaning),
                cited(item.source) if index == 0 else "",
            )
            for item in device.leds
            for index, state in enumerate(item.states)
        ],
        "characteristic_rows": [
            (code(item.name), text(item.value), code(item.only), cited(item.source)) for item in device.characteristics
        ],
    }


TEMPLATES = Templates(
    our_templates("docs"),
    values={
        "index.md.jinja": Index,
        "device.md.jinja": DevicePage,
        "code.md.jinja": CodePage,
        "masters.md.jinja": masters_page.MastersPage,
        "changes.md.jinja": changes.ChangesPage,
        "usable.md.jinja": usable.UsablePage,
        f"{across.WHICH}.jinja": across.WhichPage,
        f"{across.REGISTERS}.jinja": across.RegistersPage,
        f"{across.ALARMS}.jinja": across.AlarmsPage,
    },
    filters={
        "md": markdown.text,
        "paragraph": markdown.paragraph,
        "code": markdown.code,
        "cited": markdown.cited,
        "anchor": markdown.anchor,
        "sentence": sentence,
        "titled": title,
        "heading": heading,
        "addresses": addresses,
        "said": markdown.STYLE.sentence,
    },
    functions={"table": markdown.table, "timing_rows": facts.timing_rows, "table_rows": _table_rows},
)
TARGET = Target(
    name="docs",
    summary="Markdown pages with pictures of every frame, and the settings of BiSS and SSI masters",
    files=generate,
    templates=TEMPLATES,
)
