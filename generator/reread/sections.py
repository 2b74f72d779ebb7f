"""Divide the text of a manual into its sections, and each section into words, without text of the page layout."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from pathlib import Path

#: Largest text that is read, in bytes. Manuals have some 100,000.
MOST_BYTES = 20_000_000
#: Section of the text before the first heading.
COVER = "Cover"
_MARKUP = re.compile(r"</?\w+>|[#*_`•▪●■]+")
#: A link of Markdown, which can continue on the next line.
_LINK = re.compile(r"\[(?P<shown>[^]\f]{0,200})\]\([^)\f]{0,300}\)")
_HEADING = re.compile(r"(?P<number>\d{1,2}(?:\.\d{1,2}){0,3})\.?\s*(?:-\s*)?(?P<title>[^\W\d].*|\"\S.*|\d\w+.*)")
_NUMBER = re.compile(r"\d+(?:\.\d+)*")
_IN_CONTENTS = re.compile(r"(?<!\.)\.{3,}\s*\d+$|(?<!\.)\.{5,}$|\t\s*\d+$")
_PAGE = re.compile(r"[\s\-]*\d{1,4}[\s\-]*|(?:page|pag\.?|seite)\s+\d{1,4}(?:\s*(?:of|di|/)\s*\d{1,4})?", re.IGNORECASE)
#: A word of a manual or a spec, or a sign that changes the meaning of one.
WORD = re.compile(r"(?<![\w.])-\d+(?:[.,:]\d+)*|\w+(?:[.,:]\d+)*|[±+<>≤≥%°]")
#: Least number of times that a line is printed to be a running head, and the longest such line.
_RUNNING, _LONGEST = 4, 120
#: Number of lines at the top or bottom of a page, and the least share of a running head that is printed there.
_EDGE, _MOSTLY = 4, 0.8
#: The same with a form feed between pages, which shows where they end.
_PAGE_EDGE = 2
#: Least share of a text over which page numbers are spread, unlike the numbers of steps or of the rows of a table.
_SPREAD = 0.5
#: Least number of lines from one page to the next, and largest factor by which a page is longer or shorter than usual.
_SHORT_PAGE, _FACTOR = 12, 2
#: Largest step between two page numbers that are found. The first page of a chapter often has none.
_PAGE_STEP = 3
#: References to pages and sections. Their numbers change with the layout of a manual.
_PAGE_REFERENCE = re.compile(
    r"(?:\b(?:on|at|a|alla|auf)\s+)?\b(?:pages?|pagin[ae]|pag\.|pp?\.|seite)\s*\d{1,4}(?:\s+ff?\b\.?)?"
    r"|\b(?:on|a|alla|auf) (?:page|pagina|seite)\b",
    re.IGNORECASE,
)
_SECTION_REFERENCE = re.compile(
    r"\"(?P<number>\d{1,2}(?:\.\d{1,2}){0,3})\s*(?:-\s*)?(?=(?P<title>[^\W\d][^\"]*|\"\w[^\"]*))"
)
#: Number of lines with a page from which contents are taken to be complete.
_FEW = 12
_DASHES = str.maketrans(dict.fromkeys("‐‑‒–—−", "-") | {"\u00ad": "", "\u200b": "", "’": "'", "“": '"', "”": '"'})


class NoText(Exception):
    """A file is not the text of a manual. The message says why."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section: its number or, without one, its title, the whole title, its words in order, and its page if known."""

    number: str
    title: str
    words: tuple[str, ...]
    page: int | None = None

    @property
    def shown(self) -> str:
        return self.title if self.number == self.title else f"{self.number} {self.title}"


