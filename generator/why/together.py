"""Judge several frames together.

The mistake that was made explains all frames, and a coincidence explains only some.
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
    """Return the mistakes that explain the most frames, most likely first.

    A mistake is the same in several frames if its kind and its text without details are equal
    (``Explanation.mistake``).
    """
    explanations_by_mistake: dict[tuple[str, str, bool], list[Explanation]] = {}
    for diagnosis in diagnoses:
        for explanation in _likeliest_explanations(diagnosis):
            explanations_by_mistake.setdefault(explanation.mistake, []).append(explanation)
    most_frames = max(map(len, explanations_by_mistake.values()), default=0)
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
    """Return one explanation for each mistake, the likeliest, since a mistake may explain a frame in several ways.

    Explanations of a diagnosis are sorted, the likeliest first.
    """
    likeliest_by_mistake: dict[tuple[str, str, bool], Explanation] = {}
    all_explanations = diagnosis.unmerged or diagnosis.explanations
    # In reverse order, a likelier one replaces the ones before it.
    for explanation in reversed(all_explanations):
        likeliest_by_mistake[explanation.mistake] = explanation
    return likeliest_by_mistake.values()


def _common_score(explanations: Sequence[Explanation]) -> float:
    """Return the logarithm to base 2 of the likelihood that a mistake explains all frames.

    The score of each frame contains the frequency of the mistake. The mistake is made once, so its frequency counts
    once.
    """
    evidence = sum(log2(explanation.score / explanation.frequency) for explanation in explanations)
    return log2(explanations[0].frequency) + evidence


def _common_text(explanations: Sequence[Explanation]) -> str:
    """Return the text of the explanations, without the details in which the frames differ."""
    distinct_texts = {explanation.text for explanation in explanations}
    if len(distinct_texts) == 1:
        return explanations[0].text
    return without_details(explanations[0].template)
