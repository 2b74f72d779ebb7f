"""Compare interfaces with their frames and times, contacts, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, TypeVar

from ..model import Biss, Connector, ControlField, Interface, Layout, LayoutRange, Rs485, Timing
from .change import Change, Subject
from .compare import compare_members, compare_pair, compare_parts
from .family_pair import FamilyPair
from .pairs import both_of, by_key, paired
from .registers import layout
from .values import arrow, short_value


def interfaces(family_pair: FamilyPair) -> Iterator[Change]:
    for pair in paired(family_pair.old.interfaces, family_pair.new.interfaces):
        subject = Subject(f"interfaces.{pair.item.name}", pair.item.short, pair.item.name)
        yield from compare_pair(family_pair, "interface", subject, pair, _compare_interface)


def _compare_interface(family_pair: FamilyPair, subject: Subject, old: Interface, new: Interface) -> Iterator[Change]:
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from compare_members(family_pair, subject.inside("port", subject.label), old.port, new.port)
        yield from compare_parts(
            family_pair, "data-id", old.data_ids, new.data_ids, subject.inside("data_ids", "data ID")
        )
    elif not isinstance(new, Rs485) and not isinstance(old, Rs485):
        yield from compare_members(family_pair, subject.inside("clock", subject.label), old.clock, new.clock)
    if isinstance(old, Biss) and isinstance(new, Biss):
        control_subject = subject.inside("control_data", "control frame: field")
        yield from compare_parts(
            family_pair, "control-field", old.control_data, new.control_data, control_subject, _compare_control_values
        )
    yield from timings(family_pair, subject, old.timings, new.timings)
    yield from compare_parts(
        family_pair, "frame", old.layouts, new.layouts, subject.inside("layouts", "frame"), _compare_frame
    )


def _compare_frame(family_pair: FamilyPair, subject: Subject, old: Layout, new: Layout) -> Iterator[Change]:
    unnamed = subject.unnamed
    yield from layout(family_pair, unnamed, old, new)
    yield from _compare_position_range(family_pair, unnamed, old.position_range, new.position_range)
    old_decisions = {family_pair.to_new("decision", decision.name) for decision in family_pair.old.alternatives_of(old)}
    new_decisions = {decision.name for decision in family_pair.new.alternatives_of(new)}
    inner = unnamed.inside("alternatives", unnamed.label)
    for name in sorted(old_decisions - new_decisions):
        yield family_pair.change("frame-decision", inner, f": no longer needs the decision {name}", name, None)
    for name in sorted(new_decisions - old_decisions):
        yield family_pair.change("frame-decision", inner, f": needs the decision {name}", None, name)


def _compare_position_range(
    family_pair: FamilyPair, subject: Subject, old: LayoutRange | None, new: LayoutRange | None
) -> Iterator[Change]:
    """Compare the ranges of a position in one frame. Without its own range, a frame has that of the interface."""
    range_subject = subject.inside("position_range", f"{subject.label}: position range")
    if old is not None and new is not None:
        yield from compare_members(family_pair, range_subject, old, new)
    elif old is not new:
        yield from family_pair.presence("measurement", range_subject, old, new)


def _compare_control_values(
    family_pair: FamilyPair, subject: Subject, old: ControlField, new: ControlField
) -> Iterator[Change]:
    value_subject = replace(subject, label=f"control frame: {new.name}: value")
    yield from compare_parts(family_pair, "value", old.values, new.values, value_subject)


def timings(
    family_pair: FamilyPair, subject: Subject, old_parts: tuple[Timing, ...], new_parts: tuple[Timing, ...]
) -> Iterator[Change]:
    """Compare times of an interface or of the device."""
    yield from compare_parts(
        family_pair, "timing", old_parts, new_parts, subject.inside("timings", f"{subject.label} time".strip())
    )


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
