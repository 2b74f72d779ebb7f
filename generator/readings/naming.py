"""Names: each reader gives his own, but one that both give means one thing, and none is a slip of the other's."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import takewhile

from .fact import Name, Names


def mistaken(own: Names, theirs: Names) -> Iterator[tuple[Name, Name]]:
    """The names of things that the other reader calls otherwise, and of which one must be a slip: he uses the name for
    something else, or the two differ in a letter."""
    used = {item.name for item in theirs.values()}
    for key, mine in own.items():
        other = theirs.get(key)
        if other is not None and other.name != mine.name and (mine.name in used or _is_slip(mine.name, other.name)):
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
