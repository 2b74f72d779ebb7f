"""Procedures carried out by hand, from texts with numbered steps."""

from __future__ import annotations

from ...model import Characteristic, Device
from ...model.record import dataclass
from ...model.steps import has_steps, steps_of
from ...say.names_and_places import heading


@dataclass(frozen=True, slots=True)
class ManualProcedure:
    """Steps that a person carries out. ``before`` is the text before the first step."""

    characteristic: Characteristic
    title: str
    before: str
    steps: tuple[str, ...]


def manual_procedures(device: Device) -> list[ManualProcedure]:
    """Return the procedures that a person carries out for a family, in the order of its spec."""
    return [_manual_procedure(fact) for fact in device.characteristics if has_steps(fact.value)]


def _manual_procedure(characteristic: Characteristic) -> ManualProcedure:
    before, *steps = steps_of(characteristic.value)
    return ManualProcedure(characteristic, heading(characteristic.name), before, tuple(steps))
