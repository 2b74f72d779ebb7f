"""Page of an order code, or of several that are identical for software.

In the texts of the family, the width for the order code replaces ranges such as 17 to 39 bits.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from functools import cached_property
from typing import Annotated, TypedDict

from ...model import (
    INTERFACES,
    Biss,
    Characteristic,
    Clocked,
    Device,
    Example,
    Interface,
    Layout,
    LayoutRange,
    Parameter,
    Register,
    Ssi,
    Variant,
    member_named,
)
from ...model.order_codes import facts_for_code
from ...model.record import dataclass
from ...model.registers import has_steps, steps_of
from ...order_codes.parameters import parameters_of, run_time_names
from ...order_codes.quantities import with_quantities
from ...order_codes.reduction import for_codes
from ...say import count_with_unit, with_unit
from ...say.layout import describe_measurement, describe_position_range, describe_size, own_ranges
from ...say.names_and_evidence import describe_grade, field_at, heading, hexadecimal, title_of
from ...say.order_code import not_on_label, parameter_value
from ...say.text import MARKDOWN, Statement, as_sentence, citation, code_span, escape, markdown_link, statement
from ..registry import names_of_codes
from . import bytes_to_send, fact_tables, layout_pictures, order_code_tables, verdict_table, wiring_tables
from .interface_page import InterfaceValues, Section, Sections, interface_values, page_sections
from .links_and_errata import ErrataLinks
from .page_pictures import Pictures, pictures_of_family, pictures_of_order_codes
from .wiring_tables import no_leds, no_supply


@dataclass(frozen=True, slots=True)
class ManualProcedure:
    """Procedure that a person carries out by hand. ``before`` is the text before its first step."""

    characteristic: Characteristic
    title: str
    before: str
    steps: tuple[str, ...]


def manual_procedures(device: Device) -> list[ManualProcedure]:
    """Return the procedures that a person carries out by hand, in the order of the spec."""
    return [_manual_procedure(fact) for fact in device.characteristics if has_steps(fact.value)]


def _manual_procedure(characteristic: Characteristic) -> ManualProcedure:
    """Return a characteristic with numbered steps as a procedure."""
    before, *steps = steps_of(characteristic.value)
    return ManualProcedure(characteristic, title=heading(characteristic.name), before=before, steps=tuple(steps))


Row = tuple[str, ...]
#: Longest text, in characters, that a page quotes at its top from the note on the interface.
_LONGEST_LEAD = 180
#: Other files in the folder of a family: names of pages, and first words in the names of pictures.
RESERVED_NAMES = (*INTERFACES, "connector", "errata", "hardware", "manual", "register", "timing")


class TablesAndSummaries(TypedDict):
    """Parts of the page of an order code that consist of facts of the family alone."""

    frames_summary: Annotated[str, "number of frames and CRCs"]
    registers_summary: Annotated[str, "number of registers and their addresses"]
    procedures_summary: Annotated[str, "number of procedures"]
    setting_lines: Annotated[list[str], "settings of the interface"]
    time_rows: Annotated[list[Row], "duration and meaning of each time"]
    by_hand: Annotated[list[ManualProcedure], "procedures carried out by hand"]
    example_rows: Annotated[list[Row], "worked examples: title, facts"]
    quantity_rows: Annotated[list[Row], "quantities of the order code: value, meaning"]


class CodePage(Sections, InterfaceValues, TablesAndSummaries):
    """Values for the page of an order code in addition to those of its interface page."""

    codes: Annotated[Sequence[str], "the order codes, which differ only in mechanics or supply"]
    lead: Annotated[str, "first sentences of the note on the interface"]
    position: Annotated[str, "unit and range of the position"]
    evidence: Annotated[Statement, "grade of the evidence"]
    made_up: Annotated[Sequence[Statement], "statement that the order code is made up, if it is"]
    wiring: Annotated[wiring_tables.Wiring, "contacts and signals: head, rows, about, notes, errata"]
    supply: Annotated[list[str], "supply, with order codes if it differs between them"]
    no_supply: Annotated[str, "text in place of the supply"]
    no_leds: Annotated[str, "sentence in place of LEDs, or empty"]
    speed: Annotated[wiring_tables.SpeedSection, "clock or baud rate by cable length: title, facts, head, rows"]
    frame: Annotated[
        Section | None, "frame with the position: title, name, size, questions, wide, narrow, facts, verdicts"
    ]
    sending: Annotated[
        bytes_to_send.SendingSection, "bytes to send: facts, requests, commands, command_errata, other_value"
    ]
    errata_summary: Annotated[Callable[[], str], "number of errata listed on the page before this call"]
    errata_list: Annotated[Callable[[], str], "errata listed on the page before this call, one per line"]


@dataclass(frozen=True)
class CodeGroup:
    """Order codes that are identical for software, and so share a page, whose name is ``name``.

    ``narrowed_family`` is the family with only these order codes, and ``device`` is this reduced family with numbers in
    place of the quantities that the order codes set.
    """

    family: Device
    variants: tuple[Variant, ...]
    name: str

    @cached_property
    def narrowed_family(self) -> Device:
        return for_codes(self.family, [variant.code for variant in self.variants])

    @cached_property
    def device(self) -> Device:
        with_numbers = with_quantities(self.narrowed_family, self.variants[0])
        return order_code_tables.with_widths_of_order_code(self.family, with_numbers, self.variants[0])

    @property
    def codes(self) -> list[str]:
        return [variant.code for variant in self.variants]

    @property
    def interface(self) -> Interface:
        return self.device.interface(self.variants[0].interface)

    @cached_property
    def frame(self) -> Layout | None:
        """Frame that is shown at the top of the page, or None if no frame contains the position."""
        return verdict_table.position_frame(self.family, self.interface)

    @cached_property
    def pictures(self) -> Pictures:
        """Pictures for these order codes, as far as they differ from the family's pictures."""
        frame_name = self.frame.name if self.frame is not None else ""
        return pictures_of_order_codes(self.family, self.narrowed_family, self.name, frame_name)


