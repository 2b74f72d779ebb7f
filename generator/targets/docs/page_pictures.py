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
    ByteDiagram,
    ByteRow,
    diagram_of_bits,
    diagram_of_bytes,
    diagram_of_group,
    diagram_of_register,
    text_alternative,
    wide_picture,
)
from .layout_tables import (
    FieldPositions,
    LayoutOfCodes,
    arrangements_of_group,
    distinct_layouts,
    positions_of_fields,
    used_groups,
)

_MARGIN, _TEXT_SIZE = 10.0, 12
#: Width between the margins.
_ROOM = PICTURE_WIDTH - 2 * _MARGIN
#: Heights of a contact in the picture of a connector, and of each line of its signal.
_ROW_HEIGHT, _LINE_HEIGHT = 28.0, 15.0
#: Left edges of the names of wires, of the signals in a table with wires, and of the signals in a table with only pins.
_NAME_LEFT, _SIGNAL_LEFT_AFTER_WIRES, _SIGNAL_LEFT_AFTER_PINS = 46.0, 136.0, 52.0
_BETWEEN_COLOURS = re.compile(r"[^a-z]+")
#: Measures of rows of bytes. Lines for names that do not fit into their boxes are indented after a box in their color.
_LABEL_WIDTH, _BOX_HEIGHT, _NAME_LINE_HEIGHT, _DIAGRAM_GAP, _INDENT = 50.0, 34.0, 16.0, 12.0, 16.0
_BIT_WIDTH = (_ROOM - _LABEL_WIDTH) / 8
_CAPTION_SIZE = 13
#: Factor for the width of captions, which are order codes in bold capitals.
_CAPTION_WIDTH_FACTOR = 1.2
#: Highest number of layouts of a frame in one picture.
MOST_LAYOUTS = 12
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
    elements: list[str] = []
    top = _MARGIN
    has_only_pins = all(map(_is_pin, connector.contacts))
    signal_left = _SIGNAL_LEFT_AFTER_PINS if has_only_pins else _SIGNAL_LEFT_AFTER_WIRES
    for contact in connector.contacts:
        elements += _contact_elements(contact, top)
        signal_elements = list(_signal_elements(contact, left=signal_left, top=top))
        elements += signal_elements
        top += max(_ROW_HEIGHT, _LINE_HEIGHT * len(signal_elements) + 8)
    if any(map(_is_pin, connector.contacts)):
        for text_line in wrap_to_width(FACE_UNKNOWN, _ROOM, _TEXT_SIZE):
            elements.append(draw_text(text_line, x=_MARGIN, y=top + 16, size=_TEXT_SIZE, anchor="start", faint=True))
            top += _LINE_HEIGHT
    return create_picture(
        connector.title,
        elements,
        width=PICTURE_WIDTH,
        height=top + _MARGIN,
        description=connector_text(connector),
    )


