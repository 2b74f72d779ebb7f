"""Turn the Markdown of a repository into pages: resolve links, register anchors, and give each page its parent."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from build_site import DECODER_PAGE, NAMED
from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.transforms import SphinxTransform

_ID = re.compile(r"""\bid=["']([^"']+)["']""")
_TARGET = re.compile(r"""\b(href)=(["'])([^"']+)\2""")
#: The page above those that have no other parent.
_REST = "CONTRIBUTING"
#: Order of the pages of a family after its interfaces.
_ORDER = ("", "hardware", "errata", "masters", "verdicts", "manual", "changes")
#: Classes of entries of the tree of pages that are not on the way to the current page.
_CLASSES_OF_ENTRIES = re.compile(r' class="(?:toctree-l\d|reference internal)"')
_NOT_IN_A_SLUG = re.compile(r"[^\w\- ]")


class Mirror(SphinxTransform):
    """Transform that resolves Markdown links, gives headings the anchors of code hosts, and collects all anchors."""

    default_priority = 400

    def apply(self, **_: Any) -> None:
        self._drop_crumbs()
        self._name_headings()
        for reference in self.document.findall(nodes.reference):
            if "refuri" in reference:
                reference["refuri"] = self._resolved(reference["refuri"])
        anchors = [name for section in self.document.findall(nodes.section) for name in section["ids"]]
        for raw in list(self.document.findall(nodes.raw)):
            html = _TARGET.sub(lambda match: f'{match[1]}="{self._resolved(match[3])}"', raw.rawsource or raw.astext())
            raw.clear()
            raw.rawsource = html
            raw.append(nodes.Text(html))
            anchors += _ID.findall(html)
        self.env.metadata[self.env.docname]["anchors"] = anchors  # type: ignore[assignment]

    def _drop_crumbs(self) -> None:
        """Remove the breadcrumbs of a page, because the site adds its own to every page."""
        for paragraph in list(self.document.findall(nodes.paragraph)):
            if isinstance(paragraph.parent, nodes.document) and " › " in paragraph.astext():
                paragraph.parent.remove(paragraph)

    def _name_headings(self) -> None:
        counts_by_slug: dict[str, int] = {}
        for section in self.document.findall(nodes.section):
            slug = _NOT_IN_A_SLUG.sub("", section[0].astext().lower()).replace(" ", "-")
            count = counts_by_slug[slug] = counts_by_slug.get(slug, -1) + 1
            name = f"{slug}-{count}" if count else slug
            if name:
                section["ids"] = [name]

    def _resolved(self, target: str) -> str:
        path, mark, anchor = target.partition("#")
        if not path or ":" in path:
            return target
        folder = posixpath.dirname(self.env.docname)
        name = posixpath.normpath(posixpath.join(folder, path)).removesuffix(".md")
        for page in (name, f"{name}/README", f"{name}/index"):
            if page in self.env.found_docs:
                return posixpath.relpath(f"{page}.html", folder or ".") + mark + anchor
        return target


def _add_children(app: Sphinx, doctree: nodes.document) -> None:
    """Add a hidden list of a page's children: for ``x.md``, the pages ``x-…md`` and the pages in the folder ``x``."""
    env: BuildEnvironment = app.env
    children = list(_children(env, env.docname))
    if children:
        tree = addnodes.toctree(
            parent=env.docname, entries=[(None, name) for name in children], includefiles=children, maxdepth=-1,
            caption=None, glob=False, hidden=True, includehidden=True, numbered=0, titlesonly=True, rawentries=[],
        )  # fmt: skip
        first = next(doctree.findall(nodes.section), doctree)
        first += nodes.compound("", tree, classes=["toctree-wrapper"])


def _children(env: BuildEnvironment, page: str) -> Iterator[str]:
    named = NAMED.findall(Path(env.doc2path("index")).read_text(encoding="utf-8"))
    # Lowercase names come before order codes, which are in capitals.
    for name in sorted(env.found_docs - {"index", *named}, key=lambda name: (_rank(name), name.swapcase())):
        if page != name and _parent(env, name) == page:
            yield name


def _rank(page: str) -> int:
    """Return the place of a page among its siblings: people look for interfaces first, and for changes last."""
    last = page.rpartition("/")[2].rpartition("-")[2]
    return _ORDER.index(last) if last in _ORDER else 0


def _parent(env: BuildEnvironment, page: str) -> str:
    """Return the parent of a page outside ``index``.

    That is the interface of an order code, and otherwise the page for its folder or for its name up to a hyphen.
    """
    interface = env.get_domain("encoder").interface_page_of(page)  # type: ignore[attr-defined]
    if interface in env.found_docs:
        return str(interface)
    folder, _, name = page.rpartition("/")
    above = [f"{folder}/{name.rsplit('-', count)[0]}" for count in range(1, name.count("-") + 1)] if folder else []
    above += [folder, f"{folder}/README", f"{posixpath.dirname(folder)}/README", _REST]
    return next((candidate for candidate in above if candidate in env.found_docs and candidate != page), "")


def _context(app: Sphinx, page: str, _template: str, context: dict[str, Any], _doctree: object) -> None:
    """Set what the template of a page needs: its family and order code, the contents, and whether it has sections."""
    encoders = app.env.get_domain("encoder")
    context["decoder_page"] = DECODER_PAGE
    context["family"] = encoders.family_of(page)  # type: ignore[attr-defined]
    if DECODER_PAGE in app.env.found_docs:
        context["order_code"] = encoders.code_of(page)  # type: ignore[attr-defined]
        has_box = 'class="codewheel-decode' in context.get("body", "")
        context["decodes"] = context["order_code"] or has_box
    # Without this function, the theme does not add the tree of all pages to every page.
    toctree = context.pop("toctree")
    tree = toctree(collapse=True, includehidden=True, titles_only=True, maxdepth=5)
    # The tree is in each of hundreds of pages, and no style needs the classes of its entries.
    short_tree = _CLASSES_OF_ENTRIES.sub("", tree or "")
    context["site_tree"] = short_tree.replace('role="heading"', 'role="heading" aria-level="2"')


def _sections(_app: Sphinx, _page: str, _template: str, context: dict[str, Any], _doctree: object) -> None:
    """Move the sections of the page from the right, where the theme hides them on most screens, to the left."""
    context["has_sections"] = not context["furo_hide_toc"]
    context["furo_hide_toc"] = True


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_transform(Mirror)
    app.connect("doctree-read", _add_children, priority=100)
    app.connect("html-page-context", _context, priority=400)
    app.connect("html-page-context", _sections, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
