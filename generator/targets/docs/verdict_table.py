"""Facts about the position frame on the page of an order code: its verdicts with conditions, its CRC and its flags."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from ...model import (
    Alternative,
    Crc,
    Device,
    Field,
    Interface,
    Layout,
    PlacedField,
    PlacedLayout,
    Variant,
    Verdict,
    member_named,
)
from ...order_codes.parameters import with_answers
from ...plan.values import ActiveFlag, TwosComplement, meaning_of
from ...plan.verdicts import MatchingValues, VerdictCause, VerdictRules, verdict_rules_in_family
from ...say import count_with_unit, group_digits
from ...say.commands_and_alarms import alarm_of, manual_steps, remedy_text
from ...say.layout import crc_inverted, crc_reflected, frame_bytes, is_reserved
from ...say.names_and_evidence import bits, conditions_text, deciding_value, heading
from ...say.register import covered_by_parity_bit
from ...say.text import MARKDOWN, VERDICT_CLAUSES, as_sentence, code_span, escape, join_filled, markdown_link, statement

Row = tuple[str, ...]
#: Verdicts as cells of the table.
EFFECTS = {
    Verdict.USABLE: "✓ usable",
    Verdict.USABLE_WITH_WARNING: "▲ usable with a warning",
    Verdict.NOT_USABLE: "✕ **not usable**",
    Verdict.UNKNOWN: "? unknown",
}
#: Largest number of flags that "or" joins.
_MOST_ALTERNATIVES = 3
_COLUMN_HEADINGS = ("Bit", "Flag", "Active at", "Position", "What to do")


def verdict_table(family_device: Device, device: Device, layout: Layout, variant: Variant) -> tuple[Row, list[Row]]:
    """Return the head and the rows of the table, without the columns that have no content.

    The rows are the causes of each verdict, then all other flags, then the verdict without any cause. ``device`` is the
    family reduced to the order codes of the page.
    """
    verdict_rules = verdict_rules_in_family(family_device, layout)
    causes_by_verdict: dict[Verdict, list[VerdictCause]] = {}
    if verdict_rules is not None:
        verdict_rules = verdict_rules.for_parameters(variant.parameters)
        causes_by_verdict = applicable_causes(verdict_rules, variant)
    placed_layout = layout.place(variant.parameters)
    rows = list(_cause_rows(device, placed_layout, causes_by_verdict))
    # A frame without a position has no verdict on which its flags could have an effect.
    effect_of_other_flags = "unchanged" if verdict_rules is not None else ""
    rows += _rows_of_other_flags(device, placed_layout, causes_by_verdict, effect_of_other_flags)
    if verdict_rules is not None and causes_by_verdict:
        crc_condition = "" if placed_layout.crc_field is None else ", and the CRC is correct"
        rows.append(("", f"none of these{crc_condition}", "", EFFECTS[verdict_rules.default_verdict], ""))
    columns_with_content = _indices_with_content(rows)
    headings = _cells_at(_COLUMN_HEADINGS, columns_with_content)
    return headings, [_cells_at(row, columns_with_content) for row in rows]


def _cells_at(row: Row, indexes: Iterable[int]) -> Row:
    """Return the cells of a row at these indexes."""
    return tuple(row[index] for index in indexes)


def _cause_rows(
    device: Device, placed_layout: PlacedLayout, causes_by_verdict: dict[Verdict, list[VerdictCause]]
) -> Iterator[Row]:
    """Yield a row for each cause of a verdict, the worst verdict first."""
    for verdict, causes in causes_by_verdict.items():
        for cause in causes:
            if isinstance(cause.cause, MatchingValues):
                yield _row_of_match(placed_layout, cause.cause, EFFECTS[verdict])
            else:
                field = cause.cause.field
                active_level = deciding_value(field) + _while_inactive(cause)
                yield _build_row(device, placed_layout, field, level=active_level, effect=EFFECTS[verdict])


def _indices_with_content(rows: Iterable[Row]) -> list[int]:
    """Return the indexes of the columns in which at least one row has content."""
    indexes: set[int] = set()
    for row in rows:
        indexes.update(index for index, cell in enumerate(row) if cell)
    return sorted(indexes)


def _rows_of_other_flags(
    device: Device,
    placed_layout: PlacedLayout,
    causes_by_verdict: dict[Verdict, list[VerdictCause]],
    effect: str,
) -> Iterator[Row]:
    """Yield a row with this effect for each flag that does not affect the verdict for this order code."""
    names_of_causes: set[str] = set()
    for causes in causes_by_verdict.values():
        names_of_causes.update(cause.cause.field.name for cause in causes)
    for placed_field in placed_layout.fields:
        field = placed_field.field
        is_flag = isinstance(meaning_of(field), ActiveFlag)
        if is_flag and field.name not in names_of_causes:
            yield _build_row(device, placed_layout, field, level=deciding_value(field), effect=effect)


def _build_row(device: Device, placed_layout: PlacedLayout, field: Field, *, level: str, effect: str) -> Row:
    """Return a row of place, name, active level, effect on the position, remedy for a field."""
    return (
        place_of_field(placed_layout.field(field.name), placed_layout),
        _names_of_field(field),
        level,
        effect,
        _remedy_cell(device, field),
    )


def _remedy_cell(device: Device, field: Field) -> str:
    """Return the remedy for a flag, with links to its manual procedures, as far as the hardware page describes them."""
    alarm = alarm_of(device, field)
    remedy = remedy_text(field, alarm)
    sentences = [escape(as_sentence(remedy) if remedy else "")]
    described_names = {characteristic.name for characteristic in device.characteristics}
    for name in manual_steps(field, alarm):
        if name in described_names:
            steps_link = markdown_link("Step by step", f"hardware.md#by-hand-{name}")
            sentences.append(f"{steps_link}.")
    return join_filled(sentences, " ")


def _names_of_field(field: Field) -> str:
    """Return the name of a field in words, its name in the manual if that differs, and its name in programs."""
    if is_reserved(field):
        return f"Reserved <small>{code_span(field.name)}</small>"
    name_in_words = heading(field.name)
    has_same_name_in_manual = field.printed_name.lower() in {"", name_in_words.lower()}
    printed_name = "" if has_same_name_in_manual else f"{escape(field.printed_name)} "
    return f"{escape(name_in_words)} <small>{printed_name}{code_span(field.name)}</small>"


def _row_of_match(placed_layout: PlacedLayout, matching_values: MatchingValues, effect: str) -> Row:
    """Return the row for field values that decide together: places, values, no level, verdict, no remedy."""
    place_texts = []
    for decoded_field, _ in matching_values.conditions:
        placed_field = placed_layout.field(decoded_field.field.name)
        place_texts.append(place_of_field(placed_field, placed_layout))
    return ", ".join(place_texts), _conditions_phrase(matching_values), "", effect, ""


def _conditions_phrase(matching_values: MatchingValues) -> str:
    """Return the field values that decide together: ``error is 1 and mode is 5h (test)``."""
    fields_and_values = [(decoded_field.field, value) for decoded_field, value in matching_values.conditions]
    return MARKDOWN.phrase(conditions_text(fields_and_values))


def place_of_field(placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return the bits of a field, such as ``bit 7``, with their byte if the frame consists of bytes."""
    highest_bit, lowest_bit = placed_field.highest_bit, placed_field.lowest_bit
    if placed_layout.layout.in_bytes:
        return frame_bytes(placed_layout.layout, placed_layout.bits, highest_bit, lowest_bit)
    return bits(highest_bit, lowest_bit)


