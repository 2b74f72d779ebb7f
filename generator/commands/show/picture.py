"""Picture of a frame in text: rows of boxes, one for each field."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ...model import Constant, Field, PlacedLayout
from ...say import WIDTH
from ...say.layout import bit_place
from ...say.names_and_evidence import short_number

#: Columns of a picture before its first box, with the edges of the row.
_PICTURE_MARGIN = 3


def picture(placed_layout: PlacedLayout) -> list[str]:
    """Return the lines of a picture of a frame: rows of boxes, one for each field, in transmission order.

    Each row is at most 80 columns wide.
    """
    rows_of_boxes: list[list[_Box]] = [[]]
    used_columns = _PICTURE_MARGIN
    for placed_field in placed_layout.fields:
        box_text = _box_text(placed_field.field)
        bits_text = bit_place(
            placed_layout.layout,
            bit_count=placed_layout.bits,
            highest_bit=placed_field.highest_bit,
            lowest_bit=placed_field.lowest_bit,
        )
        width = max(len(box_text), len(bits_text)) + 2  # with a space on each side
        width_with_edge = width + 1
        if rows_of_boxes[-1] and used_columns + width_with_edge > WIDTH:
            rows_of_boxes.append([])
            used_columns = _PICTURE_MARGIN
        rows_of_boxes[-1].append(_Box(text=box_text.center(width), bits_text=bits_text.center(width)))
        used_columns += width_with_edge
    lines: list[str] = []
    for boxes in rows_of_boxes:
        if boxes:
            lines += _box_lines(boxes)
    return lines


class _Box(NamedTuple):
    """A box of a picture: its text, and the bits of the field in the frame, both as wide as the box."""

    text: str
    bits_text: str


def _box_lines(boxes: Sequence[_Box]) -> list[str]:
    """Return a row of boxes, each with its text, and with its bits above it."""
    bits_line = "".join(f" {box.bits_text}" for box in boxes).rstrip()
    edge = "+".join("-" * len(box.text) for box in boxes)
    texts = "|".join(box.text for box in boxes)
    return [f"  {bits_line}", f"  +{edge}+", f"  |{texts}|", f"  +{edge}+"]


def _box_text(field: Field) -> str:
    """Return the text in the box of a field: its name, with ``= 5h`` for a constant, or only ``5h`` for padding."""
    if not isinstance(field.kind, Constant):
        return field.name
    constant = short_number(field.kind.value)
    has_no_name = bool(field.padding_of) or field.fills_gap
    return constant if has_no_name else f"{field.name} = {constant}"
