"""Rules for quantities with units: characteristics, columns of tables, and voltages and times in texts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from decimal import Decimal

from ...model import Alarm, Quantity
from ...say.text import count_with_unit, nanoseconds
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
_CELL_WITH_NUMBER = re.compile(r"(?:(?:above|at least|at most|below) |[<>≤≥] ?)?-?\d+(?:\.\d+)?")


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
    """Check a quantity of a characteristic against its text. Return its bounds, or none if they are invalid.

    A bound is a number of the text with the same unit, or one of its numbers plus or minus a tolerance.
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
    """Yield each number with a unit in a text, with its sign: ``("±", 5)`` and ``("-", 20)``."""
    unit_pattern = _UNITS_IN_TEXTS.get(unit, re.escape(unit))
    for match in re.finditer(rf"{_NUMBER_PATTERN}(?= ?{unit_pattern}(?!\w|/))", characteristic_text):
        sign, number = match.group("sign", "number")
        yield sign.replace("−", "-"), Decimal(number.replace(",", ""))


def _plain_numbers(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit that is not a tolerance."""
    for sign, number in _signed_numbers(characteristic_text, unit):
        if sign != "±":
            yield -number if sign == "-" else number


def _possible_numbers(characteristic_text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit in a text, and the bounds of its tolerances, in the unit or in percent."""
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
    """Check that the supply ranges and the thresholds in texts match 'supply' of the spec and 'below_mv' of alarms."""
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
    supply_range: tuple[int, int], ranges: list[tuple[int, int]], path: Path, report: DocumentReport
) -> None:
    """Report a supply that is not one of ``ranges`` in millivolts, if there are any."""
    if ranges and supply_range not in ranges:
        low_mv, high_mv = supply_range
        ranges_text = join_words([f"{low} to {high} mV" for low, high in ranges], "or")
        message = f"this is {low_mv} to {high_mv} mV, but 'supply' is {ranges_text}; one of the two is wrong"
        report.add("quantity-repeated", path, message)


def _check_threshold(spec: WrittenSpec, alarm: LocatedPart[Alarm], report: DocumentReport) -> None:
    """Check that the texts of an alarm, and of its flag, have no other voltage than the threshold of the alarm."""
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
    """Return the fields with the name of an alarm's flag, in its group and in its register."""
    fields_of_owner: list[WrittenField] = []
    for group in spec.field_groups:
        if group.name == alarm.group:
            fields_of_owner += group.fields
    for register in spec.registers:
        if register.name == alarm.register:
            fields_of_owner += register.fields
    return [field for field in fields_of_owner if field.name == alarm.field]


