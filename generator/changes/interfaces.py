"""Compare interfaces with their frames, fields and times, registers, procedures, and facts without effect on code."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from ..model import (
    Argument,
    Biss,
    Choice,
    Connector,
    Constant,
    ControlField,
    Decimal,
    Device,
    Field,
    Interface,
    Join,
    Layout,
    LayoutRange,
    Number,
    Procedure,
    Register,
    Rs485,
    Sources,
    Step,
    Text,
    Timing,
    Unused,
)
from ..model.members import PARTS_BY_CLASS
from ..say.register import access
from .compare import compare_members, compare_pair, compare_parts
from .consequences import ComparedField, fold_length, fold_moves, without_explained_lengths
from .counterparts import FamilyPair, fields, step_in_new, without_words
from .pairs import Pair, both_of, by_key, paired
from .rules import Change, Subject
from .values import arrow, plain, short_value

#: Kinds among which a change affects only how bits are read.
_PLAIN = (Number, Decimal, Text)


def layout(family_pair: FamilyPair, subject: Subject, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield the differences in the fields of a frame or register."""
    compared_fields: Sequence[ComparedField] = []
    for pair in fields(family_pair, old, new, subject.interface):
        # Padding follows from the field that it fills up, and is compared with that field.
        is_padding = _is_padding(pair.item, old) or _is_padding(pair.item, new)
        if is_padding:
            continue
        common_property = _common_property(family_pair, subject, pair, old, new)
        field_changes = list(_compare_field(family_pair, subject, pair, common_property))
        compared_fields = [*compared_fields, ComparedField(pair, field_changes)]
    lengths = old.bits, new.bits
    compared_fields = fold_length(family_pair, subject.interface, subject.path, lengths, compared_fields)
    yield from fold_moves(family_pair, subject.interface, subject.path, compared_fields)
    join_subject = replace(subject, label=f"{subject.scope}: number")
    yield from compare_parts(family_pair, "joined", old.joins, new.joins, join_subject)
    combination_subject = replace(subject, label=f"{subject.scope}: combination")
    yield from compare_parts(family_pair, "combination", old.combinations, new.combinations, combination_subject)
    old_types = {join.name: _type_of_parts(old, join) for join in old.joins}
    for join in new.joins:
        type_subject = replace(
            subject, path=f"{subject.path}.{join.name}", label=f"{subject.scope}: number {join.name}"
        )
        old_type = old_types.get(join.name, "")
        new_type = _type_of_parts(new, join)
        yield from _compare_type(family_pair, type_subject, old_type, new_type)


def _is_padding(field: Field, layout: Layout) -> bool:
    name, suffix, _ = field.name.rpartition("_padding")
    padded_field = layout.find_field(name) if suffix else None
    return padded_field is not None and padded_field.container > 0


def _common_property(
    family_pair: FamilyPair, subject: Subject, pair: Pair[Field], old_layout: Layout, new_layout: Layout
) -> str:
    """Return the property by which a renamed field is recognised, if its bits in the frame or group differ."""
    if pair.old is None or pair.new is None or pair.old.name == pair.new.name:
        return ""
    old_lows = _lows_in_group(family_pair, subject.interface, old_layout, pair.old, is_old=True)
    new_lows = _lows_in_group(family_pair, subject.interface, new_layout, pair.new, is_old=False)
    return "" if old_lows == new_lows else "between the same fields"


def _lows_in_group(
    family_pair: FamilyPair, interface: str, layout: Layout, field: Field, is_old: bool
) -> tuple[int, ...]:
    """Return the lowest bit of a field at every point, counted from the start of its group if it has one."""
    lows = family_pair.numbers(field.low, interface, is_old)
    if not field.group:
        return lows
    members = [member for member in layout.fields if member.group == field.group]
    lows_of_members = [family_pair.numbers(member.low, interface, is_old) for member in members]
    starts = map(min, zip(*lows_of_members, strict=True))
    return tuple(low - start for low, start in zip(lows, starts, strict=True))


