"""Rules for cited places: sections and pages of the manual, and pages of other documents."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from ..document import Path, value_at
from ..problems import DocumentReport, quoted, suggest_word
from ..written_parts import WrittenSection, WrittenSpec
from .walk import is_placeholder, leaves_of, mapping, sources

#: A section by number or heading, perhaps with a page: ``4.2 p.17`` or ``Cover``.
_CITATION_PATTERN = re.compile(r"(?P<section>[0-9]+(?:\.[0-9]+)*|[^\W\d_][^:;]*?)(?:\s+p\.(?P<page>[0-9]+))?")
_SECTION_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)*")
#: Page on which a section begins, and page on which it ends, if the table of contents does not say.
_FIRST_POSSIBLE_PAGE, _LAST_POSSIBLE_PAGE = 1, 10_000
#: Name under which the pages of a whole section are stored.
_WHOLE_SECTION = ""
#: A spec follows the custom of citing first pages if at least this many of its citations do, and at least this share of
#: the citations for which the first page is known.
_LEAST_CITATIONS, _LEAST_SHARE = 50, 0.98


@dataclass(frozen=True, slots=True)
class _LaterPage:
    """A citation of a page on which no section or entry begins, with the last page before it on which one begins."""

    path: Path
    section: str
    page: int
    first_page: int


#: First and last page of each section, and of the entries in it, by the name of the section and the title of the entry.
#: The pages of a whole section have an empty title.
_PageRanges = Mapping[str, Mapping[str, tuple[int, int]]]


def check_cited_place(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every cited section is in the manual's table of contents, and that every cited page is in its section.

    If nearly all sources of the spec cite the page on which a section or entry begins, a source that cites only later
    pages is also reported.
    """
    contents = spec.with_invalid_parts.manual.contents
    if not contents:
        return
    page_ranges = _find_page_ranges(contents)
    first_page_count = 0
    later_pages: list[_LaterPage] = []
    for path, source in sources(leaves_of(spec.data, report)):
        own_names, enclosing_names = _printed_names(spec.data, path)
        citations = _find_citations(source)
        for citation in citations:
            section, page_text = citation.group("section", "page")
            is_in_section = _check_citation(section, page_text, page_ranges, enclosing_names, path=path, report=report)
            if not is_in_section:
                continue
            page = int(page_text)
            has_page = contents[section].page is not None
            first_pages = _first_pages(page_ranges[section], own_names, is_first_page_known=has_page)
            citations_of_section = [other for other in citations if other.group("section") == section]
            cited_pages = {int(other.group("page") or 0) for other in citations_of_section}
            if page in first_pages:
                first_page_count += 1
            elif first_pages and cited_pages.isdisjoint(first_pages):
                earlier_pages = [first_page for first_page in first_pages if first_page < page]
                first_page_before = max(earlier_pages, default=page)
                later_pages.append(_LaterPage(path, section, page=page, first_page=first_page_before))
    compared_count = first_page_count + len(later_pages)
    cites_first_pages = first_page_count >= max(_LEAST_CITATIONS, _LEAST_SHARE * compared_count)
    if cites_first_pages:
        _report_later_pages(later_pages, report)


def _report_later_pages(later_pages: list[_LaterPage], report: DocumentReport) -> None:
    """Report each citation of a page on which nothing begins, with the page to cite instead."""
    for citation in later_pages:
        problem = f"nothing in section {citation.section} begins on page {citation.page}"
        remedy = f"cite p.{citation.first_page}, or p.{citation.first_page} and p.{citation.page}"
        report.add("cited-place", citation.path, f"{problem}, and other sources cite first pages; {remedy}")


def _find_citations(source: str, document: str = "") -> list[re.Match[str]]:
    """Return a match for each section of a document that a source cites, with its groups ``section`` and ``page``.

    By default, it is the manual. The page is None if it is not cited. Citations of other documents, which begin with
    another key and a colon, and placeholders such as TODO are left out.
    """
    citations: list[re.Match[str]] = []
    for cited_place in places_in_document(source, document):
        match = _CITATION_PATTERN.fullmatch(cited_place)
        if match is not None and not is_placeholder(cited_place):
            citations.append(match)
    return citations


def places_in_document(source: str, document: str) -> list[str]:
    """Return the places that a source cites in the document with this key: ``["p.3"]`` for ``prot`` in ``prot: p.3``.

    The key of the manual is empty.
    """
    places: list[str] = []
    for citation in source.split(";"):
        key, colon, place = citation.partition(":")
        if colon and key.strip() == document:
            places.append(place.strip())
        elif not colon and not document:
            places.append(citation.strip())
    return places


