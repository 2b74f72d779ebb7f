"""SSI interface of a virtual encoder: words, and the data line clock by clock."""

from __future__ import annotations

from ..model import Layout
from .encoder import VirtualEncoder
from .faults import BUSY_S, disturbed
from .levels import ByLevels


class SsiLine(ByLevels):
    """SSI line with one encoder.

    Args:
        encoder: The encoder.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder) -> None:
        if encoder.variant.interface != "ssi":
            raise ValueError(f"{encoder.variant.code} has no SSI")
        self.encoder = encoder
        super().__init__()
        self._left, self._word = -1, 0
        self._level = self._data = 1

    @property
    def bits(self) -> int:
        """Number of bits of a word."""
        return self.encoder.place(self._layout).bits

    @property
    def _layout(self) -> Layout:
        return self.encoder.layouts("encoder")[0]

    @property
    def _is_not_ready(self) -> bool:
        """True if the encoder is busy and no flag can report it, so that it keeps the data line low."""
        encoder = self.encoder
        return encoder.is_busy() and not encoder.is_off() and not encoder.reports_busy

    def word(self) -> int:
        """Return the current word, which a fault can change. The first bit sent is the most significant."""
        fault = self.encoder.faults.draw()
        if fault == "busy":
            self.encoder.be_busy(BUSY_S)
        word = 0 if self._is_not_ready else self.encoder.frame(self._layout)
        return disturbed(self.encoder, fault, word, self.bits)

    def clock(self, level: int) -> int:
        """Set the level of the clock, and return that of the data line. Zeros follow the word."""
        if level and not self._level:
            if self._left < 0:
                self._word, self._left = self.word(), self.bits
            self._left -= self._left > 0
            self._data = self._word >> self._left & 1
            self._word &= (1 << self._left) - 1
        self._level = level
        return self._data

    def timeout(self) -> int:
        """Let the pause after a word pass. The data line is then high, unless the encoder is busy."""
        self._left, self._data = -1, int(not self._is_not_ready)
        return self._data
