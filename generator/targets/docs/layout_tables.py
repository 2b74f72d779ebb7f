"""Markdown tables of the fields in a layout (a frame or register), and the arrangements of its fields."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from ...model import (
    Alternative,
    Answer,
    Device,
    Field,
    FieldGroup,
    Interface,
    Layout,
    PlacedField,
    PlacedLayout,
    answer_combinations,
    first_or_raise,
)
from ...model.record import dataclass
from ...say.errata import answer_names
from ...say.layout import field_place, frame_bytes
from ...say.names_and_evidence import HasOtherNames, bit_range, bits, hexadecimal
from ...say.register import describe_field_rules, describe_value
from ...say.text import (
    MARKDOWN,
    CodeText,
    Statement,
    citation,
    code_span,
    escape,
    join_filled,
    join_groups,
    list_parts,
    markdown_link,
    spec_text,
    statement,
    table,
)
from .order_code_tables import order_codes

#: Highest number of named values in a cell. If there are more, they have their own table.
_MOST_VALUES_IN_CELL = 4
_NO_PARAMETERS: Mapping[str, int] = MappingProxyType({})
#: Fields with their highest and lowest bit in a group, highest field first.
GroupFields = list[tuple[Field, int, int]]
#: Name, lowest bit and width of each field.
FieldPositions = tuple[tuple[str, int, int], ...]


@dataclass(frozen=True)
class LayoutOfCodes:
    """Layout with the positions of its fields for some order codes."""

    codes: tuple[str, ...]
    placed_layout: PlacedLayout


def distinct_layouts(
    device: Device, layout: Layout, interface_name: str, parameters: Mapping[str, int] = _NO_PARAMETERS
) -> tuple[LayoutOfCodes, ...]:
    """Return the layout with each arrangement of its fields for the order codes of an interface, the shortest first.

    Arrangements differ in the names, lowest bits or widths of the fields. ``parameters`` are the values that answers to
    open questions set, if they differ from the first answers.
    """
    codes_by_positions: dict[FieldPositions, list[str]] = {}
    layout_by_positions: dict[FieldPositions, PlacedLayout] = {}
    for variant in device.variants_over(interface_name):
        placed_layout = layout.place({**variant.parameters, **parameters})
        positions = positions_of_fields(placed_layout)
        layout_by_positions.setdefault(positions, placed_layout)
        codes_by_positions.setdefault(positions, []).append(variant.code)
    layouts_of_codes = []
    for positions, placed_layout in layout_by_positions.items():
        layouts_of_codes.append(LayoutOfCodes(codes=tuple(codes_by_positions[positions]), placed_layout=placed_layout))
    return tuple(sorted(layouts_of_codes, key=lambda layout_of_codes: layout_of_codes.placed_layout.bits))


def positions_of_fields(placed_layout: PlacedLayout) -> FieldPositions:
    """Return the name, lowest bit and width of each field."""
    return tuple((field.name, field.lowest_bit, field.width) for field in placed_layout.fields)


def name_cell(named_part: HasOtherNames) -> str:
    """Return the name of an item as code, with its name in the manual below it."""
    return join_filled([code_span(named_part.name), escape(named_part.printed_name)])


def field_cell(device: Device, field: Field, in_register: bool = False) -> str:
    """Return all statements about a field in one cell.

    If a register field has many named values, they have a table of their own, which the cell refers to.
    """
    statements = [
        *spec_text(field.meaning),
        *_value_statements(field, in_register),
        *describe_field_rules(device, field),
        *spec_text(field.note),
    ]
    return join_filled(map(MARKDOWN.sentence, statements))


def _value_statements(field: Field, in_register: bool) -> Iterator[Statement]:
    """Yield a statement for each named value of a field or, if there are many, a single statement.

    For a register, this statement refers to the table of values. For a frame, it lists the values without meanings.
    """
    if not has_value_table(field):
        for named_value in field.values:
            yield describe_value(replace(named_value, source=()), field.widest)
    elif in_register:
        yield statement("See the table of values below")
    else:
        numbers_and_names = []
        for named_value in field.values:
            value_without_meaning = replace(named_value, meaning="")
            numbers_and_names.append(describe_value(value_without_meaning, field.widest).parts)
        yield statement(*join_groups(numbers_and_names, ", "), label="Values")


def has_value_table(field: Field) -> bool:
    """Return whether a field has too many named values for one cell."""
    return len(field.values) > _MOST_VALUES_IN_CELL


def value_rows(field: Field) -> Iterator[tuple[str, ...]]:
    """Yield rows of value, name, meaning, source for the named values of a field."""
    # A hexadecimal digit for each 4 bits, rounded up.
    digit_count = (field.widest + 3) // 4
    for named_value in field.values:
        number = hexadecimal(named_value.value, digit_count)
        yield number, name_cell(named_value), escape(named_value.meaning), citation(named_value.source)


def field_rows(device: Device, layout: Layout) -> Iterator[tuple[str, ...]]:
    """Yield rows of field, place, width, meaning, source. A group of fields has one row, with a link to its table."""
    for field_or_group in fields_and_groups(device, layout):
        if isinstance(field_or_group, FieldGroup):
            yield _group_row(device, layout, field_or_group)
        else:
            yield _field_row(device, layout, field_or_group)


def _group_row(device: Device, layout: Layout, field_group: FieldGroup) -> tuple[str, ...]:
    """Return a row of group, place, number of bits, names of its fields, and an empty source."""
    group_link = markdown_link(code_span(field_group.name), f"#group-{field_group.name}")
    field_names = [CodeText(field.name) for field in layout.fields if field.group == field_group.name]
    fields_statement = statement(*list_parts(field_names), label="Fields")
    return (
        join_filled([group_link, escape(field_group.printed_name)]),
        group_place(device, layout, field_group),
        f"{field_group.bits}",
        MARKDOWN.sentence(fields_statement),
        "",
    )


def _field_row(device: Device, layout: Layout, field: Field) -> tuple[str, ...]:
    """Return a row of field, place, width, meaning, source."""
    return (
        name_cell(field),
        field_place_cell(layout, field, device.alternatives_of(layout)),
        MARKDOWN.number(field.width),
        field_cell(device, field, in_register=not layout.sender),
        citation(field.source) if field.source != layout.source else "",
    )


def fields_and_groups(device: Device, layout: Layout) -> Iterator[Field | FieldGroup]:
    """Yield the groups of fields, and the fields outside groups, in the order of the layout.

    Padding is omitted, because the row of the padded field includes it.
    """
    group_by_name = {group.name: group for group in device.field_groups}
    field_names = {field.name for field in layout.fields}
    yielded_group_names: set[str] = set()
    for field in layout.fields:
        if field.padding_of in field_names or field.group in yielded_group_names:
            continue
        if field.group:
            yielded_group_names.add(field.group)
        yield group_by_name.get(field.group, field)


def group_place(device: Device, layout: Layout, field_group: FieldGroup) -> str:
    """Return the bytes of the longest frame that contain a group of fields, for the first answers to open questions."""
    fields_of_group = [field for field in layout.fields if field.group == field_group.name]
    lowest_bit = _lowest_bit(fields_of_group, _first_answers(device))
    highest_bit = lowest_bit + field_group.bits - 1
    return frame_bytes(layout, layout.widest, highest_bit, lowest_bit)


def field_place_cell(layout: Layout, field: Field, alternatives: Sequence[Alternative] = ()) -> str:
    """Return the place of a field, or its place for each answer to open questions that decide it."""
    return MARKDOWN.phrase(statement(*field_place(layout, field, alternatives)))


def _first_answers(device: Device) -> Mapping[str, int]:
    """Return the values of the parameters that the first answer to each open question sets."""
    return next(parameters for _, parameters in answer_combinations(device.alternatives))


def _lowest_bit(fields: Iterable[Field], parameters: Mapping[str, int]) -> int:
    """Return the lowest bit of several fields for these values of the parameters."""
    return min(field.low.value(parameters) for field in fields)


def arrangements_of_group(device: Device, group_name: str) -> list[tuple[tuple[Answer, ...], GroupFields]]:
    """Return the fields of a group for each combination of answers to the open questions that move these fields.

    Each field has its highest and lowest bit, counted from the lowest bit of the group in the first layout with this
    group. If no question moves the fields, there is a single result, without answers.
    """
    layouts = (layout for _, layout in device.layouts() if _has_group(layout, group_name))
    layout = first_or_raise(layouts, f"frame with the field group '{group_name}'")
    fields = [field for field in layout.fields if field.group == group_name]
    alternatives = device.alternatives_of(layout)
    deciding_alternatives = [alternative for alternative in alternatives if _decides_place_of_any(fields, alternative)]
    arrangements = []
    for answers, parameters in answer_combinations(deciding_alternatives):
        lowest_bit_of_group = _lowest_bit(fields, parameters)
        group_fields: GroupFields = []
        for field in fields:
            lowest_bit = field.low.value(parameters) - lowest_bit_of_group
            highest_bit = lowest_bit + field.width.constant - 1
            group_fields.append((field, highest_bit, lowest_bit))
        group_fields.sort(key=_highest_first)
        arrangements.append((answers, group_fields))
    return arrangements


def _highest_first(group_field: tuple[Field, int, int]) -> int:
    """Return the sort key that puts the field with the highest bit first."""
    _, highest_bit, _ = group_field
    return -highest_bit


def _has_group(layout: Layout, name: str) -> bool:
    """Return whether a layout contains the group of fields with this name."""
    return any(field.group == name for field in layout.fields)


def _decides_place_of_any(fields: Iterable[Field], alternative: Alternative) -> bool:
    """Return whether the answers to an open question determine the place or width of any of these fields."""
    # All answers set the same parameters.
    answered_parameters = alternative.answers[0].sets.keys()
    for field in fields:
        parameters_of_place = (*field.low.parameters, *field.width.parameters)
        if not answered_parameters.isdisjoint(parameters_of_place):
            return True
    return False


def group_rows(device: Device, name: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of field, place, meaning, source for a group of fields."""
    for field, place in group_places(device, name, _answers_in_words):
        yield name_cell(field), place, field_cell(device, field), citation(field.source)


