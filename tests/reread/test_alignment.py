"""Two texts are aligned word by word, in time that grows with their length."""

from __future__ import annotations

import random
import time

import pytest
from codewheel.reread.passages import differing_ranges

#: Nine words, so that every phrase of a few of them occurs many times.
WORDS = "clock data position bits error warning register value note".split()


def random_words(count: int, seed: int, vocabulary: int = len(WORDS)) -> list[str]:
    generator = random.Random(seed)
    return [generator.choice(WORDS[:vocabulary]) for _ in range(count)]


def rebuilt(old: list[str], new: list[str]) -> list[str]:
    """Return the old words with each range that differs replaced by the new one."""
    words: list[str] = []
    end = 0
    for ranges in differing_ranges(old, new):
        assert ranges.old_start >= end
        words += old[end : ranges.old_start] + new[ranges.new_start : ranges.new_end]
        end = ranges.old_end
    return words + old[end:]


@pytest.mark.parametrize("seed", range(40))
def test_the_ranges_turn_the_old_words_into_the_new_ones(seed: int) -> None:
    generator = random.Random(seed)
    old = random_words(generator.randrange(400), seed, generator.randint(1, 9))
    new = list(old)
    for _ in range(generator.randrange(6)):
        place = generator.randrange(len(new) + 1)
        new[place : place + generator.randrange(20)] = random_words(generator.randrange(20), seed + 1)
    assert rebuilt(old, new) == new


def test_a_changed_word_in_a_long_text_is_the_only_difference() -> None:
    old = random_words(60_000, 1)
    new = [*old[:30_000], "remark", *old[30_001:]]
    [ranges] = differing_ranges(old, new)
    assert ranges == (30_000, 30_001, 30_000, 30_001)


@pytest.mark.slow
def test_texts_in_which_everything_differs_end_in_seconds() -> None:
    """5,000 lines of nine words in one section. Comparing all pairs of equal words is 225 million of them."""
    old, new = random_words(45_000, 1), random_words(45_000, 2)
    start = time.process_time()
    assert rebuilt(old, new) == new
    assert time.process_time() - start < 20


def test_two_paragraphs_that_change_places_stay_aligned_on_one_side() -> None:
    old = random_words(20_000, 3)
    moved = old[10_000:] + old[:10_000]
    differing = sum(ranges.old_end - ranges.old_start for ranges in differing_ranges(old, moved))
    assert differing == 10_000
