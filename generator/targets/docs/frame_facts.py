"""Facts about the position frame on the page of an order code: fields, CRC and verdict."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...model import (
    Crc,
    Device,
    Interface,
    Layout,
    PlacedField,
    PlacedLayout,
    Variant,
    Verdict,
)
from ...order_codes.parameters import with_answers
from ...plan.values import Active, TwosComplement, meaning_of
from ...plan.verdicts import Judgement, Match, VerdictCause, reportings
from ...say.layout import crc_inverted, crc_reflected
from ...say.markdown import STYLE, code, link, text
from ...say.names_and_places import bits, frame_bytes
from ...say.numbers import number
from ...say.report import conditions, deciding
from ...say.text import WORTH, counted, statement

_SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_EXPONENT = re.compile(r"\^([0-9]*)")


def position_frame(family: Device, interface: Interface) -> Layout | None:
    """Return the frame that says most about the position: its parts, then its flags. With a tie, the shortest."""
    family_layouts = family.interface(interface.name).layouts
    names = {layout.name for layout in family_layouts if family.tells_position(interface.name, layout)}
    position_names = family.position_names(interface.name)

    def information(layout: Layout) -> tuple[int, int, int]:
        flags = sum(isinstance(meaning_of(field), Active) for field in layout.fields)
        return len(position_names & {field.name for field in layout.fields}), flags, -layout.widest

    return max((layout for layout in interface.layouts if layout.name in names), key=information, default=None)


def open_questions(device: Device, layout: Layout) -> Iterator[str]:
    """Yield a sentence for each question about a frame that the manual leaves open, with a link to it."""
    for alternative in device.alternatives_of(layout):
        question = link("open question", f"#alternative-{alternative.name}")
        answers = " and ".join(code(answer.name) for answer in alternative.answers)
        yield f"This frame depends on an {question} with the answers {answers}."


def frame_facts(
    family: Device, layout: Layout, variant: Variant, choices: Sequence[str] = ()
) -> Iterator[tuple[str, str]]:
    """Yield the CRC, the polarity of the flags and the verdict on the position, each in one line.

    ``choices`` are the names of the alternatives on the page, to which the verdicts link.
    """
    crc = family.crc_of(layout)
    yield "CRC", "none" if crc is None else crc_line(family, crc)
    # The layout of a page has other notes, and the range of a position is known for that of the family.
    family_layouts = family.interface(variant.interface).layouts
    family_layout = next(candidate for candidate in family_layouts if candidate.name == layout.name)
    placed_layout = family_layout.place(variant.parameters)
    yield from _flag_facts(placed_layout)
    for placed_field in placed_layout.fields:
        if isinstance(meaning_of(placed_field.field), TwosComplement):
            yield "Signed", _range_of_signed_number(family, placed_field, placed_layout)
    yield from _verdict_facts(family, family_layout, variant, choices, has_crc=crc is not None)


def _flag_facts(placed_layout: PlacedLayout) -> Iterator[tuple[str, str]]:
    """Yield the flags by the level at which they are active, and those that the encoder does not use."""
    layout = placed_layout.layout
    flags_by_label: dict[str, list[tuple[str, str]]] = {}
    for placed_field in placed_layout.fields:
        byte = frame_bytes(layout, placed_layout.bits, placed_field.high, placed_field.low) if layout.in_bytes else ""
        flag = (code(placed_field.name), byte or bits(placed_field.high, placed_field.low))
        level = deciding(placed_field.field)
        if isinstance(meaning_of(placed_field.field), Active):
            flags_by_label.setdefault(f"Active at {level}", []).append(flag)
        elif not byte and placed_field.field.printed_name and level in {"0", "1"}:
            flags_by_label.setdefault("Not used by this encoder", []).append(flag)
    yield from ((label, ", ".join(_with_places(flags))) for label, flags in flags_by_label.items())


def _verdict_facts(
    family: Device, layout: Layout, variant: Variant, choices: Sequence[str], has_crc: bool
) -> Iterator[tuple[str, str]]:
    """Yield the verdict on the position, and the verdicts that other answers than the defaults change."""
    judgements = (reporting.judgement for reporting in reportings(family) if reporting.codec.layout.name == layout.name)
    judgement = next(judgements, None)
    if judgement is None:
        return
    yield "Position", verdict_line(judgement, variant, has_crc)
    alternatives = [alternative for alternative in family.verdict_alternatives(layout) if alternative.name in choices]
    for alternative in alternatives:
        for answer in alternative.answers[1:]:
            variant_with_answer = with_answers(family, variant, {alternative.name: answer.name})
            changed_verdicts = _changed_verdicts(judgement, variant, variant_with_answer)
            if changed_verdicts:
                with_answer = link(f"With {code(answer.name)}", f"#alternative-{alternative.name}")
                yield with_answer, "; ".join(changed_verdicts)


def _range_of_signed_number(family: Device, placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return the notation and range of a signed number."""
    lowest, highest = family.signed_range(placed_field, placed_layout)
    return f"{code(placed_field.name)}, in two's complement, {number(lowest)} to {number(highest)}"


