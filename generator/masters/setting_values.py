"""Values of settings, by the rules of a master's description: numbers, choices, clocks and texts.

Everything about a master is in its description, a file in ``specs/masters``. See ``language/master.schema.json``.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from ..language.keys_of_masters import NUMBERS, STEPS, WORDS
from ..model.expressions import Expression, ExpressionError
from ..say import decimal
from ..say.text import count_with_unit, hertz
from .encoder_facts import EncoderFacts
from .frame_parts import FramePart
from .places_and_writing import YamlMapping as YamlMapping

#: Bound of a clock frequency that is known to work with the encoder, while its highest clock is unknown.
START_WITH = "start_with"
_HZ_BY_UNIT = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}


class ValueOfSetting(NamedTuple):
    """Value of a setting, its text, and the bound of a clock, such as ``at_most``, or an empty bound."""

    value: int | bool | str | None
    text: str
    bound: str = ""


class UnknownValue(Exception):
    """A value depends on a number that the spec does not give."""


def _unknown_number(number_name: str, count_size_um: Fraction | None = None) -> UnknownValue:
    """Return the error for a number that the spec does not give. ``number_name`` is its name, such as ``step_um``.

    If ``count_size_um`` is not None, the size of a count is known, but is not a whole number in the unit of the name.
    """
    if number_name in STEPS and count_size_um is not None:
        return UnknownValue(f"one count is {decimal(count_size_um)} µm, not a whole number of {STEPS[number_name]}")
    return UnknownValue(f"not in the encoder's spec ({NUMBERS[number_name]})")


class UnsupportedFeature(Exception):
    """The master does not support a feature that the encoder needs."""


def rule_applies(rule: YamlMapping, facts: EncoderFacts) -> bool:
    """Return whether a rule of a master's description applies to an encoder: all conditions in ``when`` are met.

    A condition on a number that the spec does not give is not met.
    """
    return all(_condition_holds(condition, facts) for condition in rule.get("when", ()))


def _condition_holds(condition: YamlMapping, facts: EncoderFacts) -> bool:
    """Return whether a fact about the encoder is known, and meets a condition."""
    fact_name = condition["item"]
    is_known = fact_name in facts.words or facts.numbers[fact_name] is not None
    return is_known and is_within_limits(condition, facts)


def is_within_limits(limit: YamlMapping, facts: EncoderFacts) -> bool:
    """Return whether a fact about the encoder meets a limit of a master, or is a number that the spec does not give.

    A fact that is a word must be in the list ``is``. A number has the limits ``at_least``, ``at_most``, ``one_of`` and
    ``none_of``, all of them optional.
    """
    fact_name = limit["item"]
    if fact_name in facts.words:
        return facts.words[fact_name] in limit["is"]
    number = facts.numbers[fact_name]
    if number is None:
        return True
    # A limit that is not given defaults to the number itself, which always meets it.
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


def fact_in_words(fact_name: str, facts: EncoderFacts) -> str:
    """Return a fact about an encoder in words, such as ``Gray code`` or ``4 zero bits before the position``.

    ``fact_name`` is the name of the fact in rules, such as ``coding`` or ``padding_left``.
    """
    if fact_name in facts.words:
        return fill_template(WORDS[fact_name][facts.words[fact_name]], facts)
    number = facts.known_numbers[fact_name]
    if fact_name in _COUNTED_BITS:
        unit, place_in_frame = _COUNTED_BITS[fact_name]
        return f"{count_with_unit(number, unit)}{place_in_frame}"
    if fact_name == "crc_inverted":
        return "an inverted CRC" if number else "a plain CRC"
    if fact_name.startswith("crc_polynomial"):
        notation, _, _ = NUMBERS[fact_name].partition(",")
        return f"{notation}: 0x{number:02X}"
    return f"{NUMBERS[fact_name]}: {number}"


def padding_text(facts: EncoderFacts) -> str:
    """Return the zero bits around the position in words, such as ``4 zero bits before the position``, or ``none``."""
    padding_names = [name for name in ("padding_left", "padding_right") if facts.known_numbers.get(name)]
    return ", ".join(fact_in_words(name, facts) for name in padding_names) or "none"


def sentence_about_encoder(fact_name: str, facts: EncoderFacts) -> str:
    """Return a fact about an encoder as a sentence, such as ``This encoder has 4 zero bits before the position.``"""
    fact_text = fact_in_words(fact_name, facts)
    if fact_name == "frame_bits":
        return f"This encoder sends frames of {count_with_unit(facts.known_numbers[fact_name], 'bit')}."
    if fact_name == "movement":
        return f"This encoder is {fact_text}."
    is_noun = fact_name in facts.words or fact_name in _COUNTED_BITS or fact_name == "crc_inverted"
    return f"This encoder has {fact_text}." if is_noun else f"For this encoder: {fact_text}."


def value_of_setting(rule: YamlMapping, facts: EncoderFacts) -> ValueOfSetting:
    """Return the value of a setting for an encoder, such as ``(5000, "5000 kHz", "at_most")``.

    ``rule`` describes how the master's setting follows from facts about the encoder: an expression, a choice, a clock,
    or a text.

    Raises:
        UnknownValue: The value depends on a number that the spec does not give.
        UnsupportedFeature: The master has no value for this encoder.
    """
    if "unknown" in rule:
        raise UnknownValue(rule["unknown"])
    if "value" in rule:
        notation = rule.get("as")
        number = _evaluate_expression(rule["value"], rule["name"], facts, may_be_negative=notation == "signed")
        if notation == "boolean":
            return ValueOfSetting(bool(number), text="TRUE" if number else "FALSE")
        text = f"0x{number:02X}" if notation == "hex" else str(number)
        return ValueOfSetting(number, text, bound=rule.get("bound", ""))
    if "choice" in rule:
        chosen_value = _choose_value(rule, facts)
        return ValueOfSetting(chosen_value, str(chosen_value))
    if "clocks" in rule:
        return _listed_clock(rule, facts)
    if "any_clock" in rule:
        return _selectable_clock(rule["any_clock"], facts)
    if "text" in rule:
        text = _fill_known_template(rule["text"], facts)
    else:  # The value is a text with a part for each field of the frame.
        text = "".join(_field_texts(rule["string"], rule["name"], facts))
    return ValueOfSetting(text, text)


def _evaluate_expression(
    value: int | str, setting_name: str, facts: EncoderFacts, *, may_be_negative: bool = False
) -> int:
    """Return the number that an expression of a rule, such as ``data_bits - 1``, has for an encoder.

    Raises:
        UnknownValue: The spec does not give a number in the expression.
        UnsupportedFeature: The result is negative, or cannot be computed.
    """
    expression = Expression.parse(value)
    for parameter in expression.parameters:
        if facts.numbers[parameter] is None:
            raise _unknown_number(parameter, facts.count_size_um)
    error = UnsupportedFeature(f"{setting_name} would be {expression.render()}, which cannot be set")
    try:
        number = expression.value(facts.known_numbers)
    except ExpressionError:
        raise error from None
    if number < 0 and not may_be_negative:
        raise error
    return number


def _choose_value(rule: YamlMapping, facts: EncoderFacts) -> int | str:
    """Return the value of a setting that depends on one fact about the encoder, such as the coding of the position.

    The choice in the rule lists cases: ``is`` is a value of the fact, and ``set`` is the value of the setting.

    Raises:
        UnknownValue: The spec does not give the fact.
        UnsupportedFeature: The choice has no case for it.
    """
    fact_name = rule["choice"]["of"]
    encoder_value = facts.words.get(fact_name, facts.numbers.get(fact_name))
    if encoder_value is None:
        raise _unknown_number(fact_name, facts.count_size_um)
    for case in rule["choice"]["cases"]:
        if case["is"] == encoder_value:
            setting_value: int | str = case["set"]
            return setting_value
    raise UnsupportedFeature(f"{rule['name']} has no value for {fact_in_words(fact_name, facts)}")


def _is_highest_clock_known(facts: EncoderFacts) -> bool:
    """Return whether the spec gives the highest clock of the encoder."""
    return facts.numbers["clock_max_hz"] is not None


def _clock_limits_hz(facts: EncoderFacts) -> tuple[int, int]:
    """Return the lowest and the highest clock of the encoder in Hz. The lowest is 0 if the spec does not give it.

    Raises:
        UnknownValue: The spec does not give the highest clock.
    """
    slowest_hz = facts.numbers["clock_min_hz"]
    fastest_hz = facts.numbers["clock_max_hz"]
    if fastest_hz is None:
        raise _unknown_number("clock_max_hz")
    return slowest_hz or 0, fastest_hz


def _listed_clock(rule: YamlMapping, facts: EncoderFacts) -> ValueOfSetting:
    """Return the value of a clock setting for which the master has a list of clocks: ``(3, "3 (5 MHz)", "")``."""
    best_clock = best_listed_clock(rule, facts)
    frequency_text = hertz(best_clock["hz"])
    value = best_clock["set"]
    # Some masters are set to the text of a frequency, and others to its number in their list.
    text = frequency_text if str(value) == frequency_text else f"{value} ({frequency_text})"
    bound = "" if _is_highest_clock_known(facts) else START_WITH
    return ValueOfSetting(value, text, bound)


def best_listed_clock(rule: YamlMapping, facts: EncoderFacts) -> YamlMapping:
    """Return the fastest of the master's clocks that the encoder supports: ``{"hz": 5000000, "set": 3}``.

    If the highest clock of the encoder is unknown, it is the fastest one of those with which the encoder is known to
    work (``used_hz``).

    Raises:
        UnknownValue: The highest clock is unknown, and the master has none of the clocks that are known to work.
        UnsupportedFeature: The master has no clock within the limits of the encoder.
    """
    used_clocks = [clock for clock in rule["clocks"] if clock["hz"] in facts.used_hz]
    if used_clocks:
        return _fastest_of(used_clocks)
    slowest_hz, fastest_hz = _clock_limits_hz(facts)
    supported_clocks = [clock for clock in rule["clocks"] if slowest_hz <= clock["hz"] <= fastest_hz]
    if not supported_clocks:
        cable_text = f" with a cable of {facts.cable_m} m" if facts.cable_m is not None else ""
        slowest_text = hertz(slowest_hz)
        fastest_text = _fastest_clock_text(facts)
        raise UnsupportedFeature(
            f"{rule['name']}: no clock is between {slowest_text} and {fastest_text}, "
            f"the limits of the encoder{cable_text}"
        )
    return _fastest_of(supported_clocks)


def _fastest_of(clocks: Sequence[YamlMapping]) -> YamlMapping:
    """Return the fastest of the clocks in the list of a master."""
    return max(clocks, key=lambda clock: int(clock["hz"]))


def _fastest_clock_text(facts: EncoderFacts) -> str:
    """Return the highest clock of the encoder in words, as printed in the table of cable lengths if that limits it."""
    cable_row = facts.cable_row
    if cable_row is not None:
        return hertz(cable_row.hz)
    return hertz(facts.known_numbers["clock_max_hz"])


def _selectable_clock(clock_rule: YamlMapping, facts: EncoderFacts) -> ValueOfSetting:
    """Return the value of a clock setting for which the master takes any number: ``(5000, "5000 kHz", "at_most")``.

    The number has the unit of the rule, or Hz if that is not a unit of frequency.
    """
    clock_hz = best_selectable_clock(clock_rule, facts)
    bound = "at_most" if _is_highest_clock_known(facts) else START_WITH
    cable_row = facts.cable_row
    # The table of cable lengths may give an exclusive limit. It is shown as printed.
    if cable_row is not None and cable_row.is_below and clock_hz == cable_row.highest_hz:
        clock_hz = cable_row.hz
        bound = "below"
    return _clock_in_unit(clock_hz, clock_rule["unit"], bound)


def _clock_in_unit(clock_hz: int, unit: str, bound: str) -> ValueOfSetting:
    """Return a clock as a number in this unit, or in Hz if that is not a unit of frequency."""
    if unit not in _HZ_BY_UNIT:
        return ValueOfSetting(clock_hz, text=hertz(clock_hz), bound=bound)
    hz_per_unit = _HZ_BY_UNIT[unit]
    is_whole_number = clock_hz % hz_per_unit == 0
    number_text = str(clock_hz // hz_per_unit) if is_whole_number else f"{clock_hz / hz_per_unit:g}"
    text = f"{number_text} Hz ({hertz(clock_hz)})" if unit == "Hz" else f"{number_text} {unit}"
    # A number with decimals, such as "1.25", remains a text.
    value: int | str = int(number_text) if number_text.isdigit() else number_text
    return ValueOfSetting(value, text, bound)


def best_selectable_clock(clock_rule: YamlMapping, facts: EncoderFacts) -> int:
    """Return the fastest clock in Hz that both the encoder and the master support, for a master that takes any number.

    If the highest clock of the encoder is unknown, it is the fastest one that the master supports of those with which
    the encoder is known to work (``used_hz``).

    Raises:
        UnknownValue: The highest clock is unknown, and the master supports none of the clocks that are known to work.
        UnsupportedFeature: No clock is within the limits of both.
    """
    slowest_of_master = clock_rule.get("at_least_hz", 0)
    fastest_of_master = clock_rule.get("at_most_hz", math.inf)
    usable_clocks = [clock_hz for clock_hz in facts.used_hz if slowest_of_master <= clock_hz <= fastest_of_master]
    if usable_clocks:
        return max(usable_clocks)
    slowest_of_encoder, fastest_of_encoder = _clock_limits_hz(facts)
    best_hz = int(min(fastest_of_encoder, fastest_of_master))
    if best_hz < max(slowest_of_encoder, slowest_of_master):
        supported_text = f"at least {hertz(slowest_of_master)}"
        if fastest_of_master < slowest_of_encoder:
            supported_text = f"at most {hertz(fastest_of_master)}"
        needed_text = f"{hertz(slowest_of_encoder)} to {_fastest_clock_text(facts)}"
        raise UnsupportedFeature(f"The master supports clocks of {supported_text}, but the encoder needs {needed_text}")
    return best_hz


def _fill_known_template(template: str, facts: EncoderFacts) -> str:
    """Return a text in which names in braces, such as ``{data_bits}``, are replaced by facts about the encoder.

    Raises:
        UnknownValue: The spec does not give one of these facts.
    """
    for fact_name in NUMBERS:
        is_in_text = f"{{{fact_name}}}" in template
        is_known = facts.numbers[fact_name] is not None
        # fill_template() can also write a size of a count that is not a whole number of micrometers.
        is_known_step = fact_name == "step_um" and bool(facts.count_size_um)
        if is_in_text and not is_known and not is_known_step:
            raise _unknown_number(fact_name, facts.count_size_um)
    return fill_template(template, facts)


def fill_template(text: str, facts: EncoderFacts) -> str:
    """Return a text in which names in braces, such as ``{data_bits}``, are replaced by facts about the encoder.

    A fact that the spec does not give becomes ``unknown``.
    """
    if "{" not in text:
        return text
    if facts.count_size_um is not None:
        text = text.replace("{step_um}", decimal(facts.count_size_um))
    fact_by_name = {**facts.words, **facts.numbers}
    for fact_name, fact in fact_by_name.items():
        name_in_braces = f"{{{fact_name}}}"
        text = text.replace(name_in_braces, "unknown" if fact is None else str(fact))
    return text


def _field_texts(rule: YamlMapping, setting_name: str, facts: EncoderFacts) -> Iterator[str]:
    """Yield the texts that describe a frame to a master, one for each part of the frame, after a text for the start.

    The rule has a template for each kind of part. The kind is the role of the part, such as ``crc``, or for a status
    bit ``status_active_low`` or ``status_active_high``.

    Raises:
        UnknownValue: A template needs a number that the spec does not give.
        UnsupportedFeature: There is no template for a kind.
    """
    template_by_kind = _template_by_part_kind(rule, facts)
    yield _fill_known_template(rule.get("start", ""), facts)
    has_whole_position = "position" in template_by_kind
    frame_parts = _with_whole_position(facts) if has_whole_position else _with_two_parts_of_position(facts)
    # The parts are in the order in which they are sent.
    if rule["first"] != "sent_first":
        frame_parts = frame_parts[::-1]
    for frame_part in frame_parts:
        part_kind = _kind_of_part(frame_part)
        if part_kind not in template_by_kind:
            setting_title = fill_template(setting_name, facts)
            raise UnsupportedFeature(f"{setting_title} cannot express '{frame_part.name}'")
        text_of_part = template_by_kind[part_kind].replace("{bits}", str(frame_part.bits))
        text_of_part = text_of_part.replace("{name}", frame_part.name)
        yield _fill_known_template(text_of_part, facts)


def _template_by_part_kind(rule: YamlMapping, facts: EncoderFacts) -> dict[str, str]:
    """Return the first template for each kind of part that applies to the encoder."""
    template_by_kind: dict[str, str] = {}
    for field_rule in rule["fields"]:
        if rule_applies(field_rule, facts):
            template_by_kind.setdefault(field_rule["of"], field_rule["text"])
    return template_by_kind


def _kind_of_part(frame_part: FramePart) -> str:
    """Return the kind by which a part of the frame is described: its role, and for a status bit also its level."""
    # A status bit that never changes counts as active low.
    return f"status_active_{frame_part.active or 'low'}" if frame_part.role == "status" else frame_part.role


def _with_whole_position(facts: EncoderFacts) -> Sequence[FramePart]:
    """Return the parts of the frame, with all bits of the position as one part."""
    parts: list[FramePart] = []
    for part in facts.frame_parts:
        is_of_position = part.role in ("multiturn", "singleturn")
        parts.append(replace(part, role="position") if is_of_position else part)
    return _merge_adjacent_parts(parts, ("position",))


def _with_two_parts_of_position(facts: EncoderFacts) -> Sequence[FramePart]:
    """Return the parts of the frame, with all multiturn bits as one part, and all singleturn bits as one part."""
    return _merge_adjacent_parts(facts.frame_parts, ("multiturn", "singleturn"))


def _merge_adjacent_parts(frame_parts: Sequence[FramePart], roles: Collection[str]) -> Sequence[FramePart]:
    """Return the parts of a frame, with adjacent parts of the same role merged if the role is in ``roles``.

    Two adjacent parts of 4 and 8 singleturn bits become one part of 12 bits with the name ``singleturn``. A part with
    one of these roles gets the name of its role even if there is nothing to merge.
    """
    merged_parts: list[FramePart] = []
    for part in frame_parts:
        if part.role not in roles:
            merged_parts.append(part)
        elif merged_parts and merged_parts[-1].role == part.role:
            previous_part = merged_parts.pop()
            merged_parts.append(replace(previous_part, bits=previous_part.bits + part.bits))
        else:
            merged_parts.append(replace(part, name=part.role))
    return merged_parts
