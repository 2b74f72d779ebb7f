"""Compare the texts of two editions of a manual, and find the facts that cite the passages that changed.

The facts that are most likely to have changed come first.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import chain
from typing import NamedTuple

from .facts import HEXADECIMAL, ORDER_CODE, CitingFact, spaced
from .passages import Passage

#: Weight of a word that differs, and weight of all words in the same row together.
_WEIGHT_OF_DIFFERING, _WEIGHT_OF_ROW = 6.0, 2.0
#: Weight of the words of an insertion, which no fact of the old edition contains.
_WEIGHT_OF_INSERTED = 1.0
#: Weight of the words next to an insertion.
_WEIGHT_NEXT_TO_CHANGE = 4.0
#: Highest number of facts that are listed: for the two most likely items, for each other item, and for items that refer
#: to the first item.
_MAX_OF_FIRST_ITEMS, _MAX_OF_OTHER_ITEM, _MAX_REFERRING = (6, 4), 2, 3
#: Highest number of items with a differing value or name, which are listed before all others.
_MAX_DIFFERING_VALUES = 4
#: A label of an order code, in capital letters.
_LABEL_IN_CAPITALS = re.compile(r"[A-Z][A-Z0-9]+")
#: Highest number of facts that an insertion names.
_MAX_INSERTED = 3
#: Highest number of groups of facts that equal a changed text.
_MAX_EQUAL = 10
#: A changed text is only searched for in other texts if it is longer, including the spaces around it.
_SHORTEST_TEXT = 4
#: Number of words before and after a change in which numbers are compared.
_WORDS_BESIDE = 3
#: A number with its unit, printed without a space.
_WITH_UNIT = re.compile(r"(?P<number>\d[\d.]*)[kmµn]?(?:hz|vdc|v|a|s|m)")


class _PassageWords(NamedTuple):
    """Words of a passage that are compared with facts: differing words, and words in their row, paragraph and section.

    ``difference_weight`` is the weight of a word that differs.
    """

    differing_words: set[str]
    adjacent_words: set[str]
    row_words: set[str]
    paragraph_words: set[str]
    section_words: set[str]
    difference_weight: float


class SectionFacts:
    """The facts that cite a section, with the number of facts that contain each word."""

    def __init__(self, facts: Sequence[CitingFact], section_words: Iterable[str]) -> None:
        self.facts = facts
        self.words = _comparable_words(section_words)
        self.fact_count_by_word = Counter(word for fact in facts for word in fact.value_words | fact.name_words)

    def likely_facts(self, passage: Passage) -> list[tuple[float, CitingFact]]:
        """Return the facts whose value or name occurs in a passage, with their scores, the highest score first.

        A word counts more if fewer facts contain it, and more if it is among the old words than near them. Facts with
        the same score are in the order of the spec.
        """
        passage_words = _PassageWords(
            # An insertion contains no old words.
            differing_words=_comparable_words(passage.old_words or passage.new_words),
            adjacent_words=_comparable_words(passage.words_next_to),
            row_words=_comparable_words(passage.words_in_row),
            paragraph_words=_comparable_words(passage.words_in_paragraph),
            section_words=self.words,
            difference_weight=_WEIGHT_OF_DIFFERING if passage.old_words else _WEIGHT_OF_INSERTED,
        )
        scored_facts: list[tuple[float, CitingFact]] = []
        for fact in self.facts:
            score = _score_of_fact(fact, passage_words, self.fact_count_by_word)
            if score > 0:
                scored_facts.append((score, fact))

        def highest_score_first(scored_fact: tuple[float, CitingFact]) -> tuple[float, int]:
            """Return the key by which scored facts are sorted."""
            score, fact = scored_fact
            return -score, fact.line

        return sorted(scored_facts, key=highest_score_first)


class TouchedFacts:
    """The facts of a spec, for finding the facts that a changed passage concerns."""

    def __init__(self, facts: Sequence[CitingFact]) -> None:
        self.all_facts = facts
        self._facts_by_item: dict[str, list[CitingFact]] = {}
        for fact in facts:
            self._facts_by_item.setdefault(fact.item, []).append(fact)
        #: The items that refer to an item, by the name or path in the reference.
        self._items_by_reference: dict[str, list[str]] = {}
        for item, item_facts in self._facts_by_item.items():
            references: set[str] = set()
            for fact in item_facts:
                references.update(fact.refers_to)
            for reference in references:
                self._items_by_reference.setdefault(reference, []).append(item)
        #: The facts that were already collected, by the cited sections and the number of the passage's section.
        self._facts_by_sections: dict[tuple[frozenset[str], str], SectionFacts] = {}

    def touched_by(self, passage: Passage, sections: Set[str]) -> tuple[list[CitingFact], int]:
        """Return the facts that a passage concerns, the most likely first, and the number of facts it may concern.

        ``sections`` are the numbers of the sections that the passage may belong to. The passage may concern all facts
        that cite one of them, facts about the edition itself, and facts about an order code that the passage names.
        """
        section_facts = self._facts_citing(sections, passage)
        facts_from_elsewhere: list[CitingFact] = []
        for fact in self.all_facts:
            # This finds facts about the edition and about options of the order code, which may cite any section.
            if fact.sections.isdisjoint(sections) and fact.may_change_with((), passage):
                facts_from_elsewhere.append(fact)
        if facts_from_elsewhere:
            section_facts = SectionFacts([*section_facts.facts, *facts_from_elsewhere], passage.section.words)
        likely_facts = [fact for _, fact in section_facts.likely_facts(passage)]
        # Facts about the edition come first: its revision and date, then the rows of the history, the newest first.
        if facts_from_elsewhere and facts_from_elsewhere[0].is_of_edition:
            newest_first = list(reversed(facts_from_elsewhere))
            newest_first.sort(key=lambda fact: fact.path.startswith("manual.history"))
            likely_facts = [*newest_first, *likely_facts]
        all_facts = list(dict.fromkeys((*likely_facts, *section_facts.facts)))
        touched_facts = self._list_by_item(likely_facts, all_facts, passage)
        return touched_facts, max(len(section_facts.facts), len(touched_facts))

    def _facts_citing(self, sections: Set[str], passage: Passage) -> SectionFacts:
        """Return the facts that cite one of the sections. They are kept for other passages of the same section."""
        section_key = frozenset(sections), passage.section.number
        if section_key not in self._facts_by_sections:
            citing_facts = [fact for fact in self.all_facts if not fact.sections.isdisjoint(sections)]
            self._facts_by_sections[section_key] = SectionFacts(citing_facts, passage.section.words)
        return self._facts_by_sections[section_key]

    def _list_by_item(
        self, likely_facts: Sequence[CitingFact], all_facts: Sequence[CitingFact], passage: Passage
    ) -> list[CitingFact]:
        """Return the facts that a passage concerns in the order in which they are listed, each path once.

        Facts that contain or equal the changed text and facts with a differing value come first. They are followed by
        facts of each likely item: 6 of the first item, 4 of the second, and 2 of each other item. Facts that refer to
        the first item follow it. All other likely facts come last.
        """
        likely_by_item: dict[str, list[CitingFact]] = {}
        for fact in likely_facts:
            likely_by_item.setdefault(fact.item, []).append(fact)
        listed_facts = [*self._with_changed_text(passage, all_facts), *_facts_with_old_words(likely_by_item, passage)]
        items_of_listed = [fact.item for fact in listed_facts if fact.item in likely_by_item]
        for rank, item in enumerate(dict.fromkeys((*items_of_listed, *likely_by_item))):
            item_facts = list(dict.fromkeys((*likely_by_item[item], *self._facts_by_item[item])))
            is_among_first_items = rank < len(_MAX_OF_FIRST_ITEMS)
            fact_limit = _MAX_OF_FIRST_ITEMS[rank] if is_among_first_items else _MAX_OF_OTHER_ITEM
            listed_facts += item_facts[:fact_limit]
            if rank == 0:
                listed_facts += self._facts_of_referring_items(item, passage)
        listed_facts += likely_facts
        fact_by_path = {fact.path: fact for fact in listed_facts}
        return list(fact_by_path.values())

    def _with_changed_text(self, passage: Passage, facts: Sequence[CitingFact]) -> list[CitingFact]:
        """Return the facts that an insertion names, facts that equal the changed text, and facts that contain it.

        A fact equals the text if the text is its value or its name. Facts that contain or equal the text are limited to
        10, where equal facts with the same key and value count as one. If more than 10 facts equal a text such as "1",
        it identifies none of them, so only the facts that an insertion names are returned.
        """
        change = _Change(passage)
        inserted_facts = [fact for fact in facts if change.inserts_name_of(fact)][:_MAX_INSERTED]
        equal_facts_by_value: dict[tuple[str, object], list[CitingFact]] = {}
        for fact in facts:
            if change.is_value_or_name_of(fact):
                equal_facts_by_value.setdefault((key_of(fact), fact.value), []).append(fact)
        group_count = len(equal_facts_by_value)
        if group_count > _MAX_EQUAL:
            return inserted_facts
        equal_facts = list(chain.from_iterable(equal_facts_by_value.values()))
        quoting_facts = [fact for fact in facts if change.is_quoted_in(fact)]
        containing_facts = dict.fromkeys((*quoting_facts, *(fact for fact in facts if change.is_contained_in(fact))))
        # A fact that equals the text also contains it. It is listed once.
        listed_facts = set(equal_facts)
        other_facts = [fact for fact in containing_facts if fact not in listed_facts]
        most_containing = _MAX_EQUAL - group_count
        return inserted_facts + equal_facts + other_facts[:most_containing]

    def _facts_of_referring_items(self, item: str, passage: Passage) -> list[CitingFact]:
        """Return a fact of each item that refers to ``item`` by its path or name, for at most 3 items.

        This is the fact with the most words from the passage, or, for an erratum, the value that is used instead. Items
        with more words from the passage come first. Items without such words are left out, except errata.
        """
        _, _, item_name = item.rpartition(".")
        items_by_reference = self._items_by_reference
        referring_items = dict.fromkeys((*items_by_reference.get(item, ()), *items_by_reference.get(item_name, ())))
        passage_words = _comparable_words((*passage.old_words, *passage.new_words))

        def common_word_count(fact: CitingFact) -> int:
            return len(fact.value_words & passage_words)

        counted_facts: list[tuple[int, CitingFact]] = []
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
        # The sort is stable, so items with the same count stay in the order of the spec.
        counted_facts.sort(key=lambda counted_fact: -counted_fact[0])
        return [fact for _, fact in counted_facts[:_MAX_REFERRING]]


def key_of(fact: CitingFact) -> str:
    """Return the key of a fact, the last step of its path."""
    return fact.path.rpartition(".")[2]


class _Change:
    """The words that were removed from a passage: their text, and the numbers and labels of order codes in it."""

    def __init__(self, passage: Passage) -> None:
        removed_words = [word for word in passage.old_words if word not in passage.new_words]
        # If the new words contain all old words, all old words count as changed.
        changed_words = removed_words or list(passage.old_words)
        shown_old_text, _ = passage.shown_texts
        # The shown text marks the changed words by brackets: ``at most [ 10 ] MHz``.
        text_before_change, _, _ = shown_old_text.partition("[")
        _, _, text_after_change = shown_old_text.partition("]")
        words_before, words_after = text_before_change.split(), text_after_change.split()
        self._changed_text = ""
        #: The changed words with the word before and the word after them: `` preset setting enable ``.
        self._changed_phrase = ""
        self._shown_old_text = ""
        # The text is only compared if new words replace it. ``spaced`` adds a space at each end, so that only whole
        # words match.
        is_replaced = bool(changed_words) and bool(passage.new_words)
        if is_replaced:
            self._changed_text = spaced(" ".join(changed_words))
            self._shown_old_text = spaced(shown_old_text)
            if words_before and words_after:
                self._changed_phrase = spaced(" ".join((words_before[-1], *changed_words, words_after[0])))
        self._adds_row = not passage.old_words
        self._inserted_text = spaced(" ".join(passage.new_words)) if self._adds_row else ""
        self._text_before_change = spaced(text_before_change) if passage.new_words else ""
        #: All old words of the change, with those that the new text keeps: `` sine cosine resolution ``.
        self._whole_old_text = spaced(" ".join(passage.old_words)) if is_replaced else ""
        self._changed_labels = {word for word in changed_words if _LABEL_IN_CAPITALS.fullmatch(word)}
        self._changed_numbers = _numbers_in(changed_words)
        adjacent_words = [*words_before[-_WORDS_BESIDE:], *words_after[:_WORDS_BESIDE]]
        self._numbers_next_to_change = {number for number in _numbers_in(adjacent_words) if len(number) > 1}

    def is_value_or_name_of(self, fact: CitingFact) -> bool:
        """Return whether the changed words are the value, the name or the label of a fact.

        If the value is a number, a changed number that equals it is enough. If a passage only adds words, for example a
        row of a table, only facts about parts of the order code count. The page of an entry in the table of contents
        only counts if the change is in the name of the entry.
        """
        if fact.is_page_of_contents and not self._is_changed_name(fact.own_name_text):
            return False
        is_number = isinstance(fact.value, int | float) and not isinstance(fact.value, bool)
        if is_number and fact.value_words & self._changed_numbers:
            return True
        if self._adds_row:
            return fact.path.startswith("order_code.parts.")
        is_label = not self._changed_labels.isdisjoint((*fact.path.split("."), str(fact.value)))
        return is_label or self._is_changed_name(fact.text) or self._is_changed_name(fact.own_name_text)

    def inserts_name_of(self, fact: CitingFact) -> bool:
        """Return whether a passage that only adds words contains the name of a fact with several words."""
        name = fact.own_name_text
        return " " in name.strip() and name in self._inserted_text

    def _is_changed_name(self, text: str) -> bool:
        """Return whether a text equals the changed text, is a part of it, or contains it.

        A part of the changed text must have several words. A text that contains it must occur in the old passage.
        """
        if not self._changed_text or not text.strip():
            return False
        is_part_of_change = " " in text.strip() and text in self._changed_text
        contains_change = self._changed_text in text and text in self._shown_old_text
        return is_part_of_change or text in (self._changed_text, self._whole_old_text) or contains_change

    def is_contained_in(self, fact: CitingFact) -> bool:
        """Return whether the value of a fact is a text that contains the changed words, or a number or label in them.

        A fact also counts if its name ends directly before the change.
        """
        if isinstance(fact.value, int | float):
            return False
        # A single digit occurs in many texts, so it only counts with a number next to the change: ``5 V to 30 V``.
        numbers_in_fact = fact.value_words & self._changed_numbers
        contains_number = any(len(word) > 1 for word in numbers_in_fact)
        contains_number |= bool(numbers_in_fact) and not fact.value_words.isdisjoint(self._numbers_next_to_change)
        contains_text = len(self._changed_text) > _SHORTEST_TEXT and self._changed_text in fact.text
        contains_label = any(f" {label.casefold()} " in fact.text for label in self._changed_labels)
        return (
            contains_number or contains_text or contains_label or self.is_quoted_in(fact) or self._is_named_before(fact)
        )

    def is_quoted_in(self, fact: CitingFact) -> bool:
        """Return whether a text contains the changed words between the same two words as in the old passage."""
        return bool(self._changed_phrase) and self._changed_phrase in fact.text

    def _is_named_before(self, fact: CitingFact) -> bool:
        """Return whether the words directly before the change are the name of a fact with several words."""
        name = fact.own_name_text
        return " " in name.strip() and self._text_before_change.endswith(name)


def _facts_with_old_words(likely_by_item: Mapping[str, Sequence[CitingFact]], passage: Passage) -> list[CitingFact]:
    """Return the most likely fact of each item whose value contains an old word, or whose name is in the old words.

    At most 4 facts are returned. ``likely_by_item`` contains the facts of each item, the most likely first.
    """
    old_words = _comparable_words(passage.old_words)
    differing_facts: list[CitingFact] = []
    for item_facts in likely_by_item.values():
        facts_with_old_words = [
            fact for fact in item_facts if fact.value_words & old_words or fact.own_name_words <= old_words
        ]
        differing_facts += facts_with_old_words[:1]
    return differing_facts[:_MAX_DIFFERING_VALUES]


def _score_of_fact(fact: CitingFact, passage_words: _PassageWords, fact_count_by_word: Mapping[str, int]) -> float:
    """Return how likely a passage concerns a fact, as a score. It is 0 if the passage is not about the fact.

    The score is high if the value and the name of the fact occur in the passage. Words that differ count most, followed
    by words in the same row and in the same paragraph. Rare words count more, by the number of facts with each
    word.
    """
    difference_score = _weight_by_rarity(fact.value_words & passage_words.differing_words, fact_count_by_word)
    difference_score += _weight_by_rarity(fact.name_words & passage_words.differing_words, fact_count_by_word) / 2
    difference_score += (
        _weight_by_rarity(fact.name_words & passage_words.adjacent_words, fact_count_by_word) * _WEIGHT_NEXT_TO_CHANGE
    )
    paragraph_name_share = _share_near_passage(
        fact.name_words, passage_words.paragraph_words, passage_words.section_words, fact_count_by_word
    )
    paragraph_value_share = _share_near_passage(
        fact.value_words, passage_words.paragraph_words, passage_words.section_words, fact_count_by_word
    )
    # If the section contains words of the name elsewhere, the paragraph may be about a different item.
    is_named_elsewhere = bool((fact.name_words & passage_words.section_words) - passage_words.paragraph_words)
    if is_named_elsewhere and not difference_score and not paragraph_value_share:
        return 0
    row_name_share = _share_near_passage(
        fact.name_words, passage_words.row_words, passage_words.section_words, fact_count_by_word
    )
    row_value_share = _share_near_passage(
        fact.value_words, passage_words.row_words, passage_words.section_words, fact_count_by_word
    )
    if fact.value_words & passage_words.differing_words:
        # The value differs in a row with the name of the fact.
        difference_score += row_name_share
    row_score = _WEIGHT_OF_ROW * (row_name_share + row_value_share)
    paragraph_score = paragraph_name_share + paragraph_value_share
    return passage_words.difference_weight * difference_score + row_score + paragraph_score


def _comparable_words(words: Iterable[str]) -> set[str]:
    """Return all spellings under which printed words are compared, in lowercase.

    ``10MHz`` becomes ``10mhz`` and ``10``, ``2,5`` becomes ``2,5`` and ``2.5``, ``1Ah`` becomes ``1ah`` and ``1a``, and
    an order code ``XY24`` becomes ``xy24`` and ``24``.
    """
    # Each step adds the spellings that follow from the spellings before it.
    comparable_words = {word.casefold() for word in words}
    comparable_words |= {word.replace(",", ".") for word in comparable_words}
    comparable_words |= {word.removesuffix("h") for word in comparable_words if HEXADECIMAL.fullmatch(word)}
    numbers_in_words: set[str] = set()
    for pattern in (_WITH_UNIT, ORDER_CODE):
        for word in comparable_words:
            word_with_number = pattern.fullmatch(word)
            if word_with_number is not None:
                numbers_in_words.add(word_with_number["number"])
    return comparable_words | numbers_in_words


def _numbers_in(words: Iterable[str]) -> set[str]:
    """Return the spellings of all numbers among printed words."""
    return {word for word in _comparable_words(words) if word[0].isdigit()}


def _weight_by_rarity(words: Set[str], fact_count_by_word: Mapping[str, int]) -> float:
    """Return the sum of the weights of words. The weight is 1 divided by the number of facts that contain the word."""
    return sum(1 / fact_count_by_word[word] for word in words)


def _share_near_passage(
    words: frozenset[str], nearby_words: set[str], section_words: set[str], fact_count_by_word: Mapping[str, int]
) -> float:
    """Return the share of a fact's words that are near a passage, weighted by rarity, from 0 to 1.

    Words that do not occur in the section are ignored, because the manual may use different words.
    """
    words_in_section = words & section_words
    rarity_in_section = _weight_by_rarity(words_in_section, fact_count_by_word)
    if not rarity_in_section:
        return 0
    return _weight_by_rarity(words_in_section & nearby_words, fact_count_by_word) / rarity_in_section
