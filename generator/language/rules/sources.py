"""Rules for sources: cited sections, the evidence of a spec, the sources of limits, and quotations."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from ...model import Evidence
from ...model.interface_parts import CABLE_LIMITS
from ..problems import DocumentReport, join_words, quoted
from ..written import LocatedPart
from ..written_interfaces import WrittenBiss, WrittenSsi
from ..written_parts import WrittenExample, WrittenSpec
from .parts import PlacedPart, WrittenInterface, by_name, clocks_of, interfaces
from .walk import leaves, sources

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
