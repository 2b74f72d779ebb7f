"""Compare the words of two readings, which are frames and registers, bit by bit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from ..language.document import Path
from ..say.names_and_places import bits as bits_text
from .compare_facts import cases_text, compare_facts, compare_names
from .comparison import Comparison, Disagreement, HowOftenRead
from .frame_bits import continues_item, describe_bits
from .reading import FACTORY_DEFAULTS, BitMeaning, CodeAndState, ComparedFact, FactClass, WordBits, WordCase

#: Identity of a disagreement in all cases: its places, its class, and its number among the disagreements of a case with
#: the same places and class.
_DisagreementKey = tuple[Path, Path, FactClass, int]


def compare_word(comparison: Comparison, spec_word: WordBits, second_word: WordBits | None) -> None:
    """Compare a frame or register in every case. Each difference is reported for the first case that shows it.

    ``second_word`` is None if the second reading lacks it. Facts of cases that only the spec has are counted as read
    once. A difference that not all cases show is reported with its cases: ``, for X-24 and 5 more``.
    """
    second_cases = _second_cases(spec_word, second_word)
    for case, spec_case in spec_word.cases.items():
        # Cases with equal words share one object. A state that changes nothing is counted with its factory defaults.
        is_repetition = case.state != FACTORY_DEFAULTS and spec_case is spec_word.cases.get(case.by_default)
        if case not in second_cases and not is_repetition:
            _count_as_read_once(comparison, spec_case)
    for disagreement, differing_cases in _disagreements_with_cases(comparison, spec_word, second_cases):
        if len(differing_cases) == len(spec_word.cases):
            comparison.add_disagreement(disagreement)
        else:
            description = disagreement.description + cases_text(differing_cases)
            comparison.add_disagreement(replace(disagreement, description=description))


def _second_cases(spec_word: WordBits, second_word: WordBits | None) -> Mapping[CodeAndState, WordCase]:
    """Return the word of the second reading for each case in which the words are compared.

    If both words are the same in all of their cases, they are compared even without a common order code.
    """
    if second_word is None:
        return {}
    if spec_word.everywhere is not None and second_word.everywhere is not None:
        return dict.fromkeys(spec_word.cases, second_word.everywhere)
    return second_word.cases


def _count_as_read_once(comparison: Comparison, spec_case: WordCase) -> None:
    """Count all facts of a word whose case occurs only in the spec."""
    for bit in spec_case.bits:
        comparison.count_fact(FactClass.POSITION, bit.place, HowOftenRead.ONCE)
    for properties in spec_case.fields.values():
        for fact in properties.values():
            comparison.count_fact(fact.sort, fact.place, HowOftenRead.ONCE)


def _disagreements_with_cases(
    comparison: Comparison, spec_word: WordBits, second_cases: Mapping[CodeAndState, WordCase]
) -> Iterable[tuple[Disagreement, list[CodeAndState]]]:
    """Return each disagreement as in the first case that shows it, with all cases that do.

    Disagreements in two cases are one if their keys are equal: places, class and number (see ``_with_keys``).
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
    """Yield the disagreements of one case, each with a key that identifies it in other cases.

    Those with the same places and class are numbered from 1.
    """
    counts_so_far: Counter[tuple[Path, Path, FactClass]] = Counter()
    for disagreement in disagreements:
        places_and_sort = disagreement.spec_place, disagreement.second_place, disagreement.sort
        counts_so_far[places_and_sort] += 1
        yield (*places_and_sort, counts_so_far[places_and_sort]), disagreement


def _compare_in_case(
    comparison: Comparison, spec_word: WordBits, spec_case: WordCase, second_case: WordCase
) -> Iterator[Disagreement]:
    """Yield the differences in one case: of bits, of the properties of fields, and of names.

    Words of different lengths have none, since their lengths are reported with the other facts.
    """
    if len(spec_case.bits) != len(second_case.bits):
        return
    yield from _compare_bits(comparison, spec_word, spec_case.bits, second_case.bits)
    for low_and_width, spec_properties in spec_case.fields.items():
        # All properties of a field have places in or near it. The first property represents the field.
        property_places = [fact.place for fact in spec_properties.values()]
        field_place = property_places[0] if property_places else spec_word.place
        second_properties = second_case.fields.get(low_and_width, {})
        place_in_spec = partial(_place_unless_optional, field_place)
        yield from compare_facts(comparison, spec_properties, second_properties, place_in_spec)
    yield from compare_names(comparison, spec_case.names, second_case.names)


def _place_unless_optional(field_place: Path, second_fact: ComparedFact) -> Path | None:
    """Return the place of the field if the spec must have a fact about it that the second reading has, or else None."""
    return None if second_fact.may_be_missing else field_place


def _compare_bits(
    comparison: Comparison, spec_word: WordBits, spec_bits: tuple[BitMeaning, ...], second_bits: tuple[BitMeaning, ...]
) -> Iterator[Disagreement]:
    """Yield the ranges of bits with different meanings, and count the bits with the same meaning as read twice."""
    for high, low in _different_ranges(spec_bits, second_bits):
        # The bits are lowest first, but descriptions begin with the highest one.
        spec_range = spec_bits[low : high + 1][::-1]
        second_range = second_bits[low : high + 1][::-1]
        yield Disagreement(
            sort=FactClass.POSITION,
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
    """Return the high and low bits of ranges of different bits, highest first: ``[(7, 4), (2, 2)]``.

    Adjacent bits are in one range if they belong to one item in the spec, and also to one in the second reading.
    """
    ranges: list[tuple[int, int]] = []
    for bit in reversed(range(len(spec_bits))):
        if _have_same_meaning(spec_bits[bit], second_bits[bit]):
            continue
        bit_above = bit + 1
        # A range is (high, low), and the last one is the lowest so far.
        is_below_last_range = bool(ranges) and ranges[-1][1] == bit_above
        if (
            is_below_last_range
            and continues_item(spec_bits[bit], spec_bits[bit_above])
            and continues_item(second_bits[bit], second_bits[bit_above])
        ):
            high, _ = ranges[-1]
            ranges[-1] = high, bit
        else:
            ranges.append((bit, bit))
    return ranges
