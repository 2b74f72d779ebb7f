"""Tables about order codes: their parts and quantities, patterns for many codes, and widths in place of ranges."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any

from ...model import (
    Alternative,
    Answer,
    Device,
    Interface,
    Layout,
    Measurement,
    OrderCode,
    Parameter,
    Variant,
)
from ...order_codes.parameters import parameters_of, run_time_names
from ...order_codes.patterns import fill_pattern
from ...say.layout import describe_measurement, describe_position_range, own_ranges
from ...say.names_and_evidence import heading
from ...say.order_code import open_values, parameter_origin, parameter_value
from ...say.text import MARKDOWN, citation, code_span, escape, join_filled, markdown_link
from .links_and_errata import style_in_folder


def part_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of part, meaning, value, meaning of the value, source, for all parts of the order code.

    If a part accepts values that are not listed, its last row says so.
    """
    parameter_by_name = {parameter.name: parameter for parameter in device.parameters}
    for code_part in device.order_code.parts:
        name_cell, meaning_cell = code_span(code_part.name), escape(code_part.meaning)
        for part_value in code_part.values:
            # The parameters that this value of the part sets.
            assignment_texts = [
                _assignment_text(parameter_by_name[name], number) for name, number in part_value.sets.items()
            ]
            condition_text = _combinable_parts(part_value.only_with)
            yield (
                name_cell,
                meaning_cell,
                code_span(part_value.text),
                join_filled([escape(part_value.meaning), ", ".join(assignment_texts), condition_text]),
                citation(part_value.source or code_part.source),
            )
            # Only the first row of a part names it.
            name_cell, meaning_cell = "", ""
        for open_value in open_values(code_part):
            condition_text = _combinable_parts(code_part.open_only_with)
            other_values_cell = join_filled([MARKDOWN.sentence(open_value), condition_text])
            yield "", "", "", other_values_cell, citation(code_part.source)


def _assignment_text(parameter: Parameter, number: int) -> str:
    """Return a parameter with a value as an assignment: ```position_bits` = 24``."""
    return f"{code_span(parameter.name)} = {parameter_value(parameter, number)}"


def spelling_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of pattern, its use, texts that differ from the order code, source for other spellings on labels."""
    for spelling in device.order_code.also_written:
        # The text of a part on such a label, with the text of this part in the order code.
        differing_values = [value for value in spelling.values if value.text != value.value]
        texts_of_values = [f"{code_span(value.text)} is {code_span(value.value)}" for value in differing_values]
        ignored_ending = f"{code_span(spelling.then)} may follow and has no meaning here" if spelling.then else ""
        yield (
            code_span(spelling.pattern),
            escape(spelling.where),
            join_filled(["; ".join(texts_of_values), ignored_ending]),
            citation(spelling.source),
        )


def _combinable_parts(texts_by_part: Mapping[str, Sequence[str]]) -> str:
    """Return the condition on other parts of the order code: ``only with `output` `BG`, `GG```.

    ``texts_by_part`` are the texts that each of these parts may have. The result is empty without conditions.
    """
    conditions = []
    for part_name, texts in texts_by_part.items():
        allowed_texts = ", ".join(map(code_span, texts))
        conditions.append(f"only with {code_span(part_name)} {allowed_texts}")
    return "; ".join(conditions)


def parameter_rows(device: Device, interface_name: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of name, meaning, unit, formula, source for the quantities that order codes set over an interface."""
    for parameter in _parameters_of_order_codes(device, interface_name):
        yield (
            code_span(parameter.name),
            escape(parameter.meaning),
            escape(parameter.unit),
            MARKDOWN.number(parameter.equals) if parameter.equals is not None else "",
            citation(parameter.source),
        )


def _parameters_of_order_codes(device: Device, interface_name: str) -> list[Parameter]:
    """Return the parameters of an interface that neither answers to open questions nor registers determine."""
    names_at_run_time = run_time_names(device)
    parameters = [parameter for parameter in parameters_of(device, interface_name) if not parameter.alternative]
    return [parameter for parameter in parameters if parameter.name not in names_at_run_time]


