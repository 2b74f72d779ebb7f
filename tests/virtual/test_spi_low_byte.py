"""Words over SPI whose numbers are sent low byte first.

The word was captured from an MLX90363 (popos123/MLX90363 at commit 5517dfc, data.jpg). The low byte of the angle is
first, 2Fh, and its six high bits are the low ones of the second byte, B1h.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from codewheel.commands.cli import main

SPEC = Path(__file__).parents[1] / "specs" / "lowfirst.yaml"
CAPTURED = "2F B1 00 00 27 00 02 E1"
ANGLE = 0x31 << 8 | 0x2F
PROGRAM = """
#include <stdio.h>
#include "test/lowfirst_spi.h"
int main(void)
{
    test_lowfirst_spi_position frame = { 0 };
    const cw_result result = test_lowfirst_spi_position_decode(TEST_LOWFIRST_SPI_L14, 0x2FB10000270002E1U, &frame);
    printf("%d %u\\n", (int)result, (unsigned)frame.position);
    return 0;
}
"""


def test_a_captured_word(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["decode", "L14", CAPTURED, "--specs", str(SPEC.parent)]) == 0
    out = capsys.readouterr().out
    assert f"0x312f  {ANGLE}  high and low as one number" in out
    assert "position: 276.66°" in out


@pytest.mark.slow
def test_a_captured_word_in_c(tmp_path: Path) -> None:
    specs = [str(SPEC), str(SPEC.with_name("manufacturer.yaml"))]
    assert main(["generate", *specs, "-o", str(tmp_path / "out"), "--target", "c"]) == 0
    (tmp_path / "main.c").write_text(PROGRAM, encoding="ascii")
    include = f"-I{tmp_path / 'out' / 'c' / 'include'}"
    command = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", include, str(tmp_path / "main.c")]
    subprocess.run([*command, "-o", str(tmp_path / "main")], check=True)
    completed = subprocess.run([str(tmp_path / "main")], check=True, capture_output=True, text=True)
    assert completed.stdout == f"0 {ANGLE}\n"
