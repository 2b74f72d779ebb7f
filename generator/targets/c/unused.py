"""The unused bits of a layout in C: one member for all of them, which a decoder fills and an encoder writes back.

In bytes, each bit keeps its place in its byte, so that only whole bytes are shifted.
"""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Field, first_of
from ...plan.codec import ShiftedBits, moved_bits
from ...plan.operations import Reserved
from .bits import Reader
from .expr import Cast, Expr, Name, Number, Operation, joined, masked, shifted_left, shifted_right
from .types import size_of, unsigned

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
