"""Hints for numbers written as in manuals, keys with another unit and words of other tools: 48h, min_khz, offset."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping
from fractions import Fraction
from typing import Any

from .problems import nearest_choice

#: Base unit and power of ten of each unit.
_BASE_UNIT_AND_POWER = {
    "hz": ("hz", 0), "khz": ("hz", 3), "mhz": ("hz", 6), "ghz": ("hz", 9),
    "ps": ("s", -12), "ns": ("s", -9), "us": ("s", -6), "µs": ("s", -6), "ms": ("s", -3), "s": ("s", 0),
    "pm": ("m", -12), "nm": ("m", -9), "um": ("m", -6), "µm": ("m", -6),
    "mm": ("m", -3), "cm": ("m", -2), "m": ("m", 0),
    "mv": ("v", -3), "v": ("v", 0),
    "baud": ("baud", 0), "kbaud": ("baud", 3), "mbaud": ("baud", 6), "bps": ("baud", 0), "kbps": ("baud", 3),
    "mbps": ("baud", 6), "bit/s": ("baud", 0), "kbit/s": ("baud", 3), "mbit/s": ("baud", 6),
}  # fmt: skip
#: Units that manuals often print with a prefix, and the number from which kilo is likelier than mega.
_PREFIXED_UNITS = {"hz": "Hz", "baud": "baud"}
_LIKELY_KILO = 50
#: Forms of keys with a value other than true or false.
_EXAMPLE_MAPS = {"gray": "{of: position}"}
#: Alternatives for a value that does not fit the smallest supported unit.
_ALTERNATIVES_TO_UNIT = {"step_nm": ": write the length of several counts, and their number in 'per_counts'"}
#: Hints for a list under a key that takes a single map.
_INSTEAD_OF_LIST = {
    "gray": "; a layout has one number in Gray code: join numbers that are converted together, or convert the others in"
    " your program",
}
_UNIT_NAMES = {"hz": "Hz", "khz": "kHz", "mhz": "MHz", "ghz": "GHz", "us": "µs", "um": "µm", "mv": "mV", "v": "V"}

#: ``48h``, ``0X48``, ``$48``, ``#48`` or ``&H48``.
_HEX_NUMBER = re.compile(
    r"(?P<negative>-?)(?:(?P<suffixed>[0-9A-Fa-f]+)[hH]|(?:0X|\$|#|&[hH])(?P<prefixed>[0-9A-Fa-f]+))"
)
#: ``0b0101``.
_BINARY_NUMBER = re.compile(r"0[bB](?P<digits>[01]+)")
#: ``1,000,000``, with the same separator each time.
_GROUPED_DIGITS = re.compile(r"-?[0-9]{1,3}(?:(?P<separator>[_' ,])[0-9]{3})(?:(?P=separator)[0-9]{3})*")
_PLAIN_NUMBER = re.compile(r"-?(?:0x[0-9A-Fa-f]+|[0-9]+)")
#: ``10 MHz`` or ``2.5 Mbit/s``.
_WITH_UNIT = re.compile(
    r"(?P<number>[0-9]+(?:\.[0-9]+)?)\s*(?P<unit>[kKMG]?[hH]z|[kKM]?(?:[bB]aud|bps|bit/s)|[pnuµm]?s|[nuµmc]?m|m?V)"
)
#: ``x^6 + x + 1``.
POLYNOMIAL = re.compile(r"(?:x(?:\s*\^\s*[0-9]+)?|1)(?:\s*\+\s*(?:x(?:\s*\^\s*[0-9]+)?|1))+", re.IGNORECASE)
#: ``1D`` or ``FF``, but not ``ff``, which may be a word.
_BARE_HEX_DIGITS = re.compile(r"[0-9][0-9A-Fa-f]*|[0-9A-F]{2,}")
#: ``4C 69 6B``.
_HEX_BYTES = re.compile(r"[0-9A-Fa-f]{2}(?: [0-9A-Fa-f]{2})*")
#: ``1 << bits`` or ``(1 << bits)``.
_SHIFTED_ONE = re.compile(r"\(?1\s*<<\s*(\w+)\)?")
#: Keys of other tools, each with the keys that may have the same meaning here.
_KEYS_OF_OTHER_TOOLS = {
    "description": ("meaning",), "desc": ("meaning",), "comment": ("note",),
    "offset": ("address", "at"), "size": ("length", "bits"), "width": ("bits", "length"),
    "type": ("length", "bits", "access"),
    "endianness": ("byte_order",), "endian": ("byte_order",), "active_low": ("active",), "active_high": ("active",),
    "reset": ("default",), "reset_value": ("default",), "enum": ("values",), "enums": ("values",),
    "permission": ("access",), "mode": ("access",),
}  # fmt: skip
#: Features that the language does not have, by the words that people try, each with the way round.
_NO_BCD = "; the language has no BCD code: write a number of plain bits, and convert it in your program"
_NO_REPETITION = (
    "; the language has no repeated words: write the second word as fields with names of their own, and compare them in"
    " your program"
)
_NO_SUM = "; the language has only parity bits, CRCs and XOR: write a number, and compare it in your program"
_NO_REVERSAL = "; the language has no words with the least significant bit first: reverse the bits before you decode"
_UNSUPPORTED_KEYS = {
    **dict.fromkeys(("bcd", "excess_3", "decimal"), _NO_BCD),
    **dict.fromkeys(("repeat", "repeats", "repeated", "repetitions"), _NO_REPETITION),
    **dict.fromkeys(("sum_of", "checksum", "checksum_of", "complement_of"), _NO_SUM),
    **dict.fromkeys(("bit_order", "lsb_first"), _NO_REVERSAL),
}
#: Values of keys that other tools write in words.
_VALUES_OF_OTHER_TOOLS = {
    "byte_order": {
        **dict.fromkeys(("big", "be", "big_endian", "msb", "motorola"), "high_byte_first"),
        **dict.fromkeys(("little", "le", "little_endian", "lsb", "intel"), "low_byte_first"),
    },
    "access": {
        **dict.fromkeys(("rw", "r/w", "read-write"), "read_write"),
        **dict.fromkeys(("ro", "r", "read", "read-only"), "read_only"),
        **dict.fromkeys(("wo", "w", "write", "write-only"), "write_only"),
    },
}
_YES_OR_NO = {
    **dict.fromkeys(("yes", "y", "on", "true", "1"), "true"),
    **dict.fromkeys(("no", "n", "off", "false", "0"), "false"),
}
#: ``uint16_t``, ``int16`` or ``u16``.
_TYPE_BITS = re.compile(r"u?int_?([0-9]{1,2})(?:_t)?|[ui]([0-9]{1,2})")
#: Hints for missing keys that most older specs lack.
TO_ADD = {
    "evidence": (
        "if the whole manual was read, add 'evidence: {grade: manual, documents: {manual: all pages}}', otherwise"
        " another grade"
    ),
}
#: Largest number of counts that a hint suggests for a length.
_MOST_COUNTS = 65_536
#: Longest text, in characters, that is tried as a number.
_LONGEST_NUMBER_TEXT = 100


def number_hint(key: str, wrong_value: Any) -> str:
    """Return a hint on what to write instead of ``wrong_value`` under ``key``, which takes a whole number.

    The hint for ``48h`` is ``; write 0x48``. All hints begin with a semicolon, because they follow a message. The hint
    is empty if it is not clear what is meant.
    """
    if isinstance(wrong_value, float):
        return _float_hint(key, wrong_value)
    if _is_list_of_bytes(wrong_value):
        return _text_hint(key, bytes(wrong_value).hex(" "))
    if isinstance(wrong_value, str) and len(wrong_value) <= _LONGEST_NUMBER_TEXT:
        return _text_hint(key, wrong_value.strip())
    return ""


def _is_list_of_bytes(wrong_value: Any) -> bool:
    """Return True for a list of two or more numbers that each fit into a byte."""
    if not isinstance(wrong_value, list) or len(wrong_value) < 2:
        return False
    return all(type(number) is int and 0 <= number < 256 for number in wrong_value)


def _float_hint(key: str, wrong_number: float) -> str:
    """Return a hint on what to write instead of a number with a decimal point. Empty if it is infinite."""
    if wrong_number.is_integer() and abs(wrong_number) < 2**64:
        return f"; write {int(wrong_number)}"
    return _fraction_hint(key, wrong_number) if math.isfinite(wrong_number) else ""


def _text_hint(key: str, number_text: str) -> str:
    """Return a hint on what to write instead of a text that is meant as a number. Empty if it is not clear.

    The text can be bytes, a number in quotes, ``48h``, ``0b11``, ``1,000``, ``10 MHz``, a polynomial, or hexadecimal
    without a prefix.
    """
    is_several_bytes = _HEX_BYTES.fullmatch(number_text) is not None and " " in number_text
    if is_several_bytes:  # 4C 69
        return _bytes_hint(bytes.fromhex(number_text))
    if _PLAIN_NUMBER.fullmatch(number_text):
        return f"; write {number_text}, without the quotes"
    if match := _HEX_NUMBER.fullmatch(number_text):  # 48h or $48
        hex_digits = match["suffixed"] or match["prefixed"]
        return f"; write {match['negative']}0x{hex_digits.upper()}"
    if match := _BINARY_NUMBER.fullmatch(number_text):  # 0b0101
        return f"; write {int(match['digits'], 2):#x}"
    if match := _GROUPED_DIGITS.fullmatch(number_text):  # 1,000
        return f"; write {number_text.replace(match['separator'], '')}"
    if match := _WITH_UNIT.fullmatch(number_text):  # 10 MHz
        unit_of_key = _unit_of_key(key)
        converted = _convert_number(Fraction(match["number"]), match["unit"].lower(), unit_of_key)
        return f"; write {converted}, in {_unit_in_words(unit_of_key)}" if converted is not None else ""
    if key == "poly" and POLYNOMIAL.fullmatch(number_text):  # x^6 + x + 1
        return _polynomial_hint(number_text)
    return f"; write 0x{number_text.upper()}" if _BARE_HEX_DIGITS.fullmatch(number_text) else ""


def expression_hint(expression_text: str) -> str:
    """Return a hint on what to write instead of powers such as ``2**n`` and ``1 << n``. Empty if there are none."""
    corrected = _SHIFTED_ONE.sub(r"2^\1", expression_text.replace("**", "^"))
    return f"; write {corrected}" if corrected != expression_text else ""


def value_hint(key: str, wrong_value: Any, schema: Mapping[str, Any]) -> str:
    """Return a hint on what to write instead of a value of the wrong type. Empty if it is not clear.

    Instead of a boolean, the value may be ``yes``. Instead of a map with one required key, it may be the value of that
    key.
    """
    required_type = schema.get("type")
    required_keys = schema.get("required", ())
    if isinstance(wrong_value, list) and required_type == "object":
        return _INSTEAD_OF_LIST.get(key, "")
    if required_type == "boolean":
        text = str(wrong_value).lower()
        return f"; write {_YES_OR_NO[text]}" if text in _YES_OR_NO else ""
    if required_type != "object" or len(required_keys) != 1 or isinstance(wrong_value, dict | list | type(None)):
        return ""
    (required_key,) = required_keys
    if isinstance(wrong_value, bool):
        example_map = _EXAMPLE_MAPS.get(key, f"{{{required_key}: NAME}}")
    else:
        example_map = f"{{{required_key}: {wrong_value}}}"
    return f"; write '{key}: {example_map}'"


def word_hint(key: str, wrong_word: Any) -> str:
    """Return a hint on what to write instead of a word of other tools, such as ``rw``. Empty for other words."""
    word = _VALUES_OF_OTHER_TOOLS.get(key, {}).get(str(wrong_word).lower(), "")
    return f"; write '{word}'" if word else ""


def unsupported_hint(word: Any) -> str:
    """Return a hint with the workaround for a feature that the spec language does not have.

    ``word`` is a key or value that suggests such a feature, such as ``bcd``. The hint is empty for all other words.
    """
    return _UNSUPPORTED_KEYS.get(str(word).lower().replace("-", "_"), "")


def foreign_key_hint(
    unknown_key: str, value_of_key: Any, allowed_keys: Collection[str], used_keys: Collection[str]
) -> str:
    """Return a hint on what to write instead of a key of other tools: ``meaning`` for ``description``.

    ``allowed_keys`` contains the keys that the map can have, and ``used_keys`` the keys that it has. The hint is empty
    if no allowed key has the same meaning.
    """
    key_of_language = _key_of_language(unknown_key, value_of_key, allowed_keys)
    if not key_of_language:
        return ""
    if key_of_language in used_keys:
        return f"; leave it out, because '{key_of_language}' says the same"
    if key_of_language == "active":
        # Both 'active_low: true' and 'active_high: false' mean low.
        names_low = unknown_key.lower() == "active_low"
        is_low = names_low if value_of_key is not False else not names_low
        return "; write 'active: low'" if is_low else "; write 'active: high'"
    if key_of_language in _VALUES_OF_OTHER_TOOLS:
        word = _VALUES_OF_OTHER_TOOLS[key_of_language].get(str(value_of_key).lower().replace("-", "_"), "")
        return f"; write '{key_of_language}: {word}'" if word else f"; it is called '{key_of_language}' here"
    # A type such as uint16_t gives the length or the number of bits.
    type_bits = _TYPE_BITS.fullmatch(str(value_of_key).lower())
    if type_bits is not None:
        bit_count = int(type_bits[1] or type_bits[2])  # The group for uint16_t or the group for u16 is empty.
        number = bit_count // 8 if key_of_language == "length" else bit_count
        return f"; write '{key_of_language}: {number}'"
    return f"; it is called '{key_of_language}' here"


def _key_of_language(unknown_key: str, value_of_key: Any, allowed_keys: Collection[str]) -> str:
    """Return the allowed key that has the meaning of an unknown key of another tool, or an empty string.

    If there are several, a key that takes the given value is preferred, so that ``mode: rw`` becomes ``access``.
    """
    candidates = [
        key_of_language
        for key_of_language in _KEYS_OF_OTHER_TOOLS.get(unknown_key.lower(), ())
        if key_of_language in allowed_keys
    ]
    for key_of_language in candidates:
        our_words = _VALUES_OF_OTHER_TOOLS.get(key_of_language, {}).values()
        if word_hint(key_of_language, value_of_key) or value_of_key in our_words:
            return key_of_language
    return candidates[0] if candidates else ""


def _bytes_hint(listed_bytes: bytes) -> str:
    """Return a hint with the number to write instead of several bytes, for each byte order if they differ."""
    big_endian = int.from_bytes(listed_bytes, "big")
    little_endian = int.from_bytes(listed_bytes, "little")
    if big_endian == little_endian:
        return f"; write one number: {big_endian:#x}"
    return (
        f"; write one number: {big_endian:#x} if the first byte is the highest, {little_endian:#x} if it is the lowest"
    )


def _fraction_hint(key: str, fraction: float) -> str:
    """Return a hint for a number with decimals, such as ``at_least_us: 0.03``.

    Limits are rounded to the safe side of the manual's value: lower bounds up, and upper bounds down unless the result
    would be 0. Other numbers are not rounded.
    """
    unit = _unit_of_key(key)
    # A small frequency or baud rate is probably in a larger unit.
    if unit in _PREFIXED_UNITS and fraction > 0:
        return _larger_unit_hint(unit, fraction)
    if key == "step_um":
        return _hint_on_length_of_step(fraction)
    problem = "; there are no fractions"
    if unit in _BASE_UNIT_AND_POWER:
        problem += f" of {_unit_in_words(unit)}"
    is_lower_bound = "at_least" in key or key.startswith("min_")
    is_upper_bound = "at_most" in key or key.startswith("max_")
    if is_lower_bound:
        return f"{problem}: round up and write {math.ceil(fraction)}"
    if is_upper_bound and fraction > 1:
        return f"{problem}: round down and write {math.floor(fraction)}"
    return problem


def _larger_unit_hint(unit: str, fraction: float) -> str:
    """Return the hint for ``max_hz: 2.5``, which is more likely in MHz than in kHz.

    ``unit`` is ``hz`` or ``baud``.
    """
    # The prefix and its power of ten.
    prefix, power = ("k", 3) if fraction >= _LIKELY_KILO else ("M", 6)
    # From the shortest decimal form: 2.1 means 21/10, not the nearest binary fraction.
    converted = Fraction(str(fraction)) * 10**power
    if converted.denominator != 1:
        return f"; there are no fractions of {_PREFIXED_UNITS[unit]}"
    return f"; if it is in {prefix}{_PREFIXED_UNITS[unit]}, write {converted}"


def _hint_on_length_of_step(micrometres: float) -> str:
    """Return the hint for ``step_um: 0.5``: the same length in nanometres, or the length of several steps."""
    nanometres = Fraction(str(micrometres)) * 1000
    if nanometres.denominator == 1:
        return f"; write 'step_nm: {nanometres}'"
    # ``numerator`` nanometres are the length of ``denominator`` steps.
    length_per_steps = nanometres.limit_denominator(_MOST_COUNTS)
    example = f"such as 'step_nm: {length_per_steps.numerator}' with 'per_counts: {length_per_steps.denominator}'"
    return f"; write the length of several steps in nanometres, and their number in 'per_counts', {example}"


def _polynomial_hint(polynomial_text: str) -> str:
    """Return the hint for ``x^6 + x + 1``: the number whose bits are the powers below the highest, and the width.

    The hint is empty if the width is above 64, which no CRC of the language has.
    """
    powers = polynomial_powers(polynomial_text)
    width = max(powers)
    if width > 64:
        return ""
    polynomial_bits = sum(1 << power for power in powers if power != width)
    return f"; write {polynomial_bits:#x}, which omits x^{width}, and 'width: {width}'"


def polynomial_powers(polynomial_text: str) -> set[int]:
    """Return the powers of a polynomial such as ``x^6 + x + 1``."""
    without_blanks = re.sub(r"\s", "", polynomial_text.lower())
    terms = without_blanks.split("+")
    return set(map(_parse_power, terms))


def _parse_power(term: str) -> int:
    """Return the power of a term: 6 for ``x^6``, 1 for ``x`` and 0 for ``1``."""
    _, _, power_text = term.partition("^")
    if not term.startswith("x"):
        return 0
    return int(power_text) if power_text else 1


def key_hint(unknown_key: str, value_of_key: Any, known_keys: Iterable[str]) -> str:
    """Return a hint on what to write instead of a key with the wrong unit: ``min_hz: 200000`` for ``min_khz: 200``.

    The hint is empty if no known key differs only in the unit.
    """
    stem, _, unit = unknown_key.rpartition("_")
    unit = unit.lower()
    if not stem or unit not in _BASE_UNIT_AND_POWER:
        return ""
    fitting_keys = _keys_of_same_kind(stem, unit, known_keys)
    if not fitting_keys or unknown_key in fitting_keys:
        return ""
    best_key = _key_with_best_unit(fitting_keys, value_of_key, unit)
    best_unit = _unit_of_key(best_key)
    if not _is_finite_number(value_of_key):
        hint = f"; the unit is {_unit_in_words(best_unit)}: write '{best_key}'"
        if best_key in _ALTERNATIVES_TO_UNIT:
            hint += f". If that is not a whole number{_ALTERNATIVES_TO_UNIT[best_key]}"
        return hint
    # From the shortest decimal form: 0.05 means five hundredths, not the nearest binary fraction.
    converted = _convert_number(Fraction(str(value_of_key)), unit, best_unit)
    if converted is None:
        problem = f"{value_of_key} {_unit_in_words(unit)} is not a whole number of {_unit_in_words(best_unit)}"
        return f"; there is only '{best_key}', and {problem}{_ALTERNATIVES_TO_UNIT.get(best_key, '')}"
    return f"; write '{best_key}: {converted}', in {_unit_in_words(best_unit)}"


def _keys_of_same_kind(stem: str, unit: str, known_keys: Iterable[str]) -> list[str]:
    """Return the known keys that differ from an unknown key only in the unit, such as ``min_hz`` for ``min_khz``.

    ``stem`` is the unknown key without its ``unit``. It may contain a typo.
    """
    base_unit = _base_unit(unit)
    keys_of_kind = [known_key for known_key in known_keys if _base_unit(_unit_of_key(known_key)) == base_unit]
    stems = {_remove_unit(known_key) for known_key in keys_of_kind}
    meant_stem = stem if stem in stems else nearest_choice(stem, list(stems))
    if not meant_stem:
        return []
    return [known_key for known_key in keys_of_kind if _remove_unit(known_key) == meant_stem]


def _base_unit(unit: str) -> str:
    """Return the unit without its prefix, such as ``hz`` for ``khz``, or "" for an unknown unit."""
    base_unit, _ = _BASE_UNIT_AND_POWER.get(unit, ("", 0))
    return base_unit


def _key_with_best_unit(keys: list[str], value_of_key: Any, unit: str) -> str:
    """Return the key with the largest unit in which a value is a whole number, or the key with the smallest unit.

    ``keys`` differ only in their units. ``unit`` is the unit of the value.
    """

    def power_of_unit(known_key: str) -> int:
        _, power_of_ten = _BASE_UNIT_AND_POWER[_unit_of_key(known_key)]
        return power_of_ten

    largest_unit_first = sorted(keys, key=power_of_unit, reverse=True)
    for known_key in largest_unit_first:
        if _is_whole_in(value_of_key, unit, _unit_of_key(known_key)):
            return known_key
    return largest_unit_first[-1]


def _is_finite_number(value_of_key: Any) -> bool:
    return isinstance(value_of_key, int | float) and not isinstance(value_of_key, bool) and math.isfinite(value_of_key)


def _is_whole_in(value_of_key: Any, unit: str, target_unit: str) -> bool:
    """Return True if a value is a whole number in another unit."""
    if not _is_finite_number(value_of_key):
        return False
    return _convert_number(Fraction(str(value_of_key)), unit, target_unit) is not None


def _remove_unit(key: str) -> str:
    return key.rpartition("_")[0]


def _unit_of_key(key: str) -> str:
    return key.rpartition("_")[2].lower()


def _unit_in_words(unit: str) -> str:
    return _UNIT_NAMES.get(unit, unit)


def _convert_number(number: Fraction, unit: str, target_unit: str) -> int | None:
    """Return the number in another unit of the same kind, or None if the kind differs or the result is not whole."""
    if unit not in _BASE_UNIT_AND_POWER or target_unit not in _BASE_UNIT_AND_POWER:
        return None
    base_unit, power_of_ten = _BASE_UNIT_AND_POWER[unit]
    target_base_unit, target_power_of_ten = _BASE_UNIT_AND_POWER[target_unit]
    if base_unit != target_base_unit:
        return None
    converted = number * Fraction(10) ** (power_of_ten - target_power_of_ten)
    return int(converted) if converted.denominator == 1 else None
