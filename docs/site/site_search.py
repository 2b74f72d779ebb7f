"""Write the index of the search: sections with their words, names and addresses, and the pages of order codes.

``static/search.js`` reads it. The index is a script, because a page that is opened as a file cannot load data.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_ID = re.compile(r"""\bid=["']([^"']+)["']""")
#: A fold, or a heading inside one, with its title. Identifiers for programmers are in small type.
_HEADING = re.compile(r"<(summary|h[2-4])[^>]*>(.*?)</\1>", re.DOTALL)
_SMALL = re.compile(r"<small>.*?</small>", re.DOTALL)
_TAG = re.compile(r"<[^>]+>")
#: A fold with links to errata inside a section. The text after it still belongs to the section.
_ERRATA_FOLD = re.compile(r"Errata: [⚠✓] \d+ ")
#: Pages about the project rather than about encoders.
_OF_PROJECT = re.compile(
    r"(CHANGELOG|CONTRIBUTING|SECURITY|README|api/|examples/|docs/(extend|trust|transcribe)/|docs/example/|.*-changes$)"
)
#: Longest text of a section in characters. Only words beyond it are not found.
_LONGEST = 12_000
#: Heading of the folded part of the page of an order code.
_DETAILS = "Details"
#: Heading above the worked examples of a family.
_EXAMPLES = "Worked examples"


@dataclass
class Section:
    anchor: str
    title: str
    is_fold: bool = False
    is_example: bool = False
    texts: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.texts)).strip()[:_LONGEST]


def sections(doctree: nodes.document) -> Iterator[Section]:
    """Yield the sections and folds of a page, in order."""
    current, anchor = Section("", ""), ""
    for node in doctree.findall():
        if isinstance(node, nodes.raw):
            ids = _ID.findall(node.astext())
            if ids and current.is_fold and not current.anchor:
                current.anchor = ids[0]
            elif ids and isinstance(node.parent, (nodes.section, nodes.document)):
                anchor = ids[-1]
            for tag, inside in _HEADING.findall(node.astext()):
                if _ERRATA_FOLD.match(_title(inside)):
                    continue
                yield current
                # Folds have their anchor inside, after the summary.
                current = Section("" if tag == "summary" else anchor, _title(inside), tag == "summary")
        elif isinstance(node, nodes.title) and isinstance(node.parent, nodes.section):
            yield current
            section_anchor = "" if isinstance(node.parent.parent, nodes.document) else node.parent["ids"][0]
            current, anchor = Section(anchor or section_anchor, node.astext(), is_example=_is_example(node)), ""
        elif isinstance(node, nodes.Text) and _is_prose(node):
            current.texts.append(str(node))
    yield current


def _title(inside: str) -> str:
    """Return the title of a heading or fold in HTML: its bold part, or all of it."""
    bold = re.search(r"<b>(.*?)</b>", inside, re.DOTALL)
    return html.unescape(_TAG.sub("", _SMALL.sub("", bold[1] if bold else inside))).strip()


def _is_example(title: nodes.title) -> bool:
    above = title.parent.parent
    return isinstance(above, nodes.section) and above[0].astext() == _EXAMPLES


def _is_prose(node: nodes.Node) -> bool:
    parent = node.parent
    while parent is not None:
        if isinstance(parent, (nodes.title, nodes.raw, nodes.comment)):
            return False
        parent = parent.parent
    return True


class Index:
    """The index, filled page by page. Texts that many pages share are kept once."""

    def __init__(self) -> None:
        self._found: dict[str, tuple[str, list[Section]]] = {}
        self._asked: dict[str, list[str]] = {}

    def add(self, page: str, title: str, doctree: nodes.document, asked: list[str]) -> None:
        """Add a page with the words that people type to find it, as its front matter lists them."""
        self._found[page] = (title, [section for section in sections(doctree) if section.title])
        self._asked[page] = asked

    def data(self, encoders: Any) -> dict[str, Any]:
        """Return the index with the names, addresses and order codes of ``encoders``, the domain."""
        ranked_pages = sorted(self._found, key=lambda page: (encoders.rank_of(page), page))
        places = {page: place for place, page in enumerate(ranked_pages)}
        texts: dict[str, int] = {}
        rows = []
        for page, place in places.items():
            in_sight = True
            for section in self._found[page][1]:
                in_sight &= section.title != _DETAILS
                standing = 2 if section.is_example else int(in_sight)
                rows.append(
                    [place, section.anchor, section.title, texts.setdefault(section.text, len(texts)), standing]
                )
        entries: list[list[str | int]] = []
        for qualified_name, _, description, page, anchor, priority in encoders.get_objects():
            if "." in qualified_name and page in places:
                family, _, name = qualified_name.partition(".")
                entries.append([name or qualified_name, description, places[page], anchor, family.lower(), priority])
        return {
            "asked": {page: words for page in ranked_pages if (words := self._asked.get(page))},
            "manufacturers": encoders.families_by_manufacturer(),
            "pages": [
                [page, self._found[page][0], *self._kind(page, encoders), int(encoders.rank_of(page) > 0)]
                for page in places
            ],
            "sections": rows,
            "texts": list(texts),
            "things": entries,
            "codes": {code: places[page] for page, codes in encoders.code_pages() if page in places for code in codes},
        }

    @staticmethod
    def _kind(page: str, encoders: Any) -> list[str]:
        """Return the kind of a page, its family and its interface."""
        family = encoders.family_of(page)
        if encoders.code_of(page):
            return ["code", family, encoders.interface_page_of(page).rpartition("/")[2]]
        if _OF_PROJECT.match(page.rpartition("generated/docs/")[2] if family else page):
            return ["project", family, ""]
        name = page.rpartition("/")[2]
        if name.startswith("questions-"):
            return ["question", "", ""]
        if name.startswith(("ERRATA-", "ASSUMPTIONS-")):
            # They repeat the content of the families' pages.
            return ["aside", "", ""]
        if family and re.search(r"(errata|masters|manual)$", name):
            return ["masters" if name.endswith("masters") else "aside", family, ""]
        if family and name.endswith("-verdicts"):
            # The page on verdicts ranks before the verdict pages of single families.
            return ["verdicts", family, ""]
        interface = name.partition("-")[0]
        if family and interface in encoders.interfaces_of(family):
            return ["interface", family, interface]
        return ["family" if family else "general", family, ""]


def _add(app: Sphinx, page: str, _template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    if doctree is not None and page != app.config.root_doc:
        index: Index = app.search_index  # type: ignore[attr-defined]
        asked = json.loads(str(app.env.metadata[page].get("asked", "[]")))
        index.add(page, _TAG.sub("", context["title"]), doctree, asked)


def _write(app: Sphinx, error: Exception | None) -> None:
    if error is None:
        data = app.search_index.data(app.env.get_domain("encoder"))  # type: ignore[attr-defined]
        text = json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")
        path = Path(app.outdir) / "_static" / "search-index.js"
        path.write_text(f"globalThis.codewheelSearch = {text};\n", encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.search_index = Index()  # type: ignore[attr-defined]
    app.connect("html-page-context", _add)
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": False}
