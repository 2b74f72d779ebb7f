"""Procedures by hand: a text that counts its steps is a list of them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...model import Characteristic, Device
from ...say.name import heading

_NUMBER = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Fewer are an enumeration.
_FEWEST = 3


@dataclass(frozen=True, slots=True)
class ByHand:
    """What a person does, step by step; ``before`` says when."""

    characteristic: Characteristic
    title: str
    before: str
    steps: tuple[str, ...]


def by_hand(device: Device) -> list[ByHand]:
    """Those of a family, in the order of its spec."""
    found = ((item, steps_of(item.value)) for item in device.characteristics)
    return [ByHand(item, heading(item.name), steps[0], steps[1:]) for item, steps in found if len(steps) > _FEWEST]


def steps_of(value: str) -> tuple[str, ...]:
    """What stands before the first step, and the steps; only the value itself if it does not count up from one."""
    places = list(_NUMBER.finditer(value))
    if [int(item[1]) for item in places] != list(range(1, len(places) + 1)):
        return (value,)
    ends = [*(item.start() for item in places[1:]), len(value)]
    steps = (value[item.end() : end].strip() for item, end in zip(places, ends, strict=True))
    return (value[: places[0].start()].strip(), *steps) if places else (value,)