@dataclass(frozen=True, slots=True)
class Manual:
    """The text of an edition.

    ``missing`` contains the listed sections for which the text has no heading.
    ``heads`` contains the letters of each running head.
    """

    sections: tuple[Section, ...]
    missing: Mapping[str, str]
    heads: frozenset[str] = frozenset()

    @property
    def words(self) -> Counter[str]:
        return Counter(word for section in self.sections for word in section.words)

    def without_heading_after(self, number: str) -> set[str]:
        """Return the sections whose heading is missing, and whose text therefore counts as part of this one."""
        order = [section.number for section in self.sections if _NUMBER.fullmatch(section.number)]
        if number not in order:
            return set()
        following = order[order.index(number) + 1 : order.index(number) + 2]
        start, end = _number_key(number), _number_key(following[0]) if following else (999,)
        return {missing_number for missing_number in self.missing if start < _number_key(missing_number) < end}


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
    text = _LINK.sub(lambda match: match["shown"], text)
    pages = [_plain_lines(page) for page in text.split("\f")]
    has_pages = len(pages) >= _RUNNING
    edges = _heads_at_edges(pages) if has_pages else set()
    pages_of_text = _without_edges(pages, edges) if has_pages else pages
    lines = _join_entry_lines([line for page in pages_of_text for line in page])
    numbered = {index: heading for index, line in enumerate(lines) if (heading := _numbered_heading(line)) is not None}
    listed = _contents(lines, numbered)
    titles = {numbered[index][0]: numbered[index][1] for index in sorted(listed, reverse=True)}
    headings, page_of = _headings(lines, numbered, listed, titles)
    running = set() if has_pages else _running_heads(lines, set(headings))
    left_out = running if has_pages else running | _page_numbers(lines)
    bodies: list[tuple[str, str, list[str]]] = [(COVER, COVER, [])]
    start = min((index for index, (number, _) in headings.items() if number[0].isdigit()), default=0)
    title_rest: list[str] = []
    for index, line in enumerate(lines):
        words = _folded_words(line)
        if index in headings:
            title = headings[index][1]
            bodies.append((*headings[index], []))
            title_rest = _folded_words(title)[len(_folded_words(_without_number(line))) :]
        elif words and words == title_rest[: len(words)]:
            title_rest = title_rest[len(words) :]  # The heading continues on this line.
        elif not (index < start and (index in listed or _IN_CONTENTS.search(line))) and index not in left_out:
            bodies[-1][2].append(line)
    sections: list[Section] = []
    for number, title, body in bodies:
        sections.append(Section(number, title, tuple(_words(body, titles)), page_of.get(number)))
    found_numbers = {number for number, _ in headings.values()}
    missing = {number: title for number, title in titles.items() if number[0] != "0" and number not in found_numbers}
    head_lines = [*edges, *(lines[index] for index in running)]
    heads = {letters([line]) for line in head_lines}
    return Manual(tuple(sections), missing, frozenset(heads - {""}))


def _plain_lines(page: str) -> list[str]:
    return [line for line in map(plain, page.split("\n")) if line.strip()]


def plain(line: str) -> str:
    """Return a line without markup, with ASCII letters, dashes and quotes, and a tab between the cells of a table."""
    line = line.strip().strip("|").replace("|", "\t")
    line = _MARKUP.sub(" ", unicodedata.normalize("NFKC", line).translate(_DASHES))
    line = re.sub(r"(?<![^\S\t])[^\S\t]{2,}(\d{1,4})$", r"\t\1", line)
    return re.sub(r" ?\t[ \t]*", "\t", re.sub(r"[^\S\t]+", " ", line)).strip()


def _join_entry_lines(lines: Sequence[str]) -> list[str]:
    """Join the two lines of a long entry of the contents, which has its page at the end of the second one.

    A running head between two rows of a table can look like one, but occurs often.
    """
    counts = Counter(map(_head, lines))
    joined_lines: list[str] = []
    for line in lines:
        last_lines = joined_lines[-2:]
        if (
            len(last_lines) == 2
            and _IN_CONTENTS.search(line)
            and _numbered_heading(line) is None
            and _numbered_heading(last_lines[1]) is not None
            and _IN_CONTENTS.search(last_lines[0])
            and not _IN_CONTENTS.search(last_lines[1])
            and counts[_head(last_lines[1])] < _RUNNING
        ):
            joined_lines[-1] = f"{last_lines[1]} {line}"
        else:
            joined_lines.append(line)
    return joined_lines


def _words(lines: Iterable[str], titles: Mapping[str, str]) -> list[str]:
    """Return the words of lines, without the numbers of pages and sections in references.

    A word that is hyphenated at the end of a line is one word.
    """

    def reference(match: re.Match[str]) -> str:
        return '"' if _same_start(titles.get(match["number"], ""), match["title"]) else match[0]

    text = re.sub(r"(?<=[a-zà-ÿ])-\n(?=[a-zà-ÿ])", "", "\n".join(lines))
    return WORD.findall(_SECTION_REFERENCE.sub(reference, _PAGE_REFERENCE.sub("", text)))


