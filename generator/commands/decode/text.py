"""Explain decoded frames in text at most 80 columns wide."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ...model import Alternative, Crc, Device, Measurement, PlacedLayout, Variant, Verdict
from ...model.expressions import Expression
from ...order_codes.labels import Match
from ...order_codes.parameters import parameters_of
from ...reference import codec
from ...reference.findings import Findings, Report
from ...say import report as say
from ...say.evidence import origin, placeholders
from ...say.names_and_places import bit_place, words
from ...say.order_code import not_on_label
from ...say.plain_text import WIDTH, decimal, quantity
from ...say.plain_text import wrapped as wrapped_anew
from ...say.report import ANOTHER_FRAME, UNCERTAIN_READINGS
from ...say.text import BY_NAME, WORTH, counted, sentence, with_unit
from .frames import Line, is_frame_of_other_kind

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis, Explanation
    from ...why.together import CommonMistake

NO_ANSWERS: Mapping[str, str] = MappingProxyType({})
NO_LINE = Line(None, "", "")
_NO_FINDINGS = Findings()
#: Most paragraphs are the same for all frames.
wrapped = lru_cache(maxsize=1024)(wrapped_anew)


def explain(
    device: Device,
    match: Match,
    sender: str,
    decoded: codec.Decoded,
    findings: Findings = _NO_FINDINGS,
    why: Diagnosis | None = None,
    line: Line = NO_LINE,
    answers: Mapping[str, str] = NO_ANSWERS,
    label: Sequence[str] | None = None,
    other_frames: str = "",
) -> str:
    """Return the result as text, at most 80 columns wide.

    ``label`` are the ``label_lines`` if they are known. ``other_frames`` names the other frames that it can be.
    """
    lines = [_line_prefix(line) + _heading(device, match.variant, sender, decoded)]
    lines += label_lines(device, match) if label is None else label
    if decoded.layout is not None:
        lines += [_layout_line(decoded.layout), *_answer_lines(device, answers)]
    if decoded.fields:
        lines += ["", *_field_table(decoded)]
        position = _position_text(device, match.variant, decoded, findings.verdict)
        lines += ["", position] if position else []
    if decoded.crc is not None:
        lines += ["", _crc_line(device.crc(decoded.crc.name), decoded.crc)]
    lines += ["", *_problem_lines(decoded, findings)]
    if other_frames:
        lines.append(wrapped(other_frames, WIDTH, prefix="  ", first=""))
    lines += _other_position_lines(device, match.variant, decoded)
    if why is not None:
        lines += _why_lines(why, decoded.layout)
    lines.append(f"evidence: {device.evidence.grade}")
    if device.evidence.placeholders:
        lines.append(wrapped(placeholders(device), WIDTH, prefix="  ", first=""))
    return "\n".join(lines)


def _other_position_lines(device: Device, variant: Variant, decoded: codec.Decoded) -> Iterator[str]:
    """Yield other readings of a position that nothing in the frame can contradict."""
    if decoded.problems or decoded.crc is not None:
        return
    from ...why.doubts import other_positions, position_name

    readings = [f"{value} {reason}" for reason, value in other_positions(device, variant, decoded)]
    if readings:
        suggestion = say.looks_wrong(position_name(device, variant), ", ".join(readings))
        yield wrapped(sentence(suggestion), WIDTH, prefix="  ", first="")


def _line_prefix(line: Line) -> str:
    """Return the number and the time of a line of standard input, or an empty string."""
    number = f"line {line.number}" if line.number is not None else ""
    time = f"at {line.time}" if line.time else ""
    prefix = f"{number} {time}".strip()
    return f"{prefix}: " if prefix else ""


def _heading(device: Device, variant: Variant, sender: str, decoded: codec.Decoded) -> str:
    heading = f"{variant.code}, {device.interface(variant.interface).title}"
    is_register = decoded.layout is not None and not decoded.layout.layout.sender
    return heading if is_register else f"{heading}, from the {sender}"


def label_lines(device: Device, match: Match) -> Iterator[str]:
    """Yield the state that registers decide, and how the label differs from the codes in the manual."""
    variant = match.variant
    names = [parameter.name for parameter in parameters_of(device, variant.interface) if parameter.read_from]
    if names:
        state = ", ".join(f"{name} = {variant.parameters[name]}" for name in names)
        yield wrapped(f"with {state} (from registers; --register changes them)", WIDTH, prefix="  ")
    yield from label_differences(device, replace(match, tail=""))
    for statement in origin(device):
        yield wrapped(BY_NAME.sentence(statement), WIDTH, prefix="  ")


def label_differences(device: Device, match: Match) -> Iterator[str]:
    """Yield how a label differs from the codes in the manual, in lines of at most 80 columns."""
    for statement in not_on_label(device):
        yield wrapped(BY_NAME.sentence(statement), WIDTH, prefix="  ")
    if match.written_as_in:
        yield wrapped(f"the label is written as in {match.written_as_in}", WIDTH, prefix="  ")
    if match.unlisted:
        yield wrapped(f"accepted, although not listed in the manual: {', '.join(match.unlisted)}", WIDTH, prefix="  ")
    if match.tail:
        yield f"  the label continues with {match.tail}"
    if match.special:
        special = device.order_code.special or "A code that ends in /Sxxx may differ from the manual."
        yield wrapped(special, WIDTH, prefix="  ")


def _layout_line(placed: PlacedLayout) -> str:
    """Return the line about a layout, such as ``Single cycle data, 45 bits, data channel 2``."""
    layout = placed.layout
    title = layout.printed_name or words(placed.name)
    if layout.in_bytes:
        size = counted(placed.bits // 8, "byte")
    else:
        size = counted(placed.bits, "bit")
    channel = f", data channel {layout.channel}" if layout.channel else ""
    return f"{title}, {size}{channel}"


def _answer_lines(device: Device, answers: Mapping[str, str]) -> Iterator[str]:
    """Yield the answers to questions that the manual leaves open, and how to choose others than the defaults."""
    for alternative in device.alternatives:
        for index, answer in enumerate(alternative.answers):
            is_used = answers.get(alternative.name) == answer.name
            if not is_used:
                continue
            yield wrapped(
                f"decoded with {alternative.name} = {answer.name}: {answer.meaning}", WIDTH, prefix="  ", first=""
            )
            is_default = bool(alternative.default) and index == 0
            if is_default:
                options = " or ".join(_other_options(alternative))
                yield wrapped(
                    f"this is the default; for another reading, add {options}", WIDTH, prefix="    ", first="  "
                )


def _other_options(alternative: Alternative) -> Iterator[str]:
    """Yield the options that choose another answer than the first."""
    return (f"--choose {alternative.name}={answer.name}" for answer in alternative.answers[1:])


def _crc_line(crc: Crc, crc_result: codec.CrcResult) -> str:
    """Return the line about the CRC, such as ``CRC 0x1a: correct (x^6 + x + 1, sent inverted)``."""
    verdict = "correct" if crc_result.ok else f"WRONG, expected {crc_result.computed:#04x}"
    start_value = f", start value {crc.init:#x}" if crc.init else ""
    inversion = ", sent inverted" if crc.xorout == crc.mask else ""
    computation = f"{crc.polynomial}{start_value}{inversion}"
    return wrapped(f"CRC {crc_result.received:#04x}: {verdict} ({computation})", WIDTH, prefix="  ", first="")


def _problem_lines(decoded: codec.Decoded, findings: Findings) -> Iterator[str]:
    """Yield the errors of the frame and what differs from the manual or, without errors, also the last lines."""
    for problem in decoded.problems:
        yield wrapped(f"{problem.fault.value} error: {problem.message}", WIDTH, prefix="  ", first="")
    for difference in findings.differences:
        yield wrapped(f"not as documented: {difference.message}", WIDTH, prefix="  ", first="")
    if not decoded.problems:
        yield from _report_lines(decoded, findings)


def _report_lines(decoded: codec.Decoded, findings: Findings) -> Iterator[str]:
    """Yield the last lines about a valid frame or register: the encoder's reports, or that there is no error."""
    if findings.reports:
        yield "the encoder reports:"
        for report in findings.reports:
            yield wrapped(_report_text(report), WIDTH, prefix=" " * 6, first="  - ")
        if findings.verdict:
            yield f"so {WORTH[findings.verdict]}"
        return
    statements = [_no_error_text(decoded, findings)]
    if _is_frame(decoded) and decoded.crc is None:
        statements.append(_no_crc_text(decoded))
    if findings.verdict is not None:
        statements.append(WORTH[findings.verdict])
    yield wrapped("; ".join(statements), WIDTH, prefix="  ", first="")


