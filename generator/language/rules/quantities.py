"""Rules for quantities with units: characteristics, conversions, and voltages and times in texts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from decimal import Decimal

from ...model import Alarm, Quantity
from ...say.text import nanoseconds
from ..document import ErratumTargets
from ..problems import DocumentReport, Path, join_words, quoted
from ..written import LocatedPart
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .code_meanings import supply_named
from .parts import PlacedPart, interfaces, timings
from .walk import leaves, leaves_of

_UNIT_OF_KIND = {
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
_NUMBER_PATTERN = r"(?<![\w.,])(?P<sign>[±−+-]?)\s?(?P<number>\d+(?:,\d{3})*(?:\.\d+)?)"
_MILLIVOLTS_PER_UNIT = {"V": 1000, "mV": 1}
_VOLTAGE_IN_TEXT = re.compile(r"(?<![\w.,])(\d+(?:\.\d+)?) ?(V|mV)\b")
#: Nanoseconds by the ends of keys and by the units in texts.
_NANOSECONDS_PER_UNIT = {"ns": 1, "us": 1000, "µs": 1000, "ms": 1_000_000, "s": 1_000_000_000}
_TIME_PATTERN = r"(?<![\w.,])(?P<number>\d+(?:,\d{3})*(?:\.\d+)?) ?(?P<unit>ns|us|µs|ms|s(?:econds?)?)\b(?!/)"
_ANY_TIME = re.compile(_TIME_PATTERN)
#: A time that the reader or the encoder must keep.
_KEPT_TIME = re.compile(rf"\b(?:[Ww]ait|[Pp]ause|[Ww]ithin|[Aa]t least|[Aa]t most)\w*\b[^.;:,]{{0,40}}?{_TIME_PATTERN}")
_NO_TEXTS = frozenset(("source", "bytes", "bits", "name", "address"))
#: A quantity in two units in a text, as in ``10 °C is 50 °F``.
_QUANTITY_IN_TWO_UNITS = re.compile(
    r"(?<![\w.,±])(?P<one>[−+-]?\d+(?:\.\d+)?) ?(?P<one_unit>°[CF]|mm|in)(?:,? which)? (?:is|=) "
    r"(?P<two>[−+-]?\d+(?:\.\d+)?) ?(?P<two_unit>°[CF]|mm|in)\b"
)
_UNIT_CONVERSIONS: Mapping[tuple[str, str], Callable[[float], float]] = {
    ("°C", "°F"): lambda number: number * 1.8 + 32,
    ("°F", "°C"): lambda number: (number - 32) / 1.8,
    ("mm", "in"): lambda number: number / 25.4,
    ("in", "mm"): lambda number: number * 25.4,
}


def check_quantity_text(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that quantities of a characteristic have possible units and bounds, and the same numbers as its text."""
    for characteristic in spec.characteristics:
        text = characteristic.part.value
        numbers_with_units: set[tuple[Decimal, str]] = set()
        for index, quantity in enumerate(characteristic.part.values):
            bounds = _check_quantity(quantity, text, (*characteristic.path, "values", index), report)
            numbers_with_units |= {(number, quantity.unit) for number in bounds}
        for unit in sorted({unit for _, unit in numbers_with_units}):
            for number in _plain_numbers(text, unit):
                if (number, unit) not in numbers_with_units:
                    message = f"'values' does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*characteristic.path, "value"), message)


