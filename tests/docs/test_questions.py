"""Questions of readers of the manuals: each answer is where they would look for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from page_reader import Line, Section, read
from reading_questions import Question, questions

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "generated" / "docs"
BY_HAND = Path(__file__).parent / "questions.yaml"
FAMILIES = ("am36", "amm5", "asc85", "sma21")
#: Kinds of questions, each asked about every family whose second reading has such a fact.
KINDS = {
    *("address", "bit", "byte order", "default", "wait", "CRC", "pin", "colour", "clock", "clock at 30 m"),
    *("clock at 80 m", "clock at 150 m", "clock at 300 m", "remedy"),
}
#: The manual of the AM36 has no alarms over a serial line.
ABSENT = {("am36", "remedy")}


@cache
def page_of(family: str, order_code: str) -> Section:
    """Return the page with the order code in its heading, above the first table."""
    for path in sorted((DOCS / family).glob("*.md")):
        text = path.read_text(encoding="utf-8")
        if f"{order_code}\n" in text or f"`{order_code}`" in text.partition("\n| ")[0]:
            return read(text)
    raise AssertionError(f"no page for {order_code}")


def places(page: Section, question: Question) -> list[Section]:
    """Return the sections where a reader looks, the smallest first."""
    sections = [page.inner[0]] if question.where else []
    for names in question.where:
        sections = _within(sections, names)
    if question.near:
        sections = [inner for section in sections for inner in section.all_sections()]
    matching = [section for section in sections if _has_all(section, question.near)]
    return sorted(matching, key=lambda section: len(section.lines))


def _within(sections: list[Section], names: tuple[str, ...]) -> list[Section]:
    """Return the inner sections with the first of the names that any section has."""
    for name in names:
        inner = [inner for section in sections for inner in section.within(name)]
        if inner:
            return inner
    return []


def _has_all(section: Section, labels_and_values: tuple[tuple[str, str], ...]) -> bool:
    return all(_has(section, label, value) for label, value in labels_and_values)


def _has(section: Section, label: str, value: str) -> bool:
    if value:
        return any(line.says(label, value) for line in section.lines)
    return any(line.is_called(label) for line in section.lines)


def answered(page: Section, question: Question) -> bool:
    sections = places(page, question)
    if not question.where:
        lines = page.inner[0].lines
    elif question.near:
        lines = sections[0].lines if sections else []
    else:
        lines = [line for section in sections for line in section.statements()]
    return any(_answers(line, label, question) for line in lines for label in question.labels)


def _answers(line: Line, label: str, question: Question) -> bool:
    if question.whole:
        return line.is_called(label) and line.has_cell(question.answer)
    return line.says(label, question.answer)


ASKED = questions()


def unanswered(asked_questions: list[Question]) -> list[str]:
    pages = [page_of(question.family, question.order_code) for question in asked_questions]
    pairs = zip(pages, asked_questions, strict=True)
    return [str(question) for page, question in pairs if not answered(page, question)]


@pytest.mark.slow
def test_what_the_second_readings_say_is_answered() -> None:
    assert unanswered(ASKED) == []


def test_they_are_many_and_of_all_kinds() -> None:
    by_family = Counter(question.family for question in ASKED)
    assert len(ASKED) >= 200
    assert min(by_family.values()) >= 50, by_family
    assert set(by_family) == set(FAMILIES)
    kinds = {(question.family, question.kind) for question in ASKED}
    assert {(family, kind) for family in FAMILIES for kind in KINDS} - kinds == ABSENT


def by_hand() -> list[Question]:
    """Return the questions in the file next to this module."""
    return list(map(question_by_hand, yaml.safe_load(BY_HAND.read_text(encoding="utf-8"))))


def question_by_hand(entry: Mapping[str, Any]) -> Question:
    order_code = entry["page"]
    (family,) = (name for name in FAMILIES if order_code.lower().replace("amc", "am").startswith(name))
    return Question(
        family=family,
        order_code=order_code,
        kind=entry["ask"],
        where=tuple((words,) for words in entry["where"]),
        labels=(entry["line"],),
        answer=entry["answer"],
    )


def test_what_was_asked_by_hand_is_answered() -> None:
    hand_questions = by_hand()
    assert len(hand_questions) == 20
    assert {question.family for question in hand_questions} == set(FAMILIES)
    assert unanswered(hand_questions) == []


@pytest.mark.slow
def test_a_page_that_errs_is_noticed() -> None:
    """A wrong byte order, time, polynomial or colour, a missing pin, or a moved bit leaves a question unanswered."""
    text = (DOCS / "amm5" / "AMM5A21-65KSC1.md").read_text(encoding="utf-8")
    amm5_questions = questions(only="AMM5A21/65KSC1")
    assert all(answered(read(text), question) for question in amm5_questions)
    spoilt = {
        "low byte first": "high byte first",
        "| 13 | Brown_Green | +5Vdc": "| 15 | Brown_Green | +5Vdc",
        "bits 28:8": "bits 29:8",
        "at least 30 ms": "at least 3 ms",
        "x^6 + x + 1": "x^6 + x^2 + 1",
        "| Pink |": "| Turquoise |",
        "Default: `00`": "Default: `01`",
        "50 kHz to 10 MHz": "50 kHz to 1 MHz",
    }
    for correct, mistake in spoilt.items():
        assert correct in text
        page = read(text.replace(correct, mistake))
        assert [question for question in amm5_questions if not answered(page, question)], mistake
