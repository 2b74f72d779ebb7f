"""Rules for sources: cited sections, the evidence of a spec, the sources of limits and the manual's revisions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from ..document import Path, is_placeholder
from ..problems import DocumentReport, listed, quoted, suggestion
from .walk import Spec, by_name, explained, items, leaves, leaves_of, mapping, sources

_CITED = re.compile(r"(?P<section>[0-9]+(?:\.[0-9]+)*|[^\W\d_][^:;]*?)(?:\s+p\.(?P<page>[0-9]+))?")
_NUMBERED = re.compile(r"[0-9]+(?:\.[0-9]+)*")
#: Where a section begins or ends if the contents do not say.
_FIRST, _END = 1, 10_000
#: Number of cited pages that show which pages a spec cites, and the share of them that agrees.
_ENOUGH, _SHARE = 50, 0.98


def cited_place(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that every cited section of the manual is in its contents, and every cited page in its section.

    In a spec whose sources cite the pages on which sections and entries begin, no source may cite another page.
    """
    contents = mapping(raw, "manual", "contents")
    spans = _spans(contents)
    first_pages = 0
    later_pages: list[tuple[Path, str, int, int]] = []
    for path, value in sources(leaves_of(spec, report)) if contents else ():
        places = [piece.strip() for piece in value.split(";") if not is_placeholder(piece)]
        pieces = [citation for place in places if (citation := _CITED.fullmatch(place)) is not None]
        own_names, names = _printed_names(spec, path)
        for cited in pieces:
            section = cited["section"]
            if not _is_in_section(section, cited["page"], path, spans, names, report):
                continue
            page, begin_pages = int(cited["page"]), _first_pages(spans[section], own_names)
            pages = {int(citation["page"] or 0) for citation in pieces if citation["section"] == section}
            if page in begin_pages:
                first_pages += 1
            elif begin_pages and not pages & begin_pages:
                later_pages.append(
                    (
                        path,
                        section,
                        page,
                        max((first_page for first_page in begin_pages if first_page < page), default=page),
                    )
                )
    if first_pages >= max(_ENOUGH, _SHARE * (first_pages + len(later_pages))):
        for path, section, page, first_page in later_pages:
            problem = f"nothing in section {section} begins on page {page}, and other sources cite first pages"
            report.add("cited-place", path, f"{problem}; cite p.{first_page}, or p.{first_page} and p.{page}")


def _first_pages(spans: Mapping[str, tuple[int, int]], own_names: list[str]) -> set[int]:
    """Return the first page of the entry of an item or, without one, those of its section and of all its entries."""
    name = next((name for name in own_names if name in spans), "")
    if name:
        return {spans[name][0]}
    if spans[""][0] <= _FIRST:
        return set()
    return {start for start, _ in spans.values()}


