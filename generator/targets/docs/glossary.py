"""Glossary: terms used in manuals and for interfaces, with links to the sections about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Annotated, TypedDict

from ...model import Device, Interface, Ssi
from ...order_codes.narrowing import for_interface
from ...say.markdown import link, text
from ...say.name import Titled
from ...say.terms import TERMS, Term
from .page_links import interface_page

#: File name of the page, which no family can have.
PAGE = "glossary-of-terms.md"


class GlossaryPage(TypedDict):
    term_rows: Annotated[list[tuple[str, str, str]], "terms that these families use: term, meaning, links"]


def page_values(devices: Sequence[Device]) -> GlossaryPage:
    parts = []
    for device in devices:
        for interface in device.interfaces:
            interface_device = for_interface(device, interface.name)
            parts.append((interface_device, interface, list(_places(interface_device, interface))))
    terms = sorted(TERMS, key=lambda term: term.name.casefold())
    linked_terms = ((term, [term_link for part in parts if (term_link := _link(term, *part))]) for term in terms)
    return {
        "term_rows": [(text(term.name), text(term.meaning), ", ".join(links)) for term, links in linked_terms if links]
    }


def _link(term: Term, device: Device, interface: Interface, places: Sequence[tuple[str, str]]) -> str:
    """Return a link to the section about the term on an interface page, or an empty string."""
    if term.over is not None:
        section = term.section if isinstance(interface, term.over) and _has(device, interface, term.section) else ""
    else:
        exactly = (place for name, place in places if name in term.spelled)
        within = (place for name, place in places if any(f" {word} " in f" {name} " for word in term.spelled))
        section = next(chain(exactly, within), "")
    title = f"{device.name.upper()} {interface.short}"
    return link(text(title), f"{interface_page(device, interface)}#{section}") if section else ""


def _has(device: Device, interface: Interface, section: str) -> bool:
    """Return whether the interface page has the section. Every page has frames and times."""
    sections_present = {
        "control-data": bool(getattr(interface, "control_data", ())),
        "procedures": bool(device.procedures),
        "wiring": bool(device.connectors),
    }
    return sections_present.get(section, True)


def _places(device: Device, interface: Interface) -> Iterator[tuple[str, str]]:
    """Yield the names on an interface page in lowercase with their anchors. Names with their own section are first."""
    for register in device.registers:
        yield from _names(register, f"register-{register.name}")
    for group in device.field_groups:
        yield from _names(group, f"group-{group.name}")
    for crc in device.crcs:
        yield "crc", f"crc-{crc.name}"
    if isinstance(interface, Ssi) and interface.output_code is not None and interface.output_code.code != "binary":
        yield "gray", "frames"
    for timing in interface.timings:
        yield timing.symbol.casefold(), "timings"
    for layout in interface.layouts:
        for field in layout.fields:
            yield from _names(field, f"group-{field.group}" if field.group else f"layout-{layout.name}")
        yield from ((join.name, f"layout-{layout.name}") for join in layout.joins)
    for register in device.registers:
        for field in register.layout.fields:
            yield from _names(field, f"register-{register.name}")


def _names(titled: Titled, place: str) -> Iterator[tuple[str, str]]:
    yield titled.name.replace("_", " "), place
    yield titled.printed_name.casefold(), place
