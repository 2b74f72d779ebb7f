"""The member ``unused`` of a struct in C, which reports the unused bits of a frame that differ from the manual."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Field, first_or_raise
from ...plan.codec import ShiftedBits, moved_bits
from ...plan.operations import Reserved
from .bits import BitReader
from .names import (
    CCast,
    CExpression,
    CName,
    CNumber,
    COperation,
    join_operands,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)

_UNUSED_MEMBER = CName("in->unused")


class UnusedMember:
    """The member ``unused`` of a struct, with a 1 in each unused bit of the frame that differs from the manual.

    The object is false if the layout has no unused bits.
    """

    def __init__(self, reader: BitReader) -> None:
        self.reader = reader
        self.plan = reader.plan
        self.width = self.plan.layout.unused_width
        are_fixed = all(reserved.bits.are_fixed for reserved in self.plan.reserved)
        #: The unused fields that are extracted one by one, because the place of some field depends on the order code.
        self.separate_fields = () if are_fixed else self.plan.reserved
        #: Otherwise, all unused bits, in groups that one shift moves from the frame to the member.
        self.bit_groups = moved_bits(self.plan) if are_fixed else ()

    def __bool__(self) -> bool:
        return bool(self.plan.reserved)

    @property
    def type(self) -> str:
        """The C type of the member."""
        return unsigned(self.width)

    @property
    def depends(self) -> bool:
        """True if the encoder of the frame needs the order code for the unused bits."""
        return bool(self.separate_fields)

    # -- decoding

    @property
    def member(self) -> CExpression:
        """The value that a decoder stores in the member: a 1 in each unused bit that differs from the manual.

        The bits come from the word, or from bytes if the fields are extracted one by one.
        """
        if self.separate_fields:
            differing_bits = join_operands("|", tuple(map(self._bits_of_separate_field, self.separate_fields)))
            return CCast(self.type, differing_bits)
        received_bits = join_operands("|", tuple(map(self._bits_of_group, self.bit_groups)))
        return CCast(self.type, _with_inverted(received_bits, self._documented_bits))

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
        differing_bits = _with_inverted(masked(bits, mask), documented)
        return differing_bits if self.type == self.work_type else CCast(self.type, differing_bits)

    @property
    def work_type(self) -> str:
        """The type in which a decoder assembles bytes."""
        return unsigned(max(self.width, 32))

    def _bits_of_group(self, group: ShiftedBits) -> CExpression:
        """Return a group of unused bits of the word, shifted to their places in the member."""
        # The mask is in the position of the member. Bit 0 of the member is bit ``shift`` of the word.
        word = self.reader.lower(group.mask.bit_length() + group.shift)
        if group.shift >= 0:
            return masked(shifted_right(word, group.shift), group.mask)
        left_shift = -group.shift
        return shifted_left(masked(word, group.mask >> left_shift), left_shift)

    def _bits_of_separate_field(self, reserved: Reserved) -> CExpression:
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
        """The condition under which an encoder rejects the member: it has a 1 outside the unused bits.

        The condition is None if that is not possible, because the unused bits fill the type of the member, or because
        there are none. If the width of unused fields depends on the order code, the condition is
        ``(in->unused & mask) != in->unused``.
        """
        fixed_mask = sum(reserved.mask for reserved in self.plan.reserved if reserved.bits.width.is_constant)
        varying_fields = [reserved for reserved in self.separate_fields if not reserved.bits.width.is_constant]
        if not varying_fields:
            all_bits_of_type = (1 << size_of(self.width)) - 1
            other_bits = fixed_mask ^ all_bits_of_type
            if not fixed_mask or not other_bits:
                return None
            return COperation("!=", (masked(_UNUSED_MEMBER, other_bits), CNumber(0)))
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
        """The terms of a word to send that are its unused bits, each shifted to its place.

        They are the bits that the manual states, inverted where the member has a 1.
        """
        is_whole_member = len(self.bit_groups) + len(self.separate_fields) == 1
        for group in self.bit_groups:
            differing_bits = _UNUSED_MEMBER if is_whole_member else masked(_UNUSED_MEMBER, group.mask)
            bits = _with_inverted(differing_bits, _express_documented_value(group.value))
            # Bit 0 of the member is bit ``shift`` of the word.
            yield _shift_bits(CCast(self.reader.encoded_type, bits), -group.shift)
        for reserved in self.separate_fields:
            if is_whole_member:
                bits = _with_inverted(_UNUSED_MEMBER, self._express_documented(reserved))
            else:
                bits = self._bits_to_send(reserved)
            low = reserved.bits.low
            distance = low.constant if low.is_constant else self.reader.scope.expression_of(low)
            yield shifted_left(CCast(self.reader.encoded_type, bits), distance)

    @property
    def in_bytes(self) -> Iterator[tuple[int, CExpression]]:
        """The index of each byte to send that has unused bits, with these bits at their places in it."""
        for group in self.bit_groups:
            assert group.byte is not None
            yield group.byte, self._group_to_send(group)
        for reserved in self.separate_fields:
            for bit_slice in reserved.bits.bit_slices:
                bits = shifted_right(self._bits_to_send(reserved), bit_slice.low_in_number)
                yield bit_slice.byte, _shift_bits(_masked_byte(bits, bit_slice.mask), -bit_slice.low_in_byte)

    def _group_to_send(self, group: ShiftedBits) -> CExpression:
        """Return the unused bits of a byte to send: as the manual states them, inverted where the member has a 1."""
        # In bytes, ``shift`` is 0 or negative: bit -shift of the member is bit 0 of the byte.
        bit_in_member = -group.shift
        bits = _masked_byte(shifted_right(_UNUSED_MEMBER, bit_in_member), group.mask >> bit_in_member)
        # The member itself, if it was neither shifted nor masked.
        is_wider_than_byte = bits is _UNUSED_MEMBER and self.width > 8
        if is_wider_than_byte:
            bits = CCast("uint8_t", bits)
        return _with_inverted(bits, _express_documented_value(group.value >> bit_in_member))

    def bits_of(self, field: Field) -> CExpression:
        """Return the bits to send for one unused field, shifted to bit 0."""
        reserved_fields = (reserved for reserved in self.plan.reserved if reserved.field is field)
        return self._bits_to_send(first_or_raise(reserved_fields, f"unused field '{field.name}'"))

    def _bits_to_send(self, reserved: Reserved) -> CExpression:
        """Return the bits to send for an unused field, shifted to bit 0.

        They are the bits that the manual states, inverted where the member has a 1.
        """
        differing_bits = shifted_right(masked(_UNUSED_MEMBER, reserved.mask), reserved.place)
        return _with_inverted(differing_bits, self._express_documented(reserved))

    # -- both

    def _express_documented(self, reserved: Reserved) -> CExpression | None:
        """Return the value that the manual states for an unused field, or None if it is 0.

        If the width depends on the order code, the value is masked to that width.
        """
        value = _express_documented_value(reserved.value)
        width = reserved.bits.width
        if value is None or width.is_constant:
            return value
        return COperation("&", (value, self.reader.scope.mask(width)))


def _masked_byte(bits: CExpression, mask: int) -> CExpression:
    """Return the bits of a number in ``mask``. For a whole byte, no mask is needed: a later cast drops higher bits."""
    return bits if mask == 0xFF else masked(bits, mask)


def _express_documented_value(value: int) -> CExpression | None:
    """Return a value that the manual states, in hexadecimal, or None if it is 0."""
    return CNumber(value, hexadecimal=True) if value else None


def _with_inverted(bits: CExpression, inverted: CExpression | None) -> CExpression:
    """Return the bits, inverted where ``inverted`` has a 1. None means that no bit is inverted."""
    return COperation("^", (bits, inverted)) if inverted is not None else bits


def _shift_bits(bits: CExpression, distance: int) -> CExpression:
    """Return ``bits`` shifted to the right, or to the left if ``distance`` is negative."""
    return shifted_left(bits, -distance) if distance < 0 else shifted_right(bits, distance)
