"""A page as its reader sees it: sections with headings, which contain rows of tables, list items and paragraphs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import unescape

_HEADING = re.compile(r"(#+) (.+)")
#: Headings inside a fold, and the fold itself, whose summary is its heading.
_RAW_HEADING = re.compile(r"<h(\d)>(.+)</h\d>")
_FOLD = re.compile(r"<summary><b>([^<]+)</b>.*</summary>")
_BREAK = re.compile(r"<br>|</?small>")
_TAG = re.compile(r"</?(?:code|b|picture|source|img|details)\b[^>]*>")
_ANCHOR = re.compile(r'<a id="[^"]*"></a>')
_PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
_LINK = re.compile(r"\[([^\]]*)\]\([^)\s]*\)")
_ESCAPED = re.compile(r"\\([!-/:-@\[-`{-~])")


@dataclass(frozen=True)
class Line:
    """A row with its cells, or one cell with one or more sentences. A cell has a line for each of its lines."""

    cells: tuple[tuple[str, ...], ...]

    def says(self, label: str, value: str) -> bool:
        """Return True if a sentence has both label and value, or if a row has this label and the value.

        The label is a whole line in one of the first two cells.
        """
        if len(self.cells) == 1:
            return any(_contains_words(label, line) and _contains_words(value, line) for line in self.cells[0])
        return self.is_called(label) and any(_contains_words(value, line) for cell in self.cells for line in cell)

    def is_called(self, label: str) -> bool:
        called = self.cells[: max(2, len(self.cells) - 1)]
        return any(_is_same_text(label, line) or label in _contacts_in(line) for cell in called for line in cell)

    def has_cell(self, value: str) -> bool:
        return any(_is_same_text(value, line) for cell in self.cells for line in cell)


@dataclass
class Section:
    """A heading with everything below it up to the next one. ``inner`` are the sections one level down."""

    heading: str
    level: int
    lines: list[Line] = field(default_factory=list)
    inner: list[Section] = field(default_factory=list)

    def all_sections(self) -> Iterator[Section]:
        yield self
        for section in self.inner:
            yield from section.all_sections()

    def statements(self) -> Iterator[Line]:
        """Return everything in it, including headings."""
        for section in self.all_sections():
            yield Line(((section.heading,),))
            yield from section.lines

    def within(self, words: str) -> list[Section]:
        """Return the inner sections whose heading has the words, or else those whose first line has them."""
        inside = [section for section in self.all_sections() if section is not self]
        titled = [section for section in inside if _contains_words(words, section.heading)]
        if titled:
            return titled
        with_lines = [section for section in inside if section.lines]
        return [section for section in with_lines if _contains_words(words, _first_line(section))]


def read(page: str) -> Section:
    """Return the page as a section. Text before its first heading of the second level belongs to the section itself."""
    top = Section("", 0)
    stack = [top]
    rows: list[str] = []
    for block in re.split(r"\n\s*\n", _ANCHOR.sub("", page)):
        rows = [line for line in _PICTURE.sub("", block).splitlines() if line.strip()]
        rows = [line for line in rows if line not in ("<details>", "</details>")]
        heading = _heading(rows[0]) if rows else None
        if heading is not None:
            section = Section(_plain(heading[1]), heading[0])
            while stack[-1].level >= section.level:
                stack.pop()
            stack[-1].inner.append(section)
            stack.append(section)
            rows = rows[1:]
        stack[-1].lines += _lines(rows)
    return top


def _heading(row: str) -> tuple[int, str] | None:
    """Return the level and the words of a heading, in Markdown or in a fold."""
    if heading := _HEADING.fullmatch(row):
        return len(heading[1]), heading[2]
    if heading := _RAW_HEADING.fullmatch(row):
        return int(heading[1]), _BREAK.sub(" ", heading[2])
    return (2, heading[1]) if (heading := _FOLD.fullmatch(row)) else None


def _contacts_in(line: str) -> set[str]:
    """Return the contacts in a cell of a table of pins: ``7, 8 (8 pins), 7 to 12 (12 pins)``."""
    contacts = set[str]()
    if ":" in line:
        return contacts
    for part in re.sub(r" \([\w ]+\)", "", line).split(", "):
        first, _, last = part.partition(" to ")
        is_range = first.isdecimal() and last.isdecimal()
        if is_range:
            contacts |= {f"{number}" for number in range(int(first), int(last) + 1)}
        else:
            contacts.add(part)
    return contacts


def _lines(rows: list[str]) -> Iterator[Line]:
    if rows and rows[0].startswith("| "):
        yield from (_row(row) for row in rows if not re.fullmatch(r"[|\s:-]+", row))
    elif rows and rows[0].startswith("- "):
        list_items = re.split(r"\n?- ", "\n".join(rows))
        yield from (Line(((_plain(list_item),),)) for list_item in list_items if list_item.strip())
    elif rows and rows[0].startswith("1. "):
        yield from map(_numbered, rows)
    elif rows:
        yield Line(((_plain(" ".join(rows)),),))


def _numbered(row: str) -> Line:
    """Return the number and the text of a row of a numbered list as two cells."""
    return Line(tuple((_plain(part),) for part in row.split(". ", 1)))


def _row(row: str) -> Line:
    return Line(tuple(map(_cell, re.split(r"(?<!\\)\|", row)[1:-1])))


def _cell(cell: str) -> tuple[str, ...]:
    return tuple(_plain(line) for line in _BREAK.split(cell) if line.strip())


def _plain(text: str) -> str:
    """Return Markdown as it is shown."""
    parts = re.split(r"(`+)(.*?)\1", _LINK.sub(r"\1", _TAG.sub("", text)))
    parts[::3] = [unescape(_ESCAPED.sub(r"\1", part)) for part in parts[::3]]
    del parts[1::3]  # The backticks.
    words = "".join(parts)
    return " ".join(words.replace("**", "").split())


def _first_line(section: Section) -> str:
    return " ".join(line for cell in section.lines[0].cells for line in cell)


def _contains_words(words: str, line: str) -> bool:
    """Return True if the line has the words, in any case, but not as parts of other words, numbers or ranges."""
    alone = rf"(?<![\w:.])(?<!to ){re.escape(words)}(?!\w|[:.]\d| to \d)"
    return re.search(alone, line, re.IGNORECASE) is not None


def _is_same_text(words: str, line: str) -> bool:
    """Return True if the words are the whole line, ignoring case and spaces."""
    return "".join(words.casefold().split()) == "".join(line.casefold().split())
