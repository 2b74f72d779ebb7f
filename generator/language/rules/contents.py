"""Rules that compare cited sections and pages with the contents of the manual."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from ..problems import DocumentReport, Path, quoted, suggestion
from .walk import Spec, mapping, sources

_CITED = re.compile(r"(?P<section>[0-9]+(?:\.[0-9]+)*|[^\W\d_][^:;]*?)(?:\s+p\.(?P<page>[0-9]+))?")
_NUMBERED = re.compile(r"[0-9]+(?:\.[0-9]+)*")
_END = 10_000


def cited_place(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that every cited section of the manual is in its contents, and every cited page in its section."""
    contents = mapping(raw, "manual", "contents")
    spans = _spans(contents)
    for path, value in sources(spec) if contents else ():
        for piece in value.split(";"):
            cited = _CITED.fullmatch(piece.strip())
            if cited is not None:
                _check(cited["section"], cited["page"], path, spans, _names(spec, path), report)


def _spans(contents: Mapping[str, Any]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return the first and the last page of each section, under an empty name, and of its entries by name.

    The last page is the one on which the next section begins. A page that the contents omit is not checked.
    """
    rows = [(name, item) for name, item in contents.items() if isinstance(item, dict)]
    found: dict[str, dict[str, tuple[int, int]]] = {}
    for at, (name, item) in enumerate(rows):
        later = [other for other in rows[at + 1 :] if not other[0].startswith(f"{name}.")]
        end = _page(later[0][1], _END) if later else _END
        inside = [other for other in rows[at + 1 :] if other[0].startswith(f"{name}.")]
        start = _page(item, 1)
        found[name] = {"": (start, end)}
        entries = [(title, page) for title, page in mapping(item, "entries").items() if isinstance(page, int)]
        after = _page(inside[0][1], end) if inside else end
        for (title, page), (_, following) in pairwise([*entries, ("", after)]):
            found[name][title.casefold()] = (page, max(page, following))
    return found


def _page(item: Mapping[str, Any], otherwise: int) -> int:
    page = item.get("page", otherwise)
    return page if isinstance(page, int) else otherwise


def _names(spec: Spec, path: Path) -> list[str]:
    """Return the printed names of the items around a source, the innermost first."""
    found: list[str] = []
    node: Any = spec
    for step in path[:-1]:
        node = node[step]
        if isinstance(node, dict):
            printed = (node.get("printed_name"), *mapping(node, "names").values())
            found[:0] = [name.casefold() for name in printed if isinstance(name, str)]
    return found


def _check(
    section: str,
    page: str | None,
    path: Path,
    spans: Mapping[str, Mapping[str, tuple[int, int]]],
    names: list[str],
    report: DocumentReport,
) -> None:
    if section not in spans:
        if _NUMBERED.fullmatch(section):
            hint = suggestion(section, [name for name in spans if _NUMBERED.fullmatch(name)])
            report.add("cited-place", path, f"the contents have no section {quoted(section)}{hint}")
        return
    if page is None:
        return
    name = next((name for name in names if name in spans[section]), "")
    start, end = spans[section][name]
    if not start <= int(page) <= end:
        what = f"the entry {quoted(name)} of section {section}" if name else f"section {section}"
        where = (
            f"on page {start} or later"
            if end == _END
            else f"on page {start}"
            if start == end
            else f"on pages {start} to {end}"
        )
        report.add("cited-place", path, f"{what} is {where} according to the table of contents, not on page {page}")
