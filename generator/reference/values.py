"""Values of single fields for the reference codec: from the bits to a value with its meaning, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Number,
    Parity,
    PlacedField,
    Text,
    Unused,
    Value,
    assert_never,
)
from ..model.kinds import DataKind
from ..say import report

Values = Mapping[str, "int | str | bool"]


class EncodeError(ValueError):
    """A value is missing, unknown, or does not fit its field."""


def number_of_text(text: str) -> int:
    """Return the bits of a text field as one number. Characters outside Latin-1 become question marks."""
    return int.from_bytes(text.encode("latin-1", "replace"), "big")


def value_and_meaning(field: Field, raw: int, width: int) -> tuple[int | str | bool, str]:
    """Return the value and the meaning of a number in a field: ``("ready", "the encoder is ready")`` for a choice.

    Invalid numbers are returned unchanged.
    """
    match field.kind:
        case Number() as number:
            return signed_or_plain(number, raw, width), field.meaning
        case Flag() as flag:
            is_active = bool(raw) != flag.active_low
            meaning_of_state = flag.when_active if is_active else flag.when_inactive
            return is_active, meaning_of_state or field.meaning
        case Choice(named_values):
            for named_value in named_values:
                if named_value.value == raw:
                    return named_value.name, named_value.meaning or field.meaning
            return raw, field.meaning
        case Text():
            return raw.to_bytes(width // 8, "big").decode("latin-1"), field.meaning
        case Constant() | Decimal() | Unused() | CrcValue() | Parity():
            return raw, field.meaning
        case _ as kind:
            assert_never(kind)


def signed_or_plain(number: Number, raw: int, width: int) -> int:
    """Return the value of these bits: two's complement if the field is signed. Zero may represent another value.

    0b111 of 3 bits is -1 in a signed field, and else 7. ``zero_means`` is 0 unless the manual gives 0 another meaning.
    """
    sign_bit = raw >> (width - 1)
    if number.signed and sign_bit:
        return raw - (1 << width)
    return raw or number.zero_means


def encode_value(kind: DataKind, placed_field: PlacedField, value: int | str | bool) -> int:
    """Return the number that represents a value of a field. Named values and texts may also be given as numbers.

    Raises:
        EncodeError: A number is a text or does not fit, or no value has this name. Named values and texts that are
            given as numbers are not checked.
    """
    match kind:
        case Number():
            return _encode_number(kind, placed_field, checked_number(value))
        case Flag():
            # 1 for an active flag that is active high, and for an inactive one that is active low.
            return int(bool(value) != kind.active_low)
        case Choice(named_values) if isinstance(value, str):
            return _number_of_name(placed_field.name, named_values, value)
        case Text() if isinstance(value, str):
            return number_of_text(value)
        case Choice() | Text() | Decimal():
            return checked_number(value)
        case _:
            assert_never(kind)


def _encode_number(number: Number, placed_field: PlacedField, value: int) -> int:
    """Return the bits of a number, which may be signed, or 0 for the number that 0 stands for.

    Raises:
        EncodeError: The number does not fit in the bits or their digits, or is not a power of two in a field that needs
            one.
    """
    # A number that does not fit loses bits, so it is not decoded to itself.
    raw = 0 if value == number.zero_means else value & placed_field.mask
    if signed_or_plain(number, raw, placed_field.width) != value:
        raise EncodeError(report.too_wide(placed_field.name, f"{value}", f"{placed_field.width}"))
    code = number.code_of_digits
    if code is not None and value > code.highest(placed_field.width):
        raise EncodeError(report.too_high(placed_field.name, f"{value}", f"{code.highest(placed_field.width)}"))
    if number.power_of_two and value.bit_count() != 1:
        raise EncodeError(report.no_power_of_two(placed_field.name, f"{value}"))
    return raw


def _number_of_name(field_name: str, named_values: Sequence[Value], name: str) -> int:
    """Return the number of the value ``name`` of a field, or raise an ``EncodeError`` if the field has none."""
    for named_value in named_values:
        if named_value.name == name:
            return named_value.value
    raise EncodeError(f"{field_name} has no value '{name}'")


def encode_digits(decimal: Decimal, values: Values) -> int:
    """Return the number that consists of all runs of digits, of which a missing one is 0.

    Raises:
        EncodeError: A run is a text, is negative or has too many digits.
    """
    number = 0
    for run in decimal.runs:
        value = checked_number(values.get(run.name, 0))
        if not 0 <= value < run.modulus:
            raise EncodeError(f"{run.name} {value} has more than {run.digits} digits")
        number += value * run.divisor
    return number


def checked_number(value: int | str | bool) -> int:
    """Return a value as a number, or raise an ``EncodeError`` if it is a text."""
    if isinstance(value, str):
        raise EncodeError(f"'{value}' is not a number")
    return int(value)
