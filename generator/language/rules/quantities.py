"""Rules for quantities and their units: characteristics, supplies, and the same quantity in two units."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from ...model import Alarm, Quantity, Supply
from ...model.expressions import Factor
from ..keys_of_fields import WrittenField
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path, join_words, quoted
from ..written import LocatedPart
from .code_meanings import supply_in_text
from .parameters import KEYS_IN_BITS, KIND_OF_UNIT_BY_KEY, expressions, list_factors
from .parts import field_lists
from .walk import leaves_of

#: The possible units of each kind of quantity, separated by spaces.
_UNITS_OF_KIND = {
    "angle": "°",
    "area": "mm²",
    "battery": "V",
    "bending_radius": "mm diameters",
    "clearance": "mm µm",
    "coverage": "%",
    "current": "A mA",
    "frequency": "Hz kHz MHz",
    "length": "in m mm µm",
    "mass": "g kg",
    "resistance": "MΩ Ω",
    "resistance_per_length": "Ω/km",
    "speed": "m/s",
    "supply": "V",
    "temperature": "°C °F",
    "time": "min ms s µs",
    "torque": "Nm",
    "voltage": "V Vpp",
}
#: Units as texts write them.
_UNITS_IN_TEXTS = {"diameters": "×", "min": "min(?:ute)?s?", "s": "s(?:ec(?:ond)?s?)?"}
#: A number with its sign, such as ``±5``, ``-20`` or ``1,000.5``.
_NUMBER_PATTERN = r"(?<![\w.,])(?P<sign>[±−+-]?)\s?(?P<number>\d+(?:,\d{3})*(?:\.\d+)?)"
_MILLIVOLTS_PER_UNIT = {"V": 1000, "mV": 1}
_VOLTAGE_IN_TEXT = re.compile(r"(?<![\w.,])(\d+(?:\.\d+)?) ?(V|mV)\b")


def check_quantity_text(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that quantities of a characteristic have possible units and bounds, and the same numbers as its text."""
    for characteristic in spec.characteristics:
        printed_text = characteristic.part.value
        quantities = characteristic.part.values
        bounds_by_unit: dict[str, set[Decimal]] = {}
        for index, quantity in enumerate(quantities):
            path = (*characteristic.path, "values", index)
            bounds = _checked_bounds(quantity, printed_text, path, report)
            if bounds:
                bounds_by_unit.setdefault(quantity.unit, set()).update(bounds)
        for unit, bounds_in_unit in sorted(bounds_by_unit.items()):
            if not bounds_in_unit.issubset(_numbers_with_tolerances(printed_text, unit)):
                continue  # The same difference is reported at the bound.
            for number in _numbers_without_tolerances(printed_text, unit):
                if number not in bounds_in_unit:
                    message = f"'values' does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*characteristic.path, "value"), message)


def _checked_bounds(quantity: Quantity, characteristic_text: str, path: Path, report: DocumentReport) -> list[Decimal]:
    """Return the bounds of a quantity of a characteristic, and report it if it contradicts the characteristic's text.

    Each bound must be a number in the text with the same unit, or such a number plus or minus a tolerance. The result
    is empty if the unit or the order of the bounds is wrong.
    """
    unit = quantity.unit
    possible_units = _UNITS_OF_KIND[quantity.quantity].split()
    if unit not in possible_units:
        units_text = join_words(possible_units, "or")
        message = f"{quoted(quantity.quantity)} is given in {units_text}, not in {unit}"
        report.add("quantity-text", (*path, "unit"), message)
        return []
    bounds_by_key = {key: Decimal(str(number)) for key, number in bounds_of(quantity).items()}
    bounds = list(bounds_by_key.values())
    are_finite = all(bound.is_finite() for bound in bounds)
    if not bounds or not are_finite or bounds != sorted(bounds):
        report.add("quantity-text", path, "give 'min', 'typical' or 'max', in ascending order")
        return []
    possible_numbers = set(_numbers_with_tolerances(characteristic_text, unit))
    for key, number in bounds_by_key.items():
        if number not in possible_numbers:
            message = f"the text does not give {number} {unit}; one of the two is wrong"
            report.add("quantity-text", (*path, key), message)
    return bounds


