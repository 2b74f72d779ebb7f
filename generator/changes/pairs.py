"""Pair the items of an old and a new list by name, or by a property that stays the same.

``diff`` pairs the parts of two versions of a spec, and ``check`` pairs the facts of two readings of a manual.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, Generic, TypeVar

_Item = TypeVar("_Item")
_Key = TypeVar("_Key", bound=Hashable)
#: Return the name or another identifying property of an item.
PairingKey = Callable[[Any], Hashable | None]
_name_of: Callable[[Any], str] = attrgetter("name")


@dataclass(frozen=True, slots=True)
class OldAndNew(Generic[_Item]):
    """An old item and its new counterpart. ``old`` is None for a new item, ``new`` for an item that is gone."""

    old: _Item | None
    new: _Item | None

    @property
    def new_or_old(self) -> _Item:
        """The new item, or the old one if it is gone."""
        item = self.old if self.new is None else self.new
        assert item is not None
        return item

    @property
    def old_or_new(self) -> _Item:
        """The old item, or the new one if there was none."""
        item = self.new if self.old is None else self.old
        assert item is not None
        return item


def complete_pairs(pairs: Iterable[OldAndNew[_Item]]) -> Iterator[tuple[_Item, _Item]]:
    """Yield the old and the new item of each pair that has both."""
    for pair in pairs:
        if pair.old is not None and pair.new is not None:
            yield pair.old, pair.new


def pair_by_name(
    old_items: Sequence[_Item],
    new_items: Sequence[_Item],
    identity_of_old: PairingKey = lambda _: None,
    identity_of_new: PairingKey | None = None,
    *,
    name_of: PairingKey = _name_of,
) -> list[OldAndNew[_Item]]:
    """Return every item with its counterpart: first the new items in their order, then the items that are gone.

    Items with the same name are a pair. The other items are paired by their identity, a property that stays the same
    when an item is renamed. An old and a new item are a pair if they have the same identity, and no other unpaired item
    of the same version has it.

    Args:
        old_items: The old items.
        new_items: The new items.
        identity_of_old: Returns the identity of an old item, or None if only its name identifies it. By default, all
            items are identified only by their names.
        identity_of_new: Returns the identity of a new item. By default, it is computed as for old items.
        name_of: Returns the name of an item.
    """
    # The old item that corresponds to each name. Below, renamed items are added under their new names.
    old_item_by_name = {name_of(old_item): old_item for old_item in old_items}
    old_names = set(old_item_by_name)
    new_names = {name_of(new_item) for new_item in new_items}
    without_new_name = [old_item for old_item in old_items if name_of(old_item) not in new_names]
    without_old_name = [new_item for new_item in new_items if name_of(new_item) not in old_names]
    old_by_identity = _by_unique_identity(without_new_name, identity_of_old)
    new_by_identity = _by_unique_identity(without_old_name, identity_of_new or identity_of_old)
    paired_old_names = set(new_names)
    for identity, new_item in new_by_identity.items():
        if identity in old_by_identity:
            renamed_item = old_by_identity[identity]
            old_item_by_name[name_of(new_item)] = renamed_item
            paired_old_names.add(name_of(renamed_item))
    new_pairs = [OldAndNew(old=old_item_by_name.get(name_of(new_item)), new=new_item) for new_item in new_items]
    gone_items = [old_item for old_item in old_items if name_of(old_item) not in paired_old_names]
    return new_pairs + [OldAndNew(old=gone_item, new=None) for gone_item in gone_items]


def _by_unique_identity(items: Sequence[_Item], identity_of: PairingKey) -> dict[Hashable, _Item]:
    """Return the items by their identities, without items that have no identity or share it with another item."""
    identities = [identity_of(item) for item in items]
    counts = Counter(identities)
    items_by_identity: dict[Hashable, _Item] = {}
    for identity, item in zip(identities, items, strict=True):
        if identity is not None and counts[identity] == 1:
            items_by_identity[identity] = item
    return items_by_identity


def match_by_key(
    old_by_key: Mapping[_Key, _Item], new_by_key: Mapping[_Key, _Item]
) -> Iterator[tuple[_Key, _Item | None, _Item | None]]:
    """Yield every key with its old and new item: ``("pin 1", old_contact, None)`` for an item that is gone.

    The keys of the old items come first, then the keys that are new.
    """
    for key in dict.fromkeys((*old_by_key, *new_by_key)):
        yield key, old_by_key.get(key), new_by_key.get(key)
