"""Collect all facts of a reading."""

from __future__ import annotations

from . import cited, interfaces, order_codes, procedures, registers, surroundings
from .fact import Facts
from .reading import Reading


def facts_of(reading: Reading) -> Facts:
    """Return all facts of a reading that can be compared with those of another reader."""
    facts = Facts()
    order_codes.add_codes(reading, facts)
    interfaces.add_interfaces(reading, facts)
    registers.add_registers(reading, facts)
    facts.add(procedures.procedures(reading))
    for found in (surroundings.contacts, surroundings.alarms, surroundings.inputs, surroundings.history):
        facts.add(found(reading))
    for found in (surroundings.characteristics, surroundings.tables, surroundings.leds, cited.contents, cited.texts):
        facts.add(found(reading))
    facts.found, facts.sections = cited.by_path(reading), cited.sections_by_path(reading)
    facts.decided = reading.document.data.get("decided", ())
    return facts
