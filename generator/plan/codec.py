"""Plans for decoding and encoding layouts: positions of fields, checks, and sources of the bits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

from ..model import Alternative, BitSlice, Device, Fault, Field, Layout
from ..model.expressions import Expression
from ..model.kinds import CrcValue, Flag, Parity, Text, Unused
from ..model.record import dataclass
from .crcs import checks_whole_words, fold_steps, is_checked_by_division
from .frame_checks import (
    bits_of,
    checks_of_layout,
    fixed_selector,
    known_parity,
    locate_bits,
    only_value,
    parity_mask,
)
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
    JoinedNumber,
    JoinNotAbove,
    NotAbove,
    ParityIs,
    ParityOf,
    Reserved,
    ReservedBits,
    ValueOfField,
    ZerosAbove,
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
    decoded_fields: tuple[FieldToDecode, ...]
    joined_numbers: tuple[JoinedNumber, ...]
    alternatives: tuple[Alternative, ...]
    reserved: tuple[Reserved, ...]
    checks: tuple[Check, ...]
    encoded_fields: tuple[FieldToEncode, ...]

    @property
    def keeps_undefined_bits(self) -> bool:
        """True if bits outside all fields are kept: register bits that the manual does not define."""
        return self.layout.gaps == "unspecified" and not self.layout.sender

    @property
    def in_bytes(self) -> bool:
        return self.layout.in_bytes

    @property
    def crc_of_all_order_codes(self) -> FrameCrc | None:
        """The CRC of all order codes. None without a CRC, or if only some order codes have it."""
        return next((crc for crc in self.crcs if not crc.is_optional), None)

    @property
    def is_converted(self) -> bool:
        """True if a decoder first converts bits of the frame: from Gray code, or from separately sent digits."""
        return self.gray is not None or bool(self.digit_codings)

    @property
    def keeps_sent_bits(self) -> bool:
        """True if a Python decoder needs the converted bits also as they were sent: for a parity bit or a message."""
        return self.parity_covers_converted or bool(self.digit_codings)

    @cached_property
    def parity_covers_converted(self) -> bool:
        """True if a parity bit covers bits that a decoder converts, from Gray code or from digits sent separately.

        The parity bit is the parity of the bits as they are sent, before the conversion.
        """
        gray_names = self.layout.field_names_of(self.layout.gray_of)
        covered_fields: list[Field] = []
        for check in self.checks:
            if isinstance(check, ParityIs):
                covered_fields += check.covered_fields
        return any(field.name in gray_names or field.kind.digit_code for field in covered_fields)

    @cached_property
    def constants(self) -> Mapping[str, int]:
        """Values of the fields that always have the same bits, by name, including the zeros that pad other fields."""
        constants = {check.field.name: check.value for check in self.checks if isinstance(check, AlwaysIs)}
        return constants | {check.padding.name: 0 for check in self.checks if isinstance(check, ZerosAbove)}

    @cached_property
    def depends_on_order_code(self) -> bool:
        """True if generated code needs parameters of the order code to decode or encode this layout.

        This is the case if a position, a width, the Gray code, or the range of the position depends on the order code.
        Parameters that answers to open questions set do not count, since the caller passes the answers separately.
        """
        if self.gray is not None and self.gray.when:
            return True
        expressions = [self.layout.bits]
        for field in self.layout.fields:
            expressions += [field.low, field.width]
        for check in self.checks:
            if isinstance(check, (NotAbove, JoinNotAbove)):
                expressions.append(check.highest)
            elif isinstance(check, IsBetween):
                expressions += [check.lowest, check.highest]
        if self.gray is not None:
            expressions.append(self.gray.excess)
        answered_names: set[str] = set()
        for alternative in self.alternatives:
            first_answer = alternative.answers[0]  # All answers to a question set the same parameters.
            answered_names.update(first_answer.sets)
        return any(not answered_names.issuperset(expression.parameters) for expression in expressions)

    @property
    def bytes_from_low(self) -> Sequence[int]:
        """Indices of the bytes in the frame, least significant byte first: 0, 1, 2 if the low byte is sent first.

        A field with a byte order of its own has its bytes in reverse order.
        """
        return sorted(range(self.length), key=self.layout.lowest_bits_of_bytes.__getitem__)

    def faults(self) -> tuple[Fault, ...]:
        """Return the kinds of errors that a decoder of this layout can report, in the order of ``Fault``."""
        faults = {check.fault for check in self.checks}
        faults.add(Fault.LENGTH)  # Every decoder checks the length of the frame.
        if self.crcs:
            faults.add(Fault.CRC)
        return tuple(fault for fault in Fault if fault in faults)

    def bits_of(self, name: str) -> FieldBits:
        """Return the bits of the field with this name."""
        return bits_of(self.layout, self.layout.field(name))


def layout_plan_of(device: Device, layout: Layout) -> LayoutPlan:
    """Return the plan for a frame or register: the positions of its fields, the checks, and the operations."""
    # The bytes of a field are unknown if the order code moves its bits.
    are_all_bytes_known = all(field.bit_slices or field.padding_of for field in layout.fields)
    by_word = not layout.in_bytes or not are_all_bytes_known or layout.is_converted
    joined_numbers = tuple(_yield_joined_numbers(layout, by_word))
    checks = (*checks_of_layout(device, layout, by_word), *_checks_of_joined_position(device, layout, joined_numbers))
    return LayoutPlan(
        layout=layout,
        by_word=by_word,
        length=layout.widest // 8,
        selector=fixed_selector(layout),
        crcs=tuple(_plan_crc(device, layout, field) for field in layout.crc_fields),
        gray=_find_gray(layout),
        digit_codings=tuple(_yield_digit_codings(layout)),
        decoded_fields=tuple(_yield_decoded_fields(layout)),
        joined_numbers=joined_numbers,
        alternatives=device.alternatives_of(layout),
        reserved=tuple(_yield_reserved(layout)),
        checks=checks,
        encoded_fields=tuple(_yield_encoded_fields(layout)),
    )


def _yield_decoded_fields(layout: Layout) -> Iterator[FieldToDecode]:
    """Yield the fields of a layout that carry data, each with its bits.

    A selector with a single valid value is omitted, because its value is the same in every frame of this layout. A
    field ``is_shared`` if a parity bit covers it, or if it is part of a number that several fields form.
    """
    shared_names: set[str] = set()
    for join in layout.joins:
        shared_names.update(join.fields)
    for field in layout.fields:
        if isinstance(field.kind, Parity):
            shared_names.update(field.kind.of)
    selector = fixed_selector(layout)
    for field in layout.fields:
        if field.carries_data and field is not selector:
            yield FieldToDecode(field, bits_of(layout, field), is_shared=field.name in shared_names)


def _yield_reserved(layout: Layout) -> Iterator[Reserved]:
    """Yield the unused fields, each with the position of its lowest bit in the decoder's number ``unused``."""
    for field, bit_in_unused in layout.unused:
        documented_value = field.kind.value if isinstance(field.kind, Unused) else 0
        yield Reserved(field, bits_of(layout, field), value=documented_value, lowest_bit_in_unused=bit_in_unused)


