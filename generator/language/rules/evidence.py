"""Rule that compares the grade of a spec with its evidence."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..problems import DocumentReport, listed, quoted
from .walk import Spec, by_name, leaves, mapping, sources

#: Number of implementations that a grade needs.
_IMPLEMENTATIONS = {"quoted": 1}
_CORROBORATED = ("corroborated", "corroborated, no hardware frame seen")
#: Grades that need data from real hardware, and the remedy if there are none.
_WITH_FRAME = ("quoted", "corroborated")
_OR = "or write 'corroborated, no hardware frame seen'"
_WHOLE = "all pages"
#: A source: the key of the document that it cites, and the place in it.
_SOURCE = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?(.*?)\s*", re.DOTALL)


def evidence(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the evidence supports the grade, and report what is missing."""
    stated_evidence, examples = mapping(spec, "evidence"), by_name(raw, "examples")
    grade, read = stated_evidence.get("grade"), mapping(stated_evidence, "documents")
    agreeing, vectors = list(stated_evidence.get("implementations", ())), list(stated_evidence.get("vectors", ()))
    for index, key in enumerate(agreeing):
        if key in read or key in agreeing[:index]:
            problem = f"{quoted(key)} is listed twice; list each source once, so that it counts once"
            report.add("evidence-grade", ("evidence", "implementations", index), problem)
    for index, name in enumerate(vectors):
        if name in examples and not _discriminates(examples[name]):
            problem = f"{quoted(name)} has the same bits throughout, so it cannot show an error; use another example"
            report.add("evidence-grade", ("evidence", "vectors", index), problem)
    known_examples = [examples[name] for name in vectors if name in examples]
    if (
        grade in _WITH_FRAME
        and known_examples
        and len(known_examples) == len(vectors)
        and not any(map(_is_reading, known_examples))
    ):
        problem = f"the grade {quoted(grade)} needs data from an encoder"
        remedy = "add a frame 'from: encoder' without 'refused', or a register reading"
        report.add("evidence-grade", ("evidence", "vectors", 0), f"{problem}: {remedy}, {_OR} without 'vectors'")
    for problem in _missing(grade, read, agreeing, vectors) if grade else ():
        report.add("evidence-grade", ("evidence", "grade"), f"the grade {quoted(grade)} {problem}")
    if grade == "quoted" or grade in _CORROBORATED:
        _sources(spec, grade, read, agreeing, report)


def _missing(grade: str, read: Spec, agreeing: list[str], vectors: list[str]) -> Iterator[str]:
    """Yield what the grade needs and the evidence does not have."""
    if grade == "manual" and read.get("manual") != _WHOLE:
        yield f"needs the whole manual: write 'documents: {{manual: {_WHOLE}}}', or another grade"
    if grade == "quoted" and not read:
        yield "needs a document of the manufacturer: list it under 'documents', with the pages that were read"
    if len(agreeing) < _IMPLEMENTATIONS.get(grade, 0):
        yield "needs an implementation: list it under 'implementations'"
    if grade == "uncorroborated" and not (read or agreeing):
        yield "needs a source: list it under 'documents', with the pages that were read, or under 'implementations'"
    if grade in _CORROBORATED and len(agreeing) < (1 if read else 2):
        yield "needs two sources that share no code: list them under 'implementations'"
    if grade in _WITH_FRAME and not vectors:
        yield f"needs an example from real hardware: list it under 'vectors', {_OR}"
    if grade == _CORROBORATED[1] and vectors:
        yield "has no vectors: remove them, or write 'corroborated'"


def _sources(spec: Spec, grade: str, read: Spec, agreeing: list[str], report: DocumentReport) -> None:
    """Check that each fact cites the manufacturer or, for a lower grade, two implementations."""
    if not (read if grade == "quoted" else read or agreeing[1:]):
        return
    wanted = [f"a source in {listed(read, 'or')}"] if read else []
    if grade in _CORROBORATED and len(agreeing) > 1:
        wanted.append(f"two sources among {listed(agreeing)}")
    for path, value in sources(leaves({**spec, "errata": [], "examples": []})):
        if grade in _CORROBORATED and "clock" in path:
            continue  # One program is enough for its own clock. Limits have a rule of their own.
        pieces = [(match[1], match[2]) for match in map(_SOURCE.fullmatch, value.split(";")) if match]
        cited = {key or "manual" for key, _ in pieces}
        agree = grade in _CORROBORATED and len(cited & {*agreeing}) > 1
        if not agree and cited.isdisjoint(read):
            problem = f"the grade {quoted(grade)} needs {', or '.join(wanted)} for each fact"
            place = next((place for key, place in pieces if not key), "")
            report.add("evidence-grade", path, problem + _remedy(place, mapping(spec, "documents")))


def _remedy(place: str, documents: Spec) -> str:
    """Return how to write a source without the key of a document, or an empty string if all have one."""
    if not place:
        return ""
    if place in documents:
        return f"; write {quoted(f'{place}: PLACE')} with a place in it"
    return f"; write {quoted(f'KEY: {place}')} with the key of its document"


def _discriminates(example: Spec) -> bool:
    """Return whether the bits of an example differ from one another."""
    frame_text = example.get("bits") or example.get("bytes") or ""
    return isinstance(frame_text, str) and len(set(frame_text.split() if " " in frame_text else frame_text)) > 1


def _is_reading(example: Spec) -> bool:
    """Return whether an example is an accepted frame of the encoder or the content of a register."""
    is_frame = example.get("kind") == "frame" and example.get("from") == "encoder" and "refused" not in example
    return is_frame or example.get("kind") == "register"
