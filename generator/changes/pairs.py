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
        present = self.old if self.new is None else self.new
        assert present is not None
        return present

    @property
    def old_or_new(self) -> _Item:
        """The old item, or the new one if there was none."""
        return Pair(self.new, self.old).item


def both_of(pairs: Iterable[Pair[_Item]]) -> Iterator[tuple[_Item, _Item]]:
    """Yield the pairs that have both items."""
    yield from ((pair.old, pair.new) for pair in pairs if pair.old is not None and pair.new is not None)


def paired(
    old_parts: Sequence[_Item],
    new_parts: Sequence[_Item],
    identity: Key = lambda _: None,
    new_identity: Key | None = None,
    name: Key = name_of,
) -> list[Pair[_Item]]:
    """Return every item with its counterpart: first the new items in their order, then those that are gone.

    Args:
        old_parts: The old items.
        new_parts: The new items.
        identity: Return the property that identifies an old item whose name is gone, or None if only the name does.
            Default: only the name.
        new_identity: Return that property of a new item, if it is computed in another way. It identifies a counterpart
            only if it is unique on its side.
        name: Return the name of an item.
    """
    counterparts = {name(part): part for part in old_parts}
    old_names = set(counterparts)
    new_names = {name(part) for part in new_parts}
    old_by_identity = _unique([part for part in old_parts if name(part) not in new_names], identity)
    new_by_identity = _unique([part for part in new_parts if name(part) not in old_names], new_identity or identity)
    matched_names = set(new_names)
    for key, new_part in new_by_identity.items():
        if key in old_by_identity:
            counterparts[name(new_part)] = old_by_identity[key]
            matched_names.add(name(old_by_identity[key]))
    pairs = [Pair(counterparts.get(name(part)), part) for part in new_parts]
    return pairs + [Pair(part, None) for part in old_parts if name(part) not in matched_names]


def _unique(items: Sequence[_Item], identity: Key) -> dict[Hashable, _Item]:
    """Return the items with a unique identifying property, by that property."""
    keys = [identity(part) for part in items]
    counts = Counter(keys)
    return {key: part for part, key in zip(items, keys, strict=True) if key is not None and counts[key] == 1}


def by_key(
    first: Mapping[_Key, _Item], second: Mapping[_Key, _Item]
) -> Iterator[tuple[_Key, _Item | None, _Item | None]]:
    """Yield every key with its item on both sides: first the keys of one side in their order, then the others."""
    yield from ((key, first.get(key), second.get(key)) for key in dict.fromkeys((*first, *second)))
