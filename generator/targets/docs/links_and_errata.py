"""Links between the pages of the documentation: to items, to errata next to the facts that they affect, and by name.

The pages and pictures are in the other modules, and ``files`` puts them together.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

from ...model import LEFT_OUT, NOT_KNOWN, Alarm, Device, Erratum, Interface, Layout, Procedure, Register, Ssi
from ...say.errata import STATUS_IN_WORDS, errata_affecting
from ...say.errata import describe_erratum as erratum_statement
from ...say.names_and_evidence import Titled, heading
from ...say.text import (
    MARKDOWN,
    Reference,
    Style,
    anchor_of,
    as_sentence,
    code_span,
    escape,
    escape_html,
    link_list,
    markdown_link,
    reference,
)

#: File name of the page with all errata of a family, in the folder of the family.
ERRATA = "errata.md"


#: First words of the anchors on the page about each subject of an interface.
ANCHORS_BY_SUBJECT = {
    "fields": ("group",),
    "registers": ("register",),
    "procedures": ("procedure", "alarm", "input"),
    "wiring": ("wiring", "connector", "led"),
    "examples": ("example",),
}


def subject_of(anchor: str) -> str:
    """Return the subject whose page contains an anchor, or an empty string for the page of the interface itself."""
    for subject, first_words in ANCHORS_BY_SUBJECT.items():
        if anchor.startswith(first_words):
            return subject
    return ""


def page_in_folder(interface_name: str, subject: str = "") -> str:
    """Return the file name of an interface page or, with a subject, of the page about it: ``biss-registers.md``."""
    return f"{interface_name}-{subject}.md" if subject else f"{interface_name}.md"


def interface_page_path(device: Device, interface: Interface) -> str:
    """Return the path to the page of an interface, such as ``FAMILY/biss.md``."""
    return f"{device.name}/{page_in_folder(interface.name)}"


def path_to_anchor(device: Device, interface_name: str, anchor: str) -> str:
    """Return the path to an anchor on a page of an interface, such as ``FAMILY/biss-registers.md#register-preset``."""
    return f"{device.name}/{page_in_folder(interface_name, subject_of(anchor))}#{anchor}"


def with_other_subjects_linked(interface_name: str, page_text: str) -> str:
    """Return the text of a page with the file name added to each link whose anchor is on another page of the interface.

    For example, ``#register-preset`` becomes ``biss-registers.md#register-preset``.
    """
    own_anchors = set(re.findall(r'<a id="([^"]+)">', page_text))

    def add_file_name(link: re.Match[str]) -> str:
        link_start, anchor = link.groups()
        file_name = "" if anchor in own_anchors else page_in_folder(interface_name, subject_of(anchor))
        return f"{link_start}{file_name}#{anchor}"

    # The start of a link in Markdown or HTML whose target is an anchor without a page.
    return re.sub(r'(\]\(|href=")#([\w.-]+)', add_file_name, page_text)


def link_to_register(device: Device, register: Register, label: str) -> str:
    """Return a link to a register on the page about the registers of its interface."""
    return markdown_link(label, path_to_anchor(device, register.interface, f"register-{register.name}"))


def link_to_layout(device: Device, layout: Layout, label: str) -> str:
    """Return a link to a frame on the page of its interface."""
    interface = next(interface for interface, device_layout in device.layouts() if device_layout.name == layout.name)
    return markdown_link(label, path_to_anchor(device, interface.name, f"layout-{layout.name}"))


def link_to_alarm(device: Device, interface: Interface, alarm: Alarm, label: str) -> str:
    """Return a link to an alarm on a page of an interface."""
    return markdown_link(label, path_to_anchor(device, interface.name, f"alarm-{alarm.name}"))


def link_to_procedure(device: Device, procedure: Procedure) -> str:
    """Return a link to a procedure, labeled with the interface that it uses."""
    interface = device.interface(procedure.interface)
    return markdown_link(interface.title, path_to_anchor(device, interface.name, f"procedure-{procedure.name}"))


def link_to_erratum(device: Device, erratum: Erratum) -> str:
    """Return a link to an erratum on the errata page of its family."""
    return markdown_link(escape(erratum.title), f"{device.name}/{ERRATA}#erratum-{erratum.name}")


def with_errata_linked(device: Device, page_path: str, page_text: str) -> str:
    """Return the text of a page with a link for each erratum that its sentences name, as in ``See erratum crc_start.``

    ``page_path`` is the path of the page. A link shows the title of the erratum.
    """
    if not device.errata:
        return page_text
    # Pages of the family are in its folder or next to it.
    is_in_folder = page_path.startswith(f"{device.name}/")
    path_to_folder = "" if is_in_folder else f"{device.name}/"
    title_by_erratum = {erratum.name: erratum.title for erratum in device.errata}
    # Longer names first, so that a name does not match the beginning of a longer one.
    names_longest_first = sorted(title_by_erratum, key=len, reverse=True)
    name_pattern = f"(?:{'|'.join(names_longest_first)})\\b"

    def link_name(name_match: re.Match[str]) -> str:
        erratum_name = name_match[0]
        return markdown_link(escape(title_by_erratum[erratum_name]), f"{path_to_folder}{ERRATA}#erratum-{erratum_name}")

    def link_names_in_mention(mention: re.Match[str]) -> str:
        return re.sub(name_pattern, link_name, mention[0])

    # "erratum" or "errata" with one or more names, separated by commas.
    mention_pattern = rf"\berrat(?:um|a)\s(?:{name_pattern}(?:, (?={name_pattern}))?)+"
    return re.sub(mention_pattern, link_names_in_mention, page_text)


