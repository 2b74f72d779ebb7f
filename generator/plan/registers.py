"""Registers that identify an encoder, and registers that hold parameters at run time."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Field, Parameter, Register, assert_never
from ..model.record import dataclass
from .codec import bits_of
from .operations import Bits
from .values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of


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


@dataclass(frozen=True, slots=True)
class HeldParameter:
    """A parameter in a register.

    ``meaning`` converts its bits to an unsigned number. ``low`` and ``high`` are None if no value of the field can be
    outside them. ``highest_value`` is the highest valid one. If the parameter has codes, its bits are one of them, and
    ``low`` and ``high`` are None.
    """

    parameter: Parameter
    field: Field
    bits: Bits
    meaning: Raw | ZeroMeans
    low: int | None
    high: int | None
    highest_value: int


@dataclass(frozen=True, slots=True)
class HoldingRegister:
    """A register, and the parameters that it holds."""

    register: Register
    parameters: tuple[HeldParameter, ...]


def held_parameters(device: Device) -> Iterator[HoldingRegister]:
    """Yield the registers that hold parameters, without duplicates."""
    by_register: dict[str, list[Parameter]] = {}
    for parameter in device.run_time_parameters:
        by_register.setdefault(parameter.register, []).append(parameter)
    for name, parameters in by_register.items():
        register = device.register(name)
        yield HoldingRegister(register, tuple(_held_parameter(register, parameter) for parameter in parameters))


def _held_parameter(register: Register, parameter: Parameter) -> HeldParameter:
    field = register.layout.field(parameter.field)
    bits = bits_of(register.layout, field)
    if parameter.by_code:
        return HeldParameter(
            parameter=parameter,
            field=field,
            bits=bits,
            meaning=Raw(),
            low=None,
            high=None,
            highest_value=max(row.value for row in parameter.by_code),
        )
    meaning, lowest, highest = _unsigned_meaning(field), 0, (1 << field.widest) - 1
    if isinstance(meaning, ZeroMeans):
        lowest, highest = 1, max(highest, meaning.number)
    low = parameter.min if parameter.min is not None and parameter.min > lowest else None
    high = parameter.max if parameter.max is not None and parameter.max < highest else None
    return HeldParameter(
        parameter=parameter,
        field=field,
        bits=bits,
        meaning=meaning,
        low=low,
        high=high,
        highest_value=highest if high is None else high,
    )


def _unsigned_meaning(field: Field) -> Raw | ZeroMeans:
    match meaning_of(field):
        case ZeroMeans() as meaning:
            return meaning
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return Raw()
        case never:
            assert_never(never)
