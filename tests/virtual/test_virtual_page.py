"""The page on virtual encoders: its programs, and a simulation in Verilog that reads an encoder over TCP."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from working_tools import require

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/bench/virtual-encoders.md").read_text(encoding="utf-8")
PROGRAMS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)

pytestmark = pytest.mark.slow


def program_with(text: str) -> str:
    (program,) = (program for program in PROGRAMS if text in program)
    return str(program)


def test_the_programs(generated_python: tuple[Path, ModuleType], capsys: pytest.CaptureFixture[str]) -> None:
    for text, output in (("RegisterBus", "1000003\n5000\n"), ("SsiLine", "0x1f00f\n")):
        exec(program_with(text), {})
        assert capsys.readouterr().out == output


def test_the_fixture(generated_python: tuple[Path, ModuleType], virtual_encoder: Callable[..., Any]) -> None:
    names: dict[str, Any] = {}
    exec(program_with("virtual_encoder"), names)
    names["test_a_lost_reply"](virtual_encoder)


@pytest.mark.exhaustive
def test_the_simulation(tmp_path: Path) -> None:
    """In the page, 0F4243D3h is position 1,000,003 of AMM5A21/65KSC1 with its flags and CRC."""
    verilator = require(["verilator", "--version"])
    _, build, run, *expected = re.findall(
        r"^(?:\$ )?(.+)$",
        PAGE.split("```text\n")[2].split("```")[0].replace("$ cd examples/simulator\n", ""),
        re.MULTILINE,
    )
    sources = ROOT / "examples" / "simulator"
    arguments = [str(sources / word) if (sources / word).is_file() else word for word in build.split()[1:]]
    subprocess.run([verilator, *arguments], cwd=tmp_path, check=True, capture_output=True)
    command = [sys.executable, "-m", "codewheel", "simulate", "AMM5A21/65KSC1", "--position", "1000003", "--tcp"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            port = process.stdout.readline().strip().rpartition(":")[2]
            program = run.replace("4711", port).split()
            completed = subprocess.run(program, cwd=tmp_path, check=True, capture_output=True, text=True, timeout=60)
        finally:
            process.terminate()
    assert completed.stdout.splitlines()[:2] == expected