def _while_inactive(cause: VerdictCause) -> str:
    """Return the condition on the flags that a cause combines: ``, while `error` is inactive``, or "" without one."""
    if not cause.overriding_flags:
        return ""
    return f", {_while_flags_are_inactive(cause)}"


def _while_flags_are_inactive(cause: VerdictCause) -> str:
    """Return the flags that must be inactive for a cause to count: ``while `error` and `fault` are inactive``."""
    flag_names = " and ".join(code_span(decoded_flag.field.name) for decoded_flag in cause.overriding_flags)
    verb = "is" if len(cause.overriding_flags) == 1 else "are"
    return f"while {flag_names} {verb} inactive"


def applicable_causes(verdict_rules: VerdictRules, variant: Variant) -> dict[Verdict, list[VerdictCause]]:
    """Return the causes of each verdict that apply to an order code, the worst verdict first. Others are omitted."""
    causes_by_verdict: dict[Verdict, list[VerdictCause]] = {}
    for verdict, causes in verdict_rules.worst_first:
        causes_for_variant = [cause for cause in causes if _holds_for_variant(cause, variant)]
        if causes_for_variant:
            causes_by_verdict[verdict] = causes_for_variant
    return causes_by_verdict


def _holds_for_variant(cause: VerdictCause, variant: Variant) -> bool:
    """Return whether all conditions of a cause hold for an order code and the answers chosen for it."""
    return all(condition.contains(variant.parameters) for condition in cause.conditions)


