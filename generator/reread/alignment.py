"""Find the words that differ between two long texts.

The time for comparing all words grows with the square of the length, so it would be too long for manuals. The texts are
therefore first divided at phrases that occur once in both.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

#: Lengths of the phrases that align two texts, longest first. In a text of few words, only long ones occur once.
_PHRASE_LENGTHS = (16, 8, 4, 2, 1)
#: Most pairs of equal words for which ranges are compared word by word. Ranges with more are first divided at phrases.
_MOST_PAIRS = 20_000
#: The same for ranges that no phrase divides. Ranges with more count as one difference.
_MOST_PAIRS_WITHOUT_PHRASE = 400_000


class RangePair(NamedTuple):
    """A range of words of the old edition, and the range that replaces it in the new edition."""

    low: int
    high: int
    new_low: int
    new_high: int

    @property
    def is_empty(self) -> bool:
        return self.low == self.high and self.new_low == self.new_high


def differing_ranges(old: Sequence[str], new: Sequence[str]) -> Iterator[RangePair]:
    """Yield the ranges of words that differ, in order.

    Short ranges are compared word by word. Long ranges are first divided at phrases that both texts contain once: at
    phrases of 16 words, then of 8 words, and so on. Ranges that are then still too long count as one difference.
    """
    whole_texts = RangePair(low=0, high=len(old), new_low=0, new_high=len(new))
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
            # The list is processed from its end, so the order is reversed.
            smaller_ranges = _divide_at_phrases(old, new, ranges, _PHRASE_LENGTHS[length_index])
            ranges_to_compare += [(smaller, length_index + 1) for smaller in reversed(smaller_ranges)]
        else:
            yield ranges


def _without_equal_ends(old: Sequence[str], new: Sequence[str], ranges: RangePair) -> RangePair:
    """Return the ranges without equal words at their beginnings and ends."""
    low, high, new_low, new_high = ranges
    while low < high and new_low < new_high and old[low] == new[new_low]:
        low, new_low = low + 1, new_low + 1
    while low < high and new_low < new_high and old[high - 1] == new[new_high - 1]:
        high, new_high = high - 1, new_high - 1
    return RangePair(low=low, high=high, new_low=new_low, new_high=new_high)


def _has_few_equal_pairs(old: Sequence[str], new: Sequence[str], ranges: RangePair, most_pairs: int) -> bool:
    """Return whether two ranges have at most ``most_pairs`` pairs of equal words.

    A word that occurs 3 times in one range and twice in the other results in 6 pairs.
    """
    old_counts = Counter(old[ranges.low : ranges.high])
    new_counts = Counter(new[ranges.new_low : ranges.new_high])
    pair_count = sum(count * new_counts[word] for word, count in old_counts.items())
    return pair_count <= most_pairs


def _differences_within(old: Sequence[str], new: Sequence[str], ranges: RangePair) -> Iterator[RangePair]:
    """Yield the differences between two ranges, compared word by word, as ranges of the whole texts."""
    low, high, new_low, new_high = ranges
    matcher = SequenceMatcher(None, old[low:high], new[new_low:new_high], autojunk=False)
    for tag, start, end, new_start, new_end in matcher.get_opcodes():
        if tag != "equal":
            yield RangePair(low=low + start, high=low + end, new_low=new_low + new_start, new_high=new_low + new_end)


def _divide_at_phrases(
    old: Sequence[str], new: Sequence[str], ranges: RangePair, phrase_length: int
) -> list[RangePair]:
    """Return the ranges between phrases of this length that occur once in each range and in the same order.

    Phrases that overlap the previous phrase are skipped. If there is no phrase, the result is the undivided ranges.
    """
    old_places = _places_of_phrases(old, ranges.low, ranges.high, phrase_length)
    new_places = _places_of_phrases(new, ranges.new_low, ranges.new_high, phrase_length)
    common_places = [(place, new_places[phrase]) for phrase, place in old_places.items() if phrase in new_places]
    ranges_between: list[RangePair] = []
    low, new_low = ranges.low, ranges.new_low
    for place, new_place in _longest_increasing(sorted(common_places)):
        is_after_last_phrase = place >= low and new_place >= new_low
        if is_after_last_phrase:
            ranges_between.append(RangePair(low=low, high=place, new_low=new_low, new_high=new_place))
            low, new_low = place + phrase_length, new_place + phrase_length
    return [*ranges_between, RangePair(low=low, high=ranges.high, new_low=new_low, new_high=ranges.new_high)]


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
    """Return the longest series of pairs in which both numbers increase. Other pairs may be between them.

    The pairs are sorted by their first number. For ``[(1, 5), (2, 3), (3, 4)]`` the result is ``[(2, 3), (3, 4)]``.
    """
    # For each length of a series: the lowest second number at its end, and the index of that pair.
    lowest_ends: list[int] = []
    last_indices: list[int] = []
    # For each pair: the index of the pair before it in the longest series that ends with it, or -1.
    previous_indices: list[int] = []
    for index, (_, new_place) in enumerate(pairs):
        # The pair continues the longest series that ends with a lower second number.
        length_before = bisect_left(lowest_ends, new_place)
        previous_indices.append(last_indices[length_before - 1] if length_before else -1)
        lowest_ends[length_before : length_before + 1] = [new_place]
        last_indices[length_before : length_before + 1] = [index]
    series: list[tuple[int, int]] = []
    index = last_indices[-1] if last_indices else -1
    while index >= 0:
        series.append(pairs[index])
        index = previous_indices[index]
    return series[::-1]
