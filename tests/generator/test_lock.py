"""Two runs that write to one folder do so one after the other, even if one of them is killed."""

from __future__ import annotations

import errno
import fcntl
import random
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from codewheel import output_folder, write_and_remove
from codewheel.commands.cli import main
from codewheel.output_folder import WriteError

TARGETS = ("c", "docs", "python")
HEAD = """
import ctypes, sys, time
from pathlib import Path
from codewheel import output_folder, write_and_remove
out, here = Path(sys.argv[1]), Path(sys.argv[2])
def files(text):
    return {name: {f"{name}/{n}/x": f"{text} {n}" for n in range(20)} for name in ("c", "docs", "python")}
def waiting():
    print("waiting", flush=True)
"""
#: Waits after the first target until the file ``go`` exists.
SLOW = """
real = output_folder._exchange
def slow(new, target_folder):
    real(new, target_folder)
    (here / "begun").touch()
    while not (here / "go").exists():
        time.sleep(0.01)
output_folder._exchange = slow
"""
WRITE = "write_and_remove.write(out, files(sys.argv[3]), before_waiting=waiting)"


def files(text: str) -> dict[str, dict[str, str]]:
    return {name: {f"{name}/{number}/x": f"{text} {number}" for number in range(20)} for name in TARGETS}


def content(folder: Path) -> dict[str, str]:
    found = (path for path in folder.rglob("*") if path.is_file() and path.name != ".codewheel")
    return {path.relative_to(folder).as_posix(): path.read_text() for path in found}


def all_of(text: str) -> dict[str, str]:
    return {path: text for of_target in files(text).values() for path, text in of_target.items()}


@contextmanager
def started(program: str, tmp_path: Path, text: str = "") -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", HEAD + program, str(tmp_path / "out"), str(tmp_path), text]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        try:
            yield running
        finally:
            running.kill()


def wait_for(file: Path, process: subprocess.Popen[str]) -> None:
    while not file.exists():
        assert process.poll() is None, "the run has ended"
        time.sleep(0.01)


@pytest.mark.slow
def test_the_second_run_waits_for_the_first(tmp_path: Path) -> None:
    with started(SLOW + WRITE, tmp_path, "first") as first:
        wait_for(tmp_path / "begun", first)
        with started(WRITE, tmp_path, "second") as second:
            assert second.stdout is not None
            assert second.stdout.readline() == "waiting\n"
            (tmp_path / "go").touch()
            assert (first.wait(), second.wait()) == (0, 0)
    assert content(tmp_path / "out") == all_of("second")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(TARGETS)


@pytest.mark.slow
def test_the_lock_of_a_killed_run_is_gone(tmp_path: Path) -> None:
    with started(SLOW + WRITE, tmp_path, "first") as first:
        wait_for(tmp_path / "begun", first)
        first.kill()
        first.wait()
    waited: list[bool] = []
    write_and_remove.write(tmp_path / "out", files("second"), before_waiting=lambda: waited.append(True))
    assert (content(tmp_path / "out"), waited) == (all_of("second"), [])
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(TARGETS)


@pytest.mark.slow
@pytest.mark.parametrize("system", ["", "def none(*_, **__): raise OSError\nctypes.CDLL = none\n"])
def test_kills_at_random_moments_leave_each_target_whole(tmp_path: Path, system: str) -> None:
    out = tmp_path / "out"
    endless = (
        "print(write_and_remove.write(out, files('a')) and 'ready', flush=True)\n"
        "while True:\n    write_and_remove.write(out, files('b'))\n    write_and_remove.write(out, files('a'))\n"
    )
    moments = random.Random(1)
    for _ in range(12):
        with started(system + endless, tmp_path) as running:
            assert running.stdout is not None
            assert running.stdout.readline() == "ready\n"
            (out / "c/mine.txt").write_text("mine")
            time.sleep(moments.random() / 20)
            running.kill()
            running.wait()
        for name in TARGETS if not system else ():
            found = {path: text for path, text in content(out / name).items() if path != "mine.txt"}
            whole = [{path.partition("/")[2]: of for path, of in files(text)[name].items()} for text in "ab"]
            assert found in whole
        write_and_remove.write(out, files("a"))
        assert content(out) == {**all_of("a"), "c/mine.txt": "mine"}
        assert sorted(path.name for path in out.iterdir()) == sorted(TARGETS)


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output_folder, "PATIENCE_S", 0.0)


@pytest.mark.parametrize("way", ["out", "link", "other/../out"])
@pytest.mark.usefixtures("impatient")
def test_a_run_that_does_not_end_is_named(tmp_path: Path, way: str) -> None:
    out = tmp_path / "out"
    (tmp_path / "other").mkdir()
    (tmp_path / "link").symlink_to(out)
    with output_folder.locked(out, list):
        waited: list[bool] = []
        with pytest.raises(WriteError) as caught:
            write_and_remove.write(tmp_path / way, files("a"), before_waiting=lambda: waited.append(True))
        assert str(caught.value) == (
            f"another run of codewheel has been writing to {tmp_path / way} for 60 s; nothing has changed; "
            "try again when it has ended"
        )
        assert waited == [True]
        assert list(out.iterdir()) == []
        write_and_remove.write(tmp_path / "another", files("a"))
    write_and_remove.write(tmp_path / way, files("a"))


def test_a_folder_that_is_made_anew_meanwhile_is_locked_anew(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with output_folder.locked(out, list):
        write_and_remove.write(out, files("a"), before_waiting=lambda: out.rename(tmp_path / "away") and None)
        assert content(out) == all_of("a")


def test_a_folder_that_is_replaced_before_it_is_locked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = fcntl.flock
    out = tmp_path / "out"

    def flock(handle: int, operation: int) -> None:
        if not (tmp_path / "away").exists():
            out.rename(tmp_path / "away")
        real(handle, operation)

    monkeypatch.setattr(fcntl, "flock", flock)
    write_and_remove.write(out, files("a"))
    assert content(out) == all_of("a")


def test_where_folders_cannot_be_locked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def flock(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", flock)
    write_and_remove.write(tmp_path, files("a"))
    assert content(tmp_path) == all_of("a")


def test_a_folder_that_was_not_there_is_not_left_behind_empty(tmp_path: Path) -> None:
    write_and_remove.write(tmp_path / "out", {"c": {}})
    assert not (tmp_path / "out").exists()


@pytest.mark.usefixtures("impatient")
def test_the_command_says_that_it_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "demo"]) == 0
    with output_folder.locked(tmp_path / "out", list):
        assert main(["generate", "demo.yaml", "--target", "browser", "-o", "out"]) == 1
    assert capsys.readouterr().err == (
        "codewheel: waiting for another run that is writing to out\n"
        "codewheel: another run of codewheel has been writing to out for 60 s; nothing has changed; "
        "try again when it has ended\n"
    )
