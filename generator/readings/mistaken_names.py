"""Names: each reader chooses their own, but a shared name has one meaning, and none is a typo of the other's."""

from __future__ import annotations

from collections.abc import Iterator

from .fact import Fact, Facts, Names

#: Share of equal names from which the second reading is assumed to use the names of the spec.
_SETTLED = 0.9


def are_settled(spec: Facts, second: Facts) -> bool:
    """Return True if the second reading uses the names of the spec, so that any different name is a mistake."""
    count, equal_count = 0, 0
    for own_names, other_names in _common_names(spec, second):
        for key in own_names.keys() & other_names.keys():
            count += 1
            equal_count += own_names[key].value == other_names[key].value
    return equal_count >= _SETTLED * count


def _common_names(spec: Facts, second: Facts) -> Iterator[tuple[Names, Names]]:
    """Yield the names of each kind that both readings have, those of fields for the first case of each word."""
    for kind in spec.names.keys() & second.names.keys():
        yield spec.names[kind], second.names[kind]
    for key in spec.words.keys() & second.words.keys():
        own_cases, other_cases = spec.words[key].cases, second.words[key].cases
        case = next((case for case in own_cases if case in other_cases), None)
        if case is not None:
            kinds = own_cases[case].names.keys() & other_cases[case].names.keys()
            yield from ((own_cases[case].names[kind], other_cases[case].names[kind]) for kind in kinds)


def mistaken_pairs(own_names: Names, other_names: Names, settled: bool) -> Iterator[tuple[Fact, Fact]]:
    """Yield pairs of different names of one item if one must be a mistake.

    This is the case if the other reader uses the name for another item, if the two differ in one letter, or if all
    names are ``settled``.
    """
    used_names = {name.value for name in other_names.values()}
    for key, own_name in own_names.items():
        other_name = other_names.get(key)
        if other_name is None or other_name.value == own_name.value:
            continue
        if settled or own_name.value in used_names or _is_misspelling(str(own_name.value), str(other_name.value)):
            yield own_name, other_name


def _is_misspelling(name: str, other_name: str) -> bool:
    """Return True if two different names differ by one extra, missing or wrong letter, or two swapped ones."""
    short, long = sorted((name, other_name), key=len)
    if len(short) < len(long):
        return any(long[:index] + long[index + 1 :] == short for index in range(len(long)))
    differing = [index for index, letters in enumerate(zip(name, other_name, strict=True)) if letters[0] != letters[1]]
    first, end = differing[0], differing[-1] + 1
    return end - first == 1 or (end - first == 2 and name[first:end] == other_name[first:end][::-1])
