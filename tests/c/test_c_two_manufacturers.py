"""Encoders of two manufacturers in one program: one runtime, one BiSS master, and comparable verdicts."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import RUNTIME, SANITIZED, WARNINGS, devices_of, write
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from working_tools import require

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "examples" / "two-manufacturers" / "two_encoders.c"
PRINTED = """\
AMM5: year 21, week 26, number 42
TV62: number 123456
AMM5: position 1000503, usable with a warning
TV62: position 70001, usable
both: usable with a warning
"""


@pytest.mark.slow
@pytest.mark.parametrize("command", [["gcc", "-std=c99"], ["g++", "-x", "c++", "-std=c++11"]], ids=" ".join)
def test_one_master_and_one_comparison_of_verdicts(command: list[str], tmp_path: Path) -> None:
    include = write(tmp_path, (*devices_of(), *devices_of(ROOT / "docs" / "example")))
    program = tmp_path / "two_encoders"
    require([*command, *SANITIZED])
    completed = subprocess.run(
        [*command, *WARNINGS, *SANITIZED, f"-I{include}", str(PROGRAM), "-o", str(program)],
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr[:3000]
    assert subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout == PRINTED


@pytest.mark.slow
def test_a_second_manufacturer_adds_nothing_but_its_own_headers() -> None:
    lika, tolvarn = devices_of(), devices_of(ROOT / "docs" / "example")
    lika_paths, all_paths = _header_paths(lika), _header_paths((*lika, *tolvarn))
    assert {"c/include/tolvarn/tv62_biss.h", "c/include/tolvarn/tv62_ssi.h"} < all_paths - lika_paths
    assert all(path.startswith("c/include/tolvarn/tv62_") for path in all_paths - lika_paths)
    runtime = {f"c/include/codewheel/{path.name}" for path in (RUNTIME / "codewheel").iterdir()}
    assert {path for path in lika_paths if "/codewheel/" in path} == runtime


def _header_paths(devices: tuple[Device, ...]) -> set[str]:
    return {path for path in generate(Library(devices)) if path.startswith("c/include/")}
