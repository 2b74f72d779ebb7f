"""``tracker.h`` and ``angle.h``: claims proved for every number, their size, and the absence of divisions."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest
from c_harness import GCC, RUNTIME, compile_c
from claims import claims_of, planted, verdict
from motion_harness import source
from proof import limited
from tools import tool

HARNESS = Path(__file__).with_name("proof_motion.c")
CORES = ("cortex-m0plus", "cortex-m4")
#: Limit of the tracker in a program that receives frames, and its size with the compiler that recorded it.
AT_MOST = 240
RECORDED = {"cortex-m0plus": 226, "cortex-m4": 234}
COMPILER = "12.2.1"


@pytest.fixture(scope="module")
def include() -> Path:
    """Return the include folder of the runtime."""
    return RUNTIME


@pytest.mark.parametrize("claim", claims_of(HARNESS))
def test_whatever_is_sent(claim: str, include: Path, tmp_path: Path) -> None:
    proved, words = verdict(HARNESS, claim, include, tmp_path, 97)
    assert proved, words


@pytest.mark.parametrize(
    ("claim", "header", "sound", "instead"),
    [
        ("what_is_believed_after_a_silence", "tracker.h", "forward += modulus;", "forward += modulus + 1U;"),
        ("what_is_believed_after_a_cycle", "tracker.h", "(2U * reach)", "(4U * reach)"),
        ("what_is_believed_after_an_hour", "tracker.h", "units > (CW_TRACKER_REACH_US / 16U)", "units == 0U"),
        ("what_was_lost", "tracker.h", "config->lost_after_refused - 1U", "config->lost_after_refused"),
        ("what_was_lost", "tracker.h", "if (tracker->lost != 0U) {", "if (tracker->lost > 1U) {"),
        ("what_is_refused_after_a_cycle", "tracker.h", "tracker->refused++;", "tracker->refused += 2U;"),
        ("what_the_speed_allows_in_a_while", "tracker.h", "max_speed >> 4U", "max_speed >> 5U"),
        ("highest_bit", "angle.h", "bit += 4U;", "bit += 5U;"),
        ("angle_of_a_power_of_two", "angle.h", "bits > 32U", "bits > 33U"),
        ("forms_of_an_angle", "angle.h", "parts -= 65536;", "parts -= 65535;"),
    ],
)
def test_what_is_planted_is_found(
    claim: str, header: str, sound: str, instead: str, include: Path, tmp_path: Path
) -> None:
    proved, words = verdict(HARNESS, claim, planted(include, header, sound, instead, tmp_path), tmp_path, 97)
    assert not proved
    assert "REFUTED" in words, words


#: Counts the angles that are not the nearest thousandth of a degree. The exact value is accumulated, so that nothing
#: here multiplies as the header does.
EVERY = """
#include <stdio.h>
#include "codewheel/angle.h"
int main(void)
{
    uint64_t exact = UINT64_C(0x80000000);
    uint32_t angle = 0U, wrong = 0U;
    do {
        const uint32_t nearest = (uint32_t)(exact >> 32U);
        wrong += cw_angle_millidegrees(angle) != ((nearest == 360000U) ? 0U : nearest);
        exact += 360000U;
        angle++;
    } while (angle != 0U);
    printf("%lu\\n", (unsigned long)wrong);
    return 0;
}
"""


#: Counts the angles that differ from a division: of each position of three turns with few steps, and of positions and
#: steps of any width, including positions next to a multiple of the steps.
ANY_STEPS = """
#include <stdio.h>
#include "codewheel/angle.h"
__extension__ typedef unsigned __int128 wide;
static uint64_t state = 1U;
static uint64_t any(void)
{
    state ^= state << 13U;
    state ^= state >> 7U;
    state ^= state << 17U;
    return state;
}
static uint32_t differs(uint64_t position, uint64_t steps)
{
    const wide rest = position % steps;
    return (cw_angle(position, steps) != (uint32_t)((rest << 32U) / steps)) ? 1U : 0U;
}
int main(void)
{
    uint64_t steps, position;
    uint32_t wrong = 0U;
    uint32_t at;
    for (steps = 1U; steps <= 1000U; steps++) {
        for (position = 0U; position < 3U * steps; position++) {
            wrong += differs(position, steps);
        }
    }
    for (at = 0U; at < 5000000U; at++) {
        steps = (any() >> (1U + (any() % 63U))) | 1U;
        position = any() >> (any() % 64U);
        wrong += differs(position, steps);
        position -= position % steps;
        wrong += differs(position, steps) + differs(position - 1U, steps);
    }
    printf("%lu\\n", (unsigned long)wrong);
    return 0;
}
"""


def wrong_angles(text: str, include: Path, folder: Path) -> int:
    program = compile_c([*GCC, "-O2"], text, folder, include)
    return int(subprocess.run(limited([str(program)]), capture_output=True, text=True, check=True).stdout)


def test_thousandths_of_a_degree_of_all_angles(include: Path, tmp_path: Path) -> None:
    """A product of 52 bits is too hard for the checker, but all 2^32 angles can be tried."""
    assert wrong_angles(EVERY, include, tmp_path) == 0


def test_a_wrong_thousandth_would_be_seen(include: Path, tmp_path: Path) -> None:
    broken = planted(include, "angle.h", "360000U) + 0x80000000U)", "360000U) + 0x7FFFFFFFU)", tmp_path)
    assert wrong_angles(EVERY, broken, tmp_path) > 0


def test_angles_of_any_number_of_steps(include: Path, tmp_path: Path) -> None:
    """A division by an unknown number is too hard for the checker as well. Steps are below 2^63."""
    assert wrong_angles(ANY_STEPS, include, tmp_path) == 0


def test_a_wrong_angle_would_be_seen(include: Path, tmp_path: Path) -> None:
    broken = planted(include, "angle.h", "if (remainder >= steps) {", "if (remainder > steps) {", tmp_path)
    assert wrong_angles(ANY_STEPS, broken, tmp_path) > 0


def symbols(core: str, include: Path, folder: Path, *options: str) -> Mapping[str, tuple[str, int]]:
    """Return each symbol of the object: its letter, and its number of bytes if it is defined."""
    compiler = tool("arm-none-eabi-gcc")
    (folder / "motion.c").write_text(source(), encoding="utf-8")
    command = [compiler, f"-mcpu={core}", "-mthumb", "-std=c99", "-Os", "-ffunction-sections", f"-I{include}", *options]
    subprocess.run([*command, "-c", str(folder / "motion.c"), "-o", str(folder / "motion.o")], check=True)
    symbol_list = subprocess.run(
        [tool("arm-none-eabi-nm"), "-S", str(folder / "motion.o")], capture_output=True, text=True, check=True
    ).stdout
    rows = re.findall(r"^(?:\w+ (\w+))? +(\w) (\S+)$", symbol_list, re.MULTILINE)
    return {name: (letter, int(size or "0", 16)) for size, letter, name in rows}


@pytest.mark.parametrize("core", CORES)
def test_nothing_divides_and_the_tracker_calls_nothing(core: str, include: Path, tmp_path: Path) -> None:
    symbol_table = symbols(core, include, tmp_path)
    called = {name for name, (letter, _) in symbol_table.items() if letter == "U"}
    assert not [name for name in called if "div" in name or "mod" in name or re.search(r"_d[a-z]+$|2d$", name)]
    assert "tracker_add" in symbol_table
    # The tracker alone, without functions of the compiler's library.
    alone = tmp_path / "alone"
    alone.mkdir()
    text = (
        '#include "codewheel/tracker.h"\nint add(cw_tracker *axis, uint64_t position, uint32_t now_us);\n'
        "int add(cw_tracker *axis, uint64_t position, uint32_t now_us)\n"
        "{\n    return (int)cw_tracker_add(axis, position, now_us);\n}\n"
    )
    (alone / "add.c").write_text(text, encoding="utf-8")
    command = [tool("arm-none-eabi-gcc"), f"-mcpu={core}", "-mthumb", "-Os", f"-I{include}", "-c"]
    subprocess.run([*command, str(alone / "add.c"), "-o", str(alone / "add.o")], check=True)
    needed = subprocess.run(
        [tool("arm-none-eabi-nm"), "-u", str(alone / "add.o")], capture_output=True, text=True, check=True
    ).stdout
    assert needed == ""


@pytest.mark.parametrize("core", CORES)
def test_the_tracker_is_small(core: str, include: Path, tmp_path: Path) -> None:
    size = symbols(core, include, tmp_path)["tracker_add"][1]
    assert 0 < size <= AT_MOST
    version = subprocess.run([tool("arm-none-eabi-gcc"), "-dumpfullversion"], capture_output=True, text=True).stdout
    if version.strip() == COMPILER:
        assert size <= RECORDED[core]


def test_a_division_would_be_seen(include: Path, tmp_path: Path) -> None:
    broken = planted(include, "tracker.h", "position - tracker->raw,", "position % tracker->modulus,", tmp_path)
    assert "__aeabi_uldivmod" in symbols("cortex-m0plus", broken, tmp_path)
