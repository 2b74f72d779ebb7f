"""Errata next to the facts that they affect, in full on a page for each family, and as a list for all families."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from typing import Annotated, Any, TypedDict

from ...model import LEFT_OUT, NOT_KNOWN, Device, Erratum
from ...say.errata import STATUS_IN_WORDS, consequence, errata
from ...say.errata import describe_erratum as erratum_statement
from ...say.markdown import MARKDOWN, anchor_of, citation, code_span, escape, escape_html, link_list, markdown_link
from ...say.text import as_sentence
from . import fact_tables
from .page_links import ERRATA, link_to_erratum

#: File name of the page about all families, which no family can have.
ALL_ERRATA = "all-errata.md"
#: Longest text of an erratum, in characters, that is shown outside the errata page.
_LONGEST_TEXT = 240
Rows = list[tuple[str, ...]]


class ErrataPage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_summary: Annotated[str, "number of errata and of open errata"]
    errata_by_kind: Annotated[
        list[tuple[str, list[dict[str, Any]]]],
        "status and impact, and its complete errata: erratum, summary, and a table of one row: head, cells",
    ]


class AllErrataPage(TypedDict):
    standings: Annotated[list[dict[str, Any]], "open errata, then resolved ones: title, anchor, rows"]


class ErrataLines:
    """Errata of one page: a full line at the first fact that an erratum affects, and links to this line after that."""

    def __init__(self, device: Device, folder: str = "") -> None:
        self._device = device
        self._page = f"{folder}{ERRATA}"
        self._names_on_page: set[str] = set()

    def __call__(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return a list of the errata that affect the parts of the spec at these paths, or anything inside them.

        All errata about wording share an item, and so do all differences from other editions.
        """
        manual_errata, edition_errata = _errata_by_origin(self._device, *paths, exactly=exactly)
        list_items = [self._erratum_line(erratum) for erratum in manual_errata if erratum.severity != "wording"]
        wording_errata = [erratum for erratum in manual_errata if erratum.severity == "wording"]
        if wording_errata:
            mistakes = "mistake" if len(wording_errata) == 1 else "mistakes"
            wording_links = link_list(map(self._title_link, wording_errata))
            list_items.append(f"- Wording {mistakes} in the manual: {wording_links}")
        if edition_errata:
            list_items.append(_edition_item(edition_errata, self._page))
        return "\n".join(list_items)

    def links_in_cell(self, *paths: str) -> str:
        """Return links for a table cell to the errata about these paths, including errata about wording."""
        affecting_errata = errata(self._device, *paths, wording=True)
        links = [f"{status_badge(erratum)} {self._link_in_cell(erratum)}" for erratum in affecting_errata]
        return link_list(dict.fromkeys(links))

    def _link_in_cell(self, erratum: Erratum) -> str:
        """Return a link to an erratum, or for a difference from another edition, ``not known before edition 1.4``."""
        if erratum.edition and not self._device.edition:
            state = erratum.used if erratum.used in (NOT_KNOWN, LEFT_OUT) else "different"
            return self._link_to_erratum(erratum, f"{state} {_edition_phrase(erratum)}")
        return self._title_link(erratum)

    def _title_link(self, erratum: Erratum) -> str:
        """Return a link to an erratum on the errata page, labeled with its title."""
        return self._link_to_erratum(erratum, erratum.title)

    def _link_to_erratum(self, erratum: Erratum, label: str) -> str:
        """Return a link to an erratum on the errata page. ``label`` is plain text."""
        return markdown_link(escape(label), f"{self._page}#erratum-{erratum.name}")

    def _erratum_line(self, erratum: Erratum) -> str:
        """Return an erratum as a list item: its text at the first mention on the page, or else a link to this text."""
        if erratum.name in self._names_on_page:
            first_mention = markdown_link(escape(erratum.title), f"#erratum-{erratum.name}")
            return f"- {status_badge(erratum)} {first_mention} (see above)"
        self._names_on_page.add(erratum.name)
        return f"- {anchor_of(f'erratum-{erratum.name}')}{erratum_line(erratum, self._page)}"


