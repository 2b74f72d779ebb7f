"""The targets of make that are used exist, and the targets for every change use them."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def commands(*targets: str) -> str:
    """Return the commands that make would run if the virtual environment existed."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    command = ["make", "--dry-run", "--assume-old=.venv/.installed", "--assume-old=.venv/.tested", *targets]
    completed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stderr
    return completed.stdout


@pytest.mark.slow
def test_lint_looks_at_format_and_rules() -> None:
    assert re.findall(r"-m (ruff \w+)", commands("lint")) == ["ruff format", "ruff check"]


@pytest.mark.slow
def test_quick_leaves_out_slow_tests_and_test_none() -> None:
    quick = commands("quick")
    assert re.findall(r"-m (ruff|mypy|codewheel|pytest)\b", quick) == [
        "ruff",
        "ruff",
        "mypy",
        "codewheel",
        "pytest",
        "pytest",
    ]
    folders = "tests/generator tests/docs tests/masters"
    assert f"-m pytest -m 'not slow' {folders}\n" in quick
    others = " ".join(f"--ignore={folder}" for folder in folders.split())
    assert f"-m pytest -m 'not slow' tests {others}\n" in quick
    assert "slow" not in commands("test")


@pytest.mark.slow
def test_what_make_test_leaves_out_is_run_by_make_verify() -> None:
    """Each folder of tests belongs to one part."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    parts = {part: commands(f"verify-cases_{part}") for part in re.findall(r"^CASES_(\w+) =", makefile, re.MULTILINE)}
    assert all("-m exhaustive tests" in command for command in parts.values())
    named_folders = {part: re.findall(r" (tests/\w+)\b", command) for part, command in parts.items()}
    assert " -m exhaustive tests --ignore=" in parts.pop("tool")
    del named_folders["tool"]
    folders = [folder for part_folders in named_folders.values() for folder in part_folders]
    ignored = re.findall(r"--ignore=(\S+)", commands("verify-cases_tool"))
    assert sorted(ignored) == sorted(["tests/verify", *folders])
    assert "-m exhaustive tests\n" in commands("verify")
    assert "-m 'not exhaustive'" in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("target", ["generate", "check", "test", "lint", "verify", "site"])
def test_only_targets_that_test_install_the_packages_for_tests(target: str) -> None:
    """Users of the outputs need four packages."""
    installs = re.findall(r"--editable (\S+)$", dry_run_in_a_clone(target), re.MULTILINE)
    needs_tests = target not in ("generate", "check")
    assert installs[:2] == [".", "'.[test]'"] if needs_tests else installs == ["."]


def dry_run_in_a_clone(target: str) -> str:
    """Return the commands that make would run without a virtual environment."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    command = ["make", "--dry-run", "--file", str(ROOT / "Makefile"), target]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "pyproject.toml").touch()
        completed = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stderr
    return completed.stdout


def test_the_tests_install_what_they_build_with() -> None:
    """Some tests build packages without isolation, so the environment needs what the packages require for this."""
    listed = re.findall(r"^test = \[(.*)\]$", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    required = set[str]()
    for path in (ROOT / "pyproject.toml", *(ROOT / "generated" / "python").rglob("pyproject.toml")):
        (requirements,) = re.findall(r"^requires = \[(.*)\]$", path.read_text(encoding="utf-8"), re.MULTILINE)
        required.update(re.findall(r'"([^"]+)"', requirements))
    assert required
    assert required <= set(re.findall(r'"([^"]+)"', listed[0]))
