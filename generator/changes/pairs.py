"""Which item of an old list is which of a new one: by its name, else by what stays the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class Pair(Generic[_Item]):
    """Two items that are one; ``old`` or ``new`` is None for one that is new or gone."""

    old: _Item | None
    new: _Item | None


def pairs(
    olds: Sequence[_Item],
    news: Sequence[_Item],
    name: Callable[[_Item], Hashable],
    same_old: Callable[[_Item], Hashable | None],
    same_new: Callable[[_Item], Hashable | None],
) -> Iterator[Pair[_Item]]:
    """Every item with its counterpart: those that are there still or anew in their new order, then those that are gone.

    Args:
        olds: The items as they were.
        news: The items as they are.
        name: What an item is called.
        same_old: What stays the same of an old item whose name is gone; None for one that is known by its name alone.
        same_new: The same of a new item. A counterpart is one that no other item of its side is like.
    """
    known = {name(item): item for item in olds}
    left = [item for item in olds if name(item) not in {name(other) for other in news}]
    fresh = [item for item in news if name(item) not in known]
    marks = [same_new(item) for item in fresh]
    alike = _only(left, same_old)
    often = Counter(marks)
    renamed: dict[Hashable, _Item] = {
        name(item): alike[mark]
        for item, mark in zip(fresh, marks, strict=True)
        if mark is not None and often[mark] == 1 and mark in alike
    }
    for item in news:
        yield Pair(known.get(name(item), renamed.get(name(item))), item)
    taken = {name(item) for item in renamed.values()}
    yield from (Pair(item, None) for item in left if name(item) not in taken)


def _only(items: Sequence[_Item], same: Callable[[_Item], Hashable | None]) -> dict[Hashable, _Item]:
    """The items of which no other is like, by what stays the same of them."""
    marks = [same(item) for item in items]
    often = Counter(marks)
    return {mark: item for item, mark in zip(items, marks, strict=True) if mark is not None and often[mark] == 1}
