"""Statement about items that apply only to some order codes."""

from __future__ import annotations

from collections.abc import Iterator

from .text import Code, Statement, statement


def only(codes: str) -> Iterator[Statement]:
    """Yield the order codes, unless the item applies to all of them."""
    if codes:
        yield statement("Only with ", Code(codes))
