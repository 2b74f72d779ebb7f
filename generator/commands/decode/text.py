"""Explain decoded frames in text at most 80 columns wide."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from ...model import Alternative, Crc, Device, Fault, PlacedLayout, Variant
from ...order_codes.labels import LabelMatch
from ...order_codes.parameters import parameters_of
from ...reference import codec
from ...reference.findings import Findings, FrameReport
from ...say import WIDTH, frame_texts
from ...say.frame_texts import ANOTHER_FRAME, UNCERTAIN_READINGS
from ...say.names_and_evidence import differences_from_manual, name_in_words, placeholders
from ...say.order_code import not_on_label
from ...say.text import PLAIN_STYLE, VERDICT_CLAUSES, as_sentence, count_with_unit
from .field_table import capitalized, field_table, position_text, wrapped
from .frames import FrameLine, frame_number, undecorated

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis, Explanation
    from ...why.together import CommonMistake

NO_ANSWERS: Mapping[str, str] = MappingProxyType({})
NO_LINE = FrameLine(None, "", "")
_NO_FINDINGS = Findings()


def explain(
    device: Device,
    code_match: LabelMatch,
    sender: str,
    decoded: codec.DecodedFrame,
    *,
    findings: Findings = _NO_FINDINGS,
    diagnosis: Diagnosis | None = None,
    line: FrameLine = NO_LINE,
    answers: Mapping[str, str] = NO_ANSWERS,
    label: Sequence[str] | None = None,
    other_frames: str = "",
) -> str:
    """Return a decoded frame as text, at most 80 columns wide.

    ``label`` are the lines about the order code, if they are already known. ``other_frames`` is a sentence on other
    layouts with which the frame is valid, or "".
    """
    title = heading(device, code_match.variant, sender, decoded.layout)
    lines = [f"{line_prefix(line)}{title}"]
    lines += label_lines(device, code_match) if label is None else label
    lines += described_frame(
        device,
        code_match.variant,
        decoded,
        findings=findings,
        diagnosis=diagnosis,
        answers=answers,
        other_frames=other_frames,
        frame_text=line.text,
    )
    return "\n".join([*lines, *evidence_lines(device)])


def described_frame(
    device: Device,
    variant: Variant,
    decoded: codec.DecodedFrame,
    *,
    findings: Findings,
    diagnosis: Diagnosis | None = None,
    answers: Mapping[str, str] = NO_ANSWERS,
    other_frames: str = "",
    frame_text: str = "",
) -> Iterator[str]:
    """Yield the lines about a decoded frame: layout, fields, position, CRC, errors or reports, and possible causes.

    ``frame_text`` is the text that the user typed for the frame, or "".
    """
    if decoded.layout is not None:
        yield _layout_line(decoded.layout)
        yield from _answer_lines(device, answers)
    # An echo makes everything else in the frame meaningless.
    yield from _own_request_lines(device, variant, decoded)
    if decoded.fields:
        yield from ("", *field_table(decoded))
        position = position_text(device, variant, decoded, findings.verdict)
        if position:
            yield from ("", position)
    if decoded.crc is not None:
        crc = device.crc(decoded.crc.name)
        yield from ("", _crc_line(crc, decoded.crc))
    yield from ("", *_problem_lines(decoded, findings))
    if other_frames:
        yield wrapped(other_frames, WIDTH, prefix="  ", first="")
    yield from _other_position_lines(device, variant, decoded, frame_text)
    if diagnosis is not None:
        yield from _why_lines(diagnosis, decoded.layout)
    elif _is_corrupted(decoded) and not other_frames:
        is_searched = not _has_odd_crc_over_bytes(device, decoded)
        yield from ("", as_sentence(frame_texts.NO_EXPLANATION if is_searched else frame_texts.NOT_SEARCHED))


def _has_odd_crc_over_bytes(device: Device, decoded: codec.DecodedFrame) -> bool:
    """Return whether a frame of bytes has a CRC that does not consist of whole bytes."""
    from ...why.in_bytes import is_whole_bytes

    if decoded.layout is None or decoded.crc is None or not decoded.layout.layout.in_bytes:
        return False
    return not is_whole_bytes(device.crc(decoded.crc.name))


def _is_corrupted(decoded: codec.DecodedFrame) -> bool:
    """Return whether a frame is corrupted: its CRC, its length or a constant is wrong, and no CRC is correct.

    A CRC whose bytes are exchanged does not count, because its message says so.
    """
    faults = {problem.fault for problem in decoded.problems}
    has_correct_crc = decoded.crc is not None and decoded.crc.ok
    has_corruption = not faults.isdisjoint({Fault.CRC, Fault.LENGTH, Fault.CONSTANT})
    is_explained = decoded.crc is not None and decoded.crc.has_exchanged_bytes
    return has_corruption and not has_correct_crc and not is_explained


def evidence_lines(device: Device) -> Iterator[str]:
    """Yield the grade of the evidence, and a sentence about values left over from the template, if there are any."""
    yield f"evidence: {device.evidence.grade}"
    if device.evidence.placeholders:
        yield wrapped(placeholders(device), WIDTH, prefix="  ", first="")


def _other_position_lines(
    device: Device, variant: Variant, decoded: codec.DecodedFrame, frame_text: str
) -> Iterator[str]:
    """Yield a line about other ways to read the position of a frame without errors.

    ``frame_text`` is the text that the user typed.
    """
    placed_layout = decoded.layout
    if decoded.problems or placed_layout is None or placed_layout.layout.in_bytes:
        return
    from ...why.doubts import other_positions, position_name

    typed_frame = frame_number(placed_layout, undecorated(frame_text)) if frame_text else None
    readings = [f"{position} {reason}" for reason, position in other_positions(device, variant, decoded, typed_frame)]
    if readings:
        suggestion = frame_texts.looks_wrong(position_name(device, variant), ", ".join(readings))
        yield wrapped(as_sentence(suggestion), WIDTH, prefix="  ", first="")


def _own_request_lines(device: Device, variant: Variant, decoded: codec.DecodedFrame) -> Iterator[str]:
    """Yield a blank line and a note if a frame without errors, received over SPI, is also the master's own request."""
    placed_layout = decoded.layout
    if decoded.problems or placed_layout is None or placed_layout.layout.in_bytes:
        return
    from ...why.exchanges import own_request

    request_name = own_request(device, variant, placed_layout, decoded.number)
    if request_name:
        note = capitalized(frame_texts.own_request_note(request_name))
        yield from ("", wrapped(as_sentence(note), WIDTH, prefix="  ", first=""))


