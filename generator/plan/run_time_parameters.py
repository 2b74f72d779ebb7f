"""Parameters that registers hold at run time: how they are read from the bytes, and which values are invalid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..model import Device, Field, Parameter, Register
from .codec import Bits, bits_of
from .values import Meaning, ZeroMeans, meaning_of


@dataclass(frozen=True, slots=True)
class Held:
    """A parameter in a register.

    ``low`` and ``high`` are None if no value of the field is beyond them. ``most`` is the highest valid value.
    """

    parameter: Parameter
    field: Field
    bits: Bits
    low: int | None
    high: int | None
    most: int

    @property
    def meaning(self) -> Meaning:
        """Operation that converts its bits."""
        return meaning_of(self.field)


@dataclass(frozen=True, slots=True)
class HeldBy:
    """A register, and the parameters that it holds."""

    register: Register
    parameters: tuple[Held, ...]


def held_parameters(device: Device) -> Iterator[HeldBy]:
    """Yield the registers that hold parameters, each once."""
    by_register: dict[str, list[Parameter]] = {}
    for item in device.run_time_parameters:
        by_register.setdefault(item.register, []).append(item)
    for name, parameters in by_register.items():
        register = device.register(name)
        yield HeldBy(register, tuple(_held(register, item) for item in parameters))


def _held(register: Register, parameter: Parameter) -> Held:
    field = register.layout.field(parameter.field)
    match meaning_of(field):
        case ZeroMeans(number):
            least, most = 1, max((1 << field.widest) - 1, number)
        case _:
            least, most = 0, (1 << field.widest) - 1
    low = parameter.min if parameter.min is not None and parameter.min > least else None
    high = parameter.max if parameter.max is not None and parameter.max < most else None
    return Held(parameter, field, bits_of(register.layout, field), low, high, most if high is None else high)
