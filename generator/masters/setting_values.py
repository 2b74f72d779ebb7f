"""Values of settings, by the rules of a master's description: numbers, choices, clocks and texts.

Everything about a master is in its description, a file in ``specs/masters``. See ``language/master.schema.json``.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

from ..language.master_items import NUMBERS, STEPS, WORDS
from ..model.expressions import Expression, ExpressionError
from ..say.plain_text import decimal
from ..say.text import count_with_unit, hertz
from .frame_parts import FramePart
from .record import EncoderFacts

Raw = Mapping[str, Any]
#: Bound of a clock that is in use, while the limits of the encoder are not known.
START_WITH = "start_with"
_HZ_BY_UNIT = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}


class ValueOfSetting(NamedTuple):
    """Value of a setting, its text, and the bound of a clock, such as ``at_most``, or an empty bound."""

    value: int | bool | str | None
    text: str
    bound: str = ""


class UnknownValue(Exception):
    """A value depends on a number that the spec does not give."""


def _unknown_number(number: str, step: Fraction | None = None) -> UnknownValue:
    """Return the error about a number without a value.

    ``number`` is its name, such as ``step_um``. The ``step`` may be known, but not whole in the unit of this item.
    """
    if number in STEPS and step is not None:
        return UnknownValue(f"one count is {decimal(step)} µm, not a whole number of {STEPS[number]}")
    return UnknownValue(f"not in the encoder's spec ({NUMBERS[number]})")


class UnsupportedFeature(Exception):
    """The master does not support a feature that the encoder needs."""


def rule_applies(rule: Raw, record: EncoderFacts) -> bool:
    """Return whether all conditions in ``when`` of a rule are known to hold."""
    return all(_condition_holds(condition, record) for condition in rule.get("when", ()))


def _condition_holds(condition: Raw, record: EncoderFacts) -> bool:
    """Return whether a condition is known to hold."""
    name = condition["item"]
    is_known = name in record.words or record.numbers[name] is not None
    return is_known and is_within_limits(condition, record)


def is_within_limits(limit: Raw, record: EncoderFacts) -> bool:
    """Return whether an item of the record is within its limits, or a number without a value.

    The limits of a word are the list ``is``. Those of a number are ``at_least``, ``at_most``, ``one_of`` and
    ``none_of``, all of them optional.
    """
    name = limit["item"]
    if name in record.words:
        return record.words[name] in limit["is"]
    number = record.numbers[name]
    if number is None:
        return True
    # A limit that is not given defaults to the number itself, so it always holds.
    is_in_range = limit.get("at_least", number) <= number <= limit.get("at_most", number)
    is_listed = number in limit.get("one_of", (number,))
    is_excluded = number in limit.get("none_of", ())
    return is_in_range and is_listed and not is_excluded


#: Items that count bits: the kind of bit, and its place in the frame.
_COUNTED_BITS: Mapping[str, tuple[str, str]] = {
    "multiturn_bits": ("multiturn bit", ""),
    "singleturn_bits": ("singleturn bit", ""),
    "position_bits": ("position bit", ""),
    "padding_left": ("zero bit", " before the position"),
    "padding_right": ("zero bit", " after the position"),
    "data_bits": ("data bit", ""),
    "status_bits": ("status bit", ""),
    "data_and_status_bits": ("data and status bit", ""),
    "crc_bits": ("CRC bit", ""),
    "other_bits_left": ("other bit", " before the position"),
    "other_bits_right": ("other bit", " after the position"),
    "other_bits_after_status": ("other bit", " after the first status bit"),
    "parity_bits": ("parity bit", ""),
    "bits_without_crc": ("bit", " of data, status and others"),
    "frame_bits": ("bit", " in the frame"),
}


def actual_value(name: str, record: EncoderFacts) -> str:
    """Return an item of a record in words of a manual, such as ``Gray code`` or ``4 zero bits before the position``."""
    if name in record.words:
        return fill_template(WORDS[name][record.words[name]], record)
    number = record.known_numbers[name]
    if name in _COUNTED_BITS:
        bit, place = _COUNTED_BITS[name]
        return f"{count_with_unit(number, bit)}{place}"
    if name == "crc_inverted":
        return "an inverted CRC" if number else "a plain CRC"
    if name.startswith("crc_polynomial"):
        polynomial, _, _ = NUMBERS[name].partition(",")
        return f"{polynomial}: 0x{number:02X}"
    return f"{NUMBERS[name]}: {number}"


def encoder_has(name: str, record: EncoderFacts) -> str:
    """Return a sentence with an item of a record, such as ``This encoder has 4 zero bits before the position.``"""
    value = actual_value(name, record)
    if name == "frame_bits":
        return f"This encoder sends frames of {count_with_unit(record.known_numbers[name], 'bit')}."
    if name == "movement":
        return f"This encoder is {value}."
    is_noun = name in record.words or name in _COUNTED_BITS or name == "crc_inverted"
    return f"This encoder has {value}." if is_noun else f"For this encoder: {value}."


def value_of_setting(rule: Raw, record: EncoderFacts) -> ValueOfSetting:
    """Return the value of a setting, such as ``(5000, "5000 kHz", "at_most")``.

    Raises:
        UnknownValue: It depends on a number that the spec does not give.
        UnsupportedFeature: The master offers no value for it.
    """
    if "unknown" in rule:
        raise UnknownValue(rule["unknown"])
    if "value" in rule:
        number = _evaluate_expression(rule["value"], rule["name"], record, may_be_negative=rule.get("as") == "signed")
        if rule.get("as") == "boolean":
            text = "TRUE" if number else "FALSE"
            return ValueOfSetting(bool(number), text)
        text = f"0x{number:02X}" if rule.get("as") == "hex" else str(number)
        return ValueOfSetting(number, text, bound=rule.get("bound", ""))
    if "choice" in rule:
        chosen_value = _choose_value(rule, record)
        return ValueOfSetting(chosen_value, str(chosen_value))
    if "clocks" in rule:
        return _listed_clock(rule, record)
    if "any_clock" in rule:
        return _selectable_clock(rule["any_clock"], record)
    # What is left are texts: ``text`` with items filled in, or ``string`` with a text for each part of the frame.
    if "text" in rule:
        text = _filled_if_known(rule["text"], record)
        return ValueOfSetting(text, text)
    text = "".join(_field_texts(rule["string"], rule["name"], record))
    return ValueOfSetting(text, text)


def _evaluate_expression(
    value: int | str, setting_name: str, record: EncoderFacts, *, may_be_negative: bool = False
) -> int:
    """Return the value of an expression for a record.

    Raises:
        UnknownValue: The record lacks a number in the expression.
        UnsupportedFeature: The number is negative, or cannot be computed.
    """
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
        raise UnsupportedFeature(f"{setting_name} would be {expression.render()}, which cannot be set")
    return number


def _choose_value(rule: Raw, record: EncoderFacts) -> int | str:
    """Return the value ``set`` of the case whose ``is`` equals the deciding item of this encoder.

    Raises:
        UnknownValue: The spec does not give the deciding item.
        UnsupportedFeature: No case has its value.
    """
    deciding_item = rule["choice"]["of"]
    encoder_value = record.words.get(deciding_item, record.numbers.get(deciding_item))
    if encoder_value is None:
        raise _unknown_number(deciding_item, record.step)
    for case in rule["choice"]["cases"]:
        if case["is"] == encoder_value:
            setting_value: int | str = case["set"]
            return setting_value
    raise UnsupportedFeature(f"{rule['name']} has no value for {actual_value(deciding_item, record)}")


def _is_highest_clock_known(record: EncoderFacts) -> bool:
    return record.numbers["clock_max_hz"] is not None


def _clock_limits_hz(record: EncoderFacts) -> tuple[int, int]:
    """Return the slowest and the fastest clock of the encoder. The slowest is 0 if it is not known.

    Raises:
        UnknownValue: The fastest one is not known.
    """
    slowest_hz, fastest_hz = record.numbers["clock_min_hz"], record.numbers["clock_max_hz"]
    if fastest_hz is None:
        raise _unknown_number("clock_max_hz")
    return slowest_hz or 0, fastest_hz


def _listed_clock(rule: Raw, record: EncoderFacts) -> ValueOfSetting:
    """Return the value of a clock that the master selects from a list: ``(3, "3 (5 MHz)", "")``."""
    best_clock = best_listed_clock(rule, record)
    frequency_text = hertz(best_clock["hz"])
    value = best_clock["set"]
    text = frequency_text if str(value) == frequency_text else f"{value} ({frequency_text})"
    bound = "" if _is_highest_clock_known(record) else START_WITH
    return ValueOfSetting(value, text, bound)


def best_listed_clock(rule: Raw, record: EncoderFacts) -> Raw:
    """Return the fastest of the master's clocks that the encoder supports: ``{"hz": 5000000, "set": 3}``.

    If the highest clock of the encoder is not known, return the fastest clock in use.

    Raises:
        UnknownValue: The highest clock is not known, and the master has none of the clocks in use.
        UnsupportedFeature: The master has no clock within the limits of the encoder.
    """
    used_clocks = [clock for clock in rule["clocks"] if clock["hz"] in record.used_hz]
    if used_clocks:
        return _fastest_of(used_clocks)
    slowest_hz, fastest_hz = _clock_limits_hz(record)
    supported_clocks = [clock for clock in rule["clocks"] if slowest_hz <= clock["hz"] <= fastest_hz]
    if not supported_clocks:
        with_cable = f" with a cable of {record.cable_m} m" if record.cable_m is not None else ""
        slowest = hertz(slowest_hz)
        fastest = _fastest_clock_text(record)
        raise UnsupportedFeature(
            f"{rule['name']}: no clock is between {slowest} and {fastest}, the limits of the encoder{with_cable}"
        )
    return _fastest_of(supported_clocks)


def _fastest_of(clocks: Sequence[Raw]) -> Raw:
    return max(clocks, key=lambda clock: int(clock["hz"]))


def _fastest_clock_text(record: EncoderFacts) -> str:
    """Return the highest clock in words, which a table of cable lengths may give as an exclusive limit."""
    row = record.cable_row
    if row is not None:
        return hertz(row.hz)
    return hertz(record.known_numbers["clock_max_hz"])


def _selectable_clock(clock_rule: Raw, record: EncoderFacts) -> ValueOfSetting:
    """Return the value of a clock that the master takes as a number: ``(5000, "5000 kHz", "at_most")``.

    The number has the unit of the rule, or Hz if that is not a unit of frequency.
    """
    clock_hz = best_selectable_clock(clock_rule, record)
    bound = "at_most" if _is_highest_clock_known(record) else START_WITH
    row = record.cable_row
    # If the table prints an exclusive limit, ``row.highest_hz`` is lower than the printed ``row.hz``, which is shown.
    if row is not None and row.is_below and clock_hz == row.highest_hz:
        clock_hz = row.hz
        bound = "below"
    unit = clock_rule["unit"]
    if unit not in _HZ_BY_UNIT:
        return ValueOfSetting(clock_hz, hertz(clock_hz), bound)
    whole_number, remainder_hz = divmod(clock_hz, _HZ_BY_UNIT[unit])
    number_text = f"{clock_hz / _HZ_BY_UNIT[unit]:g}" if remainder_hz else str(whole_number)
    text = f"{number_text} Hz ({hertz(clock_hz)})" if unit == "Hz" else f"{number_text} {unit}"
    # A number with decimals stays a text, such as "1.25".
    value: int | str = int(number_text) if number_text.isdigit() else number_text
    return ValueOfSetting(value, text, bound)


def best_selectable_clock(clock_rule: Raw, record: EncoderFacts) -> int:
    """Return the fastest clock that the encoder and the master support, for a master with freely selectable clocks.

    If the highest clock of the encoder is not known, return the fastest in use that the master supports.

    Raises:
        UnknownValue: The highest clock is not known, and the master supports none of the clocks in use.
        UnsupportedFeature: No clock is within the limits of both.
    """
    lowest_of_master = clock_rule.get("at_least_hz", 0)
    highest_of_master = clock_rule.get("at_most_hz", math.inf)
    used_clocks = [hz for hz in record.used_hz if lowest_of_master <= hz <= highest_of_master]
    if used_clocks:
        return max(used_clocks)
    slowest_hz, fastest_hz = _clock_limits_hz(record)
    best_hz = min(fastest_hz, int(clock_rule.get("at_most_hz", fastest_hz)))
    if best_hz < max(slowest_hz, lowest_of_master):
        supported = f"at least {hertz(lowest_of_master)}"
        if highest_of_master < slowest_hz:
            supported = f"at most {hertz(highest_of_master)}"
        needed = f"{hertz(slowest_hz)} to {_fastest_clock_text(record)}"
        raise UnsupportedFeature(f"The master supports clocks of {supported}, but the encoder needs {needed}")
    return best_hz


def _filled_if_known(text: str, record: EncoderFacts) -> str:
    """Return the text with the items in braces filled in.

    Raises:
        UnknownValue: One of them is unknown.
    """
    for name in NUMBERS:
        is_in_text = f"{{{name}}}" in text
        is_known = record.numbers[name] is not None or (name == "step_um" and record.step)
        if is_in_text and not is_known:
            raise _unknown_number(name, record.step)
    return fill_template(text, record)


def fill_template(text: str, record: EncoderFacts) -> str:
    """Return the text with the items in braces filled in, and with ``unknown`` for items without a value."""
    if "{" not in text:
        return text
    if record.step is not None:
        text = text.replace("{step_um}", decimal(record.step))
    for name, value in {**record.words, **record.numbers}.items():
        text = text.replace(f"{{{name}}}", "unknown" if value is None else str(value))
    return text


def _field_texts(rule: Raw, setting_name: str, record: EncoderFacts) -> Iterator[str]:
    """Yield the text at the start, and then the text of each part of the frame, from the rule for its kind.

    The kind of a part is its role, or for a status bit ``status_active_low`` or ``status_active_high``.

    Raises:
        UnknownValue: The text needs a number without a value.
        UnsupportedFeature: There is no rule for a kind.
    """
    # The first rule for a kind that applies is used.
    template_by_kind: dict[str, str] = {}
    for field_rule in rule["fields"]:
        if rule_applies(field_rule, record):
            template_by_kind.setdefault(field_rule["of"], field_rule["text"])
    yield _filled_if_known(rule.get("start", ""), record)
    has_whole_position = "position" in template_by_kind
    parts = _with_whole_position(record) if has_whole_position else _with_two_parts_of_position(record)
    # The record lists the parts in the order sent.
    if rule["first"] != "sent_first":
        parts = parts[::-1]
    for part in parts:
        kind = part.role
        if part.role == "status":
            kind = f"status_active_{part.active or 'low'}"
        if kind not in template_by_kind:
            raise UnsupportedFeature(f"{fill_template(setting_name, record)} cannot express '{part.name}'")
        template = template_by_kind[kind]
        part_text = template.replace("{bits}", str(part.bits)).replace("{name}", part.name)
        yield _filled_if_known(part_text, record)


def _with_whole_position(record: EncoderFacts) -> Sequence[FramePart]:
    """Return the parts of the frame with all parts of the position merged into one."""
    roles = ["position" if part.role in ("multiturn", "singleturn") else part.role for part in record.parts]
    parts = [replace(part, role=role) for part, role in zip(record.parts, roles, strict=True)]
    return _with_neighbours_merged(parts, ("position",))


def _with_two_parts_of_position(record: EncoderFacts) -> Sequence[FramePart]:
    """Return the parts of the frame with all multiturn bits in one, and all singleturn bits in one."""
    return _with_neighbours_merged(record.parts, ("multiturn", "singleturn"))


def _with_neighbours_merged(frame_parts: Sequence[FramePart], roles: Collection[str]) -> Sequence[FramePart]:
    """Return the parts, with adjacent parts of the same role merged if the role is in ``roles``.

    Two neighbouring parts of 4 and 8 singleturn bits become the part ``singleturn`` of 12 bits. Such a part is named
    after its role, even if it has no such neighbour.
    """
    merged_parts: list[FramePart] = []
    for part in frame_parts:
        if part.role not in roles:
            merged_parts.append(part)
        elif merged_parts and merged_parts[-1].role == part.role:
            merged_parts[-1] = replace(merged_parts[-1], bits=merged_parts[-1].bits + part.bits)
        else:
            merged_parts.append(replace(part, name=part.role))
    return merged_parts
