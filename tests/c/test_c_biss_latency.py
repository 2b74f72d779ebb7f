"""The BiSS machines in C against a master and a slave that were written from the protocol description alone, with the
control bit in the frame of the answer, and one frame later, as SPI with DMA has it: 20,000 accesses, none lost."""

from __future__ import annotations

import ctypes
import random
from collections.abc import Mapping
from pathlib import Path

import pytest
from biss_models import ModelMaster, ModelSlave
from c_harness import GCC, MadeOnce, compile_c

OUTCOMES = ("IDLE", "RUNNING", "DONE", "REFUSED", "NO_ANSWER", "BUSY", "BAD_CRC", "BAD_ECHO", "ABORTED")
ACCESSES = 20_000

LIBRARY = r"""
#include "lika/biss.h"

static lika_biss_master master;
static lika_biss_slave slave;
static uint8_t into[64];
static uint8_t from[64];
static uint8_t registers[128];

void master_init(void);
void master_init(void) { lika_biss_master_init(&master); }
int master_read(int address, int count, int limit);
int master_read(int address, int count, int limit)
{
    return (int)lika_biss_master_read(&master, 0U, (uint8_t)address, into, (size_t)count, (uint16_t)limit);
}
int master_write(int address, const uint8_t *data, int count, int limit);
int master_write(int address, const uint8_t *data, int count, int limit)
{
    int at;
    for (at = 0; at < count; at++) {
        from[at] = data[at];
    }
    return (int)lika_biss_master_write(&master, 0U, (uint8_t)address, from, (size_t)count, (uint16_t)limit);
}
int master_next(int cds, int late);
int master_next(int cds, int late)
{
    const bool bit = cds != 0;
    return (int)((late != 0) ? lika_biss_master_next_late(&master, bit) : lika_biss_master_next(&master, bit));
}
int master_outcome(void);
int master_outcome(void) { return (int)master.outcome; }
int master_done(void);
int master_done(void) { return (int)master.done; }
int master_byte(int at);
int master_byte(int at) { return into[at]; }

void slave_init(int readable, int writable);
void slave_init(int readable, int writable)
{
    size_t at;
    lika_biss_slave_init(&slave);
    (void)(lika_biss_slave_allow(&slave, 0U, (size_t)readable, true, false) == LIKA_OK);
    (void)(lika_biss_slave_allow(&slave, 0U, (size_t)writable, readable >= writable, true) == LIKA_OK);
    for (at = 0U; at < 128U; at++) {
        registers[at] = (uint8_t)(7U * at);
    }
}
int slave_next(int cdm);
int slave_next(int cdm)
{
    const bool cds = lika_biss_slave_next(&slave, cdm != 0, false);
    if (slave.wants == LIKA_BISS_WANTS_BYTE) {
        lika_biss_slave_give(&slave, registers[slave.address]);
    } else if (slave.wants == LIKA_BISS_WANTS_STORE) {
        registers[slave.address] = slave.value;
        lika_biss_slave_stored(&slave);
    }
    return (int)cds;
}
int slave_register(int address);
int slave_register(int address) { return registers[address]; }
"""


