"""Pair the things of two versions of a family, by the properties that stay the same if only a name changes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import is_dataclass, replace
from typing import Any, TypeVar

from ..model import Field, Layout, Procedure, Register, RegisterStep, Rs485, Step
from ..model.members import PARTS_BY_CLASS, Member
from .family_pair import FamilyPair
from .pairs import Pair, both_of, paired

_Part = TypeVar("_Part")


def note_all(both: FamilyPair) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    old, new = both.old, both.new
    both.note("part", recognised(both, old.order_code.parts, new.order_code.parts))
    both.note("crc", recognised(both, old.crcs, new.crcs))
    both.note("decision", recognised(both, old.alternatives, new.alternatives))
    both.note("register", recognised(both, old.registers, new.registers))
    for one, other in both_of(recognised(both, old.registers, new.registers)):
        _note_layout(both, one.layout, other.layout, other.interface, other.name)
    for before, after in both_of(paired(old.interfaces, new.interfaces)):
        both.note("frame", recognised(both, before.layouts, after.layouts, after.name))
        for frame, frame_now in both_of(recognised(both, before.layouts, after.layouts, after.name)):
            _note_layout(both, frame, frame_now, after.name, frame_now.name)
        if isinstance(before, Rs485) and isinstance(after, Rs485):
            both.note("data-id", recognised(both, before.data_ids, after.data_ids))
    both.note("procedure", procedure_pairs(both))


def _note_layout(both: FamilyPair, old: Layout, new: Layout, interface: str, scope: str) -> None:
    names = f"field {scope}"
    found = fields(both, old, new, interface)
    both.note(names, found)
    both.note("any-field", found)
    numbers = recognised(both, old.joins, new.joins, scope=scope)
    both.note(names, numbers)
    both.note("any-field", numbers)
    for one, other in both_of(found):
        both.note("any-value", recognised(both, one.values, other.values))


def recognised(
    both: FamilyPair, olds: Sequence[_Part], news: Sequence[_Part], interface: str = "", scope: str = ""
) -> list[Pair[_Part]]:
    """Pair parts of the model by name, or by the members that identify them, which the table of members names.

    Frames and registers are also identified by the bits of their fields.

    Args:
        both: The two versions of the family.
        olds: The old parts.
        news: The new parts.
        interface: The interface of frames.
        scope: The frame or register in which to look up the names of fields.
    """

    def identity(is_old: bool) -> Callable[[Any], Hashable | None]:
        def of(item: Any) -> Hashable | None:
            part = PARTS_BY_CLASS[type(item).__name__]
            values = [value(part.by_attribute[name], getattr(item, name)) for name in part.identity]
            layout = item.layout if isinstance(item, Register) else item
            if isinstance(layout, Layout):
                values.append(both.places(layout, interface or item.interface, is_old))
            return tuple(values) if any(values) else None

        def value(member: Member, found: Any) -> Any:
            if isinstance(found, Mapping):
                return tuple(sorted(found.values()))
            if isinstance(found, tuple) and any(map(is_dataclass, found)):
                return tuple(map(of, found))
            return both.to_new(member.refers_to, found, scope) if is_old and member.refers_to else found

        return of

    return paired(olds, news, identity(True), identity(False))


def fields(both: FamilyPair, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair fields. A renamed one has the same bits, and carries data only if the old one does."""

    def identity(layout: Layout, is_old: bool) -> Callable[[Field], Hashable]:
        places = both.places(layout, interface, is_old)
        at = {item.name: place for item, place in zip(layout.fields, places, strict=True)}
        return lambda item: (at[item.name], item.carries_data)

    olds, news = (
        [item for item in layout.fields if not item.fills_gap and not item.fills_byte] for layout in (old, new)
    )
    return paired(olds, news, identity(old, True), identity(new, False))


def procedure_pairs(both: FamilyPair) -> list[Pair[Procedure]]:
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
