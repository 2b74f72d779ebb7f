"""The main loop of the README sets a preset over BiSS, with an encoder that loses frames.

The encoder is the slave of ``biss.h``, which has tests of its own with independent models. The preset 1,000,003 and its
bytes are from the AMM5 manual, 6.4.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, SANITIZED, MadeOnce, compile_c, devices_of, write

pytestmark = pytest.mark.slow

#: Arguments: one frame in this many is lost (0: none), number of presets, time of the cut, and its duration.
ENCODER = r"""
#include "lika/amm5_biss_simulate.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codewheel/biss_slave.h"

static uint8_t memory[128], rx[LIKA_AMM5_BISS_A21_65KSC1_RX_BYTES];
static cw_biss_slave slave;
static uint64_t shaft = 1000503U, moved; /* so near to the preset that a step to it looks like a movement */
static uint32_t now_us, busy_until, chance = 1U;
static unsigned verbose;
static bool cdm, next;

static uint32_t random_below(uint32_t bound)
{
    chance = chance * 1664525U + 1013904223U;
    return (chance >> 8U) % bound;
}

static uint64_t shown(void) { return (shaft + moved) & (((uint64_t)1U << 37U) - 1U); }

static void store(uint8_t address, uint8_t value)
{
    if (verbose != 0U) { printf("w %02X %02X\n", address, value); }
    memory[address] = value;
    if (address == 0x77U && value == 2U) {
        uint64_t preset = 0U;
        unsigned at;
        for (at = 7U; at > 0U; at--) { preset = (preset << 8U) | memory[0x10U + at]; }
        moved = (preset >> 12U) - shaft;
    }
}

static void draw(bool cds)
{
    lika_amm5_biss_frame frame;
    uint64_t word = 0U;
    unsigned at;
    memset(&frame, 0, sizeof frame);
    frame.error = false;
    if (lika_amm5_biss_set_position(LIKA_AMM5_BISS_A21_65KSC1, shown(), &frame) != CW_OK
        || lika_amm5_biss_encode(LIKA_AMM5_BISS_A21_65KSC1, &frame, &word) != CW_OK) { abort(); }
    memset(rx, 0, sizeof rx);
    rx[0] = 0xC2U | (cds ? 1U : 0U); /* rest, an acknowledge of four bits, start, CDS */
    for (at = 0U; at < 45U; at++) {
        if (((word >> (44U - at)) & 1U) != 0U) { rx[1U + at / 8U] |= (uint8_t)(0x80U >> (at % 8U)); }
    }
}

/* One frame: seen by the encoder and by the master, or by one, or by none. It takes a write at once. */
static void frame(bool seen_there, bool seen_here)
{
    bool cds = false;
    if (seen_there) {
        cds = cw_biss_slave_next(&slave, cdm, false);
        cdm = next;
    }
    if (slave.wants == CW_BISS_WANTS_BYTE) {
        cw_biss_slave_give(&slave, memory[slave.address]);
    } else if (slave.wants == CW_BISS_WANTS_STORE && busy_until == 0U) {
        busy_until = now_us + 4000U;
        store(slave.address, slave.value);
    } else if (slave.wants == CW_BISS_WANTS_STORE && (int32_t)(now_us - busy_until) >= 0) {
        busy_until = 0U;
        cw_biss_slave_stored(&slave);
    }
    draw(cds);
    if (!seen_there || !seen_here) { memset(rx, 0xFF, sizeof rx); }
    next = frame_received(rx, sizeof rx, now_us);
}

