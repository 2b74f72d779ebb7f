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
from .names import (
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    c_name,
    join_operands,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)
from .structs import LayoutStruct


class CEncoder:
    """The checks of an encoder in order, and the expressions in it.

    A word is the sum of terms, such as ``(uint64_t)in->position << 8``. A frame of bytes has one expression per byte.
    """

    def __init__(self, struct: LayoutStruct, limits: Sequence[OutsideLimits]) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.reader = struct.reader
        possible_refusals = (*_with_powers_first(refusals(self.plan)), *limits)
        #: The checks, in order: for a value too wide for its field, outside its limits, and the like.
        self.refusals = tuple(refusal for refusal in possible_refusals if not _never_applies(refusal))
        checks = self.plan.checks
        #: The names of parity bits, of fields with zeros above them, and of unused fields.
        self._parity_names = frozenset(check.field.name for check in checks if isinstance(check, ParityIs))
        self._padded_names = frozenset(check.field.name for check in checks if isinstance(check, ZerosAbove))
        self._reserved_names = frozenset(reserved.field.name for reserved in self.plan.reserved)

    def member_of(self, field: Field) -> CExpression:
        """Return the member of the struct that is encoded, such as ``in->position``."""
        return CName(f"in->{c_name(field.name)}")

    # -- values that are refused

    def number(self, field: Field) -> CExpression:
        """Return a member as a number, with a cast if it is a flag or of an enumeration."""
        match meaning_of(field):
            case ActiveFlag():
                needs_cast = True
            case NamedChoice():
                needs_cast = self.struct.enumeration(field) is not None
            case _:
                needs_cast = False
        return CCast("uint32_t", self.member_of(field)) if needs_cast else self.member_of(field)

    def number_from_members(self, joined_number: JoinedNumber) -> CExpression:
        """Return the number that the members of a join form, the first member in its highest bits."""
        return self.reader.number_from_fields(joined_number, self._unsigned_bits_of_member)

    def total(self, field: Field) -> CExpression:
        """Return the number that a field's runs of digits form, such as ``(uint32_t)in->tens * 10U + in->ones``."""
        # At least 32 bits, which C does not promote to a signed type.
        type_of_total = unsigned(max(field.widest, 32))
        products: list[CExpression] = []
        for run in field.runs:
            run_member = CName(f"in->{c_name(run.name)}")
            if run.divisor > 1:
                products.append(COperation("*", (CCast(type_of_total, run_member), CNumber(run.divisor))))
            else:
                products.append(run_member)
        return join_operands("+", tuple(products))

    # -- the word

    @property
    def word_type(self) -> str:
        """The type in which the word is assembled."""
        return self.reader.encoded_type

    @property
    def word(self) -> tuple[CExpression, ...]:
        """The terms of the word: constants, members, parity bits and unused bits. Terms that are always 0 are left out.

        Parity bits over a number in Gray code are in ``parities_of_sent_bits``.
        """
        terms: list[CExpression] = []
        for term in self.plan.terms:
            is_added_later = self.plan.parity_covers_gray and isinstance(term.value, ParityOf)
            # ``unused.in_word`` contains the terms of unused fields.
            is_unused = isinstance(term.value, ReservedBits)
            if not is_added_later and not is_unused and not self._is_always_zero(term):
                terms.append(self._term_in_word(term))
        return (*terms, *self.struct.unused.in_word)

    @property
    def parities_of_sent_bits(self) -> tuple[CExpression, ...]:
        """The parity bits over a number in Gray code, which are added to the word after its conversion. Often none."""
        if not self.plan.parity_covers_gray:
            return ()
        return tuple(self._term_in_word(term) for term in self.plan.terms if isinstance(term.value, ParityOf))

    def _term_in_word(self, term: FieldToEncode) -> CExpression:
        """Return a term shifted to its place in the word, such as ``(uint64_t)in->position << 8``."""
        value = self._express_value(term)
        low = term.field.low
        is_at_bit_0 = low.is_constant and low.constant == 0
        if is_at_bit_0:
            # A member of a small type would be promoted to a signed one.
            is_member = isinstance(value, CName)
            return CCast(self.word_type, value) if is_member else value
        return shifted_left(CCast(self.word_type, value), self.struct.scope.expression_of(low))

    def _is_always_zero(self, term: FieldToEncode) -> bool:
        """Return True if a term is a constant field or a parity bit that is always 0."""
        is_derived = term.field.name in self.plan.constants or term.field.name in self._parity_names
        return is_derived and term.value == ConstantNumber(0)

    # -- values of terms, with their lowest bit at bit 0

    def _express_value(self, term: FieldToEncode) -> CExpression:
        """Return the value of a term, with its lowest bit at bit 0: a literal, a parity, or the bits of a member."""
        match term.value:
            case ConstantNumber(number):
                is_parity = term.field.name in self._parity_names
                return CNumber(number, hexadecimal=not is_parity)
            case ParityOf():
                return self._parity_bit(term, term.value)
            case ValueOfField(field):
                return self._bits_of_member(field)
            case ReservedBits():
                return self.struct.unused.bits_of(term.field)

    def _parity_bit(self, term: FieldToEncode, parity: ParityOf) -> CExpression:
        """Return the parity bit of several fields, 0 for an order code without this bit."""
        if self.plan.parity_covers_gray:
            even_parity = self.reader.parity_as_sent(parity.of, parity.mask)
        else:
            even_parity = self._parity_of_members(parity)
        bit = COperation("^", (even_parity, CNumber(1))) if parity.odd else even_parity
        width = term.field.width
        if width.is_constant:
            return bit
        # The width is 1 or 0 by order code, which makes it the mask of the bit.
        return COperation("&", (bit, self.struct.scope.expression_of(width)))

    def _parity_of_members(self, parity: ParityOf) -> CExpression:
        """Return the parity of the members that a parity bit covers, 1 for an odd number of ones.

        An example is ``cw_parity((uint32_t)in->position)``. ``parity.mask`` contains the bits that count, or is 0 if
        all do.
        """
        bits_and_widths = [(self._bits_of_member(field), field.widest) for field in parity.of]
        # The reader casts several members to one type, and a wide one when it splits it into halves of 32 bits.
        if len(bits_and_widths) == 1:
            bits, width = bits_and_widths[0]
            is_without_cast = width <= 32
            if is_without_cast:
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
                return COperation("&", (CCast("uint64_t", member), self.struct.scope.mask(field.width)))
            case ZeroMeans(number):
                stands_for_zero = COperation("==", (member, CNumber(number)))
                return Conditional(stands_for_zero, CNumber(0), member)
            case UnsignedNumber() | NamedChoice() | DecimalDigits() | Latin1Text():
                return member
            case meaning:
                assert_never(meaning)

    def _bit_of_flag(self, field: Field, *, low_is_active: bool) -> CExpression:
        """Return the bit of a flag, such as ``in->error ? 1U : 0U``."""
        flag = self.member_of(field)
        if not low_is_active:
            return Conditional(flag, CNumber(1), CNumber(0))
        if field.width.is_constant:
            return Conditional(flag, CNumber(0), CNumber(1))
        # The width is 1, which inverts the bit, or 0 if the order code has no flag. Its bit is then 0 ^ 0.
        active = Conditional(flag, CNumber(1), CNumber(0))
        width = self.struct.scope.expression_of(field.width)
        return COperation("^", (CCast("uint64_t", active), CCast("uint64_t", width)))

    # -- the bytes

    @property
    def bytes(self) -> Iterator[tuple[int, CExpression]]:
        """The index and the value of each byte, such as ``(0, (uint8_t)(0x80U | in->address))``.

        Bytes of a CRC over whole bytes are left out, since the encoder computes them afterwards.
        """
        expressions = self._variable_bits_by_byte()
        crc_bytes = self._crc_bytes()
        for byte, constant in self._constant_bits_by_byte().items():
            if byte in expressions:
                constants = [CNumber(constant, hexadecimal=True)] if constant else []
                yield byte, _as_byte(join_operands("|", (*constants, *expressions[byte])))
            elif byte not in crc_bytes:
                # A byte of constants alone, or without any field.
                yield byte, CNumber(constant, hexadecimal=True)

    def _crc_bytes(self) -> set[int]:
        """Return the indices of the bytes of a CRC over whole bytes. The set is empty if there is no such CRC."""
        crc = self.plan.only_crc
        if crc is None or not self.plan.layout.crc_covers_bytes:
            return set()
        return {bit_slice.byte for bit_slice in crc.bits.bit_slices}

    def _constant_bits_by_byte(self) -> dict[int, int]:
        """Return the constant bits of every byte, by its index, such as ``{0: 0x80, 1: 0}``."""
        constants = dict.fromkeys(range(self.plan.length), 0)
        for term in self.plan.terms:
            if isinstance(term.value, ConstantNumber):
                for bit_slice in term.field.bit_slices:
                    # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
                    bits_of_piece = (term.value.number >> bit_slice.low_in_number) & bit_slice.mask
                    constants[bit_slice.byte] |= bits_of_piece << bit_slice.low_in_byte
        return constants

    def _variable_bits_by_byte(self) -> dict[int, list[CExpression]]:
        """Return the expressions to be ORed in each byte, by its index: bits of unused fields, members, parities."""
        expressions: dict[int, list[CExpression]] = {}
        for byte, bits in self.struct.unused.in_bytes:
            expressions.setdefault(byte, []).append(bits)
        for term in self.plan.terms:
            for byte, bits in self._variable_bits(term):
                expressions.setdefault(byte, []).append(bits)
        return expressions

    def _variable_bits(self, term: FieldToEncode) -> Iterator[tuple[int, CExpression]]:
        """Yield the index of each byte of a term, with the bits at their places in it. Constant terms have none.

        Reserved bits have none either, because ``unused.in_bytes`` contains them.
        """
        match term.value:
            case ReservedBits() | ConstantNumber():
                return
            case ValueOfField(field):
                yield from self._bits_in_bytes(term, field)
            case ParityOf():
                for bit_slice in term.field.bit_slices:
                    parity = shifted_right(self._express_value(term), bit_slice.low_in_number)
                    yield bit_slice.byte, shifted_left(parity, bit_slice.low_in_byte)
            case _:
                assert_never(term.value)

    def _bits_in_bytes(self, term: FieldToEncode, field: Field) -> Iterator[tuple[int, CExpression]]:
        """Yield the index of each byte of a member, with the bits at their places in it."""
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
                bits = self._express_value(term) if field.name in self._padded_names else CCast("uint64_t", member)
                for bit_slice in field.bit_slices:
                    yield bit_slice.byte, self._piece_in_byte(field, bit_slice, bits, may_be_wider=True)
            case UnsignedNumber() | ZeroMeans() | NamedChoice() | DecimalDigits():
                # A single piece contains all bits of the member, so that no bits are above them.
                is_split = len(field.bit_slices) > 1
                for bit_slice in field.bit_slices:
                    # Bits above the type of the member are 0.
                    if bit_slice.low_in_number < size_of(widest_value(field)):
                        value = self._express_value(term)
                        yield bit_slice.byte, self._piece_in_byte(field, bit_slice, value, may_be_wider=is_split)
            case meaning:
                assert_never(meaning)

    def _piece_in_byte(
        self, field: Field, bit_slice: BitSlice, bits: CExpression, *, may_be_wider: bool
    ) -> CExpression:
        """Return one piece of the bits of a field, shifted to its place in its byte.

        ``may_be_wider`` is True if ``bits`` can have 1 bits above the piece, which must be masked.
        """
        bits_of_piece = shifted_right(bits, bit_slice.low_in_number)
        if may_be_wider and bit_slice.mask != 0xFF:
            bits_of_piece = masked(bits_of_piece, bit_slice.mask)
        if bit_slice.low_in_byte:
            return shifted_left(CCast("uint32_t", bits_of_piece), bit_slice.low_in_byte)
        # The bits are still a ``CName`` if they are the member itself, neither shifted nor masked.
        is_wide_member = isinstance(bits_of_piece, CName) and self.struct.type_of(field) != unsigned(8)
        return CCast("uint32_t", bits_of_piece) if is_wide_member else bits_of_piece