def run_time_rows(device: Device, interface_name: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of name, meaning, origin, factory default, source for the quantities that registers determine.

    These are parameters that a register holds, possibly a register of a different interface, and parameters that are
    calculated from them.
    """
    names_at_run_time = run_time_names(device)
    for parameter in parameters_of(device, interface_name):
        if parameter.name in names_at_run_time:
            unit = f"unit: {escape(parameter.unit)}" if parameter.unit else ""
            yield (
                code_span(parameter.name),
                join_filled([escape(parameter.meaning), unit]),
                style_in_folder(device).paragraph(parameter_origin(device, parameter)),
                _factory_default(device, parameter),
                citation(parameter.source),
            )


def _factory_default(device: Device, parameter: Parameter) -> str:
    """Return the factory default of a parameter that registers determine, such as ``4,096``, or "" if it is unknown.

    It is the value for the first order code over an interface with the parameter, or ``by order code`` if the register
    has no fixed default.
    """
    if parameter.read_from and device.register(parameter.register).default is None:
        return "by order code"
    interface_names = [interface.name for interface in device.interfaces]
    interfaces_with_parameter = {name for name in interface_names if parameter in parameters_of(device, name)}
    for variant in device.variants:
        if variant.interface in interfaces_with_parameter:
            return parameter_value(parameter, variant.parameters[parameter.name])
    return ""


def code_table(device: Device, interface: Interface, links: Mapping[str, str]) -> dict[str, Any]:
    """Return the order codes of an interface as the links in ``links``, with the quantities that they set."""
    parameters = _parameters_of_order_codes(device, interface.name)
    code_rows = []
    for variant in device.variants_over(interface.name):
        quantities = [parameter_value(parameter, variant.parameters[parameter.name]) for parameter in parameters]
        code_rows.append((links[variant.code], *quantities))
    parameter_names = [code_span(parameter.name) for parameter in parameters]
    return {"head": ["Order code", *parameter_names], "rows": code_rows}


def alternative_sections(device: Device) -> list[dict[str, Any]]:
    """Return a section for each question that the manual leaves open."""
    return [_alternative_section(device, alternative) for alternative in device.alternatives]


def _alternative_section(device: Device, alternative: Alternative) -> dict[str, Any]:
    """Return a question that the manual leaves open, with a row for each answer.

    ``members`` are the parameters that each answer sets, and ``frames`` links to the frames whose layout or verdict
    depends on the answer.
    """
    frame_links = []
    for _, layout in device.layouts():
        deciding_alternatives = (*device.alternatives_of(layout), *device.verdict_alternatives(layout))
        if alternative in deciding_alternatives:
            frame_links.append(markdown_link(code_span(layout.name), f"#layout-{layout.name}"))
    return {
        "alternative": alternative,
        "title": heading(alternative.name),
        "rows": [_answer_row(device, alternative, answer) for answer in alternative.answers],
        "frames": frame_links,
        "members": list(map(code_span, alternative.answers[0].sets)),
    }


def _answer_row(device: Device, alternative: Alternative, answer: Answer) -> tuple[str, ...]:
    """Return a row of answer, meaning, quantities that it sets, source for one answer to an open question."""
    parameter_by_name = {parameter.name: parameter for parameter in device.parameters}
    assignments = []
    for name, value in answer.sets.items():
        # A device reduced to one interface does not have the parameters of other interfaces.
        if name in parameter_by_name:
            parameter = parameter_by_name[name]
            assignments.append(f"{_assignment_text(parameter, value)} ({escape(parameter.meaning)})")
    source = answer.source or alternative.source
    return code_span(answer.name), escape(answer.meaning), join_filled(assignments), citation(source)


def measurement_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of position, unit and range, source.

    The rows are for the position over all interfaces, over each interface that has a unit of its own, and in each frame
    that has a range of its own.
    """
    if device.measurement is not None:
        yield _measurement_row(device.measurement)
    for interface in device.interfaces:
        if interface.measurement is not None:
            yield _measurement_row(interface.measurement, f" over {interface.title}")
    for interface in device.interfaces:
        interface_measurement = device.measurement_of(interface.name)
        if interface_measurement is not None:
            for layout_name, frame_range in own_ranges(device, interface.name):
                position_in_frame = f"{code_span(interface_measurement.position_name)} in {code_span(layout_name)}"
                range_text = MARKDOWN.phrase(describe_position_range(frame_range))
                yield position_in_frame, range_text, citation(frame_range.source)


def _measurement_row(measurement: Measurement, over_interface: str = "") -> tuple[str, ...]:
    """Return a row of position, unit and range, source. ``over_interface`` follows the name of the position."""
    return (
        code_span(measurement.position_name) + over_interface,
        MARKDOWN.phrase(describe_measurement(measurement)),
        citation(measurement.source),
    )


#: Lowest number of order codes that are shown as patterns. Fewer codes are listed one by one.
_FEWEST_FOR_PATTERNS = 12
#: Letters that represent parts of an order code, preferred letters of manuals first.
_LETTERS_FOR_PARTS = "xyzuvwabcdefghijklmnopqrst"
#: Texts of the parts of an order code, in order.
PartTexts = tuple[str, ...]


def order_codes(device: Device, codes: Sequence[str]) -> str:
    """Return a few order codes as a list, or many order codes as patterns."""
    are_few = len(codes) < _FEWEST_FOR_PATTERNS
    return ", ".join(map(code_span, codes)) if are_few else join_filled(code_patterns(device, codes))


def code_patterns(device: Device, codes: Collection[str]) -> list[str]:
    """Return patterns that together match exactly these order codes, such as `A-x/y` with x = 1 or 2, y = B or C."""
    part_names = [part.name for part in device.order_code.parts]
    variants = [variant for variant in device.variants if variant.code in codes]
    texts_of_order_codes = [_texts_of_parts(variant, part_names) for variant in variants]
    products = _group_into_products(texts_of_order_codes)
    return [_code_pattern(device.order_code, part_names, texts_by_part) for texts_by_part in products]


def _texts_of_parts(variant: Variant, part_names: Sequence[str]) -> PartTexts:
    """Return the text of each part of an order code, or "" for a part that it lacks."""
    return tuple(variant.parts.get(name, "") for name in part_names)


def _code_pattern(order_code: OrderCode, part_names: Sequence[str], texts_of_parts: Sequence[Sequence[str]]) -> str:
    """Return the pattern of the order codes whose parts have any of these texts: ```` `A-x/B` with x = 1 or 2````."""
    # A letter that the pattern or a text also contains would be ambiguous. Each ``{part}`` in the pattern is replaced.
    pattern_without_parts = re.sub(r"\{\w+\}", "", order_code.pattern)
    fixed_letters = set(pattern_without_parts).union(*map("".join, texts_of_parts))
    letters = _unused_letters(fixed_letters)
    text_or_letter_by_part: dict[str, str] = {}
    letter_meanings: list[str] = []
    for part_name, texts in zip(part_names, texts_of_parts, strict=True):
        if len(texts) == 1:
            text_or_letter_by_part[part_name] = texts[0]
            continue
        letter = next(letters)
        text_or_letter_by_part[part_name] = letter
        choice = f"{', '.join(texts[:-1])} or {texts[-1]}"
        letter_meanings.append(f"{letter} = {choice}")
    pattern = code_span(fill_pattern(order_code.pattern, text_or_letter_by_part))
    return f"{pattern} with {', '.join(letter_meanings)}" if letter_meanings else pattern


def _unused_letters(fixed_letters: Collection[str]) -> Iterator[str]:
    """Yield the letters that no order code contains, then x1, x2 and so on."""
    yield from (letter for letter in _LETTERS_FOR_PARTS if letter not in fixed_letters)
    yield from (f"x{number}" for number in count(1))


def _group_into_products(texts_of_order_codes: Sequence[PartTexts]) -> Iterator[list[list[str]]]:
    """Yield groups of order codes, each as the texts that its parts can have: ``[["A"], ["1", "2"]]`` for A-1 and A-2.

    Within a group, the texts of all parts can be combined freely. If they cannot, the order codes are split by the part
    that leads to the fewest groups: A-1, A-2 and B-1 become one group with A-1 and A-2, and one with B-1.
    """
    part_count = len(texts_of_order_codes[0])
    groups_by_part = [_split_by_part(texts_of_order_codes, index) for index in range(part_count)]
    splitting_groups = [groups for groups in groups_by_part if len(groups) > 1]
    if not splitting_groups:
        texts_by_part = zip(*texts_of_order_codes, strict=True)
        yield [list(dict.fromkeys(texts)) for texts in texts_by_part]
        return
    for group in min(splitting_groups, key=len):
        yield from _group_into_products(group)


def _split_by_part(texts_of_order_codes: Sequence[PartTexts], part_index: int) -> list[list[PartTexts]]:
    """Return the order codes in groups: texts of the part at ``part_index`` that combine with the same other parts."""
    other_parts_by_text: dict[str, set[PartTexts]] = {}
    for part_texts in texts_of_order_codes:
        other_parts = part_texts[:part_index] + part_texts[part_index + 1 :]
        other_parts_by_text.setdefault(part_texts[part_index], set()).add(other_parts)
    groups: dict[frozenset[PartTexts], list[PartTexts]] = {}
    for part_texts in texts_of_order_codes:
        combinable_parts = frozenset(other_parts_by_text[part_texts[part_index]])
        groups.setdefault(combinable_parts, []).append(part_texts)
    return list(groups.values())


def range_of_widths(family_device: Device, parameter: Parameter) -> str:
    """Return the range that a parameter in bits has over the order codes of a family: ``17 to 39``.

    The range is empty if all order codes have the same value, or if the unit of the parameter is not bits.
    """
    if parameter.unit != "bits":
        return ""
    variants = [variant for variant in family_device.variants if parameter.name in variant.parameters]
    widths = {variant.parameters[parameter.name] for variant in variants}
    return f"{min(widths)} to {max(widths)}" if len(widths) > 1 else ""


def meaning_without_range(family_device: Device, parameter: Parameter) -> str:
    """Return the meaning of a parameter without its range over the family, for a row that begins with its value."""
    family_range = range_of_widths(family_device, parameter)
    return parameter.meaning.replace(f", {family_range} bits", "") if family_range else parameter.meaning


def with_widths_of_order_code(family_device: Device, device: Device, variant: Variant) -> Device:
    """Return the device with notes on frames that have the widths for an order code in place of ranges."""
    parameters = [parameter for parameter in family_device.parameters if parameter.name in variant.parameters]
    ranges = [range_of_widths(family_device, parameter) for parameter in parameters]
    width_by_range: dict[str, str] = {}
    for parameter, family_range in zip(parameters, ranges, strict=True):
        # A text does not distinguish two parameters with the same range.
        is_unique = ranges.count(family_range) == 1
        if family_range and is_unique:
            width_by_range[family_range] = str(variant.parameters[parameter.name])
    interfaces = [_interface_with_widths(interface, width_by_range) for interface in device.interfaces]
    return replace(device, interfaces=tuple(interfaces))


def _interface_with_widths(interface: Interface, width_by_range: Mapping[str, str]) -> Interface:
    """Return the interface with each range in the notes on its frames replaced by a width."""
    layouts = [_layout_with_widths(layout, width_by_range) for layout in interface.layouts]
    return replace(interface, layouts=tuple(layouts))


def _layout_with_widths(layout: Layout, width_by_range: Mapping[str, str]) -> Layout:
    """Return the layout with each range in its note replaced by a width."""
    note = layout.note
    # The text around a range is part of the pattern, so that it does not match within a longer number.
    for family_range, width in width_by_range.items():
        note = note.replace(f" {family_range} bits", f" {width} bits")
        note = note.replace(f", {family_range},", f", {width},")
    return replace(layout, note=note)
