"""Contents of the pictures of frames and registers as rows of bytes, and pictures of frames on one line.

A picture with rows of bytes fits on the screen of a phone. A frame on one line has a ruler of bits or bytes, for wider
screens. Each picture has a description in words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from ...model import Field, PlacedField, PlacedLayout
from ...model.record import dataclass
from ...plan.values import ActiveFlag, meaning_of
from ...say.layout import box_colour, box_label, name_as_words
from ...say.names_and_evidence import bit_range
from ..picture_elements import create_picture, draw_box, draw_text, number, text_width


@dataclass(frozen=True)
class Box:
    """Bits of a field within one byte, which a picture shows as a box.

    ``highest_bit`` and ``lowest_bit`` are bit numbers in the byte. ``printed_bits`` has the bit numbers to print, and
    ``colour`` is the color class. ``is_active_low`` marks a flag that is active at 0.
    """

    highest_bit: int
    lowest_bit: int
    name: str
    printed_bits: str
    colour: str
    is_active_low: bool = False


@dataclass(frozen=True)
class ByteRow:
    """Byte as a row of boxes, with the highest bit on the left. ``label`` is the name of the byte."""

    label: str
    boxes: tuple[Box, ...]


@dataclass(frozen=True)
class ByteDiagram:
    """Bytes of a frame or register, one below the other, under a caption. ``description`` describes them in words."""

    caption: str
    rows: tuple[ByteRow, ...]
    description: str


@dataclass(frozen=True)
class _BitRun:
    """Consecutive bits: a field, a group of fields, or bits outside all fields. ``colour`` is their color class."""

    highest_bit: int
    lowest_bit: int
    name: str
    colour: str
    is_active_low: bool = False

    @property
    def bits_text(self) -> str:
        """The bit numbers, such as ``6:0``."""
        return bit_range(self.highest_bit, self.lowest_bit)

    def is_in_byte(self, byte_start: int) -> bool:
        """Return whether any of the bits are in the byte that begins at ``byte_start``."""
        return self.lowest_bit < byte_start + 8 and self.highest_bit >= byte_start

    def box(self, byte_start: int, printed_bits: str) -> Box:
        """Return the box for the bits in the byte that begins at ``byte_start``, with ``printed_bits`` as its text."""
        return Box(
            highest_bit=min(self.highest_bit, byte_start + 7) - byte_start,
            lowest_bit=max(self.lowest_bit, byte_start) - byte_start,
            name=self.name,
            printed_bits=printed_bits,
            colour=self.colour,
            is_active_low=self.is_active_low,
        )

    def bits_in_byte(self, byte_start: int, bit_0: int = 0) -> str:
        """Return the bit numbers of the bits in the byte that begins at ``byte_start``, counted from ``bit_0``."""
        return bit_range(min(self.highest_bit, byte_start + 7) - bit_0, max(self.lowest_bit, byte_start) - bit_0)


def diagram_of_bits(caption: str, placed_layout: PlacedLayout) -> ByteDiagram:
    """Return a frame that consists of bits as one number, with a row for each byte, highest bits first."""
    bit_runs = runs_of_layout(placed_layout)
    highest_bit = placed_layout.bits - 1
    # The lowest bit of each byte of the number: 16, 8, 0 for 20 bits, whose first byte has only four of them.
    lowest_bits = range(highest_bit // 8 * 8, -1, -8)
    labels = [bit_range(min(lowest_bit + 7, highest_bit), lowest_bit) for lowest_bit in lowest_bits]
    return ByteDiagram(
        caption=caption,
        rows=_byte_rows(bit_runs, lowest_bits, labels),
        description=f"{placed_layout.bits} bits: {_runs_text(bit_runs)}",
    )


def diagram_of_register(caption: str, placed_layout: PlacedLayout, address: int, low_byte_first: bool) -> ByteDiagram:
    """Return a register with a row for each byte, in address order. Bits are numbered in the whole register."""
    bit_runs = runs_of_layout(placed_layout)
    bit_count = placed_layout.bits
    lowest_bits = range(0, bit_count, 8) if low_byte_first else range(bit_count - 8, -1, -8)
    byte_addresses = [f"{address + index:02X}h" for index in range(len(lowest_bits))]
    address_and_order = byte_addresses[0]
    if len(byte_addresses) > 1:
        address_and_order += ", low byte first" if low_byte_first else ", high byte first"
    return ByteDiagram(
        caption=caption,
        rows=_byte_rows(bit_runs, lowest_bits, byte_addresses),
        description=f"{address_and_order}: {_runs_text(bit_runs)}",
    )


def diagram_of_bytes(caption: str, placed_layout: PlacedLayout) -> ByteDiagram:
    """Return a frame that consists of bytes, with a row for each byte, in the order of transmission.

    A group of fields has a single box in each byte, and so has a field with its padding. If they span several bytes,
    their bits are numbered in the number that these bytes form.
    """
    bit_runs = _runs_with_groups_merged(placed_layout)
    byte_rows = []
    descriptions = []
    # ``byte_start`` is the lowest bit of the byte in the number that the frame forms.
    for index, byte_start in enumerate(placed_layout.layout.lowest_bits_of_bytes):
        runs_in_byte = [run for run in bit_runs if run.is_in_byte(byte_start)]
        boxes = tuple(_box_in_byte(run, byte_start) for run in runs_in_byte)
        box_texts = [_box_text(box.name, box.printed_bits, box.is_active_low) for box in boxes]
        byte_rows.append(ByteRow(f"byte {index}", boxes))
        descriptions.append(f"byte {index}: {', '.join(box_texts)}")
    return ByteDiagram(caption=caption, rows=tuple(byte_rows), description="; ".join(descriptions))


def _box_in_byte(run: _BitRun, byte_start: int) -> Box:
    """Return the box for the part of a field or group in one byte of a frame.

    Its bits are numbered in the byte or, if the field or group spans several bytes, from its own lowest bit. A field or
    group that exactly fills the byte has no bit numbers.
    """
    is_within_byte = run.highest_bit < byte_start + 8 and run.lowest_bit >= byte_start
    is_whole_byte = is_within_byte and run.highest_bit - run.lowest_bit == 7
    if is_whole_byte:
        return run.box(byte_start, printed_bits="")
    bit_0 = byte_start if is_within_byte else run.lowest_bit
    return run.box(byte_start, run.bits_in_byte(byte_start, bit_0))


def diagram_of_group(caption: str, fields: Sequence[tuple[Field, int, int]], bit_count: int) -> ByteDiagram:
    """Return a group of fields as rows of bytes. Each field is given with its highest and lowest bit in the group."""
    bit_runs = [_run_of_field(field, highest, lowest) for field, highest, lowest in fields]
    # The lowest bit of each byte, highest first: 8, 0 for 12 bits.
    lowest_bits = range((bit_count - 1) // 8 * 8, -1, -8)
    empty_labels = [""] * len(lowest_bits)
    rows = _byte_rows(bit_runs, lowest_bits, empty_labels)
    return ByteDiagram(caption=caption, rows=rows, description=_runs_text(bit_runs))


def _byte_rows(bit_runs: Sequence[_BitRun], lowest_bits: Sequence[int], labels: Sequence[str]) -> tuple[ByteRow, ...]:
    """Return a row for each byte, with its bits numbered in the whole layout.

    ``lowest_bits`` has the lowest bit of each byte, such as 8 and 0. ``labels`` are the names of the bytes, or empty.
    """
    byte_rows = []
    for byte_start, row_label in zip(lowest_bits, labels, strict=True):
        runs_in_byte = [run for run in bit_runs if run.is_in_byte(byte_start)]
        boxes = tuple(run.box(byte_start, run.bits_in_byte(byte_start)) for run in runs_in_byte)
        byte_rows.append(ByteRow(row_label, boxes))
    return tuple(byte_rows)


def _runs_text(bit_runs: Sequence[_BitRun]) -> str:
    """Return the description of consecutive bits: ``error 7 (0 = active), position 6:0``."""
    return ", ".join(_box_text(run.name, run.bits_text, run.is_active_low) for run in bit_runs)


def _box_text(name: str, bits_text: str, is_active_low: bool) -> str:
    """Return the description of some bits, such as ``error 7 (0 = active)``, or ``always 0`` for a constant."""
    # The name of constant bits is their value.
    spoken_name = f"always {name}" if name.isdecimal() else name
    active_level_text = "(0 = active)" if is_active_low else ""
    return " ".join(filter(None, (spoken_name, bits_text, active_level_text)))


def runs_of_layout(placed_layout: PlacedLayout) -> list[_BitRun]:
    """Return the fields of a layout, and the bits outside all fields, highest bits first."""
    bit_runs = [_run_of_field(placed.field, placed.highest_bit, placed.lowest_bit) for placed in placed_layout.fields]
    for highest, lowest in _gaps_between_fields(placed_layout):
        bit_runs.append(_BitRun(highest, lowest, name="no field", colour="nothing"))
    return sorted(bit_runs, key=lambda run: -run.highest_bit)


def _runs_with_groups_merged(placed_layout: PlacedLayout) -> list[_BitRun]:
    """Return the groups of fields and the fields with their padding, highest bits first.

    Bits outside all fields are omitted.
    """
    names_in_layout = {placed_field.name for placed_field in placed_layout.fields}
    fields_by_group: dict[str, list[PlacedField]] = {}
    fields_by_padded_field: dict[str, list[PlacedField]] = {}
    for placed_field in placed_layout.fields:
        field = placed_field.field
        # Padding belongs to the field that it pads, unless this field has no bits for the order code.
        is_padding = field.padding_of in names_in_layout
        if field.group:
            fields_by_group.setdefault(field.group, []).append(placed_field)
        else:
            padded_name = field.padding_of if is_padding else field.name
            fields_by_padded_field.setdefault(padded_name, []).append(placed_field)
    bit_runs = []
    for group_name, group_fields in fields_by_group.items():
        highest, lowest = _range_of_fields(group_fields)
        bit_runs.append(_BitRun(highest, lowest, name=name_as_words(group_name), colour="group"))
    for padded_name, field_and_padding in fields_by_padded_field.items():
        highest, lowest = _range_of_fields(field_and_padding)
        bit_runs.append(_run_of_field(placed_layout.layout.field(padded_name), highest, lowest))
    return sorted(bit_runs, key=lambda run: -run.highest_bit)


def _range_of_fields(placed_fields: Sequence[PlacedField]) -> tuple[int, int]:
    """Return the highest and the lowest bit of several fields."""
    return max(field.highest_bit for field in placed_fields), min(field.lowest_bit for field in placed_fields)


def _run_of_field(field: Field, highest: int, lowest: int) -> _BitRun:
    """Return the bits of a field with its label and color class."""
    return _BitRun(
        highest_bit=highest,
        lowest_bit=lowest,
        name=box_label(field),
        colour=box_colour(field),
        is_active_low=meaning_of(field) == ActiveFlag(low=True),
    )


def _gaps_between_fields(placed_layout: PlacedLayout) -> list[tuple[int, int]]:
    """Return the highest and lowest bit of each gap between fields, or above or below them, highest first."""
    gaps: list[tuple[int, int]] = []
    # All bits from this one upward are in fields or in listed gaps.
    lowest_covered_bit = placed_layout.bits
    for placed_field in sorted(placed_layout.fields, key=lambda field: -field.highest_bit):
        bit_above_field = placed_field.highest_bit + 1
        if bit_above_field < lowest_covered_bit:
            gaps.append((lowest_covered_bit - 1, bit_above_field))
        lowest_covered_bit = min(lowest_covered_bit, placed_field.lowest_bit)
    if lowest_covered_bit > 0:
        gaps.append((lowest_covered_bit - 1, 0))
    return gaps


#: Width of a picture of a frame on one line, and of the narrowest screen that shows it instead of the rows of bytes.
_WIDE_PICTURE_WIDTH, NARROWEST_SCREEN = 720.0, 700
_MARGIN, _RULER_HEIGHT, _BOX_HEIGHT, _LINE_HEIGHT, _TEXT_SIZE = 8.0, 24.0, 44.0, 18.0, 11
#: Width of a frame between the margins.
_FRAME_WIDTH = _WIDE_PICTURE_WIDTH - 2 * _MARGIN
#: Highest number of frames that the text alternative describes. The tables next to the picture describe all of them.
_MOST_DESCRIBED = 4
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
    colour: str

    @property
    def lines(self) -> list[str]:
        """Lines inside the box: its name, then its place. Empty if a word is too wide, or for more than two lines."""
        # The text keeps a distance of 2 pixels from each side.
        letters_per_line = int((self.right - self.left - 4) / (_TEXT_SIZE * _LETTER_WIDTH))
        longest_word = max(len(word) for word in (*self.name.split(" "), self.place))
        if longest_word > letters_per_line:
            return []
        name_lines = wrap(self.name, letters_per_line)
        if len(name_lines) > 2:
            return []
        return [*name_lines, self.place] if self.place else name_lines


def wide_picture(title: str, captioned_layouts: Sequence[tuple[str, PlacedLayout]]) -> str:
    """Return the picture of a frame, with the first bit or byte on the left.

    If the frame has several layouts, they are drawn one below the other, each with its caption.
    """
    all_elements: list[str] = []
    diagrams: list[ByteDiagram] = []
    top = _MARGIN
    for caption, placed_layout in captioned_layouts:
        in_bytes = placed_layout.layout.in_bytes
        diagram = diagram_of_bytes(caption, placed_layout) if in_bytes else diagram_of_bits(caption, placed_layout)
        diagrams.append(diagram)
        if caption:
            all_elements.append(draw_text(caption, x=_MARGIN, y=top + 13, size=_TEXT_SIZE, anchor="start", bold=True))
            top += _LINE_HEIGHT
        elements, top = _frame_elements(placed_layout, diagram, top)
        all_elements += elements
    description = text_alternative(diagrams)
    return create_picture(title, all_elements, width=_WIDE_PICTURE_WIDTH, height=top, description=description)


def _frame_elements(placed_layout: PlacedLayout, diagram: ByteDiagram, top: float) -> tuple[list[str], float]:
    """Return the elements of one frame that starts at ``top``, and the top of the next frame."""
    box_top = top + _RULER_HEIGHT
    if placed_layout.layout.in_bytes:
        cells = list(_byte_cells(diagram))
        ruler_marks = list(_byte_marks(diagram))
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
    yield draw_box(left=cell.left, top=top, box_width=cell.right - cell.left, box_height=_BOX_HEIGHT, fill=cell.colour)
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
    bit_width = _FRAME_WIDTH / placed_layout.bits
    for run in runs_of_layout(placed_layout):
        left = _MARGIN + (placed_layout.bits - 1 - run.highest_bit) * bit_width
        # The ruler above the box shows its bit numbers, so only the text below the line names them.
        bits_text = f"{'bits' if run.highest_bit > run.lowest_bit else 'bit'} {run.bits_text}"
        active_level_text = ", 0 = active" if run.is_active_low else ""
        yield _Cell(
            left=left,
            right=left + (run.highest_bit - run.lowest_bit + 1) * bit_width,
            name=f"{run.name}{active_level_text}",
            place="",
            about=f"{run.name} ({bits_text}{active_level_text})",
            colour=run.colour,
        )


def _byte_cells(diagram: ByteDiagram) -> Iterator[_Cell]:
    """Yield the boxes of each byte in a frame that consists of bytes. The highest bit of a byte is on its left."""
    byte_width = _FRAME_WIDTH / len(diagram.rows)
    for index, row in enumerate(diagram.rows):
        for box in row.boxes:
            # Bit 7 is at the left of its byte.
            left = _MARGIN + byte_width * (index + (7 - box.highest_bit) / 8)
            spaced_place = f" {box.printed_bits}" if box.printed_bits else ""
            yield _Cell(
                left=left,
                right=left + byte_width * (box.highest_bit - box.lowest_bit + 1) / 8,
                name=box.name,
                place=box.printed_bits,
                about=f"{box.name}{spaced_place} ({row.label})",
                colour=box.colour,
            )


def _bit_marks(placed_layout: PlacedLayout) -> Iterator[tuple[float, str, str]]:
    """Yield the x position, text and alignment of the ruler's numbers: the first and the last bit of each box."""
    bit_width = _FRAME_WIDTH / placed_layout.bits
    for run in runs_of_layout(placed_layout):
        left = _MARGIN + (placed_layout.bits - 1 - run.highest_bit) * bit_width
        right = _MARGIN + (placed_layout.bits - run.lowest_bit) * bit_width
        if run.highest_bit == run.lowest_bit:
            yield (left + right) / 2, f"{run.highest_bit}", "middle"
        else:
            yield left + 2, f"{run.highest_bit}", "start"
            yield right - 2, f"{run.lowest_bit}", "end"


