"""Rules for numbers in texts that follow from data or other numbers: characters, counts, figures, other units."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from ...model import Quantity
from ...model.expressions import Expression, ExpressionError, resolve_parameters
from ..document import Path
from ..problems import DocumentReport, quoted
from ..schema_files import PROSE
from ..written_parts import WrittenSpec
from .parts import field_lists, measurements
from .quantities import bounds_of
from .walk import leaves_of

#: Bytes, as in ``41 42 in hexadecimal``.
_BYTES_IN_HEXADECIMAL = re.compile(r"\b((?:[0-9A-F]{2} )*[0-9A-F]{2}) in hexadecimal")
#: The number in ``always 1``, but not in ``always 1.5``.
_ALWAYS_A_NUMBER = re.compile(r"\balways (\d+)\b(?!\.\d)")
_NUMBER = r"\d{1,3}(?:,\d{3})+|\d+"
_COUNT_IN_TEXT = re.compile(r"(?<![\d.,])(\d[\d,]*) (counts per (?:turn|revolution)|revolutions|turns)\b")
_BITS_RANGE = re.compile(r"(?<![\d.,])(\d+) to (\d+) bits\b")
#: A number in two bases: ``16 is 10h``, with the decimal number first, and ``0x10 = 16``, with the hexadecimal one.
_DECIMAL_FIRST = re.compile(rf"(?<![\w.,+])({_NUMBER}) (?:is|=) (0x[0-9A-Fa-f]+|[0-9A-F]+h)\b")
_HEXADECIMAL_FIRST = re.compile(rf"\b(0x[0-9A-Fa-f]+|[0-9][0-9A-F]*h) (?:is|=) ({_NUMBER})(?![\w.,]*\d| bits?\b)")
_SECTION_OF_BITS = re.compile(r"\bbits (\d+):(\d+), which are (\d+) bits")
_RS_STANDARD = re.compile(r"\bRS[- ]?(\d{2,4})\b")
_KNOWN_RS_STANDARDS = ("232", "422", "423", "449", "485", "530", "562", "644")
#: The numbers in ``Figures 2 to 4 and 7``.
_FIGURE_NUMBERS = re.compile(r"\bFigures? (\d+(?:(?:, | and | to )\d+)*)\b")
#: A longer range of figures is compared only by its first and its last number.
_MOST_FIGURES = 1000
#: Texts that quote the manual, or are about other documents.
_KEYS_ABOUT_OTHER_DOCUMENTS = frozenset(("documents", "editions", "evidence"))
_KEYS_THAT_QUOTE = frozenset(("printed", "title", "why"))
#: A quantity in two units in a text, as in ``10 °C is 50 °F``.
_QUANTITY_IN_TWO_UNITS = re.compile(
    r"(?<![\w.,±])([−+-]?\d+(?:\.\d+)?) ?(°[CF]|mm|in)(?:,? which)? (?:is|=) "
    r"([−+-]?\d+(?:\.\d+)?) ?(°[CF]|mm|in)\b"
)
_UNIT_CONVERSIONS: Mapping[tuple[str, str], Callable[[float], float]] = {
    ("°C", "°F"): lambda number: number * 1.8 + 32,
    ("°F", "°C"): lambda number: (number - 32) / 1.8,
    ("mm", "in"): lambda number: number / 25.4,
    ("in", "mm"): lambda number: number * 25.4,
}


def check_characters(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bytes in the meaning of a text field are the characters that the field always contains."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            match = _BYTES_IN_HEXADECIMAL.search(field.meaning)
            fixed_text = field.equals if field.text else None
            if match is None or not isinstance(fixed_text, str) or not fixed_text.isascii():
                continue
            stated_bytes = match[1]
            expected_bytes = fixed_text.encode("ascii").hex(" ").upper()  # 4C 41 for LA.
            if stated_bytes != expected_bytes:
                message = (
                    f"the meaning says {stated_bytes}, but 'equals' is {quoted(fixed_text)}, which is"
                    f" {expected_bytes} in hexadecimal; one of the two is wrong"
                )
                report.add("printed-number", field.place_of("equals"), message)


def check_constant_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that fixed bits have the number that their meaning gives after the word "always"."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            stated_numbers = _ALWAYS_A_NUMBER.findall(field.meaning)
            if len(stated_numbers) != 1:
                continue
            stated_number = int(stated_numbers[0])
            for key, number in (("constant", field.constant), ("unused", field.unused)):
                if number is not None and number != stated_number:
                    problem = f"the meaning says always {stated_numbers[0]}, but {quoted(key)} is {number}"
                    report.add("printed-number", field.place_of(key), f"{problem}; one of the two is wrong")


def check_counts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the counts or revolutions in the meaning of an order code value follow from the value's settings.

    They are computed with the formulas of the measurement, if the value sets all parameters in them. With several
    measurements, the formula of the last one applies.
    """
    formulas = dict(_yield_formulas(spec))
    definitions = _collect_definitions(spec)
    for part in spec.order_code.parts:
        for value in part.values.values():
            if value.meaning_differs:
                continue
            parameters = resolve_parameters(value.sets, definitions)
            for number_text, unit_text in _COUNT_IN_TEXT.findall(value.meaning):
                formula = formulas.get("counts" if unit_text.startswith("counts") else "turns")
                number = _evaluate_formula(formula, parameters) if formula is not None else None
                if number is None:
                    continue
                possible_spellings = (str(number), f"{number:,}")  # Manuals print 4096 or 4,096.
                if number_text not in possible_spellings:
                    message = (
                        f"the meaning says {number_text} {unit_text}, but the value sets {number}; one of the two is"
                        " wrong. If the manual prints it so, give the reason in 'meaning_differs'"
                    )
                    report.add("meaning-mismatch", value.place_of("meaning"), message)