def _answers_in_words(answers: Sequence[Answer]) -> str:
    """Return the names of answers as code, such as ```normal```."""
    return MARKDOWN.phrase(statement(*answer_names(answers)))


def group_places(
    device: Device, name: str, answers_text: Callable[[Sequence[Answer]], str]
) -> Iterator[tuple[Field, str]]:
    """Yield the fields of a group, each with its place in the group.

    If answers to open questions move a field, all its places are listed, such as ``bit 3 (normal)<br>bit 4 (swapped)``.
    If several answers lead to the same place, the first of them is named.
    """
    arrangements = arrangements_of_group(device, name)
    _, fields_of_first_arrangement = arrangements[0]
    for field, _, _ in fields_of_first_arrangement:
        answers_by_bits: dict[str, str] = {}
        for answers, group_fields in arrangements:
            bits_texts = (
                bits(highest_bit, lowest_bit)
                for group_field, highest_bit, lowest_bit in group_fields
                if group_field is field
            )
            bits_text = first_or_raise(bits_texts, f"place of '{field.name}'")
            answers_by_bits.setdefault(bits_text, answers_text(answers))
        if len(answers_by_bits) == 1:
            yield field, join_filled(answers_by_bits)
        else:
            yield field, join_filled(f"{bits_text} ({answers})" for bits_text, answers in answers_by_bits.items())


