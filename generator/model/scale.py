"""Quantity that a number stands for, such as a temperature."""

from __future__ import annotations

from itertools import count
from math import gcd
from typing import TYPE_CHECKING

from .facts import Sources
from .record import dataclass

if TYPE_CHECKING:
    from fractions import Fraction

#: Widest field that can have a scale. With the limits of the schema, C computes the quantity in 64 bits.
WIDEST = 32


@dataclass(frozen=True, slots=True)
class Scale:
    """The quantity ``(number * numerator + offset) / denominator``, in ``unit``.

    The offset is added before the division, so that three whole numbers express every linear formula exactly.
    """

    numerator: int
    denominator: int
    offset: int
    unit: str
    source: Sources = ()

    def quantity(self, number: int) -> Fraction:
        """Return the exact quantity for a number."""
        from fractions import Fraction

        return Fraction(number * self.numerator + self.offset, self.denominator)

    @property
    def places(self) -> int:
        """Number of decimals: as many as exact decimals need, otherwise enough for a tenth of a count."""
        reduced_denominator = self.denominator // gcd(self.numerator, self.offset, self.denominator)
        exact_places = next(
            (places for places in range(reduced_denominator.bit_length()) if 10**places % reduced_denominator == 0),
            None,
        )
        if exact_places is not None:
            return exact_places
        return next(places for places in count() if 10**places * self.numerator >= 10 * self.denominator)

    def decimal(self, number: int) -> str:
        """Return the quantity for a number as a decimal. If it is not exact, it is rounded."""
        size = abs(number * self.numerator + self.offset)
        scaled = (2 * size * 10**self.places + self.denominator) // (2 * self.denominator)
        sign = "-" if scaled and number * self.numerator + self.offset < 0 else ""
        digits = f"{scaled:0{self.places + 1}}"
        if not self.places:
            return sign + digits
        return f"{sign}{digits[: -self.places]}.{digits[-self.places :]}"

    def is_exact(self, number: int) -> bool:
        """Return True if the decimal is exact."""
        power: int = 10**self.places
        return (number * self.numerator + self.offset) * power % self.denominator == 0
