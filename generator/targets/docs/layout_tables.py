"""Markdown tables of the fields of a layout, and pictures of the layout."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from ...model import Alternative, Answer, Device, Field, FieldGroup, Interface, Layout, PlacedLayout, Register, choices
from ...model.expressions import Expression
from ...model.record import dataclass
from ...say.alternative import names
from ...say.field import rules, value
from ...say.markdown import STYLE, cited, code, joined, link, table, text
from ...say.name import Named
from ...say.place import bit_range, bits, field_place, frame_bytes, hexadecimal
from ...say.text import Code, Statement, listed, parted, spec_text, statement
from .layout_pictures import Byte, Stack, bit_stack, byte_stack, group_stack, register_stack
from .order_code_patterns import order_codes

#: Highest number of named values in a cell. If there are more, they have their own table.
_FEW = 4
_NO_SETS: Mapping[str, int] = MappingProxyType({})
#: Fields with their highest and lowest bit in a group, highest field first.
GroupFields = list[tuple[Field, int, int]]


@dataclass(frozen=True)
class Placement:
    """Layout with the positions that apply to some order codes."""

    codes: tuple[str, ...]
    placed: PlacedLayout


def placements(device: Device, layout: Layout, kind: str, sets: Mapping[str, int] = _NO_SETS) -> tuple[Placement, ...]:
    """Return the different shapes that the layout has for the order codes of an interface, shortest first.

    ``sets`` are the parameters set by answers to alternatives, if those are not the first answers.
    """
    placements_by_shape: dict[tuple[tuple[str, int, int], ...], tuple[PlacedLayout, list[str]]] = {}
    for variant in device.variants_over(kind):
        placed = layout.place({**variant.parameters, **sets})
        shape = tuple((placed_field.name, placed_field.low, placed_field.width) for placed_field in placed.fields)
        placements_by_shape.setdefault(shape, (placed, []))[1].append(variant.code)
    return tuple(
        sorted(
            (Placement(tuple(codes), placed) for placed, codes in placements_by_shape.values()),
            key=lambda placement: placement.placed.bits,
        )
    )


def named(named_part: Named) -> str:
    """Return a name as code, with the name used in the manual below it."""
    return joined([code(named_part.name), text(named_part.printed_name)])


def field_cell(device: Device, field: Field, in_register: bool = False) -> str:
    """Return all statements about a field in one cell. Many values of a register are in a separate table."""
    parts = [*spec_text(field.meaning), *_values(field, in_register), *rules(device, field), *spec_text(field.note)]
    return joined(map(STYLE.sentence, parts))


def _values(field: Field, in_register: bool) -> Iterator[Statement]:
    if not has_value_table(field):
        yield from (value(replace(named_value, source=()), field.widest) for named_value in field.values)
    elif in_register:
        yield statement("See the table of values below")
    else:
        names = (value(replace(named_value, meaning=""), field.widest).parts for named_value in field.values)
        yield statement(*parted(names, ", "), label="Values")


def has_value_table(field: Field) -> bool:
    """Return whether a field has too many values for one cell."""
    return len(field.values) > _FEW


def value_rows(field: Field) -> Iterator[tuple[str, ...]]:
    """Yield rows of value, name, meaning, source."""
    for named_value in field.values:
        number = hexadecimal(named_value.value, (field.widest + 3) // 4)
        yield number, named(named_value), text(named_value.meaning), cited(named_value.source)


def field_rows(device: Device, layout: Layout) -> Iterator[tuple[str, ...]]:
    """Yield rows of field, place, width, meaning, source. A group of fields is one row with a link to its table."""
    for field_or_group in in_rows(device, layout):
        if isinstance(field_or_group, FieldGroup):
            name = joined(
                [link(code(field_or_group.name), f"#group-{field_or_group.name}"), text(field_or_group.printed_name)]
            )
            parts = [Code(field.name) for field in layout.fields if field.group == field_or_group.name]
            made_of = STYLE.sentence(statement(*listed(parts), label="Fields"))
            yield name, group_place(device, layout, field_or_group), f"{field_or_group.bits}", made_of, ""
        else:
            yield (
                named(field_or_group),
                field_place_cell(layout, field_or_group, device.alternatives_of(layout)),
                STYLE.number(field_or_group.width),
                field_cell(device, field_or_group, in_register=not layout.sender),
                cited(field_or_group.source) if field_or_group.source != layout.source else "",
            )


def in_rows(device: Device, layout: Layout) -> Iterator[Field | FieldGroup]:
    """Yield the groups of fields, and the fields outside of groups. Padding is in the row of the padded field."""
    groups = {group.name: group for group in device.field_groups}
    field_names = {field.name for field in layout.fields}
    unpadded = (field for field in layout.fields if field.padding_of not in field_names)
    rows = {(field.group, "" if field.group else field.name): groups.get(field.group, field) for field in unpadded}
    yield from rows.values()


def group_place(device: Device, layout: Layout, group: FieldGroup) -> str:
    """Return the bytes of a frame that hold a group of fields."""
    low = _first_bit((field for field in layout.fields if field.group == group.name), _first_answers(device))
    return frame_bytes(layout, layout.widest, low + group.bits - 1, low)


def field_place_cell(layout: Layout, field: Field, alternatives: Sequence[Alternative] = ()) -> str:
    return STYLE.phrase(statement(*field_place(layout, field, alternatives)))


def _first_answers(device: Device) -> Mapping[str, int]:
    return next(sets for _, sets in choices(device.alternatives))


def _first_bit(fields: Iterable[Field], sets: Mapping[str, int]) -> int:
    return min(field.low.value(sets) for field in fields)


def group_shapes(device: Device, name: str) -> list[tuple[tuple[Answer, ...], GroupFields]]:
    """Return the fields of a group, once for each choice that moves them."""
    layout = next(layout for _, layout in device.layouts() if any(field.group == name for field in layout.fields))
    parts = [field for field in layout.fields if field.group == name]
    deciding = [
        alternative
        for alternative in device.alternatives_of(layout)
        if any(_follows(field, alternative) for field in parts)
    ]
    shapes = []
    for answers, sets in choices(deciding):
        first = _first_bit(parts, sets)
        lows = ((field, field.low.value(sets) - first) for field in parts)
        placed = [(field, low + field.width.constant - 1, low) for field, low in lows]
        shapes.append((answers, sorted(placed, key=lambda placed_field: -placed_field[1])))
    return shapes


def _follows(field: Field, alternative: Alternative) -> bool:
    """Return whether an alternative decides the place of a field."""
    return not alternative.answers[0].sets.keys().isdisjoint((*field.low.parameters, *field.width.parameters))


def group_rows(device: Device, name: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of field, place, meaning, source."""
    for field, where in group_places(device, name, lambda answers: STYLE.phrase(statement(*names(answers)))):
        yield named(field), where, field_cell(device, field), cited(field.source)


