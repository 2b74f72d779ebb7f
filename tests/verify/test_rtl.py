"""The C against a BiSS master and a slave in Verilog, written from the protocol reference alone.

Registers and positions are sent over lines with any delay, undisturbed and disturbed. ``CODEWHEEL_FRAMES`` lowers the
number of accesses.
"""

from __future__ import annotations

import ctypes
import random
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
from biss_driver import Master, MasterEnd, SlaveEnd, SlaveInC, accesses, built
from biss_models import bits_of, crc_4, number
from c_harness import GCC, MadeOnce, compile_c, devices_of, write
from tree import number_from_environment
from verilog import FAULTS, RECEIVE, Bench, RtlMaster, RtlSlave, verilated

ACCESSES = max(2_000, min(20_000, number_from_environment("CODEWHEEL_FRAMES", 1_000_000) // 50))
DISTURBED = ACCESSES // 4
SOUND = ACCESSES - DISTURBED
#: Errors of lines, as C numbers them.
LENGTH, NO_START = 1, 10
LATE = pytest.mark.parametrize("late", [False, True], ids=["in the same frame", "a frame later"])


@pytest.fixture(scope="session")
def verilog(made_once: MadeOnce) -> ctypes.CDLL:
    return ctypes.CDLL(str(made_once("rtl", verilated) / "bench.so"))


@pytest.fixture(scope="session")
def library(made_once: MadeOnce) -> ctypes.CDLL:
    return ctypes.CDLL(
        str(made_once("rtl_c", lambda place: built(place, write(place, devices_of()), RECEIVE)) / "program")
    )


#: Number of frames for which a register is busy when it is fetched and stored. Above LIMIT the access is aborted.
BUSY = (((0, 0), (0, 0)), ((0, 3), (0, 60)), ((1, 40), (30, 300)))
LIMIT = 100
#: Members of ``FAULTS`` that lose a frame.
LOSSES = ("cut", "never ready", "hurried")


def read_back(line: MasterEnd, places: range) -> bytes:
    """Read. An error at the end of the access before may disturb its zeros. This is reported, and a retry succeeds."""
    outcome, read = line.read(places[0], len(places), 2000)
    if outcome != "DONE":
        outcome, read = line.read(places[0], len(places), 2000)
    assert outcome == "DONE"
    return read


def cut_short(value: int) -> set[int]:
    """Return the bytes that can result if the master aborts and sends zeros.

    They contain the sent part of the byte and its CRC, perhaps without the bit of the lost frame, and then zeros.
    """
    word = [*bits_of(value, 8), *crc_4(bits_of(value, 8))]
    heads = [word[:end] for end in range(12)]
    heads += [head[:lost] + head[lost + 1 :] for head in heads for lost in range(len(head))]
    return {number([*head, *[0] * 8][:8]) for head in heads}


def disturbed_access(line: MasterEnd, slave: SlaveEnd, bench: Bench, kind: str, places: range, writes: bool) -> str:
    """Make an access with an error somewhere between its first zero and its last bit.

    All values that are read are right, only written values are stored, an incomplete access is reported, and the next
    one succeeds.
    """
    contents = bytes(map(slave.stored_value, places))
    data = bytes(bench.chance.randrange(256) for _ in places)
    bench.plant(kind, bench.chance.randint(1, 36 + 14 * len(places)))
    bench.fetch = bench.store = (LIMIT + 10, LIMIT + 50) if kind == "busy" else (0, 0)
    slave.stored.clear()
    if writes:
        outcome, read = line.write(places[0], data, LIMIT), contents
    else:
        outcome, read = line.read(places[0], len(places), LIMIT)
    bench.plant("", 0)
    bench.fetch = bench.store = (0, 0)
    assert read == contents[: len(read)]
    assert outcome != "DONE" or len(read) == len(places)
    stored_data = read_back(line, places)
    if writes and stored_data != data:
        # If the S of the slave is lost, an access can look successful without storing, so a program must read back.
        assert outcome != "DONE" or kind == "cds"
        assert line.write(places[0], data, 2000) == "DONE"
        stored_data = read_back(line, places)
    assert stored_data == bytes(map(slave.stored_value, places)) == (data if writes else contents)
    for address, value in slave.stored:
        assert writes
        intended = data[address - places[0]]
        assert value == intended or (kind in LOSSES and value in cut_short(intended))
    return outcome


def disturbed_accesses(
    line: MasterEnd, slave: SlaveEnd, bench: Bench, faults: Sequence[str], count: int
) -> dict[str, Counter[str]]:
    """Make this many accesses, with each of these errors in turn. Return their outcomes by error."""
    ends = {kind: Counter[str]() for kind in faults}
    for index in range(count):
        kind, address = faults[index % len(faults)], bench.chance.randrange(0x10, 0x5F)
        places = range(address, address + (1 if address == 0x3F else bench.chance.choice((1, 1, 2))))
        ends[kind][disturbed_access(line, slave, bench, kind, places, bench.chance.random() < 0.5)] += 1
    return ends


@LATE
def test_the_master_in_c(verilog: ctypes.CDLL, library: ctypes.CDLL, late: bool) -> None:
    """On a line with the slave in Verilog, which an SPI clocks."""
    bench = Bench(verilog, library, True, random.Random(1))
    slave = RtlSlave(bench)
    line = Master(library, slave, late)
    for fetch, store in BUSY:
        bench.fetch, bench.store = fetch, store
        accesses(line, slave, bench.chance, SOUND // len(BUSY))
    ends = disturbed_accesses(line, slave, bench, FAULTS, DISTURBED)
    for kind in LOSSES:
        assert set(ends[kind]) == {"ABORTED", "DONE"}
    assert {"BAD_CRC", "BAD_ECHO", "NO_ANSWER"} <= set(ends["cds"])
    assert {"BAD_ECHO", "NO_ANSWER"} <= set(ends["cdm"])
    assert set(ends["busy"]) == {"BUSY", "DONE"}


@LATE
def test_the_slave_in_c(verilog: ctypes.CDLL, library: ctypes.CDLL, late: bool) -> None:
    """With the master in Verilog, also with one frame of delay.

    That master repeats a request for a busy register, so no register stays busy for long.
    """
    bench = Bench(verilog, library, False, random.Random(2))
    slave = SlaveInC(library)
    line = RtlMaster(bench, slave, late)
    for fetch, store in BUSY:
        bench.fetch, bench.store = (0, 0) if late else fetch, store
        accesses(line, slave, bench.chance, SOUND // len(BUSY))
    ends = disturbed_accesses(line, slave, bench, [kind for kind in FAULTS if kind != "hurried"], DISTURBED)
    for kind in ("cut", "never ready"):
        assert set(ends[kind]) == {"DISTURBED", "DONE"}
    assert "DISTURBED" in set(ends["cds"]) & set(ends["cdm"])
    assert set(ends["busy"]) == {"BUSY", "DONE"}


class Encoder(NamedTuple):
    """Describe an order code by the name of its constants, and the bits around its position as the manual has them.

    ``zero_bit`` is the answer to the question whether ASC85 sends a zero bit after the position.
    """

    name: str
    zeros_before: int
    position_bits: int
    zeros_after: int = 0
    zero_bit: str = ""

    @property
    def called(self) -> str:
        return f"{self.name}_{self.zero_bit}" if self.zero_bit else self.name


ENCODERS = (
    Encoder("AMM5_A17_1SC1", 0, 17),  # AMM5 6.2.1 p.32: revolutions and singleturn as one number
    Encoder("AMM5_A23_65KSC1", 0, 39),
    Encoder("SMA21_SC4_0050", 4, 20),  # SMA21 6.2 p.25: right-aligned in 24 bits, at 1 um in 25
    Encoder("SMA21_SC1_0001", 0, 25),
    Encoder("ASC85_20_SC1", 0, 20, 1, "AS_PRINTED"),  # ASC85 6.2.1 p.20: a bit 0 between position and nE
    Encoder("ASC85_25_SC2", 0, 25, 1, "AS_PRINTED"),
    Encoder("ASC85_25_SC2", 0, 25, 0, "LEFT_OUT"),  # as a public driver for real encoders reads it
    Encoder("AM36_AM3616_4096_I7", 0, 36),  # AM36 6.5 p.31: 16 and 20 bits by default
)
POSITIONS = """
#include "codewheel/receive.h"
#include "lika/@family@_biss.h"

/* 0, a position that is usable; 100, one that is not; else the fault. */
int @name@_read(const uint8_t *rx, uint64_t *position);
int @name@_read(const uint8_t *rx, uint64_t *position)
{
    const lika_@family@_biss encoder = LIKA_@NAME@;
    lika_@family@_biss_frame frame;
    cw_word word;
    cw_result result = lika_@family@_biss_receive(encoder, @answer@rx, LIKA_@NAME@_@ANSWER@RX_BYTES, &word);
    if (result == CW_OK) {
        result = lika_@family@_biss_decode(encoder, @answer@word, &frame);
    }
    if (result != CW_OK) {
        return (int)result;
    }
    *position = frame.position;
    return (lika_@family@_biss_verdict(encoder, &frame) == CW_NOT_USABLE) ? 100 : 0;
}
int @name@_bytes(void);
int @name@_bytes(void) { return (int)LIKA_@NAME@_@ANSWER@RX_BYTES; }
"""


def positions(folder: Path) -> None:
    include = write(folder, devices_of())
    text = "".join(map(_position_functions, ENCODERS))
    compile_c([*GCC, "-O1", "-shared", "-fPIC"], text, folder, include)


def _position_functions(encoder: Encoder) -> str:
    return (
        POSITIONS.replace("@family@", encoder.name.split("_")[0].lower())
        .replace("@NAME@", encoder.name.replace("_", "_BISS_", 1))
        .replace("@name@", encoder.called.lower())
        .replace("@ANSWER@", f"{encoder.zero_bit}_" if encoder.zero_bit else "")
        .replace("@answer@", f"LIKA_ASC85_BISS_ZERO_BIT_{encoder.zero_bit}, " if encoder.zero_bit else "")
    )


@pytest.fixture(scope="session")
def readers(made_once: MadeOnce) -> ctypes.CDLL:
    return ctypes.CDLL(str(made_once("rtl_positions", positions) / "program"))


@pytest.mark.parametrize("encoder", ENCODERS, ids=[encoder.called for encoder in ENCODERS])
def test_positions(encoder: Encoder, verilog: ctypes.CDLL, library: ctypes.CDLL, readers: ctypes.CDLL) -> None:
    """Any position, over lines whose delay and acknowledge leave room for the frame in the buffer of the order code.

    Otherwise there is an error, and never another position. One frame in ten reports an error (nE = 0).
    """
    bench = Bench(verilog, library, True, random.Random(encoder.called))
    chance, size = bench.chance, getattr(readers, f"{encoder.called.lower()}_bytes")()
    read, rx, position_read = (
        getattr(readers, f"{encoder.called.lower()}_read"),
        (ctypes.c_uint8 * size)(),
        ctypes.c_uint64(0),
    )
    bits = encoder.zeros_before + encoder.position_bits + encoder.zeros_after + 2
    results = Counter[int]()
    for _ in range(ACCESSES // 4):
        half, delay, processing = chance.randint(2, 5), chance.randint(0, 40), chance.randint(0, 90)
        position, error = chance.getrandbits(encoder.position_bits), chance.random() < 0.1
        bench.line(half, delay, processing, 0)
        bench.data(ctypes.c_uint64((position << encoder.zeros_after + 2 | (not error) << 1 | 1) << 64 - bits), bits)
        bench.clocks(rx, size)
        bench.rest(chance.getrandbits(1), 3 * half + 5)
        # Two bits of rest, the delay, the acknowledge, start and CDS, the word with its CRC, and the stop bit.
        clocks = 2 + -(-delay // (2 * half)) + 1 + processing + 2 + bits + 6 + 1
        result = read(rx, ctypes.byref(position_read))
        results[result] += 1
        if result in (0, 100):
            assert position_read.value == position
            assert (result == 100) == error
        assert result in (0, 100) or clocks > 8 * size
    assert set(results) == {0, 100, LENGTH, NO_START}
