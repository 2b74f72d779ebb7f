"""Rule on the sources of limits. An encoder that works at some value does not show where its limits are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..problems import DocumentReport, Path, listed, quoted
from .walk import Spec, items, mapping

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
