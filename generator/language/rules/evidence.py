"""Rules for the evidence of a spec: its grade, the pages read, sources of limits, examples and quotations."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ...model import Evidence
from ...model.interface_parts import CABLE_LIMITS
from ..document import Path
from ..keys_of_order_codes import WrittenBiss, WrittenSsi
from ..keys_of_specs import WrittenExample, WrittenSpec
from ..problems import DocumentReport, join_words, quoted
from ..written import LocatedPart
from .manual import places_in_document
from .parts import (
    FieldList,
    FieldOwner,
    PlacedPart,
    WrittenInterface,
    by_name,
    clocks_of,
    interfaces,
    layouts_of_interfaces,
    readable_names,
)
from .references import NameResolver
from .walk import is_derived, leaves, leaves_of, sources

#: Grades of evidence, with and without data from real hardware, for which each fact needs the manufacturer's document
#: or two implementations.
_GRADE_WITHOUT_HARDWARE_DATA = "corroborated, no hardware frame seen"
_CORROBORATED_GRADES = ("corroborated", _GRADE_WITHOUT_HARDWARE_DATA)
#: Grades that need data from real hardware, and the advice if there are no such data.
_GRADES_WITH_HARDWARE_DATA = ("quoted", "corroborated")
_ADVICE_WITHOUT_HARDWARE_DATA = f"or write '{_GRADE_WITHOUT_HARDWARE_DATA}'"
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
    example_by_name = by_name(spec.with_invalid_parts.examples)
    _check_supporting_examples(evidence, example_by_name, report)
    if not spec.evidence.is_valid("grade"):
        return
    for problem in _yield_missing_support(evidence):
        report.add("evidence-grade", ("evidence", "grade"), f"the grade {quoted(evidence.grade)} {problem}")
    if evidence.grade == "quoted" or evidence.grade in _CORROBORATED_GRADES:
        _check_sources(spec, report)


def _check_supporting_examples(
    evidence: Evidence, example_by_name: Mapping[str, WrittenExample], report: DocumentReport
) -> None:
    """Check ``vectors``, the names of the examples that support the evidence, such as frames from real hardware.

    None of them may consist of equal bits. If the grade needs data from hardware, one must be data from an encoder.
    This is not checked if one of the examples does not exist.
    """
    for index, name in enumerate(evidence.vectors):
        if name in example_by_name and not _has_different_bits(example_by_name[name]):
            problem = f"{quoted(name)} has the same bits throughout, so it cannot show an error; use another example"
            report.add("evidence-grade", ("evidence", "vectors", index), problem)
    known_vectors = [example_by_name[name] for name in evidence.vectors if name in example_by_name]
    all_exist = bool(known_vectors) and len(known_vectors) == len(evidence.vectors)
    has_data_from_encoder = any(map(_is_data_from_encoder, known_vectors))
    if evidence.grade in _GRADES_WITH_HARDWARE_DATA and all_exist and not has_data_from_encoder:
        message = (
            f"the grade {quoted(evidence.grade)} needs data from an encoder: add a frame 'from: encoder' without"
            f" 'refused', or a register reading, {_ADVICE_WITHOUT_HARDWARE_DATA} without 'vectors'"
        )
        report.add("evidence-grade", ("evidence", "vectors", 0), message)


def _yield_missing_support(evidence: Evidence) -> Iterator[str]:
    """Yield each reason that the evidence of a spec does not support its grade, with the fix.

    Each text continues a sentence that begins with the grade, such as "needs an implementation: …".
    """
    grade = evidence.grade
    documents_read = evidence.documents
    implementations = evidence.implementations
    has_any_source = bool(documents_read or implementations)
    if grade == "manual" and documents_read.get("manual") != _ALL_PAGES:
        yield f"needs the whole manual: write 'documents: {{manual: {_ALL_PAGES}}}', or another grade"
    if grade == "quoted" and not documents_read:
        yield "needs a document of the manufacturer: list it under 'documents', with the pages that were read"
    if grade == "quoted" and not implementations:
        yield "needs an implementation: list it under 'implementations'"
    if grade == "uncorroborated" and not has_any_source:
        yield "needs a source: list it under 'documents', with the pages that were read, or under 'implementations'"
    needed_implementation_count = 1 if documents_read else 2
    if grade in _CORROBORATED_GRADES and len(implementations) < needed_implementation_count:
        yield "needs two sources that share no code: list them under 'implementations'"
    if grade in _GRADES_WITH_HARDWARE_DATA and not evidence.vectors:
        yield f"needs an example from real hardware: list it under 'vectors', {_ADVICE_WITHOUT_HARDWARE_DATA}"
    if grade == _GRADE_WITHOUT_HARDWARE_DATA and evidence.vectors:
        yield "has no vectors: remove them, or write 'corroborated'"


def _check_sources(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each fact cites a document of the manufacturer or, for a corroborated grade, two implementations.

    Errata and examples are not checked.
    """
    grade = spec.evidence.part.grade
    documents_read = spec.evidence.part.documents
    implementations = spec.evidence.part.implementations
    is_corroborated = grade in _CORROBORATED_GRADES
    two_implementations_suffice = is_corroborated and len(implementations) > 1
    if not documents_read and not two_implementations_suffice:
        return  # Reported as missing.
    needed_sources: list[str] = []
    if documents_read:
        needed_sources.append(f"a source in {join_words(documents_read, 'or')}")
    if two_implementations_suffice:
        needed_sources.append(f"two sources among {join_words(implementations)}")
    needed_text = ", or ".join(needed_sources)
    checked_data = {**spec.data, "errata": [], "examples": []}
    for path, source in sources(leaves(checked_data)):
        if is_corroborated and "clock" in path:
            continue  # One program is enough for its own clock. Another rule checks limits.
        citations = _split_citations(source)
        cited_keys = {citation.document_key or "manual" for citation in citations}
        cites_manufacturer = not cited_keys.isdisjoint(documents_read)
        cites_two_implementations = is_corroborated and len(cited_keys.intersection(implementations)) > 1
        if not cites_manufacturer and not cites_two_implementations:
            places_without_key = [citation.place for citation in citations if not citation.document_key]
            first_place = places_without_key[0] if places_without_key else ""
            suggestion = _suggest_source(first_place, spec.documents)
            message = f"the grade {quoted(grade)} needs {needed_text} for each fact{suggestion}"
            report.add("evidence-grade", path, message)


