"""Small C compiler SDCC: what reads a position compiles for MCS-51 and STM8, and runs on a simulated STM8."""

from __future__ import annotations

import random
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from c_harness import RUNTIME
from tools import tool

#: SDCC passes arguments of functions that call each other in fixed places, unless they go on a stack.
PROCESSORS = {"mcs51": ["-mmcs51", "--model-large", "--stack-auto"], "stm8": ["-mstm8"]}
BITS, LINES = 47, 12

#: Reads each line, follows its position with an axis that can move anywhere, and counts those that were right.
PROGRAM = """
#include "codewheel/receive.h"
#include "codewheel/tracker.h"
static const uint8_t lines[@LINES@][12] = { @bytes@ };
static const uint64_t words[@LINES@] = { @words@ };
static const cw_tracker_config config = { 0x800000000000ULL, 0xFFFFFFFFUL, 0U, 0U, 0U };
static cw_tracker axis;
uint8_t right;
void stopped(void)
{
    for (;;) {
    }
}
void main(void)
{
    uint8_t at;
    cw_tracker_start(&axis, &config, 0U);
    for (at = 0U; at < @LINES@U; at++) {
        uint64_t word = 0U;
        if ((cw_biss_receive(lines[at], 12U, @BITS@U, &word) == CW_OK) && (word == words[at])) {
            cw_tracker_restart(&axis, 0U);
            if ((cw_tracker_add(&axis, word, 1000U) == CW_OK) && (axis.raw == word)) {
                right++;
            }
        }
    }
    stopped();
}
"""


def sdcc(processor: str, source: str, include: Path, folder: Path, options: Sequence[str] = ("-c",)) -> Path:
    (folder / "unit.c").write_text(source, encoding="ascii")
    made = folder / ("unit.rel" if "-c" in options else "unit.ihx")
    command = [tool("sdcc"), "--std-c99", *PROCESSORS[processor], f"-I{include}", *options, "unit.c", "-o", made.name]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]
    return made


@pytest.mark.parametrize("processor", PROCESSORS)
def test_headers_compile(processor: str, tmp_path: Path) -> None:
    headers = "".join(f'#include "codewheel/{name}.h"\n' for name in ("receive", "tracker", "angle"))
    sdcc(processor, f"{headers}void main(void)\n{{\n}}\n", RUNTIME, tmp_path)


def run(program: Path) -> int:
    """The positions that were right when the program has stopped."""
    listed = program.with_suffix(".map").read_text(encoding="latin-1")
    found = re.findall(r"^ +([0-9A-F]{8}) +(_\w+)", listed, re.MULTILINE)
    symbols = {name: int(place, 16) for place, name in found}
    place = symbols["_right"]
    said = subprocess.run(
        [tool("sstm8"), "-t", "S105", program.name],
        input=f"break {symbols['_stopped']:#x}\nrun\ndump /h rom {place:#x} {place:#x}\nquit\n",
        cwd=program.parent,
        capture_output=True,
        encoding="latin-1",
        timeout=120,
    ).stdout
    byte = re.search(rf"^0x0*{place:x} +([0-9a-f]{{2}})\b", said, re.MULTILINE)
    assert byte, said[-2000:]
    return int(byte[1], 16)


def program(chance: random.Random) -> str:
    lines, words = [], []
    for _ in range(LINES):
        word = chance.getrandbits(BITS)
        bits = f"{'1' * chance.randint(1, 6)}{'0' * chance.randint(1, 30)}10{word:0{BITS}b}0".ljust(96, "1")
        lines.append("{ " + ", ".join(f"0x{int(bits[at : at + 8], 2):02X}" for at in range(0, 96, 8)) + " }")
        words.append(f"0x{word:X}ULL")
    text = PROGRAM.replace("@bytes@", ", ".join(lines)).replace("@words@", ", ".join(words))
    return text.replace("@LINES@", str(LINES)).replace("@BITS@", str(BITS))


def test_positions_on_a_simulated_stm8(tmp_path: Path) -> None:
    text = program(random.Random(8))
    assert run(sdcc("stm8", text, RUNTIME, tmp_path, ())) == LINES
    # One word that is not the one of the line is one position less.
    wrong = re.sub(r"= \{ 0x([0-9A-F]+)ULL", "= { 0x1\\1ULL", text, count=1)
    assert run(sdcc("stm8", wrong, RUNTIME, tmp_path, ())) == LINES - 1
