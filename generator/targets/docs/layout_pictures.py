"""Contents of the pictures of frames and registers as rows of bytes, and the SVG elements that all pictures share.

A picture is as wide as the screen of a phone, so that its text is readable there and next to a table. Its background
follows the light or dark color scheme of the screen. Each picture has a description in words.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from textwrap import wrap

from ...model import Field, PlacedField, PlacedLayout
from ...model.record import dataclass
from ...plan.values import ActiveFlag, meaning_of
from ...say.layout import box_colour, box_label, name_as_words
from ...say.names_and_places import bit_range
from ...say.plain_text import text_on_one_line
from ..registry import palette

#: Width in pixels that fits on the screen of a phone: 375 minus the margins of a page.
PICTURE_WIDTH = 340.0
#: Average character width of sans-serif fonts as a fraction of the font size, rounded up to be safe.
_LETTER_WIDTH = 0.58
#: Class of an element, CSS property, and name of the color in the palette.
_CLASS_COLOURS = (
    ("card", "fill", "page"),
    ("card", "stroke", "border"),
    ("ink", "fill", "ink"),
    ("faint", "fill", "soft-ink"),
    ("line", "stroke", "line"),
    ("wave", "stroke", "ink"),
    *((kind, "fill", f"bits-{kind}") for kind in ("data", "group", "flag", "check", "fixed", "choice", "nothing")),
)


def _style_element() -> str:
    """Return the style sheet of a picture, with the colors of its classes for light and dark screens."""
    colours = palette()
    light = "".join(
        f".{name}{{{css_property}:{colours.light[colour]}}}" for name, css_property, colour in _CLASS_COLOURS
    )
    dark = "".join(
        f".{name}{{{css_property}:{colours.on_dark(colour)}}}" for name, css_property, colour in _CLASS_COLOURS
    )
    always = f".line,.wave{{fill:none}}rect{{stroke:{colours.light['line']}}}"
    return f"<style>{always}{light}@media(prefers-color-scheme:dark){{{dark}}}</style>"


def create_picture(title: str, body: Sequence[str], width: float, height: float, description: str) -> str:
    """Return an SVG picture of this size. ``body`` are its elements, and ``description`` is its text alternative."""
    picture_width, picture_height = number(width), number(height)
    label = html.escape(text_on_one_line(title))
    svg_start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{picture_width}" height="{picture_height}" '
        f'viewBox="0 0 {picture_width} {picture_height}" role="img" '
        f'aria-label="{label}" '
        'font-family="system-ui, -apple-system, Segoe UI, Helvetica, Arial, sans-serif">'
    )
    descriptions = [f"<title>{_escape_xml(title)}</title>", f"<desc>{_escape_xml(description)}</desc>"]
    # Half a pixel inside the picture on each side, so that the border is fully visible.
    background_size = f'width="{number(width - 1)}" height="{number(height - 1)}"'
    background = f'<rect x="0.5" y="0.5" {background_size} rx="6" class="card"/>'
    return "\n".join([svg_start, *descriptions, _style_element(), background, *body, "</svg>", ""])


def _escape_xml(words: str) -> str:
    """Return text for the content of an element, with the markup of XML escaped."""
    return html.escape(text_on_one_line(words), quote=False)


def draw_box(*, left: float, top: float, box_width: float, box_height: float, fill: str) -> str:
    """Return a rectangle. ``fill`` is its color class."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(left)}" y="{number(top)}" {size} class="{fill}"/>'


