"""Reasons why a mutant passes although it is not equivalent. Each such mutant must have one."""

from __future__ import annotations

import re
from collections.abc import Iterator

from .places import PROSE
from .slips import Mutant

#: Reasons by class of fact, keys, mistake, and name of the file. The first match counts.
_REASONS = (
    (
        "words for people",
        "No output computes with them, and no other fact says them once more; whoever reviews a spec reads them.",
        {"fact": "|".join(sorted(PROSE))},
    ),
    (
        "words of an example",
        "What an example is called and says beside its bytes and values; these are worked out again.",
        {"fact": "example"},
    ),
    (
        "a witness is missing",
        "What is there to find slips in other facts can be left out; then it finds none.",
        {"fact": "printed once more", "slip": "(item|key) lost"},
    ),
    (
        "read once: another edition",
        "What another edition prints. Its manual is not the one that was read twice.",
        {"keys": r"(order_code\.also_written|editions)\b.*"},
    ),
    (
        "names of two groups with the same bits",
        "The two groups have the same fields; only what is said of them in words differs.",
        {"keys": r"field_groups\.name", "slip": "exchanged with the next"},
    ),
    (
        "how a number is written",
        "The number is the same; documents show it in decimal or in hexadecimal.",
        {"keys": r"parameters\.NAME\.hexadecimal"},
    ),
    (
        "left out, and then not made",
        "Without the ID of the manufacturer there is no description for BiSS masters, which its user sees.",
        {"fact": "BiSS manufacturer ID", "slip": "key lost"},
    ),
    (
        "a witness, not a fact",
        "What only the second reading has reaches no output.",
        {"file": r".*\.second"},
    ),
)


def reason(mutant: Mutant) -> str:
    """Return the reason why a mutant passes. An empty string marks a gap."""
    return next(_fitting(mutant), "")


def explanation(name: str) -> str:
    """Return a reason in a sentence."""
    return next(text for known, text, _ in _REASONS if known == name)


def _fitting(mutant: Mutant) -> Iterator[str]:
    of = {
        "fact": mutant.place.fact,
        "keys": mutant.place.keys,
        "slip": mutant.slip,
        "file": mutant.file.rpartition("/")[2].removesuffix(".yaml"),
    }
    for name, _, wanted in _REASONS:
        if all(re.fullmatch(pattern, of[about]) for about, pattern in wanted.items()):
            yield name
