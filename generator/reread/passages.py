"""Passages that differ between two editions, section by section, and the facts of a spec that cite a passage."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

from ..language.document import Document, Path
from ..loading.from_mapping import parse_sources
from ..model import Sources
from .sections import WORD, Manual, Section, aligned, letters, plain

#: Differences with no more equal words between them are one passage.
_TOGETHER = 6
#: Words before and after a difference that belong to its passage. The name of a register is often far above.
_BEFORE, _AFTER = 60, 20
#: Words before and after a difference that are close to it, such as the rest of a row.
_CLOSE = 8
#: Words shown before and after a difference.
_SHOWN = 5
#: Least share of common words for texts in the same language.
_SAME_LANGUAGE = 0.5


@dataclass(frozen=True, slots=True)
class Passage:
    """A difference: its ``section`` in the old edition, or in the new one if it is new.

    ``old`` and ``new`` contain the words that differ, ``close`` and ``around`` those within a row and within a
    paragraph of them in both editions, and ``shown`` the two texts for display.
    """

    section: Section
    old: tuple[str, ...]
    new: tuple[str, ...]
    close: tuple[str, ...]
    around: tuple[str, ...]
    shown: tuple[str, str]


def same_language(old: Manual, new: Manual) -> bool:
    """Return whether two texts have enough words in common to be compared word by word."""
    first, second = (Counter(filter(str.isalpha, manual.words.elements())) for manual in (old, new))
    return (first & second).total() >= _SAME_LANGUAGE * min(first.total(), second.total())


def changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield the passages that differ.

    Sections that were only renumbered or moved do not differ. A running head of one edition can be the title on the
    cover of both, so text that only one edition has is skipped if it is a running head.
    """
    heads = old.heads | new.heads
    for old_section, new_section in aligned(old, new):
        if old_section is None or new_section is None:
            section = old_section or new_section
            assert section is not None
            words = section.words
            is_gone = old_section is not None
            shown = f"section {section.shown}, {len(words)} words"
            old_words, new_words = (words, ()) if is_gone else ((), words)
            old_and_new = (shown, "") if is_gone else ("", shown)
            yield Passage(section, old_words, new_words, words, words, old_and_new)
        else:
            for first, second in (
                (WORD.findall(old_section.title), WORD.findall(new_section.title)),
                (old_section.words, new_section.words),
            ):
                yield from _in_section(old_section, first, second, heads)


def _in_section(section: Section, old: Sequence[str], new: Sequence[str], heads: Collection[str]) -> Iterator[Passage]:
    if old == new:
        return
    for low, high, new_low, new_high in _groups(old, new):
        if "".join(old[low:high]) == "".join(new[new_low:new_high]):
            continue  # the same letters, divided otherwise at the end of a line
        if (low == high or new_low == new_high) and letters((*old[low:high], *new[new_low:new_high])) in heads:
            continue
        yield Passage(
            section=section,
            old=tuple(old[low:high]),
            new=tuple(new[new_low:new_high]),
            close=(*_widened(old, low, high, _CLOSE, _CLOSE), *_widened(new, new_low, new_high, _CLOSE, _CLOSE)),
            around=(*_widened(old, low, high, _BEFORE, _AFTER), *_widened(new, new_low, new_high, _BEFORE, _AFTER)),
            shown=(_text(old, low, high), _text(new, new_low, new_high)),
        )


def _widened(words: Sequence[str], low: int, high: int, count_before: int, count_after: int) -> Sequence[str]:
    """Return a range of words with some words before and after it."""
    return words[max(low - count_before, 0) : high + count_after]


def _groups(old: Sequence[str], new: Sequence[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the ranges of words that differ, with near ones joined."""
    waiting: tuple[int, int, int, int] | None = None
    for tag, low, high, new_low, new_high in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        if waiting is not None and low - waiting[1] <= _TOGETHER:
            waiting = (waiting[0], high, waiting[2], new_high)
        else:
            if waiting is not None:
                yield waiting
            waiting = (low, high, new_low, new_high)
    if waiting is not None:
        yield waiting


def _text(words: Sequence[str], low: int, high: int) -> str:
    words_before, words_after = words[max(low - _SHOWN, 0) : low], words[high : high + _SHOWN]
    return " ".join([*words_before, "[", *words[low:high], "]", *words_after]).replace("[ ]", "[]")


def numbers_changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield a passage for each section in which other numbers occur, for editions in two languages."""
    for old_section, new_section in aligned(old, new):
        if old_section is None or new_section is None:
            continue
        old_numbers, new_numbers = _numbers(old_section), _numbers(new_section)
        removed, added = tuple((old_numbers - new_numbers).elements()), tuple((new_numbers - old_numbers).elements())
        if removed or added:
            changed_numbers = (*removed, *added)
            yield Passage(
                old_section, removed, added, changed_numbers, changed_numbers, (", ".join(removed), ", ".join(added))
            )


def _numbers(section: Section) -> Counter[str]:
    """Return the numbers in a section, with a decimal point in every language."""
    return Counter(word.replace(",", ".") for word in section.words if _is_number(word))


def _is_number(word: str) -> bool:
    return any(letter.isdigit() for letter in word)


#: Keys that hold no fact of their own.
_NO_FACTS = frozenset({"source", "name", "erratum"})
#: Keys of the words that a manual prints next to a value.
_LABELS = ("name", "printed_name", "title", "symbol", "contact", "signal")
#: Words that manuals print for values of the spec language.
_SHORT = {"read_only": ("ro", "r"), "read_write": ("rw",), "write_only": ("wo", "w")}
#: Weights of the words that differ, and of those close to them. All words near them weigh as much as 2.
_DIFFERS, _CLOSE_TO_CHANGE = 6.0, 2.0
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
            scores[id(fact)] = weight * changed + _CLOSE_TO_CHANGE * close_share + named + value_share
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
