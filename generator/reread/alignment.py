"""Align the words of two texts in time that grows with their length, not with its square."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

#: Lengths of the phrases that align two texts, longest first. In a text of few words, only long ones occur once.
_PHRASE_LENGTHS = (16, 8, 4, 2, 1)
#: Most pairs of equal words that are compared with each other. More are first divided at common phrases.
_MOST_PAIRS = 20_000
#: The same without any common phrase that occurs once. More count as one difference.
_MOST_PAIRS_WITHOUT_PHRASE = 400_000


class Ranges(NamedTuple):
    """A range of words of the old edition, and the range that replaces it in the new edition."""

    low: int
    high: int
    new_low: int
    new_high: int

    @property
    def is_empty(self) -> bool:
        return self.low == self.high and self.new_low == self.new_high


def differing_ranges(old: Sequence[str], new: Sequence[str]) -> Iterator[Ranges]:
    """Yield the ranges of words that differ, in order.

    Ranges with few pairs of equal words are compared word by word. Other ranges are first divided at common phrases,
    with shorter and shorter phrases. Ranges that are still too large count as one difference.
    """
    whole_texts = Ranges(low=0, high=len(old), new_low=0, new_high=len(new))
    # The ranges to compare, last first, with the index of the length of the phrases that divide them next.
    ranges_to_compare = [(whole_texts, 0)]
    while ranges_to_compare:
        undivided_ranges, length_index = ranges_to_compare.pop()
        ranges = _without_equal_ends(old, new, undivided_ranges)
        if ranges.is_empty:
            continue
        has_more_lengths = length_index < len(_PHRASE_LENGTHS)
        most_pairs = _MOST_PAIRS if has_more_lengths else _MOST_PAIRS_WITHOUT_PHRASE
        if _has_few_equal_pairs(old, new, ranges, most_pairs):
            yield from _differences_within(old, new, ranges)
        elif has_more_lengths:
            # In reverse order, so that the first of them is taken from the end of the list next.
            smaller_ranges = _divide_at_phrases(old, new, ranges, _PHRASE_LENGTHS[length_index])
            ranges_to_compare += [(smaller, length_index + 1) for smaller in reversed(smaller_ranges)]
        else:
            yield ranges


def _without_equal_ends(old: Sequence[str], new: Sequence[str], ranges: Ranges) -> Ranges:
    """Return the ranges without the words at their beginning and end that are equal."""
    low, high, new_low, new_high = ranges
    while low < high and new_low < new_high and old[low] == new[new_low]:
        low, new_low = low + 1, new_low + 1
    while low < high and new_low < new_high and old[high - 1] == new[new_high - 1]:
        high, new_high = high - 1, new_high - 1
    return Ranges(low=low, high=high, new_low=new_low, new_high=new_high)


def _has_few_equal_pairs(old: Sequence[str], new: Sequence[str], ranges: Ranges, most_pairs: int) -> bool:
    """Return whether two ranges have at most ``most_pairs`` pairs of equal words.

    A word that occurs 3 times in one range and twice in the other leads to 6 pairs.
    """
    old_counts = Counter(old[ranges.low : ranges.high])
    new_counts = Counter(new[ranges.new_low : ranges.new_high])
    pair_count = sum(count * new_counts[word] for word, count in old_counts.items())
    return pair_count <= most_pairs


def _differences_within(old: Sequence[str], new: Sequence[str], ranges: Ranges) -> Iterator[Ranges]:
    """Yield the differences between two ranges, compared word by word, as ranges of the whole texts."""
    low, high, new_low, new_high = ranges
    matcher = SequenceMatcher(None, old[low:high], new[new_low:new_high], autojunk=False)
    for tag, start, end, new_start, new_end in matcher.get_opcodes():
        if tag != "equal":
            yield Ranges(low=low + start, high=low + end, new_low=new_low + new_start, new_high=new_low + new_end)


def _divide_at_phrases(old: Sequence[str], new: Sequence[str], ranges: Ranges, phrase_length: int) -> list[Ranges]:
    """Return the ranges between phrases of this length that occur once in each range and in the same order.

    Phrases that overlap the previous phrase are skipped. Without any phrase, the whole ranges are returned.
    """
    old_places = _places_of_phrases(old, ranges.low, ranges.high, phrase_length)
    new_places = _places_of_phrases(new, ranges.new_low, ranges.new_high, phrase_length)
    common_places = [(place, new_places[phrase]) for phrase, place in old_places.items() if phrase in new_places]
    ranges_between: list[Ranges] = []
    low, new_low = ranges.low, ranges.new_low
    for place, new_place in _longest_increasing(sorted(common_places)):
        is_after_last_phrase = place >= low and new_place >= new_low
        if is_after_last_phrase:
            ranges_between.append(Ranges(low=low, high=place, new_low=new_low, new_high=new_place))
            low, new_low = place + phrase_length, new_place + phrase_length
    return [*ranges_between, Ranges(low=low, high=ranges.high, new_low=new_low, new_high=ranges.new_high)]


def _places_of_phrases(words: Sequence[str], low: int, high: int, length: int) -> dict[tuple[str, ...], int]:
    """Return the index of the first word of each phrase of this length that occurs once in a range.

    For the range of "at most 10 at least" and a length of 2: ``{("at", "most"): 0, ("most", "10"): 1, …}``.
    """
    places: dict[tuple[str, ...], int] = {}
    repeated_phrases: set[tuple[str, ...]] = set()
    for place in range(low, high - length + 1):
        phrase = tuple(words[place : place + length])
        if phrase in places:
            repeated_phrases.add(phrase)
        places[phrase] = place
    return {phrase: place for phrase, place in places.items() if phrase not in repeated_phrases}


def _longest_increasing(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the longest run of pairs in which the second number increases, too.

    The pairs are sorted by their first number. For ``[(1, 5), (2, 3), (3, 4)]`` this is ``[(2, 3), (3, 4)]``.
    """
    # For each length of a run: the lowest second number at its end, and the index of that pair.
    lowest_ends: list[int] = []
    last_indices: list[int] = []
    # For each pair: the index of the pair before it in the longest run that it ends, or -1.
    previous_indices: list[int] = []
    for index, (_, new_place) in enumerate(pairs):
        # The longest run that this pair can continue: its last second number must be lower.
        length_before = bisect_left(lowest_ends, new_place)
        previous_indices.append(last_indices[length_before - 1] if length_before else -1)
        lowest_ends[length_before : length_before + 1] = [new_place]
        last_indices[length_before : length_before + 1] = [index]
    run: list[tuple[int, int]] = []
    index = last_indices[-1] if last_indices else -1
    while index >= 0:
        run.append(pairs[index])
        index = previous_indices[index]
    return run[::-1]
