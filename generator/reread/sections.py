"""Divide the text of a manual into its sections, and each section into words, without text of the page layout."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import chain
from pathlib import Path

from .page_layout import (
    LEAST_REPETITIONS,
    LONGEST_HEAD,
    find_heads_at_edges,
    find_lines_of_page_numbers,
    find_lines_of_running_heads,
    without_digits,
    without_edges,
)

#: Largest text that is read, in bytes. Manuals have about 100,000 bytes.
MOST_BYTES = 20_000_000
#: Section of the text before the first heading.
COVER = "Cover"
_MARKUP_CHARACTERS = re.compile(r"</?\w+>|[#*_`•▪●■]+")
#: A link of Markdown, which can continue on the next line.
_MARKDOWN_LINK = re.compile(r"\[(?P<shown>[^]\f]{0,200})\]\([^)\f]{0,300}\)")
_HEADING_LINE = re.compile(r"(?P<number>\d{1,2}(?:\.\d{1,2}){0,3})\.?\s*(?:-\s*)?(?P<title>[^\W\d].*|\"\S.*|\d\w+.*)")
_SECTION_NUMBER = re.compile(r"\d+(?:\.\d+)*")
_IN_CONTENTS = re.compile(r"(?<!\.)\.{3,}\s*\d+$|(?<!\.)\.{5,}$|\t\s*\d+$")
#: A word of a manual or a spec, or a sign that changes the meaning of a word.
WORD = re.compile(r"(?<![\w.])-\d+(?:[.,:]\d+)*|\w+(?:[.,:]\d+)*|[±+<>≤≥%°]")
#: References to pages and sections. Their numbers change with the layout of a manual.
_PAGE_REFERENCE = re.compile(
    r"(?:\b(?:on|at|a|alla|auf)\s+)?\b(?:pages?|pagin[ae]|pag\.|pp?\.|seite)\s*\d{1,4}(?:\s+ff?\b\.?)?"
    r"|\b(?:on|a|alla|auf) (?:page|pagina|seite)\b",
    re.IGNORECASE,
)
_SECTION_REFERENCE = re.compile(
    r"\"(?P<number>\d{1,2}(?:\.\d{1,2}){0,3})\s*(?:-\s*)?(?=(?P<title>[^\W\d][^\"]*|\"\w[^\"]*))"
)
#: A table of contents is assumed to be complete if at least this number of lines have a page.
_COMPLETE_CONTENTS = 12
#: Sort key that comes after the numbers of all sections.
_AFTER_ALL_SECTIONS = (999,)
_PLAIN_MARKS = str.maketrans(dict.fromkeys("‐‑‒–—−", "-") | {"\u00ad": "", "\u200b": "", "’": "'", "“": '"', "”": '"'})


class NoText(Exception):
    """A file is not the text of a manual. The message says why."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section of a manual: its number, its title, its words in order, and its page if this is known."""

    #: Number of the section, or its title if it has no number.
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

    ``missing`` contains the sections in the table of contents for which the text has no heading. ``heads`` contains the
    letters of each running head.
    """

    sections: tuple[Section, ...]
    missing: Mapping[str, str]
    heads: frozenset[str] = frozenset()

    @property
    def words(self) -> Counter[str]:
        return Counter(word for section in self.sections for word in section.words)

    def without_heading_after(self, number: str) -> set[str]:
        """Return the numbers of the sections whose text follows section ``number`` without a heading of its own.

        These are the numbers in the table of contents between ``number`` and the next number in the text.
        """
        section_numbers = [section.number for section in self.sections if _SECTION_NUMBER.fullmatch(section.number)]
        if number not in section_numbers:
            return set()
        next_index = section_numbers.index(number) + 1
        start_key = _number_key(number)
        end_key = _number_key(section_numbers[next_index]) if next_index < len(section_numbers) else _AFTER_ALL_SECTIONS
        return {missing_number for missing_number in self.missing if start_key < _number_key(missing_number) < end_key}


def read_manual(path: Path) -> Manual:
    """Read the text of a manual from a text file in UTF-8 or from a PDF.

    Raises:
        NoText: The file cannot be read, is too large, or has no text.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise NoText(f"{path} has more than {MOST_BYTES:,} bytes")
        file_bytes = path.read_bytes()
    except OSError as error:
        raise NoText(f"cannot read {path}: {error.strerror or error}") from None
    if file_bytes.startswith(b"%PDF-"):
        manual_text = _text_of_pdf(path)
    else:
        try:
            manual_text = file_bytes.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise NoText(f"{path} is not UTF-8 text; convert it, or give the PDF") from None
    manual = divide_into_sections(manual_text)
    if not manual.words:
        raise NoText(f"{path} has no text; run text recognition (OCR) on a scanned manual first")
    return manual


