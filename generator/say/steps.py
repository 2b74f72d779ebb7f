"""Statements about a remedy and the manual steps that it needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .name import heading
from .text import Ref, Statement, listed, spec_text, statement
from .words import sentence


def remedied(text: str, names: Sequence[str]) -> Iterator[Statement]:
    """Yield the remedy with references to its manual steps."""
    if names:
        steps = listed([Ref("by-hand", name, heading(name)) for name in names], " or ")
        yield statement(*([f"{sentence(text)} "] if text else []), "Steps: ", *steps, label="Remedy")
    else:
        yield from spec_text(text, label="Remedy")


def with_steps(text: str, names: Sequence[str]) -> str:
    """Return the remedy as plain text with the titles of its steps on the hardware page."""
    titles = " or ".join(map(heading, names))
    return f"{sentence(text)} Steps on the hardware page: {titles}".strip() if titles else text
