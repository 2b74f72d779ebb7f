"""Compare the frames and registers of two readings bit by bit. In the code, a frame or register is a word."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from ..language.document import Path
from ..say.names_and_evidence import bits as bits_text
from .compare_facts import cases_text, compare_facts, compare_names
from .comparison import Comparison, Disagreement, HowOftenRead
from .frame_bits import continues_item, describe_bits
from .reading import FACTORY_DEFAULTS, BitMeaning, CodeAndState, ComparedFact, FactClass, WordBits, WordCase

#: Key by which a disagreement is recognized in several cases: its places, its class, and its number among the
#: disagreements of a case with the same places and class.
_DisagreementKey = tuple[Path, Path, FactClass, int]


def compare_word(comparison: Comparison, spec_word: WordBits, second_word: WordBits | None) -> None:
    """Compare a frame or register of a spec with its second reading, in every case.

    A case is an order code with a state of its registers. A difference is reported once. If it only occurs in some
    cases, they are added: ``, for X-24 and 5 more``. In cases that only the spec has, facts count as read once.
    ``second_word`` is None if the second reading does not contain the word.
    """
    second_cases = _second_cases(spec_word, second_word)
    for case, spec_case in spec_word.cases.items():
        # Cases with equal words share one object. A state of the registers that changes nothing need not be read.
        is_unchanged = case.state != FACTORY_DEFAULTS and spec_case is spec_word.cases.get(case.by_default)
        if case not in second_cases and not is_unchanged:
            _count_as_read_once(comparison, spec_case)
    for disagreement, differing_cases in _disagreements_with_cases(comparison, spec_word, second_cases):
        if len(differing_cases) == len(spec_word.cases):
            comparison.add_disagreement(disagreement)
        else:
            description = disagreement.description + cases_text(differing_cases)
            comparison.add_disagreement(replace(disagreement, description=description))


def _second_cases(spec_word: WordBits, second_word: WordBits | None) -> Mapping[CodeAndState, WordCase]:
    """Return the word of the second reading in each case in which the words are compared.

    If each reading has the same word in all cases, they are compared even if the readings share no order code.
    """
    if second_word is None:
        return {}
    if spec_word.everywhere is not None and second_word.everywhere is not None:
        return dict.fromkeys(spec_word.cases, second_word.everywhere)
    return second_word.cases


def _count_as_read_once(comparison: Comparison, spec_case: WordCase) -> None:
    """Count all facts about a word as read once, because only the spec has this case."""
    for bit in spec_case.bits:
        comparison.count_fact(FactClass.POSITION, bit.place, HowOftenRead.ONCE)
    for properties in spec_case.fields.values():
        for fact in properties.values():
            comparison.count_fact(fact.fact_class, fact.place, HowOftenRead.ONCE)


def _disagreements_with_cases(
    comparison: Comparison, spec_word: WordBits, second_cases: Mapping[CodeAndState, WordCase]
) -> Iterable[tuple[Disagreement, list[CodeAndState]]]:
    """Return each disagreement on a word, as found in the first case, with all cases in which it occurs.

    Disagreements in two cases are the same if their places, classes and numbers are equal.
    """
    # Most cases share one word, so each pair of words is compared once.
    disagreements_by_pair: dict[tuple[int, int], list[Disagreement]] = {}
    disagreement_and_cases: dict[_DisagreementKey, tuple[Disagreement, list[CodeAndState]]] = {}
    for case, spec_case in spec_word.cases.items():
        second_case = second_cases.get(case)
        if second_case is None:
            continue
        pair = id(spec_case), id(second_case)
        if pair not in disagreements_by_pair:
            disagreements_by_pair[pair] = list(_compare_in_case(comparison, spec_word, spec_case, second_case))
        for key, disagreement in _with_keys(disagreements_by_pair[pair]):
            _, cases = disagreement_and_cases.setdefault(key, (disagreement, []))
            cases.append(case)
    return disagreement_and_cases.values()


def _with_keys(disagreements: Iterable[Disagreement]) -> Iterator[tuple[_DisagreementKey, Disagreement]]:
    """Yield the disagreements of one case, each with a key by which it is recognized in other cases.

    Disagreements with the same places and class are numbered from 1.
    """
    counts_so_far: Counter[tuple[Path, Path, FactClass]] = Counter()
    for disagreement in disagreements:
        places_and_class = disagreement.spec_place, disagreement.second_place, disagreement.fact_class
        counts_so_far[places_and_class] += 1
        yield (*places_and_class, counts_so_far[places_and_class]), disagreement


def _compare_in_case(
    comparison: Comparison, spec_word: WordBits, spec_case: WordCase, second_case: WordCase
) -> Iterator[Disagreement]:
    """Yield the differences between two words in one case: in bits, in the properties of fields, and in names.

    Words of different lengths are not compared, because their lengths are reported as another fact.
    """
    if len(spec_case.bits) != len(second_case.bits):
        return
    yield from _compare_bits(comparison, spec_word, spec_case.bits, second_case.bits)
    for low_and_width, spec_properties in spec_case.fields.items():
        # The properties of a field are stated in it or near it, so the place of the first one represents the field.
        property_places = [fact.place for fact in spec_properties.values()]
        field_place = property_places[0] if property_places else spec_word.place
        second_properties = second_case.fields.get(low_and_width, {})
        place_in_spec = partial(_place_unless_optional, field_place)
        yield from compare_facts(comparison, spec_properties, second_properties, place_in_spec)
    yield from compare_names(comparison, spec_case.names, second_case.names)


def _place_unless_optional(field_place: Path, second_fact: ComparedFact) -> Path | None:
    """Return the place of a field if the spec must state a fact about it that the second reading states, or None."""
    return None if second_fact.may_be_missing else field_place


def _compare_bits(
    comparison: Comparison, spec_word: WordBits, spec_bits: tuple[BitMeaning, ...], second_bits: tuple[BitMeaning, ...]
) -> Iterator[Disagreement]:
    """Yield the ranges of bits whose meanings differ, and count the bits with the same meaning as read twice."""
    for high, low in _different_ranges(spec_bits, second_bits):
        # The bits are lowest first, but descriptions begin with the highest one.
        spec_range = spec_bits[low : high + 1][::-1]
        second_range = second_bits[low : high + 1][::-1]
        yield Disagreement(
            fact_class=FactClass.POSITION,
            description=f"{bits_text(high, low)} of {spec_word.description}",
            spec_value=describe_bits(spec_range),
            second_value=describe_bits(second_range),
            spec_place=spec_range[0].place,
            second_place=second_range[0].place,
        )
    for spec_bit, second_bit in zip(spec_bits, second_bits, strict=True):
        if _have_same_meaning(spec_bit, second_bit):
            comparison.count_fact(FactClass.POSITION, spec_bit.place, HowOftenRead.TWICE)


def _have_same_meaning(bit: BitMeaning, other_bit: BitMeaning) -> bool:
    return (bit.part, bit.weight, bit.fixed) == (other_bit.part, other_bit.weight, other_bit.fixed)


def _different_ranges(spec_bits: tuple[BitMeaning, ...], second_bits: tuple[BitMeaning, ...]) -> list[tuple[int, int]]:
    """Return the highest and lowest bits of the ranges that differ, beginning with the highest: ``[(7, 4), (2, 2)]``.

    Adjacent bits are in one range if they belong to the same item in each of the readings.
    """
    ranges: list[tuple[int, int]] = []
    for bit in reversed(range(len(spec_bits))):
        if _have_same_meaning(spec_bits[bit], second_bits[bit]):
            continue
        bit_above = bit + 1
        last_high, last_low = ranges[-1] if ranges else (-1, -1)
        extends_last_range = (
            last_low == bit_above
            and continues_item(spec_bits[bit], spec_bits[bit_above])
            and continues_item(second_bits[bit], second_bits[bit_above])
        )
        if extends_last_range:
            ranges[-1] = last_high, bit
        else:
            ranges.append((bit, bit))
    return ranges
