"""Small C compiler SDCC: what reads a position compiles for MCS-51 and STM8. Nothing is run there."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from tools import tool
from tree import generated_tree

#: SDCC passes arguments of functions that call each other in fixed places, unless they go on a stack.
PROCESSORS = {"mcs51": ["-mmcs51", "--model-large", "--stack-auto"], "stm8": ["-mstm8"]}


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("sdcc")) / "c" / "include"


@pytest.mark.parametrize(
    ("interface", "processor"), [("biss", "mcs51"), ("ssi", "mcs51"), ("rs485", "mcs51"), ("biss", "stm8")]
)
def test_headers_compile(interface: str, processor: str, include: Path, tmp_path: Path) -> None:
    headers = (f"lika/amm5_{interface}", "codewheel/receive", "codewheel/tracker")
    text = "".join(f'#include "{name}.h"\n' for name in headers) + "void main(void)\n{\n}\n"
    (tmp_path / "unit.c").write_text(text, encoding="ascii")
    command = [tool("sdcc"), "--std-c99", *PROCESSORS[processor], f"-I{include}", "-c", "unit.c", "-o", "unit.rel"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]
    assert (tmp_path / "unit.rel").is_file()
