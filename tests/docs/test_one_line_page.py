"""The page about an encoder in one line: its commands print what it shows, and its tables have every word."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.one_line.parse import _SETTINGS, _WORDS, parse_line

PAGE = (Path(__file__).parents[2] / "docs/encoder/one-line.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
SHOWN = [block for block in BLOCKS if block.startswith("$ codewheel ")]
COMMANDS = [line for block in BLOCKS if block not in SHOWN for line in block.splitlines() if "generate" not in line]
#: A row of a table with a word in its first column, and the interfaces of an option.
ROW = re.compile(r"^\| (`[^|]*) \| ([^|]*) \|", re.MULTILINE)
FIELDS, _, OPTIONS = PAGE.partition("| option |")


@pytest.mark.parametrize("block", SHOWN, ids=lambda block: block.splitlines()[0][:40])
def test_a_shown_output(block: str, capsys: pytest.CaptureFixture[str]) -> None:
    command, _, shown = block.partition("\n")
    main(shlex.split(command.removeprefix("$ codewheel ")))
    out, err = capsys.readouterr()
    parts = [re.escape(part) for part in shown.split("...\n")]
    assert re.fullmatch(".*\n?".join(parts), out + err, re.DOTALL), out + err


def test_the_other_commands_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my").mkdir()
    assert len(COMMANDS) == 4
    for command in COMMANDS:
        assert main(shlex.split(command.removeprefix("codewheel "))) == 0, command
    assert "my_encoder" in capsys.readouterr().out


def test_every_field_of_the_table_is_one() -> None:
    examples = [example for cell, _ in ROW.findall(FIELDS) for example in re.findall(r"`([^`]+)`", cell)]
    assert len(examples) > 12
    for example in examples:
        line = f"ssi:{'x=3,' if example.startswith(('parity', 'crc')) else ''}{example}"
        interface = "biss" if example in ("error", "warning") else "ssi"
        if "reflected" in example:
            line, interface = line.replace("x=3", "x=8"), "rs485"
        assert parse_line(line.replace("ssi", interface)).fields


def test_the_table_has_every_option_with_its_interfaces() -> None:
    shown_interfaces: dict[str, set[str]] = {}
    for cell, interfaces in ROW.findall(OPTIONS):
        every = "BiSS, SSI, SPI, RS-485" if interfaces == "all" else interfaces
        for name in re.findall(r"[`,]([a-z_]+)", cell):
            shown_interfaces[name] = {word.strip().lower().replace("-", "") for word in every.split(",")}
    options = {name: set(interfaces) for name, (interfaces, *_) in [*_WORDS.items(), *_SETTINGS.items()]}
    del options["binary"]
    assert shown_interfaces == options
