"""Pages about all families: identification, comparison, registers by address, alarms and LEDs, and the glossary."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Annotated, Any, TypedDict

from ...model import Alarm, Device, Field, Interface, Layout, Register, Supply
from ...model.record import dataclass
from ...order_codes.parameters import run_time_names
from ...order_codes.reduction import for_interface
from ...say import register as say_register
from ...say.layout import crc_sent
from ...say.names_and_evidence import addresses_text, name_in_words, title_of, titled_in_lists
from ...say.order_code import describe_settings, parameter_value
from ...say.text import MARKDOWN, citation, code_span, escape, join_filled, markdown_link, volts
from . import fact_tables
from .links_and_errata import (
    errata_of_manual,
    link_to_alarm,
    link_to_erratum,
    link_to_layout,
    link_to_register,
    links_to_steps,
    names_and_anchors_on_pages,
    path_to_anchor,
)
from .order_code_tables import order_codes

#: File names of the pages, which no family can have.
WHICH_ENCODER, COMPARISON, REGISTERS, ALARMS = (
    "which-encoder.md",
    "compare-encoders.md",
    "registers-by-address.md",
    "alarms-and-leds.md",
)
Row = tuple[str, ...]
#: Labels of the interface facts to compare.
_COMPARED_LABELS = ("Clock", "Alignment", "Code", "Timeout", "Baud rate")


class WhichPage(TypedDict):
    label_rows: Annotated[list[Row], "family, title, patterns of its order codes, interfaces, supply"]
    identity_rows: Annotated[list[Row], "family, identifying register, name, content, source"]
    compare_page: Annotated[str, "the page that compares the families"]
    compared_rows: Annotated[list[Row], "interface of a family, fact, value, source"]
    resolution_rows: Annotated[list[Row], "quantities set by order codes: family, quantity, values, unit, source"]
    frame_rows: Annotated[list[Row], "frames with a position: interface, family, frame, bits, order, CRC"]
    byte_order_rows: Annotated[list[Row], "registers of several bytes: family, first byte, registers"]


class RegistersPage(TypedDict):
    register_rows: Annotated[list[Row], "address, bank, register, family, access, default, meaning"]


class AlarmsPage(TypedDict):
    alarm_rows: Annotated[list[Row], "alarm, family, meaning, remedy, source"]
    led_rows: Annotated[list[Row], "LED, state, family, meaning, source"]


def identification_page_values(devices: Sequence[Device]) -> WhichPage:
    """Return the values of two pages: one that identifies an encoder, and one that compares the families."""
    return {
        "label_rows": [_label_row(device) for device in devices],
        "identity_rows": _rows_of_all(devices, _identity_rows),
        "compare_page": COMPARISON,
        "resolution_rows": _rows_of_all(devices, _resolution_rows),
        "byte_order_rows": _rows_of_all(devices, _byte_order_rows),
        "compared_rows": _grouped_by_interface(_rows_of_all(devices, _interface_fact_rows)),
        "frame_rows": _grouped_by_interface(_rows_of_all(devices, _position_frame_rows)),
    }


def _rows_of_all(devices: Iterable[Device], rows_of: Callable[[Device], Iterable[Row]]) -> list[Row]:
    """Return the rows of all families in one list."""
    rows: list[Row] = []
    for device in devices:
        rows += rows_of(device)
    return rows


def _grouped_by_interface(rows: Iterable[Row]) -> list[Row]:
    """Group the rows by interface, in the order in which the interfaces first occur."""
    rows_by_interface: dict[str, list[Row]] = {}
    for row in rows:
        interface_title, *_ = row
        rows_by_interface.setdefault(interface_title, []).append(row)
    return list(chain.from_iterable(rows_by_interface.values()))


def _family_link(device: Device) -> str:
    """Return a link to the page of a family, labeled with its name in capitals."""
    return markdown_link(escape(device.name.upper()), f"{device.name}.md")


def _label_row(device: Device) -> Row:
    """Return a row of family, title, patterns of its order codes, interfaces, supply.

    The supply cell lists the supplies of all order codes, each once, such as ``4.5 V to 5.5 V``.
    """
    supplies_of_variants = [device.supply_of(variant) for variant in device.variants]
    different_supplies = dict.fromkeys(supply for supply in supplies_of_variants if supply is not None)
    return (
        _family_link(device),
        escape(titled_in_lists(device)),
        order_codes(device, [variant.code for variant in device.variants]),
        join_filled((interface.title for interface in device.interfaces), ", "),
        join_filled(map(_supply_range, different_supplies)),
    )


def _supply_range(supply: Supply) -> str:
    return f"{volts(supply.min_mv)} to {volts(supply.max_mv)}"


def _identity_rows(device: Device) -> Iterator[Row]:
    """Yield rows of family, address, name, content, source for the register fields that identify an encoder.

    Their content is the same for the whole family, or the order code determines it.
    """
    for register, field in device.identity:
        title = title_of(register)
        if len(register.layout.fields) > 1:
            title += f", {name_in_words(field.name)}"
        yield (
            _family_link(device),
            link_to_register(device, register, addresses_text(register)),
            escape(title),
            _documented_content(field),
            citation(field.source or register.source),
        )


def _documented_content(field: Field) -> str:
    """Return the content of an identifying field, such as ```1Bh```, or "" if the manual does not state it."""
    match field.equals:
        case int():
            # A hexadecimal digit for each 4 bits, rounded up.
            digit_count = (field.widest + 3) // 4
            return f"`{field.equals:0{digit_count}X}h`"
        case str():
            return code_span(field.equals)
        case None:
            return ""
        case expression_by_code:
            return MARKDOWN.number(expression_by_code) + ", by order code"


def _interface_fact_rows(device: Device) -> Iterator[Row]:
    """Yield rows of interface, family, label, fact, source for the settings that the page compares, such as clocks."""
    for interface in device.interfaces:
        for setting in describe_settings(device, interface):
            if setting.label in _COMPARED_LABELS:
                yield (
                    interface.title,
                    _family_link(device),
                    escape(setting.label),
                    MARKDOWN.phrase(setting),
                    citation(setting.source),
                )


def _position_frame_rows(device: Device) -> Iterator[Row]:
    """Yield rows of interface, family, frame, bits, order, CRC for the frames with the position.

    If the frames of some order codes have no CRC, ``none`` is in the list of CRCs.
    """
    for interface, layout in device.layouts():
        if device.sends_position(interface.name, layout):
            crc_texts = [f"{crc.polynomial}, {crc_sent(crc)}" for crc in device.crcs_of(layout)]
            if not layout.always_has_crc:
                crc_texts.append("none")
            byte_order = layout.byte_order.replace("_", " ")
            yield (
                interface.title,
                _family_link(device),
                link_to_layout(device, layout, code_span(layout.name)),
                _range_of_lengths(device, interface, layout),
                byte_order if layout.in_bytes else "most significant bit first",
                escape(" or ".join(crc_texts)),
            )


def _range_of_lengths(device: Device, interface: Interface, layout: Layout) -> str:
    """Return the shortest and longest length of a frame in bits for the order codes of an interface: ``33 to 45``."""
    variants = device.variants_over(interface.name)
    # Without order codes over the interface, the length is 0.
    bit_counts = {layout.place(variant.parameters).bits for variant in variants} or {0}
    shortest, longest = min(bit_counts), max(bit_counts)
    return f"{shortest}" if shortest == longest else f"{shortest} to {longest}"


def _resolution_rows(device: Device) -> Iterator[Row]:
    """Yield rows of family, quantity, values, unit, source for the quantities that the order code sets.

    A quantity is a parameter that has a unit and that no register changes at run time. Its values are those of all
    order codes, in ascending order.
    """
    run_time_parameters = run_time_names(device)
    for parameter in device.set_parameters:
        if not parameter.unit or parameter.name in run_time_parameters:
            continue
        variants = [variant for variant in device.variants if parameter.name in variant.parameters]
        different_values = sorted({variant.parameters[parameter.name] for variant in variants})
        values_cell = ", ".join(parameter_value(parameter, value) for value in different_values)
        yield (
            _family_link(device),
            escape(parameter.meaning),
            values_cell,
            escape(parameter.unit),
            citation(parameter.source),
        )


def _byte_order_rows(device: Device) -> Iterator[Row]:
    """Yield rows of family, byte order, links to the registers with this byte order. One-byte registers are omitted."""
    registers_by_order: dict[str, list[Register]] = {}
    for register in device.registers:
        if register.length > 1:
            registers_by_order.setdefault(register.byte_order, []).append(register)
    for byte_order, registers in registers_by_order.items():
        register_links = (_register_link(device, register) for register in registers)
        yield _family_link(device), byte_order.replace("_", " "), ", ".join(register_links)


def _register_link(device: Device, register: Register) -> str:
    return link_to_register(device, register, f"{addresses_text(register)} {escape(title_of(register))}")


def registers_page_values(devices: Sequence[Device]) -> RegistersPage:
    """Return the values of the page that lists the registers of all families by address."""
    registers_and_devices = [(register, device) for device in devices for register in device.registers]
    registers_and_devices.sort(key=_address_and_family)
    return {"register_rows": [_register_row(register, device) for register, device in registers_and_devices]}


def _address_and_family(register_of_device: tuple[Register, Device]) -> tuple[int, int, str]:
    """Return the sort key of a register: its address, then its bank, then the name of its family."""
    register, device = register_of_device
    # A register without a bank comes first.
    bank = -1 if register.bank is None else register.bank
    return register.address, bank, device.name


def _register_row(register: Register, device: Device) -> Row:
    """Return a row of address, bank, register, family, access, default, meaning, source."""
    factory_default = register.default_bytes()
    return (
        addresses_text(register),
        "" if register.bank is None else f"{register.bank}",
        link_to_register(device, register, code_span(register.name)),
        _family_link(device),
        say_register.describe_access(register),
        code_span(factory_default.hex(" ").upper()) if factory_default is not None else "",
        escape(register.meaning),
        citation(register.source),
    )


def alarms_page_values(devices: Sequence[Device]) -> AlarmsPage:
    """Return the values of the page that lists the alarms and the LEDs of all families."""
    alarms_with_interfaces: list[tuple[Alarm, Device, Interface]] = []
    for device in devices:
        alarms_with_interfaces += _alarms_with_interfaces(device)
    alarms_with_interfaces.sort(key=_title_and_family)
    return {
        "alarm_rows": [_alarm_row(alarm, device, interface) for alarm, device, interface in alarms_with_interfaces],
        "led_rows": _rows_of_all(devices, _led_rows),
    }


def _led_rows(device: Device) -> Iterator[Row]:
    """Yield rows of LED, state, family, meaning, order codes that have it, source."""
    for led in device.leds:
        for state in led.states:
            yield (
                escape(led.title),
                escape(state.state),
                _family_link(device),
                join_filled([escape(state.meaning), *links_to_steps(f"{device.name}/", state.by_hand)]),
                code_span(state.only),
                citation(led.source),
            )


def _alarms_with_interfaces(device: Device) -> list[tuple[Alarm, Device, Interface]]:
    """Return each alarm of a family with the first interface that has it. The page of this interface explains it."""
    interface_by_alarm: dict[str, Interface] = {}
    for interface in device.interfaces:
        for alarm in for_interface(device, interface.name).alarms:
            interface_by_alarm.setdefault(alarm.name, interface)
    return [(alarm, device, interface_by_alarm[alarm.name]) for alarm in device.alarms]


def _title_and_family(alarm_of_device: tuple[Alarm, Device, Interface]) -> tuple[str, str]:
    """Return the sort key of an alarm: its title, then the name of its family."""
    alarm, device, _ = alarm_of_device
    return title_of(alarm).casefold(), device.name


def _alarm_row(alarm: Alarm, device: Device, interface: Interface) -> Row:
    """Return a row of alarm, family, meaning, remedy, order codes that have it, source."""
    return (
        link_to_alarm(device, interface, alarm, escape(title_of(alarm))),
        _family_link(device),
        escape(alarm.meaning) if alarm.implemented else "not implemented in this encoder",
        join_filled([escape(alarm.remedy), *links_to_steps(f"{device.name}/", alarm.by_hand)]),
        code_span(alarm.only),
        citation(alarm.source),
    )


#: File name of the page, which no family can have.
GLOSSARY = "glossary-of-terms.md"


class TermUse(TypedDict, total=False):
    """Where pages use a term: the names of fields, registers and times, or the section of an interface about it."""

    names: list[str]
    interface: str
    section: str


class GlossaryPage(TypedDict):
    term_rows: Annotated[
        Callable[[Iterable[tuple[str, str, TermUse]]], list[tuple[str, str, str]]],
        "rows of term, meaning, links for the terms that these families use, each given with where pages use it",
    ]


@dataclass(frozen=True, slots=True)
class _InterfacePage:
    """Page of an interface. ``names_and_anchors`` are pairs of a name on the page, in lowercase, and its anchor."""

    device: Device
    interface: Interface
    names_and_anchors: tuple[tuple[str, str], ...]


def glossary_values(devices: Sequence[Device]) -> GlossaryPage:
    """Return the values of the glossary, which has the terms that the pages of these families explain or use.

    The terms and their meanings are in the template.
    """
    pages: list[_InterfacePage] = []
    for device in devices:
        pages += [_interface_page(device, interface) for interface in device.interfaces]

    def term_rows(terms: Iterable[tuple[str, str, TermUse]]) -> list[tuple[str, str, str]]:
        rows: list[tuple[str, str, str]] = []
        for term, meaning, term_use in terms:
            term_links = _links_to_term(term_use, pages)
            if term_links:
                rows.append((escape(term), escape(meaning), term_links))
        return rows

    return {"term_rows": term_rows}


def _interface_page(device: Device, interface: Interface) -> _InterfacePage:
    """Return the page of an interface with the names on it."""
    interface_device = for_interface(device, interface.name)
    names_and_anchors = tuple(names_and_anchors_on_pages(interface_device, interface))
    return _InterfacePage(interface_device, interface, names_and_anchors)


def _links_to_term(term_use: TermUse, pages: Sequence[_InterfacePage]) -> str:
    """Return links to the sections about a term: one for each interface that has such a section."""
    page_links: list[str] = []
    for page in pages:
        anchor = _anchor_of_term(term_use, page)
        if anchor:
            page_title = f"{page.device.name.upper()} {page.interface.short}"
            path = path_to_anchor(page.device, page.interface.name, anchor)
            page_links.append(markdown_link(escape(page_title), path))
    return ", ".join(page_links)


def _anchor_of_term(term_use: TermUse, page: _InterfacePage) -> str:
    """Return the anchor of the section about a term on the pages of an interface, or "" if there is none.

    A term of one interface states its section. For any other term, it is the section about the first name that equals
    one of the names of the term or else, that contains one as a whole word.
    """
    if "section" in term_use:
        section_name = term_use["section"]
        # The name of a section is also its anchor.
        is_on_page = page.interface.name == term_use["interface"] and _has_section(page, section_name)
        return section_name if is_on_page else ""
    names_of_term = term_use["names"]
    for lowercase_name, anchor in page.names_and_anchors:
        if lowercase_name in names_of_term:
            return anchor
    for lowercase_name, anchor in page.names_and_anchors:
        # With spaces around both, a name of the term is found only as a whole word.
        contains_term = any(f" {name} " in f" {lowercase_name} " for name in names_of_term)
        if contains_term:
            return anchor
    return ""


def _has_section(page: _InterfacePage, section_name: str) -> bool:
    """Return whether the pages of an interface have a section. Most sections always exist."""
    content_by_section = {
        # Only BiSS has control data.
        "control-data": getattr(page.interface, "control_data", ()),
        "procedures": page.device.procedures,
        "wiring": page.device.connectors,
    }
    return section_name not in content_by_section or bool(content_by_section[section_name])


#: File name of the page about all families, which no family can have.
ALL_ERRATA = "all-errata.md"


class AllErrataPage(TypedDict):
    standings: Annotated[list[dict[str, Any]], "open errata, then resolved ones: title, anchor, rows"]


def all_errata_values(devices: Sequence[Device]) -> AllErrataPage:
    """Return the values of the page that lists the errata of all families."""
    title_by_status = {"open": "Open: only hardware or the manufacturer can decide", "settled": "Resolved"}
    sections = []
    for status, title in title_by_status.items():
        erratum_rows = list(_rows_of_all_families(devices, status))
        if erratum_rows:
            sections.append({"title": title, "anchor": status, "rows": erratum_rows})
    return {"standings": sections}


def _rows_of_all_families(devices: Sequence[Device], status: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of impact, family, title for the errata with this status, wrong bytes first and wording last."""
    for severity in fact_tables.SEVERITIES:
        for device in devices:
            for erratum in errata_of_manual(device):
                if erratum.status == status and erratum.severity == severity:
                    yield (
                        escape(fact_tables.severity_text(severity)),
                        markdown_link(escape(device.name.upper()), f"{device.name}.md"),
                        link_to_erratum(device, erratum),
                    )
