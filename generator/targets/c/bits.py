"""C expressions that extract the bits of fields from a word or from bytes.

In bytes, each bit stays at its place in its byte, so that only whole bytes are shifted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from ...model import BitSlice, Digits, Field
from ...model.record import dataclass
from ...plan.codec import LayoutPlan
from ...plan.operations import AlwaysIs, Check, FieldBits, JoinedNumber, ZerosAbove
from ...say.names_and_evidence import name_in_words
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


def type_and_bits_in(bit_slices: tuple[BitSlice, ...]) -> tuple[str, CExpression]:
    """Return the C type and the expression of the number that consists of these bits of the array ``bytes``.

    For one slice, this is ``uint8_t`` and ``(uint8_t)(bytes[1] >> 4)``. Without slices, which means that no order code
    has the field, the number is 0.
    """
    if not bit_slices:
        return unsigned(1), CNumber(0)
    # The mask of a slice begins at bit 0, so that its length is the number of bits.
    width = sum(bit_slice.mask.bit_length() for bit_slice in bit_slices)
    type_ = unsigned(width)
    if len(bit_slices) == 1:
        bits = _bits_of_slice(bit_slices[0])
        is_whole_byte = isinstance(bits, CName)
        return type_, bits if is_whole_byte else CCast("uint8_t", bits)
    # Bytes are shifted in a type that is not promoted to a signed one.
    work_type = "uint64_t" if width > 32 else "uint32_t"
    shifted_slices: list[CExpression] = []
    for bit_slice in bit_slices:
        wide_bits = CCast(work_type, _bits_of_slice(bit_slice))
        shifted_slices.append(shifted_left(wide_bits, bit_slice.low_in_number))
    number = join_operands("|", tuple(shifted_slices))
    return type_, number if type_ == work_type else CCast(type_, number)


def _bits_of_slice(bit_slice: BitSlice) -> CExpression:
    """Return the bits of a byte that belong to a field, shifted to bit 0, such as ``(bytes[2] >> 3) & 0x07U``."""
    shifted_byte = shifted_right(CName(f"bytes[{bit_slice.byte}]"), bit_slice.low_in_byte)
    # Without bits above the slice, no mask is needed.
    reaches_top = bit_slice.low_in_byte + bit_slice.mask.bit_length() == 8
    return shifted_byte if reaches_top else masked(shifted_byte, bit_slice.mask)


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
            case ZerosAbove(beyond=slices_beyond):
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
            return type_and_bits_in(bits.bit_slices)
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
            if (low, width) == (0, 32):
                return self.lower(32)
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
        """Return a number that several fields form (a join), such as a position from turns and angle.

        If the fields are adjacent, it is extracted from the word at once. Otherwise it is assembled from the fields,
        for which ``name_of`` gives the C names.
        """
        if joined_number.bits is None:
            return self.number_from_fields(joined_number, name_of)
        number = self.in_word(joined_number.bits)
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
        """Return the parity of fields before any Gray code in the word is converted.

        At fixed places, one mask selects all their bits: ``cw_parity((uint32_t)word & 0x1FFEU)``.
        """
        places = [self.plan.bits_of(field.name) for field in fields]
        if not mask and all(bits.are_fixed for bits in places):
            mask_in_word = sum(((1 << bits.width.constant) - 1) << bits.low.constant for bits in places)
            sent_word = self.before_conversion.lower(mask_in_word.bit_length())
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
