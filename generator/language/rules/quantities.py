"""Rules for quantities with units: characteristics, and voltages and times in texts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Set
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
from .walk import leaves

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
#: Nanoseconds by the ends of keys and by the units in texts.
_NANOSECONDS_PER_UNIT = {"ns": 1, "us": 1000, "µs": 1000, "ms": 1_000_000, "s": 1_000_000_000}
#: A time such as ``20 µs``, but not a rate such as ``1 ms/m``.
_TIME_PATTERN = r"(?<![\w.,])(?P<number>\d+(?:,\d{3})*(?:\.\d+)?) ?(?P<unit>ns|us|µs|ms|s(?:econds?)?)\b(?!/)"
_ANY_TIME = re.compile(_TIME_PATTERN)
#: A time that the reader or the encoder must keep.
_KEPT_TIME = re.compile(rf"\b(?:[Ww]ait|[Pp]ause|[Ww]ithin|[Aa]t least|[Aa]t most)\w*\b[^.;:,]{{0,40}}?{_TIME_PATTERN}")
_NO_TEXTS = frozenset(("source", "bytes", "bits", "name", "address"))


def check_quantity_text(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that quantities of a characteristic have possible units and bounds, and the same numbers as its text."""
    for characteristic in spec.characteristics:
        printed_text = characteristic.part.value
        quantities = characteristic.part.values
        bounds_by_unit: dict[str, set[Decimal]] = {}
        for index, quantity in enumerate(quantities):
            path = (*characteristic.path, "values", index)
            bounds = _check_quantity(quantity, printed_text, path, report)
            if bounds:
                bounds_by_unit.setdefault(quantity.unit, set()).update(bounds)
        for unit, bounds_in_unit in sorted(bounds_by_unit.items()):
            if not bounds_in_unit.issubset(_possible_numbers(printed_text, unit)):
                continue  # The same difference is reported at the bound.
            for number in _plain_numbers(printed_text, unit):
                if number not in bounds_in_unit:
                    message = f"'values' does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*characteristic.path, "value"), message)


def _check_quantity(quantity: Quantity, characteristic_text: str, path: Path, report: DocumentReport) -> list[Decimal]:
    """Report a quantity of a characteristic that contradicts the text of the characteristic, and return its bounds.

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
    possible_numbers = set(_possible_numbers(characteristic_text, unit))
    for key, number in bounds_by_key.items():
        if number not in possible_numbers:
            message = f"the text does not give {number} {unit}; one of the two is wrong"
            report.add("quantity-text", (*path, key), message)
    return bounds


def bounds_of(quantity: Quantity) -> dict[str, float]:
    """Return the numbers of a quantity by their key, such as ``{"min": 4.5, "max": 5.5}``, in the order of the keys."""
    bounds = {"min": quantity.min, "typical": quantity.typical, "max": quantity.max}
    return {key: number for key, number in bounds.items() if number is not None}


def _signed_numbers(characteristic_text: str, unit: str) -> Iterator[tuple[str, Decimal]]:
    """Yield the sign and the size of each number with this unit in a text, such as ``("±", 5)`` and ``("-", 20)``."""
    unit_pattern = _UNITS_IN_TEXTS.get(unit, re.escape(unit))
    # The number of ``-20 °C``, but not of a quantity per another, such as ``20 m/s`` for the unit m.
    number_with_unit = rf"{_NUMBER_PATTERN}(?= ?{unit_pattern}(?!\w|/))"
    for match in re.finditer(number_with_unit, characteristic_text):
        sign, number_text = match.group("sign", "number")
        number = Decimal(number_text.replace(",", ""))
        yield sign.replace("−", "-"), number


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
            if quantity.quantity != "supply" or quantity.min is None or quantity.max is None:
                continue
            stated_range_mv = round(quantity.min * 1000), round(quantity.max * 1000)
            path: Path = (*characteristic.path, "values", index)
            _compare_supply(stated_range_mv, supply_ranges, path, report)
    for connector in spec.connectors:
        for index, contact in enumerate(connector.part.contacts):
            stated_supply = supply_named(contact.signal)
            if stated_supply is None:
                continue
            lowest_mv, highest_mv = stated_supply
            is_range = lowest_mv != highest_mv
            if is_range:
                path = (*connector.path, "contacts", index, "signal")
                _compare_supply(stated_supply, supply_ranges, path, report)
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
    for flag in _flags_of(spec, alarm.part):
        located_texts += [(flag.place_of("meaning"), flag.meaning), (flag.place_of("when_active"), flag.when_active)]
    for path, text in located_texts:
        for number, unit in _VOLTAGE_IN_TEXT.findall(text):
            voltage_mv = Decimal(number) * _MILLIVOLTS_PER_UNIT[unit]
            if voltage_mv != threshold_mv:
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
    named_times: set[int] = set()  # In nanoseconds, as all times here.
    for timing in timings(spec):
        named_times |= set(_nanoseconds_in(dict(timing.data)))
    timed_parts: list[PlacedPart] = [*spec.registers, *spec.procedures, *spec.timings, *spec.inputs]
    times_of_parts = [set(_nanoseconds_in(part.data)) for part in timed_parts]
    part_counts: Counter[int | Decimal] = Counter()
    for own_times in times_of_parts:
        part_counts.update(own_times)
    for part, own_times in zip(timed_parts, times_of_parts, strict=True):
        other_times = _TimesElsewhere(named_times, part_counts, own_times)
        for path, text, nearby_times in _yield_texts(part.data, part.path):
            expected_times = nearby_times or own_times
            _compare_times(text, expected_times, other_times, path, report)
    for _, interface in interfaces(spec):
        other_times = _TimesElsewhere(named_times, part_counts, own_times=set())
        for path, text, nearby_times in _yield_texts(interface.data, interface.path):
            _compare_times(text, nearby_times, other_times, path, report)
    _compare_errata(spec, named_times, report)
    _compare_symbols(spec, report)


def _compare_symbols(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report each timing whose meaning gives its symbol another time, as in ``tw > 20 µs``, than its own bounds."""
    for timing in timings(spec):
        if not timing.part.symbol:
            continue
        bounds = set(_nanoseconds_in(timing.data))
        symbol_with_time = rf"\b{re.escape(timing.part.symbol)} ?[<>=≤≥] ?{_TIME_PATTERN}"
        time_matches = list(re.finditer(symbol_with_time, timing.part.meaning))
        times_in_meaning = set(map(_to_nanoseconds, time_matches))
        if time_matches and bounds.isdisjoint(times_in_meaning):
            _report_time(time_matches[0], bounds, (*timing.path, "meaning"), report)


