"""What a position is in turns, degrees or micrometres, and which interfaces share one formula."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import prod
from typing import Generic, TypeVar

from ..model import Device, Interface, Measurement, Parameter
from ..model.expressions import Expression

T = TypeVar("T")
Formula = tuple["Expression | None", ...]


@dataclass(frozen=True, slots=True)
class Measured:
    """Interfaces whose positions mean the same; ``everywhere`` says that those of all interfaces do."""

    measurement: Measurement
    interfaces: tuple[Interface, ...]
    everywhere: bool


def measured(device: Device) -> Iterator[Measured]:
    """The formulas of a family, in the order of its interfaces; an interface that measures nothing is left out."""
    groups: dict[Formula, list[tuple[Interface, Measurement]]] = {}
    for interface in device.interfaces:
        item = device.measurement_of(interface.name)
        if item is not None:
            formula = (item.counts_per_turn, item.turns, item.step_um, item.modulus)
            groups.setdefault(formula, []).append((interface, item))
    for group in groups.values():
        yield Measured(group[0][1], tuple(interface for interface, _ in group), len(groups) == 1)


@dataclass(frozen=True, slots=True)
class Cases(Generic[T]):
    """What differs by interface: each value with the interfaces that have it, that of the most interfaces last.

    ``everywhere`` says that every interface has one.
    """

    cases: tuple[tuple[T, tuple[str, ...]], ...]
    everywhere: bool


def by_interface(device: Device, value: Callable[[Interface], T | None]) -> Cases[T]:
    """What ``value`` gives for each interface; None where it has none."""
    kinds: dict[T, list[str]] = {}
    for interface in device.interfaces:
        found = value(interface)
        if found is not None:
            kinds.setdefault(found, []).append(interface.name)
    cases = tuple((found, tuple(names)) for found, names in sorted(kinds.items(), key=lambda item: len(item[1])))
    return Cases(cases, sum(map(len, kinds.values())) == len(device.interfaces))


def also_measured(device: Device) -> frozenset[str]:
    """The parameters that follow from others and tell, with every order code, what a measurement tells: the counts of
    a revolution, or after how many a position starts again."""
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
    """The factors of how many counts there are before they start again; empty where that is not known."""
    if measurement.modulus is not None:
        return (measurement.modulus,)
    if measurement.counts_per_turn is None or measurement.turns is None:
        return ()
    factors = (measurement.counts_per_turn, measurement.turns)
    return tuple(item for item in factors if item != Expression(1)) or factors[:1]
