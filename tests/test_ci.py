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
#: A make that records what it is called with, and where: in the clone or here, with packages that are locked or not.
PASSES = """echo "====== 3 passed, 1 skipped in 0.10s ======"
if [ -e cloned ]; then place=clone; else place=here; fi
echo "$place$CODEWHEEL_LOCKED $*" >> "$ORDER"
"""
README = "Text.\n\n```\nmake first\nmake second\n```\n\n```console\n$ make other\n```\n"
#: A git that counts commits, and whose clones are marked folders.
GIT = 'case "$1" in clone) shift 3; mkdir -p "$1"; touch "$1/cloned" ;; *) echo COMMITS ;; esac\n'


def program(path: Path, text: str) -> Path:
    """Write a shell script that replaces a program."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}", encoding="utf-8")
    path.chmod(0o755)
    return path


def parts(folder: Path, make: str, *arguments: str, commits: int = 0, **environment: str) -> tuple[int, str]:
    """Run the parts of three files with another make. Return the exit code and the output."""
    for name in ("a", "python_columns", "z"):
        (folder / "tests" / "verify").mkdir(parents=True, exist_ok=True)
        (folder / "tests" / "verify" / f"test_{name}.py").touch()
    (folder / "README.md").write_text(README, encoding="utf-8")
    program(folder / "bin" / "make", make)
    program(folder / "bin" / "git", GIT.replace("COMMITS", str(commits)))
    variables = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "ORDER": str(folder / "order")}
    variables |= environment
    command = [sys.executable, str(CI / "parts.py"), *arguments]
    completed = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=variables, check=False)
    assert not completed.stderr
    return completed.returncode, completed.stdout


def test_every_part_is_made(tmp_path: Path) -> None:
    code, out = parts(tmp_path, PASSES)
    started_parts = (tmp_path / "order").read_text(encoding="utf-8").splitlines()
    verify = ["here verify-a", "here verify-python", "here verify-z"]
    assert (code, started_parts[:3], sorted(started_parts[3:])) == (
        0,
        ["here lint", "clone first", "clone second"],
        verify,
    )
    assert [f"== make {part.split()[1]}" in out.splitlines() for part in started_parts] == [True] * 6
    assert out.endswith("\n18 passed, 0 failed, 6 skipped\n")


def test_the_readme_prints_the_commands(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CI.parent)
    assert module.readme_commands() == ["make generate", "make test"]


def test_the_parts_include_the_cases_that_are_left_out(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CI.parent)
    assert {"make verify-cases_c", "make verify-cases_python", "make verify-cases_tool"} <= {*module.parts()}


def test_the_clone_is_a_real_one(module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It contains the files of the last commit, and no environment."""
    monkeypatch.chdir(CI.parent)
    assert module.clone(str(tmp_path / "clone"))
    assert (tmp_path / "clone" / "Makefile").exists()
    assert not (tmp_path / "clone" / ".venv").exists()


def test_only_the_clone_has_packages_that_are_not_locked(tmp_path: Path) -> None:
    parts(tmp_path, PASSES, CODEWHEEL_LOCKED="1")
    started_parts = (tmp_path / "order").read_text(encoding="utf-8").splitlines()
    assert started_parts[:3] == ["here1 lint", "clone first", "clone second"]
    assert all(part.startswith("here1 ") for part in started_parts[3:])


@pytest.mark.parametrize("is_still_skipped", [False, True])
def test_files_that_the_clone_skips_run_here(is_still_skipped: bool, tmp_path: Path) -> None:
    skips = """[ "$1" = second ] && for line in 7 9; do echo "SKIPPED [1] tests/python/test_b.py:$line: no pandas"; done
[ "$1" = first ] && echo "SKIPPED [1] tests/test_a.py:1: no polars"
"""
    again = 'case "$*" in test*) echo "SKIPPED [1] tests/test_a.py:1: no polars" ;; esac\n' if is_still_skipped else ""
    code, out = parts(tmp_path, skips + again + PASSES)
    started_parts = (tmp_path / "order").read_text(encoding="utf-8").splitlines()
    assert started_parts[3] == "here test TESTS=tests/python/test_b.py tests/test_a.py"
    assert code == (2 if is_still_skipped else 0)
    command = "make test TESTS='tests/python/test_b.py tests/test_a.py'"
    skipped_line = f"DID NOT RUN: 1\n  1 skipped in {command}: tests/test_a.py:1: no polars\n"
    assert (skipped_line in out) == is_still_skipped


