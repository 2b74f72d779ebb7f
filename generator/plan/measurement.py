"""Units of positions: values by interface, and the number of counts after which a position wraps around."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import Generic, TypeVar

from ..model import Device, Interface, Measurement, Parameter
from ..model.expressions import Expression
from ..model.record import dataclass

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Cases(Generic[T]):
    """Values by interface: each value with its interfaces. The value with the most interfaces is last.

    ``everywhere`` is true if every interface has a value.
    """

    cases: tuple[tuple[T, tuple[str, ...]], ...]
    everywhere: bool


def by_interface(device: Device, value: Callable[[Interface], T | None]) -> Cases[T]:
    """Return the result of ``value`` for each interface. ``value`` returns None for an interface without a value."""
    kinds: dict[T, list[str]] = {}
    for interface in device.interfaces:
        found = value(interface)
        if found is not None:
            kinds.setdefault(found, []).append(interface.name)
    cases = tuple((found, tuple(names)) for found, names in sorted(kinds.items(), key=lambda item: len(item[1])))
    return Cases(cases, sum(map(len, kinds.values())) == len(device.interfaces))


def also_measured(device: Device) -> frozenset[str]:
    """Return the derived parameters that equal a quantity of the measurement for all order codes.

    These quantities are the counts per revolution and the number of counts after which a position wraps around.
    """
    derived = [item for item in device.parameters if item.equals is not None]
    return frozenset(item.name for item in derived if _is_measured(device, item))


def _is_measured(device: Device, parameter: Parameter) -> bool:
    found: list[set[str]] = []
    for variant in device.variants:
        if parameter.interface not in ("", variant.interface):
            continue
        value, item = variant.parameters.get(parameter.name), device.measurement_of(variant.interface)
        if value is None or item is None or not counts(item):
            continue
        if any(name not in variant.parameters for part in counts(item) for name in part.parameters):
            return False
        whole = prod(part.value(variant.parameters) for part in counts(item))
        turn = item.counts_per_turn.value(variant.parameters) if item.counts_per_turn is not None else whole
        found.append({place for place, told in (("turn", turn), ("whole", whole)) if told == value})
    return bool(found) and bool(set.intersection(*found))


def counts(measurement: Measurement) -> tuple[Expression, ...]:
    """Return the factors of the number of counts after which a position wraps around, or none if it is unknown."""
    if measurement.modulus is not None:
        return (measurement.modulus,)
    if measurement.counts_per_turn is None or measurement.turns is None:
        return ()
    factors = (measurement.counts_per_turn, measurement.turns)
    return tuple(item for item in factors if item != Expression(1)) or factors[:1]
