"""Parameters by interface, those that registers hold at run time, and values read from registers."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product
from math import prod
from types import MappingProxyType

from ..model import Device, Layout, Measurement, Parameter, Register, Variant, number_from_bytes
from ..model.expressions import Expression, ExpressionError


def parameters_of(device: Device, kind: str) -> tuple[Parameter, ...]:
    """Return the parameters that matter for the interface ``kind``.

    Parameters used only by other interfaces are omitted, unless they are calculated from the parameters kept.
    Parameters that no interface uses are kept, since they are for information.
    """
    used_here = _used(device, kind)
    used_by_any: set[str] = set()
    for interface in device.interfaces:
        used_by_any |= _used(device, interface.name)
    formulas: dict[str, Expression] = {}
    selected_names: set[str] = set()
    for parameter in device.parameters:
        if parameter.interface not in ("", kind):
            continue
        if parameter.equals is not None:
            formulas[parameter.name] = parameter.equals
        if parameter.name in used_here or (parameter.equals is None and parameter.name not in used_by_any):
            selected_names.add(parameter.name)
    # A formula may use the result of another one, so look until nothing is added.
    while True:
        computable = {name for name, formula in formulas.items() if selected_names.issuperset(formula.parameters)}
        if computable <= selected_names:
            break
        selected_names |= computable
    return tuple(parameter for parameter in device.parameters if parameter.name in selected_names)


def run_time_names(device: Device) -> frozenset[str]:
    """Return the parameters that registers hold, and those calculated from them."""
    held_names = {parameter.name for parameter in device.run_time_parameters}
    names = (parameter.name for parameter in device.parameters)
    return frozenset(name for name in names if not held_names.isdisjoint(device.needed_parameters([name])))


def follows_registers(device: Device, layout: Layout) -> bool:
    """Return whether registers determine the positions or the code of a layout's fields at run time."""
    return not run_time_names(device).isdisjoint(deciding_parameters(layout))


def deciding_parameters(layout: Layout) -> frozenset[str]:
    """Return the parameters that determine the positions, documented values or code of a layout's fields."""
    names = (name for expression in _of_layout(layout) for name in expression.parameters)
    return frozenset((layout.gray_when, *names)) - {""}


def run_time_widths(device: Device, layout: Layout) -> tuple[str, ...]:
    """Return the register fields, as ``register.field``, that determine the length of a layout."""
    names = device.needed_parameters(layout.bits.parameters)
    return tuple(
        dict.fromkeys(parameter.read_from for parameter in device.run_time_parameters if parameter.name in names)
    )


def _used(device: Device, kind: str) -> frozenset[str]:
    """Return the parameters used in frames, registers and measurement of an interface, and their dependencies."""
    used_names = {name for expression in _expressions(device, kind) for name in expression.parameters}
    used_names |= {layout.gray_when for layout in device.interface(kind).layouts if layout.gray_when}
    return device.needed_parameters(used_names)


def _expressions(device: Device, kind: str) -> Iterator[Expression]:
    """Yield the expressions in frames, registers and measurement of an interface."""
    layouts = device.interface(kind).layouts
    for layout in layouts:
        yield from _of_layout(layout)
        if layout.position_range is not None:
            yield from layout.position_range.numbers
    for register in device.registers_over(kind):
        yield from _of_layout(register.layout)
        bounds = [register.min, register.max]
        for meaning in register.meanings:
            bounds += [meaning.min, meaning.max]
        yield from (bound for bound in bounds if bound is not None)
    measurement = device.measurement_of(kind)
    if measurement is not None:
        yield from _of_measurement(measurement)


def _of_layout(layout: Layout) -> Iterator[Expression]:
    yield layout.bits
    for field in layout.fields:
        yield field.low
        yield field.width
        if isinstance(field.equals, Expression):
            yield field.equals
    if layout.gray_excess is not None:
        yield layout.gray_excess


def _of_measurement(measurement: Measurement) -> Iterator[Expression]:
    expressions = (
        measurement.counts_per_turn,
        measurement.turns,
        *measurement.steps,
        measurement.modulus,
        measurement.highest,
    )
    yield from (expression for expression in expressions if expression is not None)


