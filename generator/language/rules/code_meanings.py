"""Rules for the values of order codes: the names in them, and what labels and meanings say about their settings."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.expressions import Expression, ExpressionError, resolve_parameters
from ..document import Path
from ..keys_of_order_codes import WrittenCodePart, WrittenCodeValue
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted
from .frames import gray_of, layouts_with_position
from .parts import by_name, interfaces, is_explained_at, layouts_of_interfaces, measurements
from .references import NameResolver

#: Names of interfaces in manuals, without RS-485, which is also the name of the signals.
_PATTERN_BY_INTERFACE = {"ssi": re.compile(r"\bSSI\b"), "biss": re.compile(r"\bBiSS\b", re.IGNORECASE)}
_ANY_INTERFACE_NAME = re.compile(r"\bSSI\b|\bBiSS\b|\bRS-?485\b", re.IGNORECASE)

#: A length such as ``20/1024 mm`` or ``50 µm``, and a voltage such as ``5 V ± 5 %`` or ``5 to 30 V DC``.
_DECIMAL = r"[0-9]{1,3}(?:,[0-9]{3})+|[0-9]+(?:\.[0-9]+)?"
_LENGTH_IN_TEXT = re.compile(rf"(?<![\d.,/])(?:({_DECIMAL}) ?/ ?)?({_DECIMAL}) ?(mm|[µμ]m|nm)\b(?!/)")
_NANOMETRES_PER_UNIT = {
    **dict.fromkeys(("nm", "nanometres", "nanometers"), 1),
    **dict.fromkeys(("µm", "μm", "um", "micrometres", "micrometers"), 1000),
    **dict.fromkeys(("mm", "millimetres", "millimeters"), 1_000_000),
}
_MILLIVOLTS_PER_VOLT = 1000
_VOLT = r"\+?([0-9]+(?:\.[0-9]+)?) ?V(?: ?DC|dc)?"
_ONE_VOLTAGE = re.compile(rf"{_VOLT}(?: ?± ?([0-9]+(?:\.[0-9]+)?) ?%)?")
_TWO_VOLTAGES = re.compile(rf"{_VOLT} ?(?:to|-|–|…|\.\.\.|(?=\+)) ?{_VOLT}")
#: Way out of a contradiction between the meaning of an order code value and its settings.
MEANING_DIFFERS = "; if the manual prints it so, give the reason in 'meaning_differs'"


def check_order_code_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the parameters, interfaces, parts and labels named by order code values exist."""
    resolver = NameResolver(spec, report)
    part_by_name = by_name(spec.with_invalid_parts.order_code.parts)
    for part in spec.order_code.parts:
        open_only_with = _AllowedLabels(part.open_only_with, part.path_of("open_only_with"))
        _check_allowed_labels(open_only_with, part.name, part_by_name, resolver)
        for value in part.values.values():
            for parameter_name in value.sets:
                resolver.check_name((*value.path, "sets", parameter_name), "parameter", parameter_name)
            resolver.check_optional_name(value.path_of("interface"), "interface", value.interface)
            only_with = _AllowedLabels(value.only_with, value.path_of("only_with"))
            _check_allowed_labels(only_with, part.name, part_by_name, resolver)


class _AllowedLabels(NamedTuple):
    """The labels of other parts with which a value of the order code can be combined, such as ``{"output": ["S"]}``."""

    labels_by_part: Mapping[str, Sequence[str]]
    path: Path


def _check_allowed_labels(
    allowed_labels: _AllowedLabels,
    own_part: str,
    part_by_name: Mapping[str, WrittenCodePart],
    resolver: NameResolver,
) -> None:
    """Check that the other parts with which a value of the order code can be combined exist, and have these labels.

    A part cannot be combined with itself, so the name of the value's own part is reported.
    """
    other_parts = [name for name in part_by_name if name != own_part]
    for part_name, labels in allowed_labels.labels_by_part.items():
        labels_path = (*allowed_labels.path, part_name)
        resolver.check_name(labels_path, "other part", part_name, known_names=other_parts)
        if part_name in part_by_name:
            known_labels = part_by_name[part_name].names_in("values")
            resolver.check_each_name(labels_path, part_name, labels, known_names=known_labels)


