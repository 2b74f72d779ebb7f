"""Explain why a CRC fails by trying common mistakes.

For each mistake, the CRC is computed as if it had been made. All that match are listed, most likely first. A mistake
may match by coincidence: with a 6-bit CRC, one random frame in 64 does. So each explanation, and the list as a whole,
states its chance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..model import Crc, Device, PlacedLayout, Rs485, Variant
from ..say.plain_text import count_with_unit
from .diagnosis import (
    Diagnosis,
    Explanation,
    diagnose,
    diagnose_without_crc,
    is_significant,
    significant_hypotheses,
)
from .exchanges import exchange_hypotheses
from .hypotheses import LEAST_EQUAL_BITS, MISTAKES, Hypothesis, TypedFrame, check_constant_bits, frame_hypothesis
from .in_bits import (
    all_hypotheses,
    moved_frame_hypotheses,
    other_answer_hypotheses,
    rearranged_frame_hypotheses,
)
from .in_bytes import byte_hypotheses, is_valid_in_bytes
from .other_crcs import hypothesis_without_mistake
from .recordings import FRAME_INSIDE, LINES, line_name, missing_part, recorded_bits
from .texts import TEXTS


def explain_bits(
    device: Device,
    variant: Variant,
    placed_layout: PlacedLayout,
    typed_frame: TypedFrame,
    *,
    is_valid: bool = False,
    with_pairs: bool = False,
) -> Diagnosis | None:
    """Explain the wrong CRC of the typed frame, which should have the layout ``placed_layout``.

    Return None if the frame is valid, unless all its bits are equal, and if nothing could be tried and nothing is
    missing. ``with_pairs`` also lists pairs of mistakes if a single one matches.
    """
    crc = device.crc_of(placed_layout)
    # A number without leading zeros is at least as long as the expected frame.
    frame_length = typed_frame.bits if typed_frame.exact else max(typed_frame.bits, placed_layout.bits)
    doubt = _doubt_about_dead_line(placed_layout, crc, typed_frame.number, is_valid)
    dead_line = _diagnose_equal_bits(variant, typed_frame.number, frame_length, doubt)
    if dead_line is not None:
        return dead_line
    if is_valid:
        return None
    missing = _missing_part(device, variant, placed_layout, typed_frame)
    if crc is None:
        hypotheses = _hypotheses_without_crc(device, variant, placed_layout, typed_frame)
        disturbed = _disturbed_constants(placed_layout, typed_frame)
        return diagnose_without_crc(device, hypotheses, missing, disturbed)
    refuted = _refuted_hypotheses(placed_layout, crc, typed_frame)
    hypotheses = all_hypotheses(device, variant, placed_layout, crc, typed_frame)
    diagnosis = diagnose(device, hypotheses, refuted, [crc], with_pairs=with_pairs)
    is_explained = diagnosis is not None and bool(diagnosis.explanations)
    # A number may lack its leading zeros, but bytes are complete.
    if typed_frame.is_bytes or not is_explained:
        missing = missing or _missing_digits(placed_layout, typed_frame)
    if diagnosis is None:
        return _only_missing(missing) if missing else None
    disturbed_bits: list[int] = []
    # There is a refuted hypothesis only if the frame can have the expected length.
    has_frame_length = bool(refuted)
    if has_frame_length:
        disturbed_bits = _bits_to_invert(placed_layout, crc, typed_frame.number)
    return replace(diagnosis, missing=missing, disturbed=tuple(disturbed_bits))


def _bits_to_invert(placed_layout: PlacedLayout, crc: Crc, frame: int) -> list[int]:
    """Return the bits, counted from the last as 0, of which each makes the frame valid if it alone is inverted."""
    bits_to_invert: list[int] = []
    for bit in range(placed_layout.bits):
        frame_with_flip = frame ^ (1 << bit)
        if frame_hypothesis("", "", placed_layout, crc, frame_with_flip).fits:
            bits_to_invert.append(bit)
    return bits_to_invert


def _disturbed_constants(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> tuple[int, ...]:
    """Return the bits of which each, if inverted, makes wrong constants and a wrong parity of the frame right."""
    frame = typed_frame.number
    _, are_right = check_constant_bits(placed_layout, frame)
    if are_right or not typed_frame.may_have(placed_layout.bits):
        return ()
    return tuple(bit for bit in range(placed_layout.bits) if check_constant_bits(placed_layout, frame ^ (1 << bit))[1])


def _doubt_about_dead_line(placed_layout: PlacedLayout | None, crc: Crc | None, frame: int, is_valid: bool) -> str:
    """Return why a frame of equal bits may still be a frame, or "" if its CRC, a constant or a parity is wrong.

    The text continues a sentence: ``and the CRC is correct too``. Without a CRC, the length alone proves nothing.
    """
    if crc is not None:
        return TEXTS["crc_is_correct"] if is_valid else ""
    if placed_layout is None:
        return ""
    _, are_constants_right = check_constant_bits(placed_layout, frame)
    return TEXTS["has_no_crc"] if are_constants_right else ""


def _only_missing(missing: str) -> Diagnosis:
    """Return the diagnosis of a recording that only lacks a part of the frame."""
    return Diagnosis(explanations=(), tried=0, coincidence=0.0, cannot_see=(), missing=missing)


def _missing_part(device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame) -> str:
    """Return what a recording of another length lacks, or "" if a rule of the line finds a frame in it.

    It is also empty if the frame may have the right length, or if the line carries bytes.
    """
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None or typed_frame.may_have(placed_layout.bits):
        return ""
    crc = device.crc_of(placed_layout)
    for hypothesis in moved_frame_hypotheses(device, variant, placed_layout, crc, typed_frame):
        is_found_by_rule = hypothesis.fits and hypothesis.kind != FRAME_INSIDE
        if is_found_by_rule and (hypothesis.crc is None or is_significant(hypothesis)):
            return ""
    return missing_part(line, placed_layout.bits, recorded_bits(typed_frame, placed_layout.bits))


def _missing_digits(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> str:
    """Return how many bytes of the frame were not typed, so that they were read as zeros, or an empty string."""
    has_known_digits = not typed_frame.exact and typed_frame.written > 0
    if not has_known_digits:
        return ""
    missing = _missing_bytes(placed_layout, typed_frame.written)
    return TEXTS["read_as_zeros"].format(missing) if missing else ""


def _missing_bytes(placed_layout: PlacedLayout, received_bits: int) -> str:
    """Return how many bytes of the frame are missing, or an empty string. Its last bits fill a whole byte."""
    received_bytes, frame_bytes = -(-received_bits // 8), -(-placed_layout.bits // 8)
    if received_bytes >= frame_bytes:
        return ""
    return TEXTS["bytes_missing"].format(
        received_bytes, frame_bytes, count_with_unit(frame_bytes - received_bytes, "byte")
    )


def _hypotheses_without_crc(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses with a frame without a CRC: with other bits around it, or with its bits or bytes rearranged."""
    yield from moved_frame_hypotheses(device, variant, placed_layout, None, typed_frame)
    yield from rearranged_frame_hypotheses(variant, placed_layout, None, typed_frame)


