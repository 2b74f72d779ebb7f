"""Pair the parts of the two versions of a family, including parts that were renamed."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Any, TypeVar

from ..model import Field, Interface, Layout, ModifyStep, Parameter, Procedure, Register, Rs485, Step, WriteStep
from ..model.members import PARTS_BY_CLASS
from .family_pair import FamilyPair, OldAndNew, complete_pairs, pair_by_name

_Item = TypeVar("_Item")


def remember_all_renamings(family_pair: FamilyPair) -> None:
    """Remember every renaming, so that references to renamed parts do not count as changed.

    Parameters come first and procedures last, because a renamed part is recognized by the new names of the parts that
    it refers to.
    """
    family_pair.remember_renamings("parameter", pair_section(family_pair, "parameters"))
    family_pair.remember_renamings("part", pair_section(family_pair, "order_code.parts"))
    family_pair.remember_renamings("crc", pair_section(family_pair, "crcs"))
    family_pair.remember_renamings("decision", pair_section(family_pair, "alternatives"))
    family_pair.remember_renamings("register", pair_section(family_pair, "registers"))
    family_pair.remember_renamings("register", _pair_replaced_registers(family_pair))
    for old_register, new_register in complete_pairs(pair_section(family_pair, "registers")):
        _remember_renamings_in_layout(
            family_pair,
            old_register.layout,
            new_register.layout,
            interface=new_register.interface,
            scope=new_register.name,
        )
    interface_pairs = pair_by_name(family_pair.old.interfaces, family_pair.new.interfaces)
    for old_interface, new_interface in complete_pairs(interface_pairs):
        _remember_renamings_in_frames(family_pair, old_interface, new_interface)
    family_pair.remember_renamings("procedure", pair_section(family_pair, "procedures"))


def _pair_replaced_registers(family_pair: FamilyPair) -> list[OldAndNew[Register]]:
    """Return pairs of a register that is gone and a new register at the same address.

    The two differ in their length or bits, so they are reported as gone and as new. Because they are paired here, parts
    that use the register do not also count as changed.
    """
    pairs = pair_section(family_pair, "registers")
    gone_registers = [pair.old for pair in pairs if pair.old is not None and pair.new is None]
    new_registers = [pair.new for pair in pairs if pair.new is not None and pair.old is None]
    address_of = attrgetter("interface", "bank", "address")
    return pair_by_name(gone_registers, new_registers, address_of)


def _remember_renamings_in_frames(family_pair: FamilyPair, old: Interface, new: Interface) -> None:
    """Remember the renamed data IDs of an interface, and renamed fields, joined numbers and values of its frames."""
    for old_frame, new_frame in complete_pairs(pair_parts(family_pair, old.layouts, new.layouts, new.name)):
        _remember_renamings_in_layout(family_pair, old_frame, new_frame, interface=new.name, scope=new_frame.name)
    if isinstance(old, Rs485) and isinstance(new, Rs485):
        data_id_pairs = pair_parts(family_pair, old.data_ids, new.data_ids)
        family_pair.remember_renamings("data-id", data_id_pairs)


def _remember_renamings_in_layout(
    family_pair: FamilyPair, old: Layout, new: Layout, interface: str, scope: str
) -> None:
    """Remember the renamed fields, joined numbers and values of a frame or register, whose new name is ``scope``.

    Fields are remembered for this layout, and as "any-field" for references that do not name the layout. Values are
    remembered for all fields together, as "any-value".
    """
    field_pairs = pair_fields(family_pair, old, new, interface)
    family_pair.remember_renamings(f"field {scope}", field_pairs)
    join_pairs = pair_parts(family_pair, old.joins, new.joins, scope=scope)
    family_pair.remember_renamings(f"field {scope}", join_pairs)
    family_pair.remember_renamings("any-field", [*field_pairs, *join_pairs])
    for old_field, new_field in complete_pairs(field_pairs):
        family_pair.remember_renamings("any-value", pair_parts(family_pair, old_field.values, new_field.values))


def pair_section(family_pair: FamilyPair, path: str) -> list[OldAndNew[Any]]:
    """Return the old and new parts of a section of the spec, such as ``order_code.parts``, as pairs.

    A part that is new or gone is paired with None.
    """
    section_of = attrgetter(path)
    return pair_parts(family_pair, section_of(family_pair.old), section_of(family_pair.new))


def pair_fields(family_pair: FamilyPair, old: Layout, new: Layout, interface: str) -> list[OldAndNew[Field]]:
    """Return the pairs of fields of a frame or register, except those that only fill gaps.

    Fields are paired by name, then by the same bits, then by the same width between the same neighbors.
    """
    old_fields, new_fields = _fields_except_gap_fillers(old), _fields_except_gap_fillers(new)
    pairs = pair_parts(family_pair, old_fields, new_fields, interface)
    gone_names = {pair.old.name for pair in pairs if pair.old is not None and pair.new is None}
    new_names = {pair.new.name for pair in pairs if pair.new is not None and pair.old is None}
    if not gone_names or not new_names:
        return pairs
    return _pair_fields_between_neighbors(family_pair, pairs, old_fields, new_fields, interface)


def _pair_fields_between_neighbors(
    family_pair: FamilyPair,
    pairs: Sequence[OldAndNew[Field]],
    old_fields: Sequence[Field],
    new_fields: Sequence[Field],
    interface: str,
) -> list[OldAndNew[Field]]:
    """Return the pairs, and also pair removed fields with new fields of the same width between the same neighbors.

    Such a field was renamed while a change elsewhere in the frame moved it. Both fields are also in the same group, and
    either both carry data or neither does. Pairs with a new field are in the order of the new frame, and removed fields
    follow.
    """
    new_name_by_old = {old.name: new.name for old, new in complete_pairs(pairs)}
    # Neighbors are compared by their new names, which the new fields already have.
    paired_new_names = {new_name: new_name for new_name in new_name_by_old.values()}
    old_neighbors = _find_neighbors(old_fields, new_name_by_old)
    new_neighbors = _find_neighbors(new_fields, paired_new_names)

    # ``low_bits_and_widths`` alternates between the two for each order code: (low, width, low, width). A field that
    # moved keeps its widths, so only these, at the odd indices, identify it.
    every_width = slice(1, None, 2)

    def identity_of_old(field: Field) -> Hashable:
        widths = family_pair.low_bits_and_widths(field, interface, is_old=True)[every_width]
        return (*old_neighbors[field.name], field.group, field.carries_data, widths)

    def identity_of_new(field: Field) -> Hashable:
        widths = family_pair.low_bits_and_widths(field, interface, is_old=False)[every_width]
        return (*new_neighbors[field.name], field.group, field.carries_data, widths)

    gone_fields = [pair.old for pair in pairs if pair.old is not None and pair.new is None]
    added_fields = [pair.new for pair in pairs if pair.new is not None and pair.old is None]
    additional_pairs = pair_by_name(gone_fields, added_fields, identity_of_old, identity_of_new)
    additional_pair_by_name = {pair.new_or_old.name: pair for pair in additional_pairs}
    in_new_order = [additional_pair_by_name.get(pair.new.name, pair) for pair in pairs if pair.new is not None]
    still_gone = [pair for pair in additional_pairs if pair.new is None]
    return in_new_order + still_gone


def _find_neighbors(fields_in_order: Sequence[Field], paired_names: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Return the new names of the nearest paired fields before and after each field, by the name of the field.

    For example ``{"counts": ("status", "crc")}``, with "" for a missing neighbor. ``paired_names`` contains the new
    name of each paired field by the name that it has in ``fields_in_order``.
    """
    # The name is empty for a field without a counterpart, which does not count as a neighbor.
    new_names = [paired_names.get(field.name, "") for field in fields_in_order]
    neighbors: dict[str, tuple[str, str]] = {}
    for index, field in enumerate(fields_in_order):
        name_before = next(filter(None, reversed(new_names[:index])), "")
        name_after = next(filter(None, new_names[index + 1 :]), "")
        neighbors[field.name] = name_before, name_after
    return neighbors


