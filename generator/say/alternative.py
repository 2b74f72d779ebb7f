"""Statements about an alternative: a question that the manual leaves open, and its answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Answer, Device, Layout
from .text import Code, Part, Ref, Said, listed, said


def question(item: Alternative) -> Said:
    """Return the question."""
    return said(item.meaning, source=item.source)


def answer(item: Answer) -> Said:
    """Return one answer, preceded by its name."""
    return said(Code(item.name), f": {item.meaning}", source=item.source)


def needs(device: Device, layout: Layout) -> Iterator[Said]:
    """Yield the choices that are needed to read or write a frame of this layout."""
    for item in device.alternatives_of(layout):
        answers = listed([Code(one.name) for one in item.answers], " or ")
        choice = Ref("alternative", item.name, item.name)
        yield said("The positions of its fields depend on your choice of ", choice, ": ", *answers)


def names(answers: Sequence[Answer]) -> Iterator[Part]:
    """Yield the names of the answers as parts, such as ``as_printed``."""
    yield from listed([Code(item.name) for item in answers])
