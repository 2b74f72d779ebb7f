"""What the README shows is what one gets."""

from __future__ import annotations

import doctest
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_its_python(generated_python: tuple[Path, ModuleType]) -> None:
    block = re.search(r"```python\n(.*?)```", README, re.DOTALL)
    assert block is not None
    test = doctest.DocTestParser().get_doctest(block[1], {}, "README", "README.md", 0)
    sys.modules["lika_encoders"] = generated_python[1]
    assert test.examples
    assert doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


def _commands() -> list[tuple[str, list[str]]]:
    """Each command of the README with the lines that it shows of what is printed."""
    found: list[tuple[str, list[str]]] = []
    for block in re.findall(r"^```\n(\$ .venv.*?)^```", README, re.DOTALL | re.MULTILINE):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line.removeprefix("$ "), []))
            else:
                found[-1][1].append(line)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("command", "shown"), _commands(), ids=lambda value: value if isinstance(value, str) else "")
def test_its_commands(command: str, shown: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "codewheel", *shlex.split(command)[1:]], capture_output=True, text=True, cwd=ROOT
    )
    fails = "not usable" in "".join(shown)
    assert (done.returncode, done.stderr) == (3 if fails else 0, "")
    # Three dots stand for lines left out, and nothing else is.
    pieces = "".join(f"{line}\n" for line in shown).split("...\n")
    assert not shown or re.fullmatch("(?:.*\n)*".join(map(re.escape, pieces)), done.stdout)


def _first_commands() -> list[str]:
    """What the first block of the README types once codewheel is there."""
    block = re.search(r"^```\n(.*?)^```", README, re.DOTALL | re.MULTILINE)
    assert block is not None
    return [line for line in block[1].splitlines() if line.startswith(".venv/bin/codewheel")]


@pytest.mark.parametrize("command", _first_commands())
def test_what_it_types_first(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(command, comments=True)[1:]) == 0
    assert "AMM5A21/65KSC1" in capsys.readouterr().out


def test_it_says_on_the_first_screen_that_nothing_was_tried() -> None:
    assert "Nothing has been tried on an encoder" in "".join(README.splitlines(keepends=True)[:24])


def test_its_table_is_what_there_is(devices: Mapping[str, Device]) -> None:
    """Interfaces and number of order codes, and no family is missing."""
    rows = re.findall(
        r"^\| [^|]+ \| ([^|]+) \| ([0-9]+) \| \[[^]]+\]\(generated/docs/(\w+)\.md\) \|$", README, re.MULTILINE
    )
    told = {name: (set(interfaces.split(", ")), int(codes)) for interfaces, codes, name in rows}
    assert told == {
        name: ({item.title for item in device.interfaces}, len(device.variants)) for name, device in devices.items()
    }


def test_it_has_commands() -> None:
    shown = [lines for _, lines in _commands() if lines]
    assert len(_commands()) >= 4
    assert len(shown) >= 2
    assert "no fault" in shown[0][-1]


def test_its_links() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
