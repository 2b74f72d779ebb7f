"""Disagreements that have one cause are one problem: a frame of another length, a name, texts that one file lacks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

from .compare import Disagreement
from .reading import NOTHING, Sort

#: Classes of facts in words, of which a second reading may list some that the spec no longer has.
_TEXTS = (Sort.TEXT, Sort.SECTION)


#: Classes of facts whose values are places or words, with numbers that mean nothing elsewhere.
_TEXTS_OF_PLACES = (Sort.SECTION, Sort.CONTENTS, Sort.PRINTED, Sort.ADDRESS, Sort.POSITION)
#: A number in decimal, or in hexadecimal with its mark.
_NUMBER = re.compile(r"0x[0-9A-Fa-f]+|\d[0-9A-F]*h\b|\d+(?:\.\d+)?")

#: The edition that a fact of the history is about.
_EDITION = re.compile(r"of the edition '.*'")


@dataclass(frozen=True)
class Related:
    """A disagreement, and the others that have the same cause."""

    first: Disagreement
    others: tuple[Disagreement, ...] = ()

    @property
    def is_text_without_spec(self) -> bool:
        """True for a text under ``found`` that the spec does not have."""
        return self.first.sort in _TEXTS and self.first.used == NOTHING


def related(disagreements: Sequence[Disagreement]) -> list[Related]:
    """Return the disagreements, each with those that have the same cause.

    In a frame with another length, all bits after the difference are others, so its length is reported alone.
    """
    frames = [disagreement.resized_frame for disagreement in disagreements if disagreement.resized_frame]
    remaining = [disagreement for disagreement in disagreements if not _is_in_frame(disagreement, frames)]
    remaining.sort(key=_place_in_order)
    groups: dict[object, list[Disagreement]] = {}
    for index, disagreement in enumerate(remaining):
        cause = _renamed_entry(disagreement, groups) or _renamed_place(disagreement, groups)
        cause = cause or _changed_time(disagreement, groups) or _cause(disagreement) or index
        groups.setdefault(cause, []).append(disagreement)
    return [Related(group[0], tuple(group[1:])) for group in groups.values()]


def _place_in_order(disagreement: Disagreement) -> tuple[bool, bool, bool]:
    """Return a key that puts names first, and disagreements that depend on others last."""
    is_open_value = disagreement.second[-1:] == ("open",)
    is_time_without_spec = disagreement.sort is Sort.TIME and disagreement.used == NOTHING
    return not disagreement.is_name, is_open_value, is_time_without_spec


def _is_in_frame(disagreement: Disagreement, frames: Sequence[str]) -> bool:
    """Return whether a disagreement is only about bits in one of these frames."""
    if disagreement.resized_frame or not frames:
        return False
    patterns = [re.compile(rf"{re.escape(frame)}(?![\w.])") for frame in frames]
    if any(pattern.search(disagreement.description) for pattern in patterns):
        return True
    used, other = _items(disagreement.used, patterns), _items(disagreement.other, patterns)
    return (used, other) != (disagreement.used.split(", "), disagreement.other.split(", ")) and used == other


def _items(text: str, patterns: Sequence[re.Pattern[str]]) -> list[str]:
    """Return the items of a list that are not about one of the frames."""
    return [item for item in text.split(", ") if not any(pattern.search(item) for pattern in patterns)]


def _cause(disagreement: Disagreement) -> object:
    """Return what a disagreement has in common with others of the same cause, or None if it stands alone."""
    if disagreement.sort in _TEXTS and disagreement.used == NOTHING:
        return "text that only the second reading has"
    if disagreement.is_name:
        return _plain_name(disagreement.used), _plain_name(disagreement.other)
    if disagreement.sort is Sort.ORDER_CODE and NOTHING in (disagreement.used, disagreement.other):
        return "order codes"
    if disagreement.sort is Sort.HISTORY:
        edition = _EDITION.search(disagreement.description)
        return edition[0] if edition is not None else None
    return _changed_values(disagreement)


def _changed_values(disagreement: Disagreement) -> object:
    """Return the numbers in which the values differ, in any unit, or the two signals of a contact.

    A wait of 30 ms and a time of 30,000 µs have the same digits.
    """
    used, other = _digits_of_numbers(disagreement.used), _digits_of_numbers(disagreement.other)
    if used - other and other - used and disagreement.sort not in _TEXTS_OF_PLACES:
        return "numbers", frozenset(used - other), frozenset(other - used)
    if disagreement.sort is Sort.PIN:
        return "signals", frozenset((disagreement.used, disagreement.other))
    return None


def _digits_of_numbers(text: str) -> Set[str]:
    """Return the digits of each number in a text, without the zeros that depend on its unit."""
    return {number.replace(".", "").strip("0") or "0" for number in _NUMBER.findall(text)}


def _renamed_entry(disagreement: Disagreement, causes: Iterable[object]) -> object:
    """Return the two names of a thing whose old one is still an entry of the contents in the second reading."""
    if disagreement.sort is not Sort.CONTENTS or disagreement.used != NOTHING:
        return None
    entry = _plain_name(str(disagreement.second[-1]))
    return next((cause for cause in causes if isinstance(cause, tuple) and cause[1] == entry), None)


def _renamed_place(disagreement: Disagreement, causes: Iterable[object]) -> object:
    """Return both names of a renamed part if a source or a text lies in it."""
    if disagreement.sort not in _TEXTS:
        return None
    names = {_plain_name(str(step)) for step in disagreement.place}
    return next((cause for cause in causes if isinstance(cause, tuple) and cause[0] in names), None)


def _changed_time(disagreement: Disagreement, causes: Iterable[object]) -> object:
    """Return the cause of another time that has changed from this one. A time without a name is known by its value."""
    if disagreement.sort is not Sort.TIME or disagreement.used != NOTHING:
        return None
    digits = _digits_of_numbers(disagreement.other)
    same_digits = [
        cause for cause in causes if isinstance(cause, tuple) and cause[0] == "numbers" and cause[2] == digits
    ]
    return next(iter(same_digits), None)


def _plain_name(text: str) -> str:
    return text.strip("'").replace("_", " ").casefold()
