"""Reduce a device to one order code, with numbers in place of quantities that depend on the code."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from operator import is_
from typing import Any

from ..model import Device, Interface, Join, Layout, Ssi, Variant
from ..model.expressions import Expression, Term
from .reduction import names_of_members, parts_of

#: The parts of a device that contain expressions.
_PARTS = ("interfaces", "registers", "procedures", "measurement")


def with_quantities(device: Device, variant: Variant) -> Device:
    """Return the device with the quantities of an order code filled in. Questions that the manual leaves open remain.

    Quantities held in registers have their factory defaults.
    """
    open_parameters = {parameter.name for parameter in device.parameters if parameter.alternative}
    known_parameters = {name: value for name, value in variant.parameters.items() if name not in open_parameters}
    parts = {name: _with_numbers(getattr(device, name), known_parameters) for name in _PARTS}
    parts["interfaces"] = tuple(with_output_code(interface, variant) for interface in parts["interfaces"])
    return replace(device, **parts)


def with_output_code(interface: Interface, variant: Variant) -> Interface:
    """Return the interface with the code that an order code has, if the manual says that it depends on it."""
    if not isinstance(interface, Ssi) or interface.output_code is None or interface.name != variant.interface:
        return interface
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    gray_settings = {layout.place(variant.parameters).gray for layout in sent_layouts}
    if interface.output_code.code != "by_order_code" or len(gray_settings) != 1:
        return interface
    code = "gray" if True in gray_settings else "binary"
    return replace(interface, output_code=replace(interface.output_code, code=code))


def _with_numbers(part: Any, known_parameters: Mapping[str, int]) -> Any:
    """Return the part with known parameters replaced by numbers. If nothing changes, it is the same object."""
    if isinstance(part, Expression):
        return _number(part, known_parameters)
    if isinstance(part, tuple):
        filled_values = tuple(_with_numbers(value, known_parameters) for value in part)
        return part if all(map(is_, filled_values, part)) else filled_values
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        filled_member = _with_numbers(member, known_parameters)
        if filled_member is not member:
            changed[member_name] = filled_member
    filled_part = replace(part, **changed) if changed else part
    if not isinstance(filled_part, Layout):
        return filled_part
    return _without_empty_fields(_with_fixed_code(filled_part, known_parameters))


def _with_fixed_code(layout: Layout, known_parameters: Mapping[str, int]) -> Layout:
    """Return the layout with a fixed code, which is Gray or binary."""
    if layout.gray_when not in known_parameters:
        return layout
    return replace(layout, gray_of=layout.gray_of if known_parameters[layout.gray_when] else "", gray_when="")


def _without_empty_fields(layout: Layout) -> Layout:
    """Return the layout without zero-width fields, in the layout itself and in its joins."""
    empty_fields = {field.name for field in layout.fields if field.width == Expression(0)}
    if not empty_fields:
        return layout
    joins = [_without_fields(join, empty_fields) for join in layout.joins]
    return replace(
        layout,
        fields=tuple(field for field in layout.fields if field.name not in empty_fields),
        joins=tuple(join for join in joins if len(join.fields) > 1),
    )


def _without_fields(join: Join, removed: Collection[str]) -> Join:
    return replace(join, fields=tuple(name for name in join.fields if name not in removed))


def _number(expression: Expression, known_parameters: Mapping[str, int]) -> Expression:
    """Return the expression with known terms replaced by numbers."""
    if expression.is_constant:
        return expression
    open_terms = tuple(term for term in expression.terms if not _is_known(term, known_parameters))
    known_sum = Expression(expression.constant, tuple(term for term in expression.terms if term not in open_terms))
    return Expression(known_sum.value(known_parameters), open_terms)


def _is_known(term: Term, known_parameters: Mapping[str, int]) -> bool:
    return all(factor.parameter in known_parameters for factor in term.factors)