def join_as_any_of(names: Sequence[str]) -> str:
    """Return up to three names as ``a or b``, and more as ``any of a, b, c, d``."""
    return f"any of {', '.join(names)}" if len(names) > _MOST_ALTERNATIVES else " or ".join(names)


def verdict_line(verdict_rules: VerdictRules, variant: Variant, has_crc: bool) -> str:
    """Return the verdicts on the position with conditions, the worst first: ``not usable if …; otherwise usable``."""
    verdict_rules = verdict_rules.for_parameters(variant.parameters)
    causes_by_verdict = applicable_causes(verdict_rules, variant)
    conditional_verdicts = [_verdict_if(verdict, causes) for verdict, causes in causes_by_verdict.items()]
    if not conditional_verdicts:
        return MARKDOWN.phrase(statement(VERDICT_CLAUSES[verdict_rules.default_verdict]))
    if_crc_is_correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*conditional_verdicts, f"otherwise{if_crc_is_correct} {EFFECTS[verdict_rules.default_verdict]}"])


def changed_verdicts_of(verdict_rules: VerdictRules, variant: Variant, variant_with_answer: Variant) -> list[str]:
    """Return the verdicts that get further causes from an answer to an open question, each with these causes.

    ``variant`` has the default answers, and ``variant_with_answer`` the other answer.
    """
    default_causes = applicable_causes(verdict_rules, variant)
    changed_verdicts = []
    for verdict, causes in applicable_causes(verdict_rules, variant_with_answer).items():
        default_conditions = [cause.cause for cause in default_causes.get(verdict, ())]
        added_causes = [cause for cause in causes if cause.cause not in default_conditions]
        if added_causes:
            changed_verdicts.append(_verdict_if(verdict, added_causes))
    return changed_verdicts


def _verdict_if(verdict: Verdict, causes: Sequence[VerdictCause]) -> str:
    """Return a verdict with its causes as conditions: ``not usable if error is 1, or if mode is 5h (test)``."""
    return f"{EFFECTS[verdict]} if {', or if '.join(_cause_texts(causes))}"


def _cause_texts(causes: Sequence[VerdictCause]) -> Iterator[str]:
    """Yield the conditions of a verdict. Flags with the same active level share one: ``error or fault is 1``."""
    names_by_active_level: dict[str, list[str]] = {}
    for cause in causes:
        if not isinstance(cause.cause, MatchingValues):
            # The level at which the flag is active, such as "1".
            active_level = deciding_value(cause.cause.field)
            names_by_active_level.setdefault(active_level, []).append(_cause_text(cause))
    yield from (f"{join_as_any_of(names)} is {active_level}" for active_level, names in names_by_active_level.items())
    for cause in causes:
        if isinstance(cause.cause, MatchingValues):
            yield _conditions_phrase(cause.cause)


def _cause_text(cause: VerdictCause) -> str:
    """Return the flag of a cause, followed by the combined flags that must be inactive, if it has any."""
    flag_name = code_span(cause.cause.field.name)
    if not cause.overriding_flags:
        return flag_name
    return f"{flag_name} ({_while_flags_are_inactive(cause)})"


