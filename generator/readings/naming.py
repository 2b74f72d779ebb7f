"""Names: each reader gives his own, but one that both give means one thing, and none is a slip of the other's."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import takewhile

from .fact import Facts, Name, Names

#: From this share of equal names on, those of a second reading have been set to the spec's.
_SETTLED = 0.9


def are_settled(spec: Facts, second: Facts) -> bool:
    """Whether the second reading has the names of the spec, so that one that differs is a slip, whatever it is."""
    pairs = [
        (own[key].name, theirs[key].name) for own, theirs in _both(spec, second) for key in own.keys() & theirs.keys()
    ]
    return sum(one == other for one, other in pairs) >= _SETTLED * len(pairs)


def _both(spec: Facts, second: Facts) -> Iterator[tuple[Names, Names]]:
    """The names of each kind that both readings have, those of fields in the first case of each word."""
    for kind in spec.names.keys() & second.names.keys():
        yield spec.names[kind], second.names[kind]
    for key in spec.words.keys() & second.words.keys():
        own, theirs = spec.words[key].cases, second.words[key].cases
        case = next((case for case in own if case in theirs), None)
        if case is not None:
            kinds = own[case].names.keys() & theirs[case].names.keys()
            yield from ((own[case].names[kind], theirs[case].names[kind]) for kind in kinds)


def mistaken(own: Names, theirs: Names, settled: bool) -> Iterator[tuple[Name, Name]]:
    """The names of things that the other reader calls otherwise, and of which one must be a slip: he uses the name for
    something else, the two differ in a letter, or all names are ``settled``."""
    used = {item.name for item in theirs.values()}
    for key, mine in own.items():
        other = theirs.get(key)
        if other is None or other.name == mine.name:
            continue
        if settled or mine.name in used or _is_slip(mine.name, other.name):
            yield mine, other


def _is_slip(one: str, other: str) -> bool:
    """Whether a letter is too many, missing or wrong, or two changed places."""
    if abs(len(one) - len(other)) > 1:
        return False
    start = _alike(one, other)
    end = _alike(one[start:][::-1], other[start:][::-1])
    here, there = one[start : len(one) - end], other[start : len(other) - end]
    return max(len(here), len(there)) < 2 or (len(here) == 2 and here == there[::-1])


def _alike(one: str, other: str) -> int:
    """How many characters two words have in common, from the first on."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
