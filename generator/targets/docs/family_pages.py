"""Pages of a family that are not about one interface: overview, hardware, manual and changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any, TypedDict

from ...model import Clocked, Device, Erratum, Interface, Manual, Release, ReleasedChange, Revision, Table
from ...order_codes.reduction import for_interface
from ...say import count_with_unit
from ...say.errata import STATUS_IN_WORDS, consequence
from ...say.names_and_evidence import (
    _second_reading_text,
    describe_evidence_basis,
    describe_grade,
    differences_from_manual,
    edition_test,
    other_editions,
)
from ...say.order_code import describe_settings
from ...say.text import (
    MARKDOWN,
    Statement,
    citation,
    code_span,
    escape,
    join_filled,
    language_name,
    link_list,
    markdown_link,
)
from . import fact_tables, masters_page, order_code_tables, verdict_page
from .interface_page import subjects
from .links_and_errata import (
    ERRATA,
    ErrataLines,
    errata_of_manual,
    interface_page_path,
    link_to_layout,
    link_to_procedure,
    page_in_folder,
    path_to_anchor,
    status_badge,
    style_in_folder,
)
from .order_code_page import ManualProcedure, OrderCodes, manual_procedures
from .order_code_tables import order_codes

_VERSION_RULE = (
    "Versions follow semantic versioning: major for changes that break code or alter its behaviour, minor for "
    "additions, patch for documentation. Before 1.0.0, the minor number marks breaking changes and the patch number "
    "all others. The version applies to the whole package. Versions without changes to this family are not listed."
)
_TITLES_BY_IMPACT = {
    "breaking": "Breaking",
    "behaviour": "Behaviour",
    "compatible": "Compatible",
    "documentation": "Documentation",
}
#: Highest number of documentation changes that a page lists. If there are more, it only gives their number.
_MOST_DOCUMENTATION_CHANGES = 10


class ChangesPage(TypedDict):
    device: Annotated[Device, "the family"]
    version: Annotated[str, "the version of the package"]
    manual: Annotated[str, "revision and date of the manual"]
    rule: Annotated[str, "rule that derives versions from changes"]
    releases: Annotated[
        list[dict[str, Any]], "the versions, the newest first: version, about, parts with title and lines"
    ]


def changes_file_name(device: Device) -> str:
    """Return the file name of the page with the changes."""
    return f"{device.name}-changes.md"


def changes_values(device: Device) -> ChangesPage:
    """Return the values of the page with the changes between releases."""
    return {
        "device": device,
        "version": device.manufacturer.version,
        "manual": revision_and_date(device.manual),
        "rule": _VERSION_RULE,
        "releases": [_release_section(release) for release in device.releases],
    }


def _release_section(release: Release) -> dict[str, Any]:
    """Return the changes in a release by their impact, followed by the names in code that have changed.

    If there are many changes to the documentation, only their number is given.
    """
    impact_sections: list[dict[str, Any]] = []
    for impact, title in _TITLES_BY_IMPACT.items():
        impact_changes = [change for change in release.changes if change.impact == impact]
        change_lines = [_change_line(change) for change in impact_changes]
        if impact == "documentation" and len(change_lines) > _MOST_DOCUMENTATION_CHANGES:
            change_lines = [f"{count_with_unit(len(change_lines), 'change')} to wording, sources, errata and examples"]
        if change_lines:
            impact_sections.append({"title": title, "lines": change_lines})
    if release.names:
        impact_sections.append({"title": "Names in code", "lines": [escape(name) for name in release.names]})
    introduction = f"Changes since {release.since}, with revision {release.manual} of the manual."
    return {"version": escape(release.version), "about": introduction, "parts": impact_sections}


def _change_line(change: ReleasedChange) -> str:
    """Return a change with its rule, and with the encoders and outputs that it affects."""
    encoders_and_outputs = join_filled([change.reach, change.outputs], "; ")
    return f"{escape(change.text)} ({code_span(change.rule)}): {escape(encoders_and_outputs)}"


Rows = list[tuple[str, ...]]


class FamilyPage(TypedDict):
    device: Annotated[Device, "the family"]
    origin: Annotated[list[Statement], "overlays and the edition of the family"]
    manual: Annotated[str, "the manual with its revision"]
    evidence: Annotated[Statement, "grade of the evidence"]
    errata_at: Annotated[Callable[..., str], "errata of one or more paths in the spec"]
    errata_count: Annotated[str, "number of errata"]
    wish_rows: Annotated[Rows, "tasks, and links to their instructions"]
    interface_rows: Annotated[Rows, "interface, order codes, clock or port, links to its registers and so on"]
    code_links: Annotated[list[tuple[str, list[str]]], "number of order codes of each interface, and links to them"]
    part_rows: Annotated[Rows, "parts of an order code and the meaning of each value"]
    spelling_rows: Annotated[Rows, "other spellings on labels"]
    measurement_rows: Annotated[Rows, "unit of the position"]
    changes_page: Annotated[str, "page that lists the changes in each version"]


class HardwarePage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_at: Annotated[Callable[..., str], "errata of one or more paths in the spec"]
    by_hand: Annotated[list[ManualProcedure], "the procedures by hand"]
    characteristic_rows: Annotated[Rows, "characteristics, mounting, safety"]


class ManualPage(TypedDict):
    device: Annotated[Device, "the family"]
    manual_rows: Annotated[Rows, "the manual: title, revision, language, publisher"]
    edition_rows: Annotated[Rows, "selectable editions, and their differences"]
    edition_tests: Annotated[list[str], "registers that identify an encoder of an older edition"]
    lost_rows: Annotated[Rows, "the figures that were not available"]
    document_rows: Annotated[Rows, "the documents that sources cite"]
    history_rows: Annotated[Rows, "the revisions of the manual"]


def index_values(family_codes: OrderCodes) -> FamilyPage:
    """Return the values of the overview page of a family."""
    device = family_codes.device
    return {
        "device": device,
        "origin": [*differences_from_manual(device), *other_editions(device)],
        "manual": f"{escape(device.manual.title)}, revision {revision_and_date(device.manual)}",
        "evidence": describe_grade(device),
        "errata_at": ErrataLines(device, f"{device.name}/"),
        "errata_count": f"{len(device.errata)}",
        "wish_rows": list(_task_rows(device)),
        "interface_rows": [_interface_row(device, interface) for interface in device.interfaces],
        "code_links": list(_order_code_links(family_codes)),
        "part_rows": list(order_code_tables.part_rows(device)),
        "spelling_rows": list(order_code_tables.spelling_rows(device)),
        "measurement_rows": list(order_code_tables.measurement_rows(device)),
        "changes_page": changes_file_name(device),
    }


def _interface_row(device: Device, interface: Interface) -> tuple[str, ...]:
    """Return a row of interface, order codes, clock or port, links to its further pages."""
    codes = [variant.code for variant in device.variants_over(interface.name)]
    # The first settings are the clocks of the master, or the port of a serial interface.
    setting_count = len(interface.clocks) if isinstance(interface, Clocked) else 1
    first_settings = list(describe_settings(device, interface))[:setting_count]
    return (
        markdown_link(interface.title, interface_page_path(device, interface)),
        order_codes(device, codes),
        "; ".join(map(MARKDOWN.phrase, first_settings)),
        ", ".join(_subject_links(device, interface)),
    )


def _subject_links(device: Device, interface: Interface) -> Iterator[str]:
    """Yield a link to each further page of an interface, such as the page about its registers."""
    for subject in subjects(device, interface.name):
        yield markdown_link(subject, f"{device.name}/{page_in_folder(interface.name, subject)}")


def _order_code_links(family_codes: OrderCodes) -> Iterator[tuple[str, list[str]]]:
    """Yield the number of order codes of each interface that has any, with links to their pages."""
    for interface in family_codes.device.interfaces:
        interface_codes = [variant.code for variant in family_codes.device.variants_over(interface.name)]
        if interface_codes:
            code_links = [family_codes.links[order_code] for order_code in interface_codes]
            yield f"{interface.title}: {count_with_unit(len(interface_codes), 'order code')}", code_links


def _task_rows(device: Device) -> Iterator[tuple[str, str]]:
    """Yield rows of task, links to the instructions for it. Tasks without instructions are omitted.

    Each procedure, including procedures carried out by hand, is a task with the title of the procedure.
    """
    frame_links = list(_position_frame_links(device))
    if frame_links:
        yield "Read the position", ", ".join(frame_links)
    yield "Check whether the position is usable", markdown_link("usable or not", verdict_page.file_name(device))
    for section_name, task in _TASKS_BY_SECTION.items():
        section_links = list(_section_links(device, section_name))
        if section_links:
            yield task, ", ".join(section_links)
    for procedure in device.procedures:
        yield escape(procedure.title), link_to_procedure(device, procedure)
    for manual_procedure in manual_procedures(device):
        path_to_steps = f"{device.name}/hardware.md#by-hand-{manual_procedure.characteristic.name}"
        yield escape(manual_procedure.title), markdown_link("by hand", path_to_steps)
    if device.characteristics:
        hardware_link = markdown_link("mounting and characteristics", f"{device.name}/hardware.md")
        yield "Mount it and look up its limits", hardware_link
    master_links = masters_page.page_links(device)
    if master_links:
        yield "Set up a BiSS or SSI master", "master settings: " + ", ".join(master_links)


def _position_frame_links(device: Device) -> Iterator[str]:
    """Yield a link to each frame with the position. If an interface has several, the links contain their names."""
    for interface in device.interfaces:
        layouts = [layout for layout in interface.layouts if device.sends_position(interface.name, layout)]
        for layout in layouts:
            frame_name = f" {code_span(layout.name)}" if len(layouts) > 1 else ""
            yield link_to_layout(device, layout, interface.title + frame_name)


#: Sections of an interface page, with the task that each one covers.
_TASKS_BY_SECTION = {
    "wiring": "Connect it",
    "leds": "Understand the LEDs",
    "alarms": "Clear an error or a warning",
}


def _section_links(device: Device, section_name: str) -> Iterator[str]:
    """Yield a link to a section, such as ``leds``, for each interface whose pages have this section."""
    for interface in device.interfaces:
        page_device = for_interface(device, interface.name)
        contents_by_section = {"wiring": page_device.connectors, "leds": page_device.leds, "alarms": page_device.alarms}
        if contents_by_section[section_name]:
            yield markdown_link(interface.title, path_to_anchor(device, interface.name, section_name))


def hardware_values(device: Device) -> HardwarePage:
    """Return the values of the page with the characteristics and the procedures carried out by hand."""
    errata_at = ErrataLines(device)
    return {
        "device": device,
        "errata_at": errata_at,
        "by_hand": manual_procedures(device),
        "characteristic_rows": list(_characteristic_rows(device, errata_at)),
    }


def _characteristic_rows(device: Device, errata_at: ErrataLines) -> Iterator[tuple[str, ...]]:
    """Yield rows of name, value or link to the steps, order codes, source for the characteristics."""
    names_with_steps = {procedure.characteristic.name for procedure in manual_procedures(device)}
    for characteristic in device.characteristics:
        name = characteristic.name
        has_steps = name in names_with_steps
        value_cell = markdown_link("step by step", f"#by-hand-{name}") if has_steps else escape(characteristic.value)
        errata_links = errata_at.links_in_cell(f"characteristics.{name}")
        yield (
            code_span(name),
            join_filled([value_cell, errata_links]),
            code_span(characteristic.only),
            citation(characteristic.source),
        )


def manual_values(device: Device) -> ManualPage:
    """Return the values of the page about the manual."""
    style = style_in_folder(device)
    test_statements = [edition_test(edition.revision, test) for edition in device.editions for test in edition.tests]
    return {
        "device": device,
        "manual_rows": [(label, content) for label, content in _manual_rows(device) if content],
        "edition_rows": list(_edition_rows(device)),
        "edition_tests": list(map(style.sentence, test_statements)),
        "lost_rows": [(escape(figure.content), citation(figure.source)) for figure in device.lost_figures],
        "document_rows": fact_tables.document_rows(device.documents),
        "history_rows": list(map(_history_row, device.manual.history)),
    }


def _history_row(revision: Revision) -> tuple[str, ...]:
    """Return a row of revision, date, changes, hardware, software for a revision of the manual."""
    return (
        escape(revision.revision),
        revision.date,
        escape(revision.changes),
        escape(revision.hardware),
        escape(revision.software),
    )


def _manual_rows(device: Device) -> Iterator[tuple[str, str]]:
    """Yield the facts about a manual as label and content. The content is empty if the spec does not state the fact."""
    manual = device.manual
    yield "Manual", escape(manual.title)
    yield "Revision", revision_and_date(manual)
    yield "Language", escape(language_name(manual.language))
    yield "Publisher", escape(manual.publisher)
    if device.manufacturer.website:
        yield "Website", escape(device.manufacturer.website)
    yield "Transcribed", _second_reading_text(device.times_read)
    for evidence_statement in (describe_grade(device), *describe_evidence_basis(device)):
        yield evidence_statement.label, MARKDOWN.phrase(replace(evidence_statement, label=""))
    yield "Manufacturer", escape(device.manufacturer.title)
    for edition in manual.editions:
        language_text = escape(language_name(edition.language))
        revision_text = f"revision {escape(edition.revision)}"
        yield "Other edition", join_filled([language_text, escape(edition.title), revision_text, edition.date], ", ")
    changes_link = markdown_link("changes", f"../{changes_file_name(device)}")
    yield "Version", f"{escape(device.manufacturer.version)}, {changes_link}"


def _edition_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of revision, date, differences before it, differences in it, labels for the editions of a manual."""
    for edition in device.editions:
        yield (
            escape(edition.revision),
            edition.date,
            _edition_errata(device, f"before {edition.revision}"),
            _edition_errata(device, edition.revision),
            ", ".join(map(code_span, edition.labels)),
        )


