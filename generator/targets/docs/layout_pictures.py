"""SVG pictures of layouts: a row of boxes for each byte, one byte below the other.

A picture is as wide as the screen of a phone, so that its text is readable there and next to a table. Every picture has
a background card in the light or dark scheme of the screen. A name that does not fit into its box is below the row with
its bit number, and so is each active-low bit. ``told`` returns a description in words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Field, PlacedLayout
from ...model.record import dataclass
from ...plan.values import Active, meaning_of
from ...say.box import as_words, colour, label
from ...say.place import bit_range
from .svg import WIDE, card, rect, text, wrapped

_GROUP, _NOTHING = "group", "nothing"
_MARGIN, _LABELS, _BOX, _LINE, _GAP, _INDENT = 10.0, 50.0, 34.0, 16.0, 12.0, 16.0
_BIT = (WIDE - 2 * _MARGIN - _LABELS) / 8
_BIG, _SMALL = 13, 12
#: Captions are order codes, in bold capitals.
_WIDE_LETTERS = 1.2


@dataclass(frozen=True)
class Box:
    """Bits of a field within one byte. ``high`` and ``low`` are bit numbers in the byte.

    ``place`` has their bit numbers in the whole layout, and ``fill`` is their colour class. ``active_low`` marks a flag
    that is active at 0.
    """

    high: int
    low: int
    name: str
    place: str
    fill: str
    active_low: bool = False


@dataclass(frozen=True)
class Byte:
    """Row of boxes, with the highest bit on the left. ``label`` is the name of the byte."""

    label: str
    boxes: tuple[Box, ...]


@dataclass(frozen=True)
class Stack:
    """Bytes, one below the other, under a caption. ``says`` is the text alternative."""

    caption: str
    rows: tuple[Byte, ...]
    says: str


@dataclass(frozen=True)
class _Run:
    """Bits that belong together: a field, a group of fields, or bits that belong to no field."""

    high: int
    low: int
    name: str
    fill: str
    active_low: bool = False

    def box(self, byte_low: int, place: str) -> Box:
        """Return the part within the byte that begins at ``byte_low``."""
        high, low = min(self.high, byte_low + 7) - byte_low, max(self.low, byte_low) - byte_low
        return Box(high, low, self.name, place, self.fill, self.active_low)

    def part(self, byte_low: int, origin: int = 0) -> str:
        """Return the bit numbers in the byte that begins at ``byte_low``, counted from ``origin``."""
        return bit_range(min(self.high, byte_low + 7) - origin, max(self.low, byte_low) - origin)


def bit_stack(caption: str, placed: PlacedLayout) -> Stack:
    """Return a frame that is one number, with one byte of the number per row, highest bits first."""
    lows = range((placed.bits - 1) // 8 * 8, -1, -8)
    rows = _rows(runs_of(placed), lows, [bit_range(min(low + 7, placed.bits - 1), low) for low in lows])
    return Stack(caption, rows, f"{placed.bits} bits: {_by_bits(runs_of(placed))}")


def register_stack(caption: str, placed: PlacedLayout, address: int, low_byte_first: bool) -> Stack:
    """Return a register in order of address. Bit numbers refer to the whole register."""
    lows = _lows(placed.bits, low_byte_first)
    labels = [f"{address + index:02X}h" for index in range(len(lows))]
    order = f", {'low' if low_byte_first else 'high'} byte first" if len(lows) > 1 else ""
    return Stack(caption, _rows(runs_of(placed), lows, labels), f"{labels[0]}{order}: {_by_bits(runs_of(placed))}")


def byte_stack(caption: str, placed: PlacedLayout) -> Stack:
    """Return a frame of bytes in transmission order.

    A group of fields, or a field with its padding, is one run. If a run spans several bytes, its bit numbers are those
    of the number formed by these bytes.
    """
    lows = _lows(placed.bits, placed.layout.byte_order == "low_byte_first")
    runs, rows, descriptions = _whole(placed), [], []
    for index, byte_low in enumerate(lows):
        boxes = []
        for run in (bit_run for bit_run in runs if bit_run.low < byte_low + 8 and bit_run.high >= byte_low):
            inside = run.high < byte_low + 8 and run.low >= byte_low
            is_byte = inside and run.high - run.low == 7
            place = "" if is_byte else run.part(byte_low, byte_low if inside else run.low)
            boxes.append(run.box(byte_low, place))
        rows.append(Byte(f"byte {index}", tuple(boxes)))
        descriptions.append(f"byte {index}: " + ", ".join(_named(box.name, box.place, box.active_low) for box in boxes))
    return Stack(caption, tuple(rows), "; ".join(descriptions))


def group_stack(caption: str, fields: Sequence[tuple[Field, int, int]], bits: int) -> Stack:
    """Return a group of fields, each given with its highest and lowest bit within the group."""
    runs = [_run(field, high, low) for field, high, low in fields]
    lows = range((bits - 1) // 8 * 8, -1, -8)
    return Stack(caption, _rows(runs, lows, [""] * len(lows)), _by_bits(runs))


def told(stacks: Sequence[Stack]) -> str:
    """Return the text alternative for a picture of these stacks. It describes the first ones."""
    further_stacks = [f"and {len(stacks) - _DESCRIBED} more, in the tables"] if len(stacks) > _DESCRIBED + 1 else []
    return "; ".join([*map(_told, stacks[: _DESCRIBED if further_stacks else None]), *further_stacks])


#: Highest number of stacks that the text describes. The tables beside the picture describe all of them.
_DESCRIBED = 4


def _told(stack: Stack) -> str:
    # The caption of a frame ends with its number of bits, and so its text need not begin with it.
    return (
        f"{stack.caption}: {stack.says.removeprefix(stack.caption.rpartition(': ')[2] + ': ')}"
        if stack.caption
        else stack.says
    )


def _lows(bits: int, low_byte_first: bool) -> range:
    """Return the lowest bit of each byte, in byte order."""
    return range(0, bits, 8) if low_byte_first else range(bits - 8, -1, -8)


def _rows(runs: Sequence[_Run], lows: Sequence[int], labels: Sequence[str]) -> tuple[Byte, ...]:
    """Return rows whose boxes have bit numbers in the whole layout."""
    return tuple(
        Byte(
            label,
            tuple(run.box(low, run.part(low)) for run in runs if run.low < low + 8 and run.high >= low),
        )
        for low, label in zip(lows, labels, strict=True)
    )


def _by_bits(runs: Sequence[_Run]) -> str:
    return ", ".join(_named(run.name, bit_range(run.high, run.low), run.active_low) for run in runs)


def _named(name: str, place: str, active_low: bool) -> str:
    spoken_name = f"always {name}" if name.isdecimal() else name
    return " ".join(filter(None, (spoken_name, place, "(0 = active)" if active_low else "")))


def runs_of(placed: PlacedLayout) -> list[_Run]:
    """Return the fields, and the bits that belong to no field, highest first."""
    runs = [_run(placed_field.field, placed_field.high, placed_field.low) for placed_field in placed.fields]
    runs += [_Run(high, low, "no field", _NOTHING) for high, low in _gaps(placed)]
    return sorted(runs, key=lambda run: -run.high)


def _whole(placed: PlacedLayout) -> list[_Run]:
    """Return the runs, with a group of fields, or a field with its padding, as one run."""
    field_names = {placed_field.name for placed_field in placed.fields}
    runs_by_owner: dict[str, list[_Run]] = {}
    for placed_field in placed.fields:
        padded = placed_field.field.padding_of if placed_field.field.padding_of in field_names else ""
        owner = placed_field.field.group or padded or placed_field.field.name
        runs_by_owner.setdefault(owner, []).append(_run(placed_field.field, placed_field.high, placed_field.low))
    runs = []
    for owner, parts in runs_by_owner.items():
        low, high = min(part.low for part in parts), max(part.high for part in parts)
        grouped = any(placed_field.field.group == owner for placed_field in placed.fields)
        first = _Run(high, low, as_words(owner), _GROUP) if grouped else _run(placed.layout.field(owner), high, low)
        runs.append(first)
    return sorted(runs, key=lambda run: -run.high)


def _run(field: Field, high: int, low: int) -> _Run:
    return _Run(high, low, label(field), colour(field), meaning_of(field) == Active(low=True))


def _gaps(placed: PlacedLayout) -> list[tuple[int, int]]:
    """Return the highest and lowest bit of each run of bits that belong to no field, highest run first."""
    free = [
        bit
        for bit in range(placed.bits - 1, -1, -1)
        if not any(placed_field.low <= bit <= placed_field.high for placed_field in placed.fields)
    ]
    runs: list[tuple[int, int]] = []
    for bit in free:
        if runs and runs[-1][1] == bit + 1:
            runs[-1] = (runs[-1][0], bit)
        else:
            runs.append((bit, bit))
    return runs


# -- drawing


def draw(title: str, stacks: Sequence[Stack]) -> str:
    """Return a picture of the stacks, one below the other."""
    body: list[str] = []
    top = _MARGIN
    for stack in stacks:
        for line in wrapped(stack.caption, WIDE - 2 * _MARGIN, _BIG * _WIDE_LETTERS):
            body.append(text(_MARGIN, top + 13, line, _BIG, "start", bold=True))
            top += _LINE + 4
        for row in stack.rows:
            body += _row(row, top)
            top += _BOX
            for fill, line in _below(row):
                if fill:
                    body.append(rect(_MARGIN, top + 5, 10, 10, fill))
                body.append(text(_MARGIN + _INDENT, top + 14, line, _SMALL, "start"))
                top += _LINE
            top += 6 if _below(row) else 0
        top += _GAP
    return card(title, body, WIDE, top - _GAP + _MARGIN, told(stacks))


def _row(row: Byte, top: float) -> Iterator[str]:
    if row.label:
        yield text(_MARGIN, top + _BOX / 2 + 4, row.label, _SMALL, "start", faint=True)
    for box in row.boxes:
        box_x, room = _MARGIN + _LABELS + (7 - box.high) * _BIT, _room(box)
        yield rect(box_x, top, room, _BOX, box.fill)
        lines = [(line, False) for line in _inside(box)] + ([(box.place, True)] if box.place else [])
        first = top + _BOX / 2 + 4.5 - 7 * (len(lines) - 1)
        for index, (line, faint) in enumerate(lines):
            yield text(box_x + room / 2, first + 14 * index, line, _SMALL, "middle", faint=faint)


def _room(box: Box) -> float:
    return (box.high - box.low + 1) * _BIT


def _inside(box: Box) -> list[str]:
    """Return the lines of the name inside its box, or none if the name is below the row."""
    if box.active_low:
        return []
    lines = wrapped(box.name, _room(box) - 4, _SMALL)
    fits = len(lines) == 1 or (len(lines) == 2 and not box.place and " ".join(lines) == box.name)
    return lines if fits else []


def _below(row: Byte) -> list[tuple[str, str]]:
    """Return the lines below a row. The first line of each name has its colour class."""
    lines = []
    for box in row.boxes:
        if not _inside(box):
            bits = f"bit{'s' * (':' in box.place)} {box.place}" if box.place else ""
            about = ", ".join(filter(None, (bits, "0 = active" if box.active_low else "")))
            name = f"{box.name} ({about})" if about else box.name
            name_lines = wrapped(name, WIDE - 2 * _MARGIN - _INDENT, _SMALL)
            lines += [("" if index else box.fill, line) for index, line in enumerate(name_lines)]
    return lines
