"""Steps that a person carries out by hand, as numbered steps in text."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Lowest number of steps that make a list.
_FEWEST = 3


def steps_of(value: str) -> tuple[str, ...]:
    """Return the text before the first step, then each step. Without steps numbered from one, return only the value."""
    places = list(_NUMBER.finditer(value))
    if [int(item[1]) for item in places] != list(range(1, len(places) + 1)):
        return (value,)
    ends = [*(item.start() for item in places[1:]), len(value)]
    steps = (value[item.end() : end].strip() for item, end in zip(places, ends, strict=True))
    return (value[: places[0].start()].strip(), *steps) if places else (value,)


def has_steps(value: str) -> bool:
    """Return whether a string has enough numbered steps to be a list."""
    return len(steps_of(value)) > _FEWEST
