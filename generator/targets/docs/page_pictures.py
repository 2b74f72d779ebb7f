"""Pictures for a family and for the page of an order code, with text alternatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...model import Device, Layout, Register
from ...model.record import dataclass
from ...say.names_and_places import Titled, title
from . import layout_tables
from .connector_pictures import connector_picture, connector_text
from .layout_pictures import Stack, stacks_picture, text_alternative
from .wide_pictures import wide_picture


@dataclass(frozen=True)
class Picture:
    """Image file in the family's folder, with its alt text."""

    name: str
    text: str
    svg: str


#: Pictures by subject: ``layout-NAME``, ``wide-NAME``, ``group-NAME``, ``register-NAME``, ``connector-NAME``.
Pictures = dict[str, Picture]


def pictures_of_family(device: Device) -> Pictures:
    pictures: Pictures = {}
    for interface, layout in device.layouts():
        stacks = layout_tables.layout_stacks(device, interface, layout)
        pictures[_layout_key(layout)] = _picture(f"{layout.name}.svg", layout, stacks)
    groups = {group.name: group for group in device.field_groups}
    for interface in device.interfaces:
        for name in layout_tables.used_groups(interface):
            stacks = layout_tables.group_stacks(device, groups[name])
            pictures[f"group-{name}"] = _picture(f"{name}.svg", groups[name], stacks)
    for register in device.registers:
        if layout_tables.has_picture(register):
            stacks = layout_tables.register_stacks(device, register)
            pictures[_register_key(register)] = _picture(f"register-{register.name}.svg", register, stacks)
    for connector in device.connectors:
        key = f"connector-{connector.name}"
        pictures[key] = Picture(f"{key}.svg", connector_text(connector), connector_picture(connector))
    return pictures


def pictures_of_order_codes(family: Device, narrowed_family: Device, page: str, frame_name: str) -> Pictures:
    """Return the pictures for a page of order codes that differ from the family's pictures.

    They are those of the layout ``frame_name``, also as one line, and of registers whose fields the order code moves.
    ``narrowed_family`` is the family with only these order codes.
    """
    pictures: Pictures = {}
    for interface, layout in narrowed_family.layouts():
        if layout.name == frame_name:
            stacks = _uncaptioned(layout_tables.layout_stacks(narrowed_family, interface, layout))
            if not layout.in_bytes or stacks != layout_tables.layout_stacks(family, interface, layout):
                pictures[_layout_key(layout)] = _picture(f"{page}-{layout.name}.svg", layout, stacks)
            shapes = layout_tables.captioned_shapes(narrowed_family, interface, layout)
            pictures[f"wide-{layout.name}"] = Picture(
                name=f"{page}-{layout.name}-wide.svg",
                text=text_alternative(stacks),
                svg=wide_picture(title(layout), shapes),
            )
    for register in narrowed_family.registers:
        differs = len(layout_tables.register_stacks(family, register)) > 1
        if differs and layout_tables.has_picture(register):
            stacks = _uncaptioned(layout_tables.register_stacks(narrowed_family, register))
            pictures[_register_key(register)] = _picture(f"{page}-register-{register.name}.svg", register, stacks)
    return pictures


def _layout_key(layout: Layout) -> str:
    return f"layout-{layout.name}"


def _register_key(register: Register) -> str:
    return f"register-{register.name}"


def _picture(name: str, titled: Titled, stacks: Sequence[Stack]) -> Picture:
    return Picture(name, text_alternative(stacks), stacks_picture(title(titled), stacks))


def _uncaptioned(stacks: Sequence[Stack]) -> list[Stack]:
    """Return the stacks without a caption if there is only one."""
    return [replace(stacks[0], caption="")] if len(stacks) == 1 else list(stacks)
