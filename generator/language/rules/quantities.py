"""Rules for quantities with units: characteristics, columns of tables, and voltages and times in texts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from ...say.text import counted, nanoseconds
from ..document import Affected
from ..problems import DocumentReport, Path, listed, quoted
from .code_meanings import supply_named
from .walk import Spec, items, leaves, leaves_of, mapping

_UNITS = {
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
_WRITTEN = {"diameters": "×", "min": "min(?:ute)?s?", "s": "s(?:ec(?:ond)?s?)?"}
_BOUNDS = ("min", "typical", "max")
_NUMBER = r"(?<![\w.,])(?P<sign>[±−+-]?)\s?(?P<number>\d+(?:,\d{3})*(?:\.\d+)?)"
_MILLIVOLTS = {"V": 1000, "mV": 1}
_VOLTAGE = re.compile(r"(?<![\w.,])(\d+(?:\.\d+)?) ?(V|mV)\b")
#: Nanoseconds by the ends of keys and by the units in texts.
_NANOSECONDS = {"ns": 1, "us": 1000, "µs": 1000, "ms": 1_000_000, "s": 1_000_000_000}
_TIME = r"(?<![\w.,])(?P<number>\d+(?:,\d{3})*(?:\.\d+)?) ?(?P<unit>ns|us|µs|ms|s(?:econds?)?)\b(?!/)"
_ANY_TIME = re.compile(_TIME)
#: A time that the reader or the encoder must keep.
_KEPT_TIME = re.compile(rf"\b(?:[Ww]ait|[Pp]ause|[Ww]ithin|[Aa]t least|[Aa]t most)\w*\b[^.;:,]{{0,40}}?{_TIME}")
#: Parts of a spec in which a text may repeat a time.
_TIMED = ("registers", "procedures", "timings", "inputs")
_NO_TEXTS = frozenset(("source", "bytes", "bits", "name", "address"))
#: A quantity that a text gives in two units.
_SAME = re.compile(
    r"(?<![\w.,±])(?P<one>[−+-]?\d+(?:\.\d+)?) ?(?P<one_unit>°[CF]|mm|in)(?:,? which)? (?:is|=) "
    r"(?P<two>[−+-]?\d+(?:\.\d+)?) ?(?P<two_unit>°[CF]|mm|in)\b"
)
_CONVERTED: Mapping[tuple[str, str], Callable[[float], float]] = {
    ("°C", "°F"): lambda number: number * 1.8 + 32,
    ("°F", "°C"): lambda number: (number - 32) / 1.8,
    ("mm", "in"): lambda number: number / 25.4,
    ("in", "mm"): lambda number: number * 25.4,
}
_CELL = re.compile(r"(?:(?:above|at least|at most|below) |[<>≤≥] ?)?-?\d+(?:\.\d+)?")


def quantity_text(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the quantities of a characteristic have possible units and bounds, and are those of its text."""
    for path, characteristic in items(spec, "characteristics"):
        text = characteristic.get("value", "")
        listed_quantities: set[tuple[Decimal, str]] = set()
        for value_path, value in items(characteristic, "values"):
            numbers = _check_value(value, text, (*path, *value_path), report)
            listed_quantities |= {(number, value["unit"]) for number in numbers}
        for unit in sorted({unit for _, unit in listed_quantities}):
            for number in _plain_numbers(text, unit):
                if (number, unit) not in listed_quantities:
                    message = f"'values' does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*path, "value"), message)


def _check_value(value: Spec, text: str, path: Path, report: DocumentReport) -> list[Decimal]:
    """Check a value of a characteristic against its text. Return its bounds, or an empty list if they are invalid."""
    unit, kind = value["unit"], value["quantity"]
    if unit not in _UNITS[kind].split():
        units_text = listed(_UNITS[kind].split(), "or")
        report.add("quantity-text", (*path, "unit"), f"{quoted(kind)} is given in {units_text}, not in {unit}")
        return []
    bounds = {name: Decimal(str(value[name])) for name in _BOUNDS if name in value}
    numbers = list(bounds.values())
    if not bounds or numbers != sorted(numbers):
        report.add("quantity-text", path, "give 'min', 'typical' or 'max', in ascending order")
        return []
    possible_numbers = set(_possible_numbers(text, unit))
    for name, number in bounds.items():
        if number not in possible_numbers:
            message = f"the text does not give {number} {unit}; one of the two is wrong"
            report.add("quantity-text", (*path, name), message)
    return numbers


def _signed_numbers(text: str, unit: str) -> Iterator[tuple[str, Decimal]]:
    """Yield each number with a unit in a text, with its sign. The first of two numbers may have the unit of both."""
    end = _WRITTEN.get(unit, re.escape(unit))
    for match in re.finditer(rf"{_NUMBER}(?= ?{end}(?!\w|/))", text):
        yield match["sign"].replace("−", "-"), Decimal(match["number"].replace(",", ""))