def explain_constant(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Diagnosis | None:
    """Explain a wrong constant, or return None if nothing matches.

    With a valid CRC, this is another answer to a question that the manual leaves open, or the CRC of a moved or
    rearranged frame is valid by coincidence. Without a CRC, it is a moved or rearranged frame, or a bit is disturbed.
    """
    crc = device.crc_of(placed_layout)
    if crc is None:
        hypotheses = _hypotheses_without_crc(device, variant, placed_layout, typed_frame)
        disturbed = _disturbed_constants(placed_layout, typed_frame)
        return diagnose_without_crc(device, hypotheses, missing="", disturbed=disturbed)
    answer_hypotheses = other_answer_hypotheses(device, variant, placed_layout, typed_frame)
    fitting_hypotheses = [hypothesis for hypothesis in answer_hypotheses if hypothesis.fits]
    frame_hypotheses = [
        *rearranged_frame_hypotheses(variant, placed_layout, crc, typed_frame),
        *moved_frame_hypotheses(device, variant, placed_layout, crc, typed_frame),
    ]
    fitting_frames = [hypothesis for hypothesis in frame_hypotheses if hypothesis.fits]
    fitting_hypotheses += significant_hypotheses(fitting_frames, _refuted_hypotheses(placed_layout, crc, typed_frame))
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
    """Explain the wrong CRC of ``received_bytes``, which should be a frame of the layout ``placed_layout`` if that is
    known.

    ``with_pairs`` also lists pairs of mistakes if a single one matches.

    Return None if there is no mistake to try. If nothing explains too few bytes, only their number is the diagnosis.
    Single bits that would make the frame valid are only searched if the layout is known and has the length of the data.
    """
    number = int.from_bytes(received_bytes, "big")
    crc = device.crc_of(placed_layout) if placed_layout is not None else None
    doubt = _doubt_about_dead_line(placed_layout, crc, number, is_valid=False)
    dead_line = _diagnose_equal_bits(variant, number, 8 * len(received_bytes), doubt)
    if dead_line is not None:
        return dead_line
    # Only what an encoder sends is searched for whole frames.
    whole_frames = list(exchange_hypotheses(device, variant, received_bytes)) if sender == "encoder" else []
    hypotheses = [*whole_frames, *byte_hypotheses(device, variant, sender, placed_layout, received_bytes)]
    if _has_crc_in_bytes(device, variant, sender):
        diagnosis = _diagnose_with_crc(device, hypotheses, whole_frames, with_pairs=with_pairs)
    else:
        diagnosis = diagnose_without_crc(device, hypotheses, missing="")
    if placed_layout is None:
        return diagnosis
    missing = _missing_bytes(placed_layout, 8 * len(received_bytes))
    is_explained = diagnosis is not None and bool(diagnosis.explanations)
    if missing and not is_explained:
        return _only_missing(missing)
    if diagnosis is None or 8 * len(received_bytes) != placed_layout.bits:
        return diagnosis
    return replace(diagnosis, disturbed=tuple(_bits_of_bytes_to_invert(device, placed_layout, received_bytes)))


def _diagnose_with_crc(
    device: Device, hypotheses: Sequence[Hypothesis], whole_frames: Sequence[Hypothesis], *, with_pairs: bool
) -> Diagnosis | None:
    """Return the diagnosis of bytes by the CRCs of the hypotheses, of which ``whole_frames`` explain extra bytes."""
    crc_names = dict.fromkeys(hypothesis.crc.name for hypothesis in hypotheses if hypothesis.crc is not None)
    crcs = [device.crc(name) for name in crc_names]
    # For an unknown frame the user has not chosen anything, so values that depend on an answer are not read.
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
    """Return whether any frame in bytes from the sender has a CRC."""
    for layout in device.interface(variant.interface).layouts:
        is_from_sender = layout.sender == sender and layout.in_bytes
        if is_from_sender and device.crc_of(layout.place(variant.parameters)) is not None:
            return True
    return False


def _repeats_frame(hypothesis: Hypothesis, whole_frames: Sequence[Hypothesis]) -> bool:
    """Return whether the hypothesis explains extra bytes although whole frames already explain them, by this frame."""
    if hypothesis in whole_frames or hypothesis.kind not in ("bytes_in_front", "bytes_behind"):
        return False
    frames_and_layouts = [(whole_frame.frame, whole_frame.frame_layout) for whole_frame in whole_frames]
    return (hypothesis.frame, hypothesis.frame_layout) in frames_and_layouts


def _bits_of_bytes_to_invert(device: Device, placed_layout: PlacedLayout, received_bytes: bytes) -> list[int]:
    """Return the bits, counted from the last as 0, of which each makes the frame valid if it alone is inverted."""
    bits_to_invert: list[int] = []
    number = int.from_bytes(received_bytes, "big")
    for bit in range(placed_layout.bits):
        frame_with_flip = (number ^ (1 << bit)).to_bytes(len(received_bytes), "big")
        if is_valid_in_bytes(device, placed_layout, frame_with_flip):
            bits_to_invert.append(bit)
    return bits_to_invert


def _refuted_hypotheses(placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame) -> Sequence[Hypothesis]:
    """Return the hypothesis that there is no mistake, or nothing if the frame cannot have the expected length.

    The frame is known to be invalid, so this does not match, and mistakes that match the same frames need not be tried.
    """
    is_too_short = typed_frame.exact and typed_frame.bits < placed_layout.bits
    if typed_frame.bits > placed_layout.bits or is_too_short:
        return []
    return [hypothesis_without_mistake(placed_layout, crc, typed_frame.number)]


def _diagnose_equal_bits(variant: Variant, number: int, bit_count: int, doubt: str) -> Diagnosis | None:
    """Explain a frame of at least 12 bits that are all equal, or return None for any other frame.

    No other mistake is tried for such a frame. ``doubt`` is the reason why nothing proves that the line is dead, or "".
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
    # The first bit can be either level, and the others must have the same. One in 2^62 is enough to be certain.
    bits_that_agree = min(bit_count - 1, 62)
    one_in = 1 << bits_that_agree
    score = MISTAKES["line_stuck"] * one_in
    explanation = Explanation(kind="line_stuck", text=explanation_text, one_in=one_in, score=score, reads={})
    return Diagnosis(explanations=(explanation,), tried=1, coincidence=1 / one_in, cannot_see=())
