"""SVG pictures of frames as one line with a ruler of bits or bytes, for screens that are wide enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from ...model import PlacedLayout
from ...model.record import dataclass
from ...say.place import bit_range
from .layout_pictures import Stack, bit_stack, byte_stack, runs_of, told
from .svg import card, number, rect, text, width

#: Width of the picture, and of the narrowest screen on which it is shown instead of the stacked picture.
WIDE, SCREEN = 720.0, 700
_MARGIN, _RULER, _BOX, _LINE, _SIZE = 8.0, 24.0, 44.0, 18.0, 11
#: Average width of a letter as a fraction of the font size.
_LETTER = 0.54


@dataclass(frozen=True, slots=True)
class _Cell:
    """Box between ``left`` and ``right``, in pixels. ``about`` describes it below the line if its name does not fit."""

    left: float
    right: float
    name: str
    place: str
    about: str
    fill: str

    @property
    def lines(self) -> list[str]:
        """Return the lines inside the box, or none if the name does not fit."""
        letters = int((self.right - self.left - 4) / (_SIZE * _LETTER))
        words = self.name.split(" ")
        if max(map(len, [*words, self.place])) > letters:
            return []
        name_lines = wrap(self.name, letters)
        return [*name_lines, *([self.place] if self.place else [])] if len(name_lines) <= 2 else []


def wide_picture(title: str, shapes: Sequence[tuple[str, PlacedLayout]]) -> str:
    """Return the picture of a frame, with its first bit or byte on the left, once for each shape with its caption."""
    body: list[str] = []
    stacks, top = [], _MARGIN
    for caption, placed in shapes:
        stack = byte_stack(caption, placed) if placed.layout.in_bytes else bit_stack(caption, placed)
        if caption:
            body.append(text(_MARGIN, top + 13, caption, _SIZE, "start", bold=True))
            top += _LINE
        drawn, top = _line(placed, stack, top)
        body += drawn
        stacks.append(stack)
    return card(title, body, WIDE, top, told(stacks))


def _line(placed: PlacedLayout, stack: Stack, top: float) -> tuple[list[str], float]:
    """Return the elements of one line below ``top``, and the top of the next one."""
    cells = list(_bytes(stack) if placed.layout.in_bytes else _bits(placed))
    marks = _byte_marks(stack) if placed.layout.in_bytes else _bit_marks(placed)
    body = [text(x, top + 12, words, _SIZE, anchor, faint=True) for x, words, anchor in marks]
    for cell in cells:
        body.append(rect(cell.left, top + _RULER, cell.right - cell.left, _BOX, cell.fill))
        first = top + _RULER + _BOX / 2 + 4.5 - 7 * (len(cell.lines) - 1)
        for index, line in enumerate(cell.lines):
            faint = bool(cell.place) and index == len(cell.lines) - 1
            body.append(text((cell.left + cell.right) / 2, first + 14 * index, line, _SIZE, "middle", faint=faint))
    if not placed.layout.in_bytes:
        body.append(f'<path d="{_ticks(placed.bits, top + _RULER)}" class="line"/>')
    below = list(_below(cells, top + _RULER + _BOX + 4))
    body += [drawn_name for _, drawn_name in below]
    return body, max((bottom for bottom, _ in below), default=top + _RULER + _BOX) + _MARGIN


def _bits(placed: PlacedLayout) -> Iterator[_Cell]:
    bit = _bit(placed.bits)
    for run in runs_of(placed):
        cell_start = _MARGIN + (placed.bits - 1 - run.high) * bit
        place = f"bit{'s' * (run.high > run.low)} {bit_range(run.high, run.low)}"
        active = ", 0 = active" if run.active_low else ""
        about = f"{run.name} ({place}{active})"
        wide = (run.high - run.low + 1) * bit
        yield _Cell(cell_start, cell_start + wide, f"{run.name}{active}", "", about, run.fill)


def _bytes(stack: Stack) -> Iterator[_Cell]:
    """Yield the boxes of each byte. The parts of a byte have its highest bit on the left."""
    byte = (WIDE - 2 * _MARGIN) / len(stack.rows)
    for index, row in enumerate(stack.rows):
        for box in row.boxes:
            cell_start = _MARGIN + byte * (index + (7 - box.high) / 8)
            bits = f" {box.place}" if box.place else ""
            cell_end = cell_start + byte * (box.high - box.low + 1) / 8
            yield _Cell(cell_start, cell_end, box.name, box.place, f"{box.name}{bits} ({row.label})", box.fill)


def _bit(bits: int) -> float:
    return (WIDE - 2 * _MARGIN) / bits


def _bit_marks(placed: PlacedLayout) -> Iterator[tuple[float, str, str]]:
    """Yield the place, text and anchor of the numbers of the first and the last bit of each box."""
    bit = _bit(placed.bits)
    for run in runs_of(placed):
        box_start, box_end = (_MARGIN + (placed.bits - 1 - end) * bit for end in (run.high, run.low - 1))
        if run.high == run.low:
            yield (box_start + box_end) / 2, f"{run.high}", "middle"
        else:
            yield box_start + 2, f"{run.high}", "start"
            yield box_end - 2, f"{run.low}", "end"


def _byte_marks(stack: Stack) -> Iterator[tuple[float, str, str]]:
    byte = (WIDE - 2 * _MARGIN) / len(stack.rows)
    for index, row in enumerate(stack.rows):
        yield _MARGIN + byte * (index + 0.5), row.label, "middle"


def _ticks(bits: int, top: float) -> str:
    """Return the ticks of the ruler, longer at every eighth bit."""
    bit = _bit(bits)
    places = ((_MARGIN + index * bit, 8 if (bits - index) % 8 == 0 else 4) for index in range(bits + 1))
    return " ".join(f"M{number(x)} {number(top)}v-{high}" for x, high in places)


def _below(cells: Sequence[_Cell], top: float) -> Iterator[tuple[float, str]]:
    """Yield the names that do not fit into their boxes, side by side, each with the bottom of its line."""
    name_start = _MARGIN
    for cell in cells:
        if not cell.lines:
            wide = 16 + width(cell.about, _SIZE) + 16
            if name_start + wide > WIDE - _MARGIN and name_start > _MARGIN:
                name_start, top = _MARGIN, top + _LINE
            yield top + _LINE, rect(name_start, top + 4, 10, 10, cell.fill)
            yield top + _LINE, text(name_start + 16, top + 13, cell.about, _SIZE, "start")
            name_start += wide
