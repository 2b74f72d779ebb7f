"""The campaign of benchmarks/why_campaign.py, for layouts that cannot tell which mistake was made."""

from __future__ import annotations

import random
import sys
from collections import Counter
from pathlib import Path

import pytest
from codewheel.commands.decode.explanations import why_text
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


def test_a_missing_byte_of_data_leaves_no_trace() -> None:
    """The first byte of an AMT21 contains a part of the position, and that of an Orbis repeats the command."""
    devices, _ = load_library()
    encoders_by_name = {encoder.name: encoder for encoder in why_campaign.distinct_encoders(devices)}
    no_trace = [
        why_campaign.is_any_frame(encoders_by_name[name], random.Random(61))
        for name in ("AMT212A position_reply", "AMT212A turns_reply", "OrbisSerial-14 status_reply")
    ]
    assert no_trace == [True, True, False]


def test_numbers_whose_place_is_an_open_question_are_not_expected() -> None:
    """The manual of the AMM5 leaves the place of the address open, so ``decode`` names only the data."""
    devices, _ = load_library()
    (encoder,) = (
        encoder for encoder in why_campaign.distinct_encoders(devices) if encoder.name.endswith(" eeprom_write_reply")
    )
    counts: dict[tuple[str, str], Count] = {}
    why_campaign.measure(encoder, 2, counts, Counter())
    assert {mistake: count.first for (_, mistake), count in counts.items()} == {
        "first byte missing": 2,
        "first byte missing, one behind": 2,
        "inverted": 2,
        "two replies": 2,
    }


def test_a_diagnosis_without_pairs_is_that_of_decode() -> None:
    """The campaign computes each diagnosis once, with pairs, and removes the pairs that ``decode`` would not try."""
    devices, _ = load_library()
    source = random.Random(48)
    compared_pairs = 0
    for encoder in why_campaign.distinct_encoders(devices)[::9]:
        for mistake in why_campaign.mistakes_of(encoder):
            planted = why_campaign.plant(encoder, mistake, source)
            if why_campaign.is_valid(planted):
                continue
            diagnosis = why_text(encoder.device, encoder.variant, "encoder", planted.text, planted.decoded)
            reduced = why_campaign.why(encoder, planted)
            assert why_campaign.explanations_of(reduced) == why_campaign.explanations_of(diagnosis)
            if diagnosis is None or reduced is None:
                assert diagnosis is reduced
                continue
            assert reduced.explanations == diagnosis.explanations
            assert reduced.missing_part == diagnosis.missing_part
            compared_pairs += reduced.explanations != planted.diagnoses[0].explanations
    assert compared_pairs > 10
