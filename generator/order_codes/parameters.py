"""Parameters by interface. Users of an SSI order code, for example, do not need the widths of a BiSS frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Layout, Measurement, Parameter
from ..model.expressions import Expression


def parameters_of(device: Device, kind: str) -> tuple[Parameter, ...]:
    """Return the parameters that matter for the interface ``kind``.

    Parameters used only by other interfaces are omitted, unless they are calculated from the parameters kept.
    Parameters that no interface uses are kept, since they are for information.
    """
    used_by_interface = {interface.name: _used(device, interface.name) for interface in device.interfaces}
    elsewhere = set[str]().union(*used_by_interface.values()) - used_by_interface[kind]
    possible = [parameter for parameter in device.parameters if parameter.interface in ("", kind)]
    calculated = {parameter.name: parameter.equals for parameter in possible if parameter.equals is not None}
    unused_calculated = calculated.keys() - used_by_interface[kind]
    kept_names = {parameter.name for parameter in possible} - elsewhere - unused_calculated
    for _ in possible:
        kept_names |= {name for name, value in calculated.items() if kept_names.issuperset(value.parameters)}
    return tuple(parameter for parameter in device.parameters if parameter.name in kept_names)


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
    for layout in device.interface(kind).layouts:
        yield from _of_layout(layout)
    for register in device.registers_over(kind):
        yield from _of_layout(register.layout)
        bounds = [
            register.min,
            register.max,
            *(bound for meaning in register.meanings for bound in (meaning.min, meaning.max)),
        ]
        yield from (bound for bound in bounds if bound is not None)
    measurement = device.measurement_of(kind)
    if measurement is not None:
        yield from _of_measurement(measurement)
    for layout in device.interface(kind).layouts:
        yield from layout.position_range.numbers if layout.position_range is not None else ()


def _of_layout(layout: Layout) -> Iterator[Expression]:
    yield layout.bits
    for field in layout.fields:
        yield from (field.low, field.width)
        if isinstance(field.equals, Expression):
            yield field.equals


def _of_measurement(measurement: Measurement) -> Iterator[Expression]:
    expressions = (
        measurement.counts_per_turn,
        measurement.turns,
        *measurement.steps,
        measurement.modulus,
        measurement.highest,
    )
    yield from (expression for expression in expressions if expression is not None)
