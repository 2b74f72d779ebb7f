"""Count the errors that a CRC cannot detect, by the length of the frame."""

from __future__ import annotations

from collections import Counter
from itertools import combinations
from math import comb

from ..model import Crc
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class Residual:
    """Errors that a CRC misses in a frame of ``bits`` bits. It detects every error of fewer than ``distance`` bits.

    Of ``patterns`` errors of exactly ``distance`` bits, it misses ``missed``. Errors of more than four bits are not
    counted, so ``missed`` is 0 if ``distance`` is 5.
    """

    bits: int
    distance: int
    missed: int

    @property
    def patterns(self) -> int:
        return comb(self.bits, self.distance)


def residual(crc: Crc, bits: int) -> Residual:
    """Return what ``crc`` misses in a frame of ``bits`` bits, including the CRC itself.

    Start value, final XOR and order of the bits do not matter, since they are the same in the frame that was sent and
    in the one that was received.
    """
    remainders, remainder = [], 1
    for _ in range(bits):
        remainders.append(remainder)
        remainder <<= 1
        if remainder >> crc.width:
            remainder ^= crc.poly_with_top_bit
    pairs = Counter(first ^ second for first, second in combinations(remainders, 2))
    # Three pairs of bits cancel a third bit in each triple, and three pairs of pairs are equal in each four.
    triples = sum(pairs[remainder] for remainder in remainders) // 3
    fours = sum(count * (count - 1) // 2 for count in pairs.values()) // 3
    missed = {2: pairs[0], 3: triples, 4: fours}
    distance = next((error_bits for error_bits, count in missed.items() if count), 5)
    return Residual(bits, distance, missed.get(distance, 0))
