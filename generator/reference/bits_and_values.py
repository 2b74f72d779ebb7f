"""Bits of a frame for the reference codec, Gray code, CRCs bit by bit, and the values of single fields.

Parameters of CRCs have their usual names: width, poly (without its top bit), init, refin, refout, xorout.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ..model import (
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Join,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Text,
    Unused,
    Value,
    assert_never,
    number_to_bytes,
)
from ..model.kinds import DataKind, DigitCode
from ..say import frame_texts


def bits_of_field(placed_field: PlacedField, frame: int) -> int:
    """Return the bits of a field in a frame as a number."""
    return (frame >> placed_field.lowest_bit) & placed_field.mask


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    binary_digits = f"{value:0{width}b}"
    return int(binary_digits[::-1], 2)


def compute_bits(crc: Crc, number: int, bit_count: int) -> int:
    """Return the CRC of the lowest ``bit_count`` bits of ``number``, processed one by one, most significant bit first.

    ``refin`` is ignored, because it reverses the bits of bytes, and this data has no bytes.
    """
    register = crc.init
    mask = crc.mask
    poly = crc.poly
    highest_bit = crc.width - 1
    for bit_position in reversed(range(bit_count)):
        data_bit = (number >> bit_position) & 1
        shifted_out = (register >> highest_bit) & 1
        register = (register << 1) & mask
        if shifted_out != data_bit:
            register ^= poly
    if crc.refout:
        register = reflect(register, crc.width)
    return register ^ crc.xorout


def compute_bytes(crc: Crc, data: bytes) -> int:
    """Return the CRC of whole bytes. With ``refin``, each byte is processed least significant bit first."""
    number, bit_count = bits_in_crc_order(crc, data)
    return compute_bits(crc, number, bit_count)


def bits_in_crc_order(crc: Crc, data: bytes) -> tuple[int, int]:
    """Return the bits of ``data`` as one number, in the order in which the CRC processes them, and how many they are.

    With ``refin``, the bits of each byte are reversed.
    """
    number = 0
    for byte in data:
        ordered_byte = reflect(byte, 8) if crc.refin else byte
        number = (number << 8) | ordered_byte
    return number, 8 * len(data)


def init_for_result(crc: Crc, number: int, bit_count: int, result: int) -> int:
    """Return the start value ``init`` with which the CRC of the lowest ``bit_count`` bits of ``number`` is ``result``.

    There is exactly one such value if the lowest bit of ``poly`` is 1, because each step can then be undone.
    """
    register = result ^ crc.xorout
    if crc.refout:
        register = reflect(register, crc.width)
    # Undo the steps of compute_bits, from the last bit to the first.
    for bit_position in range(bit_count):
        sent_bit = (number >> bit_position) & 1
        # The shift leaves the lowest bit 0, and the polynomial sets it.
        had_feedback = register & 1
        if had_feedback:
            register ^= crc.poly
        shifted_out = had_feedback ^ sent_bit
        register = (register >> 1) | (shifted_out << (crc.width - 1))
    return register


def unused_bits(placed_layout: PlacedLayout, number: int) -> int:
    """Return the unused bits of the frame ``number`` as one number. Bits that differ from the manual are 1.

    Each unused field has its place in this number. ``placed_layout.unused`` gives the position of its lowest bit.
    """
    all_differing_bits = 0
    for placed_field, lowest_bit_in_result in placed_layout.unused:
        sent_bits = bits_of_field(placed_field, number)
        differing_bits = sent_bits ^ documented_bits(placed_field)
        all_differing_bits |= differing_bits << lowest_bit_in_result
    return all_differing_bits


def documented_bits(placed_field: PlacedField) -> int:
    """Return the value of an unused field in the manual, or 0 for any other field.

    The value is cut to the width of the field for this order code.
    """
    kind = placed_field.field.kind
    if not isinstance(kind, Unused):
        return 0
    return kind.value & placed_field.mask


def parity_bit(placed_layout: PlacedLayout, parity: Parity, number: int) -> int:
    """Return the value that a parity bit must have in the frame ``number``.

    It covers the fields ``of``. ``mask`` selects the bits of each of these fields that count.
    """
    count_of_ones = 0
    for placed_field in placed_layout.find_fields(parity.of):
        covered_bits_of_field = bits_of_field(placed_field, number) & parity.mask
        count_of_ones += covered_bits_of_field.bit_count()
    # ``odd`` is 1 for odd parity, which makes the count of ones, including the parity bit, odd.
    return (count_of_ones + parity.odd) & 1


def join_value(placed_layout: PlacedLayout, join: Join, number: int) -> int:
    """Return the number that several fields of the frame ``number`` form together. The first is the most significant.

    The spec calls such a number a join, for example a position that consists of multiturn and singleturn.
    """
    joined_value = 0
    for placed_field in placed_layout.find_fields(join.fields):
        field_value = bits_of_field(placed_field, number)
        joined_value = (joined_value << placed_field.width) | field_value
    return joined_value


def gray_to_binary(gray: int) -> int:
    """Return the number whose Gray code is ``gray``: each bit is the parity of the bits from the highest down to it."""
    binary = 0
    while gray:
        binary ^= gray
        gray >>= 1
    return binary


def binary_to_gray(binary: int) -> int:
    """Return the Gray code of ``binary``."""
    return binary ^ (binary >> 1)


def to_binary(placed_layout: PlacedLayout, number: int) -> int:
    """Return the frame ``number`` with its Gray code and its digits converted to binary numbers.

    Some encoders add an excess to the number before they convert it to Gray code. It is subtracted. If a digit that is
    sent separately, such as BCD, has an invalid code, all bits of its number become 1.
    """

    def gray_to_number(gray: int) -> int:
        return gray_to_binary(gray) - placed_layout.gray_excess

    for placed_field in placed_layout.fields:
        code = placed_field.field.code_of_digits
        if code is not None:
            sent_bits = bits_of_field(placed_field, number)
            value = number_of_digits(code, sent_bits, placed_field.width)
            if value is None:
                value = placed_field.mask
            number = with_bits(number, placed_field, value)
    return _convert_gray_part(placed_layout, number, gray_to_number)


def number_of_digits(code: DigitCode, sent_bits: int, width: int) -> int | None:
    """Return the number whose digits are sent as these ``width`` bits, or None if a digit has no valid code.

    ``code`` defines how each digit is sent: for BCD, 0001 0010 are the digits 1 and 2 of the number 12.
    """
    number = 0
    mask_of_digit = (1 << code.bits) - 1
    digit_count = -(-width // code.bits)  # Rounded up: the first digit can have fewer bits.
    for digit_index in reversed(range(digit_count)):
        code_of_digit = (sent_bits >> (digit_index * code.bits)) & mask_of_digit
        if code_of_digit not in code.codes:
            return None
        digit = code.codes.index(code_of_digit)
        number = number * len(code.codes) + digit
    return number


def digits_of_number(code: DigitCode, number: int, width: int) -> int:
    """Return the bits with which the digits of a number are sent: for BCD, 0001 0010 for the number 12.

    All digits that fit in ``width`` bits are sent, because in other codes the bits of a leading digit 0 are not 0.
    """
    sent_bits = 0
    remaining_number = number
    for lowest_bit_of_digit in range(0, width, code.bits):
        remaining_number, digit = divmod(remaining_number, len(code.codes))
        sent_bits |= code.codes[digit] << lowest_bit_of_digit
    return sent_bits


def with_bits(frame: int, placed_field: PlacedField, field_bits: int) -> int:
    """Return the frame with the bits of one field replaced."""
    other_bits = frame & ~(placed_field.mask << placed_field.lowest_bit)
    return other_bits | (field_bits << placed_field.lowest_bit)


def from_binary(placed_layout: PlacedLayout, number: int) -> int:
    """Return the frame ``number`` as it is sent, with binary numbers converted to Gray code or to separate digits.

    If the counts per revolution are not a power of two, some encoders add an excess to the number first, so that only
    one bit of the Gray code changes at the wraparound.
    """
    _, width = placed_layout.lowest_bit_and_width_of(placed_layout.layout.gray_of)
    mask = (1 << width) - 1

    def number_to_gray(binary: int) -> int:
        return binary_to_gray((binary + placed_layout.gray_excess) & mask)

    for placed_field in placed_layout.fields:
        code = placed_field.field.code_of_digits
        if code is not None:
            value = bits_of_field(placed_field, number)
            sent_digits = digits_of_number(code, value, placed_field.width)
            number = with_bits(number, placed_field, sent_digits)
    return _convert_gray_part(placed_layout, number, number_to_gray)


def _convert_gray_part(placed_layout: PlacedLayout, frame: int, convert: Callable[[int], int]) -> int:
    """Return the frame with the number in Gray code replaced by the result of ``convert``, cut to its width.

    A frame without Gray code is returned unchanged.
    """
    if not placed_layout.gray:
        return frame
    lowest_bit, width = placed_layout.lowest_bit_and_width_of(placed_layout.layout.gray_of)
    mask = (1 << width) - 1
    number = (frame >> lowest_bit) & mask
    converted_number = convert(number) & mask
    other_bits = frame & ~(mask << lowest_bit)
    return other_bits | (converted_number << lowest_bit)


def compute(crc: Crc, placed_layout: PlacedLayout, number: int) -> int:
    """Return the CRC that matches the other bits of the frame ``number``."""
    covered_number, bit_count = covered_bits(crc, placed_layout, number)
    return compute_bits(crc, covered_number, bit_count)


def covered_bits(crc: Crc, placed_layout: PlacedLayout, number: int) -> tuple[int, int]:
    """Return the bits that the CRC covers as one number, in the order in which it processes them, and how many.

    A CRC over whole bytes is in the last bytes of the frame, and covers all bytes before it.
    """
    if placed_layout.layout.crc_covers_bytes:
        data = number_to_bytes(placed_layout.layout, number, placed_layout.bits)
        crc_length_in_bytes = crc.width // 8
        return bits_in_crc_order(crc, data[:-crc_length_in_bytes])
    lowest_bit, bit_count = placed_layout.covered_lowest_bit_and_width
    mask = (1 << bit_count) - 1
    return (number >> lowest_bit) & mask, bit_count


Values = Mapping[str, "int | str | bool"]


class EncodeError(ValueError):
    """A value is missing, unknown, or does not fit its field."""


def number_of_text(text: str) -> int:
    """Return the bits of a text field as one number. Characters outside Latin-1 become question marks."""
    return int.from_bytes(text.encode("latin-1", "replace"), "big")


def value_and_meaning(field: Field, field_bits: int, width: int) -> tuple[int | str | bool, str]:
    """Return the value that the bits of a field represent, and its meaning, such as ``("ready", "encoder is ready")``.

    ``field_bits`` are the bits as a number. It is the value if the field has named values but none for this number.
    """
    match field.kind:
        case Number() as number:
            return signed_or_plain(number, field_bits, width), field.meaning
        case Flag() as flag:
            is_active = bool(field_bits) != flag.active_low
            meaning_of_state = flag.when_active if is_active else flag.when_inactive
            return is_active, meaning_of_state or field.meaning
        case Choice(named_values):
            for named_value in named_values:
                if named_value.value == field_bits:
                    return named_value.name, named_value.meaning or field.meaning
            return field_bits, field.meaning
        case Text():
            return field_bits.to_bytes(width // 8, "big").decode("latin-1"), field.meaning
        case Constant() | Decimal() | Unused() | CrcValue() | Parity():
            return field_bits, field.meaning
        case _ as kind:
            assert_never(kind)


def signed_or_plain(number: Number, field_bits: int, width: int) -> int:
    """Return the number that ``width`` bits represent: 0b111 is -1 in a signed field of 3 bits, and otherwise 7.

    ``zero_means`` is the number that the bits 0 represent, which is 0 in most fields.
    """
    sign_bit = field_bits >> (width - 1)
    if number.signed and sign_bit:
        return field_bits - (1 << width)
    return number.zero_means if field_bits == 0 else field_bits


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
    field_bits = 0 if value == number.zero_means else value & placed_field.mask
    if signed_or_plain(number, field_bits, placed_field.width) != value:
        raise EncodeError(frame_texts.too_wide_message(placed_field.name, f"{value}", f"{placed_field.width}"))
    if number.power_of_two and value.bit_count() != 1:
        raise EncodeError(frame_texts.no_power_of_two_message(placed_field.name, f"{value}"))
    return field_bits


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
