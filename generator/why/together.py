"""Judge several frames together. The mistake that was made explains all of them, and a coincidence only some."""

from __future__ import annotations

from collections.abc import Sequence
from math import log2, prod

from ..model.record import dataclass
from .mistakes import Explanation, Why
from .tries import MISTAKES


@dataclass(frozen=True, slots=True)
class CommonMistake:
    """A mistake that explains ``frames`` frames. By chance, it matches one of ``one_in`` sets of that many frames."""

    text: str
    frames: int
    one_in: int
    score: float


def judge_together(whys: Sequence[Why]) -> list[CommonMistake]:
    """Return the mistakes that explain the most frames, most likely first."""
    explanations_by_mistake: dict[tuple[str, str, bool], list[Explanation]] = {}
    for why in whys:
        # One mistake may have several explanations of a frame, of which the first is the likeliest.
        likeliest = {explanation.mistake: explanation for explanation in reversed(why.unmerged or why.explanations)}
        for mistake, explanation in likeliest.items():
            explanations_by_mistake.setdefault(mistake, []).append(explanation)
    frame_counts = [len(explanations) for explanations in explanations_by_mistake.values()]
    most_frames = max(frame_counts, default=0)
    common_mistakes: list[CommonMistake] = []
    for explanations in explanations_by_mistake.values():
        if len(explanations) == most_frames:
            common_mistake = CommonMistake(
                text=_common_text(explanations),
                frames=most_frames,
                one_in=prod(explanation.one_in for explanation in explanations),
                score=_common_score(explanations),
            )
            common_mistakes.append(common_mistake)
    return sorted(common_mistakes, key=lambda mistake: -mistake.score)


def _common_score(explanations: Sequence[Explanation]) -> float:
    """Return the logarithm of the likelihood. A mistake is made once, so its frequency counts once."""
    frequency = log2(MISTAKES[explanations[0].kind])
    return frequency + sum(log2(explanation.score) - frequency for explanation in explanations)


def _common_text(explanations: Sequence[Explanation]) -> str:
    """Return the text of the explanations, with the details of each frame."""
    texts = dict.fromkeys(explanation.text for explanation in explanations)
    if len(texts) == 1:
        return explanations[0].text
    return explanations[0].template.replace("({0}) ", "").format("some")