def check_repeated_times(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that neither a text nor an erratum contradicts the times that it concerns.

    A text is compared with the times next to it, or else with the times of its register, procedure, timing or input. An
    erratum is compared with the facts that it affects. It may also repeat one of the ``timings``, or a time of another
    item. Overlays and older editions change times without changing every text, so specs with either are not checked.
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
    """Report each timing whose meaning gives a time after its symbol, as in ``tw > 20 µs``, but none of its times."""
    for timing in timings(spec):
        if not timing.part.symbol:
            continue
        times = set(_nanoseconds_in(timing.data))
        pattern = rf"\b{re.escape(timing.part.symbol)} ?[<>=≤≥] ?{_TIME_PATTERN}"
        printed_times = list(re.finditer(pattern, timing.part.meaning))
        if printed_times and times.isdisjoint(map(_to_nanoseconds, printed_times)):
            _report_time(printed_times[0], times, (*timing.path, "meaning"), report)


def _compare_errata(spec: WrittenSpec, named_times: set[int], report: DocumentReport) -> None:
    """Report each erratum none of whose times occurs in a fact it affects, or in its only timing."""
    affected_places, times_below = ErratumTargets(spec.data), _TimesBelow()
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
    """The times below places of a spec, each found once although many errata may affect the same place."""

    def __init__(self) -> None:
        self._nanoseconds_in: dict[int, set[int]] = {}

    def of(self, node: object) -> set[int]:
        if id(node) not in self._nanoseconds_in:
            self._nanoseconds_in[id(node)] = set(_nanoseconds_in(node))
        return self._nanoseconds_in[id(node)]


#: Keys of timings and of the time-out of BiSS.
_KEYS_OF_TIMINGS = frozenset(("at_least_us", "typical_us", "at_most_us", "at_most_ns", "typical_ns"))


def _is_timing(fact: object) -> bool:
    return isinstance(fact, dict) and not _KEYS_OF_TIMINGS.isdisjoint(fact)


@dataclass(frozen=True, slots=True)
class _Elsewhere:
    """The times of a spec outside one part: the named times, and the times of other parts.

    ``parts_with`` counts the parts that have a time, and ``own_times`` contains the times of the one part.
    """

    named: Set[int]
    parts_with: Mapping[int | Decimal, int]
    own_times: Set[int]

    def have(self, time: Decimal) -> bool:
        """Return True if a time is named, or occurs in another part."""
        # If the part itself has the time, it is among the parts counted.
        parts_to_exceed = 1 if time in self.own_times else 0
        return time in self.named or self.parts_with.get(time, 0) > parts_to_exceed


def _compare_times(
    text: str, expected_times: set[int], elsewhere: _Elsewhere, path: Path, report: DocumentReport
) -> None:
    """Report the first time in a text that is neither expected nor elsewhere, if any times are expected."""
    if not expected_times:
        return
    for match in _KEPT_TIME.finditer(text):
        time = _to_nanoseconds(match)
        if time not in expected_times and not elsewhere.have(time):
            _report_time(match, expected_times, path, report)
            return


def _report_time(match: re.Match[str], expected_times: set[int], path: Path, report: DocumentReport) -> None:
    """Report a time in a text, as matched by ``_TIME_PATTERN``, that is not expected."""
    times_text = join_words([nanoseconds(time) for time in sorted(expected_times)], "or")
    number, unit = match.group("number", "unit")
    message = (
        f"the text says {number} {unit}, but the time here is {times_text}; "
        "correct one of the two, or add the time to 'timings'"
    )
    report.add("time-repeated", path, message)


def _to_nanoseconds(match: re.Match[str]) -> Decimal:
    factor = _NANOSECONDS_PER_UNIT.get(match["unit"], _NANOSECONDS_PER_UNIT["s"])
    return Decimal(match["number"].replace(",", "")) * factor


def _nanoseconds_in(node: object) -> Iterator[int]:
    """Yield every whole number below a place whose key ends in a unit of time, such as ``wait_ms``, in nanoseconds."""
    for path, value in leaves(node):
        unit = str(path[-1]).rpartition("_")[2] if path else ""  # ``ms`` of ``wait_ms``.
        if unit in _NANOSECONDS_PER_UNIT and isinstance(value, int):
            yield value * _NANOSECONDS_PER_UNIT[unit]


def _yield_texts(node: object, path: Path) -> Iterator[tuple[Path, str, set[int]]]:
    """Yield every text below a place, with its path and the times in the same map."""
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
    """Check that quantities that are given in two units are the same in both, in ``values`` and within texts."""
    for characteristic in spec.characteristics:
        indices_by_quantity: dict[tuple[str, str], list[int]] = {}
        for index, quantity in enumerate(characteristic.part.values):
            indices_by_quantity.setdefault((quantity.quantity, quantity.where), []).append(index)
        for indices in indices_by_quantity.values():
            # With more than two values, nothing says which of them belong together.
            if len(indices) == 2:
                first, second = (characteristic.part.values[index] for index in indices)
                _compare_bounds(second, first, (*characteristic.path, "values", indices[1]), report)
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed":
            continue
        for match in _QUANTITY_IN_TWO_UNITS.finditer(text):
            number = _Number(Decimal(match["one"].replace("−", "-")), match["one_unit"])
            repeated_number = _Number(Decimal(match["two"].replace("−", "-")), match["two_unit"])
            _compare_numbers(number, repeated_number, path, report)


@dataclass(frozen=True, slots=True)
class _Number:
    """A number as printed, with its unit."""

    number: Decimal | float
    unit: str


def _compare_bounds(quantity: Quantity, first: Quantity, path: Path, report: DocumentReport) -> None:
    """Report each bound that differs from the same bound of ``first``, the quantity in another unit."""
    first_bounds = _bounds_of(first)
    for name, number in _bounds_of(quantity).items():
        if name in first_bounds:
            first_number = _Number(first_bounds[name], first.unit)
            _compare_numbers(_Number(number, quantity.unit), first_number, (*path, name), report)


def _compare_numbers(measured: _Number, printed: _Number, path: Path, report: DocumentReport) -> None:
    """Report a number that differs from another number, in another unit, by more than rounding.

    It may differ by 1 %, or by half of the last printed digit in either unit. A temperature may also be a difference,
    which is converted without the offset. Two numbers whose units have no conversion are not compared.
    """
    convert = _UNIT_CONVERSIONS.get((measured.unit, printed.unit))
    if convert is None:
        return
    number, printed_number = float(measured.number), float(printed.number)
    converted = convert(number)
    converted_back = _UNIT_CONVERSIONS[printed.unit, measured.unit](printed_number)
    half_digit = _half_digit(printed.number)
    is_rounded = abs(converted - printed_number) <= max(abs(converted) / 100, half_digit)
    is_rounded_back = abs(converted_back - number) <= _half_digit(measured.number)
    # A difference of temperatures has no offset.
    converted_difference = converted - convert(0.0)
    is_difference = "°" in printed.unit and abs(converted_difference - printed_number) <= max(0.5, half_digit)
    if not is_rounded and not is_rounded_back and not is_difference:
        message = f"{measured.number} {measured.unit} is {converted:.4g} {printed.unit}, not {printed.number}"
        report.add("quantity-text", path, message)


def _half_digit(printed_number: Decimal | float) -> float:
    """Return half a unit of the last digit of a number as it is printed: 0.05 for 2.5."""
    exponent = Decimal(str(printed_number)).as_tuple().exponent
    return 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0


def check_column_units(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a table with units has one per column, and only numbers in the columns whose unit is not empty."""
    for table in spec.tables:
        units, columns = table.part.units, table.part.columns
        if not units:
            continue
        if len(units) != len(columns):
            counts = f"{count_with_unit(len(columns), 'column')} but {count_with_unit(len(units), 'unit')}"
            report.add("column-units", (*table.path, "units"), f'the table has {counts}; give one for each, or ""')
            continue
        for row_index, cells in enumerate(table.part.rows):
            # Another rule reports a row with too few or too many cells.
            for column_index, (unit, cell) in enumerate(zip(units, cells, strict=False)):
                if unit and not _CELL_WITH_NUMBER.fullmatch(cell):
                    message = f"{quoted(cell)} is not a number, but the column has the unit {unit}"
                    report.add("column-units", (*table.path, "rows", row_index, column_index), message)


def check_table_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each row of a table has one cell per column."""
    for table in spec.tables:
        column_count = len(table.part.columns)
        for row_index, row in enumerate(table.part.rows):
            if len(row) != column_count:
                cells, columns = count_with_unit(len(row), "cell"), count_with_unit(column_count, "column")
                message = f"the row has {cells}, but the table has {columns}"
                report.add("table-shape", (*table.path, "rows", row_index), message)