def _compare_errata(spec: WrittenSpec, named_times: set[int], report: DocumentReport) -> None:
    """Report each erratum with times in ``used``, its text about what applies, if none of them is in an affected fact.

    One of the ``named_times`` is accepted too, unless the erratum affects exactly one timing.
    """
    erratum_targets = ErratumTargets(spec.data)
    cached_times = _CachedTimes()
    for erratum in spec.errata:
        time_matches = list(_ANY_TIME.finditer(erratum.used))
        if not time_matches:
            continue
        used_times = set(map(_to_nanoseconds, time_matches))
        affected_facts: list[object] = []
        for affected_path in dict.fromkeys(erratum.affects):
            affected_facts += erratum_targets.at(affected_path)
        affected_times: set[int] = set()
        for fact in affected_facts:
            affected_times |= cached_times.times_in(fact)
        affected_timings = [fact for fact in affected_facts if _is_timing(fact)]
        times_of_only_timing = cached_times.times_in(affected_timings[0]) if len(affected_timings) == 1 else set()
        if affected_times and used_times.isdisjoint(affected_times | named_times):
            _report_time(time_matches[0], affected_times, erratum.place_of("used"), report)
        elif times_of_only_timing and used_times.isdisjoint(times_of_only_timing):
            _report_time(time_matches[0], times_of_only_timing, erratum.place_of("used"), report)


class _CachedTimes:
    """The times in parts of a spec, which are cached because many errata may affect the same part."""

    def __init__(self) -> None:
        self._times_by_node_id: dict[int, set[int]] = {}

    def times_in(self, node: object) -> set[int]:
        """Return all times in a part of a spec, in nanoseconds."""
        if id(node) not in self._times_by_node_id:
            self._times_by_node_id[id(node)] = set(_nanoseconds_in(node))
        return self._times_by_node_id[id(node)]


#: Keys of timings and of the timeout of BiSS.
_KEYS_OF_TIMINGS = frozenset(("at_least_us", "typical_us", "at_most_us", "at_most_ns", "typical_ns"))


def _is_timing(fact: object) -> bool:
    return isinstance(fact, dict) and not _KEYS_OF_TIMINGS.isdisjoint(fact)


@dataclass(frozen=True, slots=True)
class _TimesElsewhere:
    """The times of a spec outside one part: the named times in ``timings``, and the times of other parts.

    ``part_counts`` contains the number of parts with each time, and ``own_times`` the times of the one part.
    """

    named_times: Set[int]
    part_counts: Mapping[int | Decimal, int]
    own_times: Set[int]

    def contains(self, time: Decimal) -> bool:
        """Return True if a time is one of the named times, or occurs in another part."""
        other_part_count = self.part_counts.get(time, 0)
        if time in self.own_times:
            other_part_count -= 1
        return time in self.named_times or other_part_count > 0


def _compare_times(
    text: str, expected_times: set[int], other_times: _TimesElsewhere, path: Path, report: DocumentReport
) -> None:
    """Report the first time in a text that is neither one of the expected times nor elsewhere in the spec.

    Without expected times, nothing is reported.
    """
    if not expected_times:
        return
    for match in _KEPT_TIME.finditer(text):
        time = _to_nanoseconds(match)
        if time not in expected_times and not other_times.contains(time):
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
    number = Decimal(match["number"].replace(",", ""))
    # A unit without an entry is ``second`` or ``seconds``.
    nanoseconds_per_unit = _NANOSECONDS_PER_UNIT.get(match["unit"], _NANOSECONDS_PER_UNIT["s"])
    return number * nanoseconds_per_unit


def _nanoseconds_in(node: object) -> Iterator[int]:
    """Yield every time in a part of a spec, in nanoseconds: whole numbers under keys such as ``wait_ms``."""
    for path, value in leaves(node):
        key = str(path[-1]) if path else ""
        _, _, unit = key.rpartition("_")  # ``ms`` of ``wait_ms``.
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
