"""Collect all facts of a reading."""

from __future__ import annotations

from . import around, codes, frames, procedures, registers
from .fact import Facts
from .reading import Reading


def facts_of(reading: Reading) -> Facts:
    """Return all facts of a reading that can be compared with those of another reader."""
    facts = Facts()
    codes.add_codes(reading, facts)
    frames.add_interfaces(reading, facts)
    registers.add_registers(reading, facts)
    for found in (procedures.procedures, around.contacts, around.alarms, around.inputs, around.history):
        facts.add(found(reading))
    return facts