def _check_quantity(quantity: Quantity, characteristic_text: str, path: Path, report: DocumentReport) -> list[Decimal]:
    """Report a quantity of a characteristic that contradicts the text of the characteristic, and return its bounds.

    Each bound must be a number in the text with the same unit, or such a number plus or minus a tolerance. The result
    is empty if the unit or the order of the bounds is wrong.
    """
    unit, kind = quantity.unit, quantity.quantity
    if unit not in _UNIT_OF_KIND[kind].split():
        units_text = join_words(_UNIT_OF_KIND[kind].split(), "or")
        report.add("quantity-text", (*path, "unit"), f"{quoted(kind)} is given in {units_text}, not in {unit}")
        return []
    bounds = {name: Decimal(str(number)) for name, number in _bounds_of(quantity).items()}
    bounds_in_order = list(bounds.values())
    are_finite = all(bound.is_finite() for bound in bounds_in_order)
    if not bounds or not are_finite or bounds_in_order != sorted(bounds_in_order):
        report.add("quantity-text", path, "give 'min', 'typical' or 'max', in ascending order")
        return []
    possible_numbers = set(_possible_numbers(characteristic_text, unit))
    for name, number in bounds.items():
        if number not in possible_numbers:
            message = f"the text does not give {number} {unit}; one of the two is wrong"
            report.add("quantity-text", (*path, name), message)
    return bounds_in_order


def _bounds_of(quantity: Quantity) -> dict[str, float]:
    """Return the numbers of a quantity by their key, such as ``{"min": 4.5, "max": 5.5}``, in the order of the keys."""
    bounds = {"min": quantity.min, "typical": quantity.typical, "max": quantity.max}
    return {name: number for name, number in bounds.items() if number is not None}


def _signed_numbers(characteristic_text: str, unit: str) -> Iterator[tuple[str, Decimal]]:
    """Yield the sign and the size of each number with this unit in a text, such as ``("±", 5)`` and ``("-", 20)``."""
    unit_pattern = _UNITS_IN_TEXTS.get(unit, re.escape(unit))
    for match in re.finditer(rf"{_NUMBER_PATTERN}(?= ?{unit_pattern}(?!\w|/))", characteristic_text):
        sign, number = match.group("sign", "number")
        yield sign.replace("−", "-"), Decimal(number.replace(",", ""))