def _text_of_pdf(path: Path) -> str:
    """Return the text of a PDF, with form feeds between its pages.

    Raises:
        NoText: The package pypdf is missing, or cannot read the file.
    """
    try:
        pypdf = import_module("pypdf")
    except ImportError:
        raise NoText(f"{path} is a PDF, which needs the package pypdf: pip install 'codewheel[pdf]'") from None
    try:
        return "\f".join(page.extract_text() for page in pypdf.PdfReader(path).pages)
    except Exception as error:  # A damaged PDF can raise any exception.
        raise NoText(f"cannot read {path}: {error}") from None


#: A heading: the number of its section, or its title if it has none, and its title.
_Heading = tuple[str, str]


def _numbered_lines(lines: Sequence[str]) -> dict[int, _Heading]:
    """Return the lines that can be headings with a number, by their index."""
    heading_by_line: dict[int, _Heading] = {}
    for index, line in enumerate(lines):
        heading = _numbered_heading(line)
        if heading is not None:
            heading_by_line[index] = heading
    return heading_by_line


def divide_into_sections(text: str) -> Manual:
    """Divide the text of a manual into its sections, without the table of contents, page numbers and running heads.

    Form feeds separate pages. Running heads are found at the edges of the pages, or, if there are fewer than 4 pages,
    by their repetition.
    """
    text_without_links = _MARKDOWN_LINK.sub(lambda match: match["shown"], text)
    pages = [_plain_lines(page) for page in text_without_links.split("\f")]
    has_pages = len(pages) >= LEAST_REPETITIONS
    heads_at_edges = find_heads_at_edges(pages) if has_pages else set()
    pages_of_text = without_edges(pages, heads_at_edges) if has_pages else pages
    lines = _join_entry_lines(list(chain.from_iterable(pages_of_text)))
    numbered_lines = _numbered_lines(lines)
    contents_lines = _contents_lines(lines, numbered_lines)
    # If two entries have the same number, the first one is valid. Later pairs replace earlier ones in ``dict``, so the
    # lines are in reverse order.
    title_by_number = dict(numbered_lines[index] for index in sorted(contents_lines, reverse=True))
    headings, page_by_title = _find_headings(lines, numbered_lines, contents_lines, title_by_number)
    running_heads: set[int] = set()
    page_numbers: set[int] = set()
    if not has_pages:
        running_heads = find_lines_of_running_heads(lines, set(headings))
        page_numbers = find_lines_of_page_numbers(lines)
    sections: list[Section] = []
    for (number, title), body_lines in _lines_below_headings(
        lines, headings, contents_lines, running_heads | page_numbers
    ):
        words = tuple(_words_without_numbers(body_lines, title_by_number))
        sections.append(Section(number=number, title=title, words=words, page=page_by_title.get(number)))
    # Running heads are compared by their letters, because their page numbers change.
    lines_of_heads = [*heads_at_edges, *(lines[index] for index in running_heads)]
    letters_of_running_heads = {joined_letters([line]) for line in lines_of_heads}
    return Manual(
        sections=tuple(sections),
        missing=_missing_titles(title_by_number, headings),
        heads=frozenset(letters_of_running_heads - {""}),
    )


def _lines_below_headings(
    lines: Sequence[str], headings: Mapping[int, _Heading], contents_lines: set[int], skipped_lines: set[int]
) -> list[tuple[_Heading, list[str]]]:
    """Return each heading with the lines below it, beginning with the cover, the text before the first heading.

    Lines of the table of contents and lines with an index in ``skipped_lines`` are left out. If a title continues on
    the next lines, these are not part of the text below it.
    """
    numbered_headings = [index for index, (number, _) in headings.items() if number[0].isdigit()]
    first_numbered_heading = min(numbered_headings, default=0)
    headings_and_bodies: list[tuple[_Heading, list[str]]] = [((COVER, COVER), [])]
    remaining_title_words: list[str] = []
    for index, line in enumerate(lines):
        folded_words = _folded_words(line)
        # A line with dots and a page only belongs to the table of contents if it is before the first heading.
        is_in_contents = index < first_numbered_heading and (index in contents_lines or _IN_CONTENTS.search(line))
        if index in headings:
            _, title = headings[index]
            headings_and_bodies.append((headings[index], []))
            words_on_this_line = _folded_words(_without_number(line))
            remaining_title_words = _folded_words(title)[len(words_on_this_line) :]
        elif folded_words and folded_words == remaining_title_words[: len(folded_words)]:
            remaining_title_words = remaining_title_words[len(folded_words) :]  # The heading continues on this line.
        elif not is_in_contents and index not in skipped_lines:
            _, body = headings_and_bodies[-1]
            body.append(line)
    return headings_and_bodies