def group_places(device: Device, name: str, written: Callable[[Sequence[Answer]], str]) -> Iterator[tuple[Field, str]]:
    """Yield the fields of a group, each with its place, or with the place for each of the answers that move it."""
    shapes = group_shapes(device, name)
    for field, _, _ in shapes[0][1]:
        places: dict[str, str] = {}
        for answers, fields in shapes:
            place = next(bits(high, low) for moved_field, high, low in fields if moved_field is field)
            places.setdefault(place, written(answers))
        several = len(places) > 1
        yield field, joined(f"{place} ({answer})" if several else place for place, answer in places.items())


def frames_with(interface: Interface, group: str) -> list[str]:
    """Return links to the frames that contain a group of fields."""
    layouts = [layout for layout in interface.layouts if any(field.group == group for field in layout.fields)]
    return [link(code(layout.name), f"#layout-{layout.name}") for layout in layouts]


def used_groups(interface: Interface) -> list[str]:
    return list(dict.fromkeys(field.group for layout in interface.layouts for field in layout.fields if field.group))


def placement_table(device: Device, layout: Layout, kind: str) -> str:
    """Return a table of field positions by order code and choice, or an empty string if they are the same for all.

    Only choices that change the length are included. The row of a field shows its places for all other choices.
    """
    deciding = [alternative for alternative in device.alternatives_of(layout) if _lengthens(layout, alternative)]
    shapes = [
        (answers, shape) for answers, sets in choices(deciding) for shape in placements(device, layout, kind, sets)
    ]
    if len(shapes) < 2:
        return ""
    decided = {name for alternative in device.alternatives for name in alternative.answers[0].sets}
    moving = [field for field in layout.fields if not field.padding_of and _moves(field, decided)]
    within = {field.name: field_place_cell(layout, field) for field in moving if field.container and layout.sender}
    rows = []
    for answers, shape in shapes:
        cells = []
        for field in moving:
            placed_field = shape.placed.find_field(field.name)
            container_low = placed_field.low if placed_field is not None and field.name in within else 0
            cells.append(
                "–"
                if placed_field is None
                else bit_range(placed_field.high - container_low, placed_field.low - container_low)
            )
        total = [f"{shape.placed.bits}"] if not layout.bits.is_constant else [""]
        rows.append([order_codes(device, shape.codes), *(code(answer.name) for answer in answers), *total, *cells])
    return table(
        [
            "Order codes",
            *(link(code(alternative.name), f"#alternative-{alternative.name}") for alternative in deciding),
            "Bits",
            *(code(field.name) + (f" in {within[field.name]}" if field.name in within else "") for field in moving),
        ],
        rows,
    )


