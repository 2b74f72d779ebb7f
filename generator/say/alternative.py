"""What is said of an alternative: a question that the manual leaves open, and its answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Answer, Device, Layout
from .erratum import errata, erratum
from .text import Code, Part, Ref, Said, listed, said


def alternative(device: Device, item: Alternative) -> Iterator[Said]:
    """All that running text says, in order: the question, each answer, and why it is open."""
    yield question(item)
    yield from (answer(one) for one in item.answers)
    yield from map(erratum, errata(device, f"alternatives.{item.name}"))


def question(item: Alternative) -> Said:
    """What is to be decided."""
    return said(item.meaning, source=item.source)


def answer(item: Answer) -> Said:
    """One answer, by its name."""
    return said(Code(item.name), f": {item.meaning}", source=item.source)


def needs(device: Device, layout: Layout) -> Iterator[Said]:
    """What has to be decided before a frame of this layout can be read or written."""
    for item in device.alternatives_of(layout):
        answers = listed([Code(one.name) for one in item.answers], " or ")
        yield said("Where its fields stand is for you to decide, ", reference(item), ": ", *answers)


def reference(item: Alternative) -> Ref:
    return Ref("alternative", item.name, item.name)


def names(answers: Sequence[Answer]) -> Iterator[Part]:
    """The answers as parts: ``as_printed``."""
    yield from listed([Code(item.name) for item in answers])
