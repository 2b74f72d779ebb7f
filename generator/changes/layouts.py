"""Compare the fields of a frame or register."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace

from ..model import (
    Choice,
    Constant,
    Decimal,
    Device,
    Field,
    Join,
    Layout,
    Number,
    Rs485,
    Text,
    Unused,
)
from .compare import compare_members, compare_parts
from .consequences import ComparedField, fold_length, fold_moves
from .counterparts import pair_fields
from .family_pair import FamilyPair
from .pairs import OldAndNew
from .rules import Change, ChangeSubject
from .values import short_value

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
    for pair in _without_exchanged_filling(family_pair, subject.interface, pairs):
        if _is_padding(pair.new_or_old, old) or _is_padding(pair.new_or_old, new):
            continue
        common_property = _common_property(family_pair, subject, pair, old, new)
        field_changes = list(_compare_field(family_pair, subject, pair, common_property))
        compared_fields.append(ComparedField(pair=pair, changes=field_changes))
    fields_with_length = fold_length(
        family_pair,
        interface=subject.interface,
        frame=subject.path,
        old_length=old.bits,
        new_length=new.bits,
        compared_fields=compared_fields,
    )
    yield from fold_moves(family_pair, subject.interface, subject.path, fields_with_length)


def _without_exchanged_filling(
    family_pair: FamilyPair, interface: str, pairs: Sequence[OldAndNew[Field]]
) -> Iterator[OldAndNew[Field]]:
    """Yield the pairs of fields, except a field without data that only exchanged its bits with a field that moved.

    If ``speed`` moves from bit 6 to the unused bit 7, bit 6 becomes unused. Its name, which a reader chose, may differ.
    """
    moves: set[tuple[Hashable, Hashable]] = set()
    for pair in pairs:
        if pair.old is not None and pair.new is not None and pair.new.carries_data:
            old_bits = family_pair.low_bits_and_widths(pair.old, interface, is_old=True)
            moves.add((old_bits, family_pair.low_bits_and_widths(pair.new, interface, is_old=False)))
    # Bits and kinds of the fields without data.
    old_filling: dict[Hashable, object] = {}
    new_filling: dict[Hashable, object] = {}
    for pair in pairs:
        if pair.old is not None and not pair.old.carries_data:
            old_filling[family_pair.low_bits_and_widths(pair.old, interface, is_old=True)] = pair.old.kind
        if pair.new is not None and not pair.new.carries_data:
            new_filling[family_pair.low_bits_and_widths(pair.new, interface, is_old=False)] = pair.new.kind
    exchanged_bits: set[Hashable] = set()
    for bits_before, bits_after in moves:
        if bits_after in old_filling and old_filling[bits_after] == new_filling.get(bits_before):
            exchanged_bits |= {bits_before, bits_after}
    for pair in pairs:
        field = pair.new_or_old
        bits = family_pair.low_bits_and_widths(field, interface, is_old=pair.new is None)
        if field.carries_data or bits not in exchanged_bits:
            yield pair


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
