"""The algebra by which CRCs are computed fast: tables of remainders, and folds for polynomials of few terms."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache


@dataclass(frozen=True, slots=True)
class FoldStep:
    """One step of a table-free CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``.

    Without ``back`` the last part falls away.
    """

    shift: int
    mask: int
    back: int


def reflect(value: int, width: int) -> int:
    """``value`` with its ``width`` bits in the opposite order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def table(width: int, poly: int, reflected: bool = False) -> tuple[int, ...]:
    """For each byte what it leaves of a CRC whose last bits it is: its remainder, moved up by the CRC's width.

    ``reflected`` is for a register that is kept with its bits in the opposite order, as reflected input wants it.
    """
    whole = poly | 1 << width
    if reflected:
        return tuple(reflect(remainder(reflect(byte, 8) << width, whole), width) for byte in range(256))
    return tuple(remainder(byte << width, whole) for byte in range(256))


def word_table(width: int, poly: int) -> tuple[int, ...]:
    """For each byte above the ``max(width, 8)`` bits of a number its remainder: what brings a word down byte by byte as
    it is."""
    return tuple(remainder(byte << max(width, 8), poly | 1 << width) for byte in range(256))


def remainder(number: int, polynomial: int) -> int:
    """Long division of polynomials, ``polynomial`` with its top bit."""
    while number.bit_length() >= polynomial.bit_length():
        number ^= polynomial << (number.bit_length() - polynomial.bit_length())
    return number


def fold_plan(width: int, poly: int, bits: int) -> tuple[FoldStep, ...]:
    """The fewest steps that bring a word of ``bits`` bits down to its remainder modulo x^n + x^m + 1 or x^n + 1.

    Squaring the polynomial k times gives x^(n*2^k) = x^(m*2^k) + 1, so the part of the word above bit n*2^k can be
    added to the part below it once in place and once shifted by m*2^k. For x^n + 1 both places are the same part, added
    once. The largest power is not always the best: a smaller one may leave a word that the next steps bring down
    sooner. Among plans of as many steps the one is taken that is within 32 bits soonest, and then the one of the
    smaller powers: a short mask is a cheaper constant.
    """
    middle = (poly & ~1).bit_length() - 1 if poly & ~1 else 0

    @cache
    def cheapest(left: int) -> tuple[int, int, int, tuple[int, ...]]:
        """Steps, those that leave more than 32 bits, the sum of the powers, and the powers."""
        if left <= width:
            return 0, 0, 0, ()
        plans = []
        for power in range((left - 1).bit_length()):
            shift, back = width << power, middle << power
            if shift < left:
                rest = max(shift, left - shift + back)
                steps, wide, total, powers = cheapest(rest)
                plans.append((steps + 1, wide + (rest > 32), total + power, (power, *powers)))
        return min(plans)

    return tuple(FoldStep(width << power, (1 << (width << power)) - 1, middle << power) for power in cheapest(bits)[-1])
