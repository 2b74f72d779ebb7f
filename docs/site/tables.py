"""Make tables fit their column: break long code at its marks, and stack the rows of wide tables on a narrow screen.

A stacked row shows each cell under its heading, which is in ``data-label``. Style sheets cannot test whether a table
fits a width, so its least width is estimated from its longest words. ``tests/verify`` measures every page.
"""

from __future__ import annotations

import html
import re
from itertools import zip_longest
from typing import Any

from sphinx.application import Sphinx

_TABLE = re.compile(r"<table\b([^>]*)>(.*?)</table>", re.DOTALL)
_HEAD = re.compile(r"<thead\b.*?</thead>", re.DOTALL)
_HEADING = re.compile(r"<th\b[^>]*>(.*?)</th>", re.DOTALL)
_ROW = re.compile(r"<tr\b[^>]*>(.*?)</tr>", re.DOTALL)
_CELL = re.compile(r"<td\b([^>]*)>(.*?)</td>", re.DOTALL)
_CODE = re.compile(r"(<code\b[^>]*>)(.*?)(</code>)", re.DOTALL)
_TAG = re.compile(r"<[^>]+>")
#: A word of code may be broken after these marks. Entities such as ``&amp;`` stay whole.
_BREAKS = re.compile(r"(&\w+;|&#\w+;)|(?<=\w)([_/,.=]|::)(?=\w)")
#: Columns of a phone and of a laptop in pixels, and the widths of a character and of the sides of a cell.
_NARROW, _WIDE = 315, 900
_CHARACTER, _SIDES = 7.6, 20
#: Rows with more text than this are tall columns of single words on a phone.
_LONG_ROW = 110


def fitted(body: str) -> str:
    """Return the HTML of a page with tables that fit."""
    return _TABLE.sub(_table, body)


def _table(table: re.Match[str]) -> str:
    attributes, inside = table.groups()
    inside = _CODE.sub(lambda code: code[1] + _breakable(code[2]) + code[3], inside)
    headings = [_text(heading) for heading in _HEADING.findall(inside.partition("</thead>")[0])]
    if not any(headings):
        # Markdown has no table without a row of headings.
        inside = _HEAD.sub("", inside)
    rows = list(map(_cells, _ROW.findall(inside)))
    least_width = _least_width([headings, *rows])
    longest = max(map(_text_length, rows), default=0)
    names = ["stacks"] * (least_width > _NARROW) + ["stacks-early"] * (least_width > _WIDE)
    if len(headings) > 2 and longest > _LONG_ROW and "stacks" not in names:
        names.append("stacks")
    if not names or not any(headings):
        return f"<table{attributes}>{inside}</table>"
    attributes = re.sub(r'class="([^"]*)"', rf'class="\1 {" ".join(names)}"', attributes)
    if "class=" not in attributes:
        attributes += f' class="{" ".join(names)}"'
    head, mark, body = inside.partition("</thead>")
    return f"<table{attributes}>{head}{mark}{_ROW.sub(lambda row: _labelled(row[0], headings), body)}</table>"


def _cells(row: str) -> list[str]:
    return [cell for _, cell in _CELL.findall(row)]


def _text_length(row: list[str]) -> int:
    return sum(len(_text(cell)) for cell in row)


def _labelled(row: str, headings: list[str]) -> str:
    """Return a row whose cells have the headings of their columns."""
    remaining_headings = iter(headings)

    def cell(match: re.Match[str]) -> str:
        label = html.escape(next(remaining_headings, ""))
        mark = ' class="empty"' if not match[2].strip() or match[2].strip() == "<p></p>" else ""
        return f'<td{match[1]}{mark} data-label="{label}">{match[2]}</td>'

    return _CELL.sub(cell, row)


def _breakable(code: str) -> str:
    """Return code that may be broken after its marks."""
    pieces = re.split(r"(<[^>]+>)", code)
    # The other pieces are tags.
    pieces[::2] = [_BREAKS.sub(lambda mark: mark[1] or f"{mark[2]}<wbr>", piece) for piece in pieces[::2]]
    return "".join(pieces)


def _least_width(rows: list[list[str]]) -> float:
    """Return the estimated least width of a table in pixels."""
    columns = zip_longest(*rows, fillvalue="")
    widest = [max(map(_longest_word, column)) for column in columns]
    return sum(_CHARACTER * count + _SIDES for count in widest)


def _longest_word(cell: str) -> int:
    if "<img" in cell or "<svg" in cell:
        return 20
    words = re.split(r"\s|\0|(?<=\w-)", _text(cell.replace("<wbr>", "\0").replace("<br", " <br")))
    return max(map(len, words), default=0)


def _text(cell: str) -> str:
    return html.unescape(_TAG.sub("", cell)).strip()


def _fit(_app: Sphinx, _page: str, _template: str, context: dict[str, Any], _doctree: object) -> None:
    if "body" in context:
        context["body"] = fitted(context["body"])


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("html-page-context", _fit)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
