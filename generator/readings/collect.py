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
    facts.add(surroundings.surroundings(reading))
    facts.add(cited.contents(reading))
    facts.add(cited.texts(reading))
    facts.printed_numbers, facts.sections = cited.by_path(reading), cited.sections_by_path(reading)
    facts.decided = reading.document.data.get("decided", ())
    return facts
