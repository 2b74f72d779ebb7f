"""Expressions that extract the bits of fields, and the unused bits of a layout.

In bytes, each bit keeps its place in its byte, so that only whole bytes are shifted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ...model import Digits, Field, Piece, first_of
from ...model.record import dataclass
from ...plan.codec import Codec, ShiftedBits, moved_bits
from ...plan.operations import Bits, Reserved, Whole
from .names import (
    Call,
    Cast,
    Expr,
    Name,
    Number,
    Operation,
    Scope,
    joined,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)


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
    as_sent: bool = False

    @property
    def word(self) -> Expr:
        """The word, with any Gray code in it converted unless the reader is for the bits ``as_sent``."""
        return Name("plain" if self.plan.gray is not None and not self.as_sent else "word")

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
        return Cast("uint32_t", self.word) if high <= 32 else self.word

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

    def sent(self, field: Field) -> Expr:
        """Return the bits of a field before any Gray code in the word is converted."""
        return replace(self, as_sent=True).value(self.plan.bits_of(field.name))[1]

    def parity_as_sent(self, fields: Sequence[Field], mask: int) -> Expr:
        """Return the parity of fields before any Gray code in the word is converted."""
        return self.parity([(self.sent(field), field.widest) for field in fields], mask)

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


_MEMBER = Name("in->unused")


class Unused:
    """The member ``unused`` of a struct. It is false if the layout has no unused bits."""

    def __init__(self, reader: Reader) -> None:
        self.reader, self.plan = reader, reader.plan
        self.width = self.plan.layout.unused_width
        #: If one of them depends on the order code, each is extracted alone.
        are_fixed = all(op.bits.are_fixed for op in self.plan.reserved)
        self.single = () if are_fixed else self.plan.reserved
        self.moved = () if self.single else moved_bits(self.plan)

    def __bool__(self) -> bool:
        return bool(self.plan.reserved)

    @property
    def type(self) -> str:
        return unsigned(self.width)

    @property
    def depends(self) -> bool:
        """True if an encoder needs the variant for it."""
        return bool(self.single)

    # -- decoding

    @property
    def member(self) -> Expr:
        """The member, from the word, or from bytes if the fields are extracted one by one."""
        parts = (*map(self._moved_bits, self.moved), *map(self._single_bits, self.single))
        documented = sum(bits.value for bits in self.moved)
        return Cast(self.type, _with_inverted(joined("|", parts), _documented(documented)))

    def at_place(self, moved: ShiftedBits, byte: Expr) -> Expr:
        """Return a byte shifted to the place of its bits in the member."""
        return shifted_left(Cast(self.work, byte), -moved.shift) if moved.shift else byte

    def member_from(self, bits: Expr) -> Expr:
        """Return the member from bytes that are at their positions."""
        mask = sum(moved.mask for moved in self.moved)
        value = sum(moved.value for moved in self.moved)
        inverted = _with_inverted(masked(bits, mask), _documented(value))
        return inverted if self.type == self.work else Cast(self.type, inverted)

    @property
    def work(self) -> str:
        """The type in which a decoder assembles bytes."""
        return unsigned(max(self.width, 32))

    def _moved_bits(self, moved: ShiftedBits) -> Expr:
        word = self.reader.lower(moved.mask.bit_length() + moved.shift)
        if moved.shift >= 0:
            return masked(shifted_right(word, moved.shift), moved.mask)
        return shifted_left(masked(word, moved.mask >> -moved.shift), -moved.shift)

    def _single_bits(self, op: Reserved) -> Expr:
        bits, documented = self.reader.value(op.bits)[1], self._documented(op)
        if not op.place:
            return _with_inverted(bits, documented)
        turned = _with_inverted(Cast(self.work, bits), documented)
        # The mask of a variable width has 64 bits.
        return shifted_left(turned if op.bits.width.is_constant else Cast(self.work, turned), op.place)

    # -- encoding

    @property
    def refused(self) -> Expr | None:
        """The condition that the member has a bit other than the unused ones, or None if its type has no such bit."""
        varying = [op for op in self.single if not op.bits.width.is_constant]
        fixed = sum(op.mask for op in self.plan.reserved if op.bits.width.is_constant)
        if not varying:
            other_bits = fixed ^ ((1 << size_of(self.width)) - 1)
            return Operation("!=", (masked(_MEMBER, other_bits), Number(0))) if fixed and other_bits else None
        masks = [shifted_left(self.reader.scope.mask(op.bits.width), op.place) for op in varying]
        masks += [Number(fixed, hexadecimal=True)] if fixed else []
        return Operation("!=", (Operation("&", (_MEMBER, joined("|", tuple(masks)))), _MEMBER))

    @property
    def in_word(self) -> Iterator[Expr]:
        """The terms of a word that come from it."""
        is_all = len(self.moved) + len(self.single) == 1
        for moved in self.moved:
            bits = _with_inverted(_MEMBER if is_all else masked(_MEMBER, moved.mask), _documented(moved.value))
            yield _shifted(Cast("uint64_t", bits), -moved.shift)
        for op in self.single:
            bits = _with_inverted(_MEMBER, self._documented(op)) if is_all else self._given(op)
            low = op.bits.low
            yield shifted_left(Cast("uint64_t", bits), low.constant if low.is_constant else self.reader.scope.of(low))

    @property
    def in_bytes(self) -> Iterator[tuple[int, Expr]]:
        """The terms of bytes that come from it."""
        for moved in self.moved:
            assert moved.byte is not None
            mask, value = moved.mask >> -moved.shift, moved.value >> -moved.shift
            bits = _masked_byte(shifted_right(_MEMBER, -moved.shift), mask)
            is_wider = bits is _MEMBER and self.width > 8
            yield moved.byte, _with_inverted(Cast("uint8_t", bits) if is_wider else bits, _documented(value))
        for op in self.single:
            for piece in op.bits.pieces:
                yield (
                    piece.byte,
                    _shifted(_masked_byte(shifted_right(self._given(op), piece.left), piece.mask), -piece.right),
                )

    def bits_of(self, field: Field) -> Expr:
        """Return the bits of one field."""
        operations = (op for op in self.plan.reserved if op.field is field)
        return self._given(first_of(operations, f"unused field '{field.name}'"))

    def _given(self, op: Reserved) -> Expr:
        return _with_inverted(shifted_right(masked(_MEMBER, op.mask), op.place), self._documented(op))

    # -- both

    def _documented(self, op: Reserved) -> Expr | None:
        """Return the value in the manual of a field that may be narrower with this order code."""
        value = _documented(op.value)
        if value is None or op.bits.width.is_constant:
            return value
        return Operation("&", (value, self.reader.scope.mask(op.bits.width)))


def _masked_byte(bits: Expr, mask: int) -> Expr:
    """Return these bits of a number. A later cast to one byte drops the higher bits."""
    return bits if mask == 0xFF else masked(bits, mask)


def _documented(value: int) -> Expr | None:
    """Return the value in the manual, or None if that is 0."""
    return Number(value, hexadecimal=True) if value else None


def _with_inverted(bits: Expr, by: Expr | None) -> Expr:
    """Return the bits, with the ones in ``by`` inverted."""
    return Operation("^", (bits, by)) if by is not None else bits


def _shifted(bits: Expr, by: int) -> Expr:
    """Return ``bits`` shifted to the right, or to the left if ``by`` is negative."""
    return shifted_left(bits, -by) if by < 0 else shifted_right(bits, by)