def _lengthens(layout: Layout, alternative: Alternative) -> bool:
    """Return whether the length of the layout depends on an alternative."""
    return not alternative.answers[0].sets.keys().isdisjoint(layout.bits.parameters)


def _moves(field: Field, decided: Container[str]) -> bool:
    """Return whether the position or width of a field depends on the order code."""
    return any(name not in decided for name in (*field.low.parameters, *field.width.parameters))


# -- picture contents


def layout_stacks(device: Device, interface: Interface, layout: Layout) -> list[Stack]:
    """Return the bytes of each shape of a layout, once for each choice that moves a field in the picture."""
    stacks_by_rows: dict[tuple[Byte, ...], Stack] = {}
    for answers, sets in choices(device.alternatives_of(layout)):
        for stack in _stacks(layout, placements(device, layout, interface.name, sets)):
            stacks_by_rows.setdefault(stack.rows, replace(stack, caption=_decided(answers, stack.caption)))
    stacks = list(stacks_by_rows.values())
    return [replace(stack, caption="") for stack in stacks] if layout.in_bytes and len(stacks) == 1 else stacks


def _stacks(layout: Layout, shapes: Sequence[Placement]) -> Iterator[Stack]:
    if layout.in_bytes:
        yield byte_stack("", shapes[-1].placed)
        return
    for shape in shapes:
        yield bit_stack(f"{_caption(shape)}: {shape.placed.bits} bits", shape.placed)


def shapes(device: Device, interface: Interface, layout: Layout) -> list[tuple[str, PlacedLayout]]:
    """Return each shape of a layout for one order code, with the answers that lead to it as a caption."""
    placed_by_shape: dict[tuple[tuple[str, int, int], ...], tuple[str, PlacedLayout]] = {}
    for answers, sets in choices(device.alternatives_of(layout)):
        for placement in placements(device, layout, interface.name, sets):
            places = tuple((field.name, field.low, field.width) for field in placement.placed.fields)
            placed_by_shape.setdefault(places, (_decided(answers, f"{placement.placed.bits} bits"), placement.placed))
    listed = list(placed_by_shape.values())
    return [("", listed[0][1])] if len(listed) == 1 else listed


def _decided(answers: Sequence[Answer], caption: str) -> str:
    return ", ".join(filter(None, (*(answer.name for answer in answers), caption)))


def _caption(shape: Placement) -> str:
    further_codes = f" and {len(shape.codes) - 2} more" if len(shape.codes) > 2 else ""
    return f"{', '.join(shape.codes[:2])}{further_codes}"


def group_stacks(device: Device, group: FieldGroup) -> list[Stack]:
    shapes = group_shapes(device, group.name)
    return [group_stack(_decided(answers, ""), fields, group.bits) for answers, fields in shapes]


def has_picture(register: Register) -> bool:
    """Return whether a register has anything other than one field of full width."""
    fields = register.layout.fields
    return len(fields) > 1 or fields[0].width != Expression(8 * register.length)


def register_stacks(device: Device, register: Register) -> list[Stack]:
    shapes = placements(device, register.layout, register.interface)
    low_first = register.byte_order == "low_byte_first"
    return [
        register_stack(_caption(placement) if len(shapes) > 1 else "", placement.placed, register.address, low_first)
        for placement in shapes
    ]
