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
from ...plan.verdicts import Judgement, Match, Only, Speaks
from ...say.crc import inverted, reflected
from ...say.markdown import STYLE, code, link, text
from ...say.numbers import number
from ...say.place import bits, frame_bytes
from ...say.report import conditions, deciding
from ...say.text import said
from ...say.words import WORTH, counted

_SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def position_frame(family: Device, here: Interface) -> Layout | None:
    """Return the frame that says most about the position: its parts, then its flags. With a tie, the shortest."""
    telling = {item.name for item in family.interface(here.name).layouts if family.tells_position(here.name, item)}
    of = family.position_names(here.name)

    def worth(item: Layout) -> tuple[int, int, int]:
        flags = sum(isinstance(meaning_of(field), Active) for field in item.fields)
        return len(of & {field.name for field in item.fields}), flags, -item.widest

    return max((item for item in here.layouts if item.name in telling), key=worth, default=None)


def questions(device: Device, layout: Layout) -> Iterator[str]:
    """Yield a sentence for each question about a frame that the manual leaves open, with a link to it."""
    for item in device.alternatives_of(layout):
        asked = link("open question", f"#alternative-{item.name}")
        answers = " and ".join(code(answer.name) for answer in item.answers)
        yield f"This frame depends on an {asked} with the answers {answers}."


def frame_facts(family: Device, layout: Layout, variant: Variant) -> Iterator[tuple[str, str]]:
    """Yield the CRC, the polarity of the flags and the verdict on the position, each in one line."""
    checked = family.crc_of(layout)
    yield "CRC", crc_line(family, checked) if checked is not None else "none"
    by_level: dict[str, list[tuple[str, str]]] = {}
    # The layout of a page has other notes, and the range of a position is known for that of the family.
    layout = next(item for item in family.interface(variant.interface).layouts if item.name == layout.name)
    placed = layout.place(variant.parameters)
    for item in placed.fields:
        of_byte = frame_bytes(layout, placed.bits, item.high, item.low) if layout.in_bytes else ""
        at = (code(item.name), of_byte or bits(item.high, item.low))
        if isinstance(meaning_of(item.field), Active):
            by_level.setdefault(f"Active at {deciding(item.field)}", []).append(at)
        elif not of_byte and item.field.printed_name and deciding(item.field) in {"0", "1"}:
            by_level.setdefault("Not used by this encoder", []).append(at)
    yield from ((label, ", ".join(_with_places(names))) for label, names in by_level.items())
    signed = [item for item in placed.fields if isinstance(meaning_of(item.field), TwosComplement)]
    yield from (("Signed", _signed(family, item, placed)) for item in signed)
    judgement = next((item.judgement for item in reportings(family) if item.codec.layout.name == layout.name), None)
    if judgement is not None:
        line = verdict_line(judgement, variant, checked is not None)
        yield "Position", line
        for asked in family.verdict_alternatives(layout):
            for answer in asked.answers[1:]:
                chosen = with_answers(family, variant, {asked.name: answer.name})
                other_line = verdict_line(judgement, chosen, checked is not None)
                if other_line != line:
                    choice = link("your choice", f"#alternative-{asked.name}")
                    about = f"({choice} instead of {code(asked.default)})"
                    yield f"Position, with {code(answer.name)}", f"{other_line} {about}"


def _signed(family: Device, item: PlacedField, placed: PlacedLayout) -> str:
    """Return the notation and range of a signed number."""
    lowest, highest = family.signed_range(item, placed)
    return f"{code(item.name)}, in two's complement, {number(lowest)} to {number(highest)}"


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
    parts = []
    for verdict, items in judgement.worst_first:
        applying = [item for item in items if all(_applies(only, variant) for only in item.conditions)]
        if applying:
            parts.append(f"{_VERDICT[verdict]} if {', or if '.join(_causes(applying))}")
    if not parts:
        return STYLE.phrase(said(WORTH[judgement.otherwise]))
    correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*parts, f"otherwise{correct} {_VERDICT[judgement.otherwise]}"])


def _causes(items: Sequence[Speaks]) -> Iterator[str]:
    """Yield the conditions of a verdict. Flags with the same active level are one condition."""
    by_value: dict[str, list[str]] = {}
    for item in items:
        if not isinstance(item.by, Match):
            by_value.setdefault(deciding(item.by.field), []).append(_cause(item))
    yield from (f"{' or '.join(names)} is {value}" for value, names in by_value.items())
    for item in items:
        if isinstance(item.by, Match):
            yield STYLE.phrase(conditions((part.field, value) for part, value in item.by.conditions))


_VERDICT = {
    Verdict.USABLE: "✓ usable",
    Verdict.USABLE_WITH_WARNING: "▲ usable with a warning",
    Verdict.NOT_USABLE: "✕ **not usable**",
    Verdict.UNKNOWN: "? unknown",
}


def _cause(item: Speaks) -> str:
    unless = " and ".join(code(part.field.name) for part in item.unless)
    return code(item.by.field.name) + (
        f" (while {unless} {'is' if len(item.unless) == 1 else 'are'} inactive)" if unless else ""
    )


def _applies(only: Only, variant: Variant) -> bool:
    return bool(variant.parameters.get(only.parameter, 0)) == only.holds
