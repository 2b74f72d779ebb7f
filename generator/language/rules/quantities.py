"""Rules for quantities with units: characteristics, columns of tables, and voltages and times in texts."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from ...say.words import counted, nanoseconds
from ..places import Affected
from ..problems import DocumentReport, Path, listed, quoted
from .meanings import supply_named
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
    for path, item in items(spec, "characteristics"):
        text, told = item.get("value", ""), set()
        for at, value in items(item, "values"):
            unit, kind = value["unit"], value["quantity"]
            if unit not in _UNITS[kind].split():
                right = listed(_UNITS[kind].split(), "or")
                report.add("quantity-text", (*path, *at, "unit"), f"{quoted(kind)} is given in {right}, not in {unit}")
                continue
            bounds = {name: Decimal(str(value[name])) for name in _BOUNDS if name in value}
            order = list(bounds.values())
            if not bounds or order != sorted(order):
                wrong = "give 'min', 'typical' or 'max', in ascending order"
                report.add("quantity-text", (*path, *at), wrong)
                continue
            told |= {(number, unit) for number in order}
            possible = set(_possible(text, unit))
            for name, number in bounds.items():
                if number not in possible:
                    wrong = f"the text does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*path, *at, name), wrong)
        for unit in sorted({unit for _, unit in told}):
            for number in _plain(text, unit):
                if (number, unit) not in told:
                    wrong = f"'values' does not give {number} {unit}; one of the two is wrong"
                    report.add("quantity-text", (*path, "value"), wrong)


def _found(text: str, unit: str) -> Iterator[tuple[str, Decimal]]:
    """Yield each number with a unit in a text, with its sign. The first of two numbers may have the unit of both."""
    end = _WRITTEN.get(unit, re.escape(unit))
    for item in re.finditer(rf"{_NUMBER}(?= ?{end}(?!\w|/))", text):
        yield item["sign"].replace("−", "-"), Decimal(item["number"].replace(",", ""))


def _plain(text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit that is not a tolerance."""
    yield from (-number if sign == "-" else number for sign, number in _found(text, unit) if sign != "±")


def _possible(text: str, unit: str) -> Iterator[Decimal]:
    """Yield each number with a unit in a text, and the bounds that its tolerances give."""
    plain = list(_plain(text, unit))
    yield from plain
    tolerances = [number for sign, number in _found(text, unit) if sign == "±"]
    parts = [number / 100 for sign, number in _found(text, "%") if sign == "±"]
    for middle in plain or [Decimal(0)]:
        for tolerance in (*tolerances, *(middle * part for part in parts)):
            yield from (middle - tolerance, middle + tolerance)


def quantity_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a supply in a characteristic or a contact, and a threshold in a text, match those given elsewhere."""
    values = [value for _, part in items(spec, "order_code", "parts") for value in part["values"].values()]
    supplies = [mapping(item, "supply") for item in (spec, *values)]
    ranges = [(item.get("min_mv"), item.get("max_mv")) for item in supplies if item]
    for path, item in items(spec, "characteristics"):
        for at, value in items(item, "values"):
            if value["quantity"] == "supply" and "min" in value and "max" in value:
                found = int(value["min"] * 1000), int(value["max"] * 1000)
                _compare_supply(found, ranges, (*path, *at), report)
    for path, item in items(spec, "connectors"):
        for at, contact in items(item, "contacts"):
            named = supply_named(contact["signal"])
            if named is not None and named[0] != named[1]:
                _compare_supply(named, ranges, (*path, *at, "signal"), report)
    for path, alarm in items(spec, "alarms"):
        threshold = alarm.get("below_mv")
        for place, item in ((path, alarm), *_fields(spec, alarm)) if threshold is not None else ():
            for key in ("meaning", "when_active"):
                for number, unit in _VOLTAGE.findall(item.get(key, "")):
                    if Decimal(number) * _MILLIVOLTS[unit] != threshold:
                        wrong = f"the text says {number} {unit}, but 'below_mv' of the alarm is {threshold}"
                        report.add("quantity-repeated", (*place, key), f"{wrong}; one of the two is wrong")


def _compare_supply(found: tuple[int, int], ranges: list[tuple[Any, Any]], path: Path, report: DocumentReport) -> None:
    """Report a supply that is not one of these ranges in millivolts, if there are any."""
    if ranges and found not in ranges:
        known = listed([f"{low} to {high} mV" for low, high in ranges], "or")
        wrong = f"this is {found[0]} to {found[1]} mV, but 'supply' is {known}; one of the two is wrong"
        report.add("quantity-repeated", path, wrong)


def _fields(spec: Spec, alarm: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the field of an alarm, in its group or in its register."""
    for key, owner in (("field_groups", "group"), ("registers", "register")):
        for path, item in items(spec, key):
            if item.get("name") == alarm.get(owner, ""):
                found = items(item, "fields")
                yield from (((*path, *at), field) for at, field in found if field.get("name") == alarm.get("field"))