def _compare_field(
    family_pair: FamilyPair, subject: Subject, pair: Pair[Field], common_property: str = ""
) -> Iterator[Change]:
    """Compare a field of a frame or register: its name, its members, its kind, its type and its values."""
    field = pair.item
    # A field of a group is in many frames, but its change is reported once, for the group.
    path = f"field_groups.{field.group}.{field.name}" if field.group else f"{subject.path}.{field.name}"
    field_subject = replace(subject, path=path, label=f"{field.group or subject.scope}: field {field.name}")
    # The only field of a plain register has the register's name, and is renamed with it.
    is_named_as_register = (
        field.name == subject.scope
        and pair.old is not None
        and family_pair.to_new("register", pair.old.name) == subject.scope
    )
    if not is_named_as_register:
        yield from family_pair.presence("field", field_subject, pair.old, pair.new, common_property)
    if pair.old is None or pair.new is None:
        return
    old, new = pair.old, pair.new
    yield from compare_members(family_pair, field_subject, old, new)
    yield from _compare_kind(family_pair, field_subject, old, new)
    yield from _compare_type(family_pair, field_subject, _type_of(old), _type_of(new))
    if isinstance(old.kind, Choice) and isinstance(new.kind, Choice) and not _of_data_ids(family_pair.new, new):
        owner = field_subject.label.replace(": field ", ".")
        value_subject = replace(field_subject, label=f"{owner}: value")
        yield from compare_parts(family_pair, "value", old.values, new.values, value_subject)


def _compare_type(family_pair: FamilyPair, subject: Subject, old: str, new: str) -> Iterator[Change]:
    """Compare the types of a number in C. Other things have none."""
    if old and new and old != new:
        yield family_pair.change("field-type", subject, f": {old} → {new}", old, new)


def _type_of(field: Field) -> str:
    """Return the type of a number in C, or an empty string for another kind of field."""
    if not isinstance(field.kind, (Number, Decimal)):
        return ""
    # The number that zero stands for may need one bit more than the field has.
    bits = max(field.widest, field.number.zero_means.bit_length())
    return _integer(bits, "int" if field.number.signed else "uint")


def _type_of_parts(layout: Layout, join: Join) -> str:
    """Return the type of a number made of several fields in C."""
    return _integer(sum(layout.field(name).widest for name in join.fields), "uint")


def _integer(bits: int, kind: str) -> str:
    """Return the smallest integer type of C with this number of bits."""
    fitting_sizes = [size for size in (8, 16, 32, 64) if bits <= size]
    return f"{kind}{fitting_sizes[0] if fitting_sizes else 64}_t"


def _of_data_ids(device: Device, field: Field) -> bool:
    """Return whether its values are the data IDs of an interface, which are compared separately."""
    names = {value.name for value in field.values}
    interfaces = [interface for interface in device.interfaces if isinstance(interface, Rs485)]
    return any(names == _data_id_names(interface) for interface in interfaces)


def _data_id_names(interface: Rs485) -> set[str]:
    return {data_id.name for data_id in interface.data_ids}


def _compare_kind(family_pair: FamilyPair, subject: Subject, old: Field, new: Field) -> Iterator[Change]:
    """Compare the conversion of bits to a value."""
    old_kind, new_kind = old.kind, new.kind
    if isinstance(old_kind, Decimal) and isinstance(new_kind, Decimal):
        yield from _compare_runs(family_pair, subject.inside("runs", subject.label), old_kind, new_kind)
    elif type(old_kind) is type(new_kind):
        yield from compare_members(family_pair, subject, old_kind, new_kind)
    else:
        rule = "field-kind"
        if isinstance(old_kind, _PLAIN) and isinstance(new_kind, _PLAIN):
            rule = "field-reads-otherwise"
        elif isinstance(old_kind, Constant) and isinstance(new_kind, Unused):
            rule = "field-constant"
        yield family_pair.change(rule, subject, f": {old_kind.word} → {new_kind.word}", old_kind, new_kind)


def _compare_runs(family_pair: FamilyPair, subject: Subject, old: Decimal, new: Decimal) -> Iterator[Change]:
    if old == new:
        return
    old_digits, new_digits = _digits_by_name(old), _digits_by_name(new)
    if list(old_digits.items()) == list(new_digits.items()):
        yield family_pair.change("words", subject, ": digits", old.runs, new.runs)
        return
    texts = [_digits_text(old_digits), _digits_text(new_digits)]
    rule = "field-kind" if old_digits.keys() - new_digits.keys() else "field-reads-otherwise"
    yield family_pair.change(rule, subject, f": digits {' → '.join(texts)}", old.runs, new.runs)


