"""A BiSS master and a slave in Verilog as ends of a line, connected to the machines in C."""

from __future__ import annotations

import ctypes
import random
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

from biss_driver import LOST, SlaveInC
from biss_models import Bits
from tools import tool

SOURCES = Path(__file__).with_name("rtl")
#: Functions of the library in C in addition to its machines: a buffer of raw samples, as in a user's program.
RECEIVE = r"""
#include "codewheel/receive.h"

/* CDS, or -1 where no frame was found; word as it was then. */
int received(const uint8_t *rx, int size, int bits, uint64_t *word);
int received(const uint8_t *rx, int size, int bits, uint64_t *word)
{
    bool cds = false;
    if (cw_biss_receive(rx, (size_t)size, (uint32_t)bits, word) != CW_OK) {
        return -1;
    }
    return (cw_biss_receive_cds(rx, (size_t)size, &cds) == CW_OK) ? (int)cds : -1;
}
"""

#: Possible errors by name: a flipped bit, no SLO, an acknowledge without end, the next frame before the timeout is
#: over (possible with an SPI), a register that is busy for long.
FAULTS = ("cds", "cdm", "cut", "never ready", "hurried", "busy")
#: A word of six bits of data and six of CRC, which takes few clocks, and a buffer in which it always fits: 2 of rest,
#: 5 of delay, 1 and 5 of acknowledge, start and CDS, word and stop bit.
DATA_BITS, WORD_BITS, SIZE = 6, 12, 4
RTL_OUTCOMES = ("IDLE", "RUNNING", "DONE", "REFUSED", "BUSY", "DISTURBED")


def verilated(folder: Path) -> Path:
    """Compile the Verilog and its bench."""
    program = tool("verilator")
    root = subprocess.run([program, "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=True)
    include = Path(root.stdout.strip()) / "include"
    generated = []
    for top in ("biss_master", "biss_slave"):
        command = [program, "--cc", "-Wall", "-O3", "--language", "1364-2001", "-y", ".", "--top-module", top]
        # Verilator does not take the name of a module from a path with a blank.
        subprocess.run([*command, "--Mdir", str(folder / top), f"{top}.v"], cwd=SOURCES, check=True)
        generated += sorted(map(str, (folder / top).glob("*.cpp")))
    sources = [
        str(SOURCES / "bench.cpp"),
        *generated,
        str(include / "verilated.cpp"),
        str(include / "verilated_threads.cpp"),
    ]
    folders = [include, include / "vltstd", folder / "biss_master", folder / "biss_slave"]
    library = folder / "bench.so"
    command = ["g++", "-std=c++17", "-O2", "-shared", "-fPIC", "-pthread", *(f"-I{place}" for place in folders)]
    subprocess.run([*command, *sources, "-o", str(library)], check=True)
    return library


class Bench:
    """The bench with one line, whose clock, delay, acknowledge and word change in each frame.

    A fault of ``FAULTS`` happens once, in the frame that ``plant`` sets.
    """

    def __init__(self, verilog: ctypes.CDLL, library: ctypes.CDLL, of_spi: bool, chance: random.Random) -> None:
        verilog.bench_new.restype = ctypes.c_void_p
        verilog.bench_read_word.restype = ctypes.c_uint64
        self.verilog, self.library, self.chance = verilog, library, chance
        self.handle = ctypes.c_void_p(verilog.bench_new(int(of_spi)))
        self.rx = (ctypes.c_uint8 * 16)()
        self.word = ctypes.c_uint64(0)
        self.fetch, self.store = (0, 0), (0, 0)
        self._kind, self._left = "", 0

    def __getattr__(self, name: str) -> Callable[..., Any]:
        function = getattr(self.verilog, f"bench_{name}")
        return lambda *values: function(self.handle, *values)

    def plant(self, kind: str, frames: int) -> None:
        self._kind, self._left = kind, frames

    def frames_busy(self) -> tuple[int, int]:
        """Return the number of frames for which the next register is busy when fetched and when stored."""
        return self.chance.randint(*self.fetch), self.chance.randint(*self.store)

    def another_frame(self, halves: tuple[int, ...]) -> tuple[str, int]:
        """Return the error of the frame, and the data of its word."""
        self._left -= 1
        fault = self._kind if self._left == 0 else ""
        processing = 200 if fault == "never ready" else self.chance.randint(0, 5)
        self.line(self.chance.choice(halves), self.chance.randint(0, 20), processing, int(fault == "cut"))
        data = self.chance.getrandbits(DATA_BITS)
        self.data(ctypes.c_uint64(data << 64 - DATA_BITS), DATA_BITS)
        self.control(int(fault == "cds"), int(fault == "cdm"), *self.frames_busy())
        return fault, data

    def received(self, data: int) -> int:
        """Return the CDS that C finds in the samples. The word is the sent word, or nothing is found."""
        cds = int(self.library.received(self.rx, SIZE, WORD_BITS, ctypes.byref(self.word)))
        assert cds == LOST or self.word.value >> WORD_BITS - DATA_BITS == data
        return cds


class RtlSlave:
    """The slave in Verilog, clocked by an SPI. C extracts its bits from the samples."""

    readable, writable = range(0x70), range(0x10, 0x60)

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.stored: list[tuple[int, int]] = []
        for address in range(128):
            bench.write(address, bench.chance.randrange(256))

    def stored_value(self, address: int) -> int:
        return int(self.bench.read(address))

    def run(self) -> Bits:
        bench = self.bench
        while True:
            fault, data = bench.another_frame((2, 3))
            bench.clocks(bench.rx, SIZE)
            cdm = yield bench.received(data)
            stored = bench.rest(cdm, 2 if fault == "hurried" else 14)
            if stored >= 0:
                self.stored.append(divmod(stored, 256))


class RtlMaster:
    """The master in Verilog and the line of its slave, whose registers are the registers of the slave in C."""

    def __init__(self, bench: Bench, slave: SlaveInC, late: bool) -> None:
        self.bench, self.slave, self.late = bench, slave, int(late)
        self.bytes = (ctypes.c_uint8 * 65)()
        self.cds = 0

    def _run(self, write: bool, address: int, count: int, limit: int) -> str:
        # The driver counts how often S was not answered. With one frame of delay, there are 35 frames between two such
        # times.
        self.bench.ask(self.late, int(write), address, count, limit // 35 if self.late else limit)
        outcome = "RUNNING"
        while outcome == "RUNNING":
            outcome = RTL_OUTCOMES[self._frame()]
        return outcome

    def _frame(self) -> int:
        bench = self.bench
        fault, data = bench.another_frame((2,))
        bench.answer(self.cds)
        ctypes.memset(bench.rx, 0xFF, SIZE)
        outcome = int(bench.frame(WORD_BITS, self.bytes, bench.rx, SIZE))
        # C gets the same bits from the samples at the edges of its clock.
        sound = fault not in ("cut", "never ready")
        assert bench.received(data) == (self.cds ^ (fault == "cds") if sound else LOST)
        assert not sound or bench.read_word() == bench.word.value
        cdm = bench.taken()
        if cdm >= 0:
            self.slave.library.slave_busy(*bench.frames_busy())
            self.cds = self.slave.next(cdm)
        return outcome

    def read(self, address: int, count: int, limit: int) -> tuple[str, bytes]:
        outcome = self._run(False, address, count, limit)
        return outcome, bytes(self.bytes[: self.bench.done()])

    def write(self, address: int, data: bytes, limit: int) -> str:
        self.bytes[: len(data)] = list(data)
        return self._run(True, address, len(data), limit)