def _edition_errata(device: Device, edition_name: str) -> str:
    """Return links to the differences in an edition. ``edition_name`` is such as ``1.4`` or ``before 1.4``."""
    errata_links = []
    for erratum in device.errata:
        if erratum.edition == edition_name:
            path = f"{ERRATA}#erratum-{erratum.name}"
            errata_links.append(markdown_link(escape(erratum.title), path))
    return link_list(errata_links)


def revision_and_date(manual: Manual) -> str:
    """Return the revision of a manual, followed by its date if the spec states one: ``1.9 of 2021-12-09``."""
    date = f" of {manual.date}" if manual.date else ""
    return f"{escape(manual.revision)}{date}"


def table_rows(table: Table) -> Rows:
    """Return the rows of a table from the manual."""
    return [tuple(map(escape, row)) for row in table.rows]


class ErrataPage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_summary: Annotated[str, "number of errata and of open errata"]
    errata_by_kind: Annotated[
        list[tuple[str, list[dict[str, Any]]]],
        "status and impact, and its complete errata: erratum, summary, and a table of one row: head, cells",
    ]


def errata_values(device: Device) -> ErrataPage:
    """Return the values of the errata page of a family."""
    manual_errata = errata_of_manual(device)
    open_errata = [erratum for erratum in manual_errata if erratum.status == "open"]
    summary = _summary_of_counts(len(manual_errata), len(open_errata))
    return {
        "device": device,
        "errata_summary": summary + fact_tables.sentence_on_changes(len(device.errata) - len(manual_errata)),
        "errata_by_kind": [*_sections_by_status_and_impact(manual_errata), *_sections_of_changes(device.errata)],
    }


