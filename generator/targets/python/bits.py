"""Expressions that read the bits of a frame or register, from one number or from its bytes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ...model import Piece
from ...model.expressions import Expression
from ...plan.codec import Bits, Codec, Reserved
from ...plan.unused import Moved, moved_bits
from .expr import Atom, Expr, Operation, Scope, call, joined, mask, moved, number


class Reader:
    """Expressions for bits in ``decode``, read from ``number`` or ``word``, or from single bytes of ``data``."""

    def __init__(self, scope: Scope, codec: Codec, byte: str = "data[{}]") -> None:
        self.scope, self.codec, self._byte = scope, codec, byte
        self.source = "number" if codec.in_bytes else "word"

    def bits(self, bits: Bits) -> Expr:
        if not self.codec.by_word:
            return self.of_bytes(bits.pieces)
        shifted = moved(Atom(self.source), ">>", self.scope.of(bits.low))
        on_top = bits.low + bits.width == self.codec.layout.bits
        return shifted if on_top else Operation(shifted, "&", self.scope.ones(bits.width))

    def exclusive_or(self, parts: Sequence[Bits], counted: int) -> Expr:
        """Return the XOR of these fields. Its parity is that of all their bits, or of those in the mask ``counted``."""
        found = joined("^", [self.bits(bits) for bits in parts])
        return Operation(found, "&", mask(counted)) if counted else found

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
        fixed = sorted(moved_bits(self.codec), key=lambda item: (item.byte or 0, item.shift))
        moving = (item for item in self.codec.reserved if not item.bits.are_fixed)
        return joined("|", [*map(self._taken, fixed), *map(self._reserved, moving)])

    def others(self) -> Expr:
        """Return the bits without a field, at their positions in the number that the bytes form."""
        codec, order = self.codec, "little" if self.codec.layout.byte_order == "low_byte_first" else "big"
        whole = self.source if codec.by_word else f'int.from_bytes(data, "{order}")'
        return Operation(
            Atom(whole if codec.by_word or codec.length > 1 else "data[0]"), "&", others(self.scope, codec)
        )

    def _taken(self, item: Moved) -> Expr:
        source = Atom(self.source) if item.byte is None else self._atom(item.byte)
        down, up = max(item.shift, 0), max(-item.shift, 0)
        found = moved(source, ">>", number(down))
        if item.byte is None or item.mask >> up != 0xFF:
            found = Operation(found, "&", mask(item.mask >> up))
        if item.value:
            found = Operation(found, "^", mask(item.value >> up))
        return moved(found, "<<", number(up))

    def _reserved(self, item: Reserved) -> Expr:
        """Return the differing bits among those whose position depends on the order code."""
        found = moved(Atom(self.source), ">>", self.scope.of(item.bits.low))
        found = Operation(found, "^", mask(item.value)) if item.value else found
        return moved(Operation(found, "&", self.scope.ones(item.bits.width)), "<<", number(item.place))

    def characters(self, bits: Bits) -> str:
        """Return the slice of ``data`` that contains the bytes of a string. Empty if they are not adjacent."""
        places = [piece.byte for piece in reversed(bits.pieces) if not piece.right and piece.mask == 0xFF]
        if self.codec.by_word or len(places) < len(bits.pieces) or not _ascend(places):
            return ""
        return f"data[{places[0]}:{places[-1] + 1}]"


def others(scope: Scope, codec: Codec) -> Expr:
    """Return a mask of the bits without a field."""
    fixed = sum(item.mask_in_place for item in codec.layout.fields if item.is_fixed)
    moving = [
        moved(scope.ones(item.width), "<<", scope.of(item.low)) for item in codec.layout.fields if not item.is_fixed
    ]
    ones = (1 << codec.layout.bits.constant) - 1 & ~fixed
    if not moving:
        return mask(ones)
    return Operation(mask(ones), "&", Atom(f"~({joined('|', moving)})"))


def _ascend(places: Sequence[int]) -> bool:
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
    if len(pieces) > 3 and _ascend(ascending) and all(not piece.right and piece.mask == 0xFF for piece in pieces):
        first, end = ascending[0], ascending[-1] + 1
        part = "data" if (first, end) == (0, length) else f"data[{first}:{end}]"
        return call("int.from_bytes", part, '"little"' if low_first else '"big"')
    return joined("|", (_from_piece(piece, byte) for piece in (pieces if low_first else reversed(pieces))))


def _from_piece(piece: Piece, byte: str) -> Expr:
    found = moved(Atom(byte.format(piece.byte)), ">>", number(piece.right))
    if piece.mask << piece.right & 0xFF != 0xFF >> piece.right << piece.right:
        found = Operation(found, "&", mask(piece.mask))
    return moved(found, "<<", number(piece.left))
