"""Find the facts of a spec that cite a section or page of its manual."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

from ..language.document import Document, Path
from ..loading.from_mapping import parse_sources
from ..model import Sources
from .passages import Passage
from .sections import WORD, plain

#: Keys that hold no fact of their own.
_NO_FACTS = frozenset({"source", "name", "erratum"})
#: Keys of the words that a manual prints next to a value.
_LABELS = ("name", "printed_name", "title", "symbol", "contact", "signal")
#: Words that manuals print for values of the spec language.
_SHORT = {"read_only": ("ro", "r"), "read_write": ("rw",), "write_only": ("wo", "w")}
#: Weights of the words that differ, and of those close to them. All words near them weigh as much as 2.
_DIFFERS, _CLOSE = 6.0, 2.0
#: Weight of the words of an insertion, which no fact of the old edition contains.
_INSERTED = 1.0
#: A number with its unit, printed without a space.
_WITH_UNIT = re.compile(r"(\d[\d.]*)[kmµn]?(?:hz|vdc|v|a|s|m)")
#: The path of a fact about an option of the order code.
_OPTION = re.compile(r"order_code\.parts\.[^.]+\.values\.([^.]+)(?:\..*)?")
#: An order code that ends in a number, such as the resolution.
_ORDER_CODE = re.compile(r"[a-z]{2}\w*?(\d\d)")


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
        return f"{_relative_path(self.file)}:{self.line}: {self.path}: {text if len(text) <= 60 else text[:57] + '...'}"

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of the value as a manual may print them."""
        return frozenset(_printed_words(self.value)) | _with_top_bit(
            self.value if self.path.endswith(".poly") else None
        )

    @cached_property
    def named(self) -> frozenset[str]:
        """The words of its name and of the names above it."""
        return frozenset(word for name in self.names for word in WORD.findall(name.replace("_", " ").casefold()))

    def is_at(self, sections: Collection[str], passage: Passage) -> bool:
        """Return whether it cites one of the sections, or is an option of the order code that the passage names.

        Manuals print order codes in many sections, and in headings. A spec cites few of them.
        """
        option = _OPTION.fullmatch(self.path)
        name = option[1].casefold() if option is not None else ""
        words = {word.casefold() for word in passage.old}
        # A short label, such as A, TO or 21, can be any word, but not at the end of an order code.
        is_label = len(name) > (3 if name.isdigit() else 2) or (not name.isdigit() and any(map(str.isdigit, name)))
        is_named = (is_label and name in words) or (name.isdigit() and name in _last_digits(words))
        return is_named or not self.sections.isdisjoint(sections)


def _last_digits(words: Iterable[str]) -> set[str]:
    """Return the two digits at the end of each order code among words."""
    return {match[1] for word in words if (match := _ORDER_CODE.fullmatch(word)) is not None}


def _relative_path(file: str) -> str:
    """Return a path relative to the current folder if it is below it."""
    with suppress(ValueError):
        return FilePath(file).relative_to(FilePath.cwd()).as_posix()
    return file


def _printed_words(value: object) -> Iterator[str]:
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


def _with_top_bit(poly: object) -> frozenset[str]:
    """Return a polynomial as manuals print it with its top bit, in hexadecimal or binary, for any width."""
    if not isinstance(poly, int):
        return frozenset()
    numbers = [poly | 1 << width for width in range(max(poly.bit_length(), 3), 33)]
    texts: set[str] = set()
    for number in numbers:
        texts |= {f"{number:x}", f"{number:x}h", f"0x{number:x}", f"{number:b}"}
    return frozenset(texts)


def citing(document: Document) -> list[Citing]:
    """Return the facts of a spec with what they cite. A fact without a source has the source of the item around it."""
    return list(_sourced_items(document, document.data, (), (), ()))


def _cited(source: str) -> Sources:
    """Return the places that a source cites, without the mark of the template of ``codewheel new``."""
    return parse_sources(source.replace("TODO ", ""))


def _sourced_items(
    document: Document, data: Any, path: Path, source: tuple[Any, ...], names: tuple[str, ...]
) -> Iterator[Citing]:
    if isinstance(data, dict):
        if isinstance(data.get("source"), str):
            source = _cited(data["source"])
        labels = [data.get(key) for key in _LABELS]
        in_languages = data.get("names")
        labels += in_languages.values() if isinstance(in_languages, dict) else ()
        names = (*names, *(label for label in labels if isinstance(label, str)))
        for key, member in data.items():
            own_source = data.get(f"{key}_source")
            cited = _cited(own_source) if isinstance(own_source, str) else source
            if key not in _NO_FACTS and not str(key).endswith("_source"):
                yield from _sourced_items(document, member, (*path, key), cited, (*names, str(key)))
    elif isinstance(data, list):
        for index, member in enumerate(data):
            yield from _sourced_items(document, member, (*path, index), source, names)
    elif source:
        own_manual = [cited_source for cited_source in source if not cited_source.document]
        yield Citing(
            document.file,
            document.position(path)[0],
            document.name_path(path),
            data,
            frozenset(cited_source.section for cited_source in own_manual if cited_source.section),
            frozenset(cited_source.page for cited_source in own_manual if cited_source.page is not None),
            names,
        )


def ranked(facts: Sequence[Citing], passage: Passage) -> list[Citing]:
    """Return the facts whose value or name occurs in a passage, the most likely to have changed first.

    A word counts more if fewer of the facts have it, and more in the old words than in those near them.
    """
    differ = _comparable_words(passage.old or passage.new)
    close, near = _comparable_words(passage.close), _comparable_words(passage.around)
    section = near | _comparable_words(passage.section.words)
    weight = _DIFFERS if passage.old else _INSERTED
    frequent = Counter(word for fact in facts for word in fact.words | fact.named)
    scores: dict[int, float] = {}
    for fact in facts:
        changed = sum(1 / frequent[word] for word in fact.words & differ)
        changed += sum(1 / frequent[word] for word in fact.named & differ) / 2
        named, value_share = _share(fact.named, near, section, frequent), _share(fact.words, near, section, frequent)
        if changed or value_share or fact.named & section <= near:
            close_share = _share(fact.named, close, section, frequent)
            if fact.words & differ:
                changed += close_share
            close_share += _share(fact.words, close, section, frequent)
            scores[id(fact)] = weight * changed + _CLOSE * close_share + named + value_share
    likely_facts = [fact for fact in facts if scores.get(id(fact), 0) > 0]
    return sorted(likely_facts, key=lambda fact: (-scores[id(fact)], fact.line))


def _comparable_words(words: Iterable[str]) -> set[str]:
    """Return printed words as they are compared: with a decimal point, and numbers also without their unit."""
    folded = {word.casefold() for word in words}
    folded |= {word.replace(",", ".") for word in folded}
    patterns = (_WITH_UNIT, _ORDER_CODE)
    return folded | {match[1] for word in folded for pattern in patterns if (match := pattern.fullmatch(word))}


def _share(words: frozenset[str], near: set[str], section: set[str], frequent: Mapping[str, int]) -> float:
    """Return the share of the words that occur near a passage, among those that occur in its section."""
    printed = sum(1 / frequent[word] for word in words & section)
    printed_near = sum(1 / frequent[word] for word in words & section & near)
    return printed_near / printed if printed else 0
