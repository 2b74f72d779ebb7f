"""SVG pictures of frames on one line, with a ruler of bits or bytes, for screens that are wide enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from ...model import PlacedLayout
from ...model.record import dataclass
from ...say.names_and_places import bit_range
from .layout_pictures import (
    Stack,
    bit_stack,
    byte_stack,
    create_picture,
    draw_box,
    draw_text,
    number,
    runs_of,
    text_alternative,
    text_width,
)

#: Width of the picture, and of the narrowest screen that shows it instead of the picture with a row for each byte.
PICTURE_WIDTH, NARROWEST_SCREEN = 720.0, 700
_MARGIN, _RULER_HEIGHT, _BOX_HEIGHT, _LINE_HEIGHT, _TEXT_SIZE = 8.0, 24.0, 44.0, 18.0, 11
#: Average width of a letter as a fraction of the font size.
_LETTER_WIDTH = 0.54


@dataclass(frozen=True, slots=True)
class _Cell:
    """Box between ``left`` and ``right``, in pixels. ``about`` is its text below the line if its name does not fit."""

    left: float
    right: float
    name: str
    place: str
    about: str
    fill: str

    @property
    def lines(self) -> list[str]:
        """Lines of text inside the box: its name, then its place if it has one.

        The box stays empty if a word is wider than the box, or if the name needs more than two lines.
        """
        # The text keeps a distance of 2 pixels from each side.
        letters_per_line = int((self.right - self.left - 4) / (_TEXT_SIZE * _LETTER_WIDTH))
        longest_word = max(len(word) for word in (*self.name.split(" "), self.place))
        if longest_word > letters_per_line:
            return []
        name_lines = wrap(self.name, letters_per_line)
        if len(name_lines) > 2:
            return []
        return [*name_lines, self.place] if self.place else name_lines


def wide_picture(title: str, shapes: Sequence[tuple[str, PlacedLayout]]) -> str:
    """Return the picture of a frame, with the first bit or byte on the left.

    If the frame has several shapes, they are drawn one below the other, each with its caption.
    """
    body: list[str] = []
    stacks: list[Stack] = []
    top = _MARGIN
    for caption, placed_layout in shapes:
        in_bytes = placed_layout.layout.in_bytes
        stack = byte_stack(caption, placed_layout) if in_bytes else bit_stack(caption, placed_layout)
        stacks.append(stack)
        if caption:
            body.append(draw_text(caption, x=_MARGIN, y=top + 13, size=_TEXT_SIZE, anchor="start", bold=True))
            top += _LINE_HEIGHT
        elements, top = _frame_elements(placed_layout, stack, top)
        body += elements
    return create_picture(title, body, width=PICTURE_WIDTH, height=top, description=text_alternative(stacks))


def _frame_elements(placed_layout: PlacedLayout, stack: Stack, top: float) -> tuple[list[str], float]:
    """Return the elements of one frame that starts at ``top``, and the top of the next frame."""
    box_top = top + _RULER_HEIGHT
    if placed_layout.layout.in_bytes:
        cells = list(_byte_cells(stack))
        ruler_marks = list(_byte_marks(stack))
    else:
        cells = list(_bit_cells(placed_layout))
        ruler_marks = list(_bit_marks(placed_layout))
    elements: list[str] = []
    for x, mark_text, anchor in ruler_marks:
        elements.append(draw_text(mark_text, x=x, y=top + 12, size=_TEXT_SIZE, anchor=anchor, faint=True))
    for cell in cells:
        elements += _cell_elements(cell, box_top)
    if not placed_layout.layout.in_bytes:
        ticks_path = _ruler_ticks(placed_layout.bits, box_top)
        elements.append(f'<path d="{ticks_path}" class="line"/>')
    bottom = box_top + _BOX_HEIGHT
    for line_bottom, element in _names_below(cells, bottom + 4):
        elements.append(element)
        bottom = max(bottom, line_bottom)
    return elements, bottom + _MARGIN


def _cell_elements(cell: _Cell, top: float) -> Iterator[str]:
    """Yield the box of a cell and the lines inside it. If the cell has a place, the last line shows it."""
    yield draw_box(left=cell.left, top=top, box_width=cell.right - cell.left, box_height=_BOX_HEIGHT, fill=cell.fill)
    center = (cell.left + cell.right) / 2
    last_index = len(cell.lines) - 1
    # The lines are 14 pixels apart and centered in the box.
    baseline = top + _BOX_HEIGHT / 2 + 4.5 - 7 * last_index
    for index, box_text in enumerate(cell.lines):
        is_place = bool(cell.place) and index == last_index
        yield draw_text(box_text, x=center, y=baseline, size=_TEXT_SIZE, anchor="middle", faint=is_place)
        baseline += 14


def _bit_cells(placed_layout: PlacedLayout) -> Iterator[_Cell]:
    """Yield the box of each field in a frame that consists of bits."""
    bit_width = _bit_width(placed_layout.bits)
    for run in runs_of(placed_layout):
        left = _MARGIN + (placed_layout.bits - 1 - run.high) * bit_width
        # The ruler above the box shows its bit numbers, so only the text below the line names them.
        noun = "bits" if run.high > run.low else "bit"
        place = f"{noun} {bit_range(run.high, run.low)}"
        level = ", 0 = active" if run.active_low else ""
        yield _Cell(
            left=left,
            right=left + (run.high - run.low + 1) * bit_width,
            name=f"{run.name}{level}",
            place="",
            about=f"{run.name} ({place}{level})",
            fill=run.fill,
        )


def _byte_cells(stack: Stack) -> Iterator[_Cell]:
    """Yield the boxes of each byte in a frame that consists of bytes. The highest bit of a byte is on its left."""
    byte_width = _byte_width(stack)
    for index, row in enumerate(stack.rows):
        for box in row.boxes:
            # Bit 7 is at the left of its byte.
            left = _MARGIN + byte_width * (index + (7 - box.high) / 8)
            spaced_place = f" {box.place}" if box.place else ""
            yield _Cell(
                left=left,
                right=left + byte_width * (box.high - box.low + 1) / 8,
                name=box.name,
                place=box.place,
                about=f"{box.name}{spaced_place} ({row.label})",
                fill=box.fill,
            )


def _bit_width(bits: int) -> float:
    """Return the width of one bit, in pixels, for a frame of this many bits."""
    return (PICTURE_WIDTH - 2 * _MARGIN) / bits


def _byte_width(stack: Stack) -> float:
    """Return the width of one byte, in pixels."""
    return (PICTURE_WIDTH - 2 * _MARGIN) / len(stack.rows)


def _bit_marks(placed_layout: PlacedLayout) -> Iterator[tuple[float, str, str]]:
    """Yield the x position, text and alignment of the ruler's numbers: the first and the last bit of each box."""
    bit_width = _bit_width(placed_layout.bits)
    for run in runs_of(placed_layout):
        left = _MARGIN + (placed_layout.bits - 1 - run.high) * bit_width
        right = _MARGIN + (placed_layout.bits - run.low) * bit_width
        if run.high == run.low:
            yield (left + right) / 2, f"{run.high}", "middle"
        else:
            yield left + 2, f"{run.high}", "start"
            yield right - 2, f"{run.low}", "end"


