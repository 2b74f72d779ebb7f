"""Streams with other encodings, full streams, and closed streams.

Never a traceback, and never an exit code that says done where it is not.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
from codewheel.commands.terminal import _replace_in_text
from codewheel.say import STAND_INS
from exhaustive import mostly_exhaustive

COMMAND = [sys.executable, "-m", "codewheel"]
DECODE = ["decode", "AMM5A23/65KJP1", "02 00 C7 D1 6A 7E"]


def run(
    *arguments: str, redirect: str = "", before: str = "", **environment: str
) -> subprocess.CompletedProcess[bytes]:
    """Run the command under a shell, which can close and redirect streams."""
    command = ["sh", "-c", f'{before} exec "$@" {redirect}', "sh", *COMMAND, *arguments]
    done = subprocess.run(command, capture_output=True, env={**os.environ, **environment}, check=False, timeout=60)
    assert b"Traceback" not in done.stderr, done.stderr.decode()
    assert b"Exception ignored" not in done.stderr, done.stderr.decode()
    return done


@cache
def in_utf_8(*arguments: str) -> str:
    return run(*arguments, PYTHONIOENCODING="utf-8").stdout.decode()


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["cp1252", "cp437", "ascii"])
@pytest.mark.parametrize(
    "arguments",
    [DECODE, ["show", "amm5"], ["show", "sma21"], ["master", "SMA21-SC4-0050"]],
    ids=lambda arguments: arguments[0] + arguments[1],
)
def test_text_in_any_encoding(encoding: str, arguments: list[str]) -> None:
    done, whole = run(*arguments, PYTHONIOENCODING=encoding), in_utf_8(*arguments)
    text = done.stdout.decode(encoding)
    assert (done.returncode, done.stderr) == (0, b"")
    assert text.count("\n") == whole.count("\n")
    assert "\\u" not in text
    assert text.count("?") == whole.count("?")
    if arguments is DECODE:
        assert "Encoder -> Master" in text


def test_every_character_of_our_specs_has_a_stand_in() -> None:
    specs = Path(__file__).parents[2] / "specs"
    text = "".join(path.read_text(encoding="utf-8") for path in specs.rglob("*.yaml"))
    lacking = {character for character in text if character > "~"}
    assert "µ" in lacking
    assert "−" in lacking
    for character in lacking:
        stand_in, _ = _replace_in_text(UnicodeEncodeError("ascii", character, 0, 1, ""))
        assert isinstance(stand_in, str), character
        assert stand_in.isascii(), character
        assert "?" not in stand_in, character
    assert all(text.isascii() and "\\" not in text for text in STAND_INS.values())


@pytest.mark.one_in(4, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["cp1252", "cp437", "ascii", "latin-1"])
def test_json_in_any_encoding(encoding: str) -> None:
    done, whole = run("show", "amm5", "--json", PYTHONIOENCODING=encoding), in_utf_8("show", "amm5", "--json")
    assert done.stdout.isascii()
    assert not whole.isascii()
    assert json.loads(done.stdout) == json.loads(whole)


@pytest.mark.slow
def test_messages_in_ascii() -> None:
    done = run("show", "n→n", PYTHONIOENCODING="ascii", PYTHONUTF8="1")
    assert done.returncode == 2
    assert b"'n->n' is not a known order code" in done.stderr


#: No file may grow, so that each write to one fails as on a full disk.
NO_ROOM = "ulimit -f 0;"


@pytest.mark.slow
@pytest.mark.parametrize("arguments", mostly_exhaustive([["list"], ["check"], ["check", "--json"], DECODE], ["list"]))
def test_full_standard_output(arguments: list[str], tmp_path: Path) -> None:
    done = run(*arguments, redirect=f"> '{tmp_path}/full'", before=NO_ROOM, PYTHONUNBUFFERED="")
    assert (done.returncode, done.stderr) == (1, b"codewheel: cannot write the output: File too large\n")


@pytest.mark.slow
def test_full_standard_error(tmp_path: Path) -> None:
    done = run("show", "nonsense", redirect=f"2> '{tmp_path}/full'", before=NO_ROOM, PYTHONUNBUFFERED="")
    assert done.returncode == 1


@pytest.mark.slow
def test_closed_streams(tmp_path: Path) -> None:
    done = run("generate", "docs/example", "-o", str(tmp_path), redirect=">&-")
    assert (done.returncode, done.stderr) == (0, b"")
    assert (tmp_path / "c" / "README.md").is_file()
    assert run("show", "nonsense", redirect="2>&-").returncode == 2
    assert run("list", redirect="<&- >&- 2>&-").returncode == 0
    done = run("decode", "AMM5A23/65KJP1", "-", redirect="<&-")
    assert (done.returncode, done.stderr) == (2, b"codewheel: cannot read frames: standard input is closed\n")


@pytest.mark.slow
def test_bytes_that_are_no_text_are_no_frame() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "utf-8:strict"}
    done = subprocess.run(
        [*COMMAND, *DECODE[:2], "-"], input=b"\xff\n", capture_output=True, env=environment, check=False
    )
    assert done.returncode == 2
    assert b"' is not hex" in done.stderr


@pytest.mark.slow
def test_a_folder_whose_name_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    assert run("new", "demo", "-o", str(tmp_path)).returncode == 0
    folder = os.fsdecode(os.fsencode(tmp_path) + b"/\xff")
    done = run("generate", str(tmp_path / "demo.yaml"), "-o", folder, PYTHONIOENCODING="utf-8:strict")
    assert done.returncode == 0
    assert b"/\xff/c/README.md" in done.stdout


@pytest.mark.slow
def test_a_reader_that_leaves_early_is_not_told_done() -> None:
    # The first frame has an error, and the rest is more than a pipe can hold.
    frames = b"02 20 C7 D1 6A 5F\n" + b"02 20 C7 D1 6A 5E\n" * 3000
    with subprocess.Popen(
        [*COMMAND, *DECODE[:2], "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdin
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        try:
            process.stdin.write(frames)
            process.stdin.close()
        except BrokenPipeError:
            pass
        assert process.stderr.read() == b""
        assert process.wait(60) != 0
    with subprocess.Popen([*COMMAND, "show", "amm5"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(60) == 141


SLOW = """
import sys, time
from codewheel.commands import terminal
from codewheel.commands.cli import main
from codewheel.loading import library
terminal._AFTER_S = terminal._EVERY_S = 0.05
real = library.check_document
def slow(*arguments):
    time.sleep(0.3)
    return real(*arguments)
library.check_document = slow
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
@pytest.mark.parametrize("command", mostly_exhaustive(["check", "generate"], "check"))
def test_only_a_terminal_shows_progress(command: str, tmp_path: Path) -> None:
    specs = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"
    arguments = [sys.executable, "-c", SLOW, command, str(specs), "--no-cache"]
    arguments += ["-o", str(tmp_path / "out")] if command == "generate" else []
    ours, theirs = os.openpty()
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=theirs) as process:
        os.close(theirs)
        assert process.stdout is not None
        out = process.stdout.read()
        shown = os.read(ours, 100_000)
    os.close(ours)
    assert process.returncode == 0
    begin = {"check": b"\r\x1b[Kcodewheel: checking the specs", "generate": b"\r\x1b[Kcodewheel: reading the specs"}
    assert shown.startswith(begin[command])
    assert shown.endswith(b"\r\x1b[K")
    assert (b"codewheel: rendering" in shown) is (command == "generate")
    piped = subprocess.run(arguments, capture_output=True, check=True)
    assert piped.stderr == b""
    if command == "check":
        assert piped.stdout == out
