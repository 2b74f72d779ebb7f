"""Rules for sources: cited sections, the evidence of a spec, the sources of limits, and quotations."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from ...model import Evidence
from ...model.clocks import CABLE_LIMITS
from ..document import Path, value_at
from ..problems import DocumentReport, join_words, quoted, suggest_word
from ..written import LocatedPart
from ..written_interfaces import WrittenBiss, WrittenSsi
from ..written_parts import WrittenExample, WrittenSection, WrittenSpec
from .parts import PlacedPart, WrittenInterface, by_name, clocks_of, interfaces
from .walk import is_placeholder, leaves, leaves_of, mapping, sources

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
            first_pages = _first_pages(page_ranges[section], own_names)
            citations_of_section = [other for other in citations if other["section"] == section]
            cited_pages = {int(other["page"] or 0) for other in citations_of_section}
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


def _find_citations(source: str) -> list[re.Match[str]]:
    """Return a match for each section of the manual that a source cites, with its groups ``section`` and ``page``.

    The page is None if it is not cited. Citations of other documents, which begin with a key and a colon, and
    placeholders such as TODO are left out.
    """
    citations: list[re.Match[str]] = []
    for cited_place in source.split(";"):
        match = _CITATION_PATTERN.fullmatch(cited_place.strip())
        if match is not None and not is_placeholder(cited_place):
            citations.append(match)
    return citations


def _first_pages(pages_of_section: Mapping[str, tuple[int, int]], own_names: list[str]) -> set[int]:
    """Return the pages that a source in a section can cite as the page on which its register or field begins.

    This is the first page of the entry with one of ``own_names``, the names that the manual prints for the register or
    field. Without such an entry, it is the first page of the section or of any entry in it. The result is empty if the
    table of contents does not say where the section begins.
    """
    for name in own_names:
        if name in pages_of_section:
            first_page, _ = pages_of_section[name]
            return {first_page}
    first_page_of_section, _ = pages_of_section[_WHOLE_SECTION]
    if first_page_of_section <= _FIRST_POSSIBLE_PAGE:  # The table of contents does not say where it begins.
        return set()
    return {first_page for first_page, _ in pages_of_section.values()}


def _find_page_ranges(contents: Mapping[str, WrittenSection]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section in a table of contents, and of the entries in the section.

    For a section 4 with the entry "Preset", the result is ``{"4": {"": (12, 24), "preset": (13, 15)}}``. The last page
    is the page on which the next section or entry begins. A section whose pages are not printed can be anywhere.
    """
    sections = list(contents.items())
    page_ranges: dict[str, dict[str, tuple[int, int]]] = {}
    for index, (name, section) in enumerate(sections):
        prefix = f"{name}."  # The subsections of 4 are 4.1, 4.2 and so on.
        subsections: list[WrittenSection] = []
        later_sections: list[WrittenSection] = []
        for later_name, later_section in sections[index + 1 :]:
            if later_name.startswith(prefix):
                subsections.append(later_section)
            else:
                later_sections.append(later_section)
        first_page = _page_of_first(section, default=_FIRST_POSSIBLE_PAGE)
        last_page = _page_of_first(*later_sections, default=_LAST_POSSIBLE_PAGE)
        page_ranges[name] = {_WHOLE_SECTION: (first_page, last_page)}
        # The entries of a section come before its subsections.
        last_page_of_entries = _page_of_first(*subsections, default=last_page)
        entries = list(section.entries.items())
        next_pages = [*(page for _, page in entries[1:]), last_page_of_entries]
        for (title, entry_page), next_page in zip(entries, next_pages, strict=False):
            page_ranges[name][title.casefold()] = (entry_page, max(entry_page, next_page))
    return page_ranges


def _page_of_first(*sections: WrittenSection, default: int) -> int:
    """Return the page of the first of these sections. If there are none, or it has no page, return ``default``."""
    if not sections or sections[0].page is None:
        return default
    return sections[0].page


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
    if section not in page_ranges:
        if _SECTION_NUMBER.fullmatch(section):
            numbered_sections = [name for name in page_ranges if _SECTION_NUMBER.fullmatch(name)]
            hint = suggest_word(section, numbered_sections)
            report.add("cited-place", path, f"the contents have no section {quoted(section)}{hint}")
        return False
    if page_text is None:
        return False
    titles = [name for name in names if name in page_ranges[section]]
    innermost_title = titles[0] if titles else _WHOLE_SECTION
    first_page, last_page = page_ranges[section][innermost_title]
    if first_page <= int(page_text) <= last_page:
        return True
    cited_part = f"the entry {quoted(innermost_title)} of section {section}" if titles else f"section {section}"
    pages = _pages_text(first_page, last_page)
    message = f"{cited_part} is {pages} according to the table of contents, not on page {page_text}"
    report.add("cited-place", path, message)
    return False


