"""The BiSS machines in C as a library for Python, and thousands of register accesses over any kind of line.

A line consists of models that Python steps, or of Verilog.
"""

from __future__ import annotations

import ctypes
import random
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Protocol

from biss_models import Bits, ModelMaster
from c_harness import GCC, compile_c

OUTCOMES = ("IDLE", "RUNNING", "DONE", "REFUSED", "NO_ANSWER", "BUSY", "BAD_CRC", "BAD_ECHO", "ABORTED")
#: Replaces a CDS bit if the frame was lost.
LOST = -1

LIBRARY = r"""
#include "codewheel/biss_slave.h"

static cw_biss_master master;
static cw_biss_slave slave;
static uint8_t were_read[64];
static uint8_t to_write[64];
static uint8_t registers[128];
static int fetch_frames;
static int store_frames;
static int waited;
static int stored;

void master_init(void);
void master_init(void) { cw_biss_master_init(&master); }
int master_read(int address, int count, int limit);
int master_read(int address, int count, int limit)
{
    return (int)cw_biss_master_read(&master, 0U, (uint8_t)address, were_read, (size_t)count, (uint16_t)limit);
}
int master_write(int address, const uint8_t *data, int count, int limit);
int master_write(int address, const uint8_t *data, int count, int limit)
{
    int at;
    for (at = 0; at < count; at++) {
        to_write[at] = data[at];
    }
    return (int)cw_biss_master_write(&master, 0U, (uint8_t)address, to_write, (size_t)count, (uint16_t)limit);
}
int master_next(int cds, int late);
int master_next(int cds, int late)
{
    const bool bit = cds != 0;
    return (int)((late != 0) ? cw_biss_master_next_late(&master, bit) : cw_biss_master_next(&master, bit));
}
void master_abort(void);
void master_abort(void) { cw_biss_master_abort(&master); }
int master_outcome(void);
int master_outcome(void) { return (int)master.outcome; }
int master_done(void);
int master_done(void) { return (int)master.done; }
int master_byte(int at);
int master_byte(int at) { return were_read[at]; }

/* So many frames pass until a byte is there, or after one was stored. */
void slave_busy(int fetch, int store);
void slave_busy(int fetch, int store)
{
    fetch_frames = fetch;
    store_frames = store;
}
void slave_init(int readable, int writable);
void slave_init(int readable, int writable)
{
    size_t at;
    cw_biss_slave_init(&slave);
    (void)(cw_biss_slave_allow(&slave, 0U, (size_t)readable, true, false) == CW_OK);
    (void)(cw_biss_slave_allow(&slave, 0U, (size_t)writable, readable >= writable, true) == CW_OK);
    for (at = 0U; at < 128U; at++) {
        registers[at] = (uint8_t)(7U * at);
    }
    slave_busy(0, 0);
}
int slave_next(int cdm);
int slave_next(int cdm)
{
    const bool cds = cw_biss_slave_next(&slave, cdm != 0, false);
    const bool stores = slave.wants == CW_BISS_WANTS_STORE;
    stored = -1;
    if (stores && (waited == 0)) {
        registers[slave.address] = slave.value;
        stored = (int)slave.address * 256 + (int)slave.value;
    }
    if (slave.wants == CW_BISS_WANTS_NOTHING) {
        waited = 0;
    } else if (waited < (stores ? store_frames : fetch_frames)) {
        waited++;
    } else {
        waited = 0;
        cw_biss_slave_give(&slave, registers[slave.address]);
        cw_biss_slave_stored(&slave);
    }
    return (int)cds;
}
int slave_stored(void);
int slave_stored(void) { return stored; }
int slave_register(int address);
int slave_register(int address) { return registers[address]; }
"""


def built(folder: Path, include: Path, more: str = "") -> Path:
    """The library, compiled with additional functions of the caller. Undefined behaviour ends the process."""
    command = [*GCC, "-O1", "-shared", "-fPIC", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]
    return compile_c(command, LIBRARY + more, folder, include)


class SlaveEnd(Protocol):
    """Expected effects of an access: contents of registers, and those written since the list was cleared."""

    @property
    def readable(self) -> Collection[int]: ...
    @property
    def writable(self) -> Collection[int]: ...
    @property
    def stored(self) -> list[tuple[int, int]]: ...
    def stored_value(self, address: int) -> int: ...


