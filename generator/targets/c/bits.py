"""C expressions for the bits of fields, and for unused bits, in a word or in bytes.

In bytes, each bit stays at its place in its byte, so that only whole bytes are shifted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from ...model import BitSlice, Digits, Field, first_or_raise
from ...model.record import dataclass
from ...plan.codec import LayoutPlan, ShiftedBits, group_reserved_bits_by_shift
from ...plan.operations import AlwaysIs, Check, FieldBits, JoinedNumber, Reserved, ZerosAbove
from ...say.names_and_evidence import name_in_words
from .expressions import (
    CCall,
    CCast,
    CExpression,
    CName,
    CNumber,
    COperation,
    ExpressionTranslator,
    join_operands,
    masked,
    masked_byte,
    shift_bits,
    shifted_left,
    shifted_right,
    type_and_bits_in,
    with_inverted,
)
from .names import size_of, unsigned


@dataclass(frozen=True, slots=True)
class ConstantByte:
    """A byte of a frame with constant bits. ``mask`` selects these bits, and ``value`` is what they must be.

    ``reasons`` are the names of the constant fields in it, for the comment.
    """

    byte: int
    mask: int
    value: int
    reasons: tuple[str, ...]


def constant_bytes(checks: Iterable[Check]) -> list[ConstantByte]:
    """Return the bytes with constant bits, in order, each with the mask and the value of all its constants."""
    byte_by_index: dict[int, ConstantByte] = {}
    for check in checks:
        name = name_in_words(check.field.name)
        match check:
            case ZerosAbove(bytes_beyond_field=slices_beyond):
                for bit_slice in slices_beyond:
                    byte = bit_slice.byte
                    byte_by_index[byte] = ConstantByte(byte, mask=0xFF, value=0, reasons=(f"above {name}",))
            case AlwaysIs(bits=bits, value=constant):
                for bit_slice in bits.bit_slices:
                    byte = bit_slice.byte
                    earlier = byte_by_index.get(byte, ConstantByte(byte, mask=0, value=0, reasons=()))
                    byte_by_index[byte] = _with_constant(earlier, bit_slice, constant, name)
    return [byte_by_index[byte] for byte in sorted(byte_by_index)]


def _with_constant(earlier: ConstantByte, bit_slice: BitSlice, constant: int, name: str) -> ConstantByte:
    """Return a constant byte with the bits of one more constant field: ``bit_slice`` of the number ``constant``."""
    # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
    value_in_byte = ((constant >> bit_slice.low_in_number) & bit_slice.mask) << bit_slice.low_in_byte
    return ConstantByte(
        earlier.byte,
        mask=earlier.mask | (bit_slice.mask << bit_slice.low_in_byte),
        value=earlier.value | value_in_byte,
        reasons=tuple(dict.fromkeys((*earlier.reasons, name))),
    )


@dataclass(frozen=True)
class BitReader:
    """Expressions that extract the fields of a layout: from the word if there is one, otherwise from the bytes."""

    layout_plan: LayoutPlan
    translator: ExpressionTranslator
    #: Number of bits in the type of the word that a decoder takes.
    word_size: int = 64
    #: Whether the bits are those of the word as sent, rather than those after the conversion of Gray code.
    as_sent: bool = False

    @property
    def encoded_type(self) -> str:
        """The type in which an encoder assembles the word.

        The runtime converts Gray code and digits, and masks fields whose width depends on the order code, in 64 bits.
        """
        needs_64_bits = self.word_size > 32 or self.layout_plan.is_converted or self.layout_plan.depends_on_order_code
        return "uint64_t" if needs_64_bits else "uint32_t"

    @property
    def word(self) -> CExpression:
        """The word, with any Gray code and digits in it converted unless the reader is for the bits ``as_sent``."""
        return CName("plain" if self.layout_plan.is_converted and not self.as_sent else "word")

    def type_and_bits(self, bits: FieldBits) -> tuple[str, CExpression]:
        """Return the type and the bits of a field, such as ``uint16_t`` and ``(uint16_t)(word >> 6)``."""
        if not self.layout_plan.by_word:
            return type_and_bits_in(bits.bit_slices)
        type_ = unsigned(bits.widest)
        if bits.are_fixed and bits.width.constant == 64:
            return type_, self.word
        number = self.bits_in_word(bits)
        # At a place that depends on the order code, the bits have 64 bits, the type of more than 32 of them.
        has_64_bits = bits.widest > 32 and not bits.are_fixed
        return type_, number if has_64_bits else CCast(type_, number)

    def bits_in_word(self, bits: FieldBits) -> CExpression:
        """Return bits of the word, shifted to bit 0, such as ``((uint32_t)word >> 6) & 0xFFFU``.

        If their place is fixed and in the lower half, the number has 32 bits. At a place that depends on the order
        code, ``cw_field`` extracts them, or if no bits are above them, a shift or ``cw_above``.
        """
        if bits.are_fixed:
            low = bits.low.constant
            width = bits.width.constant
            if (low, width) == (0, 32):
                return self.word_or_lower_half(32)
            mask = (1 << width) - 1
            return masked(shifted_right(self.word_or_lower_half(low + width), low), mask)
        if not bits.has_no_bits_above:
            low_and_width = (self.translator.to_c(bits.low), self.translator.to_c(bits.width))
            return CCall("cw_field", (self.word, *low_and_width))
        # No bits are above it: the length has been checked.
        if bits.low.is_constant:
            return shifted_right(self.word_or_lower_half(self.word_size), bits.low.constant)
        return CCall("cw_above", (self.word, self.translator.to_c(bits.low)))

    def flag_bit(self, bits: FieldBits) -> CExpression:
        """Return the bit of a flag at its position: ``word & 0x80U``, or in a frame of bytes ``flags & 0x80U``.

        ``flags`` is the local for the byte. A flag at a place that depends on the order code is shifted to bit 0.
        """
        if not self.layout_plan.by_word:
            (bit_slice,) = bits.bit_slices
            return masked(CName("flags"), bit_slice.mask << bit_slice.low_in_byte)
        if not bits.are_fixed:
            return self.bits_in_word(bits)
        return masked(self.word_or_lower_half(bits.low.constant + 1), 1 << bits.low.constant)

    def word_or_lower_half(self, bits_needed: int) -> CExpression:
        """Return the word, or its lower half ``(uint32_t)word`` if only its lowest ``bits_needed`` bits are needed.

        Operations in 32 bits are faster on small processors. A word that has only 32 bits needs no cast.
        """
        # A word is converted in 64 bits.
        has_32_bits = self.word_size == 32 and not self.layout_plan.is_converted
        is_lower_half_enough = bits_needed <= 32
        return CCast("uint32_t", self.word) if is_lower_half_enough and not has_32_bits else self.word

    def number_of_join(self, joined_number: JoinedNumber, name_of: Callable[[Field], CExpression]) -> CExpression:
        """Return a number that several fields form (a join), such as a position from turns and angle.

        If the fields are adjacent, it is extracted from the word at once. Otherwise it is assembled from the fields,
        for which ``name_of`` gives the C names.
        """
        if joined_number.bits is None:
            return self.number_from_fields(joined_number, name_of)
        number = self.bits_in_word(joined_number.bits)
        return number if joined_number.widest > 32 else CCast(unsigned(joined_number.widest), number)

    def number_from_fields(self, joined_number: JoinedNumber, name_of: Callable[[Field], CExpression]) -> CExpression:
        """Return the number that several fields form (a join), in its own type. The first field has the highest bits.

        ``name_of`` gives the C name of each field.
        """
        highest_field, *lower_fields = joined_number.fields
        type_ = unsigned(joined_number.widest)
        is_short = size_of(joined_number.widest) < 32
        # Several operands below 32 bits would make the result signed.
        is_promoted = is_short and len(lower_fields) > 1
        number: CExpression = CCast("uint32_t" if is_promoted else type_, name_of(highest_field))
        for field in lower_fields:
            shifted_number = shifted_left(number, self.translator.to_c(field.width))
            number = COperation("|", (shifted_number, name_of(field)))
        return CCast(type_, number) if is_short and lower_fields else number

    @property
    def before_conversion(self) -> BitReader:
        """The reader of the word before any Gray code in it is converted."""
        return replace(self, as_sent=True)

    def bits_as_sent(self, field: Field) -> CExpression:
        """Return the bits of a field before any Gray code in the word is converted."""
        _, bits = self.before_conversion.type_and_bits(self.layout_plan.bits_of(field.name))
        return bits

    def parity_as_sent(self, fields: Sequence[Field], mask: int) -> CExpression:
        """Return the parity of fields before any Gray code in the word is converted.

        At fixed places, one mask selects all their bits: ``cw_parity((uint32_t)word & 0x1FFEU)``.
        """
        bits_of_fields = [self.layout_plan.bits_of(field.name) for field in fields]
        if not mask and all(bits.are_fixed for bits in bits_of_fields):
            mask_in_word = sum(((1 << bits.width.constant) - 1) << bits.low.constant for bits in bits_of_fields)
            sent_word = self.before_conversion.word_or_lower_half(mask_in_word.bit_length())
            return self.parity([(masked(sent_word, mask_in_word), mask_in_word.bit_length())], 0)
        return self.parity([(self.bits_as_sent(field), field.widest) for field in fields], mask)

    def parity(self, numbers_and_widths: Sequence[tuple[CExpression, int]], mask: int) -> CExpression:
        """Return the parity of several numbers together: 1 if they have an odd number of 1 bits, otherwise 0.

        Each number comes with its largest width. ``mask`` selects the bits of the numbers that the parity covers, and 0
        means all bits.
        """
        numbers = [number for number, _ in numbers_and_widths]
        widest = max(width for _, width in numbers_and_widths)
        combined = numbers[0]
        if len(numbers) > 1:
            type_ = unsigned(max(widest, 32))
            combined = COperation("^", tuple(CCast(type_, number) for number in numbers))
        if mask:
            combined = masked(combined, mask)
        return CCall("cw_parity_64" if widest > 32 else "cw_parity", (combined,))


def digits(number: object, field: Field, digit_run: Digits) -> CExpression:
    """Return some decimal digits of a number (a digit run of its field), such as ``(number / 100U) % 10U``."""
    quotient: CExpression = CName(str(number))
    if digit_run.divisor > 1:
        quotient = COperation("/", (quotient, CNumber(digit_run.divisor)))
    # No digits are above the highest run, so that it needs no remainder.
    is_highest_run = digit_run is field.runs[0]
    return quotient if is_highest_run else COperation("%", (quotient, CNumber(digit_run.modulus)))


_UNUSED_MEMBER = CName("in->unused")


class UnusedMember:
    """The member ``unused`` of a struct, with a 1 in each unused bit of the frame that differs from the manual.

    The object is false if the layout has no unused bits.
    """

    def __init__(self, reader: BitReader) -> None:
        self.reader = reader
        self.layout_plan = reader.layout_plan
        self.width = self.layout_plan.layout.unused_width
        are_fixed = all(reserved.bits.are_fixed for reserved in self.layout_plan.reserved)
        #: The unused fields that are extracted one by one, because the place of some field depends on the order code.
        self.separate_fields = () if are_fixed else self.layout_plan.reserved
        #: Otherwise, all unused bits, in groups that one shift moves from the frame to the member.
        self.bit_groups = group_reserved_bits_by_shift(self.layout_plan) if are_fixed else ()

    def __bool__(self) -> bool:
        return bool(self.layout_plan.reserved)

    @property
    def type(self) -> str:
        """The C type of the member."""
        return unsigned(self.width)

    @property
    def depends_on_order_code(self) -> bool:
        """True if the encoder of the frame needs the order code for the unused bits."""
        return bool(self.separate_fields)

    # -- decoding

    @property
    def decoded_value(self) -> CExpression:
        """The value that a decoder stores in the member: a 1 in each unused bit that differs from the manual.

        The bits come from the word, or from bytes if the fields are extracted one by one.
        """
        if self.separate_fields:
            differing_bits = join_operands("|", tuple(map(self._bits_of_separate_field, self.separate_fields)))
            return CCast(self.type, differing_bits)
        received_bits = join_operands("|", tuple(map(self._bits_of_group, self.bit_groups)))
        return CCast(self.type, with_inverted(received_bits, self._documented_bits))

    @property
    def _documented_bits(self) -> CExpression | None:
        """The unused bits as the manual states them, at their places in the member, or None if all of them are 0."""
        # The groups have no common bits.
        return _express_documented_value(sum(group.value for group in self.bit_groups))

    def at_place_in_member(self, group: ShiftedBits, byte: CExpression) -> CExpression:
        """Return a byte shifted to the place of its bits in the member, such as ``(uint32_t)bytes[2] << 8``."""
        # In bytes, ``shift`` is 0 or negative: the place in the member is never lower than in the byte.
        return shifted_left(CCast(self.work_type, byte), -group.shift) if group.shift else byte

    def member_from_bytes(self, bits: CExpression) -> CExpression:
        """Return the member from bytes that are shifted to their places in it. Bits of other fields are masked off."""
        mask = sum(group.mask for group in self.bit_groups)
        documented = self._documented_bits
        differing_bits = with_inverted(masked(bits, mask), documented)
        return differing_bits if self.type == self.work_type else CCast(self.type, differing_bits)

    @property
    def work_type(self) -> str:
        """The type in which a decoder assembles bytes."""
        return unsigned(max(self.width, 32))

    def _bits_of_group(self, group: ShiftedBits) -> CExpression:
        """Return a group of unused bits of the word, shifted to their places in the member."""
        # The mask is in the position of the member. Bit 0 of the member is bit ``shift`` of the word.
        word = self.reader.word_or_lower_half(group.mask.bit_length() + group.shift)
        if group.shift >= 0:
            return masked(shifted_right(word, group.shift), group.mask)
        left_shift = -group.shift
        return shifted_left(masked(word, group.mask >> left_shift), left_shift)

    def _bits_of_separate_field(self, reserved: Reserved) -> CExpression:
        """Return the bits of one unused field that differ from the manual, shifted to their place in the member."""
        _, bits = self.reader.type_and_bits(reserved.bits)
        documented = self._express_documented(reserved)
        if not reserved.lowest_bit_in_unused:
            return with_inverted(bits, documented)
        differing_bits = with_inverted(CCast(self.work_type, bits), documented)
        if not reserved.bits.width.is_constant:
            # The mask of a variable width has 64 bits.
            differing_bits = CCast(self.work_type, differing_bits)
        return shifted_left(differing_bits, reserved.lowest_bit_in_unused)

    # -- encoding

    @property
    def refusal_condition(self) -> CExpression | None:
        """The condition under which an encoder rejects the member: it has a 1 outside the unused bits.

        The condition is None if that is not possible, because the unused bits fill the type of the member, or because
        there are none. If the width of unused fields depends on the order code, the condition is
        ``(in->unused & mask) != in->unused``.
        """
        fixed_mask = sum(reserved.mask for reserved in self.layout_plan.reserved if reserved.bits.width.is_constant)
        varying_fields = [reserved for reserved in self.separate_fields if not reserved.bits.width.is_constant]
        if not varying_fields:
            all_bits_of_type = (1 << size_of(self.width)) - 1
            other_bits = fixed_mask ^ all_bits_of_type
            if not fixed_mask or not other_bits:
                return None
            return COperation("!=", (masked(_UNUSED_MEMBER, other_bits), CNumber(0)))
        masks: list[CExpression] = []
        for reserved in varying_fields:
            mask_of_width = self.reader.translator.mask(reserved.bits.width)
            masks.append(shifted_left(mask_of_width, reserved.lowest_bit_in_unused))
        if fixed_mask:
            masks.append(CNumber(fixed_mask, hexadecimal=True))
        unused_bits_of_member = COperation("&", (_UNUSED_MEMBER, join_operands("|", tuple(masks))))
        return COperation("!=", (unused_bits_of_member, _UNUSED_MEMBER))

    @property
    def terms_in_word(self) -> Iterator[CExpression]:
        """The terms of a word to send that are its unused bits, each shifted to its place.

        They are the bits that the manual states, inverted where the member has a 1.
        """
        is_whole_member = len(self.bit_groups) + len(self.separate_fields) == 1
        for group in self.bit_groups:
            differing_bits = _UNUSED_MEMBER if is_whole_member else masked(_UNUSED_MEMBER, group.mask)
            bits = with_inverted(differing_bits, _express_documented_value(group.value))
            # Bit 0 of the member is bit ``shift`` of the word.
            yield shift_bits(CCast(self.reader.encoded_type, bits), -group.shift)
        for reserved in self.separate_fields:
            if is_whole_member:
                bits = with_inverted(_UNUSED_MEMBER, self._express_documented(reserved))
            else:
                bits = self._bits_to_send(reserved)
            low = reserved.bits.low
            distance = low.constant if low.is_constant else self.reader.translator.to_c(low)
            yield shifted_left(CCast(self.reader.encoded_type, bits), distance)

    @property
    def bits_by_byte(self) -> Iterator[tuple[int, CExpression]]:
        """The index of each byte to send that has unused bits, with these bits at their places in it."""
        for group in self.bit_groups:
            assert group.byte is not None
            yield group.byte, self._group_to_send(group)
        for reserved in self.separate_fields:
            for bit_slice in reserved.bits.bit_slices:
                bits = shifted_right(self._bits_to_send(reserved), bit_slice.low_in_number)
                yield bit_slice.byte, shift_bits(masked_byte(bits, bit_slice.mask), -bit_slice.low_in_byte)

    def _group_to_send(self, group: ShiftedBits) -> CExpression:
        """Return the unused bits of a byte to send: as the manual states them, inverted where the member has a 1."""
        # In bytes, ``shift`` is 0 or negative: bit -shift of the member is bit 0 of the byte.
        bit_in_member = -group.shift
        bits = masked_byte(shifted_right(_UNUSED_MEMBER, bit_in_member), group.mask >> bit_in_member)
        # The member itself, if it was neither shifted nor masked.
        is_wider_than_byte = bits is _UNUSED_MEMBER and self.width > 8
        if is_wider_than_byte:
            bits = CCast("uint8_t", bits)
        return with_inverted(bits, _express_documented_value(group.value >> bit_in_member))

    def bits_of(self, field: Field) -> CExpression:
        """Return the bits to send for one unused field, shifted to bit 0."""
        reserved_fields = (reserved for reserved in self.layout_plan.reserved if reserved.field is field)
        return self._bits_to_send(first_or_raise(reserved_fields, f"unused field '{field.name}'"))

    def _bits_to_send(self, reserved: Reserved) -> CExpression:
        """Return the bits to send for an unused field, shifted to bit 0.

        They are the bits that the manual states, inverted where the member has a 1.
        """
        differing_bits = shifted_right(masked(_UNUSED_MEMBER, reserved.mask), reserved.lowest_bit_in_unused)
        return with_inverted(differing_bits, self._express_documented(reserved))

    # -- both

    def _express_documented(self, reserved: Reserved) -> CExpression | None:
        """Return the value that the manual states for an unused field, or None if it is 0.

        If the width depends on the order code, the value is masked to that width.
        """
        value = _express_documented_value(reserved.value)
        width = reserved.bits.width
        if value is None or width.is_constant:
            return value
        return COperation("&", (value, self.reader.translator.mask(width)))


def _express_documented_value(value: int) -> CExpression | None:
    """Return a value that the manual states, in hexadecimal, or None if it is 0."""
    return CNumber(value, hexadecimal=True) if value else None
