"""Problems in a spec: the place, the error and the correction, with the nearest word. Also errors in users' templates.

A broken spec never raises an exception. Every step adds to a ``ProblemReport`` and continues with the remaining data,
so that one run reports everything.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, takewhile
from typing import Any

from .document import Document, excerpt, visible
from .document import Path as Path

#: Stands for prose that is missing, so that the rest of an item can be checked.
MISSING_PROSE = "?"
#: Keys for prose, on which no other part of a spec depends.
WORDS_ONLY = frozenset(("source", "note", "meaning", "title", "printed_name", "names", "why"))
#: Rule of the problem that ends the list of a document with too many problems.
TOO_MANY = "too-many-problems"
#: Largest number of problems listed for one document.
MAX_PROBLEMS = 200
#: Number of problems of one document after which no further rule is checked.
MAX_FOUND = 1000
LONGEST_QUOTE = 60
_LONGEST_PATH = 200
#: Largest number of further lines listed for problems with one cause.
_MOST_LINES = 12
#: Largest number of known words listed in a message.
_FEW_CHOICES = 11
#: The end of a line that introduces a text of several lines.
_BLOCK_TEXT_START = re.compile(r": [>|][+-]?\s*$")
_WORD_SEPARATORS = re.compile(r"[_\s-]")
_DIGITS = re.compile(r"[0-9]+")
#: Units at the end of a key. Keys with different units are never typos of each other: the number would be wrong.
UNITS = frozenset("hz khz mhz ghz ps ns us ms s nm um mm cm m mv v ma a bits bytes".split())


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One finding. ``line`` and ``column`` count from 1. ``text`` is the offending line, or empty.

    Problems of a file with the same rule and the same ``cause``, if there is one, are shown as one.
    """

    file: str
    line: int
    column: int
    rule: str
    path: str
    message: str
    text: str
    cause: str = ""

    def format(self, width: int = 80) -> str:
        """Return the problem as lines of text without a final line break: place and message, path, line and caret.

        Control characters are escaped, so that a hostile spec cannot move the cursor of a terminal.
        """
        lines = [f"{visible(self.file)}:{self.line}:{self.column}: {self.rule}: {visible(self.message)}"]
        if self.path:
            path = self.path if len(self.path) <= _LONGEST_PATH else f"{self.path[: _LONGEST_PATH - 3]}..."
            lines.append(f"  in {visible(path)}")
        # The line above a text of several lines contains none of its words.
        has_words = _BLOCK_TEXT_START.search(self.text) is None
        if has_words:
            lines += excerpt(self.text, self.column, width)
        return "\n".join(lines)

    def to_json(self) -> dict[str, str | int]:
        """Return the problem as a flat JSON object with the names of the attributes."""
        return {name: getattr(self, name) for name in ("file", "line", "column", "rule", "path", "message", "text")}


