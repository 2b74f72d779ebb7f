"""The oldest versions that pyproject.toml allows: each Python from 3.10 on, and the lowest ones of dependencies."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
NEEDED = re.findall(r"^dependencies = (.*)$", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)[0]
LOWEST = re.findall(r'"([\w-]+)>=([\d.]+)"', NEEDED)


def python_of_version(version: str) -> str:
    """Return the Python of a version, on the path or where version managers install it, next to this Python.

    "" if none.
    """
    beside = Path(sys.base_prefix).parent
    candidates = [shutil.which(f"python{version}"), *map(str, sorted(beside.glob(f"{version}.*/bin/python")))]
    return next((path for path in candidates if path and _runs(path)), "")


def _runs(python: str) -> bool:
    """A version manager's name for a Python may lead nowhere."""
    return subprocess.run([python, "-c", ""], capture_output=True).returncode == 0


def run(*command: str | Path) -> str:
    completed = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=ROOT)
    assert completed.returncode == 0, completed.stdout[-2000:] + completed.stderr[-4000:]
    return completed.stdout


@pytest.mark.parametrize("version", PYTHONS)
def test_the_same_bytes(version: str, tmp_path: Path) -> None:
    """With the lowest versions on the oldest two, for which all have wheels, and otherwise with the newest."""
    python = python_of_version(version)
    if not python:
        pytest.skip(f"no Python {version} here, so it is not shown to work there")
    run(python, "-m", "venv", tmp_path / "there")
    programs = tmp_path / "there" / "bin"
    lowest = [f"{name}=={lowest_version}" for name, lowest_version in LOWEST] if version in PYTHONS[:2] else []
    # Return a copy, because setuptools leaves its files next to the sources.
    sources = tmp_path / "sources"
    shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns(".*", "*.egg-info", "__pycache__"))
    run(programs / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *lowest, sources)
    spec_files = [path for path in (ROOT / "specs").rglob("*.yaml") if ".second" not in path.name]
    families = [path for path in spec_files if "\ndevice: " in path.read_text(encoding="utf-8")]
    assert f"no problems in {len(families)} families" in run(programs / "codewheel", "check", "specs")
    assert run(programs / "codewheel", "generate", "--check").endswith("files up to date\n")
