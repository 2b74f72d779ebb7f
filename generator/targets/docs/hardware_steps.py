"""Procedures carried out by hand, from texts with numbered steps."""

from __future__ import annotations

from ...model import Characteristic, Device
from ...model.by_hand import has_steps, steps_of
from ...model.record import dataclass
from ...say.name import heading


@dataclass(frozen=True, slots=True)
class ByHand:
    """Steps that a person carries out. ``before`` is the text before the first step."""

    characteristic: Characteristic
    title: str
    before: str
    steps: tuple[str, ...]


def by_hand(device: Device) -> list[ByHand]:
    """Return the procedures that a person carries out for a family, in the order of its spec."""
    manual_steps = (
        (characteristic, steps_of(characteristic.value))
        for characteristic in device.characteristics
        if has_steps(characteristic.value)
    )
    return [
        ByHand(characteristic, heading(characteristic.name), steps[0], steps[1:])
        for characteristic, steps in manual_steps
    ]
