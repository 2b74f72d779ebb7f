"""Opposite words that a transcriber can write in a text.

The list differs from the list of the sheets of turning words, and includes words that no sheet asks for.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from codewheel.commands.cloze import Vocabulary

_PAIRS = """\
before/after, above/below, at least/at most, minimum/maximum, lowest/highest, low/high, lower/higher, on/off
open/closed, must/may, error/warning, clockwise/counter-clockwise, read/written, reads/writes, first/last, left/right
internal/external, connected/disconnected, connect/disconnect, increases/decreases, increase/decrease, more/less
longer/shorter, always/never, valid/invalid, active/inactive, enabled/disabled, enable/disable, rising/falling
white/black, red/green, positive/negative, with/without, inner/outer, same/different, until/after, up/down
start/end, starts/ends, input/output, sent/received, sends/receives, save/load, saved/loaded, set/reset, sets/resets
singleturn/multiturn, binary/gray, possible/impossible, lost/kept, strong/weak, fast/slow, new/old, master/encoder
zero/one, only/also, absolute/incremental, serial/parallel, mechanical/electrical, earlier/later, complete/incomplete
"""


def _opposites() -> Iterator[tuple[str, str]]:
    for pair in re.split(r", |\n", _PAIRS.strip()):
        word, other_word = pair.split("/")
        yield word, other_word
        yield other_word, word


# The first pair of a word applies.
_OPPOSITES = dict(reversed(list(_opposites())))
_WORD = re.compile(rf"(?<![\w-])({'|'.join(sorted(_OPPOSITES, key=len, reverse=True))})(?![\w-])", re.IGNORECASE)
_NEGATION = re.compile(r"\b(not|no|never) ", re.IGNORECASE)
_AUXILIARY = re.compile(r"\b(is|are|must|may|can|does|do|will)(?= (?!not\b|no\b))")


def contradicts_a_gap(vocabulary: Vocabulary, text: str, reversed_text: str) -> bool:
    """Return whether a reader who fills the gaps of the reversed text from the manual contradicts the reversed word.

    A word without a gap is not asked for. Neither is a word that is missing, such as a lost ``not``.
    """
    gaps, reversed_gaps = (vocabulary.cloze(words).gaps for words in (text, reversed_text))
    return len(reversed_gaps) > len(gaps) or (len(reversed_gaps) == len(gaps) and reversed_gaps != gaps)


def opposites(text: str) -> Iterator[str]:
    """Yield the text with one word turned round: in another sense, with a negation, or without one."""
    for match in _NEGATION.finditer(text):
        yield text[: match.start()] + text[match.end() :]
    for match in _WORD.finditer(text):
        word = _OPPOSITES[match[0].lower()]
        word = word.capitalize() if match[0][0].isupper() else word
        yield text[: match.start()] + word + text[match.end() :]
    for match in _AUXILIARY.finditer(text):
        yield f"{text[: match.end()]} not{text[match.end() :]}"
