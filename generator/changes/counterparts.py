"""Pair the things of two versions of a family, by the properties that stay the same if only a name changes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from typing import Any

from ..model import (
    Alarm,
    Alternative,
    Biss,
    CodePart,
    ControlField,
    Crc,
    DataId,
    Device,
    Field,
    Interface,
    Join,
    Layout,
    Procedure,
    Register,
    RegisterStep,
    Rs485,
    Step,
    Timing,
    Value,
)
from .family_pair import FamilyPair
from .pairs import Pair, both_of, paired


def note_all(both: FamilyPair) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    old, new = both.old, both.new
    both.note("part", parts(old, new))
    both.note("crc", crcs(old.crcs, new.crcs))
    both.note("decision", alternatives(old.alternatives, new.alternatives))
    both.note("register", registers(both))
    for one, other in both_of(registers(both)):
        _note_layout(both, one.layout, other.layout, other.interface, other.name)
    for before, after in both_of(paired(old.interfaces, new.interfaces)):
        both.note("frame", layouts(both, before, after))
        for frame, frame_now in both_of(layouts(both, before, after)):
            _note_layout(both, frame, frame_now, after.name, frame_now.name)
        both.note("data-id", data_ids(before, after))
    both.note("procedure", procedures(both))


def _note_layout(both: FamilyPair, old: Layout, new: Layout, interface: str, scope: str) -> None:
    for found in (fields(both, old, new, interface), joins(both, old, new, scope)):
        both.note(f"field {scope}", found)
        both.note("any-field", found)
    for one, other in both_of(fields(both, old, new, interface)):
        both.note("any-value", paired(one.values, other.values, number))


def number(item: Value) -> Hashable:
    """Return the property that identifies a named value."""
    return item.value


def registers(both: FamilyPair) -> list[Pair[Register]]:
    """Pair registers. A renamed one has the same address and bits."""

    def mark(is_old: bool) -> Callable[[Register], Hashable]:
        return lambda item: (
            item.interface,
            item.bank,
            item.address,
            item.length,
            both.places(item.layout, item.interface, is_old),
        )

    return paired(both.old.registers, both.new.registers, mark(True), mark(False))


def layouts(both: FamilyPair, old: Interface, new: Interface) -> list[Pair[Layout]]:
    def mark(is_old: bool) -> Callable[[Layout], Hashable]:
        return lambda item: (
            item.sender,
            item.in_bytes,
            item.selects,
            item.channel,
            both.places(item, new.name, is_old),
        )

    return paired(old.layouts, new.layouts, mark(True), mark(False))


def fields(both: FamilyPair, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair fields. A renamed one has the same bits, and carries data only if the old one does."""

    def mark(layout: Layout, is_old: bool) -> Callable[[Field], Hashable]:
        places = both.places(layout, interface, is_old)
        at = {item.name: place for item, place in zip(layout.fields, places, strict=True)}
        return lambda item: (at[item.name], item.carries_data)

    olds, news = ([item for item in layout.fields if not item.fills_gap] for layout in (old, new))
    return paired(olds, news, mark(old, True), mark(new, False))


def joins(both: FamilyPair, old: Layout, new: Layout, scope: str) -> list[Pair[Join]]:
    return paired(
        old.joins, new.joins, lambda item: both.to_new("fields", item.fields, scope), lambda item: item.fields
    )


def crcs(olds: Sequence[Crc], news: Sequence[Crc]) -> list[Pair[Crc]]:
    return paired(olds, news, lambda item: (item.width, item.poly, item.init, item.refin, item.refout, item.xorout))


def alternatives(olds: Sequence[Alternative], news: Sequence[Alternative]) -> list[Pair[Alternative]]:
    return paired(olds, news, lambda item: tuple(tuple(sorted(answer.sets.values())) for answer in item.answers))


def data_ids(old: Interface, new: Interface) -> list[Pair[DataId]]:
    if isinstance(old, Rs485) and isinstance(new, Rs485):
        return paired(old.data_ids, new.data_ids, lambda item: (item.id, item.control))
    return []


def control_fields(old: Interface, new: Interface) -> list[Pair[ControlField]]:
    if isinstance(old, Biss) and isinstance(new, Biss):
        return paired(old.control_data, new.control_data, lambda item: (item.bits, item.crc, len(item.values)))
    return []


def timings(olds: Sequence[Timing], news: Sequence[Timing]) -> list[Pair[Timing]]:
    return paired(olds, news, lambda item: (item.at_least_us, item.typical_us, item.at_most_us))


def alarms(both: FamilyPair) -> list[Pair[Alarm]]:
    def old(item: Alarm) -> Hashable:
        return (both.to_new("register", item.register), both.to_new("any-field", item.field)) if item.field else None

    return paired(
        both.old.alarms, both.new.alarms, old, lambda item: (item.register, item.field) if item.field else None
    )


def parts(old: Device, new: Device) -> list[Pair[CodePart]]:
    return paired(
        old.order_code.parts, new.order_code.parts, lambda item: tuple(value.text for value in item.values) or None
    )


def procedures(both: FamilyPair) -> list[Pair[Procedure]]:
    """Pair procedures. A renamed one has the same steps."""

    def old(item: Procedure) -> Hashable:
        return item.interface, len(item.arguments), tuple(step_in_new(both, step) for step in item.steps)

    def new(item: Procedure) -> Hashable:
        return item.interface, len(item.arguments), tuple(bare(step) for step in item.steps)

    return paired(both.old.procedures, both.new.procedures, old, new)


def bare(step: Step) -> Step:
    """Return a step without its words."""
    return replace(step, meaning="", source=())


def step_in_new(both: FamilyPair, step: Step) -> Step:
    """Return an old step without its words and with the new names of the things that it uses."""
    made = bare(step)
    if isinstance(made, RegisterStep):
        register = both.to_new("register", made.register)
        changed: dict[str, Any] = {"register": register}
        if hasattr(made, "field"):
            changed["field"] = both.to_new("field", made.field, register)
        if getattr(made, "value", 0) is not None and hasattr(made, "value_name"):
            changed["value_name"] = both.to_new("any-value", made.value_name)
        return replace(made, **changed)
    return replace(made, data_id=both.to_new("data-id", made.data_id)) if hasattr(made, "data_id") else made
