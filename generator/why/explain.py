"""Explain why a CRC check fails by trying common mistakes.

For each mistake, the CRC is computed as if the mistake had been made. All mistakes with a matching CRC are listed, most
likely first. A mistake can match by chance: with a 6-bit CRC, it matches one random frame in 64. Therefore, each
explanation and the list as a whole state this probability.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

from ..model import Crc, Device, PlacedChannels, PlacedLayout, Rs485, Spi, Variant
from ..reference.codec import decode_channels
from ..say import count_with_unit, frame_texts
from .diagnosis import (
    Diagnosis,
    Explanation,
    diagnose,
    diagnose_without_crc,
    is_significant,
    unrefuted_significant_hypotheses,
)
from .exchanges import exchange_hypotheses
from .hypotheses import LEAST_EQUAL_BITS, MISTAKES, TEXTS, Hypothesis, TypedFrame, check_constant_bits, frame_hypothesis
from .in_bits import (
    all_hypotheses,
    data_bits_of_zero_reply,
    moved_frame_hypotheses,
    other_answer_hypotheses,
)
from .in_bytes import byte_hypotheses, is_valid_in_bytes
from .other_crcs import hypothesis_without_mistake
from .other_order_codes import other_order_code_hypotheses
from .rearranged import rearranged_frame_hypotheses
from .recordings import FRAME_INSIDE, LINES, line_name, missing_part_text, recorded_bits


def _diagnose_dead_line(
    variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame, is_valid: bool
) -> Diagnosis | None:
    """Return the diagnosis of a frame whose bits are all equal, or None for any other frame."""
    # If leading zeros may be missing, the frame is at least as long as expected.
    frame_length = typed_frame.bits if typed_frame.is_length_known else max(typed_frame.bits, placed_layout.bits)
    doubt = _doubt_about_dead_line(placed_layout, crc, typed_frame.number, is_valid)
    return _diagnose_equal_bits(variant, typed_frame.number, frame_length, doubt)


def explain_bits(
    device: Device,
    variant: Variant,
    placed_layout: PlacedLayout,
    typed_frame: TypedFrame,
    *,
    is_valid: bool = False,
    with_pairs: bool = False,
) -> Diagnosis | None:
    """Explain an error in a frame that is sent as bits: list the mistakes that could have caused it.

    ``typed_frame`` is the frame as the user typed it, which should have the layout ``placed_layout``. Return None if no
    mistake could be tried and no part of the frame is missing. A valid frame is only explained if all its bits are
    equal. Pairs of mistakes are listed if no single mistake matches, and with ``with_pairs`` also if one does.
    """
    crc = device.crc_of(placed_layout)
    dead_line = _diagnose_dead_line(variant, placed_layout, crc, typed_frame, is_valid)
    if dead_line is not None or is_valid:
        return dead_line
    zero_reply = _diagnose_zero_reply(variant, placed_layout, crc, typed_frame)
    if zero_reply is not None:
        return zero_reply
    missing_part = _missing_part_text(device, variant, placed_layout, typed_frame)
    if crc is None:
        hypotheses = _hypotheses_without_crc(device, variant, placed_layout, typed_frame)
        corrupted_bits = _find_corrupted_constant_bits(placed_layout, typed_frame)
        return diagnose_without_crc(device, hypotheses, missing_part, bits_to_invert=corrupted_bits)
    refuted = _refuted_hypotheses(placed_layout, crc, typed_frame)
    hypotheses = all_hypotheses(device, variant, placed_layout, crc, typed_frame)
    diagnosis = diagnose(device, hypotheses, refuted, [crc], with_pairs=with_pairs)
    if diagnosis is None or not diagnosis.explanations:
        missing_part = missing_part or _missing_digits_text(placed_layout, typed_frame)
    if diagnosis is None:
        return _only_missing(missing_part) if missing_part else None
    # There is a refuted hypothesis only if the frame can have the expected length.
    bits_to_invert = _bits_to_invert(placed_layout, crc, typed_frame.number) if refuted else []
    return replace(diagnosis, missing_part=missing_part, bits_to_invert=tuple(bits_to_invert))


def _bits_to_invert(placed_layout: PlacedLayout, crc: Crc, frame: int) -> list[int]:
    """Return the positions of the bits that make a frame valid if only this bit is inverted. The last bit is 0."""
    bits_to_invert: list[int] = []
    for bit in range(placed_layout.bits):
        changed_frame = frame ^ (1 << bit)
        if frame_hypothesis(kind="", description="", placed_layout=placed_layout, crc=crc, frame=changed_frame).fits:
            bits_to_invert.append(bit)
    return bits_to_invert


def _find_corrupted_constant_bits(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> tuple[int, ...]:
    """Return the positions of the bits that correct all constants and parity bits if only this bit is inverted.

    The last bit of the frame has the position 0. The tuple is empty if the constants and parity bits are correct, or if
    the frame cannot have the expected length.
    """
    frame = typed_frame.number
    _, are_correct = check_constant_bits(placed_layout, frame)
    if are_correct or not typed_frame.may_have_length(placed_layout.bits):
        return ()
    correcting_bits: list[int] = []
    for bit in range(placed_layout.bits):
        changed_frame = frame ^ (1 << bit)
        _, are_correct = check_constant_bits(placed_layout, changed_frame)
        if are_correct:
            correcting_bits.append(bit)
    return tuple(correcting_bits)


def _doubt_about_dead_line(placed_layout: PlacedLayout | None, crc: Crc | None, frame: int, is_valid: bool) -> str:
    """Return the reason why a frame whose bits are all equal may be a real frame, and not come from a dead line.

    The text continues a sentence: ``and the CRC is correct too``. It is empty if the CRC, a constant, or a parity bit
    of the frame is wrong.
    """
    if crc is not None:
        return TEXTS["crc_is_correct"] if is_valid else ""
    if placed_layout is None:
        return ""
    _, are_constants_correct = check_constant_bits(placed_layout, frame)
    return TEXTS["has_no_crc"] if are_constants_correct else ""


def _only_missing(missing_part: str) -> Diagnosis:
    """Return the diagnosis of an incomplete frame: only ``missing_part``, the text about the missing part."""
    return Diagnosis(
        explanations=(), tried_count=0, chance_of_match=0.0, undetectable_mistakes=(), missing_part=missing_part
    )


def _missing_part_text(device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame) -> str:
    """Return a text about the part that a recording of the line lacks, or an empty string if it contains a frame.

    It is also empty if the recording can have the length of the frame, or if the line carries bytes.
    """
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None or typed_frame.may_have_length(placed_layout.bits):
        return ""
    crc = device.crc_of(placed_layout)
    for hypothesis in moved_frame_hypotheses(device, variant, placed_layout, crc, typed_frame):
        # A frame that is searched at every bit does not count.
        is_found_by_rule = hypothesis.fits and hypothesis.kind != FRAME_INSIDE
        if is_found_by_rule and (hypothesis.crc is None or is_significant(hypothesis)):
            return ""
    missing_text = missing_part_text(line, placed_layout.bits, recorded_bits(typed_frame, placed_layout.bits))
    if not missing_text and typed_frame.is_bytes:
        missing_text = _missing_bytes_text(placed_layout, typed_frame.digit_bits)
    has_two_readings = bool(missing_text and typed_frame.text_with_zeros)
    return (
        TEXTS["zeros_left_out"].format(missing_text, typed_frame.text_with_zeros) if has_two_readings else missing_text
    )


def _missing_digits_text(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> str:
    """Return a text about the bytes of the frame that the user did not type, or an empty string.

    These bytes are treated as zeros.
    """
    has_known_digits = not typed_frame.is_length_known and typed_frame.digit_bits > 0
    if not has_known_digits:
        return ""
    missing_text = _missing_bytes_text(placed_layout, typed_frame.digit_bits)
    return TEXTS["read_as_zeros"].format(missing_text) if missing_text else ""


def _missing_bytes_text(placed_layout: PlacedLayout, received_bits: int) -> str:
    """Return a text about the number of missing bytes of a frame, or an empty string if none are missing."""
    received_bytes = (received_bits + 7) // 8  # rounded up
    frame_bytes = (placed_layout.bits + 7) // 8
    if received_bytes >= frame_bytes:
        return ""
    return TEXTS["bytes_missing"].format(
        received_bytes, frame_bytes, count_with_unit(frame_bytes - received_bytes, "byte")
    )


def _hypotheses_without_crc(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses for a frame without a CRC.

    It is surrounded by extra bits, truncated, rearranged, or from a different order code.
    """
    yield from moved_frame_hypotheses(device, variant, placed_layout, None, typed_frame)
    yield from rearranged_frame_hypotheses(variant, placed_layout, None, typed_frame)
    yield from other_order_code_hypotheses(device, variant, placed_layout, typed_frame)


