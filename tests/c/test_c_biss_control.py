"""BiSS C's control frames in C: published words, and masters and slaves in C and Python together, bit by bit."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from biss_line import Line, Memory, PythonMaster, PythonSlave
from c_harness import GCC, SANITIZED, MadeOnce, compile_c
from exhaustive import mostly_exhaustive
from hypothesis import given, settings
from hypothesis import strategies as st
from working_tools import require

RESULTS = ("OK", "LENGTH", "CRC", "CONSTANT", "RANGE")
OUTCOMES = ("IDLE", "RUNNING", "DONE", "REFUSED", "NO_ANSWER", "BUSY", "BAD_CRC", "BAD_ECHO", "ABORTED")
WANTS = ("NOTHING", "BYTE", "STORE")
NO_ID = 255

#: Each line has one answer. If there are several machines, the number of one follows the letter.
PROGRAM = r"""
#include "codewheel/biss_slave.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_biss_master master;
static cw_biss_slave slaves[12];
static uint8_t bytes[70];

static unsigned long number(void)
{
    const char *const item = strtok(NULL, " \n");
    return (item == NULL) ? 0UL : strtoul(item, NULL, 0);
}

int main(void)
{
    static char line[512];
    setvbuf(stdout, NULL, _IOLBF, 0);
    while (fgets(line, sizeof line, stdin) != NULL) {
        const char verb = strtok(line, " \n")[0];
        if (verb == 'i') {
            size_t at;
            cw_biss_master_init(&master);
            for (at = 0U; at < 12U; at++) {
                cw_biss_slave_init(&slaves[at]);
            }
            printf("0\n");
        } else if (verb == 'r') {
            const uint8_t id = (uint8_t)number();
            const uint8_t address = (uint8_t)number();
            const size_t count = number();
            memset(bytes, 0xA5, sizeof bytes);
            printf("%d\n", (int)cw_biss_master_read(&master, id, address, bytes, count, (uint16_t)number()));
        } else if (verb == 'w') {
            const uint8_t id = (uint8_t)number();
            const uint8_t address = (uint8_t)number();
            const uint16_t limit = (uint16_t)number();
            const size_t count = number();
            size_t at;
            for (at = 0U; at < count && at < sizeof bytes; at++) {
                bytes[at] = (uint8_t)number();
            }
            printf("%d\n", (int)cw_biss_master_write(&master, id, address, bytes, count, limit));
        } else if (verb == 'a') {
            cw_biss_master_abort(&master);
            printf("%d\n", (int)master.outcome);
        } else if (verb == 'm') {
            const bool cdm = cw_biss_master_next(&master, number() != 0UL);
            printf("%d %d %u %u\n", (int)cdm, (int)master.outcome, master.slaves, master.done);
        } else if (verb == 'd') {
            size_t at;
            for (at = 0U; at < sizeof bytes; at++) {
                printf("%02X", bytes[at]);
            }
            printf("\n");
        } else if (verb == 'l') {
            cw_biss_slave *const slave = &slaves[number()];
            const uint8_t address = (uint8_t)number();
            const size_t count = number();
            const bool read = number() != 0UL;
            printf("%d\n", (int)cw_biss_slave_allow(slave, address, count, read, number() != 0UL));
        } else if (verb == 's') {
            cw_biss_slave *const slave = &slaves[number()];
            const bool cdm = number() != 0UL;
            const bool cds = cw_biss_slave_next(slave, cdm, number() != 0UL);
            printf("%d %d %u %u %u\n", (int)cds, (int)slave->wants, slave->address, slave->value, slave->id);
        } else if (verb == 'g') {
            cw_biss_slave *const slave = &slaves[number()];
            cw_biss_slave_give(slave, (uint8_t)number());
            printf("%d\n", (int)slave->wants);
        } else if (verb == 't') {
            cw_biss_slave *const slave = &slaves[number()];
            cw_biss_slave_stored(slave);
            printf("%d\n", (int)slave->wants);
        } else if (verb == 'e' || verb == 'A') {
            cw_biss_request request;
            uint32_t word = 0xA5A5A5A5U;
            uint8_t counted = 0xA5U;
            uint8_t value = 0xA5U;
            request.id = (uint8_t)number();
            request.address = (uint8_t)number();
            request.write = number() != 0UL;
            request.value = (uint8_t)number();
            if (verb == 'e') {
                const cw_result result = cw_biss_request_encode(&request, &word);
                printf("%d %lu\n", (int)result, (unsigned long)word);
            } else {
                const cw_biss_outcome outcome =
                    cw_biss_answer_decode(&request, (uint32_t)number(), &counted, &value);
                printf("%d %u %u\n", (int)outcome, counted, value);
            }
        } else if (verb == 'D') {
            cw_biss_request request = { 0x5AU, 0x5AU, true, 0x5AU };
            const cw_result result = cw_biss_request_decode((uint32_t)number(), &request);
            printf("%d %u %u %d %u\n", (int)result, request.id, request.address, (int)request.write, request.value);
        } else if (verb == 'b') {
            printf("%u\n", cw_biss_byte_encode((uint8_t)number()));
        } else if (verb == 'B') {
            uint8_t value = 0xA5U;
            const cw_result result = cw_biss_byte_decode((uint16_t)number(), &value);
            printf("%d %u\n", (int)result, value);
        } else {
            const uint32_t value = (uint32_t)number();
            printf("%lu\n", (unsigned long)cw_biss_crc(value, (uint32_t)number()));
        }
    }
    return 0;
}
"""

Ask = Callable[..., list[int]]


@pytest.fixture(scope="session")
def ask(include: Path, made_once: MadeOnce) -> Iterator[Ask]:
    """Run the program, with checks for undefined behaviour."""
    command = [*GCC, "-O1", *SANITIZED]
    program = made_once("biss", lambda folder: compile_c(command, PROGRAM, folder, include)) / "program"
    with subprocess.Popen(
        [str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        into, out = process.stdin, process.stdout

        def ask_program(*items: object) -> list[int]:
            into.write(" ".join(str(word) for word in items) + "\n")
            into.flush()
            answer = out.readline()
            assert answer, "the program has stopped"
            return [int(word, 16) if items[0] == "d" else int(word) for word in answer.split()]

        yield ask_program
        into.close()
    assert process.returncode == 0


@pytest.fixture(scope="session")
def biss(generated_python: tuple[Any, ModuleType]) -> Any:
    return generated_python[1].biss


class CMaster:
    def __init__(self, ask: Ask) -> None:
        self.ask, self.outcome, self.slaves, self.done, self.reads = ask, "IDLE", 0, 0, False

    @property
    def data(self) -> bytes:
        return self.ask("d")[0].to_bytes(70, "big")[: self.done] if self.reads else b""

    def begun(self, result: int, reads: bool) -> None:
        assert RESULTS[result] == "OK"
        self.outcome, self.slaves, self.done, self.reads = "RUNNING", 0, 0, reads

    def read(self, address: int, count: int, slave_id: int, busy_limit: int) -> None:
        self.begun(self.ask("r", slave_id, address, count, busy_limit)[0], True)

    def write(self, address: int, data: bytes, slave_id: int, busy_limit: int) -> None:
        self.begun(self.ask("w", slave_id, address, busy_limit, len(data), *data)[0], False)

    def abort(self) -> None:
        self.outcome = OUTCOMES[self.ask("a")[0]]

    def next(self, cds: int) -> int:
        cdm, outcome, self.slaves, self.done = self.ask("m", cds)
        self.outcome = OUTCOMES[outcome]
        return cdm


class CSlave:
    def __init__(
        self, ask: Ask, number: int, readable: Sequence[int] = range(128), writable: Sequence[int] = range(128)
    ) -> None:
        self.ask, self.number, self.wants, self.address, self.value = ask, number, "NOTHING", 0, 0
        self.slave_id: int | None = None
        for address in range(128):
            assert ask("l", number, address, 1, int(address in readable), int(address in writable)) == [0]

    def next(self, cdm: int, upstream: int) -> int:
        cds, wants, self.address, self.value, slave_id = self.ask("s", self.number, cdm, upstream)
        self.wants, self.slave_id = WANTS[wants], None if slave_id == NO_ID else slave_id
        return cds

    def give(self, value: int) -> None:
        self.wants = WANTS[self.ask("g", self.number, value)[0]]

    def stored(self) -> None:
        self.wants = WANTS[self.ask("t", self.number)[0]]


Build = Callable[..., Line]

PAIRS = [("c", "c"), ("c", "python"), ("python", "c")]


@pytest.fixture(scope="session")
def build(ask: Ask, biss: Any) -> Build:
    """Return a line with a master and slaves in these languages. Every register of a slave contains its own address."""

    def built(
        languages: tuple[str, str] = ("c", "c"), chain: int = 1, delay: int = 0, **allowed: Sequence[int]
    ) -> Line:
        ask("i")
        master: Any = CMaster(ask) if languages[0] == "c" else PythonMaster(biss)
        slaves: list[Any] = []
        memories = []
        for number in range(chain):
            slaves.append(CSlave(ask, number, **allowed) if languages[1] == "c" else PythonSlave(biss, **allowed))
            memories.append(Memory({address: address for address in range(128)}, delay))
        return Line(master, slaves, memories)

    return built


def bits_of(text: str) -> list[int]:
    return [int(bit) for bit in text.replace(" ", "")]


# ---------------------------------------------------------------------------------------------------------------- words


def test_the_published_words(ask: Ask, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"].startswith("BiSS-C register read")]
    assert len(rows) == 13
    for row in rows:
        word, address = int(row["frame_hex_or_bits"].split()[0], 16), row["fields"]["ADR"]
        assert ask("e", row["fields"]["ID"], address, 0, 0) == [0, word]
        assert ask("D", word) == [0, row["fields"]["ID"], address, 0, 0]
    # The word that is printed wrong, the same word with a corrected CRC, and the expected word.
    assert ask("D", 0x8C13C194) == [RESULTS.index("CRC"), 0x5A, 0x5A, 1, 0x5A]
    assert ask("D", 0x8C17C194) == [RESULTS.index("CONSTANT"), 0x5A, 0x5A, 1, 0x5A]
    assert ask("D", 0x8C16C194) == [0, 0, 0x60, 1, 6]
    assert ask("e", 0, 0x60, 1, 6) == [0, 0x8C16C194]


def test_words_and_bytes_on_paper(ask: Ask) -> None:
    # The arithmetic is next to the same words in the tests of the Python module.
    assert ask("e", 0, 0, 0, 0) == [0, 0x800D4000]
    assert ask("e", 5, 0x7F, 1, 0xFF) == [0, 0xDFFEFFEC]
    assert [ask("b", value)[0] for value in (0x00, 0x01, 0x40, 0x80, 0xFF)] == [0x00F, 0x01C, 0x408, 0x801, 0xFFB]
    assert ask("B", 0x408) == [0, 0x40]
    assert ask("B", 0x409) == [RESULTS.index("CRC"), 0xA5]
    assert ask("B", 0x1408) == [RESULTS.index("LENGTH"), 0xA5]


def test_what_is_no_request(ask: Ask) -> None:
    for unencodable in ((8, 0, 0, 0), (0, 128, 0, 0), (255, 255, 1, 0), (0, 0, 0, 1)):
        assert ask("e", *unencodable) == [RESULTS.index("RANGE"), 0xA5A5A5A5]


@settings(deadline=None)
@given(word=st.integers(0, (1 << 32) - 1))
def test_any_word_as_in_python(ask: Ask, biss: Any, generated_python: tuple[Any, ModuleType], word: int) -> None:
    package = generated_python[1]
    for candidate in (word, word & 0xFFE00000 | biss.crc(word >> 21, 11) << 17 | word & 0x1FFFF):
        try:
            request = biss.Request.decode(candidate)
            expected = [0, request.slave_id, request.address, int(request.value is not None), request.value or 0]
        except package.CrcError:
            expected = [RESULTS.index("CRC"), 0x5A, 0x5A, 1, 0x5A]
        except package.ConstantError:
            expected = [RESULTS.index("CONSTANT"), 0x5A, 0x5A, 1, 0x5A]
        assert ask("D", candidate) == expected
        bits = candidate & 0xFFFF
        assert ask("c", bits, 16) == [biss.crc(bits, 16)]


READ_40 = 0b1000000000000000_10_1_01000000_1000_0


@settings(deadline=None)
@given(
    cds=st.integers(0, (1 << 32) - 1) | st.integers(0, 31).map(lambda bit: READ_40 ^ 1 << bit),
    slave_id=st.integers(0, 7),
    value=st.none() | st.integers(0, 255),
)
def test_any_answer_as_in_python(ask: Ask, biss: Any, cds: int, slave_id: int, value: int | None) -> None:
    answer = biss.Answer.decode(biss.Request(slave_id, 0x44, value), cds)
    expected = [OUTCOMES.index(answer.outcome.name), answer.slaves, 0xA5 if answer.value is None else answer.value]
    assert ask("A", slave_id, 0x44, int(value is not None), value or 0, cds) == expected


def test_answers_on_paper(ask: Ask) -> None:
    assert ask("A", 0, 0x44, 0, 0, READ_40) == [OUTCOMES.index("DONE"), 1, 0x40]
    assert ask("A", 0, 0x44, 0, 0, READ_40 ^ 1 << 14) == [OUTCOMES.index("REFUSED"), 1, 0xA5]
    assert ask("A", 1, 0x44, 0, 0, READ_40) == [OUTCOMES.index("NO_ANSWER"), 1, 0xA5]
    assert ask("A", 0, 0x44, 1, 0x40, READ_40 ^ 3 << 14) == [OUTCOMES.index("DONE"), 1, 0xA5]


# ------------------------------------------------------------------------------------------------ bit by bit


def test_a_read_written_out(build: Build) -> None:
    line = build()
    line.master.read(0x40, 1, 0, 0)
    assert line.run() == "DONE"
    assert line.master.data == b"\x40"
    assert line.master.slaves == 1
    # CTS, address 40h: x^14 + x^10 = 1001 + 0111 = 1110, inverted 0001.
    assert line.cdm[:46] == bits_of("00000000000000 1  1 000 1000000 0001 1 0 1  000000000000 0")
    assert not any(line.cdm[46:])
    assert line.cds[:47] == bits_of("00000000000000 0  1000000000000000 1 0 1 01000000 1000 0")
    assert not any(line.cds[47:])


def test_a_sequence_of_writes_written_out(build: Build) -> None:
    line = build()
    line.master.write(0x60, b"\x06\x80", 0, 0)
    assert line.run() == "DONE"
    assert line.memories[0].writes == [(0x60, 0x06), (0x61, 0x80)]
    assert line.cdm[:60] == bits_of("00000000000000 1  1 000 1100000 1011 0 1 1  00000110 0101 0 1  10000000 0001 0")
    assert line.cds[15:61] == bits_of("1000000000000000 0 1 1  00000110 0101 0 1  10000000 0001 0")


@pytest.mark.parametrize("languages", PAIRS, ids="-".join)
def test_the_same_bits_in_both_languages(build: Build, languages: tuple[str, str]) -> None:
    """Reads, writes, refusals, waiting and missing slaves: every bit equals the bits between two machines in Python."""

    def run_accesses(pair: tuple[str, str]) -> list[object]:
        line = build(pair, chain=3, readable=range(0x10, 0x60), writable=range(0x20, 0x50))
        outcomes: list[object] = []
        for delay in (0, 1, 4):
            for slave_id in (0, 2, 3):
                for address, count in ((0x10, 1), (0x3D, 3), (0x1E, 4), (0x4E, 4), (0x5E, 3), (0x7F, 1)):
                    for memory in line.memories:
                        memory.delay = delay
                    line.master.read(address, count, slave_id, 3)
                    outcomes += [line.run(), line.master.data, line.master.done, line.master.slaves]
                    line.master.write(address, bytes(range(count)), slave_id, 3)
                    outcomes += [line.run(), line.master.done, [slave.slave_id for slave in line.slaves]]
        return [*outcomes, line.cdm, line.cds, [memory.writes for memory in line.memories]]

    python = run_accesses(("python", "python"))
    assert {"DONE", "REFUSED", "NO_ANSWER", "BUSY"} <= {outcome for outcome in python if isinstance(outcome, str)}
    assert run_accesses(languages) == python


@pytest.mark.parametrize("languages", PAIRS, ids="-".join)
def test_one_flipped_bit_as_in_python(build: Build, languages: tuple[str, str]) -> None:
    """Each flipped bit has the same effect as in the tests of the Python module."""

    def run_accesses(pair: tuple[str, str], write: bool, frame: int, of_cds: bool) -> object:
        line = build(pair, readable=[0x44, 0x45], writable=[0x44, 0x45])
        if of_cds:
            line.disturb_cds = lambda number, bit: bit ^ (number == frame)
        else:
            line.disturb_cdm = lambda number, bit: bit ^ (number == frame)
        if write:
            line.master.write(0x44, b"\x06\x81", 0, 3)
        else:
            line.master.read(0x44, 2, 0, 3)
        return line.run(), line.master.data, line.master.done, line.cdm, line.cds, line.memories[0].writes

    for write in (False, True):
        for of_cds in (False, True):
            for frame in range(0, 62, 1 if languages == ("c", "c") else 5):
                assert run_accesses(languages, write, frame, of_cds) == run_accesses(
                    ("python", "python"), write, frame, of_cds
                ), (
                    write,
                    of_cds,
                    frame,
                )


@pytest.mark.parametrize("chain", [1, 2, 8, 9, 11])
def test_id_lock(build: Build, chain: int) -> None:
    line = build(chain=chain)
    for slave_id in range(8):
        line.master.write(0x20, bytes([slave_id]), slave_id, 0)
        assert line.run() == ("DONE" if slave_id < chain else "NO_ANSWER")
        assert line.master.slaves == min(chain, 9)
    assert [slave.slave_id for slave in reversed(line.slaves)] == [*range(min(chain, 8)), *[None] * (chain - 8)]
    expected = [[(0x20, number)] if number < 8 else [] for number in range(chain)]
    assert [memory.writes for memory in reversed(line.memories)] == expected


def test_all_registers_at_once(build: Build) -> None:
    for start in (0x00, 0x40):
        line = build()
        line.master.read(start, 64, 0, 0)
        assert line.run() == "DONE"
        assert line.master.data == bytes(range(start, start + 64))
        line.master.write(start, bytes(64), 0, 0)
        assert line.run() == "DONE"
        assert line.memories[0].writes == [(start + index, 0) for index in range(64)]


@pytest.mark.parametrize(
    ("address", "count"),
    [(0, 0), (0, 65), (0x3F, 2), (0x40, 65), (0x7F, 2), (0x20, 33), (128, 1), (255, 1), (0, 2**32 + 1), (0, 2**63)],
)
def test_sequences_past_the_end_are_refused_before_anything_is_sent(
    ask: Ask, build: Build, address: int, count: int
) -> None:
    line = build()
    assert ask("r", 0, address, count, 0) == [RESULTS.index("RANGE")] == ask("r", 8, 0, 1, 0)
    if count <= 65:
        assert ask("w", 0, address, 0, count, *[0] * count) == [RESULTS.index("RANGE")]
    for _ in range(40):
        line.frame()
    assert line.master.outcome == "IDLE"
    assert not any(line.cdm)


def test_given_up_at_every_bit(build: Build) -> None:
    for frames in range(15, 62):
        line = build()
        line.master.write(0x50, b"\x11\x22", 0, 0)
        for _ in range(frames):
            line.frame()
        is_over = line.master.outcome != "RUNNING"
        line.master.abort()
        assert line.master.outcome == ("DONE" if is_over else "ABORTED")
        line.master.read(0x44, 1, 0, 0)
        assert line.run() == "DONE"
        assert line.master.data == b"\x44"


def test_what_a_slave_allows(ask: Ask, build: Build) -> None:
    """Eleven registers can be read, the last and one more written, and four in the middle neither. All are tried."""
    line = build(readable=(), writable=())
    assert ask("l", 0, 0x43, 11, 1, 0) == ask("l", 0, 0x4D, 2, 0, 1) == ask("l", 0, 0x45, 4, 0, 0) == [0]
    read, written = [], []
    for address in range(128):
        line.master.read(address, 1, 0, 0)
        read += [address] if line.run() == "DONE" else []
        line.master.write(address, b"\x00", 0, 0)
        written += [address] if line.run() == "DONE" else []
    assert read == [0x43, 0x44, 0x49, 0x4A, 0x4B, 0x4C]
    assert written == [0x4D, 0x4E]


def test_what_a_slave_cannot_allow(ask: Ask) -> None:
    ask("i")
    assert (
        ask("l", 0, 0x7F, 2, 1, 1) == ask("l", 0, 128, 0, 1, 1) == ask("l", 0, 0, 129, 1, 1) == [RESULTS.index("RANGE")]
    )
    assert ask("l", 0, 0, 128, 1, 1) == ask("l", 0, 0x7F, 1, 0, 0) == [0]


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_whatever_is_written_is_read_again(build: Build, data: st.DataObject) -> None:
    line = build(data.draw(st.sampled_from(PAIRS)))
    registers = dict(line.memories[0].registers)
    for _ in range(data.draw(st.integers(1, 5), "accesses")):
        address = data.draw(st.integers(0, 127))
        content = data.draw(st.binary(min_size=1, max_size=min(4, 64 - address % 64)))
        line.memories[0].delay = data.draw(st.integers(0, 4))
        line.master.write(address, content, 0, 5)
        assert line.run() == "DONE"
        registers |= {address + index: byte for index, byte in enumerate(content)}
        line.master.read(address, len(content), 0, 5)
        assert line.run() == "DONE"
        assert line.master.data == content
        assert line.memories[0].registers == registers


# --------------------------------------------------------------------------------------------------------------- header


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    mostly_exhaustive(
        ["gcc -std=c99", "gcc -std=c17", "g++ -x c++ -std=c++11", "clang -std=c99", "clang -x c++ -std=c++17"],
        "gcc -std=c99",
    ),
)
def test_no_warning(command: str, include: Path, tmp_path: Path) -> None:
    require(command.split())
    for optimised in ("-O0", "-O2"):
        compile_c([*command.split(), optimised], PROGRAM, tmp_path, include, link=False)
