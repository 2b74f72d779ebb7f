"""Parameters that registers hold at run time: how to read them from the bytes, and which values are invalid."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Field, Parameter, Register, assert_never
from ..model.record import dataclass
from .codec import Bits, bits_of
from .values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of


@dataclass(frozen=True, slots=True)
class Held:
    """A parameter in a register.

    ``meaning`` converts its bits to an unsigned number. ``low`` and ``high`` are None if no value of the field can be
    outside them. ``most`` is the highest valid value. If the parameter has codes, its bits are one of them, and
    ``low`` and ``high`` are None.
    """

    parameter: Parameter
    field: Field
    bits: Bits
    meaning: Raw | ZeroMeans
    low: int | None
    high: int | None
    most: int


@dataclass(frozen=True, slots=True)
class HeldBy:
    """A register, and the parameters that it holds."""

    register: Register
    parameters: tuple[Held, ...]


def held_parameters(device: Device) -> Iterator[HeldBy]:
    """Yield the registers that hold parameters, without duplicates."""
    by_register: dict[str, list[Parameter]] = {}
    for item in device.run_time_parameters:
        by_register.setdefault(item.register, []).append(item)
    for name, parameters in by_register.items():
        register = device.register(name)
        yield HeldBy(register, tuple(_held(register, item) for item in parameters))


def _held(register: Register, parameter: Parameter) -> Held:
    field = register.layout.field(parameter.field)
    bits = bits_of(register.layout, field)
    if parameter.by_code:
        return Held(parameter, field, bits, Raw(), None, None, max(item.value for item in parameter.by_code))
    meaning, most = _meaning(field), (1 << field.widest) - 1
    least, most = (0, most) if isinstance(meaning, Raw) else (1, max(most, meaning.number))
    low = parameter.min if parameter.min is not None and parameter.min > least else None
    high = parameter.max if parameter.max is not None and parameter.max < most else None
    return Held(parameter, field, bits, meaning, low, high, most if high is None else high)


def _meaning(field: Field) -> Raw | ZeroMeans:
    match meaning_of(field):
        case ZeroMeans() as meaning:
            return meaning
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return Raw()
        case other:
            assert_never(other)
