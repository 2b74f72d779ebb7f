"""The fields of a decoded frame as a table with places, numbers, values and meanings, and its position in words."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from ...model import Device, Measurement, PlacedLayout, Variant, Verdict
from ...model.expressions import Expression
from ...reference import codec
from ...say import WIDTH, decimal, frame_texts, quantity_text
from ...say import wrap_text as wrapped_anew
from ...say.layout import bit_place
from ...say.text import as_sentence, with_unit

#: Wrap a paragraph. Most paragraphs are the same for all frames, so the results are cached.
wrapped = lru_cache(maxsize=1024)(wrapped_anew)


class _FieldRow(NamedTuple):
    """A row of the table of fields: place, name, number and value of a field in columns, and then its meaning."""

    cells: tuple[str, str, str, str]
    meaning: str


#: Highest number of columns before the meaning of a field. After more columns, the meaning begins on a separate line.
_WIDEST_HEAD = 56


def field_table(decoded: codec.DecodedFrame) -> list[str]:
    """Return the lines of a table with one row for each field: ``bit 3  error  1  yes  The supply is too low``.

    The meaning of a field is next to the other columns, or below them if they are wide.
    """
    assert decoded.layout is not None
    # Each unused field is listed separately, so the field for all of them, which has no place, is omitted.
    fields = [field for field in decoded.fields if field.name != codec.UNUSED or field.high >= 0]
    rows = [_field_row(decoded.layout, field) for field in fields]
    # Turn the cells of each row into the cells of each column.
    columns = zip(*(row.cells for row in rows), strict=True)
    column_widths = [max(map(len, column)) for column in columns]
    lines = []
    for row in rows:
        cells_and_widths = zip(row.cells, column_widths, strict=True)
        columns_text = "  ".join(cell.ljust(width) for cell, width in cells_and_widths)
        indent = " " * (len(columns_text) + 2)
        if not row.meaning:
            lines.append(columns_text.rstrip())
        elif len(indent) > _WIDEST_HEAD:
            lines += [columns_text.rstrip(), wrapped(row.meaning, WIDTH, prefix=" " * 6)]
        else:
            lines.append(wrapped(row.meaning, WIDTH, prefix=indent, first=columns_text + "  "))
    return lines


def _field_row(placed_layout: PlacedLayout, field: codec.DecodedField) -> _FieldRow:
    """Return the row for a field: its place, name, raw number and value, such as ``bit 3``, ``error``, ``1``, ``yes``.

    A single bit is shown in decimal, and any other raw number in hexadecimal.
    """
    place = ""
    number_text = f"{field.raw:#x}"
    has_place = field.high >= 0  # A joined number has no place.
    if has_place:
        place = bit_place(
            placed_layout.layout, bit_count=placed_layout.bits, highest_bit=field.high, lowest_bit=field.low
        )
        is_one_bit = field.high <= field.low
        if is_one_bit:
            number_text = str(field.raw)
    cells = (place, field.name, number_text, _value_text(field))
    return _FieldRow(cells, meaning=_meaning_text(placed_layout, field))


def _meaning_text(placed_layout: PlacedLayout, field: codec.DecodedField) -> str:
    """Return the meaning of a field. For a number in Gray code, its value as sent and its converted value follow."""
    if not placed_layout.gray:
        return field.meaning
    # The number in Gray code may consist of several fields, which are all in Gray code.
    gray_names = (*placed_layout.layout.field_names_of(placed_layout.layout.gray_of), placed_layout.layout.gray_of)
    if field.name not in gray_names or not isinstance(field.value, int):
        return field.meaning
    gray_text = frame_texts.gray_code_note(f"{field.raw:#x}", f"{field.value:#x}")
    return f"{as_sentence(field.meaning)} {capitalized(gray_text)}" if field.meaning else gray_text


def _value_text(field: codec.DecodedField) -> str:
    """Return the value of a field with its unit, and the quantity if it has a scale, such as ``215 (21.5 °C)``."""
    if isinstance(field.value, bool):
        value_with_unit = "yes" if field.value else "no"
    else:
        value_with_unit = with_unit(str(field.value), field.unit)
    if field.scale is None:
        return value_with_unit
    return f"{value_with_unit} ({quantity_text(field.scale, int(field.value))})"


def capitalized(text: str) -> str:
    return text[:1].upper() + text[1:]


def position_text(device: Device, variant: Variant, decoded: codec.DecodedFrame, verdict: Verdict | None) -> str:
    """Return the position in µm or degrees, such as ``position: 90.0°``, or "" if it is not usable or not known.

    If the frame contains only a part of the position, the part with the lowest bits is shown.
    """
    measurement = device.measurement_of(variant.interface)
    is_usable = verdict not in (None, Verdict.NOT_USABLE)
    if not is_usable or measurement is None or decoded.layout is None:
        return ""
    measurement = measurement.within(decoded.layout.layout.position_range)
    field_name = measurement.position_name
    # A frame without the multiturn part of a joined position contains only the part with the lowest bits.
    if field_name not in decoded.values:
        field_name = _lowest_joined_field(device, variant, field_name)
    counts = decoded.values.get(field_name)
    if not isinstance(counts, int):
        return ""
    micrometers_per_count = measurement.micrometres(variant.parameters)
    if micrometers_per_count is not None:
        length = decimal(counts * micrometers_per_count)
        return f"{field_name}: {length} µm"
    return _angle_text(measurement, variant, field_name, counts)


def _lowest_joined_field(device: Device, variant: Variant, name: str) -> str:
    """Return the field with the lowest bits of a joined number, or ``name`` if it is not a joined number."""
    for layout in device.interface(variant.interface).layouts:
        for join in layout.joins:
            if join.name == name:
                return join.fields[-1]
    return name


def _angle_text(measurement: Measurement, variant: Variant, name: str, counts: int) -> str:
    """Return a position in counts as an angle: ``singleturn: 90.0°``, or ``position: 90.0° of revolution 3``.

    The revolution is only given for the whole position of a multiturn encoder. If the counts per turn are not known,
    the text is "".
    """
    counts_per_turn = _value_or_zero(measurement.counts_per_turn, variant)
    turns = _value_or_zero(measurement.turns, variant)
    if counts_per_turn < 1:
        return ""
    turn, counts_in_turn = divmod(counts, counts_per_turn)
    degrees = counts_in_turn * 360 / counts_per_turn
    # One decimal for each digit of the counts per degree, so that adjacent counts have different texts.
    decimals = len(str(counts_per_turn // 360))
    angle = f"{name}: {degrees:.{decimals}f}°"
    has_revolution = turns > 1 and name == measurement.position_name
    return f"{angle} of revolution {turn:,}" if has_revolution else angle


def _value_or_zero(expression: Expression | None, variant: Variant) -> int:
    return expression.value(variant.parameters) if expression is not None else 0
