"""Plans for decoding and encoding layouts: positions of fields, checks, and sources of the bits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

from ..model import Alternative, BitSlice, Device, Fault, Field, Layout
from ..model.expressions import Expression
from ..model.kinds import Constant, CrcValue, Flag, Parity, Text, Unused
from ..model.record import dataclass
from .crcs import checks_whole_words, fold_steps, is_checked_by_division
from .operations import (
    AlwaysIs,
    Check,
    ConstantNumber,
    DigitCoding,
    FieldBits,
    FieldToDecode,
    FieldToEncode,
    FrameCrc,
    Gray,
    IsBetween,
    IsOneOf,
    JoinedNumber,
    NotAbove,
    ParityIs,
    ParityOf,
    Reserved,
    ReservedBits,
    ValueOfField,
    ZerosAbove,
    checks_of_meaning,
)


@dataclass(frozen=True)
class LayoutPlan:
    """The plan of a layout.

    ``by_word`` is true if the frame is processed as one number, because it is sent as bits, the order code moves its
    fields, or Gray code must be converted first. Otherwise its bytes are processed one by one. ``alternatives`` are the
    questions whose answers the caller must pass.
    """

    layout: Layout
    by_word: bool
    length: int
    selector: Field | None
    crcs: tuple[FrameCrc, ...]
    gray: Gray | None
    digit_codings: tuple[DigitCoding, ...]
    parts: tuple[FieldToDecode, ...]
    joined_numbers: tuple[JoinedNumber, ...]
    alternatives: tuple[Alternative, ...]
    reserved: tuple[Reserved, ...]
    checks: tuple[Check, ...]
    terms: tuple[FieldToEncode, ...]

    @property
    def keeps_others(self) -> bool:
        """True if bits outside all fields are kept: register bits that the manual does not define."""
        return self.layout.gaps == "unspecified" and not self.layout.sender

    @property
    def in_bytes(self) -> bool:
        return self.layout.in_bytes

    @property
    def only_crc(self) -> FrameCrc | None:
        """The CRC of all order codes. None without a CRC, or if only some order codes have it."""
        return next((crc for crc in self.crcs if not crc.is_optional), None)

    @property
    def is_converted(self) -> bool:
        """True if bits of the frame are converted before it is read: from Gray code, or from digits."""
        return self.gray is not None or bool(self.digit_codings)

    @property
    def keeps_sent_bits(self) -> bool:
        """True if a decoder in Python needs converted bits as they were sent: for a parity bit, or for a message."""
        return self.parity_covers_converted or bool(self.digit_codings)

    @cached_property
    def parity_covers_converted(self) -> bool:
        """True if a parity bit covers converted bits. It is the parity of the bits as they are sent."""
        gray_names = self.layout.names_in(self.layout.gray_of)
        parities = (check for check in self.checks if isinstance(check, ParityIs))
        return any(field.name in gray_names or field.number.digit_code for parity in parities for field in parity.of)

    @cached_property
    def constants(self) -> Mapping[str, int]:
        """Values of the fields that always have the same bits, by name, including the zeros that pad other fields."""
        constants = {check.field.name: check.value for check in self.checks if isinstance(check, AlwaysIs)}
        return constants | {check.padding.name: 0 for check in self.checks if isinstance(check, ZerosAbove)}

    @cached_property
    def depends(self) -> bool:
        """True if any position or width, the Gray code, or the range of positions depends on the order code."""
        if self.gray is not None and self.gray.when:
            return True
        expressions = [self.layout.bits]
        for field in self.layout.fields:
            expressions += [field.low, field.width]
        for check in self.checks:
            if isinstance(check, NotAbove):
                expressions.append(check.highest)
            elif isinstance(check, IsBetween):
                expressions += [check.lowest, check.highest]
        if self.gray is not None:
            expressions.append(self.gray.excess)
        # All answers to a question set the same parameters, which the caller passes.
        answered_names = {name for alternative in self.alternatives for name in alternative.answers[0].sets}
        return any(not answered_names.issuperset(expression.parameters) for expression in expressions)

    @property
    def from_low(self) -> range:
        """Indices of the bytes in the frame, least significant byte first: 0, 1, 2 if the low byte is sent first."""
        return range(self.length) if self.layout.byte_order == "low_byte_first" else range(self.length - 1, -1, -1)

    def faults(self) -> tuple[Fault, ...]:
        """Return the errors that a decoder of this layout can find, in the order of ``Fault``. It checks the length."""
        faults = {Fault.LENGTH, *(check.fault for check in self.checks)}
        if self.crcs:
            faults.add(Fault.CRC)
        return tuple(fault for fault in Fault if fault in faults)

    def bits_of(self, name: str) -> FieldBits:
        return bits_of(self.layout, self.layout.field(name))


def layout_plan_of(device: Device, layout: Layout) -> LayoutPlan:
    """Return the plan for a layout of a frame or of a register's bytes, see ``LayoutPlan``."""
    # The bytes of a field are unknown if the order code moves its bits.
    all_have_bytes = all(field.bit_slices or field.padding_of for field in layout.fields)
    by_word = not layout.in_bytes or not all_have_bytes or layout.is_converted
    return LayoutPlan(
        layout=layout,
        by_word=by_word,
        length=layout.widest // 8,
        selector=fixed_selector(layout),
        crcs=tuple(_plan_crc(device, layout, field) for field in layout.crc_fields),
        gray=_find_gray(layout),
        digit_codings=tuple(_yield_digit_codings(layout)),
        parts=tuple(_yield_parts(layout)),
        joined_numbers=tuple(_yield_joined_numbers(layout, by_word)),
        alternatives=device.alternatives_of(layout),
        reserved=tuple(_yield_reserved(layout)),
        checks=(
            *_checks_of_constants_and_parity(layout, by_word),
            *_checks_of_values(layout),
            *_checks_of_numbers(device, layout),
        ),
        terms=tuple(_yield_terms(layout)),
    )


