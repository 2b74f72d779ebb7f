"""Phrases that our texts avoid, with the better wording, the exceptions, and the patterns whose density is limited."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fnmatch import fnmatch

#: Regular expression of the phrase, in lower case, and the better wording. A space represents any white space.
_TABLE: list[tuple[str, str]] = [
    (r"makers?", "manufacturer"),
    (r"mend(?:s|ed|ing)?", "fix, correct"),
    (r"slip(?:s|ped)?(?! ring)", "mistake, typo"),
    (r"faults? of (?:a|an|the|one|its|this|that|each|every) (?:frame|word|reply|crc)", "frame error, CRC error"),
    (r"fault[ys]? (?:frame|repl(?:y|ie)|word)s?", "frame with an error"),
    (r"frame faults?", "frame error"),
    (r"sound (?:frame|value|word|repl(?:y|ie)|spec|model|position|crc|sample|row|line|answer)s?", "valid"),
    (r"(?:is|are|was|were|be) (?:not )?sound", "valid"),
    (r"(?:low|high)[ -]active", "active low, active high"),
    (r"spent batter(?:y|ies)|batter(?:y|ies) (?:is|are) spent", "depleted battery"),
    (r"(?:position|it|that|which|and|speed|value|multiturn|number)s? counts? on|counting on", "unwraps, continues"),
    (r"(?:runs?|running|ran) over", "wraps around, overflows; iterates over"),
    (r"(?:is|are|was|were|be|been) (?:not |never )?believed|believes", "is accepted, is plausible"),
    (r"(?:has|have|had|having) to be", "must be, needs"),
    (r"(?:holds?|held|holding)(?: [\w'-]+){0,8} against", "compare with, check against"),
    (r"in other words in|in editions before|otherwise in editions?", "different before edition ..."),
    (r"as delivered", "factory default"),
    (r"so many(?! that)", "that many, N"),
    (r"giv(?:es?|ing)(?: (?:an|the|its|every|each|this|that))? access(?:es)? up", "aborts the access"),
    (r"errs|manuals err", "error in the manual"),
    (
        r"nothing (?:of this |here )?(?:has been|was|is) tried|tried on (?:an?|any|no|real) encoders?",
        "not yet tested on hardware",
    ),
    (r"(?:takes?|taking|taken|took)(?: [\w'-]+){1,4} away", "rejects, makes unusable"),
    (r"takes? (?:the|an?) encoder out of", "rejects, makes unusable"),
    (r"at the (?:very )?place(?! of)|in the place where", "here, next to it, inline"),
    (r"the very (?!first|last|same|end|least)\w+", "exactly this, the ... itself"),
    (r"besides", "also, and; apart from"),
    (
        r"(?:makes?|made|making) (?:an? |the |its |all |these )?(?:files?|crcs?|headers?|pages?|packages?|outputs?)",
        "generate, compute",
    ),
    (r"house|rooms?(?! for| temperature)", "code base, package, module, layer"),
    (r"all the same", "still; nothing"),
    (r"otherwise than", "unlike, different from"),
    (r"by now", "now, already; nothing"),
    (r"nobody", "name the actor; the manual does not say"),
    (r"nothing else", "only; no other ..."),
    (r"tells? of|told of|telling of", "reports, lists, says"),
    (r"(?<!there\s)(?:is|are|was|were) none(?: of (?:it|its|them|those|these))?", "is not one"),
    (
        r"(?<!there\s)(?:is|are|was|were) no (?!longer|more|less|fewer|better|worse|greater|smaller|later|other)[\w-]+",
        "is not a ...",
    ),
    (r"see there|told above|said above", "a link, or the fact itself"),
    (r"as it has to|as they have to", "correct, as required"),
    (r"for you to decide|decides? (?:this )?for you", "you choose"),
    (r"the same to a program", "identical for software"),
    (r"the worst that speaks", "the most severe active flag"),
    (r"the label tells", "the label says, can be inferred from the label"),
    (r"turn on until", "keep turning until"),
    (r"refusing ends", "the limit widens"),
    (r"follows from itself", "is defined by itself"),
    (r"with a warning with a warning", "warning bit active: usable with a warning"),
    (r"not to be used, and to be used with care", "say the meaning of each bit"),
]


def _whole_words(regex: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![\w/-])(?:{regex.replace(' ', chr(92) + 's+')})(?![\w/=-]|\.\w)")


WORDS = [(_whole_words(regex), better) for regex, better in _TABLE]

#: Files, a phrase that they may have (a regular expression, in lower case), and why.
EXCEPTIONS: list[tuple[str, str, str]] = []
_EXCEPTIONS = [(files, re.compile(phrase), why) for files, phrase, why in EXCEPTIONS]

_CLAUSE = (
    "(?:an?|the|its?|they|is|are|was|no|not|each|every|one|this|that|these|those|has|have|comes?|came|goes|we|our|all)"
)
#: Pattern of prose, in lower case, and their limit per 1,000 words.
DENSITIES: dict[str, tuple[re.Pattern[str], float]] = {
    "headless what/where/whether clause": (
        re.compile(
            rf"(?:\A\W*|[.:!?]\s+|^\s*[-*|]\s+)(?:what|where|whether)\b|(?<![\w-])what\s+{_CLAUSE}\b", re.MULTILINE
        ),
        1.0,
    ),
    "told/said": (
        re.compile(r"\b(?:is|are|was|were|be|been|being)\s+(?:(?:not|also|then|only|never)\s+)?(?:told|said)\b"),
        0.3,
    ),
    "stands": (re.compile(r"(?<![\w-])(?:stands?|stood)(?![\w-])(?!\s+for)"), 0.1),
    "semicolon": (re.compile(r";(?=\s|$)"), 2.0),
}
#: Patterns not counted in the one-line messages of commands: a semicolon joins cause and remedy, as in compilers.
NOT_OF_MESSAGES = {"semicolon"}


def phrases(path: str, text: str) -> Iterator[tuple[int, str, str]]:
    """Yield the offset of each phrase to avoid in a text of the file, the phrase, and the better wording."""
    lowered = text.replace("None", "····").lower()
    for pattern, better in WORDS:
        for match in pattern.finditer(lowered):
            phrase = " ".join(match[0].split())
            if not any(fnmatch(path, files) and allowed.fullmatch(phrase) for files, allowed, _ in _EXCEPTIONS):
                yield match.start(), phrase, better
