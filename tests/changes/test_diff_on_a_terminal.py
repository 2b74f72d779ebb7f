"""On a terminal, ``diff`` colours the impacts and shows what it is doing. A pipe gets plain text."""

from __future__ import annotations

import os
import pty
import sys
from pathlib import Path
from shutil import copytree

import pytest
from pair import BASE

CLOCK = "max_hz: 10000000"


def output_on_terminal(words: list[str], folder: Path, variables: dict[str, str]) -> str:
    """Run the command on a pseudo-terminal, and return what it wrote."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.execve(sys.executable, [sys.executable, "-m", "codewheel", *words], {**os.environ, **variables})
    parts: list[bytes] = []
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:  # The child has closed the terminal.
            break
        if not part:
            break
        parts.append(part)
    os.waitpid(child, 0)
    os.close(terminal)
    return b"".join(parts).decode()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    copytree(BASE, tmp_path / "old")
    copytree(BASE, tmp_path / "new")
    spec = tmp_path / "new" / "demo.yaml"
    text = spec.read_text(encoding="utf-8")
    assert text.count(CLOCK) == 1
    spec.write_text(text.replace(CLOCK, "max_hz: 5000000"), encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_impacts_have_colours_on_a_terminal(folder: Path) -> None:
    variables = {"TERM": "xterm", "NO_COLOR": ""}
    assert "  \x1b[33mbehaviour\x1b[0m " in output_on_terminal(["diff", "old", "new"], folder, variables)


@pytest.mark.slow
def test_no_colour_is_respected(folder: Path) -> None:
    text = output_on_terminal(["diff", "old", "new"], folder, {"TERM": "xterm", "NO_COLOR": "1"})
    assert "  behaviour " in text
    assert "\x1b[33m" not in text


@pytest.mark.slow
def test_a_pipe_gets_plain_text(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from codewheel.commands.cli import main

    assert main(["diff", str(folder / "old"), str(folder / "new")]) == 1
    assert "\x1b" not in capsys.readouterr().out