def check_value_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the meaning of an order code value agrees with its settings: Gray or binary code, length and supply.

    A value with ``meaning_differs`` explains a difference.
    """
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            if not value.meaning_differs:
                _check_named_code(label, value, spec, report)
                _check_named_lengths(label, value, spec, report)
                _check_named_supply(label, value, report)


def _check_named_code(label: str, code_value: WrittenCodeValue, spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a value whose meaning names Gray or binary code sets the parameters that decide the code."""
    for name, required_number in _required_numbers_of_parameters(spec, code_value).items():
        if code_value.sets[name] != required_number:
            code = "Gray" if required_number else "binary"
            problem = f"the meaning of {quoted(label)} says {code}, so {quoted(name)} must be {required_number}"
            message = f"{problem}{MEANING_DIFFERS}"
            report.add("meaning-mismatch", (*code_value.path, "sets", name), message)


def _check_named_lengths(label: str, code_value: WrittenCodeValue, spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each length that a value sets is in its meaning, if this names any."""
    text_by_length = _lengths_in_text(code_value.meaning)
    if not text_by_length:
        return
    first_length_text, *_ = text_by_length.values()
    parameters = spec.with_invalid_parts.parameters
    for name, number in code_value.sets.items():
        unit = parameters[name].unit if name in parameters else ""
        if unit not in _NANOMETRES_PER_UNIT:
            continue
        length_in_nanometres = number * _NANOMETRES_PER_UNIT[unit]
        if length_in_nanometres not in text_by_length:
            problem = f"the meaning of {quoted(label)} says {first_length_text}, but {quoted(name)} is {number} {unit}"
            message = f"{problem}{MEANING_DIFFERS}"
            report.add("meaning-mismatch", (*code_value.path, "sets", name), message)


def _check_named_supply(label: str, code_value: WrittenCodeValue, report: DocumentReport) -> None:
    """Check that the supply of a value is the supply that its meaning names."""
    stated_range = supply_in_text(code_value.meaning)
    if stated_range is None or code_value.supply is None:
        return
    supply = code_value.supply.part
    if stated_range != (supply.min_mv, supply.max_mv):
        lowest_mv, highest_mv = stated_range
        problem = f"the meaning of {quoted(label)} says {lowest_mv} to {highest_mv} mV"
        message = f"{problem}, but here it is {supply.min_mv} to {supply.max_mv}{MEANING_DIFFERS}"
        report.add("meaning-mismatch", code_value.supply.path, message)


def _lengths_in_text(meaning: str) -> dict[Fraction, str]:
    """Return the lengths in a text, in nanometres, each with its text: ``{Fraction(50000): "50 µm"}``.

    A quotient such as ``20/1024 mm`` represents its result and also its dividend, 20 mm.
    """
    text_by_length = {}
    # ("20", "1024", "mm") for 20/1024 mm, and ("", "50", "µm") for 50 µm.
    for dividend_text, number_text, unit in _LENGTH_IN_TEXT.findall(meaning):
        number = Fraction(number_text.replace(",", ""))
        nanometres_per_unit = _NANOMETRES_PER_UNIT[unit]
        if dividend_text:
            quotient_text = f"{dividend_text}/{number_text} {unit}"
            dividend = Fraction(dividend_text.replace(",", "")) * nanometres_per_unit
            text_by_length[dividend] = quotient_text
            text_by_length[dividend / number] = quotient_text
        else:
            text_by_length[number * nanometres_per_unit] = f"{number_text} {unit}"
    return text_by_length


def _required_numbers_of_parameters(spec: WrittenSpec, code_value: WrittenCodeValue) -> dict[str, int]:
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


def supply_in_text(meaning: str) -> tuple[int, int] | None:
    """Return the supply range that a text consists of, in millivolts, or None if it does not.

    ``5 V ± 5 %`` is ``(4750, 5250)``, ``5 to 30 V DC`` is ``(5000, 30000)``.
    """
    two_voltages = _TWO_VOLTAGES.fullmatch(meaning)
    if two_voltages is not None:
        lowest_text, highest_text = two_voltages.groups()
        return int(Fraction(lowest_text) * _MILLIVOLTS_PER_VOLT), int(Fraction(highest_text) * _MILLIVOLTS_PER_VOLT)
    one_voltage = _ONE_VOLTAGE.fullmatch(meaning)
    if one_voltage is None:
        return None
    voltage_text, percentage_text = one_voltage.groups()
    nominal_mv = Fraction(voltage_text) * _MILLIVOLTS_PER_VOLT
    tolerance_mv = nominal_mv * Fraction(percentage_text or 0) / 100
    return int(nominal_mv - tolerance_mv), int(nominal_mv + tolerance_mv)


def check_named_interface(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an order code value selects the interface that its meaning names, if it names only one.

    RS-485 also names the signals, so it is not compared, but next to SSI or BiSS it makes the meaning unclear.
    """
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            # One spelling for each interface, so that a code in two spellings counts once.
            interface_words = _ANY_INTERFACE_NAME.findall(value.meaning)
            printed_interface_names = {word.upper().replace("RS485", "RS-485") for word in interface_words}
            if len(printed_interface_names) != 1 or value.interface is None:
                continue
            interfaces_in_meaning = [
                name for name, pattern in _PATTERN_BY_INTERFACE.items() if pattern.search(value.meaning)
            ]
            if interfaces_in_meaning and value.interface != interfaces_in_meaning[0]:
                printed_name = printed_interface_names.pop().replace("BISS", "BiSS")
                problem = (
                    f"the meaning of {quoted(label)} mentions {printed_name}, but the value selects {value.interface}"
                )
                report.add("interface-mismatch", value.path_of("interface"), problem)


def check_labels(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a label that is a number has the number of the expression in ``label_is`` of its part.

    Only labels whose value sets all parameters of the expression are checked.
    """
    for part in spec.order_code.parts:
        expression = _parse_formula(part.label_is)
        if expression is None:
            continue
        for label, value in part.values.items():
            sets_all_parameters = all(name in value.sets for name in expression.parameters)
            if not label.isdecimal() or not sets_all_parameters:
                continue
            expected_number = _evaluate_formula(expression, value.sets)
            if expected_number is not None and int(label) != expected_number:
                message = f"the label {quoted(label)} must be {expression.render()}, which is {expected_number} here"
                report.add("label-mismatch", value.path_of("sets"), message)


_ALIGNMENT_BY_SIDE = {"left": "msb_left", "right": "lsb_right"}
#: A bit and the side to which it is aligned, as in ``MSB left-aligned`` and ``LSB aligned to the right``.
_ALIGNMENT_IN_TEXT = re.compile(r"\b[ML]SB (?:(?=\w+[ -]aligned)|aligned to the )(left|right)\b", re.IGNORECASE)


def check_alignment(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``alignment`` of SSI is the alignment that the table of contents and the order code name.

    Nothing is checked if they name none or both.
    """
    ssi = spec.interfaces.ssi
    titles_and_meanings = [section.title for section in spec.manual.contents.values()]
    for part in spec.order_code.parts:
        titles_and_meanings += [value.meaning for value in part.values.values()]
    named_alignments: set[str] = set()
    for text in titles_and_meanings:
        for side in _ALIGNMENT_IN_TEXT.findall(text):
            named_alignments.add(_ALIGNMENT_BY_SIDE[side.casefold()])
    if ssi is None or not ssi.alignment or len(named_alignments) != 1:
        return
    if is_explained_at(report.document, "interfaces", "ssi", "alignment"):
        return
    named_alignment = named_alignments.pop()
    if ssi.alignment != named_alignment:
        message = (
            f"the table of contents or the order code says {quoted(named_alignment)}, but 'alignment' is"
            f" {quoted(ssi.alignment)}; correct one of the two. If both are right, add an erratum that affects"
            " interfaces.ssi.alignment"
        )
        report.add("alignment-mismatch", ssi.path_of("alignment"), message)


_GRAY_WORD = re.compile(r"\bGray\b", re.IGNORECASE)
#: Gray can also be a color, except in the meaning of an interface.
_GRAY_CODE = re.compile(r"\bGray[ -]code\b", re.IGNORECASE)
_BINARY_WORD = re.compile(r"\bbinary\b", re.IGNORECASE)


def check_named_gray_code(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an interface whose order codes name Gray code has a layout in Gray code.

    A value of an order code belongs to the interface that it selects, or to the only interface. If it selects none of
    several interfaces, it is not checked.
    """
    interface_names = [interface_name for interface_name, _ in interfaces(spec)]
    only_interface = interface_names[0] if len(interface_names) == 1 else ""
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            if not _names_gray(value):
                continue
            # No layout has an empty interface name, so the result then contains no layouts.
            interface_name = value.interface or only_interface
            position_layouts = layouts_with_position(spec, interface_name)
            has_gray = any(gray_of(frame) is not None for frame in position_layouts)
            if position_layouts and not has_gray:
                message = (
                    f"the meaning of {quoted(label)} says Gray, but no layout of {interface_name} has 'gray', "
                    "so decoders read it as binary"
                )
                report.add("output-code", value.path_of("meaning"), message)


def _names_gray(code_value: WrittenCodeValue) -> bool:
    """Return True if the meaning of an order code value names Gray code, and not binary code too.

    If the value selects no interface, "Gray" alone may be a color.
    """
    gray_pattern = _GRAY_WORD if code_value.interface else _GRAY_CODE
    says_gray = gray_pattern.search(code_value.meaning) is not None
    says_binary = _BINARY_WORD.search(code_value.meaning) is not None
    return says_gray and not says_binary


#: A number of counts or turns, such as ``4096 counts per turn``, and a range, such as ``12 to 16 bits``.
_COUNT_IN_TEXT = re.compile(r"(?<![\d.,])(\d[\d,]*) (counts per (?:turn|revolution)|revolutions|turns)\b")
_RANGE_OF_BITS_IN_TEXT = re.compile(r"(?<![\d.,])(\d+) to (\d+) bits\b")


def check_counts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the counts or revolutions in the meaning of an order code value follow from the value's settings.

    They are computed with the formulas of the measurement, if the value sets all parameters in them. With several
    measurements, the formula of the last one applies.
    """
    formula_by_unit = dict(_formulas_of_measurements(spec))
    formula_by_parameter = _formulas_of_parameters(spec)
    for part in spec.order_code.parts:
        for value in part.values.values():
            if not value.meaning_differs:
                number_by_parameter = resolve_parameters(value.sets, formula_by_parameter)
                _check_stated_counts(value, formula_by_unit, number_by_parameter, report)


def _check_stated_counts(
    code_value: WrittenCodeValue,
    formula_by_unit: Mapping[str, Expression],
    number_by_parameter: Mapping[str, int],
    report: DocumentReport,
) -> None:
    """Check each number of counts or revolutions in the meaning of an order code value against its formula."""
    for number_text, unit_text in _COUNT_IN_TEXT.findall(code_value.meaning):  # ("4,096", "counts per turn")
        unit = "counts" if unit_text.startswith("counts") else "turns"
        formula = formula_by_unit.get(unit)
        number = _evaluate_formula(formula, number_by_parameter) if formula is not None else None
        if number is None:
            continue
        possible_spellings = (str(number), f"{number:,}")  # Manuals print 4096 or 4,096.
        if number_text not in possible_spellings:
            message = (
                f"the meaning says {number_text} {unit_text}, but the value sets {number}; one of the two is"
                " wrong. If the manual prints it so, give the reason in 'meaning_differs'"
            )
            report.add("meaning-mismatch", code_value.path_of("meaning"), message)


def _formulas_of_measurements(spec: WrittenSpec) -> Iterator[tuple[str, Expression]]:
    """Yield the formulas of measurements: ``("counts", …)`` for the counts per turn, ``("turns", …)`` for the turns."""
    for measurement in measurements(spec):
        for unit, key in (("counts", "counts_per_turn"), ("turns", "turns")):
            formula = _parse_formula(measurement.data[key]) if measurement.has(key) else None
            if formula is not None:
                yield unit, formula


def _formulas_of_parameters(spec: WrittenSpec) -> dict[str, Expression]:
    """Return the formulas of the parameters that are calculated, by name."""
    formula_by_name = {name: _parse_formula(parameter.equals) for name, parameter in spec.parameters.items()}
    return {name: formula for name, formula in formula_by_name.items() if formula is not None}


def _parse_formula(formula_text: object) -> Expression | None:
    """Return a number or formula as an expression. None if it is missing or invalid, which another rule reports."""
    if not isinstance(formula_text, (int, str)) or formula_text == "":
        return None
    try:
        return Expression.parse(formula_text)
    except ExpressionError:
        return None


def _evaluate_formula(formula: Expression, number_by_parameter: Mapping[str, int]) -> int | None:
    """Return the number of a formula, or None if a parameter is missing or the number is out of range."""
    has_all_parameters = number_by_parameter.keys() >= set(formula.parameters)
    if not has_all_parameters:
        return None
    try:
        return formula.value(number_by_parameter)
    except ExpressionError:  # The exponent is out of range. Another rule reports it.
        return None


def check_widths(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a range such as ``12 to 16 bits`` in the meaning of a parameter is the range that order codes set.

    Order codes set the parameter, or the parameters from which it is calculated. The range is calculated with all of
    these at their lowest, and with all at their highest.
    """
    range_by_parameter = _ranges_set_by_codes(spec)
    formula_by_parameter = _formulas_of_parameters(spec)
    lowest_set_numbers = {name: lowest for name, (lowest, _) in range_by_parameter.items()}
    highest_set_numbers = {name: highest for name, (_, highest) in range_by_parameter.items()}
    lowest_by_parameter = resolve_parameters(lowest_set_numbers, formula_by_parameter)
    highest_by_parameter = resolve_parameters(highest_set_numbers, formula_by_parameter)
    for name, parameter in spec.parameters.items():
        if parameter.unit != "bits" or name not in lowest_by_parameter or name not in highest_by_parameter:
            continue
        stated_ranges = _RANGE_OF_BITS_IN_TEXT.findall(parameter.meaning)
        if len(stated_ranges) != 1:
            continue
        stated_lowest, stated_highest = map(int, stated_ranges[0])
        lowest, highest = lowest_by_parameter[name], highest_by_parameter[name]
        if (stated_lowest, stated_highest) != (lowest, highest):
            message = (
                f"the meaning says {stated_lowest} to {stated_highest} bits, but the order codes set {lowest} to"
                f" {highest}; one of the two is wrong"
            )
            report.add("printed-number", parameter.path_of("meaning"), message)


def _ranges_set_by_codes(spec: WrittenSpec) -> dict[str, tuple[int, int]]:
    """Return the lowest and the highest number to which order codes set each parameter: ``{"bits": (12, 16)}``.

    The result is empty if some values of the order code can be combined only with certain others (``only_with``).
    """
    numbers_by_parameter: dict[str, list[int]] = {}
    for part in spec.order_code.parts:
        for value in part.values.values():
            if value.only_with:
                return {}
            for name, number in value.sets.items():
                numbers_by_parameter.setdefault(name, []).append(number)
    return {name: (min(set_numbers), max(set_numbers)) for name, set_numbers in numbers_by_parameter.items()}
