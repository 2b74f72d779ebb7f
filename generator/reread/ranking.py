"""The facts that a changed passage touches, the most likely to have changed first."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import NamedTuple

from .facts import ORDER_CODE, Citing, spaced
from .passages import Passage

#: Weights of the words that differ, and of those close to them. All words near them weigh as much as 2.
_DIFFERS, _CLOSE_TO_CHANGE = 6.0, 2.0
#: Weight of the words of an insertion, which no fact of the old edition contains.
_INSERTED = 1.0
#: Weight of the words next to an insertion.
_NEXT_TO = 4.0
#: Facts listed of the most likely items, of each other one, and of those that refer to the first one.
_OF_FIRST_ITEMS, _OF_OTHER_ITEM, _REFERRING = (6, 4), 2, 3
#: Items of which a value or name that differs is listed before everything else.
_DIFFERING_VALUES = 4
#: A number in hexadecimal, which the bytes of an example have without the letter.
_HEXADECIMAL = re.compile(r"[0-9a-f]{2,}h")
#: A number with its unit, printed without a space.
#: A label of an order code, in capital letters.
_LABEL = re.compile(r"[A-Z][A-Z0-9]+")
#: Groups of facts that are a changed text, at most.
_MOST_EQUAL = 10
#: Letters of a changed text that is looked for in other texts, with the spaces around it.
_SHORTEST_TEXT = 4
_WITH_UNIT = re.compile(r"(\d[\d.]*)[kmµn]?(?:hz|vdc|v|a|s|m)")


class _PassageWords(NamedTuple):
    """Words of a passage as they are compared: those that differ, and those in the row, paragraph and section of it.

    ``weight`` is the weight of a word that differs.
    """

    differing: set[str]
    next_to: set[str]
    row: set[str]
    paragraph: set[str]
    section: set[str]
    weight: float


class SectionFacts:
    """The facts that cite a section, with the number of those that have each word."""

    def __init__(self, facts: Sequence[Citing], section_words: Iterable[str]) -> None:
        self.facts = facts
        self.words = _comparable_words(section_words)
        self.counts = Counter(word for fact in facts for word in fact.words | fact.named)

    def scored(self, passage: Passage) -> list[tuple[float, Citing]]:
        """Return the facts whose value or name occurs in a passage with their scores, the highest first.

        A word counts more if fewer of the facts have it, and more in the old words than in those near them.
        """
        paragraph = _comparable_words(passage.around)
        passage_words = _PassageWords(
            differing=_comparable_words(passage.old or passage.new),
            next_to=_comparable_words(passage.next_to),
            row=_comparable_words(passage.close),
            paragraph=paragraph,
            section=self.words,
            weight=_DIFFERS if passage.old else _INSERTED,
        )
        scores = [(_score(fact, passage_words, self.counts), fact) for fact in self.facts]
        likely_facts = [scored_fact for scored_fact in scores if scored_fact[0] > 0]
        likely_facts.sort(key=lambda scored_fact: (-scored_fact[0], scored_fact[1].line))
        return likely_facts


class TouchedFacts:
    """The facts of a spec, for finding those that a passage touches."""

    def __init__(self, facts: Sequence[Citing]) -> None:
        self.all_facts = facts
        self._facts_by_item: dict[str, list[Citing]] = {}
        for fact in facts:
            self._facts_by_item.setdefault(fact.item, []).append(fact)
        self._items_by_reference: dict[str, list[str]] = {}
        for item, item_facts in self._facts_by_item.items():
            for reference in frozenset[str]().union(*(fact.refers_to for fact in item_facts)):
                self._items_by_reference.setdefault(reference, []).append(item)
        self._sections: dict[tuple[frozenset[str], str], SectionFacts] = {}

    def of(self, passage: Passage, sections: Set[str]) -> tuple[list[Citing], int]:
        """Return the facts that a passage touches, the most likely first, and the number of facts of its sections."""
        key = frozenset(sections), passage.section.number
        if key not in self._sections:
            cited = [fact for fact in self.all_facts if not fact.sections.isdisjoint(sections)]
            self._sections[key] = SectionFacts(cited, passage.section.words)
        in_section = self._sections[key]
        others = [fact for fact in self.all_facts if fact.sections.isdisjoint(sections) and fact.is_at((), passage)]
        if others:
            in_section = SectionFacts([*in_section.facts, *others], passage.section.words)
        scored = in_section.scored(passage)
        if others and others[0].is_of_edition:
            scored = [(_DIFFERS, fact) for fact in reversed(others)] + scored
        facts = [*dict.fromkeys(fact for _, fact in scored), *in_section.facts]
        touched_facts = self._by_item(scored, list(dict.fromkeys(facts)), passage)
        return touched_facts, max(len(in_section.facts), len(touched_facts))

    def _by_item(
        self, scored: Sequence[tuple[float, Citing]], facts: Sequence[Citing], passage: Passage
    ) -> list[Citing]:
        """Return values that differ, then facts of the likely items, and of those that refer to the first one."""
        listed: dict[str, Citing] = {}
        scored_by_item: dict[str, list[Citing]] = {}
        for _, fact in scored:
            scored_by_item.setdefault(fact.item, []).append(fact)
        for fact in [*self._with_changed_text(passage, facts), *_differing_values(scored_by_item, passage)]:
            listed[fact.path] = fact
        items_of_listed = [fact.item for fact in listed.values() if fact.item in scored_by_item]
        ordered_items = {item: scored_by_item[item] for item in (*items_of_listed, *scored_by_item)}
        for place, (item, item_facts) in enumerate(ordered_items.items()):
            members = dict.fromkeys((*item_facts, *self._facts_by_item[item]))
            most = _OF_FIRST_ITEMS[place] if place < len(_OF_FIRST_ITEMS) else _OF_OTHER_ITEM
            listed.update((fact.path, fact) for fact in list(members)[:most])
            if place == 0:
                listed.update((fact.path, fact) for fact in self._referring(item, passage))
        listed.update((fact.path, fact) for _, fact in scored)
        return list(listed.values())

    def _with_changed_text(self, passage: Passage, facts: Sequence[Citing]) -> list[Citing]:
        """Return the facts that are the changed text, in groups with the same key and value, then those that have it.

        If too many facts are the changed text, such as a 1, none are returned.
        """
        change = _Change(passage)
        equal_facts: dict[tuple[str, object], list[Citing]] = {}
        for fact in facts:
            if change.is_value_or_name_of(fact):
                equal_facts.setdefault((key_of(fact), fact.value), []).append(fact)
        if len(equal_facts) > _MOST_EQUAL:
            return []
        containing_facts = [fact for fact in facts if change.is_in(fact)][: _MOST_EQUAL - len(equal_facts)]
        return [*(fact for group in equal_facts.values() for fact in group), *containing_facts]

    def _referring(self, item: str, passage: Passage) -> list[Citing]:
        """Return a fact of each item that refers to this one and has words of the passage, the most such words first.

        An erratum has the value that is used instead.
        """
        name = item.rpartition(".")[2]
        items = dict.fromkeys((*self._items_by_reference.get(item, ()), *self._items_by_reference.get(name, ())))
        words = _comparable_words((*passage.old, *passage.new))
        facts: list[tuple[int, Citing]] = []
        for referring_item in items:
            members = self._facts_by_item[referring_item]
            is_erratum = referring_item.startswith("errata.")
            best = max(members, key=lambda fact: (is_erratum and fact.path.endswith(".used"), len(fact.words & words)))
            common_words = max(len(fact.words & words) for fact in members)
            if common_words or is_erratum:
                facts.append((common_words, best))
        facts.sort(key=lambda counted_fact: -counted_fact[0])
        return [fact for _, fact in facts[:_REFERRING]]


def key_of(fact: Citing) -> str:
    """Return the key of a fact, the last step of its path."""
    return fact.path.rpartition(".")[2]


class _Change:
    """The words that a passage no longer has, as a text, as numbers and as labels of order codes."""

    def __init__(self, passage: Passage) -> None:
        changed_words = [word for word in passage.old if word not in passage.new] or list(passage.old)
        self._text = spaced(" ".join(changed_words)) if changed_words and passage.new else ""
        self._old_context = spaced(passage.shown[0]) if changed_words and passage.new else ""
        self._adds_row = not passage.old
        self._before = spaced(passage.shown[0].partition("[")[0]) if passage.new else ""
        self._labels = {word for word in changed_words if _LABEL.fullmatch(word)}
        self._numbers = {word for word in _comparable_words(changed_words) if word[0].isdigit()}

    def is_value_or_name_of(self, fact: Citing) -> bool:
        if fact.is_page_of_contents and fact.own_name_text != self._text:
            return False
        if isinstance(fact.value, int | float) and not isinstance(fact.value, bool) and fact.words & self._numbers:
            return True
        is_label = not self._labels.isdisjoint((*fact.path.split("."), str(fact.value)))
        if self._adds_row:
            return fact.path.startswith("order_code.parts.")
        return is_label or any(map(self._is_changed_name, (fact.text, fact.own_name_text)))

    def _is_changed_name(self, text: str) -> bool:
        """Return whether a text is the changed one, or a name in the passage of which it is a part or the reverse."""
        if not self._text or not text.strip():
            return False
        is_name_in_change = " " in text.strip() and text in self._text
        return is_name_in_change or text == self._text or (self._text in text and text in self._old_context)

    def is_in(self, fact: Citing) -> bool:
        if isinstance(fact.value, int | float):
            return False
        is_number_in_text = any(len(word) > 1 and word in self._numbers for word in fact.words)
        is_text_in_text = len(self._text) > _SHORTEST_TEXT and self._text in fact.text
        has_label = any(f" {label.casefold()} " in fact.text for label in self._labels)
        return is_number_in_text or is_text_in_text or has_label or self._is_named_before(fact)

    def _is_named_before(self, fact: Citing) -> bool:
        """Return whether the words right before the change are a name of several words, as in a sentence about it."""
        name = fact.own_name_text
        return " " in name.strip() and self._before.endswith(name)


def _differing_values(scored_by_item: Mapping[str, Sequence[Citing]], passage: Passage) -> list[Citing]:
    """Return the first fact of each item whose value or whole name differs, up to a few items."""
    differing = _comparable_words(passage.old)
    differing_facts: list[Citing] = []
    for facts in scored_by_item.values():
        differing_facts += [fact for fact in facts if fact.words & differing or fact.own_name <= differing][:1]
    return differing_facts[:_DIFFERING_VALUES]


def _score(fact: Citing, passage: _PassageWords, fact_counts: Mapping[str, int]) -> float:
    """Return how much of a fact occurs in a passage. It is 0 if the passage is not about the fact."""
    differing = _rarity(fact.words & passage.differing, fact_counts)
    differing += _rarity(fact.named & passage.differing, fact_counts) / 2
    differing += _rarity(fact.named & passage.next_to, fact_counts) * _NEXT_TO
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
    folded |= {word[:-1] for word in folded if _HEXADECIMAL.fullmatch(word)}
    matches = [pattern.fullmatch(word) for word in folded for pattern in (_WITH_UNIT, ORDER_CODE)]
    return folded | {match[1] for match in matches if match is not None}


def _rarity(words: Set[str], fact_counts: Mapping[str, int]) -> float:
    """Return the weight of words: the fewer facts have a word, the more it counts."""
    return sum(1 / fact_counts[word] for word in words)


def _share(words: frozenset[str], near: set[str], section: set[str], fact_counts: Mapping[str, int]) -> float:
    """Return the share of the words that occur near a passage, among those that occur in its section."""
    in_section = _rarity(words & section, fact_counts)
    return _rarity(words & section & near, fact_counts) / in_section if in_section else 0
