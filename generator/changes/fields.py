"""Compare the fields of a frame or register, and the numbers made of several fields."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Choice, Constant, Decimal, Device, Field, Join, Layout, Number, Rs485, Text, Unused
from .change import Change, Subject
from .compare import compare_members, compare_parts
from .counterparts import fields
from .family_pair import FamilyPair
from .pairs import Pair
from .value_text import short_value

#: Kinds among which a change affects only how bits are read.
_PLAIN = (Number, Decimal, Text)


def layout(family_pair: FamilyPair, subject: Subject, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield the differences in the fields of a frame or register."""
    for pair in fields(family_pair, old, new, subject.interface):
        yield from _compare_field(family_pair, subject, pair)
    yield from compare_parts(
        family_pair, "joined", old.joins, new.joins, replace(subject, label=f"{subject.scope}: number")
    )
    part_subject = replace(subject, label=f"{subject.scope}: combination")
    yield from compare_parts(family_pair, "combination", old.combinations, new.combinations, part_subject)
    joined = {join.name: _type_of_parts(old, join) for join in old.joins}
    for join in new.joins:
        part_subject = replace(
            subject, path=f"{subject.path}.{join.name}", label=f"{subject.scope}: number {join.name}"
        )
        yield from _compare_type(family_pair, part_subject, joined.get(join.name, ""), _type_of_parts(new, join))


def _compare_field(family_pair: FamilyPair, subject: Subject, pair: Pair[Field]) -> Iterator[Change]:
    field = pair.item
    # A field of a group is in many frames, but its change is reported once, for the group.
    path = f"field_groups.{field.group}.{field.name}" if field.group else f"{subject.path}.{field.name}"
    part_subject = replace(subject, path=path, label=f"{field.group or subject.scope}: field {field.name}")
    # The only field of a plain register has the register's name.
    if not (
        field.name == subject.scope and pair.old and family_pair.to_new("register", pair.old.name) == subject.scope
    ):
        yield from family_pair.presence("field", part_subject, pair.old, pair.new)
    if pair.old is None or pair.new is None:
        return
    old, new = pair.old, pair.new
    yield from compare_members(family_pair, part_subject, old, new)
    yield from _compare_kind(family_pair, part_subject, old, new)
    yield from _compare_type(family_pair, part_subject, _type_of(old), _type_of(new))
    if isinstance(old.kind, Choice) and isinstance(new.kind, Choice) and not _of_data_ids(family_pair.new, new):
        label = part_subject.label.replace(": field ", ".")
        yield from compare_parts(
            family_pair, "value", old.values, new.values, replace(part_subject, label=f"{label}: value")
        )


def _compare_type(family_pair: FamilyPair, subject: Subject, old: str, new: str) -> Iterator[Change]:
    """Compare the types of a number in C. Other things have none."""
    if old and new and old != new:
        yield family_pair.change("field-type", subject, f": {old} → {new}", old, new)


def _type_of(field: Field) -> str:
    """Return the type of a number in C, or an empty string for another kind of field."""
    if not isinstance(field.kind, (Number, Decimal)):
        return ""
    return _integer(max(field.widest, field.number.zero_means.bit_length()), "int" if field.number.signed else "uint")


def _type_of_parts(layout: Layout, join: Join) -> str:
    """Return the type of a number made of several fields in C."""
    return _integer(sum(layout.field(name).widest for name in join.fields), "uint")


def _integer(bits: int, kind: str) -> str:
    return f"{kind}{next((size for size in (8, 16, 32) if bits <= size), 64)}_t"


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