def bounds_of(quantity: Quantity) -> dict[str, float]:
    """Return the numbers of a quantity by their key, such as ``{"min": 4.5, "max": 5.5}``, in the order of the keys."""
    bounds = {"min": quantity.min, "typical": quantity.typical, "max": quantity.max}
    return {key: number for key, number in bounds.items() if number is not None}


def _numbers_with_sign(characteristic_text: str, unit: str) -> Iterator[tuple[str, Decimal]]:
    """Yield the sign and the size of each number with this unit in a text, such as ``("±", 5)`` and ``("-", 20)``."""
    unit_pattern = _UNITS_IN_TEXTS.get(unit, re.escape(unit))
    # The number of ``-20 °C``, but not of a quantity per another, such as ``20 m/s`` for the unit m.
    number_with_unit = rf"{_NUMBER_PATTERN}(?= ?{unit_pattern}(?!\w|/))"
    for match in re.finditer(number_with_unit, characteristic_text):
        sign, number_text = match.group("sign", "number")
        number = Decimal(number_text.replace(",", ""))
        yield sign.replace("−", "-"), number


def _numbers_without_tolerances(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with this unit in a text, except tolerances such as ``±5``."""
    for sign, number in _numbers_with_sign(characteristic_text, unit):
        if sign != "±":
            yield -number if sign == "-" else number


def _numbers_with_tolerances(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with this unit in a text, and each number plus and minus its tolerances.

    A tolerance, such as ``±5``, is in the same unit or in percent.
    """
    numbers_in_text = list(_numbers_without_tolerances(characteristic_text, unit))
    yield from numbers_in_text
    tolerances = [number for sign, number in _numbers_with_sign(characteristic_text, unit) if sign == "±"]
    percentages = [number for sign, number in _numbers_with_sign(characteristic_text, "%") if sign == "±"]
    nominal_numbers = numbers_in_text or [Decimal(0)]  # A tolerance alone is about 0.
    for nominal_number in nominal_numbers:
        relative_tolerances = [nominal_number * (percentage / 100) for percentage in percentages]
        for tolerance in (*tolerances, *relative_tolerances):
            yield nominal_number - tolerance
            yield nominal_number + tolerance


def check_repeated_quantities(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that supply voltages in characteristics and contacts match ``supply``.

    Also check that voltages in the texts of an alarm match its threshold, ``below_mv``.
    """
    supply_ranges = _supply_ranges(spec)
    for characteristic in spec.characteristics:
        for index, quantity in enumerate(characteristic.part.values):
            if quantity.quantity != "supply" or quantity.min is None or quantity.max is None:
                continue
            stated_range_mv = round(quantity.min * 1000), round(quantity.max * 1000)
            path: Path = (*characteristic.path, "values", index)
            _compare_supply(stated_range_mv, supply_ranges, path=path, report=report)
    for connector in spec.connectors:
        for index, contact in enumerate(connector.part.contacts):
            stated_supply = supply_in_text(contact.signal)
            if stated_supply is None:
                continue
            lowest_mv, highest_mv = stated_supply
            is_range = lowest_mv != highest_mv
            if is_range:
                path = (*connector.path, "contacts", index, "signal")
                _compare_supply(stated_supply, supply_ranges, path=path, report=report)
    for alarm in spec.alarms:
        _check_threshold(spec, alarm, report)


def _supply_ranges(spec: WrittenSpec) -> list[tuple[int, int]]:
    """Return the supply ranges of the device and of its order code values, in millivolts."""
    supplies = [spec.supply]
    for part in spec.order_code.parts:
        supplies += [value.supply for value in part.values.values()]
    return [(supply.part.min_mv, supply.part.max_mv) for supply in supplies if supply is not None]


def _compare_supply(
    stated_range_mv: tuple[int, int], supply_ranges: list[tuple[int, int]], path: Path, report: DocumentReport
) -> None:
    """Report a supply voltage, stated at ``path``, that is not one of the spec's supply ranges in millivolts.

    If the spec has no supply range, nothing is compared.
    """
    if supply_ranges and stated_range_mv not in supply_ranges:
        lowest_mv, highest_mv = stated_range_mv
        range_texts = [f"{min_mv} to {max_mv} mV" for min_mv, max_mv in supply_ranges]
        supply_text = join_words(range_texts, "or")
        message = f"this is {lowest_mv} to {highest_mv} mV, but 'supply' is {supply_text}; one of the two is wrong"
        report.add("quantity-repeated", path, message)


def _check_threshold(spec: WrittenSpec, alarm: LocatedPart[Alarm], report: DocumentReport) -> None:
    """Check that each voltage in the texts of an alarm and of its flag is the threshold of the alarm, if it has one."""
    threshold_mv = alarm.part.below_mv
    if threshold_mv is None:
        return
    located_texts = [((*alarm.path, "meaning"), alarm.part.meaning)]
    for flag in _flags_of_alarm(spec, alarm.part):
        located_texts += [(flag.path_of("meaning"), flag.meaning), (flag.path_of("when_active"), flag.when_active)]
    for path, text in located_texts:
        for number, unit in _VOLTAGE_IN_TEXT.findall(text):
            voltage_mv = Decimal(number) * _MILLIVOLTS_PER_UNIT[unit]
            if voltage_mv != threshold_mv:
                message = (
                    f"the text says {number} {unit}, but 'below_mv' of the alarm is {threshold_mv}; "
                    "one of the two is wrong"
                )
                report.add("quantity-repeated", path, message)


def _flags_of_alarm(spec: WrittenSpec, alarm: Alarm) -> list[WrittenField]:
    """Return the flag of an alarm: the fields with its name in the group and the register that the alarm names."""
    fields_of_owner: list[WrittenField] = []
    for group in spec.field_groups:
        if group.name == alarm.group:
            fields_of_owner += group.fields
    for register in spec.registers:
        if register.name == alarm.register:
            fields_of_owner += register.fields
    return [field for field in fields_of_owner if field.name == alarm.field]


#: Kinds of units, each with the units as manuals name them.
_UNITS_BY_KIND = {
    "bits": ("bit", "bits"),
    "micrometres": ("um", "µm", "μm", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"),
    "nanometres": ("nm", "nanometre", "nanometres", "nanometer", "nanometers"),
    "another length": ("mm", "cm", "m", "millimetre", "millimetres", "millimeters", "inch", "inches"),
    "revolutions": ("revolution", "revolutions", "turn", "turns", "rev", "revs"),
    "counts": ("count", "counts", "step", "steps", "position", "positions", "increments"),
}
_KIND_BY_UNIT = {unit: kind for kind, units in _UNITS_BY_KIND.items() for unit in units}


def kind_of_unit(unit: str) -> str:
    """Return the kind of a unit, such as ``micrometres`` for ``µm`` and ``um``, or the unit itself if it is unknown."""
    return _KIND_BY_UNIT.get(unit, unit)


def check_units(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a field whose value equals a parameter has its unit, and that parameters in expressions fit there.

    Exponents and widths of fields must be in bits, and numbers of a measurement in its units. Parameters with unknown
    units are not checked in expressions.
    """
    parameters = spec.with_invalid_parts.parameters
    for field_list in field_lists(spec):
        for field in field_list.fields:
            # None unless ``equals`` is only the name of a parameter.
            parameter = parameters.get(str(field.equals))
            parameter_unit = parameter.unit if parameter is not None else ""
            if not field.unit or not parameter_unit:
                continue
            if kind_of_unit(field.unit) != kind_of_unit(parameter_unit):
                problem = f"field {quoted(field.name)} is in {field.unit}, but the parameter {quoted(field.equals)}"
                message = f"{problem}, which it equals, is in {parameter_unit}"
                report.add("unit-mismatch", field.path_of("unit"), message)
    for path, text in expressions(spec):
        for factor in list_factors(text):
            if factor.parameter in parameters:
                unit = parameters[factor.parameter].unit
                _check_unit_of_factor(path, factor, unit, report)


def _check_unit_of_factor(path: Path, factor: Factor, unit: str, report: DocumentReport) -> None:
    """Check that a parameter in the expression at ``path`` has the unit that is needed there, if both are known.

    ``factor`` is the parameter in the expression, and ``unit`` its unit.
    """
    key = str(path[-1])
    is_exponent = factor.power
    needed_kind = "bits" if is_exponent or key in KEYS_IN_BITS else KIND_OF_UNIT_BY_KEY.get(key)
    kind = _KIND_BY_UNIT.get(unit)
    if needed_kind is None or kind is None or kind == needed_kind:
        return
    quoted_place = f"the exponent in 2^{factor.parameter}" if is_exponent else quoted(key)
    needed_unit = "µm" if needed_kind == "micrometres" else needed_kind
    message = f"{quoted(factor.parameter)} is in {unit}, but {quoted_place} must be in {needed_unit}"
    report.add("unit-mismatch", path, message)


#: A quantity in two units in a text, as in ``10 °C is 50 °F``.
_QUANTITY_IN_TWO_UNITS = re.compile(
    r"(?<![\w.,±])([−+-]?\d+(?:\.\d+)?) ?(°[CF]|mm|in)(?:,? which)? (?:is|=) "
    r"([−+-]?\d+(?:\.\d+)?) ?(°[CF]|mm|in)\b"
)
_UNIT_CONVERSIONS: Mapping[tuple[str, str], Callable[[float], float]] = {
    ("°C", "°F"): lambda number: number * 1.8 + 32,
    ("°F", "°C"): lambda number: (number - 32) / 1.8,
    ("mm", "in"): lambda number: number / 25.4,
    ("in", "mm"): lambda number: number * 25.4,
}


def check_conversions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a quantity that a characteristic or a text gives in two units is the same in both."""
    for characteristic in spec.characteristics:
        indices_by_quantity: dict[tuple[str, str], list[int]] = {}
        for index, quantity in enumerate(characteristic.part.values):
            indices_by_quantity.setdefault((quantity.quantity, quantity.where), []).append(index)
        for indices in indices_by_quantity.values():
            # If there are more than two, it is not known which of them belong together.
            if len(indices) == 2:
                first_index, second_index = indices
                first_quantity = characteristic.part.values[first_index]
                second_quantity = characteristic.part.values[second_index]
                _compare_bounds(second_quantity, first_quantity, (*characteristic.path, "values", second_index), report)
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed":
            continue
        for match in _QUANTITY_IN_TWO_UNITS.finditer(text):
            number_text, unit, other_number_text, other_unit = match.groups()
            printed = _PrintedNumber(Decimal(number_text.replace("−", "-")), unit)
            other = _PrintedNumber(Decimal(other_number_text.replace("−", "-")), other_unit)
            _compare_numbers(printed, other, path, report)


@dataclass(frozen=True, slots=True)
class _PrintedNumber:
    """A number as it is printed, with its unit."""

    number: Decimal | float
    unit: str

    @property
    def rounding(self) -> float:
        """Largest error from rounding: half a unit of the last printed digit, such as 0.05 for 2.5."""
        exponent = Decimal(str(self.number)).as_tuple().exponent
        return 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0


def _compare_bounds(quantity: Quantity, first_quantity: Quantity, path: Path, report: DocumentReport) -> None:
    """Report each bound of a quantity that differs from the same bound in another unit, of ``first_quantity``."""
    first_bounds = bounds_of(first_quantity)
    for key, bound in bounds_of(quantity).items():
        if key in first_bounds:
            printed = _PrintedNumber(bound, quantity.unit)
            first_printed = _PrintedNumber(first_bounds[key], first_quantity.unit)
            _compare_numbers(printed, first_printed, (*path, key), report)


def _compare_numbers(printed: _PrintedNumber, other: _PrintedNumber, path: Path, report: DocumentReport) -> None:
    """Report a number that differs from the same quantity in another unit by more than rounding.

    They may differ by 1 % in the other unit, or by the rounding in either unit. Two temperatures may also be
    differences of temperatures, which are converted without the offset of 32 °F. Numbers whose units have no conversion
    are not compared.
    """
    to_other_unit = _UNIT_CONVERSIONS.get((printed.unit, other.unit))
    if to_other_unit is None:
        return
    number = float(printed.number)
    other_number = float(other.number)
    converted = to_other_unit(number)
    tolerance = max(abs(converted) / 100, other.rounding)
    agrees_in_other_unit = abs(converted - other_number) <= tolerance
    to_own_unit = _UNIT_CONVERSIONS[other.unit, printed.unit]
    agrees_in_own_unit = abs(to_own_unit(other_number) - number) <= printed.rounding
    agrees_as_temperature_difference = False
    if "°" in other.unit:
        converted_difference = converted - to_other_unit(0.0)
        # Half a degree, because differences are printed in whole degrees.
        agrees_as_temperature_difference = abs(converted_difference - other_number) <= max(0.5, other.rounding)
    if not agrees_in_other_unit and not agrees_in_own_unit and not agrees_as_temperature_difference:
        message = f"{printed.number} {printed.unit} is {converted:.4g} {other.unit}, not {other.number}"
        report.add("quantity-text", path, message)


def check_bounds(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the lower and the upper bound of a quantity are different."""
    for characteristic in spec.characteristics:
        for index, quantity in enumerate(characteristic.part.values):
            if quantity.min is not None and quantity.min == quantity.max:
                message = f"'min' and 'max' are both {quantity.min:g}; correct one of them, or write 'typical'"
                report.add("quantity-text", (*characteristic.path, "values", index, "min"), message)


def check_numbers_of_conditions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the numbers in ``where``, the condition of a quantity, are in the text of the characteristic."""
    for characteristic in spec.characteristics:
        printed_text = characteristic.part.value
        printed_numbers = set(_NUMBER_IN_TEXT.findall(printed_text))
        for index, quantity in enumerate(characteristic.part.values):
            numbers_of_condition = _NUMBER_IN_TEXT.findall(quantity.where)
            missing_numbers = [number for number in numbers_of_condition if number not in printed_numbers]
            if missing_numbers:
                message = f"'where' has {missing_numbers[0]}, which the text does not have; correct one of the two"
                report.add("quantity-text", (*characteristic.path, "values", index, "where"), message)


_NUMBER_IN_TEXT = re.compile(r"(?<![\w.,])\d+(?:\.\d+)?(?![\w,]*\d)")


def check_supply_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that either the device or values of the order code have a supply, and that its voltages are in order."""
    supplies: list[LocatedPart[Supply]] = []
    if spec.supply is not None and spec.supply.is_given:
        supplies.append(spec.supply)
    has_supply_of_device = bool(supplies)
    for part in spec.order_code.parts:
        for value in part.values.values():
            if value.supply is None:
                continue
            supplies.append(value.supply)
            if has_supply_of_device:
                problem = "the device already has a 'supply'; keep only one of them"
                report.add("supply-range", value.supply.path, problem, at_key=True)
    for located_supply in supplies:
        supply = located_supply.part
        if supply.min_mv > supply.max_mv:
            problem = f"'min_mv' ({supply.min_mv}) is above 'max_mv' ({supply.max_mv})"
            report.add("supply-range", (*located_supply.path, "min_mv"), problem)
