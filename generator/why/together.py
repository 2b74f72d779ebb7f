"""Judge several frames with errors together.

The mistake that was really made explains all frames. A mistake that matches by chance explains only some of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import log2, prod

from ..model.record import dataclass
from .diagnosis import Diagnosis, Explanation, without_details


@dataclass(frozen=True, slots=True)
class CommonMistake:
    """A mistake that explains ``frames`` frames. By chance, it matches one of ``one_in`` sets of that many frames."""

    text: str
    frames: int
    one_in: int
    score: float
    hides_shift: bool


def judge_together(diagnoses: Sequence[Diagnosis]) -> list[CommonMistake]:
    """Return the mistakes that explain the largest number of frames, most likely first.

    ``diagnoses`` has the possible explanations of each frame. Two frames have the same mistake if its kind and its
    text, without the details of the frame, are equal.
    """
    explanations_by_mistake: dict[tuple[str, str, bool], list[Explanation]] = {}
    for diagnosis in diagnoses:
        for explanation in _likeliest_explanations(diagnosis):
            explanations_by_mistake.setdefault(explanation.mistake, []).append(explanation)
    numbers_of_frames = [len(explanations) for explanations in explanations_by_mistake.values()]
    most_frames = max(numbers_of_frames, default=0)
    common_mistakes: list[CommonMistake] = []
    for explanations in explanations_by_mistake.values():
        if len(explanations) == most_frames:
            common_mistake = CommonMistake(
                text=_common_text(explanations),
                frames=most_frames,
                one_in=prod(explanation.one_in for explanation in explanations),
                score=_common_score(explanations),
                hides_shift=explanations[0].hides_shift,
            )
            common_mistakes.append(common_mistake)
    return sorted(common_mistakes, key=lambda mistake: -mistake.score)


def _likeliest_explanations(diagnosis: Diagnosis) -> Iterable[Explanation]:
    """Return the likeliest explanation of a frame for each mistake, which may explain the frame in several ways."""
    likeliest_by_mistake: dict[tuple[str, str, bool], Explanation] = {}
    # Both tuples are sorted by likelihood. ``all_explanations`` also has explanations that lead to the same frame.
    all_explanations = diagnosis.all_explanations or diagnosis.explanations
    least_likely_first = reversed(all_explanations)
    for explanation in least_likely_first:
        likeliest_by_mistake[explanation.mistake] = explanation  # replaces a less likely one
    return likeliest_by_mistake.values()


def _common_score(explanations: Sequence[Explanation]) -> float:
    """Return the binary logarithm of the likelihood that one mistake explains all frames.

    The score of each explanation contains the frequency of the mistake. Since the mistake was made only once, its
    frequency is counted only once.
    """
    evidence = sum(log2(explanation.score / explanation.frequency) for explanation in explanations)
    return log2(explanations[0].frequency) + evidence


def _common_text(explanations: Sequence[Explanation]) -> str:
    """Return the text of a mistake in several frames, without the details in which the frames differ."""
    distinct_texts = {explanation.text for explanation in explanations}
    if len(distinct_texts) == 1:
        return explanations[0].text
    return without_details(explanations[0].template)
