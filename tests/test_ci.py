"""CI reports omitted parts, and exits with an error if anything is omitted."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.slow

CI = Path(__file__).resolve().parents[1] / ".ci"
PASSES = 'echo "====== 3 passed, 1 skipped in 0.10s ======"\necho "$1" >> order\n'


def program(path: Path, text: str) -> Path:
    """Write a shell script that stands for a program."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}", encoding="utf-8")
    path.chmod(0o755)
    return path


def parts(folder: Path, make: str, *arguments: str, commits: int = 0, **environment: str) -> tuple[int, str]:
    """Run the parts of three files with another make. Return the exit code and the output."""
    for name in ("a", "python_columns", "z"):
        (folder / "tests" / "verify").mkdir(parents=True, exist_ok=True)
        (folder / "tests" / "verify" / f"test_{name}.py").touch()
    program(folder / "bin" / "make", make)
    program(folder / "bin" / "git", f"echo {commits}\n")
    variables = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", **environment}
    command = [sys.executable, str(CI / "parts.py"), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=variables, check=False)
    assert not done.stderr
    return done.returncode, done.stdout


def test_every_part_is_made(tmp_path: Path) -> None:
    code, out = parts(tmp_path, PASSES)
    made = (tmp_path / "order").read_text(encoding="utf-8").split()
    assert (code, made[:2], sorted(made[2:])) == (0, ["lint", "test"], ["verify-a", "verify-python", "verify-z"])
    assert [f"== make {part}" in out.splitlines() for part in made] == [True] * 5
    assert out.endswith("\n15 passed, 0 failed, 5 skipped\n")


SKIPS = 'echo "SKIPPED [2] tests/verify/test_a.py:9: {}"\n' + PASSES


@pytest.mark.parametrize(
    ("make", "arguments", "said"),
    [
        (f'[ "$1" != verify-z ] || exit 7\n{PASSES}', [], "FAILED: 1\n  make verify-z\n"),
        (PASSES, ["--missing", ",clang,node"], "DID NOT RUN: 2\n  not installed: clang\n  not installed: node\n"),
        (
            SKIPS.format("no clang here"),
            [],
            "DID NOT RUN: 5\n  2 skipped in make lint: tests/verify/test_a.py:9: no cl",
        ),
        (SKIPS.format("no Python 3.14 here, so"), [], ""),
        (PASSES, ["--started", str(time.time() - 84.5 * 60)], "DID NOT RUN: 5\n  make lint: no time left\n"),
    ],
)
def test_what_did_not_run_is_an_error_unless_allowed(
    make: str, arguments: list[str], said: str, tmp_path: Path
) -> None:
    code, out = parts(tmp_path, make, *arguments)
    failed = said.startswith("FAILED")
    assert (code, said in out) == (1 if failed else 2 if said else 0, True), out
    assert ("DID NOT RUN" in out) == (bool(said) and not failed)
    allowed, again = parts(tmp_path, make, *arguments, "--allow-missing")
    assert (allowed, said in again) == (1 if failed else 0, True)
    assert parts(tmp_path, make, *arguments, CODEWHEEL_ALLOW_MISSING="1")[0] == allowed


@pytest.fixture
def module() -> ModuleType:
    spec = importlib.util.spec_from_file_location("parts", CI / "parts.py")
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


@pytest.mark.parametrize(
    ("commits", "order"), [(0, "a python z"), (1, "python z a"), (2, "z a python"), (300, "a python z")]
)
def test_each_commit_begins_with_another_part(
    commits: int, order: str, module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts(tmp_path, PASSES, commits=commits)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    assert module.parts() == [f"verify-{name}" for name in order.split()]


def test_a_part_ends_at_the_deadline(module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program(tmp_path / "make", "sleep 600 & sleep 600\n")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert module.run("test", 0.2, []) is None


#: Tools that .ci/run needs on a machine, apart from those that it installs.
TOOLS = ("date", "dirname", "mktemp", "rm", "tail", "touch", "mkdir", "cp", "cat", "sh")
#: A Python whose pip fails if the folder has a file of this name, and which prints its arguments.
PYTHON = """
case "$*" in
    "-m venv .venv") mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
    *--require-hashes*) echo "python $*"; [ ! -e broken ] ;;
    *) echo "python $* locked=$CODEWHEEL_LOCKED" ;;
esac
"""


def prepared(folder: Path, apt: str) -> tuple[int, str]:
    """Run a copy of .ci/run on a machine that has only apt-get."""
    (folder / ".ci").mkdir()
    shutil.copy(CI / "run", folder / ".ci" / "run")
    program(folder / "bin" / "python3", PYTHON)
    program(folder / "bin" / "apt-get", apt)
    program(folder / ".cbmc" / "cbmc", "")
    for name in TOOLS:
        (folder / "bin" / name).symlink_to(shutil.which(name) or "")
    command = ["sh", ".ci/run", "--more"]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=folder, env={"PATH": str(folder / "bin")}, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_packages_that_cannot_be_installed_are_passed_on(tmp_path: Path) -> None:
    code, out = prepared(tmp_path, 'case "$*" in *clang*) echo "E: no clang"; exit 100 ;; esac\n')
    assert code == 0
    assert "E: no clang\nNOT INSTALLED: clang (clang libclang-rt-14-dev llvm)\n" in out
    assert out.splitlines()[-1].startswith("python .ci/parts.py --started ")
    assert out.endswith(" --missing ,clang,clang++,llvm-cov,llvm-profdata --more locked=1\n")


def test_without_apt_all_that_is_missing_is_passed_on(tmp_path: Path) -> None:
    _, out = prepared(tmp_path, "exit 1\n")
    assert ",make,git,cc,gcc,objdump,c++,g++,clang," in out
    assert ",rustc,clippy-driver,chromium,node --more" in out


def test_packages_that_do_not_fit_are_replaced_by_the_ranges(tmp_path: Path) -> None:
    (tmp_path / "broken").touch()
    code, out = prepared(tmp_path, "")
    assert code == 0
    assert "do not fit here: installing by the ranges of pyproject.toml\n" in out
    assert not (tmp_path / ".venv").exists()
    assert out.endswith(" --missing  --more locked=\n")


def test_the_locked_packages_name_no_place() -> None:
    for path in CI.glob("*.txt"):
        text = path.read_text(encoding="utf-8")
        assert "--hash=sha256:" in text
        assert not any(word in text for word in ("://", "--index", "--find", "codewheel", " @ ")), path
