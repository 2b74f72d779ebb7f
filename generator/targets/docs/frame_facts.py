"""Facts about the position frame on the page of an order code: fields, CRC and verdict."""

from __future__ import annotations

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
from ...order_codes.run_time import with_answers
from ...plan.reports import reportings
from ...plan.values import Active, TwosComplement, meaning_of
from ...plan.verdicts import Judgement, Match, Only, VerdictCause
from ...say.crc import inverted, reflected
from ...say.markdown import STYLE, code, link, text
from ...say.numbers import number
from ...say.place import bits, frame_bytes
from ...say.report import conditions, deciding
from ...say.text import statement
from ...say.words import WORTH, counted

_SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def position_frame(family: Device, interface: Interface) -> Layout | None:
    """Return the frame that says most about the position: its parts, then its flags. With a tie, the shortest."""
    position_layouts = {
        layout.name
        for layout in family.interface(interface.name).layouts
        if family.tells_position(interface.name, layout)
    }
    position_names = family.position_names(interface.name)

    def worth(layout: Layout) -> tuple[int, int, int]:
        flags = sum(isinstance(meaning_of(field), Active) for field in layout.fields)
        return len(position_names & {field.name for field in layout.fields}), flags, -layout.widest

    return max((layout for layout in interface.layouts if layout.name in position_layouts), key=worth, default=None)


def questions(device: Device, layout: Layout) -> Iterator[str]:
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
    checked = family.crc_of(layout)
    yield "CRC", crc_line(family, checked) if checked is not None else "none"
    by_level: dict[str, list[tuple[str, str]]] = {}
    # The layout of a page has other notes, and the range of a position is known for that of the family.
    layout = next(frame for frame in family.interface(variant.interface).layouts if frame.name == layout.name)
    placed = layout.place(variant.parameters)
    for placed_field in placed.fields:
        of_byte = frame_bytes(layout, placed.bits, placed_field.high, placed_field.low) if layout.in_bytes else ""
        at = (code(placed_field.name), of_byte or bits(placed_field.high, placed_field.low))
        if isinstance(meaning_of(placed_field.field), Active):
            by_level.setdefault(f"Active at {deciding(placed_field.field)}", []).append(at)
        elif not of_byte and placed_field.field.printed_name and deciding(placed_field.field) in {"0", "1"}:
            by_level.setdefault("Not used by this encoder", []).append(at)
    yield from ((label, ", ".join(_with_places(names))) for label, names in by_level.items())
    signed = [
        placed_field for placed_field in placed.fields if isinstance(meaning_of(placed_field.field), TwosComplement)
    ]
    yield from (("Signed", _signed(family, placed_field, placed)) for placed_field in signed)
    judgement = next(
        (reporting.judgement for reporting in reportings(family) if reporting.codec.layout.name == layout.name), None
    )
    if judgement is not None:
        line = verdict_line(judgement, variant, checked is not None)
        yield "Position", line
        alternatives = family.verdict_alternatives(layout)
        for alternative in (alternative for alternative in alternatives if alternative.name in choices):
            for answer in alternative.answers[1:]:
                chosen = with_answers(family, variant, {alternative.name: answer.name})
                changed_verdicts = _changed_verdicts(judgement, variant, chosen)
                if changed_verdicts:
                    with_answer = link(f"With {code(answer.name)}", f"#alternative-{alternative.name}")
                    yield with_answer, "; ".join(changed_verdicts)


def _signed(family: Device, placed_field: PlacedField, placed: PlacedLayout) -> str:
    """Return the notation and range of a signed number."""
    lowest, highest = family.signed_range(placed_field, placed)
    return f"{code(placed_field.name)}, in two's complement, {number(lowest)} to {number(highest)}"


def _with_places(flags: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield flags with their places. A byte is named only where it changes."""
    last = ""
    for name, place in flags:
        byte, _, bit = place.rpartition(", ")
        yield f"{name} ({bit if byte == last else place})"
        last = byte


def crc_line(family: Device, crc: Crc) -> str:
    """Return the parameters of a CRC in one line, with the polynomial including its top bit."""
    powers = crc.polynomial.split("^")
    polynomial = powers[0] + "".join(
        part[: (end := len(part) - len(part.lstrip("0123456789")))].translate(_SUPERSCRIPT) + part[end:]
        for part in powers[1:]
    )
    parts = [
        f"poly `0x{crc.poly_with_top_bit:X}` ({text(polynomial)})",
        f"init {crc.init:#x}" if crc.init else "init 0",
        reflected(family, crc),
        inverted(crc),
        counted(crc.width, "bit"),
        "over everything before it",
        "which is the XOR of these bytes" if crc.is_xor else "",
    ]
    return ", ".join(filter(None, parts))


def verdict_line(judgement: Judgement, variant: Variant, has_crc: bool) -> str:
    """Return the rule for the verdict on the position of an order code."""
    applying = _applying_causes(judgement, variant)
    parts = [f"{_VERDICT[verdict]} if {', or if '.join(_causes(causes))}" for verdict, causes in applying.items()]
    if not parts:
        return STYLE.phrase(statement(WORTH[judgement.otherwise]))
    correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*parts, f"otherwise{correct} {_VERDICT[judgement.otherwise]}"])


def _applying_causes(judgement: Judgement, variant: Variant) -> dict[Verdict, list[VerdictCause]]:
    """Return the causes of each verdict that apply to an order code, the worst verdict first."""
    applying: dict[Verdict, list[VerdictCause]] = {}
    for verdict, causes in judgement.worst_first:
        applying[verdict] = [cause for cause in causes if all(_applies(only, variant) for only in cause.conditions)]
    return {verdict: causes for verdict, causes in applying.items() if causes}


def _changed_verdicts(judgement: Judgement, variant: Variant, chosen: Variant) -> list[str]:
    """Return the verdicts that have a cause for ``chosen``, an order code with an answer, that ``variant`` lacks."""
    usual = _applying_causes(judgement, variant)
    changes = []
    for verdict, causes in _applying_causes(judgement, chosen).items():
        usual_fields = [cause.by for cause in usual.get(verdict, ())]
        added = [cause for cause in causes if cause.by not in usual_fields]
        if added:
            changes.append(f"{_VERDICT[verdict]} if {', or if '.join(_causes(added))}")
    return changes


def _causes(causes: Sequence[VerdictCause]) -> Iterator[str]:
    """Yield the conditions of a verdict. Flags with the same active level are one condition."""
    by_value: dict[str, list[str]] = {}
    for cause in causes:
        if not isinstance(cause.by, Match):
            by_value.setdefault(deciding(cause.by.field), []).append(_cause(cause))
    yield from (f"{' or '.join(names)} is {value}" for value, names in by_value.items())
    for cause in causes:
        if isinstance(cause.by, Match):
            yield STYLE.phrase(conditions((part.field, value) for part, value in cause.by.conditions))


_VERDICT = {
    Verdict.USABLE: "✓ usable",
    Verdict.USABLE_WITH_WARNING: "▲ usable with a warning",
    Verdict.NOT_USABLE: "✕ **not usable**",
    Verdict.UNKNOWN: "? unknown",
}


def _cause(cause: VerdictCause) -> str:
    unless = " and ".join(code(part.field.name) for part in cause.unless)
    return code(cause.by.field.name) + (
        f" (while {unless} {'is' if len(cause.unless) == 1 else 'are'} inactive)" if unless else ""
    )


def _applies(only: Only, variant: Variant) -> bool:
    return bool(variant.parameters.get(only.parameter, 0)) == only.holds
