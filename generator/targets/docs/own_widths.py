"""Widths in texts about all order codes of a family, such as 17 to 39 bits, on the page of one order code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...model import Device, Interface, Layout, Parameter, Variant


def range_of_widths(family: Device, parameter: Parameter) -> str:
    """Return the widths that the order codes of a family set, as in ``17 to 39``, or nothing if there is only one."""
    if parameter.unit != "bits":
        return ""
    variants = [variant for variant in family.variants if parameter.name in variant.parameters]
    widths = {variant.parameters[parameter.name] for variant in variants}
    return f"{min(widths)} to {max(widths)}" if len(widths) > 1 else ""


def meaning_without_range(family: Device, parameter: Parameter) -> str:
    """Return the meaning of a quantity without its range, for a row that begins with its value."""
    family_range = range_of_widths(family, parameter)
    return parameter.meaning.replace(f", {family_range} bits", "") if family_range else parameter.meaning


def with_widths_of_order_code(family: Device, device: Device, variant: Variant) -> Device:
    """Return the device with the width of the order code in the notes of its frames, in place of the range."""
    parameters = [parameter for parameter in family.parameters if parameter.name in variant.parameters]
    ranges = [range_of_widths(family, parameter) for parameter in parameters]
    widths: dict[str, str] = {}
    for parameter, family_range in zip(parameters, ranges, strict=True):
        # In a text, two quantities with the same range look alike.
        if family_range and ranges.count(family_range) == 1:
            widths[family_range] = str(variant.parameters[parameter.name])
    interfaces = [_interface_with_widths(interface, widths) for interface in device.interfaces]
    return replace(device, interfaces=tuple(interfaces))


def _interface_with_widths(interface: Interface, widths: Mapping[str, str]) -> Interface:
    layouts = [_layout_with_widths(layout, widths) for layout in interface.layouts]
    return replace(interface, layouts=tuple(layouts))


def _layout_with_widths(layout: Layout, widths: Mapping[str, str]) -> Layout:
    """Return the layout with each range of widths in its note replaced by the width of the order code."""
    note = layout.note
    for family_range, width in widths.items():
        note = note.replace(f" {family_range} bits", f" {width} bits").replace(f", {family_range},", f", {width},")
    return replace(layout, note=note)