class ProblemReport:
    """The problems of all documents of a run.

    ``files`` lists the files that were read, ``passed_over`` lists files in folders that are not specs.
    """

    def __init__(self) -> None:
        self.files: list[str] = []
        self.passed_over: list[str] = []
        self._problems: set[Problem] = set()
        self._faults: dict[str, set[Path]] = {}

    def add(
        self,
        rule: str,
        document: Document,
        path: Path,
        message: str,
        *,
        at_key: bool = False,
        in_words: bool = False,
        cause: str = "",
    ) -> None:
        """Add a problem at ``path`` of ``document``.

        Args:
            rule: The stable name of the rule.
            document: The document with the problem.
            path: The place in it. If it does not exist, its nearest ancestor is used.
            message: The error and its correction.
            at_key: Point at the key rather than at its value.
            in_words: Only prose is affected. The place is not faulty, and everything built from it is reliable.
            cause: What the problem has in common with others of this rule, such as the name that is missing.
        """
        if not in_words and path and path[-1] not in WORDS_ONLY:
            self._faults.setdefault(document.key, set()).add(document.path_in_file(path))
        line, column = document.position(path, at_key)
        file = document.file_of(path)
        self.add_at(
            file or document.file,
            rule,
            message,
            line=line,
            column=column,
            path=document.name_path(path),
            text=document.line(line, file),
            cause=cause,
        )

    def add_at(
        self,
        file: str,
        rule: str,
        message: str,
        *,
        line: int = 1,
        column: int = 1,
        path: str = "",
        text: str = "",
        cause: str = "",
    ) -> None:
        """Add a problem at a place of a file, by default its start, for errors before a document exists.

        ``text`` is the line with the problem.
        """
        problem = Problem(
            file=file, line=line, column=column, rule=rule, path=path, message=message, text=text, cause=cause
        )
        self.add_problem(problem)

    def add_problem(self, problem: Problem) -> None:
        """Add a problem of another report. Its place is not marked as faulty."""
        self._problems.add(problem)

    def include(self, other_report: ProblemReport) -> None:
        """Add the problems of another report, and the places that it marks as faulty."""
        self._problems |= other_report._problems
        for key, paths in other_report._faults.items():
            self._faults.setdefault(key, set()).update(paths)

    def mark(self, document: Document, paths: Iterable[Path]) -> None:
        """Mark places of a document as faulty without a message, such as parts that were cut out with others."""
        faulty_paths = [path for path in paths if path and path[-1] not in WORDS_ONLY]
        self._faults.setdefault(document.key, set()).update(faulty_paths)

    def faults(self, document: Document) -> frozenset[Path]:
        """Return the faulty places of a document so far, as paths into the data as read, without faulty prose."""
        return frozenset(self._faults.get(document.key, ()))

    def for_document(self, document: Document) -> DocumentReport:
        """Return a view of this report for the rules that check one document."""
        return DocumentReport(self, document)

    @property
    def problems(self) -> tuple[Problem, ...]:
        """All problems, each once, sorted by file, line, column and rule."""
        return tuple(sorted(self._problems))

    @property
    def by_cause(self) -> tuple[Problem, ...]:
        """All problems, with the problems of one file that have the same rule and cause combined into the first one."""
        problems_by_cause: dict[object, list[Problem]] = {}
        for problem in self.problems:
            cause_or_problem = (problem.file, problem.rule, problem.cause) if problem.cause else problem
            problems_by_cause.setdefault(cause_or_problem, []).append(problem)
        return tuple(map(_combine_problems, problems_by_cause.values()))

    @property
    def faulty_files(self) -> frozenset[str]:
        """The files with problems."""
        return frozenset(problem.file for problem in self._problems)

    @property
    def shown(self) -> tuple[Problem, ...]:
        """The problems to list: for each file at most ``MAX_PROBLEMS``, then one with the number of the others."""
        shown_problems: list[Problem] = []
        for _, problems_of_file in groupby(self.by_cause, key=lambda problem: problem.file):
            shown_problems += _first_problems(list(problems_of_file))
        return tuple(shown_problems)

    def __len__(self) -> int:
        return len(self._problems)

    def __bool__(self) -> bool:
        return bool(self._problems)


def _combine_problems(problems: Sequence[Problem]) -> Problem:
    """Return the first of several problems with the same cause, with the line numbers of the others in its message.

    Other problems on the line of the first one are not mentioned.
    """
    first, *others = problems
    other_lines = dict.fromkeys(problem.line for problem in others)  # In order, each once.
    line_texts = [str(line) for line in other_lines if line != first.line]
    if not line_texts:
        return first
    noun = "line" if len(line_texts) == 1 else "lines"
    return replace(first, message=f"{first.message}; the same in {noun} {joined_lines(line_texts)}")


def joined_lines(lines: Sequence[str]) -> str:
    """Return line numbers as text, such as ``3, 5 and 9``, or the first ones and the number of the others."""
    if len(lines) > _MOST_LINES:
        first_lines = ", ".join(lines[:_MOST_LINES])
        return f"{first_lines} and {len(lines) - _MOST_LINES} more"
    return join_words(lines)


