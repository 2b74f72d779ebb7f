"""Tables about order codes: their parts and quantities, patterns for many codes, and facts about the position frame."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import count
from typing import Any

from ...model import (
    Alternative,
    Answer,
    Crc,
    Device,
    Interface,
    Layout,
    Measurement,
    OrderCode,
    Parameter,
    PlacedField,
    PlacedLayout,
    Variant,
    member_named,
)
from ...order_codes.labels import fill_pattern
from ...order_codes.parameters import parameters_of, run_time_names, with_answers
from ...plan.values import ActiveFlag, TwosComplement, meaning_of
from ...plan.verdicts import verdict_rules_in_family
from ...say.layout import crc_inverted, crc_reflected
from ...say.markdown import MARKDOWN, citation, code_span, escape, join_filled, markdown_link
from ...say.names_and_places import heading
from ...say.order_code import open_values, parameter_origin, parameter_value
from ...say.plain_text import count_with_unit, group_digits
from ...say.register import covered_by_parity_bit, describe_measurement, describe_position_range, own_ranges
from ...say.report import deciding_value
from .page_links import style_in_folder
from .verdict_table import changed_verdicts_of, place_of_field, verdict_line


def part_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of part, meaning, value, meaning of the value, source, for all parts of the order code.

    If a part accepts values that are not listed, its last row says so.
    """
    parameters = {parameter.name: parameter for parameter in device.parameters}
    for part in device.order_code.parts:
        name_cell, meaning_cell = code_span(part.name), escape(part.meaning)
        for value in part.values:
            assignments = [_assignment_text(parameters[name], number) for name, number in value.sets.items()]
            meaning_parts = [escape(value.meaning), ", ".join(assignments), _combinable_parts(value.only_with)]
            value_meaning_cell = join_filled(meaning_parts)
            yield (
                name_cell,
                meaning_cell,
                code_span(value.text),
                value_meaning_cell,
                citation(value.source or part.source),
            )
            # Only the first row of a part names it.
            name_cell, meaning_cell = "", ""
        for open_value in open_values(part):
            other_values_cell = join_filled([MARKDOWN.sentence(open_value), _combinable_parts(part.open_only_with)])
            yield "", "", "", other_values_cell, citation(part.source)


def _assignment_text(parameter: Parameter, number: int) -> str:
    """Return a parameter with a value as an assignment: ```position_bits` = 24``."""
    return f"{code_span(parameter.name)} = {parameter_value(parameter, number)}"


