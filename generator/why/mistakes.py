"""Explain why a CRC fails by trying common mistakes.

For each mistake, the CRC is computed as if it had been made. All that match are listed, most likely first. A mistake
may match by coincidence: with a 6-bit CRC, one random frame in 64 does. So each explanation, and the list as a whole,
comes with its chance.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import prod

from ..model import Crc, Device, Number, PlacedLayout, Rs485, Variant
from ..model.record import dataclass
from ..reference import codec
from . import in_bytes
from .in_bits import as_sent, other_answers, tries
from .tries import MISTAKES, NOT_INVERTED, BitText, Try, read_as

#: A mistake that matches more than one random frame in eight explains nothing.
_LEAST_BITS = 3
#: Frames with fewer bits may be all zeros or all ones by coincidence.
_LEAST_STUCK = 12


@dataclass(frozen=True, slots=True)
class Explanation:
    """A mistake that would explain the CRC.

    It matches one of ``one_in`` random frames. ``reads`` are the numbers in the frame without the mistake, if that
    changes the frame. ``codes`` are the order codes that would send it. ``twice`` is true if two mistakes are needed.
    """

    kind: str
    text: str
    one_in: int
    score: float
    reads: Mapping[str, int]
    codes: tuple[str, ...] = ()
    twice: bool = False


@dataclass(frozen=True, slots=True)
class Why:
    """Explanations of a frame, most likely first.

    ``tried`` is the number of mistakes tried, pairs included. At least one of them matches the fraction ``coincidence``
    of random frames. ``cannot_see`` lists mistakes that a CRC of this kind cannot detect. ``disturbed`` are the bits,
    counted from the last as 0, that make the frame valid if one of them is inverted. Such noise is the usual cause if
    only some frames fail, but one frame cannot prove it: the CRC is short, and most random frames have such a bit.
    """

    explanations: tuple[Explanation, ...]
    tried: int
    coincidence: float
    cannot_see: tuple[str, ...]
    disturbed: tuple[int, ...] = ()


def explain_bits(
    device: Device, variant: Variant, placed: PlacedLayout, text: BitText, *, is_valid: bool = False
) -> Why | None:
    """Explain the wrong CRC of ``text``, which should be a frame of the layout ``placed``.

    Return None if the frame is valid or has no CRC, unless all its bits are equal.
    """
    crc = device.crc_of(placed.layout)
    doubt = "and there is no CRC to distinguish it" if crc is None else "and the CRC is correct too" * is_valid
    stuck = _explain_equal_bits(variant, text.number, text.bits if text.exact else max(text.bits, placed.bits), doubt)
    if stuck is not None:
        return stuck
    if crc is None or is_valid:
        return None
    failed = _known_to_fail(placed, crc, text)
    why = _why(device, tries(device, variant, placed, crc, text), failed, (crc,))
    bits = range(placed.bits) if failed else ()
    flips = (1 << bit for bit in bits)
    fits = [read_as("", "", placed, crc, text.number ^ flip).fits for flip in flips]
    return replace(why, disturbed=_fitting_bits(fits)) if why is not None else None


def explain_constant(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """Explain a valid CRC with a wrong constant by another answer to a question that the manual leaves open.

    Return None if no other answer matches.
    """
    crc = device.crc_of(placed.layout)
    if crc is None:
        return None
    fitting = [candidate for candidate in other_answers(device, variant, placed, crc, text) if candidate.fits]
    return _why(device, fitting, (), (crc,)) if fitting else None


def explain_bytes(
    device: Device, variant: Variant, sender: str, placed: PlacedLayout | None, data: bytes
) -> Why | None:
    """Explain the wrong CRC of ``data``, which should be a frame of the layout ``placed`` if that is known.

    Return None if there is no mistake to try.
    """
    number = int.from_bytes(data, "big")
    stuck = _explain_equal_bits(variant, number, 8 * len(data), "")
    if stuck is not None:
        return stuck
    attempts = list(in_bytes.tries(device, variant, sender, placed, data))
    crcs = tuple({attempt.crc.name: device.crc(attempt.crc.name) for attempt in attempts}.values())
    # For an unknown frame the user has not chosen anything, so values that depend on a choice are not read.
    undecided = frozenset(name for alternative in device.alternatives for name in alternative.answers[0].sets)
    why = _why(device, attempts, (), crcs, undecided)
    if why is None or placed is None or 8 * len(data) != placed.bits:
        return why
    flipped = ((number ^ 1 << bit).to_bytes(len(data), "big") for bit in range(placed.bits))
    return replace(why, disturbed=_fitting_bits([in_bytes.is_valid(device, placed, frame) for frame in flipped]))


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
) -> Why | None:
    single_tries = _distinct_tries(tries, failed)
    if not single_tries:
        return None
    explanations = [_explanation(device, attempt, undecided) for attempt in single_tries if attempt.fits]
    all_tries = single_tries
    if not explanations:
        # Try pairs only with the most common mistake, and only if no single one matches. More pairs would mostly match
        # by coincidence.
        pairs = [_not_inverted(attempt) for attempt in single_tries if attempt.kind != NOT_INVERTED]
        all_tries = _distinct_tries((*single_tries, *pairs), failed)
        fitting_pairs = [attempt for attempt in all_tries[len(single_tries) :] if attempt.fits]
        explanations = [_explanation(device, attempt, undecided) for attempt in fitting_pairs]
        explanations = [replace(explanation, twice=True) for explanation in explanations]
    explanations.sort(key=lambda explanation: -explanation.score)
    chances = {attempt.question: attempt.one_in for attempt in all_tries}
    coincidence = 1 - prod(1 - 1 / one_in for one_in in chances.values())
    blind = tuple(dict.fromkeys(text for crc in crcs for text in _blind_spots(crc)))
    return Why(tuple(explanations), len(all_tries), coincidence, blind)


def _distinct_tries(tries: Iterable[Try], failed: Sequence[Try]) -> list[Try]:
    """Return the significant tries, without those known to fail and without duplicates that lead to the same frame."""
    failed_questions = {attempt.question for attempt in failed}
    distinct_tries: dict[object, Try] = {}
    for attempt in tries:
        if attempt.known_bits + attempt.demanded >= _LEAST_BITS and attempt.question not in failed_questions:
            leads_to = (attempt.number, _places(attempt.placed)) if attempt.placed is not None else attempt.text
            distinct_tries.setdefault((attempt.question, leads_to), attempt)
    return list(distinct_tries.values())


def _places(placed: PlacedLayout) -> tuple[int, tuple[tuple[str, int], ...]]:
    """Return the length and the lowest bits of the fields, in which frames of one length can differ."""
    return placed.bits, tuple((placed_field.name, placed_field.low) for placed_field in placed.fields)


def _not_inverted(attempt: Try) -> Try:
    change = "not inverted" if attempt.crc.xorout else "inverted"
    return replace(
        attempt,
        text=f"{attempt.text}, and the CRC is {change}",
        crc=replace(attempt.crc, xorout=attempt.crc.xorout ^ attempt.crc.mask),
    )


def _explanation(device: Device, attempt: Try, undecided: frozenset[str]) -> Explanation:
    reads = _numbers_read(device, attempt.placed, attempt.number, undecided) if attempt.placed is not None else {}
    return Explanation(attempt.kind, attempt.text, attempt.one_in, attempt.score, reads, attempt.codes)


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
    if bits < _LEAST_STUCK or number not in (0, (1 << bits) - 1):
        return None
    level = 1 if number else 0
    if doubt:
        text = f"every bit is {level}. A dead line looks the same, {doubt}"
    else:
        cause = "a broken wire" if level else "a short circuit"
        other_causes = "wires A and B" if variant.interface == Rs485.name else "the clock"
        text = f"every bit is {level}: the line never changes. Check for {cause}, the supply and {other_causes}"
    one_in = 1 << min(bits - 1, 62)
    explanation = Explanation("line_stuck", text, one_in, MISTAKES["line_stuck"] * one_in, {})
    return Why((explanation,), 1, 1 / one_in, ())


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
