"""What a search finds first: order codes, addresses of registers and printed names, taken from the model.

They are objects of a Sphinx domain, which its search puts before headings and words. The model says what there is; the
pages say where: a thing without an anchor on any page of its family is left out, and the build says so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from codewheel.build.load import load_library
from codewheel.model import Device, Field, Layout, Procedure
from codewheel.say.name import Titled, title, words
from codewheel.say.place import addresses, hexadecimal
from codewheel.targets.docs.by_code import all_alike
from sphinx.application import Sphinx
from sphinx.domains import Domain
from sphinx.util import logging

#: Where the pages of families lie.
_PAGES = "generated/docs"
#: What Sphinx adds to the score of a hit: 15, or 5, which is as much as that of a heading.
_FIRST, _SECOND = 0, 1


@dataclass(frozen=True)
class Thing:
    """A name, what it is the name of, and the anchor where that is told."""

    name: str
    what: str
    anchor: str
    interface: str = ""
    priority: int = _FIRST


def things(device: Device) -> Iterator[Thing]:
    """What a family has a name or an address for, order codes aside."""
    for register in device.registers:
        anchor = f"register-{register.name}"
        what = f"register {title(register)}, {addresses(register)}"
        yield from _named(register, what, anchor, register.interface)
        for address in range(register.address, register.last_address + 1):
            for spelling in (hexadecimal(address), f"0x{address:02X}"):
                yield Thing(spelling, what, anchor, register.interface)
        yield from _fields(register.layout, title(register), anchor, register.interface)
    for interface, layout in device.layouts():
        anchor = f"layout-{layout.name}"
        yield from _named(layout, f"frame, {interface.title}", anchor, interface.name)
        yield from _fields(layout, f"the frame {title(layout)}", anchor, interface.name)
    for item in device.interfaces:
        yield Thing(item.title, "interface", f"interface-{item.name}", item.name)
    for alarm in device.alarms:
        yield from _named(alarm, "error or warning", f"alarm-{alarm.name}")
    for procedure in device.procedures:
        over = device.interface(procedure.interface).title
        yield from _named(procedure, f"procedure, {over}", f"procedure-{procedure.name}", procedure.interface)


def _fields(layout: Layout, owner: str, anchor: str, interface: str) -> Iterator[Thing]:
    for field in layout.fields:
        if _has_name(field):
            place = f"group-{field.group}" if field.group else anchor
            yield from _named(field, f"field of {owner}", place, interface, _SECOND)


def _has_name(field: Field) -> bool:
    return field.carries_data or bool(field.printed_name)


def _named(
    item: Titled | Procedure, what: str, anchor: str, interface: str = "", priority: int = _FIRST
) -> Iterator[Thing]:
    """Under the name in specs and code, the same as words, and the manual's own."""
    printed = "" if isinstance(item, Procedure) else item.printed_name
    spelled = {name.lower(): name for name in (item.name, words(item.name), printed) if name}
    for name in spelled.values():
        # A point would part the name.
        yield Thing(name.replace(".", " "), what, anchor, interface, priority)


class Encoders(Domain):
    """The domain of encoders."""

    name = "encoder"
    label = "Encoder"
    object_types: ClassVar[dict[str, Any]] = {}

    @cached_property
    def _families(self) -> tuple[Device, ...]:
        families, report = load_library()
        if report.problems:
            raise ValueError(report.problems[0].format())
        return families

    @cached_property
    def _code_pages(self) -> dict[str, tuple[str, ...]]:
        """The pages of order codes, and which they are."""
        return {
            f"{_PAGES}/{device.name}/{alike.name}": tuple(item.code for item in alike.variants)
            for device in self._families
            for alike in all_alike(device)
        }

    def code_of(self, page: str) -> str:
        """The first order code of a page of such; empty for another page."""
        return self._code_pages.get(page, ("",))[0]

    def get_objects(self) -> Iterator[tuple[str, str, str, str, str, int]]:
        for page, codes in self._code_pages.items():
            anchors = self._anchors(page)
            for code in codes if anchors else ():
                yield code, code, f"order code of {page.split('/')[-2].upper()}", page, anchors[0], _FIRST
        for device in self._families:
            for thing in dict.fromkeys(things(device)):
                page = self._page_with(device, thing)
                name = f"{device.name.upper()}.{thing.name}"
                if page:
                    yield name, name, thing.what, page, thing.anchor, thing.priority

    def missing(self) -> Iterator[str]:
        """The things that no page has an anchor for."""
        for page, codes in self._code_pages.items():
            if not self._anchors(page):
                yield f"{codes[0]}: no page {page}"
        for device in self._families:
            for thing in dict.fromkeys(things(device)):
                if not self._page_with(device, thing):
                    yield f"{device.name}: no anchor {thing.anchor}"

    def _anchors(self, page: str) -> list[str]:
        return self.env.metadata.get(page, {}).get("anchors", [])  # type: ignore[return-value]

    def _page_with(self, device: Device, thing: Thing) -> str:
        """The page of the family that tells of a thing: that of its interface if there is one, else the first."""
        pages = self._pages_with.get((device.name, thing.anchor), ())
        return next((page for page in pages if thing.interface and _is_of(page, thing.interface)), (*pages, "")[0])

    @cached_property
    def _pages_with(self) -> dict[tuple[str, str], list[str]]:
        """The pages of each family with an anchor, those of order codes aside."""
        found: dict[tuple[str, str], list[str]] = {}
        for device in self._families:
            start = f"{_PAGES}/{device.name}"
            for page in sorted(self.env.found_docs - set(self._code_pages)):
                if page == start or page.startswith((f"{start}-", f"{start}/")):
                    for anchor in self._anchors(page):
                        found.setdefault((device.name, anchor), []).append(page)
        return found


def _is_of(page: str, interface: str) -> bool:
    return interface in page.rpartition("/")[2].split("-")


def _warn(app: Sphinx, _error: Exception | None) -> None:
    domain = app.env.get_domain("encoder")
    assert isinstance(domain, Encoders)
    for item in dict.fromkeys(domain.missing()):
        logging.getLogger(__name__).warning("the search cannot lead to %s", item)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_domain(Encoders)
    app.connect("build-finished", _warn)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
