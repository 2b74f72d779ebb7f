"""Compare the fields of frames and registers, the other facts about registers, and procedures."""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import replace

from ..model import (
    Argument,
    Choice,
    Constant,
    Decimal,
    Device,
    Field,
    Join,
    Layout,
    Number,
    Procedure,
    Register,
    Rs485,
    Sources,
    Step,
    Text,
    Unused,
)
from ..model.members import PARTS_BY_CLASS
from ..say.register import describe_access
from .compare import compare_members, compare_parts
from .consequences import ComparedField, merge_length_into_resizing, merge_moves_into_resizings
from .counterparts import pair_fields, step_with_new_names, step_without_words
from .family_pair import FamilyPair, OldAndNew, complete_pairs
from .rules import Change, ChangeSubject
from .values import as_plain_data, old_to_new, short_value

#: Kinds that all read their bits as a number or text. A change from one to another only affects how the bits are read.
_KINDS_OF_NUMBERS = (Number, Decimal, Text)


def compare_layout(family_pair: FamilyPair, subject: ChangeSubject, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield the changes of a frame or register in its fields, joined numbers and combinations of flags.

    A joined number consists of several fields. If its type in C differs, this is a change too.
    """
    yield from _compare_fields(family_pair, subject, old, new)
    join_subject = replace(subject, label=f"{subject.scope}: number")
    yield from compare_parts(
        family_pair, part_kind="joined", old_parts=old.joins, new_parts=new.joins, section_subject=join_subject
    )
    combination_subject = replace(subject, label=f"{subject.scope}: combination")
    yield from compare_parts(
        family_pair,
        part_kind="combination",
        old_parts=old.combinations,
        new_parts=new.combinations,
        section_subject=combination_subject,
    )
    # A new joined number has no old type, and only its presence is reported.
    old_type_by_name = {join.name: _type_of_join(old, join) for join in old.joins}
    for join in new.joins:
        join_path, join_label = f"{subject.path}.{join.name}", f"{subject.scope}: number {join.name}"
        type_subject = replace(subject, path=join_path, label=join_label)
        old_type = old_type_by_name.get(join.name, "")
        yield from _compare_type(family_pair, type_subject, old_type, _type_of_join(new, join))


def _compare_fields(family_pair: FamilyPair, subject: ChangeSubject, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield changes of the fields of a frame or register.

    If a resized field moves other fields or changes the length of the frame, this is part of the field's own change.
    Fields that only pad another field follow from that field, and are not compared.
    """
    compared_fields: list[ComparedField] = []
    pairs = pair_fields(family_pair, old, new, subject.interface)
    for pair in _without_exchanged_unused_bits(family_pair, subject.interface, pairs):
        if _is_padding(pair.new_or_old, old) or _is_padding(pair.new_or_old, new):
            continue
        common_property = _common_property(family_pair, subject, pair, old, new)
        field_changes = list(_compare_field(family_pair, subject, pair, common_property))
        compared_fields.append(ComparedField(pair=pair, changes=field_changes))
    fields_with_length = merge_length_into_resizing(
        family_pair,
        interface=subject.interface,
        frame=subject.path,
        old_length=old.bits,
        new_length=new.bits,
        compared_fields=compared_fields,
    )
    yield from merge_moves_into_resizings(family_pair, subject.interface, subject.path, fields_with_length)


def _without_exchanged_unused_bits(
    family_pair: FamilyPair, interface: str, pairs: Sequence[OldAndNew[Field]]
) -> Iterator[OldAndNew[Field]]:
    """Yield the pairs of fields, except a field without data that only exchanged its bits with a field that moved.

    If ``speed`` moves from bit 6 to the unused bit 7, bit 6 becomes unused. Its name, which a reader chose, may differ.
    """
    old_kind_by_bits = _kinds_of_fields_without_data(family_pair, interface, [pair.old for pair in pairs], is_old=True)
    new_kind_by_bits = _kinds_of_fields_without_data(family_pair, interface, [pair.new for pair in pairs], is_old=False)
    exchanged_bits: set[Hashable] = set()
    for old_field, new_field in complete_pairs(pairs):
        old_bits = family_pair.low_bits_and_widths(old_field, interface, is_old=True)
        new_bits = family_pair.low_bits_and_widths(new_field, interface, is_old=False)
        # If the field moved to bits without data, its old bits must now be of the kind that its new bits had.
        moves_to_filling = new_field.carries_data and new_bits in old_kind_by_bits
        if moves_to_filling and old_kind_by_bits[new_bits] == new_kind_by_bits.get(old_bits):
            exchanged_bits |= {old_bits, new_bits}
    for pair in pairs:
        field = pair.new_or_old
        bits = family_pair.low_bits_and_widths(field, interface, is_old=pair.new is None)
        if field.carries_data or bits not in exchanged_bits:
            yield pair


def _kinds_of_fields_without_data(
    family_pair: FamilyPair, interface: str, fields: Iterable[Field | None], *, is_old: bool
) -> dict[Hashable, object]:
    """Return the kinds of the fields that carry no data, such as unused bits, by their bits."""
    kind_by_bits: dict[Hashable, object] = {}
    for field in fields:
        if field is not None and not field.carries_data:
            kind_by_bits[family_pair.low_bits_and_widths(field, interface, is_old=is_old)] = field.kind
    return kind_by_bits


def _is_padding(field: Field, layout: Layout) -> bool:
    """Return whether the field pads another field, as ``position_padding`` pads ``position``."""
    padded_name, suffix, _ = field.name.rpartition("_padding")
    padded_field = layout.find_field(padded_name) if suffix else None
    return padded_field is not None and padded_field.container > 0


def _common_property(
    family_pair: FamilyPair, subject: ChangeSubject, pair: OldAndNew[Field], old_layout: Layout, new_layout: Layout
) -> str:
    """Return what a renamed field has in common with its old version: "between the same fields", or "".

    "" stands for the default text "the same bits". It is also returned for a field that is not renamed. The bits of a
    field in a group are counted from the start of the group.
    """
    if pair.old is None or pair.new is None or pair.old.name == pair.new.name:
        return ""
    old_low_bits = _low_bits_in_group(family_pair, subject.interface, old_layout, pair.old, is_old=True)
    new_low_bits = _low_bits_in_group(family_pair, subject.interface, new_layout, pair.new, is_old=False)
    if old_low_bits == new_low_bits:
        return ""
    return "between the same fields"


def _low_bits_in_group(
    family_pair: FamilyPair, interface: str, layout: Layout, field: Field, *, is_old: bool
) -> tuple[int, ...]:
    """Return the lowest bit of a field for each common order code, counted from the start of its group if it has one.

    The start of a group is the lowest bit of all its fields, for the same order code.
    """
    low_bits = family_pair.values_at_points(field.low, interface, is_old=is_old)
    if not field.group:
        return low_bits
    low_bits_of_group: list[tuple[int, ...]] = []
    for group_field in layout.fields:
        if group_field.group == field.group:
            low_bits_of_group.append(family_pair.values_at_points(group_field.low, interface, is_old=is_old))
    # The list has a tuple for each field. ``zip`` yields the low bits of all fields for each order code.
    group_starts = map(min, zip(*low_bits_of_group, strict=True))
    return tuple(low_bit - group_start for low_bit, group_start in zip(low_bits, group_starts, strict=True))


def _compare_field(
    family_pair: FamilyPair, subject: ChangeSubject, pair: OldAndNew[Field], common_property: str = ""
) -> Iterator[Change]:
    """Yield changes of a field of a frame or register: its presence or name, members, kind, type and values.

    ``common_property`` says what a renamed field has in common with its old version, or is "" for "the same bits". The
    values of two choices are compared, except data IDs, which are compared with their interface.
    """
    field = pair.new_or_old
    # A field of a group is in many frames, but its change is reported once, for the group.
    owner_path = f"field_groups.{field.group}" if field.group else subject.path
    owner_name = field.group or subject.scope
    field_subject = replace(subject, path=f"{owner_path}.{field.name}", label=f"{owner_name}: field {field.name}")
    # The only field of a plain register has the register's name, and is renamed with it. ``scope`` is its new name.
    is_named_as_register = (
        field.name == subject.scope
        and pair.old is not None
        and family_pair.to_new_names("register", pair.old.name) == subject.scope
    )
    if not is_named_as_register:
        yield from family_pair.compare_presence(
            "field", field_subject, old=pair.old, new=pair.new, common_property=common_property
        )
    if pair.old is None or pair.new is None:
        return
    old, new = pair.old, pair.new
    yield from compare_members(family_pair, field_subject, old, new)
    yield from _compare_kind(family_pair, field_subject, old, new)
    yield from _compare_type(family_pair, field_subject, _type_of(old), _type_of(new))
    if isinstance(old.kind, Choice) and isinstance(new.kind, Choice) and not _has_data_ids(family_pair.new, new):
        value_subject = replace(field_subject, label=f"{owner_name}.{field.name}: value")
        yield from compare_parts(
            family_pair, part_kind="value", old_parts=old.values, new_parts=new.values, section_subject=value_subject
        )


def _compare_type(family_pair: FamilyPair, subject: ChangeSubject, old: str, new: str) -> Iterator[Change]:
    """Yield a change if the type of a number in C differs. A type is "" if the field is not a number or is new."""
    if old and new and old != new:
        yield family_pair.change("field-type", subject, description=f": {old} → {new}", old=old, new=new)


def _type_of(field: Field) -> str:
    """Return the type of a field in C, such as ``uint32_t``, or "" if the field is not a number."""
    if not isinstance(field.kind, (Number, Decimal)):
        return ""
    # The number that zero represents may need one bit more than the field has.
    bits = max(field.widest, field.number.zero_means.bit_length())
    return _smallest_integer_type(bits, is_signed=field.number.signed)


def _type_of_join(layout: Layout, join: Join) -> str:
    """Return the type in C of a number that consists of several fields, which must hold their largest widths."""
    bits = sum(layout.field(name).widest for name in join.fields)
    return _smallest_integer_type(bits, is_signed=False)


def _smallest_integer_type(bits: int, *, is_signed: bool) -> str:
    """Return the smallest integer type of C with at least this number of bits, such as ``uint32_t`` for 17 bits."""
    sufficient_sizes = [size for size in (8, 16, 32) if bits <= size]
    size = sufficient_sizes[0] if sufficient_sizes else 64
    return f"int{size}_t" if is_signed else f"uint{size}_t"


def _has_data_ids(device: Device, field: Field) -> bool:
    """Return whether the values of a field are the data IDs of an RS-485 interface, which have the same names."""
    value_names = {value.name for value in field.values}
    for interface in device.interfaces:
        if isinstance(interface, Rs485) and value_names == {data_id.name for data_id in interface.data_ids}:
            return True
    return False


def _compare_kind(family_pair: FamilyPair, subject: ChangeSubject, old: Field, new: Field) -> Iterator[Change]:
    """Yield changes of the kind of a field, which says how its bits are converted to a value.

    If the kind is the same, its details are compared, or the digits of numbers in decimal digits. Otherwise, the text
    of the change is ``: flag → number``.
    """
    old_kind, new_kind = old.kind, new.kind
    if isinstance(old_kind, Decimal) and isinstance(new_kind, Decimal):
        yield from _compare_digits(family_pair, subject.inside("runs", subject.label), old_kind, new_kind)
    elif type(old_kind) is type(new_kind):
        yield from compare_members(family_pair, subject, old_kind, new_kind)
    else:
        rule = "field-kind"
        if isinstance(old_kind, _KINDS_OF_NUMBERS) and isinstance(new_kind, _KINDS_OF_NUMBERS):
            rule = "field-reads-otherwise"
        elif isinstance(old_kind, Constant) and isinstance(new_kind, Unused):
            rule = "field-constant"
        yield family_pair.change(
            rule, subject, description=f": {old_kind.word} → {new_kind.word}", old=old_kind, new=new_kind
        )


def _compare_digits(family_pair: FamilyPair, subject: ChangeSubject, old: Decimal, new: Decimal) -> Iterator[Change]:
    """Yield a change of a field that contains one or several numbers as decimal digits, such as year and week.

    If the names and the numbers of digits are the same in the same order, only texts have changed. If a name is gone,
    the change counts as a different kind of field.
    """
    if old == new:
        return
    old_digits, new_digits = _digits_by_name(old), _digits_by_name(new)
    has_same_order = list(old_digits.items()) == list(new_digits.items())
    if has_same_order:
        yield family_pair.change("words", subject, description=": digits", old=old.runs, new=new.runs)
        return
    gone_names = old_digits.keys() - new_digits.keys()
    rule = "field-kind" if gone_names else "field-reads-otherwise"
    description = f": digits {_digits_text(old_digits)} → {_digits_text(new_digits)}"
    yield family_pair.change(rule, subject, description=description, old=old.runs, new=new.runs)


def _digits_by_name(decimal: Decimal) -> dict[str, int]:
    """Return the number of digits of each number in a field of decimal digits: ``{"year": 2, "week": 2}``."""
    return {run.name: run.digits for run in decimal.runs}


def _digits_text(digits_by_name: dict[str, int]) -> str:
    """Return a text such as ``year (2), week (2)``, shortened if it is long."""
    return short_value(", ".join(f"{name} ({digits})" for name, digits in digits_by_name.items()))


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