def _plan_crc(device: Device, layout: Layout, field: Field) -> FrameCrc:
    """Return the plan of a CRC: its position, and the bits that it covers.

    It covers the fields from the first to the last that the spec lists in ``of``. If ``of`` is empty, it covers all
    bits before it.
    """
    assert isinstance(field.kind, CrcValue)
    crc = device.crc(field.kind.crc)
    # A CRC that only some order codes have is at the end of their frames.
    bits = bits_of(layout, field) if field.width.is_constant else _bits_at_end(layout, crc.width)
    if field.kind.of:
        # From the most significant field to the least significant one.
        names_of_covered = field.kind.of
        first_covered = layout.field(names_of_covered[0])
        last_covered = layout.field(names_of_covered[-1])
        return FrameCrc(
            crc=crc,
            field=field,
            bits=bits,
            covered_width=first_covered.low + first_covered.width - last_covered.low,
            lowest_covered_bit=last_covered.low.constant,
            covers_part_only=True,
            is_checked_by_division=False,
            steps=(),  # Only a CRC of the whole frame has steps.
        )
    is_of_whole_words = checks_whole_words(device, crc)
    return FrameCrc(
        crc=crc,
        field=field,
        bits=bits,
        covered_width=layout.bits - Expression(crc.width),
        lowest_covered_bit=crc.width,
        covers_part_only=False,
        is_checked_by_division=is_of_whole_words and is_checked_by_division(crc, layout),
        steps=fold_steps(crc, layout.widest) if is_of_whole_words else (),
    )


