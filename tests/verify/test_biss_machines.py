"""Register access over BiSS, proved by CBMC for every state of a machine and every bit on the line."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_harness import RUNTIME
from claims import planted
from tools import tool

HARNESS = Path(__file__).with_name("proof_biss.c")
#: Undefined behaviour, and also every unsigned overflow and every number that does not fit into a smaller type.
CHECKS = (
    "--bounds-check --pointer-check --pointer-overflow-check --pointer-primitive-check"
    " --signed-overflow-check --unsigned-overflow-check --conversion-check --undefined-shift-check --div-by-zero-check"
    " --unwind 130 --unwinding-assertions"
).split()
CLAIMS = re.findall(r"^void (\w+)\(void\)$", HARNESS.read_text(encoding="utf-8"), re.MULTILINE)


def verdict(include: Path, claim: str) -> str:
    """Return the failed claims."""
    checker = tool("cbmc", [str(Path(__file__).resolve().parents[2] / ".cbmc")])
    completed = subprocess.run(
        [checker, str(HARNESS), f"-I{include}", "--function", claim, *CHECKS],
        capture_output=True,
        text=True,
        timeout=400,
    )
    # A function without a body may return anything, and the harness needs this.
    failed = [line for line in completed.stdout.splitlines() if line.endswith(": FAILURE") and ".no-body." not in line]
    assert failed or "0 of " in completed.stdout, completed.stdout[-2000:] + completed.stderr[-2000:]
    return "\n".join(failed)


@pytest.mark.parametrize("claim", CLAIMS)
def test_whatever_comes_over_the_line(claim: str) -> None:
    assert verdict(RUNTIME, claim) == ""


@pytest.mark.parametrize(
    ("claim", "header", "sound", "instead"),
    [
        (
            "one_more_bit_of_a_master",
            "biss.h",
            "index == CW_BISS_BYTE_BITS) {\n        if (cds)",
            "index == 13U) {\n        if (cds)",
        ),
        (
            "one_more_bit_of_a_late_master",
            "biss.h",
            "if (master->bit_index == (CW_BISS_HEADER_BITS + 1U)) {",
            "if (master->bit_index == 19U) {",
        ),
        (
            "one_more_bit_of_a_late_master",
            "biss.h",
            "master->repeats_start = !master->request.write;",
            "master->repeats_start = true;",
        ),
        ("a_master_begins", "biss.h", "(request->address % CW_BISS_REGISTERS)", "(request->address % 32U)"),
        (
            "one_more_bit_of_a_slave",
            "biss_slave.h",
            "if (slave->bit_index > CW_BISS_BYTE_BITS) {",
            "if (slave->bit_index > 13U) {",
        ),
        (
            "one_more_bit_of_a_slave",
            "biss_slave.h",
            "const bool is_last = (next_address % CW_BISS_REGISTERS) == 0U;",
            "const bool is_last = false;",
        ),
        ("words", "biss.h", "return crc ^ 0xFU;", "return crc ^ 0x1FU;"),
    ],
)
def test_what_is_planted_is_found(claim: str, header: str, sound: str, instead: str, tmp_path: Path) -> None:
    assert verdict(planted(RUNTIME, header, sound, instead, tmp_path), claim) != ""