def links_to_steps(folder: str, procedure_names: Iterable[str]) -> list[str]:
    """Return links to the manual procedures with these names. ``folder`` is the path to the folder of the family."""
    links = []
    for procedure_name in procedure_names:
        label = escape(f"Steps: {heading(procedure_name)}")
        links.append(markdown_link(label, f"{folder}hardware.md#by-hand-{procedure_name}"))
    return links


def style_in_folder(device: Device) -> Style:
    """Return the style for a page in the folder of a family. References to registers link to the register pages."""

    def reference_text(ref: Reference) -> str:
        """Return a link to the item. Only registers are on other pages."""
        for register in device.registers:
            if ref.anchor == f"register-{register.name}":
                page_name = page_in_folder(register.interface, "registers")
                return markdown_link(code_span(ref.name), f"{page_name}#{ref.anchor}")
        return reference(ref)

    return replace(MARKDOWN, ref=reference_text)


#: Longest text of an erratum, in characters, that is shown outside the errata page.
_LONGEST_TEXT = 240
Rows = list[tuple[str, ...]]


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
        affecting_errata = errata_affecting(self._device, *paths, wording=True)
        links = [f"{status_badge(erratum)} {self._link_in_cell(erratum)}" for erratum in affecting_errata]
        return link_list(dict.fromkeys(links))

    def _link_in_cell(self, erratum: Erratum) -> str:
        """Return a link to an erratum, or for a difference from another edition, ``not known before edition 1.4``."""
        if erratum.edition and not self._device.edition:
            difference_text = erratum.used if erratum.used in (NOT_KNOWN, LEFT_OUT) else "different"
            return self._link_to_erratum(erratum, f"{difference_text} {_edition_phrase(erratum)}")
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
        count_texts: list[str] = []
        link_texts: list[str] = []
        for status, mark in _MARK_BY_STATUS.items():
            status_word = STATUS_IN_WORDS[status]
            errata_of_status = [erratum for erratum in linked_errata if erratum.status == status]
            if errata_of_status:
                links_of_status = link_list(map(_html_link, errata_of_status))
                count_texts.append(f"{mark} {len(errata_of_status)} {status_word}")
                link_texts.append(f"{mark} {status_word}: {links_of_status}")
        if not link_texts:
            return ""
        return f"<details><summary>Errata: {', '.join(count_texts)}</summary>{' '.join(link_texts)}</details>"

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
    affecting_errata = errata_affecting(device, *paths, exactly=exactly, wording=True)
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
        reasons = map(MARKDOWN.sentence, erratum_statement(listed_erratum).statements_below)
        return " ".join([f"{status_and_title} {MARKDOWN.cited(listed_erratum.source)}:", *reasons])
    value_used = _shorten_sentences(as_sentence(listed_erratum.used))
    return f"{status_and_title}. Used: {escape(value_used)}"


def _shorten_sentences(sentences: str) -> str:
    """Return a text, shortened with an ellipsis after the last sentence, or else the last word, that fits."""
    if len(sentences) <= _LONGEST_TEXT:
        return sentences
    text_that_fits = sentences[:_LONGEST_TEXT]
    separator = ". " if ". " in text_that_fits else " "
    complete_sentences, _, _ = text_that_fits.rpartition(separator)
    return f"{complete_sentences} …"


def status_badge(erratum: Erratum) -> str:
    """Return the status of an erratum with a mark: ``⚠ **open**`` or ``✓ resolved``."""
    return "⚠ **open**" if erratum.status == "open" else f"✓ {STATUS_IN_WORDS[erratum.status]}"


def errata_of_manual(device: Device) -> list[Erratum]:
    """Return the errata about mistakes in the manual, without the changes by overlays and other editions."""
    return [erratum for erratum in device.errata if not (erratum.overlay or erratum.edition)]


def names_and_anchors_on_pages(device: Device, interface: Interface) -> Iterator[tuple[str, str]]:
    """Yield the names on the pages of an interface, in lowercase, with their anchors: ``("crc", "crc-x24")``.

    Names that have a section of their own come first. A name can occur several times.
    """
    for register in device.registers:
        yield from _names_with_anchor(register, f"register-{register.name}")
    for group in device.field_groups:
        yield from _names_with_anchor(group, f"group-{group.name}")
    for crc in device.crcs:
        yield "crc", f"crc-{crc.name}"
    if isinstance(interface, Ssi) and interface.output_code is not None and interface.output_code.code != "binary":
        # The section about frames mentions Gray code.
        yield "gray", "frames"
    for timing in interface.timings:
        yield timing.symbol.casefold(), "timings"
    for layout in interface.layouts:
        layout_anchor = f"layout-{layout.name}"
        for field in layout.fields:
            anchor = f"group-{field.group}" if field.group else layout_anchor
            yield from _names_with_anchor(field, anchor)
        # A join is a number that several fields form together.
        yield from ((join.name, layout_anchor) for join in layout.joins)
    for register in device.registers:
        for field in register.layout.fields:
            yield from _names_with_anchor(field, f"register-{register.name}")


def _names_with_anchor(titled: Titled, anchor: str) -> Iterator[tuple[str, str]]:
    """Yield the name of an item in the spec and its name in the manual, both in lowercase, with the anchor."""
    yield titled.name.replace("_", " "), anchor
    yield titled.printed_name.casefold(), anchor