def _fields_except_gap_fillers(layout: Layout) -> list[Field]:
    """Return the fields of a frame or register that the spec lists, without fields that only fill gaps or bytes."""
    return [field for field in layout.fields if not field.fills_gap and not field.fills_byte]


def pair_parts(
    family_pair: FamilyPair,
    old_parts: Sequence[_Item],
    new_parts: Sequence[_Item],
    interface: str = "",
    scope: str = "",
) -> list[OldAndNew[_Item]]:
    """Return every part with its counterpart in the other version, or with None if it is new or gone.

    Parts with the same name are a pair. A part whose name is gone and a part whose name is new are also a pair if their
    identities are equal and no other such part has this identity. The identity of a part stays the same when the part
    is renamed, such as the address of a register or the bits of a field.

    Args:
        family_pair: The two versions of the family.
        old_parts: The old parts.
        new_parts: The new parts.
        interface: The interface of frames and fields. Their bits are compared for its order codes.
        scope: The frame or register in which to look up the new names of fields.
    """
    identity_of_old = partial(_identity_of, family_pair=family_pair, is_old=True, interface=interface, scope=scope)
    identity_of_new = partial(_identity_of, family_pair=family_pair, is_old=False, interface=interface, scope=scope)
    return pair_by_name(old_parts, new_parts, identity_of_old, identity_of_new)


