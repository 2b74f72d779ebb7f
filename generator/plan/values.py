"""Values: operations that convert the bits of a field, and the units and ranges of positions.

This is the only module between the model and the outputs that looks at kinds. Each output has an exhaustive match over
these operations, so mypy reports every output that lacks a new one.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from math import prod
from typing import Generic, TypeVar

from ..model import Device, Digits, Field, Interface, Layout, Measurement, Parameter, Value
from ..model.expressions import Expression
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Flag, Number, Parity, Text, Unused
from ..model.lookup import assert_never
from ..model.record import dataclass

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class ByInterface(Generic[T]):
    """Values by interface: each value with its interfaces. The value with the most interfaces is last.

    ``everywhere`` is true if every interface has a value.
    """

    cases: tuple[tuple[T, tuple[str, ...]], ...]
    everywhere: bool


def by_interface(device: Device, value: Callable[[Interface], T | None]) -> ByInterface[T]:
    """Return the result of ``value`` for each interface. ``value`` returns None for an interface without a value."""
    interfaces_by_value: dict[T, list[str]] = {}
    values_in_total = 0
    for interface in device.interfaces:
        interface_value = value(interface)
        if interface_value is not None:
            interfaces_by_value.setdefault(interface_value, []).append(interface.name)
            values_in_total += 1
    cases = [(case_value, tuple(names)) for case_value, names in interfaces_by_value.items()]
    cases.sort(key=_number_of_interfaces)
    return ByInterface(cases=tuple(cases), everywhere=values_in_total == len(device.interfaces))


def _number_of_interfaces(value_with_interfaces: tuple[object, tuple[str, ...]]) -> int:
    _, interface_names = value_with_interfaces
    return len(interface_names)


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
    """Return the ranges of the position over an interface, or an empty tuple without a measurement.

    Layouts share a range if ``_range_key`` is equal: the counts, the highest position, wrapping and the sign. If no
    frame contains the position, all frames of the encoder share one range.
    """
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return ()
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    layouts_with_position = [layout for layout in sent_layouts if measurement.of in layout.member_names]
    if not layouts_with_position:
        only_range = PositionRange(
            measurement=measurement, never_wraps=False, signed_field=None, layouts=tuple(sent_layouts)
        )
        return (only_range,)
    ranges_by_key: dict[Hashable, PositionRange] = {}
    for layout in layouts_with_position:
        layout_range = _position_range(measurement, layout)
        range_key = _range_key(layout_range)
        earlier_range = ranges_by_key.get(range_key)
        if earlier_range is None:
            ranges_by_key[range_key] = layout_range
        else:
            ranges_by_key[range_key] = replace(earlier_range, layouts=(*earlier_range.layouts, layout))
    return tuple(ranges_by_key.values())


def _position_range(measurement: Measurement, layout: Layout) -> PositionRange:
    """Return the range of the position in one layout, which the layout can narrow."""
    own_range = layout.position_range
    # A position that is a join has no field of this name, and is unsigned.
    signed_fields = [field for field in layout.fields if field.name == measurement.of and field.number.signed]
    return PositionRange(
        measurement=measurement.within(own_range),
        never_wraps=own_range is not None and not own_range.wraps,
        signed_field=signed_fields[0] if signed_fields else None,
        layouts=(layout,),
    )


def _range_key(position_range: PositionRange) -> Hashable:
    """Return a key that is equal for layouts with the same range, whatever its sources.

    If no highest position is known, the width of a signed field decides the range, and is therefore part of the key.
    """
    measurement = position_range.measurement
    signed_field = position_range.signed_field
    deciding_width = None
    if signed_field is not None and measurement.highest is None:
        deciding_width = signed_field.width
    is_signed = signed_field is not None
    return measurement.total, measurement.highest, position_range.never_wraps, is_signed, deciding_width


def parameters_in_measurement(device: Device) -> frozenset[str]:
    """Return the names of the derived parameters that equal a quantity of the measurement for all order codes.

    These quantities are the counts per revolution and the number of counts after which a position wraps around.
    """
    derived = [parameter for parameter in device.parameters if parameter.equals is not None]
    return frozenset(parameter.name for parameter in derived if _equals_quantity(device, parameter))


def _equals_quantity(device: Device, parameter: Parameter) -> bool:
    """Return whether a parameter equals the counts per revolution or the number of counts for every order code.

    The same one of these two must apply to all order codes. Order codes without the parameter, or without a number of
    counts, are ignored.
    """
    # Quantities that equal the parameter for all order codes so far. None before the first of them.
    equal_in_all: set[str] | None = None
    for variant in device.variants:
        # Without an interface, the parameter belongs to all of them.
        if parameter.interface not in ("", variant.interface):
            continue
        parameter_value = variant.parameters.get(parameter.name)
        measurement = device.measurement_of(variant.interface)
        factors = count_factors(measurement) if measurement is not None else ()
        if parameter_value is None or measurement is None or not factors:
            continue
        # The quantity is not the same in all frames.
        if len(position_ranges(device, device.interface(variant.interface))) > 1:
            return False
        # The order code alone does not determine the quantity.
        needed_names = {name for factor in factors for name in factor.parameters}
        if not needed_names <= variant.parameters.keys():
            return False
        equal_quantities: set[str] = set()
        total = prod(factor.value(variant.parameters) for factor in factors)
        # Without revolutions, the one quantity is the other.
        counts_per_turn = total
        if measurement.counts_per_turn is not None:
            counts_per_turn = measurement.counts_per_turn.value(variant.parameters)
        if parameter_value == counts_per_turn:
            equal_quantities.add("counts per turn")
        if parameter_value == total:
            equal_quantities.add("total")
        equal_in_all = equal_quantities if equal_in_all is None else equal_in_all & equal_quantities
    return bool(equal_in_all)


def count_factors(measurement: Measurement) -> tuple[Expression, ...]:
    """Return the factors of the number of counts after which a position wraps around.

    Return an empty tuple if it is unknown. Factors that are 1 are omitted unless all are.
    """
    if measurement.modulus is not None:
        return (measurement.modulus,)
    if measurement.counts_per_turn is None or measurement.turns is None:
        return ()
    factors = (measurement.counts_per_turn, measurement.turns)
    factors_above_1 = tuple(factor for factor in factors if factor != Expression(1))
    return factors_above_1 or (measurement.counts_per_turn,)


@dataclass(frozen=True, slots=True)
class UnsignedNumber:
    """An unsigned number: the bits as they are. The inverse rejects a number that is too wide."""


@dataclass(frozen=True, slots=True)
class TwosComplement:
    """A signed number in two's complement. The inverse rejects a number that does not fit."""


