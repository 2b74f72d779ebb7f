"""Passages that differ between two editions, section by section, and the facts of a spec that cite a passage."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, NamedTuple

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
#: Letters of a value shown with its fact.
_SHOWN_LETTERS = 60
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
        if old_section is not None and new_section is not None:
            old_title, new_title = WORD.findall(old_section.title), WORD.findall(new_section.title)
            yield from _in_section(old_section, old_title, new_title, heads)
            yield from _in_section(old_section, old_section.words, new_section.words, heads)
        elif old_section is not None:
            words = old_section.words
            yield Passage(old_section, words, (), words, words, (_whole_section_text(old_section), ""))
        elif new_section is not None:
            words = new_section.words
            yield Passage(new_section, (), words, words, words, ("", _whole_section_text(new_section)))


def _whole_section_text(section: Section) -> str:
    return f"section {section.shown}, {len(section.words)} words"


class _Ranges(NamedTuple):
    """A range of words of the old edition, and the one that replaces it in the new edition."""

    low: int
    high: int
    new_low: int
    new_high: int


def _in_section(section: Section, old: Sequence[str], new: Sequence[str], heads: Collection[str]) -> Iterator[Passage]:
    """Yield the passages that differ between the words ``old`` and ``new`` of a section."""
    if old == new:
        return
    for low, high, new_low, new_high in _groups(old, new):
        old_words, new_words = tuple(old[low:high]), tuple(new[new_low:new_high])
        # Words that are only divided differently at the end of a line have the same letters.
        if "".join(old_words) == "".join(new_words):
            continue
        is_in_one_edition = not old_words or not new_words
        if is_in_one_edition and letters((*old_words, *new_words)) in heads:
            continue
        yield Passage(
            section=section,
            old=old_words,
            new=new_words,
            close=(*_widened(old, low, high, _CLOSE, _CLOSE), *_widened(new, new_low, new_high, _CLOSE, _CLOSE)),
            around=(*_widened(old, low, high, _BEFORE, _AFTER), *_widened(new, new_low, new_high, _BEFORE, _AFTER)),
            shown=(_text(old, low, high), _text(new, new_low, new_high)),
        )


def _widened(words: Sequence[str], low: int, high: int, count_before: int, count_after: int) -> Sequence[str]:
    """Return a range of words with some words before and after it."""
    return words[max(low - count_before, 0) : high + count_after]


def _groups(old: Sequence[str], new: Sequence[str]) -> Iterator[_Ranges]:
    """Yield the ranges of words that differ, with near ones joined."""
    last: _Ranges | None = None
    for tag, low, high, new_low, new_high in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        ranges = _Ranges(low, high, new_low, new_high)
        if last is None:
            last = ranges
        elif low - last.high <= _TOGETHER:
            last = last._replace(high=high, new_high=new_high)
        else:
            yield last
            last = ranges
    if last is not None:
        yield last


def _text(words: Sequence[str], low: int, high: int) -> str:
    words_before, words_after = words[max(low - _SHOWN, 0) : low], words[high : high + _SHOWN]
    return " ".join([*words_before, "[", *words[low:high], "]", *words_after]).replace("[ ]", "[]")


def numbers_changed(old: Manual, new: Manual) -> Iterator[Passage]:
    """Yield a passage for each section in which other numbers occur, for editions in two languages."""
    for old_section, new_section in aligned(old, new):
        if old_section is None or new_section is None:
            continue
        old_numbers, new_numbers = _numbers(old_section), _numbers(new_section)
        removed = tuple((old_numbers - new_numbers).elements())
        added = tuple((new_numbers - old_numbers).elements())
        changed_numbers = (*removed, *added)
        if changed_numbers:
            yield Passage(
                section=old_section,
                old=removed,
                new=added,
                close=changed_numbers,
                around=changed_numbers,
                shown=(", ".join(removed), ", ".join(added)),
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
        if len(text) > _SHOWN_LETTERS:
            text = text[: _SHOWN_LETTERS - 3] + "..."
        return f"{_relative_path(self.file)}:{self.line}: {self.path}: {text}"

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of the value as a manual may print them."""
        printed_words = frozenset(_printed_words(self.value))
        if self.path.endswith(".poly"):
            printed_words |= _with_top_bit(self.value)
        return printed_words

    @cached_property
    def named(self) -> frozenset[str]:
        """The words of its name and of the names above it."""
        return frozenset(word for name in self.names for word in WORD.findall(name.replace("_", " ").casefold()))

    def is_at(self, sections: Collection[str], passage: Passage) -> bool:
        """Return whether it cites one of the sections, or is an option of the order code that the passage names.

        Manuals print order codes in many sections, and in headings. A spec cites few of them.
        """
        return not self.sections.isdisjoint(sections) or self._is_option_named_in(passage)

    def _is_option_named_in(self, passage: Passage) -> bool:
        option = _OPTION.fullmatch(self.path)
        if option is None:
            return False
        label = option[1].casefold()
        words = {word.casefold() for word in passage.old}
        # Labels of digits are often printed only at the end of an order code.
        return (_is_order_code_label(label) and label in words) or (label.isdigit() and label in _last_digits(words))


