"""Statements about the times that a manual gives."""

from __future__ import annotations

from ..model import Timing
from .text import Said, said
from .words import microseconds


def timing(item: Timing) -> Said:
    """Return its duration, labelled with the symbol in the manual or with our name."""
    about = f": {item.meaning}" if item.meaning else ""
    about += f" (only with {item.only})" if item.only else ""
    return said(bounds(item), about, label=item.symbol or item.name, source=item.source)


def bounds_with_codes(item: Timing) -> str:
    """Return the duration as text, with the order codes to which it applies unless these are all."""
    return f"{bounds(item)} (only with {item.only})" if item.only else bounds(item)


def bounds(item: Timing) -> str:
    """Return the duration as text, such as ``at least 12 µs``."""
    named = (("at least", item.at_least_us), ("typically", item.typical_us), ("at most", item.at_most_us))
    return ", ".join(f"{word} {microseconds(count)}" for word, count in named if count is not None)