@dataclass(frozen=True, slots=True)
class ZeroMeans:
    """An unsigned number, except that the value is ``number`` if all bits are 0.

    The inverse writes 0 for a ``number`` that does not fit, and rejects 0.
    """

    number: int


@dataclass(frozen=True, slots=True)
class ActiveFlag:
    """Boolean that is true if the bit is 1 or, with ``low``, if it is 0. The inverse writes the bit."""

    low: bool


@dataclass(frozen=True, slots=True)
class NamedChoice:
    """One of the named ``values``. The inverse rejects any other."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class DecimalDigits:
    """An unsigned number, shown as ``runs`` of decimal digits. The inverse joins the runs."""

    runs: tuple[Digits, ...]


@dataclass(frozen=True, slots=True)
class Latin1Text:
    """Latin-1 characters, one per byte, the first in the most significant byte. The inverse rejects other lengths."""


Meaning = UnsignedNumber | TwosComplement | ZeroMeans | ActiveFlag | NamedChoice | DecimalDigits | Latin1Text


def is_number(meaning: Meaning) -> bool:
    """Return whether the value is a single number, not a Boolean, a name, runs of digits or a string."""
    match meaning:
        case UnsignedNumber() | TwosComplement() | ZeroMeans():
            return True
        case ActiveFlag() | NamedChoice() | DecimalDigits() | Latin1Text():
            return False
        case _:
            assert_never(meaning)


def is_named(meaning: Meaning) -> bool:
    """Return whether the value is one of several names."""
    match meaning:
        case NamedChoice():
            return True
        case UnsignedNumber() | TwosComplement() | ZeroMeans() | ActiveFlag() | DecimalDigits() | Latin1Text():
            return False
        case _:
            assert_never(meaning)


def meaning_of(field: Field) -> Meaning:
    """Return the meaning of the bits of a field.

    Constants, unused bits, CRCs and parity bits have no value to convert. Their bits are a number.
    """
    match field.kind:
        case Number(signed=True):
            return TwosComplement()
        case Number(zero_means=number) if number:
            return ZeroMeans(number)
        case Number() | Constant() | Unused() | CrcValue() | Parity():
            return UnsignedNumber()
        case Flag(active_low=low):
            return ActiveFlag(low)
        case Choice(values):
            return NamedChoice(values)
        case Decimal(runs):
            return DecimalDigits(runs)
        case Text():
            return Latin1Text()
        case _:
            assert_never(field.kind)


def widest_value(field: Field) -> int:
    """Return the width in bits of the largest number that the field can represent."""
    match meaning_of(field):
        case ZeroMeans(number):
            return max(field.widest, number.bit_length())
        case UnsignedNumber() | TwosComplement() | ActiveFlag() | NamedChoice() | DecimalDigits() | Latin1Text():
            return field.widest
        case never:
            assert_never(never)
