"""Find the facts of a spec that cite a section or page of its manual."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

from ..language.document import Document, Path
from ..loading.from_mapping import parse_sources
from .passages import Passage
from .sections import WORD, plain

#: Keys that hold no fact of their own.
_NO_FACTS = frozenset({"source", "name", "erratum"})
#: Words that manuals print for values of the spec language.
_SHORT = {"read_only": ("ro", "r"), "read_write": ("rw",), "write_only": ("wo", "w")}
#: Weight of the words that differ. All words near them weigh as much as 2.
_DIFFERS = 6.0


@dataclass(frozen=True)
class Citing:
    """A fact that cites the manual: its place in the spec, its value, and the sections and pages that it cites."""

    file: str
    line: int
    path: str
    value: object
    sections: frozenset[str]
    pages: frozenset[int]
    names: tuple[str, ...]

    @property
    def shown(self) -> str:
        text = " ".join(str(self.value).split())
        return f"{_here(self.file)}:{self.line}: {self.path}: {text if len(text) <= 60 else text[:57] + '...'}"

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of the value as a manual may print them."""
        return frozenset(_printed(self.value))

    @cached_property
    def named(self) -> frozenset[str]:
        """The words of its name and of the names above it."""
        return frozenset(word for name in self.names for word in WORD.findall(name.replace("_", " ").casefold()))


def _here(file: str) -> str:
    """Return a path relative to the current folder if it is below it."""
    with suppress(ValueError):
        return FilePath(file).relative_to(FilePath.cwd()).as_posix()
    return file


def _printed(value: object) -> Iterator[str]:
    """Yield the words of a value. A number can be printed in hexadecimal, with separators, or in a larger unit."""
    if isinstance(value, bool) or value is None:
        return
    if isinstance(value, int):
        yield from (f"{value:,}", f"{value:,}".replace(",", "."))
        yield from (f"{value / scale:g}" for scale in (1, 1000, 1_000_000) if value >= scale // 10 or scale == 1)
        yield from (str(value), f"{value / 10:.1f}")
        yield from (f"{value:x}", f"{value:02x}", f"{value:x}h", f"{value:02x}h", f"0x{value:x}", f"0x{value:02x}")
    else:
        yield from (word.casefold() for word in WORD.findall(plain(str(value))))
        yield from _SHORT.get(str(value), ())


def citing(document: Document) -> list[Citing]:
    """Return the facts of a spec with what they cite. A fact without a source has the source of the item around it."""
    return list(_below(document, document.data, (), (), ()))


def _below(
    document: Document, data: Any, path: Path, source: tuple[Any, ...], names: tuple[str, ...]
) -> Iterator[Citing]:
    if isinstance(data, dict):
        if isinstance(data.get("source"), str):
            source = parse_sources(data["source"])
        labels = (data.get(key) for key in ("name", "printed_name", "title", "symbol"))
        names = (*names, *(label for label in labels if isinstance(label, str)))
        for key, item in data.items():
            own = data.get(f"{key}_source")
            cited = parse_sources(own) if isinstance(own, str) else source
            if key not in _NO_FACTS and not str(key).endswith("_source"):
                yield from _below(document, item, (*path, key), cited, (*names, str(key)))
    elif isinstance(data, list):
        for index, item in enumerate(data):
            yield from _below(document, item, (*path, index), source, names)
    elif source:
        own_manual = [item for item in source if not item.document]
        yield Citing(
            document.file,
            document.position(path)[0],
            document.name_path(path),
            data,
            frozenset(item.section for item in own_manual if item.section),
            frozenset(item.page for item in own_manual if item.page is not None),
            names,
        )


def ranked(facts: Sequence[Citing], passage: Passage) -> list[Citing]:
    """Return the facts whose value or name occurs in a passage, the most likely to have changed first.

    A word counts more if fewer of the facts have it, and more in the old words than in those near them.
    """
    differ = {word.casefold() for word in passage.old or passage.new}
    near = {word.casefold() for word in passage.around}
    section = near | {word.casefold() for word in passage.section.words}
    frequent = Counter(word for fact in facts for word in fact.words | fact.named)
    scores = {id(fact): _score(fact, differ, near, section, frequent) for fact in facts}
    found = [fact for fact in facts if scores[id(fact)] > 0]
    return sorted(found, key=lambda fact: (-scores[id(fact)], fact.line))


def _score(fact: Citing, differ: set[str], near: set[str], section: set[str], frequent: Mapping[str, int]) -> float:
    """Return the weight of a fact for a passage, or 0 if neither its value nor its name occurs there."""
    changed = sum(1 / frequent[word] for word in fact.words & differ)
    changed += sum(1 / frequent[word] for word in fact.named & differ) / 2
    named, valued = _share(fact.named, near, section), _share(fact.words, near, section)
    return _DIFFERS * changed + named + valued if changed or named == 1 or valued else 0


def _share(words: frozenset[str], near: set[str], section: set[str]) -> float:
    """Return the share of the words that occur near a passage, among those that occur in its section."""
    printed = words & section
    return len(printed & near) / len(printed) if printed else 0
