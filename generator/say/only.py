"""Statement about things that apply to some order codes only."""

from __future__ import annotations

from collections.abc import Iterator

from .text import Code, Said, said


def only(codes: str) -> Iterator[Said]:
    """Yield the order codes unless it applies to all."""
    if codes:
        yield said("Only with ", Code(codes))
