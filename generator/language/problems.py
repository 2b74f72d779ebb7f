"""Problems in a spec: where, what is wrong, and what would be right.

Nothing raises on a broken spec. Every step adds to a :class:`Report` and goes on with what is left,
so that one run tells all.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

from .document import Document
from .document import Path as Path

#: Keys on which nothing else in a spec depends.
WORDS_ONLY = frozenset(("source", "note", "meaning", "title", "printed_name", "names", "why"))
_LONGEST_QUOTE = 60
_LONGEST_PATH = 200
#: Known words that a message lists.
_FEW_CHOICES = 9
_BETWEEN = re.compile(r"[_\s-]")
_DIGITS = re.compile(r"[0-9]+")
#: Units at the end of a key. Two words that differ in their unit are not one word misspelt: the number would be wrong.
UNITS = frozenset("hz khz mhz ghz ps ns us ms s nm um mm cm m mv v ma a bits bytes".split())


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One finding. ``line`` and ``column`` count from 1; ``text`` is the offending line, empty where there is none."""

    file: str
    line: int
    column: int
    rule: str
    path: str
    message: str
    text: str

    def format(self, width: int = 80) -> str:
        """The problem as lines of text without a last line break: place and message, path, offending line, a caret.

        Control characters are made visible, so that a hostile spec cannot move the cursor of a terminal.
        """
        lines = [f"{visible(self.file)}:{self.line}:{self.column}: {self.rule}: {visible(self.message)}"]
        if self.path:
            path = self.path if len(self.path) <= _LONGEST_PATH else f"{self.path[: _LONGEST_PATH - 3]}..."
            lines.append(f"  in {visible(path)}")
        if self.text.strip():
            shown, caret = _window(self.text, self.column, max(width, 20) - 4)
            lines += [f"    {shown}", f"    {' ' * caret}^"]
        return "\n".join(lines)

    def to_json(self) -> dict[str, str | int]:
        """The problem as a flat JSON object with the names of the attributes."""
        return {name: getattr(self, name) for name in ("file", "line", "column", "rule", "path", "message", "text")}


class Report:
    """Collects problems over all documents of a run.

    ``files`` are those that were read, ``passed_over`` those in folders that are no specs.
    """

    def __init__(self) -> None:
        self.files: list[str] = []
        self.passed_over: list[str] = []
        self._problems: set[Problem] = set()
        self._faults: dict[str, set[Path]] = {}

    def add(
        self, rule: str, document: Document, path: Path, message: str, *, at_key: bool = False, in_words: bool = False
    ) -> None:
        """Adds a problem at ``path`` of ``document``.

        Args:
            rule: The stable name of the rule.
            document: The document that is at fault.
            path: Where in it; a part of it that does not exist stands for its nearest ancestor.
            message: What is wrong, and what would be right.
            at_key: Point at the key rather than at its value.
            in_words: Only words are at fault: all that is made of the place can be relied on.
        """
        if not in_words and path and path[-1] not in WORDS_ONLY:
            self._faults.setdefault(document.key, set()).add(document.original(path))
        line, column = document.position(path, at_key)
        file = document.file_of(path)
        text = document.line(line, file)
        self.add_at(file or document.file, line, column, rule, message, path=document.name_path(path), text=text)

    def add_at(
        self, file: str, line: int, column: int, rule: str, message: str, *, path: str = "", text: str = ""
    ) -> None:
        """Adds a problem at a place of a file, for what is wrong before there is a document."""
        self._problems.add(Problem(file, line, column, rule, path, message, text))

    def mark(self, document: Document, paths: Iterable[Path]) -> None:
        """Notes places of a document as at fault without a word on them: what was left out with a part of it."""
        self._faults.setdefault(document.key, set()).update(
            path for path in paths if path and path[-1] not in WORDS_ONLY
        )

    def faults(self, document: Document) -> frozenset[Path]:
        """Where a document is at fault so far, as paths into the data as read; slips in mere words left out."""
        return frozenset(self._faults.get(document.key, ()))

    def for_document(self, document: Document) -> DocumentReport:
        """The view of this report through which rules speak about one document."""
        return DocumentReport(self, document)

    @property
    def problems(self) -> tuple[Problem, ...]:
        """All problems, each once, by file, line, column and rule."""
        return tuple(sorted(self._problems))

    def __len__(self) -> int:
        return len(self._problems)

    def __bool__(self) -> bool:
        return bool(self._problems)


class DocumentReport:
    """What a rule gets: the report, with the document filled in."""

    def __init__(self, report: Report, document: Document) -> None:
        self._report = report
        self.document = document

    def add(self, rule: str, path: Path, message: str, *, at_key: bool = False) -> None:
        """Adds a problem at ``path``; see :meth:`Report.add`."""
        self._report.add(rule, self.document, path, message, at_key=at_key)

    def faults(self) -> frozenset[Path]:
        """Where the document is at fault so far; see :meth:`Report.faults`."""
        return self._report.faults(self.document)

    def __len__(self) -> int:
        """How many problems there are so far, over all documents."""
        return len(self._report)


