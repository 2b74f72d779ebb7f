"""Expressions that read the bits of a frame or register, and the numbers that several fields form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from ...model import BitSlice, Field
from ...model.expressions import Expression
from ...model.record import assert_never
from ...plan.codec import LayoutPlan, ShiftedBits, group_reserved_bits_by_shift
from ...plan.operations import FieldBits, JoinedNumber, Reserved
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
)
from ...say import text_on_one_line
from .literals import (
    Atom,
    ExpressionTranslator,
    Not,
    PythonExpression,
    PythonOperation,
    call,
    join_operands,
    mask,
    multiply,
    number,
    shift_left,
    shift_right,
)
from .names import ClassNames, byte_order

#: Number of characters from which a comment is too long for the end of a line.
_LONG_COMMENT = 60


class BitsEncoder:
    """Expressions for numbers that several fields form (joined numbers), from the attributes of a frame's class."""

    def __init__(self, translator: ExpressionTranslator, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
        self.translator = translator
        self.layout_plan = layout_plan
        self.class_names = class_names

    def _checked_bits(self, field: Field) -> PythonExpression:
        """Return the bits of a field as an expression that checks the value, as ``encode`` does.

        An example is ``check_width("turns", self.turns, 12)``.
        """
        attribute_code = Atom(f"self.{self.class_names.attribute_name(field.name)}")
        quoted_name = f'"{field.name}"'
        width = str(self.translator.to_python(field.width))
        match meaning_of(field):
            case UnsignedNumber() | NamedChoice():
                return call("check_width", quoted_name, attribute_code, width)
            case ZeroMeans(number_for_zero):
                return call("zero_for", quoted_name, attribute_code, str(number_for_zero), width)
            case TwosComplement():
                checked_number = call("check_signed", quoted_name, attribute_code, width)
                return PythonOperation(checked_number, "&", self.translator.mask_of_ones(field.width))
            case ActiveFlag(is_active_low) if field.width.is_constant:
                return Not(attribute_code) if is_active_low else call("bool", attribute_code)
            case ActiveFlag():
                # A flag of a joined number is active high. Its width is 1 or, by order code, 0.
                return call("check_width", quoted_name, call("int", attribute_code), width)
            case DecimalDigits():
                return self.number_from_digits(field)
            case Latin1Text():
                character_count = field.width.constant // 8
                return call("text_number", quoted_name, attribute_code, str(character_count))
            case meaning:
                assert_never(meaning)

    def number_from_digits(self, field: Field) -> PythonExpression:
        """Return the number that the decimal digits of a field form, such as ``index(self.turns) * 100 + …``.

        Each attribute holds some of the digits (a digit run), and is multiplied by the value of its lowest digit.
        """
        products = (multiply(self._attribute_as_int(digit_run.name), digit_run.divisor) for digit_run in field.runs)
        return join_operands("+", products)

    def checked_bits(self, joined_number: JoinedNumber) -> list[tuple[str, PythonExpression]]:
        """Return each attribute of a joined number with an expression that checks its value and gives its bits.

        The attribute with the highest bits comes first.
        """
        return [
            (self.class_names.attribute_name(field.name), self._checked_bits(field)) for field in joined_number.fields
        ]

    def join_numbers(
        self, joined_number: JoinedNumber, translator: ExpressionTranslator, to_python: Callable[[str], str]
    ) -> PythonExpression:
        """Return a joined number as an expression of its attributes, such as ``turns << 12 | angle``.

        The attributes must be unsigned numbers, and are not checked. ``to_python`` returns the expression for an
        attribute.
        """
        shifted_attributes = []
        # ``lowest_bit`` is the position of the field's lowest bit in the joined number.
        for field, lowest_bit in joined_number.fields_from_low:
            attribute_code = Atom(to_python(self.class_names.attribute_name(field.name)))
            shifted_attributes.append(shift_left(attribute_code, translator.to_python(lowest_bit)))
        # The highest field comes first.
        return join_operands("|", reversed(shifted_attributes))

    def fields_and_bits(self, joined_number: JoinedNumber) -> list[tuple[Field, PythonExpression]]:
        """Return the fields of a joined number, most significant first, with expressions for their bits.

        An example of such an expression is ``position >> 4 & 0xFFF``.
        """
        number_variable = Atom(self.class_names.attribute_name(joined_number.join.name))
        highest_field = joined_number.fields[0]
        fields_and_bits: list[tuple[Field, PythonExpression]] = []
        # ``lowest_bit`` is the position of the field's lowest bit in the joined number.
        for field, lowest_bit in joined_number.fields_from_low:
            bits_code = shift_right(number_variable, self.translator.to_python(lowest_bit))
            # No bits are above the highest field, so it needs no mask.
            if field is not highest_field:
                bits_code = PythonOperation(bits_code, "&", self.translator.mask_of_ones(field.width))
            fields_and_bits.insert(0, (field, bits_code))
        return fields_and_bits

    @staticmethod
    def parameters_of_join(joined_number: JoinedNumber) -> frozenset[str]:
        """Return the names of the parameters that the expression of a joined number uses in shifts and checks."""
        parameters: set[str] = set()
        for field, lowest_bit in joined_number.fields_from_low:
            parameters.update(lowest_bit.parameters)
            if _has_width_check(field):
                parameters.update(field.width.parameters)
        return frozenset(parameters)

    def _attribute_as_int(self, name: str) -> PythonExpression:
        """Return an attribute as an integer, by ``operator.index``, which rejects other types."""
        return call("index", f"self.{self.class_names.attribute_name(name)}")


def _has_width_check(field: Field) -> bool:
    """Return whether ``_checked_bits`` compares the value of a field with its width."""
    match meaning_of(field):
        case UnsignedNumber() | NamedChoice() | TwosComplement() | ZeroMeans():
            return True
        case ActiveFlag():
            return not field.width.is_constant
        case DecimalDigits() | Latin1Text():
            return False
        case meaning:
            assert_never(meaning)


class BitReader:
    """Expressions that extract bits in ``decode``: from ``number`` or ``word``, or from single bytes of ``data``.

    ``byte_pattern`` is the pattern for the name of a byte.
    """

    def __init__(
        self, translator: ExpressionTranslator, layout_plan: LayoutPlan, byte_pattern: str = "data[{}]"
    ) -> None:
        self.translator = translator
        self.layout_plan = layout_plan
        self._byte_pattern = byte_pattern
        self.number_variable = "number" if layout_plan.in_bytes else "word"

    def as_sent(self) -> BitReader:
        """Return a reader for the bits as the encoder sent them, before Gray code is converted."""
        reader = BitReader(self.translator, self.layout_plan, self._byte_pattern)
        reader.number_variable = "sent" if self.layout_plan.keeps_sent_bits else self.number_variable
        return reader

    def read_bits(self, field_bits: FieldBits) -> PythonExpression:
        """Return the bits as a number, such as ``word >> 8 & 0x3FF``."""
        if not self.layout_plan.by_word:
            return self.number_from_slices(field_bits.bit_slices)
        shifted = shift_right(Atom(self.number_variable), self.translator.to_python(field_bits.low))
        # Bits at the top of the word need no mask.
        is_at_top = field_bits.low + field_bits.width == self.layout_plan.layout.bits
        return shifted if is_at_top else PythonOperation(shifted, "&", self.translator.mask_of_ones(field_bits.width))

    def place_comment(self, field_bits: FieldBits) -> str:
        """Return the position of these bits, for a comment, such as ``bits 7:4``, or ``from bit 48 down``.

        Empty if both ends depend on the order code, or if the bits fill a byte.
        """
        if not self.layout_plan.by_word:
            return place_in_bytes(field_bits.bit_slices)
        if field_bits.are_fixed:
            return bit_numbers(field_bits.low.constant, field_bits.width.constant)
        end_bit = field_bits.low + field_bits.width
        return f"from bit {end_bit.constant - 1} down" if end_bit.is_constant and not field_bits.low.is_constant else ""

    def number_with_parity_of(self, covered_fields: Sequence[FieldBits], parity_mask: int) -> PythonExpression:
        """Return a number that has the same parity as the bits that a parity bit covers.

        For fields at fixed places in a word, it is the word with all other bits cleared, such as ``word & 0xFF3``.
        Otherwise, it is the XOR of the fields, such as ``data[0] ^ data[2]``. ``parity_mask`` selects the bits of this
        XOR that the parity covers, and 0 means all bits.
        """
        are_at_fixed_places = self.layout_plan.by_word and all(field_bits.are_fixed for field_bits in covered_fields)
        if not parity_mask and are_at_fixed_places:
            # The fields have no bit in common, so that the sum of their masks has the bits of all.
            mask_of_fields = sum(mask_in_place(field_bits) for field_bits in covered_fields)
            return PythonOperation(Atom(self.number_variable), "&", mask(mask_of_fields))
        xor_of_fields = join_operands("^", [self.read_bits(field_bits) for field_bits in covered_fields])
        return PythonOperation(xor_of_fields, "&", mask(parity_mask)) if parity_mask else xor_of_fields

    def number_from_slices(self, bit_slices: Sequence[BitSlice]) -> PythonExpression:
        """Return the number that these slices of the bytes form."""
        return from_slices(bit_slices, self.layout_plan.length, self._byte_pattern)

    def read_bit(self, field_bits: FieldBits, other_word: str = "") -> PythonExpression:
        """Return an expression that is not 0 if a bit is set. ``other_word`` is another variable to read it from."""
        if self.layout_plan.by_word:
            number_or_byte = Atom(other_word or self.number_variable)
            lowest_bit = field_bits.low
        else:
            # A single bit has one slice. Bit numbers now count in its byte.
            bit_slice = field_bits.bit_slices[0]
            number_or_byte = self._byte_variable(bit_slice.byte)
            lowest_bit = Expression(bit_slice.low_in_byte)
        if lowest_bit.is_constant:
            return PythonOperation(number_or_byte, "&", Atom(f"0x{1 << lowest_bit.constant:02X}"))
        shifted = shift_right(number_or_byte, self.translator.to_python(lowest_bit))
        return PythonOperation(shifted, "&", number(1))

    def _byte_variable(self, byte: int) -> Atom:
        """Return the name of a byte, such as ``data[2]``."""
        return Atom(self._byte_pattern.format(byte))

    def differing_unused_bits(self) -> PythonExpression:
        """Return the value of the attribute ``unused``: a 1 in each unused bit that differs from the manual.

        An example is ``b1 & 0xC | (b2 & 0x1) << 4``.
        """
        groups_of_bits = sorted(group_reserved_bits_by_shift(self.layout_plan), key=_byte_and_shift)
        differing_bits = [self._unused_at_fixed_place(bit_group) for bit_group in groups_of_bits]
        for unused_field in self.layout_plan.reserved:
            if not unused_field.bits.are_fixed:
                differing_bits.append(self._unused_at_moving_place(unused_field))
        return join_operands("|", differing_bits)

    def bits_without_field(self) -> PythonExpression:
        """Return the bits that belong to no field, at their positions in the number that the bytes form.

        An example is ``data[0] & 0xF0``.
        """
        if self.layout_plan.by_word:
            number_code = self.number_variable
        elif self.layout_plan.length > 1:
            number_code = f'int.from_bytes(data, "{byte_order(self.layout_plan.layout)}")'
        else:
            number_code = "data[0]"
        return PythonOperation(Atom(number_code), "&", mask_without_field(self.translator, self.layout_plan))

    def _unused_at_fixed_place(self, bit_group: ShiftedBits) -> PythonExpression:
        """Return the bits of a group of unused bits that differ from the manual, at their places in ``unused``.

        A group consists of bits of a word or byte that one shift moves. An example is ``(b1 & 0xC ^ 0x4) << 4``, where
        ``0x4`` is the value in the manual.
        """
        word_or_byte = Atom(self.number_variable) if bit_group.byte is None else self._byte_variable(bit_group.byte)
        # Bits with a negative shift move to the left. One of these distances is 0.
        right_shift = max(bit_group.shift, 0)
        left_shift = max(-bit_group.shift, 0)
        # ``bit_group`` contains the mask and the value at their places in ``unused``, after the shift to the left.
        mask_in_word_or_byte = bit_group.mask >> left_shift
        value_in_word_or_byte = bit_group.value >> left_shift
        differing_bits = shift_right(word_or_byte, number(right_shift))
        is_whole_byte = bit_group.byte is not None and mask_in_word_or_byte == 0xFF
        if not is_whole_byte:
            differing_bits = PythonOperation(differing_bits, "&", mask(mask_in_word_or_byte))
        if bit_group.value:
            differing_bits = PythonOperation(differing_bits, "^", mask(value_in_word_or_byte))
        return shift_left(differing_bits, number(left_shift))

    def _unused_at_moving_place(self, unused_field: Reserved) -> PythonExpression:
        """Return the bits of an unused field that differ from the manual, if its place depends on the order code."""
        bits_code = shift_right(Atom(self.number_variable), self.translator.to_python(unused_field.bits.low))
        # The value in the manual. XOR with it leaves a 1 in each bit that differs.
        if unused_field.value:
            bits_code = PythonOperation(bits_code, "^", mask(unused_field.value))
        differing_bits = PythonOperation(bits_code, "&", self.translator.mask_of_ones(unused_field.bits.width))
        # The position of the field in ``unused``.
        return shift_left(differing_bits, number(unused_field.lowest_bit_in_unused))

    def bytes_of_text(self, field_bits: FieldBits) -> str:
        """Return the slice of ``data`` that contains the bytes of a text, such as ``data[2:6]``.

        The result is empty if they are not adjacent whole bytes in the order of the characters.
        """
        # Slices begin with the lowest bits, texts with the highest.
        byte_indexes = [bit_slice.byte for bit_slice in reversed(field_bits.bit_slices) if _is_whole_byte(bit_slice)]
        has_partial_bytes = len(byte_indexes) < len(field_bits.bit_slices)
        if self.layout_plan.by_word or has_partial_bytes or not _are_ascending(byte_indexes):
            return ""
        return f"data[{byte_indexes[0]}:{byte_indexes[-1] + 1}]"


def _byte_and_shift(bit_group: ShiftedBits) -> tuple[int, int]:
    """Return the key by which groups of unused bits are sorted: byte, which is 0 for a word, and shift."""
    return bit_group.byte or 0, bit_group.shift


def mask_in_place(field_bits: FieldBits) -> int:
    """Return the mask of bits whose place does not depend on the order code."""
    return ((1 << field_bits.width.constant) - 1) << field_bits.low.constant


def place_in_bytes(bit_slices: Sequence[BitSlice]) -> str:
    """Return the order of the bytes of a field, or if it is in a single byte, its bits there, such as ``bits 7:4``.

    The result is empty if the field is a whole byte. ``bit_slices`` begin with the lowest bits.
    """
    if not bit_slices:
        return ""
    lowest_slice = bit_slices[0]
    if len(bit_slices) > 1:
        highest_slice = bit_slices[-1]
        return "low byte first" if lowest_slice.byte < highest_slice.byte else "high byte first"
    fills_byte = lowest_slice.mask == 0xFF
    return "" if fills_byte else bit_numbers(lowest_slice.low_in_byte, lowest_slice.mask.bit_length())


def purpose_of_constant(field: Field, bits_comment: str) -> str:
    """Return the comment on a constant field: its place and the first sentence of its meaning.

    An example is ``bits 1:0: always set``. The meaning is left out if both are too long for the end of a line.
    """
    # Texts of the spec can have several lines.
    meaning_on_one_line = " ".join(text_on_one_line(field.meaning).split())
    first_sentence = meaning_on_one_line.partition(". ")[0].rstrip(".")
    comment = ": ".join(filter(None, [bits_comment, first_sentence]))
    return comment if len(comment) < _LONG_COMMENT else bits_comment


def bit_numbers(lowest_bit: int, width: int) -> str:
    """Return the highest and the lowest bit of a field, for a comment, such as ``bits 7:4``."""
    return f"bit {lowest_bit}" if width == 1 else f"bits {lowest_bit + width - 1}:{lowest_bit}"


def mask_without_field(translator: ExpressionTranslator, layout_plan: LayoutPlan) -> PythonExpression:
    """Return a mask of the bits that belong to no field, such as ``0xF0 & ~(variant.mask << 4)``.

    Fields at fixed places are cleared in the number. Other fields are cleared at run time.
    """
    # All bits at first. The length of a layout with such bits is constant.
    bits_without_fixed_field = (1 << layout_plan.layout.bits.constant) - 1
    masks_of_moving_fields: list[PythonExpression] = []
    for field in layout_plan.layout.fields:
        if field.is_fixed:
            bits_without_fixed_field &= ~field.mask_in_place
        else:
            mask_at_bit_0, lowest_bit = translator.mask_of_ones(field.width), translator.to_python(field.low)
            masks_of_moving_fields.append(shift_left(mask_at_bit_0, lowest_bit))
    if not masks_of_moving_fields:
        return mask(bits_without_fixed_field)
    moving_bits = join_operands("|", masks_of_moving_fields)
    return PythonOperation(mask(bits_without_fixed_field), "&", Atom(f"~({moving_bits})"))


def _is_whole_byte(bit_slice: BitSlice) -> bool:
    """Return whether a slice is all eight bits of its byte."""
    return bit_slice.low_in_byte == 0 and bit_slice.mask == 0xFF


def _are_ascending(byte_indices: Sequence[int]) -> bool:
    """Return whether the bytes are adjacent and ascending."""
    return all(next_index - index == 1 for index, next_index in pairwise(byte_indices))


def from_slices(
    bit_slices: Sequence[BitSlice], byte_count: int = 0, byte_pattern: str = "data[{}]"
) -> PythonExpression:
    """Return the number that slices of bytes form, such as ``data[1] | data[2] << 8``, or 0 without slices.

    The slices begin with the lowest bits. ``byte_count`` is the number of bytes in the frame, or 0 if it is unknown.
    ``byte_pattern`` is the pattern for the name of a byte.
    """
    if not bit_slices:
        return number(0)
    # A single slice also counts as low byte first, which makes no difference.
    low_byte_first = bit_slices[0].byte <= bit_slices[-1].byte
    ascending_slices = bit_slices if low_byte_first else bit_slices[::-1]
    # From four bytes on, int.from_bytes is shorter than shifts.
    if len(bit_slices) > 3 and _are_adjacent_whole_bytes(ascending_slices):
        first_byte = ascending_slices[0].byte
        end_of_slice = ascending_slices[-1].byte + 1
        are_all_bytes = (first_byte, end_of_slice) == (0, byte_count)
        slice_of_data = "data" if are_all_bytes else f"data[{first_byte}:{end_of_slice}]"
        byte_order_literal = '"little"' if low_byte_first else '"big"'
        return call("int.from_bytes", slice_of_data, byte_order_literal)
    return join_operands("|", (_from_slice(bit_slice, byte_pattern) for bit_slice in ascending_slices))


def _are_adjacent_whole_bytes(bit_slices: Sequence[BitSlice]) -> bool:
    """Return whether slices are whole bytes, in ascending order without a gap."""
    return all(map(_is_whole_byte, bit_slices)) and _are_ascending([bit_slice.byte for bit_slice in bit_slices])


def _from_slice(bit_slice: BitSlice, byte_pattern: str) -> PythonExpression:
    """Return the bits of one slice at their place in the number, such as ``(b1 & 0x3F) << 8``."""
    byte_variable = Atom(byte_pattern.format(bit_slice.byte))
    bits_code = shift_right(byte_variable, number(bit_slice.low_in_byte))
    # The mask is applied after the shift. It is not needed if no bits are above the slice.
    reaches_top_of_byte = bit_slice.mask == 0xFF >> bit_slice.low_in_byte
    if not reaches_top_of_byte:
        bits_code = PythonOperation(bits_code, "&", mask(bit_slice.mask))
    return shift_left(bits_code, number(bit_slice.low_in_number))