def _yield_parts(layout: Layout) -> Iterator[FieldToDecode]:
    """Yield the fields with data, except a fixed selector. Parts that a join or a parity bit also uses are shared."""
    shared_names = {name for join in layout.joins for name in join.fields}
    for field in layout.fields:
        if isinstance(field.kind, Parity):
            shared_names.update(field.kind.of)
    selector = fixed_selector(layout)
    for field in layout.fields:
        if field.carries_data and field is not selector:
            yield FieldToDecode(field, bits_of(layout, field), shared=field.name in shared_names)


def _yield_reserved(layout: Layout) -> Iterator[Reserved]:
    """Yield the unused fields, each with the position of its lowest bit in the decoder's number ``unused``."""
    for field, bit_in_unused in layout.unused:
        documented_value = field.kind.value if isinstance(field.kind, Unused) else 0
        yield Reserved(field, bits_of(layout, field), documented_value, bit_in_unused)


def fixed_selector(layout: Layout) -> Field | None:
    """Return the selector if a single value of it identifies the frame, or None."""
    return layout.field(layout.selector) if len(layout.selects) == 1 else None


def only_value(layout: Layout, field: Field) -> int | None:
    """Return the only value of a constant or of a selector with one value, or None for any other field."""
    if isinstance(field.kind, Constant):
        return field.kind.value
    return layout.selects[0] if field is fixed_selector(layout) else None


def bits_of(layout: Layout, field: Field) -> FieldBits:
    """Return the bits of a field. In bytes, a padded field has no pieces for bytes that contain only padding."""
    bit_slices = tuple(
        bit_slice for bit_slice in field.bit_slices if not field.container or bit_slice.low_in_number < field.widest
    )
    return _locate_bits(layout, field.low, field.width, field.widest, bit_slices)


def _locate_bits(
    layout: Layout, low: Expression, width: Expression, widest: int, bit_slices: tuple[BitSlice, ...] = ()
) -> FieldBits:
    """Return ``width`` bits, starting at ``low``. The bits are on top if a frame of bits has none above them."""
    bits_above = layout.bits - low - width
    on_top = not layout.in_bytes and bits_above == Expression(0)
    return FieldBits(low, width, widest, on_top, bit_slices)