class ErrataLinks:
    """Errata of the page of an order code: links at the facts that they affect, and a list at the end of the page."""

    def __init__(self, device: Device) -> None:
        self._device = device
        #: Errata that the page has mentioned so far, by name: mistakes in the manual, and differences from editions.
        self._errata: dict[str, Erratum] = {}
        self._differences: dict[str, Erratum] = {}

    def __call__(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return one line of links to the errata about the parts of the spec at these paths, or anything inside them.

        Several links are folded under their number. Errata about wording are omitted. Differences from other editions
        are only remembered for ``list_of_errata``.
        """
        manual_errata, differences = _errata_by_origin(self._device, *paths, exactly=exactly)
        self._differences |= {difference.name: difference for difference in differences}
        return self._links_by_status([erratum for erratum in manual_errata if erratum.severity != "wording"])

    def links_about_bytes(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return links to the errata about these paths that can lead to wrong bytes on the wire."""
        manual_errata, _ = _errata_by_origin(self._device, *paths, exactly=exactly)
        return self._links_by_status([erratum for erratum in manual_errata if erratum.severity == "wrong_data"])

    def _links_by_status(self, linked_errata: Sequence[Erratum]) -> str:
        """Return links to errata for one cell, or "" without errata. Also add the errata to the list of the page.

        Several links are folded under the number of errata with each status.
        """
        self._errata |= {erratum.name: erratum for erratum in linked_errata}
        if len(linked_errata) == 1:
            (erratum,) = linked_errata
            title_link = markdown_link(escape(erratum.title), f"#erratum-{erratum.name}")
            return f"{_MARK_BY_STATUS[erratum.status]} {STATUS_IN_WORDS[erratum.status]}: {title_link}"
        counts: list[str] = []
        links: list[str] = []
        for status, mark in _MARK_BY_STATUS.items():
            status_word = STATUS_IN_WORDS[status]
            errata_of_status = [erratum for erratum in linked_errata if erratum.status == status]
            if errata_of_status:
                links_of_status = link_list(map(_html_link, errata_of_status))
                counts.append(f"{mark} {len(errata_of_status)} {status_word}")
                links.append(f"{mark} {status_word}: {links_of_status}")
        if not links:
            return ""
        return f"<details><summary>Errata: {', '.join(counts)}</summary>{' '.join(links)}</details>"

    def count_by_status(self) -> str:
        """Return the number of errata that the page has mentioned so far, such as ``1 open, 3 resolved``."""
        counts = Counter(erratum.status for erratum in self._errata.values())
        if counts:
            words_by_status = STATUS_IN_WORDS.items()
            return ", ".join(f"{counts[status]} {word}" for status, word in words_by_status if counts[status])
        return "none that change these facts" if self._device.errata else "none known"

    def list_of_errata(self) -> str:
        """Return a list of the errata that the page has mentioned so far, open errata first.

        The last item has links to the differences from other editions.
        """
        open_first = sorted(self._errata.values(), key=lambda erratum: erratum.status != "open")
        list_items = []
        for erratum in open_first:
            anchor = anchor_of(f"erratum-{erratum.name}")
            list_items.append(f"- {anchor}{erratum_line(erratum, ERRATA)}")
        # In the order of the spec, not of the page.
        differences = [difference for difference in self._device.errata if difference.name in self._differences]
        if differences:
            list_items.append(_edition_item(differences, ERRATA))
        return "\n".join(list_items)


def _html_link(erratum: Erratum) -> str:
    """Return a link in HTML, for a block that begins with HTML and therefore cannot contain Markdown."""
    return f'<a href="#erratum-{erratum.name}">{escape_html(erratum.title)}</a>'


def _edition_item(differences: Sequence[Erratum], page: str) -> str:
    """Return a list item with links to differences from other editions on ``page``, each edition once."""
    targets_by_edition: dict[str, list[str]] = {}
    for difference in differences:
        link_target = f"{page}#erratum-{difference.name}"
        targets_by_edition.setdefault(_edition_phrase(difference), []).append(link_target)
    editions = link_list(_numbered_links(label, targets) for label, targets in targets_by_edition.items())
    return f"- Other editions of the manual differ: {editions}"


def _numbered_links(label: str, targets: Sequence[str]) -> str:
    """Return the label as a link or, for several targets, the label followed by a numbered link to each of them."""
    if len(targets) == 1:
        return markdown_link(escape(label), targets[0])
    links = [markdown_link(f"{number}", target) for number, target in enumerate(targets, 1)]
    return f"{escape(label)} ({', '.join(links)})"


#: Marks in front of links to errata, by status.
_MARK_BY_STATUS = {"open": "⚠", "settled": "✓"}


def _errata_by_origin(device: Device, *paths: str, exactly: Collection[str]) -> tuple[list[Erratum], list[Erratum]]:
    """Return two lists of errata about the parts of a spec at these paths: mistakes, and differences from editions.

    If the device itself is another edition, all errata are in the first list.
    """
    affecting_errata = errata(device, *paths, exactly=exactly, wording=True)
    edition_errata = [erratum for erratum in affecting_errata if erratum.edition and not device.edition]
    manual_errata = [erratum for erratum in affecting_errata if erratum not in edition_errata]
    return manual_errata, edition_errata


def _edition_phrase(difference: Erratum) -> str:
    """Return the edition in which something differs as a phrase: ``before edition 1.4``."""
    label = erratum_statement(difference).label
    return f"{label[0].lower()}{label[1:]}"


def erratum_line(listed_erratum: Erratum, page: str) -> str:
    """Return the status, the title and the value used of an erratum. The title links to the full text on ``page``.

    A change by an overlay also has its reason and its source, which the users of a special model need.
    """
    title_link = markdown_link(escape(listed_erratum.title), f"{page}#erratum-{listed_erratum.name}")
    status_and_title = f"{status_badge(listed_erratum)} {title_link}"
    if listed_erratum.overlay:
        reasons = map(MARKDOWN.sentence, erratum_statement(listed_erratum).below)
        return " ".join([f"{status_and_title} {MARKDOWN.cited(listed_erratum.source)}:", *reasons])
    value_used = _shorten_sentences(as_sentence(listed_erratum.used))
    return f"{status_and_title}. Used: {escape(value_used)}"


def _shorten_sentences(sentences: str) -> str:
    """Return a text, shortened with an ellipsis after the last sentence, or else the last word, that fits."""
    if len(sentences) <= _LONGEST_TEXT:
        return sentences
    text_that_fits = sentences[:_LONGEST_TEXT]
    separator = ". " if ". " in text_that_fits else " "
    complete_part, _, _ = text_that_fits.rpartition(separator)
    return f"{complete_part} …"


def status_badge(erratum: Erratum) -> str:
    """Return the status of an erratum with a mark: ``⚠ **open**`` or ``✓ resolved``."""
    return "⚠ **open**" if erratum.status == "open" else f"✓ {STATUS_IN_WORDS[erratum.status]}"


def _errata_of_manual(device: Device) -> list[Erratum]:
    """Return the errata about mistakes in the manual, without the changes by overlays and other editions."""
    return [erratum for erratum in device.errata if not (erratum.overlay or erratum.edition)]


def page_values(device: Device) -> ErrataPage:
    """Return the values of the errata page of a family."""
    manual_errata = _errata_of_manual(device)
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
    head, cells = zip(*labels_and_texts, strict=True)
    affected = ", ".join(map(code_span, erratum.affects))
    result = f"{status_badge(erratum)}: {consequence(erratum.severity)}."
    summary = f"{result} Affected parts of the spec: {affected}. Source: {citation(erratum.source)}."
    return {"erratum": erratum, "summary": summary, "head": head, "cells": cells}


def _summary_of_counts(count: int, open_count: int) -> str:
    """Return sentences that state how many errata there are, how many are open, and what that means."""
    if not count:
        return "No errata are known."
    sentences = ["There is 1 known erratum." if count == 1 else f"There are {count} known errata."]
    if open_count:
        verb = "is" if open_count == 1 else "are"
        sentences.append(f"{open_count} {verb} open, which means that only hardware or the manufacturer can decide.")
    resolved_count = count - open_count
    if resolved_count > 0:
        verb = "is" if resolved_count == 1 else "are"
        sentences.append(f"{resolved_count} {verb} resolved by the manual's own evidence or by arithmetic.")
    return " ".join(sentences)


def _sections_by_status_and_impact(listed_errata: Sequence[Erratum]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield a heading with its errata for each status and impact: open errata first, and wrong bytes before wording."""
    for status, status_word in STATUS_IN_WORDS.items():
        errata_of_status = [erratum for erratum in listed_errata if erratum.status == status]
        for severity in fact_tables.SEVERITIES:
            errata_of_kind = [erratum for erratum in errata_of_status if erratum.severity == severity]
            if errata_of_kind:
                heading = f"{status_word.capitalize()}: {fact_tables.severity_text(severity)}"
                yield escape(heading), list(map(_erratum_section, errata_of_kind))


def _sections_of_changes(listed_errata: Sequence[Erratum]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield a heading with its errata for the changes by overlays, and for the changes in other editions."""
    overlay_changes = [erratum for erratum in listed_errata if erratum.overlay]
    edition_changes = [erratum for erratum in listed_errata if erratum.edition and not erratum.overlay]
    for heading, changes in (("Overlays", overlay_changes), ("Other editions", edition_changes)):
        if changes:
            yield heading, list(map(_erratum_section, changes))


def all_values(devices: Sequence[Device]) -> AllErrataPage:
    """Return the values of the page that lists the errata of all families."""
    titles = {"open": "Open: only hardware or the manufacturer can decide", "settled": "Resolved"}
    sections = []
    for status, title in titles.items():
        erratum_rows = list(_rows_of_all_families(devices, status))
        if erratum_rows:
            sections.append({"title": title, "anchor": status, "rows": erratum_rows})
    return {"standings": sections}


def _rows_of_all_families(devices: Sequence[Device], status: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of impact, family, title for the errata with this status, wrong bytes first and wording last."""
    for severity in fact_tables.SEVERITIES:
        for device in devices:
            for erratum in _errata_of_manual(device):
                if erratum.status == status and erratum.severity == severity:
                    yield (
                        escape(fact_tables.severity_text(severity)),
                        markdown_link(escape(device.name.upper()), f"{device.name}.md"),
                        link_to_erratum(device, erratum),
                    )