def _missing_titles(title_by_number: Mapping[str, str], headings: Mapping[int, _Heading]) -> dict[str, str]:
    """Return the titles in the table of contents for which the text has no heading, by number: ``{"4.3": "Preset"}``.

    Numbers that begin with 0, such as numbers of revisions, are left out.
    """
    numbers_in_text = {number for number, _ in headings.values()}
    missing_titles: dict[str, str] = {}
    for number, title in title_by_number.items():
        if number[0] != "0" and number not in numbers_in_text:
            missing_titles[number] = title
    return missing_titles


def _plain_lines(page: str) -> list[str]:
    return [line for line in map(plain_line, page.split("\n")) if line.strip()]


def plain_line(line: str) -> str:
    """Return a line without markup, with ASCII dashes and quotes, and a tab before each cell or page number."""
    with_tabs = line.strip().strip("|").replace("|", "\t")
    ascii_line = unicodedata.normalize("NFKC", with_tabs).translate(_PLAIN_MARKS)
    without_markup = _MARKUP_CHARACTERS.sub(" ", ascii_line)
    # Two or more spaces before a page become a tab: "4.3 Preset    17" becomes "4.3 Preset\t17".
    with_tab_before_page = re.sub(r"(?<![^\S\t])[^\S\t]{2,}(\d{1,4})$", r"\t\1", without_markup)
    # "max.  10 \t MHz" becomes "max. 10 \t MHz", and then "max. 10\tMHz".
    with_single_spaces = re.sub(r"[^\S\t]+", " ", with_tab_before_page)
    return re.sub(r" ?\t[ \t]*", "\t", with_single_spaces).strip()


def _join_entry_lines(lines: Sequence[str]) -> list[str]:
    """Return the lines of a manual, with each entry of the table of contents that occupies two lines on one line.

    A running head between two rows of a table can look like the first line of an entry, but is repeated often.
    """
    repetitions = Counter(map(without_digits, lines))
    joined_lines: list[str] = []
    for line in lines:
        has_two_lines_before = len(joined_lines) >= 2
        is_second_line = has_two_lines_before and _continues_entry(joined_lines[-2], joined_lines[-1], line)
        if is_second_line and repetitions[without_digits(joined_lines[-1])] < LEAST_REPETITIONS:
            joined_lines[-1] += f" {line}"
        else:
            joined_lines.append(line)
    return joined_lines


def _continues_entry(line_before: str, first_line: str, second_line: str) -> bool:
    """Return whether two lines are one entry of the table of contents.

    The line before them must be an entry with a page. The first of the two lines has a number but no page, and the
    second one only has a page.
    """
    is_after_entry = bool(_IN_CONTENTS.search(line_before))
    begins_entry = _numbered_heading(first_line) is not None and not _IN_CONTENTS.search(first_line)
    ends_entry = _numbered_heading(second_line) is None and bool(_IN_CONTENTS.search(second_line))
    return is_after_entry and begins_entry and ends_entry


def _words_without_numbers(lines: Iterable[str], title_by_number: Mapping[str, str]) -> list[str]:
    """Return the words in some lines, without the numbers in references to pages and sections.

    A word that is hyphenated at the end of a line is one word. The number in a reference such as ``"4.3 Preset"`` is
    removed if the table of contents lists it with this title.
    """

    def without_number(reference: re.Match[str]) -> str:
        """Return the opening quotation mark of a reference, without the number after it. The title is not matched."""
        listed_title = title_by_number.get(reference["number"], "")
        is_reference = _have_same_start(listed_title, reference["title"])
        return '"' if is_reference else reference[0]

    # A word that is divided at the end of a line: "resolu-\ntion" becomes "resolution".
    without_hyphens = re.sub(r"(?<=[a-zà-ÿ])-\n(?=[a-zà-ÿ])", "", "\n".join(lines))
    without_pages = _PAGE_REFERENCE.sub("", without_hyphens)
    return WORD.findall(_SECTION_REFERENCE.sub(without_number, without_pages))


def joined_letters(words: Iterable[str]) -> str:
    """Return the letters of words as one text, such as the letters of a running head without its page."""
    # All characters except letters are removed: "ABC5A - 12" becomes "ABCA".
    return re.sub(r"[\W\d_]+", "", "".join(words))