def spelling_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of pattern, its use, texts that differ from the order code, source for other spellings on labels."""
    for spelling in device.order_code.also_written:
        differing_values = [value for value in spelling.values if value.text != value.value]
        texts_of_values = "; ".join(
            f"{code_span(value.text)} is {code_span(value.value)}" for value in differing_values
        )
        ignored_ending = f"{code_span(spelling.then)} may follow and has no meaning here" if spelling.then else ""
        yield (
            code_span(spelling.pattern),
            escape(spelling.where),
            join_filled([texts_of_values, ignored_ending]),
            citation(spelling.source),
        )


def _combinable_parts(texts_by_part: Mapping[str, Sequence[str]]) -> str:
    """Return the condition on other parts of the order code: ``only with `output` `BG`, `GG```.

    ``texts_by_part`` are the texts that each of these parts may have. The result is empty without conditions.
    """
    conditions = []
    for part_name, texts in texts_by_part.items():
        conditions.append(f"only with {code_span(part_name)} {', '.join(map(code_span, texts))}")
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
        if alternative in (*device.alternatives_of(layout), *device.verdict_alternatives(layout)):
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
    parameters = {parameter.name: parameter for parameter in device.parameters}
    assignments = []
    for name, value in answer.sets.items():
        # A device reduced to one interface does not have the parameters of other interfaces.
        if name in parameters:
            assignments.append(f"{_assignment_text(parameters[name], value)} ({escape(parameters[name].meaning)})")
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
                position_in_frame = f"{code_span(interface_measurement.of)} in {code_span(layout_name)}"
                range_text = MARKDOWN.phrase(describe_position_range(frame_range))
                yield position_in_frame, range_text, citation(frame_range.source)


def _measurement_row(measurement: Measurement, over_interface: str = "") -> tuple[str, ...]:
    """Return a row of position, unit and range, source. ``over_interface`` follows the name of the position."""
    return (
        code_span(measurement.of) + over_interface,
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
    texts_by_variant = [_texts_of_parts(variant, part_names) for variant in variants]
    products = _group_into_products(texts_by_variant)
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


def _group_into_products(combinations: Sequence[PartTexts]) -> Iterator[list[list[str]]]:
    """Yield groups of order codes, each as the texts that its parts can have: ``[["A"], ["1", "2"]]`` for A-1 and A-2.

    Within a group, the texts of all parts can be combined freely. If they cannot, the order codes are split by the part
    that leads to the fewest groups: A-1, A-2 and B-1 become one group with A-1 and A-2, and one with B-1.
    """
    number_of_parts = len(combinations[0])
    groups_by_part = [_split_by_part(combinations, index) for index in range(number_of_parts)]
    splitting_groups = [groups for groups in groups_by_part if len(groups) > 1]
    if not splitting_groups:
        texts_by_part = zip(*combinations, strict=True)
        yield [list(dict.fromkeys(texts)) for texts in texts_by_part]
        return
    for group in min(splitting_groups, key=len):
        yield from _group_into_products(group)


def _split_by_part(combinations: Sequence[PartTexts], index: int) -> list[list[PartTexts]]:
    """Return the order codes in groups: texts of the part at ``index`` that combine with the same other parts."""
    other_parts_by_text: dict[str, set[PartTexts]] = {}
    for part_texts in combinations:
        other_parts = part_texts[:index] + part_texts[index + 1 :]
        other_parts_by_text.setdefault(part_texts[index], set()).add(other_parts)
    groups: dict[frozenset[PartTexts], list[PartTexts]] = {}
    for part_texts in combinations:
        combinable_parts = frozenset(other_parts_by_text[part_texts[index]])
        groups.setdefault(combinable_parts, []).append(part_texts)
    return list(groups.values())


_SUPERSCRIPT_DIGITS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_EXPONENT_IN_TEXT = re.compile(r"\^([0-9]*)")


def position_frame(family_device: Device, interface: Interface) -> Layout | None:
    """Return the frame that contains the most parts of the position, or None if no frame contains any.

    Of several such frames, it is the one with the most flags, then the shortest one.
    """
    family_layouts = family_device.interface(interface.name).layouts
    position_frames = {layout.name for layout in family_layouts if family_device.sends_position(interface.name, layout)}
    candidates = [layout for layout in interface.layouts if layout.name in position_frames]
    parts_of_position = family_device.position_names(interface.name)

    def amount_of_information(layout: Layout) -> tuple[int, int, int]:
        field_names = {field.name for field in layout.fields}
        number_of_parts = len(parts_of_position & field_names)
        number_of_flags = sum(isinstance(meaning_of(field), ActiveFlag) for field in layout.fields)
        return number_of_parts, number_of_flags, -layout.widest

    return max(candidates, key=amount_of_information, default=None)


def open_questions(device: Device, layout: Layout) -> Iterator[str]:
    """Yield a sentence, with a link, for each open question whose answer is needed to read a frame."""
    for alternative in device.alternatives_of(layout):
        question = markdown_link("open question", f"#alternative-{alternative.name}")
        answers = " and ".join(code_span(answer.name) for answer in alternative.answers)
        yield f"This frame depends on an {question} with the answers {answers}."


def frame_facts(
    family_device: Device, layout: Layout, variant: Variant, choices: Sequence[str] = ()
) -> Iterator[tuple[str, str]]:
    """Yield the facts about a frame as label and text: CRC or parity bits, flags, ranges of signed fields, verdict.

    ``choices`` are the names of the open questions on the page, which the verdicts link to.
    """
    crc = family_device.crc_of(layout.place(variant.parameters))
    yield "CRC", "none" if crc is None else crc_line(family_device, crc)
    # The layout of a page is a copy with different notes. The family finds ranges only for its own layout objects.
    family_layout = member_named(family_device.interface(variant.interface).layouts, layout.name, "layout")
    placed_layout = family_layout.place(variant.parameters)
    if crc is None:
        yield from _parity_facts(placed_layout)
    yield from _flag_facts(placed_layout)
    for placed_field in placed_layout.fields:
        if isinstance(meaning_of(placed_field.field), TwosComplement):
            yield "Signed", _range_of_signed_number(family_device, placed_field, placed_layout)
    yield from _verdict_facts(family_device, family_layout, variant, choices, has_crc=crc is not None)


def _parity_facts(placed_layout: PlacedLayout) -> Iterator[tuple[str, str]]:
    """Yield a fact for each parity bit: its place and the fields that it covers."""
    for placed_field in placed_layout.fields:
        covered_fields = covered_by_parity_bit(placed_field.field)
        if covered_fields is not None:
            place = place_of_field(placed_field, placed_layout)
            yield "Parity", f"{code_span(placed_field.name)} ({place}). {MARKDOWN.phrase(covered_fields)}"


def _flag_facts(placed_layout: PlacedLayout) -> Iterator[tuple[str, str]]:
    """Yield the flags by active level, such as ``("Active at 1", "`error` (bit 3)")``, and the unused bits.

    Unused bits are listed only if they are single bits with a name in the manual, in a frame that does not consist of
    bytes.
    """
    layout = placed_layout.layout
    flags_by_label: dict[str, list[tuple[str, str]]] = {}
    for placed_field in placed_layout.fields:
        flag = (code_span(placed_field.name), place_of_field(placed_field, placed_layout))
        # The active level of a flag, or what differs from the manual: ``0`` or ``1`` for a single unused bit.
        level = deciding_value(placed_field.field)
        if isinstance(meaning_of(placed_field.field), ActiveFlag):
            flags_by_label.setdefault(f"Active at {level}", []).append(flag)
        elif not layout.in_bytes and placed_field.field.printed_name and level in {"0", "1"}:
            flags_by_label.setdefault("Not used by this encoder", []).append(flag)
    yield from ((label, ", ".join(_flags_with_places(flags))) for label, flags in flags_by_label.items())


def _verdict_facts(
    family_device: Device, layout: Layout, variant: Variant, choices: Sequence[str], has_crc: bool
) -> Iterator[tuple[str, str]]:
    """Yield the verdict on the position, if the frame has one, and each verdict that another answer adds causes to."""
    verdict_rules = verdict_rules_in_family(family_device, layout)
    if verdict_rules is None:
        return
    yield "Position", verdict_line(verdict_rules, variant, has_crc)
    alternatives = [question for question in family_device.verdict_alternatives(layout) if question.name in choices]
    for alternative in alternatives:
        # The first answer is the default.
        for answer in alternative.answers[1:]:
            variant_with_answer = with_answers(family_device, variant, {alternative.name: answer.name})
            changed_verdicts = changed_verdicts_of(verdict_rules, variant, variant_with_answer)
            if changed_verdicts:
                with_answer = markdown_link(f"With {code_span(answer.name)}", f"#alternative-{alternative.name}")
                yield with_answer, "; ".join(changed_verdicts)


def _range_of_signed_number(family_device: Device, placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return a signed field and its range, such as ``position, in two's complement, -512 to 511``."""
    lowest, highest = family_device.signed_range(placed_field, placed_layout)
    return f"{code_span(placed_field.name)}, in two's complement, {group_digits(lowest)} to {group_digits(highest)}"


