"""Statements about an alternative: a question that the manual leaves open, and its answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Answer, Device, Layout
from .erratum import errata, erratum
from .text import Code, Part, Ref, Said, listed, said


def alternative(device: Device, item: Alternative) -> Iterator[Said]:
    """Yield the question, each answer, and the errata that explain why it is open."""
    yield question(item)
    yield from (answer(one) for one in item.answers)
    yield from map(erratum, errata(device, f"alternatives.{item.name}"))


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
        yield said("The positions of its fields depend on your choice of ", reference(item), ": ", *answers)


def reference(item: Alternative) -> Ref:
    return Ref("alternative", item.name, item.name)


def names(answers: Sequence[Answer]) -> Iterator[Part]:
    """Yield the names of the answers as parts, such as ``as_printed``."""
    yield from listed([Code(item.name) for item in answers])
