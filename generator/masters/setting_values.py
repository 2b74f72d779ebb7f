"""Values of settings, by the rules of a master's description: numbers, choices, clocks and texts.

Everything about a master is in its description, a file in ``specs/masters``. See ``language/master.schema.json``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from ..language.master_items import NUMBERS, STEPS
from ..model.expressions import Expression, ExpressionError
from ..say.plain_text import decimal
from ..say.text import hertz
from .frame_parts import Part
from .record import Record

Raw = Mapping[str, Any]
#: Bound of a clock that is in use, while the limits of the encoder are not known.
START_WITH = "start_with"
_UNITS = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}


class UnknownValue(Exception):
    """A value depends on a number that the spec does not give."""


def _unknown_number(number: str, step: Fraction | None = None) -> UnknownValue:
    if number in STEPS and step is not None:
        return UnknownValue(f"one count is {decimal(step)} µm, not a whole number of {STEPS[number]}")
    return UnknownValue(f"not in the encoder's spec ({NUMBERS[number]})")


class UnsupportedFeature(Exception):
    """The master does not support a feature that the encoder needs."""


def applies(rule: Raw, record: Record) -> bool:
    """Return whether all conditions in ``when`` of a rule are known to hold."""
    return all(_condition_holds(condition, record) for condition in rule.get("when", ()))


def _condition_holds(condition: Raw, record: Record) -> bool:
    """Return whether a condition is known to hold."""
    name = condition["item"]
    is_known = name in record.words or record.numbers[name] is not None
    return is_known and is_within_limits(condition, record)


def is_within_limits(limit: Raw, record: Record) -> bool:
    """Return whether an item is within its limits or unknown."""
    name = limit["item"]
    if name in record.words:
        return record.words[name] in limit["is"]
    number = record.numbers[name]
    if number is None:
        return True
    is_within = limit.get("at_least", number) <= number <= limit.get("at_most", number)
    return is_within and number in limit.get("one_of", (number,)) and number not in limit.get("none_of", ())


def actual_value(name: str, record: Record) -> str:
    if name in record.words:
        return f"{name.replace('_', ' ')} {record.words[name]}"
    number = record.numbers[name]
    is_polynomial = name.startswith("crc_polynomial") and number is not None
    printed_number = f"0x{number:02X}" if is_polynomial else f"{number}"
    return f"{name.replace('_', ' ')} {printed_number}"


def value_of_setting(rule: Raw, record: Record) -> tuple[int | bool | str | None, str, str]:
    """Return the value, its text, and its bound."""
    if "unknown" in rule:
        raise UnknownValue(rule["unknown"])
    if "value" in rule:
        number = _evaluated(rule["value"], rule["name"], record, may_be_negative=rule.get("as") == "signed")
        if rule.get("as") == "boolean":
            text = "TRUE" if number else "FALSE"
            return bool(number), text, ""
        text = f"0x{number:02X}" if rule.get("as") == "hex" else str(number)
        return number, text, rule.get("bound", "")
    if "choice" in rule:
        chosen = _chosen_value(rule, record)
        return chosen, str(chosen), ""
    if "clocks" in rule:
        return _listed_clock(rule, record)
    if "any_clock" in rule:
        return _selectable_clock(rule["any_clock"], record)
    if "text" in rule:
        text = _filled_if_known(rule["text"], record)
        return text, text, ""
    text = "".join(_field_texts(rule["string"], rule["name"], record))
    return text, text, ""


def _evaluated(value: int | str, name: str, record: Record, *, may_be_negative: bool = False) -> int:
    """Return the number that an expression has for a record. ``name`` is the name of the setting."""
    expression = Expression.parse(value)
    for parameter in expression.parameters:
        if record.numbers[parameter] is None:
            raise _unknown_number(parameter, record.step)
    number: int | None
    try:
        number = expression.value(record.known_numbers)
    except ExpressionError:
        number = None
    if number is None or (number < 0 and not may_be_negative):
        raise UnsupportedFeature(f"{name} would be {expression.render()}, which cannot be set")
    return number


def _chosen_value(rule: Raw, record: Record) -> int | str:
    name = rule["choice"]["of"]
    actual = record.words.get(name, record.numbers.get(name))
    if actual is None:
        raise _unknown_number(name, record.step)
    for case in rule["choice"]["cases"]:
        if case["is"] == actual:
            chosen: int | str = case["set"]
            return chosen
    raise UnsupportedFeature(f"{rule['name']} has no value for {actual_value(name, record)}")


def _is_highest_clock_known(record: Record) -> bool:
    return record.numbers["clock_max_hz"] is not None


def _clock_limits(record: Record) -> tuple[int, int]:
    slowest, fastest = record.numbers["clock_min_hz"], record.numbers["clock_max_hz"]
    if fastest is None:
        raise _unknown_number("clock_max_hz")
    return slowest or 0, fastest


def _listed_clock(rule: Raw, record: Record) -> tuple[int | str, str, str]:
    best_clock = best_listed_clock(rule, record)
    frequency, value = hertz(best_clock["hz"]), best_clock["set"]
    text = frequency if str(value) == frequency else f"{value} ({frequency})"
    bound = "" if _is_highest_clock_known(record) else START_WITH
    return value, text, bound


def best_listed_clock(rule: Raw, record: Record) -> Raw:
    """Return the fastest of the master's clocks that the encoder supports, or that is in use if this is not known."""
    used_clocks = [clock for clock in rule["clocks"] if clock["hz"] in record.used_hz]
    if used_clocks:
        return _fastest_of(used_clocks)
    slowest, fastest = _clock_limits(record)
    fitting_clocks = [clock for clock in rule["clocks"] if slowest <= clock["hz"] <= fastest]
    if not fitting_clocks:
        with_cable = f" with a cable of {record.cable_m} m" if record.cable_m is not None else ""
        highest = _fastest_clock_text(record)
        raise UnsupportedFeature(
            f"{rule['name']}: no clock is between {hertz(slowest)} and {highest}, the limits of the encoder{with_cable}"
        )
    return _fastest_of(fitting_clocks)


