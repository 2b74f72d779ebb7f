"""Descriptions of masters at the limits of their rules: the last valid value and the first invalid value."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.language.check import check_document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document

MASTER = """codewheel: 1
master: tried
title: A master
takes: [biss]
documents: {manual: {title: A manual}}
devices: [{name: One, channels: [a, b]}, {name: Two}]
limits: [{item: data_bits, LIMIT, reason: A reason., source: manual}]
settings:
  - {name: Bits, value: data_bits, source: manual, places: [{PLACE, unit: none, default: 0, source: manual}]}
  - {name: Clock, any_clock: {unit: Hz, CLOCK}, source: manual,
     places: [{PLACE, unit: none, default: 0, source: manual}]}
writing: [{of: [Bits], WRITING, source: manual}]
"""
VALID = {
    "LIMIT": "at_most: 3",
    "PLACE": "symbol: x, type: UINT8",
    "CLOCK": "at_least_hz: 1",
    "WRITING": "after: [Clock]",
}
CLASH = "is less than 'at_least', which is 4"
CLOCK_CLASH = "'at_most_hz' is less than 'at_least_hz', which is 4"
BITS_AND_AT = "use the type 'bits' and the key 'at' together or not at all"
ENTRIES = "'symbol' needs one entry for each channel of One, which has 2 channels"


def problems(folder: Path, word: str, text: str) -> set[str]:
    content = MASTER
    for name, valid_text in VALID.items():
        content = content.replace(name, text if name == word else valid_text)
    (folder / "tried.yaml").write_text(content, encoding="utf-8")
    report = ProblemReport()
    document = read_document(folder / "tried.yaml", report, "tried.yaml")
    assert document is not None
    check_document(document, report)
    return {problem.message for problem in report.problems}


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("LIMIT", "at_least: 4, at_most: 4"),
        ("LIMIT", "at_least: 4"),
        ("LIMIT", "at_most: 0"),
        ("LIMIT", "one_of: [4]"),
        ("CLOCK", "at_least_hz: 4, at_most_hz: 4"),
        ("CLOCK", "at_most_hz: 1"),
        ("PLACE", "symbol: x, type: UINT8, min: 2, max: 2"),
        ("PLACE", "symbol: x, type: UINT8, max: 0"),
        ("PLACE", "symbol: x, type: UINT8, min: 2"),
        ("PLACE", "register: x, type: bits, at: 7"),
        ("PLACE", 'register: x, type: bits, at: "7:6"'),
        ("PLACE", "index: 1, subindex: 2, type: UINT8"),
        ("PLACE", "on: [One], symbol: [x, y], type: UINT8"),
        ("PLACE", "on: [Two], symbol: [x], type: UINT8"),
        ("PLACE", "where: not_given, type: UINT8"),
        ("WRITING", "takes_effect: {at_once: true}"),
    ],
)
def test_the_last_valid_value_is_accepted(tmp_path: Path, word: str, text: str) -> None:
    assert problems(tmp_path, word, text) == set()


@pytest.mark.parametrize(
    ("word", "text", "message"),
    [
        ("LIMIT", "at_least: 4, at_most: 3", f"'at_most' {CLASH}"),
        ("CLOCK", "at_least_hz: 4, at_most_hz: 3", CLOCK_CLASH),
        ("PLACE", "symbol: x, type: UINT8, min: 2, max: 1", "'max' is less than 'min', which is 2"),
        ("PLACE", "register: x, type: bits", BITS_AND_AT),
        ("PLACE", "register: x, type: UINT8, at: 7", BITS_AND_AT),
        ("PLACE", 'register: x, type: bits, at: "7:x"', "'at' is a bit number, or a range such as 7:6"),
        ("PLACE", "index: 1, type: UINT8", "use 'index' and 'subindex' together or not at all"),
        ("PLACE", "on: [One], symbol: [x], type: UINT8", ENTRIES),
        ("PLACE", "on: [One, Two], symbol: [x], type: UINT8", ENTRIES),
        ("PLACE", "on: [One], symbol: [x, y, z], type: UINT8", ENTRIES),
        ("WRITING", "after: [Bits]", "circular order: 'Bits' after 'Bits'"),
    ],
)
def test_the_first_invalid_value_is_refused(tmp_path: Path, word: str, text: str, message: str) -> None:
    assert problems(tmp_path, word, text) == {message}
