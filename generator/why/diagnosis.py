"""The diagnosis of a frame: which hypotheses explain it, and how likely each is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import prod
from typing import NamedTuple

from ..model import Crc, Device, Number, PlacedLayout
from ..model.record import dataclass
from ..reference import codec
from .hypotheses import LEAST_EQUAL_BITS, NOT_INVERTED, OTHER_MESSAGE, TEXTS, WITH_SECOND_MISTAKE, Hypothesis
from .recordings import FRAME_INSIDE

#: Fewest bits that must match. A mistake that matches more than one random frame in eight explains nothing.
LEAST_BITS = 3
#: An explanation that matches fewer than one in this many random frames is practically certain.
CERTAIN = 1 << 16


@dataclass(frozen=True, slots=True)
class Explanation:
    """A mistake that would explain the CRC.

    It matches one of ``one_in`` random frames. ``frequency`` is the part of the score that belongs to the mistake and
    not to the frame. ``numbers_read`` are the numbers in the frame without the mistake, by field, if that changes the
    frame, and ``other_numbers_read`` the numbers with another value of a lost bit. ``order_codes`` would send the
    frame. ``recording_parts`` are the parts of a recording, each with its bits. ``template`` is the text without the
    details of this frame, if the text has details. With ``hides_shift``, the CRC of the explanation does not detect
    every shift.
    """

    kind: str
    text: str
    one_in: int
    score: float
    frequency: float
    numbers_read: Mapping[str, int]
    order_codes: tuple[str, ...] = ()
    needs_two_mistakes: bool = False
    recording_parts: tuple[tuple[str, str], ...] = ()
    template: str = ""
    other_numbers_read: tuple[Mapping[str, int], ...] = ()
    hides_shift: bool = False

    @property
    def mistake(self) -> tuple[str, str, bool]:
        """Key of the mistake, which is the same for all frames with this mistake."""
        return self.kind, self.template or self.text, self.needs_two_mistakes


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Explanations of a frame, most likely first.

    ``tried_count`` is the number of mistakes tried, pairs included. At least one of them matches the fraction
    ``chance_of_match`` of random frames. ``undetectable_mistakes`` lists mistakes that a CRC of this kind cannot
    detect. ``bits_to_invert`` are the bits, counted from the last as 0, that make the frame valid if one of them is
    inverted. Such noise is the usual cause if only some frames fail, but one frame cannot prove it: the CRC is short,
    and most random frames have such a bit. ``all_explanations`` also contains those that lead to the same frame as a
    likelier one. ``missing_part`` is the part that a recording without a complete frame lacks. ``has_crc`` is false if
    only constants, parity and the length can contradict a frame, so that nothing is certain.
    """

    explanations: tuple[Explanation, ...]
    tried_count: int
    chance_of_match: float
    undetectable_mistakes: tuple[str, ...]
    bits_to_invert: tuple[int, ...] = ()
    missing_part: str = ""
    has_crc: bool = True
    all_explanations: tuple[Explanation, ...] = ()

    @property
    def equal_readings(self) -> int:
        """Number of equally good explanations of a frame without a CRC, or 0 if one is better than all others.

        The likeliest of them is the first explanation.
        """
        if self.has_crc:
            return 0
        improbabilities = [explanation.one_in for explanation in self.explanations]
        best_improbability = max(improbabilities, default=0)
        equal_count = improbabilities.count(best_improbability)
        return equal_count if equal_count > 1 else 0

    @property
    def needs_another_frame(self) -> bool:
        """True if another frame with the same mistake would show which explanation is correct."""
        if any(explanation.kind in ("line_stuck", "echo") for explanation in self.explanations):
            return False
        is_doubtful = bool(self.explanations) and self.explanations[0].one_in < CERTAIN
        return is_doubtful or len(self.explanations) > 1


class _ExplainedFrame(NamedTuple):
    """An explanation with the frame without the mistake, or with its text if the mistake does not change the frame."""

    resulting_frame: int | str
    explanation: Explanation