_SUPERSCRIPT_DIGITS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


_EXPONENT_IN_TEXT = re.compile(r"\^([0-9]*)")


def position_frame(family_device: Device, interface: Interface) -> Layout | None:
    """Return the frame that contains the most parts of the position, or None if no frame contains any.

    Of several such frames, it is the one with the most flags, then the shortest one.
    """
    names_of_position_frames: set[str] = set()
    # Only for the layouts of the family is it known whether they contain the position.
    for family_layout in family_device.interface(interface.name).layouts:
        if family_device.sends_position(interface.name, family_layout):
            names_of_position_frames.add(family_layout.name)
    position_frames = [layout for layout in interface.layouts if layout.name in names_of_position_frames]
    parts_of_position = family_device.position_names(interface.name)

    def amount_of_information(layout: Layout) -> tuple[int, int, int]:
        field_names = {field.name for field in layout.fields}
        part_count = len(parts_of_position & field_names)
        flag_count = sum(isinstance(meaning_of(field), ActiveFlag) for field in layout.fields)
        return part_count, flag_count, -layout.widest

    return max(position_frames, key=amount_of_information, default=None)


def open_questions(device: Device, layout: Layout) -> Iterator[str]:
    """Yield a sentence, with a link, for each open question whose answer is needed to read a frame."""
    for alternative in device.alternatives_of(layout):
        question = markdown_link("open question", f"#alternative-{alternative.name}")
        answers = " and ".join(code_span(answer.name) for answer in alternative.answers)
        yield f"This frame depends on an {question} with the answers {answers}."


def frame_facts(
    family_device: Device, layout: Layout, variant: Variant, *, question_names: Sequence[str] = ()
) -> Iterator[tuple[str, str]]:
    """Yield the facts about a frame as label and text: CRC or parity bits, flags, ranges of signed fields, verdict.

    ``question_names`` are the names of the open questions on the page, which the verdicts link to.
    """
    # The layout of a page is a copy with different notes. The family finds ranges only for its own layout objects.
    family_layout = member_named(family_device.interface(variant.interface).layouts, layout.name, "layout")
    placed_layout = family_layout.place(variant.parameters)
    crc = family_device.crc_of(placed_layout)
    yield "CRC", "none" if crc is None else crc_line(family_device, crc, placed_layout)
    if crc is None:
        yield from _parity_facts(placed_layout)
    yield from _flag_facts(placed_layout)
    for placed_field in placed_layout.fields:
        if isinstance(meaning_of(placed_field.field), TwosComplement):
            yield "Signed", _range_of_signed_number(family_device, placed_field, placed_layout)
    verdict_rules = verdict_rules_in_family(family_device, family_layout)
    if verdict_rules is not None:
        yield "Position", verdict_line(verdict_rules, variant, has_crc=crc is not None)
        verdict_questions = family_device.verdict_alternatives(family_layout)
        questions_on_page = [question for question in verdict_questions if question.name in question_names]
        yield from _verdict_changes(family_device, verdict_rules, variant, questions_on_page)


def _parity_facts(placed_layout: PlacedLayout) -> Iterator[tuple[str, str]]:
    """Yield a fact for each parity bit: its place and the fields that it covers."""
    for placed_field in placed_layout.fields:
        covered_fields = covered_by_parity_bit(placed_field.field)
        if covered_fields is not None:
            name, place = code_span(placed_field.name), place_of_field(placed_field, placed_layout)
            yield "Parity", f"{name} ({place}). {MARKDOWN.phrase(covered_fields)}"


