"""The pages of a family that belong to no interface: its index, its hardware, and its manual."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, TypedDict

from ...model import Device, Manual, Table, TimesRead
from ...order_codes.narrowing import for_interface
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
    origin: Annotated[list[Said], "what the family is beside what its manual says: overlays, another edition"]
    manual: Annotated[str, "the manual with its revision"]
    errata_at: Annotated[Callable[..., str], "the errata of a path into the spec, or of several"]
    errata_count: Annotated[str, "how many errata there are"]
    wish_rows: Annotated[Rows, "what somebody wants to do, and links to where it is told"]
    interface_rows: Annotated[Rows, "interface, order codes, what has to be set first"]
    code_links: Annotated[list[tuple[str, list[str]]], "for each interface how many order codes, and links to them"]
    part_rows: Annotated[Rows, "the parts of an order code and what each value stands for"]
    spelling_rows: Annotated[Rows, "labels that are written otherwise"]
    measurement_rows: Annotated[Rows, "what a position counts"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]
    changes_page: Annotated[str, "the page of what each version changed"]


class HardwarePage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_at: Annotated[Callable[..., str], "the errata of a path into the spec, or of several"]
    by_hand: Annotated[list[ByHand], "the procedures by hand"]
    characteristic_rows: Annotated[Rows, "characteristics, mounting, safety"]


class ManualPage(TypedDict):
    device: Annotated[Device, "the family"]
    manual_rows: Annotated[Rows, "the manual: title, revision, language, publisher"]
    edition_rows: Annotated[Rows, "the editions that can be asked for, and what is otherwise in them"]
    edition_tests: Annotated[list[str], "registers that tell an encoder of an older edition"]
    lost_rows: Annotated[Rows, "the figures that were not available"]
    document_rows: Annotated[Rows, "the documents that sources name"]
    history_rows: Annotated[Rows, "the revisions of the manual"]


def index_values(family: Codes, has_masters: bool) -> FamilyPage:
    device = family.device
    listed = [(item, [one.code for one in device.variants if one.interface == item.name]) for item in device.interfaces]
    return {
        "device": device,
        "origin": [*origin(device), *other_editions(device)],
        "manual": f"{text(device.manual.title)}, revision {revision(device.manual)}",
        "errata_at": inline_errata.OnPage(device, f"{device.name}/"),
        "errata_count": counted(len(device.errata), "place"),
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
    """What somebody wants to do, and where it is told; what the manual calls it, where it has a name for it."""
    frames = [pair for pair in device.layouts() if device.tells_position(pair[0].name, pair[1])]
    over = [interface.name for interface, _ in frames]
    labels = (part.title + (f" {code(one.name)}" if over.count(part.name) > 1 else "") for part, one in frames)
    if frames:
        links = (page_links.to_layout(device, one, label) for (_, one), label in zip(frames, labels, strict=True))
        yield "Read the position", ", ".join(links)
    yield "Know whether it can be used", link("usable or not", f"{verdict_page.PAGE}#{device.name}")
    for part, wish in _PARTS.items():
        if found := list(_to_part(device, part)):
            yield wish, ", ".join(found)
    for item in device.procedures:
        yield text(item.title), page_links.to_procedure(device, item)
    for hand in by_hand(device):
        yield text(hand.title), link("by hand", f"{device.name}/hardware.md#by-hand-{hand.characteristic.name}")
    if device.characteristics:
        yield "Mount it, know its limits", link("mounting and characteristics", f"{device.name}/hardware.md")
    if has_masters:
        yield "Set up a BiSS or SSI master", link("master settings", f"{device.name}-masters.md")


#: Sections of the page of an interface, and what they are wanted for.
_PARTS = {
    "wiring": "Connect it",
    "leds": "Understand the LEDs",
    "alarms": "Find the remedy of an error or a warning",
}


def _to_part(device: Device, part: str) -> Iterator[str]:
    """The section of each interface that has it."""
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
    yield "Read", _times_read(device.times_read)
    yield "Manufacturer", text(device.manufacturer.title)
    for item in manual.editions:
        about = [text(language(item.language)), text(item.title), f"revision {text(item.revision)}", item.date]
        yield "Other edition", joined(about, ", ")
    yield (
        "Version",
        f"{text(device.manufacturer.version)}, {link('what each changed', f'../{changes_page.page(device)}')}",
    )


def _times_read(counts: TimesRead | None) -> str:
    """How many facts a second reader found alike; empty where there was none."""
    if counts is None:
        return ""
    every = counts.twice + counts.explained + counts.once
    otherwise = f", {counts.explained} otherwise for reasons that the errata give" if counts.explained else ""
    return f"Twice, and settled by the manual: {counts.twice} of {every} facts are alike in both readings{otherwise}"


def _edition_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """What is otherwise in other editions, by the revision that changed it."""

    def links(name: str) -> str:
        found = (item.name for item in device.errata if item.edition == name)
        return ", ".join(link(code(item), f"{page_links.ERRATA}#erratum-{item}") for item in found)

    for item in device.editions:
        name = item.revision
        yield text(name), item.date, links(f"before {name}"), links(name), ", ".join(map(code, item.labels))


def revision(manual: Manual) -> str:
    return text(manual.revision) + (f" of {manual.date}" if manual.date else "")


def table_rows(table: Table) -> Rows:
    """The rows of a table of the manual."""
    return [tuple(map(text, row)) for row in table.rows]
