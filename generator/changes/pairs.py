"""Pair the items of an old and a new list by name, or by a property that stays the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class Pair(Generic[_Item]):
    """An old item and its new counterpart. ``old`` is None for a new one, ``new`` for one that is gone."""

    old: _Item | None
    new: _Item | None


def pairs(
    olds: Sequence[_Item],
    news: Sequence[_Item],
    name: Callable[[_Item], Hashable],
    same_old: Callable[[_Item], Hashable | None],
    same_new: Callable[[_Item], Hashable | None],
) -> Iterator[Pair[_Item]]:
    """Yield every item with its counterpart: first the new items in their order, then those that are gone.

    Args:
        olds: The old items.
        news: The new items.
        name: Return the name of an item.
        same_old: Return the property that identifies an old item whose name is gone, or None if only the name does.
        same_new: Return that property of a new item. It identifies a counterpart only if it is unique on its side.
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
    """Return the items with a unique identifying property, by that property."""
    marks = [same(item) for item in items]
    often = Counter(marks)
    return {mark: item for item, mark in zip(items, marks, strict=True) if mark is not None and often[mark] == 1}
