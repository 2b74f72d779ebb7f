"""Rules for the values of order codes: the names in them, their settings in words, and labels that are numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction

from ...model.expressions import Expression, ExpressionError
from ..document import Path
from ..problems import DocumentReport, quoted
from ..written_codes import WrittenCodePart, WrittenCodeValue
from ..written_parts import WrittenSpec
from .name_resolver import NameResolver
from .parts import by_name, layouts_of_interfaces

#: Names of interfaces in manuals, without RS-485, which is also the name of the signals.
_INTERFACE_NAMES = {"ssi": re.compile(r"\bSSI\b"), "biss": re.compile(r"\bBiSS\b", re.IGNORECASE)}
_ANY_INTERFACE = re.compile(r"\bSSI\b|\bBiSS\b|\bRS-?485\b", re.IGNORECASE)

#: A length, perhaps as a quotient, and a voltage: one with its tolerance, or two.
_DECIMAL = r"[0-9]{1,3}(?:,[0-9]{3})+|[0-9]+(?:\.[0-9]+)?"
_LENGTH_IN_TEXT = re.compile(rf"(?<![\d.,/])(?:({_DECIMAL}) ?/ ?)?({_DECIMAL}) ?(mm|[µμ]m|nm)\b(?!/)")
_NANOMETRES_PER_UNIT = {
    **dict.fromkeys(("nm", "nanometres", "nanometers"), 1),
    **dict.fromkeys(("µm", "μm", "um", "micrometres", "micrometers"), 1000),
    **dict.fromkeys(("mm", "millimetres", "millimeters"), 1_000_000),
}
_VOLT = r"\+?([0-9]+(?:\.[0-9]+)?) ?V(?: ?DC|dc)?"
_ONE_VOLTAGE = re.compile(rf"{_VOLT}(?: ?± ?([0-9]+(?:\.[0-9]+)?) ?%)?")
_TWO_VOLTAGES = re.compile(rf"{_VOLT} ?(?:to|-|–|…|\.\.\.|(?=\+)) ?{_VOLT}")
#: Way out of a contradiction between the meaning of an order code value and its settings.
MEANING_DIFFERS = "; if the manual prints it so, give the reason in 'meaning_differs'"


def check_order_code_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the parameters, interfaces, parts and labels named by order code values exist."""
    resolver = NameResolver(spec, report)
    parts = by_name(spec.with_invalid_parts.order_code.parts)
    for part in spec.order_code.parts:
        # A part cannot be combined with itself.
        other_parts = [name for name in parts if name != part.name]
        _check_combinations(resolver, part.place_of("open_only_with"), part.open_only_with, parts, other_parts)
        for value in part.values.values():
            for name in value.sets:
                resolver.check_name((*value.path, "sets", name), "parameter", name)
            resolver.check_optional_name(value.place_of("interface"), "interface", value.interface)
            _check_combinations(resolver, value.place_of("only_with"), value.only_with, parts, other_parts)


def _check_combinations(
    resolver: NameResolver,
    path: Path,
    labels_by_part: Mapping[str, Sequence[str]],
    parts_by_name: Mapping[str, WrittenCodePart],
    other_parts: Sequence[str],
) -> None:
    """Check that the other parts with which a value of the order code can be combined exist, and have these labels.

    ``labels_by_part`` is the map at ``path``, such as ``{"output": ["S", "B"]}`` under ``only_with``.
    """
    for part_name, labels in labels_by_part.items():
        labels_path = (*path, part_name)
        resolver.check_name(labels_path, "other part", part_name, known_names=other_parts)
        if part_name in parts_by_name:
            known_labels = parts_by_name[part_name].names_in("values")
            resolver.check_each_name(labels_path, part_name, labels, known_names=known_labels)


def check_value_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the meaning of an order code value agrees with its settings: Gray or binary code, length and supply.

    A value with ``meaning_differs`` explains a difference.
    """
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            if not value.meaning_differs:
                says = f"the meaning of {quoted(label)} says"
                _check_code(value, says, spec, report)
                _check_lengths(value, says, spec, report)
                _check_supply(value, says, report)


def _check_code(code_value: WrittenCodeValue, says: str, spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a value whose meaning names Gray or binary code sets the parameters that decide the code.

    ``says`` is the beginning of the message, also in the next two functions.
    """
    for name, required_number in _codes_named(spec, code_value).items():
        if code_value.sets[name] != required_number:
            code = "Gray" if required_number else "binary"
            message = f"{says} {code}, so {quoted(name)} must be {required_number}{MEANING_DIFFERS}"
            report.add("meaning-mismatch", (*code_value.path, "sets", name), message)


