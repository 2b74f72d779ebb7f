"""Expressions that extract the bits of fields, and the unused bits of a layout.

In bytes, each bit stays at its place in its byte, so that only whole bytes are shifted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ...model import BitSlice, Digits, Field, first_or_raise
from ...model.record import dataclass
from ...plan.codec import LayoutPlan, ShiftedBits, moved_bits
from ...plan.operations import FieldBits, JoinedNumber, Reserved
from .names import (
    CCall,
    CCast,
    CExpression,
    CName,
    CNumber,
    COperation,
    ParameterSpelling,
    join_operands,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)


def of_bytes(bit_slices: tuple[BitSlice, ...]) -> tuple[str, CExpression]:
    """Return the type and the bits in these pieces of ``bytes``, as one number.

    For one slice, this is ``uint8_t`` and ``(uint8_t)(bytes[1] >> 4)``. Without slices, when no order code has such
    bits, the number is 0.
    """
    if not bit_slices:
        return unsigned(1), CNumber(0)
    # The mask of a piece begins at bit 0, so that its length is the number of bits.
    width = sum(bit_slice.mask.bit_length() for bit_slice in bit_slices)
    type_ = unsigned(width)
    if len(bit_slices) == 1:
        bits = _bits_of_piece(bit_slices[0])
        is_whole_byte = isinstance(bits, CName)
        return type_, bits if is_whole_byte else CCast("uint8_t", bits)
    # Bytes are shifted in a type that is not promoted to a signed one.
    shifted_type = "uint64_t" if width > 32 else "uint32_t"
    shifted_pieces: list[CExpression] = []
    for bit_slice in bit_slices:
        shifted_pieces.append(shifted_left(CCast(shifted_type, _bits_of_piece(bit_slice)), bit_slice.low_in_number))
    number = join_operands("|", tuple(shifted_pieces))
    return type_, number if type_ == shifted_type else CCast(type_, number)


def _bits_of_piece(bit_slice: BitSlice) -> CExpression:
    """Return the bits of a byte that belong to a field, shifted to bit 0, such as ``(bytes[2] >> 3) & 0x07U``."""
    shifted_byte = shifted_right(CName(f"bytes[{bit_slice.byte}]"), bit_slice.low_in_byte)
    # Without bits above the piece, no mask is needed.
    reaches_top = bit_slice.low_in_byte + bit_slice.mask.bit_length() == 8
    return shifted_byte if reaches_top else masked(shifted_byte, bit_slice.mask)


@dataclass(frozen=True)
class BitReader:
    """Expressions that extract the fields of a layout: from the word if there is one, otherwise from the bytes."""

    plan: LayoutPlan
    scope: ParameterSpelling
    #: Number of bits in the type of the word that a decoder takes.
    word_size: int = 64
    #: Whether the bits are those of the word as sent, rather than those after the conversion of Gray code.
    as_sent: bool = False

    @property
    def encoded_type(self) -> str:
        """The type in which an encoder assembles the word.

        The runtime converts Gray code and digits, and masks fields whose width depends on the order code, in 64 bits.
        """
        needs_64_bits = self.word_size > 32 or self.plan.is_converted or self.plan.depends
        return "uint64_t" if needs_64_bits else "uint32_t"

    @property
    def word(self) -> CExpression:
        """The word, with any Gray code and digits in it converted unless the reader is for the bits ``as_sent``."""
        return CName("plain" if self.plan.is_converted and not self.as_sent else "word")

    def value(self, bits: FieldBits) -> tuple[str, CExpression]:
        """Return the type and the bits of a field, such as ``uint16_t`` and ``(uint16_t)(word >> 6)``."""
        if not self.plan.by_word:
            return of_bytes(bits.bit_slices)
        type_ = unsigned(bits.widest)
        if bits.are_fixed and bits.width.constant == 64:
            return type_, self.word
        number = self.in_word(bits)
        # At a place that depends on the order code, the bits have 64 bits, the type of more than 32 of them.
        has_64_bits = bits.widest > 32 and not bits.are_fixed
        return type_, number if has_64_bits else CCast(type_, number)

    def in_word(self, bits: FieldBits) -> CExpression:
        """Return bits of the word, shifted to bit 0, such as ``((uint32_t)word >> 6) & 0xFFFU``.

        If their place is fixed and in the lower half, the number has 32 bits. At a place that depends on the order
        code, ``cw_field`` extracts them, or if no bits are above them, a shift or ``cw_above``.
        """
        if bits.are_fixed:
            low = bits.low.constant
            width = bits.width.constant
            mask = (1 << width) - 1
            return masked(shifted_right(self.lower(low + width), low), mask)
        if not bits.on_top:
            low_and_width = (self.scope.expression_of(bits.low), self.scope.expression_of(bits.width))
            return CCall("cw_field", (self.word, *low_and_width))
        # No bits are above it: the length has been checked.
        if bits.low.is_constant:
            return shifted_right(self.lower(self.word_size), bits.low.constant)
        return CCall("cw_above", (self.word, self.scope.expression_of(bits.low)))

    def flag(self, bits: FieldBits) -> CExpression:
        """Return the bit of a flag at its position: ``word & 0x80U``, or in a frame of bytes ``flags & 0x80U``.

        ``flags`` is the local for the byte. A flag at a place that depends on the order code is shifted to bit 0.
        """
        if not self.plan.by_word:
            (bit_slice,) = bits.bit_slices
            return masked(CName("flags"), bit_slice.mask << bit_slice.low_in_byte)
        if not bits.are_fixed:
            return self.in_word(bits)
        return masked(self.lower(bits.low.constant + 1), 1 << bits.low.constant)

    def lower(self, high: int) -> CExpression:
        """Return the word, or its lower half ``(uint32_t)word`` if the bits below ``high`` are enough.

        Operations in 32 bits are faster on small processors. A word that has only 32 bits needs no cast.
        """
        # A word is converted in 64 bits.
        has_32_bits = self.word_size == 32 and not self.plan.is_converted
        is_lower_half_enough = high <= 32
        return CCast("uint32_t", self.word) if is_lower_half_enough and not has_32_bits else self.word

    def number_of_join(self, joined_number: JoinedNumber, name_of: Callable[[Field], CExpression]) -> CExpression:
        """Return a join as one number: from the word if its fields are adjacent, otherwise from its fields by name."""
        if joined_number.bits is None:
            return self.number_from_fields(joined_number, name_of)
        number = self.in_word(joined_number.bits)
        return number if joined_number.widest > 32 else CCast(unsigned(joined_number.widest), number)

    def number_from_fields(self, joined_number: JoinedNumber, name_of: Callable[[Field], CExpression]) -> CExpression:
        """Return the fields of a join as one number of the join's type. The first field forms the highest bits."""
        highest_field, *lower_fields = joined_number.fields
        type_ = unsigned(joined_number.widest)
        is_short = size_of(joined_number.widest) < 32
        # Several operands below 32 bits would make the result signed.
        is_promoted = is_short and len(lower_fields) > 1
        number: CExpression = CCast("uint32_t" if is_promoted else type_, name_of(highest_field))
        for field in lower_fields:
            shifted_number = shifted_left(number, self.scope.expression_of(field.width))
            number = COperation("|", (shifted_number, name_of(field)))
        return CCast(type_, number) if is_short and lower_fields else number

    @property
    def before_conversion(self) -> BitReader:
        """The reader of the word before any Gray code in it is converted."""
        return replace(self, as_sent=True)

    def bits_as_sent(self, field: Field) -> CExpression:
        """Return the bits of a field before any Gray code in the word is converted."""
        _, bits = self.before_conversion.value(self.plan.bits_of(field.name))
        return bits

    def parity_as_sent(self, fields: Sequence[Field], mask: int) -> CExpression:
        """Return the parity of fields before any Gray code in the word is converted."""
        return self.parity([(self.bits_as_sent(field), field.widest) for field in fields], mask)

    def parity(self, numbers_and_widths: Sequence[tuple[CExpression, int]], mask: int) -> CExpression:
        """Return the common parity of these numbers, 1 for an odd number of ones. Each comes with its largest width.

        ``mask`` is the mask of the bits that count, or 0 if all of them count.
        """
        numbers = [number for number, _ in numbers_and_widths]
        widest = max(width for _, width in numbers_and_widths)
        combined = numbers[0]
        if len(numbers) > 1:
            type_ = unsigned(max(widest, 32))
            combined = COperation("^", tuple(CCast(type_, number) for number in numbers))
        if mask:
            combined = masked(combined, mask)
        if widest > 32:
            # The parity of a number equals the parity of its halves XORed, and the runtime takes 32 bits.
            lower_half = CCast("uint32_t", combined)
            upper_half = CCast("uint32_t", shifted_right(combined, 32))
            combined = COperation("^", (lower_half, upper_half))
        return CCall("cw_parity", (combined,))


