"""Rules that compare cited sections and pages with the contents of the manual."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from ..placeholders import is_placeholder
from ..problems import DocumentReport, Path, quoted, suggestion
from .walk import Spec, leaves_of, mapping, sources

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