def line_prefix(line: FrameLine) -> str:
    """Return the number and the time of a line of input, such as ``line 3 at 0.125: ``, or "" if it has neither."""
    number_text = f"line {line.number}" if line.number is not None else ""
    time_text = f"at {line.time}" if line.time else ""
    number_and_time = f"{number_text} {time_text}".strip()
    return f"{number_and_time}: " if number_and_time else ""


def heading(device: Device, variant: Variant, sender: str, placed_layout: PlacedLayout | None) -> str:
    """Return the order code, its interface and, unless it is a register, the sender."""
    text = f"{variant.code}, {device.interface(variant.interface).title}"
    is_register = placed_layout is not None and not placed_layout.layout.sender
    return text if is_register else f"{text}, from the {sender}"


def label_lines(device: Device, code_match: LabelMatch) -> Iterator[str]:
    """Yield lines about an order code: the parameters that registers hold, its label, and the origin of its spec."""
    variant = code_match.variant
    names_read = [parameter.name for parameter in parameters_of(device, variant.interface) if parameter.read_from]
    if names_read:
        state = ", ".join(f"{name} = {variant.parameters[name]}" for name in names_read)
        yield wrapped(f"with {state} (from registers; --register changes them)", WIDTH, prefix="  ")
    # Text after the order code does not matter for decoding.
    yield from label_differences(device, replace(code_match, tail=""))
    for statement in differences_from_manual(device):
        yield wrapped(PLAIN_STYLE.sentence(statement), WIDTH, prefix="  ")


