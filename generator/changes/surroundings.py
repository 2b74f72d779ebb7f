"""Compare contacts, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from ..model import Connector
from .change import Change, Subject
from .compare import compare_members
from .family_pair import FamilyPair
from .pairs import both_of, by_key, paired
from .value_text import arrow, short_value

_Part = TypeVar("_Part")
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


def contacts(family_pair: FamilyPair, subject: Subject, old: Connector, new: Connector) -> Iterator[Change]:
    """Compare the contacts of a connector."""
    old_contacts, new_contacts = _by_member(old.contacts, "contact"), _by_member(new.contacts, "contact")
    for contact, old_contact, new_contact in by_key(old_contacts, new_contacts):
        contact_subject = subject.inside(contact, f"{subject.label}: contact {contact}")
        if old_contact is not None and new_contact is not None:
            yield from compare_members(family_pair, contact_subject, old_contact, new_contact)
        else:
            old_signal = old_contact.signal if old_contact is not None else None
            new_signal = new_contact.signal if new_contact is not None else None
            description = f": signal {arrow(old_signal, new_signal)}"
            yield family_pair.change("contact", contact_subject, description, old_signal, new_signal)


def displayed(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare errata, examples, and facts that no code depends on."""
    for rule, section, identity, word in _DISPLAYED:
        old_parts = _by_member(getattr(family_pair.old, section), identity)
        new_parts = _by_member(getattr(family_pair.new, section), identity)
        for key, old, new in by_key(old_parts, new_parts):
            if old != new:
                description = _difference(old, new)
                yield family_pair.change(rule, Subject(f"{section}.{key}", f"{word} {key}"), description, old, new)
    for old_group, new_group in both_of(paired(family_pair.old.field_groups, family_pair.new.field_groups)):
        subject = Subject(f"field_groups.{new_group.name}", f"group {new_group.name}")
        yield from compare_members(family_pair, subject, old_group, new_group)


def _by_member(parts: Iterable[_Part], name: str) -> dict[Any, _Part]:
    """Return the parts by their member of this name."""
    return {getattr(part, name): part for part in parts}


def _difference(old: Any, new: Any) -> str:
    """Return the old and new value of a characteristic with a short text, or only that the item has changed."""
    if old is None:
        return " is new"
    if new is None:
        return " is gone"
    old_text, new_text = (short_value(getattr(part, "value", None)) for part in (old, new))
    return f": {old_text} → {new_text}" if old_text != new_text else " has changed"
