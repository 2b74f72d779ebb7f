"""Pair the things of two versions of a family, by the properties that stay the same if only a name changes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Any, TypeVar

from ..model import Field, Layout, ModifyStep, Parameter, Procedure, Register, Rs485, Step, WriteStep
from ..model.members import PARTS_BY_CLASS
from .family_pair import FamilyPair
from .pairs import Pair, both_of, paired

_Part = TypeVar("_Part")


def note_all(family_pair: FamilyPair) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    family_pair.note("parameter", in_section(family_pair, "parameters"))
    family_pair.note("part", in_section(family_pair, "order_code.parts"))
    family_pair.note("crc", in_section(family_pair, "crcs"))
    family_pair.note("decision", in_section(family_pair, "alternatives"))
    family_pair.note("register", in_section(family_pair, "registers"))
    for old_register, new_register in both_of(in_section(family_pair, "registers")):
        _note_layout(family_pair, old_register.layout, new_register.layout, new_register.interface, new_register.name)
    for old_interface, new_interface in both_of(paired(family_pair.old.interfaces, family_pair.new.interfaces)):
        for old_frame, new_frame in both_of(
            recognised(family_pair, old_interface.layouts, new_interface.layouts, new_interface.name)
        ):
            _note_layout(family_pair, old_frame, new_frame, new_interface.name, new_frame.name)
        if isinstance(old_interface, Rs485) and isinstance(new_interface, Rs485):
            family_pair.note("data-id", recognised(family_pair, old_interface.data_ids, new_interface.data_ids))
    family_pair.note("procedure", in_section(family_pair, "procedures"))


def _note_layout(family_pair: FamilyPair, old: Layout, new: Layout, interface: str, scope: str) -> None:
    field_pairs = fields(family_pair, old, new, interface)
    family_pair.note(f"field {scope}", field_pairs)
    join_pairs = recognised(family_pair, old.joins, new.joins, scope=scope)
    family_pair.note(f"field {scope}", join_pairs)
    family_pair.note("any-field", [*field_pairs, *join_pairs])
    for old_field, new_field in both_of(field_pairs):
        family_pair.note("any-value", recognised(family_pair, old_field.values, new_field.values))


def in_section(family_pair: FamilyPair, path: str) -> list[Pair[Any]]:
    """Pair the things in a section of the spec."""
    return recognised(family_pair, *map(attrgetter(path), (family_pair.old, family_pair.new)))


def fields(family_pair: FamilyPair, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair the fields of a frame or register, except those that only fill gaps."""
    return recognised(family_pair, _described_fields(old), _described_fields(new), interface)


def _described_fields(layout: Layout) -> list[Field]:
    return [field for field in layout.fields if not field.fills_gap and not field.fills_byte]


def recognised(
    family_pair: FamilyPair,
    old_parts: Sequence[_Part],
    new_parts: Sequence[_Part],
    interface: str = "",
    scope: str = "",
) -> list[Pair[_Part]]:
    """Pair parts of the model by name, or by what identifies them under another name.

    Args:
        family_pair: The two versions of the family.
        old_parts: The old parts.
        new_parts: The new parts.
        interface: The interface of frames and fields.
        scope: The frame or register in which to look up the names of fields.
    """
    old_key, new_key = (partial(_identity, family_pair, is_old, interface, scope) for is_old in (True, False))
    return paired(old_parts, new_parts, old_key, new_key)


def _identity(family_pair: FamilyPair, is_old: bool, interface: str, scope: str, part: Any) -> Hashable | None:
    """Return what identifies a part: the members that the table of members names, or for some parts as follows.

    Fields have the same bits, and a new one carries data only if the old one does. Frames and registers also have the
    same bits. Procedures have the same steps, and parameters the same number for every order code.
    """
    match part:
        case Field():
            return family_pair.place(part, interface, is_old), part.carries_data
        case Procedure():
            in_new_names: Callable[[Step], Step] = partial(step_in_new, family_pair) if is_old else without_words
            return part.interface, len(part.arguments), tuple(map(in_new_names, part.steps))
        case Parameter():
            device, codes = (
                (family_pair.old, frozenset(family_pair.shared)) if is_old else (family_pair.new, family_pair.kept)
            )
            numbers = tuple(variant.parameters[part.name] for variant in device.variants if variant.code in codes)
            return (part.unit, bool(part.read_from), part.alternative, numbers) if numbers else None

    def value(member_value: Any) -> Any:
        if isinstance(member_value, Mapping):
            return tuple(sorted(member_value.values()))
        if isinstance(member_value, tuple) and any(map(is_dataclass, member_value)):
            return tuple(_identity(family_pair, is_old, interface, scope, inner_part) for inner_part in member_value)
        return member_value

    part = family_pair.in_new(part, scope) if is_old else part
    values = [value(getattr(part, name)) for name in PARTS_BY_CLASS[type(part).__name__].identity]
    layout = part.layout if isinstance(part, Register) else part
    if isinstance(layout, Layout):
        values.append(tuple(family_pair.place(field, interface or part.interface, is_old) for field in layout.fields))
    return tuple(values) if any(values) else None


def without_words(step: Step) -> Step:
    """Return a step without its words."""
    return replace(step, meaning="", source=())


def step_in_new(family_pair: FamilyPair, step: Step) -> Step:
    """Return an old step without its words and with the new names of the things that it uses."""
    renamed_step = family_pair.in_new(
        without_words(step), family_pair.to_new("register", getattr(step, "register", ""))
    )
    if (
        isinstance(step, (WriteStep, ModifyStep))
        and isinstance(renamed_step, (WriteStep, ModifyStep))
        and step.value is None
    ):
        return replace(renamed_step, value_name=step.value_name)  # the name of an argument, not of a value
    return renamed_step