def _plain_numbers(text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit that is not a tolerance."""
    for sign, number in _signed_numbers(text, unit):
        if sign != "±":
            yield -number if sign == "-" else number


def _possible_numbers(text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit in a text, and the bounds that its tolerances give."""
    plain_numbers = list(_plain_numbers(text, unit))
    yield from plain_numbers
    tolerances = [number for sign, number in _signed_numbers(text, unit) if sign == "±"]
    percentages = [number for sign, number in _signed_numbers(text, "%") if sign == "±"]
    nominal_numbers = plain_numbers or [Decimal(0)]  # A tolerance alone is about 0.
    for nominal in nominal_numbers:
        relative_tolerances = [nominal * (percentage / 100) for percentage in percentages]
        for tolerance in (*tolerances, *relative_tolerances):
            yield nominal - tolerance
            yield nominal + tolerance


def quantity_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a supply in a characteristic or a contact, and a threshold in a text, match those given elsewhere."""
    supply_ranges = _supply_ranges(spec)
    for path, characteristic in items(spec, "characteristics"):
        for value_path, value in items(characteristic, "values"):
            if value["quantity"] == "supply" and "min" in value and "max" in value:
                stated_range = int(value["min"] * 1000), int(value["max"] * 1000)
                _compare_supply(stated_range, supply_ranges, (*path, *value_path), report)
    for path, connector in items(spec, "connectors"):
        for contact_path, contact in items(connector, "contacts"):
            contact_supply = supply_named(contact["signal"])
            if contact_supply is not None and contact_supply[0] != contact_supply[1]:
                _compare_supply(contact_supply, supply_ranges, (*path, *contact_path, "signal"), report)
    for path, alarm in items(spec, "alarms"):
        threshold_mv = alarm.get("below_mv")
        if threshold_mv is not None:
            _compare_threshold(alarm, threshold_mv, path, report)
            for field_path, field in _fields_of_alarm(spec, alarm):
                _compare_threshold(field, threshold_mv, field_path, report)


def _supply_ranges(spec: Spec) -> list[tuple[Any, Any]]:
    """Return the supply ranges of the device and of its order code values, in millivolts."""
    owners = [spec]
    for _, part in items(spec, "order_code", "parts"):
        owners += part["values"].values()
    supplies = [mapping(owner, "supply") for owner in owners]
    return [(supply.get("min_mv"), supply.get("max_mv")) for supply in supplies if supply]


def _compare_supply(
    supply_range: tuple[int, int], ranges: list[tuple[Any, Any]], path: Path, report: DocumentReport
) -> None:
    """Report a supply that is not one of these ranges in millivolts, if there are any."""
    if ranges and supply_range not in ranges:
        ranges_text = listed([f"{low} to {high} mV" for low, high in ranges], "or")
        message = (
            f"this is {supply_range[0]} to {supply_range[1]} mV, but 'supply' is {ranges_text}; one of the two is wrong"
        )
        report.add("quantity-repeated", path, message)


def _compare_threshold(described: Spec, threshold_mv: int, path: Path, report: DocumentReport) -> None:
    """Report each voltage in the texts of an alarm or its field that is not the threshold of the alarm."""
    for key in ("meaning", "when_active"):
        for number, unit in _VOLTAGE.findall(described.get(key, "")):
            if Decimal(number) * _MILLIVOLTS[unit] != threshold_mv:
                message = (
                    f"the text says {number} {unit}, but 'below_mv' of the alarm is {threshold_mv}; "
                    "one of the two is wrong"
                )
                report.add("quantity-repeated", (*path, key), message)


def _fields_of_alarm(spec: Spec, alarm: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the field of an alarm, in its group or in its register."""
    for list_key, alarm_key in (("field_groups", "group"), ("registers", "register")):
        for path, owner in items(spec, list_key):
            if owner.get("name") != alarm.get(alarm_key, ""):
                continue
            for field_path, field in items(owner, "fields"):
                if field.get("name") == alarm.get("field"):
                    yield (*path, *field_path), field


def time_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a text does not contradict the times of its item, nor an erratum those of the facts it affects.

    A text may also repeat one of the ``timings``, or a time of another item. Overlays and older editions change times
    without changing every text, so they are not checked.
    """
    if report.document.other_files or report.document.family:
        return
    interfaces = mapping(spec, "interfaces")
    named_times = set(_times([mapping(owner).get("timings") for owner in (spec, *interfaces.values())]))
    timed_items: list[tuple[Path, Spec]] = []
    for key in _TIMED:
        timed_items += items(spec, key)
    times_of_items = [set(_times(timed_item)) for _, timed_item in timed_items]
    items_with: Counter[int] = Counter()
    for item_times in times_of_items:
        items_with.update(item_times)
    for (path, timed_item), item_times in zip(timed_items, times_of_items, strict=True):
        elsewhere = _Elsewhere(named_times, items_with, item_times)
        for place, text, nearby_times in _texts(timed_item, path):
            _compare_times(text, nearby_times or item_times, elsewhere, place, report)
    for name, interface in interfaces.items():
        elsewhere = _Elsewhere(named_times, items_with, set())
        for place, text, nearby_times in _texts(interface, ("interfaces", name)):
            _compare_times(text, nearby_times, elsewhere, place, report)
    _compare_errata(spec, named_times, report)
    _compare_symbols(spec, report)


def _compare_symbols(spec: Spec, report: DocumentReport) -> None:
    """Report each timing whose meaning gives another time after its symbol, as in ``tw > 20 µs``."""
    for path, timing in _with_symbol(spec):
        times = set(_times(timing))
        pattern = rf"\b{re.escape(timing['symbol'])} ?[<>=≤≥] ?{_TIME}"
        printed_times = list(re.finditer(pattern, timing.get("meaning", "")))
        if printed_times and times.isdisjoint(map(_nanoseconds, printed_times)):
            _report_time(printed_times[0], times, (*path, "meaning"), report)


def _compare_errata(spec: Spec, named_times: set[int], report: DocumentReport) -> None:
    """Report each erratum whose times differ from all times of the facts it affects."""
    affected_places, times_below = Affected(spec), _TimesBelow()
    for path, erratum in items(spec, "errata"):
        used_matches = list(_ANY_TIME.finditer(erratum.get("used", "")))
        if not used_matches:
            continue
        used_times = set(map(_nanoseconds, used_matches))
        facts: list[Any] = []
        for affected in dict.fromkeys(erratum.get("affects", ())):
            facts += affected_places.at(affected)
        affected_times = set().union(*map(times_below.of, facts))
        timings = [fact for fact in facts if _is_timing(fact)]
        timing_times = times_below.of(timings[0]) if len(timings) == 1 else set()
        if affected_times and used_times.isdisjoint(affected_times | named_times):
            _report_time(used_matches[0], affected_times, (*path, "used"), report)
        elif timing_times and used_times.isdisjoint(timing_times):
            _report_time(used_matches[0], timing_times, (*path, "used"), report)


class _TimesBelow:
    """The times below places of a spec, each found once although many errata may affect the same place."""

    def __init__(self) -> None:
        self._times: dict[int, set[int]] = {}

    def of(self, node: Any) -> set[int]:
        if id(node) not in self._times:
            self._times[id(node)] = set(_times(node))
        return self._times[id(node)]


def _is_timing(fact: Any) -> bool:
    return isinstance(fact, dict) and not {"at_least_us", "typical_us", "at_most_us"}.isdisjoint(fact)


def _with_symbol(spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the timings with a symbol, of the device and of its interfaces."""
    timings = list(items(spec, "timings"))
    for interface in mapping(spec, "interfaces"):
        timings += items(spec, "interfaces", interface, "timings")
    for path, timing in timings:
        if "symbol" in timing:
            yield path, timing


@dataclass(frozen=True, slots=True)
class _Elsewhere:
    """The times of a spec outside one item: the named ones, and those of other items.

    ``items_with`` counts the items that have a time, and ``item_times`` contains the times of the one item.
    """

    named: Set[int]
    items_with: Mapping[Any, int]
    item_times: Set[int]

    def __contains__(self, time: object) -> bool:
        if time in self.named:
            return True
        items_to_exceed = 1 if time in self.item_times else 0
        return self.items_with.get(time, 0) > items_to_exceed


def _compare_times(text: str, item_times: set[int], elsewhere: _Elsewhere, place: Path, report: DocumentReport) -> None:
    """Report the first time of a text that differs from all of these, if the item has times."""
    if not item_times:
        return
    for match in _KEPT_TIME.finditer(text):
        time = _nanoseconds(match)
        if time not in item_times and time not in elsewhere:
            _report_time(match, item_times, place, report)
            return


def _report_time(match: re.Match[str], item_times: set[int], place: Path, report: DocumentReport) -> None:
    times_text = listed([nanoseconds(time) for time in sorted(item_times)], "or")
    message = (
        f"the text says {match['number']} {match['unit']}, but the time here is {times_text}; "
        "correct one of the two, or add the time to 'timings'"
    )
    report.add("time-repeated", place, message)


def _nanoseconds(match: re.Match[str]) -> Decimal:
    return Decimal(match["number"].replace(",", "")) * _NANOSECONDS.get(match["unit"], _NANOSECONDS["s"])


def _times(node: Any) -> Iterator[int]:
    """Yield every time below a place, in nanoseconds."""
    for path, value in leaves(node):
        unit = str(path[-1]).rpartition("_")[2] if path else ""
        if unit in _NANOSECONDS and isinstance(value, int):
            yield value * _NANOSECONDS[unit]


def _texts(node: Any, path: Path) -> Iterator[tuple[Path, str, set[int]]]:
    """Yield every text below a place, with the times next to it."""
    if isinstance(node, dict):
        numbers = {key: value for key, value in node.items() if isinstance(value, int)}
        nearby_times = set(_times(numbers))
        for key, value in node.items():
            if isinstance(value, str) and key not in _NO_TEXTS:
                yield (*path, key), value, nearby_times
            else:
                yield from _texts(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _texts(value, (*path, index))


def conversions(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that quantities that are given in two units are the same in both."""
    for path, characteristic in items(spec, "characteristics"):
        values_by_quantity: dict[tuple[object, object], list[tuple[Path, Spec]]] = {}
        for value_path, value in items(characteristic, "values"):
            key = (value["quantity"], value.get("where"))
            values_by_quantity.setdefault(key, []).append(((*path, *value_path), value))
        for values in values_by_quantity.values():
            # With more than two values, nothing says which of them belong together.
            if len(values) == 2:
                (_, first_value), (second_path, second_value) = values
                _compare_bounds(second_value, first_value, second_path, report)
    for path, text in leaves_of(spec, report):
        if not isinstance(text, str) or path[-1] == "printed":
            continue
        for match in _SAME.finditer(text):
            quantity = _Quantity(Decimal(match["one"].replace("−", "-")), match["one_unit"])
            repetition = _Quantity(Decimal(match["two"].replace("−", "-")), match["two_unit"])
            _compare_quantities(quantity, repetition, path, report)


@dataclass(frozen=True, slots=True)
class _Quantity:
    """A number as printed, with its unit."""

    number: Any
    unit: str


def _compare_bounds(value: Spec, first_value: Spec, path: Path, report: DocumentReport) -> None:
    """Report each bound of a value that differs from that of a value of the same quantity in another unit."""
    for bound in _BOUNDS:
        if bound in value and bound in first_value:
            quantity = _Quantity(value[bound], value["unit"])
            first_quantity = _Quantity(first_value[bound], first_value["unit"])
            _compare_quantities(quantity, first_quantity, (*path, bound), report)


def _compare_quantities(quantity: _Quantity, printed: _Quantity, path: Path, report: DocumentReport) -> None:
    """Report a quantity that differs from another one, in another unit, by more than rounding."""
    convert = _CONVERTED.get((quantity.unit, printed.unit))
    if convert is None:
        return
    number, printed_number = float(quantity.number), float(printed.number)
    converted = convert(number)
    converted_back = _CONVERTED[printed.unit, quantity.unit](printed_number)
    half_digit = _half_digit(printed.number)
    is_rounded = abs(converted - printed_number) <= max(abs(converted) / 100, half_digit)
    is_rounded_back = abs(converted_back - number) <= _half_digit(quantity.number)
    # A difference of temperatures has no offset.
    converted_difference = converted - convert(0.0)
    is_difference = "°" in printed.unit and abs(converted_difference - printed_number) <= max(0.5, half_digit)
    if not is_rounded and not is_rounded_back and not is_difference:
        message = f"{quantity.number} {quantity.unit} is {converted:.4g} {printed.unit}, not {printed.number}"
        report.add("quantity-text", path, message)


def _half_digit(number: object) -> float:
    """Return half a unit of the last digit of a number as it is printed."""
    exponent = Decimal(str(number)).as_tuple().exponent
    return 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0


def column_units(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a table has one unit per column, and numbers in the columns that have a unit."""
    for path, table in items(spec, "tables"):
        if not table.get("units"):
            continue
        units, columns = table["units"], table["columns"]
        if len(units) != len(columns):
            counts = f"{counted(len(columns), 'column')} but {counted(len(units), 'unit')}"
            report.add("column-units", (*path, "units"), f'the table has {counts}; give one for each, or ""')
            continue
        for row, cells in enumerate(table["rows"]):
            # Another rule reports a row with too few or too many cells.
            for column, (unit, cell) in enumerate(zip(units, cells, strict=False)):
                if unit and not _CELL.fullmatch(str(cell)):
                    message = f"{quoted(str(cell))} is not a number, but the column has the unit {unit}"
                    report.add("column-units", (*path, "rows", row, column), message)


def table_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each row of a table has one cell per column."""
    for path, table in items(spec, "tables"):
        columns = len(table["columns"])
        for index, row in enumerate(table["rows"]):
            if len(row) != columns:
                message = f"the row has {counted(len(row), 'cell')}, but the table has {counted(columns, 'column')}"
                report.add("table-shape", (*path, "rows", index), message)
