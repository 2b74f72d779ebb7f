"""Divide the text of a manual into its sections, and each section into words, without text of the page layout."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from pathlib import Path

#: Largest text that is read, in bytes. Manuals have some 100,000.
MOST_BYTES = 20_000_000
#: Section of the text before the first heading.
COVER = "Cover"
_MARKUP = re.compile(r"</?\w+>|[#*_`•▪●■]+|\[(?P<shown>[^]]*)\]\([^)]*\)")
_HEADING = re.compile(r"(?P<number>\d{1,2}(?:\.\d{1,2}){0,3})\.?\s*(?:-\s*)?(?P<title>[^\W\d].*|\"\S.*|\d\w+.*)")
_IN_CONTENTS = re.compile(r"\.{3,}\s*\d*$|\t\s*\d+$")
_PAGE = re.compile(r"[\s\-]*\d{1,4}[\s\-]*|(?:page|pag\.?|seite)\s+\d{1,4}(?:\s*(?:of|di|/)\s*\d{1,4})?", re.IGNORECASE)
#: A word of a manual or a spec, or a sign that changes the meaning of one.
WORD = re.compile(r"(?<![\w.])-\d+(?:[.,:]\d+)*|\w+(?:[.,:]\d+)*|[±+<>≤≥%°]")
#: Least number of times that a line is printed to be a running head, and the longest such line.
_RUNNING, _LONGEST = 4, 120
#: Number of lines at the top or bottom of a page, and the least share of a running head that is printed there.
_EDGE, _MOSTLY = 4, 0.8
#: Number of lines with a page from which contents are taken to be complete.
_FEW = 12
_DASHES = str.maketrans(dict.fromkeys("‐‑‒–—−", "-") | {"\u00ad": "", "\u200b": "", "’": "'", "“": '"', "”": '"'})


class NoText(Exception):
    """A file is not the text of a manual. The message says why."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section: its number or, without one, its title, the whole title, and its words in order."""

    number: str
    title: str
    words: tuple[str, ...]

    @property
    def shown(self) -> str:
        return self.title if self.number == self.title else f"{self.number} {self.title}"


@dataclass(frozen=True, slots=True)
class Manual:
    """The text of an edition. ``missing`` contains the listed sections for which the text has no heading."""

    sections: tuple[Section, ...]
    missing: Mapping[str, str]

    @property
    def words(self) -> Counter[str]:
        return Counter(word for section in self.sections for word in section.words)

    def without_heading_after(self, number: str) -> set[str]:
        """Return the sections whose heading is missing, and whose text therefore counts as part of this one."""
        order = [section.number for section in self.sections if section.number[0].isdigit()]
        if number not in order:
            return set()
        following = order[order.index(number) + 1 : order.index(number) + 2]
        end = _key(following[0]) if following else (999,)
        return {item for item in self.missing if _key(number) < _key(item) < end}