def _check_lengths(code_value: WrittenCodeValue, says: str, spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each length that a value sets is in its meaning, if this names any."""
    lengths = _lengths_named(code_value.meaning)
    if not lengths:
        return
    parameters = spec.with_invalid_parts.parameters
    for name, number in code_value.sets.items():
        unit = parameters[name].unit if name in parameters else ""
        if unit in _NANOMETRES_PER_UNIT and number * _NANOMETRES_PER_UNIT[unit] not in lengths:
            first_length, *_ = lengths.values()
            message = f"{says} {first_length}, but {quoted(name)} is {number} {unit}{MEANING_DIFFERS}"
            report.add("meaning-mismatch", (*code_value.path, "sets", name), message)


def _check_supply(code_value: WrittenCodeValue, says: str, report: DocumentReport) -> None:
    """Check that the supply of a value is the supply that its meaning names."""
    stated_range = supply_named(code_value.meaning)
    if stated_range is None or code_value.supply is None:
        return
    supply = code_value.supply.part
    if stated_range != (supply.min_mv, supply.max_mv):
        low_mv, high_mv = stated_range
        actual_range = f"{supply.min_mv} to {supply.max_mv}"
        message = f"{says} {low_mv} to {high_mv} mV, but here it is {actual_range}{MEANING_DIFFERS}"
        report.add("meaning-mismatch", code_value.supply.path, message)


def _lengths_named(meaning: str) -> dict[Fraction, str]:
    """Return the lengths in a meaning in nanometres, each with its text.

    A quotient such as ``20/1024 mm`` represents its result and also its dividend, 20 mm.
    """
    lengths = {}
    for dividend, number, unit in _LENGTH_IN_TEXT.findall(meaning):
        plain_number = Fraction(number.replace(",", ""))
        nanometres = _NANOMETRES_PER_UNIT[unit]
        if dividend:
            text = f"{dividend}/{number} {unit}"
            whole_length = Fraction(dividend.replace(",", "")) * nanometres
            lengths[whole_length] = text
            lengths[whole_length / plain_number] = text
        else:
            lengths[plain_number * nanometres] = f"{number} {unit}"
    return lengths


def _codes_named(spec: WrittenSpec, code_value: WrittenCodeValue) -> dict[str, int]:
    """Return the parameters that a value sets and that decide the code, with the number for the code in its meaning.

    A parameter that decides the code of a layout is 1 for Gray code and 0 for binary code. The result is empty if the
    meaning names neither code or both.
    """
    says_gray = re.search(r"\bGray\b", code_value.meaning, re.IGNORECASE) is not None
    says_binary = re.search(r"\bbinary\b", code_value.meaning, re.IGNORECASE) is not None
    if says_gray == says_binary:
        return {}
    deciding_parameters = set()
    for frame in layouts_of_interfaces(spec):
        # A value that selects no interface applies to all of them.
        is_of_value = code_value.interface is None or frame.interface == code_value.interface
        if is_of_value and frame.layout is not None and frame.layout.gray is not None:
            deciding_parameters.add(frame.layout.gray.when)
    required_number = 1 if says_gray else 0
    return {name: required_number for name in code_value.sets if name in deciding_parameters}


def supply_named(meaning: str) -> tuple[int, int] | None:
    """Return the supply range that a text consists of, in millivolts, or None if it does not.

    ``5 V ± 5 %`` is ``(4750, 5250)``, ``5 to 30 V DC`` is ``(5000, 30000)``.
    """
    two_voltages = _TWO_VOLTAGES.fullmatch(meaning)
    if two_voltages is not None:
        low, high = two_voltages.groups()
        return _to_millivolts(low, 100), _to_millivolts(high, 100)  # 100 % of each, as there is no tolerance.
    one_voltage = _ONE_VOLTAGE.fullmatch(meaning)
    if one_voltage is None:
        return None
    volts, tolerance_text = one_voltage.groups()
    tolerance = Fraction(tolerance_text or 0)
    return _to_millivolts(volts, 100 - tolerance), _to_millivolts(volts, 100 + tolerance)


def _to_millivolts(volts: str, per_cent: Fraction | int) -> int:
    """Return a percentage of a voltage in millivolts."""
    return int(Fraction(volts) * per_cent * 10)  # 1000 mV per V, and 1 / 100 for the percentage.


def check_named_interface(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an order code value selects the interface that its meaning names, if it names only one.

    RS-485 also names the signals, so it is not compared, but next to SSI or BiSS it makes the meaning unclear.
    """
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            # One spelling for each interface, so that a code in two spellings counts once.
            interface_words = _ANY_INTERFACE.findall(value.meaning)
            interface_names = {word.upper().replace("RS485", "RS-485") for word in interface_words}
            if len(interface_names) != 1 or value.interface is None:
                continue
            named_kinds = [kind for kind, pattern in _INTERFACE_NAMES.items() if pattern.search(value.meaning)]
            if named_kinds and value.interface != named_kinds[0]:
                name = interface_names.pop().replace("BISS", "BiSS")
                problem = f"the meaning of {quoted(label)} mentions {name}, but the value selects {value.interface}"
                report.add("interface-mismatch", value.place_of("interface"), problem)


def check_labels(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a label that is a number has the number of the expression in ``label_is`` of its part.

    Only labels whose value sets all parameters of the expression are checked.
    """
    for part in spec.order_code.parts:
        expression = _parse_expression(part.label_is)
        if expression is None:
            continue
        for label, value in part.values.items():
            sets_all_parameters = all(name in value.sets for name in expression.parameters)
            if not label.isdecimal() or not sets_all_parameters:
                continue
            number = _evaluate_expression(expression, value.sets)
            if number is not None and int(label) != number:
                message = f"the label {quoted(label)} must be {expression.render()}, which is {number} here"
                report.add("label-mismatch", value.place_of("sets"), message)


def _parse_expression(formula: int | str | None) -> Expression | None:
    """Return a formula as an expression, or None if there is none or it is not valid."""
    try:
        return None if formula is None else Expression.parse(formula)
    except ExpressionError:  # Reported by the rule on expressions.
        return None


def _evaluate_expression(expression: Expression, parameters: Mapping[str, int]) -> int | None:
    """Return the value of an expression, or None if an exponent is out of range."""
    try:
        return expression.value(parameters)
    except ExpressionError:  # The exponent is out of range. Another rule reports it.
        return None
