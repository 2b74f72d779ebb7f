"""All pictures of a family and of the pages of its order codes, with their text alternatives, and connector pictures.

The picture of a connector has the name of each color next to it, so that it can be read without color vision. It does
not show the face of the connector, because manuals show the arrangement of pins only in figures, which specs lack.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ...model import Connector, Contact, Device, Layout, Register
from ...model.record import dataclass
from ...say.names_and_places import Titled, title_of
from ..palette import palette
from . import layout_tables
from .layout_pictures import (
    WIDE,
    Stack,
    create_picture,
    draw_box,
    draw_swatch,
    draw_text,
    stacks_picture,
    text_alternative,
    wrap_to_width,
)
from .wide_pictures import wide_picture

_MARGIN, _ROW, _LINE, _SIZE = 10.0, 28.0, 15.0, 12
#: Left edges of the names of wires, of the signals in a table with wires, and of the signals in a table with only pins.
_NAME, _SIGNAL_AFTER_WIRES, _SIGNAL_AFTER_PINS = 46.0, 136.0, 52.0
_BETWEEN_COLOURS = re.compile(r"[^a-z]+")
#: Highest number of shapes of a frame in one picture.
MOST_SHAPES = 12
FACE_UNKNOWN = "The pins are in the order of the manual's table. Their arrangement on the connector face is not known."


def connector_text(connector: Connector) -> str:
    """Return the text alternative for the picture of a connector: its contacts and their signals."""
    return f"{connector.title}: {', '.join(map(_contact_text, connector.contacts))}"


def _contact_text(contact: Contact) -> str:
    """Return a contact in words, such as ``3 CLOCK+ (only X-24)``."""
    order_codes = f" (only {contact.only})" if contact.only else ""
    return f"{contact.contact} {contact.signal}{order_codes}"


def connector_picture(connector: Connector) -> str:
    """Return the picture of a connector or cable: a row for each contact, with its signal."""
    body: list[str] = []
    top = _MARGIN
    signal_left = _SIGNAL_AFTER_PINS if all(map(_is_pin, connector.contacts)) else _SIGNAL_AFTER_WIRES
    for contact in connector.contacts:
        signal_lines = list(_signal_lines(contact, WIDE - _MARGIN - signal_left))
        body += _contact_elements(contact, top)
        for index, (text_line, faint) in enumerate(signal_lines):
            body.append(
                draw_text(signal_left, top + 18 + _LINE * index, text_line, size=_SIZE, anchor="start", faint=faint)
            )
        top += max(_ROW, _LINE * len(signal_lines) + 8)
    if any(map(_is_pin, connector.contacts)):
        for text_line in wrap_to_width(FACE_UNKNOWN, WIDE - 2 * _MARGIN, _SIZE):
            body.append(draw_text(_MARGIN, top + 16, text_line, size=_SIZE, anchor="start", faint=True))
            top += _LINE
    return create_picture(
        connector.title, body, width=WIDE, height=top + _MARGIN, description=connector_text(connector)
    )


def _signal_lines(contact: Contact, room: float) -> Iterator[tuple[str, bool]]:
    """Yield the lines of text for the signal of a contact and its order codes, each with whether it is faint."""
    yield from ((line, False) for line in wrap_to_width(contact.signal, room, _SIZE))
    if contact.only:
        yield from ((line, True) for line in wrap_to_width(f"only {contact.only}", room, _SIZE))


def _is_pin(contact: Contact) -> bool:
    """Return whether a contact is a pin number of at most three digits. All other contacts are wires or names."""
    return contact.contact.isdecimal() and len(contact.contact) <= 3


def _contact_elements(contact: Contact, top: float) -> Iterator[str]:
    """Yield the elements of a contact: a box with a pin number, a wire in its colors with their names, or a name."""
    if _is_pin(contact):
        yield draw_box(_MARGIN, top + 3, box_width=28, box_height=22, fill="data")
        yield draw_text(_MARGIN + 14, top + 18, contact.contact, size=_SIZE, anchor="middle", bold=True)
        return
    colour_words = _BETWEEN_COLOURS.split(contact.contact.lower())
    wire_colours = palette().wires
    if all(word in wire_colours for word in colour_words):
        colour_width = 28.0 / len(colour_words)
        for index, word in enumerate(colour_words):
            yield draw_swatch(
                _MARGIN + colour_width * index,
                top + 5,
                box_width=colour_width,
                box_height=18,
                colour=wire_colours[word],
            )
    # Only the first line of a long name fits.
    for name_line in wrap_to_width(contact.contact, _SIGNAL_AFTER_WIRES - _NAME - 6, _SIZE)[:1]:
        yield draw_text(_NAME, top + 18, name_line, size=_SIZE, anchor="start")


@dataclass(frozen=True)
class Picture:
    """Picture in the folder of a family.

    ``name`` is its file name, and ``text`` its text alternative. ``note`` says what the picture does not show, if
    anything.
    """

    name: str
    text: str
    svg: str
    note: str = ""


#: Pictures by subject: ``layout-NAME``, ``wide-NAME``, ``group-NAME``, ``register-NAME``, ``connector-NAME``.
Pictures = dict[str, Picture]


def pictures_of_family(device: Device) -> Pictures:
    """Return the pictures of a family: its frames, groups of fields, registers and connectors."""
    pictures: Pictures = {}
    for interface, layout in device.layouts():
        stacks = layout_tables.layout_stacks(device, interface, layout)
        pictures[_layout_key(layout)] = _draw_shortest_and_longest(f"{layout.name}.svg", layout, stacks)
    groups = {group.name: group for group in device.field_groups}
    for interface in device.interfaces:
        for name in layout_tables.used_groups(interface):
            stacks = layout_tables.group_stacks(device, groups[name])
            pictures[f"group-{name}"] = _draw_picture(f"{name}.svg", groups[name], stacks)
    for register in device.registers:
        if layout_tables.has_picture(register):
            stacks = layout_tables.register_stacks(device, register)
            pictures[_register_key(register)] = _draw_picture(f"register-{register.name}.svg", register, stacks)
    for connector in device.connectors:
        key = f"connector-{connector.name}"
        pictures[key] = Picture(f"{key}.svg", connector_text(connector), connector_picture(connector))
    return pictures


def pictures_of_order_codes(family_device: Device, narrowed_family: Device, page: str, frame_name: str) -> Pictures:
    """Return the pictures that the page of some order codes shows in place of the family's pictures.

    These are the pictures of the layout ``frame_name`` (with a row for each byte, and on one line), and of registers
    whose fields depend on the order code. ``narrowed_family`` is the family with only these order codes.
    """
    pictures: Pictures = {}
    for interface, layout in narrowed_family.layouts():
        if layout.name == frame_name:
            stacks = _without_single_caption(layout_tables.layout_stacks(narrowed_family, interface, layout))
            # The picture of the family has captions for a frame that consists of bits, so this picture always differs.
            if not layout.in_bytes or stacks != layout_tables.layout_stacks(family_device, interface, layout):
                pictures[_layout_key(layout)] = _draw_picture(f"{page}-{layout.name}.svg", layout, stacks)
            shapes = layout_tables.captioned_shapes(narrowed_family, interface, layout)
            pictures[f"wide-{layout.name}"] = Picture(
                name=f"{page}-{layout.name}-wide.svg",
                text=text_alternative(stacks),
                svg=wide_picture(title_of(layout), shapes),
            )
    for register in narrowed_family.registers:
        depends_on_order_code = len(layout_tables.register_stacks(family_device, register)) > 1
        if depends_on_order_code and layout_tables.has_picture(register):
            stacks = _without_single_caption(layout_tables.register_stacks(narrowed_family, register))
            pictures[_register_key(register)] = _draw_picture(f"{page}-register-{register.name}.svg", register, stacks)
    return pictures


def _layout_key(layout: Layout) -> str:
    """Return the key of the picture of a frame."""
    return f"layout-{layout.name}"


def _register_key(register: Register) -> str:
    """Return the key of the picture of a register."""
    return f"register-{register.name}"


def _draw_picture(name: str, titled: Titled, stacks: Sequence[Stack]) -> Picture:
    """Return the picture of an item with this file name. ``stacks`` are its shapes, as rows of bytes."""
    return Picture(name, text_alternative(stacks), stacks_picture(title_of(titled), stacks))


def _draw_shortest_and_longest(name: str, layout: Layout, stacks: Sequence[Stack]) -> Picture:
    """Return a picture of all shapes of a layout or, if there are many, of only the shortest and the longest."""
    if len(stacks) <= MOST_SHAPES:
        return _draw_picture(name, layout, stacks)
    picture = _draw_picture(name, layout, [stacks[0], stacks[-1]])
    note = (
        f"The picture has the shortest and the longest of {len(stacks)} frames. The table of positions has all of them."
    )
    return replace(picture, note=note)


def _without_single_caption(stacks: Sequence[Stack]) -> list[Stack]:
    """Return shapes as they are or, if there is only one, this shape without its caption."""
    return [replace(stacks[0], caption="")] if len(stacks) == 1 else list(stacks)
