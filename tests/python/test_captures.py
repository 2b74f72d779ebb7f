"""Captures of logic analysers: frames, lost cycles and register accesses are found in synthetic lines."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from typing import Any

import numpy
import pytest
from codewheel_runtime.clocked import Lost, clocked
from codewheel_runtime.signals import Names, of_array
from lines import Biss, Wave, biss_word, ssi

BITS = 40
NAMES = Names("1", "2")


def read(
    wave: Wave, rate: float, bits: int = BITS, kind: Any = "biss", shift: float = 0.0
) -> tuple[list[int], list[Lost]]:
    signals = of_array(numpy.array(wave.samples(rate, shift), numpy.uint8), NAMES)
    words: list[int] = []
    lost: list[Lost] = []
    for found in clocked(signals, "a capture", kind, bits):
        words += found.frames.tolist()
        lost += found.lost
    return words, lost


def positions(count: int, seed: int = 1) -> list[int]:
    chosen = random.Random(seed)
    return [chosen.getrandbits(32) for _ in range(count)]


def biss(words: Sequence[int], **options: Any) -> Wave:
    line = Biss(**options)
    for word in words:
        line.cycle(word, BITS)
    return line.finish()


RATES = (4, 4.8, 5, 6.37, 8, 11, 16, 24, 33.3, 50)
DELAYS = (0.0, 0.1, 0.26, 0.5, 0.77, 0.99, 1.0, 1.5, 3.3, 7.0)


@pytest.mark.parametrize("rate", RATES)
def test_biss_at_every_rate_with_every_delay(rate: float) -> None:
    words = [biss_word(position) for position in positions(3)]
    for delay, shift in itertools.product(DELAYS, (0.0, 0.3, 0.7)):
        # The last bits of a delayed line come after the clock.
        found = read(biss(words, delay=delay), rate, shift=shift)
        assert found == (words, []), (rate, delay, shift)


@pytest.mark.parametrize("acknowledge", [1, 2, 3, 7, 20, 64, 133, 200])
def test_acknowledge_of_any_length(acknowledge: int) -> None:
    words = [biss_word(position) for position in positions(3, acknowledge)]
    for rate, delay in itertools.product((4, 5.3, 24), (0.1, 0.8, 4.4)):
        assert read(biss(words, acknowledge=acknowledge, delay=delay), rate) == (words, [])


@pytest.mark.parametrize("rate", RATES)
def test_ssi_at_every_rate_with_every_delay(rate: float) -> None:
    words = [value & (1 << 25) - 1 for value in positions(4)]
    for delay, shift in itertools.product((0.0, 0.1, 0.4, 0.7), (0.0, 0.4)):
        assert read(ssi(words, 25, delay), rate, 25, "ssi", shift) == (words, [])


@pytest.mark.parametrize("extra", [1, 5, 40, 90])
def test_clocks_after_the_frame_do_not_matter(extra: int) -> None:
    words = [biss_word(position) for position in positions(3)]
    assert read(biss(words, extra=extra), 10) == (words, [])
