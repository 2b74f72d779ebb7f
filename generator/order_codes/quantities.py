"""Replace the parameters in the expressions of a device by the numbers of an order code."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from operator import is_
from typing import Any

from ..model import (
    Constant,
    Device,
    Field,
    Flag,
    Interface,
    Join,
    Layout,
    Measurement,
    Parity,
    Ssi,
    Variant,
)
from ..model.expressions import Expression, Term
from .parameters import with_sent_layouts
from .reduction import names_of_members, parts_of, sent_crcs

#: Members of a device that contain expressions.
_PARTS_WITH_EXPRESSIONS = ("interfaces", "registers", "procedures", "measurement")


def with_quantities(device: Device, variant: Variant, *, keeps_settings: bool = False) -> Device:
    """Return the device with the parameters in its expressions replaced by the numbers of an order code.

    Parameters that the answer to an open question sets remain, as do those calculated from them. Parameters that
    registers hold have their factory defaults. With ``keeps_settings``, they also remain, and the device has no other
    parameters. Layouts that have no bits for the order code are left out, as are CRCs that only these layouts
    have.
    """
    open_names = _names_of_open_parameters(device, keeps_settings)
    known_parameters = {name: value for name, value in variant.parameters.items() if name not in open_names}
    parts_with_numbers: dict[str, Any] = {}
    for part_name in _PARTS_WITH_EXPRESSIONS:
        parts_with_numbers[part_name] = _with_numbers(getattr(device, part_name), known_parameters)
    if keeps_settings:
        open_parameters = tuple(parameter for parameter in device.parameters if parameter.name in open_names)
        parts_with_numbers["parameters"] = _with_numbers(open_parameters, known_parameters)
    interfaces: list[Interface] = []
    for interface in parts_with_numbers["interfaces"]:
        interface_with_code = with_output_code(interface, variant)
        sent_interface = with_sent_layouts(interface_with_code, variant.parameters)
        interfaces.append(_without_needless_joins(sent_interface, device.measurement_of(interface.name)))
    parts_with_numbers["interfaces"] = tuple(interfaces)
    device_with_numbers = replace(device, **parts_with_numbers)
    return _without_crcs(device_with_numbers, sent_crcs(device.interfaces) - sent_crcs(interfaces))


def _names_of_open_parameters(device: Device, keeps_settings: bool) -> set[str]:
    """Return the names of the parameters that depend on an answer or, with ``keeps_settings``, on a register."""
    undecided = {parameter.name for parameter in device.parameters if parameter.alternative}
    if keeps_settings:
        undecided |= {parameter.name for parameter in device.run_time_parameters}
    open_names: set[str] = set()
    for parameter in device.parameters:
        needed_names = device.needed_parameters([parameter.name])  # The parameter, and those in its formula.
        if not undecided.isdisjoint(needed_names):
            open_names.add(parameter.name)
    return open_names


def _without_needless_joins(interface: Interface, measurement: Measurement | None) -> Interface:
    """Return the interface without joined numbers that consist of a single field, except the position."""
    position_name = measurement.position_name if measurement is not None else ""
    layouts = tuple(_without_single_field_joins(layout, position_name) for layout in interface.layouts)
    return replace(interface, layouts=layouts)


def _without_single_field_joins(layout: Layout, kept_name: str) -> Layout:
    """Return a layout without joined numbers that consist of a single field, except the one called ``kept_name``.

    If such a number is sent in Gray code, its field takes its place.
    """
    field_by_join: dict[str, str] = {}
    for join in layout.joins:
        if len(join.fields) == 1 and join.name != kept_name:
            field_by_join[join.name] = join.fields[0]
    if not field_by_join:
        return layout
    remaining_joins = tuple(join for join in layout.joins if join.name not in field_by_join)
    name_in_gray = field_by_join.get(layout.gray_of, layout.gray_of)
    return replace(layout, joins=remaining_joins, gray_of=name_in_gray)


def _without_crcs(device: Device, names: Collection[str]) -> Device:
    """Return the device without these CRCs and their examples."""
    if not names:
        return device
    crcs = tuple(crc for crc in device.crcs if crc.name not in names)
    examples = tuple(example for example in device.examples if getattr(example, "crc", "") not in names)
    return replace(device, crcs=crcs, examples=examples)


def with_output_code(interface: Interface, variant: Variant) -> Interface:
    """Return an SSI interface with the output code that the order code determines: ``gray`` or ``binary``.

    Any other interface is returned unchanged, as is an interface whose output code does not depend on the order code,
    or whose frames have different codes.
    """
    if not isinstance(interface, Ssi) or interface.output_code is None:
        return interface
    if interface.name != variant.interface or interface.output_code.code != "by_order_code":
        return interface
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    are_gray = [layout.place(variant.parameters).gray for layout in sent_layouts]
    have_different_codes = any(are_gray) and not all(are_gray)
    if not sent_layouts or have_different_codes:
        return interface
    code = "gray" if all(are_gray) else "binary"
    return replace(interface, output_code=replace(interface.output_code, code=code))


def _with_numbers(part: Any, known_parameters: Mapping[str, int]) -> Any:
    """Return a part of the model with known parameters in all its expressions replaced by numbers.

    In layouts, fields whose width is then 0 are left out. If nothing changes, the same object is returned.
    """
    if isinstance(part, Expression):
        return _with_known_numbers(part, known_parameters)
    if isinstance(part, tuple):
        values_with_numbers = tuple(_with_numbers(value, known_parameters) for value in part)
        return part if all(map(is_, values_with_numbers, part)) else values_with_numbers
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        member_with_numbers = _with_numbers(member, known_parameters)
        if member_with_numbers is not member:
            changed[member_name] = member_with_numbers
    part_with_numbers = replace(part, **changed) if changed else part
    if isinstance(part_with_numbers, Field):
        return _with_decided_flag(part_with_numbers, known_parameters)
    if isinstance(part_with_numbers, Layout):
        layout = _with_fixed_code(part_with_numbers, known_parameters)
        return _without_empty_fields(layout)
    return part_with_numbers


def _with_decided_flag(field: Field, known_parameters: Mapping[str, int]) -> Field:
    """Return a flag without the condition ``only_while`` if its parameter is known, and any other field unchanged.

    For an order code without the flag, it is unexplained.
    """
    if not isinstance(field.kind, Flag) or field.kind.only_while not in known_parameters:
        return field
    if not known_parameters[field.kind.only_while]:
        return field.unexplained
    return replace(field, kind=replace(field.kind, only_while=""))


def _with_fixed_code(layout: Layout, known_parameters: Mapping[str, int]) -> Layout:
    """Return a layout with a fixed code, Gray or binary, if the parameter that decides it is known.

    ``gray_when`` names this parameter. The field ``gray_of`` is in Gray code if the parameter is not 0.
    """
    if layout.gray_when not in known_parameters:
        return layout
    if known_parameters[layout.gray_when]:
        return replace(layout, gray_when="")  # Without this parameter, ``gray_of`` is always in Gray code.
    return replace(layout, gray_of="", gray_when="", gray_excess=None)


def _without_empty_fields(layout: Layout) -> Layout:
    """Return a layout without fields of width 0, which are also removed from joined numbers and from parity bits.

    If no remaining field judges whether the position is usable, unexpected reserved bits lead to the verdict UNKNOWN
    instead of a warning.
    """
    empty_fields = {field.name: field for field in layout.fields if field.width == Expression(0)}
    if not empty_fields:
        return layout
    joins = [_without_fields(join, empty_fields) for join in layout.joins]
    remaining_fields = [field for field in layout.fields if field.name not in empty_fields]
    reduced = replace(
        layout,
        fields=tuple(_without_references(field, empty_fields) for field in remaining_fields),
        joins=tuple(join for join in joins if join.fields),
    )
    no_longer_judges_position = reduced.judges_position != layout.judges_position
    return reduced.with_unknown_verdicts() if no_longer_judges_position else reduced


def _without_references(field: Field, removed_fields: Mapping[str, Field]) -> Field:
    """Return the field without references to removed fields.

    A parity bit covers only the remaining fields. If there are none, it becomes a constant: 0 for even parity, 1 for
    odd parity. The padding of a removed field becomes a constant in the bytes of both.
    """
    match field.kind:
        case Parity(of=covered_names) as parity if not removed_fields.keys().isdisjoint(covered_names):
            remaining_names = tuple(name for name in covered_names if name not in removed_fields)
            if not remaining_names:
                return replace(field, kind=Constant(int(parity.odd)))
            return replace(field, kind=replace(parity, of=remaining_names))
        case Constant(padding_of=padded_name) as padding if padded_name in removed_fields:
            bytes_of_both = removed_fields[padded_name].bit_slices
            return replace(field, kind=replace(padding, padding_of=""), bit_slices=bytes_of_both)
    return field


def _without_fields(join: Join, removed_names: Collection[str]) -> Join:
    """Return a joined number that consists of the fields that are not removed."""
    return replace(join, fields=tuple(name for name in join.fields if name not in removed_names))


def _with_known_numbers(expression: Expression, known_parameters: Mapping[str, int]) -> Expression:
    """Return an expression in which known parameters are replaced by their numbers.

    If ``bits`` is known to be 12, ``bits * on + bits`` becomes ``12 * on + 12``.
    """
    constant = expression.constant
    open_terms: list[Term] = []
    for term in expression.terms:
        open_factors = tuple(factor for factor in term.factors if factor.parameter not in known_parameters)
        known_factors = tuple(factor for factor in term.factors if factor.parameter in known_parameters)
        known_term = Term(term.multiple, known_factors)
        known_product = Expression(0, (known_term,)).value(known_parameters)
        if not open_factors:
            constant += known_product
        elif known_product:
            open_terms.append(Term(known_product, open_factors))
    return Expression(constant, tuple(open_terms))
