"""Pictures for a family and for the page of an order code, with text alternatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...model import Device, Layout, Register
from ...model.record import dataclass
from ...say.name import Titled, title
from . import layout_tables
from .connector_pictures import connector_picture, connector_text
from .layout_pictures import Stack, draw, told
from .wide_pictures import wide_picture


@dataclass(frozen=True)
class Picture:
    """Image file in the family's folder, with its alt text."""

    name: str
    text: str
    drawn: str


#: Pictures by subject: ``layout-NAME``, ``wide-NAME``, ``group-NAME``, ``register-NAME``, ``connector-NAME``.
Pictures = dict[str, Picture]


def of_family(device: Device) -> Pictures:
    pictures: Pictures = {}
    for interface, layout in device.layouts():
        pictures[_frame(layout)] = _picture(
            f"{layout.name}.svg", layout, layout_tables.layout_stacks(device, interface, layout)
        )
    groups = {group.name: group for group in device.field_groups}
    for interface in device.interfaces:
        for name in layout_tables.used_groups(interface):
            stacks = layout_tables.group_stacks(device, groups[name])
            pictures[f"group-{name}"] = _picture(f"{name}.svg", groups[name], stacks)
    for register in device.registers:
        if layout_tables.has_picture(register):
            stacks = layout_tables.register_stacks(device, register)
            pictures[_held(register)] = _picture(f"register-{register.name}.svg", register, stacks)
    for connector in device.connectors:
        key = f"connector-{connector.name}"
        pictures[key] = Picture(f"{key}.svg", connector_text(connector), connector_picture(connector))
    return pictures


def of_codes(device: Device, codes_device: Device, page: str, frame: str) -> Pictures:
    """Return the pictures for a page of order codes that differ from the family's pictures.

    They are those of the layout ``frame``, also as one line, and of registers whose fields the order code moves.
    ``codes_device`` is the family with only these order codes.
    """
    pictures: Pictures = {}
    for interface, layout in codes_device.layouts():
        if layout.name == frame:
            stacks = _uncaptioned(layout_tables.layout_stacks(codes_device, interface, layout))
            if not layout.in_bytes or stacks != layout_tables.layout_stacks(device, interface, layout):
                pictures[_frame(layout)] = _picture(f"{page}-{layout.name}.svg", layout, stacks)
            shapes = layout_tables.shapes(codes_device, interface, layout)
            drawn = wide_picture(title(layout), shapes)
            pictures[f"wide-{layout.name}"] = Picture(f"{page}-{layout.name}-wide.svg", told(stacks), drawn)
    for register in codes_device.registers:
        differs = len(layout_tables.register_stacks(device, register)) > 1
        if differs and layout_tables.has_picture(register):
            stacks = _uncaptioned(layout_tables.register_stacks(codes_device, register))
            pictures[_held(register)] = _picture(f"{page}-register-{register.name}.svg", register, stacks)
    return pictures


def _frame(layout: Layout) -> str:
    return f"layout-{layout.name}"


def _held(register: Register) -> str:
    return f"register-{register.name}"


def _picture(name: str, titled: Titled, stacks: Sequence[Stack]) -> Picture:
    return Picture(name, told(stacks), draw(title(titled), stacks))


def _uncaptioned(stacks: Sequence[Stack]) -> list[Stack]:
    """Return the stacks without a caption if there is only one."""
    return [replace(stack, caption="") for stack in stacks] if len(stacks) == 1 else list(stacks)
