"""Compare two readings fact by fact, also the numbers and sources of their texts.

Texts are compared by their places in the file, because two readers use different words for them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import partial
from itertools import chain

from ..changes.pairs import match_by_key
from ..language.document import Path
from ..say.names_and_places import bits
from ..say.plain_text import first_of
from .frame_bits import continues_item, describe_bits
from .reading import (
    FACTORY_DEFAULTS,
    NOTHING,
    Bit,
    Case,
    Fact,
    Facts,
    Key,
    Names,
    Sort,
    Value,
    Word,
    WordCase,
    are_settled,
    in_hex,
    mistaken_pairs,
    same_name,
)
from .texts import NUMBERS, dotted

#: Items that each reader defines as needed, so that none is missing if the other has a different set.
_OWN = frozenset(("parameter",))
#: Classes of facts in words, which a second reading can also give by their paths.
_WORDS = frozenset((Sort.TEXT, Sort.SECTION))


class Read(IntEnum):
    """How often a fact was read, best first. For a place with several facts, the worst applies."""

    TWICE = 0
    DECIDED = 1
    EXPLAINED = 2
    ONCE = 3
    OTHERWISE = 4


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A fact with different values in the readings. ``place`` is in the spec, ``second`` in the second reading.

    A place is empty if a reading lacks the fact. ``near`` is then the place where it would be. ``is_name`` is set if
    the values are names of the same thing, and ``resized_frame`` contains the words for a frame with another length.
    """

    sort: Sort
    description: str
    used: str
    other: str
    place: Path
    second: Path
    near: Path = ()
    is_name: bool = False
    resized_frame: str = ""


@dataclass(slots=True)
class Comparison:
    """The result: each place of the spec by class and how often it was read, and the disagreements.

    ``settled`` is set if the second reading uses the names of the spec.
    """

    read: dict[tuple[Sort, Path], Read] = field(default_factory=dict)
    disagreements: list[Disagreement] = field(default_factory=list)
    settled: bool = False

    def note(self, sort: Sort, place: Path, read: Read) -> None:
        """Count a fact of the spec."""
        key = sort, place
        self.read[key] = max(read, self.read.get(key, Read.TWICE))

    def differ(self, disagreement: Disagreement) -> None:
        """Add a disagreement, once."""
        if disagreement.place:
            self.note(disagreement.sort, disagreement.place, Read.OTHERWISE)
        if disagreement not in self.disagreements:
            self.disagreements.append(disagreement)


def compare(spec: Facts, second: Facts) -> Comparison:
    """Compare the facts of a spec with those of its second reading."""
    comparison = Comparison(settled=are_settled(spec, second))
    place_in_spec = partial(_nearest_place, comparison, spec, second)
    second_facts = second.facts | dict(_facts_by_path(spec, second))
    disagreements = chain(
        _compare_facts(comparison, spec.facts, second_facts, place_in_spec),
        _codes_differ(spec, second),
        _compare_names(comparison, spec.names, second.names),
    )
    for disagreement in disagreements:
        comparison.differ(disagreement)
    for key, word in spec.words.items():
        facts_on_order = [facts.get((*key, "order")) for facts in (spec.facts, second.facts)]
        byte_orders = {str(fact.value) for fact in facts_on_order if fact is not None}
        # Different byte orders are reported alone: all bits would differ, too.
        if len(byte_orders) < 2:
            _compare_words(comparison, word, second.words.get(key))
    _count_decided(comparison, spec, second)
    return comparison


def _nearest_place(comparison: Comparison, spec: Facts, second: Facts, fact: Fact) -> Path | None:
    """Return the place where the spec would state a fact of the second reading, or None if the spec may lack it.

    This is its subject, or the only item of the same kind that the second reading lacks, or the list of such items.
    """
    if fact.key[0] == "code":
        return None  # Missing order codes are reported together.
    is_needed_name = comparison.settled and fact.key[0] in _OWN
    if fact.mild and not is_needed_name:
        return None
    if fact.under:
        # If the subject is missing, only that is reported.
        return spec.facts[fact.under].place if fact.under in spec.facts else None
    candidates = [
        candidate
        for key, candidate in spec.facts.items()
        if key[:2] == fact.key[:2] and candidate.sort is fact.sort and not candidate.under
    ]
    unmatched = [candidate for candidate in candidates if candidate.key not in second.facts]
    return unmatched[0].place if len(unmatched) == 1 else _container(fact.place)


def _container(place: Path) -> Path:
    """Return the nearest list or map around a place that exists in any spec."""
    if place[0] in ("interfaces", "manual"):
        return place[:3] if len(place) > 2 and isinstance(place[2], str) else place[:2]
    return place[:1]