def links_to_frames_with(interface: Interface, group: str) -> list[str]:
    """Return links to the frames that contain a group of fields."""
    layouts = [layout for layout in interface.layouts if _has_group(layout, group)]
    return [markdown_link(code_span(layout.name), f"#layout-{layout.name}") for layout in layouts]


def used_groups(interface: Interface) -> list[str]:
    """Return the names of the field groups in the frames, in the order of their first use."""
    group_names: dict[str, None] = {}
    for layout in interface.layouts:
        group_names |= dict.fromkeys(field.group for field in layout.fields if field.group)
    return list(group_names)


def table_of_positions(device: Device, layout: Layout, interface_name: str) -> str:
    """Return a table of field positions by order code, or "" if they are the same for all order codes.

    Answers to open questions that change the length of the layout have rows of their own. Places for the answers to
    all other questions are in the main table of fields.
    """
    questions = [question for question in device.alternatives_of(layout) if _decides_length(layout, question)]
    # ``parameters`` are the values that the answers set.
    answers_and_layouts: list[tuple[tuple[Answer, ...], LayoutOfCodes]] = []
    for answers, parameters in answer_combinations(questions):
        for layout_of_codes in distinct_layouts(device, layout, interface_name, parameters):
            answers_and_layouts.append((answers, layout_of_codes))
    if len(answers_and_layouts) < 2:
        return ""
    moved_fields = _fields_moved_by_order_code(device, layout)
    place_by_padded_field = _places_of_containers(layout, moved_fields)
    table_rows = []
    for answers, layout_of_codes in answers_and_layouts:
        placed_layout = layout_of_codes.placed_layout
        length_cell = "" if layout.bits.is_constant else f"{placed_layout.bits}"
        bits_cells = []
        for field in moved_fields:
            placed_field = placed_layout.find_field(field.name)
            bits_cells.append(_bits_cell(placed_field, count_from_lowest_bit=field.name in place_by_padded_field))
        answer_cells = [code_span(answer.name) for answer in answers]
        table_rows.append([order_codes(device, layout_of_codes.codes), *answer_cells, length_cell, *bits_cells])
    question_heads = [
        markdown_link(code_span(question.name), f"#alternative-{question.name}") for question in questions
    ]
    field_heads = [_field_head(field, place_by_padded_field) for field in moved_fields]
    return table(["Order codes", *question_heads, "Bits", *field_heads], table_rows)