def _digits_by_name(kind: Decimal) -> dict[str, int]:
    return {run.name: run.digits for run in kind.runs}


def _digits_text(digits_by_name: dict[str, int]) -> str:
    return short_value(", ".join(f"{name} ({digits})" for name, digits in digits_by_name.items()))


_CAN_READ, _CAN_WRITE = ("read_only", "read_write"), ("write_only", "read_write")


def register(family_pair: FamilyPair, subject: Subject, old: Register, new: Register) -> Iterator[Change]:
    """Compare the access, the meanings and the bits of a register."""
    unnamed = subject.unnamed
    if old.access != new.access:
        is_read_lost = old.access in _CAN_READ and new.access not in _CAN_READ
        is_write_lost = old.access in _CAN_WRITE and new.access not in _CAN_WRITE
        is_lost = is_read_lost or is_write_lost
        if not is_lost:
            subject = unnamed
        rule = "access-lost" if is_lost else "access-gained"
        description = f": {access(old)} → {access(new)}"
        yield family_pair.change(rule, subject.inside("access", subject.label), description, old.access, new.access)
    meaning_subject = replace(subject, label=f"{subject.label}: meaning")
    yield from compare_parts(family_pair, "meaning", old.meanings, new.meanings, meaning_subject)
    # Everything else in the layout of a register follows from the register, which is compared separately.
    compared = {name: getattr(old.layout, name) for name in ("fields", "joins", "gaps")}
    old_layout = replace(new.layout, **compared)
    yield from compare_members(family_pair, unnamed, old_layout, new.layout)
    yield from layout(family_pair, unnamed, old_layout, new.layout)


def procedure(family_pair: FamilyPair, subject: Subject, old: Procedure, new: Procedure) -> Iterator[Change]:
    """Compare the arguments and the steps of a procedure."""
    yield from _compare_arguments(family_pair, subject.inside("arguments", subject.label), old, new)
    steps_subject = subject.unnamed.inside("steps", subject.label)
    old_steps = [step_in_new(family_pair, step) for step in old.steps]
    new_steps = [without_words(step) for step in new.steps]
    if old_steps != new_steps:
        yield family_pair.change("procedure-steps", steps_subject, _steps(old_steps, new_steps), old_steps, new_steps)
    elif _meanings(old.steps) != _meanings(new.steps):
        yield family_pair.change("words", steps_subject, ": steps", old.steps, new.steps)
    elif old.steps != new.steps and _sources(old.steps) != _sources(new.steps):
        yield family_pair.change("source", steps_subject, ": steps", None, None)


def _compare_arguments(family_pair: FamilyPair, subject: Subject, old: Procedure, new: Procedure) -> Iterator[Change]:
    old_arguments, new_arguments = _signature(map(family_pair.in_new, old.arguments)), _signature(new.arguments)
    if old_arguments != new_arguments:
        old_texts, new_texts = _argument_names(old), _argument_names(new)
        if old_texts == new_texts:  # Then the register that takes an argument differs, or its meaning.
            old_texts, new_texts = _argument_texts(old_arguments), _argument_texts(new_arguments)
        description = f": arguments {arrow(old_texts, new_texts)}"
        yield family_pair.change("procedure-arguments", subject, description, old_arguments, new_arguments)
    elif _meanings(old.arguments) != _meanings(new.arguments):
        yield family_pair.change("words", subject.unnamed, ": arguments", old.arguments, new.arguments)


def _argument_names(procedure: Procedure) -> list[str]:
    return [argument.name for argument in procedure.arguments]


def _signature(arguments: Iterable[Argument]) -> list[tuple[str, str, str]]:
    """Return the name of each argument, the register or field that takes it, and how it is meant."""
    return [(argument.name, argument.of, argument.meant_as) for argument in arguments]


def _argument_texts(signature: list[tuple[str, str, str]]) -> list[str]:
    texts = []
    for name, owner, meaning in signature:
        as_meaning = f" as {meaning}" if meaning else ""
        texts.append(f"{name} for {owner}{as_meaning}")
    return texts


def _meanings(parts: Sequence[Argument | Step]) -> list[str]:
    return [part.meaning for part in parts]