def diagnose_without_crc(
    device: Device, hypotheses: Iterable[Hypothesis], missing_part: str, bits_to_invert: tuple[int, ...] = ()
) -> Diagnosis | None:
    """Return the possible explanations of a frame without a CRC, most likely first. None of them is certain.

    If several mistakes lead to the same frame, only the likeliest is listed. ``missing_part`` is a text about the part
    that the received bits lack, or empty. ``bits_to_invert`` are the positions of bits, one of which may be corrupted.
    Return None if nothing fits, nothing is missing, and no bit may be corrupted.
    """
    explained_frames: list[_ExplainedFrame] = []
    for hypotheses_of_mistake in _grouped_by_mistake(hypotheses):
        likeliest = hypotheses_of_mistake[0]
        has_frame = likeliest.frame_layout is not None
        # The description replaces the frame for a mistake that does not change it.
        resulting_frame = likeliest.frame if has_frame else likeliest.description
        explanation = _explain_mistake(device, hypotheses_of_mistake)
        explained_frames.append(_ExplainedFrame(resulting_frame, explanation))
    explained_frames.sort(key=lambda explained_frame: -explained_frame.explanation.score)
    # The first explanation of each frame is the likeliest.
    likeliest_by_frame: dict[int | str, Explanation] = {}
    for resulting_frame, explanation in explained_frames:
        likeliest_by_frame.setdefault(resulting_frame, explanation)
    if not likeliest_by_frame and not missing_part and not bits_to_invert:
        return None
    return Diagnosis(
        explanations=tuple(likeliest_by_frame.values()),
        tried_count=len(likeliest_by_frame),
        chance_of_match=1.0,
        undetectable_mistakes=(),
        missing_part=missing_part,
        bits_to_invert=bits_to_invert,
        has_crc=False,
        all_explanations=tuple(explained_frame.explanation for explained_frame in explained_frames),
    )


def _grouped_by_mistake(hypotheses: Iterable[Hypothesis]) -> Iterable[list[Hypothesis]]:
    """Group the hypotheses that match the frame by their mistake, and return the groups, each with the likeliest first.

    Hypotheses that differ only in the assumed value of a lost bit have the same mistake. Every other hypothesis is a
    group of its own.
    """
    fitting_hypotheses = [hypothesis for hypothesis in hypotheses if hypothesis.fits]
    fitting_hypotheses.sort(key=lambda hypothesis: -hypothesis.score)
    hypotheses_by_mistake: dict[object, list[Hypothesis]] = {}
    for number, hypothesis in enumerate(fitting_hypotheses):
        # The number makes the key of any other hypothesis unique.
        mistake_key = (hypothesis.kind, hypothesis.template) if hypothesis.has_assumed_bit else number
        hypotheses_by_mistake.setdefault(mistake_key, []).append(hypothesis)
    return hypotheses_by_mistake.values()


def _explain_mistake(device: Device, hypotheses_of_mistake: Sequence[Hypothesis]) -> Explanation:
    """Return one explanation for hypotheses with the same mistake, which differ only in the value of a lost bit.

    ``one_in`` of each hypothesis excludes the assumed bit. Their sum therefore counts the compared bits once.
    """
    explanations = [
        _explain_hypothesis(device, hypothesis, undecided_parameters=frozenset())
        for hypothesis in hypotheses_of_mistake
    ]
    likeliest, *others = explanations
    if not others:
        return likeliest
    return replace(
        likeliest,
        text=without_details(likeliest.template),
        one_in=sum(explanation.one_in for explanation in explanations),
        score=sum(explanation.score for explanation in explanations),
        other_numbers_read=tuple(explanation.numbers_read for explanation in others),
    )


def without_details(template: str) -> str:
    """Return the text of a template without the details of a frame.

    ``the first bit ({0}) is missing`` becomes ``the first bit is missing``, and other details become ``some``.
    """
    return template.replace("({0}) ", "").format("some")


def diagnose(
    device: Device,
    hypotheses: Iterable[Hypothesis],
    refuted: Sequence[Hypothesis],
    crcs: Sequence[Crc],
    undecided_parameters: frozenset[str] = frozenset(),
    *,
    with_pairs: bool = False,
    repeated: Sequence[Hypothesis] = (),
) -> Diagnosis | None:
    """Try hypotheses on a frame with a CRC, and return those that explain its error, most likely first.

    Hypotheses that match the same frames as a ``refuted`` one are not tried. Pairs of mistakes would often match by
    chance, so they are only tried if no single mistake matches, or with ``with_pairs``. ``repeated`` are hypotheses
    that lead to the same frame as a better one, and are added to ``all_explanations`` only. Fields that depend on
    ``undecided_parameters`` are not decoded. Return None if no hypothesis could be tried.
    """
    significant = unrefuted_significant_hypotheses(hypotheses, refuted)
    tried_hypotheses = _distinct_hypotheses(significant)
    if not tried_hypotheses:
        return None
    explanations = _explain_hypotheses(device, tried_hypotheses, undecided_parameters)
    repeated_hypotheses = unrefuted_significant_hypotheses(repeated, refuted)
    all_explanations = _explain_hypotheses(device, [*significant, *repeated_hypotheses], undecided_parameters)
    if with_pairs or all(explanation.kind == FRAME_INSIDE for explanation in explanations):
        single_count = len(tried_hypotheses)
        pairs = unrefuted_significant_hypotheses(_paired_with_inversion(significant), refuted)
        tried_hypotheses = _distinct_hypotheses((*tried_hypotheses, *pairs))
        distinct_pairs = tried_hypotheses[single_count:]
        explanations += _explain_hypotheses(device, distinct_pairs, undecided_parameters, by_two_mistakes=True)
        all_explanations += _explain_hypotheses(device, pairs, undecided_parameters, by_two_mistakes=True)
    explanations.sort(key=lambda explanation: -explanation.score)
    all_explanations.sort(key=lambda explanation: -explanation.score)
    return Diagnosis(
        explanations=tuple(explanations),
        tried_count=len(tried_hypotheses),
        chance_of_match=_chance_of_any(tried_hypotheses),
        undetectable_mistakes=tuple(_undetectable_mistakes(crcs)),
        all_explanations=tuple(all_explanations),
    )


