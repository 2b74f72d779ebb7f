"""Pictures of layouts as SVG: strips of boxes, one box for each field.

Every picture has a card of its own behind it, light or dark as its reader's screen is. Names that do not fit into their
box stand below it at the end of a line. A bit that is 0 when it is active has a line over its name, and says so where
there is room.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from ...model import Choice, Constant, CrcValue, Field, Flag, Kind, Parity, PlacedLayout, Unused
from ...say.place import bit_range
from .svg import card, number, rect, text, width

#: What a box is, which is its colour.
_FILL: dict[type[Kind], str] = {
    Flag: "flag",
    CrcValue: "check",
    Parity: "check",
    Constant: "fixed",
    Unused: "fixed",
    Choice: "choice",
}
_DATA, _GROUP, _NOTHING = "data", "group", "nothing"
_MARGIN, _BOX, _ROW = 16.0, 38.0, 17.0


@dataclass(frozen=True)
class Box:
    """A field at ``start``, ``size`` bits wide as it is drawn.

    ``place`` says which bits it has, ``fill`` what it is, ``active_low`` that 0 means yes.
    """

    start: float
    size: float
    name: str
    place: str
    fill: str
    active_low: bool = False


@dataclass(frozen=True)
class Strip:
    """A row of boxes under a caption; ``marks`` stand above it at the middle of their bits."""

    caption: str
    boxes: tuple[Box, ...]
    marks: tuple[tuple[float, str], ...] = ()


def bit_strip(
    caption: str, placed: PlacedLayout, widest: int, left: bool = False, marks: tuple[tuple[float, str], ...] = ()
) -> Strip:
    """A layout with its highest bit on the left.

    ``widest`` is the length to which shorter strips are aligned, to the right unless ``left``.
    """
    top = (placed.bits if left else widest) - 1
    boxes = [_box(item.field, top - item.high, item.high, item.low) for item in placed.fields]
    boxes += [Box(top - high, high - low + 1, "-", bit_range(high, low), _NOTHING) for high, low in _gaps(placed)]
    return _strip(caption, boxes, marks)


def _strip(caption: str, boxes: Iterable[Box], marks: tuple[tuple[float, str], ...] = ()) -> Strip:
    return Strip(caption, tuple(sorted(boxes, key=lambda box: box.start)), marks)


def _box(field: Field, start: float, high: int, low: int) -> Box:
    active_low = isinstance(field.kind, Flag) and field.kind.active_low
    fill = _FILL.get(type(field.kind), _DATA)
    return Box(start, high - low + 1, _label(field), bit_range(high, low), fill, active_low)


def _gaps(placed: PlacedLayout) -> list[tuple[int, int]]:
    """Bits that no field has, as highest and lowest, the highest run first."""
    free = [
        bit for bit in range(placed.bits - 1, -1, -1) if not any(item.low <= bit <= item.high for item in placed.fields)
    ]
    runs: list[tuple[int, int]] = []
    for bit in free:
        if runs and runs[-1][1] == bit + 1:
            runs[-1] = (runs[-1][0], bit)
        else:
            runs.append((bit, bit))
    return runs


def register_strip(caption: str, placed: PlacedLayout, address: int, low_byte_first: bool) -> Strip:
    """A register with its highest bit on the left and the address of each byte above it."""
    count = placed.bits // 8
    addresses = [address + (count - 1 - index if low_byte_first else index) for index in range(count)]
    return bit_strip(
        caption,
        placed,
        placed.bits,
        marks=tuple((8 * index + 4, f"{number:02X}h") for index, number in enumerate(addresses)),
    )


def byte_strip(caption: str, placed: PlacedLayout) -> Strip:
    """A frame of bytes in sending order.

    Within a byte the highest bit is on the left. A group of fields, or a field with its padding, is one box.
    """
    low_first = placed.layout.byte_order == "low_byte_first"
    count = placed.bits // 8
    boxes: list[Box] = []
    done: set[str] = set()
    for item in placed.fields:
        field = item.field
        whole = field.group or field.padding_of or field.name
        if whole in done:
            continue
        done.add(whole)
        parts = [other for other in placed.fields if whole in (other.field.group, other.field.padding_of, other.name)]
        low, high = min(part.low for part in parts), max(part.high for part in parts)
        first = low // 8 if low_first else count - 1 - high // 8
        bytes_taken = high // 8 - low // 8 + 1
        inside = bytes_taken == 1
        start = 8 * first + (7 - high % 8 if inside else 0)
        size = high - low + 1 if inside else 8 * bytes_taken
        place = "" if not inside or size == 8 else bit_range(high % 8, low % 8)
        if field.group:
            boxes.append(Box(start, size, whole.replace("_", " "), place, _GROUP))
        else:
            name = _label(placed.layout.field(whole))
            boxes.append(replace(_box(field, start, high, low), size=size, name=name, place=place))
    marks = tuple((8 * index + 4.0, f"byte {index}") for index in range(count))
    return _strip(caption, boxes, marks)


def group_strip(caption: str, fields: Sequence[tuple[Field, int, int]], bits: int) -> Strip:
    """A group of fields, each with its highest and lowest bit within the group."""
    return _strip(caption, (_box(field, bits - 1 - high, high, low) for field, high, low in fields))


def draw(title: str, strips: Sequence[Strip], scale: float) -> str:
    """The strips one under the other, ``scale`` pixels for each bit."""
    body: list[str] = []
    right, top = 0.0, _MARGIN
    for index, strip in enumerate(strips):
        if strip.caption:
            body.append(text(_MARGIN, top + 12, strip.caption, 12, "start", bold=True))
            right = max(right, _MARGIN + width(strip.caption, 12.5))
            top += _ROW + 4
        if strip.marks:
            body += [
                text(_MARGIN + middle * scale, top + 9, mark, 10, "middle", faint=True) for middle, mark in strip.marks
            ]
            top += 15
        outside = []
        for box in strip.boxes:
            left, room = _MARGIN + box.start * scale, box.size * scale
            body.append(rect(left, top, room, _BOX, box.fill))
            right = max(right, left + room)
            lines = _lines(box, room)
            body += _centred(left + room / 2, top, lines, box)
            if not lines:
                outside.append(box)
        top += _BOX
        if outside and not _repeated(outside, strips[index + 1 : index + 2]):
            for row, box in enumerate(reversed(outside)):
                middle, bottom = _MARGIN + (box.start + box.size / 2) * scale, top + 6 + _ROW * (row + 0.5)
                label = _outside(box)
                body.append(f'<path d="M{number(middle)} {number(top)}V{number(bottom)}h6" class="line"/>')
                body.append(text(middle + 9, bottom + 4, label, 11, "start"))
                right = max(right, middle + 9 + width(label, 11))
            top += 8 + _ROW * len(outside)
        top += 14
    return card(title, body, right + _MARGIN, top - 14 + _MARGIN)


def _outside(box: Box) -> str:
    """A name that stands below its box."""
    said = [f"bit{'s' * (':' in box.place)} {box.place}" if box.place else "", "0 = active" if box.active_low else ""]
    return f"{box.name} ({', '.join(filter(None, said))})" if any(said) else box.name


def _repeated(outside: Sequence[Box], following: Sequence[Strip]) -> bool:
    """Whether the next strip has the same boxes at the same places, so that their names need to stand below it only."""
    return bool(following) and all(box in following[0].boxes for box in outside)


def _label(field: Field) -> str:
    if isinstance(field.kind, Unused) and not (field.printed_name or field.kind.value):
        return "unused"
    if not isinstance(field.kind, Constant):
        return field.name.replace("_", " ")
    constant = field.kind.value
    value = f"{constant:X}h" if constant > 9 else f"{constant}"
    is_plain = constant == 0 and (field.kind.padding_of or not field.printed_name)
    return value if is_plain else f"{field.name.replace('_', ' ')} = {value}"


def _lines(box: Box, room: float) -> list[tuple[str, int, bool]]:
    """The lines of text inside a box as text, size and whether faint; none where the name does not fit."""
    place = [(box.place, 10, True)] if box.place and width(box.place, 10) <= room - 2 else []
    for size in (12, 11, 10):
        if width(box.name, size) <= room - 4:
            if box.place and not place:
                return [(box.name, size, False)] if box.size > 1 else []
            return [(box.name, size, False), *place]
        words = box.name.split(" ", 1)
        if len(words) > 1 and not place and all(width(part, size) <= room - 4 for part in words):
            return [(part, size, False) for part in words]
    return []


def _centred(middle: float, top: float, lines: Sequence[tuple[str, int, bool]], box: Box) -> list[str]:
    first = top + _BOX / 2 + 4 - 7 * (len(lines) - 1)
    return [
        text(middle, first + 14 * index, line, size, "middle", faint=faint, over=box.active_low and line in box.name)
        for index, (line, size, faint) in enumerate(lines)
    ]
