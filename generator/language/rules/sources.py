"""Rules for sources: cited sections, the evidence of a spec, the sources of limits and the manual's revisions."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from ...model import Evidence
from ..document import Path, is_placeholder, value_at
from ..problems import DocumentReport, join_words, quoted, suggest_word
from ..written import LocatedPart
from ..written_interfaces import WrittenBiss, WrittenSsi
from ..written_parts import WrittenExample, WrittenSection, WrittenSpec
from .parts import PlacedPart, WrittenInterface, by_name, clocks_of, has_erratum_at, interfaces
from .walk import leaves, leaves_of, mapping, sources

_CITATION_PATTERN = re.compile(r"(?P<section>[0-9]+(?:\.[0-9]+)*|[^\W\d_][^:;]*?)(?:\s+p\.(?P<page>[0-9]+))?")
_SECTION_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)*")
#: Page on which a section begins or ends if the contents do not say.
_PAGE_BEFORE_CONTENTS, _PAGE_AFTER_CONTENTS = 1, 10_000
#: Name under which the pages of a whole section are kept.
_WHOLE_SECTION = ""
#: A spec cites first pages if at least this many citations do, and this share of all with a known first page.
_LEAST_CITATIONS, _LEAST_SHARE = 50, 0.98


@dataclass(frozen=True, slots=True)
class _LaterPage:
    """A citation of a page on which nothing begins, with the last page before it on which something begins."""

    path: Path
    section: str
    page: int
    first_page: int


#: First and last page of each section, under an empty name, and of its entries by name.
_Spans = Mapping[str, Mapping[str, tuple[int, int]]]


def check_cited_place(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every cited section of the manual is in its contents, and every cited page in its section.

    In a spec whose sources cite the pages on which sections and entries begin, a source with only later pages is
    reported.
    """
    contents = spec.with_invalid_parts.manual.contents
    if not contents:
        return
    spans = _find_spans(contents)
    first_page_count = 0
    later_pages: list[_LaterPage] = []
    for path, source in sources(leaves_of(spec.data, report)):
        own_names, enclosing_names = _printed_names(spec.data, path)  # of the item with this source
        citations = _find_citations(source)
        for citation in citations:
            section = citation["section"]
            if not _is_in_section(section, citation["page"], path, spans, enclosing_names, report):
                continue
            page = int(citation["page"])
            first_pages = _first_pages(spans[section], own_names)
            cited_pages = {int(other["page"] or 0) for other in citations if other["section"] == section}
            if page in first_pages:
                first_page_count += 1
            elif first_pages and cited_pages.isdisjoint(first_pages):
                earlier_pages = [first_page for first_page in first_pages if first_page < page]
                later_pages.append(
                    _LaterPage(path=path, section=section, page=page, first_page=max(earlier_pages, default=page))
                )
    # Otherwise this spec does not follow the custom of citing first pages, so later pages are correct in it.
    compared_count = first_page_count + len(later_pages)
    first_pages_needed = max(_LEAST_CITATIONS, _LEAST_SHARE * compared_count)
    if first_page_count >= first_pages_needed:
        _report_later_pages(later_pages, report)


def _report_later_pages(later_pages: list[_LaterPage], report: DocumentReport) -> None:
    """Report each citation of a later page, with the first page to cite."""
    for later in later_pages:
        problem = f"nothing in section {later.section} begins on page {later.page}, and other sources cite first pages"
        remedy = f"cite p.{later.first_page}, or p.{later.first_page} and p.{later.page}"
        report.add("cited-place", later.path, f"{problem}; {remedy}")


def _find_citations(source: str) -> list[re.Match[str]]:
    """Return the matches of ``_CITATION_PATTERN`` for the sections of the manual that a source cites.

    Some have a page. Sources in other documents, which have a key before a colon, and placeholders are left out.
    """
    places = [piece.strip() for piece in source.split(";") if not is_placeholder(piece)]
    matches = [_CITATION_PATTERN.fullmatch(place) for place in places]
    return [match for match in matches if match is not None]