class RegisterError(ValueError):
    """A register is unknown, or its bytes or value are invalid."""


def resolve_parameters(known_values: Mapping[str, int], definitions: Mapping[str, Expression]) -> Mapping[str, int]:
    """Return ``known_values`` together with all parameters that are calculated from others."""
    parameters = dict(known_values)
    pending = {name: definition for name, definition in definitions.items() if name not in parameters}
    while pending:
        ready = [name for name, definition in pending.items() if parameters.keys() >= set(definition.parameters)]
        if not ready:
            break
        for name in ready:
            try:
                parameters[name] = pending.pop(name).value(parameters)
            except ExpressionError:
                parameters[name] = 0  # out of range, reported where the width is used
    return MappingProxyType(parameters)


def with_changed(device: Device, variant: Variant, changed: Mapping[str, int]) -> Mapping[str, int]:
    """Return the parameters of a variant with some values changed, and those that follow from them."""
    independent_values = {name: value for name, value in variant.parameters.items() if name not in device.definitions}
    return resolve_parameters({**independent_values, **changed}, device.definitions)


#: Values of the parameters that one register field holds.
State = Mapping[str, int]
#: Highest number of combinations of states. If there are more, only pairs of fields are combined.
_MOST_CORNERS = 64


def corners(states_by_field: Sequence[Sequence[State]]) -> Iterator[State]:
    """Yield combined states of register fields, since a value may fit with one extreme but not with two.

    If there are too many, yield those of each pair with the others unchanged, and those with all at the same extreme.

    Args:
        states_by_field: The states of each field, from the one with the lowest values to the one with the highest.
    """
    changing_fields = [states for states in states_by_field if states]
    if prod(map(len, changing_fields)) <= _MOST_CORNERS:
        yield from _combined_states(changing_fields)
        return
    for pair in combinations(changing_fields, 2):
        yield from _combined_states(pair)
    for end in (0, -1):
        yield ChainMap(*(dict(states[end]) for states in changing_fields))


def _combined_states(states_by_field: Sequence[Sequence[State]]) -> Iterator[State]:
    for states in product(*states_by_field):
        yield ChainMap(*map(dict, states))


def coded_states(codes: Mapping[str, Mapping[int, int]]) -> Sequence[State]:
    """Return the states of a field that holds a code, for the codes that all its parameters have.

    Args:
        codes: The values by code of each parameter that is read from the field.
    """

    def state_with(code: int) -> State:
        return {name: values[code] for name, values in codes.items()}

    common_codes = set.intersection(*map(set, codes.values()))
    return sorted(map(state_with, sorted(common_codes)), key=lambda state: sum(state.values()))


def extreme_states(device: Device) -> Sequence[Sequence[State]]:
    """Return the extreme states of each field that holds a parameter: the limits of its value, or each of its codes."""
    return _states(device.run_time_parameters, lambda parameter: dict.fromkeys(_limits(parameter)))


def possible_states(parameters: Sequence[Parameter]) -> Sequence[Sequence[State]]:
    """Return the states of each field that holds one of the parameters."""
    return _states(parameters, lambda parameter: range(parameter.min or 0, (parameter.max or 0) + 1))


def _limits(parameter: Parameter) -> Iterator[int]:
    return (bound for bound in (parameter.min, parameter.max) if bound is not None)


def _states(
    parameters: Sequence[Parameter], values_of: Callable[[Parameter], Iterable[int]]
) -> Sequence[Sequence[State]]:
    """Return the states of each field. ``values_of`` lists the values of a parameter that is not read from a code."""
    codes_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    direct_states: list[Sequence[State]] = []
    for parameter in parameters:
        if parameter.by_code:
            value_by_code = {coded.code: coded.value for coded in parameter.by_code}
            codes_by_field.setdefault(parameter.read_from, {})[parameter.name] = value_by_code
        else:
            direct_states.append([{parameter.name: value} for value in values_of(parameter)])
    return [*direct_states, *map(coded_states, codes_by_field.values())]


