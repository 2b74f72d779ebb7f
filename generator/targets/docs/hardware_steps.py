"""Procedures by hand: a text that counts its steps is a list of them."""

from __future__ import annotations

from dataclasses import dataclass

from ...model import Characteristic, Device
from ...model.by_hand import has_steps, steps_of
from ...say.name import heading


@dataclass(frozen=True, slots=True)
class ByHand:
    """What a person does, step by step; ``before`` says when."""

    characteristic: Characteristic
    title: str
    before: str
    steps: tuple[str, ...]


def by_hand(device: Device) -> list[ByHand]:
    """Those of a family, in the order of its spec."""
    found = ((item, steps_of(item.value)) for item in device.characteristics if has_steps(item.value))
    return [ByHand(item, heading(item.name), steps[0], steps[1:]) for item, steps in found]