def _plan_crc(device: Device, layout: Layout, field: Field) -> FrameCrc:
    """Return the check of a CRC. It covers the fields from the first to the last in ``of``, or else all before it."""
    assert isinstance(field.kind, CrcValue)
    crc = device.crc(field.kind.crc)
    # A CRC that only some order codes have is at the end of their frames.
    bits = bits_of(layout, field) if field.width.is_constant else _bits_at_end(layout, crc.width)
    if field.kind.of:
        # From the most significant field to the least significant one.
        first_covered = layout.field(field.kind.of[0])
        last_covered = layout.field(field.kind.of[-1])
        return FrameCrc(
            crc=crc,
            field=field,
            bits=bits,
            covered=first_covered.low + first_covered.width - last_covered.low,
            low=last_covered.low.constant,
            is_part=True,
            divides=False,
            steps=(),  # Only a CRC of the whole frame has steps.
        )
    is_of_whole_words = checks_whole_words(device, crc)
    return FrameCrc(
        crc=crc,
        field=field,
        bits=bits,
        covered=layout.bits - Expression(crc.width),
        low=crc.width,
        is_part=False,
        divides=is_of_whole_words and is_checked_by_division(crc, layout),
        steps=fold_steps(crc, layout.widest) if is_of_whole_words else (),
    )


def _bits_at_end(layout: Layout, width: int) -> FieldBits:
    """Return the last ``width`` bits, in bytes with their pieces: a CRC that only some order codes have."""
    low_byte_first = layout.byte_order == "low_byte_first"
    low = layout.bits - Expression(width) if low_byte_first else Expression(0)
    byte_count = layout.widest // 8
    bit_slices = []
    starts_of_bytes = range(0, width, 8) if layout.in_bytes else ()
    for low_in_crc in starts_of_bytes:
        byte = byte_count - (width - low_in_crc) // 8 if low_byte_first else byte_count - 1 - low_in_crc // 8
        bits_in_byte = min(8, width - low_in_crc)
        mask = (1 << bits_in_byte) - 1
        bit_slices.append(BitSlice(byte=byte, low_in_byte=0, mask=mask, low_in_number=low_in_crc))
    return _locate_bits(layout, low, Expression(width), width, tuple(bit_slices))


def _find_gray(layout: Layout) -> Gray | None:
    """Return the bits in Gray code, those of a field or of the adjacent fields of a join, or None if none are."""
    if not layout.gray_of:
        return None
    fields = [layout.field(name) for name in layout.names_in(layout.gray_of)]
    lowest_field = fields[-1]  # The names are in order of significance, most significant first.
    width = sum((field.width for field in fields), Expression(0))
    return Gray(lowest_field.low, width, layout.gray_when, layout.gray_excess or Expression(0))


def _yield_digit_codings(layout: Layout) -> Iterator[DigitCoding]:
    """Yield the numbers whose digits are sent separately."""
    for field in layout.fields:
        code = field.number.code_of_digits
        if code is not None:
            yield DigitCoding(field.low, field.width, code.bits, code.codes)


def _yield_joined_numbers(layout: Layout, by_word: bool) -> Iterator[JoinedNumber]:
    """Yield the numbers formed by several fields. If one shift extracts adjacent fields from a word, set ``bits``."""
    for join in layout.joins:
        fields = tuple(layout.field(name) for name in join.fields)  # most significant first
        total_width = sum((field.width for field in fields), Expression(0))
        # The number needs a type, which has at least 1 bit and at most 64.
        widest = min(sum(field.widest for field in fields) or 1, 64)
        are_adjacent = all(upper.low == lower.low + lower.width for upper, lower in pairwise(fields))
        adjacent_bits = None
        if by_word and are_adjacent:
            lowest_field = fields[-1]
            adjacent_bits = _locate_bits(layout, lowest_field.low, total_width, widest)
        yield JoinedNumber(join=join, fields=fields, width=total_width, widest=widest, bits=adjacent_bits)


def _checks_of_constants_and_parity(layout: Layout, by_word: bool) -> Iterator[Check]:
    """Yield the checks of constants and parity bits in the order of the fields, and therefore of their errors."""
    for field in layout.fields:
        match field.kind:
            # In bytes, padding is checked together with the field that it pads.
            case Constant(padding_of=padded_name) if padded_name and not by_word:
                yield _zeros_above(layout, layout.field(padded_name), padding=field)
            case Constant(value=number):
                yield AlwaysIs(field, bits_of(layout, field), number)
            case Parity() as parity_kind:
                yield _parity_check(layout, field, parity_kind)


