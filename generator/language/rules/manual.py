"""Rules for the manual: the form of cited sources, cited sections, pages and figures, and dates of revisions."""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from ...model import Revision
from ..document import Path, value_at
from ..keys_of_specs import WrittenManual, WrittenSection, WrittenSpec
from ..problems import DocumentReport, quoted, suggest_word
from ..written import LocatedPart
from .parts import is_explained_at
from .walk import is_placeholder, leaves_of, mapping, sources, texts_in_our_words

#: One citation, with or without the key of a document: ``6.4 p.35`` or ``errata: 2``.
_CITATION_WITH_KEY = re.compile(r"(?:(?P<key>[a-z][a-z0-9_]*):)?(?P<place>.*)")
#: The number of a section or table, such as ``6.4``, ``A.2`` or ``7-1``.
_NUMBER = r"(?:[A-Z]\.)?[0-9]+(?:[.-][0-9]+)*"
#: A heading, possibly with a number, such as ``Table 41``. It does not begin with the word for a page.
_HEADING = rf"(?!(?i:page|pag|pg|p)\b)[^\W\d_](?:[^\W\d_]|[ '&/()-])+(?: {_NUMBER})?"
#: A section by number, possibly with a table or figure in it, or by its heading.
_SECTION = rf"{_NUMBER}(?: (?:Table|Figure) {_NUMBER})?|{_HEADING}"
#: One page or several, such as ``p.35`` or ``p.35-36``.
_PAGE = r"p\.[0-9]+(?:-[0-9]+)?"
_CITED_PLACE = re.compile(rf"(?:{_SECTION})(?: {_PAGE})?|{_PAGE}")


