"""What a page about a device says of its layouts and registers: rows of tables whose cells are Markdown, and pictures."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from .expressions import Expression
from .markdown import cited, code, joined, link, table, text
from .model import Alarm, Device, Field, Interface, Layout, PlacedLayout, Register, Value
from .pictures import Strip, bit_strip, byte_strip, draw, group_strip, register_strip
from .words import WORTH, number

_BIT, _BYTE_BIT = 15.0, 10.5
#: More named values than this are listed in a table of their own.
_FEW = 4


@dataclass(frozen=True)
class Placement:
    """A layout as some order codes have it."""

    codes: tuple[str, ...]
    placed: PlacedLayout


def placements(device: Device, layout: Layout, kind: str) -> tuple[Placement, ...]:
    """The layout for the order codes of an interface, each shape once, the shortest first."""
    found: dict[tuple[tuple[str, int, int], ...], tuple[PlacedLayout, list[str]]] = {}
    for variant in device.variants:
        if variant.interface == kind:
            placed = layout.place(variant.parameters)
            shape = tuple((item.name, item.low, item.width) for item in placed.fields)
            found.setdefault(shape, (placed, []))[1].append(variant.code)
    return tuple(sorted((Placement(tuple(codes), placed) for placed, codes in found.values()), key=lambda item: item.placed.bits))


def hexadecimal(value: int, digits: int = 2) -> str:
    """As manuals write it: ``3Fh``."""
    return f"{value:0{digits}X}h"


def expression(value: Expression | int | str | None) -> str:
    """A number, or an expression as code."""
    if value is None:
        return ""
    if isinstance(value, Expression):
        return number(value.constant) if value.is_constant else code(value.render())
    return number(value) if isinstance(value, int) else text(value)


def address(register: Register) -> str:
    """``40h``, or ``11h–17h``."""
    return hexadecimal(register.address) + (f"–{hexadecimal(register.last_address)}" if register.length > 1 else "")


def named(name: str, printed_name: str, names: Mapping[str, str]) -> str:
    """A name as code, and the manual's own names below it."""
    return joined([code(name), own_names(printed_name, names)])


def own_names(printed_name: str, names: Mapping[str, str]) -> str:
    return joined([text(printed_name), *(f"{key}: {text(value)}" for key, value in names.items())], ", ")


def title(name: str, printed_name: str, names: Mapping[str, str]) -> str:
    """A heading: the manual's own name, and in parentheses its names in other languages."""
    own = printed_name or name.replace("_", " ").capitalize()
    others = ", ".join(f"{key}: {other}" for key, other in names.items())
    return f"{own} ({others})" if others else own


def errata_links(device: Device, path: str | Sequence[str]) -> str:
    """The errata that are about exactly this, or about something inside it."""
    paths = (path,) if isinstance(path, str) else tuple(path)
    found = [item for item in device.errata if any(other in paths or other.startswith(tuple(f"{part}." for part in paths)) for other in item.affects)]
    return ", ".join(link(code(item.name), f"#erratum-{item.name}") for item in found)


def place(layout: Layout, field: Field, *, bits: int) -> str:
    """Where a field stands: a number, or by expressions where that depends on the order code."""
    size = Expression(field.container) if field.container else field.width
    high = field.low + size - Expression(1)
    if layout.carried_as == "bytes" and layout.sender and field.low.is_constant and size.is_constant:
        return byte_place(layout, bits, high.constant, field.low.constant)
    if high.is_constant and field.low.is_constant:
        return bit_range(high.constant, field.low.constant)
    return f"{expression(high)} : {expression(field.low)}"


