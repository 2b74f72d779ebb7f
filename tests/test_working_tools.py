"""A tool that is present but cannot do its job counts as missing, and the message says why."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest
import working_tools
from working_tools import require

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="the programs of these tests are shell scripts"),
]

#: Programs on ``PATH``: a command with options, the text of the program, and the end of the message.
BROKEN = {
    "no sanitizer runtime": (
        ["clang", "-std=c99", "-fsanitize=address,undefined", "-O1"],
        'case "$*" in *-fsanitize*) echo "ld: error: no libclang_rt.asan.a" >&2; exit 1 ;; esac\nexec REAL "$@"',
        (
            "clang cannot compile and link a program with -fsanitize=address,undefined "
            "(ld: error: no libclang_rt.asan.a), so this is not shown; "
            "apt-get install clang libclang-rt-14-dev llvm"
        ),
    ),
    "no headers of C": (
        ["gcc", "-std=c99"],
        'echo "trial.c:1:10: fatal error: stdint.h: No such file or directory" >&2; exit 1',
        (
            "gcc cannot compile and link a program (trial.c:1:10: fatal error: stdint.h: No such file or directory), "
            "so this is not shown; apt-get install gcc libc6-dev"
        ),
    ),
    "no headers of C++": (
        ["g++", "-x", "c++"],
        'case "$*" in *trial.cpp*) echo "error: no cstdint" >&2; exit 1 ;; esac',
        "g++ cannot compile and link a program (error: no cstdint), so this is not shown; apt-get install g++",
    ),
    "a program that does not run": (
        ["cc"],
        'echo "exit 3" > "$3"; chmod +x "$3"',
        "cc compiles a program that does not run (OSError), so this is not shown; apt-get install gcc libc6-dev",
    ),
    "no newlib": (
        ["arm-none-eabi-gcc", "-mthumb"],
        'case "$*" in *--version*) exit 0 ;; esac\necho "fatal error: string.h: not found" >&2; exit 1',
        (
            "arm-none-eabi-gcc cannot compile with the headers of C (fatal error: string.h: not found), "
            "so this is not shown; apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi"
        ),
    ),
    "a browser that does not start": (
        ["chromium"],
        "exit 127",
        "chromium does not start, so this is not shown; apt-get install chromium",
    ),
    "a browser without fonts": (
        ["chromium"],
        "echo '<html><head><title>empty</title></head></html>'",
        "chromium has no fonts, so this is not shown; apt-get install chromium",
    ),
    "an old node": (
        ["node"],
        'echo "SyntaxError: Unexpected token" >&2; exit 1',
        (
            "node is too old or does not start (SyntaxError: Unexpected token), so this is not shown; "
            "apt-get install nodejs"
        ),
    ),
    "a linker that Rust does not find": (
        ["rustc"],
        'echo "error: linker cc not found" >&2; exit 1',
        (
            "rustc cannot compile and link a program (error: linker cc not found), so this is not shown; "
            "apt-get install rustc rust-clippy"
        ),
    ),
    "a missing library": (
        ["cmake"],
        'echo "cmake: error while loading shared libraries: libuv.so.1" >&2; exit 127',
        (
            "cmake does not start (cmake: error while loading shared libraries: libuv.so.1), so this is not shown; "
            "apt-get install cmake"
        ),
    ),
}


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that comes first on ``PATH``, and results of its own."""
    folder = tmp_path / "programs"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)
    monkeypatch.delenv("CODEWHEEL_REQUIRE_TOOLS", raising=False)
    monkeypatch.setattr(working_tools, "results", tmp_path / "results")
    return folder


def program(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("kind", BROKEN)
def test_a_tool_that_cannot_do_its_job_is_missing(kind: str, programs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command, text, message = BROKEN[kind]
    program(programs, command[0], text.replace("REAL", shutil.which(command[0]) or "false"))
    with pytest.raises(pytest.skip.Exception) as skipped:
        require(command)
    assert str(skipped.value) == message
    monkeypatch.setenv("CODEWHEEL_REQUIRE_TOOLS", "1")
    with pytest.raises(pytest.fail.Exception) as failed:
        require(command)
    assert str(failed.value) == message


def test_a_compiler_without_sanitizers_compiles_other_programs(programs: Path) -> None:
    _, text, _ = BROKEN["no sanitizer runtime"]
    fake = program(programs, "cc", text.replace("REAL", require(["gcc"])))
    assert require(["cc", "-std=c99"]) == str(fake)
    with pytest.raises(pytest.skip.Exception, match="with -fsanitize=undefined"):
        require(["cc", "-fsanitize=undefined"])


def test_a_tool_that_is_not_there_has_its_package(programs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(programs))
    with pytest.raises(pytest.skip.Exception) as skipped:
        require(["doxygen"])
    assert str(skipped.value) == "no doxygen here, so this is not shown; apt-get install doxygen"


def test_a_tool_is_tried_once_by_all_processes(programs: Path) -> None:
    count = programs / "count"
    fake = program(programs, "cmake", f'echo "$*" >> {count}')
    for _ in range(2):
        assert require(["cmake"]) == str(fake)
        working_tools.problem.cache_clear()  # as in another process
    assert count.read_text(encoding="utf-8") == "--version\n"


@pytest.mark.parametrize("name", sorted(working_tools.PACKAGES))
def test_the_tools_of_this_machine_work(name: str) -> None:
    """A trial that a working tool fails would leave out tests without a reason."""
    if shutil.which(name) is None:
        pytest.skip(f"no {name} here, so this is not shown; {working_tools.PACKAGES[name]}")
    require([name])
