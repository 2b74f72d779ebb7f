"""Linear encoders whose counts are not a whole number of micrometres, from public files.

LA11: the data sheet LA11D01_04 has up to 0.244 µm and axes up to 16.3 m, and ecmccfg has 4096 counts per mm.
RESOLUTE: the README of lcls-plc-sxr-satt has 50 nm, and ecmccfg 5 nm.
"""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.say import decimal

ENCODERS = Path(__file__).parents[2] / "specs"
#: A frame of real hardware, whose position is 2,979,902,961.
CAPTURED = "0b1011000110011101101101011111000111010011"
#: The same lines for a Python package, with values that follow from the data sheets.
IN_PYTHON = """
from fractions import Fraction
from codewheel_runtime.measures import FineLinear, Linear
from renishaw_encoders import lookup as resolute
from rls_encoders import lookup as la11
tape, scale = la11("LA1126bit"), resolute("RESOLUTE-LINEAR-32-050")
assert isinstance(tape, FineLinear) and not isinstance(tape, Linear)
assert (tape.nanometres(4096), tape.nanometres(1)) == (1_000_000, Fraction(15625, 64))
assert tape.micrometres(-3) == Fraction(-46875, 64000) and tape.millimetres(2**26) == 16384.0
assert (tape.metres(4096), tape.from_millimetres(1.0)) == (0.001, 4096)
assert la11("LA11DCB2D0KB").from_millimetres(1.0) == 1024
assert scale.micrometres(2979902961) == Fraction(14899514805, 100) and scale.per_counts == 1
"""
IN_C = """
#include <stdio.h>
#include "renishaw/resolute_linear_biss.h"
#include "rls/la11_biss.h"
int main(void) {
    const renishaw_resolute_linear_biss scale = RENISHAW_RESOLUTE_LINEAR_BISS_RESOLUTE_LINEAR_32_050;
    const rls_la11_biss tape = RLS_LA11_BISS_26BIT;
    printf("%lld %lld %lld ", (long long)rls_la11_biss_nanometres(tape, 4096),
        (long long)rls_la11_biss_nanometres(tape, 3), (long long)rls_la11_biss_nanometres(tape, -3));
    printf("%.17g ", rls_la11_biss_millimetres(tape, 1));
    printf("%lld ", (long long)renishaw_resolute_linear_biss_nanometres(scale, 2979902961));
    printf("%.17g", renishaw_resolute_linear_biss_millimetres(scale, 1));
    return 0;
}
"""


def text(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main([*arguments, "--specs", str(ENCODERS)]) == 0
    return " ".join(capsys.readouterr().out.split())


def test_decode_and_show_give_the_exact_decimal(capsys: pytest.CaptureFixture[str]) -> None:
    assert "position: 148,995,148.05 µm CRC" in text(capsys, "decode", "RESOLUTE-LINEAR-32-050", CAPTURED)
    assert "position: 14,899,514.805 µm CRC" in text(capsys, "decode", "RESOLUTE-LINEAR-32-005", CAPTURED)
    printed = text(capsys, "show", "LA1126bit")
    assert "1,000,000 nm per 4,096 counts, 67,108,864 counts in total, 16,384.000 mm in total" in printed
    assert "50 nm per count [" in text(capsys, "show", "RESOLUTE-LINEAR-32-050")


def test_masters_get_the_exact_step_or_the_reason_why_not(capsys: pytest.CaptureFixture[str]) -> None:
    ax8000, akd = ("--master", "beckhoff_ax8000"), ("--master", "kollmorgen_akd")
    assert "Measuring step length 5000 32EF:03" in text(capsys, "master", "RESOLUTE-LINEAR-32-005", *ax8000)
    assert "unknown: one count is 0.9765625 µm, not a whole number of pm" in text(
        capsys, "master", "LA11DCB2D0KB", *ax8000
    )
    assert "(pole pitch / 0.005 µm) * 2^(32 - 32)" in text(capsys, "master", "RESOLUTE-LINEAR-32-005", *akd)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (Fraction(1_000_000, 4096), "244.140625"),
        (Fraction(-1, 8), "-0.125"),
        (Fraction(-9, 10), "-0.9"),
        (Fraction(12_345_678, 100), "123,456.78"),
        (Fraction(7), "7"),
        (Fraction(1, 3), "≈ 0.333333"),
        (Fraction(-2, 3), "≈ -0.666667"),
    ],
)
def test_decimals(value: Fraction, expected: str) -> None:
    assert decimal(value) == expected


@pytest.mark.slow
def test_python_and_c_convert_without_rounding(tmp_path: Path) -> None:
    specs = [str(ENCODERS / name) for name in ("renishaw", "rls")]
    assert main(["generate", *specs, "-o", str(tmp_path), "--target", "c", "--target", "python"]) == 0
    packages = tmp_path / "python"
    paths = [str(packages), *map(str, packages.glob("*")), str(ENCODERS.parent / "runtime" / "python")]
    subprocess.run([sys.executable, "-c", IN_PYTHON], env={"PYTHONPATH": ":".join(paths)}, check=True)
    (tmp_path / "main.c").write_text(IN_C, encoding="utf-8")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", f"-I{tmp_path}/c/include"]
    subprocess.run(["gcc", *flags, str(tmp_path / "main.c"), "-o", str(tmp_path / "main")], check=True)
    printed = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=True).stdout
    assert printed == "1000000 732 -732 0.000244140625 148995148050 5.0000000000000002e-05"
