# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encoders whose positions are angles or lengths, and encoders whose positions wrap around."""

from __future__ import annotations

from fractions import Fraction
from math import tau

from .codec import PositionRange, check_limits, unwrap, whole_number
from .encoder import Encoder


class Rotary(Encoder):
    """Encoder whose positions are angles. If the interface has none, the methods raise ValueError."""

    @property
    def counts_per_turn(self) -> int:
        """Number of counts per revolution."""
        raise NotImplementedError

    def turns(self, position: int) -> float:
        """Convert ``position`` from counts to revolutions.

        For counts of ``unwrap``, which continue outside the range of positions, divide by ``counts_per_turn``.

        Raises:
            RangeError: The encoder does not send such a position.
            TypeError: ``position`` is not an integer.
        """
        return self._check_position(position) / self.counts_per_turn

    def degrees(self, position: int) -> float:
        """Convert ``position`` from counts to degrees within one revolution.

        A count of ``unwrap`` can be outside the range of positions. Such a count is at the same angle as the position
        from which it was computed. For continuous degrees, multiply by 360 and divide by ``counts_per_turn``.

        Raises:
            RangeError: The encoder does not send such a position.
            TypeError: ``position`` is not an integer.
        """
        per_turn = self.counts_per_turn
        return self._check_position(position) % per_turn * 360 / per_turn

    def radians(self, position: int) -> float:
        """Convert ``position`` from counts to radians within one revolution.

        Raises:
            RangeError: The encoder does not send such a position.
            TypeError: ``position`` is not an integer.
        """
        per_turn = self.counts_per_turn
        return self._check_position(position) % per_turn * tau / per_turn

    def _check_position(self, position: int) -> int:
        """Return a position as an int. Raises RangeError if it is outside a known range of positions."""
        number = whole_number("position", position)
        limits = self._find_limits()
        return number if limits is None else check_limits("position", number, limits)

    def _find_limits(self) -> tuple[int, int] | None:
        """Return the lowest and the highest position in any frame, or None if the manual does not give them."""
        ranges = [*self._position_ranges().values()]
        if not ranges:
            # There is one range for all frames, so the name of the frame does not matter. Without a range in the
            # manual, this raises ValueError.
            try:
                ranges = [self._range_in("")]
            except ValueError:
                return None
        lowest = min(position_range.lowest for position_range in ranges)
        highest = max(position_range.highest for position_range in ranges)
        return lowest, highest

    def from_turns(self, turns: float) -> int:
        """Return the count nearest to ``turns`` revolutions."""
        return round(turns * self.counts_per_turn)

    def from_degrees(self, degrees: float) -> int:
        """Return the count nearest to ``degrees``."""
        return round(degrees * self.counts_per_turn / 360)

    def from_radians(self, radians: float) -> int:
        """Return the count nearest to ``radians``."""
        return round(radians * self.counts_per_turn / tau)


class Length(Encoder):
    """Encoder whose positions are lengths. If the interface has none, the methods raise ValueError."""

    def micrometres(self, position: int) -> int | Fraction:
        """Convert ``position`` from counts to micrometers, without rounding."""
        raise NotImplementedError

    def millimetres(self, position: int) -> float:
        """Convert ``position`` from counts to millimeters."""
        return float(self.micrometres(position) / 1000)

    def metres(self, position: int) -> float:
        """Convert ``position`` from counts to meters."""
        return float(self.micrometres(position) / 1_000_000)

    def from_millimetres(self, millimetres: float) -> int:
        """Return the count nearest to ``millimetres``."""
        return round(millimetres * 1000 / self.micrometres(1))


class Linear(Length):
    """Encoder whose positions are lengths in whole micrometers."""

    @property
    def step_um(self) -> int:
        """Length of one count in micrometers."""
        raise NotImplementedError

    def micrometres(self, position: int) -> int:
        """Convert ``position`` from counts to micrometers."""
        return whole_number("position", position) * self.step_um


class FineLinear(Length):
    """Encoder whose positions are lengths, and whose counts are not a whole number of micrometers."""

    @property
    def step_nm(self) -> int:
        """Length of ``per_counts`` counts, in nanometers."""
        raise NotImplementedError

    @property
    def per_counts(self) -> int:
        """Number of counts that ``step_nm`` refers to."""
        return 1

    def nanometres(self, position: int) -> Fraction:
        """Convert ``position`` from counts to nanometers, without rounding."""
        return Fraction(whole_number("position", position) * self.step_nm, self.per_counts)

    def micrometres(self, position: int) -> Fraction:
        """Convert ``position`` from counts to micrometers, without rounding."""
        return self.nanometres(position) / 1000


class Wrapping(Encoder):
    """Encoder whose positions wrap around. If the positions do not wrap around, the methods raise ValueError.

    If frame classes have different ranges, ``range_of`` returns the range of one class, and the methods and
    attributes here raise ValueError.
    """

    @property
    def modulus(self) -> int:
        """Number of counts after which the position wraps around."""
        raise NotImplementedError

    @property
    def lowest(self) -> int:
        """Lowest position. It is negative if positions are signed."""
        return 0

    @property
    def highest(self) -> int:
        """Highest position. It can reach ``modulus`` or more if an offset shifts all positions up."""
        return self.modulus - 1

    def unwrap(self, previous: int, position: int) -> int:
        """Return the count nearest to ``previous`` that corresponds to ``position``.

        The count continues when ``position`` wraps around. Between two calls, the encoder must move by less than half
        of ``modulus``.

        Args:
            previous: Result of the previous call. On the first call, pass the first ``position``.
            position: Position in a frame, in counts.

        Returns:
            The count.

        Raises:
            RangeError: ``position`` is above ``highest`` or below ``lowest``.
        """
        return unwrap(previous, position, self.modulus, self.highest, self.lowest)

    def _range_in(self, frame: str, /) -> PositionRange:
        ranges = self._position_ranges()
        return ranges[frame] if ranges else PositionRange(self.lowest, self.highest, self.modulus)