def _facts_by_path(spec: Facts, second: Facts) -> Iterator[tuple[Key, Fact]]:
    """Yield the facts that the second reading gives by paths: numbers in texts, and sections."""
    spec_facts = {dotted(fact.place): fact for fact in spec.facts.values() if fact.sort in _WORDS}
    for path, (value, place) in second.printed_numbers.items():
        spec_fact = spec_facts.get(path)
        if spec_fact is None:
            spec_fact = Fact(Sort.TEXT, (NUMBERS, path), "", f"numbers in {path}", place=())
        yield spec_fact.key, replace(spec_fact, value=value, place=place)
    for key, fact in spec.facts.items():
        if fact.sort is Sort.SECTION and dotted(fact.place) not in second.printed_numbers:
            sections = _sections_at(fact.place, second)
            if sections:
                yield key, replace(fact, value=", ".join(sorted(sections)), place=("sections", sections[0]))


def _sections_at(place: Path, second: Facts) -> Sequence[str]:
    """Return the sections that the second reading gives for a place, or for the nearest place around it."""
    for end in range(len(place), 0, -1):
        path = dotted(place[:end])
        if path in second.sections:
            return second.sections[path]
    return ()


def _count_decided(comparison: Comparison, spec: Facts, second: Facts) -> None:
    """Count facts that no manual prints as decided, and texts of which only a name was compared as read once."""
    for (sort, place), read in comparison.read.items():
        path = dotted(place)
        if read is not Read.TWICE:
            continue
        is_characteristic = sort is Sort.CHARACTERISTIC and len(place) == 2
        is_name_only = is_characteristic and (NUMBERS, *place, "value") not in spec.facts
        if is_name_only or (sort in _WORDS and path in second.printed_numbers):
            comparison.read[sort, place] = Read.ONCE
        elif sort not in _WORDS and _is_decided(sort, path, second.decided):
            comparison.read[sort, place] = Read.DECIDED


def _is_decided(sort: Sort, path: str, decided: Sequence[str]) -> bool:
    """Return True if ``decided`` contains the class of a fact, its path or a path above it."""
    return sort.value in decided or any(f"{path}.".startswith(f"{decided_path}.") for decided_path in decided)


def _codes_of(facts: Facts) -> dict[Key, Fact]:
    return {key: fact for key, fact in facts.facts.items() if key[0] == "code"}


