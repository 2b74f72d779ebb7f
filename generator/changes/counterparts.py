"""Pair the things of two versions of a family, by the properties that stay the same if only a name changes."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Any, TypeVar

from ..model import Field, Layout, ModifyStep, Parameter, Procedure, Register, Rs485, Step, WriteStep
from ..model.members import PARTS_BY_CLASS
from .family_pair import FamilyPair
from .pairs import Pair, both_of, paired

_Part = TypeVar("_Part")


def note_all(both: FamilyPair) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    both.note("parameter", in_section(both, "parameters"))
    both.note("part", in_section(both, "order_code.parts"))
    both.note("crc", in_section(both, "crcs"))
    both.note("decision", in_section(both, "alternatives"))
    both.note("register", in_section(both, "registers"))
    for one, other in both_of(in_section(both, "registers")):
        _note_layout(both, one.layout, other.layout, other.interface, other.name)
    for before, after in both_of(paired(both.old.interfaces, both.new.interfaces)):
        for frame, frame_now in both_of(recognised(both, before.layouts, after.layouts, after.name)):
            _note_layout(both, frame, frame_now, after.name, frame_now.name)
        if isinstance(before, Rs485) and isinstance(after, Rs485):
            both.note("data-id", recognised(both, before.data_ids, after.data_ids))
    both.note("procedure", in_section(both, "procedures"))


def _note_layout(both: FamilyPair, old: Layout, new: Layout, interface: str, scope: str) -> None:
    found = fields(both, old, new, interface)
    both.note(f"field {scope}", found)
    numbers = recognised(both, old.joins, new.joins, scope=scope)
    both.note(f"field {scope}", numbers)
    both.note("any-field", [*found, *numbers])
    for one, other in both_of(found):
        both.note("any-value", recognised(both, one.values, other.values))


def in_section(both: FamilyPair, path: str) -> list[Pair[Any]]:
    """Pair the things in a section of the spec."""
    return recognised(both, *map(attrgetter(path), (both.old, both.new)))


def fields(both: FamilyPair, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair the fields of a frame or register, except those that only fill gaps."""
    olds, news = (
        [item for item in layout.fields if not item.fills_gap and not item.fills_byte] for layout in (old, new)
    )
    return recognised(both, olds, news, interface)


def recognised(
    both: FamilyPair, olds: Sequence[_Part], news: Sequence[_Part], interface: str = "", scope: str = ""
) -> list[Pair[_Part]]:
    """Pair parts of the model by name, or by what identifies them under another name.

    Args:
        both: The two versions of the family.
        olds: The old parts.
        news: The new parts.
        interface: The interface of frames and fields.
        scope: The frame or register in which to look up the names of fields.
    """
    old, new = (partial(_identity, both, is_old, interface, scope) for is_old in (True, False))
    return paired(olds, news, old, new)


def _identity(both: FamilyPair, is_old: bool, interface: str, scope: str, item: Any) -> Hashable | None:
    """Return what identifies a part: the members that the table of members names, or for some parts as follows.

    Fields have the same bits, and a new one carries data only if the old one does. Frames and registers also have the
    same bits. Procedures have the same steps, and parameters the same number for every order code.
    """
    match item:
        case Field():
            return both.place(item, interface, is_old), item.carries_data
        case Procedure():
            steps = (step_in_new(both, step) if is_old else bare(step) for step in item.steps)
            return item.interface, len(item.arguments), tuple(steps)
        case Parameter():
            device, codes = (both.old, frozenset(both.shared)) if is_old else (both.new, both.kept)
            numbers = tuple(each.parameters[item.name] for each in device.variants if each.code in codes)
            return (item.unit, bool(item.read_from), item.alternative, numbers) if numbers else None

    def value(found: Any) -> Any:
        if isinstance(found, Mapping):
            return tuple(sorted(found.values()))
        if isinstance(found, tuple) and any(map(is_dataclass, found)):
            return tuple(_identity(both, is_old, interface, scope, each) for each in found)
        return found

    item = both.in_new(item, scope) if is_old else item
    values = [value(getattr(item, name)) for name in PARTS_BY_CLASS[type(item).__name__].identity]
    layout = item.layout if isinstance(item, Register) else item
    if isinstance(layout, Layout):
        values.append(tuple(both.place(each, interface or item.interface, is_old) for each in layout.fields))
    return tuple(values) if any(values) else None


def bare(step: Step) -> Step:
    """Return a step without its words."""
    return replace(step, meaning="", source=())


def step_in_new(both: FamilyPair, step: Step) -> Step:
    """Return an old step without its words and with the new names of the things that it uses."""
    made = both.in_new(bare(step), both.to_new("register", getattr(step, "register", "")))
    if isinstance(step, (WriteStep, ModifyStep)) and isinstance(made, (WriteStep, ModifyStep)) and step.value is None:
        return replace(made, value_name=step.value_name)  # the name of an argument, not of a value
    return made
