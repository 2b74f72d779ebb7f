"""What is said of things that hold for some order codes alone."""

from __future__ import annotations

from collections.abc import Iterator

from .text import Code, Said, said


def only(codes: str) -> Iterator[Said]:
    """The order codes, unless it holds for all."""
    if codes:
        yield said("Only with ", Code(codes))
