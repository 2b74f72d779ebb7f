"""Pages about an interface, and their sections: frames, registers, procedures and so on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
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
    Variant,
)
from ...order_codes.parameters import follows_registers
from ...order_codes.reduction import for_interface
from ...plan.frames import exchanges
from ...say import commands_and_alarms as say_commands
from ...say import layout as say_layout
from ...say import register as say_register
from ...say.errata import needed_answers
from ...say.names_and_evidence import (
    HasOtherNames,
    addresses_text,
    differences_from_manual,
    name_in_words,
    other_editions,
    title_of,
    word_for_document,
)
from ...say.order_code import PURPOSES, words_for_initial_values
from ...say.text import (
    MARKDOWN,
    CodeText,
    Statement,
    citation,
    code_span,
    escape,
    join_filled,
    list_parts,
    markdown_link,
    statement,
)
from . import fact_tables, layout_tables, order_code_tables, verdict_page
from .layout_tables import has_value_table
from .links_and_errata import ErrataLines, links_to_steps
from .order_code_tables import order_codes
from .page_pictures import Pictures
from .timing_pictures import TimingDiagram, timing_diagram

#: Rows of a table, with Markdown cells.
Rows = list[tuple[str, ...]]
#: Parts of a section, by name in the template.
Section = dict[str, Any]


class Sections(TypedDict):
    device: Annotated[Device, "the family, with only the data relevant to this page"]
    document: Annotated[str, "manual, or spec if not all of the manual was read"]
    origin: Annotated[list[Statement], "overlays and the edition of the family"]
    verdict_page: Annotated[str, "the page with the verdicts of the family"]
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
    """Return the sections that the page of an interface and the page of an order code share."""
    return {
        "device": device,
        "document": word_for_document(device),
        "origin": [*differences_from_manual(device), *other_editions(device)],
        "verdict_page": verdict_page.file_name(device),
        "errata_at": ErrataLines(device),
        "alternatives": order_code_tables.alternative_sections(device),
        "interfaces": [_interface_section(device, interface) for interface in device.interfaces],
        "crcs": [{"crc": crc, "rows": fact_tables.crc_rows(device, crc)} for crc in device.crcs],
        "registers": [_register_section(device, register) for register in device.registers],
        "register_rows": [_register_row(register) for register in device.registers],
        "procedures": [_procedure_section(device, procedure) for procedure in device.procedures],
        "alarms": [_alarm_section(device, device_alarm) for device_alarm in device.alarms],
        "inputs": [_input_section(device, device_input) for device_input in device.inputs],
        "connectors": [_connector_section(connector) for connector in device.connectors],
        "led_rows": list(chain.from_iterable(map(_led_rows, device.leds))),
        "examples": [_example_section(device, example) for example in device.examples],
    }


def _alarm_section(device: Device, alarm: Alarm) -> Section:
    """Return an alarm with its title and its facts."""
    return {"alarm": alarm, "title": title_of(alarm), "facts": say_commands.alarm_facts(device, alarm)}


def _input_section(device: Device, hardware_input: Input) -> Section:
    """Return a hardware input with its title and its facts."""
    return {
        "input": hardware_input,
        "title": title_of(hardware_input),
        "facts": say_commands.input_facts(device, hardware_input),
    }


def _example_section(device: Device, example: Example) -> Section:
    """Return a worked example with a row for each of its facts."""
    return {"example": example, "rows": fact_tables.example_facts(device, example)}


def _led_rows(led: Led) -> Iterator[tuple[str, ...]]:
    """Yield rows of LED, state, meaning, order codes, source. Only the first row names the LED and its source."""
    name_cell, source_cell = escape(led.title), citation(led.source)
    for state in led.states:
        meaning = join_filled([escape(state.meaning), *links_to_steps("", state.by_hand)])
        yield name_cell, escape(state.state), meaning, code_span(state.only), source_cell
        name_cell, source_cell = "", ""


#: Keys of an interface whose errata are listed with its facts.
_KEYS_OF_FACTS = (
    "measurement",
    "clock",
    "cable_lengths",
    "timeout",
    "channels",
    "network",
    "port",
    "profile",
    "alignment",
    "output_code",
    "signals",
    "description_file",
)


def _interface_section(device: Device, interface: Interface) -> Section:
    """Return an interface with its facts, frames, requests and groups of fields, and the paths of its errata."""
    group_by_name = {group.name: group for group in device.field_groups}
    used_groups = [group_by_name[name] for name in layout_tables.used_groups(interface)]
    interface_path = f"interfaces.{interface.name}"
    paths_of_interface_timings = [f"{interface_path}.{timing.name}" for timing in interface.timings]
    paths_of_device_timings = [f"timings.{timing.name}" for timing in device.timings]
    data_ids = interface.data_ids if isinstance(interface, Rs485) else ()
    memory_access = interface.memory_access if isinstance(interface, Rs485) else ()
    return {
        "interface": interface,
        "rows": list(fact_tables.interface_rows(device, interface)),
        "path": interface_path,
        "paths": [f"{interface_path}.{key}" for key in _KEYS_OF_FACTS],
        "timing_paths": [*paths_of_interface_timings, f"{interface_path}.timings", *paths_of_device_timings],
        "data_id_rows": [_data_id_row(data_id) for data_id in data_ids],
        "exchange_rows": _exchange_rows(interface),
        "layouts": [_layout_section(device, interface, layout) for layout in interface.layouts],
        "groups": [_group_section(device, interface, group) for group in used_groups],
        "memory_rows": [_memory_row(access) for access in memory_access],
        "control_rows": list(fact_tables.control_rows(interface)) if isinstance(interface, Biss) else [],
    }


def _group_section(device: Device, interface: Interface, field_group: FieldGroup) -> Section:
    """Return a group of fields with a row for each field, and links to the frames that contain the group."""
    return {
        "group": field_group,
        "title": _group_title(field_group),
        "frames": layout_tables.links_to_frames_with(interface, field_group.name),
        "rows": layout_tables.group_rows(device, field_group.name),
    }


def _data_id_row(data_id: DataId) -> tuple[str, ...]:
    """Return a row of data ID, name, control byte, purpose, meaning, source for a request of the T-format."""
    return (
        f"{data_id.id:X}",
        code_span(data_id.name),
        f"`{data_id.control:02X}h`",
        escape(data_id.purpose),
        escape(data_id.meaning),
        citation(data_id.source),
    )


def _exchange_rows(interface: Interface) -> Rows:
    """Return rows of request, reply, length, purpose, source for the requests of an interface.

    The length is included only if requests that consist of bits have different lengths.
    """
    frame_exchanges = exchanges(interface)
    bit_counts = {exchange.request.bits for exchange in frame_exchanges if not exchange.request.in_bytes}
    exchange_rows: Rows = []
    for exchange in frame_exchanges:
        length_cells = [f"{exchange.request.bits.render()} bits"] if len(bit_counts) > 1 else []
        purpose = PURPOSES[exchange.exchange.purpose]
        frame_links = [_layout_link(exchange.request), _layout_link(exchange.reply)]
        exchange_rows.append((*frame_links, *length_cells, purpose, citation(exchange.exchange.source)))
    return exchange_rows


def _layout_link(layout: Layout | None) -> str:
    """Return a link to a frame on the same page, or ``none`` without a frame."""
    return markdown_link(code_span(layout.name), f"#layout-{layout.name}") if layout is not None else "none"


def _memory_row(access: MemoryAccess) -> tuple[str, ...]:
    """Return a row of access, busy, address, data, meaning, source for one kind of memory access."""
    return (
        escape(access.access),
        f"{access.busy}",
        escape(access.address),
        escape(access.data),
        escape(access.meaning),
        citation(access.source),
    )


def _group_title(field_group: FieldGroup) -> str:
    """Return the name of a group in words, followed by its name in the manual in parentheses."""
    printed_name = f" ({field_group.printed_name})" if field_group.printed_name else ""
    return name_in_words(field_group.name).capitalize() + printed_name


def _layout_section(device: Device, interface: Interface, layout: Layout) -> Section:
    """Return a frame with its size, its facts, a row for each field, and the positions of its fields by order code."""
    size = statement(*say_layout.describe_size(layout, device.alternatives))
    return {
        "layout": layout,
        "head": say_layout.describe_head(interface, layout, CodeText(layout.name), device.alternatives),
        "size": MARKDOWN.phrase(size),
        "facts": [*say_layout.describe_layout_facts(interface, layout), *needed_answers(device, layout)],
        "rows": list(layout_tables.field_rows(device, layout)),
        "placements": layout_tables.table_of_positions(device, layout, interface.name),
    }


def _register_section(device: Device, register: Register) -> Section:
    """Return a register with its facts, a row for each field, and tables of named values.

    A single field with the name of the register has no row if it has neither a meaning nor a source of its own.
    """
    fields = register.layout.fields
    has_only_field = len(fields) == 1
    field_rows = list(layout_tables.field_rows(device, register.layout))
    # A row consists of the field, its place, its width, its meaning and its source.
    _, _, _, meaning_cell, source_cell = field_rows[0]
    is_named_like_register = has_only_field and fields[0].name == register.name
    adds_nothing = not meaning_cell and not source_cell
    return {
        "register": register,
        "title": title_of(register),
        "access": say_register.describe_access(register),
        "head": say_register.describe_head(device, register, CodeText(register.name)),
        "facts": say_register.describe_register_facts(device, register),
        "rows": [] if is_named_like_register and adds_nothing else field_rows,
        "value_tables": [_value_table(field, has_only_field) for field in fields if has_value_table(field)],
        "joins": say_layout.describe_joins(register.layout),
        "placements": layout_tables.table_of_positions(device, register.layout, register.interface),
    }


def _value_table(field: Field, is_only_field: bool) -> Section:
    """Return the named values of a field as a table, and whether it is the only field of its register."""
    return {"field": code_span(field.name), "rows": list(layout_tables.value_rows(field)), "alone": is_only_field}


def _procedure_section(device: Device, procedure: Procedure) -> Section:
    """Return a procedure with its precondition and result, a row for each step, and its arguments."""
    names_and_texts = [
        (argument.name, say_commands.describe_argument(device, argument)) for argument in procedure.arguments
    ]
    return {
        "procedure": procedure,
        "about": list(say_commands.about_procedure(procedure)),
        "rows": fact_tables.step_rows(device, procedure),
        "arguments": names_and_texts,
    }


def _connector_section(connector: Connector) -> Section:
    """Return a connector or cable with a row for each contact: contact, signal, order codes."""
    return {
        "connector": connector,
        "head": "Wire" if connector.kind == "cable" else "Pin",
        "rows": [
            (escape(contact.contact), escape(contact.signal), code_span(contact.only)) for contact in connector.contacts
        ],
    }


def _register_row(register: Register) -> tuple[str, ...]:
    """Return a row of bank, addresses, register, access, default, source for the overview of registers."""
    default_bytes = register.default_bytes()
    return (
        "" if register.bank is None else f"{register.bank}",
        addresses_text(register),
        markdown_link(code_span(register.name), f"#register-{register.name}"),
        say_register.describe_access(register),
        f"`{default_bytes.hex(' ').upper()}`" if default_bytes is not None else "",
        citation(register.source),
    )


Row = tuple[str, ...]


class InterfaceValues(TypedDict):
    """Values of a page about one interface, in addition to its sections."""

    interface: Annotated[Interface, "the interface"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]
    short_rows: Annotated[list[Row], "fact, value, source: the position, the supply, the interface"]
    pictures: Annotated[Pictures, "pictures by their subject, such as `register-preset`: name, text"]
    timing: Annotated[TimingDiagram | None, "timing diagram of the interface, if there is one"]
    frames_set_by_registers: Annotated[
        Sequence[str], "frames in which positions of fields, or the code, depend on registers"
    ]
    initial: Annotated[str, "values until these registers are read: factory defaults or values of the order code"]


class InterfacePage(Sections, InterfaceValues):
    order_codes: Annotated[str, "the order codes with the interface, or patterns if there are many"]
    code_table: Annotated[Section, "these order codes as links, with their quantities: head, rows"]
    parameter_rows: Annotated[Rows, "quantities set by an order code"]
    run_time_rows: Annotated[Rows, "quantities held by registers"]
    name_rows: Annotated[Rows, "names in the manual and its other editions: here, manual, language, name"]


class SubjectPage(InterfacePage):
    subject: Annotated[str, "subject of the page: `fields`, `registers`, `procedures`, `wiring` or `examples`"]
    contents: Annotated[str, "contents of the page, such as `wiring and LEDs`"]


def subjects(device: Device, interface_name: str) -> list[str]:
    """Return the subjects that an interface has content for, such as ``registers``. Each has a page of its own."""
    return list(_contents_by_subject(for_interface(device, interface_name)))


def _contents_by_subject(device: Device) -> dict[str, list[str]]:
    """Return the contents of the page about each subject, such as ``{"wiring": ["wiring", "LEDs"]}``.

    ``device`` is a family reduced to one interface. Subjects without content are omitted.
    """
    (interface,) = device.interfaces
    contents_by_subject: dict[str, list[str]] = {}
    for subject, content, parts_of_device in (
        ("fields", "bit fields", layout_tables.used_groups(interface)),
        ("registers", "registers", device.registers),
        ("procedures", "procedures", device.procedures),
        ("procedures", "errors", device.alarms),
        ("procedures", "inputs", device.inputs),
        ("wiring", "wiring", device.connectors),
        ("wiring", "LEDs", device.leds),
        ("examples", "worked examples", device.examples),
    ):
        if parts_of_device:
            contents_by_subject.setdefault(subject, []).append(content)
    return contents_by_subject


def subject_values(subject: str, page: InterfacePage) -> SubjectPage:
    """Return the values of the page about one subject. ``page`` has the values of the interface page."""
    contents = _contents_by_subject(page["device"])[subject]
    return {**page, "subject": subject, "contents": MARKDOWN.phrase(statement(*list_parts(contents)))}


def interface_values(
    family_device: Device, device: Device, *, variants: Sequence[Variant], has_masters: bool, pictures: Pictures
) -> InterfaceValues:
    """Return the values of a page about one interface, to which ``family_device`` is reduced in ``device``."""
    (interface,) = device.interfaces
    layouts = family_device.interface(interface.name).layouts
    return {
        "interface": interface,
        "has_masters": has_masters,
        "short_rows": list(fact_tables.overview_rows(device, interface, variants)),
        "pictures": pictures,
        "timing": timing_diagram(device, interface),
        "frames_set_by_registers": [layout.name for layout in layouts if follows_registers(family_device, layout)],
        "initial": words_for_initial_values(family_device),
    }


def page_values(
    device: Device, interface_name: str, links: Mapping[str, str], has_masters: bool, pictures: Pictures
) -> InterfacePage:
    """Return the values of an interface page. ``links`` contains a link to the page of each order code."""
    interface_device = for_interface(device, interface_name)
    variants = device.variants_over(interface_name)
    codes = [variant.code for variant in variants]
    return {
        **page_sections(interface_device),
        **interface_values(device, interface_device, variants=variants, has_masters=has_masters, pictures=pictures),
        "order_codes": order_codes(device, codes),
        "code_table": order_code_tables.code_table(device, device.interface(interface_name), links),
        "parameter_rows": list(order_code_tables.parameter_rows(device, interface_name)),
        "run_time_rows": list(order_code_tables.run_time_rows(device, interface_name)),
        "name_rows": list(_name_rows(interface_device)),
    }


def _name_rows(device: Device) -> Iterator[Row]:
    """Yield rows of name, name in the manual, language, and a different name in the edition of this language."""
    for named_part in _parts_with_names(device):
        for language, name_in_language in named_part.names.items():
            if name_in_language != title_of(named_part):
                yield (
                    code_span(named_part.name),
                    escape(named_part.printed_name),
                    escape(language),
                    escape(name_in_language),
                )


def _parts_with_names(device: Device) -> Iterator[HasOtherNames]:
    """Yield the parts of an interface that can have names in other editions. If fields share a name, yield the last."""
    (interface,) = device.interfaces
    layouts = [*interface.layouts, *(register.layout for register in device.registers)]
    fields = [field for layout in layouts for field in layout.fields]
    named_values = [named_value for field in fields for named_value in field.values]
    # ``names`` are the names in other editions, by language.
    yield from {field.name: field for field in fields if field.names}.values()
    yield from {named_value.name: named_value for named_value in named_values if named_value.names}.values()
    yield from device.registers
    yield from device.field_groups
    yield from device.alarms
    yield from device.inputs
    yield from getattr(interface, "control_data", ())
