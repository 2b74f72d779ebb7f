"""What is said of a remedy, and of the steps that a person carries out by hand for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .name import heading
from .text import Ref, Said, listed, said, told
from .words import sentence


def remedied(text: str, names: Sequence[str]) -> Iterator[Said]:
    """The remedy, with a reference to the steps by hand of these names."""
    if names:
        steps = listed([Ref("by-hand", name, heading(name)) for name in names], " or ")
        yield said(*([f"{sentence(text)} "] if text else []), "Steps: ", *steps, label="Remedy")
    else:
        yield from told(text, label="Remedy")


def with_steps(text: str, names: Sequence[str]) -> str:
    """The same as plain text: the steps by their titles on the page of the hardware."""
    titles = " or ".join(map(heading, names))
    return f"{sentence(text)} Steps on the hardware page: {titles}".strip() if titles else text
