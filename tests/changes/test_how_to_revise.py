"""The page about new editions of a manual: every command is run, and its output is exactly as shown."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from shutil import copytree

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/transcribe/how-to-revise.md").read_text(encoding="utf-8")
#: Blocks of the session. The parts of the chapter on editions and overlays have tests of their own.
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.partition("\n## Editions")[0], re.DOTALL | re.MULTILINE)


def steps() -> list[tuple[str, str]]:
    """Yield each command with its output. For the change of the spec, yield its name and text."""
    commands: list[tuple[str, str]] = []
    for language, block in BLOCKS:
        if language == "diff":
            commands.append(("", block))
        else:
            for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
                command, _, output = part.partition("\n")
                commands.append((command, output))
    return commands


def environment(folder: Path) -> dict[str, str]:
    """Provide the command codewheel, and a git without the settings of the user."""
    tool = folder / "bin" / "codewheel"
    tool.parent.mkdir()
    tool.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m codewheel "$@"\n', encoding="utf-8")
    tool.chmod(0o755)
    variables = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    who = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@example.org", "GIT_CONFIG_NOSYSTEM": "1"}
    who |= {"GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@example.org"}
    who |= {"GIT_CONFIG_GLOBAL": str(folder / "no.gitconfig")}
    return variables | who | {"PATH": f"{tool.parent}:{os.environ['PATH']}", "PYTHONIOENCODING": "utf-8"}


def create_repository(folder: Path) -> tuple[Path, dict[str, str]]:
    """Create the repository with which the page begins."""
    variables, work = environment(folder), folder / "work"
    copytree(ROOT / "docs" / "example" / "tolvarn", work / "specs" / "tolvarn")
    begin = "git init -q && codewheel generate specs/tolvarn && git add . && git commit -q -m first && git tag v0.1.0"
    subprocess.run(begin, shell=True, check=True, capture_output=True, cwd=work, env=variables)
    return work, variables


def output_of(command: str, work: Path, variables: dict[str, str]) -> str:
    done = subprocess.run(
        ["bash", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=work, env=variables
    )
    return done.stdout


@pytest.mark.exhaustive
def test_its_session(tmp_path: Path) -> None:
    work, variables = create_repository(tmp_path)
    for command, output in steps():
        if command:
            assert output_of(command, work, variables) == output, command
        else:
            subprocess.run(["git", "apply", "-"], input=output, text=True, check=True, cwd=work, env=variables)


def test_it_has_commands() -> None:
    assert sum(command.startswith("codewheel ") for command, _ in steps()) >= 9


def test_its_links() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert (ROOT / "docs" / "transcribe" / target).exists(), target
