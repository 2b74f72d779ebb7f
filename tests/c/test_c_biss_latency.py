"""The BiSS machines in C against a master and a slave that were written from the protocol description alone, with the
control bit in the frame of the answer, and one frame later, as SPI with DMA has it: 20,000 accesses, none lost."""

from __future__ import annotations

import ctypes
import random
from collections.abc import Mapping
from pathlib import Path

import pytest
from biss_driver import OUTCOMES, Master, ModelLine, SlaveInC, accesses, built
from biss_models import ModelSlave
from c_harness import MadeOnce

pytestmark = pytest.mark.slow

ACCESSES = 20_000


@pytest.fixture(scope="session")
def library(include: Path, made_once: MadeOnce) -> ctypes.CDLL:
    return ctypes.CDLL(str(made_once("biss_latency", lambda place: built(place, include)) / "program"))


def model(chance: random.Random, **times: tuple[int, int]) -> ModelSlave:
    registers = {address: chance.randrange(256) for address in range(128)}
    return ModelSlave(registers, frozenset(range(0x70)), frozenset(range(0x10, 0x60)), chance=chance, **times)


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
    slave = SlaveInC(library)
    accesses(ModelLine(slave, latency), slave, random.Random(latency), ACCESSES)
