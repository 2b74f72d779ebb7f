"""Sentences about a hardware input."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Input
from .name import register_field
from .text import Said, said, told
from .words import microseconds


def facts(device: Device, item: Input) -> Iterator[Said]:
    """Yield the meanings of its levels, its effect, and the rules for its use."""
    yield from told(item.low, label="Low level")
    yield from told(item.high, label="High level")
    if item.pulse_at_least_us is not None:
        yield said(f"at least {microseconds(item.pulse_at_least_us)}", label="Pulse")
    if item.inverts:
        yield said("A high level inverts ", register_field(device, item.inverts))
    if item.needs:
        yield said("Has an effect only if enabled by ", register_field(device, item.needs))
    if item.when_unused:
        yield said(f"Connect it to {item.when_unused} when it is not used")
