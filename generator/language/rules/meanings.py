"""Rules for text that repeats nearby data: if the two differ, one of them is a mistake."""

from __future__ import annotations

import re
from fractions import Fraction

from ..problems import DocumentReport, quoted
from .values import constant_width
from .walk import Spec, field_lists, items, layouts, mapping

#: Names of interfaces in manuals, without RS-485, which is also the name of the signals.
_INTERFACES = {"ssi": re.compile(r"\bSSI\b"), "biss": re.compile(r"\bBiSS\b", re.IGNORECASE)}
_ANY_INTERFACE = re.compile(r"\bSSI\b|\bBiSS\b|\bRS-?485\b", re.IGNORECASE)

#: Numbers: binary in quotes, hexadecimal as in 0x1F or 0Ah, binary as in 0b01. Plain digits may be a name.
_IN_QUOTES = re.compile(r"\"([01]+)\"|'([01]+)'|“([01]+)”")
_WITH_PREFIX = re.compile(r"0[xX][0-9A-Fa-f]+|0b[01]+")
_WITH_SUFFIX = re.compile(r"((?:0[0-9A-F]*|[0-9A-F]*[A-F][0-9A-F]*))h")


#: A length, perhaps as a quotient, and a voltage: one with its tolerance, or two.
_DECIMAL = r"[0-9]{1,3}(?:,[0-9]{3})+|[0-9]+(?:\.[0-9]+)?"
_LENGTH = re.compile(rf"(?<![\d.,/])(?:({_DECIMAL}) ?/ ?)?({_DECIMAL}) ?(mm|[µμ]m|nm)\b(?!/)")
_NANOMETRES = {
    **dict.fromkeys(("nm", "nanometres", "nanometers"), 1),
    **dict.fromkeys(("µm", "μm", "um", "micrometres", "micrometers"), 1000),
    **dict.fromkeys(("mm", "millimetres", "millimeters"), 1_000_000),
}
_VOLT = r"\+?([0-9]+(?:\.[0-9]+)?) ?V(?: ?DC|dc)?"
_ONE_VOLTAGE = re.compile(rf"{_VOLT}(?: ?± ?([0-9]+(?:\.[0-9]+)?) ?%)?")
_TWO_VOLTAGES = re.compile(rf"{_VOLT} ?(?:to|-|–|…|\.\.\.|(?=\+)) ?{_VOLT}")


def value_words(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the meaning of an order code value agrees with its settings: code, length and supply."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            meaning, value_path, sets = value.get("meaning", ""), (*path, "values", text), mapping(value, "sets")
            for name, expected in _codes_named(spec, value).items():
                if value["sets"][name] != expected:
                    word = "Gray" if expected else "binary"
                    problem = f"the meaning of {quoted(text)} says {word}, so {quoted(name)} must be {expected}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), problem)
            lengths = _lengths_named(meaning)
            for name, number in sets.items():
                unit = str(mapping(raw, "parameters", name).get("unit"))
                if lengths and unit in _NANOMETRES and number * _NANOMETRES[unit] not in lengths:
                    says = next(iter(lengths.values()))
                    problem = f"the meaning of {quoted(text)} says {says}, but {quoted(name)} is {number} {unit}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), problem)
            stated_range, supply = supply_named(meaning), mapping(value, "supply")
            if stated_range and supply and stated_range != (supply["min_mv"], supply["max_mv"]):
                problem = f"the meaning of {quoted(text)} says {stated_range[0]} to {stated_range[1]} mV"
                report.add(
                    "meaning-mismatch",
                    (*value_path, "supply"),
                    f"{problem}, but here it is {supply['min_mv']} to {supply['max_mv']}",
                )


def _lengths_named(meaning: str) -> dict[Fraction, str]:
    """Return the lengths in a meaning in nanometres, each with its text. A quotient also stands for its dividend."""
    lengths = {}
    for dividend, number, unit in _LENGTH.findall(meaning):
        length = Fraction(number.replace(",", "")) * _NANOMETRES[unit]
        text = f"{number} {unit}"
        if dividend:
            whole = Fraction(dividend.replace(",", "")) * _NANOMETRES[unit]
            length, text = whole / Fraction(number.replace(",", "")), f"{dividend}/{number} {unit}"
            lengths[whole] = text
        lengths[length] = text
    return lengths


def _codes_named(spec: Spec, value: Spec) -> dict[str, int]:
    """Return the parameters that must be set by a value whose meaning names one code, with the required numbers."""
    words = [word for word in ("Gray", "binary") if re.search(rf"\b{word}\b", value.get("meaning", ""), re.IGNORECASE)]
    if len(words) != 1:
        return {}
    interface = value.get("interface")
    own_layouts = (fields for fields in layouts(spec) if interface in (None, fields.interface))
    used = {mapping(fields.owner, "gray").get("when") for fields in own_layouts}
    return {name: int(words[0] == "Gray") for name in mapping(value, "sets") if name in used}


def supply_named(text: str) -> tuple[int, int] | None:
    """Return the supply range given by a text, in millivolts, or None."""
    if (range_match := _TWO_VOLTAGES.fullmatch(text)) is not None:
        return _millivolts(range_match[1], 100), _millivolts(range_match[2], 100)
    match = _ONE_VOLTAGE.fullmatch(text)
    if match is None:
        return None
    tolerance = Fraction(match[2] or 0)
    return _millivolts(match[1], 100 - tolerance), _millivolts(match[1], 100 + tolerance)


def _millivolts(volts: str, per_cent: Fraction | int) -> int:
    return int(Fraction(volts) * per_cent * 10)


def printed_number(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a value whose printed name is a number has that number."""
    for fields in field_lists(spec):
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                number = _number(value.get("printed_name", ""), constant_width(field))
                if number is not None and number != value["value"]:
                    problem = (
                        f"{quoted(name)} is printed as {value['printed_name']}, which is {number}, but 'value' is"
                        f" {value['value']}"
                    )
                    report.add("printed-number", (*path, "values", name, "value"), problem)


def _number(text: str, width: int | None) -> int | None:
    """Return the number in a printed name if it is clearly only a number, otherwise None."""
    if (match := _IN_QUOTES.fullmatch(text)) is not None:
        digits = next(group for group in match.groups() if group)
        return int(digits, 2) if len(digits) == width else None
    if _WITH_PREFIX.fullmatch(text):
        return int(text, 0)
    suffixed = _WITH_SUFFIX.fullmatch(text)
    return int(suffixed[1], 16) if suffixed is not None else None


def interface_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an order code value does not select a different interface than its meaning names."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            words = _ANY_INTERFACE.findall(value.get("meaning", ""))
            names = {word.upper().replace("RS485", "RS-485") for word in words}
            for kind, pattern in _INTERFACES.items():
                if len(names) == 1 and pattern.search(value["meaning"]) and value.get("interface", kind) != kind:
                    problem = (
                        f"the meaning of {quoted(text)} mentions {names.pop().replace('BISS', 'BiSS')}, but the"
                        f" value selects {value['interface']}"
                    )
                    report.add("interface-mismatch", (*path, "values", text, "interface"), problem)
                    break
