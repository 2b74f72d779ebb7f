"""Page of an order code: everything about its interface, with numbers in place of expressions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Annotated

from ...model import INTERFACES, Biss, Device, Interface, Layout, Measurement, Parameter, Variant
from ...model.record import dataclass
from ...order_codes.narrowing import for_codes
from ...order_codes.parameters import parameters_of, run_time_names
from ...order_codes.with_numbers import with_quantities
from ...say.evidence import grade
from ...say.layout import size
from ...say.markdown import STYLE, cited, code, link, text
from ...say.measurement import measurement, own_ranges, position_range
from ...say.name import title
from ...say.parameter import value
from ...say.place import field_at, hexadecimal
from ...say.text import Said, said
from ...say.words import counted, sentence, with_unit
from ..file_names import names_of_codes
from . import bytes_to_send, clock_and_cable, frame_facts, pin_tables, short_tables, wide_pictures
from .hardware_steps import ByHand, by_hand
from .inline_errata import Badges
from .interface_page import OverValues, over_values
from .interface_sections import Section, Sections, sections
from .order_code_patterns import patterns
from .own_widths import own_meaning, with_own_widths
from .page_pictures import Pictures, of_codes, of_family
from .unstated import no_leds, no_supply

Row = tuple[str, ...]
#: Longest lead, in characters.
_LEAD = 180
#: Other files in the folder of a family: names of pages, and first words of the names of pictures.
TAKEN = (*INTERFACES, "connector", "errata", "hardware", "manual", "register", "timing")


class CodePage(Sections, OverValues):
    """Values for the page of an order code in addition to those of its interface page."""

    codes: Annotated[Sequence[str], "the order codes, which differ only in mechanics or supply"]
    lead: Annotated[str, "first sentences of the note on the interface"]
    position: Annotated[str, "unit and range of the position"]
    evidence: Annotated[Said, "grade of the evidence"]
    wiring: Annotated[pin_tables.Wiring, "contacts and signals: head, rows, about, notes, errata"]
    supply: Annotated[list[str], "supply, with order codes if it differs between them"]
    no_supply: Annotated[str, "text in place of the supply"]
    no_leds: Annotated[str, "sentence in place of LEDs, or empty"]
    speed: Annotated[clock_and_cable.Speed, "clock or baud rate by cable length: title, facts, head, rows"]
    frame: Annotated[Section | None, "frame with the position: title, name, size, questions, wide, narrow, facts"]
    sending: Annotated[bytes_to_send.Sending, "bytes to send: facts, requests, commands, other_value"]
    frames_summary: Annotated[str, "number of frames and CRCs"]
    registers_summary: Annotated[str, "number of registers and their addresses"]
    procedures_summary: Annotated[str, "number of procedures"]
    setting_lines: Annotated[list[str], "settings of the interface"]
    time_rows: Annotated[list[Row], "duration and meaning of each time"]
    by_hand: Annotated[list[ByHand], "procedures carried out by hand"]
    example_rows: Annotated[list[Row], "worked examples: title, facts"]
    quantity_rows: Annotated[list[Row], "quantities of the order code: value, meaning"]
    errata_summary: Annotated[Callable[[], str], "number of errata listed on the page before this call"]
    errata_list: Annotated[Callable[[], str], "errata listed on the page before this call, one per line"]


@dataclass(frozen=True)
class Alike:
    """Order codes that are identical for software. ``name`` is the name of their common page.

    ``only`` is the family with only these order codes, and ``here`` is that with the quantities that they set.
    """

    family: Device
    variants: tuple[Variant, ...]
    only: Device
    here: Device
    name: str

    @property
    def codes(self) -> list[str]:
        return [variant.code for variant in self.variants]

    @property
    def interface(self) -> Interface:
        return self.here.interface(self.variants[0].interface)

    @cached_property
    def frame(self) -> Layout | None:
        """Frame at the top of the page."""
        return frame_facts.position_frame(self.family, self.interface)

    @cached_property
    def pictures(self) -> Pictures:
        """Pictures for these codes that differ from those of the family."""
        return of_codes(self.family, self.only, self.name, self.frame.name if self.frame is not None else "")


@dataclass(frozen=True)
class Codes:
    """Order codes of a family, grouped by interface and by the quantities that they set."""

    device: Device

    @cached_property
    def alike(self) -> tuple[Alike, ...]:
        groups: dict[tuple[str, tuple[tuple[str, int], ...]], list[Variant]] = {}
        for variant in self.device.variants:
            groups.setdefault((variant.interface, tuple(sorted(variant.parameters.items()))), []).append(variant)
        names = names_of_codes((variants[0].code for variants in groups.values()), TAKEN)
        return tuple(self._alike(tuple(variants), name) for variants, name in zip(groups.values(), names, strict=True))

    def _alike(self, variants: tuple[Variant, ...], name: str) -> Alike:
        only = for_codes(self.device, [variant.code for variant in variants])
        device = with_own_widths(self.device, with_quantities(only, variants[0]), variants[0])
        return Alike(self.device, variants, only, device, name)

    @cached_property
    def pictures(self) -> Pictures:
        """Pictures of the family."""
        return of_family(self.device)

    @cached_property
    def links(self) -> dict[str, str]:
        """Links to the page of each order code, for pages next to the folder of the family."""
        return self._links(f"{self.device.name}/")

    @cached_property
    def links_beside(self) -> dict[str, str]:
        """Links to the page of each order code, relative to the folder of the family."""
        return self._links("")

    def page_links(self, kind: str) -> list[str]:
        """Return links to the order code pages of an interface, labelled with patterns, for pages next to it."""
        return [
            link(
                ", ".join(map(code, patterns(self.device, page_codes.codes))),
                f"{self.device.name}/{page_codes.name}.md",
            )
            for page_codes in self.alike
            if page_codes.interface.name == kind
        ]

    def _links(self, folder: str) -> dict[str, str]:
        return {
            variant.code: link(code(variant.code), f"{folder}{alike.name}.md")
            for alike in self.alike
            for variant in alike.variants
        }


def _position(device: Device, interface: str, measured: Measurement) -> str:
    """Return the unit and range of the position, and the ranges that single frames have."""
    frame_ranges = [
        f"in {code(name)} it {STYLE.phrase(position_range(frame_range))}"
        if not frame_range.wraps
        else f"in {code(name)}: {STYLE.phrase(position_range(frame_range))}"
        for name, frame_range in own_ranges(device, interface)
    ]
    return ", ".join([STYLE.phrase(measurement(measured)), *frame_ranges])


def page_values(alike: Alike, has_masters: bool, pictures: Pictures) -> CodePage:
    """Return the values of the page. ``pictures`` are those of the family, of which the page may replace some."""
    device, interface, badges = alike.here, alike.interface, Badges(alike.here)
    measured = device.measurement_of(interface.name)
    page_sections = sections(device)
    return {
        **page_sections,
        **over_values(alike.family, device, alike.variants, has_masters, alike.pictures),
        "errata_at": badges,
        "codes": alike.codes,
        # The notes on SSI and RS-485 begin with the line, those on BiSS with limits that users must keep.
        "lead": lead(interface.note) if isinstance(interface, Biss) else "",
        "position": _position(device, interface.name, measured) if measured is not None else "",
        "evidence": grade(device),
        "wiring": pin_tables.wiring(device),
        "supply": pin_tables.supply(device, alike.variants),
        "speed": clock_and_cable.speed_section(alike.family, device, interface, alike.frame),
        "frame": _frame(alike, alike.frame, {**pictures, **alike.pictures}) if alike.frame is not None else None,
        "sending": bytes_to_send.sending_section(alike.family, device, interface, alike.variants[0], badges.of_bytes),
        "led_rows": list(short_tables.led_rows(device)),
        "no_leds": no_leds(alike.family, device, interface),
        "no_supply": no_supply(alike.family, interface),
        "interfaces": [_with_short_rows(device, section) for section in page_sections["interfaces"]],
        "registers": [
            {
                **section,
                "rows": list(short_tables.field_rows(device, section["register"].layout)) if section["rows"] else [],
                "value_tables": short_tables.value_tables(section["register"]),
            }
            for section in page_sections["registers"]
        ],
        "register_rows": list(short_tables.register_rows(device)),
        "procedures": [
            {**section, "steps": list(short_tables.steps(device, section["procedure"]))}
            for section in page_sections["procedures"]
        ],
        "procedures_summary": f"{counted(len(device.procedures), 'procedure')}, step by step",
        "setting_lines": list(short_tables.setting_lines(device, interface)),
        "frames_summary": counted(len(interface.layouts), "frame") + (" with CRC" if device.crcs else ""),
        "registers_summary": _summary(device),
        "time_rows": list(short_tables.time_rows(interface.timings + device.timings)),
        "by_hand": by_hand(device),
        "example_rows": list(
            short_tables.example_rows(
                device, (example for example in device.examples if getattr(example, "order_code", ""))
            )
        ),
        "quantity_rows": list(_quantity_rows(alike)),
        "errata_summary": badges.summary,
        "errata_list": badges.listed,
    }


def lead(note: str) -> str:
    """Return the first sentences of a text, up to the length that is shown at the top of a page."""
    parts = note.split(". ")
    count = max((index for index in range(len(parts) + 1) if len(". ".join(parts[:index])) <= _LEAD), default=0)
    return sentence(". ".join(parts[: max(count, 1)])) if note else ""


def _frame(alike: Alike, layout: Layout, pictures: Pictures) -> Section:
    checked = alike.family.crc_of(layout)
    choices = [alternative.name for alternative in alike.here.alternatives]
    return {
        "title": title(layout),
        "name": layout.name,
        "size": STYLE.phrase(said(*size(layout, alike.here.alternatives))),
        "wide": pictures[f"wide-{layout.name}"],
        "narrow": pictures[f"layout-{layout.name}"],
        "narrower": wide_pictures.SCREEN - 1,
        "questions": list(frame_facts.questions(alike.here, layout)),
        "facts": list(frame_facts.frame_facts(alike.family, layout, alike.variants[0], choices)),
        "crc_path": [f"crcs.{checked.name}"] if checked is not None else [],
    }


def _with_short_rows(device: Device, interface_section: Section) -> Section:
    """Return the values of an interface with tables of two columns."""
    layouts = [
        {**section, "rows": list(short_tables.field_rows(device, section["layout"]))}
        for section in interface_section["layouts"]
    ]
    groups = [
        {**section, "rows": list(short_tables.group_rows(device, section["group"].name))}
        for section in interface_section["groups"]
    ]
    return {**interface_section, "layouts": layouts, "groups": groups}


def _summary(device: Device) -> str:
    if not device.registers:
        return ""
    first, last = (
        min(register.address for register in device.registers),
        max(register.last_address for register in device.registers),
    )
    return f"{counted(len(device.registers), 'register')} from {hexadecimal(first)} to {hexadecimal(last)}"


def _quantity_rows(alike: Alike) -> Iterator[Row]:
    """Yield the quantities set by the order code, and the factory defaults of those that registers hold."""
    run_time_parameters = run_time_names(alike.family)
    for parameter in parameters_of(alike.family, alike.interface.name):
        if not parameter.alternative and alike.variants[0].parameters[parameter.name] != 0:
            yield _quantity(alike, parameter, parameter.name in run_time_parameters)


def _quantity(alike: Alike, parameter: Parameter, is_held: bool) -> Row:
    quantity = value(parameter, alike.variants[0].parameters[parameter.name])
    by_code = parameter.read_from and alike.family.register(parameter.register).default is None
    kind = "Value of the order code" if by_code else "Factory default"
    origin_text = (
        f" {kind}, held in {text(field_at(alike.family, parameter.read_from))}." if parameter.read_from else ""
    )
    origin_text = origin_text or (" Factory default, set by registers." if is_held else "")
    about = f"{text(sentence(own_meaning(alike.family, parameter)))}{origin_text} <small>{code(parameter.name)}</small>"
    return with_unit(quantity, text(parameter.unit)), f"{about} <small>{cited(parameter.source)}</small>"