def draw_swatch(*, left: float, top: float, box_width: float, box_height: float, colour: str) -> str:
    """Return a rectangle in a color that is the same on light and dark screens, such as the color of a wire."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(left)}" y="{number(top)}" {size} fill="{colour}"/>'


def draw_text(
    words: str, *, x: float, y: float, size: int, anchor: str, faint: bool = False, bold: bool = False
) -> str:
    """Return a line of text. ``anchor`` says which part of it is at ``x``: its ``start``, ``middle`` or ``end``."""
    weight = ' font-weight="600"' if bold else ""
    colour = "faint" if faint else "ink"
    attributes = f'font-size="{size}" text-anchor="{anchor}" class="{colour}"{weight}'
    return f'<text x="{number(x)}" y="{number(y)}" {attributes}>{_escape_xml(words)}</text>'


def text_width(words: str, size: float) -> float:
    """Return an upper estimate of the width of a line of text."""
    return len(words) * size * _LETTER_WIDTH


def wrap_to_width(words: str, room: float, size: float) -> list[str]:
    """Return text as lines of at most ``room`` pixels, with at least one character per line."""
    letters_per_line = int(room / (size * _LETTER_WIDTH))
    return wrap(text_on_one_line(words), max(1, letters_per_line))


def number(value: float) -> str:
    """Return a number with at most one decimal, so that it is identical on every machine."""
    return f"{value:.1f}".removesuffix(".0")


_GROUP, _NOTHING = "group", "nothing"


@dataclass(frozen=True)
class Box:
    """Bits of a field within one byte, which a picture shows as a box.

    ``high`` and ``low`` are bit numbers in the byte. ``place`` has the bit numbers to print, and ``fill`` is the color
    class. ``active_low`` marks a flag that is active at 0.
    """

    high: int
    low: int
    name: str
    place: str
    fill: str
    active_low: bool = False


@dataclass(frozen=True)
class ByteRow:
    """Byte as a row of boxes, with the highest bit on the left. ``label`` is the name of the byte."""

    label: str
    boxes: tuple[Box, ...]


@dataclass(frozen=True)
class Stack:
    """Bytes of a frame or register, one below the other, under a caption. ``text`` describes them in words."""

    caption: str
    rows: tuple[ByteRow, ...]
    text: str


@dataclass(frozen=True)
class _BitRun:
    """Consecutive bits: a field, a group of fields, or bits outside all fields. ``fill`` is their color class."""

    high: int
    low: int
    name: str
    fill: str
    active_low: bool = False

    def is_in_byte(self, byte_low: int) -> bool:
        """Return whether any of the bits are in the byte that begins at ``byte_low``."""
        return self.low < byte_low + 8 and self.high >= byte_low

    def box(self, byte_low: int, place: str) -> Box:
        """Return the box for the bits in the byte that begins at ``byte_low``. ``place`` is the text to print in it."""
        return Box(
            high=min(self.high, byte_low + 7) - byte_low,
            low=max(self.low, byte_low) - byte_low,
            name=self.name,
            place=place,
            fill=self.fill,
            active_low=self.active_low,
        )

    def bits_in_byte(self, byte_low: int, origin: int = 0) -> str:
        """Return the bit numbers of the bits in the byte that begins at ``byte_low``, counted from ``origin``."""
        return bit_range(min(self.high, byte_low + 7) - origin, max(self.low, byte_low) - origin)


def bit_stack(caption: str, placed_layout: PlacedLayout) -> Stack:
    """Return a frame that consists of bits as one number, with a row for each byte, highest bits first."""
    bit_runs = runs_of(placed_layout)
    highest_bit = placed_layout.bits - 1
    # The lowest bit of each byte of the number: 16, 8, 0 for 20 bits, whose first byte has only four of them.
    lowest_bits = range(highest_bit // 8 * 8, -1, -8)
    labels = [bit_range(min(low + 7, highest_bit), low) for low in lowest_bits]
    return Stack(
        caption=caption,
        rows=_byte_rows(bit_runs, lowest_bits, labels),
        text=f"{placed_layout.bits} bits: {_runs_text(bit_runs)}",
    )


def register_stack(caption: str, placed_layout: PlacedLayout, address: int, low_byte_first: bool) -> Stack:
    """Return a register with a row for each byte, in address order. Bits are numbered in the whole register."""
    bit_runs = runs_of(placed_layout)
    lowest_bits = _lowest_bits(placed_layout.bits, low_byte_first)
    byte_addresses = [f"{address + index:02X}h" for index in range(len(lowest_bits))]
    place = byte_addresses[0]
    if len(byte_addresses) > 1:
        place += ", low byte first" if low_byte_first else ", high byte first"
    return Stack(
        caption=caption,
        rows=_byte_rows(bit_runs, lowest_bits, byte_addresses),
        text=f"{place}: {_runs_text(bit_runs)}",
    )


def byte_stack(caption: str, placed_layout: PlacedLayout) -> Stack:
    """Return a frame that consists of bytes, with a row for each byte, in the order of transmission.

    A group of fields has a single box in each byte, and so has a field with its padding. If they span several bytes,
    their bits are numbered in the number that these bytes form.
    """
    bit_runs = _runs_with_groups_merged(placed_layout)
    byte_rows = []
    descriptions = []
    # ``byte_low`` is the lowest bit of the byte in the number that the frame forms.
    for index, byte_low in enumerate(placed_layout.layout.lowest_bits_of_bytes):
        runs_in_byte = [run for run in bit_runs if run.is_in_byte(byte_low)]
        boxes = tuple(_box_in_byte(run, byte_low) for run in runs_in_byte)
        box_texts = [_box_text(box.name, box.place, box.active_low) for box in boxes]
        byte_rows.append(ByteRow(f"byte {index}", boxes))
        descriptions.append(f"byte {index}: {', '.join(box_texts)}")
    return Stack(caption=caption, rows=tuple(byte_rows), text="; ".join(descriptions))


def _box_in_byte(run: _BitRun, byte_low: int) -> Box:
    """Return the box for the part of a field or group in one byte of a frame.

    Its bits are numbered in the byte or, if the field or group spans several bytes, from its own lowest bit. A field or
    group that exactly fills the byte has no bit numbers.
    """
    is_within_byte = run.high < byte_low + 8 and run.low >= byte_low
    is_whole_byte = is_within_byte and run.high - run.low == 7
    if is_whole_byte:
        return run.box(byte_low, place="")
    origin = byte_low if is_within_byte else run.low
    return run.box(byte_low, run.bits_in_byte(byte_low, origin))


def group_stack(caption: str, fields: Sequence[tuple[Field, int, int]], bits: int) -> Stack:
    """Return a group of fields as rows of bytes. Each field is given with its highest and lowest bit in the group."""
    bit_runs = [_run_of_field(field, high, low) for field, high, low in fields]
    # The lowest bit of each byte, highest first: 8, 0 for 12 bits.
    lowest_bits = range((bits - 1) // 8 * 8, -1, -8)
    empty_labels = [""] * len(lowest_bits)
    return Stack(caption=caption, rows=_byte_rows(bit_runs, lowest_bits, empty_labels), text=_runs_text(bit_runs))


def text_alternative(stacks: Sequence[Stack]) -> str:
    """Return the text alternative for a picture of these frames. It describes the first ones and counts the others."""
    # To count a single one would be no shorter than to describe it.
    if len(stacks) <= _MOST_DESCRIBED + 1:
        return "; ".join(map(_stack_text, stacks))
    further_stacks = f"and {len(stacks) - _MOST_DESCRIBED} more, in the tables"
    return "; ".join([*map(_stack_text, stacks[:_MOST_DESCRIBED]), further_stacks])


#: Highest number of stacks that the text describes. The tables next to the picture describe all of them.
_MOST_DESCRIBED = 4


def _stack_text(stack: Stack) -> str:
    """Return the description of one frame, with its caption."""
    if not stack.caption:
        return stack.text
    # The caption of a frame ends with its number of bits, so its text does not need to begin with the same number.
    number_of_bits = stack.caption.rpartition(": ")[2]
    text_without_number = stack.text.removeprefix(f"{number_of_bits}: ")
    return f"{stack.caption}: {text_without_number}"


def _lowest_bits(bits: int, low_byte_first: bool) -> range:
    """Return the lowest bit of each byte, in the order of the bytes. ``bits`` is a multiple of 8."""
    return range(0, bits, 8) if low_byte_first else range(bits - 8, -1, -8)


def _byte_rows(bit_runs: Sequence[_BitRun], lowest_bits: Sequence[int], labels: Sequence[str]) -> tuple[ByteRow, ...]:
    """Return a row for each byte, with its bits numbered in the whole layout.

    ``lowest_bits`` has the lowest bit of each byte, such as 8 and 0. ``labels`` are the names of the bytes, or empty.
    """
    byte_rows = []
    for byte_low, row_label in zip(lowest_bits, labels, strict=True):
        runs_in_byte = [run for run in bit_runs if run.is_in_byte(byte_low)]
        boxes = tuple(run.box(byte_low, run.bits_in_byte(byte_low)) for run in runs_in_byte)
        byte_rows.append(ByteRow(row_label, boxes))
    return tuple(byte_rows)


def _runs_text(bit_runs: Sequence[_BitRun]) -> str:
    """Return the description of consecutive bits: ``error 7 (0 = active), position 6:0``."""
    return ", ".join(_box_text(run.name, bit_range(run.high, run.low), run.active_low) for run in bit_runs)


def _box_text(name: str, place: str, active_low: bool) -> str:
    """Return the description of some bits, such as ``error 7 (0 = active)``, or ``always 0`` for a constant."""
    # The name of constant bits is their value.
    spoken_name = f"always {name}" if name.isdecimal() else name
    level = "(0 = active)" if active_low else ""
    return " ".join(filter(None, (spoken_name, place, level)))


def runs_of(placed_layout: PlacedLayout) -> list[_BitRun]:
    """Return the fields of a layout, and the bits outside all fields, highest bits first."""
    fields = placed_layout.fields
    bit_runs = [_run_of_field(placed_field.field, placed_field.high, placed_field.low) for placed_field in fields]
    for high, low in _gaps_between_fields(placed_layout):
        bit_runs.append(_BitRun(high=high, low=low, name="no field", fill=_NOTHING))
    return sorted(bit_runs, key=lambda run: -run.high)


def _runs_with_groups_merged(placed_layout: PlacedLayout) -> list[_BitRun]:
    """Return the groups of fields and the fields with their padding, highest bits first.

    Bits outside all fields are omitted.
    """
    field_names = {placed_field.name for placed_field in placed_layout.fields}
    fields_by_group: dict[str, list[PlacedField]] = {}
    fields_by_padded_field: dict[str, list[PlacedField]] = {}
    for placed_field in placed_layout.fields:
        field = placed_field.field
        # Padding belongs to the field that it pads, unless this field has no bits for the order code.
        is_padding = field.padding_of in field_names
        if field.group:
            fields_by_group.setdefault(field.group, []).append(placed_field)
        else:
            padded_name = field.padding_of if is_padding else field.name
            fields_by_padded_field.setdefault(padded_name, []).append(placed_field)
    bit_runs = []
    for group_name, group_fields in fields_by_group.items():
        high, low = _range_of_fields(group_fields)
        bit_runs.append(_BitRun(high=high, low=low, name=name_as_words(group_name), fill=_GROUP))
    for padded_name, field_and_padding in fields_by_padded_field.items():
        high, low = _range_of_fields(field_and_padding)
        bit_runs.append(_run_of_field(placed_layout.layout.field(padded_name), high, low))
    return sorted(bit_runs, key=lambda run: -run.high)


def _range_of_fields(placed_fields: Sequence[PlacedField]) -> tuple[int, int]:
    """Return the highest and the lowest bit of several fields."""
    highest_bit = max(placed_field.high for placed_field in placed_fields)
    lowest_bit = min(placed_field.low for placed_field in placed_fields)
    return highest_bit, lowest_bit


def _run_of_field(field: Field, high: int, low: int) -> _BitRun:
    """Return the bits of a field with its label and color class."""
    return _BitRun(
        high=high,
        low=low,
        name=box_label(field),
        fill=box_colour(field),
        active_low=meaning_of(field) == ActiveFlag(low=True),
    )


def _gaps_between_fields(placed_layout: PlacedLayout) -> list[tuple[int, int]]:
    """Return the highest and lowest bit of each gap between fields, or above or below them, highest first."""
    gaps: list[tuple[int, int]] = []
    # All bits from this one upward are in fields or in listed gaps.
    covered_from = placed_layout.bits
    for placed_field in sorted(placed_layout.fields, key=lambda field: -field.high):
        bit_above_field = placed_field.high + 1
        if bit_above_field < covered_from:
            gaps.append((covered_from - 1, bit_above_field))
        covered_from = min(covered_from, placed_field.low)
    if covered_from > 0:
        gaps.append((covered_from - 1, 0))
    return gaps