class SteppedSlave(SlaveEnd, Protocol):
    """A slave that receives the CDM bit of each frame and yields the CDS bit of the next frame."""

    def run(self) -> Bits: ...


class MasterEnd(Protocol):
    """Return the outcome of an access by its name in C, and the bytes read."""

    def read(self, address: int, count: int, limit: int) -> tuple[str, bytes]: ...
    def write(self, address: int, data: bytes, limit: int) -> str: ...


class Master:
    """The master in C on a line with such a slave."""

    def __init__(self, library: ctypes.CDLL, slave: SteppedSlave, late: bool) -> None:
        self.library, self.late = library, int(late)
        self.slave = slave.run()
        self.cds = next(self.slave)
        self.waiting = 0
        self.frames = 0
        library.master_init()

    def run(self, frames: int = 6000) -> str:
        """Run frames until the access is over. A late CDM bit is sent in the next frame."""
        outcome = self.library.master_outcome
        for _ in range(frames):
            self.frames += 1
            bit = self._answer()
            if self.late:
                bit, self.waiting = self.waiting, bit
            self.cds = self.slave.send(bit)
            if outcome() != 1:
                break
        return OUTCOMES[outcome()]

    def _answer(self) -> int:
        if self.cds == LOST:
            self.library.master_abort()
            return 0
        return int(self.library.master_next(self.cds, self.late))

    def read(self, address: int, count: int, limit: int) -> tuple[str, bytes]:
        assert self.library.master_read(address, count, limit) == 0
        outcome = self.run()
        return outcome, bytes(self.library.master_byte(at) for at in range(self.library.master_done()))

    def write(self, address: int, data: bytes, limit: int) -> str:
        assert self.library.master_write(address, data, len(data), limit) == 0
        return self.run()


class SlaveInC:
    """The slave in C. slave_busy of the library sets for how many frames its registers are busy."""

    readable, writable = range(0x70), range(0x60)

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library = library
        self.stored: list[tuple[int, int]] = []
        library.slave_init(len(self.readable), len(self.writable))

    def stored_value(self, address: int) -> int:
        return int(self.library.slave_register(address))

    def next(self, cdm: int) -> int:
        cds = int(self.library.slave_next(cdm))
        stored = self.library.slave_stored()
        if stored >= 0:
            self.stored.append(divmod(stored, 256))
        return cds


class ModelLine:
    """The master of the model on a line with the slave in C. With latency, its bit is sent in the next frame."""

    def __init__(self, slave: SlaveInC, latency: int) -> None:
        self.slave, self.master = slave, ModelMaster(latency)
        self.waiting = [0] * latency

    def _access(self, address: int, values: Sequence[int] | int) -> str:
        bits = self.master.access(address, values)
        bit = next(bits)
        while True:
            self.waiting.append(bit)
            cds = self.slave.next(self.waiting.pop(0))
            try:
                bit = bits.send(cds)
            except StopIteration:
                return self.master.outcome.upper()

    def read(self, address: int, count: int, limit: int) -> tuple[str, bytes]:
        return self._access(address, count), bytes(self.master.data)

    def write(self, address: int, data: bytes, limit: int) -> str:
        return self._access(address, list(data))


def accesses(line: MasterEnd, slave: SlaveEnd, chance: random.Random, count: int) -> None:
    """Read and write up to three registers anywhere. Each result must match the registers of the slave."""
    for index in range(count):
        address = chance.randrange(128)
        size = min(chance.choice((1, 1, 1, 2, 3)), 64 - address % 64)
        places = range(address, address + size)
        writes = chance.random() < 0.5
        allowed = [place in (slave.writable if writes else slave.readable) for place in places]
        sound = allowed.index(False) if not all(allowed) else size
        outcome = "DONE" if all(allowed) else "REFUSED"
        if writes:
            data = bytes(chance.randrange(256) for _ in places)
            slave.stored.clear()
            assert line.write(address, data, 2000) == outcome, (index, address, size)
            # A byte is stored once, and no other byte is stored.
            assert slave.stored == list(zip(places[:sound], data, strict=False)), (index, address, size)
        else:
            expected = bytes(slave.stored_value(place) for place in places[:sound])
            assert line.read(address, size, 2000) == (outcome, expected), (index, address, size)
