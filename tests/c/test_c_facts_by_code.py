"""Facts by order code in C: each order code has its own macros, and compiles with all warnings as errors."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, SANITIZED, compile_c, devices_of, write

# Compiles a program.
pytestmark = pytest.mark.slow

MADE_UP = Path(__file__).resolve().parents[1] / "check" / "ok_model"
PROGRAM = """\
#include <stdio.h>

#include "acme/facts_by_code_biss.h"
#include "acme/facts_by_code_ssi.h"

#define SSI(code, fact) (unsigned long)ACME_FACTS_BY_CODE_SSI_##code##_##fact
#define BISS(code, fact) (unsigned long)ACME_FACTS_BY_CODE_BISS_##code##_##fact

int main(void)
{
    printf("%lu %lu\\n", SSI(FBC12_BG, CLOCK_MAX_HZ), SSI(FBC16_BG, CLOCK_MAX_HZ));
    printf("%lu %lu\\n", SSI(FBC12_BG, CLOCK_LIMIT_HZ)(30U), SSI(FBC16_BG, CLOCK_LIMIT_HZ)(30U));
    printf("%lu %lu\\n", SSI(FBC12_BG, PAUSE_AT_LEAST_US), SSI(FBC16_BG, PAUSE_AT_LEAST_US));
    printf("%lu %lu\\n", BISS(FBC12_SC, CLOCK_MIN_HZ), BISS(FBC16_SC, CLOCK_MIN_HZ));
    printf("%lu %lu\\n", BISS(FBC12_SC, TIMEOUT_NS)(1000000U), BISS(FBC16_SC, TIMEOUT_AT_MOST_NS));
    printf("%lu %lu\\n", BISS(FBC12_SC, STARTUP_AT_MOST_US), BISS(FBC16_SC, STARTUP_AT_MOST_US));
    return 0;
}
"""


def test_two_order_codes_with_different_values(tmp_path: Path) -> None:
    """One and a half periods of 1 MHz are 1500 ns. The other values come from the made-up spec."""
    include = write(tmp_path, devices_of(MADE_UP / "manufacturer.yaml", MADE_UP / "facts_by_code.yaml"))
    program = compile_c([*GCC, *SANITIZED], PROGRAM, tmp_path, include)
    output = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
    assert output.splitlines() == [
        "2000000 1000000",
        "800000 400000",
        "12 20",
        "50000 200000",
        "1500 20000",
        "100000 300000",
    ]
