"""Algebra for fast CRCs: tables of remainders, and table-free reduction for polynomials with few terms."""

from __future__ import annotations

from functools import cache

from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class FoldStep:
    """One step of a table-free CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``.

    If ``back`` is 0, the last term is absent.
    """

    shift: int
    mask: int
    back: int


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def table(width: int, poly: int, reflected: bool = False) -> tuple[int, ...]:
    """Return the remainder of each byte, shifted left by the width of the CRC.

    With ``reflected``, the CRC register has its bits in reverse order, as needed for reflected input.
    """
    whole = poly | 1 << width
    if reflected:
        return tuple(reflect(remainder(reflect(byte, 8) << width, whole), width) for byte in range(256))
    return tuple(remainder(byte << width, whole) for byte in range(256))


def word_table(width: int, poly: int) -> tuple[int, ...]:
    """Return the remainder of each byte above the lowest ``max(width, 8)`` bits, used to reduce a word byte by byte."""
    return tuple(remainder(byte << max(width, 8), poly | 1 << width) for byte in range(256))


def remainder(number: int, polynomial: int) -> int:
    """Return the remainder of long division by ``polynomial``, which includes its top bit."""
    while number.bit_length() >= polynomial.bit_length():
        number ^= polynomial << (number.bit_length() - polynomial.bit_length())
    return number


def fold_plan(width: int, poly: int, bits: int) -> tuple[FoldStep, ...]:
    """Return the fewest steps that reduce a word of ``bits`` bits to its remainder modulo x^n + x^m + 1 or x^n + 1.

    Squaring the polynomial k times gives x^(n*2^k) = x^(m*2^k) + 1, so the part of the word from bit n*2^k up can be
    added to the lower part twice, once shifted to bit 0 and once to bit m*2^k. For x^n + 1, it is added only once. The
    largest power is not always the best, since a smaller one may leave a word that needs fewer further steps. Among
    plans with the same number of steps, the function chooses the one that reaches 32 bits soonest, and then the one
    with the smallest powers, since a short mask is a cheaper constant.
    """
    middle = (poly & ~1).bit_length() - 1 if poly & ~1 else 0

    @cache
    def cheapest(bits_left: int) -> tuple[int, int, int, tuple[int, ...]]:
        """Return the number of steps, of those with results above 32 bits, the exponents' sum, and the exponents."""
        if bits_left <= width:
            return 0, 0, 0, ()
        plans = []
        for power in range((bits_left - 1).bit_length()):
            shift, second_shift = width << power, middle << power
            if shift < bits_left:
                next_bits = max(shift, bits_left - shift + second_shift)
                steps, wide, total, powers = cheapest(next_bits)
                plans.append((steps + 1, wide + (next_bits > 32), total + power, (power, *powers)))
        return min(plans)

    return tuple(FoldStep(width << power, (1 << (width << power)) - 1, middle << power) for power in cheapest(bits)[-1])