def _flag_in_byte(flag: CExpression, bit_slice: BitSlice, *, low_is_active: bool) -> CExpression:
    """Return the bit of a flag at its place in its byte, such as ``in->error ? 0x80U : 0x00U``."""
    bit = CNumber(bit_slice.mask << bit_slice.low_in_byte, hexadecimal=True)
    zero = CNumber(0, hexadecimal=True)
    return Conditional(flag, zero, bit) if low_is_active else Conditional(flag, bit, zero)


def _as_byte(value: CExpression) -> CExpression:
    """Cast a value to a byte. A one-byte member needs no cast."""
    if isinstance(value, CName):
        return value
    if isinstance(value, CCast) and isinstance(value.value, CName):
        # One cast instead of two.
        return CCast("uint8_t", value.value)
    return CCast("uint8_t", value)


def _with_powers_first(unordered: Iterable[Refusal]) -> list[Refusal]:
    """Move each check for a power of two before the check that it follows. Both give the same error.

    That check tests whether the number fits in the same field.
    """
    ordered: list[Refusal] = []
    for refusal in unordered:
        if isinstance(refusal, NoPowerOfTwo):
            ordered.insert(len(ordered) - 1, refusal)
        else:
            ordered.append(refusal)
    return ordered


def _never_applies(refusal: Refusal) -> bool:
    """Return True if a check for the width refuses nothing, because the field is as wide as the member's type."""
    if not isinstance(refusal, TooWide) or not refusal.width.is_constant:
        return False
    bits_of_type = size_of(refusal.field.widest)
    return bits_of_type == refusal.field.widest
