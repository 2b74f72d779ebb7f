"""Pointers are checked only where CW_ASSERT does so."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, RUNTIME, compile_c

#: Each function that checks its pointers, called with one null pointer.
CALLS = (
    "cw_received_words16(NULL, 0U, rx)",
    "cw_received_words32(words, 0U, NULL)",
    "(void)cw_received_samples(rx, 0U, 1U, NULL)",
    "(void)!cw_biss_receive(NULL, 0U, 47U, &word)",
    "(void)!cw_biss_receive_bits(rx, 0U, 47U, NULL)",
    "(void)!cw_biss_find_frame(rx, 0U, 47U, NULL)",
    "(void)!cw_biss_receive_cds(rx, 0U, NULL)",
    "(void)!cw_biss_receive_frame(NULL, 0U, 70U, frame, 9U)",
    "(void)!cw_biss_receive_frame_bits(rx, 0U, 70U, NULL, 9U)",
    "(void)!cw_ssi_receive(NULL, 0U, 39U, &word)",
    "(void)!cw_ssi_receive_frame(NULL, 0U, 70U, frame, 9U)",
    "(void)!cw_rs485_ask(NULL, 0U, 0U, 0U, 0U, 0U)",
    "(void)cw_rs485_take(NULL, 0U)",
    "(void)cw_rs485_take_any(NULL, 0U)",
    "cw_rs485_resume(NULL)",
    "(void)cw_rs485_late(NULL, 0U)",
    "(void)!cw_rs485_reason(NULL)",
    "cw_tracker_start(NULL, &config, 0U)",
    "cw_tracker_restart(NULL, 0U)",
    "(void)cw_tracker_add(NULL, 0U, 0U)",
    "(void)cw_tracker_speed(NULL)",
)
#: The headers with these functions.
CHECKED = ("receive", "receive_frame", "tracker")
PROGRAM = """
#include <stdlib.h>
#define CW_ASSERT(condition) do { if (!(condition)) { exit(77); } } while (0)
#include "codewheel/receive_frame.h"
#include "codewheel/tracker.h"
int main(int count, char **given)
{
    static uint8_t rx[8];
    static uint8_t frame[9];
    static uint32_t words[2];
    static const cw_tracker_config config = { 0U, 0U, 0U, 0U, 0U };
    uint64_t word = 0U;
    (void)count; (void)words; (void)config; (void)word; (void)rx; (void)frame;
    switch (atoi(given[1])) {
@cases@
    default: return 0;
    }
    return 1;
}
"""


@pytest.mark.slow
def test_a_null_pointer_ends_in_the_assertion(tmp_path: Path) -> None:
    cases = "".join(f"    case {at}: {call}; break;\n" for at, call in enumerate(CALLS))
    program = compile_c([*GCC, "-O1"], PROGRAM.replace("@cases@", cases), tmp_path, RUNTIME)
    ended = [subprocess.run([str(program), str(at)]).returncode for at in range(len(CALLS) + 1)]
    assert ended == [77] * len(CALLS) + [0]


def test_every_assertion_is_called_above() -> None:
    """Functions that forward to one of them have no checks of their own."""
    text = "".join((RUNTIME / "codewheel" / f"{name}.h").read_text(encoding="ascii") for name in CHECKED)
    checked = set(re.findall(r"^static inline [^\n(]*\b(cw_\w+)\([^{}]*?\)\n\{\n    CW_ASSERT\(", text, re.MULTILINE))
    called = set(re.findall(r"\b(cw_\w+)\(", " ".join(CALLS)))
    forwarded = {"cw_biss_receive", "cw_biss_receive_cds", "cw_biss_receive_frame"}
    assert checked == called - forwarded | {"cw_biss_receive_cds_bits"}
    assert text.count("CW_ASSERT(") == len(checked)


@pytest.mark.slow
def test_without_a_definition_nothing_is_checked(tmp_path: Path) -> None:
    text = '#include "codewheel/receive.h"\nint main(void)\n{\n    CW_ASSERT(0);\n    return 0;\n}\n'
    program = compile_c(GCC, text, tmp_path, RUNTIME)
    assert subprocess.run([str(program)]).returncode == 0