def _plain_numbers(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with this unit in a text, except tolerances such as ``±5``."""
    for sign, number in _signed_numbers(characteristic_text, unit):
        if sign != "±":
            yield -number if sign == "-" else number


def _possible_numbers(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with this unit in a text, and each number plus and minus its tolerances.

    A tolerance, such as ``±5``, is in the same unit or in percent.
    """
    plain_numbers = list(_plain_numbers(characteristic_text, unit))
    yield from plain_numbers
    tolerances = [number for sign, number in _signed_numbers(characteristic_text, unit) if sign == "±"]
    percentages = [number for sign, number in _signed_numbers(characteristic_text, "%") if sign == "±"]
    nominal_numbers = plain_numbers or [Decimal(0)]  # A tolerance alone is about 0.
    for nominal in nominal_numbers:
        relative_tolerances = [nominal * (percentage / 100) for percentage in percentages]
        for tolerance in (*tolerances, *relative_tolerances):
            yield nominal - tolerance
            yield nominal + tolerance


def check_repeated_quantities(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that supply voltages in characteristics and contacts match ``supply``.

    Also check that voltages in the texts of an alarm match its threshold, ``below_mv``.
    """
    supply_ranges = _supply_ranges(spec)
    for characteristic in spec.characteristics:
        for index, quantity in enumerate(characteristic.part.values):
            if quantity.quantity == "supply" and quantity.min is not None and quantity.max is not None:
                stated_range = round(quantity.min * 1000), round(quantity.max * 1000)
                _compare_supply(stated_range, supply_ranges, (*characteristic.path, "values", index), report)
    for connector in spec.connectors:
        for index, contact in enumerate(connector.part.contacts):
            contact_supply = supply_named(contact.signal)
            if contact_supply is not None and contact_supply[0] != contact_supply[1]:  # A range, not one voltage.
                path = (*connector.path, "contacts", index, "signal")
                _compare_supply(contact_supply, supply_ranges, path, report)
    for alarm in spec.alarms:
        _check_threshold(spec, alarm, report)


def _supply_ranges(spec: WrittenSpec) -> list[tuple[int, int]]:
    """Return the supply ranges of the device and of its order code values, in millivolts."""
    supplies = [spec.supply]
    for part in spec.order_code.parts:
        supplies += [value.supply for value in part.values.values()]
    return [(supply.part.min_mv, supply.part.max_mv) for supply in supplies if supply is not None]


def _compare_supply(
    stated_range: tuple[int, int], supply_ranges: list[tuple[int, int]], path: Path, report: DocumentReport
) -> None:
    """Report a supply voltage, stated at ``path``, that is not one of the spec's supply ranges in millivolts.

    If the spec has no supply range, nothing is compared.
    """
    if supply_ranges and stated_range not in supply_ranges:
        low_mv, high_mv = stated_range
        ranges_text = join_words([f"{low} to {high} mV" for low, high in supply_ranges], "or")
        message = f"this is {low_mv} to {high_mv} mV, but 'supply' is {ranges_text}; one of the two is wrong"
        report.add("quantity-repeated", path, message)


def _check_threshold(spec: WrittenSpec, alarm: LocatedPart[Alarm], report: DocumentReport) -> None:
    """Check that each voltage in the texts of an alarm and of its flag is the threshold of the alarm, if it has one."""
    threshold_mv = alarm.part.below_mv
    if threshold_mv is None:
        return
    located_texts = [((*alarm.path, "meaning"), alarm.part.meaning)]
    for flag in _flags_of(spec, alarm.part):
        located_texts += [(flag.place_of("meaning"), flag.meaning), (flag.place_of("when_active"), flag.when_active)]
    for path, text in located_texts:
        for number, unit in _VOLTAGE_IN_TEXT.findall(text):
            if Decimal(number) * _MILLIVOLTS_PER_UNIT[unit] != threshold_mv:
                message = (
                    f"the text says {number} {unit}, but 'below_mv' of the alarm is {threshold_mv}; "
                    "one of the two is wrong"
                )
                report.add("quantity-repeated", path, message)


def _flags_of(spec: WrittenSpec, alarm: Alarm) -> list[WrittenField]:
    """Return the flag of an alarm: the fields with its name in the group and the register that the alarm names."""
    fields_of_owner: list[WrittenField] = []
    for group in spec.field_groups:
        if group.name == alarm.group:
            fields_of_owner += group.fields
    for register in spec.registers:
        if register.name == alarm.register:
            fields_of_owner += register.fields
    return [field for field in fields_of_owner if field.name == alarm.field]


def check_repeated_times(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the times in texts and errata are those of the facts that they describe.

    A text is compared with the times next to it, or otherwise with those of its register, procedure, timing or input.
    An erratum is compared with the facts that it affects. Both may also repeat one of the ``timings``, or a time of
    another part. Overlays and older editions change times without changing every text, so their specs are not checked.
    """
    if report.document.other_files or report.document.family:
        return
    named_times = set(_nanoseconds_in([dict(timing.data) for timing in timings(spec)]))
    timed_parts: list[PlacedPart] = [*spec.registers, *spec.procedures, *spec.timings, *spec.inputs]
    times_of_parts = [set(_nanoseconds_in(part.data)) for part in timed_parts]
    parts_with: Counter[int | Decimal] = Counter()
    for own_times in times_of_parts:
        parts_with.update(own_times)
    for part, own_times in zip(timed_parts, times_of_parts, strict=True):
        elsewhere = _Elsewhere(named_times, parts_with, own_times)
        for path, text, nearby_times in _yield_texts(part.data, part.path):
            _compare_times(text, nearby_times or own_times, elsewhere, path, report)
    for _, interface in interfaces(spec):
        elsewhere = _Elsewhere(named_times, parts_with, set())
        for path, text, nearby_times in _yield_texts(interface.data, interface.path):
            _compare_times(text, nearby_times, elsewhere, path, report)
    _compare_errata(spec, named_times, report)
    _compare_symbols(spec, report)


def _compare_symbols(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report each timing whose meaning gives its symbol another time, as in ``tw > 20 µs``, than its own bounds."""
    for timing in timings(spec):
        if not timing.part.symbol:
            continue
        times = set(_nanoseconds_in(timing.data))
        pattern = rf"\b{re.escape(timing.part.symbol)} ?[<>=≤≥] ?{_TIME_PATTERN}"
        printed_times = list(re.finditer(pattern, timing.part.meaning))
        if printed_times and times.isdisjoint(map(_to_nanoseconds, printed_times)):
            _report_time(printed_times[0], times, (*timing.path, "meaning"), report)


def _compare_errata(spec: WrittenSpec, named_times: set[int], report: DocumentReport) -> None:
    """Report each erratum with times in ``used``, its text about what applies, if none of them is in an affected fact.

    One of the ``named_times`` is accepted too, unless the erratum affects exactly one timing.
    """
    affected_places = ErratumTargets(spec.data)
    times_below = _TimesBelow()
    for erratum in spec.errata:
        used_matches = list(_ANY_TIME.finditer(erratum.used))
        if not used_matches:
            continue
        used_times = set(map(_to_nanoseconds, used_matches))
        facts: list[object] = []
        for affected in dict.fromkeys(erratum.affects):
            facts += affected_places.at(affected)
        affected_times = set().union(*map(times_below.of, facts))
        affected_timings = [fact for fact in facts if _is_timing(fact)]
        timing_times = times_below.of(affected_timings[0]) if len(affected_timings) == 1 else set()
        if affected_times and used_times.isdisjoint(affected_times | named_times):
            _report_time(used_matches[0], affected_times, erratum.place_of("used"), report)
        elif timing_times and used_times.isdisjoint(timing_times):
            _report_time(used_matches[0], timing_times, erratum.place_of("used"), report)


class _TimesBelow:
    """The times in parts of a spec, which are cached because many errata may affect the same part."""

    def __init__(self) -> None:
        self._nanoseconds_in: dict[int, set[int]] = {}

    def of(self, node: object) -> set[int]:
        """Return all times in a part of a spec, in nanoseconds."""
        if id(node) not in self._nanoseconds_in:
            self._nanoseconds_in[id(node)] = set(_nanoseconds_in(node))
        return self._nanoseconds_in[id(node)]


#: Keys of timings and of the timeout of BiSS.
_KEYS_OF_TIMINGS = frozenset(("at_least_us", "typical_us", "at_most_us", "at_most_ns", "typical_ns"))


def _is_timing(fact: object) -> bool:
    return isinstance(fact, dict) and not _KEYS_OF_TIMINGS.isdisjoint(fact)


@dataclass(frozen=True, slots=True)
class _Elsewhere:
    """The times of a spec outside one part: the times in ``timings``, and the times of other parts.

    ``parts_with`` contains the number of parts with each time, and ``own_times`` the times of the one part.
    """

    named: Set[int]
    parts_with: Mapping[int | Decimal, int]
    own_times: Set[int]

    def have(self, time: Decimal) -> bool:
        """Return True if a time is one of the named times, or occurs in another part."""
        other_parts = self.parts_with.get(time, 0)
        if time in self.own_times:
            other_parts -= 1
        return time in self.named or other_parts > 0


def _compare_times(
    text: str, expected_times: set[int], elsewhere: _Elsewhere, path: Path, report: DocumentReport
) -> None:
    """Report the first time in a text that is neither one of the expected times nor elsewhere in the spec.

    Without expected times, nothing is reported.
    """
    if not expected_times:
        return
    for match in _KEPT_TIME.finditer(text):
        time = _to_nanoseconds(match)
        if time not in expected_times and not elsewhere.have(time):
            _report_time(match, expected_times, path, report)
            return


def _report_time(match: re.Match[str], expected_times: set[int], path: Path, report: DocumentReport) -> None:
    """Report a time in a text that is not one of the expected times. ``match`` has its groups number and unit."""
    times_text = join_words([nanoseconds(time) for time in sorted(expected_times)], "or")
    number, unit = match.group("number", "unit")
    message = (
        f"the text says {number} {unit}, but the time here is {times_text}; "
        "correct one of the two, or add the time to 'timings'"
    )
    report.add("time-repeated", path, message)


def _to_nanoseconds(match: re.Match[str]) -> Decimal:
    """Return the time that a match of ``_TIME_PATTERN`` found, in nanoseconds."""
    factor = _NANOSECONDS_PER_UNIT.get(match["unit"], _NANOSECONDS_PER_UNIT["s"])
    return Decimal(match["number"].replace(",", "")) * factor


def _nanoseconds_in(node: object) -> Iterator[int]:
    """Yield every time in a part of a spec, in nanoseconds: whole numbers under keys such as ``wait_ms``."""
    for path, value in leaves(node):
        unit = str(path[-1]).rpartition("_")[2] if path else ""  # ``ms`` of ``wait_ms``.
        if unit in _NANOSECONDS_PER_UNIT and isinstance(value, int):
            yield value * _NANOSECONDS_PER_UNIT[unit]


def _yield_texts(node: object, path: Path) -> Iterator[tuple[Path, str, set[int]]]:
    """Yield every text in a part of a spec, with its path and the times in the same map."""
    if isinstance(node, dict):
        numbers_by_key = {key: value for key, value in node.items() if isinstance(value, int)}
        nearby_times = set(_nanoseconds_in(numbers_by_key))
        for key, value in node.items():
            if isinstance(value, str) and key not in _NO_TEXTS:
                yield (*path, key), value, nearby_times
            else:
                yield from _yield_texts(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _yield_texts(value, (*path, index))


def check_conversions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a quantity that a characteristic or a text gives in two units is the same in both."""
    for characteristic in spec.characteristics:
        indices_by_quantity: dict[tuple[str, str], list[int]] = {}
        for index, quantity in enumerate(characteristic.part.values):
            indices_by_quantity.setdefault((quantity.quantity, quantity.where), []).append(index)
        for indices in indices_by_quantity.values():
            # If there are more than two, it is not known which of them belong together.
            if len(indices) == 2:
                first, second = (characteristic.part.values[index] for index in indices)
                _compare_bounds(second, first, (*characteristic.path, "values", indices[1]), report)
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed":
            continue
        for match in _QUANTITY_IN_TWO_UNITS.finditer(text):
            number = _PrintedNumber(Decimal(match["one"].replace("−", "-")), match["one_unit"])
            repeated_number = _PrintedNumber(Decimal(match["two"].replace("−", "-")), match["two_unit"])
            _compare_numbers(number, repeated_number, path, report)


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
    first_bounds = _bounds_of(first_quantity)
    for name, number in _bounds_of(quantity).items():
        if name in first_bounds:
            first_number = _PrintedNumber(first_bounds[name], first_quantity.unit)
            _compare_numbers(_PrintedNumber(number, quantity.unit), first_number, (*path, name), report)


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
    agrees = abs(converted - other_number) <= tolerance
    to_own_unit = _UNIT_CONVERSIONS[other.unit, printed.unit]
    agrees_in_own_unit = abs(to_own_unit(other_number) - number) <= printed.rounding
    agrees_as_difference = False
    if "°" in other.unit:
        converted_difference = converted - to_other_unit(0.0)
        # Half a degree, because differences are printed in whole degrees.
        agrees_as_difference = abs(converted_difference - other_number) <= max(0.5, other.rounding)
    if not agrees and not agrees_in_own_unit and not agrees_as_difference:
        message = f"{printed.number} {printed.unit} is {converted:.4g} {other.unit}, not {other.number}"
        report.add("quantity-text", path, message)