def _spans(contents: Mapping[str, Any]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section, under an empty name, and of its entries by name.

    The last page is the one on which the next section begins. A page that the contents omit is not checked.
    """
    rows = [(name, section) for name, section in contents.items() if isinstance(section, dict)]
    page_spans: dict[str, dict[str, tuple[int, int]]] = {}
    for at, (name, section) in enumerate(rows):
        later_rows = [row for row in rows[at + 1 :] if not row[0].startswith(f"{name}.")]
        end = _page(later_rows[0][1], _END) if later_rows else _END
        inner_rows = [row for row in rows[at + 1 :] if row[0].startswith(f"{name}.")]
        start = _page(section, _FIRST)
        page_spans[name] = {"": (start, end)}
        entries = [(title, page) for title, page in mapping(section, "entries").items() if isinstance(page, int)]
        after = _page(inner_rows[0][1], end) if inner_rows else end
        for (title, page), (_, following) in pairwise([*entries, ("", after)]):
            page_spans[name][title.casefold()] = (page, max(page, following))
    return page_spans


def _page(section: Mapping[str, Any], otherwise: int) -> int:
    page = section.get("page", otherwise)
    return page if isinstance(page, int) else otherwise


def _printed_names(spec: Spec, path: Path) -> tuple[list[str], list[str]]:
    """Return the printed names of the item with a source, and those of all items around it, the innermost first."""
    enclosing_names: list[str] = []
    own_names: list[str] = []
    node: Any = spec
    for step in path[:-1]:
        node = node[step]
        if isinstance(node, dict):
            printed = (node.get("printed_name"), *mapping(node, "names").values())
            own_names = [name.casefold() for name in printed if isinstance(name, str)]
            enclosing_names[:0] = own_names
    return own_names, enclosing_names


def _is_in_section(
    section: str,
    page: str | None,
    path: Path,
    spans: Mapping[str, Mapping[str, tuple[int, int]]],
    names: list[str],
    report: DocumentReport,
) -> bool:
    """Return whether a page is given and is in its section, and report a section or page that cannot be right."""
    if section not in spans:
        if _NUMBERED.fullmatch(section):
            hint = suggestion(section, [name for name in spans if _NUMBERED.fullmatch(name)])
            report.add("cited-place", path, f"the contents have no section {quoted(section)}{hint}")
        return False
    if page is None:
        return False
    name = next((name for name in names if name in spans[section]), "")
    start, end = spans[section][name]
    if start <= int(page) <= end:
        return True
    cited_part = f"the entry {quoted(name)} of section {section}" if name else f"section {section}"
    pages = _pages_text(start, end)
    report.add("cited-place", path, f"{cited_part} is {pages} according to the table of contents, not on page {page}")
    return False


def _pages_text(start: int, end: int) -> str:
    if end == _END:
        return f"on page {start} or later"
    return f"on page {start}" if start == end else f"on pages {start} to {end}"


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


#: Grades with which every fact is in the manufacturer's words.
_IN_THE_MANUFACTURERS_WORDS = ("manual", "quoted")
#: The document that a source cites. Without a key, it is the manual.
_DOCUMENT = re.compile(r"\s*(?:([a-z][a-z0-9_]*):\s)?")

#: Keys with limits, and the alternative if no document of the manufacturer gives them.
_CLOCK = (("min_hz", "max_hz"), "write 'used_hz' for a clock that a program or a master uses")
_TIMING = (("at_least_us", "at_most_us"), "write 'typical_us', or describe the time in a 'note'")
_TIMEOUT = (("at_most_ns",), "write 'typical_ns', or leave the time-out out")
_CABLE = (("below_hz",), "leave the table out")
_SUPPLY = (("min_mv", "max_mv"), "list the voltage in use under 'characteristics'")


def limit_source(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that limits come from a document of the manufacturer if other facts do not have to."""
    evidence = mapping(spec, "evidence")
    if evidence.get("grade", "manual") in _IN_THE_MANUFACTURERS_WORDS:
        return
    read = mapping(evidence, "documents")
    documents = f"a source in {listed(read, 'or')}" if read else "a document of the manufacturer under 'evidence'"
    for path, limits, source, (keys, instead) in _limits(spec):
        cited = {match[1] or "manual" for match in map(_DOCUMENT.match, source.split(";")) if match}
        key = next((key for key in keys if key in limits), "")
        if key and cited.isdisjoint(read):
            problem = f"{quoted(key)} needs {documents}, because it is a limit"
            report.add("limit-source", (*path, key), f"{problem}; without one, {instead}", at_key=True)


def _limits(spec: Spec) -> Iterator[tuple[Path, Spec, str, tuple[tuple[str, ...], str]]]:
    """Yield each part of a spec that can have limits: its path, its data, its source, and its keys."""
    if supply := mapping(spec, "supply"):
        yield ("supply",), supply, _source(supply), _SUPPLY
    for path, timing in items(spec, "timings"):
        yield path, timing, _source(timing), _TIMING
    for name in mapping(spec, "interfaces"):
        interface = mapping(spec, "interfaces", name)
        for key, kind in (("clock", _CLOCK), ("timeout", _TIMEOUT)):
            part = mapping(interface, key)
            yield ("interfaces", name, key), part, _source(part, interface), kind
        for key, kind in (("timings", _TIMING), ("cable_lengths", _CABLE)):
            for path, part in items(interface, key):
                yield ("interfaces", name, *path), part, _source(part, interface), kind


def _source(part: Spec, parent: Spec | None = None) -> str:
    """Return the source of a part, or that of its parent."""
    return str(part.get("source") or (parent or {}).get("source") or "")


def revision_in_history(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the history of a manual lists its own revision, unless an erratum explains it."""
    revisions = [str(history_row.get("revision")) for _, history_row in items(raw, "manual", "history")]
    revision = mapping(spec, "manual").get("revision")
    is_repeated = len(set(revisions)) < len(revisions)  # Reported by another rule.
    if not revisions or is_repeated or not revision or revision in revisions:
        return
    if explained(report.document, "manual", "history"):
        return
    problem = f"the manual has revision {quoted(revision)}, but its history lists {', '.join(revisions)}"
    remedy = "correct one of the two, or add an erratum that affects manual.history if the manual prints this"
    report.add("revision-not-in-history", ("manual", "revision"), f"{problem}; {remedy}")


def open_quotation(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that double quotation marks in the printed text of an erratum come in pairs."""
    for path, erratum in items(spec, "errata"):
        if erratum["printed"].count('"') % 2:
            message = "a quotation mark has no partner; text between two of them is quoted to the letter"
            report.add("open-quotation", (*path, "printed"), message)
