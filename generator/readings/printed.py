"""Names as manuals print them: compared where both readers give them in the same language, however they are written."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .reading import Reading

_OR = " | "
_BREAKS = re.compile(r"[\W_]+")


def printed_names(reading: Reading, name: str, others: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The names by their languages, as they are compared; of several in one language each may be what is printed."""
    found = {language: [plain(text)] for language, text in others.items()}
    if name:
        found.setdefault(reading.device.manual.language, []).append(plain(name))
    yield from ((language, _OR.join(texts)) for language, texts in found.items())


def same_name(one: str, other: str) -> bool:
    """Whether two readers have a name in common."""
    return not set(one.split(_OR)).isdisjoint(other.split(_OR))


def plain(text: str) -> str:
    """A text without what readers write differently: capitals and marks."""
    return _BREAKS.sub(" ", text).strip().casefold() or text