class _Citation(NamedTuple):
    """A citation of a source: the key of the document, which is empty for the manual, and the place in it."""

    document_key: str
    place: str


def _split_citations(source: str) -> list[_Citation]:
    """Return the citations of a source: ``("", "6.4")`` and ``("errata", "2")`` for ``6.4; errata: 2``."""
    citations: list[_Citation] = []
    for citation_text in source.split(";"):
        match = _SOURCE_PATTERN.fullmatch(citation_text)
        if match is not None:
            citations.append(_Citation(document_key=match[1] or "", place=match[2]))
    return citations


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


def _is_data_from_encoder(example: WrittenExample) -> bool:
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

    limit_keys: tuple[str, ...]
    alternative_text: str


@dataclass(frozen=True, slots=True)
class _LimitedPart:
    """A part of a spec that can have limits, with its source, which can be the source of its interface."""

    placed_part: PlacedPart
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
        given_keys = [key for key in limited_part.limits.limit_keys if key in limited_part.placed_part.data]
        cited_documents = _cited_documents(limited_part.source)
        cites_manufacturer = not cited_documents.isdisjoint(manufacturer_documents)
        if given_keys and not cites_manufacturer:
            first_key = given_keys[0]
            cited_text = join_words(map(quoted, sorted(cited_documents)), "or")
            message = (
                f"{quoted(first_key)} is a limit, so its source must be in 'documents' of"
                f" 'evidence'{listed_documents}; if {cited_text} is by the"
                f" manufacturer, add it there; otherwise, {limited_part.limits.alternative_text}"
            )
            report.add("limit-source", (*limited_part.placed_part.path, first_key), message, at_key=True)


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
            report.add("open-quotation", erratum.path_of("printed"), message)