def _zeros_above(layout: Layout, padded_field: Field, padding: Field) -> ZerosAbove:
    """Return the check that the bits above a field are 0, in its own bytes and in those that only the padding has."""
    # The slices of ``bits`` lack the bytes that contain only padding.
    bits = bits_of(layout, padded_field)
    bytes_of_padding = tuple(bit_slice for bit_slice in padded_field.bit_slices if bit_slice not in bits.bit_slices)
    return ZerosAbove(padded_field, padding, bits, bytes_of_padding)


def _parity_check(layout: Layout, parity_bit: Field, parity_kind: Parity) -> ParityIs:
    """Return the check of a parity bit."""
    covered_fields = tuple(layout.field(name) for name in parity_kind.of)
    return ParityIs(
        field=parity_bit,
        bits=bits_of(layout, parity_bit),
        of=covered_fields,
        of_bits=tuple(bits_of(layout, covered_field) for covered_field in covered_fields),
        odd=parity_kind.odd,
        mask=_parity_mask(parity_kind, covered_fields),
        known_parity=_known_parity(layout, parity_bit, covered_fields, parity_kind),
    )


def _checks_of_values(layout: Layout) -> Iterator[Check]:
    """Yield the checks of choices and selectors, unless all their values are valid, and of decimal digits."""
    for field in layout.fields:
        bits = bits_of(layout, field)
        valid_values = allowed_values(layout, field)
        if valid_values:
            yield IsOneOf(field, bits, valid_values)
        yield from checks_of_meaning(field, bits)


def _checks_of_numbers(device: Device, layout: Layout) -> Iterator[Check]:
    """Yield the checks of numbers whose fields could hold others: the position, and numbers that are sent as digits."""
    position = device.range_in(layout)
    if position is not None and position.field.number.signed:
        yield IsBetween(position.field, bits_of(layout, position.field), position.lowest, position.highest)
    elif position is not None and not position.field.number.digit_code:
        yield NotAbove(position.field, bits_of(layout, position.field), position.highest)
    for field in layout.fields:
        code = field.number.code_of_digits
        if code is not None:
            highest = Expression(code.highest(field.widest))
            if position is not None and position.field is field:
                highest = position.highest
            yield NotAbove(field, bits_of(layout, field), highest, code.name)


def allowed_values(layout: Layout, field: Field) -> tuple[int, ...]:
    """Return the valid values of a selector or a choice. An empty tuple means that every value is valid."""
    if field.name == layout.selector:
        valid_values = dict.fromkeys(layout.selects)
    else:
        valid_values = dict.fromkeys(named_value.value for named_value in field.values)
    # Each value fits in the bits, so if there are as many values as codes, every code is valid.
    number_of_codes = 1 << field.widest
    has_all_values = field.width.is_constant and len(valid_values) == number_of_codes
    return () if has_all_values else tuple(valid_values)


def _known_parity(
    layout: Layout, parity_bit: Field, covered_fields: tuple[Field, ...], parity_kind: Parity
) -> int | None:
    """Return the parity bit if all order codes have it and it covers a single field with a single value, else None."""
    if len(covered_fields) != 1 or not parity_bit.width.is_constant:
        return None
    covered_value = only_value(layout, covered_fields[0])
    return parity(covered_value & parity_kind.mask, parity_kind.odd) if covered_value is not None else None


def _parity_mask(parity_kind: Parity, fields: tuple[Field, ...]) -> int:
    """Return the mask of the covered bits of each field, no wider than the widest one, or 0 if it covers all."""
    if not parity_kind.over:
        return 0
    widest = max(field.widest for field in fields)
    mask_of_widest = (1 << widest) - 1
    return parity_kind.mask & mask_of_widest


def parity(number: int, odd: bool) -> int:
    """Return the even or odd parity bit of a number: with it, the number of ones is even or odd."""
    return (number.bit_count() & 1) ^ odd


