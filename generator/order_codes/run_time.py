"""Parameters that registers hold at run time, and values read from registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product
from math import prod
from types import MappingProxyType

from ..model import Device, Parameter, Register, Variant, number_from_bytes
from ..model.expressions import Expression, ExpressionError


class RegisterError(ValueError):
    """A register is unknown, or its bytes or value are invalid."""


def resolve_parameters(given: Mapping[str, int], definitions: Mapping[str, Expression]) -> Mapping[str, int]:
    """Return ``given`` together with all parameters that are calculated from others."""
    parameters = dict(given)
    left = {name: item for name, item in definitions.items() if name not in parameters}
    while left:
        ready = [name for name, item in left.items() if all(other in parameters for other in item.parameters)]
        if not ready:
            break
        for name in ready:
            try:
                parameters[name] = left.pop(name).value(parameters)
            except ExpressionError:
                parameters[name] = 0  # out of range, reported where the width is used
    return MappingProxyType(parameters)


def with_changed(device: Device, variant: Variant, changed: Mapping[str, int]) -> Mapping[str, int]:
    """Return the parameters of a variant with some values changed, and those that follow from them."""
    given = {name: value for name, value in variant.parameters.items() if name not in device.definitions}
    return resolve_parameters({**given, **changed}, device.definitions)


#: Highest number of combinations of extremes. If there are more, only pairs of parameters are combined.
_MOST_CORNERS = 64


def corners(extremes: Mapping[str, Sequence[int]]) -> Iterator[Mapping[str, int]]:
    """Yield combined extremes of parameters, since a value may fit with one extreme but not with two.

    If there are too many, yield those of each pair with the others unchanged, and those with all at the same extreme.
    """
    names = [name for name, values in extremes.items() if values]
    if prod(len(set(extremes[name])) for name in names) <= _MOST_CORNERS:
        yield from _joint(names, extremes)
        return
    for pair in combinations(names, 2):
        yield from _joint(pair, extremes)
    yield from ({name: end(extremes[name]) for name in names} for end in (min, max))


def _joint(names: Sequence[str], extremes: Mapping[str, Sequence[int]]) -> Iterator[Mapping[str, int]]:
    for values in product(*(dict.fromkeys(extremes[name]) for name in names)):
        yield dict(zip(names, values, strict=True))


def at_run_time(device: Device, variant: Variant) -> Iterator[Mapping[str, int]]:
    """Yield the parameters of a variant with factory defaults, and with the extremes of those held in registers."""
    bounds = {
        item.name: [bound for bound in (item.min, item.max) if bound is not None] for item in device.run_time_parameters
    }
    for changed in ({}, *corners(bounds)):
        yield with_changed(device, variant, changed)


def with_registers(device: Device, variant: Variant, held: Mapping[int, int]) -> Variant:
    """Return the variant with these register values.

    Args:
        device: The family.
        variant: One of its order codes.
        held: Register bytes by address. Other registers are at their defaults.

    Raises:
        RegisterError: There is no parameter at an address, or a value is invalid.
    """
    parameters: dict[str, int] = {}
    used: set[int] = set()
    for item in device.run_time_parameters:
        register = device.register(item.register)
        addresses = range(register.address, register.address + register.length)
        if not used.union(addresses) & held.keys():
            continue
        used.update(addresses)
        parameters[item.name] = _value(register, item, held)
    unknown = sorted(held.keys() - used)
    if unknown:
        known = (
            ", ".join(
                sorted({f"0x{device.register(item.register).address:02X}" for item in device.run_time_parameters})
            )
            or "none"
        )
        raise RegisterError(f"register 0x{unknown[0]:02X} does not change how a frame is read; those that do: {known}")
    return replace(variant, parameters=with_changed(device, variant, parameters))


def decided(device: Device, variant: Variant, answers: Mapping[str, str]) -> Variant:
    """Return the variant with these answers, keyed by the name of the alternative.

    Raises:
        KeyError: There is no such alternative or answer.
    """
    parameters: dict[str, int] = {}
    known = {item.name: {answer.name: answer.sets for answer in item.answers} for item in device.alternatives}
    for name, answer in answers.items():
        parameters |= known[name][answer]
    return replace(variant, parameters=with_changed(device, variant, parameters))


def after_write(device: Device, variant: Variant, register: Register, number: int) -> Variant:
    """Return the variant after writing ``number`` to ``register``."""
    held = {item.name: item for item in device.run_time_parameters if item.register == register.name}
    if not held:
        return variant
    parameters: dict[str, int] = {}
    for name, item in held.items():
        field = register.layout.field(item.field)
        parameters[name] = number >> field.low.constant & ((1 << field.widest) - 1) or field.number.zero_means
    return replace(variant, parameters=with_changed(device, variant, parameters))


def _value(register: Register, parameter: Parameter, held: Mapping[int, int]) -> int:
    """Return the value of the parameter from the register's bytes in ``held`` or its default."""
    default = register.default_bytes() or bytes(register.length)
    data = bytes(held.get(register.address + index, byte) for index, byte in enumerate(default))
    field = register.layout.field(parameter.field)
    value = (
        number_from_bytes(register.layout, data) >> field.low.constant & ((1 << field.widest) - 1)
        or field.number.zero_means
    )
    low, high = parameter.min or 0, parameter.max if parameter.max is not None else value
    if not low <= value <= high:
        raise RegisterError(f"{parameter.name} is {value}; it can be {low} to {high}")
    return value
