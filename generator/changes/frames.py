"""Compare frames and registers as layouts: their fields, named values and joined numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields as members_of
from dataclasses import replace

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Field,
    Flag,
    Layout,
    Number,
    Parity,
    Rs485,
    Text,
    Unused,
    Value,
)
from ..model.expressions import Expression
from . import known
from .change import Change, Thing
from .compare import members
from .pairs import Pair
from .shown import arrow, shown
from .sides import Sides

_WORDS = {
    Number: "number",
    Flag: "flag",
    Choice: "named values",
    Constant: "fixed bits",
    Unused: "unused bits",
    CrcValue: "CRC",
    Parity: "parity",
    Decimal: "decimal digits",
    Text: "text",
}
#: Members of a flag that are only text.
_TOLD = ("when_active", "when_inactive")
#: Kinds among which a change affects only how bits are read.
_PLAIN = (Number, Decimal, Text)


def layout(sides: Sides, thing: Thing, old: Layout, new: Layout, scope: str) -> Iterator[Change]:
    """Yield the differences in a frame or in the layout of a register, which ``scope`` names."""
    yield from members(sides, thing, old, new, scope)
    for pair in known.fields(sides, old, new, thing.interface):
        yield from _field(sides, thing, pair, scope)
    for join in known.joins(sides, old, new, scope):
        item = join.new or join.old
        assert item is not None
        place = thing.inside(item.name, f"number {item.name} of {_short(thing)}")
        place = replace(place, label=f"{_short(thing)}: number {item.name}")
        yield from sides.presence("joined", place, join.old, join.new)
        if join.old is not None and join.new is not None:
            yield from members(sides, place, join.old, join.new, scope)


def _short(thing: Thing) -> str:
    """Return the bare name of a register or frame, as used for its fields."""
    return thing.label.rpartition(" ")[2]


def _field(sides: Sides, thing: Thing, pair: Pair[Field], scope: str) -> Iterator[Change]:
    item = pair.new or pair.old
    assert item is not None
    # A field of a group is in many frames, but its change is reported once, for the group.
    path = f"field_groups.{item.group}.{item.name}" if item.group else f"{thing.path}.{item.name}"
    place = Thing(path, f"{item.group or _short(thing)}: field {item.name}", thing.interface)
    # The only field of a plain register has the register's name.
    if not (item.name == scope and pair.old and sides.to_new("register", pair.old.name) == scope):
        yield from sides.presence("field", place, pair.old, pair.new)
    if pair.old is None or pair.new is None:
        return
    old, new = pair.old, pair.new
    yield from members(sides, place, old, new, scope)
    yield from _expected(sides, place, old, new)
    yield from _kind(sides, place, old, new, scope)
    for value in known.values(old, new):
        if isinstance(old.kind, Choice) and isinstance(new.kind, Choice) and not _of_data_ids(sides.new, new):
            yield from _value(sides, place, value)


def _of_data_ids(device: Device, field: Field) -> bool:
    """Return whether its values are the data IDs of an interface, which are compared separately."""
    found = [item.data_ids for item in device.interfaces if isinstance(item, Rs485)]
    return any({value.name for value in field.values} == {data_id.name for data_id in each} for each in found)


def _expected(sides: Sides, place: Thing, old: Field, new: Field) -> Iterator[Change]:
    """Compare the documented value."""
    before, after = (Expression(item) if isinstance(item, int) else item for item in (old.equals, new.equals))
    codes = None
    if isinstance(before, str) or isinstance(after, str):
        differs = before != after
    else:
        found = sides.differing(place.interface, before, after)
        differs, codes = found is not None, found.codes if found is not None else None
    if differs:
        said = f": documented value {arrow(old.equals, new.equals)}"
        yield sides.change("field-expected", place, said, old.equals, new.equals, codes or None)


def _value(sides: Sides, thing: Thing, pair: Pair[Value]) -> Iterator[Change]:
    item = pair.new or pair.old
    assert item is not None
    place = replace(thing.inside(item.name, ""), label=f"{thing.label.replace(': field ', '.')}: value {item.name}")
    yield from sides.presence("value", place, pair.old, pair.new)
    if pair.old is not None and pair.new is not None:
        yield from members(sides, place, pair.old, pair.new)


def _kind(sides: Sides, place: Thing, old: Field, new: Field, scope: str) -> Iterator[Change]:
    """Compare the conversion of bits to a value."""
    before, after = old.kind, new.kind
    if type(before) is not type(after):
        said = f": {_WORDS[type(before)]} → {_WORDS[type(after)]}"
        rule = "field-kind"
        if isinstance(before, _PLAIN) and isinstance(after, _PLAIN):
            rule = "field-reads-otherwise"
        elif isinstance(before, Constant) and isinstance(after, Unused):
            rule = "field-constant"
        yield sides.change(rule, place, said, before, after)
        return
    for member in members_of(after):
        was, now = getattr(before, member.name), getattr(after, member.name)
        if member.name in ("of", "padding_of"):
            was = sides.to_new("field", was, scope)
        elif member.name == "sums_up":
            was = sides.to_new("any-fields", was)
        elif member.name == "crc":
            was = sides.to_new("crc", was)
        if was != now and member.name not in ("values", "only_while"):
            inner = replace(place, path=f"{place.path}.{member.name}")
            yield _of_kind(sides, inner, member.name, was, now)


def _of_kind(sides: Sides, place: Thing, name: str, old: object, new: object) -> Change:
    words = name.replace("_", " ")
    if name in _TOLD:
        return sides.change("words", place, f": {words}", old, new)
    if name == "runs":
        return _runs(sides, place, old, new)
    rule = "field-reads-otherwise"
    if name in ("makes_position", "verdict", "sums_up", "only"):
        words = {"sums_up": "sums up", "only": "order codes"}.get(name, "makes the position")
        rule = "field-verdict"
    elif name in ("value", "padding_of"):
        rule, words = "field-constant", "bits"
    elif name == "active_low":
        return sides.change(rule, place, f": active at {int(not old)} → active at {int(not new)}", old, new)
    return sides.change(rule, place, f": {words} {arrow(old, new)}", old, new)


def _runs(sides: Sides, place: Thing, old: object, new: object) -> Change:
    assert isinstance(old, tuple)
    assert isinstance(new, tuple)
    names = [[(item.name, item.digits) for item in runs] for runs in (old, new)]
    texts = [", ".join(f"{name} ({digits})" for name, digits in each) for each in names]
    if names[0] == names[1]:
        return sides.change("words", place, ": digits", old, new)
    gone = {name for name, _ in names[0]} - {name for name, _ in names[1]}
    said = f": digits {shown(texts[0])} → {shown(texts[1])}"
    return sides.change("field-kind" if gone else "field-reads-otherwise", place, said, old, new)