def _yield_terms(layout: Layout) -> Iterator[FieldToEncode]:
    """Yield each field of an encoded frame with the source of its bits. The CRC is computed from all of them later."""
    bit_in_unused_by_name = {field.name: bit_in_unused for field, bit_in_unused in layout.unused}
    for field in layout.fields:
        sent_value: ConstantNumber | ValueOfField | ParityOf | ReservedBits
        match field.kind:
            case CrcValue():
                continue
            case Parity() as parity_kind:
                sent_value = _sent_parity(layout, field, parity_kind)
            case Unused(documented_value):
                sent_value = ReservedBits(documented_value, bit_in_unused_by_name[field.name])
            case _:
                sent_value = _sent_number(layout, field)
        yield FieldToEncode(field, bits_of(layout, field), sent_value)


def _sent_parity(layout: Layout, parity_bit: Field, parity_kind: Parity) -> ConstantNumber | ParityOf:
    """Return the computation of a parity bit, or its value if that never changes."""
    covered_fields = tuple(layout.field(name) for name in parity_kind.of)
    known_bit = _known_parity(layout, parity_bit, covered_fields, parity_kind)
    if known_bit is not None:
        return ConstantNumber(known_bit)
    return ParityOf(covered_fields, parity_kind.odd, _parity_mask(parity_kind, covered_fields))


def _sent_number(layout: Layout, field: Field) -> ConstantNumber | ValueOfField:
    """Return the only value that a field can have, or the field itself if the caller supplies its value."""
    constant = only_value(layout, field)
    return ValueOfField(field) if constant is None else ConstantNumber(constant)


def characters(field: Field) -> tuple[tuple[int, int], ...]:
    """Return each character of a text as the index of the character and the index of its byte: ``((0, 2), (1, 3))``.

    If the characters do not fill whole bytes, or the field is not a text, return an empty tuple.
    """
    fills_whole_bytes = all(bit_slice.low_in_byte == 0 and bit_slice.mask == 0xFF for bit_slice in field.bit_slices)
    if not isinstance(field.kind, Text) or not fills_whole_bytes:
        return ()
    indices = []
    last_index = field.widest // 8 - 1
    for bit_slice in reversed(field.bit_slices):
        bytes_after = bit_slice.low_in_number // 8
        indices.append((last_index - bytes_after, bit_slice.byte))
    return tuple(indices)


def is_plain_flag(part: FieldToDecode) -> bool:
    """Return whether a part is a flag whose bit no join and no parity bit uses."""
    return isinstance(part.field.kind, Flag) and not part.shared


@dataclass(frozen=True, slots=True)
class ShiftedBits:
    """Unused bits with one shift: bit 0 of the member is bit ``shift`` of ``byte``, or of the word if that is None.

    ``mask`` and ``value``, the value in the manual, have the places of the member.
    """

    byte: int | None
    shift: int
    mask: int
    value: int


def moved_bits(layout_plan: LayoutPlan) -> tuple[ShiftedBits, ...]:
    """Return the unused bits whose position is fixed. Fields of a byte or word with the same shift are combined."""
    bits_by_shift: dict[tuple[int | None, int], ShiftedBits] = {}
    for reserved in layout_plan.reserved:
        if not reserved.bits.are_fixed:
            continue
        for bits in _shifted_bits(reserved, layout_plan.by_word):
            byte_and_shift = (bits.byte, bits.shift)
            earlier_bits = bits_by_shift.get(byte_and_shift, bits)
            mask = earlier_bits.mask | bits.mask
            value = earlier_bits.value | bits.value
            bits_by_shift[byte_and_shift] = replace(bits, mask=mask, value=value)
    return tuple(bits_by_shift.values())


def _shifted_bits(reserved: Reserved, by_word: bool) -> Iterator[ShiftedBits]:
    """Yield the bits of an unused field: once for the word or, without ``by_word``, once for each byte."""
    value = reserved.value << reserved.place
    if by_word:
        shift = reserved.bits.low.constant - reserved.place
        yield ShiftedBits(byte=None, shift=shift, mask=reserved.mask, value=value)
        return
    for bit_slice in reserved.bits.bit_slices:
        # Position of the byte's lowest bit in ``unused``. A negative shift moves the bits up.
        bit_in_unused = reserved.place + bit_slice.low_in_number
        mask = bit_slice.mask << bit_in_unused
        yield ShiftedBits(
            byte=bit_slice.byte, shift=bit_slice.low_in_byte - bit_in_unused, mask=mask, value=value & mask
        )
