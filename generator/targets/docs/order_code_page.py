"""Page of an order code: everything about its interface, with numbers in place of expressions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from ...model import INTERFACES, Device, Interface, Parameter, Variant
from ...order_codes.narrowing import for_codes
from ...order_codes.parameters import parameters_of, run_time_names
from ...order_codes.with_numbers import applied
from ...say.markdown import cited, code, joined, link, text
from ...say.parameter import value
from ...say.place import field_at
from ...say.words import with_unit
from ..file_names import names_of_codes
from .interface_page import OverValues, over_values
from .interface_sections import Sections, sections
from .order_code_patterns import patterns
from .page_pictures import Pictures, of_codes, of_family

Row = tuple[str, ...]
#: Other files in the folder of a family: names of pages, and first words of the names of pictures.
TAKEN = (*INTERFACES, "connector", "errata", "hardware", "manual", "register", "timing")


class CodePage(Sections, OverValues):
    """Values of the page of an order code in addition to those of its interface page."""

    codes: Annotated[Sequence[str], "the order codes, which differ only in mechanics or supply"]
    quantity_rows: Annotated[list[Row], "quantities of the order code: quantity, value, meaning, source"]


@dataclass(frozen=True)
class Alike:
    """Order codes that are identical for software. ``name`` is the name of their common page."""

    family: Device
    variants: tuple[Variant, ...]
    here: Device
    name: str

    @property
    def codes(self) -> list[str]:
        return [item.code for item in self.variants]

    @property
    def interface(self) -> Interface:
        return self.here.interface(self.variants[0].interface)

    @cached_property
    def pictures(self) -> Pictures:
        """Pictures for these codes that differ from those of the family."""
        return of_codes(self.family, self.codes, self.name)


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
        return tuple(
            Alike(self.device, tuple(variants), applied(_only(self.device, variants), variants[0]), name)
            for variants, name in zip(found.values(), names, strict=True)
        )

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
        """Links to the page of each order code, for pages in the folder of the family."""
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


def _only(device: Device, variants: Iterable[Variant]) -> Device:
    return for_codes(device, [item.code for item in variants])


def page_values(alike: Alike, has_masters: bool, pictures: Pictures) -> CodePage:
    """Return the values of the page. ``pictures`` are those of the family. The page may replace some of them."""
    return {
        **sections(alike.here),
        **over_values(alike.family, alike.here, alike.variants, has_masters, {**pictures, **alike.pictures}),
        "codes": alike.codes,
        "quantity_rows": list(_quantity_rows(alike)),
    }


def _quantity_rows(alike: Alike) -> Iterator[Row]:
    """Yield the quantities set by the order code, and the factory defaults of those that registers hold."""
    later = run_time_names(alike.family)
    for item in parameters_of(alike.family, alike.interface.name):
        if not item.alternative:
            yield _quantity(alike, item, item.name in later)


def _quantity(alike: Alike, item: Parameter, is_held: bool) -> Row:
    shown = value(item, alike.variants[0].parameters[item.name])
    held = f"factory default, held in {text(field_at(alike.family, item.read_from))}" if item.read_from else ""
    held = held or ("factory default, set by registers" if is_held else "")
    return code(item.name), with_unit(shown, text(item.unit)), joined([text(item.meaning), held]), cited(item.source)