def _chance_of_any(hypotheses: Iterable[Hypothesis]) -> float:
    """Return the fraction of random frames that at least one of the hypotheses matches by chance.

    It is 0.03 for two hypotheses that match 1 in 64 random frames each. Hypotheses that match the same frames are
    counted once.
    """
    chance_by_key: dict[object, float] = {}
    for hypothesis in hypotheses:
        chance_at_one_place = 0.5 ** (hypothesis.received_crc_bits + hypothesis.determined_bits)
        # A frame that is searched at every bit has a hypothesis for each place.
        places = 1 if hypothesis.kind == FRAME_INSIDE else hypothesis.searched_places
        chance_by_key[hypothesis.match_key] = 1 - (1 - chance_at_one_place) ** places
    chance_that_none_matches = prod(1 - chance for chance in chance_by_key.values())
    return 1 - chance_that_none_matches


def _paired_with_inversion(hypotheses: Iterable[Hypothesis]) -> Iterator[Hypothesis]:
    """Yield each hypothesis combined with the most common mistake: a CRC that is wrongly inverted or not inverted.

    Hypotheses without a CRC, this mistake itself, messages of another length, and frames that were searched at every
    bit are omitted.
    """
    for hypothesis in hypotheses:
        if hypothesis.crc is None or hypothesis.kind in (NOT_INVERTED, FRAME_INSIDE, OTHER_MESSAGE):
            continue
        is_inverted = hypothesis.crc.xorout != 0
        pair_text = TEXTS["not_inverted_too" if is_inverted else "inverted_too"]
        inverted_crc = replace(hypothesis.crc, xorout=hypothesis.crc.xorout ^ hypothesis.crc.mask)
        template = pair_text.format(hypothesis.template) if hypothesis.template else ""
        description = pair_text.format(hypothesis.description)
        yield replace(
            hypothesis,
            description=description,
            template=template,
            crc=inverted_crc,
            relative_frequency=hypothesis.relative_frequency * WITH_SECOND_MISTAKE,
        )


def is_significant(hypothesis: Hypothesis) -> bool:
    """Return whether a match of the hypothesis means anything: at least 3 bits must be compared.

    A frame of 12 or more bits that are all equal means nothing either, since it may be a part of an idle line.
    """
    frame_layout = hypothesis.frame_layout
    if frame_layout is not None and frame_layout.bits >= LEAST_EQUAL_BITS:
        all_ones = (1 << frame_layout.bits) - 1
        if hypothesis.frame in (0, all_ones):
            return False
    return hypothesis.received_crc_bits + hypothesis.determined_bits >= LEAST_BITS


def unrefuted_significant_hypotheses(
    hypotheses: Iterable[Hypothesis], refuted: Sequence[Hypothesis]
) -> list[Hypothesis]:
    """Return the hypotheses whose match would mean something, without those that the frame refutes.

    A hypothesis is refuted if it matches the same frames as one of ``refuted``.
    """
    refuted_keys = {hypothesis.match_key for hypothesis in refuted}
    significant = [hypothesis for hypothesis in hypotheses if is_significant(hypothesis)]
    return [hypothesis for hypothesis in significant if hypothesis.match_key not in refuted_keys]


def _distinct_hypotheses(hypotheses: Iterable[Hypothesis]) -> list[Hypothesis]:
    """Return the hypotheses without duplicates.

    Of hypotheses that match the same frames and lead to the same frame, only the likeliest remains.
    """
    likeliest_by_result: dict[object, Hypothesis] = {}
    for hypothesis in hypotheses:
        result_key = hypothesis.match_key, _resulting_frame(hypothesis)
        known_hypothesis = likeliest_by_result.get(result_key)
        if known_hypothesis is None or _ranking_key(hypothesis) > _ranking_key(known_hypothesis):
            likeliest_by_result[result_key] = hypothesis
    return list(likeliest_by_result.values())