def _first_pages(
    pages_of_section: Mapping[str, tuple[int, int]], own_names: list[str], *, is_first_page_known: bool
) -> set[int]:
    """Return the pages that a source in a section can cite as the page on which its register or field begins.

    This is the first page of the entry with one of ``own_names``, the names that the manual prints for the register or
    field. Without such an entry, it is the first page of the section or of any entry in it. The result is empty if the
    table of contents does not say where the section begins.
    """
    for name in own_names:
        if name in pages_of_section:
            first_page, _ = pages_of_section[name]
            return {first_page}
    if not is_first_page_known:
        return set()
    return {first_page for first_page, _ in pages_of_section.values()}


def _find_page_ranges(contents: Mapping[str, WrittenSection]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section in a table of contents, and of the entries in the section.

    For a section 4 with the entry "Preset", the result is ``{"4": {"": (12, 24), "preset": (13, 15)}}``. The last page
    is the page on which the next section or entry begins. A section whose page is not printed is between the nearest
    pages that are printed.
    """
    sections = list(contents.items())
    page_ranges: dict[str, dict[str, tuple[int, int]]] = {}
    latest_page = _FIRST_POSSIBLE_PAGE
    for index, (name, section) in enumerate(sections):
        prefix = f"{name}."  # The subsections of 4 are 4.1, 4.2 and so on.
        subsections: list[WrittenSection] = []
        later_sections: list[WrittenSection] = []
        for later_name, later_section in sections[index + 1 :]:
            if later_name.startswith(prefix):
                subsections.append(later_section)
            else:
                later_sections.append(later_section)
        first_page = latest_page if section.page is None else section.page
        last_page = max(first_page, _first_printed_page(later_sections, default=_LAST_POSSIBLE_PAGE))
        page_ranges[name] = {_WHOLE_SECTION: (first_page, last_page)}
        # The entries of a section come before its subsections.
        last_page_of_entries = _first_printed_page(subsections, default=last_page)
        entries = list(section.entries.items())
        next_pages = [*(page for _, page in entries[1:]), last_page_of_entries]
        for (title, entry_page), next_page in zip(entries, next_pages, strict=False):
            page_ranges[name][title.casefold()] = (entry_page, max(entry_page, next_page))
        latest_page = max([first_page, *section.entries.values()])
    return page_ranges


def _first_printed_page(sections: Iterable[WrittenSection], default: int) -> int:
    """Return the page of the first of these sections, or of its first entry, that has one, or else ``default``."""
    for section in sections:
        if section.page is not None:
            return section.page
        if section.entries:
            return next(iter(section.entries.values()))
    return default


def _printed_names(spec_data: object, path: Path) -> tuple[list[str], list[str]]:
    """Return the names that the manual prints for the part with the source at ``path``, and for all parts around it.

    The first list is empty if the part itself has no printed name. The second list includes the first one and begins
    with the innermost part. Names are in lower case, for comparison.
    """
    enclosing_names: list[str] = []
    own_names: list[str] = []
    for length in range(1, len(path)):
        path_of_part = path[:length]
        node = value_at(spec_data, path_of_part)
        if isinstance(node, dict):
            # The name in the language of the manual, and the names in other languages.
            printed_names = (node.get("printed_name"), *mapping(node, "names").values())
            own_names = [name.casefold() for name in printed_names if isinstance(name, str)]
            enclosing_names = own_names + enclosing_names
    return own_names, enclosing_names


def _check_citation(
    section: str, page_text: str | None, page_ranges: _PageRanges, names: list[str], path: Path, report: DocumentReport
) -> bool:
    """Return True if a citation has a page, and the page is in the cited section. Report one that cannot be correct.

    If one of ``names``, the printed names around the source at ``path``, is the title of an entry in the section, the
    page must be in the range of this entry.
    """
    problem = _problem_of_citation(section, page_text, page_ranges, names)
    if problem:
        report.add("cited-place", path, problem)
    return not problem and section in page_ranges and page_text is not None


def _problem_of_citation(section: str, page_text: str | None, page_ranges: _PageRanges, names: list[str]) -> str:
    """Return a message if the contents do not have the cited section, or not on this page, or otherwise ""."""
    if section not in page_ranges:
        if not _SECTION_NUMBER.fullmatch(section):
            return ""
        numbered_sections = [name for name in page_ranges if _SECTION_NUMBER.fullmatch(name)]
        return f"the contents have no section {quoted(section)}{suggest_word(section, numbered_sections)}"
    if page_text is None:
        return ""
    titles = [name for name in names if name in page_ranges[section]]
    innermost_title = titles[0] if titles else _WHOLE_SECTION
    first_page, last_page = page_ranges[section][innermost_title]
    if first_page <= int(page_text) <= last_page:
        return ""
    cited_part = f"the entry {quoted(innermost_title)} of section {section}" if titles else f"section {section}"
    pages = _pages_text(first_page, last_page)
    return f"{cited_part} is {pages} according to the table of contents, not on page {page_text}"


def _pages_text(first_page: int, last_page: int) -> str:
    """Return a range of pages as text, such as ``on pages 3 to 5``, or ``on page 3 or later`` if its end is unknown."""
    if last_page == _LAST_POSSIBLE_PAGE:
        return f"on page {first_page} or later"
    return f"on page {first_page}" if first_page == last_page else f"on pages {first_page} to {last_page}"


def check_editions_in_other_languages(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the sections cited in an edition in another language are in the table of contents.

    Such an edition has the same sections, but not always on the same pages.
    """
    manual = spec.with_invalid_parts.manual
    if not manual.contents:
        return
    sections = {name: {_WHOLE_SECTION: (_FIRST_POSSIBLE_PAGE, _LAST_POSSIBLE_PAGE)} for name in manual.contents}
    for edition in manual.editions:
        for path, source in sources(leaves_of(spec.data, report)):
            for citation in _find_citations(source, edition.part.language):
                problem = _problem_of_citation(citation.group("section"), citation.group("page"), sections, [])
                if problem:
                    report.add("cited-place", path, problem)


def problems_of_other_manual(source: str, document: str, contents: Mapping[str, WrittenSection]) -> Iterator[str]:
    """Yield a message for each section or page that a source cites wrongly in the manual with this key and contents."""
    citations = _find_citations(source, document)
    if not citations:
        return
    page_ranges = _find_page_ranges(contents)
    for citation in citations:
        problem = _problem_of_citation(citation.group("section"), citation.group("page"), page_ranges, [])
        if problem:
            yield problem


#: A page or a range of pages, such as ``30`` or ``9-14``.
_PAGES = re.compile(r"(?P<first>[0-9]{1,4})(?:-(?P<last>[0-9]{1,4}))?")
#: Pages in a text, such as ``p.9-14, 18 and 22``, and the number of all pages after them, such as ``of 66``.
_CITED_PAGES = re.compile(r"\bp\.([0-9]{1,4}(?:-[0-9]{1,4})?(?:(?:, | and )[0-9]{1,4}(?:-[0-9]{1,4})?)*)\b")
_ALL_PAGES = re.compile(r" of ([0-9]+)")


def check_listed_pages(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that sources cite only the pages that are listed for their document.

    They are listed under ``pages`` of the document, or in ``documents`` of ``evidence``, if that text has pages. Each
    page under ``pages`` must be cited, but not in overlays and older editions, which omit facts. Other pages can be
    evidence too.
    """
    is_derived = bool(report.document.family or report.document.other_files)
    for key, pages_read in spec.evidence.part.documents.items():
        path = ("evidence", "documents", key)
        last_page = _ALL_PAGES.search(pages_read)
        for page in _pages_in(pages_read):
            if last_page is not None and page > int(last_page[1]):
                report.add("cited-place", path, f"page {page} is after the last page, {last_page[1]}")
        _check_pages_cited(spec, "" if key == "manual" else key, path, pages_read, report)
    for key, document in spec.documents.items():
        path = ("documents", key, "pages")
        cited_pages = _check_pages_cited(spec, key, path, document.pages, report)
        if is_derived:
            continue
        for page in sorted(_pages_in(document.pages) - cited_pages):
            report.add("cited-place", path, f"no source cites page {page}; correct or remove it")


def _check_pages_cited(
    spec: WrittenSpec, document_key: str, list_path: Path, listed_text: str, report: DocumentReport
) -> set[int]:
    """Return the pages of a document that sources cite, and report each that is not among the pages in a text.

    Nothing is reported if the text has no pages, such as "all pages".
    """
    listed_pages = _pages_in(listed_text)
    cited_pages: set[int] = set()
    for path, source in sources(leaves_of(spec.data, report)):
        pages = set().union(*map(_pages_in, places_in_document(source, document_key)))
        cited_pages |= pages
        unlisted_pages = pages - listed_pages
        if listed_pages and unlisted_pages:
            line, _ = report.document.position(list_path)
            message = f"page {min(unlisted_pages)} is not among the pages in line {line}; correct one of the two"
            report.add("cited-place", path, message)
    return cited_pages


def _pages_in(text: str) -> set[int]:
    """Return the pages in a text, such as 9, 10 and 18 for ``p.9-10 and 18``."""
    page_numbers: set[int] = set()
    for pages_text in _CITED_PAGES.findall(text):
        for pages in _PAGES.finditer(pages_text):
            first_page = int(pages.group("first"))
            page_numbers.update(range(first_page, int(pages.group("last") or first_page) + 1))
    return page_numbers
