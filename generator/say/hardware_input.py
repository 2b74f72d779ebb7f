"""Sentences about a hardware input."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Input
from .name import register_field
from .text import Statement, spec_text, statement
from .words import microseconds


def facts(device: Device, hardware_input: Input) -> Iterator[Statement]:
    """Yield the meanings of its levels, its effect, and the rules for its use."""
    yield from spec_text(hardware_input.low, label="Low level")
    yield from spec_text(hardware_input.high, label="High level")
    if hardware_input.pulse_at_least_us is not None:
        yield statement(f"at least {microseconds(hardware_input.pulse_at_least_us)}", label="Pulse")
    if hardware_input.inverts:
        yield statement("A high level inverts ", register_field(device, hardware_input.inverts))
    if hardware_input.needs:
        yield statement("Has an effect only if enabled by ", register_field(device, hardware_input.needs))
    if hardware_input.when_unused:
        yield statement(f"Connect it to {hardware_input.when_unused} when it is not used")
