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
from ...say.text import Statement
from ...say.words import counted, language
from . import changes_page, fact_tables, inline_errata, order_code_tables, page_links, verdict_page
from .hardware_steps import ByHand, by_hand
from .order_code_page import Codes
from .order_code_patterns import patterns

Rows = list[tuple[str, ...]]


class FamilyPage(TypedDict):
    device: Annotated[Device, "the family"]
    origin: Annotated[list[Statement], "overlays and the edition of the family"]
    manual: Annotated[str, "the manual with its revision"]
    evidence: Annotated[Statement, "grade of the evidence"]
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
    interface_codes = [
        (interface, [variant.code for variant in device.variants_over(interface.name)])
        for interface in device.interfaces
    ]
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
                link(interface.title, page_links.interface_page(device, interface)),
                ", ".join(map(code, patterns(device, order_codes))) if order_codes else "",
                "; ".join(STYLE.phrase(setting) for setting in list(settings(device, interface))[:1]),
            )
            for interface, order_codes in interface_codes
        ],
        "code_links": [
            (
                f"{interface.title}: {counted(len(order_codes), 'order code')}",
                [family.links[order_code] for order_code in order_codes],
            )
            for interface, order_codes in interface_codes
            if order_codes
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
    interface_names = [interface.name for interface, _ in frames]
    labels = (
        interface.title + (f" {code(layout.name)}" if interface_names.count(interface.name) > 1 else "")
        for interface, layout in frames
    )
    if frames:
        links = (page_links.to_layout(device, layout, label) for (_, layout), label in zip(frames, labels, strict=True))
        yield "Read the position", ", ".join(links)
    yield "Check whether the position is usable", link("usable or not", f"{verdict_page.PAGE}#{device.name}")
    for part, wish in _PARTS.items():
        if section_links := list(_to_part(device, part)):
            yield wish, ", ".join(section_links)
    for procedure in device.procedures:
        yield text(procedure.title), page_links.to_procedure(device, procedure)
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
    for interface in device.interfaces:
        page_device = for_interface(device, interface.name)
        if {"wiring": page_device.connectors, "leds": page_device.leds, "alarms": page_device.alarms}[part]:
            yield link(interface.title, f"{page_links.interface_page(device, interface)}#{part}")


def hardware_values(device: Device) -> HardwarePage:
    errata_at, hand = inline_errata.OnPage(device), by_hand(device)
    hands_by_name = {procedure.characteristic.name: procedure for procedure in hand}
    return {
        "device": device,
        "errata_at": errata_at,
        "by_hand": hand,
        "characteristic_rows": [
            (
                code(characteristic.name),
                joined(
                    [
                        link("step by step", f"#by-hand-{characteristic.name}")
                        if characteristic.name in hands_by_name
                        else text(characteristic.value),
                        errata_at.named(f"characteristics.{characteristic.name}"),
                    ]
                ),
                code(characteristic.only),
                cited(characteristic.source),
            )
            for characteristic in device.characteristics
        ],
    }


def manual_values(device: Device) -> ManualPage:
    style = page_links.style_beside(device)
    tests = [edition_test(edition.revision, test) for edition in device.editions for test in edition.tests]
    return {
        "device": device,
        "manual_rows": [row for row in _manual_rows(device) if row[1]],
        "edition_rows": list(_edition_rows(device)),
        "edition_tests": [style.sentence(edition_test_text) for edition_test_text in tests],
        "lost_rows": [(text(figure.content), cited(figure.source)) for figure in device.lost_figures],
        "document_rows": fact_tables.document_rows(device.documents),
        "history_rows": [
            (
                text(history_revision.revision),
                history_revision.date,
                text(history_revision.changes),
                text(history_revision.hardware),
                text(history_revision.software),
            )
            for history_revision in device.manual.history
        ],
    }


def _manual_rows(device: Device) -> Iterator[tuple[str, str]]:
    manual = device.manual
    yield "Manual", text(manual.title)
    yield "Revision", revision(manual)
    yield "Language", text(language(manual.language))
    yield "Publisher", text(manual.publisher)
    yield "Transcribed", _times_read(device.times_read)
    for evidence in (grade(device), *basis(device)):
        yield evidence.label, STYLE.phrase(replace(evidence, label=""))
    yield "Manufacturer", text(device.manufacturer.title)
    for edition in manual.editions:
        about = [
            text(language(edition.language)),
            text(edition.title),
            f"revision {text(edition.revision)}",
            edition.date,
        ]
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

    def links(edition_name: str) -> str:
        erratum_names = (erratum.name for erratum in device.errata if erratum.edition == edition_name)
        return ", ".join(link(code(name), f"{page_links.ERRATA}#erratum-{name}") for name in erratum_names)

    for edition in device.editions:
        revision_name = edition.revision
        yield (
            text(revision_name),
            edition.date,
            links(f"before {revision_name}"),
            links(revision_name),
            ", ".join(map(code, edition.labels)),
        )


def revision(manual: Manual) -> str:
    return text(manual.revision) + (f" of {manual.date}" if manual.date else "")


def table_rows(table: Table) -> Rows:
    """Return the rows of a table from the manual."""
    return [tuple(map(text, row)) for row in table.rows]
