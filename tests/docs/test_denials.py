"""Every sentence that denies something is listed with its condition, and is not printed if the spec contradicts it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from denial_cases import CASES, SLOW
from denials import denials, denies

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
LISTED = yaml.load(Path(__file__).with_name("denials.yaml").read_text("utf-8"), _LOADER)
ABOUT_ENCODERS = LISTED["about_encoders"]


def _listed() -> Iterator[tuple[str, str]]:
    """Yield the file and the text of each listed denial."""
    yield from ((entry["file"], entry["says"]) for entry in ABOUT_ENCODERS)
    for group in LISTED["holds_for_all"]:
        for file, texts in group["texts"].items():
            yield from ((file, text) for text in texts)


def _cases() -> Iterator[Any]:
    for entry in ABOUT_ENCODERS:
        for name in entry["cases"]:
            marks = [pytest.mark.slow] if name in SLOW else []
            yield pytest.param(entry["says"], name, id=f"{name}: {entry['says'][:40]}", marks=marks)


def _pattern(says: str) -> re.Pattern[str]:
    """Return a pattern for a text in which ``{}`` and ``%s`` represent values."""
    words = re.split(r"\{\}|%s", re.sub(r"^(?:-|#+) ", "", says))
    return re.compile("[^|]{0,60}?".join(map(re.escape, words)))


def _printed(name: str, index: int) -> str:
    """Return the output of a case on one line, without the marks of comments and of line breaks."""
    return " ".join(re.sub(r"^ *(?:/?\*+|//|#+|>|-) ", "", CASES[name][index](), flags=re.MULTILINE).split())


def test_every_denial_is_listed() -> None:
    listed, printed_denials = list(_listed()), list(denials())
    assert len(listed) == len(set(listed))
    assert sorted(set(printed_denials) - set(listed)) == [], (
        "list it in denials.yaml, with the condition under which it is printed"
    )
    assert sorted(set(listed) - set(printed_denials)) == [], "it is no longer printed"


@pytest.mark.parametrize(("says", "case"), list(_cases()))
def test_it_is_printed_only_if_no_fact_contradicts_it(says: str, case: str) -> None:
    pattern, (true, false) = _pattern(says), (_printed(case, index) for index in (0, 1))
    assert pattern.search(true), true[:2000]
    assert not pattern.search(false), pattern.pattern


def test_every_case_is_that_of_a_denial() -> None:
    assert {name for entry in ABOUT_ENCODERS for name in entry["cases"]} == set(CASES)


@pytest.mark.parametrize(
    "text",
    [
        "It has no preset",
        "the manual does not say",
        "SSI only reads",
        "Nothing is saved",
        "without a CRC",
        "it isn't sent",
    ],
)
def test_words_that_deny(text: str) -> None:
    assert denies(text)


@pytest.mark.parametrize("text", ["The notes are long", "none", "Another preset: 5"])
def test_other_words(text: str) -> None:
    assert not denies(text)