def _is_order_code_label(text: str) -> bool:
    """Return whether a text can only be a label of an order code. A, TO or 21 can be any word."""
    if text.isdigit():
        return len(text) > 3
    return len(text) > 2 or any(letter.isdigit() for letter in text)


def _last_digits(words: Iterable[str]) -> set[str]:
    """Return the two digits at the end of each order code among words."""
    order_codes = [_ORDER_CODE.fullmatch(word) for word in words]
    return {order_code[1] for order_code in order_codes if order_code is not None}


def _relative_path(file: str) -> str:
    """Return a path relative to the current folder if it is below it."""
    with suppress(ValueError):
        return FilePath(file).relative_to(FilePath.cwd()).as_posix()
    return file


def _printed_words(value: object) -> Iterator[str]:
    """Yield the words of a value. A number can be printed in hexadecimal, with separators, or in a larger unit."""
    if isinstance(value, bool) or value is None:
        return
    if not isinstance(value, int):
        yield from (word.casefold() for word in WORD.findall(plain(str(value))))
        yield from _SHORT.get(str(value), ())
        return
    with_commas = f"{value:,}"
    yield from (with_commas, with_commas.replace(",", "."))
    yield f"{value:g}"
    for scale in (1000, 1_000_000):
        # 100 can be printed as 0.1 of the larger unit.
        if value >= scale // 10:
            yield f"{value / scale:g}"
    yield from (str(value), f"{value / 10:.1f}")
    yield from (f"{value:x}", f"{value:02x}", f"{value:x}h", f"{value:02x}h", f"0x{value:x}", f"0x{value:02x}")


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
    document: Document, data: Any, path: Path, source: Sources, names: tuple[str, ...]
) -> Iterator[Citing]:
    """Yield the facts in part of a spec, with the source and the names of the items around it."""
    if isinstance(data, dict):
        if isinstance(data.get("source"), str):
            source = _cited(data["source"])
        names = (*names, *_labels(data))
        for key, member in data.items():
            if key in _NO_FACTS or str(key).endswith("_source"):
                continue
            member_source = data.get(f"{key}_source")
            cited = _cited(member_source) if isinstance(member_source, str) else source
            yield from _sourced_items(document, member, (*path, key), cited, (*names, str(key)))
    elif isinstance(data, list):
        for index, member in enumerate(data):
            yield from _sourced_items(document, member, (*path, index), source, names)
    elif source:
        in_manual = [citation for citation in source if not citation.document]
        yield Citing(
            file=document.file,
            line=document.position(path)[0],
            path=document.name_path(path),
            value=data,
            sections=frozenset(citation.section for citation in in_manual if citation.section),
            pages=frozenset(citation.page for citation in in_manual if citation.page is not None),
            names=names,
        )


