"""Disagreements that have one cause are one problem: a frame of another length, a name, texts that one file lacks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

from .comparison import Disagreement
from .reading import NOTHING, Sort

#: Classes of facts in words, of which a second reading may list some that the spec no longer has.
_TEXTS = (Sort.TEXT, Sort.SECTION)


#: Classes of facts whose values are places or words, with numbers that mean nothing elsewhere.
_SORTS_WITH_OWN_NUMBERS = (Sort.SECTION, Sort.CONTENTS, Sort.PRINTED, Sort.ADDRESS, Sort.POSITION)
#: A number in decimal, or in hexadecimal with its mark.
_NUMBER = re.compile(r"0x[0-9A-Fa-f]+|\d[0-9A-F]*h\b|\d+(?:\.\d+)?")

#: The edition that a fact of the history is about.
_EDITION = re.compile(r"of the edition '.*'")


@dataclass(frozen=True)
class Related:
    """A disagreement, and the others that have the same cause."""

    first_disagreement: Disagreement
    others: tuple[Disagreement, ...] = ()

    @property
    def is_text_without_spec(self) -> bool:
        """True for a text under ``found`` that the spec does not have."""
        return self.first_disagreement.sort in _TEXTS and self.first_disagreement.spec_value == NOTHING


def related(disagreements: Sequence[Disagreement]) -> list[Related]:
    """Return the disagreements, each with those that have the same cause.

    In a frame with another length, all bits after the difference are others, so its length is reported alone.
    """
    resized_frames = [disagreement.resized_frame for disagreement in disagreements if disagreement.resized_frame]
    separate = [disagreement for disagreement in disagreements if not _is_in_frame(disagreement, resized_frames)]
    separate.sort(key=_sort_key)
    disagreements_by_cause: dict[object, list[Disagreement]] = {}
    for index, disagreement in enumerate(separate):
        known_causes = disagreements_by_cause.keys()
        cause = (
            _known_renaming_of_entry(disagreement, known_causes)
            or _known_renaming_of_place(disagreement, known_causes)
            or _known_change_of_time(disagreement, known_causes)
            or _own_cause(disagreement)
            or index
        )
        disagreements_by_cause.setdefault(cause, []).append(disagreement)
    groups = disagreements_by_cause.values()
    return [Related(first_disagreement=group[0], others=tuple(group[1:])) for group in groups]


def _sort_key(disagreement: Disagreement) -> tuple[bool, bool, bool]:
    """Return a key that puts names first, and disagreements that depend on others last."""
    is_open_value = disagreement.second_place[-1:] == ("open",)
    is_time_without_spec = disagreement.sort is Sort.TIME and disagreement.spec_value == NOTHING
    return not disagreement.is_name, is_open_value, is_time_without_spec


def _is_in_frame(disagreement: Disagreement, frames: Sequence[str]) -> bool:
    """Return whether a disagreement is only about bits in one of these frames."""
    if disagreement.resized_frame or not frames:
        return False
    any_frame = re.compile(rf"(?:{'|'.join(map(re.escape, frames))})(?![\w.])")
    if any_frame.search(disagreement.description):
        return True
    # The values may be lists, such as those of the bits of an alarm in several frames.
    spec_items, second_items = disagreement.spec_value.split(", "), disagreement.second_value.split(", ")
    spec_items_elsewhere = [bits_text for bits_text in spec_items if not any_frame.search(bits_text)]
    second_items_elsewhere = [bits_text for bits_text in second_items if not any_frame.search(bits_text)]
    has_items_in_frame = (spec_items_elsewhere, second_items_elsewhere) != (spec_items, second_items)
    return has_items_in_frame and spec_items_elsewhere == second_items_elsewhere


def _own_cause(disagreement: Disagreement) -> object:
    """Return what a disagreement has in common with others of the same cause, or None if it stands alone."""
    if disagreement.sort in _TEXTS and disagreement.spec_value == NOTHING:
        return "text that only the second reading has"
    if disagreement.is_name:
        return _plain_name(disagreement.spec_value), _plain_name(disagreement.second_value)
    if disagreement.sort is Sort.ORDER_CODE and NOTHING in (disagreement.spec_value, disagreement.second_value):
        return "order codes"
    if disagreement.sort is Sort.HISTORY:
        edition = _EDITION.search(disagreement.description)
        return edition[0] if edition is not None else None
    return _changed_values(disagreement)


def _changed_values(disagreement: Disagreement) -> object:
    """Return the numbers in which the values differ, in any unit, or the two signals of a contact.

    A wait of 30 ms and a time of 30,000 µs have the same digits.
    """
    spec_digits = _digits_of_numbers(disagreement.spec_value)
    second_digits = _digits_of_numbers(disagreement.second_value)
    only_in_spec, only_in_second = spec_digits - second_digits, second_digits - spec_digits
    if only_in_spec and only_in_second and disagreement.sort not in _SORTS_WITH_OWN_NUMBERS:
        return "numbers", frozenset(only_in_spec), frozenset(only_in_second)
    if disagreement.sort is Sort.PIN:
        return "signals", frozenset((disagreement.spec_value, disagreement.second_value))
    return None


def _digits_of_numbers(text: str) -> Set[str]:
    """Return the digits of each number in a text, without the zeros that depend on its unit."""
    return {number.replace(".", "").strip("0") or "0" for number in _NUMBER.findall(text)}


def _known_renaming_of_entry(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return the two names of a thing whose old one is still an entry of the contents in the second reading."""
    if disagreement.sort is not Sort.CONTENTS or disagreement.spec_value != NOTHING:
        return None
    entry_name = _plain_name(str(disagreement.second_place[-1]))
    for cause in known_causes:
        if isinstance(cause, tuple) and cause[1] == entry_name:
            return cause
    return None


def _known_renaming_of_place(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return both names of a renamed part if a source or a text lies in it."""
    if disagreement.sort not in _TEXTS:
        return None
    names_in_place = {_plain_name(str(step)) for step in disagreement.spec_place}
    for cause in known_causes:
        if isinstance(cause, tuple) and cause[0] in names_in_place:
            return cause
    return None


def _known_change_of_time(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return the cause of another time that has changed from this one. A time without a name is known by its value."""
    if disagreement.sort is not Sort.TIME or disagreement.spec_value != NOTHING:
        return None
    digits = _digits_of_numbers(disagreement.second_value)
    for cause in known_causes:
        if isinstance(cause, tuple) and cause[0] == "numbers" and cause[2] == digits:
            return cause
    return None


def _plain_name(name: str) -> str:
    """Return a name without quotes, underscores and capitals: ``speed limit`` for ``'Speed_limit'``."""
    return name.strip("'").replace("_", " ").casefold()
