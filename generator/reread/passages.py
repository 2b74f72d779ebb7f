"""Find the passages that differ between two editions, section by section."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from .sections import WORD, Manual, Section, aligned, letters

#: Differences with no more equal words between them are one passage.
_TOGETHER = 6
#: Words before and after a difference that belong to its passage. The name of a register is often far above.
_BEFORE, _AFTER = 60, 20
#: Words before and after a difference that are close to it, such as the rest of a row.
_CLOSE = 8
#: Words shown before and after a difference.
_SHOWN = 5
#: Least share of common words for texts in the same language.
_SAME_LANGUAGE = 0.5


@dataclass(frozen=True, slots=True)
class Passage:
    """A difference: its ``section`` in the old edition, or in the new one if it is new.

    ``old`` and ``new`` contain the words that differ, ``close`` and ``around`` those within a row and within a
    paragraph of them in both editions, and ``shown`` the two texts for display.
    """

    section: Section
    old: tuple[str, ...]
    new: tuple[str, ...]
    close: tuple[str, ...]
    around: tuple[str, ...]
    shown: tuple[str, str]


def same_language(old: Manual, new: Manual) -> bool:
    """Return whether two texts have enough words in common to be compared word by word."""
    first, second = (Counter(filter(str.isalpha, manual.words.elements())) for manual in (old, new))
    return (first & second).total() >= _SAME_LANGUAGE * min(first.total(), second.total())


def changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield the passages that differ.

    Sections that were only renumbered or moved do not differ. A running head of one edition can be the title on the
    cover of both, so text that only one edition has is skipped if it is a running head.
    """
    heads = old.heads | new.heads
    for old_section, new_section in aligned(old, new):
        if old_section is None or new_section is None:
            section = old_section or new_section
            assert section is not None
            words = section.words
            is_gone = old_section is not None
            shown = f"section {section.shown}, {len(words)} words"
            old_words, new_words = (words, ()) if is_gone else ((), words)
            old_and_new = (shown, "") if is_gone else ("", shown)
            yield Passage(section, old_words, new_words, words, words, old_and_new)
        else:
            for first, second in (
                (WORD.findall(old_section.title), WORD.findall(new_section.title)),
                (old_section.words, new_section.words),
            ):
                yield from _in_section(old_section, first, second, heads)


def _in_section(section: Section, old: Sequence[str], new: Sequence[str], heads: Collection[str]) -> Iterator[Passage]:
    if old == new:
        return
    for low, high, new_low, new_high in _groups(old, new):
        if "".join(old[low:high]) == "".join(new[new_low:new_high]):
            continue  # the same letters, divided otherwise at the end of a line
        if (low == high or new_low == new_high) and letters((*old[low:high], *new[new_low:new_high])) in heads:
            continue
        yield Passage(
            section=section,
            old=tuple(old[low:high]),
            new=tuple(new[new_low:new_high]),
            close=(*_widened(old, low, high, _CLOSE, _CLOSE), *_widened(new, new_low, new_high, _CLOSE, _CLOSE)),
            around=(*_widened(old, low, high, _BEFORE, _AFTER), *_widened(new, new_low, new_high, _BEFORE, _AFTER)),
            shown=(_text(old, low, high), _text(new, new_low, new_high)),
        )


def _widened(words: Sequence[str], low: int, high: int, count_before: int, count_after: int) -> Sequence[str]:
    """Return a range of words with some words before and after it."""
    return words[max(low - count_before, 0) : high + count_after]


def _groups(old: Sequence[str], new: Sequence[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the ranges of words that differ, with near ones joined."""
    waiting: tuple[int, int, int, int] | None = None
    for tag, low, high, new_low, new_high in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        if waiting is not None and low - waiting[1] <= _TOGETHER:
            waiting = (waiting[0], high, waiting[2], new_high)
        else:
            if waiting is not None:
                yield waiting
            waiting = (low, high, new_low, new_high)
    if waiting is not None:
        yield waiting


def _text(words: Sequence[str], low: int, high: int) -> str:
    words_before, words_after = words[max(low - _SHOWN, 0) : low], words[high : high + _SHOWN]
    return " ".join([*words_before, "[", *words[low:high], "]", *words_after]).replace("[ ]", "[]")


def numbers_changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield a passage for each section in which other numbers occur, for editions in two languages."""
    for old_section, new_section in aligned(old, new):
        if old_section is None or new_section is None:
            continue
        old_numbers, new_numbers = _numbers(old_section), _numbers(new_section)
        removed, added = tuple((old_numbers - new_numbers).elements()), tuple((new_numbers - old_numbers).elements())
        if removed or added:
            changed_numbers = (*removed, *added)
            yield Passage(
                old_section, removed, added, changed_numbers, changed_numbers, (", ".join(removed), ", ".join(added))
            )


def _numbers(section: Section) -> Counter[str]:
    """Return the numbers in a section, with a decimal point in every language."""
    return Counter(word.replace(",", ".") for word in section.words if _is_number(word))


def _is_number(word: str) -> bool:
    return any(letter.isdigit() for letter in word)
