"""Compare single facts of two readings, the names that the readers give to items, and frames and registers bit by bit.

In the code, a frame or register is a word.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from ..language.document import Path
from ..say import first_of
from ..say.names_and_evidence import bits as bits_text
from .bits_and_registers import continues_item, describe_bits
from .disagreements import Comparison, Disagreement, HowOftenRead
from .reading import (
    FACTORY_DEFAULTS,
    NOTHING,
    BitMeaning,
    CodeAndState,
    ComparedFact,
    FactClass,
    FactKey,
    FactNames,
    FactValue,
    WordBits,
    WordCase,
    in_hex,
    same_name,
)

#: Kinds of items that each reader defines as needed. A different set of them in the other reading is not a mistake.
CHOSEN_BY_READER = frozenset(("parameter",))


def compare_facts(
    comparison: Comparison,
    spec_facts: Mapping[FactKey, ComparedFact],
    second_facts: Mapping[FactKey, ComparedFact],
    find_path_in_spec: Callable[[ComparedFact], Path | None],
) -> Iterator[Disagreement]:
    """Yield the disagreements between the facts of a spec and of its second reading, and count the facts of the spec.

    A fact that only the spec states counts as read once. A fact that only the second reading states is a disagreement,
    also if the spec implies it. ``find_path_in_spec`` returns where the spec should state such a fact, or None for a
    fact that it need not state.
    """
    for key in dict.fromkeys((*second_facts, *spec_facts)):
        spec_fact, second_fact = spec_facts.get(key), second_facts.get(key)
        if spec_fact is not None and not spec_fact.is_implied:
            if second_fact is not None:
                yield from _compare_values(comparison, spec_fact, second_fact)
            elif key[0] not in CHOSEN_BY_READER:
                comparison.count_fact(spec_fact.fact_class, spec_fact.path_in_file, HowOftenRead.ONCE)
        elif second_fact is not None and not second_fact.is_implied:
            # The spec may imply the fact, but must state it if the second reading does.
            nearest_path = spec_fact.path_in_file if spec_fact is not None else find_path_in_spec(second_fact)
            if nearest_path is not None:
                yield missing_in_spec(second_fact, nearest_path)


def missing_in_spec(second_fact: ComparedFact, nearest_path: Path) -> Disagreement:
    """Return the disagreement on a fact that only the second reading has.

    ``nearest_path`` is the place where the spec should state the fact.
    """
    return Disagreement(
        fact_class=second_fact.fact_class,
        description=second_fact.description,
        spec_value=NOTHING,
        second_value=value_text(second_fact.value),
        path_in_spec=(),
        path_in_second=second_fact.path_in_file,
        nearest_path=nearest_path,
    )


def _compare_values(
    comparison: Comparison, spec_fact: ComparedFact, second_fact: ComparedFact
) -> Iterator[Disagreement]:
    """Yield a disagreement if a fact has different values in the two readings, and count the fact if not.

    A value can differ between cases, which are order codes with states of their registers. If each reading has the same
    value in all cases, these two values are compared. Printed names are equal if they have an alternative in common.
    """
    spec_value, second_value = _common_value(spec_fact.value), _common_value(second_fact.value)
    has_one_common_value = isinstance(spec_value, str) is not isinstance(second_value, str)
    if has_one_common_value:
        # Only one of the readings has the same value in all cases, so the values are compared case by case.
        spec_value, second_value = spec_fact.value, second_fact.value
    if not isinstance(spec_value, str) and not isinstance(second_value, str):
        yield from _compare_cases(comparison, spec_fact, spec_value, second_fact, second_value)
        return
    spec_text, second_text = value_text(spec_value), value_text(second_value)
    is_same_name = spec_fact.fact_class is FactClass.PRINTED and same_name(spec_text, second_text)
    if spec_value == second_value or is_same_name:
        comparison.count_fact(spec_fact.fact_class, spec_fact.path_in_file, HowOftenRead.TWICE)
    else:
        yield _different_values(spec_fact, spec_text, second_fact, second_text)


def _common_value(value_or_cases: FactValue) -> FactValue:
    """Return the value of a fact if it is the same in all cases, or else the values by case."""
    if isinstance(value_or_cases, str):
        return value_or_cases
    distinct_values = set(value_or_cases.values())
    has_common_value = len(distinct_values) == 1
    return distinct_values.pop() if has_common_value else value_or_cases


def value_text(value_or_cases: FactValue) -> str:
    """Return the value of a fact as text, or its value in the first case if the value differs between cases."""
    if isinstance(value_or_cases, str):
        return value_or_cases
    return next(iter(value_or_cases.values()), NOTHING)


def _compare_cases(
    comparison: Comparison,
    spec_fact: ComparedFact,
    spec_values: Mapping[CodeAndState, str],
    second_fact: ComparedFact,
    second_values: Mapping[CodeAndState, str],
) -> Iterator[Disagreement]:
    """Yield a disagreement if a fact has different values in cases that both readings have, and count the fact.

    A case is an order code with a state of its registers. The fact counts as read once if the second reading does not
    have all cases of the spec. Cases in which the registers do not change the value are not needed.
    """
    common_cases = [case for case in spec_values if case in second_values]
    differing_cases = [case for case in common_cases if spec_values[case] != second_values[case]]
    if differing_cases:
        first_case = differing_cases[0]
        described_fact = replace(spec_fact, description=spec_fact.description + cases_text(differing_cases))
        disagreement = _different_values(
            described_fact, spec_values[first_case], second_fact, second_values[first_case]
        )
        yield replace(disagreement, order_codes=frozenset(case.code for case in differing_cases))
    missing_cases = [case for case in spec_values if case not in second_values]
    is_incomplete = any(not _has_default_value(spec_values, case) for case in missing_cases)
    how_often = HowOftenRead.ONCE if is_incomplete else HowOftenRead.TWICE
    comparison.count_fact(spec_fact.fact_class, spec_fact.path_in_file, how_often)


def _has_default_value(values: Mapping[CodeAndState, str], case: CodeAndState) -> bool:
    """Return whether a fact has the same value in this case as with the factory defaults of the registers."""
    return case.state != FACTORY_DEFAULTS and values[case] == values.get(case.by_default)


def _different_values(
    spec_fact: ComparedFact, spec_text: str, second_fact: ComparedFact, second_text: str
) -> Disagreement:
    """Return the disagreement on a fact with different values in the two readings.

    ``resized_frame`` of the result contains the words for a frame whose length differs, and is "" for any other fact.
    """
    is_length = spec_fact.key[-1] == "length"
    return Disagreement(
        fact_class=spec_fact.fact_class,
        description=spec_fact.description,
        spec_value=spec_text,
        second_value=second_text,
        path_in_spec=spec_fact.path_in_file,
        path_in_second=second_fact.path_in_file,
        is_name=spec_fact.fact_class is FactClass.PRINTED,
        resized_frame=_frame_text(spec_fact.key) if is_length else "",
    )


def _frame_text(frame_key: FactKey) -> str:
    """Return the words for a frame in descriptions of its bits: ``of the encoder's frame with 0x1A``, or "".

    ``frame_key`` is the key of the length. For a register, the text is "".
    """
    if frame_key[0] != "frame":
        return ""
    # ("frame", interface, sender, channel, selector value or other identity, "length")
    _, _, sender, _, selector_value, _ = frame_key
    frame_text = f"of the {sender}'s frame"
    # For a frame without a selector, this is a text or a negative number.
    if isinstance(selector_value, int) and selector_value >= 0:
        return f"{frame_text} with {in_hex(selector_value)}"
    return frame_text


def cases_text(cases: list[CodeAndState]) -> str:
    """Return the order codes of cases and the state of the first case: ``, for X-24 and 2 more while 0x49 = 3``."""
    order_codes = list(dict.fromkeys(case.code for case in cases))
    text = f", for {first_of(order_codes, 1)}"
    state = cases[0].state
    return text if state == FACTORY_DEFAULTS else f"{text} while {state}"


def compare_names(
    comparison: Comparison,
    spec_names_by_kind: Mapping[FactKey, FactNames],
    second_names_by_kind: Mapping[FactKey, FactNames],
) -> Iterator[Disagreement]:
    """Yield a disagreement for each item with different names in the two readings, if one of them must be a mistake.

    If the second reading uses the names of the spec, all names must be equal.
    """
    for kind, spec_names in spec_names_by_kind.items():
        second_names = second_names_by_kind.get(kind, {})
        for spec_name, second_name in mistaken_pairs(
            spec_names, second_names, must_be_equal=comparison.has_names_of_spec
        ):
            yield Disagreement(
                fact_class=spec_name.fact_class,
                description=spec_name.description,
                spec_value=f"'{spec_name.value}'",
                second_value=f"'{second_name.value}'",
                path_in_spec=spec_name.path_in_file,
                path_in_second=second_name.path_in_file,
                is_name=True,
            )


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
        comparison.count_fact(FactClass.POSITION, bit.path_in_file, HowOftenRead.ONCE)
    for properties in spec_case.fields.values():
        for fact in properties.values():
            comparison.count_fact(fact.fact_class, fact.path_in_file, HowOftenRead.ONCE)


def _disagreements_with_cases(
    comparison: Comparison, spec_word: WordBits, second_cases: Mapping[CodeAndState, WordCase]
) -> Iterable[tuple[Disagreement, list[CodeAndState]]]:
    """Return each disagreement on a word, as found in the first case, with all cases in which it occurs.

    Disagreements in two cases are the same if their places, classes and numbers are equal.
    """
    # Most cases share one word, so each pair of words is compared once.
    disagreements_by_word_pair: dict[tuple[int, int], list[Disagreement]] = {}
    disagreement_and_cases: dict[_DisagreementKey, tuple[Disagreement, list[CodeAndState]]] = {}
    for case, spec_case in spec_word.cases.items():
        second_case = second_cases.get(case)
        if second_case is None:
            continue
        word_pair = id(spec_case), id(second_case)
        if word_pair not in disagreements_by_word_pair:
            disagreements_by_word_pair[word_pair] = list(
                _compare_in_case(comparison, spec_word, spec_case, second_case)
            )
        for key, disagreement in _with_keys(disagreements_by_word_pair[word_pair]):
            _, cases = disagreement_and_cases.setdefault(key, (disagreement, []))
            cases.append(case)
    return disagreement_and_cases.values()


def _with_keys(disagreements: Iterable[Disagreement]) -> Iterator[tuple[_DisagreementKey, Disagreement]]:
    """Yield the disagreements of one case, each with a key by which it is recognized in other cases.

    Disagreements with the same places and class are numbered from 1.
    """
    counts_so_far: Counter[tuple[Path, Path, FactClass]] = Counter()
    for disagreement in disagreements:
        places_and_class = disagreement.path_in_spec, disagreement.path_in_second, disagreement.fact_class
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
        property_paths = [fact.path_in_file for fact in spec_properties.values()]
        field_path = property_paths[0] if property_paths else spec_word.path_in_file
        second_properties = second_case.fields.get(low_and_width, {})
        find_path_in_spec = partial(_place_unless_optional, field_path)
        yield from compare_facts(comparison, spec_properties, second_properties, find_path_in_spec)
    yield from compare_names(comparison, spec_case.names, second_case.names)


def _place_unless_optional(field_path: Path, second_fact: ComparedFact) -> Path | None:
    """Return the place of a field if the spec must state a fact about it that the second reading states, or None."""
    return None if second_fact.may_be_missing else field_path


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
            path_in_spec=spec_range[0].path_in_file,
            path_in_second=second_range[0].path_in_file,
        )
    for spec_bit, second_bit in zip(spec_bits, second_bits, strict=True):
        if _have_same_meaning(spec_bit, second_bit):
            comparison.count_fact(FactClass.POSITION, spec_bit.path_in_file, HowOftenRead.TWICE)


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


def mistaken_pairs(
    spec_name_by_key: FactNames, second_name_by_key: FactNames, *, must_be_equal: bool
) -> Iterator[tuple[ComparedFact, ComparedFact]]:
    """Yield the names of an item in the spec and in the second reading, if they differ and one must be a mistake.

    One must be a mistake if the second reader uses the name in the spec for a different item, if the two names differ
    in one letter, or if all names ``must_be_equal``.
    """
    all_second_names = {second_name.value for second_name in second_name_by_key.values()}
    for key, spec_name in spec_name_by_key.items():
        second_name = second_name_by_key.get(key)
        if second_name is None or second_name.value == spec_name.value:
            continue
        is_used_for_other_item = spec_name.value in all_second_names
        is_misspelling = _differ_in_one_letter(str(spec_name.value), str(second_name.value))
        if must_be_equal or is_used_for_other_item or is_misspelling:
            yield spec_name, second_name


def _differ_in_one_letter(name: str, other_name: str) -> bool:
    """Return whether two names differ by one extra, missing or wrong letter, or by two swapped letters."""
    shorter, longer = sorted((name, other_name), key=len)
    if len(shorter) < len(longer):
        return any(longer[:index] + longer[index + 1 :] == shorter for index in range(len(longer)))
    differing_indices = [index for index in range(len(name)) if name[index] != other_name[index]]
    start, end = differing_indices[0], differing_indices[-1] + 1
    is_one_wrong_letter = end - start == 1
    are_two_swapped = end - start == 2 and name[start:end] == other_name[start:end][::-1]
    return is_one_wrong_letter or are_two_swapped
