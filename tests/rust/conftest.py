"""The target installed as its user would install it, and a program for each family."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from rust_harness import PACKAGE, ROOT, Workshop


@pytest.fixture(scope="session")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("rust"), "-C", "opt-level=0")


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder where the package of the target is installed."""
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(PACKAGE, folder / "source", ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    completed = subprocess.run(
        [*command, "--target", str(folder / "site"), str(folder / "source")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stderr
    return folder / "site"


@pytest.fixture(scope="session")
def codewheel(site: Path) -> Callable[..., tuple[int, str, str]]:
    """Run the command with the target installed. Return its exit code and its output."""

    def run(*arguments: str | Path, cwd: Path = ROOT) -> tuple[int, str, str]:
        command = [sys.executable, "-m", "codewheel", *map(str, arguments)]
        environment = {**os.environ, "PYTHONPATH": str(site)}
        completed = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
        return completed.returncode, completed.stdout, completed.stderr

    return run
