"""A BiSS master and a slave for register access, bit by bit, written from the protocol description alone (Rev C6, p.

9 to 14), as a person reads it: from top to bottom, one line for each exchange of bits.

Both are generators. A slave receives the CDM bit of a frame and yields the CDS bit of the next frame. A master yields a
CDM bit and receives the CDS bit that it has seen before it must send the next bit.
"""

from __future__ import annotations

import random
from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, field

Bits = Generator[int, int, None]
Part = Generator[int, int, int]


def crc_4(bits: Iterable[int]) -> list[int]:
    """Return the CRC x^4 + x + 1 with start value 0, inverted, highest bit first."""
    remainder = [0, 0, 0, 0]
    for bit in bits:
        out = remainder[0] ^ bit
        remainder = [remainder[1], remainder[2], remainder[3] ^ out, out]
    return [1 - bit for bit in remainder]


def bits_of(number: int, width: int) -> list[int]:
    return [number >> place & 1 for place in range(width - 1, -1, -1)]


def number(bits: Iterable[int]) -> int:
    value = 0
    for bit in bits:
        value = 2 * value + bit
    return value


class _Abort(Exception):
    """Fourteen zeros end the control frame in any state."""


@dataclass
class ModelSlave:
    """The only slave of a line, whose ID is 0. It takes a number of frames to fetch or store a register."""

    registers: dict[int, int]
    readable: frozenset[int]
    writable: frozenset[int]
    fetch: tuple[int, int] = (0, 0)
    store: tuple[int, int] = (0, 0)
    chance: random.Random = field(default_factory=lambda: random.Random(0))
    #: Names of received bits that the protocol description does not have.
    violations: list[str] = field(default_factory=list)
    stored: list[tuple[int, int]] = field(default_factory=list)
    _zeros: int = 0
    _now: int = 0
    _ready: int = 0

    def stored_value(self, address: int) -> int:
        return self.registers[address]

    def run(self) -> Bits:
        cdm = yield 0
        while True:
            try:
                while not (cdm and self._zeros >= 14):
                    self._zeros = 0 if cdm else self._zeros + 1
                    cdm = yield 0
                    self._now += 1
                self._zeros = 0
                yield from self._control_frame()
            except _Abort:
                pass
            cdm = 0

    def _exchange(self, cds: int) -> Part:
        """Exchange one frame: CDS is sent at its beginning, and CDM is received at its end."""
        cdm = yield cds
        self._now += 1
        self._zeros = 0 if cdm else self._zeros + 1
        if self._zeros >= 14:
            raise _Abort
        return cdm

    def _exchanges(self, bits: Iterable[int]) -> Generator[int, int, list[int]]:
        """Exchange this many frames."""
        heard = []
        for bit in bits:
            heard += [(yield from self._exchange(bit))]
        return heard

    def _control_frame(self) -> Generator[int, int, None]:
        """Continue from the bit after S. Return if the frame is for another slave."""
        # IDL0: the ID is taken.
        header = yield from self._exchanges([1, *[0] * 14])
        if header[0] != 1 or crc_4(header[:11]) != header[11:] or number(header[1:4]) != 0:
            return
        address = number(header[4:11])
        read = yield from self._exchange(0)
        write = yield from self._exchange(read)
        if read == write:
            self.violations.append("R W")
            return
        allowed = self.writable if write else self.readable
        refused = address not in allowed
        self._busy(self.fetch if read else (0, 0))
        start = yield from self._exchange(1 - write if refused else write)
        while not refused:
            waited = False
            while self._now < self._ready:
                if not start:
                    return
                waited = True
                start = yield from self._exchange(0)
            if not start:
                return
            yield from (self._read(address, waited) if read else self._write(address))
            refused = address % 64 == 63 or address + 1 not in allowed
            address += 1
            self._busy(self.fetch if read else (0, 0))
            start = yield from self._exchange(int(refused))

    def _busy(self, bounds: tuple[int, int]) -> None:
        self._ready = max(self._ready, self._now + self.chance.randint(*bounds))

    def _read(self, address: int, waited: bool) -> Generator[int, int, None]:
        data = bits_of(self.registers[address], 8)
        heard = yield from self._exchanges([1, *data, *crc_4(data)])
        if any(heard[1:]):
            self.violations.append("a read that sends more than zeros")
        elif heard[0] and not waited:
            self.violations.append("S in place of DATA7 of a read")

    def _write(self, address: int) -> Generator[int, int, None]:
        heard = [(yield from self._exchange(1))]
        for index in range(12):
            heard.append((yield from self._exchange(heard[index])))
        if crc_4(heard[:8]) == heard[8:12]:
            self.registers[address] = number(heard[:8])
            self.stored.append((address, self.registers[address]))
            self._busy(self.store)
        else:
            self.violations.append("a byte whose CRC does not fit")


@dataclass
class ModelMaster:
    """A master that makes one access at a time, whose ``outcome`` is "done", "refused" or "disturbed".

    ``latency`` is the number of bits that it has sent after a bit before it sees the answer to that bit. It is 1 if its
    bit is sent one frame later.
    """

    latency: int
    outcome: str = ""
    data: list[int] = field(default_factory=list)

    def access(self, address: int, values: Sequence[int] | int) -> Bits:
        """Write these values, or read this many registers.

        Each register has a control frame of its own, which is sent completely before its answers are examined. A busy
        register is requested again.
        """
        self.outcome, self.data = "", []
        writes = not isinstance(values, int)
        for index in range(len(values) if not isinstance(values, int) else values):
            value = values[index] if not isinstance(values, int) else 0
            while not (yield from self._one(address + index, value if writes else None)):
                pass
            if self.outcome:
                return
        self.outcome = "done"

    def _one(self, address: int, value: int | None) -> Generator[int, int, bool]:
        header = [1, 0, 0, 0, *bits_of(address, 7)]
        data = bits_of(value, 8) if value is not None else []
        tail = [*data, *crc_4(data)] if value is not None else [0] * 12
        access = [0, 1] if value is not None else [1, 0]
        request_bits = [*[0] * 14, 1, *header, *crc_4(header), *access, 1, *tail, 0]
        heard: list[int] = []
        for bit in [*request_bits, *[0] * self.latency]:
            heard += [(yield bit)]
        answers = heard[14 + self.latency :]
        locked, echo, start, byte = answers[:16], answers[16:18], answers[18], answers[19:31]
        if locked != [1, *[0] * 15] or echo not in (access, [access[0], 1 - access[1]]):
            self.outcome = "disturbed"
        elif echo != access:
            self.outcome = "refused"
        elif not start:
            return False
        elif crc_4(byte[:8]) != byte[8:] or (value is not None and byte != tail):
            self.outcome = "disturbed"
        else:
            self.data.append(number(byte[:8]))
        return True
