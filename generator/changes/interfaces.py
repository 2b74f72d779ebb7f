"""Compare interfaces with their frames, fields and times, registers, procedures, and facts without effect on code."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from ..model import (
    Argument,
    Biss,
    Clocked,
    Connector,
    ControlField,
    DataChannels,
    Interface,
    Layout,
    LayoutRange,
    Procedure,
    Register,
    Rs485,
    Sources,
    Ssi,
    Step,
    Timing,
)
from ..model.members import PARTS_BY_CLASS
from ..model.order_codes import repeated_names
from ..say.register import describe_access
from .compare import compare_members, compare_pair, compare_parts
from .consequences import without_explained_lengths
from .counterparts import step_with_new_names, step_without_words
from .facts_by_code import compare_cables, compare_clocks, compare_timeouts, with_distinct_names
from .family_pair import FamilyPair
from .layouts import compare_layout
from .pairs import complete_pairs, match_by_key, pair_by_name
from .rules import Change, ChangeSubject
from .values import as_plain_data, old_to_new, short_value

_CAN_READ, _CAN_WRITE = ("read_only", "read_write"), ("write_only", "read_write")


def compare_register(family_pair: FamilyPair, subject: ChangeSubject, old: Register, new: Register) -> Iterator[Change]:
    """Yield changes of the access, the meanings and the bits of a register. The caller compares its other members.

    If only the bits change, the names of the register in code stay the same, so such a change does not list them.
    """
    yield from _compare_access(family_pair, subject, old, new)
    meaning_subject = replace(subject, label=f"{subject.label}: meaning")
    yield from compare_parts(
        family_pair,
        part_kind="meaning",
        old_parts=old.meanings,
        new_parts=new.meanings,
        section_subject=meaning_subject,
    )
    # All other members of the layout follow from the register, which the caller compares.
    old_layout = replace(new.layout, fields=old.layout.fields, joins=old.layout.joins, gaps=old.layout.gaps)
    yield from compare_members(family_pair, subject.unnamed, old_layout, new.layout)
    yield from compare_layout(family_pair, subject.unnamed, old_layout, new.layout)


def _compare_access(family_pair: FamilyPair, subject: ChangeSubject, old: Register, new: Register) -> Iterator[Change]:
    """Yield a change if the access to a register differs.

    The rule is "access-lost" if the register can no longer be read or can no longer be written, and otherwise
    "access-gained".
    """
    if old.access == new.access:
        return
    is_read_lost = old.access in _CAN_READ and new.access not in _CAN_READ
    is_write_lost = old.access in _CAN_WRITE and new.access not in _CAN_WRITE
    access_subject = subject.inside("access", subject.label)
    description = f": {describe_access(old)} → {describe_access(new)}"
    if is_read_lost or is_write_lost:
        rule = "access-lost"
    else:
        # The functions of a register that is still accessible as before keep their names.
        rule = "access-gained"
        access_subject = access_subject.unnamed
    yield family_pair.change(rule, access_subject, description=description, old=old.access, new=new.access)


def compare_procedure(
    family_pair: FamilyPair, subject: ChangeSubject, old: Procedure, new: Procedure
) -> Iterator[Change]:
    """Yield a change if the arguments of a procedure differ, and a change if its steps differ.

    The change of the steps is about what they do. If that is the same, it is about their descriptions, and if these are
    the same too, about their citations. A renamed register or field does not count as a change of the steps.
    """
    yield from _compare_arguments(family_pair, subject.inside("arguments", subject.label), old, new)
    steps_subject = subject.unnamed.inside("steps", subject.label)
    old_steps = [step_with_new_names(family_pair, step) for step in old.steps]
    new_steps = [step_without_words(step) for step in new.steps]
    if old_steps != new_steps:
        description = _describe_steps(old_steps, new_steps)
        yield family_pair.change(
            "procedure-steps", steps_subject, description=description, old=old_steps, new=new_steps
        )
    elif _list_meanings(old.steps) != _list_meanings(new.steps):
        yield family_pair.change("words", steps_subject, description=": steps", old=old.steps, new=new.steps)
    elif _list_sources(old.steps) != _list_sources(new.steps):
        yield family_pair.change("source", steps_subject, description=": steps", old=None, new=None)


def _compare_arguments(
    family_pair: FamilyPair, subject: ChangeSubject, old: Procedure, new: Procedure
) -> Iterator[Change]:
    """Yield a change if the arguments of a procedure differ in names, registers or units, or only in descriptions."""
    old_arguments = _describe_arguments(map(family_pair.with_new_names, old.arguments))
    new_arguments = _describe_arguments(new.arguments)
    if old_arguments != new_arguments:
        old_texts, new_texts = _argument_names(old), _argument_names(new)
        if old_texts == new_texts:
            # The names are the same, so the register that takes an argument differs, or the unit of the argument.
            old_texts, new_texts = _argument_texts(old_arguments), _argument_texts(new_arguments)
        yield family_pair.change(
            "procedure-arguments",
            subject,
            description=f": arguments {old_to_new(old_texts, new_texts)}",
            old=old_arguments,
            new=new_arguments,
        )
    elif _list_meanings(old.arguments) != _list_meanings(new.arguments):
        yield family_pair.change(
            "words", subject.unnamed, description=": arguments", old=old.arguments, new=new.arguments
        )


def _argument_names(procedure: Procedure) -> list[str]:
    return [argument.name for argument in procedure.arguments]


def _describe_arguments(arguments: Iterable[Argument]) -> list[tuple[str, str, str]]:
    """Return a tuple for each argument: its name, the register or field that takes it, and what the number counts.

    For example ``("position", "preset", "counts")``, with "" as the last item if the spec does not say what it counts.
    """
    return [(argument.name, argument.of, argument.meant_as) for argument in arguments]


def _argument_texts(arguments: list[tuple[str, str, str]]) -> list[str]:
    """Return a text for each argument of a procedure, such as ``position for preset as counts``."""
    argument_texts = []
    for argument_name, register_or_field, meaning in arguments:
        name_and_target = f"{argument_name} for {register_or_field}"
        argument_texts.append(f"{name_and_target} as {meaning}" if meaning else name_and_target)
    return argument_texts


def _list_meanings(arguments_or_steps: Sequence[Argument | Step]) -> list[str]:
    return [part.meaning for part in arguments_or_steps]


def _list_sources(steps: Sequence[Step]) -> list[Sources]:
    return [step.source for step in steps]


def _describe_steps(old_steps: list[Step], new_steps: list[Step]) -> str:
    """Describe how the steps of a procedure differ, such as ``: steps 2, 3: pause 5 ms → 10 ms``.

    If the steps differ in several ways, the text is ``: steps 2, 3 differ``. If their number differs, it is
    ``: 4 steps → 5 steps``.
    """
    if len(old_steps) != len(new_steps):
        return f": {len(old_steps)} steps → {len(new_steps)} steps"
    step_numbers: list[str] = []
    differences: set[str] = set()
    for step_number, (old, new) in enumerate(zip(old_steps, new_steps, strict=True), 1):
        if old != new:
            step_numbers.append(str(step_number))
            differences.add(_describe_step(old, new))
    noun = "steps" if len(step_numbers) > 1 else "step"
    steps_text = f": {noun} {', '.join(step_numbers)}"
    if len(differences) > 1:
        return f"{steps_text} differ"
    # The caller only passes lists that differ, so there is exactly one difference.
    (common_difference,) = differences
    return f"{steps_text}: {common_difference}"


def _describe_step(old: Step, new: Step) -> str:
    """Describe how two steps differ, such as ``pause 5 ms → 10 ms``, or ``read → write`` for different kinds."""
    if type(old) is not type(new):
        return f"{old.do} → {new.do}"
    members = PARTS_BY_CLASS[type(new).__name__].by_attribute
    member_texts: list[str] = []
    for attribute in dataclasses.fields(new):
        old_value, new_value = getattr(old, attribute.name), getattr(new, attribute.name)
        if old_value != new_value:
            member = members[attribute.name]
            values_text = old_to_new(as_plain_data(old_value), as_plain_data(new_value), member.notation)
            member_texts.append(f"{member.words} {values_text}")
    return ", ".join(member_texts)


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
    elif old is not new:
        yield from family_pair.compare_presence("measurement", range_subject, old=old, new=new)


def _compare_channels(
    family_pair: FamilyPair, subject: ChangeSubject, old: DataChannels | None, new: DataChannels | None
) -> Iterator[Change]:
    """Yield changes of a frame with several data channels, or the change that only one version has such a frame."""
    channels_subject = subject.inside("channels", f"{subject.label}: frame with several data channels")
    if old is not None and new is not None:
        yield from compare_members(family_pair, channels_subject, old, new)
    elif old is not new:
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
        codes += family_pair.order_codes_over(interface)
    exchanged_pairs = _exchanged_contacts(old, new)
    exchanged_contacts = {contact for pair in exchanged_pairs for contact in pair}
    changes = list(_compare_each_contact(family_pair, subject, old, new, exchanged_contacts))
    for first, second in exchanged_pairs:
        signals = {contact.contact: contact.signal for contact in new.contacts}
        first_signal, second_signal = signals[first], signals[second]
        contact_subject = subject.inside(first, f"{subject.label}: contacts {first} and {second}")
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
    old_contacts, new_contacts = _by_member(old.contacts, "contact"), _by_member(new.contacts, "contact")
    for contact, old_contact, new_contact in match_by_key(old_contacts, new_contacts):
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
        old_parts, new_parts = _by_member(old_section, key_member), _by_member(new_section, key_member)
        for key, old, new in match_by_key(old_parts, new_parts):
            if old != new:
                subject = ChangeSubject(path=f"{section}.{key}", label=f"{noun} {key}")
                yield family_pair.change(rule, subject, description=_describe_difference(old, new), old=old, new=new)
    for old_group, new_group in complete_pairs(
        pair_by_name(family_pair.old.field_groups, family_pair.new.field_groups)
    ):
        subject = ChangeSubject(path=f"field_groups.{new_group.name}", label=f"group {new_group.name}")
        yield from compare_members(family_pair, subject, old_group, new_group)


def _by_member(parts: Iterable[_Part], member_name: str) -> dict[Any, _Part]:
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
