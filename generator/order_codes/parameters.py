"""Parameters of an interface, values that registers hold at run time, and layouts that are sent with parameters."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product
from math import prod

from ..model import (
    Biss,
    DataChannels,
    Device,
    Interface,
    Layout,
    Measurement,
    Parameter,
    Register,
    Variant,
    number_from_bytes,
)
from ..model.expressions import Expression, resolve_parameters


def parameters_of(device: Device, interface_name: str) -> tuple[Parameter, ...]:
    """Return the parameters of a device that matter for the interface ``interface_name``, such as ``biss``.

    These are the parameters that the interface uses, all parameters that are calculated from them, and parameters that
    no interface uses, which are for information.
    """
    # Both sets include the parameters from which used parameters are calculated.
    used_by_interface = _used_parameters(device, interface_name)
    used_by_any: set[str] = set()
    for interface in device.interfaces:
        used_by_any |= _used_parameters(device, interface.name)
    formula_by_name: dict[str, Expression] = {}
    selected_names: set[str] = set()
    for parameter in device.parameters:
        if parameter.interface not in ("", interface_name):
            continue
        if parameter.equals is not None:
            formula_by_name[parameter.name] = parameter.equals
        is_for_information = parameter.equals is None and parameter.name not in used_by_any
        if parameter.name in used_by_interface or is_for_information:
            selected_names.add(parameter.name)
    selected_names |= _computable_names(formula_by_name, known_names=selected_names)
    return tuple(parameter for parameter in device.parameters if parameter.name in selected_names)


def _computable_names(formula_by_name: Mapping[str, Expression], known_names: Collection[str]) -> set[str]:
    """Return the names of the parameters whose formulas only need known parameters, or others that are computable."""
    computable_names: set[str] = set()
    # A formula may use the result of another formula, so repeat until no parameter is added.
    while True:
        usable_names = {*known_names, *computable_names}
        next_names = {name for name, formula in formula_by_name.items() if usable_names.issuperset(formula.parameters)}
        if next_names <= computable_names:
            return computable_names
        computable_names |= next_names


def run_time_names(device: Device) -> frozenset[str]:
    """Return the names of the parameters that registers hold, and of parameters that are calculated from them."""
    names_in_registers = {parameter.name for parameter in device.run_time_parameters}
    dependent_names: set[str] = set()
    for parameter in device.parameters:
        if not names_in_registers.isdisjoint(device.needed_parameters([parameter.name])):
            dependent_names.add(parameter.name)
    return frozenset(dependent_names)


def follows_registers(device: Device, layout: Layout) -> bool:
    """Return whether the format of a layout depends on registers at run time.

    The format consists of the positions, the documented values and the code (binary or Gray) of the fields.
    """
    return not run_time_names(device).isdisjoint(deciding_parameters(layout))


def deciding_parameters(layout: Layout) -> frozenset[str]:
    """Return the names of the parameters that determine the format of a layout.

    The format consists of the positions, the documented values and the code (binary or Gray) of the fields.
    """
    names: set[str] = set()
    for expression in _expressions_of_layout(layout):
        names.update(expression.parameters)
    if layout.gray_when:  # The parameter that switches Gray code on.
        names.add(layout.gray_when)
    return frozenset(names)


def run_time_widths(device: Device, layout: Layout) -> tuple[str, ...]:
    """Return the register fields that determine the length of a layout at run time, each as ``register.field``."""
    length_parameters = device.needed_parameters(layout.bits.parameters)
    deciding = [parameter for parameter in device.run_time_parameters if parameter.name in length_parameters]
    register_fields = [parameter.read_from for parameter in deciding]
    return tuple(dict.fromkeys(register_fields))  # Several parameters can be read from the same field.


def _used_parameters(device: Device, interface_name: str) -> frozenset[str]:
    """Return the names of the parameters that are used in the frames, registers and measurement of an interface.

    Parameters from which these parameters are calculated are included.
    """
    used_names: set[str] = set()
    for expression in _expressions_over(device, interface_name):
        used_names.update(expression.parameters)
    for layout in device.interface(interface_name).layouts:
        if layout.gray_when:  # The parameter that switches Gray code on.
            used_names.add(layout.gray_when)
    return device.needed_parameters(used_names)


def _expressions_over(device: Device, interface_name: str) -> Iterator[Expression]:
    """Yield the expressions in the frames and registers of an interface, and in the description of its position."""
    for layout in device.interface(interface_name).layouts:
        yield from _expressions_of_layout(layout)
        if layout.position_range is not None:
            yield from layout.position_range.numbers
    for register in device.registers_over(interface_name):
        yield from _expressions_of_layout(register.layout)
        bounds = [register.min, register.max]
        for meaning in register.meanings:
            bounds += [meaning.min, meaning.max]
        yield from (bound for bound in bounds if bound is not None)
    measurement = device.measurement_of(interface_name)
    if measurement is not None:
        yield from _expressions_of_measurement(measurement)


def _expressions_of_layout(layout: Layout) -> Iterator[Expression]:
    """Yield all expressions in a frame or register: its length, and the fields' positions, widths and fixed values.

    A Gray-coded layout can also have an excess, a number that is added to the position before it is encoded.
    """
    yield layout.bits
    for field in layout.fields:
        yield field.low
        yield field.width
        if isinstance(field.equals, Expression):
            yield field.equals
    if layout.gray_excess is not None:
        yield layout.gray_excess


def _expressions_of_measurement(measurement: Measurement) -> Iterator[Expression]:
    """Yield the expressions that describe a position: counts per turn, turns, steps and limits, if they are given."""
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


def with_changed(device: Device, variant: Variant, changed: Mapping[str, int]) -> Mapping[str, int]:
    """Return the parameters of an order code with some values changed, and calculate the dependent ones again."""
    formulas = device.definitions
    independent_values = {name: value for name, value in variant.parameters.items() if name not in formulas}
    return resolve_parameters({**independent_values, **changed}, formulas)


#: Values of the parameters that one register field holds.
State = Mapping[str, int]
#: Highest number of combinations of states. If there are more, only pairs of fields are combined.
_MAX_COMBINATIONS = 64


def extreme_combinations(states_by_field: Sequence[Sequence[State]]) -> Iterator[State]:
    """Yield combined states of register fields, such as ``{"singleturn_bits": 16, "multiturn_bits": 12}``.

    A state contains the parameters that one register field sets. All combinations are yielded if there are at most 64.
    Otherwise, these are the combinations of each pair of fields, with the other fields unchanged, and the combinations
    with all fields at their lowest or at their highest state.

    Args:
        states_by_field: The states of each field, from the lowest values to the highest.
    """
    states_of_changing_fields = [states for states in states_by_field if states]
    number_of_combinations = prod(len(states) for states in states_of_changing_fields)
    if number_of_combinations <= _MAX_COMBINATIONS:
        yield from _combined_states(states_of_changing_fields)
        return
    for states_of_pair in combinations(states_of_changing_fields, 2):
        yield from _combined_states(states_of_pair)
    yield _joined_state([states[0] for states in states_of_changing_fields])
    yield _joined_state([states[-1] for states in states_of_changing_fields])


def _combined_states(states_by_field: Sequence[Sequence[State]]) -> Iterator[State]:
    """Yield every combination of register fields, with one state of each field."""
    for one_state_per_field in product(*states_by_field):
        yield _joined_state(one_state_per_field)


def _joined_state(one_state_per_field: Iterable[State]) -> State:
    """Return the parameters that all register fields set, in one map."""
    return ChainMap(*(dict(state) for state in one_state_per_field))


def coded_states(codes: Mapping[str, Mapping[int, int]]) -> Sequence[State]:
    """Return the states of a register field that holds a code, for each code that all its parameters have.

    A state contains the parameters that the code sets. The states are sorted by the sum of their values.

    Args:
        codes: The values by code of each parameter that is read from the field: ``{"bits": {0: 12, 1: 16}}``.
    """

    common_codes = set.intersection(*map(set, codes.values()))
    states: list[State] = []
    for code in sorted(common_codes):
        states.append({name: value_by_code[code] for name, value_by_code in codes.items()})
    return sorted(states, key=lambda state: sum(state.values()))


def extreme_states(device: Device) -> Sequence[Sequence[State]]:
    """Return the extreme states of each register field that holds a parameter.

    These are the limits of the parameter, or the values of all codes if the field holds a code.
    """
    return _states_of_fields(device.run_time_parameters, _limits_of_parameter)


def possible_states(parameters: Sequence[Parameter]) -> Sequence[Sequence[State]]:
    """Return all states of each register field that holds one of the parameters: every value, or every code."""

    def all_values(parameter: Parameter) -> Iterable[int]:
        lowest, highest = parameter.min or 0, parameter.max or 0
        return range(lowest, highest + 1)

    return _states_of_fields(parameters, all_values)


def _limits_of_parameter(parameter: Parameter) -> Iterable[int]:
    """Return the minimum and the maximum of a parameter, as far as they are known. Equal limits are returned once."""
    return dict.fromkeys(limit for limit in (parameter.min, parameter.max) if limit is not None)


def _states_of_fields(
    parameters: Sequence[Parameter], list_values: Callable[[Parameter], Iterable[int]]
) -> Sequence[Sequence[State]]:
    """Return the states of each register field that holds parameters, from the lowest values to the highest.

    A parameter without codes has a field of its own, with one state for each number that ``list_values`` returns.
    Parameters that are read from the same code change together, so their field has a state for each code:
    ``[{"bits": 12, "turns": 0}, {"bits": 16, "turns": 4096}]``.
    """
    # By the field that holds the code, then by parameter, then by code: {"bank.mode": {"bits": {0: 12, 1: 16}}}.
    codes_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    states_by_field: list[Sequence[State]] = []
    for parameter in parameters:
        if parameter.by_code:
            value_by_code = {coded.code: coded.value for coded in parameter.by_code}
            codes_by_field.setdefault(parameter.read_from, {})[parameter.name] = value_by_code
        else:
            states_by_field.append([{parameter.name: value} for value in list_values(parameter)])
    states_by_field += [coded_states(codes) for codes in codes_by_field.values()]
    return states_by_field


def parameters_at_run_time(device: Device, variant: Variant) -> Iterator[Mapping[str, int]]:
    """Yield the parameters of an order code with factory defaults, and with extreme values in its registers."""
    factory_defaults: State = {}
    for register_values in (factory_defaults, *extreme_combinations(extreme_states(device))):
        yield with_changed(device, variant, register_values)


def with_registers(device: Device, variant: Variant, register_bytes: Mapping[int, int]) -> Variant:
    """Return an order code with the parameters that these register bytes set.

    Args:
        device: The family.
        variant: One of its order codes.
        register_bytes: Register bytes by address. Other registers are at their defaults.

    Raises:
        RegisterError: There is no parameter at an address, or a value is invalid.
    """
    parameters: dict[str, int] = {}
    used_addresses: set[int] = set()
    for parameter in device.run_time_parameters:
        register = device.register(parameter.register)
        addresses = range(register.address, register.address + register.length)
        has_given_bytes = any(address in register_bytes for address in addresses)
        if has_given_bytes:
            used_addresses.update(addresses)
            parameters[parameter.name] = _value_from_bytes(register, parameter, register_bytes)
    unknown_addresses = sorted(register_bytes.keys() - used_addresses)
    if unknown_addresses:
        raise RegisterError(_unknown_address_message(device, unknown_addresses[0]))
    return replace(variant, parameters=with_changed(device, variant, parameters))


def _unknown_address_message(device: Device, address: int) -> str:
    """Return the message for a register that holds no parameter. It lists the registers that hold one."""
    registers = [device.register(parameter.register) for parameter in device.run_time_parameters]
    valid_addresses = ", ".join(sorted({f"0x{register.address:02X}" for register in registers})) or "none"
    return f"register 0x{address:02X} does not change how a frame is read; those that do: {valid_addresses}"


def with_answers(device: Device, variant: Variant, chosen_answers: Mapping[str, str]) -> Variant:
    """Return an order code with the parameters that the user's answers to open questions set.

    The manual leaves such a question, an alternative, open. ``chosen_answers`` contains the name of the answer to each
    question, by the name of the alternative.

    Raises:
        KeyError: There is no such alternative or answer.
    """
    parameters_of_answers: dict[str, int] = {}
    questions = {alternative.name: alternative for alternative in device.alternatives}
    for question_name, chosen_name in chosen_answers.items():
        possible_answers = {answer.name: answer for answer in questions[question_name].answers}
        chosen_answer = possible_answers[chosen_name]
        parameters_of_answers |= chosen_answer.sets
    return replace(variant, parameters=with_changed(device, variant, parameters_of_answers))


def after_write(device: Device, variant: Variant, register: Register, number: int) -> Variant:
    """Return an order code with the parameters that are active after writing ``number`` to ``register``.

    The limits of the register are not checked. If the register holds no parameter, or if ``number`` does not contain a
    valid code, ``variant`` is returned unchanged.
    """
    changed_parameters: dict[str, int] = {}
    for parameter in device.run_time_parameters:
        if parameter.register != register.name:
            continue
        value = _value_in_content(register, parameter, number)
        if value is not None:  # With an invalid code, the encoder keeps its frame format.
            changed_parameters[parameter.name] = value
    if not changed_parameters:
        return variant
    return replace(variant, parameters=with_changed(device, variant, changed_parameters))


def _value_from_bytes(register: Register, parameter: Parameter, register_bytes: Mapping[int, int]) -> int:
    """Return the value of a parameter that a register holds. Bytes that are not given have their factory defaults.

    Raises:
        RegisterError: The register does not hold a code of the parameter, or the value is outside its limits.
    """
    default_bytes = register.default_bytes() or bytes(register.length)
    content = bytearray()
    for address, default_byte in enumerate(default_bytes, register.address):
        content.append(register_bytes.get(address, default_byte))
    value = _value_in_content(register, parameter, number_from_bytes(register.layout, bytes(content)))
    if value is None:
        codes = ", ".join(str(coded_value.code) for coded_value in parameter.by_code)
        raise RegisterError(f"{parameter.read_from} does not hold a code of {parameter.name}; the codes are {codes}")
    lowest = parameter.min or 0
    highest = value if parameter.max is None else parameter.max
    if not lowest <= value <= highest:
        raise RegisterError(f"{parameter.name} is {value}; it can be {lowest} to {highest}")
    return value


def _value_in_content(register: Register, parameter: Parameter, register_content: int) -> int | None:
    """Return the value of a parameter in a register with this content, or None if its code is not valid.

    In some registers, 0 stands for a different number, ``zero_means``: 256 in 8 bits, for example.
    """
    field = register.layout.field(parameter.field)
    mask = (1 << field.widest) - 1
    stored_number = (register_content >> field.low.constant) & mask
    if stored_number == 0 and not parameter.by_code:
        stored_number = field.number.zero_means
    return parameter.held_value(stored_number)


def with_sent_layouts(interface: Interface, parameters: Mapping[str, int]) -> Interface:
    """Return the interface without the layouts that have no bits for an order code with these parameters.

    Their data channels are also left out.
    """
    layouts = tuple(layout for layout in interface.layouts if layout.is_sent(parameters))
    if len(layouts) == len(interface.layouts):
        return interface
    if isinstance(interface, Biss) and interface.channels is not None:
        sent_names = [layout.name for layout in layouts]
        interface = replace(interface, channels=_with_sent_channels(interface.channels, sent_names))
    return replace(interface, layouts=layouts)


def _with_sent_channels(channels: DataChannels, sent_names: Collection[str]) -> DataChannels | None:
    """Return the data channels of a frame that have bits, or None if the frame then carries only one channel."""
    sent_order = tuple(name for name in channels.order if name in sent_names)
    if len(sent_order) < 2:
        return None
    compared = {name: field for name, field in channels.compared.items() if name in sent_names}
    return replace(channels, order=sent_order, compared=compared)
