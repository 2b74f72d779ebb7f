"""Problems in a spec: where, what is wrong, and what would be right.

Nothing raises on a broken spec. Every step adds to a :class:`Report` and goes on with what is left, so that one run tells all.
"""

from __future__ import annotations

import difflib
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .read import Document

#: A place inside a spec: keys of maps, and for lists an index or the name of an item.
Path = tuple[str | int, ...]

_LONGEST_QUOTE = 60
_LONGEST_PATH = 200
#: Names among which the nearest is sought; among more it would take longer than the rest of the check.
_MOST_CHOICES = 500


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One finding. ``line`` and ``column`` count from 1; ``text`` is the offending line, or empty where there is none to show."""

    file: str
    line: int
    column: int
    rule: str
    path: str
    message: str
    text: str

    def format(self, width: int = 80) -> str:
        """The problem as lines of text without a final line break: place and message, the path, the offending line, a caret.

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
    """Collects problems over all documents of a run."""

    def __init__(self) -> None:
        self._problems: set[Problem] = set()

    def add(self, rule: str, document: Document, path: Path, message: str, *, at_key: bool = False) -> None:
        """Adds a problem at ``path`` of ``document``.

        Args:
            rule: The stable name of the rule.
            document: The document that is at fault.
            path: Where in it; a part of it that does not exist stands for its nearest ancestor.
            message: What is wrong, and what would be right.
            at_key: Point at the key rather than at its value.
        """
        line, column = document.position(path, at_key)
        self.add_at(document.file, line, column, rule, message, path=document.name_path(path), text=document.line(line))

    def add_at(self, file: str, line: int, column: int, rule: str, message: str, *, path: str = "", text: str = "") -> None:
        """Adds a problem at a place of a file, for what is wrong before there is a document."""
        self._problems.add(Problem(file, line, column, rule, path, message, text))

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


def suggestion(word: str, known: Iterable[str], otherwise: str = "known") -> str:
    """What to say after an unknown word: the nearest known one, or all where they are few, or nothing.

    Args:
        word: What was written.
        known: What could have been written.
        otherwise: The word before the list of all.
    """
    choices = [item for item in dict.fromkeys(known) if item != word]
    near = difflib.get_close_matches(word[:_LONGEST_QUOTE], choices, n=1, cutoff=0.6) if len(choices) <= _MOST_CHOICES else []
    if near:
        return f"; did you mean '{near[0]}'?"
    if choices and len(choices) <= 8:
        return f"; {otherwise}: {', '.join(choices)}"
    return ""


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
    """Terminal columns that a visible text takes."""
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