def _flag_facts(placed_layout: PlacedLayout) -> Iterator[tuple[str, str]]:
    """Yield the flags by active level, such as ``("Active at 1", "`error` (bit 3)")``, and the unused bits.

    Unused bits are listed only if they are single bits with a name in the manual, in a frame that does not consist of
    bytes.
    """
    layout = placed_layout.layout
    flags_by_label: dict[str, list[tuple[str, str]]] = {}
    for placed_field in placed_layout.fields:
        field = placed_field.field
        name_and_place = (code_span(field.name), place_of_field(placed_field, placed_layout))
        # The active level of a flag, or what differs from the manual: ``0`` or ``1`` for a single unused bit.
        deciding_value_text = deciding_value(field)
        is_unused_bit = bool(field.printed_name) and deciding_value_text in {"0", "1"}
        if isinstance(meaning_of(field), ActiveFlag):
            flags_by_label.setdefault(f"Active at {deciding_value_text}", []).append(name_and_place)
        elif is_unused_bit and not layout.in_bytes:
            flags_by_label.setdefault("Not used by this encoder", []).append(name_and_place)
    for label, names_and_places in flags_by_label.items():
        yield label, ", ".join(_flags_with_places(names_and_places))


def _verdict_changes(
    family_device: Device, verdict_rules: VerdictRules, variant: Variant, questions: Iterable[Alternative]
) -> Iterator[tuple[str, str]]:
    """Yield each answer to an open question that adds causes to verdicts, with these verdicts and causes."""
    for question in questions:
        # The first answer is the default.
        for answer in question.answers[1:]:
            variant_with_answer = with_answers(family_device, variant, {question.name: answer.name})
            changed_verdicts = changed_verdicts_of(verdict_rules, variant, variant_with_answer)
            if changed_verdicts:
                answer_link = markdown_link(f"With {code_span(answer.name)}", f"#alternative-{question.name}")
                yield answer_link, "; ".join(changed_verdicts)


def _range_of_signed_number(family_device: Device, placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return a signed field and its range, such as ``position, in two's complement, -512 to 511``."""
    lowest, highest = family_device.signed_range(placed_field, placed_layout)
    return f"{code_span(placed_field.name)}, in two's complement, {group_digits(lowest)} to {group_digits(highest)}"


def _flags_with_places(names_and_places: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield flags with their places: ``error (byte 1, bit 0)``, then ``warning (bit 1)`` in the same byte."""
    previous_byte = ""
    for flag_name, place in names_and_places:
        # The byte is empty for a frame of bits, whose places look like ``bit 7``.
        byte, _, bit = place.rpartition(", ")
        short_place = bit if byte == previous_byte else place
        yield f"{flag_name} ({short_place})"
        previous_byte = byte


def crc_line(family_device: Device, crc: Crc, placed_layout: PlacedLayout) -> str:
    """Return the parameters of the CRC of a frame in one line. The polynomial includes its top bit."""
    polynomial = _EXPONENT_IN_TEXT.sub(_in_superscript, crc.polynomial)
    crc_properties = [
        f"poly `0x{crc.poly_with_top_bit:X}` ({escape(polynomial)})",
        f"init {crc.init:#x}" if crc.init else "init 0",
        crc_reflected(family_device, crc),
        crc_inverted(crc),
        count_with_unit(crc.width, "bit"),
        _covered_by_crc(placed_layout),
    ]
    xor_sentence = ". It equals the XOR of these bytes" if crc.is_xor else ""
    return ", ".join(filter(None, crc_properties)) + xor_sentence


def _covered_by_crc(placed_layout: PlacedLayout) -> str:
    """Return what the CRC of a frame covers, such as ``over bits 47:16, `read` to `position```."""
    if not placed_layout.covers_part:
        return "over everything before it"
    lowest_bit, bit_count = placed_layout.covered_lowest_bit_and_width
    covered_bits = range(lowest_bit, lowest_bit + bit_count)
    covered_names = [code_span(field.name) for field in placed_layout.fields if field.lowest_bit in covered_bits]
    return f"over bits {covered_bits[-1]}:{lowest_bit}, {covered_names[0]} to {covered_names[-1]}"


def _in_superscript(exponent: re.Match[str]) -> str:
    """Return an exponent such as ``^6`` in superscript digits."""
    return exponent[1].translate(_SUPERSCRIPT_DIGITS)
