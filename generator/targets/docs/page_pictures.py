"""All pictures of a family and of the pages of its order codes, with their text alternatives, and connector pictures.

The picture of a connector has the name of each color next to it, so that it can be read without color vision. It does
not show the face of the connector, because manuals show the arrangement of pins only in figures, which specs lack.

In the picture of a frame or register, a name that does not fit into its box is below the row, with its bit numbers, and
so is each active-low flag.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ...model import (
    Answer,
    Connector,
    Contact,
    Device,
    FieldGroup,
    Interface,
    Layout,
    PlacedLayout,
    Register,
    answer_combinations,
)
from ...model.expressions import Expression
from ...model.record import dataclass
from ...say.names_and_evidence import Titled, title_of
from ...say.text import join_filled
from ..picture_elements import PICTURE_WIDTH, create_picture, draw_box, draw_swatch, draw_text, palette, wrap_to_width
from .layout_pictures import (
    Box,
    ByteRow,
    Stack,
    bit_stack,
    byte_stack,
    group_stack,
    register_stack,
    text_alternative,
    wide_picture,
)
from .layout_tables import Placement, Shape, distinct_placements, group_shapes, shape_of, used_groups

_MARGIN, _TEXT_SIZE = 10.0, 12
#: Width between the margins.
_ROOM = PICTURE_WIDTH - 2 * _MARGIN
#: Heights of a contact in the picture of a connector, and of each line of its signal.
_ROW_HEIGHT, _LINE_HEIGHT = 28.0, 15.0
#: Left edges of the names of wires, of the signals in a table with wires, and of the signals in a table with only pins.
_NAME_LEFT, _SIGNAL_LEFT_AFTER_WIRES, _SIGNAL_LEFT_AFTER_PINS = 46.0, 136.0, 52.0
_BETWEEN_COLOURS = re.compile(r"[^a-z]+")
#: Measures of rows of bytes. Lines for names that do not fit into their boxes are indented after a box in their color.
_LABEL_WIDTH, _BOX_HEIGHT, _NAME_LINE_HEIGHT, _STACK_GAP, _INDENT = 50.0, 34.0, 16.0, 12.0, 16.0
_BIT_WIDTH = (_ROOM - _LABEL_WIDTH) / 8
_CAPTION_SIZE = 13
#: Factor for the width of captions, which are order codes in bold capitals.
_CAPTION_WIDTH_FACTOR = 1.2
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
    has_only_pins = all(map(_is_pin, connector.contacts))
    signal_left = _SIGNAL_LEFT_AFTER_PINS if has_only_pins else _SIGNAL_LEFT_AFTER_WIRES
    for contact in connector.contacts:
        body += _contact_elements(contact, top)
        signal_elements = list(_signal_elements(contact, left=signal_left, top=top))
        body += signal_elements
        top += max(_ROW_HEIGHT, _LINE_HEIGHT * len(signal_elements) + 8)
    if any(map(_is_pin, connector.contacts)):
        for text_line in wrap_to_width(FACE_UNKNOWN, _ROOM, _TEXT_SIZE):
            body.append(draw_text(text_line, x=_MARGIN, y=top + 16, size=_TEXT_SIZE, anchor="start", faint=True))
            top += _LINE_HEIGHT
    return create_picture(
        connector.title, body, width=PICTURE_WIDTH, height=top + _MARGIN, description=connector_text(connector)
    )


def _signal_elements(contact: Contact, *, left: float, top: float) -> Iterator[str]:
    """Yield the lines of text for the signal of a contact and, in a faint color, for its order codes."""
    room = PICTURE_WIDTH - _MARGIN - left
    baseline = top + 18
    for signal_line in wrap_to_width(contact.signal, room, _TEXT_SIZE):
        yield draw_text(signal_line, x=left, y=baseline, size=_TEXT_SIZE, anchor="start")
        baseline += _LINE_HEIGHT
    if contact.only:
        for order_codes_line in wrap_to_width(f"only {contact.only}", room, _TEXT_SIZE):
            yield draw_text(order_codes_line, x=left, y=baseline, size=_TEXT_SIZE, anchor="start", faint=True)
            baseline += _LINE_HEIGHT


def _is_pin(contact: Contact) -> bool:
    """Return whether a contact is a pin number of at most three digits. All other contacts are wires or names."""
    return contact.contact.isdecimal() and len(contact.contact) <= 3


def _contact_elements(contact: Contact, top: float) -> Iterator[str]:
    """Yield the elements of a contact: a box with a pin number, a wire in its colors with their names, or a name."""
    if _is_pin(contact):
        yield draw_box(left=_MARGIN, top=top + 3, box_width=28, box_height=22, fill="data")
        yield draw_text(contact.contact, x=_MARGIN + 14, y=top + 18, size=_TEXT_SIZE, anchor="middle", bold=True)
        return
    colour_words = _BETWEEN_COLOURS.split(contact.contact.lower())
    wire_colours = palette().wires
    if all(word in wire_colours for word in colour_words):
        colour_width = 28.0 / len(colour_words)
        for index, word in enumerate(colour_words):
            yield draw_swatch(
                left=_MARGIN + colour_width * index,
                top=top + 5,
                box_width=colour_width,
                box_height=18,
                colour=wire_colours[word],
            )
    name_lines = wrap_to_width(contact.contact, _SIGNAL_LEFT_AFTER_WIRES - _NAME_LEFT - 6, _TEXT_SIZE)
    # Only the first line of a long name fits.
    for name_line in name_lines[:1]:
        yield draw_text(name_line, x=_NAME_LEFT, y=top + 18, size=_TEXT_SIZE, anchor="start")


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
        stacks = layout_stacks(device, interface, layout)
        pictures[_layout_key(layout)] = _draw_shortest_and_longest(f"{layout.name}.svg", layout, stacks)
    groups = {group.name: group for group in device.field_groups}
    for interface in device.interfaces:
        for group_name in used_groups(interface):
            field_group = groups[group_name]
            stacks = group_stacks(device, field_group)
            pictures[f"group-{group_name}"] = _draw_picture(f"{group_name}.svg", field_group, stacks)
    for register in device.registers:
        if has_picture(register):
            key = _register_key(register)
            stacks = register_stacks(device, register)
            pictures[key] = _draw_picture(f"{key}.svg", register, stacks)
    for connector in device.connectors:
        key = f"connector-{connector.name}"
        pictures[key] = Picture(
            name=f"{key}.svg",
            text=connector_text(connector),
            svg=connector_picture(connector),
        )
    return pictures


def pictures_of_order_codes(family_device: Device, narrowed_family: Device, page: str, frame_name: str) -> Pictures:
    """Return the pictures that the page of some order codes shows in place of the family's pictures.

    These are the pictures of the layout ``frame_name`` (with a row for each byte, and on one line), and of registers
    whose fields depend on the order code. ``narrowed_family`` is the family with only these order codes.
    """
    pictures: Pictures = {}
    for interface, layout in narrowed_family.layouts():
        if layout.name == frame_name:
            stacks = _without_single_caption(layout_stacks(narrowed_family, interface, layout))
            family_stacks = layout_stacks(family_device, interface, layout)
            # The picture of the family has captions for a frame that consists of bits, so this picture always differs.
            if not layout.in_bytes or stacks != family_stacks:
                pictures[_layout_key(layout)] = _draw_picture(f"{page}-{layout.name}.svg", layout, stacks)
            shapes = captioned_shapes(narrowed_family, interface, layout)
            pictures[f"wide-{layout.name}"] = Picture(
                name=f"{page}-{layout.name}-wide.svg",
                text=text_alternative(stacks),
                svg=wide_picture(title_of(layout), shapes),
            )
    for register in narrowed_family.registers:
        depends_on_order_code = len(register_stacks(family_device, register)) > 1
        if depends_on_order_code and has_picture(register):
            stacks = _without_single_caption(register_stacks(narrowed_family, register))
            key = _register_key(register)
            pictures[key] = _draw_picture(f"{page}-{key}.svg", register, stacks)
    return pictures


def _layout_key(layout: Layout) -> str:
    """Return the key of the picture of a frame."""
    return f"layout-{layout.name}"


def _register_key(register: Register) -> str:
    """Return the key of the picture of a register."""
    return f"register-{register.name}"


def _draw_picture(file_name: str, titled: Titled, stacks: Sequence[Stack]) -> Picture:
    """Return the picture of a frame, group or register. ``stacks`` are its shapes, as rows of bytes."""
    svg = stacks_picture(title_of(titled), stacks)
    return Picture(name=file_name, text=text_alternative(stacks), svg=svg)


def _draw_shortest_and_longest(file_name: str, layout: Layout, stacks: Sequence[Stack]) -> Picture:
    """Return a picture of all shapes of a layout or, if there are many, of only the shortest and the longest."""
    if len(stacks) <= MOST_SHAPES:
        return _draw_picture(file_name, layout, stacks)
    shortest, longest = stacks[0], stacks[-1]
    picture = _draw_picture(file_name, layout, [shortest, longest])
    note = (
        f"The picture has the shortest and the longest of {len(stacks)} frames. The table of positions has all of them."
    )
    return replace(picture, note=note)


def _without_single_caption(stacks: Sequence[Stack]) -> list[Stack]:
    """Return shapes as they are or, if there is only one, this shape without its caption."""
    return [replace(stacks[0], caption="")] if len(stacks) == 1 else list(stacks)


def stacks_picture(title: str, stacks: Sequence[Stack]) -> str:
    """Return a picture with several frames, one below the other. Names that do not fit a box are below its row."""
    body: list[str] = []
    top = _MARGIN
    for stack in stacks:
        caption_lines = wrap_to_width(stack.caption, _ROOM, _CAPTION_SIZE * _CAPTION_WIDTH_FACTOR)
        for caption_line in caption_lines:
            body.append(draw_text(caption_line, x=_MARGIN, y=top + 13, size=_CAPTION_SIZE, anchor="start", bold=True))
            top += _NAME_LINE_HEIGHT + 4
        for row in stack.rows:
            body += _row_elements(row, top)
            top += _BOX_HEIGHT
            lines_below = _lines_below(row)
            for fill, text_line in lines_below:
                if fill:
                    body.append(draw_box(left=_MARGIN, top=top + 5, box_width=10, box_height=10, fill=fill))
                body.append(draw_text(text_line, x=_MARGIN + _INDENT, y=top + 14, size=_TEXT_SIZE, anchor="start"))
                top += _NAME_LINE_HEIGHT
            top += 6 if lines_below else 0
        top += _STACK_GAP
    height = top - _STACK_GAP + _MARGIN
    return create_picture(title, body, width=PICTURE_WIDTH, height=height, description=text_alternative(stacks))


def _row_elements(row: ByteRow, top: float) -> Iterator[str]:
    """Yield the elements of a byte: its name, and its boxes with their names and bit numbers."""
    middle = top + _BOX_HEIGHT / 2
    if row.label:
        yield draw_text(row.label, x=_MARGIN, y=middle + 4, size=_TEXT_SIZE, anchor="start", faint=True)
    for box in row.boxes:
        # Bit 7 is at the left.
        left = _MARGIN + _LABEL_WIDTH + (7 - box.high) * _BIT_WIDTH
        box_width = _width_of_box(box)
        yield draw_box(left=left, top=top, box_width=box_width, box_height=_BOX_HEIGHT, fill=box.fill)
        name_lines = _lines_inside(box)
        number_of_lines = len(name_lines) + bool(box.place)
        center = left + box_width / 2
        # The lines are 14 pixels apart and centered in the box.
        baseline = middle + 4.5 - 7 * (number_of_lines - 1)
        for name_line in name_lines:
            yield draw_text(name_line, x=center, y=baseline, size=_TEXT_SIZE, anchor="middle")
            baseline += 14
        if box.place:
            yield draw_text(box.place, x=center, y=baseline, size=_TEXT_SIZE, anchor="middle", faint=True)


def _width_of_box(box: Box) -> float:
    """Return the width of a box in pixels."""
    return (box.high - box.low + 1) * _BIT_WIDTH


def _lines_inside(box: Box) -> list[str]:
    """Return the lines of a name inside its box, or no lines if the name goes below the row.

    A name goes into its box if it fits on one line, or on two lines without breaking a word if the box has no bit
    numbers. The names of active-low flags always go below.
    """
    if box.active_low:
        return []
    name_lines = wrap_to_width(box.name, _width_of_box(box) - 4, _TEXT_SIZE)
    has_whole_words = " ".join(name_lines) == box.name
    fits_on_two_lines = len(name_lines) == 2 and not box.place and has_whole_words
    return name_lines if len(name_lines) == 1 or fits_on_two_lines else []


def _lines_below(row: ByteRow) -> list[tuple[str, str]]:
    """Return the color class and the text of each line below a row, for names that do not fit their boxes.

    The color class is empty for the second and further lines of a name.
    """
    colours_and_lines = []
    for box in row.boxes:
        if not _lines_inside(box):
            first_line, *further_lines = wrap_to_width(_name_below(box), _ROOM - _INDENT, _TEXT_SIZE)
            colours_and_lines.append((box.fill, first_line))
            colours_and_lines += [("", further_line) for further_line in further_lines]
    return colours_and_lines


def _name_below(box: Box) -> str:
    """Return the name for a line below a row, with bit numbers and active level: ``error (bit 7, 0 = active)``."""
    # A place with several bits looks like ``7:4``.
    noun = "bits" if ":" in box.place else "bit"
    bits_text = f"{noun} {box.place}" if box.place else ""
    level = "0 = active" if box.active_low else ""
    place_and_level = ", ".join(filter(None, (bits_text, level)))
    return f"{box.name} ({place_and_level})" if place_and_level else box.name


def layout_stacks(device: Device, interface: Interface, layout: Layout) -> list[Stack]:
    """Return the rows of bytes to draw for each shape of a layout, and for all answers that change the picture.

    A frame that consists of bytes has no caption if there is only one picture.
    """
    stacks_by_rows: dict[tuple[ByteRow, ...], Stack] = {}
    for answers, parameters in answer_combinations(device.alternatives_of(layout)):
        placements = distinct_placements(device, layout, interface.name, parameters)
        for stack in _stacks_of_shapes(layout, placements):
            captioned_stack = replace(stack, caption=_caption_with_answers(answers, stack.caption))
            stacks_by_rows.setdefault(stack.rows, captioned_stack)
    stacks = list(stacks_by_rows.values())
    if layout.in_bytes and len(stacks) == 1:
        return [replace(stacks[0], caption="")]
    return stacks


def _stacks_of_shapes(layout: Layout, shapes: Sequence[Placement]) -> Iterator[Stack]:
    """Yield the rows of bytes to draw for each shape, or only for the longest shape of a frame that consists of bytes.

    In such a frame, the boxes of fields include their padding, so shapes hardly differ.
    """
    if layout.in_bytes:
        # The shapes are sorted by length, so the longest is last.
        yield byte_stack("", shapes[-1].placed_layout)
        return
    for shape in shapes:
        caption = f"{_codes_caption(shape)}: {shape.placed_layout.bits} bits"
        yield bit_stack(caption, shape.placed_layout)


def captioned_shapes(device: Device, interface: Interface, layout: Layout) -> list[tuple[str, PlacedLayout]]:
    """Return each shape of a layout for one order code, with a caption that names the answers and the length.

    If there is only one shape, its caption is empty.
    """
    shapes: dict[Shape, tuple[str, PlacedLayout]] = {}
    for answers, parameters in answer_combinations(device.alternatives_of(layout)):
        for placement in distinct_placements(device, layout, interface.name, parameters):
            placed_layout = placement.placed_layout
            caption = _caption_with_answers(answers, f"{placed_layout.bits} bits")
            shapes.setdefault(shape_of(placed_layout), (caption, placed_layout))
    if len(shapes) > 1:
        return list(shapes.values())
    return [("", placed_layout) for _, placed_layout in shapes.values()]


def _caption_with_answers(answers: Sequence[Answer], caption: str) -> str:
    """Return the names of the answers and the caption, separated by commas. Either can be empty."""
    names_of_answers = [answer.name for answer in answers]
    return join_filled([*names_of_answers, caption], ", ")


def _codes_caption(placement: Placement) -> str:
    """Return the first two order codes and the number of the others: ``X-12, X-13 and 4 more``."""
    first_codes, further_codes = placement.codes[:2], placement.codes[2:]
    number_of_further_codes = f" and {len(further_codes)} more" if further_codes else ""
    return f"{', '.join(first_codes)}{number_of_further_codes}"


def group_stacks(device: Device, field_group: FieldGroup) -> list[Stack]:
    """Return the rows of bytes to draw for a group of fields, for all answers that move its fields."""
    stacks = []
    for answers, group_fields in group_shapes(device, field_group.name):
        caption = _caption_with_answers(answers, "")
        stacks.append(group_stack(caption, group_fields, field_group.bits))
    return stacks


def has_picture(register: Register) -> bool:
    """Return whether a register needs a picture: it has several fields, or one that does not fill it."""
    fields = register.layout.fields
    return len(fields) > 1 or fields[0].width != Expression(8 * register.length)


def register_stacks(device: Device, register: Register) -> list[Stack]:
    """Return the rows of bytes to draw for each shape of a register. A single shape has no caption."""
    low_byte_first = register.byte_order == "low_byte_first"
    shapes = distinct_placements(device, register.layout, register.interface)
    stacks = []
    for shape in shapes:
        caption = _codes_caption(shape) if len(shapes) > 1 else ""
        stack = register_stack(caption, shape.placed_layout, address=register.address, low_byte_first=low_byte_first)
        stacks.append(stack)
    return stacks
