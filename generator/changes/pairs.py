"""Pair the items of an old and a new list by name, or by a property that stays the same.

``diff`` pairs the things of two versions of a spec, and ``check`` the facts of two readings of a manual.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, Generic, TypeVar

_Item = TypeVar("_Item")
_Key = TypeVar("_Key", bound=Hashable)
Key = Callable[[Any], Hashable | None]
name_of: Callable[[Any], str] = attrgetter("name")


@dataclass(frozen=True, slots=True)
class Pair(Generic[_Item]):
    """An old item and its new counterpart. ``old`` is None for a new one, ``new`` for one that is gone."""

    old: _Item | None
    new: _Item | None

    @property
    def item(self) -> _Item:
        """The new item, or the old one if it is gone."""
        found = self.old if self.new is None else self.new
        assert found is not None
        return found

    @property
    def first(self) -> _Item:
        """The old item, or the new one if there was none."""
        return Pair(self.new, self.old).item


def both_of(pairs: Iterable[Pair[_Item]]) -> Iterator[tuple[_Item, _Item]]:
    """Yield the pairs that have both items."""
    yield from ((pair.old, pair.new) for pair in pairs if pair.old is not None and pair.new is not None)


def paired(
    olds: Sequence[_Item],
    news: Sequence[_Item],
    same: Key = lambda _: None,
    same_new: Key | None = None,
    name: Key = name_of,
) -> list[Pair[_Item]]:
    """Return every item with its counterpart: first the new items in their order, then those that are gone.

    Args:
        olds: The old items.
        news: The new items.
        same: Return the property that identifies an old item whose name is gone, or None if only the name does.
            Default: only the name.
        same_new: Return that property of a new item, if it is computed in another way. It identifies a counterpart only
            if it is unique on its side.
        name: Return the name of an item.
    """
    known = {name(item): item for item in olds}
    names = {name(item) for item in news}
    left = _unique([item for item in olds if name(item) not in names], same)
    fresh = _unique([item for item in news if name(item) not in known], same_new or same)
    renamed = {name(item): left[mark] for mark, item in fresh.items() if mark in left}
    taken = {name(item) for item in renamed.values()} | names
    found = [Pair(known.get(name(item), renamed.get(name(item))), item) for item in news]
    return found + [Pair(item, None) for item in olds if name(item) not in taken]


def _unique(items: Sequence[_Item], same: Key) -> dict[Hashable, _Item]:
    """Return the items with a unique identifying property, by that property."""
    marks = [same(item) for item in items]
    often = Counter(marks)
    return {mark: item for item, mark in zip(items, marks, strict=True) if mark is not None and often[mark] == 1}


def by_key(
    first: Mapping[_Key, _Item], second: Mapping[_Key, _Item]
) -> Iterator[tuple[_Key, _Item | None, _Item | None]]:
    """Yield every key with its item on both sides: first the keys of one side in their order, then the others."""
    yield from ((key, first.get(key), second.get(key)) for key in dict.fromkeys((*first, *second)))