def _sources(steps: Sequence[Step]) -> list[Sources]:
    return [step.source for step in steps]


def _steps(old_steps: list[Step], new_steps: list[Step]) -> str:
    """Describe the steps that differ, by their numbers. If they differ in the same way, say how."""
    if len(old_steps) != len(new_steps):
        return f": {len(old_steps)} steps → {len(new_steps)} steps"
    numbers: list[str] = []
    differences: set[str] = set()
    for number, (old, new) in enumerate(zip(old_steps, new_steps, strict=True), 1):
        if old != new:
            numbers.append(str(number))
            differences.add(_step(old, new))
    noun = "steps" if len(numbers) > 1 else "step"
    steps_text = f": {noun} {', '.join(numbers)}"
    return f"{steps_text}: {differences.pop()}" if len(differences) == 1 else f"{steps_text} differ"


def _step(old: Step, new: Step) -> str:
    """Describe the difference between two steps."""
    if type(old) is not type(new):
        return f"{old.do} → {new.do}"
    part_members, texts = PARTS_BY_CLASS[type(new).__name__].by_attribute, []
    for attribute in dataclasses.fields(new):
        old_value, new_value = getattr(old, attribute.name), getattr(new, attribute.name)
        if old_value != new_value:
            member = part_members[attribute.name]
            texts.append(f"{member.words} {arrow(plain(old_value), plain(new_value), member.notation)}")
    return ", ".join(texts)


def interfaces(family_pair: FamilyPair) -> Iterator[Change]:
    for pair in paired(family_pair.old.interfaces, family_pair.new.interfaces):
        subject = Subject(f"interfaces.{pair.item.name}", pair.item.short, pair.item.name)
        yield from compare_pair(family_pair, "interface", subject, pair, _compare_interface)


def _compare_interface(family_pair: FamilyPair, subject: Subject, old: Interface, new: Interface) -> Iterator[Change]:
    """Compare the electrical side, the timings and the frames of an interface.

    An interface that changes between RS-485 and a clocked one has neither a port nor a clock to compare.
    """
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        port_subject = subject.inside("port", subject.label)
        yield from compare_members(family_pair, port_subject, old.port, new.port)
        data_id_subject = subject.inside("data_ids", "data ID")
        yield from compare_parts(family_pair, "data-id", old.data_ids, new.data_ids, data_id_subject)
    elif not isinstance(new, Rs485) and not isinstance(old, Rs485):
        clock_subject = subject.inside("clock", subject.label)
        yield from compare_members(family_pair, clock_subject, old.clock, new.clock)
    if isinstance(old, Biss) and isinstance(new, Biss):
        control_subject = subject.inside("control_data", "control frame: field")
        yield from compare_parts(
            family_pair, "control-field", old.control_data, new.control_data, control_subject, _compare_control_values
        )
    yield from timings(family_pair, subject, old.timings, new.timings)
    frame_subject = subject.inside("layouts", "frame")
    frame_changes = compare_parts(family_pair, "frame", old.layouts, new.layouts, frame_subject, _compare_frame)
    yield from without_explained_lengths(list(frame_changes))


def _compare_frame(family_pair: FamilyPair, subject: Subject, old: Layout, new: Layout) -> Iterator[Change]:
    """Compare the fields, the position range and the needed decisions of a frame. Decisions have their new names."""
    unnamed = subject.unnamed
    yield from layout(family_pair, unnamed, old, new)
    yield from _compare_position_range(family_pair, unnamed, old.position_range, new.position_range)
    old_alternatives = family_pair.old.alternatives_of(old)
    new_alternatives = family_pair.new.alternatives_of(new)
    old_decisions = {family_pair.to_new("decision", alternative.name) for alternative in old_alternatives}
    new_decisions = {alternative.name for alternative in new_alternatives}
    decision_subject = unnamed.inside("alternatives", unnamed.label)
    for decision in sorted(old_decisions - new_decisions):
        description = f": no longer needs the decision {decision}"
        yield family_pair.change("frame-decision", decision_subject, description, decision, None)
    for decision in sorted(new_decisions - old_decisions):
        description = f": needs the decision {decision}"
        yield family_pair.change("frame-decision", decision_subject, description, None, decision)


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