def letters(words: Iterable[str]) -> str:
    """Return the letters of words. The numbers of a running head change from page to page."""
    return re.sub(r"[\W\d_]+", "", "".join(words))


def _head(line: str) -> str:
    return re.sub(r"\d+", "#", line.strip())


def _page_numbers(lines: Sequence[str]) -> set[int]:
    """Return the lines that contain only a page number: the longest series of numbers that increase in small steps."""
    series: dict[int, list[int]] = {}
    for index, line in enumerate(lines):
        if _PAGE.fullmatch(line) and (number := re.search(r"\d{1,4}", line)):
            page = int(number[0])
            previous = max((series.get(page - step, []) for step in range(1, _PAGE_STEP + 1)), key=len)
            series[page] = max(series.get(page, []), [*previous, index], key=len)
    longest = max(series.values(), key=len, default=[])
    return set(longest) if len(longest) >= _RUNNING else set()


def _running_heads(lines: Sequence[str], headings: set[int]) -> set[int]:
    """Return the lines that are printed on many pages: page numbers, and identical lines next to them.

    A row of a table can also occur often. Its numbers do not increase each time, or the rows are close together.
    """
    places: dict[str, list[int]] = {}
    for index, line in enumerate(lines):
        if len(line) <= _LONGEST and index not in headings:
            places.setdefault(_head(line), []).append(index)
    frequent = {head: indexes for head, indexes in places.items() if len(indexes) >= _RUNNING}
    spread = {head: indexes for head, indexes in frequent.items() if indexes[-1] - indexes[0] >= _SPREAD * len(lines)}
    counting: set[str] = set()
    for head, indexes in spread.items():
        if _counts_pages([lines[index] for index in indexes]):
            counting.add(head)
    edges: list[int] = []
    for index in sorted(index for head in counting for index in frequent[head]):
        if not edges or index - edges[-1] > _EDGE:  # One page has only one, or the lines near it would count twice.
            edges.append(index)
    at_edges: Counter[str] = Counter()
    for edge in edges:
        at_edges.update({_head(line) for line in lines[max(edge - _EDGE, 0) : edge + _EDGE + 1]})
    heads = {head for head, indexes in spread.items() if _is_regular(indexes)}
    heads |= counting | {head for head, indexes in frequent.items() if at_edges[head] >= _MOSTLY * len(indexes)}
    return {index for head in heads for index in frequent[head]}


