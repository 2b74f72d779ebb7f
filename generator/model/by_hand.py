"""Steps that a person carries out by hand, as numbered steps in text."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Lowest number of steps that make a list.
_FEWEST = 3


def steps_of(value: str) -> tuple[str, ...]:
    """Return the text before the first step, then each step. Without steps numbered from one, return only the value."""
    numbers = list(_NUMBER.finditer(value))
    if [int(match[1]) for match in numbers] != list(range(1, len(numbers) + 1)):
        return (value,)
    ends = [*(match.start() for match in numbers[1:]), len(value)]
    steps = (value[match.end() : end].strip() for match, end in zip(numbers, ends, strict=True))
    return (value[: numbers[0].start()].strip(), *steps) if numbers else (value,)


def has_steps(value: str) -> bool:
    """Return whether a string has enough numbered steps to be a list."""
    return len(steps_of(value)) > _FEWEST