def _fastest_of(clocks: Sequence[Raw]) -> Raw:
    return max(clocks, key=lambda clock: int(clock["hz"]))


def _fastest_clock_text(record: Record) -> str:
    """Return the highest clock in words, which a table of cable lengths may give as an exclusive limit."""
    row = record.cable_row
    return hertz(row.hz if row is not None else record.known_numbers["clock_max_hz"])


def _selectable_clock(clock: Raw, record: Record) -> tuple[int | str, str, str]:
    best_clock, unit = best_selectable_clock(clock, record), clock["unit"]
    bound = "at_most" if _is_highest_clock_known(record) else START_WITH
    row = record.cable_row
    if row is not None and row.is_below and best_clock == row.highest_hz:
        best_clock, bound = row.hz, "below"
    if unit not in _UNITS:
        return best_clock, hertz(best_clock), bound
    number = f"{best_clock / _UNITS[unit]:g}" if best_clock % _UNITS[unit] else str(best_clock // _UNITS[unit])
    text = f"{number} Hz ({hertz(best_clock)})" if unit == "Hz" else f"{number} {unit}"
    value: int | str = int(number) if number.isdigit() else number
    return value, text, bound


def best_selectable_clock(clock: Raw, record: Record) -> int:
    """Return the fastest clock that the encoder and the master support, for a master with freely selectable clocks."""
    lowest, highest = clock.get("at_least_hz", 0), clock.get("at_most_hz", math.inf)
    used_clocks = [hz for hz in record.used_hz if lowest <= hz <= highest]
    if used_clocks:
        return max(used_clocks)
    slowest, fastest = _clock_limits(record)
    best_clock = min(fastest, int(clock.get("at_most_hz", fastest)))
    if best_clock < max(slowest, lowest):
        supported = f"at most {hertz(highest)}" if highest < slowest else f"at least {hertz(lowest)}"
        needed = f"{hertz(slowest)} to {_fastest_clock_text(record)}"
        raise UnsupportedFeature(f"The master supports clocks of {supported}, but the encoder needs {needed}")
    return best_clock


def _filled_if_known(text: str, record: Record) -> str:
    """Return the text with the items in braces filled in, all of which must be known."""
    for name in NUMBERS:
        is_known = record.numbers[name] is not None or (name == "step_um" and record.step)
        if f"{{{name}}}" in text and not is_known:
            raise _unknown_number(name, record.step)
    return filled(text, record)


def filled(text: str, record: Record) -> str:
    """Return the text with the items in braces filled in, with ``unknown`` for those without a value."""
    if "{" not in text:
        return text
    if record.step is not None:
        text = text.replace("{step_um}", decimal(record.step))
    for name, value in {**record.words, **record.numbers}.items():
        text = text.replace(f"{{{name}}}", "unknown" if value is None else str(value))
    return text


def _field_texts(rule: Raw, name: str, record: Record) -> Iterator[str]:
    """Yield the text of each field of the frame, according to its kind."""
    texts: dict[str, str] = {}
    for field in rule["fields"]:
        if applies(field, record):
            texts.setdefault(field["of"], field["text"])
    yield _filled_if_known(rule.get("start", ""), record)
    parts = _with_whole_position(record) if "position" in texts else record.parts
    if rule["first"] != "sent_first":
        parts = parts[::-1]
    for part in parts:
        kind = f"status_active_{part.active or 'low'}" if part.role == "status" else part.role
        if kind not in texts:
            raise UnsupportedFeature(f"{filled(name, record)} cannot express '{part.name}'")
        yield _filled_if_known(texts[kind].replace("{bits}", str(part.bits)).replace("{name}", part.name), record)


def _with_whole_position(record: Record) -> tuple[Part, ...]:
    """Return the parts of the frame with multiturn and singleturn merged."""
    position = Part("position", "position", record.numbers["position_bits"] or 0)
    parts: list[Part] = []
    for part in record.parts:
        if part.role == "singleturn":
            parts.append(position)
        elif part.role != "multiturn":
            parts.append(part)
    return tuple(parts)