def _is_regular(places: Sequence[int]) -> bool:
    lengths = sorted(following - previous for previous, following in pairwise(places))
    usual = lengths[len(lengths) // 2]
    near = sum(usual <= _FACTOR * length <= _FACTOR**2 * usual for length in lengths)
    return usual >= _SHORT_PAGE and near >= _MOSTLY * len(lengths)


def _heads_at_edges(pages: Sequence[Sequence[str]]) -> set[str]:
    """Return the lines, with # for numbers, that occur often and mostly at the edges of pages."""
    counts = Counter(_head(line) for page in pages for line in page)
    edges = Counter(_head(line) for page in pages for line in (*page[:_PAGE_EDGE], *page[_PAGE_EDGE:][-_PAGE_EDGE:]))
    return {head for head, count in edges.items() if count >= max(_RUNNING, _MOSTLY * counts[head])}


def _without_edges(pages: Sequence[Sequence[str]], heads: Collection[str]) -> Iterator[Sequence[str]]:
    """Yield the pages without page numbers and running heads."""
    for page in pages:
        last = len(page) - _PAGE_EDGE
        lines: list[str] = []
        for index, line in enumerate(page):
            is_at_edge = not _PAGE_EDGE <= index < last
            if not is_at_edge or (_head(line) not in heads and not _PAGE.fullmatch(line)):
                lines.append(line)
        yield lines


def _counts_pages(lines: Sequence[str]) -> bool:
    """Return whether the numbers in lines increase from line to line, except those that are always the same."""
    numbers = [list(map(int, re.findall(r"\d{1,4}", line))) for line in lines]
    columns = [column for column in zip(*numbers, strict=False) if len(set(column)) > 1]
    return bool(columns) and all(map(_increases, columns))


def _increases(numbers: Sequence[int]) -> bool:
    return all(number < following for number, following in pairwise(numbers))


def _headings(
    lines: Sequence[str], numbered: Mapping[int, tuple[str, str]], listed: set[int], titles: Mapping[str, str]
) -> tuple[dict[int, tuple[str, str]], dict[str, int]]:
    """Return number and title of the headings by line, and the pages of those without a number.

    A heading is a numbered line whose number and words the contents list as well, or whose number they skip.
    """
    headings: dict[int, tuple[str, str]] = {}
    last: tuple[int, ...] = ()
    for index, (number, title) in numbered.items():
        key = _number_key(number)
        if index in listed or key <= last:
            continue
        if _same_start(titles.get(number, ""), title) or (number not in titles and _is_skipped(key, last, titles)):
            headings[index], last = (number, titles.get(number, title)), key
    start = min(headings, default=len(lines))
    places = {_title(line): index for index, line in enumerate(lines[:start]) if _IN_CONTENTS.search(line)}
    pages: dict[str, int] = {}
    for index, line in enumerate(lines[:start]):
        if places.get(line, index) < index:
            headings[index] = (line, line)
            page = re.search(r"\d+$", lines[places[line]])
            pages |= {line: int(page[0])} if page else {}
    return headings, pages


def _is_skipped(key: tuple[int, ...], last: tuple[int, ...], titles: Mapping[str, str]) -> bool:
    """Return whether the contents list the sections before and after a number, but not the number itself."""
    after = ".".join(map(str, (*key[:-1], key[-1] + 1)))
    return len(key) > 1 and last == (*key[:-1], key[-1] - 1) and after in titles


def _contents(lines: Sequence[str], numbered: Mapping[int, tuple[str, str]]) -> set[int]:
    """Return the numbered lines of the contents: those with a page, and the others up to the first lower number."""
    with_page = {index for index in numbered if _IN_CONTENTS.search(lines[index])}
    if len(with_page) >= _FEW:
        return with_page
    first = min(with_page or numbered, default=len(lines))
    indexes: set[int] = set()
    last: tuple[int, ...] = ()
    for index, (number, _) in numbered.items():
        if index >= first:
            key = _number_key(number)
            if key[:1] < last[:1]:
                break
            indexes.add(index)
            last = max(key, last)
    return indexes | with_page


def _number_key(number: str) -> tuple[int, ...]:
    return tuple(map(int, number.split(".")))


def _numbered_heading(line: str) -> tuple[str, str] | None:
    match = _HEADING.fullmatch(_title(line))
    return (match["number"], match["title"].strip()) if match is not None and len(line) <= _LONGEST else None


def _title(line: str) -> str:
    return _IN_CONTENTS.sub("", line).strip()


def _without_number(line: str) -> str:
    heading = _numbered_heading(line)
    return line if heading is None else heading[1]


def _folded_words(text: str) -> list[str]:
    return WORD.findall(text.casefold())


def _same_start(listed: str, title: str) -> bool:
    """Return whether two titles have the same first words."""
    first, second = (_folded_words(text)[:3] for text in (listed, title))
    return bool(first) and first[: len(second)] == second[: len(first)]


def aligned(old: Manual, new: Manual) -> Iterator[tuple[Section | None, Section | None]]:
    """Yield the sections of two editions in pairs, by title or else by number, with None for a missing one."""
    unpaired = {section.number: section for section in new.sections}
    pairs: dict[str, Section] = {}
    for find_same in (_same_section, _same_title, _same_number):
        for section in old.sections:
            if section.number not in pairs and (number := find_same(section, unpaired)) is not None:
                pairs[section.number] = unpaired.pop(number)
    yield from ((section, pairs.get(section.number)) for section in old.sections)
    yield from ((None, section) for section in unpaired.values())


def _same_section(section: Section, among: Mapping[str, Section]) -> str | None:
    same_number = among.get(section.number)
    return (
        section.number if same_number is not None and same_number.title.casefold() == section.title.casefold() else None
    )


def _same_title(section: Section, among: Mapping[str, Section]) -> str | None:
    numbers = (number for number, candidate in among.items() if candidate.title.casefold() == section.title.casefold())
    return next(numbers, None)


def _same_number(section: Section, among: Mapping[str, Section]) -> str | None:
    return section.number if section.number in among else None
