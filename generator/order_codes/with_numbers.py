"""Reduce a device to one order code, with numbers in place of quantities that depend on the code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..model import Device, Interface, Layout, Ssi, Variant
from ..model.expressions import Expression, Factor
from .holding_only import names_of_members, parts_of

#: The parts of a device that contain expressions.
_PARTS = ("interfaces", "registers", "procedures", "measurement")


def applied(device: Device, variant: Variant) -> Device:
    """Return the device with the quantities of an order code filled in. Questions that the manual leaves open remain.

    Quantities held in registers have their factory defaults.
    """
    asked = {item.name for item in device.parameters if item.alternative}
    known = {name: value for name, value in variant.parameters.items() if name not in asked}
    parts = {name: _filled(getattr(device, name), known) for name in _PARTS}
    return replace(device, **{**parts, "interfaces": tuple(with_code(item, variant) for item in parts["interfaces"])})


def with_code(interface: Interface, variant: Variant) -> Interface:
    """Return the interface with the code that an order code has, if the manual says that it depends on it."""
    if not isinstance(interface, Ssi) or interface.output_code is None or interface.name != variant.interface:
        return interface
    is_gray = {item.place(variant.parameters).gray for item in interface.layouts if item.sender == "encoder"}
    if interface.output_code.code != "by_order_code" or len(is_gray) != 1:
        return interface
    return replace(interface, output_code=replace(interface.output_code, code="gray" if True in is_gray else "binary"))


def _filled(item: Any, known: Mapping[str, int]) -> Any:
    if isinstance(item, Expression):
        return _number(item, known)
    if isinstance(item, tuple):
        several = tuple(_filled(one, known) for one in item)
        return several if any(new is not old for new, old in zip(several, item, strict=True)) else item
    if not names_of_members(item.__class__):
        return item
    changed = {name: new for name, old in parts_of(item) if (new := _filled(old, known)) is not old}
    made = replace(item, **changed) if changed else item
    return _without_empty(_decoded(made, known)) if isinstance(made, Layout) else made


def _decoded(layout: Layout, known: Mapping[str, int]) -> Layout:
    """Return the layout with a fixed code, which is Gray or binary."""
    if layout.gray_when not in known:
        return layout
    return replace(layout, gray_of=layout.gray_of if known[layout.gray_when] else "", gray_when="")


def _without_empty(layout: Layout) -> Layout:
    """Return the layout without zero-width fields, in the layout itself and in its joins."""
    empty = {item.name for item in layout.fields if item.width == Expression(0)}
    if not empty:
        return layout
    joins = (replace(item, fields=tuple(name for name in item.fields if name not in empty)) for item in layout.joins)
    return replace(
        layout,
        fields=tuple(item for item in layout.fields if item.name not in empty),
        joins=tuple(item for item in joins if len(item.fields) > 1),
    )


def _number(item: Expression, known: Mapping[str, int]) -> Expression:
    """Return the expression with known terms replaced by numbers."""
    if item.is_constant:
        return item
    open_terms = tuple(term for term in item.terms if not all(_is_known(factor, known) for factor in term.factors))
    rest = Expression(item.constant, tuple(term for term in item.terms if term not in open_terms))
    return Expression(rest.value(known), open_terms)


def _is_known(factor: Factor, known: Mapping[str, int]) -> bool:
    return factor.parameter in known
