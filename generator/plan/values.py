"""Values: operations that convert the bits of a field, and the units and ranges of positions.

This is the only module between the model and the outputs that looks at kinds. Each output has an exhaustive match over
these operations, so mypy reports every output that lacks a new one.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from math import prod
from typing import Generic, TypeVar

from ..model import Device, Digits, Field, Interface, Layout, Measurement, Parameter, Value
from ..model.expressions import Expression
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Flag, Number, Parity, Text, Unused
from ..model.record import assert_never, dataclass

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class ByInterface(Generic[T]):
    """Each different value with the names of the interfaces that have it. The value with the most interfaces is last.

    ``every_interface_has_value`` is true if every interface of the encoder has a value.
    """

    values_with_interfaces: tuple[tuple[T, tuple[str, ...]], ...]
    every_interface_has_value: bool


def by_interface(device: Device, find_value: Callable[[Interface], T | None]) -> ByInterface[T]:
    """Call ``find_value`` for each interface of the encoder, and return the values, grouped by equal values.

    ``find_value`` returns None for an interface without a value.
    """
    names_by_value: dict[T, list[str]] = {}
    number_of_values = 0
    for interface in device.interfaces:
        value = find_value(interface)
        if value is not None:
            names_by_value.setdefault(value, []).append(interface.name)
            number_of_values += 1
    values_with_names = [(value, tuple(names)) for value, names in names_by_value.items()]
    values_with_names.sort(key=_number_of_names)
    return ByInterface(
        values_with_interfaces=tuple(values_with_names),
        every_interface_has_value=number_of_values == len(device.interfaces),
    )


def _number_of_names(value_with_names: tuple[object, tuple[str, ...]]) -> int:
    """Return the number of interfaces that have this value. The values are sorted by it."""
    _, interface_names = value_with_names
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
    """Return the ranges of the position that the encoder sends over an interface.

    Layouts share a range if they have the same number of counts, highest position, wrapping and sign, which
    ``_range_key`` compares. If no frame contains the position, all frames that the encoder sends share one range. The
    tuple is empty if the manual describes no measurement for this interface.
    """
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return ()
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    layouts_with_position = [layout for layout in sent_layouts if measurement.position_name in layout.member_names]
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
    """Return the range of the position in one layout: the range of the measurement, or a narrower one of the layout."""
    range_of_layout = layout.position_range
    position_name = measurement.position_name
    # A position that several fields form together has no field of this name, and is unsigned.
    signed_fields = [field for field in layout.fields if field.name == position_name and field.number.signed]
    return PositionRange(
        measurement=measurement.within(range_of_layout),
        never_wraps=range_of_layout is not None and not range_of_layout.wraps,
        signed_field=signed_fields[0] if signed_fields else None,
        layouts=(layout,),
    )


def _range_key(position_range: PositionRange) -> Hashable:
    """Return a key that is equal for layouts with the same range, even if different passages of the manual give it.

    If no highest position is known, the width of a signed field determines the range, and is part of the key.
    """
    measurement = position_range.measurement
    signed_field = position_range.signed_field
    width_of_range = None
    if signed_field is not None and measurement.highest is None:
        width_of_range = signed_field.width
    is_signed = signed_field is not None
    return measurement.total, measurement.highest, position_range.never_wraps, is_signed, width_of_range


def parameters_in_measurement(device: Device) -> frozenset[str]:
    """Return the names of the derived parameters that equal a quantity of the measurement for all order codes.

    These quantities are the counts per revolution and the number of counts after which a position wraps around. Derived
    parameters are those that the spec computes from other parameters.
    """
    derived_parameters = [parameter for parameter in device.parameters if parameter.equals is not None]
    return frozenset(parameter.name for parameter in derived_parameters if _equals_quantity(device, parameter))


def _equals_quantity(device: Device, parameter: Parameter) -> bool:
    """Return whether a parameter equals the counts per revolution or the number of counts for every order code.

    It must equal the same one of these two quantities for all order codes. Order codes without the parameter, or
    without a known number of counts, are ignored. The result is false if no order code remains.
    """
    # For each order code, the quantities that equal the parameter.
    quantities_by_code: list[frozenset[str]] = []
    for variant in device.variants:
        # A parameter without an interface applies to all interfaces.
        applies_to_variant = parameter.interface in ("", variant.interface)
        measurement = device.measurement_of(variant.interface)
        if not applies_to_variant or parameter.name not in variant.parameters or measurement is None:
            continue
        factors = count_factors(measurement)
        if not factors:
            continue
        differs_between_frames = len(position_ranges(device, device.interface(variant.interface))) > 1
        needed_names = {name for factor in factors for name in factor.parameters}
        order_code_determines_counts = needed_names <= variant.parameters.keys()
        if differs_between_frames or not order_code_determines_counts:
            return False
        parameter_value = variant.parameters[parameter.name]
        quantities_by_code.append(_equal_quantities(measurement, parameter_value, variant.parameters))
    return bool(quantities_by_code) and bool(frozenset.intersection(*quantities_by_code))


def _equal_quantities(measurement: Measurement, number: int, parameters: Mapping[str, int]) -> frozenset[str]:
    """Return which quantities of an order code equal ``number``: ``counts_per_turn``, ``total``, both, or neither.

    ``total`` is the number of counts after which the position wraps around. ``parameters`` are those of the order code.
    """
    total = prod(factor.value(parameters) for factor in count_factors(measurement))
    # Without revolutions, both quantities are the same.
    counts_per_turn = total
    if measurement.counts_per_turn is not None:
        counts_per_turn = measurement.counts_per_turn.value(parameters)
    quantities = {"counts_per_turn": counts_per_turn, "total": total}
    return frozenset(name for name, quantity in quantities.items() if quantity == number)


def count_factors(measurement: Measurement) -> tuple[Expression, ...]:
    """Return the factors whose product is the number of counts after which a position wraps around.

    They are the counts per revolution and the number of revolutions, or a single factor. Factors of 1 are omitted
    unless all factors are 1. The tuple is empty if the number of counts is unknown.
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
    """Return the operation that converts the bits of a field to its value, such as ``TwosComplement()``.

    The bits of constants, unused bits, CRCs and parity bits are treated as unsigned numbers.
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
    """Return the number of bits of the largest value that the field can represent.

    It can be one more than the width of the field: 8 bits in which 0 represents 256 need a variable of 9 bits.
    """
    match meaning_of(field):
        case ZeroMeans(number):
            return max(field.widest, number.bit_length())
        case UnsignedNumber() | TwosComplement() | ActiveFlag() | NamedChoice() | DecimalDigits() | Latin1Text():
            return field.widest
        case never:
            assert_never(never)