def test_a_test_that_a_helper_skips_in_the_clone_did_not_run(tmp_path: Path) -> None:
    """The line names the helper, so it is not known which file to run here."""
    skips = '[ "$1" = second ] && echo "SKIPPED [1] tests/working_tools.py:98: no clang here"\n'
    code, out = parts(tmp_path, skips + PASSES)
    assert code == 2
    assert "DID NOT RUN: 1\n  1 skipped in make second: tests/working_tools.py:98: no clang here\n" in out


def test_without_a_clone_ci_fails(tmp_path: Path) -> None:
    (tmp_path / "bin").mkdir()
    program(tmp_path / "no" / "git", '[ "$1" != clone ]\n')
    code, out = parts(tmp_path, PASSES, PATH=f"{tmp_path / 'no'}:{tmp_path / 'bin'}:{os.environ['PATH']}")
    assert (code, "FAILED: 1\n  git clone\n" in out) == (1, True)


SKIPS = 'echo "SKIPPED [2] tests/verify/test_a.py:9: {}"\n' + PASSES


@pytest.mark.parametrize(
    ("make", "arguments", "message"),
    [
        (f'[ "$1" != verify-z ] || exit 7\n{PASSES}', [], "FAILED: 1\n  make verify-z\n"),
        (PASSES, ["--missing", ",clang,node"], "DID NOT RUN: 2\n  not installed: clang\n  not installed: node\n"),
        (
            SKIPS.format("no clang here"),
            [],
            (
                "DID NOT RUN: 5\n  2 skipped in make lint: tests/verify/test_a.py:9: no clang here\n"
                "  2 skipped in make test TESTS='tests/verify/test_a.py': tests/verify/test_a.py:9: no cl"
            ),
        ),
        (SKIPS.format("no Python 3.14 here, so"), [], ""),
        (PASSES, ["--started", str(time.time() - 87.5 * 60)], "DID NOT RUN: 6\n  make lint: no time left\n"),
    ],
)
def test_what_did_not_run_is_an_error_unless_allowed(
    make: str, arguments: list[str], message: str, tmp_path: Path
) -> None:
    code, out = parts(tmp_path, make, *arguments)
    failed = message.startswith("FAILED")
    incomplete = 2 if message else 0
    assert (code, message in out) == (1 if failed else incomplete, True), out
    assert ("DID NOT RUN" in out) == (bool(message) and not failed)
    allowed, again = parts(tmp_path, make, *arguments, "--allow-missing")
    assert (allowed, message in again) == (1 if failed else 0, True)
    assert parts(tmp_path, make, *arguments, CODEWHEEL_ALLOW_MISSING="1")[0] == allowed


@pytest.fixture
def module() -> ModuleType:
    spec = importlib.util.spec_from_file_location("parts", CI / "parts.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("commits", "order"), [(0, "a python z"), (1, "python z a"), (2, "z a python"), (300, "a python z")]
)
def test_each_commit_begins_with_another_part(
    commits: int, order: str, module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts(tmp_path, PASSES, commits=commits)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    assert module.parts() == [f"make verify-{name}" for name in order.split()]


def test_a_part_ends_at_the_deadline(module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program(tmp_path / "make", "sleep 600 & sleep 600\n")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert module.run("make test", 0.2, []) is None


#: Tools that .ci/run needs on a machine, apart from those that it installs.
TOOLS = ("date", "dirname", "mktemp", "rm", "tail", "touch", "mkdir", "cp", "cat", "sh")
#: A Python whose pip fails if the folder has a file of this name, and which prints its arguments.
PYTHON = """
case "$*" in
    "-m venv .venv") mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
    *--require-hashes*) echo "python $*"; [ ! -e broken ] ;;
    *) command -v cbmc; echo "python $* locked=$CODEWHEEL_LOCKED" ;;
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
    completed = subprocess.run(
        command, capture_output=True, text=True, cwd=folder, env={"PATH": str(folder / "bin")}, check=False
    )
    return completed.returncode, completed.stdout + completed.stderr


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


def test_the_parts_find_the_checker_also_in_the_clone(tmp_path: Path) -> None:
    _, out = prepared(tmp_path, "")
    assert str(tmp_path / ".cbmc" / "cbmc") in out.splitlines()


def test_the_locked_packages_name_no_place() -> None:
    for path in CI.glob("*.txt"):
        text = path.read_text(encoding="utf-8")
        assert "--hash=sha256:" in text
        assert not any(word in text for word in ("://", "--index", "--find", "codewheel", " @ ")), path