def _byte_marks(stack: Stack) -> Iterator[tuple[float, str, str]]:
    """Yield the x position, text and alignment of the name of each byte."""
    byte_width = _byte_width(stack)
    for index, row in enumerate(stack.rows):
        yield _MARGIN + byte_width * (index + 0.5), row.label, "middle"


def _ruler_ticks(bits: int, top: float) -> str:
    """Return the path of the ruler's ticks. Every eighth tick is longer, counted from the lowest bit."""
    ticks = []
    for index in range(bits + 1):
        x = _MARGIN + index * _bit_width(bits)
        height = 8 if (bits - index) % 8 == 0 else 4
        ticks.append(f"M{number(x)} {number(top)}v-{height}")
    return " ".join(ticks)


def _names_below(cells: Sequence[_Cell], top: float) -> Iterator[tuple[float, str]]:
    """Yield the elements for names that do not fit into their boxes, each with the bottom of its line.

    Names are side by side, in as many lines as needed. Each has a small box in its color in front of it.
    """
    left = _MARGIN
    for cell in cells:
        if not cell.lines:
            # The color box with its gap takes 16 pixels, and 16 more follow the text.
            width_with_box = 16 + text_width(cell.about, _TEXT_SIZE) + 16
            is_line_full = left + width_with_box > PICTURE_WIDTH - _MARGIN
            if is_line_full and left > _MARGIN:
                left = _MARGIN
                top += _LINE_HEIGHT
            bottom = top + _LINE_HEIGHT
            yield bottom, draw_box(left=left, top=top + 4, box_width=10, box_height=10, fill=cell.fill)
            yield bottom, draw_text(cell.about, x=left + 16, y=top + 13, size=_TEXT_SIZE, anchor="start")
            left += width_with_box
