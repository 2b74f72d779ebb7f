"""Expressions that extract the bits of fields from the word or from the bytes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...model import Digits, Field, Piece
from ...model.record import dataclass
from ...plan.codec import Codec
from ...plan.operations import Bits, Whole
from .expr import Call, Cast, Expr, Name, Number, Operation, Scope, joined, masked, shifted_left, shifted_right
from .types import size_of, unsigned


def of_bytes(pieces: tuple[Piece, ...]) -> tuple[str, Expr]:
    """Return the type and the bits in these pieces of ``bytes``, or 0 if no order code has such bits."""
    if not pieces:
        return unsigned(1), Number(0)
    bits = sum(piece.mask.bit_length() for piece in pieces)
    kind, work = unsigned(bits), "uint64_t" if bits > 32 else "uint32_t"
    if len(pieces) == 1:
        part = _bits_of_piece(pieces[0])
        return kind, part if isinstance(part, Name) else Cast("uint8_t", part)
    parts = joined("|", tuple(shifted_left(Cast(work, _bits_of_piece(piece)), piece.left) for piece in pieces))
    return kind, parts if kind == work else Cast(kind, parts)


def _bits_of_piece(piece: Piece) -> Expr:
    """Return the bits of a byte that belong to a field, shifted to bit 0."""
    part = shifted_right(Name(f"bytes[{piece.byte}]"), piece.right)
    reaches_top = piece.right + piece.mask.bit_length() == 8
    return part if reaches_top else masked(part, piece.mask)


@dataclass(frozen=True)
class Reader:
    """Expressions that extract the fields of a layout: from the word if there is one, otherwise from the bytes."""

    plan: Codec
    scope: Scope

    @property
    def word(self) -> Expr:
        """The word, with any Gray code in it converted."""
        return Name("plain" if self.plan.gray is not None else "word")

    def value(self, bits: Bits) -> tuple[str, Expr]:
        """Return the type and the bits of a field, with its padding if that is read as well."""
        if not self.plan.by_word:
            return of_bytes(bits.pieces)
        kind = unsigned(bits.widest)
        if bits.are_fixed and bits.width.constant == 64:
            return kind, self.word
        number = self.in_word(bits)
        return kind, number if bits.widest > 32 and not bits.are_fixed else Cast(kind, number)

    def in_word(self, bits: Bits) -> Expr:
        """Return bits of the word. If their place is fixed and in the lower half, the expression has 32 bits."""
        if bits.are_fixed:
            low, width = bits.low.constant, bits.width.constant
            return masked(shifted_right(self.lower(low + width), low), (1 << width) - 1)
        if not bits.on_top:
            return Call("cw_field", (self.word, self.scope.of(bits.low), self.scope.of(bits.width)))
        # There are no bits above it: the length has been checked.
        if bits.low.is_constant:
            return shifted_right(self.word, bits.low.constant)
        return Call("cw_above", (self.word, self.scope.of(bits.low)))

    def flag(self, bits: Bits) -> Expr:
        """Return the bit of a flag at its position: in the word, or in the byte ``flags``."""
        if not self.plan.by_word:
            return masked(Name("flags"), bits.pieces[0].mask << bits.pieces[0].right)
        if not bits.are_fixed:
            return self.in_word(bits)
        return masked(self.lower(bits.low.constant + 1), 1 << bits.low.constant)

    def lower(self, high: int) -> Expr:
        """Return the word, or its lower half if the bits below ``high`` are enough."""
        return Cast("uint32_t", self.word) if high <= 32 < self.plan.layout.widest else self.word

    def whole(self, whole: Whole, name_of: Callable[[Field], Expr]) -> Expr:
        """Return a join as one number: from the word if its fields are adjacent, otherwise from its fields by name."""
        if whole.bits is None:
            return self.joined(whole, name_of)
        number = self.in_word(whole.bits)
        return number if whole.widest > 32 else Cast(unsigned(whole.widest), number)

    def joined(self, whole: Whole, name_of: Callable[[Field], Expr]) -> Expr:
        """Return the fields of a join as one number of the join's type."""
        first, *lower_fields = whole.fields
        kind = unsigned(whole.widest)
        # Several operands below 32 bits would make the result signed.
        is_promoted = len(lower_fields) > 1 and size_of(whole.widest) < 32
        number: Expr = Cast("uint32_t" if is_promoted else kind, name_of(first))
        for field in lower_fields:
            number = Operation("|", (shifted_left(number, self.scope.of(field.width)), name_of(field)))
        return Cast(kind, number) if lower_fields and size_of(whole.widest) < 32 else number

    def parity(self, parts: Sequence[tuple[Expr, int]], mask: int) -> Expr:
        """Return the common parity of these numbers, 1 for an odd number of ones. Each comes with its largest width.

        ``mask`` is the mask of the bits that count, or 0 if all of them count.
        """
        widest = max(width for _, width in parts)
        kind = unsigned(max(widest, 32))
        (number, _), *further = parts
        if further:
            number = Operation("^", tuple(Cast(kind, part) for part, _ in parts))
        if mask:
            number = masked(number, mask)
        if widest > 32:
            number = Operation("^", (Cast("uint32_t", number), Cast("uint32_t", shifted_right(number, 32))))
        return Call("cw_parity", (number,))


def digits(number: object, field: Field, run: Digits) -> Expr:
    """Return a run of decimal digits extracted from a number."""
    name = Name(str(number))
    above = Operation("/", (name, Number(run.divisor))) if run.divisor > 1 else name
    return above if run is field.runs[0] else Operation("%", (above, Number(run.modulus)))
