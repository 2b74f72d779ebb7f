"""BiSS and SSI interfaces of a virtual encoder, clock by clock, and their levels as bytes for a socket.

Source of the protocol: "BiSS Interface, Protocol Description (BiSS C)", Rev C6, iC-Haus, pages 3 to 14.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator

from ..model import Crc, Layout
from ..reference.bits import compute_bits
from .encoder import VirtualEncoder
from .faults import BUSY_S, word_with_fault

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


#: Number of zeros after which a control frame can start, and that abort one.
ZEROS = 14
#: CRC of control data: x^4 + x + 1, inverted.
_CRC = Crc(name="control", width=4, poly=0x3, init=0, refin=False, refout=False, xorout=0xF, source=())
#: Fewest and most clocks by which the start bit is late.
_LATE = {"late": (1, 8), "busy": (9, 40)}


class BissLine(ByLevels):
    """BiSS line with one encoder, which has the ID 0.

    Args:
        encoder: The encoder.
        acknowledge: Number of zeros before the start bit.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder, acknowledge: int = 3) -> None:
        if encoder.variant.interface != "biss":
            raise ValueError(f"{encoder.variant.code} has no BiSS")
        super().__init__()
        self.encoder, self.acknowledge = encoder, acknowledge
        self._access: Generator[int, int, int] | None = None
        self._zeros = 0
        self._ma, self._edges, self._cdm = 1, 0, 0
        self._bits: list[int] = []

    @property
    def bits(self) -> int:
        """Number of bits of the single cycle data, CRC included."""
        return self.encoder.place(self.encoder.layouts("encoder")[0]).bits

    def frame(self) -> int:
        """Return the current single cycle data. The first bit sent is the most significant."""
        return self.exchange(0)[1]

    def exchange(self, cdm: int) -> tuple[int, int]:
        """Carry out one cycle.

        Args:
            cdm: CDM bit of the previous cycle.

        Returns:
            The CDS bit of this cycle, and its single cycle data.
        """
        data = self.cycle(cdm)
        start = self.acknowledge + 1
        return data[start], int("".join(map(str, data[start + 1 : start + 1 + self.bits])), 2)

    def cycle(self, cdm: int) -> list[int]:
        """Return the bits of a cycle from the second rising edge of MA: acknowledge, start, CDS, data, stop."""
        encoder, faults = self.encoder, self.encoder.faults
        fault = faults.draw()
        cds = self._control(cdm)
        word = encoder.frame(encoder.layouts("encoder")[0])
        data = [word >> shift & 1 for shift in range(self.bits - 1, -1, -1)]
        late = [0] * faults.random.randint(*_LATE.get(fault, (0, 0)))
        bits = [*[0] * self.acknowledge, *late, 1, cds, *data, 0]
        if fault == "low":
            bits = [0] * len(bits)
        elif fault in ("high", "lost", "restart") or encoder.is_off():
            bits = [1] * len(bits)
        elif fault == "flip":
            bits[faults.random.randrange(self.acknowledge + 1, len(bits) - 1)] ^= 1
        elif fault in ("short", "brownout"):
            last_zero = len(data) - 1 - data[::-1].index(0) if 0 in data else 0
            first_lost = faults.random.randint(self.acknowledge, self.acknowledge + 2 + last_zero)
            bits[first_lost:] = [1] * (len(bits) - first_lost)
        if fault in ("restart", "brownout"):
            encoder.restart()
            self._access = None
        elif fault == "busy":
            encoder.be_busy(BUSY_S)
        return bits

    def clock(self, ma: int) -> int:
        """Set the level of MA, and return the resulting level of SLO."""
        if ma and not self._ma:
            self._edges += 1
            if self._edges == 1:
                self._bits = self.cycle(self._cdm)
        self._ma = ma
        if self._edges < 2:
            return 1
        return self._bits[self._edges - 2] if self._edges - 2 < len(self._bits) else 0

    def timeout(self) -> int:
        """Let the time-out pass. The inverse of the level of MA is the CDM bit. SLO is then high."""
        self._cdm, self._edges = 1 - self._ma, 0
        return 1

    def _control(self, cdm: int) -> int:
        """Take the CDM bit of the previous cycle, and return the CDS bit of this one."""
        ready = self._zeros >= ZEROS
        self._zeros = 0 if cdm else self._zeros + 1
        if self._zeros >= ZEROS:
            self._access = None
        elif self._access is not None:
            try:
                return self._access.send(cdm)
            except StopIteration as ended:
                self._access = None
                return int(ended.value)
        elif cdm and ready:
            self._access = self._registers()
            return next(self._access)
        return 0

    def _registers(self) -> Generator[int, int, int]:
        """Answer one control frame: yield CDS bits, receive the next CDM bit for each, and return the last CDS bit."""
        memory = self.encoder.memory
        read, head = yield from _receive_head()
        address = head >> 4 & 0x7F
        if head >> 11 != 0b1000 or head & 0xF != compute_bits(_CRC, head >> 4, 11):
            return 0
        write = yield read
        if read == write:
            return write
        allowed = memory.writable if write else memory.readable
        if not allowed(address):
            return 1 - write
        cdm = yield write
        while cdm:
            while self.encoder.is_busy():
                cdm = yield 0
                if not cdm:
                    return 0
            if write:
                cdm, is_valid = yield from self._write_byte(address)
                if not is_valid:
                    return cdm
            else:
                cdm = yield from self._read_byte(address)
            if cdm or address & 0x3F == 0x3F or not allowed(address + 1):
                return 1
            address += 1
            cdm = yield 0
        return 0

    def _write_byte(self, address: int) -> Generator[int, int, tuple[int, bool]]:
        """Receive a byte and its CRC. Return the next CDM bit, and whether the CRC was correct and the byte written."""
        cdm, data = (yield 1), 0
        for _ in range(11):
            data = data << 1 | cdm
            cdm = yield cdm
        data = data << 1 | cdm
        if data & 0xF != compute_bits(_CRC, data >> 4, 8):
            return cdm, False
        self.encoder.memory.write(address, data >> 4)
        cdm = yield cdm
        return cdm, True

    def _read_byte(self, address: int) -> Generator[int, int, int]:
        """Send a byte and its CRC, and return the next CDM bit."""
        byte = self.encoder.memory.read(address) or 0
        data = byte << 4 | compute_bits(_CRC, byte, 8)
        cdm = yield 1
        for shift in range(11, -1, -1):
            cdm = yield data >> shift & 1
        return cdm


def _receive_head() -> Generator[int, int, tuple[int, int]]:
    """Receive the head of a control frame. Return the next CDM bit, which is the read bit, and the head."""
    cdm, head = (yield 1), 0
    for _ in range(15):
        head = head << 1 | cdm
        cdm = yield 0
    return cdm, head


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
        return word_with_fault(self.encoder, fault, word, self.bits)

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
