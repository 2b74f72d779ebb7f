"""Statements about the times that a manual gives."""

from __future__ import annotations

from ..model import Timing
from .text import Statement, statement
from .words import microseconds


def timing(printed_time: Timing) -> Statement:
    """Return its duration, labelled with the symbol in the manual or with our name."""
    description = f": {printed_time.meaning}" if printed_time.meaning else ""
    description += f" (only with {printed_time.only})" if printed_time.only else ""
    return statement(
        bounds(printed_time), description, label=printed_time.symbol or printed_time.name, source=printed_time.source
    )


def bounds_with_codes(printed_time: Timing) -> str:
    """Return the duration as text, with the order codes to which it applies unless these are all."""
    return f"{bounds(printed_time)} (only with {printed_time.only})" if printed_time.only else bounds(printed_time)


def bounds(printed_time: Timing) -> str:
    """Return the duration as text, such as ``at least 12 µs``."""
    bounds_by_word = (
        ("at least", printed_time.at_least_us),
        ("typically", printed_time.typical_us),
        ("at most", printed_time.at_most_us),
    )
    return ", ".join(f"{word} {microseconds(count)}" for word, count in bounds_by_word if count is not None)
