"""Compare the names that two readers chose, such as the names of registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from .reading import ComparedFact, ComparedFacts, FactKey, FactNames

#: If at least this share of names is equal, the second reading is assumed to use the names of the spec.
_SHARE_OF_EQUAL_NAMES = 0.9


def use_same_names(spec: ComparedFacts, second: ComparedFacts) -> bool:
    """Return whether the second reading uses the names of the spec, so that any different name is a mistake.

    This is assumed if at least 90 % of the names of common items are equal.
    """
    compared_count, equal_count = 0, 0
    for spec_names, second_names in _name_maps_of_both(spec, second):
        for key in spec_names.keys() & second_names.keys():
            compared_count += 1
            if spec_names[key].value == second_names[key].value:
                equal_count += 1
    return equal_count >= _SHARE_OF_EQUAL_NAMES * compared_count


def _name_maps_of_both(spec: ComparedFacts, second: ComparedFacts) -> Iterator[tuple[FactNames, FactNames]]:
    """Yield the names of each kind of item in both readings, by key.

    Names of fields are taken from the first case of a frame or register that both readings have.
    """
    yield from _names_by_kind(spec.names, second.names)
    for key in spec.words.keys() & second.words.keys():
        spec_cases, second_cases = spec.words[key].cases, second.words[key].cases
        common_cases = [case for case in spec_cases if case in second_cases]
        if common_cases:
            first_case = common_cases[0]
            yield from _names_by_kind(spec_cases[first_case].names, second_cases[first_case].names)


def _names_by_kind(
    spec: Mapping[FactKey, FactNames], second: Mapping[FactKey, FactNames]
) -> Iterator[tuple[FactNames, FactNames]]:
    for kind in spec.keys() & second.keys():
        yield spec[kind], second[kind]


def mistaken_pairs(
    spec_names: FactNames, second_names: FactNames, *, must_be_equal: bool
) -> Iterator[tuple[ComparedFact, ComparedFact]]:
    """Yield the names of an item in the spec and in the second reading, if they differ and one must be a mistake.

    One must be a mistake if the second reader uses the name in the spec for a different item, if the two names differ
    in one letter, or if all names ``must_be_equal``.
    """
    all_second_names = {second_name.value for second_name in second_names.values()}
    for key, spec_name in spec_names.items():
        second_name = second_names.get(key)
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
