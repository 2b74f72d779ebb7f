"""First results of the search: order codes, addresses of registers and printed names, taken from the model.

They are objects of a Sphinx domain, which the search ranks before headings and words. The entries come from the model,
and their locations from the pages. An entry without an anchor on any page of its family is omitted, with a warning.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol

from codewheel.loading.library import load_library
from codewheel.model import Device, Field, Layout, Variant
from codewheel.say.names_and_evidence import GRADES, addresses_text, hexadecimal, name_in_words, title_of
from codewheel.targets.docs.order_code_page import OrderCodes
from sphinx.application import Sphinx
from sphinx.domains import Domain
from sphinx.util import logging

#: Folder of the pages of families.
_PAGES = "generated/docs"
#: Sphinx adds to the score of a hit by its name: 15, or 5, which ranks a part of a name after headings.
_FIRST, _SECOND = 0, 1


class _Nameable(Protocol):
    @property
    def name(self) -> str: ...


@dataclass(frozen=True)
class SearchEntry:
    """A name, the kind of part with this name, and the anchor of its description."""

    name: str
    description: str
    anchor: str
    interface: str = ""
    priority: int = _FIRST


def entries(device: Device) -> Iterator[SearchEntry]:
    """Yield everything in a family that has a name or an address, except order codes and fields."""
    for register in device.registers:
        anchor = f"register-{register.name}"
        description = f"register {title_of(register)}, {addresses_text(register)}"
        yield from _entries_of(register, description, anchor, register.interface)
        for address in range(register.address, register.last_address + 1):
            for spelling in (hexadecimal(address), f"0x{address:02X}"):
                yield SearchEntry(spelling, description, anchor, register.interface)
    for interface, layout in device.layouts():
        anchor = f"layout-{layout.name}"
        yield from _entries_of(layout, f"frame, {interface.title}", anchor, interface.name)
    for interface in device.interfaces:
        # The first section of its page.
        yield SearchEntry(interface.title, "interface", "frames", interface.name)
    for kind, anchor, items in _parts(device):
        for part in items:
            yield from _entries_of(part, kind, f"{anchor}-{part.name}")
    for procedure in device.procedures:
        interface_title = device.interface(procedure.interface).title
        yield from _entries_of(
            procedure, f"procedure, {interface_title}", f"procedure-{procedure.name}", procedure.interface
        )


def _parts(device: Device) -> Iterator[tuple[str, str, Sequence[_Nameable]]]:
    """Yield the other parts of a family with their own sections: kind, prefix of the anchors, and the parts."""
    yield "error or warning", "alarm", device.alarms
    yield "input", "input", device.inputs
    yield "CRC", "crc", device.crcs
    yield "left open by the manual", "alternative", device.alternatives


def field_entries(device: Device) -> Iterator[SearchEntry]:
    """Yield the fields of registers and frames, and the groups that frames share."""
    for register in device.registers:
        owner, anchor = f"register {title_of(register)}", f"register-{register.name}"
        yield from _fields(device, register.layout, owner, anchor, register.interface)
    for interface, layout in device.layouts():
        yield from _fields(device, layout, f"frame {title_of(layout)}", f"layout-{layout.name}", interface.name)


def _fields(device: Device, layout: Layout, owner: str, anchor: str, interface: str) -> Iterator[SearchEntry]:
    groups = {group.name: group for group in device.field_groups}
    for name in dict.fromkeys(field.group for field in layout.fields if field.group):
        yield from _entries_of(groups[name], f"part of {owner}", f"group-{name}", interface)
    for field in layout.fields:
        if field.group:
            yield from _field(field, title_of(groups[field.group]), f"group-{field.group}", interface)
        elif field.carries_data or field.printed_name:
            yield from _field(field, owner, anchor, interface)


def _field(field: Field, owner: str, anchor: str, interface: str) -> Iterator[SearchEntry]:
    """Yield a field. The printed name ranks first, and our own names, such as number, rank like other words."""
    for entry in _entries_of(field, f"field of {owner}", anchor, interface):
        is_printed = entry.name == field.printed_name.replace(".", " ")
        yield entry if is_printed else replace(entry, priority=_SECOND)


def _entries_of(owner: _Nameable, description: str, anchor: str, interface: str = "") -> Iterator[SearchEntry]:
    """Yield an item by its name in the manual, its name in words, and its name in specs and code."""
    for name in (getattr(owner, "printed_name", ""), name_in_words(owner.name)):
        if name:
            # A point would split the name.
            yield SearchEntry(name.replace(".", " "), description, anchor, interface)
    yield SearchEntry(owner.name, description, anchor, interface, _SECOND)


def _rank(device: Device) -> int:
    """Return 0 for a family whose facts are the manufacturer's, and more for other grades."""
    return max(GRADES.index(device.evidence.grade) - GRADES.index("quoted"), 0)