def read(path: Path) -> Manual:
    """Read the text of a manual from a text file in UTF-8 or from a PDF.

    Raises:
        NoText: The file cannot be read, is too large, or has no text.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise NoText(f"{path} has more than {MOST_BYTES:,} bytes")
        data = path.read_bytes()
    except OSError as error:
        raise NoText(f"cannot read {path}: {error.strerror or error}") from None
    if data.startswith(b"%PDF-"):
        text = _of_pdf(path)
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise NoText(f"{path} is not text in UTF-8; convert it, or give the PDF") from None
    manual = divide(text)
    if not manual.words:
        raise NoText(f"{path} has no text; a scanned manual must be recognised (OCR) first")
    return manual


def _of_pdf(path: Path) -> str:
    try:
        pypdf = import_module("pypdf")
    except ImportError:
        raise NoText(f"{path} is a PDF, which needs the package pypdf: pip install 'codewheel[pdf]'") from None
    try:
        return "\f".join(page.extract_text() for page in pypdf.PdfReader(path).pages)
    except Exception as error:  # A damaged PDF raises whatever its damage leads to.
        raise NoText(f"cannot read {path}: {error}") from None


def divide(text: str) -> Manual:
    """Divide a text into its sections."""
    lines = [plain(line) for line in re.split(r"[\n\f]", text)]
    lines = [line for line in lines if line.strip()]
    headings, missing = _headings(lines)
    left_out = _running_heads([line for index, line in enumerate(lines) if index not in headings])
    bodies: list[tuple[str, str, list[str]]] = [(COVER, COVER, [])]
    start = min((index for index, (number, _) in headings.items() if number[0].isdigit()), default=0)
    for index, line in enumerate(lines):
        if index in headings:
            bodies.append((*headings[index], []))
        elif (
            not (index < start and _IN_CONTENTS.search(line))
            and _head(line) not in left_out
            and not _PAGE.fullmatch(line)
        ):
            bodies[-1][2].append(line)
    return Manual(tuple(Section(number, title, tuple(_words(body))) for number, title, body in bodies), missing)


def plain(line: str) -> str:
    """Return a line without markup, with ASCII letters, dashes and quotes, and a tab between the cells of a table."""
    line = line.strip().strip("|").replace("|", "\t")
    line = _MARKUP.sub(lambda found: found["shown"] or " ", unicodedata.normalize("NFKC", line).translate(_DASHES))
    return re.sub(r" ?\t[ \t]*", "\t", re.sub(r"[^\S\t]+", " ", line)).strip()


def _words(lines: Iterable[str]) -> list[str]:
    """Return the words of lines. A word that is hyphenated at the end of a line is one word."""
    return WORD.findall(re.sub(r"(?<=[a-zà-ÿ])-\n(?=[a-zà-ÿ])", "", "\n".join(lines)))


def _head(line: str) -> str:
    return re.sub(r"\d+", "#", line.strip())


def _running_heads(lines: Sequence[str]) -> set[str]:
    """Return the lines that are printed on many pages: page numbers, and identical lines next to them.

    A row of a table can also occur often. Its numbers do not increase each time.
    """
    numbers: dict[str, list[list[int]]] = {}
    for line in lines:
        if len(line) <= _LONGEST:
            numbers.setdefault(_head(line), []).append([int(number) for number in re.findall(r"\d{1,4}", line)])
    often = {head: found for head, found in numbers.items() if len(found) >= _RUNNING}
    counting = {head for head, found in often.items() if _counts_pages(found)}
    edges = {at + step for at, line in enumerate(lines) if _head(line) in counting for step in range(-_EDGE, _EDGE + 1)}
    at_edges = Counter(_head(lines[at]) for at in edges if 0 <= at < len(lines))
    return counting | {head for head, found in often.items() if at_edges[head] >= _MOSTLY * len(found)}


def _counts_pages(found: Sequence[Sequence[int]]) -> bool:
    columns = [column for column in zip(*found, strict=False) if len(set(column)) > 1]
    return bool(columns) and all(all(a < b for a, b in pairwise(column)) for column in columns)


def _headings(lines: Sequence[str]) -> tuple[dict[int, tuple[str, str]], dict[str, str]]:
    """Return number and title of the headings by line, and the sections that have no heading.

    A heading is a numbered line whose number and words the contents list as well.
    """
    numbered = {index: found for index, line in enumerate(lines) if (found := _numbered(line)) is not None}
    listed = _contents(lines, numbered)
    titles = {numbered[index][0]: numbered[index][1] for index in sorted(listed, reverse=True)}
    headings: dict[int, tuple[str, str]] = {}
    last: tuple[int, ...] = ()
    for index, (number, title) in numbered.items():
        key = _key(number)
        if index not in listed and key > last and _same_start(titles.get(number, ""), title):
            headings[index], last = (number, titles[number]), key
    start = min(headings, default=len(lines))
    places = {_title(line): index for index, line in enumerate(lines[:start]) if _IN_CONTENTS.search(line)}
    for index, line in enumerate(lines[:start]):
        if places.get(line, index) < index:
            headings[index] = (line, line)
    missing = {number: title for number, title in titles.items() if number[0] != "0"}
    for number, _ in headings.values():
        missing.pop(number, None)
    return headings, missing


def _contents(lines: Sequence[str], numbered: Mapping[int, tuple[str, str]]) -> set[int]:
    """Return the numbered lines of the contents: those with a page, and the others up to the first lower number."""
    with_page = {index for index in numbered if _IN_CONTENTS.search(lines[index])}
    if len(with_page) >= _FEW:
        return with_page
    first = min(with_page or numbered, default=len(lines))
    found: set[int] = set()
    last: tuple[int, ...] = ()
    for index, (number, _) in numbered.items():
        if index >= first:
            key = _key(number)
            if key[:1] < last[:1]:
                break
            found.add(index)
            last = max(key, last)
    return found | with_page


def _key(number: str) -> tuple[int, ...]:
    return tuple(map(int, number.split(".")))


def _numbered(line: str) -> tuple[str, str] | None:
    found = _HEADING.fullmatch(_title(line))
    return (found["number"], found["title"].strip()) if found is not None and len(line) <= _LONGEST else None


def _title(line: str) -> str:
    return _IN_CONTENTS.sub("", line).strip()


def _same_start(listed: str, title: str) -> bool:
    """Return whether two titles have the same first words."""
    first, second = (WORD.findall(text.casefold())[:3] for text in (listed, title))
    return bool(first) and first[: len(second)] == second[: len(first)]


def aligned(old: Manual, new: Manual) -> Iterator[tuple[Section | None, Section | None]]:
    """Yield the sections of two editions in pairs, by title or else by number, with None for a missing one."""
    left = {section.number: section for section in new.sections}
    pairs: list[tuple[Section, Section | None]] = []
    for section in old.sections:
        same = left.get(section.number)
        if same is None or not _same_start(section.title, same.title):
            named = (item for item in left.values() if item.title.casefold() == section.title.casefold())
            same = next(named, same)
        if same is not None:
            del left[same.number]
        pairs.append((section, same))
    yield from pairs
    yield from ((None, section) for section in left.values())
