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
        return [item.code for item in self.variants]

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
        found: dict[tuple[str, tuple[tuple[str, int], ...]], list[Variant]] = {}
        for item in self.device.variants:
            found.setdefault((item.interface, tuple(sorted(item.parameters.items()))), []).append(item)
        names = names_of_codes((variants[0].code for variants in found.values()), TAKEN)
        return tuple(self._alike(tuple(variants), name) for variants, name in zip(found.values(), names, strict=True))

    def _alike(self, variants: tuple[Variant, ...], name: str) -> Alike:
        only = for_codes(self.device, [item.code for item in variants])
        here = with_own_widths(self.device, with_quantities(only, variants[0]), variants[0])
        return Alike(self.device, variants, only, here, name)

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
            link(", ".join(map(code, patterns(self.device, item.codes))), f"{self.device.name}/{item.name}.md")
            for item in self.alike
            if item.interface.name == kind
        ]

    def _links(self, folder: str) -> dict[str, str]:
        return {
            item.code: link(code(item.code), f"{folder}{alike.name}.md")
            for alike in self.alike
            for item in alike.variants
        }


def _position(here: Device, interface: str, measured: Measurement) -> str:
    """Return the unit and range of the position, and the ranges that single frames have."""
    others = [
        f"in {code(name)} it {STYLE.phrase(position_range(item))}"
        if not item.wraps
        else f"in {code(name)}: {STYLE.phrase(position_range(item))}"
        for name, item in own_ranges(here, interface)
    ]
    return ", ".join([STYLE.phrase(measurement(measured)), *others])


def page_values(alike: Alike, has_masters: bool, pictures: Pictures) -> CodePage:
    """Return the values of the page. ``pictures`` are those of the family, of which the page may replace some."""
    here, interface, badges = alike.here, alike.interface, Badges(alike.here)
    measured = here.measurement_of(interface.name)
    found = sections(here)
    return {
        **found,
        **over_values(alike.family, here, alike.variants, has_masters, alike.pictures),
        "errata_at": badges,
        "codes": alike.codes,
        # The notes on SSI and RS-485 begin with the line, those on BiSS with limits that users must keep.
        "lead": lead(interface.note) if isinstance(interface, Biss) else "",
        "position": _position(here, interface.name, measured) if measured is not None else "",
        "evidence": grade(here),
        "wiring": pin_tables.wiring(here),
        "supply": pin_tables.supply(here, alike.variants),
        "speed": clock_and_cable.speed(alike.family, here, interface, alike.frame),
        "frame": _frame(alike, alike.frame, {**pictures, **alike.pictures}) if alike.frame is not None else None,
        "sending": bytes_to_send.sending(alike.family, here, interface, alike.variants[0], badges.of_bytes),
        "led_rows": list(short_tables.led_rows(here)),
        "no_leds": no_leds(alike.family, here, interface),
        "no_supply": no_supply(alike.family, interface),
        "interfaces": [_with_short_rows(here, item) for item in found["interfaces"]],
        "registers": [
            {
                **item,
                "rows": list(short_tables.field_rows(here, item["register"].layout)) if item["rows"] else [],
                "value_tables": short_tables.value_tables(item["register"]),
            }
            for item in found["registers"]
        ],
        "register_rows": list(short_tables.register_rows(here)),
        "procedures": [
            {**item, "steps": list(short_tables.steps(here, item["procedure"]))} for item in found["procedures"]
        ],
        "procedures_summary": f"{counted(len(here.procedures), 'procedure')}, step by step",
        "setting_lines": list(short_tables.setting_lines(here, interface)),
        "frames_summary": counted(len(interface.layouts), "frame") + (" with CRC" if here.crcs else ""),
        "registers_summary": _summary(here),
        "time_rows": list(short_tables.time_rows(interface.timings + here.timings)),
        "by_hand": by_hand(here),
        "example_rows": list(
            short_tables.example_rows(here, (item for item in here.examples if getattr(item, "order_code", "")))
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
    return {
        "title": title(layout),
        "name": layout.name,
        "size": STYLE.phrase(said(*size(layout, alike.here.alternatives))),
        "wide": pictures[f"wide-{layout.name}"],
        "narrow": pictures[f"layout-{layout.name}"],
        "narrower": wide_pictures.SCREEN - 1,
        "questions": list(frame_facts.questions(alike.here, layout)),
        "facts": list(frame_facts.frame_facts(alike.family, layout, alike.variants[0])),
        "crc_path": [f"crcs.{checked.name}"] if checked is not None else [],
    }


def _with_short_rows(device: Device, item: Section) -> Section:
    """Return the values of an interface with tables of two columns."""
    layouts = [{**part, "rows": list(short_tables.field_rows(device, part["layout"]))} for part in item["layouts"]]
    groups = [{**part, "rows": list(short_tables.group_rows(device, part["group"].name))} for part in item["groups"]]
    return {**item, "layouts": layouts, "groups": groups}


def _summary(device: Device) -> str:
    if not device.registers:
        return ""
    first, last = min(item.address for item in device.registers), max(item.last_address for item in device.registers)
    return f"{counted(len(device.registers), 'register')} from {hexadecimal(first)} to {hexadecimal(last)}"


def _quantity_rows(alike: Alike) -> Iterator[Row]:
    """Yield the quantities set by the order code, and the factory defaults of those that registers hold."""
    later = run_time_names(alike.family)
    for item in parameters_of(alike.family, alike.interface.name):
        if not item.alternative and alike.variants[0].parameters[item.name] != 0:
            yield _quantity(alike, item, item.name in later)


def _quantity(alike: Alike, item: Parameter, is_held: bool) -> Row:
    shown = value(item, alike.variants[0].parameters[item.name])
    by_code = item.read_from and alike.family.register(item.register).default is None
    kind = "Value of the order code" if by_code else "Factory default"
    held = f" {kind}, held in {text(field_at(alike.family, item.read_from))}." if item.read_from else ""
    held = held or (" Factory default, set by registers." if is_held else "")
    about = f"{text(sentence(own_meaning(alike.family, item)))}{held} <small>{code(item.name)}</small>"
    return with_unit(shown, text(item.unit)), f"{about} <small>{cited(item.source)}</small>"
