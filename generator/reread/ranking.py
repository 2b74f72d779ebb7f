"""The facts that a changed passage touches, the most likely to have changed first."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import chain
from typing import NamedTuple

from .facts import ORDER_CODE, Citing, spaced
from .passages import Passage

#: Weights of the words that differ, and of those close to them. All words near them weigh as much as 2.
_WEIGHT_OF_DIFFERING, _CLOSE_TO_CHANGE = 6.0, 2.0
#: Weight of the words of an insertion, which no fact of the old edition contains.
_WEIGHT_OF_INSERTED = 1.0
#: Weight of the words next to an insertion.
_WEIGHT_NEXT_TO_CHANGE = 4.0
#: Facts listed of the most likely items, of each other item, and of items that refer to the first item.
_MOST_OF_FIRST_ITEMS, _MOST_OF_OTHER_ITEM, _MOST_REFERRING = (6, 4), 2, 3
#: Items with a differing value or name, which are listed before everything else.
_MOST_DIFFERING_VALUES = 4
#: A number in hexadecimal, which the bytes of an example contain without the letter.
_HEX_NUMBER = re.compile(r"[0-9a-f]{2,}h")
#: A label of an order code, in capital letters.
_LABEL_IN_CAPITALS = re.compile(r"[A-Z][A-Z0-9]+")
#: Facts that an insertion names, at most.
_MOST_INSERTED = 3
#: Groups of facts that are a changed text, at most.
_MOST_EQUAL = 10
#: Letters of a changed text that is looked for in other texts, with the spaces around it.
_SHORTEST_TEXT = 4
#: A number with its unit, printed without a space.
_WITH_UNIT = re.compile(r"(\d[\d.]*)[kmµn]?(?:hz|vdc|v|a|s|m)")


class _PassageWords(NamedTuple):
    """Words of a passage as they are compared: the differing words, and the words of their row, paragraph and section.

    ``weight`` is the weight of a word that differs.
    """

    differing: set[str]
    next_to: set[str]
    row: set[str]
    paragraph: set[str]
    section: set[str]
    weight: float


class SectionFacts:
    """The facts that cite a section, with the number of facts that contain each word."""

    def __init__(self, facts: Sequence[Citing], section_words: Iterable[str]) -> None:
        self.facts = facts
        self.words = _comparable_words(section_words)
        self.counts = Counter(word for fact in facts for word in fact.words | fact.named)

    def likely_facts(self, passage: Passage) -> list[tuple[float, Citing]]:
        """Return the facts whose value or name occurs in a passage with their scores, the highest first.

        A word counts more if fewer of the facts contain it, and more in the old words than near them (see
        ``_score_of_fact``). Facts with the same score are in the order of the spec.
        """
        passage_words = _PassageWords(
            # An insertion contains no old words.
            differing=_comparable_words(passage.old or passage.new),
            next_to=_comparable_words(passage.next_to),
            row=_comparable_words(passage.close),
            paragraph=_comparable_words(passage.around),
            section=self.words,
            weight=_WEIGHT_OF_DIFFERING if passage.old else _WEIGHT_OF_INSERTED,
        )
        scored_facts: list[tuple[float, Citing]] = []
        for fact in self.facts:
            score = _score_of_fact(fact, passage_words, self.counts)
            if score > 0:
                scored_facts.append((score, fact))

        def highest_score_first(scored_fact: tuple[float, Citing]) -> tuple[float, int]:
            """Return the key by which scored facts are sorted."""
            score, fact = scored_fact
            return -score, fact.line

        return sorted(scored_facts, key=highest_score_first)


class TouchedFacts:
    """The facts of a spec, for finding those that a passage touches."""

    def __init__(self, facts: Sequence[Citing]) -> None:
        self.all_facts = facts
        self._facts_by_item: dict[str, list[Citing]] = {}
        for fact in facts:
            self._facts_by_item.setdefault(fact.item, []).append(fact)
        #: The items that refer to a name or path.
        self._items_by_reference: dict[str, list[str]] = {}
        for item, item_facts in self._facts_by_item.items():
            references: set[str] = set()
            for fact in item_facts:
                references.update(fact.refers_to)
            for reference in references:
                self._items_by_reference.setdefault(reference, []).append(item)
        #: The facts already collected, by the cited sections and the number of the passage's section.
        self._facts_by_sections: dict[tuple[frozenset[str], str], SectionFacts] = {}

    def touched_by(self, passage: Passage, sections: Set[str]) -> tuple[list[Citing], int]:
        """Return the facts that a passage touches, the most likely first, and how many facts it may concern in all.

        ``sections`` are the numbers of the sections that the passage may belong to. The facts citing one of them count,
        and so do facts from elsewhere: facts of the edition itself, and of an order code that the passage names.
        """
        section_facts = self._facts_citing(sections, passage)
        facts_from_elsewhere: list[Citing] = []
        for fact in self.all_facts:
            # Without sections, only the edition and the options of the order code are at the passage.
            if fact.sections.isdisjoint(sections) and fact.is_at((), passage):
                facts_from_elsewhere.append(fact)
        if facts_from_elsewhere:
            section_facts = SectionFacts([*section_facts.facts, *facts_from_elsewhere], passage.section.words)
        likely_facts = [fact for _, fact in section_facts.likely_facts(passage)]
        # Facts of the edition come first, the last fact in the spec before the others.
        if facts_from_elsewhere and facts_from_elsewhere[0].is_of_edition:
            likely_facts = [*reversed(facts_from_elsewhere), *likely_facts]
        all_facts = list(dict.fromkeys((*likely_facts, *section_facts.facts)))
        touched_facts = self._list_by_item(likely_facts, all_facts, passage)
        return touched_facts, max(len(section_facts.facts), len(touched_facts))

    def _facts_citing(self, sections: Set[str], passage: Passage) -> SectionFacts:
        """Return the facts that cite one of the sections. They are kept for the next passage of the same section."""
        section_key = frozenset(sections), passage.section.number
        if section_key not in self._facts_by_sections:
            citing_facts = [fact for fact in self.all_facts if not fact.sections.isdisjoint(sections)]
            self._facts_by_sections[section_key] = SectionFacts(citing_facts, passage.section.words)
        return self._facts_by_sections[section_key]

    def _list_by_item(
        self, likely_facts: Sequence[Citing], all_facts: Sequence[Citing], passage: Passage
    ) -> list[Citing]:
        """Return facts in the order of display, each path once.

        First facts that contain or equal the changed text, and differing values. Then for each likely item its first
        facts: 6 of the first item, 4 of the second, and 2 of each other item. Facts that refer to the first item follow
        it. All other likely facts are last.
        """
        likely_by_item: dict[str, list[Citing]] = {}
        for fact in likely_facts:
            likely_by_item.setdefault(fact.item, []).append(fact)
        listed_facts = [*self._with_changed_text(passage, all_facts), *_differing_values(likely_by_item, passage)]
        items_of_listed = [fact.item for fact in listed_facts if fact.item in likely_by_item]
        for rank, item in enumerate(dict.fromkeys((*items_of_listed, *likely_by_item))):
            item_facts = list(dict.fromkeys((*likely_by_item[item], *self._facts_by_item[item])))
            is_among_first_items = rank < len(_MOST_OF_FIRST_ITEMS)
            fact_limit = _MOST_OF_FIRST_ITEMS[rank] if is_among_first_items else _MOST_OF_OTHER_ITEM
            listed_facts += item_facts[:fact_limit]
            if rank == 0:
                listed_facts += self._facts_of_referring_items(item, passage)
        listed_facts += likely_facts
        fact_by_path = {fact.path: fact for fact in listed_facts}
        return list(fact_by_path.values())

    def _with_changed_text(self, passage: Passage, facts: Sequence[Citing]) -> list[Citing]:
        """Return three kinds of facts: those that an insertion names, those that equal the changed text, and others.

        A fact equals the text if the text is its value or its name. The others are those whose value contains the
        text. Equal facts with the same key and value count as one, and with the others at most 10 are returned. A text
        such as "1" equals more than 10 facts. It identifies none of them, so only the facts that an insertion names
        are returned.
        """
        change = _Change(passage)
        inserted_facts = [fact for fact in facts if change.inserts_name_of(fact)][:_MOST_INSERTED]
        equal_facts_by_value: dict[tuple[str, object], list[Citing]] = {}
        for fact in facts:
            if change.is_value_or_name_of(fact):
                equal_facts_by_value.setdefault((key_of(fact), fact.value), []).append(fact)
        group_count = len(equal_facts_by_value)
        if group_count > _MOST_EQUAL:
            return inserted_facts
        equal_facts = list(chain.from_iterable(equal_facts_by_value.values()))
        containing_facts = [fact for fact in facts if change.is_in(fact)]
        most_containing = _MOST_EQUAL - group_count
        return inserted_facts + equal_facts + containing_facts[:most_containing]

    def _facts_of_referring_items(self, item: str, passage: Passage) -> list[Citing]:
        """Return a fact of each item that refers to ``item``, by path or name, for at most 3 items.

        The fact of an item is the fact with the most words of the passage, and for an erratum, the value used instead.
        Items with more such words come first. Of the items without any, only errata are returned.
        """
        _, _, item_name = item.rpartition(".")
        items_by_reference = self._items_by_reference
        referring_items = dict.fromkeys((*items_by_reference.get(item, ()), *items_by_reference.get(item_name, ())))
        passage_words = _comparable_words((*passage.old, *passage.new))

        def common_word_count(fact: Citing) -> int:
            return len(fact.words & passage_words)

        counted_facts: list[tuple[int, Citing]] = []
        for referring_item in referring_items:
            item_facts = self._facts_by_item[referring_item]
            highest_word_count = max(map(common_word_count, item_facts))
            is_erratum = referring_item.startswith("errata.")
            if not highest_word_count and not is_erratum:
                continue
            candidates = item_facts
            if is_erratum:
                candidates = [fact for fact in item_facts if fact.path.endswith(".used")] or item_facts
            likeliest_fact = max(candidates, key=common_word_count)
            counted_facts.append((highest_word_count, likeliest_fact))
        # Highest count first. Items with the same count stay in the order of the spec.
        counted_facts.sort(key=lambda counted_fact: -counted_fact[0])
        return [fact for _, fact in counted_facts[:_MOST_REFERRING]]


def key_of(fact: Citing) -> str:
    """Return the key of a fact, the last step of its path."""
    return fact.path.rpartition(".")[2]


class _Change:
    """Words that were removed from a passage: the text, its numbers and its labels of order codes."""

    def __init__(self, passage: Passage) -> None:
        removed_words = [word for word in passage.old if word not in passage.new]
        # If the new words contain all of the old ones, all of the old ones count as changed.
        changed_words = removed_words or list(passage.old)
        shown_old_text, _ = passage.shown
        # The text is only compared if new words replace it. Texts have spaces at both ends (see ``spaced``).
        is_replaced = bool(changed_words) and bool(passage.new)
        self._text = spaced(" ".join(changed_words)) if is_replaced else ""
        self._old_context = spaced(shown_old_text) if is_replaced else ""
        self._adds_row = not passage.old
        self._inserted_text = "" if passage.old else spaced(" ".join(passage.new))
        # The shown text marks the changed words by brackets: ``at most [ 10 ] MHz``.
        words_before_change = shown_old_text.partition("[")[0]
        self._before = spaced(words_before_change) if passage.new else ""
        self._labels = {word for word in changed_words if _LABEL_IN_CAPITALS.fullmatch(word)}
        self._numbers = {word for word in _comparable_words(changed_words) if word[0].isdigit()}

    def is_value_or_name_of(self, fact: Citing) -> bool:
        """Return whether the changed words are the value, the name or the label of a fact.

        A number is enough if the value is a number. If a passage only adds words, such as a row, only the parts of the
        order code count. A page of the contents counts only if the change is in the name of its entry.
        """
        if fact.is_page_of_contents and not self._is_changed_name(fact.own_name_text):
            return False
        is_number = isinstance(fact.value, int | float) and not isinstance(fact.value, bool)
        if is_number and fact.words & self._numbers:
            return True
        if self._adds_row:
            return fact.path.startswith("order_code.parts.")
        is_label = not self._labels.isdisjoint((*fact.path.split("."), str(fact.value)))
        return is_label or self._is_changed_name(fact.text) or self._is_changed_name(fact.own_name_text)

    def inserts_name_of(self, fact: Citing) -> bool:
        """Return whether a passage that only adds words has the name of a fact, of several words: ``start value``."""
        name = fact.own_name_text
        return " " in name.strip() and name in self._inserted_text

    def _is_changed_name(self, text: str) -> bool:
        """Return whether a text is the changed text, or one of them is a part of the other.

        A part of the change must have several words. A longer text must occur in the old text of the passage.
        """
        if not self._text or not text.strip():
            return False
        is_part_of_change = " " in text.strip() and text in self._text
        contains_change = self._text in text and text in self._old_context
        return is_part_of_change or text == self._text or contains_change

    def is_in(self, fact: Citing) -> bool:
        """Return whether a text that is the value of a fact contains the changed words, or a number or label of them.

        A fact also counts if its name ends right before the change.
        """
        if isinstance(fact.value, int | float):
            return False
        # A single digit occurs in many texts.
        is_number_in_text = any(len(word) > 1 and word in self._numbers for word in fact.words)
        is_text_in_text = len(self._text) > _SHORTEST_TEXT and self._text in fact.text
        has_label = any(f" {label.casefold()} " in fact.text for label in self._labels)
        return is_number_in_text or is_text_in_text or has_label or self._is_named_before(fact)

    def _is_named_before(self, fact: Citing) -> bool:
        """Return whether the words right before the change are the name of a fact, if the name has several words."""
        name = fact.own_name_text
        return " " in name.strip() and self._before.endswith(name)


def _differing_values(likely_by_item: Mapping[str, Sequence[Citing]], passage: Passage) -> list[Citing]:
    """Return the likeliest fact of each item whose value contains an old word, or whose whole name is in the old words.

    At most 4 facts are returned. ``likely_by_item`` contains the facts of each item, the most likely first.
    """
    old_words = _comparable_words(passage.old)
    differing_facts: list[Citing] = []
    for item_facts in likely_by_item.values():
        # An item can be without such a fact.
        facts_with_old_words = [fact for fact in item_facts if fact.words & old_words or fact.own_name <= old_words]
        differing_facts += facts_with_old_words[:1]
    return differing_facts[:_MOST_DIFFERING_VALUES]


def _score_of_fact(fact: Citing, passage: _PassageWords, fact_counts: Mapping[str, int]) -> float:
    """Return how much of a fact occurs in a passage. It is 0 if the passage is not about the fact.

    Words that differ count most, then words in the same row, then words in the same paragraph. ``fact_counts`` contains
    the number of facts of the section with each word, by which rare words count more.
    """
    difference_score = _weight_by_rarity(fact.words & passage.differing, fact_counts)
    difference_score += _weight_by_rarity(fact.named & passage.differing, fact_counts) / 2
    difference_score += _weight_by_rarity(fact.named & passage.next_to, fact_counts) * _WEIGHT_NEXT_TO_CHANGE
    paragraph_name_share = _share_near_passage(fact.named, passage.paragraph, passage.section, fact_counts)
    paragraph_value_share = _share_near_passage(fact.words, passage.paragraph, passage.section, fact_counts)
    # If the section prints words of the name elsewhere, the paragraph may be about another item.
    is_named_elsewhere = bool((fact.named & passage.section) - passage.paragraph)
    if is_named_elsewhere and not difference_score and not paragraph_value_share:
        return 0
    row_name_share = _share_near_passage(fact.named, passage.row, passage.section, fact_counts)
    row_value_share = _share_near_passage(fact.words, passage.row, passage.section, fact_counts)
    if fact.words & passage.differing:
        # The value differs in a row with the name of the fact.
        difference_score += row_name_share
    row_score = _CLOSE_TO_CHANGE * (row_name_share + row_value_share)
    paragraph_score = paragraph_name_share + paragraph_value_share
    return passage.weight * difference_score + row_score + paragraph_score


def _comparable_words(words: Iterable[str]) -> set[str]:
    """Return all spellings of printed words under which they are compared, in lower case.

    ``10MHz`` becomes ``10mhz`` and ``10``, ``2,5`` becomes ``2,5`` and ``2.5``, ``1Ah`` becomes ``1ah`` and ``1a``, and
    an order code ``XY24`` becomes ``xy24`` and ``24``.
    """
    # Each step adds the spellings that follow from the spellings before it.
    comparable_words = {word.casefold() for word in words}
    comparable_words |= {word.replace(",", ".") for word in comparable_words}
    comparable_words |= {word.removesuffix("h") for word in comparable_words if _HEX_NUMBER.fullmatch(word)}
    numbers_in_words: set[str] = set()
    for word in comparable_words:
        # The first group of either pattern is the number.
        for number_match in (_WITH_UNIT.fullmatch(word), ORDER_CODE.fullmatch(word)):
            if number_match is not None:
                numbers_in_words.add(number_match[1])
    return comparable_words | numbers_in_words


def _weight_by_rarity(words: Set[str], fact_counts: Mapping[str, int]) -> float:
    """Return the sum of the weights of words. The weight is 1 divided by the number of facts that contain the word."""
    return sum(1 / fact_counts[word] for word in words)


def _share_near_passage(
    words: frozenset[str], near: set[str], section: set[str], fact_counts: Mapping[str, int]
) -> float:
    """Return the share of a fact's words that are near a passage, weighted by rarity, from 0 to 1.

    Only words printed in its section count, so that a word that the manual does not use does not lower the share.
    """
    words_in_section = words & section
    rarity_in_section = _weight_by_rarity(words_in_section, fact_counts)
    if not rarity_in_section:
        return 0
    return _weight_by_rarity(words_in_section & near, fact_counts) / rarity_in_section
