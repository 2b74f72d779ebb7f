"""Functions that write text from a spec as Markdown, so that code hosts and site generators show it literally."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from html import escape as escape_xml

from ..model import Source, Sources, cite
from .plain_text import one_line, text_on_one_line
from .text import Reference, Style

_MARKUP_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;"} | {mark: f"\\{mark}" for mark in r"\`*[]|~$"})
_MARKUP_ENTITIES = {ord(mark): f"&#{ord(mark)};" for mark in r"\`*[]|~$"}
#: An underscore starts emphasis at the edge of a word, but not inside it.
_EDGE_UNDERSCORE = re.compile(r"(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])")
#: Columns of a wrapped paragraph.
_PARAGRAPH_WIDTH = 132
_BLOCK_START = re.compile(r"^(\d+)([.)])(?=\s|$)|^([-+#=])")


def escape(value: object) -> str:
    """Return one line of text with all Markdown and HTML markup escaped."""
    return _escape_markdown(text_on_one_line(value))


@lru_cache(4096)
def _escape_markdown(value: str) -> str:
    """Return one line of text with its markup escaped, and spaces at its ends kept."""
    return _EDGE_UNDERSCORE.sub(r"\\_", value.translate(_MARKUP_ESCAPES))


def code_span(value: object) -> str:
    """Return a code span that is safe inside a table, where a vertical bar would end the cell."""
    return _code_span(text_on_one_line(value))


@lru_cache(4096)
def _code_span(code_text: str) -> str:
    """Return a code span for text on one line, or "" for an empty text."""
    if not code_text:
        return ""
    # The fence is longer than any run of backticks in the text.
    longest_run = max(map(len, re.findall("`+", code_text)), default=0)
    fence = "`" * (longest_run + 1)
    touches_fence = code_text.startswith("`") or code_text.endswith("`")
    # A space, which Markdown removes, separates backticks of the text from the fence.
    space = " " if touches_fence else ""
    return f"{fence}{space}{code_text}{space}{fence}".replace("|", "\\|")


def wrap_markdown(value: str) -> str:
    """Return a paragraph of Markdown as wrapped lines. No line starts a list, a heading or a rule by accident."""
    lines = textwrap.wrap(value, _PARAGRAPH_WIDTH, break_long_words=False, break_on_hyphens=False)
    return "\n".join(_BLOCK_START.sub(_escaped_start, line) for line in lines)


def _escaped_start(match: re.Match[str]) -> str:
    """Return the first characters of a line with the sign that would start a list, heading or rule escaped.

    For example, ``1.`` becomes ``1\\.``, and ``-`` becomes ``\\-``.
    """
    item_number, sign_after_number, other_sign = match.groups()
    return f"{item_number}\\{sign_after_number}" if item_number else f"\\{other_sign}"


def citation(sources: Sources) -> str:
    """Return the sources as ``§6.4 p.35, it: §6.4 p.36``."""
    return escape(_cite_with_section_signs(sources))


def cited_html(sources: Sources) -> str:
    """Return the sources for an HTML element."""
    return escape_html(_cite_with_section_signs(sources))


def _cite_with_section_signs(sources: Sources) -> str:
    """Return the sources in one line, with § before each section number."""
    return cite(tuple(map(_with_section_sign, sources)))


def _with_section_sign(source: Source) -> Source:
    """Return a source with § before its section if that is a number. Other sections are titles."""
    has_section_number = _SECTION_NUMBER.match(source.section) is not None
    return replace(source, section=f"§{source.section}") if has_section_number else source


#: The number of a section, unlike the number of a register, such as 0x07.
_SECTION_NUMBER = re.compile(r"\d+(?![\dx])")


def escape_html(value: object) -> str:
    """Return one line of text for an HTML element or attribute, with Markdown characters escaped as entities."""
    return escape_xml(text_on_one_line(value)).translate(_MARKUP_ENTITIES)


def markdown_link(label: str, target: str) -> str:
    """Return a link whose ``label`` is already Markdown."""
    return f"[{label}]({target})"


def link_list(links: Iterable[str]) -> str:
    """Return links in one line. A dot separates them, because titles of errata contain commas."""
    return " · ".join(links)


def anchor_of(name: str) -> str:
    """Return the HTML anchor that links to ``name`` refer to."""
    return f'<a id="{name}"></a>'


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table, with the columns omitted that are empty in all rows, or "" if no column remains."""
    row_lists = [list(row) for row in rows]
    filled_columns = [column for column in range(len(head)) if _has_text(row_lists, column)]
    if not filled_columns:
        return ""
    rule = ["---"] * len(head)
    lines = []
    for row in (head, rule, *row_lists):
        cells = [row[column] for column in filled_columns]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _has_text(rows: Sequence[Sequence[str]], column: int) -> bool:
    """Return whether any row has text in a column."""
    return any(row[column] for row in rows)


def join_filled(parts: Iterable[str], between: str = "<br>") -> str:
    """Join the parts that are not empty."""
    return between.join(part for part in parts if part)


def reference(ref: Reference) -> str:
    """Return a name with a link to its description on this page, or to a manual procedure on the hardware page."""
    if ref.kind == "by-hand":
        return markdown_link(escape(ref.title), f"hardware.md#{ref.anchor}")
    return markdown_link(code_span(ref.name), f"#{ref.anchor}")


#: Style for statements on a Markdown page.
MARKDOWN = Style(
    text=lambda part: _escape_markdown(one_line(part)),
    code=code_span,
    ref=reference,
    cited=lambda sources: f"({citation(sources)})" if sources else "",
)
