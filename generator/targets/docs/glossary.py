"""Glossary: terms used in manuals and for interfaces, with links to the sections about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, TypedDict

from ...model import Device, Interface, Ssi
from ...model.record import dataclass
from ...order_codes.reduction import for_interface
from ...say.markdown import link, text
from ...say.names_and_places import Titled
from ...say.terms import TERMS, Term
from .page_links import interface_page_path

#: File name of the page, which no family can have.
PAGE = "glossary-of-terms.md"


class GlossaryPage(TypedDict):
    term_rows: Annotated[list[tuple[str, str, str]], "terms that these families use: term, meaning, links"]


@dataclass(frozen=True, slots=True)
class _InterfacePage:
    """Page of an interface. ``names`` are the names on it in lowercase with their anchors."""

    device: Device
    interface: Interface
    names: tuple[tuple[str, str], ...]


def page_values(devices: Sequence[Device]) -> GlossaryPage:
    pages = [_interface_page(device, interface) for device in devices for interface in device.interfaces]
    terms = sorted(TERMS, key=lambda term: term.name.casefold())
    rows = [(text(term.name), text(term.meaning), _links(term, pages)) for term in terms]
    return {"term_rows": [row for row in rows if row[2]]}


def _interface_page(device: Device, interface: Interface) -> _InterfacePage:
    interface_device = for_interface(device, interface.name)
    return _InterfacePage(interface_device, interface, tuple(_anchors_by_name(interface_device, interface)))


def _links(term: Term, pages: Sequence[_InterfacePage]) -> str:
    """Return links to the sections about a term, one for each interface page that has one."""
    links: list[str] = []
    for page in pages:
        anchor = _anchor_of_term(term, page)
        if anchor:
            title = f"{page.device.name.upper()} {page.interface.short}"
            links.append(link(text(title), f"{interface_page_path(page.device, page.interface)}#{anchor}"))
    return ", ".join(links)


def _anchor_of_term(term: Term, page: _InterfacePage) -> str:
    """Return the anchor of the section about a term on an interface page, or an empty string."""
    if term.over is not None:
        is_on_page = isinstance(page.interface, term.over) and _has_section(page, term.section)
        return term.section if is_on_page else ""
    for name, anchor in page.names:
        if name in term.spelled:
            return anchor
    for name, anchor in page.names:
        if any(f" {word} " in f" {name} " for word in term.spelled):
            return anchor
    return ""


def _has_section(page: _InterfacePage, section: str) -> bool:
    """Return whether an interface page has a section. Every page has frames and times."""
    contents = {
        "control-data": getattr(page.interface, "control_data", ()),
        "procedures": page.device.procedures,
        "wiring": page.device.connectors,
    }
    return section not in contents or bool(contents[section])


def _anchors_by_name(device: Device, interface: Interface) -> Iterator[tuple[str, str]]:
    """Yield the names on an interface page in lowercase with their anchors. Names with their own section are first."""
    for register in device.registers:
        yield from _names_of(register, f"register-{register.name}")
    for group in device.field_groups:
        yield from _names_of(group, f"group-{group.name}")
    for crc in device.crcs:
        yield "crc", f"crc-{crc.name}"
    if isinstance(interface, Ssi) and interface.output_code is not None and interface.output_code.code != "binary":
        yield "gray", "frames"
    for timing in interface.timings:
        yield timing.symbol.casefold(), "timings"
    for layout in interface.layouts:
        for field in layout.fields:
            yield from _names_of(field, f"group-{field.group}" if field.group else f"layout-{layout.name}")
        yield from ((join.name, f"layout-{layout.name}") for join in layout.joins)
    for register in device.registers:
        for field in register.layout.fields:
            yield from _names_of(field, f"register-{register.name}")


def _names_of(titled: Titled, anchor: str) -> Iterator[tuple[str, str]]:
    yield titled.name.replace("_", " "), anchor
    yield titled.printed_name.casefold(), anchor
