"""Parameters that registers hold at run time, and values read from registers."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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


#: Values of the parameters that one register field holds.
State = Mapping[str, int]
#: Highest number of combinations of states. If there are more, only pairs of fields are combined.
_MOST_CORNERS = 64


def corners(fields: Sequence[Sequence[State]]) -> Iterator[State]:
    """Yield combined states of register fields, since a value may fit with one extreme but not with two.

    If there are too many, yield those of each pair with the others unchanged, and those with all at the same extreme.

    Args:
        fields: The states of each field, from the one with the lowest values to the one with the highest.
    """
    found = [states for states in fields if states]
    if prod(map(len, found)) <= _MOST_CORNERS:
        yield from _joint(found)
        return
    for pair in combinations(found, 2):
        yield from _joint(pair)
    yield from (ChainMap(*(dict(states[end]) for states in found)) for end in (0, -1))


def _joint(fields: Sequence[Sequence[State]]) -> Iterator[State]:
    for states in product(*fields):
        yield ChainMap(*map(dict, states))


def coded_states(codes: Mapping[str, Mapping[int, int]]) -> Sequence[State]:
    """Return the states of a field that holds a code, for the codes that all its parameters have.

    Args:
        codes: The values by code of each parameter that is read from the field.
    """
    common = set.intersection(*(set(values) for values in codes.values()))
    states = [{name: values[code] for name, values in codes.items()} for code in sorted(common)]
    return sorted(states, key=lambda state: sum(state.values()))


def extreme_states(device: Device) -> Sequence[Sequence[State]]:
    """Return the extreme states of each field that holds a parameter: the limits of its value, or each of its codes."""
    return _states(device.run_time_parameters, lambda item: dict.fromkeys(_limits(item)))


def possible_states(parameters: Sequence[Parameter]) -> Sequence[Sequence[State]]:
    """Return the states of each field that holds one of the parameters."""
    return _states(parameters, lambda item: range(item.min or 0, (item.max or 0) + 1))


def _limits(item: Parameter) -> Iterator[int]:
    return (bound for bound in (item.min, item.max) if bound is not None)


def _states(parameters: Sequence[Parameter], plain: Callable[[Parameter], Iterable[int]]) -> Sequence[Sequence[State]]:
    coded: dict[str, dict[str, Mapping[int, int]]] = {}
    for item in parameters:
        if item.by_code:
            coded.setdefault(item.read_from, {})[item.name] = {one.code: one.value for one in item.by_code}
    direct = [[{item.name: value} for value in plain(item)] for item in parameters if not item.by_code]
    return [*direct, *map(coded_states, coded.values())]


def at_run_time(device: Device, variant: Variant) -> Iterator[Mapping[str, int]]:
    """Yield the parameters of a variant with factory defaults, and with the extremes of those held in registers."""
    for changed in ({}, *corners(extreme_states(device))):
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
        value = _value_in(register, item, number)
        if value is not None:  # With an invalid code, the encoder keeps its frame format.
            parameters[name] = value
    return replace(variant, parameters=with_changed(device, variant, parameters))


def _value(register: Register, parameter: Parameter, held: Mapping[int, int]) -> int:
    """Return the value of the parameter from the register's bytes in ``held`` or its default."""
    default = register.default_bytes() or bytes(register.length)
    data = bytes(held.get(register.address + index, byte) for index, byte in enumerate(default))
    value = _value_in(register, parameter, number_from_bytes(register.layout, data))
    if value is None:
        codes = ", ".join(str(item.code) for item in parameter.by_code)
        raise RegisterError(f"{parameter.read_from} does not hold a code of {parameter.name}; the codes are {codes}")
    low, high = parameter.min or 0, parameter.max if parameter.max is not None else value
    if not low <= value <= high:
        raise RegisterError(f"{parameter.name} is {value}; it can be {low} to {high}")
    return value


def _value_in(register: Register, parameter: Parameter, number: int) -> int | None:
    """Return the parameter that is in the content of a register, or None if it holds no valid code."""
    field = register.layout.field(parameter.field)
    held = number >> field.low.constant & ((1 << field.widest) - 1)
    return parameter.held_value(held if parameter.by_code else held or field.number.zero_means)
