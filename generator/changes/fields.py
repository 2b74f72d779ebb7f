"""Compare the fields of a frame or register, and the numbers made of several fields."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Choice, Constant, Decimal, Device, Field, Join, Layout, Number, Rs485, Text, Unused
from .change import Change, Thing
from .compare import members, things
from .counterparts import fields
from .family_pair import FamilyPair
from .pairs import Pair
from .value_text import shown

#: Kinds among which a change affects only how bits are read.
_PLAIN = (Number, Decimal, Text)


def layout(both: FamilyPair, thing: Thing, old: Layout, new: Layout) -> Iterator[Change]:
    """Yield the differences in the fields of a frame or register."""
    for pair in fields(both, old, new, thing.interface):
        yield from _field(both, thing, pair)
    yield from things(both, "joined", old.joins, new.joins, replace(thing, label=f"{thing.scope}: number"))
    place = replace(thing, label=f"{thing.scope}: combination")
    yield from things(both, "combination", old.combinations, new.combinations, place)
    joined = {join.name: _type_of_parts(old, join) for join in old.joins}
    for join in new.joins:
        place = replace(thing, path=f"{thing.path}.{join.name}", label=f"{thing.scope}: number {join.name}")
        yield from _type(both, place, joined.get(join.name, ""), _type_of_parts(new, join))


def _field(both: FamilyPair, thing: Thing, pair: Pair[Field]) -> Iterator[Change]:
    item = pair.item
    # A field of a group is in many frames, but its change is reported once, for the group.
    path = f"field_groups.{item.group}.{item.name}" if item.group else f"{thing.path}.{item.name}"
    place = replace(thing, path=path, label=f"{item.group or thing.scope}: field {item.name}")
    # The only field of a plain register has the register's name.
    if not (item.name == thing.scope and pair.old and both.to_new("register", pair.old.name) == thing.scope):
        yield from both.presence("field", place, pair.old, pair.new)
    if pair.old is None or pair.new is None:
        return
    old, new = pair.old, pair.new
    yield from members(both, place, old, new)
    yield from _kind(both, place, old, new)
    yield from _type(both, place, _type_of(old), _type_of(new))
    if isinstance(old.kind, Choice) and isinstance(new.kind, Choice) and not _of_data_ids(both.new, new):
        label = place.label.replace(": field ", ".")
        yield from things(both, "value", old.values, new.values, replace(place, label=f"{label}: value"))


def _type(both: FamilyPair, place: Thing, old: str, new: str) -> Iterator[Change]:
    """Compare the types of a number in C. Other things have none."""
    if old and new and old != new:
        yield both.change("field-type", place, f": {old} → {new}", old, new)


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
    found = [item.data_ids for item in device.interfaces if isinstance(item, Rs485)]
    return any({value.name for value in field.values} == {data_id.name for data_id in each} for each in found)


def _kind(both: FamilyPair, place: Thing, old: Field, new: Field) -> Iterator[Change]:
    """Compare the conversion of bits to a value."""
    before, after = old.kind, new.kind
    if isinstance(before, Decimal) and isinstance(after, Decimal):
        yield from _runs(both, place.inside("runs", place.label), before, after)
    elif type(before) is type(after):
        yield from members(both, place, before, after)
    else:
        rule = "field-kind"
        if isinstance(before, _PLAIN) and isinstance(after, _PLAIN):
            rule = "field-reads-otherwise"
        elif isinstance(before, Constant) and isinstance(after, Unused):
            rule = "field-constant"
        yield both.change(rule, place, f": {before.word} → {after.word}", before, after)


def _runs(both: FamilyPair, place: Thing, old: Decimal, new: Decimal) -> Iterator[Change]:
    if old == new:
        return
    names = [[(item.name, item.digits) for item in each.runs] for each in (old, new)]
    if names[0] == names[1]:
        yield both.change("words", place, ": digits", old.runs, new.runs)
        return
    gone = {name for name, _ in names[0]} - {name for name, _ in names[1]}
    texts = [shown(", ".join(f"{name} ({digits})" for name, digits in each)) for each in names]
    rule = "field-kind" if gone else "field-reads-otherwise"
    yield both.change(rule, place, f": digits {' → '.join(texts)}", old.runs, new.runs)