def _ranking_key(hypothesis: Hypothesis) -> tuple[bool, float]:
    """Return a key for comparing hypotheses by score. Those that the frame contradicts rank below all others."""
    return hypothesis.do_determined_bits_match, hypothesis.score


def _resulting_frame(hypothesis: Hypothesis) -> object:
    """Return a key of the frame without the mistake: its bits and the positions of its fields.

    For a mistake that does not change the frame, the key is its description.
    """
    placed_layout = hypothesis.frame_layout
    if placed_layout is None:
        return hypothesis.description
    field_positions = tuple((placed_field.name, placed_field.lowest_bit) for placed_field in placed_layout.fields)
    return hypothesis.frame, placed_layout.bits, field_positions


def _explain_hypotheses(
    device: Device,
    hypotheses: Iterable[Hypothesis],
    undecided_parameters: frozenset[str],
    *,
    by_two_mistakes: bool = False,
) -> list[Explanation]:
    """Return an explanation for each hypothesis that matches the frame.

    ``by_two_mistakes`` is true if each hypothesis is a pair of mistakes.
    """
    explanations: list[Explanation] = []
    for hypothesis in hypotheses:
        if hypothesis.fits:
            explanation = _explain_hypothesis(device, hypothesis, undecided_parameters)
            explanations.append(replace(explanation, needs_two_mistakes=by_two_mistakes))
    return explanations


def _explain_hypothesis(device: Device, hypothesis: Hypothesis, undecided_parameters: frozenset[str]) -> Explanation:
    """Return a hypothesis that matches the frame as an explanation.

    If the mistake changes the frame, it contains the numbers in the frame without the mistake. Fields that depend on
    ``undecided_parameters`` are omitted.
    """
    numbers: Mapping[str, int] = {}
    if hypothesis.frame_layout is not None:
        numbers = _numbers_in_frame(device, hypothesis.frame_layout, hypothesis.frame, undecided_parameters)
    return Explanation(
        kind=hypothesis.kind,
        text=hypothesis.description,
        one_in=hypothesis.one_in,
        score=hypothesis.score,
        frequency=hypothesis.frequency,
        numbers_read=numbers,
        order_codes=hypothesis.order_codes,
        recording_parts=hypothesis.recording_parts,
        template=hypothesis.template,
        hides_shift=_hides_shift(hypothesis),
    )


def _hides_shift(hypothesis: Hypothesis) -> bool:
    """Return whether the CRC of a hypothesis is also valid for half of all frames that are shifted by one bit.

    This is true if the CRC has neither a start value nor an inversion, so that a frame with its CRC is a multiple of
    the polynomial. If its last bit is 0, it is also valid without this bit, and if its first bit is 0, with an
    additional 0 at the end.
    """
    crc = hypothesis.crc
    if hypothesis.kind != NOT_INVERTED or crc is None or hypothesis.is_crc_over_bytes:
        return False
    return crc.init == 0 and crc.xorout == 0


def _numbers_in_frame(
    device: Device, placed_layout: PlacedLayout, frame: int, undecided_parameters: frozenset[str]
) -> dict[str, int]:
    """Return the numbers in a frame by field name: ``{"position": 4711}``.

    Fields whose position depends on an undecided parameter, such as an answer that the user has not given, are omitted.
    """
    numbers: dict[str, int] = {}
    field_by_name = {placed_field.name: placed_field.field for placed_field in placed_layout.fields}
    for decoded_field in codec.decode(device, placed_layout, frame).fields:
        field = field_by_name.get(decoded_field.name)
        if field is None or not isinstance(field.kind, Number) or not isinstance(decoded_field.value, int):
            continue
        if undecided_parameters.isdisjoint(field.low.parameters):
            numbers[decoded_field.name] = decoded_field.value
    return numbers


def _undetectable_mistakes(crcs: Iterable[Crc]) -> list[str]:
    """Return the mistakes that at least one of the CRCs cannot detect, as texts without duplicates.

    A CRC that is the XOR of the bytes does not depend on their order. If the start value is 0, leading zeros do not
    change the CRC.
    """
    undetected_mistakes: list[str] = []
    for crc in crcs:
        if crc.is_xor:
            undetected_mistakes.append("swapped bytes, or reversed bits in every byte (it is the XOR of the bytes)")
            undetected_mistakes.append("missing or extra bytes of 0")
        elif crc.init == 0:
            undetected_mistakes.append(
                "missing or extra leading zeros, such as those of a wider or narrower order code (its start value is 0)"
            )
        undetected_mistakes.append("wrong field boundaries, or Gray code mistaken for binary")
    return list(dict.fromkeys(undetected_mistakes))