def byte_place(layout: Layout, bits: int, high: int, low: int) -> str:
    """Where bits stand in a frame of bytes, the first byte being 0: ``byte 1, bits 7:1`` or ``bytes 2–4``."""
    last = bits // 8 - 1
    first_byte, last_byte = (low // 8, high // 8) if layout.byte_order == "low_byte_first" else (last - high // 8, last - low // 8)
    if low % 8 == 0 and high % 8 == 7:
        return f"byte {first_byte}" if first_byte == last_byte else f"bytes {first_byte}–{last_byte}"
    if first_byte == last_byte:
        return f"byte {first_byte}, bit{'s' * (high > low)} {bit_range(high % 8, low % 8)}"
    return f"bits {bit_range(high, low)} of the frame as one number"


def value_text(value: Value, written: str) -> str:
    names = own_names(value.printed_name, value.names)
    return f"{written} {code(value.name)}" + (f" ({names})" if names else "") + (f": {text(value.meaning)}" if value.meaning else "")


def field_meaning(field: Field, in_register: bool = False) -> str:
    """All that is to be said of a field in one cell; a register has a table of its own for many values."""
    parts = [text(field.meaning)]
    if field.kind == "flag":
        yes, no = (0, 1) if field.active_low else (1, 0)
        if field.when_active or field.when_inactive or field.implemented:
            parts.append(f"{yes}: {text(field.when_active) or 'yes'}; {no}: {text(field.when_inactive) or 'no'}")
        parts.append(f"the sum of {', '.join(map(code, field.sums_up))}" if field.sums_up else "")
        parts.append(f"while active, {WORTH[field.makes_position]}" if field.makes_position and field.implemented else "")
    elif field.kind == "constant" and not re.search(rf"always ({field.constant}|zero)\b", field.meaning.lower()):
        parts.append(f"always {hexadecimal(field.constant)}" if field.constant > 1 else f"always {field.constant}")
    elif field.kind == "crc":
        parts.append(f"{link(code(field.crc), f'#crc-{field.crc}')} over everything before it")
    elif field.kind == "parity":
        parts.append(f"even parity of {code(field.parity_of)}")
    elif field.kind == "text":
        parts.append("ASCII text")
    elif field.kind == "digits":
        runs = (f"{code(run.name)} {run.digits}" + (f" ({text(run.meaning)})" if run.meaning else "") for run in field.digits)
        parts.append(f"decimal digits, most significant first: {'; '.join(runs)}")
    if has_value_table(field):
        parts.append("see its values below" if in_register else "; ".join(value_text(replace(item, meaning=""), f"{item.value:X}h") for item in field.values))
    else:
        parts += [value_text(item, hexadecimal(item.value, (field.widest + 3) // 4)) for item in field.values]
    parts += [f"right-aligned in {field.container} bits, zeros above it" if field.container else "", f"unit: {text(field.unit)}" if field.unit else ""]
    parts += ["two's complement" if field.signed else "", f"0 means {number(field.zero_means)}" if field.zero_means else ""]
    parts += ["powers of two only" if field.power_of_two else "", "" if field.implemented or is_said(field) else "not implemented"]
    parts += [f"reserved for the {field.reserved}" if field.reserved else "", f"is {_equal(field.equals)}" if field.equals is not None else ""]
    parts.append(f"default {number(field.default)}" if field.default is not None else "")
    parts.append("explained by " + ", ".join(map(bit_link, field.explained_by)) if field.explained_by else "")
    return joined([*parts, text(field.note)])


def is_said(item: Field | Alarm) -> bool:
    """Whether the meaning itself says that it is not implemented."""
    return item.meaning.lower().startswith("not implemented")


def _equal(value: Expression | int | str) -> str:
    if isinstance(value, str):
        return code(value)
    constant = value.constant if isinstance(value, Expression) and value.is_constant else value
    return f"{hexadecimal(constant)} ({number(constant)})" if isinstance(constant, int) and constant > 9 else expression(value)


def bit_link(path: str) -> str:
    """A bit written as ``register.field``, as a link to its register."""
    return link(code(path), f"#register-{path.partition('.')[0]}")


def has_value_table(field: Field) -> bool:
    """Whether its values are too many for one cell."""
    return len(field.values) > _FEW


def value_rows(field: Field) -> Iterator[tuple[str, ...]]:
    """Value, name, meaning, source."""
    for item in field.values:
        names = own_names(item.printed_name, item.names)
        yield hexadecimal(item.value, (field.widest + 3) // 4), joined([code(item.name), names]), text(item.meaning), cited(item.source)


def field_rows(device: Device, layout: Layout) -> Iterator[tuple[str, ...]]:
    """Field, place, width, meaning, source; a group of fields is one row that leads to its own table."""
    done: set[str] = set()
    groups = {group.name: group for group in device.field_groups}
    for field in layout.fields:
        if field.group:
            if field.group not in done:
                done.add(field.group)
                parts = [item for item in layout.fields if item.group == field.group]
                low = min(item.low.constant for item in parts)
                group = groups[field.group]
                name = link(code(group.name), f"#group-{group.name}")
                where = byte_place(layout, layout.widest, low + group.bits - 1, low)
                yield joined([name, own_names(group.printed_name, group.names)]), where, f"{group.bits}", "several fields, see there", ""
            continue
        if field.padding_of:
            continue  # told with the field itself
        yield (
            named(field.name, field.printed_name, field.names),
            place(layout, field, bits=layout.widest),
            expression(field.width),
            field_meaning(field, in_register=not layout.sender),
            cited(field.source) if field.source != layout.source else "",
        )


def group_fields(device: Device, name: str) -> list[tuple[Field, int, int]]:
    """The fields of a group with their highest and lowest bit in it, the highest first."""
    layout = next(layout for _, layout in device.layouts() if any(field.group == name for field in layout.fields))
    parts = [field for field in layout.fields if field.group == name]
    first = min(field.low.constant for field in parts)
    placed = [(field, field.low.constant - first + field.width.constant - 1, field.low.constant - first) for field in parts]
    return sorted(placed, key=lambda item: -item[1])


def group_rows(device: Device, name: str) -> Iterator[tuple[str, ...]]:
    for field, high, low in group_fields(device, name):
        yield named(field.name, field.printed_name, field.names), f"{high}" if high == low else f"{high}:{low}", field_meaning(field), cited(field.source)


def used_groups(interface: Interface) -> list[str]:
    return list(dict.fromkeys(field.group for layout in interface.layouts for field in layout.fields if field.group))


def placement_table(device: Device, layout: Layout, kind: str) -> str:
    """Where each field stands for each order code, as a table; empty where that is the same for all."""
    shapes = placements(device, layout, kind)
    if len(shapes) < 2:
        return ""
    moving = [field for field in layout.fields if not (field.padding_of or field.low.is_constant and field.width.is_constant)]
    within = {field.name: place(layout, field, bits=layout.widest) for field in moving if field.container and layout.sender}
    rows = []
    for shape in shapes:
        cells = []
        for field in moving:
            item = shape.placed.field(field.name)
            below = item.low if item is not None and field.name in within else 0
            cells.append("–" if item is None else bit_range(item.high - below, item.low - below))
        total = [f"{shape.placed.bits}"] if not layout.bits.is_constant else [""]
        rows.append([", ".join(map(code, shape.codes)), *total, *cells])
    return table(["Order codes", "Bits", *(code(field.name) + (f" in {within[field.name]}" if field.name in within else "") for field in moving)], rows)


def bit_range(high: int, low: int) -> str:
    return f"{high}" if high == low else f"{high}:{low}"


def join_lines(layout: Layout) -> list[str]:
    """Each number that is made of several fields, in words."""
    found = [join for join in layout.joins if join.fields != (join.name,)]
    return [f"{code(join.name)} is {', then '.join(map(code, join.fields))}, the first of them most significant." for join in found]


# ------------------------------------------------------------------------------------------------------------------ pictures


def layout_picture(device: Device, interface: Interface, layout: Layout) -> str:
    """The layout as SVG: a strip for each shape that it has, or the bytes of a frame."""
    shapes = placements(device, layout, interface.kind)
    title = layout.printed_name or layout.name.replace("_", " ")
    if layout.carried_as == "bytes":
        return draw(title, [byte_strip("", shapes[-1].placed)], _BYTE_BIT)
    left = interface.alignment == "msb_left"
    strips = [bit_strip(_caption(shape), shape.placed, layout.widest, left) for shape in shapes]
    return draw(title, strips, _BIT)


def _caption(shape: Placement) -> str:
    more = f" and {len(shape.codes) - 2} more" if len(shape.codes) > 2 else ""
    return f"{', '.join(shape.codes[:2])}{more}: {shape.placed.bits} bits"


def group_picture(device: Device, name: str) -> str:
    group = next(item for item in device.field_groups if item.name == name)
    return draw(group.printed_name or name, [group_strip(group_fields(device, name), group.bits)], 8 * _BYTE_BIT)


def has_picture(register: Register) -> bool:
    """A register that is one field from end to end needs none."""
    fields = register.layout.fields
    return len(fields) > 1 or fields[0].width != Expression(8 * register.length)


def register_picture(device: Device, register: Register) -> str:
    shapes = placements(device, register.layout, register.interface)
    captions = [_caption(shape).rpartition(":")[0] if len(shapes) > 1 else "" for shape in shapes]
    low_first = register.byte_order == "low_byte_first"
    strips: Sequence[Strip] = [register_strip(caption, shape.placed, register.address, low_first) for caption, shape in zip(captions, shapes)]
    return draw(register.printed_name or register.name, strips, max(_BIT, 42.0 if register.length == 1 else _BIT))