class Encoders(Domain):
    """The Sphinx domain for encoders."""

    name = "encoder"
    label = "Encoder"
    object_types: ClassVar[dict[str, Any]] = {}

    @cached_property
    def _families(self) -> tuple[Device, ...]:
        """Return all families, the highest grade first, so that they are found before others with the same words."""
        families, report = load_library()
        if report.problems:
            raise ValueError(report.problems[0].format())
        return tuple(sorted(families, key=_rank))

    @cached_property
    def _entries(self) -> dict[str, list[SearchEntry]]:
        """Return the entries of each family, without duplicates. A field is kept only if no other part has its name."""
        entries_by_family = {}
        for device in self._families:
            named_entries = {(entry.name.lower(), entry.anchor): entry for entry in reversed([*entries(device)])}
            fields = {entry.name.lower(): entry for entry in reversed([*field_entries(device)])}
            for name, _ in named_entries:
                fields.pop(name, None)
            entries_by_family[device.name] = [*named_entries.values(), *fields.values()]
        return entries_by_family

    @cached_property
    def _code_pages(self) -> dict[str, tuple[str, ...]]:
        """Return the order codes described by each page."""
        pages: dict[str, tuple[str, ...]] = {}
        for device in self._families:
            pages |= {f"{_PAGES}/{device.name}/{group.name}": tuple(group.codes) for group in OrderCodes(device).groups}
        return pages

    def rank_of(self, page: str) -> int:
        """Return the rank of a page in the search: first pages of no family and of families with the highest grade."""
        return next((_rank(device) for device in self._families if device.name == self.family_of(page)), 0)

    def code_of(self, page: str) -> str:
        """Return the first order code described by a page, or an empty string if there is none."""
        return self._code_pages.get(page, ("",))[0]

    def family_of(self, page: str) -> str:
        """Return the name of the family that a page describes, or an empty string."""
        names = (device.name for device in self._families)
        start = f"{_PAGES}/"
        return next((name for name in names if re.match(rf"{start}{name}\b", page)), "")

    def device_of(self, page: str) -> Device | None:
        """Return the family that a page describes, if any."""
        return next((device for device in self._families if device.name == self.family_of(page)), None)

    def variant_of(self, page: str) -> Variant | None:
        """Return the first order code described by a page, if any."""
        device = self.device_of(page)
        variants = device.variants if device is not None else ()
        return next((variant for variant in variants if variant.code == self.code_of(page)), None)

    def code_pages(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Yield the pages of order codes, and the codes that each describes."""
        yield from self._code_pages.items()

    def families_by_manufacturer(self) -> dict[str, list[str]]:
        """Return the names of the families of each manufacturer, by the words of its name, in lower case."""
        families: dict[str, list[str]] = {}
        for device in self._families:
            title = device.manufacturer.title.lower()
            words = [re.sub(r"[^a-z0-9]", "", word) for word in title.split()]
            for word in dict.fromkeys([device.manufacturer.name, words[0]]):
                families.setdefault(word, []).append(device.name)
        return families

    def interfaces_of(self, family: str) -> list[str]:
        """Return the names of the interfaces of a family."""
        return [interface.name for device in self._families if device.name == family for interface in device.interfaces]

    def interface_page_of(self, page: str) -> str:
        """Return the page for the interface of an order code, or an empty string for other pages."""
        code = self.code_of(page)
        for device in self._families if code else ():
            for variant in device.variants:
                if variant.code == code:
                    return f"{page.rpartition('/')[0]}/{variant.interface}"
        return ""

    def get_objects(self) -> Iterator[tuple[str, str, str, str, str, int]]:
        for page, codes in self._code_pages.items():
            anchors = self._anchors(page)
            for code in codes if anchors else ():
                yield code, code, f"order code of {page.split('/')[-2].upper()}", page, anchors[0], _FIRST
        for device in self._families:
            for entry in self._entries[device.name]:
                page = self._page_with(device, entry)
                name = f"{device.name.upper()}.{entry.name}"
                if page:
                    yield name, name, entry.description, page, entry.anchor, entry.priority

    def missing(self) -> Iterator[str]:
        """Yield the entries that have no anchor on any page."""
        for page, codes in self._code_pages.items():
            if not self._anchors(page):
                yield f"{codes[0]}: no page {page}"
        for device in self._families:
            for entry in self._entries[device.name]:
                if not self._page_with(device, entry):
                    yield f"{device.name}: no anchor {entry.anchor}"

    def _anchors(self, page: str) -> list[str]:
        return self.env.metadata.get(page, {}).get("anchors", [])  # type: ignore[return-value]

    def _page_with(self, device: Device, entry: SearchEntry) -> str:
        """Return the page that describes an entry: the page for its interface, or otherwise the first page."""
        pages = self._pages_with.get((device.name, entry.anchor), ())
        return next(
            (page for page in pages if entry.interface and _is_page_of_interface(page, entry.interface)),
            (*pages, "")[0],
        )

    @cached_property
    def _pages_with(self) -> dict[tuple[str, str], list[str]]:
        """Return the pages of each family that contain an anchor, except order code pages."""
        pages_by_anchor: dict[tuple[str, str], list[str]] = {}
        for device in self._families:
            start = f"{_PAGES}/{device.name}"
            for page in sorted(self.env.found_docs - set(self._code_pages)):
                if page == start or page.startswith((f"{start}-", f"{start}/")):
                    for anchor in self._anchors(page):
                        pages_by_anchor.setdefault((device.name, anchor), []).append(page)
        return pages_by_anchor


def _is_page_of_interface(page: str, interface: str) -> bool:
    return interface in page.rpartition("/")[2].split("-")


def _warn(app: Sphinx, _error: Exception | None) -> None:
    domain = app.env.get_domain("encoder")
    assert isinstance(domain, Encoders)
    for missing in dict.fromkeys(domain.missing()):
        logging.getLogger(__name__).warning("the search cannot lead to %s", missing)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_domain(Encoders)
    app.connect("build-finished", _warn)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