def _with_places(flags: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield flags with their places. A byte is named only where it changes."""
    previous_byte = ""
    for name, place in flags:
        byte, _, bit = place.rpartition(", ")
        yield f"{name} ({bit if byte == previous_byte else place})"
        previous_byte = byte


def crc_line(family: Device, crc: Crc) -> str:
    """Return the parameters of a CRC in one line, with the polynomial including its top bit."""
    polynomial = _EXPONENT.sub(_in_superscript, crc.polynomial)
    parts = [
        f"poly `0x{crc.poly_with_top_bit:X}` ({text(polynomial)})",
        f"init {crc.init:#x}" if crc.init else "init 0",
        crc_reflected(family, crc),
        crc_inverted(crc),
        counted(crc.width, "bit"),
        "over everything before it",
        "which is the XOR of these bytes" if crc.is_xor else "",
    ]
    return ", ".join(filter(None, parts))


def _in_superscript(exponent: re.Match[str]) -> str:
    return exponent[1].translate(_SUPERSCRIPT)


def verdict_line(judgement: Judgement, variant: Variant, has_crc: bool) -> str:
    """Return the rule for the verdict on the position of an order code."""
    causes_by_verdict = _applicable_causes(judgement, variant)
    parts = [_verdict_if(verdict, causes) for verdict, causes in causes_by_verdict.items()]
    if not parts:
        return STYLE.phrase(statement(WORTH[judgement.otherwise]))
    correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*parts, f"otherwise{correct} {_VERDICT_TEXTS[judgement.otherwise]}"])


def _applicable_causes(judgement: Judgement, variant: Variant) -> dict[Verdict, list[VerdictCause]]:
    """Return the causes of each verdict that apply to an order code, the worst verdict first."""
    causes_by_verdict: dict[Verdict, list[VerdictCause]] = {}
    for verdict, causes in judgement.worst_first:
        applicable_causes = [cause for cause in causes if _applies(cause, variant)]
        if applicable_causes:
            causes_by_verdict[verdict] = applicable_causes
    return causes_by_verdict


def _changed_verdicts(judgement: Judgement, variant: Variant, variant_with_answer: Variant) -> list[str]:
    """Return the verdicts to which an answer adds causes that ``variant``, with the defaults, lacks."""
    default_causes = _applicable_causes(judgement, variant)
    changed_verdicts = []
    for verdict, causes in _applicable_causes(judgement, variant_with_answer).items():
        default_fields = [cause.by for cause in default_causes.get(verdict, ())]
        added_causes = [cause for cause in causes if cause.by not in default_fields]
        if added_causes:
            changed_verdicts.append(_verdict_if(verdict, added_causes))
    return changed_verdicts


def _verdict_if(verdict: Verdict, causes: Sequence[VerdictCause]) -> str:
    return f"{_VERDICT_TEXTS[verdict]} if {', or if '.join(_cause_texts(causes))}"


def _cause_texts(causes: Sequence[VerdictCause]) -> Iterator[str]:
    """Yield the conditions of a verdict. Flags with the same active level are one condition."""
    names_by_level: dict[str, list[str]] = {}
    for cause in causes:
        if not isinstance(cause.by, Match):
            names_by_level.setdefault(deciding(cause.by.field), []).append(_cause_text(cause))
    yield from (f"{' or '.join(names)} is {level}" for level, names in names_by_level.items())
    for cause in causes:
        if isinstance(cause.by, Match):
            yield STYLE.phrase(conditions((part.field, value) for part, value in cause.by.conditions))


_VERDICT_TEXTS = {
    Verdict.USABLE: "✓ usable",
    Verdict.USABLE_WITH_WARNING: "▲ usable with a warning",
    Verdict.NOT_USABLE: "✕ **not usable**",
    Verdict.UNKNOWN: "? unknown",
}


def _cause_text(cause: VerdictCause) -> str:
    name = code(cause.by.field.name)
    if not cause.unless:
        return name
    flags = " and ".join(code(part.field.name) for part in cause.unless)
    return f"{name} (while {flags} {'is' if len(cause.unless) == 1 else 'are'} inactive)"


def _applies(cause: VerdictCause, variant: Variant) -> bool:
    """Return whether all conditions of a cause hold for an order code and the answers chosen for it."""
    return all(bool(variant.parameters.get(only.parameter, 0)) == only.holds for only in cause.conditions)
