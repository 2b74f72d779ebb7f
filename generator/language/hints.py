"""Hints for numbers written as in manuals, or keys with another unit: 48h, 10 MHz, x^6 + x + 1, min_khz."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from .problems import meant

#: Base unit and power of ten of each unit.
_UNITS = {
    "hz": ("hz", 0), "khz": ("hz", 3), "mhz": ("hz", 6), "ghz": ("hz", 9),
    "ps": ("s", -12), "ns": ("s", -9), "us": ("s", -6), "µs": ("s", -6), "ms": ("s", -3), "s": ("s", 0),
    "nm": ("m", -9), "um": ("m", -6), "µm": ("m", -6), "mm": ("m", -3), "cm": ("m", -2), "m": ("m", 0),
    "mv": ("v", -3), "v": ("v", 0),
}  # fmt: skip
#: Alternatives if a value does not fit the only supported unit.
_INSTEAD = {
    "step_um": ": leave 'measurement' out and describe the step as a characteristic; positions are then in counts",
}
_WORDS = {"hz": "Hz", "khz": "kHz", "mhz": "MHz", "ghz": "GHz", "us": "µs", "um": "µm", "mv": "mV", "v": "V"}

_HEX = re.compile(r"(?P<negative>-?)(?:(?P<suffixed>[0-9A-Fa-f]+)[hH]|(?:0X|\$|#|&[hH])(?P<prefixed>[0-9A-Fa-f]+))")
_BINARY = re.compile(r"(?:0[bB])([01]+)")
_GROUPED = re.compile(r"-?[0-9]{1,3}(?:([_' ,])[0-9]{3})(?:\1[0-9]{3})*")
_PLAIN = re.compile(r"-?(?:0x[0-9A-Fa-f]+|[0-9]+)")
_WITH_UNIT = re.compile(r"(?P<number>[0-9]+(?:\.[0-9]+)?)\s*(?P<unit>[kKMG]?[hH]z|[pnuµm]?s|[nuµmc]?m|m?V)")
_POLYNOMIAL = re.compile(r"(?:x(?:\s*\^\s*[0-9]+)?|1)(?:\s*\+\s*(?:x(?:\s*\^\s*[0-9]+)?|1))+", re.IGNORECASE)
#: Longest text, in characters, that is tried as a number.
_LONGEST = 100


def number_hint(key: str, value: Any) -> str:
    """Return what to write instead of ``value`` under ``key``, which takes a whole number. Empty if unclear."""
    if isinstance(value, float):
        if value.is_integer() and abs(value) < 2**64:
            return f"; write {int(value)}"
        return _fraction_hint(key, value) if math.isfinite(value) else ""
    if not isinstance(value, str) or len(value) > _LONGEST:
        return ""
    text = value.strip()
    if _PLAIN.fullmatch(text):
        return f"; write {text}, without the quotes"
    if found := _HEX.fullmatch(text):
        return f"; write {found['negative']}0x{(found['suffixed'] or found['prefixed']).upper()}"
    if found := _BINARY.fullmatch(text):
        return f"; write {int(found[1], 2):#x}"
    if found := _GROUPED.fullmatch(text):
        return f"; write {text.replace(found[1], '')}"
    if found := _WITH_UNIT.fullmatch(text):
        converted = _converted(Fraction(found["number"]), found["unit"].lower(), _unit(key))
        return f"; write {converted}, in {_word(_unit(key))}" if converted is not None else ""
    return _polynomial_hint(text) if key == "poly" and _POLYNOMIAL.fullmatch(text) else ""


def _fraction_hint(key: str, value: float) -> str:
    """Return the hint for ``at_least_us: 0.03``. Bounds are rounded to the safe side of the manual's value."""
    unit = _unit(key)
    wrong = f"; there are no fractions of {_word(unit)}" if unit in _UNITS else "; there are no fractions"
    if "at_least" in key or key.startswith("min_"):
        return f"{wrong}: round up and write {math.ceil(value)}"
    if ("at_most" in key or key.startswith("max_")) and value > 1:
        return f"{wrong}: round down and write {math.floor(value)}"
    return wrong


def _polynomial_hint(text: str) -> str:
    terms = re.sub(r"\s", "", text.lower()).split("+")
    powers = [int(term.partition("^")[2] or 1) if term.startswith("x") else 0 for term in terms]
    top = max(powers)
    if top > 64:
        return ""
    rest = sum(1 << power for power in set(powers) - {top})
    return f"; write {rest:#x}, which omits x^{top}, and 'width: {top}'"


def key_hint(key: str, value: Any, known: Iterable[str]) -> str:
    """Return what to write instead of a key with the wrong unit, such as ``min_khz: 200`` for ``min_hz: 200000``."""
    stem, _, unit = key.rpartition("_")
    if not stem or unit.lower() not in _UNITS:
        return ""
    kind = _UNITS[unit.lower()][0]
    others = {item: _unit(item) for item in known if _UNITS.get(_unit(item), ("", 0))[0] == kind}
    stems = {item.rpartition("_")[0]: item for item in others}
    right = stems.get(meant(stem, [other for other in stems if other != stem]) if stem not in stems else stem, "")
    if not right or right == key:
        return ""
    wanted = _word(others[right])
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        or_else = f". If that is not a whole number{_INSTEAD[right]}" if right in _INSTEAD else ""
        return f"; the unit is {wanted}: write '{right}'{or_else}"
    # From the shortest decimal form: 0.05 means five hundredths, not the nearest binary fraction.
    converted = _converted(Fraction(str(value)), unit.lower(), others[right])
    if converted is None:
        shown = f"{value} {_word(unit.lower())}"
        return f"; there is only '{right}', and {shown} is not a whole number of {wanted}{_INSTEAD.get(right, '')}"
    return f"; write '{right}: {converted}', in {wanted}"


def _unit(key: str) -> str:
    return key.rpartition("_")[2].lower()


def _word(unit: str) -> str:
    return _WORDS.get(unit, unit)


def _converted(number: Fraction, unit: str, wanted: str) -> int | None:
    """Return the number in another unit of the same kind, or None if the kind differs or the result is not whole."""
    if unit not in _UNITS or wanted not in _UNITS or _UNITS[unit][0] != _UNITS[wanted][0]:
        return None
    exact = number * Fraction(10) ** (_UNITS[unit][1] - _UNITS[wanted][1])
    return int(exact) if exact.denominator == 1 else None
