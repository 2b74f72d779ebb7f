"""Pages of a family that do not belong to an interface: index, hardware and manual."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Annotated, TypedDict

from ...model import Device, Manual, Table, TimesRead
from ...order_codes.narrowing import for_interface
from ...say.evidence import basis, grade
from ...say.interface import settings
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.origin import edition_test, origin, other_editions
from ...say.text import Said
from ...say.words import counted, language
from . import changes_page, fact_tables, inline_errata, order_code_tables, page_links, verdict_page
from .hardware_steps import ByHand, by_hand
from .order_code_page import Codes
from .order_code_patterns import patterns

Rows = list[tuple[str, ...]]


class FamilyPage(TypedDict):
    device: Annotated[Device, "the family"]
    origin: Annotated[list[Said], "overlays and the edition of the family"]
    manual: Annotated[str, "the manual with its revision"]
    evidence: Annotated[Said, "grade of the evidence"]
    errata_at: Annotated[Callable[..., str], "errata of one or more paths in the spec"]
    errata_count: Annotated[str, "number of errata"]
    wish_rows: Annotated[Rows, "tasks, and links to their instructions"]
    interface_rows: Annotated[Rows, "interface, order codes, clock or port"]
    code_links: Annotated[list[tuple[str, list[str]]], "number of order codes of each interface, and links to them"]
    part_rows: Annotated[Rows, "parts of an order code and the meaning of each value"]
    spelling_rows: Annotated[Rows, "other spellings on labels"]
    measurement_rows: Annotated[Rows, "unit of the position"]
    has_masters: Annotated[bool, "true if there is a page of master settings"]
    changes_page: Annotated[str, "page that lists the changes in each version"]


class HardwarePage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_at: Annotated[Callable[..., str], "errata of one or more paths in the spec"]
    by_hand: Annotated[list[ByHand], "the procedures by hand"]
    characteristic_rows: Annotated[Rows, "characteristics, mounting, safety"]


class ManualPage(TypedDict):
    device: Annotated[Device, "the family"]
    manual_rows: Annotated[Rows, "the manual: title, revision, language, publisher"]
    edition_rows: Annotated[Rows, "selectable editions, and their differences"]
    edition_tests: Annotated[list[str], "registers that identify an encoder of an older edition"]
    lost_rows: Annotated[Rows, "the figures that were not available"]
    document_rows: Annotated[Rows, "the documents that sources cite"]
    history_rows: Annotated[Rows, "the revisions of the manual"]


def index_values(family: Codes, has_masters: bool) -> FamilyPage:
    device = family.device
    listed = [(item, [one.code for one in device.variants_over(item.name)]) for item in device.interfaces]
    return {
        "device": device,
        "origin": [*origin(device), *other_editions(device)],
        "manual": f"{text(device.manual.title)}, revision {revision(device.manual)}",
        "evidence": grade(device),
        "errata_at": inline_errata.OnPage(device, f"{device.name}/"),
        "errata_count": f"{len(device.errata)}",
        "wish_rows": list(_wishes(device, has_masters)),
        "interface_rows": [
            (
                link(item.title, page_links.interface_page(device, item)),
                ", ".join(map(code, patterns(device, found))) if found else "",
                "; ".join(STYLE.phrase(said) for said in list(settings(device, item))[:1]),
            )
            for item, found in listed
        ],
        "code_links": [
            (f"{item.title}: {counted(len(found), 'order code')}", [family.links[one] for one in found])
            for item, found in listed
            if found
        ],
        "part_rows": list(order_code_tables.part_rows(device)),
        "spelling_rows": list(order_code_tables.spelling_rows(device)),
        "measurement_rows": list(order_code_tables.measurement_rows(device)),
        "has_masters": has_masters,
        "changes_page": changes_page.page(device),
    }


def _wishes(device: Device, has_masters: bool) -> Iterator[tuple[str, str]]:
    """Yield tasks, with the names used in the manual if it has any, and links to their instructions."""
    frames = [pair for pair in device.layouts() if device.tells_position(pair[0].name, pair[1])]
    over = [interface.name for interface, _ in frames]
    labels = (part.title + (f" {code(one.name)}" if over.count(part.name) > 1 else "") for part, one in frames)
    if frames:
        links = (page_links.to_layout(device, one, label) for (_, one), label in zip(frames, labels, strict=True))
        yield "Read the position", ", ".join(links)
    yield "Check whether the position is usable", link("usable or not", f"{verdict_page.PAGE}#{device.name}")
    for part, wish in _PARTS.items():
        if found := list(_to_part(device, part)):
            yield wish, ", ".join(found)
    for item in device.procedures:
        yield text(item.title), page_links.to_procedure(device, item)
    for hand in by_hand(device):
        yield text(hand.title), link("by hand", f"{device.name}/hardware.md#by-hand-{hand.characteristic.name}")
    if device.characteristics:
        yield "Mount it, look up its limits", link("mounting and characteristics", f"{device.name}/hardware.md")
    if has_masters:
        yield "Set up a BiSS or SSI master", link("master settings", f"{device.name}-masters.md")


#: Sections of an interface page, with the task that each one covers.
_PARTS = {
    "wiring": "Connect it",
    "leds": "Understand the LEDs",
    "alarms": "Clear an error or a warning",
}


def _to_part(device: Device, part: str) -> Iterator[str]:
    """Yield a link to the section of each interface that has it."""
    for item in device.interfaces:
        here = for_interface(device, item.name)
        if {"wiring": here.connectors, "leds": here.leds, "alarms": here.alarms}[part]:
            yield link(item.title, f"{page_links.interface_page(device, item)}#{part}")


def hardware_values(device: Device) -> HardwarePage:
    errata_at, hand = inline_errata.OnPage(device), by_hand(device)
    listed = {item.characteristic.name: item for item in hand}
    return {
        "device": device,
        "errata_at": errata_at,
        "by_hand": hand,
        "characteristic_rows": [
            (
                code(item.name),
                joined(
                    [
                        link("step by step", f"#by-hand-{item.name}") if item.name in listed else text(item.value),
                        errata_at.named(f"characteristics.{item.name}"),
                    ]
                ),
                code(item.only),
                cited(item.source),
            )
            for item in device.characteristics
        ],
    }


def manual_values(device: Device) -> ManualPage:
    style = page_links.style_beside(device)
    tests = [edition_test(item.revision, test) for item in device.editions for test in item.tests]
    return {
        "device": device,
        "manual_rows": [row for row in _manual_rows(device) if row[1]],
        "edition_rows": list(_edition_rows(device)),
        "edition_tests": [style.sentence(item) for item in tests],
        "lost_rows": [(text(item.content), cited(item.source)) for item in device.lost_figures],
        "document_rows": fact_tables.document_rows(device.documents),
        "history_rows": [
            (text(item.revision), item.date, text(item.changes), text(item.hardware), text(item.software))
            for item in device.manual.history
        ],
    }


def _manual_rows(device: Device) -> Iterator[tuple[str, str]]:
    manual = device.manual
    yield "Manual", text(manual.title)
    yield "Revision", revision(manual)
    yield "Language", text(language(manual.language))
    yield "Publisher", text(manual.publisher)
    yield "Transcribed", _times_read(device.times_read)
    for said in (grade(device), *basis(device)):
        yield said.label, STYLE.phrase(replace(said, label=""))
    yield "Manufacturer", text(device.manufacturer.title)
    for item in manual.editions:
        about = [text(language(item.language)), text(item.title), f"revision {text(item.revision)}", item.date]
        yield "Other edition", joined(about, ", ")
    yield "Version", f"{text(device.manufacturer.version)}, {link('changes', f'../{changes_page.page(device)}')}"


def _times_read(counts: TimesRead | None) -> str:
    """Return the text about facts confirmed by a second reading, or an empty string without one."""
    if counts is None:
        return ""
    every = counts.twice + counts.explained + counts.decided + counts.once
    differ = "differs for a reason" if counts.explained == 1 else "differ for reasons"
    explained = f", {counts.explained} {differ} given in the errata" if counts.explained else ""
    decided = f", {counts.decided} {'is' if counts.decided == 1 else 'are'} not in the manual" if counts.decided else ""
    once = f", and {counts.once} {'was' if counts.once == 1 else 'were'} read only once" if counts.once else ""
    derived = f". {counts.derived} more follow from others" if counts.derived else ""
    return f"Twice. Of {every} facts, {counts.twice} agree in both readings{explained}{decided}{once}{derived}"


def _edition_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield the differences in other editions, with the revision that introduced them."""

    def links(name: str) -> str:
        found = (item.name for item in device.errata if item.edition == name)
        return ", ".join(link(code(item), f"{page_links.ERRATA}#erratum-{item}") for item in found)

    for item in device.editions:
        name = item.revision
        yield text(name), item.date, links(f"before {name}"), links(name), ", ".join(map(code, item.labels))


def revision(manual: Manual) -> str:
    return text(manual.revision) + (f" of {manual.date}" if manual.date else "")


def table_rows(table: Table) -> Rows:
    """Return the rows of a table from the manual."""
    return [tuple(map(text, row)) for row in table.rows]