def _byte_marks(diagram: ByteDiagram) -> Iterator[tuple[float, str, str]]:
    """Yield the x position, text and alignment of the name of each byte."""
    byte_width = _FRAME_WIDTH / len(diagram.rows)
    for index, row in enumerate(diagram.rows):
        yield _MARGIN + byte_width * (index + 0.5), row.label, "middle"


def _ruler_ticks(bit_count: int, top: float) -> str:
    """Return the path of the ruler's ticks. Every eighth tick is longer, counted from the lowest bit."""
    ticks = []
    bit_width = _FRAME_WIDTH / bit_count
    for index in range(bit_count + 1):
        x = _MARGIN + index * bit_width
        height = 8 if (bit_count - index) % 8 == 0 else 4
        ticks.append(f"M{number(x)} {number(top)}v-{height}")
    return " ".join(ticks)


def _names_below(cells: Sequence[_Cell], top: float) -> Iterator[tuple[float, str]]:
    """Yield the elements for names that do not fit into their boxes, each with the bottom of its line.

    Names are side by side, in as many lines as needed. Each has a small box in its color in front of it.
    """
    box_left = _MARGIN
    for cell in cells:
        if not cell.lines:
            # The color box with its gap takes 16 pixels, and 16 more follow the text.
            width_with_box = 16 + text_width(cell.about, _TEXT_SIZE) + 16
            is_line_full = box_left + width_with_box > _WIDE_PICTURE_WIDTH - _MARGIN
            if is_line_full and box_left > _MARGIN:
                box_left = _MARGIN
                top += _LINE_HEIGHT
            bottom = top + _LINE_HEIGHT
            yield bottom, draw_box(left=box_left, top=top + 4, box_width=10, box_height=10, fill=cell.colour)
            yield bottom, draw_text(cell.about, x=box_left + 16, y=top + 13, size=_TEXT_SIZE, anchor="start")
            box_left += width_with_box


def text_alternative(diagrams: Sequence[ByteDiagram]) -> str:
    """Return the text alternative for a picture of these frames. It describes the first ones and counts the others."""
    # To count a single one would be no shorter than to describe it.
    if len(diagrams) <= _MOST_DESCRIBED + 1:
        return "; ".join(map(_diagram_text, diagrams))
    further_diagrams_text = f"and {len(diagrams) - _MOST_DESCRIBED} more, in the tables"
    return "; ".join([*map(_diagram_text, diagrams[:_MOST_DESCRIBED]), further_diagrams_text])


def _diagram_text(diagram: ByteDiagram) -> str:
    """Return the description of one frame, with its caption."""
    if not diagram.caption:
        return diagram.description
    # The caption of a frame ends with its number of bits, so its text does not need to begin with the same number.
    number_of_bits = diagram.caption.rpartition(": ")[2]
    text_without_number = diagram.description.removeprefix(f"{number_of_bits}: ")
    return f"{diagram.caption}: {text_without_number}"
