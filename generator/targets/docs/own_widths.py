"""Widths in texts about all order codes of a family, such as 17 to 39 bits, on the page of one order code."""

from __future__ import annotations

from dataclasses import replace

from ...model import Device, Interface, Layout, Parameter, Variant


def range_of(family: Device, item: Parameter) -> str:
    """Return the widths that the order codes of a family set, as in ``17 to 39``, or nothing if there is only one."""
    found = [variant.parameters[item.name] for variant in family.variants if item.name in variant.parameters]
    return f"{min(found)} to {max(found)}" if item.unit == "bits" and found and min(found) < max(found) else ""


def own_meaning(family: Device, item: Parameter) -> str:
    """Return the meaning of a quantity without its range, for a row that begins with its value."""
    written = range_of(family, item)
    return item.meaning.replace(f", {written} bits", "") if written else item.meaning


def with_own_widths(family: Device, device: Device, variant: Variant) -> Device:
    """Return the device with the width of the order code in the notes of its frames, in place of the range."""
    ranges = [(range_of(family, item), item) for item in family.parameters if item.name in variant.parameters]
    written = [text for text, _ in ranges]
    # In a text, two quantities with the same range look alike.
    widths = {text: str(variant.parameters[item.name]) for text, item in ranges if text and written.count(text) == 1}
    return replace(device, interfaces=tuple(_interface(item, widths) for item in device.interfaces))


def _interface(item: Interface, widths: dict[str, str]) -> Interface:
    return replace(item, layouts=tuple(_layout(each, widths) for each in item.layouts))


def _layout(item: Layout, widths: dict[str, str]) -> Layout:
    note = item.note
    for written, own in widths.items():
        note = note.replace(f" {written} bits", f" {own} bits").replace(f", {written},", f", {own},")
    return replace(item, note=note)
