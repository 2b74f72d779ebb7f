"""Compare contacts, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..model import Connector
from .change import Change, Thing
from .compare import members
from .family_pair import FamilyPair
from .pairs import both_of, by_key, paired
from .value_text import arrow, shown

#: Sections without effect on code: the rule, the member of the family, the member that identifies an item, and a word.
_DISPLAYED = (
    ("erratum", "errata", "name", "erratum"),
    ("example", "examples", "name", "example"),
    ("told", "characteristics", "name", "characteristic"),
    ("told", "tables", "name", "table"),
    ("told", "leds", "name", "light"),
    ("told", "documents", "key", "document"),
    ("told", "lost_figures", "content", "lost figure"),
)


def contacts(both: FamilyPair, thing: Thing, old: Connector, new: Connector) -> Iterator[Change]:
    """Compare the contacts of a connector."""
    olds, news = ({item.contact: item for item in each.contacts} for each in (old, new))
    for contact, before, after in by_key(olds, news):
        place = thing.inside(contact, f"{thing.label}: contact {contact}")
        if before is not None and after is not None:
            yield from members(both, place, before, after)
        else:
            was, now = (item.signal if item is not None else None for item in (before, after))
            yield both.change("contact", place, f": signal {arrow(was, now)}", was, now)


def displayed(both: FamilyPair) -> Iterator[Change]:
    """Compare errata, examples, and facts that no code depends on."""
    for rule, section, identity, word in _DISPLAYED:
        olds, news = (
            {getattr(item, identity): item for item in getattr(each, section)} for each in (both.old, both.new)
        )
        for key, old, new in by_key(olds, news):
            if old != new:
                how = " is new" if old is None else " is gone" if new is None else _changed(old, new)
                yield both.change(rule, Thing(f"{section}.{key}", f"{word} {key}"), how, old, new)
    for before, after in both_of(paired(both.old.field_groups, both.new.field_groups)):
        yield from members(both, Thing(f"field_groups.{after.name}", f"group {after.name}"), before, after)


def _changed(old: Any, new: Any) -> str:
    """Return the old and new value of a characteristic with a short text, or only that the item has changed."""
    before, after = (shown(getattr(item, "value", None)) for item in (old, new))
    return f": {before} → {after}" if before != after else " has changed"
