"""Steps that a person carries out by hand: a text that counts them is a list."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Fewer are an enumeration.
_FEWEST = 3


def steps_of(value: str) -> tuple[str, ...]:
    """Return what stands before the first step, and the steps; the value alone if it does not count up from one."""
    places = list(_NUMBER.finditer(value))
    if [int(item[1]) for item in places] != list(range(1, len(places) + 1)):
        return (value,)
    ends = [*(item.start() for item in places[1:]), len(value)]
    steps = (value[item.end() : end].strip() for item, end in zip(places, ends, strict=True))
    return (value[: places[0].start()].strip(), *steps) if places else (value,)


def has_steps(value: str) -> bool:
    """Tell whether a text counts enough steps to be a list of them."""
    return len(steps_of(value)) > _FEWEST
