"""Statements about the evidence for the facts of a family."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device
from .text import Statement, statement

_MEANING = {
    "manual": "all pages of the manufacturer's document were read",
    "quoted": "every fact is in the manufacturer's words, an independent implementation agrees, and data from real"
    " hardware pass",
    "corroborated": "every fact is in the manufacturer's words or in two implementations that share no code, and data"
    " from real hardware pass",
    "corroborated, no hardware frame seen": "every fact is in the manufacturer's words or in two implementations that"
    " share no code",
    "uncorroborated": "the facts have a single source, so do not rely on them",
}
#: All grades, from the highest to the lowest.
GRADES = tuple(_MEANING)


def grade(device: Device) -> Statement:
    """Return the grade of the evidence, with its meaning, and the values that are still the template's."""
    grade_name = device.evidence.grade
    text = f"{grade_name} ({_MEANING[grade_name]})"
    return statement(f"{text}. {placeholders(device)}" if device.evidence.placeholders else text, label="Evidence")


def placeholders(device: Device) -> str:
    """Return the values that are still the template's in one sentence, or an empty text if there are none."""
    names = device.evidence.placeholders
    if not names:
        return ""
    verb = "value is" if len(names) == 1 else "values are"
    return f"{len(names)} {verb} still the template's, not the manufacturer's: {', '.join(names)}"


def document(device: Device) -> str:
    """Return the word for what does not state a fact: the manual, if all of it was read, otherwise the spec."""
    return "manual" if device.evidence.grade == "manual" else "spec"


def basis(device: Device) -> Iterator[Statement]:
    """Yield what the grade rests on, unless it is the manual as a whole, and the facts that are left out."""
    evidence = device.evidence
    if evidence.grade != "manual":
        for key, pages in evidence.documents.items():
            yield statement(pages, label=f"Read in {key}")
        for label, names in (("Implementations", evidence.implementations), ("Vectors", evidence.vectors)):
            if names:
                yield statement(", ".join(names), label=label)
    for fact in evidence.left_out:
        yield statement(fact, label="Left out")