def _erratum_section(erratum: Erratum) -> dict[str, Any]:
    """Return one erratum for the errata page: a summary, and a table with a single row for its texts."""
    labels_and_texts = (*fact_tables.printed_and_used_rows(erratum), ("Why", escape(erratum.why)))
    # The labels become the head of the table, and the texts its only row.
    labels, texts = zip(*labels_and_texts, strict=True)
    affected_paths = ", ".join(map(code_span, erratum.affects))
    status_and_result = f"{status_badge(erratum)}: {consequence(erratum.severity)}."
    summary = f"{status_and_result} Affected parts of the spec: {affected_paths}. Source: {citation(erratum.source)}."
    return {"erratum": erratum, "summary": summary, "head": labels, "cells": texts}


def _summary_of_counts(erratum_count: int, open_count: int) -> str:
    """Return sentences that state how many errata there are, how many are open, and what that means."""
    if not erratum_count:
        return "No errata are known."
    sentences = ["There is 1 known erratum." if erratum_count == 1 else f"There are {erratum_count} known errata."]
    if open_count:
        verb = "is" if open_count == 1 else "are"
        sentences.append(f"{open_count} {verb} open, which means that only hardware or the manufacturer can decide.")
    resolved_count = erratum_count - open_count
    if resolved_count > 0:
        verb = "is" if resolved_count == 1 else "are"
        sentences.append(f"{resolved_count} {verb} resolved by the manual's own evidence or by arithmetic.")
    return " ".join(sentences)


def _sections_by_status_and_impact(listed_errata: Sequence[Erratum]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield a heading with its errata for each status and impact: open errata first, and wrong bytes before wording."""
    for status, status_word in STATUS_IN_WORDS.items():
        errata_of_status = [erratum for erratum in listed_errata if erratum.status == status]
        for severity in fact_tables.SEVERITIES:
            errata_of_severity = [erratum for erratum in errata_of_status if erratum.severity == severity]
            if errata_of_severity:
                heading = f"{status_word.capitalize()}: {fact_tables.severity_text(severity)}"
                yield escape(heading), list(map(_erratum_section, errata_of_severity))


def _sections_of_changes(listed_errata: Sequence[Erratum]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield a heading with its errata for the changes by overlays, and for the changes in other editions."""
    overlay_changes = [erratum for erratum in listed_errata if erratum.overlay]
    edition_changes = [erratum for erratum in listed_errata if erratum.edition and not erratum.overlay]
    for heading, changes in (("Overlays", overlay_changes), ("Other editions", edition_changes)):
        if changes:
            yield heading, list(map(_erratum_section, changes))
