"""What the README shows is what one gets."""

from __future__ import annotations

import doctest
import re
import shlex
import subprocess
import sys
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_its_python(generated_python: tuple[Path, ModuleType]) -> None:
    block = re.search(r"```python\n(.*?)```", README, re.DOTALL)
    assert block is not None
    test = doctest.DocTestParser().get_doctest(block[1], {}, "README", "README.md", 0)
    sys.modules["lika_encoders"] = generated_python[1]
    assert test.examples and doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


def test_its_commands() -> None:
    block = re.search(r"```\n(\$ .venv.*?)```", README, re.DOTALL)
    assert block is not None
    commands = [line for line in block[1].splitlines() if line.startswith("$ ")]
    for line in commands:
        command = [sys.executable, "-m", "codewheel", *shlex.split(line)[2:]]
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    shown = block[1].split(commands[-1])[1].strip().splitlines()
    made = done.stdout.splitlines()
    # Dots stand for lines left out; empty lines are not compared.
    wanted = [line for line in shown if line and line != "..."]
    assert wanted and [line for line in made if line in wanted] == wanted


def test_its_links() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