def _codes_differ(spec: Facts, second: Facts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those that it lacks.

    A reading without any order code is not compared.
    """
    spec_codes, second_codes = _codes_of(spec), _codes_of(second)
    if not spec_codes or not second_codes:
        return
    only_in_spec = [fact for key, fact in spec_codes.items() if key not in second_codes]
    if only_in_spec:
        fact, second_place = only_in_spec[0], next(iter(second_codes.values())).place
        yield Disagreement(
            sort=fact.sort,
            description=_with_count(only_in_spec),
            used=_value_text(fact.value),
            other=NOTHING,
            place=fact.place,
            second=second_place,
        )
    only_in_second = [fact for key, fact in second_codes.items() if key not in spec_codes]
    if only_in_second:
        spec_place = next(iter(spec_codes.values())).place
        yield _missing_in_spec(replace(only_in_second[0], description=_with_count(only_in_second)), spec_place)


def _with_count(facts: Sequence[Fact]) -> str:
    """Return the description of the first of several facts, and how many more there are."""
    description = facts[0].description
    return f"{description} and of {len(facts) - 1} more" if len(facts) > 1 else description


def _missing_in_spec(fact: Fact, near: Path) -> Disagreement:
    """Return the disagreement on a fact that only the second reading has."""
    return Disagreement(fact.sort, fact.description, NOTHING, _value_text(fact.value), (), fact.place, near)


def _compare_names(
    comparison: Comparison, spec: Mapping[Key, Names], second: Mapping[Key, Names]
) -> Iterator[Disagreement]:
    for kind, names in spec.items():
        for own_name, other_name in mistaken_pairs(names, second.get(kind, {}), comparison.settled):
            yield Disagreement(
                own_name.sort,
                own_name.description,
                f"'{own_name.value}'",
                f"'{other_name.value}'",
                own_name.place,
                other_name.place,
                is_name=True,
            )


def _value_text(value: Value) -> str:
    return value if isinstance(value, str) else next(iter(value.values()), NOTHING)


def _common_value(value: Value) -> Value:
    """Return the common value if all cases have the same one, otherwise all values."""
    distinct = {value} if isinstance(value, str) else set(value.values())
    return distinct.pop() if len(distinct) == 1 else value


def _compare_facts(
    comparison: Comparison,
    spec_facts: Mapping[Key, Fact],
    second_facts: Mapping[Key, Fact],
    place_in_spec: Callable[[Fact], Path | None],
) -> Iterator[Disagreement]:
    """Compare facts by their keys.

    ``place_in_spec`` returns the place of a fact that the spec lacks, or None if the spec may lack it.
    """
    for key, second_fact, spec_fact in match_by_key(second_facts, spec_facts):
        if spec_fact is not None and not spec_fact.implied:
            if second_fact is not None:
                yield from _compare_values(comparison, spec_fact, second_fact)
            elif key[0] not in _OWN:
                comparison.note(spec_fact.sort, spec_fact.place, Read.ONCE)
        elif second_fact is not None and not second_fact.implied:
            # An implied fact of the spec has a place, but the spec must state it if the second reading does.
            place = spec_fact.place if spec_fact is not None else place_in_spec(second_fact)
            if place is not None:
                yield _missing_in_spec(second_fact, place)


def _compare_values(comparison: Comparison, spec_fact: Fact, second_fact: Fact) -> Iterator[Disagreement]:
    """Compare the values of a fact: one value, or one for each case. Of several differences, yield the first."""
    spec_value, second_value = _common_value(spec_fact.value), _common_value(second_fact.value)
    if isinstance(spec_value, str) is not isinstance(second_value, str):
        # A reading in which all cases have one value is compared in the cases of the other one.
        spec_value, second_value = spec_fact.value, second_fact.value
    if not isinstance(spec_value, str) and not isinstance(second_value, str):
        yield from _compare_cases(comparison, spec_fact, spec_value, second_fact, second_value)
        return
    spec_text, second_text = _value_text(spec_value), _value_text(second_value)
    is_same_name = spec_fact.sort is Sort.PRINTED and same_name(spec_text, second_text)
    if spec_value == second_value or is_same_name:
        comparison.note(spec_fact.sort, spec_fact.place, Read.TWICE)
    else:
        yield _different_values(spec_fact, spec_text, second_fact, second_text)


def _compare_cases(
    comparison: Comparison,
    spec_fact: Fact,
    spec_values: Mapping[Case, str],
    second_fact: Fact,
    second_values: Mapping[Case, str],
) -> Iterator[Disagreement]:
    """Compare the values that a fact has in each case."""
    common = [case for case in spec_values if case in second_values]
    differing = [case for case in common if spec_values[case] != second_values[case]]
    if differing:
        first = differing[0]
        spec_fact_there = replace(spec_fact, description=spec_fact.description + _cases_text(differing))
        yield _different_values(spec_fact_there, spec_values[first], second_fact, second_values[first])
    # A state that changes nothing is known from the factory defaults.
    is_incomplete = any(case not in second_values and not _is_default(spec_values, case) for case in spec_values)
    comparison.note(spec_fact.sort, spec_fact.place, Read.ONCE if is_incomplete else Read.TWICE)


def _different_values(spec_fact: Fact, spec_text: str, second_fact: Fact, second_text: str) -> Disagreement:
    return Disagreement(
        sort=spec_fact.sort,
        description=spec_fact.description,
        used=spec_text,
        other=second_text,
        place=spec_fact.place,
        second=second_fact.place,
        is_name=spec_fact.sort is Sort.PRINTED,
        resized_frame=_frame_text(spec_fact.key) if spec_fact.key[-1] == "length" else "",
    )


def _frame_text(key: Key) -> str:
    """Return the words for the frame with this key in other facts, or an empty text for a register."""
    if key[0] != "frame":
        return ""
    _, _, sender, _, identity, _ = key
    value = f" with {in_hex(identity)}" if isinstance(identity, int) and identity >= 0 else ""
    return f"of the {sender}'s frame{value}"


def _is_default(value: Mapping[Case, str], case: Case) -> bool:
    """Return True if a fact has the same value in a state of the registers as with the factory defaults."""
    return case.state != FACTORY_DEFAULTS and value[case] == value.get(case.by_default)


def _cases_text(cases: list[Case]) -> str:
    """Return the text on the order codes and the state of the registers."""
    state = cases[0].state
    while_text = f" while {state}" if state != FACTORY_DEFAULTS else ""
    codes = dict.fromkeys(case.code for case in cases)
    return f", for {first_of([*codes], 1)}{while_text}"


def _compare_words(comparison: Comparison, word: Word, second_word: Word | None) -> None:
    """Compare a frame or register in every case. Each difference is reported for the first case that shows it."""
    if second_word is None:
        second_cases: Mapping[Case, WordCase] = {}
    elif word.everywhere is not None and second_word.everywhere is not None:
        # Words that are the same in every case are compared even if the readings have no order code in common.
        second_cases = dict.fromkeys(word.cases, second_word.everywhere)
    else:
        second_cases = second_word.cases
    for case, placed in word.cases.items():
        # A state that changes nothing is noted with its factory defaults.
        is_repetition = case.state != FACTORY_DEFAULTS and placed is word.cases.get(case.by_default)
        if case not in second_cases and not is_repetition:
            _note_all(comparison, placed)
    for disagreement, cases in _disagreements_with_cases(comparison, word, second_cases):
        if len(cases) == len(word.cases):
            comparison.differ(disagreement)
        else:
            description = disagreement.description + _cases_text(cases)
            comparison.differ(replace(disagreement, description=description))


#: Identity of a disagreement in all cases: its places, its class, and its number among those of a case with these.
_SameDisagreement = tuple[Path, Path, Sort, int]


def _disagreements_with_cases(
    comparison: Comparison, word: Word, second_cases: Mapping[Case, WordCase]
) -> Iterable[tuple[Disagreement, list[Case]]]:
    """Return each disagreement as it is in the first case that shows it, with all cases that do."""
    disagreements_by_pair: dict[tuple[int, int], list[Disagreement]] = {}
    cases_by_disagreement: dict[_SameDisagreement, tuple[Disagreement, list[Case]]] = {}
    for case, placed in word.cases.items():
        second_placed = second_cases.get(case)
        if second_placed is None:
            continue
        pair = id(placed), id(second_placed)
        if pair not in disagreements_by_pair:
            disagreements_by_pair[pair] = list(_in_case(comparison, word, placed, second_placed))
        counts: Counter[tuple[Path, Path, Sort]] = Counter()
        for disagreement in disagreements_by_pair[pair]:
            kind = disagreement.place, disagreement.second, disagreement.sort
            counts[kind] += 1
            _, cases = cases_by_disagreement.setdefault((*kind, counts[kind]), (disagreement, []))
            cases.append(case)
    return cases_by_disagreement.values()


def _note_all(comparison: Comparison, placed: WordCase) -> None:
    """Count all facts of a word in a case that only the spec has."""
    for bit in placed.bits:
        comparison.note(Sort.POSITION, bit.place, Read.ONCE)
    for properties in placed.fields.values():
        for fact in properties.values():
            comparison.note(fact.sort, fact.place, Read.ONCE)


def _in_case(
    comparison: Comparison, word: Word, spec_placed: WordCase, second_placed: WordCase
) -> Iterator[Disagreement]:
    """Yield the differences in one case. Different lengths are reported with the other facts."""
    if len(spec_placed.bits) != len(second_placed.bits):
        return
    for high, low in _different_ranges(spec_placed.bits, second_placed.bits):
        # Descriptions begin with the highest bit.
        spec_bits, second_bits = spec_placed.bits[low : high + 1][::-1], second_placed.bits[low : high + 1][::-1]
        yield Disagreement(
            sort=Sort.POSITION,
            description=f"{bits(high, low)} of {word.description}",
            used=describe_bits(spec_bits),
            other=describe_bits(second_bits),
            place=spec_bits[0].place,
            second=second_bits[0].place,
        )
    for spec_bit, second_bit in zip(spec_placed.bits, second_placed.bits, strict=True):
        if _have_same_value(spec_bit, second_bit):
            comparison.note(Sort.POSITION, spec_bit.place, Read.TWICE)
    for span, properties in spec_placed.fields.items():
        fact_places = [fact.place for fact in properties.values()]
        field_place = fact_places[0] if fact_places else word.place
        second_properties = second_placed.fields.get(span, {})
        yield from _compare_facts(comparison, properties, second_properties, partial(_unless_mild, field_place))
    yield from _compare_names(comparison, spec_placed.names, second_placed.names)


def _unless_mild(near: Path, fact: Fact) -> Path | None:
    return None if fact.mild else near


def _have_same_value(bit: Bit, other_bit: Bit) -> bool:
    return (bit.part, bit.weight, bit.fixed) == (other_bit.part, other_bit.weight, other_bit.fixed)


def _different_ranges(own_bits: tuple[Bit, ...], other_bits: tuple[Bit, ...]) -> list[tuple[int, int]]:
    """Return ranges of different bits, highest first, grouped if they differ in the same way."""
    ranges: list[tuple[int, int]] = []
    for index in range(len(own_bits) - 1, -1, -1):
        if _have_same_value(own_bits[index], other_bits[index]):
            continue
        is_below_last = bool(ranges) and ranges[-1][1] == index + 1
        if (
            is_below_last
            and continues_item(own_bits[index], own_bits[index + 1])
            and continues_item(other_bits[index], other_bits[index + 1])
        ):
            high, _ = ranges[-1]
            ranges[-1] = high, index
        else:
            ranges.append((index, index))
    return ranges