@dataclass(frozen=True)
class OrderCodes:
    """Order codes of a family, grouped by interface and by the quantities that they set."""

    device: Device

    @cached_property
    def groups(self) -> tuple[CodeGroup, ...]:
        """Groups of order codes that have the same interface with the same limits, and set the same quantities."""
        variants_by_facts: dict[Hashable, list[Variant]] = {}
        for variant in self.device.variants:
            quantities = tuple(sorted(variant.parameters.items()))
            clock_limits = _clock_limits_of(self.device.interface(variant.interface), variant.code)
            variants_by_facts.setdefault((variant.interface, quantities, clock_limits), []).append(variant)
        variants_of_groups = variants_by_facts.values()
        first_codes = [variants[0].code for variants in variants_of_groups]
        page_names = names_of_codes(first_codes, RESERVED_NAMES)
        return tuple(
            CodeGroup(family=self.device, variants=tuple(variants), name=page_name)
            for variants, page_name in zip(variants_of_groups, page_names, strict=True)
        )

    @cached_property
    def pictures(self) -> Pictures:
        """Pictures of the family."""
        return pictures_of_family(self.device)

    @cached_property
    def links(self) -> dict[str, str]:
        """Links to the page of each order code, for pages next to the folder of the family."""
        return self._links_to_order_codes(f"{self.device.name}/")

    @cached_property
    def links_in_folder(self) -> dict[str, str]:
        """Links to the page of each order code, relative to the folder of the family."""
        return self._links_to_order_codes("")

    def page_links(self, interface_name: str) -> list[str]:
        """Return links to the order code pages of an interface, for pages next to it."""
        links = []
        for group in self.groups:
            if group.variants[0].interface == interface_name:
                label = ", ".join(map(code_span, group.codes))
                links.append(markdown_link(label, f"{self.device.name}/{group.name}.md"))
        return links

    def _links_to_order_codes(self, folder: str) -> dict[str, str]:
        """Return the link to the page of each order code, from pages that reach it through ``folder``."""
        link_by_order_code: dict[str, str] = {}
        for group in self.groups:
            page_path = f"{folder}{group.name}.md"
            for order_code in group.codes:
                link_by_order_code[order_code] = markdown_link(code_span(order_code), page_path)
        return link_by_order_code


def _clock_limits_of(interface: Interface, order_code: str) -> Hashable:
    """Return the clock, the timeout and the clocks by cable length for an order code. None means not applicable."""
    clock = interface.clock_of(order_code) if isinstance(interface, Clocked) else None
    timeout = interface.timeout_of(order_code) if isinstance(interface, Biss) else None
    cable_lengths = facts_for_code(interface.cable_lengths, order_code) if isinstance(interface, Ssi) else ()
    return clock, timeout, cable_lengths


def _position_text(device: Device, interface: Interface) -> str:
    """Return the unit and range of the position, followed by the range in each frame that has its own."""
    position_measurement = device.measurement_of(interface.name)
    if position_measurement is None:
        return ""
    unit_and_range = MARKDOWN.phrase(describe_measurement(position_measurement))
    ranges_in_frames = [_range_in_frame(name, frame_range) for name, frame_range in own_ranges(device, interface.name)]
    return ", ".join([unit_and_range, *ranges_in_frames])


