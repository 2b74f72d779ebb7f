"""Clocked line as bytes, so that a socket can carry it: a clock level for each level of the data line."""

from __future__ import annotations

from abc import ABC, abstractmethod

#: Bytes with which the master lets the time-out pass, and the clock go low and high.
TIMEOUT, CLOCK = b"TC"


class ByLevels(ABC):
    """Line whose master sends ``0`` or ``1`` for each level of the clock, ``C`` for 0 and 1, and ``T`` for a time-out.

    Each byte is answered by the level of the data line after it, ``0`` or ``1``. Other bytes are ignored.
    """

    def __init__(self) -> None:
        self._levels = bytearray()

    @abstractmethod
    def clock(self, level: int) -> int:
        """Set the level of the clock, and return that of the data line."""

    @abstractmethod
    def timeout(self) -> int:
        """Let the time-out pass, and return the level of the data line."""

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends."""
        for byte in data:
            if byte in b"01":
                self._levels.append(ord("0") + self.clock(byte & 1))
            elif byte == CLOCK:
                self.clock(0)
                self._levels.append(ord("0") + self.clock(1))
            elif byte == TIMEOUT:
                self._levels.append(ord("0") + self.timeout())

    def send(self) -> bytes:
        """Return each answer once."""
        data = bytes(self._levels)
        self._levels.clear()
        return data

    def due(self) -> float | None:
        """Return None, because the answers never wait."""
        return None
