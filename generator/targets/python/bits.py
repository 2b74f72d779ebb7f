"""Expressions that read the bits of a frame or register, and the numbers that several fields form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from ...model import BitSlice, Field
from ...model.expressions import Expression
from ...model.lookup import assert_never
from ...plan.codec import LayoutPlan, ShiftedBits, moved_bits
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
from ...say.plain_text import text_on_one_line
from .literals import (
    Atom,
    Not,
    ParameterExpressions,
    PythonExpression,
    PythonOperation,
    call,
    join_operands,
    mask,
    multiply,
    number,
    shift_value,
)
from .names import ClassNames, byte_order

#: Number of characters from which a comment is too long for the end of a line.
_LONG_COMMENT = 60


class BitsEncoder:
    """Expressions of joined numbers. They use the attributes of a class."""

    def __init__(self, scope: ParameterExpressions, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
        self.scope = scope
        self.codec = layout_plan
        self.names = class_names

    def _checked_bits(self, field: Field) -> PythonExpression:
        """Return the bits of a field, with the same check of its value as in ``encode``.

        An example is ``check_width("turns", self.turns, 12)``.
        """
        attribute = Atom(f"self.{self.names.attribute(field.name)}")
        quoted_name = f'"{field.name}"'
        width = str(self.scope.expression_of(field.width))
        match meaning_of(field):
            case UnsignedNumber() | NamedChoice():
                return call("check_width", quoted_name, attribute, width)
            case ZeroMeans(stands_for):
                return call("zero_for", quoted_name, attribute, str(stands_for), width)
            case TwosComplement():
                number = call("check_signed", quoted_name, attribute, width)
                return PythonOperation(number, "&", self.scope.ones(field.width))
            case ActiveFlag(low) if field.width.is_constant:
                return Not(attribute) if low else call("bool", attribute)
            case ActiveFlag():
                # A flag of a joined number is active high. Its width is 1 or, by order code, 0.
                return call("check_width", quoted_name, call("int", attribute), width)
            case DecimalDigits():
                return self.digits(field)
            case Latin1Text():
                number_of_characters = field.width.constant // 8
                return call("text_number", quoted_name, attribute, str(number_of_characters))
            case meaning:
                assert_never(meaning)

    def digits(self, field: Field) -> PythonExpression:
        """Return the number that the runs of decimal digits of a field form: ``index(self.turns) * 100 + …``.

        Each run is multiplied by its divisor, the value of 1 in its lowest digit.
        """
        return join_operands("+", (multiply(self._index_of_choice(run.name), run.divisor) for run in field.runs))

    def checked_bits(self, joined_number: JoinedNumber) -> list[tuple[str, PythonExpression]]:
        """Return each attribute of a joined number, most significant first, with a checked expression for its bits."""
        return [(self.names.attribute(field.name), self._checked_bits(field)) for field in joined_number.fields]

    def join_numbers(
        self, joined_number: JoinedNumber, scope: ParameterExpressions, expression_of: Callable[[str], str]
    ) -> PythonExpression:
        """Return a joined number of attributes that are unsigned numbers, without checks of their values.

        ``expression_of`` returns the expression for an attribute. An example is ``turns << 12 | angle``.
        """
        shifted_attributes = []
        # ``low`` is the position of the field's lowest bit in the joined number.
        for field, low in joined_number.from_low:
            attribute = Atom(expression_of(self.names.attribute(field.name)))
            shifted_attributes.append(shift_value(attribute, "<<", scope.expression_of(low)))
        # The highest field comes first.
        return join_operands("|", reversed(shifted_attributes))

    def parts(self, whole: JoinedNumber) -> list[tuple[Field, PythonExpression]]:
        """Return the fields of a joined number, most significant first, with expressions for their bits.

        An example of such an expression is ``position >> 4 & 0xFFF``.
        """
        joined_number = Atom(self.names.attribute(whole.join.name))
        highest_field = whole.fields[0]
        fields_and_bits: list[tuple[Field, PythonExpression]] = []
        # ``low`` is the position of the field's lowest bit in the joined number.
        for field, low in whole.from_low:
            bits = shift_value(joined_number, ">>", self.scope.expression_of(low))
            # No bits are above the highest field, so it needs no mask.
            if field is not highest_field:
                bits = PythonOperation(bits, "&", self.scope.ones(field.width))
            fields_and_bits.insert(0, (field, bits))
        return fields_and_bits

    @staticmethod
    def parameters_of_whole(joined_number: JoinedNumber) -> frozenset[str]:
        """Return the parameters in the shifts and width checks of the expression of a joined number."""
        parameters: set[str] = set()
        for field, low in joined_number.from_low:
            parameters.update(low.parameters)
            if _has_width_check(field):
                parameters.update(field.width.parameters)
        return frozenset(parameters)

    def _index_of_choice(self, name: str) -> PythonExpression:
        return call("index", f"self.{self.names.attribute(name)}")


def _has_width_check(field: Field) -> bool:
    """Return whether ``_checked_bits`` compares a value with the width of the field."""
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
    """Expressions for bits in ``decode``, read from ``number`` or ``word``, or from single bytes of ``data``."""

    def __init__(self, scope: ParameterExpressions, layout_plan: LayoutPlan, byte: str = "data[{}]") -> None:
        self.scope = scope
        self.codec = layout_plan
        self._byte = byte
        self.source = "number" if layout_plan.in_bytes else "word"

    def as_sent(self) -> BitReader:
        """Return the reader of the bits before any Gray code is converted. Such bits are in ``sent``."""
        reader = BitReader(self.scope, self.codec, self._byte)
        reader.source = "sent" if self.codec.keeps_sent_bits else self.source
        return reader

    def bits(self, bits: FieldBits) -> PythonExpression:
        """Return the bits as a number, such as ``word >> 8 & 0x3FF``."""
        if not self.codec.by_word:
            return self.number_from_pieces(bits.bit_slices)
        shifted = shift_value(Atom(self.source), ">>", self.scope.expression_of(bits.low))
        # Bits at the top of the word need no mask.
        is_at_top = bits.low + bits.width == self.codec.layout.bits
        return shifted if is_at_top else PythonOperation(shifted, "&", self.scope.ones(bits.width))

    def place(self, bits: FieldBits) -> str:
        """Return the position of these bits, for a comment, such as ``bits 7:4``.

        Empty if it depends on the order code, or if the bits fill a byte.
        """
        if not self.codec.by_word:
            return place_in_bytes(bits.bit_slices)
        return bit_numbers(bits.low.constant, bits.width.constant) if bits.are_fixed else ""

    def exclusive_or(self, parts: Sequence[FieldBits], counted: int) -> PythonExpression:
        """Return a number with the same parity as the bits of these fields, or as the bits in the mask ``counted``.

        For fields at fixed places in a word, it is the word with all other bits cleared, such as ``word & 0xFF3``. In
        other cases it is the XOR of the fields, such as ``data[0] ^ data[2]``. ``counted`` is a mask of this XOR, or 0
        if all bits count.
        """
        are_at_fixed_places = self.codec.by_word and all(bits.are_fixed for bits in parts)
        if not counted and are_at_fixed_places:
            # The fields have no bit in common, so that the sum of their masks has the bits of all.
            mask_of_fields = sum(mask_in_place(bits) for bits in parts)
            return PythonOperation(Atom(self.source), "&", mask(mask_of_fields))
        xor_of_fields = join_operands("^", [self.bits(bits) for bits in parts])
        return PythonOperation(xor_of_fields, "&", mask(counted)) if counted else xor_of_fields

    def number_from_pieces(self, bit_slices: Sequence[BitSlice]) -> PythonExpression:
        """Return the number that pieces of the bytes form."""
        return from_pieces(bit_slices, self.codec.length, self._byte)

    def bit(self, bits: FieldBits, word: str = "") -> PythonExpression:
        """Return an expression that is not 0 if the bit is set. ``word`` is the number to read it from, if given."""
        if self.codec.by_word:
            source = Atom(word or self.source)
            low = bits.low
        else:
            # A single bit has one piece. Bit numbers now count in its byte.
            bit_slice = bits.bit_slices[0]
            source = self._byte_variable(bit_slice.byte)
            low = Expression(bit_slice.low_in_byte)
        if low.is_constant:
            return PythonOperation(source, "&", Atom(f"0x{1 << low.constant:02X}"))
        return PythonOperation(shift_value(source, ">>", self.scope.expression_of(low)), "&", number(1))

    def _byte_variable(self, byte: int) -> Atom:
        return Atom(self._byte.format(byte))

    def differing_unused_bits(self) -> PythonExpression:
        """Return the unused bits that differ from the manual, each at its position in the attribute ``unused``.

        An example is ``b1 & 0xC | (b2 & 0x1) << 4``.
        """
        # The byte of the bits of a word is None.
        fixed_bits = sorted(moved_bits(self.codec), key=lambda bits: (bits.byte or 0, bits.shift))
        differing_bits = [self._unused_at_fixed_place(bits) for bits in fixed_bits]
        for reserved in self.codec.reserved:
            if not reserved.bits.are_fixed:
                differing_bits.append(self._unused_at_moving_place(reserved))
        return join_operands("|", differing_bits)

    def bits_without_field(self) -> PythonExpression:
        """Return the bits without a field, at their positions in the number that the bytes form.

        An example is ``data[0] & 0xF0``.
        """
        if self.codec.by_word:
            all_bits = self.source
        elif self.codec.length > 1:
            all_bits = f'int.from_bytes(data, "{byte_order(self.codec.layout)}")'
        else:
            all_bits = "data[0]"
        return PythonOperation(Atom(all_bits), "&", mask_without_field(self.scope, self.codec))

    def _unused_at_fixed_place(self, bits: ShiftedBits) -> PythonExpression:
        """Return the differing bits among the bits of the word, or of a byte, that are shifted by the same distance.

        An example is ``(b1 & 0xC ^ 0x4) << 4``, where ``0x4`` is the value in the manual.
        """
        source = Atom(self.source) if bits.byte is None else self._byte_variable(bits.byte)
        # Bits with a negative shift move to the left. One of these distances is 0.
        right_shift = max(bits.shift, 0)
        left_shift = max(-bits.shift, 0)
        # ``bits`` contains the mask and the value at their places in ``unused``, after the shift to the left.
        mask_in_source = bits.mask >> left_shift
        value_in_source = bits.value >> left_shift
        expression = shift_value(source, ">>", number(right_shift))
        is_whole_byte = bits.byte is not None and mask_in_source == 0xFF
        if not is_whole_byte:
            expression = PythonOperation(expression, "&", mask(mask_in_source))
        if bits.value:
            expression = PythonOperation(expression, "^", mask(value_in_source))
        return shift_value(expression, "<<", number(left_shift))

    def _unused_at_moving_place(self, reserved: Reserved) -> PythonExpression:
        """Return the differing bits of an unused field whose position depends on the order code."""
        bits = shift_value(Atom(self.source), ">>", self.scope.expression_of(reserved.bits.low))
        # The value in the manual. XOR with it leaves a 1 in each bit that differs.
        if reserved.value:
            bits = PythonOperation(bits, "^", mask(reserved.value))
        differing_bits = PythonOperation(bits, "&", self.scope.ones(reserved.bits.width))
        # The position of the field in ``unused``.
        return shift_value(differing_bits, "<<", number(reserved.place))

    def characters(self, bits: FieldBits) -> str:
        """Return the slice of ``data`` that contains the bytes of a string, such as ``data[2:6]``.

        Empty if they are not adjacent whole bytes in the order of the characters.
        """
        # Pieces begin with the lowest bits, strings with the highest.
        whole_bytes = [bit_slice.byte for bit_slice in reversed(bits.bit_slices) if _is_whole_byte(bit_slice)]
        has_partial_bytes = len(whole_bytes) < len(bits.bit_slices)
        if self.codec.by_word or has_partial_bytes or not _are_ascending(whole_bytes):
            return ""
        return f"data[{whole_bytes[0]}:{whole_bytes[-1] + 1}]"


def mask_in_place(bits: FieldBits) -> int:
    """Return the mask of bits whose position does not depend on the order code."""
    return ((1 << bits.width.constant) - 1) << bits.low.constant


def place_in_bytes(bit_slices: Sequence[BitSlice]) -> str:
    """Return the order of the bytes of a field, or its bits in a single byte, such as ``bits 7:4``.

    Empty if it fills the byte. ``bit_slices`` begin with the lowest bits.
    """
    if not bit_slices:
        return ""
    lowest_piece = bit_slices[0]
    if len(bit_slices) > 1:
        highest_piece = bit_slices[-1]
        return "low byte first" if lowest_piece.byte < highest_piece.byte else "high byte first"
    fills_byte = lowest_piece.mask == 0xFF
    return "" if fills_byte else bit_numbers(lowest_piece.low_in_byte, lowest_piece.mask.bit_length())


def purpose_of_constant(field: Field, place: str) -> str:
    """Return the place of a constant with the first sentence of its meaning, such as ``bits 1:0: always set``.

    Return only the place if both are too long for a comment at the end of a line.
    """
    # Texts of the spec can have several lines.
    meaning_on_one_line = " ".join(text_on_one_line(field.meaning).split())
    first_sentence = meaning_on_one_line.partition(". ")[0].rstrip(".")
    comment = ": ".join(filter(None, [place, first_sentence]))
    return comment if len(comment) < _LONG_COMMENT else place


def bit_numbers(low: int, width: int) -> str:
    """Return the highest and the lowest bit of a field, for a comment, such as ``bits 7:4``."""
    return f"bit {low}" if width == 1 else f"bits {low + width - 1}:{low}"


def mask_without_field(scope: ParameterExpressions, layout_plan: LayoutPlan) -> PythonExpression:
    """Return a mask of the bits without a field, such as ``0xF0 & ~(variant.mask << 4)``.

    Fields whose place is fixed are cleared in the first mask, and the others are masked at run time.
    """
    # All bits at first. The length of a layout with such bits is constant.
    bits_without_fixed_field = (1 << layout_plan.layout.bits.constant) - 1
    masks_of_moving_fields: list[PythonExpression] = []
    for field in layout_plan.layout.fields:
        if field.is_fixed:
            bits_without_fixed_field &= ~field.mask_in_place
        else:
            masks_of_moving_fields.append(shift_value(scope.ones(field.width), "<<", scope.expression_of(field.low)))
    if not masks_of_moving_fields:
        return mask(bits_without_fixed_field)
    moving_bits = join_operands("|", masks_of_moving_fields)
    return PythonOperation(mask(bits_without_fixed_field), "&", Atom(f"~({moving_bits})"))


def _is_whole_byte(bit_slice: BitSlice) -> bool:
    """Return whether a piece is all eight bits of its byte."""
    return not bit_slice.low_in_byte and bit_slice.mask == 0xFF


def _are_ascending(byte_indices: Sequence[int]) -> bool:
    """Return whether the bytes are adjacent and ascending."""
    return all(next_index - index == 1 for index, next_index in pairwise(byte_indices))


def from_pieces(bit_slices: Sequence[BitSlice], length: int = 0, byte: str = "data[{}]") -> PythonExpression:
    """Return the number that the pieces form, such as ``data[1] | data[2] << 8``, or 0 if there are none.

    The slices begin with the lowest bits. ``length`` is the number of bytes, or 0 if it is unknown. ``byte`` is the
    pattern for the name of a byte.
    """
    if not bit_slices:
        return number(0)
    # A single piece also counts as low byte first, which makes no difference.
    low_byte_first = bit_slices[0].byte <= bit_slices[-1].byte
    ascending = bit_slices if low_byte_first else bit_slices[::-1]
    # From four bytes on, int.from_bytes is shorter than shifts.
    if len(bit_slices) > 3 and _are_adjacent_whole_bytes(ascending):
        first_byte = ascending[0].byte
        stop = ascending[-1].byte + 1
        are_all_bytes = (first_byte, stop) == (0, length)
        slice_of_data = "data" if are_all_bytes else f"data[{first_byte}:{stop}]"
        byte_order_literal = '"little"' if low_byte_first else '"big"'
        return call("int.from_bytes", slice_of_data, byte_order_literal)
    return join_operands("|", (_from_piece(bit_slice, byte) for bit_slice in ascending))


def _are_adjacent_whole_bytes(ascending: Sequence[BitSlice]) -> bool:
    return all(map(_is_whole_byte, ascending)) and _are_ascending([bit_slice.byte for bit_slice in ascending])


def _from_piece(bit_slice: BitSlice, byte: str) -> PythonExpression:
    """Return the bits of one piece at their place in the number, such as ``(b1 & 0x3F) << 8``."""
    bits = shift_value(Atom(byte.format(bit_slice.byte)), ">>", number(bit_slice.low_in_byte))
    # The mask of the piece covers its bits after the shift. Without bits above them, they need none.
    reaches_top_of_byte = bit_slice.mask == 0xFF >> bit_slice.low_in_byte
    if not reaches_top_of_byte:
        bits = PythonOperation(bits, "&", mask(bit_slice.mask))
    return shift_value(bits, "<<", number(bit_slice.low_in_number))