def parameters_at_run_time(device: Device, variant: Variant) -> Iterator[Mapping[str, int]]:
    """Yield the parameters of a variant with factory defaults, and with the extremes of those held in registers."""
    for changed in ({}, *corners(extreme_states(device))):
        yield with_changed(device, variant, changed)


def with_registers(device: Device, variant: Variant, register_bytes: Mapping[int, int]) -> Variant:
    """Return the variant with these register values.

    Args:
        device: The family.
        variant: One of its order codes.
        held: Register bytes by address. Other registers are at their defaults.

    Raises:
        RegisterError: There is no parameter at an address, or a value is invalid.
    """
    parameters: dict[str, int] = {}
    used_addresses: set[int] = set()
    for parameter in device.run_time_parameters:
        register = device.register(parameter.register)
        addresses = range(register.address, register.address + register.length)
        if not used_addresses.union(addresses) & register_bytes.keys():
            continue
        used_addresses.update(addresses)
        parameters[parameter.name] = _value(register, parameter, register_bytes)
    unknown_addresses = sorted(register_bytes.keys() - used_addresses)
    if unknown_addresses:
        registers = [device.register(parameter.register) for parameter in device.run_time_parameters]
        valid_addresses = ", ".join(sorted({f"0x{register.address:02X}" for register in registers})) or "none"
        raise RegisterError(
            f"register 0x{unknown_addresses[0]:02X} does not change how a frame is read; "
            f"those that do: {valid_addresses}"
        )
    return replace(variant, parameters=with_changed(device, variant, parameters))


def with_answers(device: Device, variant: Variant, answers: Mapping[str, str]) -> Variant:
    """Return the variant with these answers, keyed by the name of the alternative.

    Raises:
        KeyError: There is no such alternative or answer.
    """
    parameters: dict[str, int] = {}
    alternatives = {alternative.name: alternative for alternative in device.alternatives}
    for name, answer_name in answers.items():
        sets_by_answer = {answer.name: answer.sets for answer in alternatives[name].answers}
        parameters |= sets_by_answer[answer_name]
    return replace(variant, parameters=with_changed(device, variant, parameters))


def after_write(device: Device, variant: Variant, register: Register, number: int) -> Variant:
    """Return the variant after writing ``number`` to ``register``."""
    held_parameters = [parameter for parameter in device.run_time_parameters if parameter.register == register.name]
    if not held_parameters:
        return variant
    parameters: dict[str, int] = {}
    for parameter in held_parameters:
        value = _value_in_content(register, parameter, number)
        if value is not None:  # With an invalid code, the encoder keeps its frame format.
            parameters[parameter.name] = value
    return replace(variant, parameters=with_changed(device, variant, parameters))


def _value(register: Register, parameter: Parameter, register_bytes: Mapping[int, int]) -> int:
    """Return the value of the parameter from the register's bytes in ``register_bytes`` or its default."""
    default = register.default_bytes() or bytes(register.length)
    data = bytes(register_bytes.get(register.address + index, byte) for index, byte in enumerate(default))
    value = _value_in_content(register, parameter, number_from_bytes(register.layout, data))
    if value is None:
        codes = ", ".join(str(coded_value.code) for coded_value in parameter.by_code)
        raise RegisterError(f"{parameter.read_from} does not hold a code of {parameter.name}; the codes are {codes}")
    low = parameter.min or 0
    high = value if parameter.max is None else parameter.max
    if not low <= value <= high:
        raise RegisterError(f"{parameter.name} is {value}; it can be {low} to {high}")
    return value


def _value_in_content(register: Register, parameter: Parameter, number: int) -> int | None:
    """Return the parameter that is in the content of a register, or None if it holds no valid code."""
    field = register.layout.field(parameter.field)
    mask = (1 << field.widest) - 1
    content = (number >> field.low.constant) & mask
    if content == 0 and not parameter.by_code:
        content = field.number.zero_means
    return parameter.held_value(content)