def explain_constant(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Diagnosis | None:
    """Explain a wrong constant in a frame, or return None if no mistake matches.

    If the CRC is valid, a different answer to a question that the manual leaves open may apply, or the bits are moved
    or rearranged and the CRC is valid by chance. Without a CRC, bits are moved or rearranged, or one is corrupted.
    """
    crc = device.crc_of(placed_layout)
    if crc is None:
        hypotheses = _hypotheses_without_crc(device, variant, placed_layout, typed_frame)
        corrupted_bits = _find_corrupted_constant_bits(placed_layout, typed_frame)
        return diagnose_without_crc(device, hypotheses, missing_part="", bits_to_invert=corrupted_bits)
    answer_hypotheses = other_answer_hypotheses(device, variant, placed_layout, typed_frame)
    fitting_hypotheses = [hypothesis for hypothesis in answer_hypotheses if hypothesis.fits]
    frame_hypotheses = [
        *rearranged_frame_hypotheses(variant, placed_layout, crc, typed_frame),
        *moved_frame_hypotheses(device, variant, placed_layout, crc, typed_frame),
    ]
    fitting_frames = [hypothesis for hypothesis in frame_hypotheses if hypothesis.fits]
    fitting_hypotheses += unrefuted_significant_hypotheses(
        fitting_frames, _refuted_hypotheses(placed_layout, crc, typed_frame)
    )
    if not fitting_hypotheses:
        return None
    return diagnose(device, fitting_hypotheses, refuted=[], crcs=[crc])


def explain_bytes(
    device: Device,
    variant: Variant,
    sender: str,
    placed_layout: PlacedLayout | None,
    received_bytes: bytes,
    *,
    with_pairs: bool = False,
) -> Diagnosis | None:
    """Explain an error in a frame that is sent as bytes: list the mistakes that could have caused it.

    ``placed_layout`` is the layout that the bytes should have, or None if it is unknown. Return None if there is no
    mistake to try. If bytes are missing and nothing explains the error, the diagnosis contains only their number.
    Single corrupted bits are only searched if the layout is known and the length is correct. Pairs of mistakes are
    listed if no single mistake matches, and with ``with_pairs`` also if one does.
    """
    number = int.from_bytes(received_bytes, "big")
    crc = device.crc_of(placed_layout) if placed_layout is not None else None
    doubt = _doubt_about_dead_line(placed_layout, crc, number, is_valid=False)
    dead_line = _diagnose_equal_bits(variant, number, 8 * len(received_bytes), doubt)
    if dead_line is not None:
        return dead_line
    whole_frames: list[Hypothesis] = []
    if sender == "encoder":
        whole_frames = list(exchange_hypotheses(device, variant, received_bytes))
    hypotheses = [*whole_frames, *byte_hypotheses(device, variant, sender, placed_layout, received_bytes)]
    if _has_crc_in_bytes(device, variant, sender):
        diagnosis = _diagnose_with_crc(device, hypotheses, whole_frames, with_pairs=with_pairs)
    else:
        diagnosis = diagnose_without_crc(device, hypotheses, missing_part="")
    if placed_layout is None:
        return diagnosis
    missing_part = _missing_bytes_text(placed_layout, 8 * len(received_bytes))
    is_explained = diagnosis is not None and bool(diagnosis.explanations)
    if missing_part and not is_explained:
        return _only_missing(missing_part)
    if diagnosis is None or 8 * len(received_bytes) != placed_layout.bits:
        return diagnosis
    return replace(diagnosis, bits_to_invert=tuple(_bits_of_bytes_to_invert(device, placed_layout, received_bytes)))


def _diagnose_with_crc(
    device: Device, hypotheses: Sequence[Hypothesis], whole_frames: Sequence[Hypothesis], *, with_pairs: bool
) -> Diagnosis | None:
    """Return the diagnosis of bytes that end with a CRC.

    ``whole_frames`` are those of the hypotheses in which the bytes consist of several whole frames.
    """
    crc_names = dict.fromkeys(hypothesis.crc.name for hypothesis in hypotheses if hypothesis.crc is not None)
    crcs = [device.crc(name) for name in crc_names]
    # The user may not have answered the questions that the manual leaves open, so fields that depend on them are
    # omitted.
    undecided = frozenset(name for alternative in device.alternatives for name in alternative.answers[0].sets)
    repeated = [hypothesis for hypothesis in hypotheses if _repeats_frame(hypothesis, whole_frames)]
    return diagnose(
        device,
        [hypothesis for hypothesis in hypotheses if hypothesis not in repeated],
        refuted=[],
        crcs=crcs,
        undecided_parameters=undecided,
        with_pairs=with_pairs,
        repeated=repeated,
    )


def _has_crc_in_bytes(device: Device, variant: Variant, sender: str) -> bool:
    """Return whether the sender sends any frame as bytes that has a CRC."""
    for layout in device.interface(variant.interface).layouts:
        is_from_sender = layout.sender == sender and layout.in_bytes
        if is_from_sender and device.crc_of(layout.place(variant.parameters)) is not None:
            return True
    return False


def _repeats_frame(hypothesis: Hypothesis, whole_frames: Sequence[Hypothesis]) -> bool:
    """Return whether a hypothesis finds the same frame between extra bytes as a hypothesis of several whole frames.

    The latter is better, because it also explains the extra bytes.
    """
    if hypothesis in whole_frames or hypothesis.kind not in ("bytes_in_front", "bytes_behind"):
        return False
    frames_and_layouts = [(whole_frame.frame, whole_frame.frame_layout) for whole_frame in whole_frames]
    return (hypothesis.frame, hypothesis.frame_layout) in frames_and_layouts


def _bits_of_bytes_to_invert(device: Device, placed_layout: PlacedLayout, received_bytes: bytes) -> list[int]:
    """Return the positions of the bits that make the bytes a valid frame if only this bit is inverted.

    The last bit has the position 0.
    """
    bits_to_invert: list[int] = []
    number = int.from_bytes(received_bytes, "big")
    for bit in range(placed_layout.bits):
        changed_bytes = (number ^ (1 << bit)).to_bytes(len(received_bytes), "big")
        if is_valid_in_bytes(device, placed_layout, changed_bytes):
            bits_to_invert.append(bit)
    return bits_to_invert


def _refuted_hypotheses(placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame) -> Sequence[Hypothesis]:
    """Return the hypothesis without a mistake, which an invalid frame refutes, as a list.

    Other hypotheses that match the same frames are refuted with it. The list is empty if the frame cannot have the
    expected length.
    """
    is_too_long = typed_frame.bits > placed_layout.bits
    is_too_short = typed_frame.is_length_known and typed_frame.bits < placed_layout.bits
    if is_too_long or is_too_short:
        return []
    return [hypothesis_without_mistake(placed_layout, crc, typed_frame.number)]


def _diagnose_equal_bits(variant: Variant, number: int, bit_count: int, doubt: str) -> Diagnosis | None:
    """Explain a frame of at least 12 bits that are all equal: the line is dead. Return None for any other frame.

    ``doubt`` is the reason why the bits may be a real frame, or an empty string.
    """
    all_ones = (1 << bit_count) - 1
    if bit_count < LEAST_EQUAL_BITS or number not in (0, all_ones):
        return None
    level = 1 if number == all_ones else 0
    if doubt:
        explanation_text = TEXTS["line_may_be_stuck"].format(level, doubt)
    else:
        cause = "a broken wire" if level else "a short circuit"
        other_causes = "wires A and B" if variant.interface == Rs485.name else "the clock"
        explanation_text = TEXTS["line_stuck"].format(level, cause, other_causes)
    # The first bit can be 0 or 1, and all others must equal it.
    return _diagnosis_of_dead_line(explanation_text, bits_that_agree=bit_count - 1)


def _diagnose_zero_reply(
    variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Diagnosis | None:
    """Explain an SPI word with a right command and at least 12 zeros: nothing drives the line after the command.

    Return None for any other frame.
    """
    if variant.interface != Spi.name:
        return None
    data_bits = data_bits_of_zero_reply(placed_layout, crc, typed_frame)
    if data_bits < LEAST_EQUAL_BITS:
        return None
    return _diagnosis_of_dead_line(TEXTS["zero_reply"], bits_that_agree=data_bits)


def _diagnosis_of_dead_line(explanation_text: str, bits_that_agree: int) -> Diagnosis:
    """Return the diagnosis of a dead line, whose only explanation matches by chance if some bits agree."""
    # More than 62 bits do not make the explanation more certain.
    one_in = 1 << min(bits_that_agree, 62)
    frequency = MISTAKES["line_stuck"]
    explanation = Explanation(
        kind="line_stuck",
        text=explanation_text,
        one_in=one_in,
        score=frequency * one_in,
        frequency=frequency,
        numbers_read={},
    )
    return Diagnosis(explanations=(explanation,), tried_count=1, chance_of_match=1 / one_in, undetectable_mistakes=())


#: Fewest bits that the CRCs of all channels need together. Of 65,536 random frames, one has valid CRCs by chance.
LEAST_CRC_BITS = 16


def channel_readings(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield a text for each way to read ``bits`` received bits so that the CRCs of all channels are correct.

    The frame may have extra bits around it, or its channels may be in a different order. Nothing is yielded if the CRCs
    are so short that they would often be correct by chance.
    """
    crc_bits = sum(channel.crc_field.width for channel in frame.channels if channel.crc_field is not None)
    if crc_bits < LEAST_CRC_BITS:
        return
    yield from _readings_with_bits_around(device, frame, number, bits)
    if bits == frame.bits:
        yield from _readings_in_other_order(device, frame, number)


def _readings_with_bits_around(device: Device, frame: PlacedChannels, number: int, bits: int) -> Iterator[str]:
    """Yield a text for each place among the received bits at which all CRCs of the frame are correct.

    Nothing is yielded if there are no extra bits.
    """
    extra_bits = bits - frame.bits
    if extra_bits <= 0:
        return
    for bits_before in range(extra_bits + 1):
        bits_after = extra_bits - bits_before
        frame_bits = (number >> bits_after) & ((1 << frame.bits) - 1)
        if _is_valid_frame(device, frame, frame_bits):
            yield frame_texts.bits_around(f"{bits_before}", f"{bits_after}")


def _readings_in_other_order(device: Device, frame: PlacedChannels, number: int) -> Iterator[str]:
    """Yield a text for each different order of the channels with which all CRCs are correct."""
    for channels in permutations(frame.channels):
        other_frame = replace(frame, channels=channels)
        if channels != frame.channels and _is_valid_frame(device, other_frame, number):
            yield frame_texts.other_order(", ".join(channel.name for channel in channels))


def _is_valid_frame(device: Device, frame: PlacedChannels, number: int) -> bool:
    """Return whether no channel of the frame ``number`` has an error."""
    return not any(decoded.problems for decoded in decode_channels(device, frame, number))
