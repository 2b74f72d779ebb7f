"""Reasons why a mutant passes although it is not equivalent. Every such mutant must have a reason."""

from __future__ import annotations

import re
from collections.abc import Iterator

from .mistakes import Mutant
from .places import PROSE, WORD

#: Reasons by class of fact, keys, mistake, and file name. The first match applies.
_REASONS = (
    (
        "words for people",
        "No output computes with these texts, and no other fact repeats them. They are checked by reading the spec.",
        {"fact": "|".join(sorted(PROSE - {"source"}))},
    ),
    (
        "a word in a text that is in no sheet",
        "Only texts with a gap in a sheet of turning words are compared. Texts about other editions have no gaps.",
        {"fact": WORD},
    ),
    (
        "a place in the manual",
        "The table of contents gives only the first page of each section. Other pages are checked only by reading.",
        {"fact": "cited section|cited page|page without contents|place in another document"},
    ),
    (
        "a name or a page that only one reading has",
        "The second reading does not contain these facts.",
        {"fact": "characteristic(, hazard)?|table|LED|contents"},
    ),
    (
        "words of an example",
        "The mutant changes the name or a text of an example. The example's bytes and values are computed again.",
        {"fact": "example"},
    ),
    (
        "a witness is missing",
        "A value that only helps to find mistakes in other facts can be omitted. It then finds none.",
        {"fact": "printed once more", "mistake": "(item|key) omitted"},
    ),
    (
        "read once: another edition",
        "These facts are from another edition of the manual, which was not read twice.",
        {"keys": r"(order_code\.also_written|editions)\b.*"},
    ),
    (
        "names of two groups with the same bits",
        "The two groups have the same fields. Only their descriptions differ.",
        {"keys": r"field_groups\.name", "mistake": "swapped with the next"},
    ),
    (
        "how a number is written",
        "The number is the same. Documents show it in decimal or in hexadecimal.",
        {"keys": r"parameters\.NAME\.hexadecimal"},
    ),
    (
        "omitted, so not generated",
        "Without the manufacturer ID, no description for BiSS masters is generated, which users notice.",
        {"fact": "BiSS manufacturer ID", "mistake": "key omitted"},
    ),
    (
        "a witness, not a fact",
        "Facts that are only in the second reading do not reach any output.",
        {"file": r".*\.second"},
    ),
)


def reason(mutant: Mutant) -> str:
    """Return the reason why a mutant passes. If it is empty, the mutant is a gap."""
    return next(_matching_reasons(mutant), "")


def explanation(name: str) -> str:
    """Return a reason as a sentence."""
    return next(text for reason_name, text, _ in _REASONS if reason_name == name)


def _matching_reasons(mutant: Mutant) -> Iterator[str]:
    facts = {
        "fact": mutant.fact,
        "keys": mutant.place.keys,
        "mistake": mutant.mistake,
        "file": mutant.file.rpartition("/")[2].removesuffix(".yaml"),
    }
    for name, _, wanted in _REASONS:
        if all(re.fullmatch(pattern, facts[about]) for about, pattern in wanted.items()):
            yield name