def _first_problems(file_problems: Sequence[Problem]) -> Iterator[Problem]:
    """Yield the problems of one file or, if there are too many, the first ones and one that counts the others."""
    # If the check ended early, one of the problems only says so. Then there may be more than were counted.
    counted_problems = [problem for problem in file_problems if problem.rule != TOO_MANY]
    unlisted_count = len(counted_problems) - MAX_PROBLEMS
    if unlisted_count <= 0:
        yield from file_problems
        return
    yield from counted_problems[:MAX_PROBLEMS]
    ended_early = len(counted_problems) < len(file_problems)
    count_text = f"at least {unlisted_count}" if ended_early else str(unlisted_count)
    if unlisted_count == 1:
        message = f"there is {count_text} more problem from here on; it is reported once these are fixed"
    else:
        message = f"there are {count_text} more problems from here on; they are reported once these are fixed"
    yield replace(counted_problems[MAX_PROBLEMS], rule=TOO_MANY, path="", message=message)


class DocumentReport:
    """A report bound to one document, as passed to rules."""

    def __init__(self, report: ProblemReport, document: Document) -> None:
        self._report = report
        self.document = document
        #: The data of the document that rules asked about last, and its leaves.
        self.leaves: tuple[Any, Sequence[tuple[Path, Any]]] = (None, ())

    def add(self, rule: str, path: Path, message: str, *, at_key: bool = False, cause: str = "") -> None:
        """Add a problem at ``path``, or at the key there. Problems with the same ``cause`` are shown as one."""
        self._report.add(rule, self.document, path, message, at_key=at_key, cause=cause)

    def mark(self, path: Path) -> None:
        """Mark a place as faulty without a message, because another problem explains it."""
        self._report.mark(self.document, [self.document.path_in_file(path)])

    def faults(self) -> frozenset[Path]:
        """Return the places with errors so far, as paths in the document before invalid parts were removed."""
        return self._report.faults(self.document)

    def __len__(self) -> int:
        """Return the number of problems so far, over all documents."""
        return len(self._report)


def quoted(value: Any) -> str:
    """Return a value as shown in messages: quoted text, shortened if long, a number, ``nothing`` or ``a list``."""
    if isinstance(value, str):
        return f"'{value}'" if len(value) <= LONGEST_QUOTE else f"'{value[: LONGEST_QUOTE - 3]}...'"
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a map"
    return "a list" if isinstance(value, list) else str(value)


def join_words(words: Iterable[str], last: str = "and") -> str:
    """Join words as ``a``, ``a and b`` or ``a, b and c``. ``last`` is the word before the last one."""
    items = list(words)
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def missing_keys_message(keys: Iterable[str], owner: str) -> str:
    """Return the message about missing keys, such as ``'a' and 'b' are missing; a clock needs them``."""
    quoted_keys = [quoted(key) for key in keys]
    are, them = ("is", "it") if len(quoted_keys) == 1 else ("are", "them")
    return f"{join_words(quoted_keys)} {are} missing; {owner} needs {them}"


def suggest_word(word: str, known_words: Iterable[str], otherwise: str = "known") -> str:
    """Return the hint for the end of a message about an unknown word: the known word that is probably meant.

    Without such a word, the hint lists all known words after the text ``otherwise``, or is empty if there are many.
    """
    choices = [known_word for known_word in dict.fromkeys(known_words) if known_word != word]
    nearest_word = nearest_choice(word, choices)
    if nearest_word:
        return f"; did you mean '{nearest_word}'?"
    if choices and len(choices) <= _FEW_CHOICES:
        return f"; {otherwise}: {', '.join(choices)}"
    return ""


