"""Pair the things of two families, by the properties that stay the same if only a name changes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from ..model import (
    Alarm,
    Alternative,
    Biss,
    CodePart,
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
from .pairs import Pair, pairs
from .sides import Sides

_Named = TypeVar("_Named")
_Mark = Callable[[Any], Hashable | None]


def named(olds: Sequence[_Named], news: Sequence[_Named], old: _Mark, new: _Mark | None = None) -> list[Pair[_Named]]:
    """Pair things by their ``name``."""
    return list(pairs(olds, news, lambda item: getattr(item, "name"), old, new or old))  # noqa: B009 (any thing's)


def nothing(_: Any) -> None:
    """Return None, for things that cannot be recognised except by name."""


def note_all(sides: Sides) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    old, new = sides.old, sides.new
    for part in parts(old, new):
        sides.note("part", part.old, part.new)
    for crc in crcs(old.crcs, new.crcs):
        sides.note("crc", crc.old, crc.new)
    for decision in alternatives(old.alternatives, new.alternatives):
        sides.note("decision", decision.old, decision.new)
    for register in registers(sides):
        sides.note("register", register.old, register.new)
        if register.old is not None and register.new is not None:
            _note_layout(sides, register.old.layout, register.new.layout, register.new.interface, register.new.name)
    for interface in named(old.interfaces, new.interfaces, nothing):
        if interface.old is not None and interface.new is not None:
            for layout in layouts(sides, interface.old, interface.new):
                sides.note("frame", layout.old, layout.new)
                if layout.old is not None and layout.new is not None:
                    _note_layout(sides, layout.old, layout.new, interface.new.name, layout.new.name)
            for data_id in data_ids(interface.old, interface.new):
                sides.note("data-id", data_id.old, data_id.new)
    for procedure in procedures(sides):
        sides.note("procedure", procedure.old, procedure.new)


def _note_layout(sides: Sides, old: Layout, new: Layout, interface: str, scope: str) -> None:
    for field in fields(sides, old, new, interface):
        sides.note(f"field {scope}", field.old, field.new)
        sides.note("any-field", field.old, field.new)
        if field.old is not None and field.new is not None:
            for value in values(field.old, field.new):
                sides.note("any-value", value.old, value.new)
    for join in joins(sides, old, new, scope):
        sides.note(f"field {scope}", join.old, join.new)
        sides.note("any-field", join.old, join.new)


def registers(sides: Sides) -> list[Pair[Register]]:
    """Pair registers. A renamed one has the same address and bits."""

    def mark(is_old: bool) -> Callable[[Register], Hashable]:
        return lambda item: (
            item.interface,
            item.bank,
            item.address,
            item.length,
            sides.places(item.layout, item.interface, is_old),
        )

    return named(sides.old.registers, sides.new.registers, mark(True), mark(False))


def layouts(sides: Sides, old: Interface, new: Interface) -> list[Pair[Layout]]:
    def mark(is_old: bool) -> Callable[[Layout], Hashable]:
        return lambda item: (
            item.sender,
            item.in_bytes,
            item.selects,
            item.channel,
            sides.places(item, new.name, is_old),
        )

    return named(old.layouts, new.layouts, mark(True), mark(False))


def fields(sides: Sides, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair fields. A renamed one has the same bits, and carries data only if the old one does."""

    def mark(layout: Layout, is_old: bool) -> Callable[[Field], Hashable]:
        places = sides.places(layout, interface, is_old)
        at = {item.name: place for item, place in zip(layout.fields, places, strict=True)}
        return lambda item: (at[item.name], item.carries_data)

    olds, news = ([item for item in layout.fields if not item.fills_gap] for layout in (old, new))
    return named(olds, news, mark(old, True), mark(new, False))


def joins(sides: Sides, old: Layout, new: Layout, scope: str) -> list[Pair[Join]]:
    return named(
        old.joins, new.joins, lambda item: sides.to_new("fields", item.fields, scope), lambda item: item.fields
    )


def values(old: Field, new: Field) -> list[Pair[Value]]:
    return named(old.values, new.values, lambda item: item.value)


def crcs(olds: Sequence[Crc], news: Sequence[Crc]) -> list[Pair[Crc]]:
    return named(olds, news, lambda item: (item.width, item.poly, item.init, item.refin, item.refout, item.xorout))


def alternatives(olds: Sequence[Alternative], news: Sequence[Alternative]) -> list[Pair[Alternative]]:
    return named(olds, news, lambda item: tuple(tuple(sorted(answer.sets.values())) for answer in item.answers))


def data_ids(old: Interface, new: Interface) -> list[Pair[DataId]]:
    if isinstance(old, Rs485) and isinstance(new, Rs485):
        return named(old.data_ids, new.data_ids, lambda item: (item.id, item.control))
    return []


def control_fields(old: Interface, new: Interface) -> list[Pair[Any]]:
    if isinstance(old, Biss) and isinstance(new, Biss):
        return named(old.control_data, new.control_data, lambda item: (item.bits, item.crc, len(item.values)))
    return []


def timings(olds: Sequence[Timing], news: Sequence[Timing]) -> list[Pair[Timing]]:
    return named(olds, news, lambda item: (item.at_least_us, item.typical_us, item.at_most_us))


def alarms(sides: Sides) -> list[Pair[Alarm]]:
    def old(item: Alarm) -> Hashable:
        return (sides.to_new("register", item.register), sides.to_new("any-field", item.field)) if item.field else None

    return named(
        sides.old.alarms, sides.new.alarms, old, lambda item: (item.register, item.field) if item.field else None
    )


def parts(old: Device, new: Device) -> list[Pair[CodePart]]:
    return named(
        old.order_code.parts, new.order_code.parts, lambda item: tuple(value.text for value in item.values) or None
    )


def procedures(sides: Sides) -> list[Pair[Procedure]]:
    """Pair procedures. A renamed one has the same steps."""

    def old(item: Procedure) -> Hashable:
        return item.interface, len(item.arguments), tuple(step_in_new(sides, step) for step in item.steps)

    def new(item: Procedure) -> Hashable:
        return item.interface, len(item.arguments), tuple(bare(step) for step in item.steps)

    return named(sides.old.procedures, sides.new.procedures, old, new)


def bare(step: Step) -> Step:
    """Return a step without its words."""
    return replace(step, meaning="", source=())


def step_in_new(sides: Sides, step: Step) -> Step:
    """Return an old step without its words and with the new names of the things that it uses."""
    made = bare(step)
    if isinstance(made, RegisterStep):
        register = sides.to_new("register", made.register)
        changed: dict[str, Any] = {"register": register}
        if hasattr(made, "field"):
            changed["field"] = sides.to_new("field", made.field, register)
        if getattr(made, "value", 0) is not None and hasattr(made, "value_name"):
            changed["value_name"] = sides.to_new("any-value", made.value_name)
        return replace(made, **changed)
    return replace(made, data_id=sides.to_new("data-id", made.data_id)) if hasattr(made, "data_id") else made