def time_repeated(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a text does not contradict the times of its item, nor an erratum those of the facts it affects.

    A text may also repeat one of the ``timings``, or a time of another item. Overlays and older editions change times
    without changing every text, so they are not checked.
    """
    if report.document.others or report.document.family:
        return
    interfaces = [(("interfaces", name), item) for name, item in mapping(spec, "interfaces").items()]
    named = set(_times([mapping(item).get("timings") for item in (spec, *(item for _, item in interfaces))]))
    timed = [(path, item, set(_times(item))) for key in _TIMED for path, item in items(spec, key)]
    items_with = Counter(time for _, _, times in timed for time in times)
    for path, item, here in timed:
        others = _Elsewhere(named, items_with, here)
        for place, text, own in _texts(item, path):
            _compare_times(text, own or here, others, place, report)
    for path, item in interfaces:
        for place, text, own in _texts(item, path):
            _compare_times(text, own, _Elsewhere(named, items_with, set()), place, report)
    places, below = Affected(spec), _TimesBelow()
    for path, item in items(spec, "errata"):
        facts = [found for text in dict.fromkeys(item.get("affects", ())) for found in places.at(text)]
        affected = set().union(*map(below.of, facts))
        used = [(found, _nanoseconds(found)) for found in _ANY_TIME.finditer(item.get("used", ""))]
        of_timing = [below.of(found) for found in facts if _is_timing(found)]
        for known, possible in (
            (affected, affected | named),
            *((times, times) for times in of_timing[:1] if not of_timing[1:]),
        ):
            if known and used and possible.isdisjoint(time for _, time in used):
                _report_time(used[0][0], known, (*path, "used"), report)
                break
    for path, item in _with_symbol(spec):
        printed = list(re.finditer(rf"\b{re.escape(item['symbol'])} ?[<>=≤≥] ?{_TIME}", item.get("meaning", "")))
        if printed and set(_times(item)).isdisjoint(map(_nanoseconds, printed)):
            _report_time(printed[0], set(_times(item)), (*path, "meaning"), report)


class _TimesBelow:
    """The times below places of a spec, each found once although many errata may affect the same place."""

    def __init__(self) -> None:
        self._times: dict[int, set[int]] = {}

    def of(self, node: Any) -> set[int]:
        if id(node) not in self._times:
            self._times[id(node)] = set(_times(node))
        return self._times[id(node)]


def _is_timing(item: Any) -> bool:
    return isinstance(item, dict) and not {"at_least_us", "typical_us", "at_most_us"}.isdisjoint(item)


def _with_symbol(spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the timings with a symbol."""
    places = ((), *(("interfaces", name) for name in mapping(spec, "interfaces")))
    for place in places:
        yield from ((path, item) for path, item in items(spec, *place, "timings") if "symbol" in item)


@dataclass(frozen=True, slots=True)
class _Elsewhere:
    """The times of a spec outside one item: the named ones, and those of other items.

    ``items_with`` counts the items that have a time, and ``here`` contains the times of the one item.
    """

    named: Set[int]
    items_with: Mapping[Any, int]
    here: Set[int]

    def __contains__(self, time: object) -> bool:
        return time in self.named or self.items_with.get(time, 0) > (time in self.here)


def _compare_times(text: str, own: set[int], others: _Elsewhere, place: Path, report: DocumentReport) -> None:
    """Report the first time of a text that differs from all of these, if the item has times."""
    for found in _KEPT_TIME.finditer(text) if own else ():
        if (time := _nanoseconds(found)) not in own and time not in others:
            _report_time(found, own, place, report)
            return


def _report_time(found: re.Match[str], own: set[int], place: Path, report: DocumentReport) -> None:
    known = listed([nanoseconds(item) for item in sorted(own)], "or")
    wrong = f"the text says {found['number']} {found['unit']}, but the time here is {known}"
    report.add("time-repeated", place, f"{wrong}; correct one of the two, or add the time to 'timings'")


def _nanoseconds(found: re.Match[str]) -> Decimal:
    return Decimal(found["number"].replace(",", "")) * _NANOSECONDS.get(found["unit"], _NANOSECONDS["s"])


def _times(node: Any) -> Iterator[int]:
    """Yield every time below a place, in nanoseconds."""
    for path, value in leaves(node):
        unit = str(path[-1]).rpartition("_")[2] if path else ""
        if unit in _NANOSECONDS and isinstance(value, int):
            yield value * _NANOSECONDS[unit]


def _texts(node: Any, path: Path) -> Iterator[tuple[Path, str, set[int]]]:
    """Yield every text below a place, with the times next to it."""
    if isinstance(node, dict):
        own = set(_times({key: item for key, item in node.items() if isinstance(item, int)}))
        for key, item in node.items():
            if isinstance(item, str) and key not in _NO_TEXTS:
                yield (*path, key), item, own
            else:
                yield from _texts(item, (*path, key))
    elif isinstance(node, list):
        for index, item in enumerate(node):
            yield from _texts(item, (*path, index))


def conversions(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that quantities that are given in two units are the same in both."""
    for path, item in items(spec, "characteristics"):
        same: dict[tuple[object, object], list[tuple[Path, Spec]]] = {}
        for at, value in items(item, "values"):
            same.setdefault((value["quantity"], value.get("where")), []).append((at, value))
        # With more than two values, nothing says which of them belong together.
        for (_, other), (at, value) in (found for found in same.values() if len(found) == 2):
            for bound in _BOUNDS:
                if bound in value and bound in other and (right := _converted(value, other, bound)) is not None:
                    wrong = f"{value[bound]} {value['unit']} is {right:.4g} {other['unit']}, not {other[bound]}"
                    report.add("quantity-text", (*path, *at, bound), wrong)
    for path, text in leaves_of(spec, report):
        for found in _SAME.finditer(text) if isinstance(text, str) and path[-1] != "printed" else ():
            values = [
                {"number": Decimal(found[f"{key}"].replace("−", "-")), "unit": found[f"{key}_unit"]}
                for key in ("one", "two")
            ]
            if (right := _converted(values[0], values[1], "number")) is not None:
                wrong = f"{values[0]['number']} {values[0]['unit']} is {right:.4g} {values[1]['unit']}"
                report.add("quantity-text", path, f"{wrong}, not {values[1]['number']}")


def _converted(value: Spec, other: Spec, key: str) -> float | None:
    """Return a value in the unit of another if the other differs from it by more than rounding."""
    convert = _CONVERTED.get((value["unit"], other["unit"]))
    if convert is None:
        return None
    here, given = float(value[key]), float(other[key])
    right, back = convert(here), _CONVERTED[other["unit"], value["unit"]](given)
    is_rounded = abs(right - given) <= max(abs(right) / 100, _half_digit(other[key]))
    # A difference of temperatures has no offset.
    is_difference = "°" in other["unit"] and abs(right - convert(0.0) - given) <= max(0.5, _half_digit(other[key]))
    return None if is_rounded or is_difference or abs(back - here) <= _half_digit(value[key]) else right


def _half_digit(number: object) -> float:
    """Return half a unit of the last digit of a number as it is printed."""
    exponent = Decimal(str(number)).as_tuple().exponent
    return 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0


def column_units(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a table has one unit per column, and numbers in the columns that have a unit."""
    for path, table in items(spec, "tables"):
        units = table.get("units", [])
        if units and len(units) != len(table["columns"]):
            wrong = f"the table has {counted(len(table['columns']), 'column')} but {counted(len(units), 'unit')}"
            report.add("column-units", (*path, "units"), f'{wrong}; give one for each, or ""')
            continue
        for row, cells in enumerate(table["rows"] if units else ()):
            for column, (unit, cell) in enumerate(zip(units, cells, strict=False)):
                if unit and not _CELL.fullmatch(str(cell)):
                    wrong = f"{quoted(str(cell))} is not a number, but the column has the unit {unit}"
                    report.add("column-units", (*path, "rows", row, column), wrong)