def _signal_elements(contact: Contact, *, left: float, top: float) -> Iterator[str]:
    """Yield the lines of text for the signal of a contact and, in a faint color, for its order codes."""
    available_width = PICTURE_WIDTH - _MARGIN - left
    baseline = top + 18
    for signal_line in wrap_to_width(contact.signal, available_width, _TEXT_SIZE):
        yield draw_text(signal_line, x=left, y=baseline, size=_TEXT_SIZE, anchor="start")
        baseline += _LINE_HEIGHT
    if contact.only:
        for order_codes_line in wrap_to_width(f"only {contact.only}", available_width, _TEXT_SIZE):
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
    if all(colour_word in wire_colours for colour_word in colour_words):
        colour_width = 28.0 / len(colour_words)
        for index, colour_word in enumerate(colour_words):
            yield draw_swatch(
                left=_MARGIN + colour_width * index,
                top=top + 5,
                box_width=colour_width,
                box_height=18,
                colour=wire_colours[colour_word],
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
        diagrams = layout_diagrams(device, interface, layout)
        pictures[_layout_key(layout)] = _draw_shortest_and_longest(f"{layout.name}.svg", layout, diagrams)
    group_by_name = {group.name: group for group in device.field_groups}
    for interface in device.interfaces:
        for group_name in used_groups(interface):
            field_group = group_by_name[group_name]
            diagrams = group_diagrams(device, field_group)
            pictures[f"group-{group_name}"] = _draw_picture(f"{group_name}.svg", field_group, diagrams)
    for register in device.registers:
        if has_picture(register):
            picture_key = _register_key(register)
            diagrams = register_diagrams(device, register)
            pictures[picture_key] = _draw_picture(f"{picture_key}.svg", register, diagrams)
    for connector in device.connectors:
        picture_key = f"connector-{connector.name}"
        pictures[picture_key] = Picture(
            name=f"{picture_key}.svg",
            text=connector_text(connector),
            svg=connector_picture(connector),
        )
    return pictures


def pictures_of_order_codes(
    family_device: Device, narrowed_family: Device, page_name: str, frame_name: str
) -> Pictures:
    """Return the pictures that the page of some order codes shows in place of the family's pictures.

    These are the pictures of the layout ``frame_name`` (with a row for each byte, and on one line), and of registers
    whose fields depend on the order code. ``narrowed_family`` is the family with only these order codes.
    """
    pictures: Pictures = {}
    for interface, layout in narrowed_family.layouts():
        if layout.name == frame_name:
            diagrams = _without_single_caption(layout_diagrams(narrowed_family, interface, layout))
            family_diagrams = layout_diagrams(family_device, interface, layout)
            # The picture of the family has captions for a frame that consists of bits, so this picture always differs.
            if not layout.in_bytes or diagrams != family_diagrams:
                pictures[_layout_key(layout)] = _draw_picture(f"{page_name}-{layout.name}.svg", layout, diagrams)
            layouts_with_captions = captioned_layouts(narrowed_family, interface, layout)
            pictures[f"wide-{layout.name}"] = Picture(
                name=f"{page_name}-{layout.name}-wide.svg",
                text=text_alternative(diagrams),
                svg=wide_picture(title_of(layout), layouts_with_captions),
            )
    for register in narrowed_family.registers:
        depends_on_order_code = len(register_diagrams(family_device, register)) > 1
        if depends_on_order_code and has_picture(register):
            diagrams = _without_single_caption(register_diagrams(narrowed_family, register))
            picture_key = _register_key(register)
            pictures[picture_key] = _draw_picture(f"{page_name}-{picture_key}.svg", register, diagrams)
    return pictures


def _layout_key(layout: Layout) -> str:
    """Return the key of the picture of a frame."""
    return f"layout-{layout.name}"


def _register_key(register: Register) -> str:
    """Return the key of the picture of a register."""
    return f"register-{register.name}"


def _draw_picture(file_name: str, titled: Titled, diagrams: Sequence[ByteDiagram]) -> Picture:
    """Return the picture of a frame, group or register. ``diagrams`` are its layouts, as rows of bytes."""
    svg = picture_of_diagrams(title_of(titled), diagrams)
    return Picture(name=file_name, text=text_alternative(diagrams), svg=svg)


def _draw_shortest_and_longest(file_name: str, layout: Layout, diagrams: Sequence[ByteDiagram]) -> Picture:
    """Return a picture of all diagrams of a frame or, if there are many, of only the shortest and the longest."""
    if len(diagrams) <= MOST_LAYOUTS:
        return _draw_picture(file_name, layout, diagrams)
    shortest, longest = diagrams[0], diagrams[-1]
    picture = _draw_picture(file_name, layout, [shortest, longest])
    omission = f"The picture has the shortest and the longest of {len(diagrams)} frames."
    return replace(picture, note=f"{omission} The table of positions has all of them.")


def _without_single_caption(diagrams: Sequence[ByteDiagram]) -> list[ByteDiagram]:
    """Return the diagrams as they are or, if there is only one, this diagram without its caption."""
    return [replace(diagrams[0], caption="")] if len(diagrams) == 1 else list(diagrams)


def picture_of_diagrams(title: str, diagrams: Sequence[ByteDiagram]) -> str:
    """Return a picture with several frames, one below the other. Names that do not fit a box are below its row."""
    elements: list[str] = []
    top = _MARGIN
    for diagram in diagrams:
        caption_lines = wrap_to_width(diagram.caption, _ROOM, _CAPTION_SIZE * _CAPTION_WIDTH_FACTOR)
        for caption_line in caption_lines:
            elements.append(
                draw_text(caption_line, x=_MARGIN, y=top + 13, size=_CAPTION_SIZE, anchor="start", bold=True)
            )
            top += _NAME_LINE_HEIGHT + 4
        for row in diagram.rows:
            elements += _row_elements(row, top)
            top += _BOX_HEIGHT
            lines_below = _lines_below(row)
            for colour, text_line in lines_below:
                if colour:
                    elements.append(draw_box(left=_MARGIN, top=top + 5, box_width=10, box_height=10, fill=colour))
                elements.append(draw_text(text_line, x=_MARGIN + _INDENT, y=top + 14, size=_TEXT_SIZE, anchor="start"))
                top += _NAME_LINE_HEIGHT
            top += 6 if lines_below else 0
        top += _DIAGRAM_GAP
    height = top - _DIAGRAM_GAP + _MARGIN
    return create_picture(title, elements, width=PICTURE_WIDTH, height=height, description=text_alternative(diagrams))


def _row_elements(row: ByteRow, top: float) -> Iterator[str]:
    """Yield the elements of a byte: its name, and its boxes with their names and bit numbers."""
    middle = top + _BOX_HEIGHT / 2
    if row.label:
        yield draw_text(row.label, x=_MARGIN, y=middle + 4, size=_TEXT_SIZE, anchor="start", faint=True)
    for box in row.boxes:
        # Bit 7 is at the left.
        left = _MARGIN + _LABEL_WIDTH + (7 - box.highest_bit) * _BIT_WIDTH
        box_width = _width_of_box(box)
        yield draw_box(left=left, top=top, box_width=box_width, box_height=_BOX_HEIGHT, fill=box.colour)
        name_lines = _lines_inside(box)
        line_count = len(name_lines) + bool(box.printed_bits)
        center = left + box_width / 2
        # The lines are 14 pixels apart and centered in the box.
        baseline = middle + 4.5 - 7 * (line_count - 1)
        for name_line in name_lines:
            yield draw_text(name_line, x=center, y=baseline, size=_TEXT_SIZE, anchor="middle")
            baseline += 14
        if box.printed_bits:
            yield draw_text(box.printed_bits, x=center, y=baseline, size=_TEXT_SIZE, anchor="middle", faint=True)


def _width_of_box(box: Box) -> float:
    """Return the width of a box in pixels."""
    return (box.highest_bit - box.lowest_bit + 1) * _BIT_WIDTH


def _lines_inside(box: Box) -> list[str]:
    """Return the lines of a name inside its box, or no lines if the name goes below the row.

    A name goes into its box if it fits on one line, or on two lines without breaking a word if the box has no bit
    numbers. The names of active-low flags always go below.
    """
    if box.is_active_low:
        return []
    name_lines = wrap_to_width(box.name, _width_of_box(box) - 4, _TEXT_SIZE)
    has_whole_words = " ".join(name_lines) == box.name
    fits_on_two_lines = len(name_lines) == 2 and not box.printed_bits and has_whole_words
    return name_lines if len(name_lines) == 1 or fits_on_two_lines else []


def _lines_below(row: ByteRow) -> list[tuple[str, str]]:
    """Return the color class and the text of each line below a row, for names that do not fit their boxes.

    The color class is empty for the second and further lines of a name.
    """
    colours_and_lines = []
    for box in row.boxes:
        if not _lines_inside(box):
            first_line, *further_lines = wrap_to_width(_name_below(box), _ROOM - _INDENT, _TEXT_SIZE)
            colours_and_lines.append((box.colour, first_line))
            colours_and_lines += [("", further_line) for further_line in further_lines]
    return colours_and_lines


def _name_below(box: Box) -> str:
    """Return the name for a line below a row, with bit numbers and active level: ``error (bit 7, 0 = active)``."""
    # A place with several bits looks like ``7:4``.
    noun = "bits" if ":" in box.printed_bits else "bit"
    bits_text = f"{noun} {box.printed_bits}" if box.printed_bits else ""
    active_level_text = "0 = active" if box.is_active_low else ""
    place_and_level = ", ".join(filter(None, (bits_text, active_level_text)))
    return f"{box.name} ({place_and_level})" if place_and_level else box.name


def layout_diagrams(device: Device, interface: Interface, layout: Layout) -> list[ByteDiagram]:
    """Return the rows of bytes to draw for each arrangement of the fields, and for all answers that change the picture.

    A frame that consists of bytes has no caption if there is only one picture.
    """
    diagram_by_rows: dict[tuple[ByteRow, ...], ByteDiagram] = {}
    for answers, parameters in answer_combinations(device.alternatives_of(layout)):
        layouts_of_codes = distinct_layouts(device, layout, interface.name, parameters)
        for diagram in _diagrams_of_layouts(layout, layouts_of_codes):
            captioned_diagram = replace(diagram, caption=_caption_with_answers(answers, diagram.caption))
            diagram_by_rows.setdefault(diagram.rows, captioned_diagram)
    diagrams = list(diagram_by_rows.values())
    if layout.in_bytes and len(diagrams) == 1:
        return [replace(diagrams[0], caption="")]
    return diagrams


def _diagrams_of_layouts(layout: Layout, layouts_of_codes: Sequence[LayoutOfCodes]) -> Iterator[ByteDiagram]:
    """Yield the diagram of each layout, or only of the longest layout of a frame that consists of bytes.

    In such a frame, the boxes of fields include their padding, so layouts hardly differ.
    """
    if layout.in_bytes:
        # The layouts are sorted by length, so the longest is last.
        yield diagram_of_bytes("", layouts_of_codes[-1].placed_layout)
        return
    for layout_of_codes in layouts_of_codes:
        caption = f"{_codes_caption(layout_of_codes)}: {layout_of_codes.placed_layout.bits} bits"
        yield diagram_of_bits(caption, layout_of_codes.placed_layout)


def captioned_layouts(device: Device, interface: Interface, layout: Layout) -> list[tuple[str, PlacedLayout]]:
    """Return each arrangement of the fields for one order code, with a caption that names the answers and the length.

    If there is only one, its caption is empty.
    """
    captions_and_layouts: dict[FieldPositions, tuple[str, PlacedLayout]] = {}
    for answers, parameters in answer_combinations(device.alternatives_of(layout)):
        for layout_of_codes in distinct_layouts(device, layout, interface.name, parameters):
            placed_layout = layout_of_codes.placed_layout
            caption = _caption_with_answers(answers, f"{placed_layout.bits} bits")
            captions_and_layouts.setdefault(positions_of_fields(placed_layout), (caption, placed_layout))
    if len(captions_and_layouts) > 1:
        return list(captions_and_layouts.values())
    return [("", placed_layout) for _, placed_layout in captions_and_layouts.values()]


def _caption_with_answers(answers: Sequence[Answer], caption: str) -> str:
    """Return the names of the answers and the caption, separated by commas. Either can be empty."""
    names_of_answers = [answer.name for answer in answers]
    return join_filled([*names_of_answers, caption], ", ")


def _codes_caption(layout_of_codes: LayoutOfCodes) -> str:
    """Return the first two order codes and the number of the others: ``X-12, X-13 and 4 more``."""
    first_codes, further_codes = layout_of_codes.codes[:2], layout_of_codes.codes[2:]
    number_of_further_codes = f" and {len(further_codes)} more" if further_codes else ""
    return f"{', '.join(first_codes)}{number_of_further_codes}"


def group_diagrams(device: Device, field_group: FieldGroup) -> list[ByteDiagram]:
    """Return the rows of bytes to draw for a group of fields, for all answers that move its fields."""
    diagrams = []
    for answers, group_fields in arrangements_of_group(device, field_group.name):
        caption = _caption_with_answers(answers, "")
        diagrams.append(diagram_of_group(caption, group_fields, field_group.bits))
    return diagrams


def has_picture(register: Register) -> bool:
    """Return whether a register needs a picture: it has several fields, or one that does not fill it."""
    fields = register.layout.fields
    return len(fields) > 1 or fields[0].width != Expression(8 * register.length)


def register_diagrams(device: Device, register: Register) -> list[ByteDiagram]:
    """Return the rows of bytes to draw for each arrangement of the fields of a register. One alone has no caption."""
    low_byte_first = register.byte_order == "low_byte_first"
    layouts_of_codes = distinct_layouts(device, register.layout, register.interface)
    diagrams = []
    for layout_of_codes in layouts_of_codes:
        caption = _codes_caption(layout_of_codes) if len(layouts_of_codes) > 1 else ""
        diagram = diagram_of_register(
            caption, layout_of_codes.placed_layout, address=register.address, low_byte_first=low_byte_first
        )
        diagrams.append(diagram)
    return diagrams