def check_source_format(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that sources are well-formed, and that cited editions and documents are listed.

    A source has one or more places, separated by semicolons, each with an optional document: ``6.4 p.35; errata: 2``.
    """
    languages = [edition.part.language for edition in spec.with_invalid_parts.manual.editions if edition.part.language]
    documents = spec.with_invalid_parts.names_in("documents")
    language_of_manual = spec.with_invalid_parts.manual.language
    known_sources = _KnownSources(language_of_manual, languages, documents)
    for path, source_text in sources(leaves_of(spec.data, report)):
        for citation in source_text.split(";"):
            _check_form_of_citation(citation.strip(), path, known_sources, report)


class _KnownSources(NamedTuple):
    """The documents that a spec can cite: the manual, its editions in other languages, and other documents."""

    #: Language of the manual itself, which is cited without a key.
    language_of_manual: str
    #: Language of each other edition, which is its key.
    editions: list[str]
    #: Keys of other documents.
    documents: list[str]


def _check_form_of_citation(citation: str, path: Path, known_sources: _KnownSources, report: DocumentReport) -> None:
    """Check one citation of a source, such as ``6.4 p.35``, or ``errata: 2`` in the document with the key ``errata``.

    The form of the place, such as ``6.4 p.35``, is checked only in the manual and its editions.
    """
    # TODO marks a place that is still to be checked.
    citation_line = citation.replace("\n", " ").removeprefix("TODO ")
    match = _CITATION_WITH_KEY.fullmatch(citation_line)
    key, place_text = (match["key"], match["place"].strip()) if match is not None else (None, citation)
    possible_keys = [*known_sources.editions, *known_sources.documents]
    if key is not None and key == known_sources.language_of_manual:
        report.add("bad-source", path, f"{quoted(key)} is the language of the manual itself; remove '{key}:'")
    elif key is not None and key not in possible_keys:
        hint = suggest_word(key, possible_keys)
        report.add("undefined-reference", path, f"there is no edition or document {quoted(key)}{hint}")
    elif key in known_sources.documents and place_text:
        return  # Public documents have sections of every kind.
    elif not _CITED_PLACE.fullmatch(place_text):
        citation_text = quoted(citation) if citation else "empty text"
        valid_forms_text = (
            "cite a section ('6.4' or 'Cover'), a table ('Table 41'), a page ('p.35'), "
            "or a section or table followed by a page"
        )
        message = (
            f"{citation_text} is not a valid source; {valid_forms_text}. "
            "Separate several sources with semicolons, and prefix those in other documents with the document's key and"
            " a colon"
        )
        report.add("bad-source", path, message)


#: A section by number or heading, perhaps with a page: ``4.2 p.17`` or ``Cover``.
_CITED_SECTION_AND_PAGE = re.compile(r"(?P<section>[0-9]+(?:\.[0-9]+)*|[^\W\d_][^:;]*?)(?:\s+p\.(?P<page>[0-9]+))?")
_SECTION_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)*")
#: Page on which a section begins, and page on which it ends, if the table of contents does not say.
_FIRST_POSSIBLE_PAGE, _LAST_POSSIBLE_PAGE = 1, 10_000
#: Name under which the pages of a whole section are stored.
_WHOLE_SECTION = ""
#: A spec follows the custom of citing first pages if at least this many of its citations do, and at least this share of
#: the citations for which the first page is known.
_LEAST_CITATIONS, _LEAST_SHARE_OF_CITATIONS = 50, 0.98


@dataclass(frozen=True, slots=True)
class _LaterPage:
    """A citation of a page on which no section or entry begins, with the last page before it on which one begins."""

    path: Path
    section: str
    cited_page: int
    earlier_first_page: int


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
            is_page_in_section = _check_cited_page(
                section, page_text, page_ranges, enclosing_names, path=path, report=report
            )
            if not is_page_in_section:
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
                later_pages.append(_LaterPage(path, section, page, first_page_before))
    compared_count = first_page_count + len(later_pages)
    cites_first_pages = first_page_count >= max(_LEAST_CITATIONS, _LEAST_SHARE_OF_CITATIONS * compared_count)
    if cites_first_pages:
        _report_later_pages(later_pages, report)


def _report_later_pages(later_pages: list[_LaterPage], report: DocumentReport) -> None:
    """Report each citation of a page on which nothing begins, with the page to cite instead."""
    for citation in later_pages:
        problem = f"nothing in section {citation.section} begins on page {citation.cited_page}"
        remedy = f"cite p.{citation.earlier_first_page}, or p.{citation.earlier_first_page} and p.{citation.cited_page}"
        report.add("cited-place", citation.path, f"{problem}, and other sources cite first pages; {remedy}")


def _find_citations(source: str, document: str = "") -> list[re.Match[str]]:
    """Return a match for each section of a document that a source cites, with its groups ``section`` and ``page``.

    By default, it is the manual. The page is None if it is not cited. Citations of other documents, which begin with
    another key and a colon, and placeholders such as TODO are left out.
    """
    citations: list[re.Match[str]] = []
    for cited_place in places_in_document(source, document):
        match = _CITED_SECTION_AND_PAGE.fullmatch(cited_place)
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
    page_range_by_title: Mapping[str, tuple[int, int]], own_names: list[str], *, is_first_page_known: bool
) -> set[int]:
    """Return the pages that a source in a section can cite as the page on which its register or field begins.

    This is the first page of the entry with one of ``own_names``, the names that the manual prints for the register or
    field. Without such an entry, it is the first page of the section or of any entry in it. The result is empty if the
    table of contents does not say where the section begins.
    """
    for name in own_names:
        if name in page_range_by_title:
            first_page, _ = page_range_by_title[name]
            return {first_page}
    if not is_first_page_known:
        return set()
    return {first_page for first_page, _ in page_range_by_title.values()}


def _find_page_ranges(contents: Mapping[str, WrittenSection]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section in a table of contents, and of the entries in the section.

    For a section 4 with the entry "Preset", the result is ``{"4": {"": (12, 24), "preset": (13, 15)}}``. The last page
    is the page on which the next section or entry begins. A section whose page is not printed is between the nearest
    pages that are printed.
    """
    named_sections = list(contents.items())
    page_ranges: dict[str, dict[str, tuple[int, int]]] = {}
    page_reached = _FIRST_POSSIBLE_PAGE
    for index, (section_name, section) in enumerate(named_sections):
        following_sections = named_sections[index + 1 :]
        prefix_of_subsections = f"{section_name}."  # The subsections of 4 are 4.1, 4.2 and so on.
        subsections: list[WrittenSection] = []
        sections_after_it: list[WrittenSection] = []
        for following_name, following_section in following_sections:
            if following_name.startswith(prefix_of_subsections):
                subsections.append(following_section)
            else:
                sections_after_it.append(following_section)
        first_page = page_reached if section.page is None else section.page
        last_page = max(first_page, _first_printed_page(sections_after_it, default=_LAST_POSSIBLE_PAGE))
        page_ranges[section_name] = {_WHOLE_SECTION: (first_page, last_page)}
        # The entries of a section come before its subsections.
        last_page_of_entries = _first_printed_page(subsections, default=last_page)
        page_ranges[section_name] |= _page_ranges_of_entries(section, last_page_of_entries)
        page_reached = max([first_page, *section.entries.values()])
    return page_ranges


def _page_ranges_of_entries(section: WrittenSection, last_page: int) -> dict[str, tuple[int, int]]:
    """Return the first and the last page of each entry of a section, by its title in lower case.

    An entry ends on the page on which the next one begins. The last entry ends on ``last_page``.
    """
    first_pages = list(section.entries.values())
    next_pages = [*first_pages[1:], last_page]
    page_range_by_title: dict[str, tuple[int, int]] = {}
    for title, first_page, next_page in zip(section.entries, first_pages, next_pages, strict=False):
        page_range_by_title[title.casefold()] = (first_page, max(first_page, next_page))
    return page_range_by_title


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
    for step_count in range(1, len(path)):
        path_of_part = path[:step_count]
        part_data = value_at(spec_data, path_of_part)
        if isinstance(part_data, dict):
            # The name in the language of the manual, and the names in other languages.
            printed_names = (part_data.get("printed_name"), *mapping(part_data, "names").values())
            own_names = [name.casefold() for name in printed_names if isinstance(name, str)]
            enclosing_names = own_names + enclosing_names
    return own_names, enclosing_names


def _check_cited_page(
    section: str, page_text: str | None, page_ranges: _PageRanges, names: list[str], path: Path, report: DocumentReport
) -> bool:
    """Return True if a citation has a page, and the page is in the cited section. Report one that cannot be correct.

    If one of ``names``, the printed names around the source at ``path``, is the title of an entry in the section, the
    page must be in the range of this entry.
    """
    problem = _citation_problem(section, page_text, page_ranges, names)
    if problem:
        report.add("cited-place", path, problem)
    return not problem and section in page_ranges and page_text is not None


def _citation_problem(section: str, page_text: str | None, page_ranges: _PageRanges, names: list[str]) -> str:
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
    pages_text = _pages_in_words(first_page, last_page)
    return f"{cited_part} is {pages_text} according to the table of contents, not on page {page_text}"


def _pages_in_words(first_page: int, last_page: int) -> str:
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
    page_ranges = {name: {_WHOLE_SECTION: (_FIRST_POSSIBLE_PAGE, _LAST_POSSIBLE_PAGE)} for name in manual.contents}
    for edition in manual.editions:
        for path, source in sources(leaves_of(spec.data, report)):
            for citation in _find_citations(source, edition.part.language):
                problem = _citation_problem(citation.group("section"), citation.group("page"), page_ranges, names=[])
                if problem:
                    report.add("cited-place", path, problem)


def problems_of_other_manual(source: str, document: str, contents: Mapping[str, WrittenSection]) -> Iterator[str]:
    """Yield a message for each section or page that a source cites wrongly in the manual with this key and contents."""
    citations = _find_citations(source, document)
    if not citations:
        return
    page_ranges = _find_page_ranges(contents)
    for citation in citations:
        problem = _citation_problem(citation.group("section"), citation.group("page"), page_ranges, names=[])
        if problem:
            yield problem


#: The numbers in ``Figures 2 to 4 and 7``.
_FIGURE_NUMBERS = re.compile(r"\bFigures? (\d+(?:(?:, | and | to )\d+)*)\b")
#: A longer range of figures is compared only by its first and its last number.
_MOST_FIGURES = 1000


def check_figures(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a figure that a text names is listed under ``lost_figures``, the figures that were not available.

    Nothing is checked if the list contains no numbers of figures.
    """
    lost_numbers: set[int] = set()
    for figure in spec.lost_figures:
        lost_numbers.update(_figure_numbers(figure.part.content))
    for path, text in texts_in_our_words(spec, report):
        if not lost_numbers or path[0] == "lost_figures":
            continue
        unlisted_numbers = [number for number in _figure_numbers(text) if number not in lost_numbers]
        if unlisted_numbers:
            message = f"'lost_figures' has no Figure {unlisted_numbers[0]}; correct the number, or add the figure"
            report.add("figure-number", path, message)


def _figure_numbers(figure_text: str) -> Iterator[int]:
    """Yield the numbers of the figures that a text names: 2, 3, 4 and 7 for ``Figures 2 to 4 and 7``."""
    for listed_numbers in _FIGURE_NUMBERS.findall(figure_text):
        for number_or_range_text in re.split(", | and ", listed_numbers):
            first_text, _, last_text = number_or_range_text.partition(" to ")
            first_number = int(first_text)
            last_number = int(last_text) if last_text else first_number
            if last_number - first_number < _MOST_FIGURES:
                yield from range(first_number, last_number + 1)
            else:
                yield from (first_number, last_number)


def check_dates(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that dates exist, that revisions are in order, and that the transcribed revision has the manual's date."""
    _check_that_dates_exist(spec.manual, report)
    dated_history = [revision for revision in spec.manual.history if _parse_date(revision.part.date)]
    _check_order_of_revisions(dated_history, report)
    _check_date_in_history(spec.manual, dated_history, report)


def _check_that_dates_exist(manual: WrittenManual, report: DocumentReport) -> None:
    """Check that each date of the manual, its editions and its revisions exists. It may be empty or only a year."""
    dated_parts = [(manual.path, manual.date)]
    dated_parts += [(edition.path, edition.part.date) for edition in manual.editions]
    dated_parts += [(revision.path, revision.part.date) for revision in manual.history]
    for path, date in dated_parts:
        is_only_a_year = len(date) <= len("2024")  # or empty
        if not is_only_a_year and _parse_date(date) is None:
            report.add("date", (*path, "date"), f"{quoted(date)} is not a valid date")


def _check_order_of_revisions(dated_history: Sequence[LocatedPart[Revision]], report: DocumentReport) -> None:
    """Check that no revision of the history has an earlier date than the one before it."""
    for earlier, later in pairwise(dated_history):
        if later.part.date < earlier.part.date:
            message = (
                f"revision {later.part.revision} is dated {later.part.date}, before revision {earlier.part.revision},"
                f" dated {earlier.part.date}; list the oldest first"
            )
            report.add("date", (*later.path, "date"), message)


def _check_date_in_history(
    manual: WrittenManual, dated_history: Sequence[LocatedPart[Revision]], report: DocumentReport
) -> None:
    """Check that the revision table gives the manual's own revision the date of the manual, if it has both."""
    date_by_revision = {revision.part.revision: revision.part.date for revision in dated_history}
    date_in_history = date_by_revision.get(manual.revision)
    if date_in_history is None or not _parse_date(manual.date):
        return
    if date_in_history != manual.date:
        problem = f"revision {manual.revision} is dated {manual.date}, but {date_in_history} in 'history'"
        report.add("date", manual.path_of("date"), problem)


def _parse_date(date_text: str) -> datetime.date | None:
    """Return the date in a text such as 2024-05-31, or None if it is not a date."""
    try:
        return datetime.date.fromisoformat(date_text)
    except ValueError:
        return None


def check_revision_in_history(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the revision table of a manual lists the manual's own revision, unless an erratum explains it."""
    # A revision that is not text is reported by the schema, and can still be the right revision.
    listed_revisions = [str(row.data.get("revision")) for row in spec.with_invalid_parts.manual.history]
    revision = spec.manual.revision
    has_duplicates = len(set(listed_revisions)) < len(listed_revisions)  # Reported by another rule.
    if not listed_revisions or has_duplicates or not revision or revision in listed_revisions:
        return
    if is_explained_at(report.document, "manual", "history"):
        return
    problem = f"the manual has revision {quoted(revision)}, but its history lists {', '.join(listed_revisions)}"
    remedy = "correct one of the two, or add an erratum that affects manual.history if the manual prints this"
    report.add("revision-not-in-history", ("manual", "revision"), f"{problem}; {remedy}")