def _range_in_frame(name: str, frame_range: LayoutRange) -> str:
    """Return a frame with the range of its position: ``in `reply`: 65,536 counts in total``."""
    range_text = MARKDOWN.phrase(describe_position_range(frame_range))
    return f"in {code_span(name)}: {range_text}" if frame_range.wraps else f"{code_span(name)} {range_text}"


def _tables_and_summaries(code_group: CodeGroup) -> TablesAndSummaries:
    """Return the parts of the page that consist of facts of the family alone."""
    device, interface = code_group.device, code_group.interface
    frame_count = count_with_unit(len(interface.layouts), "frame")
    return {
        "frames_summary": f"{frame_count} with CRC" if device.crcs else frame_count,
        "registers_summary": _registers_summary(device),
        "procedures_summary": f"{count_with_unit(len(device.procedures), 'procedure')}, step by step",
        "setting_lines": list(fact_tables.setting_lines(device, interface)),
        "time_rows": list(fact_tables.time_rows(interface.timings + device.timings)),
        "by_hand": manual_procedures(device),
        "example_rows": list(fact_tables.example_rows(device, _examples_of_order_codes(device))),
        "quantity_rows": list(_quantity_rows(code_group)),
    }


def page_values(code_group: CodeGroup, has_masters: bool, pictures: Pictures) -> CodePage:
    """Return the values of a page. ``pictures`` are the family's pictures, some of which the page may replace."""
    family, device, interface, frame = code_group.family, code_group.device, code_group.interface, code_group.frame
    errata_links = ErrataLinks(device)
    interface_sections = page_sections(device)
    all_pictures = {**pictures, **code_group.pictures}
    return {
        **interface_sections,
        **interface_values(
            family,
            device,
            variants=code_group.variants,
            has_masters=has_masters,
            pictures=code_group.pictures,
        ),
        **_tables_and_summaries(code_group),
        "errata_at": errata_links,
        "codes": code_group.codes,
        # The notes on SSI and RS-485 begin with the line, but the notes on BiSS with limits that users must observe.
        "lead": lead_sentences(interface.note) if isinstance(interface, Biss) else "",
        "position": _position_text(device, interface),
        "evidence": describe_grade(device),
        "made_up": tuple(not_on_label(device)),
        "wiring": wiring_tables.wiring_table(device, code_group.codes),
        "supply": wiring_tables.supply_lines(device, code_group.variants),
        "speed": wiring_tables.speed_section(family, device, interface, frame),
        "frame": _frame_section(code_group, frame, all_pictures) if frame is not None else None,
        "sending": bytes_to_send.sending_section(
            family, device, interface, code_group.variants[0], errata_at=errata_links.links_about_bytes
        ),
        "led_rows": list(fact_tables.led_rows(device)),
        "no_leds": no_leds(family, device, interface),
        "no_supply": no_supply(family, interface),
        "interfaces": [_with_short_rows(device, section) for section in interface_sections["interfaces"]],
        "registers": [_register_section(device, section) for section in interface_sections["registers"]],
        "register_rows": list(fact_tables.register_rows(device)),
        "procedures": [_procedure_section(device, section) for section in interface_sections["procedures"]],
        "errata_summary": errata_links.count_by_status,
        "errata_list": errata_links.list_of_errata,
    }


def _register_section(device: Device, section: Section) -> Section:
    """Return the section of a register with its tables reduced to two columns."""
    register: Register = section["register"]
    field_rows = list(fact_tables.field_rows(device, register.layout)) if section["rows"] else []
    return {**section, "rows": field_rows, "value_tables": fact_tables.value_tables(register)}


def _procedure_section(device: Device, section: Section) -> Section:
    """Return the section of a procedure with its steps as sentences."""
    return {**section, "steps": list(fact_tables.step_sentences(device, section["procedure"]))}


def _examples_of_order_codes(device: Device) -> list[Example]:
    """Return the worked examples that are about an order code."""
    return [example for example in device.examples if getattr(example, "order_code", "")]


def lead_sentences(note: str) -> str:
    """Return the first sentences of a note: as many as fit at the top of a page, but at least one."""
    if not note:
        return ""
    sentences, *further_sentences = note.split(". ")
    for further_sentence in further_sentences:
        longer_text = f"{sentences}. {further_sentence}"
        if len(longer_text) > _LONGEST_LEAD:
            break
        sentences = longer_text
    return as_sentence(sentences)


