"""A page for an order code: everything of its interface, with numbers in place of quantities."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, TypedDict

from ...model import Device, Erratum, Interface, Parameter, Supply, Variant
from ...reference.applied import applied
from ...reference.parameters import follows_registers, parameters_of, run_time_names
from ...reference.parts import for_codes
from ...say.erratum import erratum
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.measurement import measurement
from ...say.parameter import value
from ...say.place import field_at
from ...say.text import Said
from ...say.words import volts
from . import facts
from .waves import wave

Row = tuple[str, ...]
_NO_PART_OF_A_NAME = re.compile(r"[^A-Za-z0-9.-]+")


class CodeValues(TypedDict):
    """What a page of an order code has beside what the page of its family has."""

    codes: Annotated[Sequence[str], "the order codes, which differ in mechanics or supply alone"]
    interface: Annotated[Interface, "the interface that they have"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]
    short_rows: Annotated[list[Row], "fact, value, source: the position, the supply, the interface"]
    quantity_rows: Annotated[list[Row], "quantity, value, meaning, source: what follows from the order code"]
    timing_text: Annotated[str, "what the picture of the interface in time shows; empty where there is none"]
    delivered: Annotated[Sequence[str], "the frames whose places or code registers decide"]
    short_errata: Annotated[list[tuple[Erratum, Said]], "the errata that concern this order code"]


@dataclass(frozen=True)
class Alike:
    """Order codes that are the same to a program, and the family as they have it."""

    family: Device
    variants: tuple[Variant, ...]
    here: Device

    @property
    def name(self) -> str:
        """What their page is called: the first order code, with a hyphen for what no file name may have."""
        return _NO_PART_OF_A_NAME.sub("-", self.variants[0].code)

    @property
    def interface(self) -> Interface:
        return self.here.interface(self.variants[0].interface)


def all_alike(device: Device) -> Iterator[Alike]:
    """The order codes of a family, those with the same interface and quantities together."""
    found: dict[tuple[str, tuple[tuple[str, int], ...]], list[Variant]] = {}
    for item in device.variants:
        found.setdefault((item.interface, tuple(sorted(item.parameters.items()))), []).append(item)
    for variants in found.values():
        here = for_codes(device, [item.code for item in variants])
        yield Alike(device, tuple(variants), applied(here, variants[0]))


def values(alike: Alike, has_masters: bool) -> CodeValues:
    shown = wave(alike.family, alike.interface)
    return {
        "codes": [item.code for item in alike.variants],
        "interface": alike.interface,
        "has_masters": has_masters,
        "short_rows": list(_short_rows(alike)),
        "quantity_rows": list(_quantity_rows(alike)),
        "timing_text": shown.told if shown is not None else "",
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


def links(device: Device, folder: str) -> dict[str, str]:
    """Each order code with a link to its page, for a page beside the ``folder`` of the family."""
    return {
        item.code: link(code(item.code), f"{folder}{alike.name}.md")
        for alike in all_alike(device)
        for item in alike.variants
    }