def _yield_formulas(spec: WrittenSpec) -> Iterator[tuple[str, Expression]]:
    """Yield the formulas of measurements: ``("counts", …)`` for the counts per turn, ``("turns", …)`` for the turns."""
    for measurement in measurements(spec):
        for unit, key in (("counts", "counts_per_turn"), ("turns", "turns")):
            formula = _parse_formula(measurement.data[key]) if measurement.has(key) else None
            if formula is not None:
                yield unit, formula


def _collect_definitions(spec: WrittenSpec) -> dict[str, Expression]:
    """Return the formulas of the parameters that are calculated, by name."""
    formulas = {name: _parse_formula(parameter.equals) for name, parameter in spec.parameters.items()}
    return {name: formula for name, formula in formulas.items() if formula is not None}


def _parse_formula(formula_text: object) -> Expression | None:
    """Return a number or formula as an expression. None if it is missing or invalid, which another rule reports."""
    if not isinstance(formula_text, (int, str)) or formula_text == "":
        return None
    try:
        return Expression.parse(formula_text)
    except ExpressionError:
        return None


def _evaluate_formula(formula: Expression, parameters: Mapping[str, int]) -> int | None:
    """Return the number of a formula, or None if a parameter is missing or the number is out of range."""
    has_all_parameters = parameters.keys() >= set(formula.parameters)
    if not has_all_parameters:
        return None
    try:
        return formula.value(parameters)
    except ExpressionError:  # The exponent is out of range. Another rule reports it.
        return None