def check_example_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that everything that examples name exists, such as procedures, layouts, fields and errata."""
    resolver = NameResolver(spec, report)
    layout_by_name = {frame.name: frame for frame in layouts_of_interfaces(spec.with_invalid_parts) if frame.name}
    for example in spec.examples:
        resolver.check_optional_name(example.path_of("procedure"), "procedure", example.procedure)
        resolver.check_optional_name(example.path_of("erratum"), "erratum", example.erratum)
        resolver.check_optional_name(example.path_of("register"), "register", example.register)
        resolver.check_optional_name(example.path_of("crc"), "CRC", example.crc)
        resolver.check_optional_name(example.path_of("layout"), "layout", example.layout, known_names=layout_by_name)
        procedure = resolver.procedures.get(example.procedure)
        if procedure is not None:
            noun = f"argument of {quoted(example.procedure)} called"
            known_arguments = by_name(procedure.arguments)
            for name in example.arguments:
                resolver.check_name((*example.path, "arguments", name), noun, name, known_names=known_arguments)
        _check_example_values(example, layout_by_name, resolver)


def _check_example_values(
    example: WrittenExample, layout_by_name: Mapping[str, FieldList], resolver: NameResolver
) -> None:
    """Check that the layout or register of an example has the fields whose values the example gives."""
    field_list = layout_by_name.get(example.layout)
    if field_list is None and example.register in resolver.registers:
        register = resolver.registers[example.register]
        field_list = FieldList(FieldOwner.REGISTER, register, interface="")
    if field_list is not None:
        known_fields = readable_names(field_list, resolver.groups)
        for name in example.values:
            resolver.check_name((*example.path, "values", name), "field", name, known_names=known_fields)


#: Several bytes in hexadecimal in a text, such as ``32h 10h 01h`` or ``32 10 01``.
_BYTES_IN_TEXT = re.compile(r"\b[0-9A-F]{2}h?(?: [0-9A-F]{2}h?){2,}\b")


def check_bytes_in_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bytes that an erratum quotes are the bytes of an example that names the erratum.

    Only as many bytes as the example has are compared. If the erratum quotes several frames of this length, one of them
    must be the example.
    """
    erratum_by_name = by_name(spec.errata)
    for example in spec.examples:
        erratum = erratum_by_name.get(example.erratum)
        example_bytes = example.bytes.upper().split()
        if erratum is None or not example_bytes:
            continue
        quoted_frames: list[list[str]] = []
        for bytes_text in _BYTES_IN_TEXT.findall(erratum.printed):
            quoted_frames.append(bytes_text.replace("h", "").split())
        frames_of_length = [frame for frame in quoted_frames if len(frame) == len(example_bytes)]
        if frames_of_length and example_bytes not in frames_of_length:
            message = (
                f"the text has the bytes {quoted(' '.join(frames_of_length[0]))}, but the example"
                f" {quoted(example.name)} has {quoted(example.bytes)}; correct one of the two"
            )
            report.add("left-behind", erratum.path_of("printed"), message)


#: A page or a range of pages, such as ``30`` or ``9-14``.
_PAGES = re.compile(r"(?P<first>[0-9]{1,4})(?:-(?P<last>[0-9]{1,4}))?")
#: Pages in a text, such as ``p.9-14, 18 and 22``, and the number of all pages after them, such as ``of 66``.
_CITED_PAGES = re.compile(r"\bp\.([0-9]{1,4}(?:-[0-9]{1,4})?(?:(?:, | and )[0-9]{1,4}(?:-[0-9]{1,4})?)*)\b")
_LAST_PAGE_OF_DOCUMENT = re.compile(r" of ([0-9]+)")