def _is_frame(decoded: codec.Decoded) -> bool:
    """Return whether a frame with a known layout was decoded, not a register."""
    return decoded.layout is not None and decoded.layout.layout.sender != ""


def _no_error_text(decoded: codec.Decoded, findings: Findings) -> str:
    if findings.differences:
        return "no other error"
    return "no frame error" if _is_frame(decoded) else "the value is valid"


def _no_crc_text(decoded: codec.Decoded) -> str:
    has_parity = decoded.layout is not None and decoded.layout.layout.has_parity
    return "this frame has no CRC, only parity" if has_parity else "this frame has no CRC"


def _report_text(report: Report) -> str:
    name = f"{report.field} ({report.printed_name})" if report.printed_name else report.field
    if not report.remedy:
        return f"{name}: {report.meaning}"
    return f"{name}: {sentence(report.meaning)} {sentence(report.remedy)}"


def _position_text(device: Device, variant: Variant, decoded: codec.Decoded, verdict: Verdict | None) -> str:
    """Return the position in degrees or micrometres, or only the angle if the frame has no other part of it.

    An angle in degrees would look too trustworthy for an unusable position, so there is none.
    """
    measurement = device.measurement_of(variant.interface)
    if verdict in (None, Verdict.NOT_USABLE) or measurement is None or decoded.layout is None:
        return ""
    measurement = measurement.within(decoded.layout.layout.position_range)
    field_name = measurement.of
    if field_name not in decoded.values:
        field_name = _lowest_joined_field(device, variant, field_name)
    counts = decoded.values.get(field_name)
    if not isinstance(counts, int):
        return ""
    micrometres_per_count = measurement.micrometres(variant.parameters)
    if micrometres_per_count is not None:
        return f"{field_name}: {decimal(counts * micrometres_per_count)} µm"
    return _angle_text(measurement, variant, field_name, counts)


