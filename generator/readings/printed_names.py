"""Names as printed in manuals, compared independently of spelling if both readers give them in the same language."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .reading import Reading

_OR = " | "
_BREAKS = re.compile(r"[\W_]+")


def printed_names(reading: Reading, name: str, others: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the names by language, as used in comparisons. Several in one language are alternatives."""
    found = {language: [plain(text)] for language, text in others.items()}
    if name:
        found.setdefault(reading.device.manual.language, []).append(plain(name))
    yield from ((language, _OR.join(texts)) for language, texts in found.items())


def same_name(one: str, other: str) -> bool:
    """Return True if two readers have a name in common."""
    return not set(one.split(_OR)).isdisjoint(other.split(_OR))


def plain(text: str) -> str:
    """Return text without the differences between readers: capitals and punctuation."""
    return _BREAKS.sub(" ", text).strip().casefold() or text
