"""Registers that identify an encoder, and the values to compare."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Field, Register
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class IdentityRegister:
    """A register, and those of its fields that have a documented value."""

    register: Register
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Identity:
    """Identifying registers of one interface. ``alone`` is true if no other interface has such registers."""

    interface: str
    compared: tuple[IdentityRegister, ...]
    alone: bool


def identities(device: Device) -> Iterator[Identity]:
    """Yield the identifying registers of each interface, in the order of the registers."""
    by_interface: dict[str, dict[str, list[Field]]] = {}
    for register, field in device.identity:
        by_interface.setdefault(register.interface, {}).setdefault(register.name, []).append(field)
    for interface, registers in by_interface.items():
        compared = (IdentityRegister(device.register(name), tuple(fields)) for name, fields in registers.items())
        yield Identity(interface, tuple(compared), len(by_interface) == 1)
