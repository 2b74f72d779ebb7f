"""Decoded frames as plain data, with the structure that ``decode.schema.json`` describes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from ...model import Device, PlacedLayout, Scale, Variant
from ...reference import codec
from ...reference.findings import Findings, FrameReport, ValueDifference
from .channel_frames import ChannelResult
from .frames import FrameLine
from .text import NO_ANSWERS, NO_LINE

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis, Explanation

JSON_VERSION = 1


def decoded_data(
    device: Device,
    variant: Variant,
    sender: str,
    decoded: codec.DecodedFrame,
    frame_findings: Findings,
    diagnosis: Diagnosis | None = None,
    line: FrameLine = NO_LINE,
    answers: Mapping[str, str] = NO_ANSWERS,
    other_layouts: Sequence[PlacedLayout] = (),
) -> dict[str, Any]:
    """Return a decoded frame as plain data for JSON.

    ``line`` is the line of standard input, if the frame comes from there. ``answers`` are the answers to open questions
    that were used to decode the frame, as ``{question: answer}``. ``other_layouts`` are the other layouts with which
    the frame is valid.
    """
    verdict = frame_findings.verdict
    return {
        "version": JSON_VERSION,
        "line": line.number,
        "time": line.time or None,
        "order_code": variant.code,
        "evidence": device.evidence.grade,
        "alternatives": dict(answers),
        "layout": decoded.layout.name if decoded.layout is not None else None,
        "other_layouts": [other_layout.name for other_layout in other_layouts],
        "direction": sender,
        "fields": list(map(_field_data, decoded.fields)),
        "crc": _crc_data(decoded.crc) if decoded.crc is not None else None,
        "problems": list(map(_problem_data, decoded.problems)),
        "reports": list(map(_report_data, frame_findings.reports)),
        "verdict": verdict.value if verdict is not None else None,
        "differences": list(map(_difference_data, frame_findings.differences)),
        "why": _why_data(diagnosis) if diagnosis is not None else None,
    }


def channel_data(
    device: Device, variant: Variant, *, sender: str, result: ChannelResult, line: FrameLine
) -> dict[str, Any]:
    """Return a frame with several data channels as plain data for JSON, with the errors and reports of all channels.

    Each channel also has its fields and its own errors and reports. ``agree`` says whether the compared positions
    agree, and is null if none are compared.
    """
    data_of_frame = partial(decoded_data, device, variant, sender=sender, line=line)
    whole_frame = codec.DecodedFrame(layout=None, number=0, fields=(), crc=None, problems=tuple(result.all_problems))
    data = data_of_frame(decoded=whole_frame, frame_findings=result.all_findings)
    data["channels"] = []
    channels = zip(result.channels, result.findings.channels, result.whys, strict=True)
    for decoded_channel, channel_findings, diagnosis in channels:
        channel = data_of_frame(decoded=decoded_channel, frame_findings=channel_findings, diagnosis=diagnosis)
        data["channels"].append(channel)
    data["agree"] = result.findings.agree
    data["readings"] = list(result.readings)
    return data


def _crc_data(crc: codec.CrcResult) -> dict[str, Any]:
    return {"received": crc.received, "computed": crc.computed, "ok": crc.ok}


def _problem_data(problem: codec.FrameProblem) -> dict[str, Any]:
    return {"kind": problem.fault.value, "field": problem.field or None, "message": problem.message}


def _difference_data(difference: ValueDifference) -> dict[str, Any]:
    """Return a value that differs from the manual, for JSON."""
    return {
        "field": difference.field,
        "found": difference.actual,
        "documented": difference.documented,
        "message": difference.message,
    }


def _field_data(field: codec.DecodedField) -> dict[str, Any]:
    """Return a field with its raw and its decoded value, for JSON."""
    return {
        "name": field.name,
        "raw": field.raw,
        "value": field.value,
        "unit": field.unit or None,
        "quantity": _quantity_data(field.scale, field.value) if field.scale is not None else None,
        "meaning": field.meaning,
    }


def _quantity_data(scale: Scale, number: int | str | bool) -> dict[str, Any]:
    """Return the quantity that a number represents, such as 21.5 °C, as a decimal and as a fraction, for JSON.

    ``exact`` is false if the decimal is rounded.
    """
    fraction = scale.quantity(int(number))
    return {
        "decimal": scale.decimal(int(number)),
        "exact": scale.is_exact(int(number)),
        "numerator": fraction.numerator,
        "denominator": fraction.denominator,
        "unit": scale.unit,
    }


def _report_data(report: FrameReport) -> dict[str, Any]:
    """Return a report of the encoder, for JSON."""
    return {
        "field": report.field,
        "meaning": report.meaning,
        "remedy": report.remedy or None,
        "makes_position": report.makes_position.value if report.makes_position is not None else None,
        "source": report.source,
    }


def _why_data(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the possible explanations of an error in a frame, for JSON."""
    return {
        "explanations": [_explanation_data(explanation) for explanation in diagnosis.explanations],
        "tried": diagnosis.tried_count,
        "coincidence": round(diagnosis.chance_of_match, 4),
        "cannot_see": list(diagnosis.undetectable_mistakes),
        "disturbed": list(diagnosis.bits_to_invert),
        "missing": diagnosis.missing_part or None,
        "another_frame_helps": diagnosis.needs_another_frame,
        "equal_readings": diagnosis.equal_readings,
    }


def _explanation_data(explanation: Explanation) -> dict[str, Any]:
    """Return one possible explanation of an error in a frame, for JSON."""
    return {
        "kind": explanation.kind,
        "text": explanation.text,
        "one_in": explanation.one_in,
        "twice": explanation.needs_two_mistakes,
        "order_codes": list(explanation.order_codes),
        "reads": dict(explanation.numbers_read),
        "or_reads": [dict(numbers) for numbers in explanation.other_numbers_read],
        "parts": [{"name": name, "bits": bits} for name, bits in explanation.recording_parts],
    }
