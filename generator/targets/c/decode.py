"""A decoder in C: its checks, and the expressions that extract the members of a struct."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...model import Field, assert_never
from ...model.record import dataclass
from ...plan.codec import ShiftedBits, characters, is_plain_flag
from ...plan.operations import AlwaysIs, Check, FieldBits, FieldToDecode, JoinedNumber, ParityIs, ZerosAbove
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
)
from .bits import ConstantByte, constant_bytes, digits
from .expressions import CCall, CCast, CExpression, CName, CNumber, Conditional, COperation, join_operands, masked
from .names import c_name, unsigned
from .structs import LayoutStruct

#: Names of arguments and locals in the generated functions. The locals of fields must have different names.
_NAMES_OF_LOCALS = frozenset("variant word received plain bytes length out in crc index v wide value flags".split())


@dataclass(frozen=True, slots=True)
class FlagByte:
    """A byte whose flags are tested next. ``is_first`` and ``is_only`` say whether there are other such bytes."""

    byte: int
    is_first: bool
    is_only: bool


@dataclass(frozen=True, slots=True)
class UnusedBitsOfByte:
    """A byte with unused bits, shifted to its place in the member ``unused``.

    The first such byte initializes the local variable.
    """

    bits: CExpression
    is_first: bool


@dataclass(frozen=True, slots=True)
class AllUnusedBits:
    """The value of the member ``unused``, which contains the unused bits of the whole frame."""

    bits: CExpression


#: Masks of the lower 32 bits of a word, and of the odd and the even bits in them.
_LOWER_HALF = 0xFFFFFFFF
_ODD_BITS, _EVEN_BITS = 0xAAAAAAAA, 0x55555555


class CDecoder:
    """The operations of the decoder of a frame or register, in order, and the C expressions in them."""

    def __init__(self, struct: LayoutStruct) -> None:
        self.struct = struct
        self.layout_plan = struct.layout_plan
        self.reader = struct.reader
        self._plain_flags = {
            decoded_field.name for decoded_field in self.layout_plan.decoded_fields if is_plain_flag(decoded_field)
        }
        #: For each parity bit that is checked in the word: the mask of it and of all bits that it covers.
        self._word_parities: dict[str, int] = {}
        #: Fields that a check needs in a local.
        checked_names: set[str] = set()
        for check in self.layout_plan.checks:
            if isinstance(check, ZerosAbove):
                checked_names.add(check.field.name)
            if isinstance(check, ParityIs):
                mask = self._mask_in_word(check)
                if mask:
                    self._word_parities[check.field.name] = mask
                else:
                    checked_names.update(covered.name for covered in check.covered_fields)
        unused_names = {reserved.field.name for reserved in self.layout_plan.reserved}
        #: Unused fields that no check needs. Their bits only go to the member ``unused``.
        self._only_reported = unused_names - checked_names

    def local_variable(self, field: Field) -> CExpression:
        """Return the local that holds the bits of a field."""
        return CName(c_name(field.name, _NAMES_OF_LOCALS))

    @property
    def fields_with_local(self) -> tuple[Field, ...]:
        """The fields whose bits the decoder stores in a local variable.

        No local is needed for constants, CRCs, texts, unused fields that are only reported, and parity bits that are
        checked in the word. Nor is it for most flags, which are tested in their byte or in the word.
        """
        names_without_local = self._plain_flags | self._only_reported | self.layout_plan.constants.keys()
        names_without_local |= self._word_parities.keys()
        decoded_fields = self.layout_plan.decoded_fields
        names_without_local |= {field.name for field in decoded_fields if isinstance(field.meaning, Latin1Text)}
        names_without_local |= {crc.field.name for crc in self.layout_plan.crcs}
        return tuple(field for field in self.layout_plan.layout.fields if field.name not in names_without_local)

    def type_and_received_bits(self, field: Field) -> tuple[str, CExpression]:
        """Return the C type and the received bits of a field: ``uint8_t`` and ``(uint8_t)(bytes[1] >> 4)``."""
        return self.reader.type_and_bits(self.layout_plan.bits_of(field.name))

    def bits_as_sent(self, field: Field) -> CExpression:
        """Return the bits of a field before any Gray code is converted."""
        return self.reader.bits_as_sent(field)

    # -- errors

    @property
    def parities_in_word(self) -> tuple[ParityIs, ...]:
        """The parity bits that are checked in the word one by one, before any field of it is extracted."""
        pair = self.parity_pair_in_word
        return tuple(parity for parity in self._checked_in_word if parity not in pair)

    @property
    def parity_pair_in_word(self) -> tuple[ParityIs, ...]:
        """The two parity bits that are checked together, because one covers odd and the other even bits of the word.

        The tuple is empty if the frame has no such pair.
        """
        masks = [self._word_parities[parity.field.name] for parity in self._checked_in_word]
        have_same_parity = len({parity.odd for parity in self._checked_in_word}) == 1
        if len(masks) != 2 or not have_same_parity or max(masks) > _LOWER_HALF:
            return ()
        first_mask, second_mask = masks
        is_odd_then_even = first_mask & _EVEN_BITS == 0 and second_mask & _ODD_BITS == 0
        is_even_then_odd = first_mask & _ODD_BITS == 0 and second_mask & _EVEN_BITS == 0
        return self._checked_in_word if is_odd_then_even or is_even_then_odd else ()

    @property
    def _checked_in_word(self) -> tuple[ParityIs, ...]:
        """The parity bits that are checked in the word, before any field of it is extracted."""
        parities = (check for check in self.layout_plan.checks if isinstance(check, ParityIs))
        return tuple(parity for parity in parities if parity.field.name in self._word_parities)

    @property
    def checks(self) -> Iterator[Check | ConstantByte]:
        """The checks of a decoder in order: constants, parity bits, parity bits of the selector, and then values.

        In a frame of bytes, constants are checked byte by byte. The selector is the field that tells frames apart. If
        it has a parity bit, both are checked together, and the selector has no check of its own. Parity bits that are
        checked in the word are not included.
        """
        parities = [check for check in self.layout_plan.checks if isinstance(check, ParityIs)]
        # A parity is known if it covers only the selector, which has one value in this frame.
        parities_of_selector = [parity for parity in parities if parity.known_parity is not None]
        selector_names = {parity.selector.name for parity in parities_of_selector}
        yield from self._checks_of_constants()
        for parity in parities:
            if parity.known_parity is None and parity.field.name not in self._word_parities:
                yield parity
        yield from parities_of_selector
        for check in self.layout_plan.checks:
            is_of_value = not isinstance(check, (AlwaysIs, ZerosAbove, ParityIs))
            if is_of_value and check.field.name not in selector_names:
                yield check

    def _checks_of_constants(self) -> Iterator[Check | ConstantByte]:
        """Yield the checks of constant fields in the word, or of zeros above fields and of constant bytes."""
        checks = self.layout_plan.checks
        if self.layout_plan.by_word:
            yield from (check for check in checks if isinstance(check, AlwaysIs))
        else:
            yield from (check for check in checks if isinstance(check, ZerosAbove) and check.shares_bytes_with_field)
            yield from constant_bytes(checks)

    def is_of_other_frame(self, parity: ParityIs) -> CExpression:
        """Return the condition that the field that tells frames apart (the selector) or its parity bit is another.

        A byte that contains both is compared once, together with the constants in it, such as
        ``(bytes[0] & 0x9FU) != 0x1AU``.
        """
        assert parity.known_parity is not None
        # A known parity covers a single field with a single value: here the selector, with the value of this frame.
        (selected_value,) = self.layout_plan.layout.selects
        (selector_bits,) = parity.covered_bits
        slices_and_numbers = [(bit_slice, selected_value) for bit_slice in selector_bits.bit_slices]
        slices_and_numbers += [(bit_slice, parity.known_parity) for bit_slice in parity.bits.bit_slices]
        byte_indices = {bit_slice.byte for bit_slice, _ in slices_and_numbers}
        if self.layout_plan.by_word or len(byte_indices) != 1:
            return self._selector_or_parity_differs(parity, parity.known_parity)
        (byte,) = byte_indices
        mask, expected_value = self._constant_bits_of(byte)
        for bit_slice, number in slices_and_numbers:
            bits_of_number = (number >> bit_slice.low_in_number) & bit_slice.mask
            mask |= bit_slice.mask << bit_slice.low_in_byte
            expected_value |= bits_of_number << bit_slice.low_in_byte
        whole_byte = CName(f"bytes[{byte}]")
        compared_bits = masked(whole_byte, mask) if mask != 0xFF else whole_byte
        return COperation("!=", (compared_bits, CNumber(expected_value, hexadecimal=True)))

    def _constant_bits_of(self, byte: int) -> tuple[int, int]:
        """Return the mask and the value of the constant bits of a byte, both 0 without such bits.

        They were checked before. Comparing them again can complete a mask to 0xFF, so that the byte needs no mask.
        """
        for constant in constant_bytes(self.layout_plan.checks):
            # There is at most one constant for each byte.
            if constant.byte == byte:
                return constant.mask, constant.value
        return 0, 0

    def _selector_or_parity_differs(self, parity: ParityIs, known_parity: int) -> CExpression:
        """Return the condition that the selector or its parity bit, both in locals, differs from this frame's."""
        selector = parity.selector
        values_of_frame = self.layout_plan.layout.selects
        selector_differs = self.struct.is_none_of(selector, self.local_variable(selector), values_of_frame, is_raw=True)
        parity_differs = COperation("!=", (self.local_variable(parity.field), CNumber(known_parity)))
        return join_operands("||", (selector_differs, parity_differs))

    def _mask_in_word(self, parity: ParityIs) -> int:
        """Return the mask of a parity bit and all bits that it covers in the word, or 0 if one mask is not enough.

        One mask is enough for a word without Gray code, if these are the same bits for all order codes, contents of
        registers and answers of the user. It is not used for the parity of the selector, which is compared with a
        constant instead.
        """
        is_in_plain_word = self.layout_plan.by_word and not self.layout_plan.is_converted
        if not is_in_plain_word or parity.known_parity is not None:
            return 0
        parameters: set[str] = set()
        for bits in (parity.bits, *parity.covered_bits):
            parameters.update((*bits.low.parameters, *bits.width.parameters))
        depends_on_order_code_alone = parameters.isdisjoint(self._parameters_beyond_order_code())
        masks = {_mask_for_code(parity, variant.parameters) for variant in self.struct.device.variants}
        if not depends_on_order_code_alone or len(masks) > 1:
            return 0
        (mask,) = masks
        return mask

    def _parameters_beyond_order_code(self) -> set[str]:
        """Return the names of the parameters that a register, or an answer of the user, can change."""
        device = self.struct.device
        names = {parameter.name for parameter in device.run_time_parameters}
        for alternative in device.alternatives:
            # All answers of an alternative set the same parameters.
            names |= alternative.answers[0].sets.keys()
        return names

    def parity_in_word(self, parity: ParityIs) -> CExpression:
        """Return the parity of a parity bit in the word and all bits that it covers."""
        mask = self._word_parities[parity.field.name]
        if mask > _LOWER_HALF:
            return CCall("cw_parity_64", (masked(self.reader.word, mask),))
        return CCall("cw_parity", (masked(self.reader.word_or_lower_half(32), mask),))

    def parity_pair_of_word(self, parities: Sequence[ParityIs]) -> CExpression:
        """Return the parities of the odd and of the even bits in the word that two parity bits cover."""
        mask = 0
        for parity in parities:
            mask |= self._word_parities[parity.field.name]
        return CCall("cw_parities", (masked(self.reader.word_or_lower_half(32), mask),))

    def parity(self, fields: Sequence[Field], mask: int) -> CExpression:
        """Return the parity of these fields, or of their bits in ``mask`` if it is not 0."""
        if self.layout_plan.parity_covers_converted:
            return self.reader.parity_as_sent(fields, mask)
        return self.reader.parity([(self.local_variable(field), field.widest) for field in fields], mask)

    # -- members

    @property
    def fill_operations(self) -> Iterator[FlagByte | FieldToDecode | JoinedNumber | UnusedBitsOfByte | AllUnusedBits]:
        """The operations that fill the members of the struct, in order.

        The unused bits of a byte with flags are taken from the local for these flags. Those of other bytes follow.
        """
        unused = self.struct.unused
        # The unused bits that no operation has taken yet.
        group_by_byte = {group.byte: group for group in unused.bit_groups if group.byte is not None}
        for operation in self._fields_and_joined_numbers():
            yield operation
            if isinstance(operation, FlagByte) and operation.byte in group_by_byte:
                is_first = len(group_by_byte) == len(unused.bit_groups)
                group = group_by_byte.pop(operation.byte)
                yield from self._take_unused(group, CName("flags"), is_first=is_first, is_last=not group_by_byte)
        for byte in tuple(group_by_byte):
            is_first = len(group_by_byte) == len(unused.bit_groups)
            group = group_by_byte.pop(byte)
            yield from self._take_unused(group, CName(f"bytes[{byte}]"), is_first=is_first, is_last=not group_by_byte)
        if unused and (self.layout_plan.by_word or unused.separate_fields):
            yield AllUnusedBits(unused.decoded_value)

    def _take_unused(
        self, group: ShiftedBits, byte: CExpression, *, is_first: bool, is_last: bool
    ) -> Iterator[UnusedBitsOfByte | AllUnusedBits]:
        """Yield the operation for the unused bits of a byte, and for the last such byte also the whole member.

        A single byte with unused bits needs no local variable for them.
        """
        unused = self.struct.unused
        if is_first and is_last:
            yield AllUnusedBits(unused.member_from_bytes(byte))
            return
        yield UnusedBitsOfByte(unused.at_place_in_member(group, byte), is_first=is_first)
        if is_last:
            yield AllUnusedBits(unused.member_from_bytes(CName("unused")))

    def _fields_and_joined_numbers(self) -> Iterator[FlagByte | FieldToDecode | JoinedNumber]:
        """Yield the fields with a member, and then the numbers that several fields form (joins).

        The byte of adjacent flags comes before the first of them.
        """
        flag_bytes = self._first_flags_of_bytes()
        for decoded_field in self.layout_plan.decoded_fields:
            if decoded_field.name in flag_bytes:
                yield flag_bytes[decoded_field.name]
            yield decoded_field
        yield from self.layout_plan.joined_numbers

    def _first_flags_of_bytes(self) -> dict[str, FlagByte]:
        """Return the bytes of flags, each under the name of the first flag that is tested in it.

        A byte occurs again if flags of another byte are between its flags.
        """
        byte_by_first_flag: dict[str, int] = {}
        previous_byte: int | None = None
        for decoded_field in self.layout_plan.decoded_fields:
            if is_plain_flag(decoded_field) and not self.layout_plan.by_word:
                byte = decoded_field.bits.bit_slices[0].byte
                if byte != previous_byte:
                    byte_by_first_flag[decoded_field.name] = byte
                previous_byte = byte
        is_only = len(byte_by_first_flag) == 1
        flag_bytes: dict[str, FlagByte] = {}
        for name, byte in byte_by_first_flag.items():
            is_first = not flag_bytes
            flag_bytes[name] = FlagByte(byte, is_first=is_first, is_only=is_only)
        return flag_bytes

    def members_filled_by(self, decoded_field: FieldToDecode) -> Iterator[tuple[str, CExpression]]:
        """Yield the members of the struct that a field fills, each with its value.

        An example is ``error`` with ``(flags & 0x80U) != 0U``. A number whose decimal digits are members, too, and a
        text fill several members.
        """
        name = c_name(decoded_field.name)
        bits = self.local_variable(decoded_field.field)
        type_ = self.struct.type_of(decoded_field.field)
        match decoded_field.meaning:
            case UnsignedNumber() | NamedChoice():
                yield name, self._bits_as(type_, decoded_field)
            case TwosComplement():
                width = self.struct.translator.to_c(decoded_field.field.width)
                signed_number = CCall("cw_signed", (bits, width))
                yield name, CCast(type_, signed_number)
            case ZeroMeans(number_for_zero):
                is_zero = COperation("==", (bits, CNumber(0)))
                number = Conditional(is_zero, value_if_true=CNumber(number_for_zero), value_if_false=bits)
                yield name, CCast(type_, number)
            case ActiveFlag(low):
                bit = self.reader.flag_bit(decoded_field.bits) if is_plain_flag(decoded_field) else bits
                is_active = self._is_active(decoded_field, bit, low_is_active=low)
                yield name, CName(is_active.as_operand)
            case DecimalDigits(runs):
                yield name, self._bits_as(type_, decoded_field)
                for run in runs:
                    highest_of_run = run.modulus - 1
                    type_of_run = unsigned(highest_of_run.bit_length())
                    digits_of_run = digits(bits, decoded_field.field, run)
                    yield c_name(run.name), CCast(type_of_run, digits_of_run)
            case Latin1Text():
                for index, byte in characters(decoded_field.field):
                    received_byte = CName(f"bytes[{byte}]")
                    yield f"{name}[{index}]", CCast(type_, received_byte)
            case never:
                assert_never(never)

    def _is_active(self, decoded_field: FieldToDecode, bit: CExpression, *, low_is_active: bool) -> CExpression:
        """Return the condition that a flag is active. A flag that does not exist for the order code is inactive.

        An active-low flag of which only some order codes have the bit is compared with its width, which is 1 or 0.
        """
        if low_is_active and not decoded_field.field.width.is_constant:
            return COperation("!=", (bit, self.struct.translator.to_c(decoded_field.field.width)))
        operator = "==" if low_is_active else "!="
        return COperation(operator, (bit, CNumber(0)))

    def _bits_as(self, type_: str, decoded_field: FieldToDecode) -> CExpression:
        """Return the bits of a field, with a cast if the member has another type."""
        bits = self.local_variable(decoded_field.field)
        type_of_local, _ = self.type_and_received_bits(decoded_field.field)
        return bits if type_of_local == type_ else CCast(type_, bits)

    def is_fixed(self, field: Field) -> bool:
        """Return True if a field always has the same bits."""
        return field.name in self.layout_plan.constants

    def number_of_join(self, joined_number: JoinedNumber) -> CExpression:
        """Return the number that several fields form (a join), from the word or from the locals of the fields."""
        return self.reader.number_of_join(joined_number, self.local_variable)


def _mask_for_code(parity: ParityIs, parameters: Mapping[str, int]) -> int:
    """Return the mask of a parity bit and of all bits that it covers, in the word of one order code.

    ``parameters`` are the values of that order code.
    """
    word_mask = _field_mask(parity.bits, parameters)
    for bits in parity.covered_bits:
        word_mask |= _field_mask(bits, parameters, parity.mask)
    return word_mask


def _field_mask(bits: FieldBits, parameters: Mapping[str, int], mask: int = 0) -> int:
    """Return the mask of a field in the word, or if ``mask`` is not 0, the mask of only these bits of the field.

    For a field at bit 8, a ``mask`` of 0b11 becomes 0x300.
    """
    all_bits = (1 << bits.width.value(parameters)) - 1
    selected_bits = all_bits & mask if mask else all_bits
    return selected_bits << bits.low.value(parameters)
