"""Cyclic redundancy checks: the plain definition, and the table-free plan for polynomials of two or three terms.

Parameters have their usual names: width, poly (without its top bit), init, refin, refout, xorout.
"""

from __future__ import annotations

from functools import cache

from ..model import Crc, FoldStep, Form


def reflect(value: int, width: int) -> int:
    """Return ``value`` with its ``width`` bits in reverse order."""
    return int(f"{value:0{width}b}"[::-1], 2)


def compute_bits(crc: Crc, number: int, bits: int) -> int:
    """Compute the CRC over ``bits`` bits of ``number``, most significant first, bit by bit as in the definition.

    ``refin`` has no meaning for a string of bits and is ignored.
    """
    register = crc.init
    top = 1 << (crc.width - 1)
    for index in range(bits - 1, -1, -1):
        feedback = bool(register & top) != bool(number >> index & 1)
        register = (register << 1) & crc.mask
        if feedback:
            register ^= crc.poly
    if crc.refout:
        register = reflect(register, crc.width)
    return register ^ crc.xorout


def compute_bytes(crc: Crc, data: bytes) -> int:
    """Compute the CRC over whole bytes, each least significant bit first if ``refin`` is set."""
    number = 0
    for byte in data:
        number = number << 8 | (reflect(byte, 8) if crc.refin else byte)
    return compute_bits(crc, number, 8 * len(data))


def polynomial_text(width: int, poly: int) -> str:
    """Return the generator polynomial in the form ``x^6 + x + 1``."""
    powers = [width, *(power for power in range(width - 1, -1, -1) if poly >> power & 1)]
    return " + ".join({0: "1", 1: "x"}.get(power, f"x^{power}") for power in powers)


def form(width: int, poly: int, init: int, refin: bool, refout: bool) -> Form:
    """Return the form in which code should compute a CRC with these parameters."""
    if init == 0 and poly & 1:
        if width == 8 and poly == 1 and refin == refout:
            return Form.XOR
        if poly.bit_count() <= 2 and not refin and not refout:
            return Form.FOLD
    return Form.TABLE


def table(width: int, poly: int, reflected: bool = False) -> tuple[int, ...]:
    """Return the table of remainders of every byte shifted left by the CRC's width.

    ``reflected`` is for a register with its bits in reverse order, as needed for reflected input.
    """
    whole = poly | 1 << width
    if reflected:
        return tuple(reflect(remainder(reflect(byte, 8) << width, whole), width) for byte in range(256))
    return tuple(remainder(byte << width, whole) for byte in range(256))


def word_table(width: int, poly: int) -> tuple[int, ...]:
    """Return the table of remainders of every byte above the lowest ``max(width, 8)`` bits of a number.

    It reduces a whole word byte by byte.
    """
    return tuple(remainder(byte << max(width, 8), poly | 1 << width) for byte in range(256))


def remainder(number: int, polynomial: int) -> int:
    """Return the remainder of a long division of polynomials. ``polynomial`` includes its top bit."""
    while number.bit_length() >= polynomial.bit_length():
        number ^= polynomial << (number.bit_length() - polynomial.bit_length())
    return number


def fold_plan(width: int, poly: int, bits: int) -> tuple[FoldStep, ...]:
    """Return the fewest steps that reduce a word of ``bits`` bits to its remainder modulo x^n + x^m + 1 or x^n + 1.

    Squaring the polynomial k times gives x^(n*2^k) = x^(m*2^k) + 1, so the part of the word above bit n*2^k can be
    added to the part below it once in place and once shifted by m*2^k. For x^n + 1 both places are the same part, added
    once. The largest power is not always the best: a smaller one may leave a word that the next steps reduce faster.
    Among plans with equally many steps, the best is the one that gets within 32 bits first, and then the one with the
    smaller powers, since a short mask is a cheaper constant.
    """
    middle = (poly & ~1).bit_length() - 1 if poly & ~1 else 0

    @cache
    def cheapest(left: int) -> tuple[int, int, int, tuple[int, ...]]:
        """Return the steps, those that leave more than 32 bits, the sum of the powers, and the powers."""
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