def digits(number: object, field: Field, digit_run: Digits) -> CExpression:
    """Return a run of decimal digits extracted from a number, such as ``(number / 100U) % 10U``."""
    quotient: CExpression = CName(str(number))
    if digit_run.divisor > 1:
        quotient = COperation("/", (quotient, CNumber(digit_run.divisor)))
    # No digits are above the highest run, so that it needs no remainder.
    is_highest_run = digit_run is field.runs[0]
    return quotient if is_highest_run else COperation("%", (quotient, CNumber(digit_run.modulus)))


_UNUSED_MEMBER = CName("in->unused")


class UnusedMember:
    """The member ``unused`` of a struct. The object is false if the layout has no unused bits."""

    def __init__(self, reader: BitReader) -> None:
        self.reader = reader
        self.plan = reader.plan
        self.width = self.plan.layout.unused_width
        are_fixed = all(reserved.bits.are_fixed for reserved in self.plan.reserved)
        #: Unused fields that are extracted one by one: all of them if the place of a field depends on the order code.
        self.single = () if are_fixed else self.plan.reserved
        #: Otherwise all unused bits, grouped by the distance between their places in the frame and in the member.
        self.moved = moved_bits(self.plan) if are_fixed else ()

    def __bool__(self) -> bool:
        return bool(self.plan.reserved)

    @property
    def type(self) -> str:
        return unsigned(self.width)

    @property
    def depends(self) -> bool:
        """True if an encoder needs the variant for it."""
        return bool(self.single)

    # -- decoding

    @property
    def member(self) -> CExpression:
        """The member: 1 in each bit that differs from the manual.

        The bits come from the word, or from bytes if the fields are extracted one by one.
        """
        # Either ``moved`` or ``single`` is empty.
        all_bits = (*map(self._moved_bits, self.moved), *map(self._single_bits, self.single))
        # The values have no common bits. Bits of single fields are already inverted in ``_single_bits``.
        documented = _express_documented_value(sum(moved.value for moved in self.moved))
        return CCast(self.type, _with_inverted(join_operands("|", all_bits), documented))

    def at_place(self, moved: ShiftedBits, byte: CExpression) -> CExpression:
        """Return a byte shifted to the place of its bits in the member, such as ``(uint32_t)bytes[2] << 8``."""
        # In bytes, ``shift`` is 0 or negative: the place in the member is never lower than in the byte.
        return shifted_left(CCast(self.work_type, byte), -moved.shift) if moved.shift else byte

    def member_from(self, bits: CExpression) -> CExpression:
        """Return the member from bytes that ``at_place`` has shifted, with all other bits masked off."""
        mask = sum(moved.mask for moved in self.moved)
        documented = _express_documented_value(sum(moved.value for moved in self.moved))
        differing_bits = _with_inverted(masked(bits, mask), documented)
        return differing_bits if self.type == self.work_type else CCast(self.type, differing_bits)

    @property
    def work_type(self) -> str:
        """The type in which a decoder assembles bytes."""
        return unsigned(max(self.width, 32))

    def _moved_bits(self, moved: ShiftedBits) -> CExpression:
        """Return bits of the word, shifted to their places in the member."""
        # The mask is in the position of the member. Bit 0 of the member is bit ``shift`` of the word.
        word = self.reader.lower(moved.mask.bit_length() + moved.shift)
        if moved.shift >= 0:
            return masked(shifted_right(word, moved.shift), moved.mask)
        return shifted_left(masked(word, moved.mask >> -moved.shift), -moved.shift)

    def _single_bits(self, reserved: Reserved) -> CExpression:
        """Return the bits of one unused field that differ from the manual, shifted to their place in the member."""
        _, bits = self.reader.value(reserved.bits)
        documented = self._express_documented(reserved)
        if not reserved.place:
            return _with_inverted(bits, documented)
        differing_bits = _with_inverted(CCast(self.work_type, bits), documented)
        if not reserved.bits.width.is_constant:
            # The mask of a variable width has 64 bits.
            differing_bits = CCast(self.work_type, differing_bits)
        return shifted_left(differing_bits, reserved.place)

    # -- encoding

    @property
    def refusal_condition(self) -> CExpression | None:
        """The condition that the member has a bit other than the unused ones, or None if that is not possible.

        It is not possible if the unused bits fill the type of the member, or if there are none.

        If the width of fields depends on the order code, this is ``(in->unused & mask) != in->unused``.
        """
        fixed_mask = sum(reserved.mask for reserved in self.plan.reserved if reserved.bits.width.is_constant)
        varying_fields = [reserved for reserved in self.single if not reserved.bits.width.is_constant]
        if not varying_fields:
            all_bits_of_type = (1 << size_of(self.width)) - 1
            other_bits = fixed_mask ^ all_bits_of_type
            can_have_other_bits = bool(fixed_mask and other_bits)
            return COperation("!=", (masked(_UNUSED_MEMBER, other_bits), CNumber(0))) if can_have_other_bits else None
        masks: list[CExpression] = []
        for reserved in varying_fields:
            mask_of_width = self.reader.scope.mask(reserved.bits.width)
            masks.append(shifted_left(mask_of_width, reserved.place))
        if fixed_mask:
            masks.append(CNumber(fixed_mask, hexadecimal=True))
        unused_bits_of_member = COperation("&", (_UNUSED_MEMBER, join_operands("|", tuple(masks))))
        return COperation("!=", (unused_bits_of_member, _UNUSED_MEMBER))

    @property
    def in_word(self) -> Iterator[CExpression]:
        """The terms of a word that come from it: the documented bits, with those inverted that are 1 in the member."""
        # A single group of bits is the whole member, and needs no mask.
        is_all = len(self.moved) + len(self.single) == 1
        for moved in self.moved:
            differing_bits = _UNUSED_MEMBER if is_all else masked(_UNUSED_MEMBER, moved.mask)
            bits = _with_inverted(differing_bits, _express_documented_value(moved.value))
            # Bit 0 of the member is bit ``shift`` of the word.
            yield _shift_bits(CCast(self.reader.encoded_type, bits), -moved.shift)
        for reserved in self.single:
            if is_all:
                bits = _with_inverted(_UNUSED_MEMBER, self._express_documented(reserved))
            else:
                bits = self._bits_to_send(reserved)
            low = reserved.bits.low
            distance = low.constant if low.is_constant else self.reader.scope.expression_of(low)
            yield shifted_left(CCast(self.reader.encoded_type, bits), distance)

    @property
    def in_bytes(self) -> Iterator[tuple[int, CExpression]]:
        """The bytes with bits that come from it, each with these bits at their places."""
        for moved in self.moved:
            assert moved.byte is not None
            yield moved.byte, self._moved_bits_to_send(moved)
        for reserved in self.single:
            for bit_slice in reserved.bits.bit_slices:
                bits = shifted_right(self._bits_to_send(reserved), bit_slice.low_in_number)
                yield bit_slice.byte, _shift_bits(_masked_byte(bits, bit_slice.mask), -bit_slice.low_in_byte)

    def _moved_bits_to_send(self, moved: ShiftedBits) -> CExpression:
        """Return bits of the member, shifted to their places in the frame and combined with the documented bits."""
        # In bytes, ``shift`` is 0 or negative: bit -shift of the member is bit 0 of the byte.
        bit_in_member = -moved.shift
        bits = _masked_byte(shifted_right(_UNUSED_MEMBER, bit_in_member), moved.mask >> bit_in_member)
        # The member itself, if it was neither shifted nor masked.
        is_wider_than_byte = bits is _UNUSED_MEMBER and self.width > 8
        if is_wider_than_byte:
            bits = CCast("uint8_t", bits)
        return _with_inverted(bits, _express_documented_value(moved.value >> bit_in_member))

    def bits_of(self, field: Field) -> CExpression:
        """Return the bits to send for one unused field, shifted to bit 0."""
        reserved_fields = (reserved for reserved in self.plan.reserved if reserved.field is field)
        return self._bits_to_send(first_or_raise(reserved_fields, f"unused field '{field.name}'"))

    def _bits_to_send(self, reserved: Reserved) -> CExpression:
        """Return the documented bits of an unused field at bit 0, with those inverted that are 1 in the member."""
        differing_bits = shifted_right(masked(_UNUSED_MEMBER, reserved.mask), reserved.place)
        return _with_inverted(differing_bits, self._express_documented(reserved))

    # -- both

    def _express_documented(self, reserved: Reserved) -> CExpression | None:
        """Return the value in the manual of a field that may be narrower with this order code, or None if it is 0."""
        value = _express_documented_value(reserved.value)
        width = reserved.bits.width
        if value is None or width.is_constant:
            return value
        return COperation("&", (value, self.reader.scope.mask(width)))


def _masked_byte(bits: CExpression, mask: int) -> CExpression:
    """Return these bits of a number. A whole byte has no mask, because a later cast drops the higher bits."""
    return bits if mask == 0xFF else masked(bits, mask)


def _express_documented_value(value: int) -> CExpression | None:
    """Return the value in the manual, or None if that is 0."""
    return CNumber(value, hexadecimal=True) if value else None


def _with_inverted(bits: CExpression, inverted: CExpression | None) -> CExpression:
    """Return the bits, with those inverted that are 1 in ``inverted``."""
    return COperation("^", (bits, inverted)) if inverted is not None else bits


def _shift_bits(bits: CExpression, distance: int) -> CExpression:
    """Return ``bits`` shifted to the right, or to the left if ``distance`` is negative."""
    return shifted_left(bits, -distance) if distance < 0 else shifted_right(bits, distance)