def check_listed_pages(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that sources cite only the pages that are listed for their document.

    They are listed under ``pages`` of the document, or in ``documents`` of ``evidence``, if that text has pages. Each
    page under ``pages`` must be cited, but not in overlays and older editions, which omit facts. Other pages can be
    evidence too.
    """
    for key, pages_read in spec.evidence.part.documents.items():
        path = ("evidence", "documents", key)
        document_key = "" if key == "manual" else key  # Sources cite the manual without a key.
        last_page_match = _LAST_PAGE_OF_DOCUMENT.search(pages_read)
        for page in _pages_in_text(pages_read):
            if last_page_match is not None and page > int(last_page_match[1]):
                report.add("cited-place", path, f"page {page} is after the last page, {last_page_match[1]}")
        _check_pages_cited(spec, document_key, list_path=path, listed_text=pages_read, report=report)
    for key, document in spec.documents.items():
        path = ("documents", key, "pages")
        cited_pages = _check_pages_cited(spec, key, list_path=path, listed_text=document.pages, report=report)
        if is_derived(report.document):
            continue
        for page in sorted(_pages_in_text(document.pages) - cited_pages):
            report.add("cited-place", path, f"no source cites page {page}; correct or remove it")


def _check_pages_cited(
    spec: WrittenSpec, document_key: str, list_path: Path, listed_text: str, report: DocumentReport
) -> set[int]:
    """Return the pages of a document that sources cite, and report each that is not among the pages in a text.

    Nothing is reported if the text has no pages, such as "all pages".
    """
    listed_pages = _pages_in_text(listed_text)
    cited_pages: set[int] = set()
    for path, source in sources(leaves_of(spec.data, report)):
        pages_of_source = set().union(*map(_pages_in_text, places_in_document(source, document_key)))
        cited_pages |= pages_of_source
        unlisted_pages = pages_of_source - listed_pages
        if listed_pages and unlisted_pages:
            line, _ = report.document.position(list_path)
            message = f"page {min(unlisted_pages)} is not among the pages in line {line}; correct one of the two"
            report.add("cited-place", path, message)
    return cited_pages


def _pages_in_text(text: str) -> set[int]:
    """Return the pages in a text, such as 9, 10 and 18 for ``p.9-10 and 18``."""
    page_numbers: set[int] = set()
    for pages_text in _CITED_PAGES.findall(text):
        for pages in _PAGES.finditer(pages_text):
            first_page = int(pages.group("first"))
            page_numbers.update(range(first_page, int(pages.group("last") or first_page) + 1))
    return page_numbers


#: Pairs of quotes used by word processors and PDF files.
_TYPOGRAPHIC_QUOTES = frozenset(map(tuple, ("“”", "„“", "„”", "””", "‘’", "‚‘", "’’", "«»", "»«")))


def check_typographic_quotes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text begins and ends with typographic quotes, which YAML treats as part of the text."""
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or len(text) < 2:
            continue
        first_character, inner_text, last_character = text[0], text[1:-1], text[-1]
        if (first_character, last_character) in _TYPOGRAPHIC_QUOTES:
            message = (
                f"the quotes {first_character} and {last_character} are part of this text; "
                f'write "{inner_text}" with straight quotes'
            )
            report.add("typographic-quotes", path, message)


def check_evidence_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the documents, implementations and examples that the evidence names exist.

    The manual is a document too, with the name ``manual`` and the language code of each edition.
    """
    resolver = NameResolver(spec, report)
    evidence = spec.evidence.part
    path = spec.evidence.path
    documents = spec.with_invalid_parts.names_in("documents")
    languages = [edition.part.language for edition in spec.with_invalid_parts.manual.editions]
    known_documents = ("manual", *languages, *documents)
    for key in evidence.documents:
        resolver.check_name((*path, "documents", key), "document", key, known_names=known_documents)
    implementations_path = (*path, "implementations")
    resolver.check_each_name(implementations_path, "document", evidence.implementations, known_names=documents)
    example_by_name = by_name(spec.with_invalid_parts.examples)
    resolver.check_each_name((*path, "vectors"), "example", evidence.vectors, known_names=example_by_name)