def _pages_text(first_page: int, last_page: int) -> str:
    """Return a range of pages as text, such as ``on pages 3 to 5``, or ``on page 3 or later`` if its end is unknown."""
    if last_page == _LAST_POSSIBLE_PAGE:
        return f"on page {first_page} or later"
    return f"on page {first_page}" if first_page == last_page else f"on pages {first_page} to {last_page}"


#: Grades of evidence, with and without data from real hardware, for which each fact needs the manufacturer's document
#: or two implementations.
_CORROBORATED_GRADES = ("corroborated", "corroborated, no hardware frame seen")
#: Grades that need data from real hardware, and the advice if there are no such data.
_GRADES_WITH_FRAME = ("quoted", "corroborated")
_OR_CORROBORATED = "or write 'corroborated, no hardware frame seen'"
_ALL_PAGES = "all pages"
#: A source: the key of the cited document, and the place in it.
_SOURCE_PATTERN = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?(.*?)\s*", re.DOTALL)


def check_evidence(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the evidence of a spec supports its grade, and that each fact cites the sources that the grade needs.

    Only the grades ``quoted`` and ``corroborated`` need a source for each fact.
    """
    evidence = spec.evidence.part
    for index, key in enumerate(evidence.implementations):
        is_repeated = key in evidence.documents or key in evidence.implementations[:index]
        if is_repeated:
            problem = f"{quoted(key)} is listed twice; list each source once, so that it counts once"
            report.add("evidence-grade", ("evidence", "implementations", index), problem)
    examples = by_name(spec.with_invalid_parts.examples)
    _check_examples(evidence, examples, report)
    if not spec.evidence.is_valid("grade"):
        return
    for problem in _yield_missing_support(evidence):
        report.add("evidence-grade", ("evidence", "grade"), f"the grade {quoted(evidence.grade)} {problem}")
    if evidence.grade == "quoted" or evidence.grade in _CORROBORATED_GRADES:
        _check_sources(spec, report)


def _check_examples(evidence: Evidence, examples: Mapping[str, WrittenExample], report: DocumentReport) -> None:
    """Check ``vectors``, the names of the examples that support the evidence, such as frames from real hardware.

    None of them may consist of equal bits. If the grade needs data from hardware, one must be data from an encoder.
    This is not checked if one of the examples does not exist.
    """
    for index, name in enumerate(evidence.vectors):
        if name in examples and not _has_different_bits(examples[name]):
            problem = f"{quoted(name)} has the same bits throughout, so it cannot show an error; use another example"
            report.add("evidence-grade", ("evidence", "vectors", index), problem)
    known_vectors = [examples[name] for name in evidence.vectors if name in examples]
    all_exist = bool(known_vectors) and len(known_vectors) == len(evidence.vectors)
    has_reading = any(map(_is_reading, known_vectors))
    if evidence.grade in _GRADES_WITH_FRAME and all_exist and not has_reading:
        message = (
            f"the grade {quoted(evidence.grade)} needs data from an encoder: add a frame 'from: encoder' without"
            f" 'refused', or a register reading, {_OR_CORROBORATED} without 'vectors'"
        )
        report.add("evidence-grade", ("evidence", "vectors", 0), message)


def _yield_missing_support(evidence: Evidence) -> Iterator[str]:
    """Yield each reason that the evidence of a spec does not support its grade, with the fix.

    Each text continues a sentence that begins with the grade, such as "needs an implementation: …".
    """
    grade = evidence.grade
    documents_read = evidence.documents
    implementations = evidence.implementations
    has_source = bool(documents_read or implementations)
    if grade == "manual" and documents_read.get("manual") != _ALL_PAGES:
        yield f"needs the whole manual: write 'documents: {{manual: {_ALL_PAGES}}}', or another grade"
    if grade == "quoted" and not documents_read:
        yield "needs a document of the manufacturer: list it under 'documents', with the pages that were read"
    if grade == "quoted" and not implementations:
        yield "needs an implementation: list it under 'implementations'"
    if grade == "uncorroborated" and not has_source:
        yield "needs a source: list it under 'documents', with the pages that were read, or under 'implementations'"
    needed_implementations = 1 if documents_read else 2
    if grade in _CORROBORATED_GRADES and len(implementations) < needed_implementations:
        yield "needs two sources that share no code: list them under 'implementations'"
    if grade in _GRADES_WITH_FRAME and not evidence.vectors:
        yield f"needs an example from real hardware: list it under 'vectors', {_OR_CORROBORATED}"
    _, grade_without_frame = _CORROBORATED_GRADES
    if grade == grade_without_frame and evidence.vectors:
        yield "has no vectors: remove them, or write 'corroborated'"


def _check_sources(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each fact cites a document of the manufacturer or, for a corroborated grade, two implementations.

    A source without a key before a colon cites the manual. Errata and examples are not checked.
    """
    grade = spec.evidence.part.grade
    documents_read = spec.evidence.part.documents
    implementations = spec.evidence.part.implementations
    is_corroborated = grade in _CORROBORATED_GRADES
    can_cite_two_implementations = is_corroborated and len(implementations) > 1
    if not documents_read and not can_cite_two_implementations:
        return  # Reported as missing.
    needed_sources: list[str] = []
    if documents_read:
        needed_sources.append(f"a source in {join_words(documents_read, 'or')}")
    if can_cite_two_implementations:
        needed_sources.append(f"two sources among {join_words(implementations)}")
    checked_data = {**spec.data, "errata": [], "examples": []}
    for path, source in sources(leaves(checked_data)):
        if is_corroborated and "clock" in path:
            continue  # One program is enough for its own clock. Another rule checks limits.
        # ``errata: 2`` has the key errata and the place 2, and ``6.4`` no key and the place 6.4.
        matches = [_SOURCE_PATTERN.fullmatch(citation) for citation in source.split(";")]
        keys_and_places = [(match[1], match[2]) for match in matches if match is not None]
        cited_keys = {key or "manual" for key, _ in keys_and_places}
        cites_manufacturer = not cited_keys.isdisjoint(documents_read)
        cites_two_implementations = is_corroborated and len(cited_keys.intersection(implementations)) > 1
        if not cites_manufacturer and not cites_two_implementations:
            needed_text = ", or ".join(needed_sources)
            places_without_key = [place for key, place in keys_and_places if not key]
            first_place = places_without_key[0] if places_without_key else ""
            suggestion = _suggest_source(first_place, spec.documents)
            message = f"the grade {quoted(grade)} needs {needed_text} for each fact{suggestion}"
            report.add("evidence-grade", path, message)


def _suggest_source(cited_place: str, documents: Collection[str]) -> str:
    """Return a suggestion for a source that cites a place without the key of its document, such as ``6.4 p.35``.

    If the place itself is the key of a document, the place in this document is missing. The result is empty if
    ``cited_place`` is empty.
    """
    if not cited_place:
        return ""
    if cited_place in documents:
        source_with_place = quoted(f"{cited_place}: PLACE")
        return f"; write {source_with_place} with a place in that document"
    source_with_key = quoted(f"KEY: {cited_place}")
    return f"; write {source_with_key} with the key of its document"


def _has_different_bits(example: WrittenExample) -> bool:
    """Return True if the bits (or bytes) of an example are not all equal."""
    frame_text = example.bits or example.bytes
    is_bytes = " " in frame_text
    bits_or_bytes = frame_text.split() if is_bytes else list(frame_text)
    return len(set(bits_or_bytes)) > 1


def _is_reading(example: WrittenExample) -> bool:
    """Return True if an example is a frame that an encoder sent and a decoder accepts, or the content of a register."""
    is_frame = example.kind == "frame" and example.from_ == "encoder" and not example.refused
    return is_frame or example.kind == "register"


#: Grades for which every fact is in the manufacturer's words.
_GRADES_FROM_MANUFACTURER = ("manual", "quoted")
#: The key of the document that a source cites. Without a key, it is the manual.
_DOCUMENT_KEY = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?")


@dataclass(frozen=True, slots=True)
class _LimitKeys:
    """Keys of limits, and what to write instead if no document of the manufacturer gives these limits."""

    keys: tuple[str, ...]
    alternative: str


@dataclass(frozen=True, slots=True)
class _LimitedPart:
    """A part of a spec that can have limits, with its source, which can be the source of its interface."""

    part: PlacedPart
    source: str
    limits: _LimitKeys


_CLOCK_LIMITS = _LimitKeys(("min_hz", "max_hz"), "write 'used_hz' for a clock that a program or a master uses")
_TIMING_LIMITS = _LimitKeys(("at_least_us", "at_most_us"), "write 'typical_us', or describe the time in a 'note'")
_TIMEOUT_LIMITS = _LimitKeys(("at_most_ns",), "write 'typical_ns', or remove the timeout")
_CABLE_LIMITS = _LimitKeys(CABLE_LIMITS, "remove the table")
_SUPPLY_LIMITS = _LimitKeys(("min_mv", "max_mv"), "list the voltage in use under 'characteristics'")


def check_limit_sources(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every limit, such as a highest clock, cites a document of the manufacturer.

    Specs of the grades ``manual`` and ``quoted`` are not checked, because all of their facts cite one.
    """
    grade = spec.evidence.part.grade
    manufacturer_documents = spec.evidence.part.documents
    if not spec.evidence.is_valid("grade") or grade in _GRADES_FROM_MANUFACTURER:
        return
    listed_documents = f" ({join_words(manufacturer_documents, 'and')})" if manufacturer_documents else ""
    for limited_part in _yield_limited_parts(spec):
        given_keys = [key for key in limited_part.limits.keys if key in limited_part.part.data]
        cited_documents = _cited_documents(limited_part.source)
        cites_manufacturer = not cited_documents.isdisjoint(manufacturer_documents)
        if given_keys and not cites_manufacturer:
            first_key = given_keys[0]
            cited_text = join_words(map(quoted, sorted(cited_documents)), "or")
            message = (
                f"{quoted(first_key)} is a limit, so its source must be in 'documents' of"
                f" 'evidence'{listed_documents}; if {cited_text} is by the"
                f" manufacturer, add it there; otherwise, {limited_part.limits.alternative}"
            )
            report.add("limit-source", (*limited_part.part.path, first_key), message, at_key=True)


def _cited_documents(source: str) -> set[str]:
    """Return the keys of the documents that a source cites. A place without a key is in the manual."""
    matches = [_DOCUMENT_KEY.match(cited_place) for cited_place in source.split(";")]
    return {match[1] or "manual" for match in matches if match is not None}


def _yield_limited_parts(spec: WrittenSpec) -> Iterator[_LimitedPart]:
    """Yield each part of a spec that can have limits, with its own source or otherwise that of its interface."""
    if spec.supply is not None:
        yield _LimitedPart(spec.supply, _source_of_part(spec.supply), _SUPPLY_LIMITS)
    for timing in spec.timings:
        yield _LimitedPart(timing, _source_of_part(timing), _TIMING_LIMITS)
    for _, interface in interfaces(spec):
        for part, limits in _limited_parts_of_interface(interface):
            yield _LimitedPart(part, _source_of_part(part) or interface.source, limits)


def _limited_parts_of_interface(interface: WrittenInterface) -> Iterator[tuple[LocatedPart[object], _LimitKeys]]:
    """Yield the parts of an interface that can have limits, each with the keys of these limits."""
    for clock in clocks_of(interface):
        yield clock, _CLOCK_LIMITS
    for timing in interface.timings:
        yield timing, _TIMING_LIMITS
    if isinstance(interface, WrittenBiss):
        for timeout in interface.timeout:
            yield timeout, _TIMEOUT_LIMITS
    if isinstance(interface, WrittenSsi):
        for cable_length in interface.cable_lengths:
            yield cable_length, _CABLE_LIMITS


def _source_of_part(located_part: LocatedPart[object]) -> str:
    """Return the source of a part, or an empty string if it has none."""
    return str(located_part.source or "")


def check_open_quotation(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that double quotation marks come in pairs in ``printed``, the manual's text that an erratum corrects."""
    for erratum in spec.errata:
        if erratum.printed.count('"') % 2 == 1:
            message = "a quotation mark is not closed; text between two quotation marks is a verbatim quotation"
            report.add("open-quotation", erratum.place_of("printed"), message)