@pytest.fixture(scope="session")
def library(include: Path, made_once: MadeOnce) -> ctypes.CDLL:
    command = [*GCC, "-O1", "-shared", "-fPIC", "-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]
    folder = made_once("biss_latency", lambda place: compile_c(command, LIBRARY, place, include))
    return ctypes.CDLL(str(folder / "program"))


class Master:
    """The master in C on a line with the slave of the model."""

    def __init__(self, library: ctypes.CDLL, slave: ModelSlave, late: bool) -> None:
        self.library, self.late = library, int(late)
        self.slave = slave.run()
        self.cds = next(self.slave)
        self.waiting = 0
        self.frames = 0
        library.master_init()

    def run(self, frames: int = 6000) -> str:
        """Frames until the access is over. A CDM bit that comes late goes out in the next frame."""
        outcome, next_bit = self.library.master_outcome, self.library.master_next
        for _ in range(frames):
            self.frames += 1
            if self.late:
                sent = self.waiting
                self.waiting = next_bit(self.cds, 1)
            else:
                sent = next_bit(self.cds, 0)
            self.cds = self.slave.send(sent)
            if outcome() != 1:
                break
        return OUTCOMES[outcome()]

    def read(self, address: int, count: int, limit: int) -> tuple[str, bytes]:
        assert self.library.master_read(address, count, limit) == 0
        outcome = self.run()
        return outcome, bytes(self.library.master_byte(at) for at in range(self.library.master_done()))

    def write(self, address: int, data: bytes, limit: int) -> str:
        assert self.library.master_write(address, data, len(data), limit) == 0
        return self.run()


def model(chance: random.Random, **times: tuple[int, int]) -> ModelSlave:
    registers = {address: chance.randrange(256) for address in range(128)}
    return ModelSlave(registers, frozenset(range(0x70)), frozenset(range(0x10, 0x60)), chance=chance, **times)


def accesses(line: Master, slave: ModelSlave, chance: random.Random, count: int) -> None:
    """Reads and writes of up to three registers anywhere; each has to come out as the registers of the slave say."""
    for index in range(count):
        address = chance.randrange(128)
        size = min(chance.choice((1, 1, 1, 2, 3)), 64 - address % 64)
        places = range(address, address + size)
        if chance.random() < 0.5:
            allowed = [place in slave.readable for place in places]
            sound = allowed.index(False) if not all(allowed) else size
            expected = bytes(slave.registers[place] for place in places[:sound])
            found = line.read(address, size, 2000)
            assert found == ("DONE" if all(allowed) else "REFUSED", expected), (index, address, size)
        else:
            allowed = [place in slave.writable for place in places]
            sound = allowed.index(False) if not all(allowed) else size
            data = bytes(chance.randrange(256) for _ in places)
            slave.stored.clear()
            assert line.write(address, data, 2000) == ("DONE" if all(allowed) else "REFUSED"), (index, address, size)
            # A byte is stored once, and no other one is.
            assert slave.stored == list(zip(places[:sound], data, strict=False)), (index, address, size)


#: What a slave that was busy sees of the late master, as its comment says: S once more in place of DATA7 of a read; of
#: a write that was given up a byte of zeros, which no CRC of zeros goes with.
SEEN = {"S in place of DATA7 of a read", "a byte whose CRC does not fit"}
TIMES: Mapping[str, Mapping[str, tuple[int, int]]] = {
    "never busy": {},
    "busy at times": {"fetch": (0, 3), "store": (0, 60)},
    "always busy": {"fetch": (1, 40), "store": (30, 300)},
}


@pytest.mark.slow
@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
def test_20_000_accesses_without_a_loss(library: ctypes.CDLL, late: bool) -> None:
    """A third each with a slave that is never busy, at times, and whenever it can be."""
    for seed, times in enumerate(TIMES.values()):
        chance = random.Random(seed)
        slave = model(chance, **times)
        accesses(Master(library, slave, late), slave, chance, ACCESSES // len(TIMES) + 1)
        assert set(slave.wrong) <= (SEEN if late and times else set())


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
@pytest.mark.parametrize("times", TIMES)
def test_accesses_without_a_loss(library: ctypes.CDLL, times: str, late: bool) -> None:
    chance = random.Random(times)
    slave = model(chance, **TIMES[times])
    accesses(Master(library, slave, late), slave, chance, 150)
    assert set(slave.wrong) <= (SEEN if late and TIMES[times] else set())


def test_a_bit_that_comes_late_needs_the_late_master(library: ctypes.CDLL) -> None:
    """The other one loses everything then, as its comment says."""
    chance = random.Random(5)
    slave = model(chance)
    line = Master(library, slave, late=True)
    for _ in range(20):
        assert library.master_read(0x20, 1, 0) == 0
        for _ in range(200):
            sent, line.waiting = line.waiting, library.master_next(line.cds, 0)
            line.cds = line.slave.send(sent)
        assert OUTCOMES[library.master_outcome()] != "DONE"


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
def test_how_many_frames_an_access_takes(library: ctypes.CDLL, late: bool) -> None:
    """46 in all for one register and 14 for each further one; a frame late one more."""
    for count in (1, 2, 3, 64):
        slave = model(random.Random(6))
        line = Master(library, slave, late)
        assert line.read(0x00, count, 0)[0] == "DONE"
        assert line.frames == 46 + 14 * (count - 1) + late


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
@pytest.mark.parametrize("writes", [False, True], ids=["read", "written"])
def test_a_disturbed_answer_is_seen(library: ctypes.CDLL, writes: bool, late: bool) -> None:
    """Each bit of the answer in turn: what comes back as another byte is no byte, and nothing is said to be done."""
    for frame in range(33, 45):
        slave = model(random.Random(frame))
        line = Master(library, slave, late)
        held = dict(slave.registers)
        if writes:
            assert library.master_write(0x20, b"\x5a", 1, 0) == 0
        else:
            assert library.master_read(0x20, 1, 0) == 0
        for at in range(60):
            if at == frame + late + 1:
                line.cds ^= 1
            line.run(1)
        assert OUTCOMES[library.master_outcome()] in (("BAD_ECHO",) if writes else ("BAD_CRC",)), frame
        assert library.master_done() == 0
        assert slave.registers == (held | {0x20: 0x5A} if writes else held)


def test_a_slave_that_is_never_ready(library: ctypes.CDLL) -> None:
    """As many frames as allowed, and no more; with none allowed at the first sign."""
    for limit, most in ((0, 0), (1, 35), (100, 135), (1000, 1035)):
        slave = model(random.Random(7), fetch=(10**6, 10**6))
        line = Master(library, slave, late=True)
        assert line.read(0x20, 1, limit) == ("BUSY", b"")
        assert 34 < line.frames <= 36 + most
        slave = model(random.Random(8), store=(10**6, 10**6))
        line = Master(library, slave, late=True)
        assert line.write(0x20, b"\x12", 0) == "DONE"
        assert line.write(0x21, b"\x34", limit) == "BUSY"
        assert slave.stored == [(0x20, 0x12)]
        assert slave.wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("latency", [0, 1], ids=["in the same frame", "a frame later"])
def test_the_slave_in_c_under_a_master_of_the_model(library: ctypes.CDLL, latency: int) -> None:
    """One that sends a whole control frame before it looks at what came: it loses nothing either."""
    chance = random.Random(latency)
    library.slave_init(0x70, 0x60)
    held = [7 * address % 256 for address in range(128)]
    master = ModelMaster(latency)
    # With latency, what the master says now goes out in the next frame.
    waiting, cds = [0] * latency, 0
    for index in range(ACCESSES):
        address, count = chance.randrange(128), 1 if chance.random() < 0.8 else 2
        count = min(count, 64 - address % 64)
        values = [chance.randrange(256) for _ in range(count)]
        reads = chance.random() < 0.5
        bits = master.access(address, count if reads else values)
        bit = next(bits)
        while True:
            waiting.append(bit)
            cds = library.slave_next(waiting.pop(0))
            try:
                bit = bits.send(cds)
            except StopIteration:
                break
        allowed = all(place < (0x70 if reads else 0x60) for place in range(address, address + count))
        assert master.outcome == ("done" if allowed else "refused"), (index, address, count, reads)
        sound = [place for place in range(address, address + count) if place < (0x70 if reads else 0x60)]
        if reads:
            assert master.data == [held[place] for place in sound]
        else:
            for place, value in zip(sound, values, strict=False):
                held[place] = value
            assert [library.slave_register(place) for place in sound] == [held[place] for place in sound]