def _bits_at_end(layout: Layout, width: int) -> FieldBits:
    """Return the position of the last ``width`` bits of a frame: those of a CRC that only some order codes have.

    In a layout of bytes, the result also says which bits of which byte they are.
    """
    low_byte_first = layout.byte_order == "low_byte_first"
    low = layout.bits - Expression(width) if low_byte_first else Expression(0)
    last_byte_of_frame = layout.widest // 8 - 1
    bytes_of_crc = (width + 7) // 8 if layout.in_bytes else 0  # rounded up
    bit_slices = []
    for byte_of_crc in range(bytes_of_crc):  # The byte 0 has the lowest bits of the CRC.
        bytes_after = bytes_of_crc - 1 - byte_of_crc if low_byte_first else byte_of_crc
        bits_below = 8 * byte_of_crc
        mask = (1 << min(8, width - bits_below)) - 1
        bit_slices.append(
            BitSlice(byte=last_byte_of_frame - bytes_after, low_in_byte=0, mask=mask, low_in_number=bits_below)
        )
    return locate_bits(layout, low, Expression(width), widest=width, bit_slices=tuple(bit_slices))


def _find_gray(layout: Layout) -> Gray | None:
    """Return the position of the bits that are sent in Gray code, or None if the layout has no Gray code.

    They are the bits of one field, or of adjacent fields that form one number.
    """
    if not layout.gray_of:
        return None
    fields = [layout.field(name) for name in layout.field_names_of(layout.gray_of)]
    lowest_field = fields[-1]  # The names are in order of significance, most significant first.
    width = sum((field.width for field in fields), Expression(0))
    excess = layout.gray_excess or Expression(0)
    return Gray(lowest_field.low, width, when=layout.gray_when, excess=excess)


def _yield_digit_codings(layout: Layout) -> Iterator[DigitCoding]:
    """Yield the position and the code of each number whose digits are sent separately, such as BCD."""
    for field in layout.fields:
        code = field.code_of_digits
        if code is not None:
            yield DigitCoding(field.low, field.width, code.bits, code.codes)


def _yield_joined_numbers(layout: Layout, by_word: bool) -> Iterator[JoinedNumber]:
    """Yield the numbers that several fields form together, such as multiturn and singleturn.

    ``bits`` is the position of the whole number if the fields are adjacent and the frame is processed as one word, so
    that a single shift extracts the number. Otherwise it is None.
    """
    for join in layout.joins:
        fields = tuple(layout.field(name) for name in join.fields)  # most significant first
        total_width = sum((field.width for field in fields), Expression(0))
        # The number needs a type, which has at least 1 bit and at most 64.
        widest = min(sum(field.widest for field in fields) or 1, 64)
        are_adjacent = all(upper.low == lower.low + lower.width for upper, lower in pairwise(fields))
        adjacent_bits = None
        if by_word and are_adjacent:
            lowest_field = fields[-1]
            adjacent_bits = locate_bits(layout, lowest_field.low, total_width, widest=widest)
        yield JoinedNumber(join=join, fields=fields, width=total_width, widest=widest, bits=adjacent_bits)