def _labels(item: Mapping[str, Any]) -> list[str]:
    """Return the names of an item of a spec, as printed and in other languages."""
    labels = [item.get(key) for key in _LABELS]
    names_by_language = item.get("names")
    if isinstance(names_by_language, dict):
        labels += names_by_language.values()
    return [label for label in labels if isinstance(label, str)]


class _PassageWords(NamedTuple):
    """Words of a passage as they are compared: those that differ, and those in the row, paragraph and section of it.

    ``weight`` is the weight of a word that differs.
    """

    differing: set[str]
    row: set[str]
    paragraph: set[str]
    section: set[str]
    weight: float


def ranked(facts: Sequence[Citing], passage: Passage) -> list[Citing]:
    """Return the facts whose value or name occurs in a passage, the most likely to have changed first.

    A word counts more if fewer of the facts have it, and more in the old words than in those near them.
    """
    paragraph = _comparable_words(passage.around)
    passage_words = _PassageWords(
        differing=_comparable_words(passage.old or passage.new),
        row=_comparable_words(passage.close),
        paragraph=paragraph,
        section=paragraph | _comparable_words(passage.section.words),
        weight=_DIFFERS if passage.old else _INSERTED,
    )
    fact_counts = Counter(word for fact in facts for word in fact.words | fact.named)
    scores = [_score(fact, passage_words, fact_counts) for fact in facts]
    likely_facts = [(score, fact) for score, fact in zip(scores, facts, strict=True) if score > 0]
    likely_facts.sort(key=lambda scored_fact: (-scored_fact[0], scored_fact[1].line))
    return [fact for _, fact in likely_facts]


def _score(fact: Citing, passage: _PassageWords, fact_counts: Mapping[str, int]) -> float:
    """Return how much of a fact occurs in a passage. It is 0 if the passage is not about the fact."""
    differing = _rarity(fact.words & passage.differing, fact_counts)
    differing += _rarity(fact.named & passage.differing, fact_counts) / 2
    paragraph_name_share = _share(fact.named, passage.paragraph, passage.section, fact_counts)
    paragraph_value_share = _share(fact.words, passage.paragraph, passage.section, fact_counts)
    # If the section prints words of the name elsewhere, the paragraph may be about another item.
    is_named_elsewhere = bool((fact.named & passage.section) - passage.paragraph)
    if is_named_elsewhere and not differing and not paragraph_value_share:
        return 0
    row_name_share = _share(fact.named, passage.row, passage.section, fact_counts)
    row_value_share = _share(fact.words, passage.row, passage.section, fact_counts)
    if fact.words & passage.differing:
        # The value differs in a row with the name of the fact.
        differing += row_name_share
    row_score = _CLOSE_TO_CHANGE * (row_name_share + row_value_share)
    return passage.weight * differing + row_score + paragraph_name_share + paragraph_value_share


def _comparable_words(words: Iterable[str]) -> set[str]:
    """Return printed words as they are compared: with a decimal point, and numbers also without their unit."""
    folded = {word.casefold() for word in words}
    folded |= {word.replace(",", ".") for word in folded}
    matches = [pattern.fullmatch(word) for word in folded for pattern in (_WITH_UNIT, _ORDER_CODE)]
    return folded | {match[1] for match in matches if match is not None}


def _rarity(words: Set[str], fact_counts: Mapping[str, int]) -> float:
    """Return the weight of words: the fewer facts have a word, the more it counts."""
    return sum(1 / fact_counts[word] for word in words)


def _share(words: frozenset[str], near: set[str], section: set[str], fact_counts: Mapping[str, int]) -> float:
    """Return the share of the words that occur near a passage, among those that occur in its section."""
    in_section = _rarity(words & section, fact_counts)
    return _rarity(words & section & near, fact_counts) / in_section if in_section else 0