def _find_headings(
    lines: Sequence[str],
    numbered_lines: Mapping[int, _Heading],
    contents_lines: set[int],
    title_by_number: Mapping[str, str],
) -> tuple[dict[int, _Heading], dict[str, int]]:
    """Return the number and title of each heading by line, and the pages of headings without a number by title.

    A numbered line is a heading if its number is higher than those before it, and the table of contents lists it with
    the same first words or skips it. A line without a number, such as a preface, is a heading if the table of contents
    before it has an entry with the same text.
    """
    headings: dict[int, _Heading] = {}
    last_number_key: tuple[int, ...] = ()
    for index, (number, title) in numbered_lines.items():
        number_key = _number_key(number)
        if index in contents_lines or number_key <= last_number_key:
            continue
        has_listed_title = _have_same_start(title_by_number.get(number, ""), title)
        is_skipped = number not in title_by_number and _is_skipped_in_contents(
            number_key, last_number_key, title_by_number
        )
        if has_listed_title or is_skipped:
            headings[index] = number, title_by_number.get(number, title)
            last_number_key = number_key
    # Headings without a number are only searched for before the numbered headings.
    first_numbered_heading = min(headings, default=len(lines))
    unnumbered_headings, page_by_title = _find_unnumbered_headings(lines[:first_numbered_heading])
    return headings | unnumbered_headings, page_by_title


def _find_unnumbered_headings(lines: Sequence[str]) -> tuple[dict[int, _Heading], dict[str, int]]:
    """Return the headings without a number by line, and their pages in the table of contents by title.

    Such a heading has the same text as an entry of the table of contents before it.
    """
    entry_index_by_title: dict[str, int] = {}
    for index, line in enumerate(lines):
        if _IN_CONTENTS.search(line):
            entry_index_by_title[_entry_title(line)] = index
    headings: dict[int, _Heading] = {}
    page_by_title: dict[str, int] = {}
    for index, line in enumerate(lines):
        is_after_its_entry = line in entry_index_by_title and entry_index_by_title[line] < index
        if is_after_its_entry:
            headings[index] = line, line
            page_match = re.search(r"\d+$", lines[entry_index_by_title[line]])
            if page_match is not None:
                page_by_title[line] = int(page_match[0])
    return headings, page_by_title


def _is_skipped_in_contents(
    number_key: tuple[int, ...], last_key: tuple[int, ...], title_by_number: Mapping[str, str]
) -> bool:
    """Return whether the table of contents lists the sections before and after a number, but not the number itself.

    ``number_key`` is the number, such as ``(4, 3)``. The last heading, ``last_key``, must then be ``(4, 2)``, and the
    contents must list 4.4.
    """
    *chapter, last_number = number_key
    key_before = (*chapter, last_number - 1)
    number_after = ".".join(map(str, (*chapter, last_number + 1)))
    return bool(chapter) and last_key == key_before and number_after in title_by_number


def _contents_lines(lines: Sequence[str], numbered_lines: Mapping[int, _Heading]) -> set[int]:
    """Return the indices of the numbered lines of the table of contents.

    If at least 12 lines have a page, these are all lines of the table. Otherwise, the table ends before the first line
    with a lower chapter, where the text begins with chapter 1 again.
    """
    lines_with_page = {index for index in numbered_lines if _IN_CONTENTS.search(lines[index])}
    if len(lines_with_page) >= _COMPLETE_CONTENTS:
        return lines_with_page
    first_line = min(lines_with_page or numbered_lines, default=len(lines))
    contents_lines: set[int] = set()
    highest_key: tuple[int, ...] = ()
    for index, (number, _) in numbered_lines.items():
        if index < first_line:
            continue
        number_key = _number_key(number)
        is_lower_chapter = number_key[:1] < highest_key[:1]
        if is_lower_chapter:
            break
        contents_lines.add(index)
        highest_key = max(number_key, highest_key)
    return contents_lines | lines_with_page


def _number_key(section_number: str) -> tuple[int, ...]:
    """Return the number of a section as a key for sorting: ``(4, 3, 2)`` for ``4.3.2``."""
    return tuple(map(int, section_number.split(".")))


def _numbered_heading(line: str) -> _Heading | None:
    """Return the number and title of a line: ``("4.3", "Preset")`` for ``4.3 Preset ..... 21``.

    Return None for a line without a number and for a very long line.
    """
    heading_match = _HEADING_LINE.fullmatch(_entry_title(line))
    if heading_match is None or len(line) > LONGEST_HEAD:
        return None
    return heading_match["number"], heading_match["title"].strip()


def _entry_title(line: str) -> str:
    """Return a line without the dots and the page at the end of an entry of the table of contents."""
    return _IN_CONTENTS.sub("", line).strip()


def _without_number(line: str) -> str:
    """Return the title of a numbered line, or any other line as it is."""
    heading = _numbered_heading(line)
    if heading is None:
        return line
    _, title = heading
    return title


def _folded_words(text: str) -> list[str]:
    return WORD.findall(text.casefold())


def _have_same_start(listed_title: str, title: str) -> bool:
    """Return whether two titles have the same first three words, or as many as the shorter one has."""
    listed_words, words = _folded_words(listed_title)[:3], _folded_words(title)[:3]
    common_length = min(len(listed_words), len(words))
    return bool(listed_words) and listed_words[:common_length] == words[:common_length]