def _checks_of_joined_position(
    device: Device, layout: Layout, joined_numbers: Sequence[JoinedNumber]
) -> Iterator[JoinNotAbove]:
    """Yield the check that a position in several fields is not too high, if their bits could contain such a number."""
    position_range = device.range_in(layout)
    if position_range is not None and position_range.field is None:
        joined_position = next(number for number in joined_numbers if number.join.name == position_range.name)
        yield JoinNotAbove(joined_position, bits_of(layout, joined_position.fields[0]), position_range.highest)


def _yield_encoded_fields(layout: Layout) -> Iterator[FieldToEncode]:
    """Yield each field of an encoded frame with the source of its bits, except the CRC, which is computed last."""
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
    """Return how a parity bit is encoded: as a constant if it never changes, or computed from the covered fields."""
    covered_fields = tuple(layout.field(name) for name in parity_kind.of)
    known_bit = known_parity(layout, parity_bit, covered_fields, parity_kind)
    if known_bit is not None:
        return ConstantNumber(known_bit)
    mask = parity_mask(parity_kind, covered_fields)
    return ParityOf(covered_fields, odd=parity_kind.odd, mask=mask)


def _sent_number(layout: Layout, field: Field) -> ConstantNumber | ValueOfField:
    """Return how a field is encoded: as a constant if it can have only one value, or from the value of the caller."""
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
    index_of_last_character = field.widest // 8 - 1
    for bit_slice in reversed(field.bit_slices):
        characters_after = bit_slice.low_in_number // 8
        index_of_character = index_of_last_character - characters_after
        indices.append((index_of_character, bit_slice.byte))
    return tuple(indices)


def is_plain_flag(decoded_field: FieldToDecode) -> bool:
    """Return whether a field is a flag whose bit no join and no parity bit uses."""
    return isinstance(decoded_field.field.kind, Flag) and not decoded_field.is_shared


@dataclass(frozen=True, slots=True)
class ShiftedBits:
    """Reserved bits that one shift moves to their places in ``unused``, the number formed by all reserved bits.

    Bit 0 of ``unused`` is bit ``shift`` of the byte with index ``byte``, or of the whole word if ``byte`` is None.
    ``mask`` and ``value``, the value in the manual, are at the places of the bits in ``unused``.
    """

    byte: int | None
    shift: int
    mask: int
    value: int


def group_reserved_bits_by_shift(layout_plan: LayoutPlan) -> tuple[ShiftedBits, ...]:
    """Return the shifts that collect the reserved bits of a frame in one number, ``unused``.

    Fields of the same byte or word that need the same shift are combined. Fields whose position depends on the order
    code are omitted.
    """
    bits_by_shift: dict[tuple[int | None, int], ShiftedBits] = {}
    for reserved in layout_plan.reserved:
        if not reserved.bits.are_fixed:
            continue
        for bits in _shifts_of_reserved_bits(reserved, layout_plan.by_word):
            byte_and_shift = (bits.byte, bits.shift)
            earlier_bits = bits_by_shift.get(byte_and_shift, bits)
            mask = earlier_bits.mask | bits.mask
            value = earlier_bits.value | bits.value
            bits_by_shift[byte_and_shift] = replace(bits, mask=mask, value=value)
    return tuple(bits_by_shift.values())


def _shifts_of_reserved_bits(reserved: Reserved, by_word: bool) -> Iterator[ShiftedBits]:
    """Yield the shifts that move reserved bits to their place in the number ``unused``.

    If the frame is processed as one word, a single shift moves them. Otherwise, each byte needs its own shift.
    """
    value = reserved.value << reserved.lowest_bit_in_unused
    if by_word:
        shift = reserved.bits.low.constant - reserved.lowest_bit_in_unused
        yield ShiftedBits(byte=None, shift=shift, mask=reserved.mask, value=value)
        return
    for bit_slice in reserved.bits.bit_slices:
        # Position of the byte's lowest bit in ``unused``. A negative shift moves the bits up.
        bit_in_unused = reserved.lowest_bit_in_unused + bit_slice.low_in_number
        shift = bit_slice.low_in_byte - bit_in_unused
        mask = bit_slice.mask << bit_in_unused
        yield ShiftedBits(byte=bit_slice.byte, shift=shift, mask=mask, value=value & mask)