def label_differences(device: Device, code_match: LabelMatch) -> Iterator[str]:
    """Yield lines on how a label differs from the order codes in the manual.

    It may be spelled differently, contain unlisted values, continue after the order code, or be for a special model.
    """
    for statement in not_on_label(device):
        yield wrapped(PLAIN_STYLE.sentence(statement), WIDTH, prefix="  ")
    if code_match.written_as_in:
        yield wrapped(f"the label is written as in {code_match.written_as_in}", WIDTH, prefix="  ")
    if code_match.unlisted:
        unlisted_parts = ", ".join(code_match.unlisted)
        yield wrapped(f"accepted, although not listed in the manual: {unlisted_parts}", WIDTH, prefix="  ")
    if code_match.tail:
        yield f"  the label continues with {code_match.tail}"
    if code_match.special:
        special = device.order_code.special or "A code that ends in /Sxxx may differ from the manual."
        yield wrapped(special, WIDTH, prefix="  ")


def _layout_line(placed_layout: PlacedLayout) -> str:
    """Return the line about a layout, such as ``Single cycle data, 45 bits, data channel 2``."""
    layout = placed_layout.layout
    title = layout.printed_name or name_in_words(placed_layout.name)
    if layout.in_bytes:
        length = count_with_unit(placed_layout.bits // 8, "byte")
    else:
        length = count_with_unit(placed_layout.bits, "bit")
    channel = f", data channel {layout.channel}" if layout.channel else ""
    return f"{title}, {length}{channel}"


def _answer_lines(device: Device, answers: Mapping[str, str]) -> Iterator[str]:
    """Yield the meaning of each answer that was used, and the options for choosing a different one than a default.

    ``answers`` contains the answers to questions that the manual leaves open, as ``{question: answer}``.
    """
    for alternative in device.alternatives:
        for index, answer in enumerate(alternative.answers):
            is_used = answers.get(alternative.name) == answer.name
            if not is_used:
                continue
            answer_text = f"decoded with {alternative.name} = {answer.name}: {answer.meaning}"
            yield wrapped(answer_text, WIDTH, prefix="  ", first="")
            # If a question has a default, it is the first answer.
            is_default = bool(alternative.default) and index == 0
            if is_default:
                options = " or ".join(_options_for_other_answers(alternative))
                remark = f"this is the default; for a different reading, add {options}"
                yield wrapped(remark, WIDTH, prefix="    ", first="  ")


def _options_for_other_answers(alternative: Alternative) -> Iterator[str]:
    """Return the command-line options that choose the other answers to a question than the first."""
    return (f"--choose {alternative.name}={answer.name}" for answer in alternative.answers[1:])


def _crc_line(crc: Crc, crc_result: codec.CrcResult) -> str:
    """Return the line about the CRC, such as ``CRC 0x1a: correct (x^6 + x + 1, sent inverted)``."""
    verdict = "correct" if crc_result.ok else f"WRONG, expected {crc_result.computed:#04x}"
    start_value = f", start value {crc.init:#x}" if crc.init else ""
    inversion = ", sent inverted" if crc.xorout == crc.mask else ""
    computation = f"{crc.polynomial}{start_value}{inversion}"
    return wrapped(f"CRC {crc_result.received:#04x}: {verdict} ({computation})", WIDTH, prefix="  ", first="")


def _problem_lines(decoded: codec.DecodedFrame, findings: Findings) -> Iterator[str]:
    """Yield the errors of a frame and its differences from the manual. Without errors, the encoder's reports follow."""
    for problem in decoded.problems:
        yield wrapped(f"{problem.fault.value} error: {problem.message}", WIDTH, prefix="  ", first="")
    for difference in findings.differences:
        yield wrapped(f"not as documented: {difference.message}", WIDTH, prefix="  ", first="")
    if not decoded.problems:
        yield from _report_lines(decoded, findings)


def _report_lines(decoded: codec.DecodedFrame, findings: Findings) -> Iterator[str]:
    """Yield the encoder's reports and the verdict that follows from them.

    Without reports, yield one line: ``no frame error; this frame has no CRC; …`` with the verdict, if there is one.
    """
    if findings.reports:
        yield "the encoder reports:"
        for report in findings.reports:
            yield wrapped(_report_text(report), WIDTH, prefix=" " * 6, first="  - ")
        if findings.verdict:
            yield f"so {VERDICT_CLAUSES[findings.verdict]}"
        return
    statements = [_no_error_text(decoded, findings)]
    if _is_known_frame(decoded) and decoded.crc is None:
        statements.append(_no_crc_text(decoded))
    if findings.verdict is not None:
        statements.append(VERDICT_CLAUSES[findings.verdict])
    yield wrapped("; ".join(statements), WIDTH, prefix="  ", first="")


def _is_known_frame(decoded: codec.DecodedFrame) -> bool:
    """Return whether a frame with a known layout was decoded, not a register."""
    return decoded.layout is not None and decoded.layout.layout.sender != ""


def _no_error_text(decoded: codec.DecodedFrame, findings: Findings) -> str:
    if findings.differences:
        return "no other error"
    return "no frame error" if _is_known_frame(decoded) else "the value is valid"


def _no_crc_text(decoded: codec.DecodedFrame) -> str:
    has_parity = decoded.layout is not None and decoded.layout.has_parity
    return "this frame has no CRC, only parity" if has_parity else "this frame has no CRC"


def _report_text(report: FrameReport) -> str:
    name = f"{report.field} ({report.printed_name})" if report.printed_name else report.field
    if not report.remedy:
        return f"{name}: {report.meaning}"
    return f"{name}: {as_sentence(report.meaning)} {as_sentence(report.remedy)}"


def _why_lines(diagnosis: Diagnosis, placed_layout: PlacedLayout | None) -> list[str]:
    """Return the lines that explain an error: a dead line alone, or corrupted bits and possible mistakes."""
    kinds = [explanation.kind for explanation in diagnosis.explanations]
    if kinds == ["line_stuck"]:
        explanation = as_sentence(capitalized(diagnosis.explanations[0].text))
        return ["", wrapped(explanation, WIDTH, prefix="  ", first="")]
    lines = []
    if diagnosis.missing_part:
        missing_bits = as_sentence(capitalized(diagnosis.missing_part))
        lines += ["", wrapped(missing_bits, WIDTH, prefix="  ", first="")]
    lines += _disturbed_lines(diagnosis.bits_to_invert, placed_layout)
    return lines + _mistake_lines(diagnosis)


def _disturbed_lines(disturbed: Sequence[int], placed_layout: PlacedLayout | None) -> list[str]:
    """Return the hint that one of some bits may have been inverted on the line, or no lines if there are none."""
    if not disturbed or placed_layout is None:
        return []
    inverted_bits = _bit_name(disturbed[0], placed_layout) if len(disturbed) == 1 else f"one of {len(disturbed)} bits"
    from ...why.hypotheses import has_only_parity

    if has_only_parity(placed_layout):
        return ["", wrapped(frame_texts.inverted_or_shifted_note(inverted_bits), WIDTH, prefix="  ", first="")]
    has_crc = placed_layout.crc_field is not None
    hint = frame_texts.inverted_bit_note(inverted_bits, has_crc=has_crc)
    return ["", wrapped(f"{hint} If all frames fail, read on.", WIDTH, prefix="  ", first="")]


def _bit_name(bit: int, placed_layout: PlacedLayout) -> str:
    """Return the name of a bit: ``bit 9`` in a bit frame, or ``bit 1 of byte 2`` in a frame of bytes.

    Bit 0 is the last bit sent, and byte 0 is the first byte.
    """
    if not placed_layout.layout.in_bytes:
        return f"bit {bit}"
    byte = placed_layout.bits // 8 - 1 - bit // 8  # Bits are counted from the end, and bytes from the beginning.
    return f"bit {bit % 8} of byte {byte}"


def _mistake_lines(diagnosis: Diagnosis) -> list[str]:
    """Return the mistakes that explain a frame, each with its probability, or a line that none does, and then hints."""
    whole_percent = round(100 * diagnosis.chance_of_match)
    percent = f"{whole_percent}" if whole_percent else "less than 1"
    mistakes = count_with_unit(diagnosis.tried_count, "common mistake")
    chance = f"{mistakes} tried; {percent} of 100 random frames would match at least one"
    lines = []
    if diagnosis.explanations:
        lines.append(wrapped(_introduction_sentence(diagnosis, chance), WIDTH, prefix="  ", first=""))
    elif diagnosis.tried_count:
        lines.append(wrapped(f"{frame_texts.NO_EXPLANATION} ({chance}).", WIDTH, prefix="  ", first=""))
    for explanation in diagnosis.explanations:
        lines.append(wrapped(explanation.text, WIDTH, prefix=" " * 6, first="    - "))
        for detail in (_chance_and_values(explanation), _parts_of_recording(explanation)):
            if detail:
                lines.append(wrapped(detail, WIDTH, prefix=" " * 6, first=" " * 6))
    lines += _hint_lines(diagnosis)
    return ["", *lines] if lines else []


def _hint_lines(diagnosis: Diagnosis) -> list[str]:
    """Return hints: whether another frame would help, and which errors the CRC cannot detect."""
    lines = []
    if diagnosis.explanations and diagnosis.explanations[0].hides_shift:
        lines.append(wrapped(as_sentence(frame_texts.HIDDEN_SHIFT), WIDTH, prefix="  ", first=""))
    if diagnosis.equal_readings:
        equal_readings = frame_texts.equal_readings(f"{diagnosis.equal_readings}")
        lines.append(wrapped(as_sentence(equal_readings), WIDTH, prefix="  ", first=""))
    if diagnosis.needs_another_frame:
        lines.append(wrapped(ANOTHER_FRAME, WIDTH, prefix="  ", first=""))
    if diagnosis.undetectable_mistakes:
        undetected_errors = "; ".join(diagnosis.undetectable_mistakes)
        lines.append(wrapped(f"This CRC cannot detect: {undetected_errors}.", WIDTH, prefix="  ", first=""))
    return lines


def together_lines(
    mistakes: Sequence[CommonMistake], failed_frames: int, *, with_valid_frames: bool = False
) -> Iterator[str]:
    """Yield lines about mistakes, likeliest first. Each explains the same number of failed frames, at least two.

    If ``with_valid_frames`` is true, the mistakes explain all frames, also the valid ones.
    """
    if not mistakes or mistakes[0].frames < 2:
        return
    explained_frames = mistakes[0].frames
    introduction = frame_texts.explained_together(f"{explained_frames}", f"{failed_frames}")
    if with_valid_frames:
        introduction = frame_texts.all_explained_together(f"{explained_frames}")
    yield f"\n{wrapped(introduction, WIDTH, prefix='  ', first='')}:"
    for mistake in mistakes:
        chance = f"; matches by chance in {_frequency_text(mistake.one_in)}" if mistake.one_in > 1 else ""
        yield wrapped(f"{mistake.text}{chance}", WIDTH, prefix=" " * 6, first="    - ")
    if mistakes[0].hides_shift:
        yield wrapped(as_sentence(frame_texts.HIDDEN_SHIFT), WIDTH, prefix="  ", first="")
    yield ""


def _introduction_sentence(diagnosis: Diagnosis, chance: str) -> str:
    """Return the sentence before the possible explanations of a frame. With a CRC, it includes ``chance``."""
    if not diagnosis.has_crc:
        return f"{UNCERTAIN_READINGS}:"
    needs_two = diagnosis.explanations[-1].needs_two_mistakes
    introduction = "No single mistake explains it. Two at once would" if needs_two else "Possible explanations"
    return f"{introduction}, most likely first ({chance}):"


def _chance_and_values(explanation: Explanation) -> str:
    """Return how often a mistake matches by chance, and the values that the frame has without it.

    For example, ``matches by chance in 1 of 64 frames, and gives position 5``.
    """
    details = []
    if explanation.one_in > 1:
        details.append(f"matches by chance in {_frequency_text(explanation.one_in)} frames")
    if explanation.numbers_read:
        readings = map(_numbers_text, (explanation.numbers_read, *explanation.other_numbers_read))
        details.append(f"gives {' or '.join(readings)}")
    return ", and ".join(details)


def _numbers_text(numbers: Mapping[str, int]) -> str:
    """Return the numbers of a frame, such as ``multiturn 3, singleturn 1000``."""
    return ", ".join(f"{name} {number}" for name, number in numbers.items())


def _parts_of_recording(explanation: Explanation) -> str:
    """Return the parts of a recording in the order received, such as ``start 0, position 101101, crc 011010``."""
    return ", ".join(f"{name.replace('_', '-')} {bits}" for name, bits in explanation.recording_parts)


def _frequency_text(frames_per_match: int) -> str:
    return f"1 of {frames_per_match:,}" if frames_per_match < 1_000_000 else "fewer than 1 of a million"
