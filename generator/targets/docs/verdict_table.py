"""Verdicts on the page of an order code: a table of the deciding bits, and a line with the conditions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ...model import Device, Field, Layout, PlacedField, PlacedLayout, Variant, Verdict
from ...plan.values import ActiveFlag, meaning_of
from ...plan.verdicts import MatchingValues, VerdictCause, VerdictRules, verdict_rules_in_family
from ...say.layout import is_reserved
from ...say.markdown import MARKDOWN, code_span, escape, join_filled, markdown_link
from ...say.names_and_places import bits, frame_bytes, heading
from ...say.report import alarm_of, conditions_text, deciding_value, manual_steps, remedy_text
from ...say.text import VERDICT_CLAUSES, as_sentence, statement

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
    placed = layout.place(variant.parameters)
    rows = list(_cause_rows(device, placed, causes_by_verdict))
    rows += _rows_of_other_flags(device, placed, causes_by_verdict, verdict_rules)
    if verdict_rules is not None and causes_by_verdict:
        with_crc = "" if placed.crc_field is None else ", and the CRC is correct"
        rows.append(("", f"none of these{with_crc}", "", EFFECTS[verdict_rules.otherwise], ""))
    columns_with_content = _indices_with_content(rows)
    return _cells_at(_COLUMN_HEADINGS, columns_with_content), [_cells_at(row, columns_with_content) for row in rows]


def _cells_at(row: Row, indexes: Iterable[int]) -> Row:
    """Return the cells of a row at these indexes."""
    return tuple(row[index] for index in indexes)


def _cause_rows(
    device: Device, placed_layout: PlacedLayout, causes_by_verdict: dict[Verdict, list[VerdictCause]]
) -> Iterator[Row]:
    """Yield a row for each cause of a verdict, the worst verdict first."""
    for verdict, causes in causes_by_verdict.items():
        for cause in causes:
            if isinstance(cause.by, MatchingValues):
                yield _row_of_match(placed_layout, cause.by, EFFECTS[verdict])
            else:
                field = cause.by.field
                active_level = deciding_value(field) + _while_inactive(cause)
                yield _build_row(device, placed_layout, field, active_level, EFFECTS[verdict])


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
    verdict_rules: VerdictRules | None,
) -> Iterator[Row]:
    """Yield a row for each flag that does not affect the verdict for this order code.

    Its effect is ``unchanged``, or empty for a frame without a position, which has no verdict.
    """
    names_of_causes: set[str] = set()
    for causes in causes_by_verdict.values():
        names_of_causes.update(cause.by.field.name for cause in causes)
    effect = "unchanged" if verdict_rules is not None else ""
    for placed_field in placed_layout.fields:
        field = placed_field.field
        if isinstance(meaning_of(field), ActiveFlag) and field.name not in names_of_causes:
            yield _build_row(device, placed_layout, field, deciding_value(field), effect)


def _build_row(device: Device, placed_layout: PlacedLayout, field: Field, level: str, effect: str) -> Row:
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
    words = heading(field.name)
    has_same_name_in_manual = field.printed_name.lower() in {"", words.lower()}
    printed_name = "" if has_same_name_in_manual else f"{escape(field.printed_name)} "
    return f"{escape(words)} <small>{printed_name}{code_span(field.name)}</small>"


def _row_of_match(placed_layout: PlacedLayout, match: MatchingValues, effect: str) -> Row:
    """Return the row for field values that decide together: places, values, no level, verdict, no remedy."""
    placed_fields = [placed_layout.field(part.field.name) for part, _ in match.conditions]
    places = ", ".join(place_of_field(placed_field, placed_layout) for placed_field in placed_fields)
    phrase = MARKDOWN.phrase(conditions_text((part.field, value) for part, value in match.conditions))
    return places, phrase, "", effect, ""


def place_of_field(placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return the bits of a field, such as ``bit 7``, with their byte if the frame consists of bytes."""
    high, low = placed_field.high, placed_field.low
    if placed_layout.layout.in_bytes:
        return frame_bytes(placed_layout.layout, placed_layout.bits, high, low)
    return bits(high, low)


def _while_inactive(cause: VerdictCause) -> str:
    """Return the condition on the flags that a cause combines: ``, while `error` is inactive``, or "" without one."""
    if not cause.unless:
        return ""
    return f", {_while_flags_are_inactive(cause)}"


def _while_flags_are_inactive(cause: VerdictCause) -> str:
    """Return the flags that must be inactive for a cause to count: ``while `error` and `fault` are inactive``."""
    flags = " and ".join(code_span(part.field.name) for part in cause.unless)
    verb = "is" if len(cause.unless) == 1 else "are"
    return f"while {flags} {verb} inactive"


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
        return MARKDOWN.phrase(statement(VERDICT_CLAUSES[verdict_rules.otherwise]))
    if_crc_is_correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*conditional_verdicts, f"otherwise{if_crc_is_correct} {EFFECTS[verdict_rules.otherwise]}"])


def changed_verdicts_of(verdict_rules: VerdictRules, variant: Variant, variant_with_answer: Variant) -> list[str]:
    """Return the verdicts that get further causes from an answer to an open question, each with these causes.

    ``variant`` has the default answers, and ``variant_with_answer`` the other answer.
    """
    default_causes = applicable_causes(verdict_rules, variant)
    changed_verdicts = []
    for verdict, causes in applicable_causes(verdict_rules, variant_with_answer).items():
        default_conditions = [cause.by for cause in default_causes.get(verdict, ())]
        added_causes = [cause for cause in causes if cause.by not in default_conditions]
        if added_causes:
            changed_verdicts.append(_verdict_if(verdict, added_causes))
    return changed_verdicts


def _verdict_if(verdict: Verdict, causes: Sequence[VerdictCause]) -> str:
    """Return a verdict with its causes as conditions: ``not usable if error is 1, or if mode is 5h (test)``."""
    return f"{EFFECTS[verdict]} if {', or if '.join(_cause_texts(causes))}"


def _cause_texts(causes: Sequence[VerdictCause]) -> Iterator[str]:
    """Yield the conditions of a verdict. Flags with the same active level share one: ``error or fault is 1``."""
    names_by_level: dict[str, list[str]] = {}
    for cause in causes:
        if not isinstance(cause.by, MatchingValues):
            # deciding_value() returns the level at which the flag is active, such as "1".
            names_by_level.setdefault(deciding_value(cause.by.field), []).append(_cause_text(cause))
    yield from (f"{join_as_any_of(names)} is {level}" for level, names in names_by_level.items())
    for cause in causes:
        if isinstance(cause.by, MatchingValues):
            yield MARKDOWN.phrase(conditions_text((part.field, value) for part, value in cause.by.conditions))


def _cause_text(cause: VerdictCause) -> str:
    """Return the flag of a cause, followed by the combined flags that must be inactive, if it has any."""
    flag_name = code_span(cause.by.field.name)
    if not cause.unless:
        return flag_name
    return f"{flag_name} ({_while_flags_are_inactive(cause)})"
