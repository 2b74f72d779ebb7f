"""Passages that differ between two editions, section by section."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from .alignment import Ranges, differing_ranges
from .sections import WORD, Manual, Section, joined_letters, pair_sections

#: Differences with no more equal words between them are one passage.
_MOST_EQUAL_WORDS_BETWEEN = 6
#: Words before and after a difference that belong to its passage. The name of a register is often far above.
_WORDS_BEFORE, _WORDS_AFTER = 60, 20
#: Words before and after a difference that are close to it, such as the rest of a row.
_CLOSE_WORDS = 8
#: Words directly before and after an insertion, such as the cells on both sides of a new cell.
_WORDS_NEXT_TO_INSERTION = 1
#: Words shown before and after a difference.
_SHOWN_WORDS = 5
#: Least share of common words for texts in the same language.
_SAME_LANGUAGE = 0.5


@dataclass(frozen=True, slots=True)
class Passage:
    """A difference: its ``section`` in the old edition, or in the new one if it is new.

    ``old`` and ``new`` contain the words that differ. ``close`` has these words and 8 words on both sides in both
    editions, about a row of a table, and ``around`` has about a paragraph. ``shown`` is the old and the new text for
    display. ``next_to`` contains the words next to an insertion, and is empty if there are old words.
    """

    section: Section
    old: tuple[str, ...]
    new: tuple[str, ...]
    close: tuple[str, ...]
    around: tuple[str, ...]
    shown: tuple[str, str]
    next_to: tuple[str, ...] = ()


def same_language(old: Manual, new: Manual) -> bool:
    """Return whether two texts have enough words in common to be compared word by word.

    These are at least half of the words of the shorter text, without numbers and signs.
    """
    old_words = Counter(filter(str.isalpha, old.words.elements()))
    new_words = Counter(filter(str.isalpha, new.words.elements()))
    # A word that occurs several times counts as often as both texts have it.
    common_count = (old_words & new_words).total()
    return common_count >= _SAME_LANGUAGE * min(old_words.total(), new_words.total())


def differing_passages(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield the passages that differ. A section that only one edition has is one passage.

    Sections that were only renumbered or moved do not differ. A running head of one edition can be the title on the
    cover of both, so text that only one edition has is skipped if it is a running head.
    """
    heads = old.heads | new.heads
    for old_section, new_section in pair_sections(old, new):
        if old_section is not None and new_section is not None:
            old_title, new_title = WORD.findall(old_section.title), WORD.findall(new_section.title)
            yield from _passages_of_section(old_section, old_title, new_title, heads)
            yield from _passages_of_section(old_section, old_section.words, new_section.words, heads)
        elif old_section is not None:
            yield Passage(
                section=old_section,
                old=old_section.words,
                new=(),
                close=old_section.words,
                around=old_section.words,
                shown=(_whole_section_text(old_section), ""),
            )
        elif new_section is not None:
            yield Passage(
                section=new_section,
                old=(),
                new=new_section.words,
                close=new_section.words,
                around=new_section.words,
                shown=("", _whole_section_text(new_section)),
            )


def _whole_section_text(section: Section) -> str:
    return f"section {section.shown}, {len(section.words)} words"


def _passages_of_section(
    section: Section, old: Sequence[str], new: Sequence[str], heads: Collection[str]
) -> Iterator[Passage]:
    """Yield the passages that differ between the words ``old`` and ``new`` of a section.

    ``heads`` contains the letters of running heads, which are skipped if only one edition has them here.
    """
    if old == new:
        return
    for low, high, new_low, new_high in _differences_with_near_joined(old, new):
        old_words, new_words = tuple(old[low:high]), tuple(new[new_low:new_high])
        # Words that are only divided differently at the end of a line have the same letters.
        if "".join(old_words) == "".join(new_words):
            continue
        is_in_one_edition = not old_words or not new_words
        if is_in_one_edition and joined_letters((*old_words, *new_words)) in heads:
            continue
        old_row = _with_words_around(old, low, high, count_before=_CLOSE_WORDS, count_after=_CLOSE_WORDS)
        new_row = _with_words_around(new, new_low, new_high, count_before=_CLOSE_WORDS, count_after=_CLOSE_WORDS)
        old_paragraph = _with_words_around(old, low, high, count_before=_WORDS_BEFORE, count_after=_WORDS_AFTER)
        new_paragraph = _with_words_around(new, new_low, new_high, count_before=_WORDS_BEFORE, count_after=_WORDS_AFTER)
        # Only an insertion has words next to it. It contains no old words for finding facts.
        words_next_to = _with_words_around(
            old, low, high, count_before=_WORDS_NEXT_TO_INSERTION, count_after=_WORDS_NEXT_TO_INSERTION
        )
        is_insertion = not old_words
        yield Passage(
            section=section,
            old=old_words,
            new=new_words,
            close=(*old_row, *new_row),
            around=(*old_paragraph, *new_paragraph),
            shown=(_shown_text(old, low, high), _shown_text(new, new_low, new_high)),
            next_to=tuple(words_next_to) if is_insertion else (),
        )


def _with_words_around(
    words: Sequence[str], low: int, high: int, *, count_before: int, count_after: int
) -> Sequence[str]:
    """Return the words from ``low`` to before ``high``, with some words before and after them."""
    return words[max(low - count_before, 0) : high + count_after]


def _differences_with_near_joined(old: Sequence[str], new: Sequence[str]) -> Iterator[Ranges]:
    """Yield the ranges of words that differ in the old and the new text.

    If at most 6 equal words of the old text are between two passages, they are joined into one, with these words.
    """
    joined_ranges: Ranges | None = None
    for ranges in differing_ranges(old, new):
        if joined_ranges is not None and ranges.low - joined_ranges.high <= _MOST_EQUAL_WORDS_BETWEEN:
            joined_ranges = joined_ranges._replace(high=ranges.high, new_high=ranges.new_high)
            continue
        if joined_ranges is not None:
            yield joined_ranges
        joined_ranges = ranges
    if joined_ranges is not None:
        yield joined_ranges


def _shown_text(words: Sequence[str], low: int, high: int) -> str:
    """Return a range of words in brackets, with up to 5 words before and after it: ``at most [ 10 ] MHz``."""
    words_before = words[max(low - _SHOWN_WORDS, 0) : low]
    words_after = words[high : high + _SHOWN_WORDS]
    text = " ".join([*words_before, "[", *words[low:high], "]", *words_after])
    return text.replace("[ ]", "[]")


def numbers_changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield a passage for each section in which other numbers occur, for editions in two languages.

    Only the numbers are compared, without their order, so ``old`` and ``new`` contain the numbers that only one edition
    has.
    """
    for old_section, new_section in pair_sections(old, new):
        if old_section is None or new_section is None:
            continue
        old_numbers, new_numbers = _count_numbers(old_section), _count_numbers(new_section)
        removed_numbers = tuple((old_numbers - new_numbers).elements())
        added_numbers = tuple((new_numbers - old_numbers).elements())
        changed_numbers = (*removed_numbers, *added_numbers)
        if changed_numbers:
            yield Passage(
                section=old_section,
                old=removed_numbers,
                new=added_numbers,
                close=changed_numbers,
                around=changed_numbers,
                shown=(", ".join(removed_numbers), ", ".join(added_numbers)),
            )


def _count_numbers(section: Section) -> Counter[str]:
    """Return the numbers in a section, with a decimal point in every language."""
    return Counter(word.replace(",", ".") for word in section.words if _is_number(word))


def _is_number(word: str) -> bool:
    return any(letter.isdigit() for letter in word)
