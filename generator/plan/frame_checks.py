"""Positions of fields, and the checks that a decoder makes: constants, parity bits, valid values, and ranges."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import BitSlice, Device, Field, Layout
from ..model.expressions import Expression
from ..model.kinds import Constant, Parity
from .operations import (
    AlwaysIs,
    Check,
    FieldBits,
    IsBetween,
    IsOneOf,
    NotAbove,
    ParityIs,
    ZerosAbove,
    checks_of_meaning,
)


def fixed_selector(layout: Layout) -> Field | None:
    """Return the selector, the field that identifies the frame, if it has the same value in all frames of this layout.

    Return None if the layout has no selector, or a selector with several valid values.
    """
    return layout.field(layout.selector) if len(layout.selects) == 1 else None


def only_value(layout: Layout, field: Field) -> int | None:
    """Return the only value of a constant or of a selector with one value, or None for any other field."""
    if isinstance(field.kind, Constant):
        return field.kind.value
    is_fixed_selector = field is fixed_selector(layout)
    return layout.selects[0] if is_fixed_selector else None


def bits_of(layout: Layout, field: Field) -> FieldBits:
    """Return the position of a field's bits. Bytes that contain only the padding of the field are omitted."""
    bit_slices = field.bit_slices
    is_padded = bool(field.container)
    if is_padded:
        bit_slices = tuple(bit_slice for bit_slice in bit_slices if bit_slice.low_in_number < field.widest)
    return locate_bits(layout, field.low, field.width, widest=field.widest, bit_slices=bit_slices)


def locate_bits(
    layout: Layout, low: Expression, width: Expression, widest: int, bit_slices: tuple[BitSlice, ...] = ()
) -> FieldBits:
    """Return the position of ``width`` bits, starting at bit ``low``.

    ``on_top`` is true if the layout is sent as bits and has no bits above these.
    """
    bits_above = layout.bits - low - width
    on_top = not layout.in_bytes and bits_above == Expression(0)
    return FieldBits(low, width, widest=widest, has_no_bits_above=on_top, bit_slices=bit_slices)


def checks_of_layout(device: Device, layout: Layout, by_word: bool) -> Iterator[Check]:
    """Yield the checks of all fields of a frame or register, in the order in which a decoder makes them.

    ``by_word`` is true if the frame is processed as one number, and false if its bytes are processed one by one.
    """
    yield from _checks_of_constants_and_parity(layout, by_word)
    yield from _checks_of_values(layout)
    yield from _checks_of_numbers(device, layout)


def _checks_of_constants_and_parity(layout: Layout, by_word: bool) -> Iterator[Check]:
    """Yield the checks of constants and parity bits, in the order of the fields.

    If ``by_word`` is false, the frame is processed byte by byte, and zeros that pad a field are checked together with
    this field.
    """
    for field in layout.fields:
        match field.kind:
            case Constant(padding_of=padded_name) if padded_name and not by_word:
                yield _zeros_above(layout, layout.field(padded_name), padding=field)
            case Constant(value=number):
                yield AlwaysIs(field, bits_of(layout, field), number)
            case Parity() as parity_kind:
                yield _parity_check(layout, field, parity_kind)


def _zeros_above(layout: Layout, padded_field: Field, padding: Field) -> ZerosAbove:
    """Return the check that the padding above a field is 0.

    Some bytes of the padding can also contain bits of the field, and others contain only padding.
    """
    # ``bits`` omits the bytes that contain only padding.
    bits = bits_of(layout, padded_field)
    bytes_of_padding = tuple(bit_slice for bit_slice in padded_field.bit_slices if bit_slice not in bits.bit_slices)
    return ZerosAbove(padded_field, padding, bits, bytes_of_padding)


def _parity_check(layout: Layout, parity_bit: Field, parity_kind: Parity) -> ParityIs:
    """Return the check that a parity bit matches the fields that it covers."""
    covered_fields = tuple(layout.field(name) for name in parity_kind.of)
    covered_bits = tuple(bits_of(layout, covered_field) for covered_field in covered_fields)
    return ParityIs(
        field=parity_bit,
        bits=bits_of(layout, parity_bit),
        covered_fields=covered_fields,
        covered_bits=covered_bits,
        odd=parity_kind.odd,
        mask=parity_mask(parity_kind, covered_fields),
        known_parity=known_parity(layout, parity_bit, covered_fields, parity_kind),
    )


def _checks_of_values(layout: Layout) -> Iterator[Check]:
    """Yield a check for each field whose bits can contain values that are not valid.

    These are fields with named values, selectors, and decimal digits.
    """
    for field in layout.fields:
        bits = bits_of(layout, field)
        valid_values = allowed_values(layout, field)
        if valid_values:
            yield IsOneOf(field, bits, valid_values)
        yield from checks_of_meaning(field, bits)


def _checks_of_numbers(device: Device, layout: Layout) -> Iterator[Check]:
    """Yield the checks that numbers are in their range, if the bits could contain numbers outside it.

    These numbers are the position in one field, and numbers whose digits are sent separately, such as BCD.
    """
    position_range = device.range_in(layout)
    position_field = position_range.field if position_range is not None else None
    if position_range is not None and position_field is not None:
        position_bits = bits_of(layout, position_field)
        highest = position_range.highest
        if position_field.number.signed:
            yield IsBetween(position_field, position_bits, lowest=position_range.lowest, highest=highest)
        elif not position_field.kind.digit_code:
            yield NotAbove(position_field, position_bits, highest)
    for field in layout.fields:
        code = field.code_of_digits
        if code is not None:
            highest = Expression(code.highest(field.widest))
            if position_range is not None and position_field is field:
                highest = position_range.highest
            yield NotAbove(field, bits_of(layout, field), highest, code.name)


def allowed_values(layout: Layout, field: Field) -> tuple[int, ...]:
    """Return the valid values of a field: the values of a selector that identify this frame, or all named values.

    The tuple is empty if every number that fits in the bits is valid.
    """
    if field.name == layout.selector:
        valid_values = dict.fromkeys(layout.selects)
    else:
        valid_values = dict.fromkeys(named_value.value for named_value in field.values)
    # Each value fits in the bits, so it is enough to compare how many there are.
    numbers_that_fit = 1 << field.widest
    are_all_valid = field.width.is_constant and len(valid_values) == numbers_that_fit
    return () if are_all_valid else tuple(valid_values)


def known_parity(
    layout: Layout, parity_bit: Field, covered_fields: tuple[Field, ...], parity_kind: Parity
) -> int | None:
    """Return the value of a parity bit that is the same in every frame of this layout, or None if it can vary.

    It is the same if it covers a single field that always has the same value, and if all order codes have the bit.
    """
    if len(covered_fields) != 1 or not parity_bit.width.is_constant:
        return None
    covered_value = only_value(layout, covered_fields[0])
    if covered_value is None:
        return None
    return parity(covered_value & parity_kind.mask, parity_kind.odd)


def parity_mask(parity_kind: Parity, fields: tuple[Field, ...]) -> int:
    """Return the mask of the bits of each field that count toward a parity bit, such as 0b1010, or 0 if all bits count.

    The key ``over`` of the spec selects odd or even bits. The mask is not wider than the widest of the fields.
    """
    if not parity_kind.over:  # All bits count.
        return 0
    widest = max(field.widest for field in fields)
    mask_of_widest = (1 << widest) - 1
    return parity_kind.mask & mask_of_widest


def parity(number: int, odd: bool) -> int:
    """Return the parity bit of a number. With this bit, the number of ones is odd if ``odd`` is true, else even."""
    return (number.bit_count() & 1) ^ odd
