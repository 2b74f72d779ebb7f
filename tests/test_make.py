"""The targets of make that are used exist, and the targets for every change use them."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def commands(*targets: str) -> str:
    """Return the commands that make would run if the virtual environment existed."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    command = ["make", "--dry-run", "--assume-old=.venv/.installed", *targets]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_lint_looks_at_format_and_rules() -> None:
    assert re.findall(r"-m (ruff \w+)", commands("lint")) == ["ruff format", "ruff check"]


@pytest.mark.slow
def test_quick_leaves_out_slow_tests_and_test_none() -> None:
    quick = commands("quick")
    assert re.findall(r"-m (ruff|mypy|codewheel|pytest)\b", quick) == ["ruff", "ruff", "mypy", "codewheel", "pytest"]
    assert "-m 'not slow'" in quick
    assert "slow" not in commands("test")