def _first_pages(spans: Mapping[str, tuple[int, int]], own_names: list[str]) -> set[int]:
    """Return the page on which the entry of an item begins, or else the first pages of its section and all its entries.

    ``spans`` belongs to one section, and ``own_names`` are the printed names of the item. The result is empty if the
    item has no entry, and the contents do not say where the section begins.
    """
    for name in own_names:
        if name in spans:
            first_page, _ = spans[name]
            return {first_page}
    section_start, _ = spans[_WHOLE_SECTION]
    if section_start <= _PAGE_BEFORE_CONTENTS:  # The contents do not say where it begins.
        return set()
    return {start for start, _ in spans.values()}


def _find_spans(contents: Mapping[str, WrittenSection]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section, under an empty name, and of its entries by name.

    For a section 4 with the entry Preset these are ``{"4": {"": (12, 24), "preset": (13, 15)}}``. The last page is the
    page on which the next section or entry begins. Without pages, a section lasts from ``_PAGE_BEFORE_CONTENTS``
    to ``_PAGE_AFTER_CONTENTS``.
    """
    sections = list(contents.items())
    page_spans: dict[str, dict[str, tuple[int, int]]] = {}
    for index, (name, section) in enumerate(sections):
        sections_after = sections[index + 1 :]
        prefix = f"{name}."  # The subsections of 4 are 4.1, 4.2 and so on.
        subsections = [inner for inner_name, inner in sections_after if inner_name.startswith(prefix)]
        later_sections = [later for later_name, later in sections_after if not later_name.startswith(prefix)]
        last_page = (
            _page_of_section(later_sections[0], _PAGE_AFTER_CONTENTS) if later_sections else _PAGE_AFTER_CONTENTS
        )
        page_spans[name] = {_WHOLE_SECTION: (_page_of_section(section, _PAGE_BEFORE_CONTENTS), last_page)}
        # The entries of a section come before its subsections.
        end_of_entries = _page_of_section(subsections[0], last_page) if subsections else last_page
        entries = list(section.entries.items())
        starts_after = [*(page for _, page in entries[1:]), end_of_entries]
        for (title, first_page), next_start in zip(entries, starts_after, strict=False):
            page_spans[name][title.casefold()] = (first_page, max(first_page, next_start))
    return page_spans


def _page_of_section(section: WrittenSection, default: int) -> int:
    """Return the page of a section, or a default if the contents do not give it."""
    return default if section.page is None else section.page


def _printed_names(root: object, path: Path) -> tuple[list[str], list[str]]:
    """Return the printed names of the item with a source, and of all items around it, the innermost first.

    The first list is empty if the innermost map has no printed names. Names are in lower case, for comparison.
    """
    enclosing_names: list[str] = []
    own_names: list[str] = []
    for end in range(1, len(path)):
        node = value_at(root, path[:end])
        if isinstance(node, dict):
            # The name in the language of the manual, and the names in other languages.
            printed_names = (node.get("printed_name"), *mapping(node, "names").values())
            own_names = [name.casefold() for name in printed_names if isinstance(name, str)]
            enclosing_names = own_names + enclosing_names
    return own_names, enclosing_names


def _is_in_section(
    section: str, page: str | None, path: Path, spans: _Spans, names: list[str], report: DocumentReport
) -> bool:
    """Return True if a page is given and is in its section, and report a section or page that cannot be right.

    If one of the names around the source is an entry of the section, the page must be the page of the entry.
    """
    if section not in spans:
        if _SECTION_NUMBER.fullmatch(section):
            numbered_sections = [name for name in spans if _SECTION_NUMBER.fullmatch(name)]
            hint = suggest_word(section, numbered_sections)
            report.add("cited-place", path, f"the contents have no section {quoted(section)}{hint}")
        return False
    if page is None:
        return False
    entries = [name for name in names if name in spans[section]]  # The innermost one is the first.
    entry = entries[0] if entries else _WHOLE_SECTION
    first_page, last_page = spans[section][entry]
    if first_page <= int(page) <= last_page:
        return True
    cited_part = f"the entry {quoted(entry)} of section {section}" if entries else f"section {section}"
    pages = _pages_text(first_page, last_page)
    report.add("cited-place", path, f"{cited_part} is {pages} according to the table of contents, not on page {page}")
    return False


def _pages_text(start: int, end: int) -> str:
    """Return pages as text, such as ``on pages 3 to 5``."""
    if end == _PAGE_AFTER_CONTENTS:
        return f"on page {start} or later"
    return f"on page {start}" if start == end else f"on pages {start} to {end}"


_CORROBORATED_STATES = ("corroborated", "corroborated, no hardware frame seen")
#: Grades that need data from real hardware, and the advice if there are no such data.
_WITH_FRAME = ("quoted", "corroborated")
_OR_CORROBORATED = "or write 'corroborated, no hardware frame seen'"
_ALL_PAGES = "all pages"
#: A source: the key of the cited document, and the place in it.
_SOURCE_PATTERN = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?(.*?)\s*", re.DOTALL)


def check_evidence(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the evidence supports the grade and lists each source once, and that each fact cites enough of them.

    Only the grades ``quoted`` and ``corroborated`` require a source for each fact.
    """
    stated = spec.evidence.part
    for index, key in enumerate(stated.implementations):
        if key in stated.documents or key in stated.implementations[:index]:
            problem = f"{quoted(key)} is listed twice; list each source once, so that it counts once"
            report.add("evidence-grade", ("evidence", "implementations", index), problem)
    _check_vectors(stated, by_name(spec.with_invalid_parts.examples), report)
    if not spec.evidence.is_valid("grade"):
        return
    for problem in _yield_missing_support(stated):
        report.add("evidence-grade", ("evidence", "grade"), f"the grade {quoted(stated.grade)} {problem}")
    if stated.grade == "quoted" or stated.grade in _CORROBORATED_STATES:
        _check_sources(spec, report)


def _check_vectors(stated: Evidence, examples: Mapping[str, WrittenExample], report: DocumentReport) -> None:
    """Check that the examples from hardware can show an error, and that one of them is data from an encoder.

    The second applies only to a grade that needs it, and if all of the examples exist.
    """
    for index, name in enumerate(stated.vectors):
        if name in examples and not _has_different_bits(examples[name]):
            problem = f"{quoted(name)} has the same bits throughout, so it cannot show an error; use another example"
            report.add("evidence-grade", ("evidence", "vectors", index), problem)
    are_known = bool(stated.vectors) and all(name in examples for name in stated.vectors)
    has_reading = are_known and any(_is_reading(examples[name]) for name in stated.vectors)
    if stated.grade in _WITH_FRAME and are_known and not has_reading:
        problem = f"the grade {quoted(stated.grade)} needs data from an encoder"
        remedy = "add a frame 'from: encoder' without 'refused', or a register reading"
        report.add(
            "evidence-grade", ("evidence", "vectors", 0), f"{problem}: {remedy}, {_OR_CORROBORATED} without 'vectors'"
        )


def _yield_missing_support(stated: Evidence) -> Iterator[str]:
    """Yield each reason that the evidence does not support its grade, such as what it needs, with the remedy."""
    grade = stated.grade
    documents_read = stated.documents
    implementations = stated.implementations
    has_source = bool(documents_read) or bool(implementations)
    if grade == "manual" and documents_read.get("manual") != _ALL_PAGES:
        yield f"needs the whole manual: write 'documents: {{manual: {_ALL_PAGES}}}', or another grade"
    if grade == "quoted" and not documents_read:
        yield "needs a document of the manufacturer: list it under 'documents', with the pages that were read"
    if grade == "quoted" and not implementations:
        yield "needs an implementation: list it under 'implementations'"
    if grade == "uncorroborated" and not has_source:
        yield "needs a source: list it under 'documents', with the pages that were read, or under 'implementations'"
    needed_implementations = 1 if documents_read else 2
    if grade in _CORROBORATED_STATES and len(implementations) < needed_implementations:
        yield "needs two sources that share no code: list them under 'implementations'"
    if grade in _WITH_FRAME and not stated.vectors:
        yield f"needs an example from real hardware: list it under 'vectors', {_OR_CORROBORATED}"
    _, grade_without_frame = _CORROBORATED_STATES
    if grade == grade_without_frame and stated.vectors:
        yield "has no vectors: remove them, or write 'corroborated'"


def _check_sources(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each fact cites the manufacturer or, for a corroborated grade, two implementations.

    A source without a key cites the manual. Errata and examples are not checked.
    """
    grade = spec.evidence.part.grade
    documents_read = spec.evidence.part.documents
    implementations = spec.evidence.part.implementations
    is_corroborated = grade in _CORROBORATED_STATES
    can_cite_two_implementations = is_corroborated and len(implementations) > 1
    if not documents_read and not can_cite_two_implementations:
        return  # Reported as missing.
    needed_sources = [f"a source in {join_words(documents_read, 'or')}"] if documents_read else []
    if can_cite_two_implementations:
        needed_sources.append(f"two sources among {join_words(implementations)}")
    for path, source in sources(leaves({**spec.data, "errata": [], "examples": []})):
        if is_corroborated and "clock" in path:
            continue  # One program is enough for its own clock. Another rule checks limits.
        # ``errata: 2`` has the key errata and the place 2, and ``6.4`` no key and the place 6.4.
        matches = [_SOURCE_PATTERN.fullmatch(piece) for piece in source.split(";")]
        keys_and_places = [(match[1], match[2]) for match in matches if match is not None]
        cited_keys = {key or "manual" for key, _ in keys_and_places}
        cites_manufacturer = not cited_keys.isdisjoint(documents_read)
        cites_two_implementations = is_corroborated and len(cited_keys.intersection(implementations)) > 1
        if not cites_manufacturer and not cites_two_implementations:
            problem = f"the grade {quoted(grade)} needs {', or '.join(needed_sources)} for each fact"
            places_without_key = [place for key, place in keys_and_places if not key]
            first_place = places_without_key[0] if places_without_key else ""
            report.add("evidence-grade", path, problem + _suggest_source(first_place, spec.documents))


def _suggest_source(cited_place: str, documents: Collection[str]) -> str:
    """Return how to write a source whose place lacks the key of a document, or an empty string without such a place."""
    if not cited_place:
        return ""
    if cited_place in documents:
        return f"; write {quoted(f'{cited_place}: PLACE')} with a place in that document"
    return f"; write {quoted(f'KEY: {cited_place}')} with the key of its document"


def _has_different_bits(example: WrittenExample) -> bool:
    """Return True if not all bits (or bytes) of an example are the same."""
    frame_text = example.bits or example.bytes
    is_bytes = " " in frame_text
    bits_or_bytes = frame_text.split() if is_bytes else list(frame_text)
    return len(set(bits_or_bytes)) > 1


def _is_reading(example: WrittenExample) -> bool:
    """Return True if an example is an accepted frame of the encoder or the content of a register."""
    is_frame = example.kind == "frame" and example.from_ == "encoder" and not example.refused
    return is_frame or example.kind == "register"


#: Grades with which every fact is in the manufacturer's words.
_IN_THE_MANUFACTURERS_WORDS = ("manual", "quoted")
#: The document that a source cites. Without a key, it is the manual.
_CITED_DOCUMENT = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?")


@dataclass(frozen=True, slots=True)
class _LimitKeys:
    """Keys of limits, and the alternative if no document of the manufacturer gives them."""

    keys: tuple[str, ...]
    alternative: str


@dataclass(frozen=True, slots=True)
class _Limited:
    """A part of a spec that can have limits, with its source, which it may inherit from the part around it."""

    part: PlacedPart
    source: str
    kind: _LimitKeys


_CLOCK_LIMITS = _LimitKeys(("min_hz", "max_hz"), "write 'used_hz' for a clock that a program or a master uses")
_TIMING_LIMITS = _LimitKeys(("at_least_us", "at_most_us"), "write 'typical_us', or describe the time in a 'note'")
_TIMEOUT_LIMITS = _LimitKeys(("at_most_ns",), "write 'typical_ns', or remove the time-out")
_CABLE_LIMITS = _LimitKeys(("below_hz",), "remove the table")
_SUPPLY_LIMITS = _LimitKeys(("min_mv", "max_mv"), "list the voltage in use under 'characteristics'")


def check_limit_sources(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that limits cite a document of the manufacturer if the grade does not require it for every fact."""
    grade = spec.evidence.part.grade
    documents_read = spec.evidence.part.documents
    if not spec.evidence.is_valid("grade") or grade in _IN_THE_MANUFACTURERS_WORDS:
        return
    listed_documents = f" ({join_words(documents_read, 'and')})" if documents_read else ""
    for limited in _yield_limited(spec):
        cited_keys = set()
        for piece in limited.source.split(";"):
            document = _CITED_DOCUMENT.match(piece)
            if document is not None:
                cited_keys.add(document[1] or "manual")  # A place without a key refers to the manual.
        given_limits = [key for key in limited.kind.keys if key in limited.part.data]
        if given_limits and cited_keys.isdisjoint(documents_read):
            needed_source = f"its source must be in 'documents' of 'evidence'{listed_documents}"
            new_document = (
                f"if {join_words(map(quoted, sorted(cited_keys)), 'or')} is by the manufacturer, add it there"
            )
            message = (
                f"{quoted(given_limits[0])} is a limit, so {needed_source}; {new_document}; "
                f"otherwise, {limited.kind.alternative}"
            )
            report.add("limit-source", (*limited.part.path, given_limits[0]), message, at_key=True)


def _yield_limited(spec: WrittenSpec) -> Iterator[_Limited]:
    """Yield each part of a spec that can have limits, with its own source or else its interface's source."""
    if spec.supply is not None:
        yield _Limited(spec.supply, _source_of_part(spec.supply), _SUPPLY_LIMITS)
    for timing in spec.timings:
        yield _Limited(timing, _source_of_part(timing), _TIMING_LIMITS)
    for _, interface in interfaces(spec):
        for part, kind in _limited_parts(interface):
            yield _Limited(part, _source_of_part(part) or interface.source, kind)


def _limited_parts(interface: WrittenInterface) -> Iterator[tuple[LocatedPart[object], _LimitKeys]]:
    """Yield the parts of an interface that can have limits, each with the keys for them."""
    for clock in clocks_of(interface):
        yield clock, _CLOCK_LIMITS
    for timeout in interface.timeout if isinstance(interface, WrittenBiss) else ():
        yield timeout, _TIMEOUT_LIMITS
    for timing in interface.timings:
        yield timing, _TIMING_LIMITS
    for cable_length in interface.cable_lengths if isinstance(interface, WrittenSsi) else ():
        yield cable_length, _CABLE_LIMITS


def _source_of_part(located_part: LocatedPart[object]) -> str:
    """Return the source of a part, or an empty string if it has none."""
    return str(located_part.source or "")


def check_revision_in_history(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the history of a manual lists its own revision, unless an erratum explains it."""
    # A revision that is not text is reported by the schema, and can still be the right revision.
    revisions = [str(history_row.data.get("revision")) for history_row in spec.with_invalid_parts.manual.history]
    revision = spec.manual.revision
    is_repeated = len(set(revisions)) < len(revisions)  # Reported by another rule.
    if not revisions or is_repeated or not revision or revision in revisions:
        return
    if has_erratum_at(report.document, "manual", "history"):
        return
    problem = f"the manual has revision {quoted(revision)}, but its history lists {', '.join(revisions)}"
    remedy = "correct one of the two, or add an erratum that affects manual.history if the manual prints this"
    report.add("revision-not-in-history", ("manual", "revision"), f"{problem}; {remedy}")


def check_open_quotation(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that double quotation marks in the printed text of an erratum come in pairs."""
    for erratum in spec.errata:
        has_open_quotation = erratum.printed.count('"') % 2 == 1
        if has_open_quotation:
            message = "a quotation mark is not closed; text between two quotation marks is a verbatim quotation"
            report.add("open-quotation", erratum.place_of("printed"), message)