def quoted(value: Any) -> str:
    """A value of a spec as a message shows it: text in quotes and not too long, a container by its kind."""
    if isinstance(value, str):
        return f"'{value}'" if len(value) <= _LONGEST_QUOTE else f"'{value[: _LONGEST_QUOTE - 3]}...'"
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a map"
    return "a list" if isinstance(value, list) else str(value)


def listed(words: Iterable[str], last: str = "and") -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    items = list(words)
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} {last} {items[-1]}" if items else ""


def missing(keys: Iterable[str], owner: str) -> str:
    """What to say of keys that are missing, and of what needs them."""
    named = [quoted(key) for key in keys]
    are, them = ("is", "it") if len(named) == 1 else ("are", "them")
    return f"{listed(named)} {are} missing; {owner} needs {them}"


def suggestion(word: str, known: Iterable[str], otherwise: str = "known") -> str:
    """What to say after an unknown word: the known one that it is a slip of, or all where they are few, or nothing.

    Args:
        word: What was written.
        known: What could have been written.
        otherwise: The word before the list of all.
    """
    choices = [item for item in dict.fromkeys(known) if item != word]
    near = meant(word, choices)
    if near:
        return f"; did you mean '{near}'?"
    if choices and len(choices) <= _FEW_CHOICES:
        return f"; {otherwise}: {', '.join(choices)}"
    return ""


def meant(word: str, choices: Sequence[str]) -> str:
    """The one choice that ``word`` is a slip or an abbreviation of, or empty."""
    if len(word) > _LONGEST_QUOTE:
        return ""
    for alike in (_is_spelling, _is_slip, _is_abbreviation):
        found = [item for item in choices if alike(word, item)]
        if found:
            return found[0] if len(found) == 1 else ""
    return ""


def _is_spelling(word: str, known: str) -> bool:
    """The same but for capitals, underscores, hyphens and spaces."""
    return _BETWEEN.sub("", word).lower() == _BETWEEN.sub("", known).lower()


def _alike(one: str, other: str) -> int:
    """How many characters two words have in common, from the first on."""
    pairs = takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False))  # up to the end of the shorter
    return sum(1 for _ in pairs)


def _is_slip(word: str, known: str) -> bool:
    """One letter too many, missing or wrong, or two that changed places; and not another word of the trade.

    Short words, first letters, digits and units are seldom slips: spi is not ssi, reset not preset,
    biss_4 not biss_6, min_khz not min_hz.
    """
    if abs(len(word) - len(known)) > 1 or not _same_sense(word, known):
        return False
    start = _alike(word, known)
    end = _alike(word[start:][::-1], known[start:][::-1])
    here, there = word[start : len(word) - end], known[start : len(known) - end]
    shortest = min(len(word), len(known))
    if len(here) == len(there) == 2:
        return shortest >= 4 and here == there[::-1]
    if not start or len(here) > 1 or len(there) > 1:
        return False
    plural = not end and "s" in (here, there)
    return shortest >= (3 if plural else 4 if len(here) != len(there) else 5)


def _same_sense(word: str, known: str) -> bool:
    units = {text.rpartition("_")[2] for text in (word, known)}
    return _DIGITS.findall(word) == _DIGITS.findall(known) and not (len(units) == 2 and units <= UNITS)


def _is_abbreviation(word: str, known: str) -> bool:
    return len(word) >= 4 and known.startswith(word) and _same_sense(word, known)


def visible(text: str) -> str:
    """The text with every character that a terminal would act on written as an escape."""
    return "".join(map(_visible_character, text))


def _visible_character(character: str) -> str:
    if unicodedata.category(character) not in ("Cc", "Cf", "Cs", "Zl", "Zp"):
        return character
    if character == "\t":
        return "\\t"
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _columns(text: str) -> int:
    wide = sum(unicodedata.east_asian_width(character) in "WF" for character in text)
    combining = sum(unicodedata.combining(character) != 0 for character in text)
    return len(text) + wide - combining


def _window(text: str, column: int, width: int) -> tuple[str, int]:
    """The part of a line to show without its indentation, and the offset of the caret in it.

    A line that is too long is scrolled so that the caret stands in sight, with more of what comes before it than after.
    """
    indent = len(text) - len(text.lstrip(" "))
    stripped = text.strip(" ")
    caret = max(0, min(column - 1 - indent, len(stripped)))
    # One character takes a column at least, so nothing further off can be shown; a line may have millions.
    first = max(0, caret - width)
    before = [_visible_character(character) for character in stripped[first:caret]]
    after = [_visible_character(character) for character in stripped[caret : caret + width + 1]]
    if first or _columns("".join(before + after)) > width:
        start = _fitting(before[::-1], width * 2 // 3)
        cut = first > 0 or start < len(before)
        before = ["...", *before[len(before) - start :]] if cut else before
        room = width - _columns("".join(before))
        if _columns("".join(after)) > room:
            after = [*after[: _fitting(after, room - 3)], "..."]
    return "".join(before + after), _columns("".join(before))


def _fitting(pieces: Sequence[str], room: int) -> int:
    """How many of the pieces, from the first on, fit into so many columns."""
    used = 0
    for count, piece in enumerate(pieces):
        used += _columns(piece)
        if used > room:
            return count
    return len(pieces)
