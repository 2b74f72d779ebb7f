"""The campaign of benchmarks/why_campaign.py, for layouts that cannot tell whether a frame is inverted."""

from __future__ import annotations

import random
import sys
from collections import Counter
from pathlib import Path

import pytest
from codewheel.loading.library import load_library

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))

import why_campaign
from why_campaign import Count, Encoder

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def encoders() -> dict[str, Encoder]:
    devices, _ = load_library()
    chips = [device for device in devices if device.name in ("amt22", "ma600", "mt6835", "as5047p")]
    return {encoder.name: encoder for encoder in why_campaign.distinct_encoders(chips)}


def count_inverted(encoder: Encoder) -> Count:
    """Return the results for ten sets of three inverted frames."""
    counts: dict[tuple[str, str], Count] = {}
    why_campaign.measure(encoder, 10, counts, Counter())
    return counts["spi no CRC", "inverted"]


def test_an_inverted_frame_that_is_valid_is_among_the_doubts(encoders: dict[str, Encoder]) -> None:
    """Its 16 bits have an even parity, which does not change if all of them are inverted."""
    for name in ("AS5047P position", "AMT22-14 position"):
        count = count_inverted(encoders[name])
        assert (count.as_it_is, count.doubts, count.without_doubts) == (10, 30, 0), name


@pytest.mark.parametrize(
    ("name", "is_decidable"),
    [
        ("MA600 position_with_parity", False),  # a parity bit also fits any frame that lost its first bit
        ("MT6835 acknowledge", False),  # 55h inverted is AAh, and so is 55h with its bits reversed
        ("AMT22-12 position", True),  # two zeros and two parity bits
    ],
)
def test_whether_three_inverted_frames_show_it(encoders: dict[str, Encoder], name: str, is_decidable: bool) -> None:
    encoder = encoders[name]
    inverted = next(mistake for mistake in why_campaign.mistakes_of(encoder) if mistake.name == "inverted")
    assert why_campaign.is_decidable(encoder, inverted, random.Random(48)) == is_decidable
    count = count_inverted(encoder)
    assert (count.undecided, count.listed, count.judged) == ((0, 0, 10) if is_decidable else (10, 10, 0))