def _lowest_joined_field(device: Device, variant: Variant, name: str) -> str:
    """Return the last field of a join of this name, which has the lowest bits, or the name itself without a join."""
    for layout in device.interface(variant.interface).layouts:
        for join in layout.joins:
            if join.name == name:
                return join.fields[-1]
    return name


def _angle_text(measurement: Measurement, variant: Variant, name: str, counts: int) -> str:
    """Return the angle and, if the counts are the whole position, the revolution. Empty for a fraction of a count."""
    counts_per_turn = _value_or_zero(measurement.counts_per_turn, variant)
    turns = _value_or_zero(measurement.turns, variant)
    if counts_per_turn < 1:
        return ""
    turn, counts_in_turn = divmod(counts, counts_per_turn)
    degrees = counts_in_turn * 360 / counts_per_turn
    decimals = len(str(counts_per_turn // 360))
    angle = f"{name}: {degrees:.{decimals}f}°"
    is_whole_position = turns > 1 and name == measurement.of
    return f"{angle} of revolution {turn:,}" if is_whole_position else angle


def _value_or_zero(expression: Expression | None, variant: Variant) -> int:
    return expression.value(variant.parameters) if expression is not None else 0


def _why_lines(why: Diagnosis, placed: PlacedLayout | None) -> list[str]:
    """Return what explains the frame: a line that never changes, a disturbed bit, or mistakes."""
    is_line_stuck = [explanation.kind for explanation in why.explanations] == ["line_stuck"]
    if is_line_stuck:
        explanation = sentence(capitalized(why.explanations[0].text))
        return ["", wrapped(explanation, WIDTH, prefix="  ", first="")]
    return [*_disturbed_lines(why.disturbed, placed), *_mistake_lines(why)]


def _disturbed_lines(disturbed: Sequence[int], placed: PlacedLayout | None) -> list[str]:
    """Return the usual cause if only some frames fail: one bit was inverted in transmission."""
    if not disturbed or placed is None:
        return []
    bits = _bit_name(disturbed[0], placed) if len(disturbed) == 1 else f"one of {len(disturbed)} bits"
    explanation = (
        "If only some frames fail, one bit may have been disturbed on the line: the CRC matches with "
        f"{bits} inverted. In that case, no change is needed. If all frames fail, read on."
    )
    return ["", wrapped(explanation, WIDTH, prefix="  ", first="")]


def _bit_name(bit: int, placed: PlacedLayout) -> str:
    """Return the name of a bit that is counted from the last as 0."""
    if not placed.layout.in_bytes:
        return f"bit {bit}"
    last_byte = placed.bits // 8 - 1
    return f"bit {bit % 8} of byte {last_byte - bit // 8}"


def _mistake_lines(why: Diagnosis) -> list[str]:
    """Return the mistakes that explain a frame, each with its chance, and the hints that follow them."""
    percent = f"{100 * why.coincidence:.0f}" if why.coincidence >= 0.005 else "less than 1"
    mistakes = counted(why.tried, "common mistake")
    chance = f"{mistakes} tried; {percent} of 100 random frames would match at least one"
    lines = [""]
    if why.explanations:
        lines.append(wrapped(_introduction(why, chance), WIDTH, prefix="  ", first=""))
    elif why.tried:
        lines.append(wrapped(f"No common mistake explains it ({chance}).", WIDTH, prefix="  ", first=""))
    for explanation in why.explanations:
        lines.append(wrapped(explanation.text, WIDTH, prefix=" " * 6, first="    - "))
        for detail in (_chance_and_values(explanation), _parts_of_recording(explanation)):
            if detail:
                lines.append(wrapped(detail, WIDTH, prefix=" " * 6, first=" " * 6))
    return [*lines, *_hint_lines(why)]


def _hint_lines(why: Diagnosis) -> list[str]:
    """Return what a recording lacks, whether another frame would help, and what the CRC cannot detect."""
    lines = []
    if why.missing:
        lines.append(wrapped(sentence(capitalized(why.missing)), WIDTH, prefix="  ", first=""))
    if why.needs_another_frame:
        lines.append(wrapped(ANOTHER_FRAME, WIDTH, prefix="  ", first=""))
    if why.cannot_see:
        lines.append(wrapped(f"This CRC cannot detect: {'; '.join(why.cannot_see)}.", WIDTH, prefix="  ", first=""))
    return lines


def together_lines(mistakes: Sequence[CommonMistake], failed_frames: int) -> Iterator[str]:
    """Yield lines about the mistakes that explain the most of several frames with an error, the likeliest first."""
    if not mistakes or mistakes[0].frames < 2:
        return
    explained_frames = mistakes[0].frames
    introduction = say.explained_together(f"{explained_frames}", f"{failed_frames}")
    yield f"\n{wrapped(introduction, WIDTH, prefix='  ', first='')}:"
    for mistake in mistakes:
        chance = f"; matches by chance in {_frequency(mistake.one_in)}" if mistake.one_in > 1 else ""
        yield wrapped(f"{mistake.text}{chance}", WIDTH, prefix=" " * 6, first="    - ")
    yield ""


def _introduction(why: Diagnosis, chance: str) -> str:
    """Return the sentence in front of the explanations."""
    if not why.has_crc:
        return f"{UNCERTAIN_READINGS}:"
    needs_two = why.explanations[-1].twice
    introduction = "No single mistake explains it. Two at once would" if needs_two else "Possible explanations"
    return f"{introduction}, most likely first ({chance}):"


def _chance_and_values(explanation: Explanation) -> str:
    """Return how often a mistake matches by chance, and the values that the frame has without it."""
    texts = []
    if explanation.one_in > 1:
        texts.append(f"matches by chance in {_frequency(explanation.one_in)} frames")
    if explanation.reads:
        values = ", ".join(f"{name} {value}" for name, value in explanation.reads.items())
        texts.append(f"gives {values}")
    return ", and ".join(texts)


def _parts_of_recording(explanation: Explanation) -> str:
    """Return the parts of a recording, each with its bits, in the order received."""
    return ", ".join(f"{name.replace('_', '-')} {bits}" for name, bits in explanation.parts)


def _frequency(frames_per_match: int) -> str:
    return f"1 of {frames_per_match:,}" if frames_per_match < 1_000_000 else "fewer than 1 of a million"


class _FieldRow(NamedTuple):
    """A row of the table of fields: place, name, number and value of a field in columns, and then its meaning."""

    cells: tuple[str, str, str, str]
    meaning: str


#: Columns in front of the meaning of a field, above which it begins on a line of its own.
_WIDEST_HEAD = 56


def _field_table(decoded: codec.Decoded) -> list[str]:
    """Return the lines about the fields, in columns. The meaning is wrapped."""
    assert decoded.layout is not None
    # Each unused field has a line of its own, so the one for all of them is omitted.
    fields = [field for field in decoded.fields if field.name != codec.UNUSED or field.high >= 0]
    rows = [_field_row(decoded.layout, field) for field in fields]
    columns = zip(*(row.cells for row in rows), strict=True)
    column_widths = [max(map(len, column)) for column in columns]
    lines = []
    for row in rows:
        head = "  ".join(cell.ljust(width) for cell, width in zip(row.cells, column_widths, strict=True))
        indent = " " * (len(head) + 2)
        if not row.meaning:
            lines.append(head.rstrip())
        elif len(indent) > _WIDEST_HEAD:
            lines += [head.rstrip(), wrapped(row.meaning, WIDTH, prefix=" " * 6)]
        else:
            lines.append(wrapped(row.meaning, WIDTH, prefix=indent, first=head + "  "))
    return lines


def _field_row(placed: PlacedLayout, field: codec.DecodedField) -> _FieldRow:
    has_place = field.high >= 0
    place = bit_place(placed.layout, placed.bits, field.high, field.low) if has_place else ""
    is_one_bit = has_place and field.high <= field.low
    number = str(field.raw) if is_one_bit else f"{field.raw:#x}"
    return _FieldRow(cells=(place, field.name, number, _value_text(field)), meaning=_meaning_text(placed, field))


def _meaning_text(placed: PlacedLayout, field: codec.DecodedField) -> str:
    """Return the meaning, and for a number in Gray code also how it was sent."""
    if not placed.gray:
        return field.meaning
    gray_names = (*placed.layout.names_in(placed.layout.gray_of), placed.layout.gray_of)
    if field.name not in gray_names or not isinstance(field.value, int):
        return field.meaning
    gray_text = say.in_gray_code(f"{field.raw:#x}", f"{field.value:#x}")
    return f"{sentence(field.meaning)} {capitalized(gray_text)}" if field.meaning else gray_text


def capitalized(text: str) -> str:
    return text[:1].upper() + text[1:]


def _value_text(field: codec.DecodedField) -> str:
    """Return the value of a field with its unit, and the quantity that it stands for."""
    if isinstance(field.value, bool):
        text = "yes" if field.value else "no"
    else:
        text = with_unit(str(field.value), field.unit)
    if field.scale is None:
        return text
    return f"{text} ({quantity(field.scale, int(field.value))})"


def other_frames_line(decoded: codec.Decoded, other_layouts: Sequence[PlacedLayout]) -> str:
    """Return the names of the other frames in a sentence, or an empty string if there are none."""
    if not other_layouts:
        return ""
    names = ", ".join(layout.name for layout in other_layouts)
    if not decoded.problems:
        return f"{say.also_possible(names)} (choose with --layout)"
    if is_frame_of_other_kind(decoded, other_layouts):
        return f"{say.valid_other(names)}: add --layout {names}"
    return f"{say.possible_instead(names)} (choose with --layout)"