def nearest_choice(word: str, choices: Sequence[str]) -> str:
    """Return the one choice that ``word`` misspells or abbreviates, or an empty string if there are none or several.

    Words that differ only in capitals and separators are preferred, then typos, then abbreviations.
    """
    if len(word) > LONGEST_QUOTE:  # Messages shorten such texts, so none is compared.
        return ""
    for is_similar in (_has_same_letters, is_typo, _is_abbreviation):
        similar_choices = [choice for choice in choices if is_similar(word, choice)]
        if similar_choices:
            return similar_choices[0] if len(similar_choices) == 1 else ""
    return ""


def _has_same_letters(word: str, known_word: str) -> bool:
    """Return True if two words differ only in capitals, underscores, hyphens and spaces."""
    return _keep_letters(word) == _keep_letters(known_word)


# A name is compared with each unknown word of a spec.
@functools.lru_cache(maxsize=10_000)
def _keep_letters(word: str) -> str:
    """Return a word in lower case, without underscores, hyphens and spaces."""
    return _WORD_SEPARATORS.sub("", word).lower()


def _common_prefix_length(word: str, other_word: str) -> int:
    """Return the length of the common prefix of two words."""
    pairs = zip(word, other_word, strict=False)  # up to the end of the shorter
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def is_typo(word: str, known_word: str) -> bool:
    """Return True if a word is probably a typo: one extra, missing or wrong letter, or two swapped letters.

    Differences in the first letter, digits or units are rarely typos: reset is not preset, biss_4 not biss_6, min_khz
    not min_hz. The shorter word needs 5 letters for a wrong letter, 4 for other typos, and 3 for an s at the end.
    """
    if abs(len(word) - len(known_word)) > 1 or not _has_same_digits_and_units(word, known_word):
        return False
    # What remains between the common beginning and the common end are the differing letters: in posiion and position,
    # between "posi" and "ion", the texts "" and "t".
    prefix_length = _common_prefix_length(word, known_word)
    # The common end is searched after the beginning, so that no letter counts for both.
    reversed_ending, reversed_known_ending = word[prefix_length:][::-1], known_word[prefix_length:][::-1]
    suffix_length = _common_prefix_length(reversed_ending, reversed_known_ending)
    differing_letters = word[prefix_length : len(word) - suffix_length]
    known_letters = known_word[prefix_length : len(known_word) - suffix_length]
    shorter_length = min(len(word), len(known_word))
    if len(differing_letters) == 2 and len(known_letters) == 2:
        are_swapped = differing_letters == known_letters[::-1]
        return are_swapped and shorter_length >= 4
    differs_in_first_letter = prefix_length == 0
    differs_in_several_letters = len(differing_letters) > 1 or len(known_letters) > 1
    if differs_in_first_letter or differs_in_several_letters:
        return False
    # For an extra or missing letter, one of the two texts is empty.
    is_plural = suffix_length == 0 and "s" in (differing_letters, known_letters)
    if is_plural:
        return shorter_length >= 3
    is_wrong_letter = len(differing_letters) == len(known_letters)
    return shorter_length >= (5 if is_wrong_letter else 4)


def _has_same_digits_and_units(word: str, known_word: str) -> bool:
    """Return True if two words have the same digits and do not end in two different units, such as hz and khz."""
    if _DIGITS.findall(word) != _DIGITS.findall(known_word):
        return False
    _, _, ending = word.rpartition("_")  # ``hz`` of ``min_hz``.
    _, _, known_ending = known_word.rpartition("_")
    return ending == known_ending or ending not in UNITS or known_ending not in UNITS


def _is_abbreviation(word: str, known_word: str) -> bool:
    """Return True if a word of at least 4 letters is the beginning of a known word with the same digits and unit."""
    return len(word) >= 4 and known_word.startswith(word) and _has_same_digits_and_units(word, known_word)


TEMPLATE_SUFFIX = ".jinja"


class TemplateFault(ValueError):
    """An error in a user's template. The message gives the location and the reason in one line."""
