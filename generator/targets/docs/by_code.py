"""A page for an order code: everything of its interface, with numbers in place of quantities."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, count
from typing import Annotated, TypedDict

from ...model import Device, Erratum, Interface, Layout, Parameter, Ssi, Supply, Variant
from ...reference.applied import applied
from ...reference.parameters import follows_registers, parameters_of, run_time_names
from ...reference.parts import for_codes
from ...say.erratum import erratum
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.measurement import measurement
from ...say.parameter import value
from ...say.place import bit_range, field_at
from ...say.text import Said
from ...say.words import volts
from . import facts
from .pictures import bit_strip, draw
from .waves import Wave, wave

Row = tuple[str, ...]
_BIT = 15.0
_NO_PART_OF_A_NAME = re.compile(r"[^A-Za-z0-9.-]+")
_LONGEST = 80
#: What else lies in the folder of a family, pictures of registers and of lines in time by their first word.
_TAKEN = ("register", "timing")


class CodeValues(TypedDict):
    """What a page of an order code has beside what the page of its family has."""

    codes: Annotated[Sequence[str], "the order codes, which differ in mechanics or supply alone"]
    interface: Annotated[Interface, "the interface that they have"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]
    short_rows: Annotated[list[Row], "fact, value, source: the position, the supply, the interface"]
    quantity_rows: Annotated[list[Row], "quantity, value, meaning, source: what follows from the order code"]
    frame_pictures: Annotated[dict[str, str], "the path of the picture of each frame, by the name of its layout"]
    picture_texts: Annotated[dict[str, str], "what each of these pictures shows"]
    timing: Annotated[Wave | None, "the picture of the interface in time, if there is one"]
    delivered: Annotated[Sequence[str], "the frames whose places or code registers decide"]
    short_errata: Annotated[list[tuple[Erratum, Said]], "the errata that concern this order code"]


@dataclass(frozen=True)
class Alike:
    """Order codes that are the same to a program, and the family as they have it; ``name`` is that of their page."""

    family: Device
    variants: tuple[Variant, ...]
    here: Device
    name: str

    @property
    def interface(self) -> Interface:
        return self.here.interface(self.variants[0].interface)


@dataclass(frozen=True)
class Codes:
    """The order codes of a family, those with the same interface and quantities together."""

    device: Device

    @cached_property
    def alike(self) -> tuple[Alike, ...]:
        found: dict[tuple[str, tuple[tuple[str, int], ...]], list[Variant]] = {}
        for item in self.device.variants:
            found.setdefault((item.interface, tuple(sorted(item.parameters.items()))), []).append(item)
        names = page_names(variants[0].code for variants in found.values())
        return tuple(
            Alike(self.device, tuple(variants), applied(_only(self.device, variants), variants[0]), name)
            for variants, name in zip(found.values(), names, strict=True)
        )

    @cached_property
    def links(self) -> dict[str, str]:
        """Each order code with a link to its page, for a page beside the folder of the family."""
        return {
            item.code: link(code(item.code), f"{self.device.name}/{alike.name}.md")
            for alike in self.alike
            for item in alike.variants
        }


def _only(device: Device, variants: Iterable[Variant]) -> Device:
    return for_codes(device, [item.code for item in variants])


def page_names(order_codes: Iterable[str]) -> list[str]:
    """What the page of each is called, also where upper and lower case are the same; numbered where that is needed.

    What no file name may have is a hyphen.
    """
    taken, names = set(_TAKEN), list[str]()
    for order_code in order_codes:
        plain = _NO_PART_OF_A_NAME.sub("-", order_code)
        numbers = chain([""], (f"-{number}" for number in count(2)))
        numbered = (f"{plain[: _LONGEST - len(number)]}{number}" for number in numbers)
        names.append(next(name for name in numbered if name.casefold() not in taken))
        taken.add(names[-1].casefold())
    return names


def values(alike: Alike, has_masters: bool) -> CodeValues:
    return {
        "codes": [item.code for item in alike.variants],
        "interface": alike.interface,
        "has_masters": has_masters,
        "short_rows": list(_short_rows(alike)),
        "quantity_rows": list(_quantity_rows(alike)),
        "frame_pictures": {item.name: _picture_path(alike, item) for item in alike.interface.layouts},
        "picture_texts": {item.name: _picture_text(alike, item) for item in alike.interface.layouts},
        "timing": wave(alike.family, alike.interface),
        "delivered": [
            item.name
            for item in alike.family.interface(alike.interface.name).layouts
            if follows_registers(alike.family, item)
        ],
        "short_errata": [(item, erratum(item, whole=True)) for item in alike.here.errata if _concerns(item)],
    }


#: What the page of the family is about, not that of an order code.
_OF_THE_FAMILY = ("order_code", "parameters", "manual")


def _concerns(item: Erratum) -> bool:
    """Whether an erratum is about something on the page."""
    return any(path.partition(".")[0] not in _OF_THE_FAMILY for path in item.affects)


def pictures(alike: Alike) -> Iterator[tuple[str, str]]:
    """Path and picture of each frame of bits; a frame of bytes is the same for the whole family."""
    interface = alike.interface
    left = isinstance(interface, Ssi) and interface.alignment.end == "msb_left"
    for layout in interface.layouts:
        if not layout.in_bytes:
            placed = layout.place(alike.variants[0].parameters)
            title = f"{layout.printed_name or layout.name.replace('_', ' ')}, {alike.variants[0].code}"
            yield _picture_path(alike, layout), draw(title, [bit_strip("", placed, placed.bits, left)], _BIT)


def _picture_path(alike: Alike, layout: Layout) -> str:
    return f"{layout.name}.svg" if layout.in_bytes else f"{alike.name}-{layout.name}.svg"


def _picture_text(alike: Alike, layout: Layout) -> str:
    """What the picture shows, for whoever cannot see it."""
    placed = layout.place(alike.variants[0].parameters)
    fields = ", ".join(f"{item.name} {bit_range(item.high, item.low)}" for item in placed.fields)
    return f"{placed.bits} bits: {fields}"


def _quantity_rows(alike: Alike) -> Iterator[Row]:
    """The quantities that the order code stands for; those that registers hold as delivered."""
    later = run_time_names(alike.family)
    for item in parameters_of(alike.family, alike.interface.name):
        if not item.alternative:
            yield _quantity(alike, item, item.name in later)


def _short_rows(alike: Alike) -> Iterator[Row]:
    """What the position counts, the supply, and what the manual says of the interface."""
    counted = alike.here.measurement_of(alike.interface.name)
    if counted is not None:
        yield "Position", STYLE.phrase(measurement(counted)), cited(counted.source)
    for voltage, codes in _supplies(alike).items():
        whose = f" ({', '.join(map(code, codes))})" if len(codes) < len(alike.variants) else ""
        yield f"Supply{whose}", f"{volts(voltage.min_mv)} to {volts(voltage.max_mv)}", cited(voltage.source)
    yield from facts.interface_rows(alike.here, alike.interface)


def _quantity(alike: Alike, item: Parameter, is_held: bool) -> Row:
    shown = value(item, alike.variants[0].parameters[item.name])
    unit = f" {text(item.unit)}" if item.unit else ""
    held = f"as delivered; held by {text(field_at(alike.family, item.read_from))}" if item.read_from else ""
    held = held or ("as delivered; registers decide it" if is_held else "")
    return code(item.name), shown + unit, joined([text(item.meaning), held]), cited(item.source)


def _supplies(alike: Alike) -> dict[Supply, list[str]]:
    found: dict[Supply, list[str]] = {}
    for item in alike.variants:
        needed = alike.family.supply_of(item)
        if needed is not None:
            found.setdefault(needed, []).append(item.code)
    return found
