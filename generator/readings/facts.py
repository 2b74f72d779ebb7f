"""All facts of a reading."""

from __future__ import annotations

from . import around, codes, frames, procedures, registers
from .fact import Facts
from .reading import Reading


def facts_of(reading: Reading) -> Facts:
    """Everything that a reading states and that another reader can be asked for."""
    facts = Facts()
    codes.add_codes(reading, facts)
    frames.add_interfaces(reading, facts)
    registers.add_registers(reading, facts)
    for found in (procedures.procedures, around.contacts, around.alarms, around.inputs, around.history):
        facts.add(found(reading))
    return facts
