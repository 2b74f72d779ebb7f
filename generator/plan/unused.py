"""Unused bits of a layout that a decoder extracts together, since the same shift moves them to their places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model.record import dataclass
from .codec import Codec, Reserved


@dataclass(frozen=True, slots=True)
class ShiftedBits:
    """Unused bits with one shift: bit 0 of the member is bit ``shift`` of the ``byte``, or of the word if it is None.

    ``mask`` and ``value``, the value in the manual, have the places of the member.
    """

    byte: int | None
    shift: int
    mask: int
    value: int


def moved_bits(codec: Codec) -> tuple[ShiftedBits, ...]:
    """Return the unused bits whose position is the same for every order code. Those with the same shift are one."""
    bits_by_shift: dict[tuple[int | None, int], ShiftedBits] = {}
    for op in codec.reserved:
        for bits in _moved_bits_of_field(op, codec.by_word) if op.bits.are_fixed else ():
            bits_so_far = bits_by_shift.get((bits.byte, bits.shift), replace(bits, mask=0, value=0))
            mask, value = bits_so_far.mask | bits.mask, bits_so_far.value | bits.value
            bits_by_shift[bits.byte, bits.shift] = replace(bits, mask=mask, value=value)
    return tuple(bits_by_shift.values())


def _moved_bits_of_field(op: Reserved, by_word: bool) -> Iterator[ShiftedBits]:
    """Yield the bits of a field, in the word or byte by byte."""
    if by_word:
        yield ShiftedBits(None, op.bits.low.constant - op.place, op.mask, op.value << op.place)
        return
    for piece in op.bits.pieces:
        place = op.place + piece.left
        mask = piece.mask << place
        yield ShiftedBits(piece.byte, piece.right - place, mask, op.value << op.place & mask)
