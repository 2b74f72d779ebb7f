"""Widths in texts about all order codes of a family, such as 17 to 39 bits, on the page of one order code."""

from __future__ import annotations

from dataclasses import replace

from ...model import Device, Interface, Layout, Parameter, Variant


def range_of(family: Device, parameter: Parameter) -> str:
    """Return the widths that the order codes of a family set, as in ``17 to 39``, or nothing if there is only one."""
    widths = [variant.parameters[parameter.name] for variant in family.variants if parameter.name in variant.parameters]
    return (
        f"{min(widths)} to {max(widths)}" if parameter.unit == "bits" and widths and min(widths) < max(widths) else ""
    )


def own_meaning(family: Device, parameter: Parameter) -> str:
    """Return the meaning of a quantity without its range, for a row that begins with its value."""
    written = range_of(family, parameter)
    return parameter.meaning.replace(f", {written} bits", "") if written else parameter.meaning


def with_own_widths(family: Device, device: Device, variant: Variant) -> Device:
    """Return the device with the width of the order code in the notes of its frames, in place of the range."""
    ranges = [
        (range_of(family, parameter), parameter)
        for parameter in family.parameters
        if parameter.name in variant.parameters
    ]
    written = [text for text, _ in ranges]
    # In a text, two quantities with the same range look alike.
    widths = {
        text: str(variant.parameters[parameter.name]) for text, parameter in ranges if text and written.count(text) == 1
    }
    return replace(device, interfaces=tuple(_interface(interface, widths) for interface in device.interfaces))


def _interface(interface: Interface, widths: dict[str, str]) -> Interface:
    return replace(interface, layouts=tuple(_layout(layout, widths) for layout in interface.layouts))


def _layout(layout: Layout, widths: dict[str, str]) -> Layout:
    note = layout.note
    for written, code_width in widths.items():
        note = note.replace(f" {written} bits", f" {code_width} bits").replace(f", {written},", f", {code_width},")
    return replace(layout, note=note)
