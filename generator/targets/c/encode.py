"""An encoder in C: the checks of the members of a struct, and the expressions for the word or the bytes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ...model import BitSlice, Field, assert_never
from ...plan.codec import characters
from ...plan.limits import NoPowerOfTwo, OutsideLimits, Refusal, TooWide, refusals
from ...plan.operations import (
    ConstantNumber,
    FieldToEncode,
    JoinedNumber,
    ParityIs,
    ParityOf,
    ReservedBits,
    ValueOfField,
    ZerosAbove,
)
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
    widest_value,
)
from .expressions import (
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    join_operands,
    masked,
    shifted_left,
    shifted_right,
)
from .names import c_name, size_of, unsigned
from .structs import LayoutStruct


class CEncoder:
    """The C code that encodes a struct: the checks of its members in order, and the expressions for the bits to send.

    A word is made of terms, such as ``(uint64_t)in->position << 8``. A frame of bytes has one expression per byte.
    """

    def __init__(self, struct: LayoutStruct, limits: Sequence[OutsideLimits]) -> None:
        self.struct = struct
        self.layout_plan = struct.layout_plan
        self.reader = struct.reader
        possible_refusals = (*_with_powers_first(refusals(self.layout_plan)), *limits)
        #: The checks in order, each for a reason to reject a value, such as one that is too wide for its field.
        self.refusals = tuple(refusal for refusal in possible_refusals if not _never_applies(refusal))
        checks = self.layout_plan.checks
        #: The names of parity bits, of fields with zeros above them, and of unused fields.
        self._parity_names = frozenset(check.field.name for check in checks if isinstance(check, ParityIs))
        self._padded_names = frozenset(check.field.name for check in checks if isinstance(check, ZerosAbove))
        self._reserved_names = frozenset(reserved.field.name for reserved in self.layout_plan.reserved)

    def member_of(self, field: Field) -> CExpression:
        """Return the member of the struct that is encoded, such as ``in->position``."""
        return CName(f"in->{c_name(field.name)}")

    # -- values that are rejected

    def member_as_number(self, field: Field) -> CExpression:
        """Return the member of a field as a number. A flag and an enumeration need a cast."""
        match meaning_of(field):
            case ActiveFlag():
                needs_cast = True
            case NamedChoice():
                needs_cast = self.struct.enumeration(field) is not None
            case _:
                needs_cast = False
        return CCast("uint32_t", self.member_of(field)) if needs_cast else self.member_of(field)

    def number_from_members(self, joined_number: JoinedNumber) -> CExpression:
        """Return the number that several members form (a join). The first member has its highest bits."""
        return self.reader.number_from_fields(joined_number, self._unsigned_bits_of_member)

    def number_from_digits(self, field: Field) -> CExpression:
        """Return the number that the members with decimal digits of a field form.

        An example is ``(uint32_t)in->tens * 10U + in->ones``.
        """
        # At least 32 bits, which C does not promote to a signed type.
        type_of_number = unsigned(max(field.widest, 32))
        products: list[CExpression] = []
        for digit_run in field.runs:
            member = CName(f"in->{c_name(digit_run.name)}")
            if digit_run.divisor > 1:
                products.append(COperation("*", (CCast(type_of_number, member), CNumber(digit_run.divisor))))
            else:
                products.append(member)
        return join_operands("+", tuple(products))

    # -- the word

    @property
    def word_type(self) -> str:
        """The type in which the word is assembled."""
        return self.reader.encoded_type

    @property
    def terms_of_word(self) -> tuple[CExpression, ...]:
        """The terms that are ORed to form the word: constants, members, parity bits and unused bits.

        Terms that are always 0 are left out. So are parity bits that are computed after the conversion to Gray code,
        which are in ``parities_of_sent_bits``.
        """
        terms: list[CExpression] = []
        for encoded_field in self.layout_plan.encoded_fields:
            is_added_later = self.layout_plan.parity_covers_converted and isinstance(encoded_field.value, ParityOf)
            # ``unused.terms_in_word`` contains the terms of unused fields.
            is_unused = isinstance(encoded_field.value, ReservedBits)
            if not is_added_later and not is_unused and not self._is_always_zero(encoded_field):
                terms.append(self._term_in_word(encoded_field))
        return (*terms, *self.struct.unused.terms_in_word)

    @property
    def parities_of_sent_bits(self) -> tuple[CExpression, ...]:
        """The parity bits over a number in Gray code, which are added to the word after its conversion.

        Most frames have none.
        """
        if not self.layout_plan.parity_covers_converted:
            return ()
        parity_bits = [field for field in self.layout_plan.encoded_fields if isinstance(field.value, ParityOf)]
        return tuple(map(self._term_in_word, parity_bits))

    def _term_in_word(self, encoded_field: FieldToEncode) -> CExpression:
        """Return the bits of a field, shifted to its place in the word, such as ``(uint64_t)in->position << 8``."""
        value = self._express_value(encoded_field)
        low = encoded_field.field.low
        is_at_bit_0 = low.is_constant and low.constant == 0
        if is_at_bit_0:
            # A member of a small type would be promoted to a signed one.
            is_member = isinstance(value, CName)
            return CCast(self.word_type, value) if is_member else value
        return shifted_left(CCast(self.word_type, value), self.struct.translator.to_c(low))

    def _is_always_zero(self, encoded_field: FieldToEncode) -> bool:
        """Return True if a field is a constant field or a parity bit that is always 0."""
        is_derived = encoded_field.name in self.layout_plan.constants or encoded_field.name in self._parity_names
        return is_derived and encoded_field.value == ConstantNumber(0)

    # -- values of terms, with their lowest bit at bit 0

    def _express_value(self, encoded_field: FieldToEncode) -> CExpression:
        """Return the bits to send for a field, with the lowest one at bit 0: a constant, a parity, or a member."""
        match encoded_field.value:
            case ConstantNumber(number):
                is_parity = encoded_field.name in self._parity_names
                return CNumber(number, hexadecimal=not is_parity)
            case ParityOf():
                return self._parity_bit(encoded_field, encoded_field.value)
            case ValueOfField(field):
                return self._bits_of_member(field)
            case ReservedBits():
                return self.struct.unused.bits_of(encoded_field.field)

    def _parity_bit(self, encoded_field: FieldToEncode, parity: ParityOf) -> CExpression:
        """Return the parity bit of several fields, 0 for an order code without this bit."""
        if self.layout_plan.parity_covers_converted:
            even_parity = self.reader.parity_as_sent(parity.covered_fields, parity.mask)
        else:
            even_parity = self._parity_of_members(parity)
        bit = COperation("^", (even_parity, CNumber(1))) if parity.odd else even_parity
        width = encoded_field.field.width
        if width.is_constant:
            return bit
        # The width is 1 or 0 by order code, which makes it the mask of the bit.
        return COperation("&", (bit, self.struct.translator.to_c(width)))

    def _parity_of_members(self, parity: ParityOf) -> CExpression:
        """Return the parity of the members that a parity bit covers: 1 if they have an odd number of 1 bits.

        An example is ``cw_parity((uint32_t)in->position)``. The width of a field can depend on the order code, so its
        greatest width (``widest``) counts.
        """
        covered_fields = parity.covered_fields
        bits_and_widths = [(self._bits_of_member(field), field.widest) for field in covered_fields]
        # ``self.reader`` writes the C code of the parity. It casts several members to one type, and splits a member of
        # more than 32 bits into halves. A single shorter member is cast here.
        if len(covered_fields) == 1 and covered_fields[0].widest <= 32:
            bits, width = bits_and_widths[0]
            bits_and_widths = [(CCast("uint32_t", bits), width)]
        return self.reader.parity(bits_and_widths, parity.mask)

    def _unsigned_bits_of_member(self, field: Field) -> CExpression:
        """Return the bits of a member as an unsigned number. Some compilers make an enumeration signed."""
        bits = self._bits_of_member(field)
        return CCast(unsigned(field.widest), bits) if isinstance(meaning_of(field), NamedChoice) else bits

    def _bits_of_member(self, field: Field) -> CExpression:
        """Return the bits that are sent for a member, such as ``in->error ? 1U : 0U`` for a flag.

        The bits of an unused field come from the member ``unused``.
        """
        if field.name in self._reserved_names:
            return self.struct.unused.bits_of(field)
        member = self.member_of(field)
        match meaning_of(field):
            case ActiveFlag(low):
                return self._bit_of_flag(field, low_is_active=low)
            case TwosComplement():
                return COperation("&", (CCast("uint64_t", member), self.struct.translator.mask(field.width)))
            case ZeroMeans(number_for_zero):
                is_sent_as_zero = COperation("==", (member, CNumber(number_for_zero)))
                return Conditional(is_sent_as_zero, value_if_true=CNumber(0), value_if_false=member)
            case UnsignedNumber() | NamedChoice() | DecimalDigits() | Latin1Text():
                return member
            case meaning:
                assert_never(meaning)

    def _bit_of_flag(self, field: Field, *, low_is_active: bool) -> CExpression:
        """Return the bit to send for a flag, such as ``in->error ? 1U : 0U``, or the inverse if it is active low."""
        flag = self.member_of(field)
        if not low_is_active:
            return Conditional(flag, value_if_true=CNumber(1), value_if_false=CNumber(0))
        if field.width.is_constant:
            return Conditional(flag, value_if_true=CNumber(0), value_if_false=CNumber(1))
        # The width is 1, which inverts the bit, or 0 if the order code has no flag. Its bit is then 0 ^ 0.
        active = Conditional(flag, value_if_true=CNumber(1), value_if_false=CNumber(0))
        width = self.struct.translator.to_c(field.width)
        return COperation("^", (CCast("uint64_t", active), CCast("uint64_t", width)))

    # -- the bytes

    @property
    def values_of_bytes(self) -> Iterator[tuple[int, CExpression]]:
        """The index and the value of each byte to send, such as ``(0, (uint8_t)(0x80U | in->address))``.

        The bytes of a CRC over whole bytes are left out, since the encoder computes them afterwards.
        """
        expressions = self._variable_bits_by_byte()
        crc_bytes = self._crc_bytes()
        for byte, constant in self._constant_bits_by_byte().items():
            if byte in expressions:
                constants = [CNumber(constant, hexadecimal=True)] if constant else []
                yield byte, _as_byte(join_operands("|", (*constants, *expressions[byte])))
            elif byte not in crc_bytes:
                # A byte that has only constant bits, or no field.
                yield byte, CNumber(constant, hexadecimal=True)

    def _crc_bytes(self) -> set[int]:
        """Return the indices of the bytes of a CRC over whole bytes. The set is empty if there is no such CRC."""
        crc = self.layout_plan.crc_of_all_order_codes
        if crc is None or not self.layout_plan.layout.crc_covers_bytes:
            return set()
        return {bit_slice.byte for bit_slice in crc.bits.bit_slices}

    def _constant_bits_by_byte(self) -> dict[int, int]:
        """Return the constant bits of every byte, by its index, such as ``{0: 0x80, 1: 0}``."""
        constants = dict.fromkeys(range(self.layout_plan.length), 0)
        for encoded_field in self.layout_plan.encoded_fields:
            if isinstance(encoded_field.value, ConstantNumber):
                for bit_slice in encoded_field.field.bit_slices:
                    # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
                    bits_of_slice = (encoded_field.value.number >> bit_slice.low_in_number) & bit_slice.mask
                    constants[bit_slice.byte] |= bits_of_slice << bit_slice.low_in_byte
        return constants

    def _variable_bits_by_byte(self) -> dict[int, list[CExpression]]:
        """Return the bits that are ORed in each byte, by its index: those of unused fields, members and parity bits."""
        expressions: dict[int, list[CExpression]] = {}
        for byte, bits in self.struct.unused.bits_by_byte:
            expressions.setdefault(byte, []).append(bits)
        for encoded_field in self.layout_plan.encoded_fields:
            for byte, bits in self._variable_bits(encoded_field):
                expressions.setdefault(byte, []).append(bits)
        return expressions

    def _variable_bits(self, encoded_field: FieldToEncode) -> Iterator[tuple[int, CExpression]]:
        """Yield the index of each byte that contains bits of a member or parity bit, with the bits at their places.

        Nothing is yielded for constants and unused bits, which other functions add to the bytes.
        """
        match encoded_field.value:
            case ReservedBits() | ConstantNumber():
                return
            case ValueOfField(field):
                yield from self._bits_in_bytes(encoded_field, field)
            case ParityOf():
                for bit_slice in encoded_field.field.bit_slices:
                    parity = shifted_right(self._express_value(encoded_field), bit_slice.low_in_number)
                    yield bit_slice.byte, shifted_left(parity, bit_slice.low_in_byte)
            case _:
                assert_never(encoded_field.value)

    def _bits_in_bytes(self, encoded_field: FieldToEncode, field: Field) -> Iterator[tuple[int, CExpression]]:
        """Yield the index of each byte that contains bits of a member, with the bits at their places in it."""
        member = self.member_of(field)
        match meaning_of(field):
            case Latin1Text():
                for index, byte in characters(field):
                    yield byte, CCast("uint8_t", CName(f"{member}[{index}]"))
            case ActiveFlag(low):
                for bit_slice in field.bit_slices:
                    yield bit_slice.byte, _flag_in_byte(member, bit_slice, low_is_active=low)
            case TwosComplement():
                # Copies of the sign must not reach the zeros above the field.
                is_padded = field.name in self._padded_names
                bits = self._express_value(encoded_field) if is_padded else CCast("uint64_t", member)
                for bit_slice in field.bit_slices:
                    yield bit_slice.byte, self._slice_in_byte(field, bit_slice, bits, may_be_wider=True)
            case UnsignedNumber() | ZeroMeans() | NamedChoice() | DecimalDigits():
                # A single slice contains all bits of the member, so that no bits are above them.
                is_split = len(field.bit_slices) > 1
                for bit_slice in field.bit_slices:
                    # Bits above the type of the member are 0.
                    if bit_slice.low_in_number < size_of(widest_value(field)):
                        value = self._express_value(encoded_field)
                        yield bit_slice.byte, self._slice_in_byte(field, bit_slice, value, may_be_wider=is_split)
            case meaning:
                assert_never(meaning)

    def _slice_in_byte(
        self, field: Field, bit_slice: BitSlice, bits: CExpression, *, may_be_wider: bool
    ) -> CExpression:
        """Return the bits of a field that belong to one byte, shifted to their place in it.

        ``bits`` are all bits of the field. ``may_be_wider`` is True if there can be 1 bits above the slice, which must
        be masked.
        """
        bits_of_slice = shifted_right(bits, bit_slice.low_in_number)
        if may_be_wider and bit_slice.mask != 0xFF:
            bits_of_slice = masked(bits_of_slice, bit_slice.mask)
        if bit_slice.low_in_byte:
            return shifted_left(CCast("uint32_t", bits_of_slice), bit_slice.low_in_byte)
        # The bits are still a name if they are the member itself, neither shifted nor masked.
        is_wide_member = isinstance(bits_of_slice, CName) and self.struct.type_of(field) != unsigned(8)
        return CCast("uint32_t", bits_of_slice) if is_wide_member else bits_of_slice


def _flag_in_byte(flag: CExpression, bit_slice: BitSlice, *, low_is_active: bool) -> CExpression:
    """Return the bit of a flag at its place in its byte, such as ``in->error ? 0x80U : 0x00U``."""
    bit = CNumber(bit_slice.mask << bit_slice.low_in_byte, hexadecimal=True)
    zero = CNumber(0, hexadecimal=True)
    if low_is_active:
        return Conditional(flag, value_if_true=zero, value_if_false=bit)
    return Conditional(flag, value_if_true=bit, value_if_false=zero)


def _as_byte(value: CExpression) -> CExpression:
    """Return a value cast to a byte. A name is a member of one byte, and needs no cast."""
    if isinstance(value, CName):
        return value
    if isinstance(value, CCast) and isinstance(value.value, CName):
        # One cast instead of two.
        return CCast("uint8_t", value.value)
    return CCast("uint8_t", value)


def _with_powers_first(unordered: Iterable[Refusal]) -> list[Refusal]:
    """Return the checks, with each check for a power of two before the check whether the number fits in its field.

    In ``unordered`` it comes directly after that check. Both report the same error.
    """
    ordered: list[Refusal] = []
    for refusal in unordered:
        if isinstance(refusal, NoPowerOfTwo):
            index_of_last = len(ordered) - 1
            ordered.insert(index_of_last, refusal)
        else:
            ordered.append(refusal)
    return ordered


def _never_applies(refusal: Refusal) -> bool:
    """Return True if a check for the width rejects no value, because the field is as wide as the type of its member."""
    if not isinstance(refusal, TooWide) or not refusal.width.is_constant:
        return False
    bits_of_type = size_of(refusal.field.widest)
    return bits_of_type == refusal.field.widest
