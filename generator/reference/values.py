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
from ..say import frame_texts

Values = Mapping[str, "int | str | bool"]


class EncodeError(ValueError):
    """A value is missing, unknown, or does not fit its field."""


def number_of_text(text: str) -> int:
    """Return the bits of a text field as one number. Characters outside Latin-1 become question marks."""
    return int.from_bytes(text.encode("latin-1", "replace"), "big")


def value_and_meaning(field: Field, raw: int, width: int) -> tuple[int | str | bool, str]:
    """Return the value that the bits of a field represent, and its meaning, such as ``("ready", "encoder is ready")``.

    ``raw`` is the number formed by the bits. It is the value if the field has named values but none for this number.
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
    """Return the number that ``width`` bits represent: 0b111 is -1 in a signed field of 3 bits, and otherwise 7.

    ``zero_means`` is the number that the bits 0 represent, which is 0 in most fields.
    """
    sign_bit = raw >> (width - 1)
    if number.signed and sign_bit:
        return raw - (1 << width)
    return number.zero_means if raw == 0 else raw


def encode_value(kind: DataKind, placed_field: PlacedField, value: int | str | bool) -> int:
    """Return the bits of a field for a value, as a number. Instead of a name or a text, the number itself is accepted.

    Raises:
        EncodeError: The value is not a number although it should be, it does not fit in the bits or their digits, or it
            is an unknown name. A number that replaces a name or a text is not checked.
    """
    number = _encode_by_kind(kind, placed_field, value)
    code = placed_field.field.code_of_digits
    if code is not None and number > code.highest(placed_field.width):
        raise EncodeError(
            frame_texts.too_high_message(placed_field.name, f"{number}", f"{code.highest(placed_field.width)}")
        )
    return number


def _encode_by_kind(kind: DataKind, placed_field: PlacedField, value: int | str | bool) -> int:
    """Return the bits of a field for a value, as a number. Digits are not yet converted to their code.

    Raises:
        EncodeError: The value is not a number although it should be, it does not fit, or it is an unknown name.
    """
    match kind:
        case Number():
            return _encode_number(kind, placed_field, checked_number(value))
        case Flag():
            is_active = bool(value)
            return int(is_active != kind.active_low)
        case Choice(named_values) if isinstance(value, str):
            return _number_of_name(placed_field.name, named_values, value)
        case Text() if isinstance(value, str):
            return number_of_text(value)
        case Choice() | Text() | Decimal():
            return checked_number(value)
        case _:
            assert_never(kind)


def _encode_number(number: Number, placed_field: PlacedField, value: int) -> int:
    """Return the bits that represent ``value``, which may be negative in a signed field.

    In some fields, the bits 0 represent the number ``zero_means`` instead of 0.

    Raises:
        EncodeError: The number does not fit in the bits, or the field requires a power of two.
    """
    # A number that does not fit loses bits, and decoding returns a different number.
    raw = 0 if value == number.zero_means else value & placed_field.mask
    if signed_or_plain(number, raw, placed_field.width) != value:
        raise EncodeError(frame_texts.too_wide_message(placed_field.name, f"{value}", f"{placed_field.width}"))
    if number.power_of_two and value.bit_count() != 1:
        raise EncodeError(frame_texts.no_power_of_two_message(placed_field.name, f"{value}"))
    return raw


def _number_of_name(field_name: str, named_values: Sequence[Value], name: str) -> int:
    """Return the number of the named value ``name``, or raise an ``EncodeError`` if the field has no such name."""
    for named_value in named_values:
        if named_value.name == name:
            return named_value.value
    raise EncodeError(f"{field_name} has no value '{name}'")


def encode_digits(decimal: Decimal, values: Values) -> int:
    """Return the decimal number that groups of digits form, such as 1234 from the groups 12 and 34.

    ``values`` contains the number of each group by name. A missing group is 0.

    Raises:
        EncodeError: A group is not a number, is negative, or has too many digits.
    """
    number = 0
    for digit_group in decimal.runs:
        value = checked_number(values.get(digit_group.name, 0))
        if not 0 <= value < digit_group.modulus:
            raise EncodeError(f"{digit_group.name} {value} has more than {digit_group.digits} digits")
        number += value * digit_group.divisor
    return number


def checked_number(value: int | str | bool) -> int:
    """Return a number or Boolean as an integer, or raise an ``EncodeError`` if the value is a text."""
    if isinstance(value, str):
        raise EncodeError(f"'{value}' is not a number")
    return int(value)
