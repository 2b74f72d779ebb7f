"""Captures of logic analysers: frames, lost cycles and register accesses are found in synthetic lines."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from typing import Any

import numpy
import pytest
from codewheel_runtime.captures.clocked import Lost, find_clocked_frames
from codewheel_runtime.captures.signals import SignalNames, read_array
from lines import Biss, Wave, biss_word, ssi

BITS = 40
NAMES = SignalNames("1", "2")


def read(
    wave: Wave, rate: float, bits: int = BITS, kind: Any = "biss", shift: float = 0.0
) -> tuple[list[int], list[Lost]]:
    signals = read_array(numpy.array(wave.samples(rate, shift), numpy.uint8), NAMES)
    words: list[int] = []
    lost: list[Lost] = []
    for clocked_part in find_clocked_frames(signals, "a capture", kind, bits):
        words += clocked_part.frames.tolist()
        lost += clocked_part.lost
    return words, lost


def positions(count: int, seed: int = 1) -> list[int]:
    chosen = random.Random(seed)
    return [chosen.getrandbits(32) for _ in range(count)]


def biss(words: Sequence[int], **options: Any) -> Wave:
    line = Biss(**options)
    for word in words:
        line.cycle(word, BITS)
    return line.finish()


RATES = (2.4, 3, 4, 4.8, 5, 6.37, 8, 11, 16, 24, 33.3, 50)
DELAYS = (0.0, 0.1, 0.26, 0.5, 0.77, 0.99, 1.0, 1.5, 3.3, 7.0)


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
def test_biss_at_every_rate_with_every_delay(rate: float) -> None:
    words = [biss_word(position) for position in positions(3)]
    for delay, shift in itertools.product(DELAYS, (0.0, 0.3, 0.7)):
        # The last bits of a delayed line come after the last clock.
        words_read = read(biss(words, delay=delay), rate, shift=shift)
        assert words_read == (words, []), (rate, delay, shift)


@pytest.mark.slow
@pytest.mark.parametrize("acknowledge", [1, 2, 3, 7, 20, 64, 133, 200])
def test_acknowledge_of_any_length(acknowledge: int) -> None:
    words = [biss_word(position) for position in positions(3, acknowledge)]
    for rate, delay in itertools.product((4, 5.3, 24), (0.1, 0.8, 4.4)):
        assert read(biss(words, acknowledge=acknowledge, delay=delay), rate) == (words, [])


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[2:])
def test_ssi_at_every_rate_with_every_delay(rate: float) -> None:
    words = [value & (1 << 25) - 1 for value in positions(4)]
    for delay, shift in itertools.product((0.0, 0.1, 0.4, 0.7), (0.0, 0.4)):
        assert read(ssi(words, 25, delay), rate, 25, "ssi", shift) == (words, [])


@pytest.mark.parametrize("extra", [1, 5, 40, 90])
def test_clocks_after_the_frame_do_not_matter(extra: int) -> None:
    words = [biss_word(position) for position in positions(3)]
    assert read(biss(words, extra=extra), 10) == (words, [])


# Planted errors: each leads to exactly one message, and the other frames are found.


def spike(wave: Wave, at: float) -> Wave:
    return Wave(sorted([*wave.clock, at, at + 0.08]), wave.data, wave.now)


def cycles(count: int = 5, **faults: Any) -> tuple[Biss, list[int]]:
    line, words = Biss(**faults), [biss_word(position) for position in positions(count)]
    return line, words


def test_clock_that_stops_early() -> None:
    line, words = cycles()
    for place, word in enumerate(words):
        # One clock, three of the acknowledgement, start, CDS, and 18 bits of the frame.
        line.cycle(word, BITS, clocks=24 if place == 2 else None)
    words_read, lost = read(line.finish(), 10)
    assert words_read == words[:2] + words[3:]
    assert [lost_cycle.reason for lost_cycle in lost] == ["the clock stops after 18 of 40 bits"]


def test_silent_encoder() -> None:
    line, words = cycles()
    for place, word in enumerate(words):
        before = list(line.wave.data)
        line.cycle(word, BITS)
        if place == 2:
            line.wave.data = before
    words_read, lost = read(line.finish(), 10)
    assert words_read == words[:2] + words[3:]
    assert [lost_cycle.reason for lost_cycle in lost] == ["no acknowledgement: the data line stays high"]


def test_encoder_that_never_starts() -> None:
    line, words = cycles()
    for place, word in enumerate(words):
        before = list(line.wave.data)
        line.cycle(word, BITS)
        if place == 3:
            line.wave.data = [*before, line.wave.data[len(before)], (line.wave.now - 1, 1)]
    words_read, lost = read(line.finish(), 10)
    assert words_read == words[:3] + words[4:]
    assert [lost_cycle.reason for lost_cycle in lost] == [
        "no start bit: the data line stays low after the acknowledgement"
    ]


def test_data_line_that_is_low_at_rest() -> None:
    line, words = cycles()
    for place, word in enumerate(words):
        line.cycle(word, BITS)
        if place == 1:
            line.wave.data[-1] = (line.wave.now + 50, 1)
    line.wave.data.sort()
    words_read, lost = read(line.finish(), 10)
    assert words_read == words[:2] + words[3:]
    assert [lost_cycle.reason for lost_cycle in lost] == ["the data line is low before the cycle begins"]


@pytest.mark.parametrize("rate", [16, 24, 50])
def test_spike_on_the_clock(rate: float) -> None:
    wave = biss([biss_word(position) for position in positions(5)])
    words, _ = read(wave, rate)
    words_read, lost = read(spike(wave, wave.clock[2 * 47 + 30] + 0.2), rate)
    assert words_read == [word for place, word in enumerate(words) if place != 1]
    assert [lost_cycle.reason for lost_cycle in lost] == ["a very short pulse on the clock"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["biss", "ssi"])
def test_capture_that_begins_or_ends_within_a_cycle(kind: str) -> None:
    words = [biss_word(position) for position in positions(3, 7)]
    wave = biss(words) if kind == "biss" else ssi(words, BITS)
    samples = wave.samples(10)
    begin, end = int(wave.clock[0] * 10), int(wave.clock[-1] * 10)
    for cut in range(begin + 12, begin + 400, 7):
        words_and_reasons = list(_read_samples(samples[cut:], kind))
        assert words_and_reasons == [words[1:], ["the capture begins within this cycle"]], cut
    for cut in range(end - 390, end - 12, 7):
        words_and_reasons = list(_read_samples(samples[:cut], kind))
        assert words_and_reasons == [words[:2], ["the capture ends within this cycle"]], cut


def _read_samples(samples: Any, kind: Any) -> tuple[list[int], list[str]]:
    words_and_reasons: tuple[list[int], list[str]] = ([], [])
    for part in find_clocked_frames(read_array(numpy.array(samples, numpy.uint8), NAMES), "a capture", kind, BITS):
        words_and_reasons[0].extend(part.frames.tolist())
        words_and_reasons[1].extend(lost_cycle.reason for lost_cycle in part.lost)
    return words_and_reasons


def test_ssi_word_that_is_cut() -> None:
    words = [5, 6, 7]
    wave = ssi(words, 25, clocks=20)
    words_read, lost = read(wave, 10, 25, "ssi")
    assert words_read == []
    assert [lost_cycle.reason for lost_cycle in lost] == ["the clock stops after 20 of 25 bits"] * 3
