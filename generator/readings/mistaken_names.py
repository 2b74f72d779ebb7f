"""Names: each reader chooses their own, but a shared name has one meaning, and none is a typo of the other's."""

from __future__ import annotations

from collections.abc import Iterator

from .fact import Fact, Facts, Names

#: Share of equal names from which the second reading is assumed to use the names of the spec.
_SETTLED = 0.9


def are_settled(spec: Facts, second: Facts) -> bool:
    """Return True if the second reading uses the names of the spec, so that any different name is a mistake."""
    pairs = [
        (own[key].value, theirs[key].value) for own, theirs in _both(spec, second) for key in own.keys() & theirs.keys()
    ]
    return sum(one == other for one, other in pairs) >= _SETTLED * len(pairs)


def _both(spec: Facts, second: Facts) -> Iterator[tuple[Names, Names]]:
    """Yield the names of each kind that both readings have, those of fields for the first case of each word."""
    for kind in spec.names.keys() & second.names.keys():
        yield spec.names[kind], second.names[kind]
    for key in spec.words.keys() & second.words.keys():
        own, theirs = spec.words[key].cases, second.words[key].cases
        case = next((case for case in own if case in theirs), None)
        if case is not None:
            kinds = own[case].names.keys() & theirs[case].names.keys()
            yield from ((own[case].names[kind], theirs[case].names[kind]) for kind in kinds)


def mistaken(own: Names, theirs: Names, settled: bool) -> Iterator[tuple[Fact, Fact]]:
    """Yield pairs of different names of one item if one must be a mistake.

    This is the case if the other reader uses the name for another item, if the two differ in one letter, or if all
    names are ``settled``.
    """
    used = {item.value for item in theirs.values()}
    for key, mine in own.items():
        other = theirs.get(key)
        if other is None or other.value == mine.value:
            continue
        if settled or mine.value in used or _is_slip(str(mine.value), str(other.value)):
            yield mine, other


def _is_slip(one: str, other: str) -> bool:
    """Return True if two different names differ by one extra, missing or wrong letter, or two swapped ones."""
    short, long = sorted((one, other), key=len)
    if len(short) < len(long):
        return any(long[:index] + long[index + 1 :] == short for index in range(len(long)))
    differing = [index for index, letters in enumerate(zip(one, other, strict=True)) if letters[0] != letters[1]]
    first, end = differing[0], differing[-1] + 1
    return end - first == 1 or (end - first == 2 and one[first:end] == other[first:end][::-1])
