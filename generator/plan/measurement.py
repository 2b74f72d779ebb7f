"""Units and ranges of positions: values by interface, ranges by layout, and counts until a position wraps around."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from math import prod
from typing import Generic, TypeVar

from ..model import Device, Field, Interface, Layout, Measurement, Parameter
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


@dataclass(frozen=True, slots=True)
class PositionRange:
    """Range of the position in some layouts of an interface.

    ``signed_field`` is the field with it in two's complement, or None if it is never negative.
    """

    measurement: Measurement
    never_wraps: bool
    signed_field: Field | None
    layouts: tuple[Layout, ...]

    @property
    def has_difference(self) -> bool:
        """True if the distance between two positions is known."""
        return self.never_wraps or self.measurement.total is not None


def position_ranges(device: Device, interface: Interface) -> tuple[PositionRange, ...]:
    """Return the ranges of the position over an interface, or none without a measurement.

    There is only one unless the layouts differ.
    """
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return ()
    sent = [item for item in interface.layouts if item.sender == "encoder"]
    layouts = [item for item in sent if measurement.of in item.member_names]
    groups: dict[Hashable, PositionRange] = {}
    for layout in layouts:
        found = _position_range(measurement, layout)
        same = groups.setdefault(_numbers_of(found), found)
        if same is not found:
            groups[_numbers_of(found)] = replace(same, layouts=(*same.layouts, layout))
    return tuple(groups.values()) or (PositionRange(measurement, False, None, tuple(sent)),)


def _position_range(measurement: Measurement, layout: Layout) -> PositionRange:
    own_range = layout.position_range
    never_wraps = own_range is not None and not own_range.wraps
    fields = [item for item in layout.fields if item.name == measurement.of and item.number.signed]
    return PositionRange(measurement.within(own_range), never_wraps, fields[0] if fields else None, (layout,))


def _numbers_of(item: PositionRange) -> Hashable:
    """Return what determines the range, without sources. The width of a signed position matters without a highest."""
    measurement, field = item.measurement, item.signed_field
    width = field.width if field is not None and measurement.highest is None else None
    return measurement.total, measurement.highest, item.never_wraps, field is not None, width


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
        if len(position_ranges(device, device.interface(variant.interface))) > 1:
            return False
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
