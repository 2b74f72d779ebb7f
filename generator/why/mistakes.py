"""Explain why a CRC fails by trying common mistakes, also those with a frame of bytes on RS-485.

For each mistake, the CRC is computed as if it had been made. All that match are listed, most likely first. A mistake
may match by coincidence: with a 6-bit CRC, one random frame in 64 does. So each explanation, and the list as a whole,
comes with its chance.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import prod

from ..model import (
    Constant,
    Crc,
    Device,
    Number,
    Parity,
    PlacedLayout,
    Rs485,
    Variant,
    number_from_bytes,
    number_to_bytes,
)
from ..model.record import dataclass
from ..reference import codec
from ..reference.bits import parity_bit
from .exchanges import exchange_tries
from .in_bits import POLYNOMIALS, OtherCrc, as_sent, moved_frames, other_answers, tries
from .recordings import FRAME_INSIDE, LINES, line_name, missing_part, recorded_bits
from .tries import MISTAKES, NOT_INVERTED, BitText, Try, read_as

#: More extra bytes than this do not come from an echoed request.
_MOST_MORE = 4


def tries_with_bytes(
    device: Device, variant: Variant, sender: str, expected: PlacedLayout | None, data: bytes
) -> Iterator[Try]:
    """Yield every single mistake that could have turned a valid frame of the sender into ``data``.

    ``expected`` is the layout of ``data``, or None if that is not known.
    """
    for layout in device.interface(variant.interface).layouts:
        if layout.sender != sender or not layout.in_bytes:
            continue
        placed = layout.place(variant.parameters)
        crc = device.crc_of(placed.layout)
        if crc is None or crc.width != 8:
            continue
        if expected is not None and expected.name == placed.name and 8 * len(data) == placed.bits:
            yield from _computed_otherwise(placed, crc, data)
        yield from _moved_byte_tries(placed, crc, data)


def is_valid(device: Device, placed: PlacedLayout, data: bytes) -> bool:
    """Return whether the CRC and the constants of the frame are correct."""
    crc = device.crc_of(placed.layout)
    return crc is not None and crc.width == 8 and _read_as("", "", placed, crc, data).fits


def _computed_otherwise(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """Yield tries of the frame as sent with another CRC."""
    try_as_sent = _over_bytes(as_sent(placed, crc, number_from_bytes(placed.layout, data)), data)
    for kind, description, other_crc in other_crcs(crc):
        yield replace(try_as_sent, kind=kind, text=description, crc=other_crc)
    without_first_byte = int.from_bytes(data[1:-1], "big")
    yield replace(
        try_as_sent,
        kind="first_byte_left_out",
        text="the CRC does not cover the first byte",
        data=without_first_byte,
        bits=try_as_sent.bits - 8,
    )


def other_crcs(crc: Crc) -> Iterator[OtherCrc]:
    """Yield the CRC with its inversion changed, with another start value, or with another polynomial of its length."""
    change = "the CRC is inverted" if not crc.xorout else "the CRC is not inverted"
    # With x^8 + 1 a start value only adds itself to the result.
    remark = f", or its start value is {crc.mask ^ crc.init:#x} (the same here)" if crc.is_xor else ""
    yield NOT_INVERTED, change + remark, replace(crc, xorout=crc.xorout ^ crc.mask)
    for start in () if crc.is_xor else sorted({0, crc.mask} - {crc.init}):
        yield "start_value", f"the start value of the CRC is {start:#x}", replace(crc, init=start)
    for polynomial in POLYNOMIALS:
        if polynomial.bit_length() == 9:
            for reflected in (False, True):
                description = (
                    f"the polynomial is {polynomial:#x}, {'least' if reflected else 'most'} significant bit first"
                )
                yield (
                    "other_polynomial",
                    description,
                    replace(crc, poly=polynomial & 0xFF, refin=reflected, refout=reflected),
                )


def _moved_byte_tries(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """Yield tries in which the bytes do not begin and end with the frame, or are inverted."""
    size = placed.bits // 8
    extra_bytes = len(data) - size
    if 0 < extra_bytes <= _MOST_MORE:
        plural = f"{extra_bytes} extra bytes" if extra_bytes > 1 else "an extra byte"
        description = f"{plural} before the frame, such as an echo of the request"
        yield _read_as("bytes_in_front", description, placed, crc, data[extra_bytes:])
        yield _read_as("bytes_behind", f"{plural} after the frame", placed, crc, data[:size])
    if extra_bytes in (-1, 0):
        for first in _first_bytes(placed):
            behind = "" if extra_bytes else ", and an extra byte follows the frame"
            description = f"the first byte ({first:02X}) is missing{behind}"
            yield _read_as("first_byte_lost", description, placed, crc, bytes([first, *data[: size - 1]]))
    if extra_bytes == 0:
        yield _read_as("all_inverted", "every bit is inverted", placed, crc, bytes(byte ^ 0xFF for byte in data))


def _read_as(kind: str, description: str, placed: PlacedLayout, crc: Crc, data: bytes) -> Try:
    return _over_bytes(read_as(kind, description, placed, crc, number_from_bytes(placed.layout, data)), data)


def _over_bytes(try_as_sent: Try, data: bytes) -> Try:
    """Return the try with the CRC over the bytes as sent, independent of the byte order of the number."""
    return replace(try_as_sent, data=int.from_bytes(data[:-1], "big"), received=data[-1], by_bytes=True)


def _first_bytes(placed: PlacedLayout) -> Iterator[int]:
    """Yield the possible first bytes of a frame, if that byte only identifies the layout."""
    first = number_from_bytes(placed.layout, bytes([0xFF, *bytes(placed.bits // 8 - 1)]))
    first_fields = [placed_field for placed_field in placed.fields if first >> placed_field.low & placed_field.mask]
    selector = placed.layout.selector
    other_fields = [placed_field for placed_field in first_fields if placed_field.name != selector]
    if not all(isinstance(placed_field.field.kind, (Constant, Parity)) for placed_field in other_fields):
        return
    for selected in placed.layout.selects:
        number = 0
        for placed_field in first_fields:
            if placed_field.name == selector:
                number |= selected << placed_field.low
            elif isinstance(placed_field.field.kind, Constant):
                number |= placed_field.field.kind.value << placed_field.low
        for placed_field in first_fields:
            if isinstance(placed_field.field.kind, Parity):
                number |= parity_bit(placed, placed_field.field.kind, number) << placed_field.low
        yield number_to_bytes(placed.layout, number, placed.bits)[0]


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
    crc = device.crc_of(placed.layout)
    doubt = "and there is no CRC to distinguish it" if crc is None else "and the CRC is correct too" * is_valid
    stuck = _explain_equal_bits(variant, text.number, text.bits if text.exact else max(text.bits, placed.bits), doubt)
    if stuck is not None:
        return stuck
    if is_valid:
        return None
    missing = _missing_part(device, variant, placed, text)
    if crc is None:
        return _readings(device, moved_frames(device, variant, placed, crc, text), missing)
    failed = _known_to_fail(placed, crc, text)
    why = _why(device, tries(device, variant, placed, crc, text), failed, (crc,), with_pairs=with_pairs)
    if why is None:
        return Why((), 0, 0.0, (), missing=missing) if missing else None
    why = replace(why, missing=missing)
    bits = range(placed.bits) if failed else ()
    flips = (1 << bit for bit in bits)
    fits = [read_as("", "", placed, crc, text.number ^ flip).fits for flip in flips]
    return replace(why, disturbed=_fitting_bits(fits))


def _missing_part(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> str:
    """Return what a recording of another length lacks, or an empty string if a rule of the line finds a frame."""
    line = LINES.get(line_name(device.interface(variant.interface)))
    has_frame_length = text.bits == placed.bits if text.exact else text.bits <= placed.bits
    if line is None or has_frame_length:
        return ""
    attempts = moved_frames(device, variant, placed, device.crc_of(placed.layout), text)
    by_rule = (attempt for attempt in attempts if attempt.fits and attempt.kind != FRAME_INSIDE)
    if any(attempt.crc is None or _is_significant(attempt) for attempt in by_rule):
        return ""
    return missing_part(line, placed.bits, recorded_bits(text, placed.bits))


def _readings(device: Device, tries: Iterable[Try], missing: str) -> Why | None:
    """Return the readings of a frame without a CRC, most likely first. Nothing proves one of them."""
    fitting_tries = sorted((attempt for attempt in tries if attempt.fits), key=lambda attempt: -attempt.score)
    likeliest_tries = {attempt.number: attempt for attempt in reversed(fitting_tries)}
    readings = (attempt for attempt in fitting_tries if likeliest_tries[attempt.number] is attempt)
    explanations = [_explanation(device, attempt, frozenset()) for attempt in readings]
    if not explanations and not missing:
        return None
    return Why(tuple(explanations), len(explanations), 1.0, (), missing=missing, has_crc=False)


def explain_constant(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """Explain a wrong constant.

    With a valid CRC, this is another answer to a question that the manual leaves open. Without a CRC, it is a frame
    that was read one clock early or late. Return None if nothing matches.
    """
    crc = device.crc_of(placed.layout)
    if crc is None:
        return _readings(device, moved_frames(device, variant, placed, crc, text), "")
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
    exchanges = list(exchange_tries(device, variant, data)) if sender == "encoder" else []
    attempts = list(tries_with_bytes(device, variant, sender, placed, data))
    if exchanges:
        # The extra bytes are known, so they are not explained again.
        attempts = [attempt for attempt in attempts if attempt.kind not in ("bytes_in_front", "bytes_behind")]
    attempts = [*exchanges, *attempts]
    crc_names = dict.fromkeys(attempt.crc.name for attempt in attempts if attempt.crc is not None)
    crcs = tuple(map(device.crc, crc_names))
    # For an unknown frame the user has not chosen anything, so values that depend on a choice are not read.
    undecided = frozenset(name for alternative in device.alternatives for name in alternative.answers[0].sets)
    why = _why(device, attempts, (), crcs, undecided)
    if why is None or placed is None or 8 * len(data) != placed.bits:
        return why
    flipped = ((number ^ 1 << bit).to_bytes(len(data), "big") for bit in range(placed.bits))
    return replace(why, disturbed=_fitting_bits([is_valid(device, placed, frame) for frame in flipped]))


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
    single_tries = _distinct_tries(tries, failed)
    if not single_tries:
        return None
    explanations = [_explanation(device, attempt, undecided) for attempt in single_tries if attempt.fits]
    all_tries = single_tries
    if with_pairs or all(explanation.kind == FRAME_INSIDE for explanation in explanations):
        # Try pairs only with the most common mistake, and only if no single one matches. More pairs would mostly match
        # by coincidence.
        unpaired_kinds = (NOT_INVERTED, FRAME_INSIDE)
        pairs = [_not_inverted(attempt) for attempt in single_tries if attempt.kind not in unpaired_kinds]
        all_tries = _distinct_tries((*single_tries, *pairs), failed)
        fitting_pairs = [attempt for attempt in all_tries[len(single_tries) :] if attempt.fits]
        explanations += [replace(_explanation(device, pair, undecided), twice=True) for pair in fitting_pairs]
    explanations.sort(key=lambda explanation: -explanation.score)
    chances = {attempt.question: attempt.one_in for attempt in all_tries}
    coincidence = 1 - prod(1 - 1 / one_in for one_in in chances.values())
    blind = tuple(dict.fromkeys(text for crc in crcs for text in _blind_spots(crc)))
    return Why(tuple(explanations), len(all_tries), coincidence, blind)


def _is_significant(attempt: Try) -> bool:
    return attempt.known_bits + attempt.demanded >= _LEAST_BITS


def _distinct_tries(tries: Iterable[Try], failed: Sequence[Try]) -> list[Try]:
    """Return the significant tries, without those known to fail. Of those that lead to the same frame, one is kept."""
    failed_questions = {attempt.question for attempt in failed}
    distinct_tries: dict[object, Try] = {}
    for attempt in tries:
        if _is_significant(attempt) and attempt.question not in failed_questions:
            leads_to = (attempt.number, _places(attempt.placed)) if attempt.placed is not None else attempt.text
            key = (attempt.question, leads_to)
            same = distinct_tries.get(key)
            if same is None or (attempt.holds, attempt.score) > (same.holds, same.score):
                distinct_tries[key] = attempt
    return list(distinct_tries.values())


def _places(placed: PlacedLayout) -> tuple[int, tuple[tuple[str, int], ...]]:
    """Return the length and the lowest bits of the fields, in which frames of one length can differ."""
    return placed.bits, tuple((placed_field.name, placed_field.low) for placed_field in placed.fields)


def _not_inverted(attempt: Try) -> Try:
    assert attempt.crc is not None
    change = "not inverted" if attempt.crc.xorout else "inverted"
    return replace(
        attempt,
        text=f"{attempt.text}, and the CRC is {change}",
        crc=replace(attempt.crc, xorout=attempt.crc.xorout ^ attempt.crc.mask),
    )


def _explanation(device: Device, attempt: Try, undecided: frozenset[str]) -> Explanation:
    reads = _numbers_read(device, attempt.placed, attempt.number, undecided) if attempt.placed is not None else {}
    return Explanation(
        attempt.kind,
        attempt.text,
        attempt.one_in,
        attempt.score,
        reads,
        attempt.codes,
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
