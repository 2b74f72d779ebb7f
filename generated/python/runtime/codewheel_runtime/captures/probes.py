# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Arguments about the connection and the timing of a capture."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

from ..errors import UsageError
from .signals import SignalNames


class Probes(NamedTuple):
    """Connection and timing of a capture.

    Attributes:
        clock: Channel of the clock (MA), by name or by number from 1. By default, a channel with a common name.
        data: Channel of the data line (SLO), or of the serial line.
        rate: Sample rate in Hz, needed if the file does not specify it.
        shortest_pause: Shortest pause of the clock between two cycles, in seconds, or in samples if the sample rate is
            unknown. The default is 1.4 periods. Use a longer pause if the master pauses within a frame.
        baud: Bits per second on a serial line, if they differ from the manual, or bits per sample if the sample rate is
            unknown.
        threshold: Voltage above which the level is 1, for a table of voltages. The default is the middle of their
            range.
    """

    clock: str | int = ""
    data: str | int = ""
    rate: float | None = None
    shortest_pause: float | None = None
    baud: float | None = None
    threshold: float | None = None

    def check_numbers(self) -> None:
        """Raise UsageError unless the rates and the pause of the clock are above 0 and the threshold is finite.

        None is always accepted.
        """
        # The pause is the argument ``rest``.
        for name, number in (("rate", self.rate), ("rest", self.shortest_pause), ("baud", self.baud)):
            if number is not None and not (_is_finite(number) and number > 0):
                raise UsageError(f"{name} must be a number above 0, got {number!r}")
        if self.threshold is not None and not _is_finite(self.threshold):
            raise UsageError(f"threshold must be a number, got {self.threshold!r}")

    def signal_names(self, *, has_clock: bool) -> SignalNames:
        """Return the chosen channels of the clock and the data line. Without a clock, return that of the data line.

        Raises UsageError if a channel is neither a name nor a number.
        """
        for channel in (self.clock, self.data):
            if not isinstance(channel, (str, int)) or isinstance(channel, bool):
                raise UsageError(f"a channel is a name or a number from 1, got {channel!r}")
        clock = str(self.clock) if has_clock else None
        return SignalNames(clock=clock, data=str(self.data))


def _is_finite(number: object) -> bool:
    """Return whether an argument is a finite number."""
    return isinstance(number, (int, float)) and not isinstance(number, bool) and isfinite(number)