def check_widths(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a range such as ``12 to 16 bits`` in the meaning of a parameter is the range that order codes set.

    Order codes set the parameter, or the parameters from which it is calculated. The range is calculated with all of
    these at their lowest, and with all at their highest.
    """
    ranges = _ranges_set_by_codes(spec)
    definitions = _collect_definitions(spec)
    lowest_numbers = {name: lowest for name, (lowest, _) in ranges.items()}
    highest_numbers = {name: highest for name, (_, highest) in ranges.items()}
    lowest_parameters = resolve_parameters(lowest_numbers, definitions)
    highest_parameters = resolve_parameters(highest_numbers, definitions)
    for name, parameter in spec.parameters.items():
        if parameter.unit != "bits" or name not in lowest_parameters or name not in highest_parameters:
            continue
        stated_ranges = _BITS_RANGE.findall(parameter.meaning)
        if len(stated_ranges) != 1:
            continue
        stated_lowest, stated_highest = map(int, stated_ranges[0])
        lowest, highest = lowest_parameters[name], highest_parameters[name]
        if (stated_lowest, stated_highest) != (lowest, highest):
            message = (
                f"the meaning says {stated_lowest} to {stated_highest} bits, but the order codes set {lowest} to"
                f" {highest}; one of the two is wrong"
            )
            report.add("printed-number", parameter.place_of("meaning"), message)


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


def check_equal_numbers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts that give a number in decimal and in hexadecimal, as in ``16 is 10h``, give the same number.

    Also check that texts such as ``bits 7:4, which are 4 bits`` give the correct number of bits.
    """
    for path, text in _texts_in_our_words(spec, report):
        number_pairs = _DECIMAL_FIRST.findall(text)
        number_pairs += [(decimal, hexadecimal) for hexadecimal, decimal in _HEXADECIMAL_FIRST.findall(text)]
        for decimal, hexadecimal in number_pairs:
            number = int(hexadecimal.removesuffix("h"), 16)
            if int(decimal.replace(",", "")) != number:
                message = f"{hexadecimal} is {number}, not {decimal}; correct one of the two"
                report.add("printed-number", path, message)
        for highest_bit, lowest_bit, stated_width in _SECTION_OF_BITS.findall(text):
            width = int(highest_bit) - int(lowest_bit) + 1
            if width != int(stated_width):
                message = f"bits {highest_bit}:{lowest_bit} are {width} bits, not {stated_width}; correct one of them"
                report.add("printed-number", path, message)


def _texts_in_our_words(spec: WrittenSpec, report: DocumentReport) -> Iterator[tuple[Path, str]]:
    """Yield the texts of a spec that neither quote the manual nor describe other documents, with their paths."""
    for path, text in leaves_of(spec.data, report):
        section, key = path[0], path[-1]
        is_prose = key in PROSE or (section, key) == ("characteristics", "value")
        is_quotation = key in _KEYS_THAT_QUOTE
        is_about_other_document = section in _KEYS_ABOUT_OTHER_DOCUMENTS
        is_in_our_words = is_prose and not is_quotation and not is_about_other_document
        if isinstance(text, str) and is_in_our_words:
            yield path, text


def check_standards(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each standard with the prefix RS in a text exists, such as RS-485.

    The text of the manual that an erratum corrects may name any standard.
    """
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed" or path[0] in _KEYS_ABOUT_OTHER_DOCUMENTS:
            continue
        unknown_numbers = [number for number in _RS_STANDARD.findall(text) if number not in _KNOWN_RS_STANDARDS]
        if unknown_numbers:
            number = unknown_numbers[0]
            problem = f"RS-{number} is not a known standard; expected one such as RS-422 or RS-485"
            message = f"{problem}; correct the number, or write TIA-{number}"
            report.add("unknown-standard", path, message)


def check_figures(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a figure that a text names is listed under ``lost_figures``, the figures that were not available.

    Nothing is checked if the list contains no numbers of figures.
    """
    lost_numbers: set[int] = set()
    for figure in spec.lost_figures:
        lost_numbers.update(_figure_numbers(figure.part.content))
    for path, text in _texts_in_our_words(spec, report):
        if not lost_numbers or path[0] == "lost_figures":
            continue
        unlisted_numbers = [number for number in _figure_numbers(text) if number not in lost_numbers]
        if unlisted_numbers:
            message = f"'lost_figures' has no Figure {unlisted_numbers[0]}; correct the number, or add the figure"
            report.add("figure-number", path, message)


def _figure_numbers(figure_text: str) -> Iterator[int]:
    """Yield the numbers of the figures that a text names: 2, 3, 4 and 7 for ``Figures 2 to 4 and 7``."""
    for listed_numbers in _FIGURE_NUMBERS.findall(figure_text):
        for number_or_range in re.split(", | and ", listed_numbers):
            first_text, _, last_text = number_or_range.partition(" to ")
            first_number = int(first_text)
            last_number = int(last_text) if last_text else first_number
            if last_number - first_number < _MOST_FIGURES:
                yield from range(first_number, last_number + 1)
            else:
                yield from (first_number, last_number)


def check_conversions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a quantity that a characteristic or a text gives in two units is the same in both."""
    for characteristic in spec.characteristics:
        indices_by_quantity: dict[tuple[str, str], list[int]] = {}
        for index, quantity in enumerate(characteristic.part.values):
            indices_by_quantity.setdefault((quantity.quantity, quantity.where), []).append(index)
        for indices in indices_by_quantity.values():
            # If there are more than two, it is not known which of them belong together.
            if len(indices) == 2:
                first_index, second_index = indices
                quantity = characteristic.part.values[second_index]
                first_quantity = characteristic.part.values[first_index]
                _compare_bounds(quantity, first_quantity, (*characteristic.path, "values", second_index), report)
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed":
            continue
        for match in _QUANTITY_IN_TWO_UNITS.finditer(text):
            number_text, unit, other_number_text, other_unit = match.groups()
            printed = _PrintedNumber(Decimal(number_text.replace("−", "-")), unit)
            other = _PrintedNumber(Decimal(other_number_text.replace("−", "-")), other_unit)
            _compare_numbers(printed, other, path, report)


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
    first_bounds = bounds_of(first_quantity)
    for key, bound in bounds_of(quantity).items():
        if key in first_bounds:
            printed = _PrintedNumber(bound, quantity.unit)
            first_printed = _PrintedNumber(first_bounds[key], first_quantity.unit)
            _compare_numbers(printed, first_printed, (*path, key), report)


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