int main(int count, char **given)
{
    const cw_tracker_config limits = { (uint64_t)1U << 37U, 100000000U, 0U, 0U, 0U };
    const uint32_t lost_of = (uint32_t)atoi(given[1]);
    const unsigned presets = (unsigned)atoi(given[2]);
    const uint32_t cut = (uint32_t)atoi(given[3]), mended = cut + (uint32_t)atoi(given[4]);
    unsigned done, well = 0U, open = 0U, ends = 0U, elsewhere = 0U, moves = 0U;
    (void)count;
    verbose = presets == 1U;
    cw_biss_slave_init(&slave);
    if (cw_biss_slave_allow(&slave, 0U, 128U, true, true) != CW_OK) { return 1; }
    cw_biss_master_init(&master);
    cw_tracker_start(&axis, &limits, 0U);
    for (done = 0U; done < presets; done++) {
        unsigned left;
        int64_t before;
        shaft += 9000U;
        for (left = 0U; left < 40U; left++) { now_us += FRAME_US; frame(true, true); (void)step(now_us); }
        before = axis.position;
        if (start(1000003U, now_us) != CW_OK) { return 1; }
        for (left = 200000U; left > 0U; left--) {
            const bool off = now_us >= cut && now_us < mended;
            const bool is_lost = off || (lost_of != 0U && random_below(lost_of) == 0U);
            now_us += FRAME_US;
            frame(!is_lost || (!off && random_below(2U) != 0U), !is_lost);
            if (step(now_us)) { break; }
            moves += (axis.position != before || axis.moved != 0) ? 1U : 0U;
        }
        ends += left != 0U;
        well += runner.result == CW_OK;
        if (verbose != 0U) { printf("%d %d\n", (int)runner.result, (int)runner.failure.left_open); }
        /* What is asked once more does nothing. */
        for (left = 0U; left < 3U; left++) {
            now_us += FRAME_US;
            frame(true, true);
            ends += step(now_us) ? 1U : 0U;
        }
        open += memory[0x40] != 0U;
        elsewhere += (runner.result == CW_OK) && (axis.known == 0U || axis.position != 1000003 || axis.moved != 0);
    }
    printf("%u ends, %u well, %u open, %u elsewhere, %u moves\n", ends, well, open, elsewhere, moves);
    return 0;
}
"""

#: From the AMM5 manual, 6.4: 40h opens and closes the preset, and 77h saves and activates it.
PRESET = ["40 01", "11 00", "12 30", "13 24", "14 F4", "15 00", "16 00", "17 00", "40 00", "77 01", "77 02"]


@pytest.fixture(scope="module")
def loop(made_once: MadeOnce) -> Path:
    def built(folder: Path) -> None:
        include = write(folder, devices_of())
        code = re.findall(r"```c\n(.*?)```", (include.parent / "README.md").read_text(), re.DOTALL)
        compile_c([*GCC, "-O2", *SANITIZED], code[0] + code[-1] + ENCODER, folder, include)

    return made_once("main_loop", built) / "program"


def printed_lines(loop: Path, lost_of: int, presets: int, cut_us: int = 0, for_us: int = 0) -> list[str]:
    command = [str(loop), *map(str, (lost_of, presets, cut_us, for_us))]
    completed = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert completed.returncode == 0, completed.stderr
    return completed.stdout.splitlines()


def test_a_preset_of_the_manual(loop: Path) -> None:
    lines = printed_lines(loop, 0, 1)
    assert lines == [*(f"w {line}" for line in PRESET), "0 0", "1 ends, 1 well, 0 open, 0 elsewhere, 0 moves"]


def test_frames_that_are_lost_cost_time_alone(loop: Path) -> None:
    """Each access takes 47 frames. Without a second try, nearly all presets would fail."""
    assert printed_lines(loop, 300, 200) == ["200 ends, 200 well, 0 open, 0 elsewhere, 0 moves"]


def test_nothing_stays_open_on_a_bad_line(loop: Path) -> None:
    """If one frame in 30 is lost, almost no access succeeds."""
    (line,) = printed_lines(loop, 30, 200)
    counts = re.fullmatch(r"200 ends, (\d+) well, 0 open, 0 elsewhere, 0 moves", line)
    assert counts is not None, line
    assert int(counts[1]) < 100


def test_a_line_that_comes_back_is_waited_for(loop: Path) -> None:
    """The line is cut for 90 ms once 40h is open."""
    assert printed_lines(loop, 0, 1, 40_000, 90_000)[-2:] == ["0 0", "1 ends, 1 well, 0 open, 0 elsewhere, 0 moves"]


def test_what_is_open_is_closed_when_the_line_is_back(loop: Path) -> None:
    """The line is cut for three seconds. By then the procedure has failed, and only closes."""
    lines = printed_lines(loop, 0, 1, 40_000, 3_000_000)
    assert lines[0] == "w 40 01"
    assert lines[-3:] == ["w 40 00", "5 0", "1 ends, 0 well, 0 open, 0 elsewhere, 0 moves"]
    assert "w 77 01" not in lines


def test_what_cannot_be_closed_is_told(loop: Path) -> None:
    lines = printed_lines(loop, 0, 1, 40_000, 1_000_000_000)
    assert lines[-2:] == ["5 1", "1 ends, 0 well, 1 open, 0 elsewhere, 0 moves"]