def _fields_moved_by_order_code(device: Device, layout: Layout) -> list[Field]:
    """Return the fields, except padding, whose place or width depends on the order code."""
    answered_parameters: set[str] = set()
    for alternative in device.alternatives:
        answered_parameters.update(alternative.answers[0].sets)
    fields_without_padding = [field for field in layout.fields if not field.padding_of]
    return [field for field in fields_without_padding if _depends_on_order_code(field, answered_parameters)]


def _places_of_containers(layout: Layout, fields: Sequence[Field]) -> dict[str, str]:
    """Return the place of each container (the bits of a field with its padding), by the name of the field.

    Registers have no containers, so the result for a register is empty.
    """
    if not layout.sender:
        return {}
    return {field.name: field_place_cell(layout, field) for field in fields if field.container}


def _bits_cell(placed_field: PlacedField | None, *, count_from_lowest_bit: bool) -> str:
    """Return the bits of a field, or a dash if it is None, which means that the order code does not have the field.

    If ``count_from_lowest_bit`` is True, bits are counted from the lowest bit of the field.
    """
    if placed_field is None:
        return "–"
    bit_0 = placed_field.lowest_bit if count_from_lowest_bit else 0
    return bit_range(placed_field.highest_bit - bit_0, placed_field.lowest_bit - bit_0)


def _field_head(field: Field, place_by_padded_field: Mapping[str, str]) -> str:
    """Return the name of a field for the head of its column, followed by the place of its container if it has one."""
    name = code_span(field.name)
    return f"{name} in {place_by_padded_field[field.name]}" if field.name in place_by_padded_field else name


def _decides_length(layout: Layout, alternative: Alternative) -> bool:
    """Return whether the length of the layout depends on the answer to an open question."""
    return not alternative.answers[0].sets.keys().isdisjoint(layout.bits.parameters)


def _depends_on_order_code(field: Field, answered_parameters: Container[str]) -> bool:
    """Return whether the position or width of a field depends on any parameter that answers do not set."""
    parameters_of_place = (*field.low.parameters, *field.width.parameters)
    return any(name not in answered_parameters for name in parameters_of_place)