def _flags_with_places(flags: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield flags with their places: ``error (byte 1, bit 0)``, then ``warning (bit 1)`` in the same byte."""
    previous_byte = ""
    for flag_name, place in flags:
        # The byte is empty for a frame of bits, whose places look like ``bit 7``.
        byte, _, bit = place.rpartition(", ")
        short_place = bit if byte == previous_byte else place
        yield f"{flag_name} ({short_place})"
        previous_byte = byte


def crc_line(family_device: Device, crc: Crc) -> str:
    """Return the parameters of a CRC in one line. The polynomial includes its top bit."""
    polynomial = _EXPONENT_IN_TEXT.sub(_in_superscript, crc.polynomial)
    crc_properties = [
        f"poly `0x{crc.poly_with_top_bit:X}` ({escape(polynomial)})",
        f"init {crc.init:#x}" if crc.init else "init 0",
        crc_reflected(family_device, crc),
        crc_inverted(crc),
        count_with_unit(crc.width, "bit"),
        "over everything before it",
    ]
    xor_sentence = ". It equals the XOR of these bytes" if crc.is_xor else ""
    return ", ".join(filter(None, crc_properties)) + xor_sentence


def _in_superscript(exponent: re.Match[str]) -> str:
    """Return an exponent such as ``^6`` in superscript digits."""
    return exponent[1].translate(_SUPERSCRIPT_DIGITS)
