"""Statements about an alternative: a question that the manual leaves open, and its answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Answer, Device, Layout
from .text import Code, Part, Ref, Statement, listed, statement


def question(alternative: Alternative) -> Statement:
    """Return the question."""
    return statement(alternative.meaning, source=alternative.source)


def answer(choice: Answer) -> Statement:
    """Return one answer, preceded by its name."""
    return statement(Code(choice.name), f": {choice.meaning}", source=choice.source)


def needs(device: Device, layout: Layout) -> Iterator[Statement]:
    """Yield the choices that are needed to read or write a frame of this layout."""
    for alternative in device.alternatives_of(layout):
        answers = listed([Code(choice.name) for choice in alternative.answers], " or ")
        choice = Ref("alternative", alternative.name, alternative.name)
        yield statement("The positions of its fields depend on your choice of ", choice, ": ", *answers)


def names(answers: Sequence[Answer]) -> Iterator[Part]:
    """Yield the names of the answers as parts, such as ``as_printed``."""
    yield from listed([Code(choice.name) for choice in answers])