def _identity_of(part: Any, family_pair: FamilyPair, *, is_old: bool, interface: str, scope: str) -> Hashable | None:
    """Return a key that stays equal when a part is renamed, or None if only its name identifies the part.

    A field is identified by its bits and by whether it carries data. A procedure is identified by its interface, number
    of arguments and steps, and a parameter by its numbers for each common order code. Any other part is identified by
    the members that the table of members marks as identity, and a frame or register also by the bits of its fields.
    References contain the new names.
    """
    match part:
        case Field():
            return family_pair.low_bits_and_widths(part, interface, is_old=is_old), part.carries_data
        case Procedure():
            if is_old:
                steps = [step_with_new_names(family_pair, step) for step in part.steps]
            else:
                steps = [step_without_words(step) for step in part.steps]
            return part.interface, len(part.arguments), tuple(steps)
        case Parameter():
            return _parameter_identity(family_pair, part, is_old=is_old)
    if is_old:
        part = family_pair.with_new_names(part, scope)
    identity_of_inner = partial(_identity_of, family_pair=family_pair, is_old=is_old, interface=interface, scope=scope)
    identifying_members = PARTS_BY_CLASS[type(part).__name__].identity
    identifying_values = [_identifying_value(getattr(part, name), identity_of_inner) for name in identifying_members]
    layout = part.layout if isinstance(part, Register) else part
    if isinstance(layout, Layout):
        layout_interface = interface or part.interface
        bits_of_fields: list[tuple[int | str, ...]] = []
        for field in layout.fields:
            bits_of_fields.append(family_pair.low_bits_and_widths(field, layout_interface, is_old=is_old))
        identifying_values.append(tuple(bits_of_fields))
    # A part without any identifying value is only identified by its name.
    return tuple(identifying_values) if any(identifying_values) else None


def _parameter_identity(family_pair: FamilyPair, parameter: Parameter, *, is_old: bool) -> Hashable | None:
    """Return a key that stays equal when a parameter is renamed, or None if the versions share no order code.

    The key consists of the unit, the origin of the number (a register, an alternative or neither), and the number for
    each order code that both versions have.
    """
    device = family_pair.old if is_old else family_pair.new
    common_codes = family_pair.new_code_by_old.keys() if is_old else family_pair.common_new_codes
    numbers = tuple(variant.parameters[parameter.name] for variant in device.variants if variant.code in common_codes)
    if not numbers:
        return None
    return parameter.unit, bool(parameter.read_from), parameter.alternative, numbers


def _identifying_value(member_value: Any, identity_of_inner: Callable[[Any], Hashable | None]) -> Any:
    """Return the value of a member without the names of parts, so that it stays equal when a part is renamed.

    For a map, these are its sorted values, and for a tuple of parts, their identities. Any other value is returned as
    it is.
    """
    if isinstance(member_value, Mapping):
        return tuple(sorted(member_value.values()))
    if isinstance(member_value, tuple) and any(map(is_dataclass, member_value)):
        return tuple(identity_of_inner(inner_part) for inner_part in member_value)
    return member_value


def step_without_words(step: Step) -> Step:
    """Return a step without its descriptive text."""
    return replace(step, meaning="", source=())


def step_with_new_names(family_pair: FamilyPair, step: Step) -> Step:
    """Return an old step without its descriptive text, and with the new names of the registers and fields that it uses.

    Fields are looked up in the new register of the step. The name of an argument of the procedure is kept.
    """
    new_register = family_pair.to_new_names("register", getattr(step, "register", ""))
    renamed_step = family_pair.with_new_names(step_without_words(step), new_register)
    if isinstance(renamed_step, (WriteStep, ModifyStep)) and renamed_step.value is None:
        # Without a value, the name is the name of an argument, which is not renamed with values.
        assert isinstance(step, (WriteStep, ModifyStep))
        return replace(renamed_step, value_name=step.value_name)
    return renamed_step
