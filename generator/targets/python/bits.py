"""Expressions that read the bits of a frame or register, and the numbers that several fields form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from ...model import Field, Piece
from ...model.expressions import Expression
from ...model.lookup import assert_never
from ...plan.codec import Codec, ShiftedBits, moved_bits
from ...plan.operations import Bits, Reserved, Whole
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...say.plain_text import plain
from .literals import Atom, Expr, Not, Operation, Scope, call, joined, mask, moved, number, times
from .names import ClassNames


class Maker:
    """Expressions of joined numbers. They use the attributes of a class."""

    def __init__(self, scope: Scope, codec: Codec, names: ClassNames) -> None:
        self.scope, self.codec, self.names = scope, codec, names

    def _bits(self, field: Field) -> Expr:
        """Return the bits of a field, with a check of its value like that of ``encode``."""
        attribute = Atom(f"self.{self.names.attribute(field.name)}")
        quoted_name, width = f'"{field.name}"', str(self.scope.of(field.width))
        match meaning_of(field):
            case Raw() | Named():
                return call("check_width", quoted_name, attribute, width)
            case ZeroMeans(stands_for):
                return call("zero_for", quoted_name, attribute, str(stands_for), width)
            case TwosComplement():
                number = call("check_signed", quoted_name, attribute, width)
                return Operation(number, "&", self.scope.ones(field.width))
            case Active(low) if field.width.is_constant:
                return Not(attribute) if low else call("bool", attribute)
            case Active():
                # A flag of a joined number is active high.
                return call("check_width", quoted_name, call("int", attribute), width)
            case DigitRuns():
                return self.digits(field)
            case Characters():
                return call("text_number", f'"{field.name}"', attribute, str(field.width.constant // 8))
            case meaning:
                assert_never(meaning)

    def digits(self, field: Field) -> Expr:
        """Return the number that runs of decimal digits form."""
        return joined("+", (times(self._index(run.name), run.divisor) for run in field.runs))

    def checked_bits(self, whole: Whole) -> list[tuple[str, Expr]]:
        """Return the attributes of a joined number, most significant first, with expressions for their bits."""
        return [(self.names.attribute(field.name), self._bits(field)) for field in whole.fields]

    def whole_of_numbers(self, whole: Whole, scope: Scope, expression_of: Callable[[str], str]) -> Expr:
        """Return the same expression of unsigned numbers, without a check of their types."""
        terms = []
        for field, low in whole.from_low:
            attribute = Atom(expression_of(self.names.attribute(field.name)))
            terms.append(moved(attribute, "<<", scope.of(low)))
        return joined("|", reversed(terms))

    def parts(self, whole: Whole) -> list[tuple[Field, Expr]]:
        """Return the fields of a joined number, most significant first, with expressions for their bits."""
        name, field_bits = Atom(self.names.attribute(whole.join.name)), []
        for field, low in whole.from_low:
            shifted = moved(name, ">>", self.scope.of(low))
            top = field is whole.fields[0]
            field_bits.append((field, shifted if top else Operation(shifted, "&", self.scope.ones(field.width))))
        return field_bits[::-1]

    @staticmethod
    def parameters_of_whole(whole: Whole) -> frozenset[str]:
        """Return the parameters on which the expression of a joined number depends."""
        checked_fields = (field for field in whole.fields if _has_width_check(field))
        expressions = [low for _, low in whole.from_low] + [field.width for field in checked_fields]
        return frozenset(name for expression in expressions for name in expression.parameters)

    def _index(self, name: str) -> Expr:
        return call("index", f"self.{self.names.attribute(name)}")


def _has_width_check(field: Field) -> bool:
    """Return whether ``_bits`` compares a value with the width of the field."""
    match meaning_of(field):
        case Raw() | Named() | TwosComplement() | ZeroMeans():
            return True
        case Active():
            return not field.width.is_constant
        case DigitRuns() | Characters():
            return False
        case meaning:
            assert_never(meaning)


class Reader:
    """Expressions for bits in ``decode``, read from ``number`` or ``word``, or from single bytes of ``data``."""

    def __init__(self, scope: Scope, codec: Codec, byte: str = "data[{}]") -> None:
        self.scope, self.codec, self._byte = scope, codec, byte
        self.source = "number" if codec.in_bytes else "word"

    def as_sent(self) -> Reader:
        """Return the reader of the bits before any Gray code is converted. They are in ``sent``."""
        reader = Reader(self.scope, self.codec, self._byte)
        reader.source = "sent" if self.codec.parity_covers_gray else self.source
        return reader

    def bits(self, bits: Bits) -> Expr:
        if not self.codec.by_word:
            return self.of_bytes(bits.pieces)
        shifted = moved(Atom(self.source), ">>", self.scope.of(bits.low))
        on_top = bits.low + bits.width == self.codec.layout.bits
        return shifted if on_top else Operation(shifted, "&", self.scope.ones(bits.width))

    def place(self, bits: Bits) -> str:
        """Return the position of these bits, for a comment. Empty if it depends on the order code."""
        if not self.codec.by_word:
            return place_in_bytes(bits.pieces)
        return bit_numbers(bits.low.constant, bits.width.constant) if bits.are_fixed else ""

    def exclusive_or(self, parts: Sequence[Bits], counted: int) -> Expr:
        """Return the XOR of these fields. Its parity is that of all their bits, or of those in the mask ``counted``."""
        if not counted and self.codec.by_word and all(bits.are_fixed for bits in parts):
            # The parity of the XOR of several fields is that of all their bits.
            return Operation(Atom(self.source), "&", mask(sum(mask_in_place(bits) for bits in parts)))
        difference = joined("^", [self.bits(bits) for bits in parts])
        return Operation(difference, "&", mask(counted)) if counted else difference

    def of_bytes(self, pieces: Sequence[Piece]) -> Expr:
        return from_pieces(pieces, self.codec.length, self._byte)

    def bit(self, bits: Bits, word: str = "") -> Expr:
        """Return an expression that is not 0 if the bit is set. ``word`` is the number to read it from, if given."""
        place: Expr = Atom(word or self.source)
        if not self.codec.by_word:
            place, low = self._atom(bits.pieces[0].byte), Expression(bits.pieces[0].right)
        else:
            low = bits.low
        if low.is_constant:
            return Operation(place, "&", Atom(f"0x{1 << low.constant:02X}"))
        return Operation(moved(place, ">>", self.scope.of(low)), "&", number(1))

    def _atom(self, byte: int) -> Atom:
        return Atom(self._byte.format(byte))

    def unused(self) -> Expr:
        """Return the unused bits that differ from the manual, each at its position in one number."""
        fixed = sorted(moved_bits(self.codec), key=lambda bits: (bits.byte or 0, bits.shift))
        moving = (reserved for reserved in self.codec.reserved if not reserved.bits.are_fixed)
        return joined("|", [*map(self._unused_at_fixed_place, fixed), *map(self._unused_at_moving_place, moving)])

    def others(self) -> Expr:
        """Return the bits without a field, at their positions in the number that the bytes form."""
        codec, order = self.codec, "little" if self.codec.layout.byte_order == "low_byte_first" else "big"
        number_of_bytes = self.source if codec.by_word else f'int.from_bytes(data, "{order}")'
        number_of_data = number_of_bytes if codec.by_word or codec.length > 1 else "data[0]"
        return Operation(Atom(number_of_data), "&", others(self.scope, codec))

    def _unused_at_fixed_place(self, bits: ShiftedBits) -> Expr:
        source = Atom(self.source) if bits.byte is None else self._atom(bits.byte)
        down, up = max(bits.shift, 0), max(-bits.shift, 0)
        expression = moved(source, ">>", number(down))
        if bits.byte is None or bits.mask >> up != 0xFF:
            expression = Operation(expression, "&", mask(bits.mask >> up))
        if bits.value:
            expression = Operation(expression, "^", mask(bits.value >> up))
        return moved(expression, "<<", number(up))

    def _unused_at_moving_place(self, reserved: Reserved) -> Expr:
        """Return the differing bits among those whose position depends on the order code."""
        expression = moved(Atom(self.source), ">>", self.scope.of(reserved.bits.low))
        expression = Operation(expression, "^", mask(reserved.value)) if reserved.value else expression
        return moved(Operation(expression, "&", self.scope.ones(reserved.bits.width)), "<<", number(reserved.place))

    def characters(self, bits: Bits) -> str:
        """Return the slice of ``data`` that contains the bytes of a string. Empty if they are not adjacent."""
        places = [piece.byte for piece in reversed(bits.pieces) if not piece.right and piece.mask == 0xFF]
        if self.codec.by_word or len(places) < len(bits.pieces) or not _are_ascending(places):
            return ""
        return f"data[{places[0]}:{places[-1] + 1}]"


def mask_in_place(bits: Bits) -> int:
    """Return the mask of bits whose position does not depend on the order code."""
    return ((1 << bits.width.constant) - 1) << bits.low.constant


def place_in_bytes(pieces: Sequence[Piece]) -> str:
    """Return the order of the bytes of a field, or its position in a single byte. Empty if it fills the byte."""
    if not pieces:
        return ""
    first = pieces[0]
    if len(pieces) > 1:
        return "low byte first" if first.byte < pieces[-1].byte else "high byte first"
    return "" if first.mask == 0xFF else bit_numbers(first.right, first.mask.bit_length())


def purpose(field: Field, place: str) -> str:
    """Return the place of a constant with the first sentence of its meaning, for a short comment."""
    meaning = " ".join(plain(field.meaning).split()).partition(". ")[0].rstrip(".")
    comment = ": ".join(filter(None, [place, meaning]))
    return comment if len(comment) < 60 else place


def bit_numbers(low: int, width: int) -> str:
    """Return the highest and the lowest bit of a field, for a comment."""
    return f"bit {low}" if width == 1 else f"bits {low + width - 1}:{low}"


def others(scope: Scope, codec: Codec) -> Expr:
    """Return a mask of the bits without a field."""
    fields = codec.layout.fields
    fixed = sum(field.mask_in_place for field in fields if field.is_fixed)
    moving_fields = (field for field in fields if not field.is_fixed)
    moving = [moved(scope.ones(field.width), "<<", scope.of(field.low)) for field in moving_fields]
    ones = (1 << codec.layout.bits.constant) - 1 & ~fixed
    if not moving:
        return mask(ones)
    return Operation(mask(ones), "&", Atom(f"~({joined('|', moving)})"))


def _are_ascending(places: Sequence[int]) -> bool:
    """Return whether the bytes are adjacent and ascending."""
    return all(after - before == 1 for before, after in pairwise(places))


def from_pieces(pieces: Sequence[Piece], length: int = 0, byte: str = "data[{}]") -> Expr:
    """Return the number that the pieces form, or 0 if there are none.

    ``length`` is the number of bytes, if it is known. ``byte`` is the pattern for the name of a byte.
    """
    if not pieces:
        return number(0)
    places = [piece.byte for piece in pieces]
    low_first = places[0] <= places[-1]
    ascending = places if low_first else places[::-1]
    if (
        len(pieces) > 3
        and _are_ascending(ascending)
        and all(not piece.right and piece.mask == 0xFF for piece in pieces)
    ):
        first, end = ascending[0], ascending[-1] + 1
        part = "data" if (first, end) == (0, length) else f"data[{first}:{end}]"
        return call("int.from_bytes", part, '"little"' if low_first else '"big"')
    from_low = pieces if low_first else reversed(pieces)
    return joined("|", (_from_piece(piece, byte) for piece in from_low))


def _from_piece(piece: Piece, byte: str) -> Expr:
    expression = moved(Atom(byte.format(piece.byte)), ">>", number(piece.right))
    if piece.mask << piece.right & 0xFF != 0xFF >> piece.right << piece.right:
        expression = Operation(expression, "&", mask(piece.mask))
    return moved(expression, "<<", number(piece.left))
