"""Read the options of a line: the words between the interface and the colon."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ..language.problems import listed, quoted, suggestion
from .fields import FieldError, number_in
from .line import Options

_HERTZ = re.compile(r"([0-9]{1,12})([.][0-9]{1,6})?(|k|M)(?:Hz)?")
_FACTORS = {"": 1, "k": 1_000, "M": 1_000_000}
#: Most bytes of the request in a line.
_LONGEST_REQUEST = 8

#: Options without a value: the interfaces that have them, and the members that they set.
_WORDS: Mapping[str, tuple[tuple[str, ...], Mapping[str, Any]]] = {
    "gray": (("biss", "ssi", "spi"), {"is_gray": True}),
    "binary": (("biss", "ssi", "spi", "rs485"), {"is_gray": False}),
    "left": (("ssi",), {"alignment": "msb_left"}),
    "right": (("ssi",), {"alignment": "lsb_right"}),
    "low_byte_first": (("spi", "rs485"), {"byte_order": "low_byte_first"}),
    "high_byte_first": (("spi", "rs485"), {"byte_order": "high_byte_first"}),
}


def _read_frequency(option_text: str) -> int | None:
    """Return the frequency in Hz of a text such as ``1.5MHz`` or ``800k``, or None if it is not 1 Hz to 1 GHz."""
    match = _HERTZ.fullmatch(option_text)
    if match is None:
        return None
    hertz = round(float(match[1] + (match[2] or "")) * _FACTORS[match[3]])
    return hertz if 0 < hertz <= 1_000_000_000 else None


def _read_spi_mode(option_text: str) -> int | None:
    return int(option_text) if option_text in ("0", "1", "2", "3") else None


def _read_positive_number(option_text: str) -> int | None:
    """Return the number in a text, or None if it is 0, too large, or not a number."""
    number = number_in(option_text)
    is_too_large = number is not None and number >= 1 << 63
    return number if number and not is_too_large else None


def _read_hex_bytes(option_text: str) -> bytes | None:
    """Return the bytes of a text such as ``1A`` or ``0x1A02``, or None if it has other characters or is too long."""
    digits = option_text.removeprefix("0x")
    if not re.fullmatch(r"(?:[0-9A-Fa-f]{2})+", digits) or len(digits) > 2 * _LONGEST_REQUEST:
        return None
    return bytes.fromhex(digits)


#: Options with a value: the interfaces that have them, the member, its reader, and an example.
_SETTINGS: Mapping[str, tuple[tuple[str, ...], str, Callable[[str], Any], str]] = {
    "clock": (("biss", "ssi", "spi"), "clock_hz", _read_frequency, "clock=1MHz"),
    "mode": (("spi",), "mode", _read_spi_mode, "mode=1"),
    "baud": (("rs485",), "baud", _read_positive_number, "baud=2500000"),
    "request": (("rs485",), "request", _read_hex_bytes, "request=1A"),
    "counts": (("biss", "ssi", "spi", "rs485"), "counts", _read_positive_number, "counts=4096"),
    "turns": (("biss", "ssi", "spi", "rs485"), "turns", _read_positive_number, "turns=4096"),
}


def with_option(options: Options, text: str, interface: str) -> Options:
    """Return the options with one more, such as ``gray`` or ``clock=1MHz``. Without an interface, each option is valid.

    Raises:
        FieldError: There is no such option, or not for this interface, or its value is wrong.
    """
    name, equals, value_text = text.partition("=")
    name = name.strip()
    value_text = value_text.strip()
    is_word = name in _WORDS
    if not is_word and name not in _SETTINGS:
        known_names = [*_WORDS, *_SETTINGS]
        hint = suggestion(name, known_names) or f"; write {listed(known_names, 'or')}"
        raise FieldError(f"{quoted(name)} is not an option{hint} (a field belongs after the colon)")
    interfaces, *_ = _WORDS[name] if is_word else _SETTINGS[name]
    if interface and interface not in interfaces:
        raise FieldError(f"'{name}' is not an option of {interface}, only of {listed(interfaces)}; remove it")
    if is_word:
        if equals:
            raise FieldError(f"'{name}' has no value; write only {name}", len(name))
        _, changed_members = _WORDS[name]
        return replace(options, **changed_members)
    _, member, read_value, example = _SETTINGS[name]
    value = read_value(value_text)
    if value is None:
        offset = len(name) + 1  # after "name="
        raise FieldError(f"{quoted(value_text)} is not a value of '{name}'; write it like {example}", offset)
    return replace(options, **{member: value})
