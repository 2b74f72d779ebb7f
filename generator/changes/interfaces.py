"""Compare interfaces with their frames, clocks and times, connectors, and facts without effect on code."""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from ..model import (
    Biss,
    Characteristic,
    Clock,
    Clocked,
    Connector,
    ControlField,
    DataChannels,
    Interface,
    Layout,
    LayoutRange,
    Rs485,
    Ssi,
    Timeout,
    Timing,
)
from ..model.members import ModelMember
from ..model.order_codes import repeated_names
from .compare import compare_member, compare_members, compare_pair, compare_parts
from .consequences import without_explained_lengths
from .family_pair import FamilyPair, complete_pairs, keys_with_old_and_new, pair_by_name
from .layouts_and_procedures import compare_layout
from .rules import Change, ChangeSubject
from .values import old_to_new, short_value


def compare_interfaces(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield the changes of all interfaces: new and removed interfaces, and changes within those in both versions."""
    for pair in pair_by_name(family_pair.old.interfaces, family_pair.new.interfaces):
        subject = ChangeSubject(
            path=f"interfaces.{pair.new_or_old.name}", label=pair.new_or_old.short, interface=pair.new_or_old.name
        )
        yield from compare_pair(family_pair, "interface", subject, pair, _compare_interface)


def _compare_rs485(family_pair: FamilyPair, subject: ChangeSubject, old: Rs485, new: Rs485) -> Iterator[Change]:
    """Yield changes of the port and of the data IDs."""
    port_subject = subject.inside("port", subject.label)
    yield from compare_members(family_pair, port_subject, old.port, new.port)
    yield from compare_parts(
        family_pair,
        part_kind="data-id",
        old_parts=old.data_ids,
        new_parts=new.data_ids,
        section_subject=subject.inside("data_ids", "data ID"),
    )


def _compare_biss(family_pair: FamilyPair, subject: ChangeSubject, old: Biss, new: Biss) -> Iterator[Change]:
    """Yield changes of the timeout, the data channels and the control frame, but not of the clock."""
    yield from compare_timeouts(family_pair, subject.inside("timeout", subject.label), old, new)
    yield from _compare_channels(family_pair, subject, old.channels, new.channels)
    yield from compare_parts(
        family_pair,
        part_kind="control-field",
        old_parts=old.control_data,
        new_parts=new.control_data,
        section_subject=subject.inside("control_data", "control frame: field"),
        compare_content=_compare_control_values,
    )


def _compare_interface(
    family_pair: FamilyPair, subject: ChangeSubject, old: Interface, new: Interface
) -> Iterator[Change]:
    """Yield changes of the port or clock, data IDs, control frame, timings and frames of an interface.

    RS-485 has a port and data IDs. The other interfaces have a clock, and BiSS also has a control frame. A changed
    length of a frame is left out if a resized field explains it.
    """
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from _compare_rs485(family_pair, subject, old, new)
    elif isinstance(new, Clocked) and isinstance(old, Clocked):
        yield from compare_clocks(family_pair, subject.inside("clock", subject.label), old, new)
    if isinstance(old, Ssi) and isinstance(new, Ssi):
        yield from compare_cables(family_pair, subject.inside("cable_lengths", subject.label), old, new)
    if isinstance(old, Biss) and isinstance(new, Biss):
        yield from _compare_biss(family_pair, subject, old, new)
    yield from compare_timings(family_pair, subject, old.timings, new.timings)
    frame_subject = subject.inside("layouts", "frame")
    frame_changes = compare_parts(
        family_pair,
        part_kind="frame",
        old_parts=old.layouts,
        new_parts=new.layouts,
        section_subject=frame_subject,
        compare_content=_compare_frame,
    )
    yield from without_explained_lengths(list(frame_changes))


def _compare_frame(family_pair: FamilyPair, subject: ChangeSubject, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield changes of the fields and the position range of a frame, and of the decisions that users must make for it.

    Users must decide where the manual leaves open which of several alternatives a frame contains. Renamed decisions do
    not count as changes.
    """
    # The names of the frame in code stay the same, so the changes do not list them.
    subject = subject.unnamed
    yield from compare_layout(family_pair, subject, old, new)
    yield from _compare_position_range(family_pair, subject, old.position_range, new.position_range)
    old_alternatives = family_pair.old.alternatives_of(old)
    new_alternatives = family_pair.new.alternatives_of(new)
    old_decisions = {family_pair.to_new_names("decision", alternative.name) for alternative in old_alternatives}
    new_decisions = {alternative.name for alternative in new_alternatives}
    decision_subject = subject.inside("alternatives", subject.label)
    for decision in sorted(old_decisions - new_decisions):
        description = f": no longer needs the decision {decision}"
        yield family_pair.change("frame-decision", decision_subject, description=description, old=decision, new=None)
    for decision in sorted(new_decisions - old_decisions):
        description = f": needs the decision {decision}"
        yield family_pair.change("frame-decision", decision_subject, description=description, old=None, new=decision)


def _compare_position_range(
    family_pair: FamilyPair, subject: ChangeSubject, old: LayoutRange | None, new: LayoutRange | None
) -> Iterator[Change]:
    """Yield changes of the range of the positions that a frame can contain.

    None means that the frame has no range of its own, so the range of its interface applies. If only one version has a
    separate range, this is the change.
    """
    range_subject = subject.inside("position_range", f"{subject.label}: position range")
    if old is not None and new is not None:
        yield from compare_members(family_pair, range_subject, old, new)
    elif old is not None or new is not None:
        yield from family_pair.compare_presence("measurement", range_subject, old=old, new=new)


def _compare_channels(
    family_pair: FamilyPair, subject: ChangeSubject, old: DataChannels | None, new: DataChannels | None
) -> Iterator[Change]:
    """Yield changes of a frame with several data channels, or the change that only one version has such a frame."""
    channels_subject = subject.inside("channels", f"{subject.label}: frame with several data channels")
    if old is not None and new is not None:
        yield from compare_members(family_pair, channels_subject, old, new)
    elif old is not None or new is not None:
        yield from family_pair.compare_presence("channels", channels_subject, old=old, new=new)


def _compare_control_values(
    family_pair: FamilyPair, subject: ChangeSubject, old: ControlField, new: ControlField
) -> Iterator[Change]:
    """Yield the changes of the values that a field of the BiSS control frame can have."""
    value_subject = replace(subject, label=f"control frame: {new.name}: value")
    yield from compare_parts(
        family_pair, part_kind="value", old_parts=old.values, new_parts=new.values, section_subject=value_subject
    )


def compare_timings(
    family_pair: FamilyPair, subject: ChangeSubject, old_timings: tuple[Timing, ...], new_timings: tuple[Timing, ...]
) -> Iterator[Change]:
    """Yield changes of the times that an interface specifies, or the device if the label of ``subject`` is empty.

    A name that several times share, each for other order codes, is first extended by the order codes.
    """
    timing_label = f"{subject.label} time".strip()  # The device itself has no label.
    timing_subject = subject.inside("timings", timing_label)
    shared_names = repeated_names(old_timings) | repeated_names(new_timings)
    yield from compare_parts(
        family_pair,
        part_kind="timing",
        old_parts=with_distinct_names(old_timings, shared_names),
        new_parts=with_distinct_names(new_timings, shared_names),
        section_subject=timing_subject,
    )


# -- facts that may depend on the order code: clocks, timeouts, clocks by cable length, and names of times

_Named = TypeVar("_Named", Characteristic, Timing)
#: The timeout in descriptions of changes.
_TIMEOUT_MEMBER = ModelMember("timeout", rule="interface-rule", label="timeout")


def compare_clocks(family_pair: FamilyPair, subject: ChangeSubject, old: Clocked, new: Clocked) -> Iterator[Change]:
    """Yield changes of the limits of the clock. Order codes with the same old and new clock share a change.

    ``clock`` of an interface is None if the clock depends on the order code. Each clock then lists in ``only`` the
    order codes that it applies to.
    """
    if old.clock is not None and new.clock is not None:
        yield from compare_members(family_pair, subject, old.clock, new.clock)
        return
    if old.clock is not new.clock:
        yield _change_of_code_dependence(family_pair, subject, "clock", depends_on_code=new.clock is None)
    codes_by_clocks: dict[tuple[Clock, Clock], list[str]] = {}
    for code in family_pair.order_codes_with_interface(new.name):
        old_clock = old.clock_of(family_pair.old_code(code))
        new_clock = new.clock_of(code)
        # The lists of order codes are removed, so that equal clocks compare as equal.
        clocks = replace(old_clock, only=""), replace(new_clock, only="")
        codes_by_clocks.setdefault(clocks, []).append(code)
    for (old_clock, new_clock), codes in codes_by_clocks.items():
        for change in compare_members(family_pair, subject, old_clock, new_clock):
            yield family_pair.limited_to_codes(change, codes)


def compare_timeouts(family_pair: FamilyPair, subject: ChangeSubject, old: Biss, new: Biss) -> Iterator[Change]:
    """Yield changes of the BiSS timeout. Order codes with the same old and new timeout share a change."""
    depended_on_code = bool(old.timeouts_by_code)
    depends_on_code = bool(new.timeouts_by_code)
    if not depended_on_code and not depends_on_code:
        yield from compare_member(family_pair, subject, _TIMEOUT_MEMBER, old.timeout, new.timeout)
        return
    if depended_on_code != depends_on_code:
        yield _change_of_code_dependence(family_pair, subject, "timeout", depends_on_code=depends_on_code)
    codes_by_timeouts: dict[tuple[Timeout | None, Timeout | None], list[str]] = {}
    for code in family_pair.order_codes_with_interface(new.name):
        old_timeout = _without_order_codes(old.timeout_of(family_pair.old_code(code)))
        new_timeout = _without_order_codes(new.timeout_of(code))
        codes_by_timeouts.setdefault((old_timeout, new_timeout), []).append(code)
    for (old_timeout, new_timeout), codes in codes_by_timeouts.items():
        for change in compare_member(family_pair, subject, _TIMEOUT_MEMBER, old_timeout, new_timeout):
            yield family_pair.limited_to_codes(change, codes)


def compare_cables(family_pair: FamilyPair, subject: ChangeSubject, old: Ssi, new: Ssi) -> Iterator[Change]:
    """Yield a change if the table of clocks by cable length depends on the order code in only one version.

    It depends on the order code if a row of the table lists, in ``only``, the order codes that it applies to.
    """
    depended_on_code = any(row.only for row in old.cable_lengths)
    depends_on_code = any(row.only for row in new.cable_lengths)
    if depended_on_code != depends_on_code:
        yield _change_of_code_dependence(family_pair, subject, "clock by cable", depends_on_code=depends_on_code)


def _change_of_code_dependence(
    family_pair: FamilyPair, subject: ChangeSubject, noun: str, *, depends_on_code: bool
) -> Change:
    """Return the change that a fact depends on the order code in only one version.

    ``depends_on_code`` is true if it depends on the order code in the new version. ``noun`` names the fact.
    """
    if depends_on_code:
        old, new = "all order codes", "some order codes"
    else:
        old, new = "some order codes", "all order codes"
    return family_pair.change("facts-by-code", subject, description=f": {noun} of {old} → {new}", old=old, new=new)


def _without_order_codes(timeout: Timeout | None) -> Timeout | None:
    """Return a timeout without the list of order codes that it applies to, so that equal timeouts compare as equal."""
    return replace(timeout, only="") if timeout is not None else None


def with_distinct_names(facts: Sequence[_Named], shared_names: Container[str]) -> tuple[_Named, ...]:
    """Return the facts with distinct names: ``pause, X-24`` for a pause that applies to the order code X-24.

    Names in ``shared_names`` belong to several facts, each of which applies to other order codes, listed in ``only``.
    """
    facts_with_distinct_names: list[_Named] = []
    for fact in facts:
        name = f"{fact.name}, {fact.only}" if fact.name in shared_names else fact.name
        facts_with_distinct_names.append(replace(fact, name=name))
    return tuple(facts_with_distinct_names)


# -- contacts of connectors, and facts without effect on code

_Part = TypeVar("_Part")
#: Sections without effect on code: rule, member of the device, member that identifies each item, and word in texts.
_DISPLAYED_SECTIONS = (
    ("erratum", "errata", "name", "erratum"),
    ("example", "examples", "name", "example"),
    ("told", "characteristics", "name", "characteristic"),
    ("told", "tables", "name", "table"),
    ("told", "leds", "name", "light"),
    ("told", "documents", "key", "document"),
    ("told", "lost_figures", "content", "lost figure"),
)


def compare_contacts(
    family_pair: FamilyPair, subject: ChangeSubject, old: Connector, new: Connector
) -> Iterator[Change]:
    """Yield changes of the contacts of a connector, for the order codes with one of its interfaces.

    Two contacts whose signals were exchanged are one change.
    """
    codes: list[str] = []
    for interface in new.interfaces or ("",):  # Without interfaces, it is for all of them.
        codes += family_pair.order_codes_with_interface(interface)
    exchanged_pairs = _exchanged_contacts(old, new)
    exchanged_contacts = {contact for pair in exchanged_pairs for contact in pair}
    changes = list(_compare_each_contact(family_pair, subject, old, new, exchanged_contacts))
    for first_contact, second_contact in exchanged_pairs:
        signals = {contact.contact: contact.signal for contact in new.contacts}
        first_signal, second_signal = signals[first_contact], signals[second_contact]
        contact_subject = subject.inside(
            first_contact, f"{subject.label}: contacts {first_contact} and {second_contact}"
        )
        changes.append(
            family_pair.change(
                "contact",
                contact_subject,
                description=f": signals {second_signal} and {first_signal} exchanged",
                old=second_signal,
                new=first_signal,
            )
        )
    for change in changes:
        yield family_pair.limited_to_codes(change, codes)


def _exchanged_contacts(old: Connector, new: Connector) -> list[tuple[str, str]]:
    """Return each pair of contacts of which each one carries in the new version the old signal of the other one."""
    old_signals = {contact.contact: contact.signal for contact in old.contacts}
    # Contacts by their old and new signal, if these differ.
    contact_by_signals: dict[tuple[str, str], str] = {}
    pairs: list[tuple[str, str]] = []
    for contact in new.contacts:
        old_signal = old_signals.get(contact.contact, contact.signal)
        if old_signal == contact.signal:
            continue
        other_contact = contact_by_signals.pop((contact.signal, old_signal), None)
        if other_contact is None:
            contact_by_signals[old_signal, contact.signal] = contact.contact
        else:
            pairs.append((other_contact, contact.contact))
    return pairs


def _compare_each_contact(
    family_pair: FamilyPair, subject: ChangeSubject, old: Connector, new: Connector, exchanged_contacts: Collection[str]
) -> Iterator[Change]:
    """Yield changes of the contacts of a connector, but not of contacts that were exchanged.

    A contact is identified by its pin or wire color. If only the old version has it, the text is ``signal SL → none``,
    and if only the new version has it, ``signal none → SL``.
    """
    old_contacts, new_contacts = _part_by_member(old.contacts, "contact"), _part_by_member(new.contacts, "contact")
    for contact, old_contact, new_contact in keys_with_old_and_new(old_contacts, new_contacts):
        if contact in exchanged_contacts:
            continue
        contact_subject = subject.inside(contact, f"{subject.label}: contact {contact}")
        if old_contact is not None and new_contact is not None:
            yield from compare_members(family_pair, contact_subject, old_contact, new_contact)
        else:
            old_signal = old_contact.signal if old_contact is not None else None
            new_signal = new_contact.signal if new_contact is not None else None
            description = f": signal {old_to_new(old_signal, new_signal)}"
            yield family_pair.change(
                "contact", contact_subject, description=description, old=old_signal, new=new_signal
            )


def compare_displayed_facts(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield changes of facts that no code depends on, such as errata and characteristics, and of field groups.

    There is one change for each erratum, example, characteristic and so on that is new, gone or different.
    """
    for rule, section, key_member, noun in _DISPLAYED_SECTIONS:
        old_section, new_section = getattr(family_pair.old, section), getattr(family_pair.new, section)
        # Characteristics for different order codes may have the same name.
        if section == "characteristics":
            shared_names = repeated_names(old_section) | repeated_names(new_section)
            old_section = with_distinct_names(old_section, shared_names)
            new_section = with_distinct_names(new_section, shared_names)
        old_parts, new_parts = _part_by_member(old_section, key_member), _part_by_member(new_section, key_member)
        for key, old, new in keys_with_old_and_new(old_parts, new_parts):
            if old != new:
                subject = ChangeSubject(path=f"{section}.{key}", label=f"{noun} {key}")
                yield family_pair.change(rule, subject, description=_describe_difference(old, new), old=old, new=new)
    for old_group, new_group in complete_pairs(
        pair_by_name(family_pair.old.field_groups, family_pair.new.field_groups)
    ):
        subject = ChangeSubject(path=f"field_groups.{new_group.name}", label=f"group {new_group.name}")
        yield from compare_members(family_pair, subject, old_group, new_group)


def _part_by_member(parts: Iterable[_Part], member_name: str) -> dict[Any, _Part]:
    """Return the parts by the value of their member ``member_name``, such as ``contact`` or ``key``."""
    return {getattr(part, member_name): part for part in parts}


def _describe_difference(old: Any, new: Any) -> str:
    """Describe the difference between an old and a new fact, of which one may be None.

    The text is `` is new``, `` is gone``, or ``: 5 V → 12 V`` for a characteristic with a different value. For any
    other difference, it is `` has changed``.
    """
    if old is None:
        return " is new"
    if new is None:
        return " is gone"
    old_text = short_value(getattr(old, "value", None))
    new_text = short_value(getattr(new, "value", None))
    if old_text == new_text:
        return " has changed"
    return f": {old_text} → {new_text}"
