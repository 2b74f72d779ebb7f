"""Names: each reader chooses their own, but a shared name has one meaning, and none is a typo of the other's."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import takewhile

from .fact import Facts, Name, Names

#: Share of equal names from which the second reading is assumed to use the names of the spec.
_SETTLED = 0.9


def are_settled(spec: Facts, second: Facts) -> bool:
    """Return True if the second reading uses the names of the spec, so that any different name is a mistake."""
    pairs = [
        (own[key].name, theirs[key].name) for own, theirs in _both(spec, second) for key in own.keys() & theirs.keys()
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


def mistaken(own: Names, theirs: Names, settled: bool) -> Iterator[tuple[Name, Name]]:
    """Yield pairs of different names of one item if one must be a mistake.

    This is the case if the other reader uses the name for another item, if the two differ in one letter, or if all
    names are ``settled``.
    """
    used = {item.name for item in theirs.values()}
    for key, mine in own.items():
        other = theirs.get(key)
        if other is None or other.name == mine.name:
            continue
        if settled or mine.name in used or _is_slip(mine.name, other.name):
            yield mine, other


def _is_slip(one: str, other: str) -> bool:
    """Return True for one extra, missing or wrong letter, or two swapped ones."""
    if abs(len(one) - len(other)) > 1:
        return False
    start = _alike(one, other)
    end = _alike(one[start:][::-1], other[start:][::-1])
    here, there = one[start : len(one) - end], other[start : len(other) - end]
    return max(len(here), len(there)) < 2 or (len(here) == 2 and here == there[::-1])


def _alike(one: str, other: str) -> int:
    """Return the length of the common prefix of two words."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
