"""Pair the sections of two editions of a manual, and find the passages and words that differ between them.

The time for comparing all words of two texts grows with the square of the length, so it would be too long for manuals.
The texts are therefore first divided at phrases that occur once in both.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import NamedTuple

from .sections import WORD, Manual, Section, joined_letters

#: Differences with at most this number of equal words between them are one passage.
_MAX_EQUAL_WORDS_BETWEEN = 6
#: Words before and after a difference that belong to its passage. The name of a register is often far above.
_WORDS_BEFORE, _WORDS_AFTER = 60, 20
#: Words before and after a difference that are close to it, such as the rest of a row.
_CLOSE_WORDS = 8
#: Words directly before and after an insertion, such as the cells on both sides of a new cell.
_WORDS_NEXT_TO_INSERTION = 1
#: Words shown before and after a difference.
_SHOWN_WORDS = 5
#: Lowest share of common words for texts in the same language.
_SAME_LANGUAGE = 0.5


@dataclass(frozen=True, slots=True)
class Passage:
    """A difference between two editions of a manual."""

    #: Section in the old edition, or in the new edition if the section is new.
    section: Section
    #: Words that only the old and only the new edition has.
    old_words: tuple[str, ...]
    new_words: tuple[str, ...]
    #: Differing words with 8 words before and after them, in both editions. This is about a row of a table.
    words_in_row: tuple[str, ...]
    #: Differing words with more words around them, in both editions. This is about a paragraph.
    words_in_paragraph: tuple[str, ...]
    #: The old and the new text for display.
    shown_texts: tuple[str, str]
    #: Words directly before and after an insertion. Empty if there are old words.
    words_next_to: tuple[str, ...] = ()


def same_language(old: Manual, new: Manual) -> bool:
    """Return whether two texts have enough words in common to be compared word by word.

    At least half of the words in the shorter text, without numbers and signs, must be common.
    """
    old_words = Counter(filter(str.isalpha, old.words.elements()))
    new_words = Counter(filter(str.isalpha, new.words.elements()))
    # The intersection of two counters contains a word as often as both texts contain it.
    common_count = (old_words & new_words).total()
    return common_count >= _SAME_LANGUAGE * min(old_words.total(), new_words.total())


def differing_passages(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield the passages that differ between two editions. A section that only one edition has is one passage.

    Sections that were only renumbered or moved do not differ. A text that only one edition has is skipped if it is a
    running head in either edition.
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
                old_words=old_section.words,
                new_words=(),
                words_in_row=old_section.words,
                words_in_paragraph=old_section.words,
                shown_texts=(_whole_section_text(old_section), ""),
            )
        elif new_section is not None:
            yield Passage(
                section=new_section,
                old_words=(),
                new_words=new_section.words,
                words_in_row=new_section.words,
                words_in_paragraph=new_section.words,
                shown_texts=("", _whole_section_text(new_section)),
            )


def _whole_section_text(section: Section) -> str:
    return f"section {section.shown}, {len(section.words)} words"


def _passages_of_section(
    section: Section, old: Sequence[str], new: Sequence[str], heads: Collection[str]
) -> Iterator[Passage]:
    """Yield the passages that differ between the old and the new words of a section.

    ``heads`` contains the letters of running heads. They are skipped if only one edition has them here.
    """
    if old == new:
        return
    for old_start, old_end, new_start, new_end in _differences_with_near_joined(old, new):
        old_words, new_words = tuple(old[old_start:old_end]), tuple(new[new_start:new_end])
        # Words that are only hyphenated differently at the end of a line have the same letters.
        if "".join(old_words) == "".join(new_words):
            continue
        is_in_one_edition = not old_words or not new_words
        if is_in_one_edition and joined_letters((*old_words, *new_words)) in heads:
            continue
        old_row = _with_words_around(old, old_start, old_end, count_before=_CLOSE_WORDS, count_after=_CLOSE_WORDS)
        new_row = _with_words_around(new, new_start, new_end, count_before=_CLOSE_WORDS, count_after=_CLOSE_WORDS)
        old_paragraph = _with_words_around(
            old, old_start, old_end, count_before=_WORDS_BEFORE, count_after=_WORDS_AFTER
        )
        new_paragraph = _with_words_around(
            new, new_start, new_end, count_before=_WORDS_BEFORE, count_after=_WORDS_AFTER
        )
        # An insertion contains no old words, so facts are found by the words next to it.
        words_next_to = _with_words_around(
            old, old_start, old_end, count_before=_WORDS_NEXT_TO_INSERTION, count_after=_WORDS_NEXT_TO_INSERTION
        )
        is_insertion = not old_words
        yield Passage(
            section=section,
            old_words=old_words,
            new_words=new_words,
            words_in_row=(*old_row, *new_row),
            words_in_paragraph=(*old_paragraph, *new_paragraph),
            shown_texts=(_shown_text(old, old_start, old_end), _shown_text(new, new_start, new_end)),
            words_next_to=tuple(words_next_to) if is_insertion else (),
        )


def _with_words_around(
    words: Sequence[str], start: int, end: int, *, count_before: int, count_after: int
) -> Sequence[str]:
    """Return the words from index ``start`` to before ``end``, with some words before and after them."""
    return words[max(start - count_before, 0) : end + count_after]


def _differences_with_near_joined(old: Sequence[str], new: Sequence[str]) -> Iterator[RangePair]:
    """Yield the ranges of words that differ between the old and the new text.

    Two ranges with at most 6 equal words between them are joined into one, which includes these words.
    """
    joined_pair: RangePair | None = None
    for next_pair in differing_ranges(old, new):
        if joined_pair is not None:
            equal_words_between = next_pair.old_start - joined_pair.old_end
            if equal_words_between <= _MAX_EQUAL_WORDS_BETWEEN:
                joined_pair = joined_pair._replace(old_end=next_pair.old_end, new_end=next_pair.new_end)
                continue
            yield joined_pair
        joined_pair = next_pair
    if joined_pair is not None:
        yield joined_pair


def _shown_text(words: Sequence[str], start: int, end: int) -> str:
    """Return a range of words in brackets, with up to 5 words before and after it: ``at most [ 10 ] MHz``."""
    words_before = words[max(start - _SHOWN_WORDS, 0) : start]
    words_after = words[end : end + _SHOWN_WORDS]
    text = " ".join([*words_before, "[", *words[start:end], "]", *words_after])
    return text.replace("[ ]", "[]")


def numbers_changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield a passage for each section whose numbers differ between two editions in different languages.

    The order of the numbers does not matter. ``old`` and ``new`` of a passage contain the numbers that only one edition
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
                old_words=removed_numbers,
                new_words=added_numbers,
                words_in_row=changed_numbers,
                words_in_paragraph=changed_numbers,
                shown_texts=(", ".join(removed_numbers), ", ".join(added_numbers)),
            )


def _count_numbers(section: Section) -> Counter[str]:
    """Return how often each number occurs in a section. A decimal comma is replaced by a decimal point."""
    return Counter(word.replace(",", ".") for word in section.words if _is_number(word))


def _is_number(word: str) -> bool:
    return any(letter.isdigit() for letter in word)


def pair_sections(old: Manual, new: Manual) -> Iterator[tuple[Section | None, Section | None]]:
    """Yield the sections of two editions in pairs, with None for a section that is not in the other edition.

    Sections are paired by number and title, then by title, then by number. Sections that are only in the new edition
    come last.
    """
    unpaired_by_number = {section.number: section for section in new.sections}
    new_section_by_old_number: dict[str, Section] = {}
    # Each rule is tried for all sections before the next rule, so that better pairs are found first.
    for find_number in (_same_number_and_title, _number_with_same_title, _same_number):
        for section in old.sections:
            if section.number in new_section_by_old_number:
                continue
            new_number = find_number(section, unpaired_by_number)
            if new_number is not None:
                new_section_by_old_number[section.number] = unpaired_by_number.pop(new_number)
    for section in old.sections:
        yield section, new_section_by_old_number.get(section.number)
    for section in unpaired_by_number.values():
        yield None, section


def _same_number_and_title(old_section: Section, new_sections: Mapping[str, Section]) -> str | None:
    """Return the number of an old section if the new section with this number has the same title, or None."""
    new_section = new_sections.get(old_section.number)
    if new_section is None or new_section.title.casefold() != old_section.title.casefold():
        return None
    return old_section.number


def _number_with_same_title(old_section: Section, new_sections: Mapping[str, Section]) -> str | None:
    """Return the number of the first new section with the same title, regardless of case, or None."""
    for number, new_section in new_sections.items():
        if new_section.title.casefold() == old_section.title.casefold():
            return number
    return None


def _same_number(old_section: Section, new_sections: Mapping[str, Section]) -> str | None:
    return old_section.number if old_section.number in new_sections else None


# -- words that differ between two long texts

#: Lengths of the phrases that align two texts, longest first. In a text of few words, only long ones occur once.
_PHRASE_LENGTHS = (16, 8, 4, 2, 1)
#: Most pairs of equal words for which ranges are compared word by word. Ranges with more are first divided at phrases.
_MOST_PAIRS = 20_000
#: The same for ranges that no phrase divides. Ranges with more count as one difference.
_MOST_PAIRS_WITHOUT_PHRASE = 400_000


class RangePair(NamedTuple):
    """A range of words of the old edition, and the range that replaces it in the new edition."""

    old_start: int
    old_end: int
    new_start: int
    new_end: int

    @property
    def is_empty(self) -> bool:
        return self.old_start == self.old_end and self.new_start == self.new_end


def differing_ranges(old: Sequence[str], new: Sequence[str]) -> Iterator[RangePair]:
    """Yield the ranges of words that differ, in order.

    Short ranges are compared word by word. Long ranges are first divided at phrases that both texts contain once: at
    phrases of 16 words, then of 8 words, and so on. Ranges that are then still too long count as one difference.
    """
    whole_texts = RangePair(old_start=0, old_end=len(old), new_start=0, new_end=len(new))
    # The ranges to compare, last first, with the index of the length of the phrases that divide them next.
    ranges_to_compare = [(whole_texts, 0)]
    while ranges_to_compare:
        undivided_ranges, length_index = ranges_to_compare.pop()
        range_pair = _without_equal_ends(old, new, undivided_ranges)
        if range_pair.is_empty:
            continue
        has_more_lengths = length_index < len(_PHRASE_LENGTHS)
        most_pairs = _MOST_PAIRS if has_more_lengths else _MOST_PAIRS_WITHOUT_PHRASE
        if _has_few_equal_pairs(old, new, range_pair, most_pairs):
            yield from _differences_within(old, new, range_pair)
        elif has_more_lengths:
            # The list is processed from its end, so the order is reversed.
            smaller_ranges = _divide_at_phrases(old, new, range_pair, _PHRASE_LENGTHS[length_index])
            ranges_to_compare += [(smaller, length_index + 1) for smaller in reversed(smaller_ranges)]
        else:
            yield range_pair


def _without_equal_ends(old: Sequence[str], new: Sequence[str], range_pair: RangePair) -> RangePair:
    """Return the ranges without equal words at their beginnings and ends."""
    old_start, old_end, new_start, new_end = range_pair
    while old_start < old_end and new_start < new_end and old[old_start] == new[new_start]:
        old_start, new_start = old_start + 1, new_start + 1
    while old_start < old_end and new_start < new_end and old[old_end - 1] == new[new_end - 1]:
        old_end, new_end = old_end - 1, new_end - 1
    return RangePair(old_start=old_start, old_end=old_end, new_start=new_start, new_end=new_end)


def _has_few_equal_pairs(old: Sequence[str], new: Sequence[str], range_pair: RangePair, most_pairs: int) -> bool:
    """Return whether two ranges have at most ``most_pairs`` pairs of equal words.

    A word that occurs 3 times in one range and twice in the other results in 6 pairs.
    """
    old_counts = Counter(old[range_pair.old_start : range_pair.old_end])
    new_counts = Counter(new[range_pair.new_start : range_pair.new_end])
    pair_count = sum(old_count * new_counts[word] for word, old_count in old_counts.items())
    return pair_count <= most_pairs


def _differences_within(old: Sequence[str], new: Sequence[str], range_pair: RangePair) -> Iterator[RangePair]:
    """Yield the differences between two ranges, compared word by word, as ranges of the whole texts."""
    old_start, old_end, new_start, new_end = range_pair
    matcher = SequenceMatcher(None, old[old_start:old_end], new[new_start:new_end], autojunk=False)
    # The indices in an opcode count from the starts of the two ranges.
    for tag, first_old, end_old, first_new, end_new in matcher.get_opcodes():
        if tag != "equal":
            yield RangePair(
                old_start=old_start + first_old,
                old_end=old_start + end_old,
                new_start=new_start + first_new,
                new_end=new_start + end_new,
            )


def _divide_at_phrases(
    old: Sequence[str], new: Sequence[str], range_pair: RangePair, phrase_length: int
) -> list[RangePair]:
    """Return the ranges between phrases of this length that occur once in each range and in the same order.

    Phrases that overlap the previous phrase are skipped. If there is no phrase, the result is the undivided ranges.
    """
    old_index_by_phrase = _index_by_unique_phrase(old, range_pair.old_start, range_pair.old_end, phrase_length)
    new_index_by_phrase = _index_by_unique_phrase(new, range_pair.new_start, range_pair.new_end, phrase_length)
    common_indices = [
        (old_index, new_index_by_phrase[phrase])
        for phrase, old_index in old_index_by_phrase.items()
        if phrase in new_index_by_phrase
    ]
    ranges_between: list[RangePair] = []
    old_start, new_start = range_pair.old_start, range_pair.new_start
    for old_index, new_index in _longest_increasing(sorted(common_indices)):
        is_after_last_phrase = old_index >= old_start and new_index >= new_start
        if is_after_last_phrase:
            ranges_between.append(
                RangePair(old_start=old_start, old_end=old_index, new_start=new_start, new_end=new_index)
            )
            old_start, new_start = old_index + phrase_length, new_index + phrase_length
    return [
        *ranges_between,
        RangePair(old_start=old_start, old_end=range_pair.old_end, new_start=new_start, new_end=range_pair.new_end),
    ]


def _index_by_unique_phrase(
    words: Sequence[str], start: int, end: int, phrase_length: int
) -> dict[tuple[str, ...], int]:
    """Return the index of the first word of each phrase of this length that occurs once in a range.

    For the range of "at most 10 at least" and a length of 2: ``{("at", "most"): 0, ("most", "10"): 1, …}``.
    """
    index_by_phrase: dict[tuple[str, ...], int] = {}
    repeated_phrases: set[tuple[str, ...]] = set()
    for index in range(start, end - phrase_length + 1):
        phrase = tuple(words[index : index + phrase_length])
        if phrase in index_by_phrase:
            repeated_phrases.add(phrase)
        index_by_phrase[phrase] = index
    return {phrase: index for phrase, index in index_by_phrase.items() if phrase not in repeated_phrases}


def _longest_increasing(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the longest series of pairs in which both numbers increase. Other pairs may be between them.

    The pairs are sorted by their first number. For ``[(1, 5), (2, 3), (3, 4)]`` the result is ``[(2, 3), (3, 4)]``.
    """
    # For each length of a series: the lowest second number at its end, and the index of that pair.
    lowest_ends: list[int] = []
    last_indices: list[int] = []
    # For each pair: the index of the pair before it in the longest series that ends with it, or -1.
    previous_indices: list[int] = []
    for index, (_, second_number) in enumerate(pairs):
        # The pair continues the longest series that ends with a lower second number.
        length_before = bisect_left(lowest_ends, second_number)
        previous_indices.append(last_indices[length_before - 1] if length_before else -1)
        lowest_ends[length_before : length_before + 1] = [second_number]
        last_indices[length_before : length_before + 1] = [index]
    series: list[tuple[int, int]] = []
    index = last_indices[-1] if last_indices else -1
    while index >= 0:
        series.append(pairs[index])
        index = previous_indices[index]
    return series[::-1]
