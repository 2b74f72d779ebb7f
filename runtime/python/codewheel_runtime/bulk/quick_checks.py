# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the frame checks that one comparison of whole words can replace."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

from .shape import Check, FrameLayout, holds


class QuickChecks(NamedTuple):
    """Quick checks of a frame. Only frames that fail them are examined for their errors.

    ``fixed`` contains a mask and the required bits of each 64-bit word, lowest word first. ``bytes`` contains the index
    of a byte and its allowed values. ``remaining`` contains all other checks.
    """

    fixed: tuple[tuple[int, int], ...]
    bytes: tuple[tuple[int, tuple[int, ...]], ...]
    remaining: tuple[Check, ...]


class _FixedBits:
    """Bits of a frame that must have certain values."""

    def __init__(self) -> None:
        self.mask = 0
        self.values = 0

    def require(self, lowest_bit: int, mask: int, values: int) -> None:
        """Require that the bits in ``mask`` have these values. Bit 0 of both is bit ``lowest_bit`` of the frame."""
        self.mask |= mask << lowest_bit
        self.values |= (values & mask) << lowest_bit


@lru_cache(maxsize=256)
def find_quick_checks(layout: FrameLayout) -> QuickChecks:
    """Return the checks of a frame in the form that is fastest for many frames.

    Checks are combined into a single comparison of all constant bits, and lists of allowed values for single bytes. If
    the four lowest bits of a frame must be 1010, the result is ``fixed=((0xF, 0xA),)``.
    """
    fixed_bits = _FixedBits()
    remaining: list[Check] = []
    checks_by_byte: dict[int, list[Check]] = {}
    for check in layout.checks:
        # The value of a field without bits is 0.
        has_no_bits = not check.width and not check.parity_of
        if has_no_bits and holds(0, check):
            continue
        covers_unconverted_bits = bool(check.parity_of) and (layout.gray is not None or bool(layout.digit_codings))
        byte_indices = _find_bytes_of(check)
        possible_values = [value for value in check.allowed_values if not (value >> check.width)]
        if covers_unconverted_bits:
            remaining.append(check)
        elif len(byte_indices) == 1:
            checks_by_byte.setdefault(byte_indices.pop(), []).append(check)
        elif len(possible_values) == 1:
            fixed_bits.require(check.lowest_bit, mask=(1 << check.width) - 1, values=possible_values[0])
        else:
            remaining.append(check)
    allowed_by_byte = _combine_checks_of_bytes(checks_by_byte, fixed_bits, remaining)
    fixed = _split_into_words(fixed_bits.mask, fixed_bits.values, bit_count=layout.bit_count)
    return QuickChecks(fixed=fixed, bytes=allowed_by_byte, remaining=tuple(remaining))


def _combine_checks_of_bytes(
    checks_by_byte: Mapping[int, Sequence[Check]], fixed_bits: _FixedBits, remaining: list[Check]
) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Return the bytes that are compared with a list, each with its index and its allowed values.

    ``checks_by_byte`` are the checks that need only one byte, by its index. If they only require constant bits, these
    are added to ``fixed_bits`` instead. If they allow many values, they are added to ``remaining``.
    """
    allowed_by_byte: list[tuple[int, tuple[int, ...]]] = []
    for byte_index, checks in checks_by_byte.items():
        lowest_bit = 8 * byte_index
        allowed_values = [value for value in range(256) if _are_all_met(value << lowest_bit, checks)]
        constant_mask = _find_constant_bits(allowed_values)
        are_other_bits_free = bool(allowed_values) and _has_all_values(allowed_values, constant_mask)
        if are_other_bits_free:
            fixed_bits.require(lowest_bit, constant_mask, values=allowed_values[0])
        elif len(allowed_values) <= _MOST_COMPARED_VALUES:
            allowed_by_byte.append((byte_index, tuple(allowed_values)))
        else:
            remaining += checks
    return tuple(allowed_by_byte)


#: Maximum number of allowed values for which a byte is compared with each of them.
_MOST_COMPARED_VALUES: Final = 8


def _find_constant_bits(values: list[int]) -> int:
    """Return a mask of the bits of a byte that are the same in all of these values."""
    constant_mask = 0xFF
    for value in values:
        constant_mask &= ~(value ^ values[0])
    return constant_mask


def _has_all_values(values: list[int], constant_mask: int) -> bool:
    """Return whether these are all the byte values that have the same constant bits.

    The constant bits are then the whole condition.
    """
    free_bits = 8 - constant_mask.bit_count()
    return len(values) == (1 << free_bits)


def _split_into_words(mask: int, required_bits: int, bit_count: int) -> tuple[tuple[int, int], ...]:
    """Return the mask and the required bits of a frame of ``bit_count`` bits as 64-bit words, lowest word first."""
    word_mask = (1 << 64) - 1
    return tuple(
        ((mask >> lowest_bit) & word_mask, (required_bits >> lowest_bit) & word_mask)
        for lowest_bit in range(0, bit_count, 64)
    )


def _find_bytes_of(check: Check) -> set[int]:
    """Return the indices of the first and last bytes of the checked bits and of each field that a parity bit covers."""
    byte_indices: set[int] = set()
    # A field without bits counts as one bit.
    for lowest_bit, width in (*(check.joined or ((check.lowest_bit, check.width),)), *check.parity_of):
        byte_indices |= {lowest_bit // 8, (lowest_bit + max(width, 1) - 1) // 8}
    return byte_indices


def _are_all_met(number: int, checks: Sequence[Check]) -> bool:
    """Return whether a frame, given as a number, meets all conditions."""
    return all(holds(number, check) for check in checks)