def _frame_section(code_group: CodeGroup, layout: Layout, pictures: Pictures) -> Section:
    """Return the section about the frame with the position: its pictures, facts and verdicts."""
    family, device = code_group.family, code_group.device
    # All order codes of a group set the same quantities, so the first represents all.
    variant = code_group.variants[0]
    crc = family.crc_of(layout.place(variant.parameters))
    open_question_names = [alternative.name for alternative in device.alternatives]
    # The layout of the page is a copy with different notes. Verdicts are known only for the family's layout.
    layouts_of_family = family.interface(code_group.interface.name).layouts
    family_layout = member_named(layouts_of_family, layout.name, "layout")
    verdict_head, verdict_rows = verdict_table.verdict_table(family, device, family_layout, variant)
    size_statement = statement(*describe_size(layout, device.alternatives))
    return {
        "title": title_of(layout),
        "name": layout.name,
        "size": MARKDOWN.phrase(size_statement),
        "wide": pictures[f"wide-{layout.name}"],
        "narrow": pictures[f"layout-{layout.name}"],
        # Width of the widest screen that shows the narrow picture.
        "narrower": layout_pictures.NARROWEST_SCREEN - 1,
        "questions": list(verdict_table.open_questions(device, layout)),
        "facts": list(verdict_table.frame_facts(family, layout, variant, question_names=open_question_names)),
        "verdict_head": verdict_head,
        "verdict_rows": verdict_rows,
        "crc_path": [f"crcs.{crc.name}"] if crc is not None else [],
    }


def _with_short_rows(device: Device, interface_section: Section) -> Section:
    """Return the section of an interface with its tables reduced to two columns."""
    layouts = [_layout_section(device, section) for section in interface_section["layouts"]]
    groups = [_group_section(device, section) for section in interface_section["groups"]]
    return {**interface_section, "layouts": layouts, "groups": groups}


def _layout_section(device: Device, section: Section) -> Section:
    """Return the section of a frame with two columns: place and field."""
    return {**section, "rows": list(fact_tables.field_rows(device, section["layout"]))}


def _group_section(device: Device, section: Section) -> Section:
    """Return the section of a group of fields with two columns: place and field."""
    return {**section, "rows": list(fact_tables.group_rows(device, section["group"].name))}


def _registers_summary(device: Device) -> str:
    """Return the number of registers and their lowest and highest address, or "" if there are no registers."""
    if not device.registers:
        return ""
    register_count = count_with_unit(len(device.registers), "register")
    lowest_address = min(register.address for register in device.registers)
    highest_address = max(register.last_address for register in device.registers)
    return f"{register_count} from {hexadecimal(lowest_address)} to {hexadecimal(highest_address)}"


def _quantity_rows(code_group: CodeGroup) -> Iterator[Row]:
    """Yield rows of value, meaning for the quantities that the order code or registers set.

    The values of quantities that registers set are factory defaults. Quantities that are 0, or that answers to open
    questions set, are omitted.
    """
    run_time_parameters = run_time_names(code_group.family)
    # All order codes of a group set the same quantities, so the first represents all.
    value_by_parameter = code_group.variants[0].parameters
    for parameter in parameters_of(code_group.family, code_group.interface.name):
        is_set_by_answer = bool(parameter.alternative)
        if not is_set_by_answer and value_by_parameter[parameter.name] != 0:
            yield _quantity_row(
                code_group.family,
                parameter,
                value=value_by_parameter[parameter.name],
                is_set_by_registers=parameter.name in run_time_parameters,
            )


def _quantity_row(family_device: Device, parameter: Parameter, *, value: int, is_set_by_registers: bool) -> Row:
    """Return a row of value, meaning for a quantity that the order code or a register sets."""
    value_with_unit = with_unit(parameter_value(parameter, value), escape(parameter.unit))
    meaning = escape(as_sentence(order_code_tables.meaning_without_range(family_device, parameter)))
    origin_sentence = _origin_of_quantity(family_device, parameter, is_set_by_registers)
    name_and_source = f"<small>{code_span(parameter.name)}</small> <small>{citation(parameter.source)}</small>"
    return value_with_unit, f"{meaning}{origin_sentence} {name_and_source}"


def _origin_of_quantity(family_device: Device, parameter: Parameter, is_set_by_registers: bool) -> str:
    """Return a sentence on the registers that hold or set a quantity, or "" if the order code sets it."""
    if parameter.read_from:
        has_default = family_device.register(parameter.register).default is not None
        value_kind = "Factory default" if has_default else "Value of the order code"
        # The field of a register from which programs read the quantity.
        register_field = field_at(family_device, parameter.read_from)
        return f" {value_kind}, held in {escape(register_field)}."
    return " Factory default, set by registers." if is_set_by_registers else ""
