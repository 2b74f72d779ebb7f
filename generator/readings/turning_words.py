"""Words that turn a sentence round if exchanged for their opposite, as data, and the gaps that they leave."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

#: Kinds of words. Each line has the senses of a kind, separated by bars, and each sense has words, separated by commas.
#: Words of one sense can replace each other. A reader fills in the first word.
_WORDS = """\
negation: not, no, never, none, nothing, neither, nor, without, non, no longer | always
modal: must, should, shall, has to, have to | may, can, could, might | must not, should not, may not | cannot, can not
order: before, prior to, previous, until | after, afterwards, following, next, since
place: above, over the limit | below, under, beneath
bound: at least, minimum, lowest, smallest, shortest, min | at most, maximum, highest, largest, longest, up to, max
amount: more, greater, larger, longer, higher, bigger, too high, too large, exceeds | \
less, fewer, smaller, shorter, lower, too low, too small
rotation: clockwise | counter-clockwise, counterclockwise, anticlockwise, anti-clockwise
level: high | low
switch: on | off
opening: open, opened, opens | closed, close, closes
report: error, errors, fault, faults | warning, warnings
change: increase, increases, increased, increasing, rises, rising, up | \
decrease, decreases, decreased, decreasing, falls, falling, down
side: left | right
connection: connected, connect, connects | disconnected, disconnect, disconnects, unconnected
inside: internal, inner, inside | external, outer, outside
sign: positive, plus | negative, minus
activity: active, activated, activate, activates, enabled, enable, enables | \
inactive, deactivated, deactivate, deactivates, disabled, disable, disables
colour: white | black | brown | green | yellow | grey | pink | blue | red | violet | orange | purple
"""
#: Kind of the signals of the connectors, which differ between families.
SIGNAL = "signal"
#: Words that are turning words only after one of these words. Elsewhere they are prepositions.
_ONLY_AFTER = {
    "on": "power- switch- power turn turned switch switched powered lit is are stays remains".split(),
    "up": ["count", "counts", "counting"],
    "down": ["count", "counts", "counting"],
}


class Gap(NamedTuple):
    """A gap in a text. ``word`` is the word that fits, the first one of its sense."""

    kind: str
    word: str


class ClozeText(NamedTuple):
    """A text with numbered gaps, and its gaps."""

    text: str
    gaps: tuple[Gap, ...]


class Vocabulary:
    """The turning words of a family: the turning words of the language, and the signals on its connectors."""

    def __init__(self, signals: Iterable[str]) -> None:
        #: The kind of each word, and the first word of its sense.
        self._senses: dict[str, Gap] = {}
        #: First words of the senses, by kind: ``{"level": ["high", "low"]}``.
        self.choices: dict[str, Sequence[str]] = {}
        for line in _WORDS.splitlines():
            kind, _, senses = line.partition(": ")
            self._add_kind(kind, [sense.split(", ") for sense in senses.split(" | ")])
        # Signals of one or two characters are left out. Each other word is a separate sense.
        self._add_kind(SIGNAL, [[signal] for signal in sorted(set(signals)) if len(signal) > 2])
        # The regular expression takes the first alternative that matches, so "no longer" must come before "no".
        spellings = sorted(self._senses, key=len, reverse=True)
        self._pattern_of_word = re.compile(
            rf"(?<![\w/])(?:{'|'.join(map(_pattern_of_word, spellings))})(?!\w)", re.IGNORECASE
        )

    def _add_kind(self, kind_of_turn: str, senses: Sequence[Sequence[str]]) -> None:
        """Add the words of each sense. A word of several kinds belongs to the first kind."""
        self.choices[kind_of_turn] = [words[0] for words in senses]
        for words in senses:
            for word in words:
                self._senses.setdefault(word.casefold(), Gap(kind_of_turn, words[0]))

    def cloze(self, text: str) -> ClozeText:
        """Return a text with numbered gaps instead of its turning words, and the gaps.

        For example ``if {1 level} {2 order} the start`` for ``if high before the start``.
        """
        gaps: list[Gap] = []

        def numbered_gap(match: re.Match[str]) -> str:
            gaps.append(self._senses[match[0].casefold()])
            return f"{{{len(gaps)} {gaps[-1].kind}}}"

        text_in_one_line = " ".join(text.split())
        # The substitution also fills the list of gaps.
        return ClozeText(self._pattern_of_word.sub(numbered_gap, text_in_one_line), tuple(gaps))


def _pattern_of_word(word: str) -> str:
    """Return the regular expression of a word.

    A word of ``_ONLY_AFTER`` matches only directly after one of its words: ``(?:(?<=count )|(?<=counts ))up``.
    """
    if word not in _ONLY_AFTER:
        return re.escape(word)
    words_before = (before if before.endswith("-") else f"{before} " for before in _ONLY_AFTER[word])
    return f"(?:{'|'.join(f'(?<={before})' for before in words_before)}){word}"
