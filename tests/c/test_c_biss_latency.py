"""The BiSS machines in C against a master and a slave written from the protocol description alone.

The control bit is in the frame of the answer, or one frame later, as SPI with DMA sends it. None of 20,000 accesses is
lost.
"""

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


#: Received by a slave that was busy, from the late master, as its comment says: a second S in place of DATA7 of a read,
#: and for an aborted write a byte of zeros, whose CRC is not the CRC of zeros.
SEEN = {"S in place of DATA7 of a read", "a byte whose CRC does not fit"}
TIMES: Mapping[str, Mapping[str, tuple[int, int]]] = {
    "never busy": {},
    "busy at times": {"fetch": (0, 3), "store": (0, 60)},
    "always busy": {"fetch": (1, 40), "store": (30, 300)},
}


@pytest.mark.slow
@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
def test_20_000_accesses_without_a_loss(library: ctypes.CDLL, late: bool) -> None:
    """A third of the accesses each has a slave that is never busy, sometimes busy, and busy whenever possible."""
    for seed, times in enumerate(TIMES.values()):
        chance = random.Random(seed)
        slave = model(chance, **times)
        accesses(Master(library, slave, late), slave, chance, ACCESSES // len(TIMES) + 1)
        assert set(slave.violations) <= (SEEN if late and times else set())


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
@pytest.mark.parametrize("times", TIMES)
def test_accesses_without_a_loss(library: ctypes.CDLL, times: str, late: bool) -> None:
    chance = random.Random(times)
    slave = model(chance, **TIMES[times])
    accesses(Master(library, slave, late), slave, chance, 150)
    assert set(slave.violations) <= (SEEN if late and TIMES[times] else set())


def test_a_bit_that_comes_late_needs_the_late_master(library: ctypes.CDLL) -> None:
    """The other master then loses everything, as its comment says."""
    chance = random.Random(5)
    slave = model(chance)
    line = Master(library, slave, late=True)
    for _ in range(20):
        assert library.master_read(0x20, 1, 0) == 0
        for _ in range(200):
            sent_bit, line.waiting = line.waiting, library.master_next(line.cds, 0)
            line.cds = line.slave.send(sent_bit)
        assert OUTCOMES[library.master_outcome()] != "DONE"


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
def test_how_many_frames_an_access_takes(library: ctypes.CDLL, late: bool) -> None:
    """46 frames for one register and 14 for each further one, and one more if a frame late."""
    for count in (1, 2, 3, 64):
        slave = model(random.Random(6))
        line = Master(library, slave, late)
        assert line.read(0x00, count, 0)[0] == "DONE"
        assert line.frames == 46 + 14 * (count - 1) + late


@pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])
@pytest.mark.parametrize("writes", [False, True], ids=["read", "written"])
def test_a_disturbed_answer_is_seen(library: ctypes.CDLL, writes: bool, late: bool) -> None:
    """Each bit of the answer is inverted in turn: a wrong byte is not accepted, and nothing is reported as done."""
    for frame in range(33, 45):
        slave = model(random.Random(frame))
        line = Master(library, slave, late)
        registers = dict(slave.registers)
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
        assert slave.registers == (registers | {0x20: 0x5A} if writes else registers)


def test_a_slave_that_is_never_ready(library: ctypes.CDLL) -> None:
    """Exactly as many frames as allowed. If none is allowed, it ends at the first sign of a busy slave."""
    for limit, longest in ((0, 0), (1, 35), (100, 135), (1000, 1035)):
        slave = model(random.Random(7), fetch=(10**6, 10**6))
        line = Master(library, slave, late=True)
        assert line.read(0x20, 1, limit) == ("BUSY", b"")
        assert 34 < line.frames <= 36 + longest
        slave = model(random.Random(8), store=(10**6, 10**6))
        line = Master(library, slave, late=True)
        assert line.write(0x20, b"\x12", 0) == "DONE"
        assert line.write(0x21, b"\x34", limit) == "BUSY"
        assert slave.stored == [(0x20, 0x12)]
        assert slave.violations == []


@pytest.mark.slow
@pytest.mark.parametrize("latency", [0, 1], ids=["in the same frame", "a frame later"])
def test_the_slave_in_c_under_a_master_of_the_model(library: ctypes.CDLL, latency: int) -> None:
    """A master that sends a whole control frame before it examines the answers also loses nothing."""
    slave = SlaveInC(library)
    accesses(ModelLine(slave, latency), slave, random.Random(latency), ACCESSES)
