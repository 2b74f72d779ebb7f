"""Questions of readers of the manuals: each answer is where they would look for it."""

from __future__ import annotations

from collections import Counter
from functools import cache
from pathlib import Path

import pytest
import yaml
from asked import Question, questions
from page_reader import Line, Section, read

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
        made = path.read_text(encoding="utf-8")
        if f"{order_code}\n" in made or f"`{order_code}`" in made.partition("\n| ")[0]:
            return read(made)
    raise AssertionError(f"no page for {order_code}")


def places(page: Section, question: Question) -> list[Section]:
    """Return the sections where a reader looks, the smallest first."""
    found = [page.inner[0]] if question.where else []
    for names in question.where:
        found = next(filter(None, ([inner for item in found for inner in item.within(name)] for name in names)), [])
    found = [inner for item in found for inner in item.every()] if question.known else found
    known = [item for item in found if all(_has(item, label, value) for label, value in question.known)]
    return sorted(known, key=lambda item: len(item.lines))


def _has(section: Section, label: str, value: str) -> bool:
    return any(line.says(label, value) if value else line.is_called(label) for line in section.lines)


def answered(page: Section, question: Question) -> bool:
    found = places(page, question)
    if not question.where:
        lines = page.inner[0].lines
    elif question.known:
        lines = found[0].lines if found else []
    else:
        lines = [line for item in found for line in item.statements()]
    return any(_answers(line, label, question) for line in lines for label in question.labels)


def _answers(line: Line, label: str, question: Question) -> bool:
    if question.whole:
        return line.is_called(label) and line.has_cell(question.answer)
    return line.says(label, question.answer)


ASKED = questions()


@pytest.mark.slow
def test_what_the_second_readings_say_is_answered() -> None:
    missed = [f"{item}" for item in ASKED if not answered(page_of(item.family, item.order_code), item)]
    assert missed == []


def test_they_are_many_and_of_all_kinds() -> None:
    by_family = Counter(item.family for item in ASKED)
    assert len(ASKED) >= 200
    assert min(by_family.values()) >= 50, by_family
    assert set(by_family) == set(FAMILIES)
    kinds = {(item.family, item.kind) for item in ASKED}
    assert {(family, kind) for family in FAMILIES for kind in KINDS} - kinds == ABSENT


def by_hand() -> list[Question]:
    """Return the questions in the file next to this one."""
    asked = yaml.safe_load(BY_HAND.read_text(encoding="utf-8"))
    return [
        Question(
            next(name for name in FAMILIES if item["page"].lower().replace("amc", "am").startswith(name)),
            item["page"],
            item["ask"],
            tuple((words,) for words in item["where"]),
            (item["line"],),
            item["answer"],
        )
        for item in asked
    ]


def test_what_was_asked_by_hand_is_answered() -> None:
    asked = by_hand()
    assert len(asked) == 20
    assert {item.family for item in asked} == set(FAMILIES)
    assert [f"{item}" for item in asked if not answered(page_of(item.family, item.order_code), item)] == []


@pytest.mark.slow
def test_a_page_that_errs_is_noticed() -> None:
    """A wrong byte order, time, polynomial or colour, a missing pin, or a moved bit leaves a question unanswered."""
    made = (DOCS / "amm5" / "AMM5A21-65KSC1.md").read_text(encoding="utf-8")
    asked = questions(only="AMM5A21/65KSC1")
    assert all(answered(read(made), item) for item in asked)
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
    for right, wrong in spoilt.items():
        assert right in made
        page = read(made.replace(right, wrong))
        assert [item for item in asked if not answered(page, item)], wrong
