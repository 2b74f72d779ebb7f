"""Explain why a CRC fails by trying common mistakes.

For each mistake, the CRC is computed as if it had been made. All that match are listed, most likely first. A mistake
may match by coincidence: with a 6-bit CRC, one random frame in 64 does. So each explanation, and the list as a whole,
comes with its chance.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import prod

from ..model import (
    Crc,
    Device,
    Number,
    PlacedLayout,
    Rs485,
    Variant,
)
from ..model.record import dataclass
from ..reference import codec
from .exchanges import exchange_tries
from .in_bits import as_sent, moved_frames, other_answers, rearranged_frames, tries
from .in_bytes import is_valid_in_bytes, tries_with_bytes
from .recordings import FRAME_INSIDE, LINES, line_name, missing_part, recorded_bits
from .texts import TEXTS
from .tries import MISTAKES, NOT_INVERTED, BitText, Try, read_as

#: A mistake that matches more than one random frame in eight explains nothing.
_LEAST_BITS = 3
#: Frames with fewer bits may be all zeros or all ones by coincidence.
_LEAST_STUCK = 12
#: An explanation that matches fewer random frames than one in this many is as good as certain.
_CERTAIN = 1 << 16


@dataclass(frozen=True, slots=True)
class Explanation:
    """A mistake that would explain the CRC.

    It matches one of ``one_in`` random frames. ``reads`` are the numbers in the frame without the mistake, if that
    changes the frame. ``codes`` are the order codes that would send it. ``twice`` is true if two mistakes are needed.
    ``parts`` are the parts of a recording, each with its bits. ``template`` is the text without the details of this
    frame, if it has any.
    """

    kind: str
    text: str
    one_in: int
    score: float
    reads: Mapping[str, int]
    codes: tuple[str, ...] = ()
    twice: bool = False
    parts: tuple[tuple[str, str], ...] = ()
    template: str = ""

    @property
    def mistake(self) -> tuple[str, str, bool]:
        """Key of the mistake, which is the same for all frames with it."""
        return self.kind, self.template or self.text, self.twice


@dataclass(frozen=True, slots=True)
class Why:
    """Explanations of a frame, most likely first.

    ``tried`` is the number of mistakes tried, pairs included. At least one of them matches the fraction ``coincidence``
    of random frames. ``cannot_see`` lists mistakes that a CRC of this kind cannot detect. ``disturbed`` are the bits,
    counted from the last as 0, that make the frame valid if one of them is inverted. Such noise is the usual cause if
    only some frames fail, but one frame cannot prove it: the CRC is short, and most random frames have such a bit.
    ``unmerged`` has all that fit, also those that lead to the same frame as a likelier one.
    ``missing`` is the part that a recording without a complete frame lacks. ``has_crc`` is false if only constants,
    parity and the length can contradict a frame, so that nothing is certain.
    """

    explanations: tuple[Explanation, ...]
    tried: int
    coincidence: float
    cannot_see: tuple[str, ...]
    disturbed: tuple[int, ...] = ()
    missing: str = ""
    has_crc: bool = True
    unmerged: tuple[Explanation, ...] = ()

    @property
    def needs_another_frame(self) -> bool:
        """True if other frames with the same mistake would decide between the explanations."""
        if any(explanation.kind in ("line_stuck", "echo") for explanation in self.explanations):
            return False
        is_doubtful = bool(self.explanations) and self.explanations[0].one_in < _CERTAIN
        return is_doubtful or len(self.explanations) > 1


def explain_bits(
    device: Device,
    variant: Variant,
    placed: PlacedLayout,
    text: BitText,
    *,
    is_valid: bool = False,
    with_pairs: bool = False,
) -> Why | None:
    """Explain the wrong CRC of ``text``, which should be a frame of the layout ``placed``.

    ``with_pairs`` also lists pairs of mistakes if a single one matches.

    Return None if the frame is valid, unless all its bits are equal.
    """
    crc = device.crc_of(placed)
    bits = text.bits if text.exact else max(text.bits, placed.bits)
    stuck = _explain_equal_bits(variant, text.number, bits, _doubt_about_dead_line(crc, is_valid))
    if stuck is not None:
        return stuck
    if is_valid:
        return None
    missing = _missing_part(device, variant, placed, text)
    if crc is None:
        return _readings(device, _frames_without_crc(device, variant, placed, text), missing)
    failed = _known_to_fail(placed, crc, text)
    why = _why(device, tries(device, variant, placed, crc, text), failed, (crc,), with_pairs=with_pairs)
    if why is None:
        return _only_missing(missing) if missing else None
    why = replace(why, missing=missing)
    # Only a frame of the right length can be one with a disturbed bit.
    if not failed:
        return why
    fits = [read_as("", "", placed, crc, text.number ^ 1 << bit).fits for bit in range(placed.bits)]
    return replace(why, disturbed=_fitting_bits(fits))


def _doubt_about_dead_line(crc: Crc | None, is_valid: bool) -> str:
    """Return why a frame of equal bits may still be a frame, or an empty string if it cannot."""
    if crc is None:
        return "and there is no CRC to distinguish it"
    return "and the CRC is correct too" if is_valid else ""


def _only_missing(missing: str) -> Why:
    """Return the explanation of a recording that only lacks a part of the frame."""
    return Why(explanations=(), tried=0, coincidence=0.0, cannot_see=(), missing=missing)


def _missing_part(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> str:
    """Return what a recording of another length lacks, or an empty string if a rule of the line finds a frame."""
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None or text.may_have(placed.bits):
        return ""
    for attempt in moved_frames(device, variant, placed, device.crc_of(placed), text):
        is_found_by_rule = attempt.fits and attempt.kind != FRAME_INSIDE
        if is_found_by_rule and (attempt.crc is None or _is_significant(attempt)):
            return ""
    return missing_part(line, placed.bits, recorded_bits(text, placed.bits))


def _frames_without_crc(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Iterator[Try]:
    """Yield tries with a frame that has no CRC: with other bits around it, or with its bits or bytes rearranged."""
    yield from moved_frames(device, variant, placed, None, text)
    yield from rearranged_frames(placed, None, text)


def _readings(device: Device, tries: Iterable[Try], missing: str) -> Why | None:
    """Return the readings of a frame without a CRC, most likely first. Nothing proves one of them."""
    fitting_tries = sorted((attempt for attempt in tries if attempt.fits), key=lambda attempt: -attempt.score)
    unmerged = [_explanation(device, attempt, frozenset()) for attempt in fitting_tries]
    likeliest: dict[int, Explanation] = {}
    for attempt, explanation in zip(fitting_tries, unmerged, strict=True):
        likeliest.setdefault(attempt.number, explanation)
    if not likeliest and not missing:
        return None
    return Why(
        explanations=tuple(likeliest.values()),
        tried=len(likeliest),
        coincidence=1.0,
        cannot_see=(),
        missing=missing,
        has_crc=False,
        unmerged=tuple(unmerged),
    )


def explain_constant(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """Explain a wrong constant.

    With a valid CRC, this is another answer to a question that the manual leaves open, or the CRC of a moved or
    rearranged frame is valid by coincidence. Without a CRC, it is a moved or rearranged frame. Return None if nothing
    matches.
    """
    crc = device.crc_of(placed)
    if crc is None:
        return _readings(device, _frames_without_crc(device, variant, placed, text), "")
    fitting = [candidate for candidate in other_answers(device, variant, placed, text) if candidate.fits]
    moved = (*rearranged_frames(placed, crc, text), *moved_frames(device, variant, placed, crc, text))
    fitting += _significant_tries((frame for frame in moved if frame.fits), _known_to_fail(placed, crc, text))
    return _why(device, fitting, (), (crc,)) if fitting else None


def explain_bytes(
    device: Device, variant: Variant, sender: str, placed: PlacedLayout | None, data: bytes
) -> Why | None:
    """Explain the wrong CRC of ``data``, which should be a frame of the layout ``placed`` if that is known.

    Return None if there is no mistake to try.
    """
    number = int.from_bytes(data, "big")
    stuck = _explain_equal_bits(variant, number, 8 * len(data), doubt="")
    if stuck is not None:
        return stuck
    exchanges = list(exchange_tries(device, variant, data)) if sender == "encoder" else []
    attempts = list(tries_with_bytes(device, variant, sender, placed, data))
    if exchanges:
        # The extra bytes are known, so they are not explained again.
        attempts = [attempt for attempt in attempts if attempt.kind not in ("bytes_in_front", "bytes_behind")]
    attempts = [*exchanges, *attempts]
    crc_names = dict.fromkeys(attempt.crc.name for attempt in attempts if attempt.crc is not None)
    crcs = [device.crc(name) for name in crc_names]
    # For an unknown frame the user has not chosen anything, so values that depend on a choice are not read.
    undecided = frozenset(name for alternative in device.alternatives for name in alternative.answers[0].sets)
    why = _why(device, attempts, (), crcs, undecided)
    if why is None or placed is None or 8 * len(data) != placed.bits:
        return why
    frames_with_flip = [(number ^ 1 << bit).to_bytes(len(data), "big") for bit in range(placed.bits)]
    return replace(
        why, disturbed=_fitting_bits([is_valid_in_bytes(device, placed, frame) for frame in frames_with_flip])
    )


def _fitting_bits(fits: Sequence[bool]) -> tuple[int, ...]:
    return tuple(bit for bit, does_fit in enumerate(fits) if does_fit)


def _known_to_fail(placed: PlacedLayout, crc: Crc, text: BitText) -> tuple[Try, ...]:
    """Return the frame as given. It is known not to match, so equivalent mistakes need not be tried."""
    if text.bits > placed.bits or (text.exact and text.bits != placed.bits):
        return ()
    return (as_sent(placed, crc, text.number),)


def _why(
    device: Device,
    tries: Iterable[Try],
    failed: Sequence[Try],
    crcs: Sequence[Crc],
    undecided: frozenset[str] = frozenset(),
    with_pairs: bool = False,
) -> Why | None:
    """Return the explanations among the tries, without those known as ``failed``, or None if there is no try."""
    significant_tries = _significant_tries(tries, failed)
    single_tries = _distinct_tries(significant_tries)
    if not single_tries:
        return None
    explanations = [_explanation(device, attempt, undecided) for attempt in single_tries if attempt.fits]
    unmerged = [_explanation(device, attempt, undecided) for attempt in significant_tries if attempt.fits]
    all_tries = single_tries
    # More pairs would mostly match by coincidence, so they are only tried if no single mistake matches.
    is_unexplained = all(explanation.kind == FRAME_INSIDE for explanation in explanations)
    if with_pairs or is_unexplained:
        pairs = _significant_tries(_pairs(significant_tries), failed)
        all_tries = _distinct_tries((*single_tries, *pairs))
        explanations += _twice_explanations(device, all_tries[len(single_tries) :], undecided)
        unmerged += _twice_explanations(device, pairs, undecided)
    explanations.sort(key=lambda explanation: -explanation.score)
    unmerged.sort(key=lambda explanation: -explanation.score)
    chances = {attempt.question: attempt.one_in for attempt in all_tries}
    blind_spots: dict[str, None] = {}
    for crc in crcs:
        blind_spots.update(dict.fromkeys(_blind_spots(crc)))
    return Why(
        explanations=tuple(explanations),
        tried=len(all_tries),
        coincidence=1 - prod(1 - 1 / one_in for one_in in chances.values()),
        cannot_see=tuple(blind_spots),
        unmerged=tuple(unmerged),
    )


def _twice_explanations(device: Device, pairs: Iterable[Try], undecided: frozenset[str]) -> list[Explanation]:
    """Return the explanations by two mistakes."""
    return [replace(_explanation(device, pair, undecided), twice=True) for pair in pairs if pair.fits]


def _pairs(single_tries: Iterable[Try]) -> Iterator[Try]:
    """Yield the tries together with the most common mistake, a CRC that is inverted or not."""
    for attempt in single_tries:
        if attempt.crc is not None and attempt.kind not in (NOT_INVERTED, FRAME_INSIDE):
            yield _not_inverted(attempt)


def _is_significant(attempt: Try) -> bool:
    return attempt.known_bits + attempt.demanded >= _LEAST_BITS


def _significant_tries(tries: Iterable[Try], failed: Sequence[Try]) -> list[Try]:
    """Return the tries that do not match too many random frames, without those known to fail."""
    failed_questions = {attempt.question for attempt in failed}
    return [attempt for attempt in tries if _is_significant(attempt) and attempt.question not in failed_questions]


def _distinct_tries(tries: Iterable[Try]) -> list[Try]:
    """Return one of the tries that lead to the same frame."""
    distinct_tries: dict[object, Try] = {}
    for attempt in tries:
        # A mistake that does not change the frame leads to its text.
        leads_to: object = attempt.text
        if attempt.placed is not None:
            leads_to = attempt.number, _places(attempt.placed)
        key = attempt.question, leads_to
        earlier = distinct_tries.get(key)
        if earlier is None or (attempt.holds, attempt.score) > (earlier.holds, earlier.score):
            distinct_tries[key] = attempt
    return list(distinct_tries.values())


def _places(placed: PlacedLayout) -> tuple[int, tuple[tuple[str, int], ...]]:
    """Return the length and the lowest bits of the fields, in which frames of one length can differ."""
    return placed.bits, tuple((placed_field.name, placed_field.low) for placed_field in placed.fields)


def _not_inverted(attempt: Try) -> Try:
    assert attempt.crc is not None
    change = "not_inverted_too" if attempt.crc.xorout else "inverted_too"
    template = TEXTS[change].format(attempt.template) if attempt.template else ""
    return replace(
        attempt,
        text=TEXTS[change].format(attempt.text),
        template=template,
        crc=replace(attempt.crc, xorout=attempt.crc.xorout ^ attempt.crc.mask),
    )


def _explanation(device: Device, attempt: Try, undecided: frozenset[str]) -> Explanation:
    reads: Mapping[str, int] = {}
    if attempt.placed is not None:
        reads = _numbers_read(device, attempt.placed, attempt.number, undecided)
    return Explanation(
        kind=attempt.kind,
        text=attempt.text,
        one_in=attempt.one_in,
        score=attempt.score,
        reads=reads,
        codes=attempt.codes,
        parts=attempt.parts,
        template=attempt.template,
    )


def _numbers_read(device: Device, placed: PlacedLayout, number: int, undecided: frozenset[str]) -> dict[str, int]:
    """Return the numbers in a frame, except those at bits that depend on undecided parameters."""
    reads: dict[str, int] = {}
    fields = {placed_field.name: placed_field.field for placed_field in placed.fields}
    for decoded_field in codec.decode(device, placed, number).fields:
        field = fields.get(decoded_field.name)
        if field is None or not isinstance(field.kind, Number) or not isinstance(decoded_field.value, int):
            continue
        if undecided.isdisjoint(field.low.parameters):
            reads[decoded_field.name] = decoded_field.value
    return reads


def _explain_equal_bits(variant: Variant, number: int, bits: int, doubt: str) -> Why | None:
    """Explain a frame whose bits are all equal. No other mistake is tried for such a frame.

    ``doubt`` is the reason why nothing proves that the line is dead.
    """
    all_ones = (1 << bits) - 1
    if bits < _LEAST_STUCK or number not in (0, all_ones):
        return None
    level = 1 if number == all_ones else 0
    if doubt:
        text = f"every bit is {level}. A dead line looks the same, {doubt}"
    else:
        cause = "a broken wire" if level else "a short circuit"
        other_causes = "wires A and B" if variant.interface == Rs485.name else "the clock"
        text = f"every bit is {level}: the line never changes. Check for {cause}, the supply and {other_causes}"
    # The first bit can be either level.
    one_in = 1 << min(bits - 1, 62)
    explanation = Explanation("line_stuck", text, one_in, score=MISTAKES["line_stuck"] * one_in, reads={})
    return Why((explanation,), tried=1, coincidence=1 / one_in, cannot_see=())


def _blind_spots(crc: Crc) -> list[str]:
    mistakes = []
    if crc.is_xor:
        mistakes.append("swapped bytes, or reversed bits in every byte (it is the XOR of the bytes)")
        mistakes.append("missing or extra bytes of 0")
    elif crc.init == 0:
        mistakes.append(
            "missing or extra leading zeros, such as those of a wider or narrower order code (its start value is 0)"
        )
    mistakes.append("wrong field boundaries, or Gray code mistaken for binary")
    return mistakes
