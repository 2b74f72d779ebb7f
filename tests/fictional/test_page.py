"""The page on transcribing: its quotations of the manual, of the spec and of the tool are right."""

from __future__ import annotations

import re
import shlex
import shutil
import textwrap
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from exhaustive import mostly_exhaustive

DOCS = Path(__file__).resolve().parents[2] / "docs"
EXAMPLE = DOCS / "example"
PAGE = (DOCS / "transcribe" / "how-to-transcribe.md").read_text(encoding="utf-8")
MANUAL = (EXAMPLE / "manual.md").read_text(encoding="utf-8")
SPEC = (EXAMPLE / "tolvarn" / "tv62.yaml").read_text(encoding="utf-8")

#: Mistakes described on the page: text of the spec, typed text, and message of the tool.
SLIPS = {
    "padding": (
        "padded_to: 31",
        "padded_to: 32",
        "example 'ssi_before_preset' does not match: 'ssi_word' has 33 bits, got 32",
    ),
    "length": (
        "    length: 4\n    byte_order: high_byte_first\n    access: read_write",
        "    length: 5\n    byte_order: high_byte_first\n    access: read_write",
        "duplicate-address: address 0x04 overlaps 'preset' on line 166, which has addresses 0x00 to 0x04",
    ),
    "signed": (
        "padded_to: 31\n            signed: true\n",
        "padded_to: 31\n",
        "example 'ssi_before_preset' does not match: position is 33553432, not -1000",
    ),
    "no_order": (
        "    byte_order: high_byte_first\n    access: read_write\n",
        "    access: read_write\n",
        "byte-order-missing: 'preset' has 4 bytes, so it needs 'byte_order': low_byte_first or high_byte_first",
    ),
    "swapped": (
        "byte_order: low_byte_first\n    access: read_write\n    default: 0x03B6",
        "byte_order: high_byte_first\n    access: read_write\n    default: 0x03B6",
        (
            "left-behind: the example shows the default of 'upper_limit', which is 0x3b6, in the other byte order; "
            "correct 'byte_order', 'default' or the bytes"
        ),
    ),
    "top_bit": (
        "poly: 0x05",
        "poly: 0x25",
        "crc-impossible: the polynomial 0x25 does not fit into 5 bits; omit the top bit: 0x5",
    ),
    "start": (
        "init: 0x5A3C",
        "init: 0",
        "example 'position_channel' does not match: expected CRC 0x5e9a, got 0x4587",
    ),
    "bank": (
        "      - {do: write, register: bank, value: position}\n",
        "",
        "bank-not-selected: 'preset' is in bank 1; write 1 to 'bank' before this step",
    ),
    "bits_from_1": ("at: 2:1, values", "at: 3:2, values", ""),
}


def fences(word: str) -> list[str]:
    """Return the fenced blocks with this info string, or with none."""
    return [text for info, text in re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL) if info == word]


def quotes() -> list[str]:
    quotes_with_marks = re.findall(r"(?:^> .*\n)+", PAGE, re.MULTILINE)
    return [re.sub("^> ", "", quote, flags=re.MULTILINE).removesuffix("\n") for quote in quotes_with_marks]


def on_one_line(text: str) -> str:
    return " ".join(text.split())


def without_indent(line: str, depth: int) -> str:
    """Return a line without its first columns, if these are blank."""
    return line if line[:depth].strip() else line[depth:]


@pytest.mark.parametrize("snippet", fences("yaml"), ids=lambda text: text.split("\n")[0][:40])
def test_yaml_is_that_of_the_spec(snippet: str) -> None:
    wanted = textwrap.dedent(snippet).rstrip("\n").splitlines()
    lines = SPEC.splitlines()
    for start, line in enumerate(lines):
        depth = len(line) - len(line.lstrip())
        piece = [without_indent(spec_line, depth) for spec_line in lines[start : start + len(wanted)]]
        # An item of a list or a map may be shown without the text before it on its line.
        if piece == wanted or (len(wanted) == 1 and line.strip().endswith(wanted[0])):
            return
    pytest.fail(f"not in the spec:\n{snippet}")


@pytest.mark.parametrize("quote", quotes(), ids=lambda text: text[:40])
def test_quotes_are_from_the_manual(quote: str) -> None:
    assert on_one_line(quote) in on_one_line(MANUAL)


def test_there_is_something_to_compare() -> None:
    assert len(fences("yaml")) >= 15
    assert len(quotes()) >= 15
    assert len(fences("text")) >= 6


@pytest.mark.slow
def test_what_the_tool_says_is_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    messages = [message for _, _, message in SLIPS.values()]
    assert main(["decode", "--specs", str(EXAMPLE), "TV62-M17-B1", "--as", "lower_limit", "06 FF"]) == 0
    messages.append(capsys.readouterr().out)
    for text in fences("text"):
        if "readings-disagree" not in text:  # Other blocks are tested one by one in test_revision.py.
            assert any(text.rstrip("\n") in message for message in messages), text


@pytest.mark.slow
@pytest.mark.parametrize("slip", mostly_exhaustive(SLIPS, "padding"))
def test_slips_are_found_in_the_words_shown(slip: str, tmp_path: Path) -> None:
    original, misspelt, message = SLIPS[slip]
    assert original in SPEC
    shutil.copy(EXAMPLE / "tolvarn" / "manufacturer.yaml", tmp_path)
    (tmp_path / "tv62.yaml").write_text(SPEC.replace(original, misspelt, 1), encoding="utf-8")
    _, report = load_library([tmp_path / "tv62.yaml"])
    reported = [f"{problem.rule}: {problem.message}" for problem in report.problems]
    if message:
        assert any(message in text for text in reported), reported
    else:
        assert not reported  # The page says that no program can find it.


@pytest.mark.slow
def test_commands_of_the_page_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(DOCS.parent)
    commands = [line.removeprefix("$ ") for text in fences("") for line in text.splitlines()]
    commands += [command for command in re.findall(r"`(codewheel [^`]+)`", PAGE) if "--specs" in command]
    ours = [shlex.split(line) for line in commands if "docs/example" in line]
    assert len(ours) >= 7
    (tmp_path / "new").mkdir()
    assert "codewheel new tv62" in commands
    assert main(["new", "tv62", "-o", str(tmp_path / "new" / "tv62.yaml")]) == 0
    for words in ours:
        assert main([str(tmp_path) if word.startswith("/") else word for word in words[1:]]) == 0, words
    capsys.readouterr()


def test_links_lead_somewhere() -> None:
    for name, text in (("transcribe/how-to-transcribe.md", PAGE), ("example/manual.md", MANUAL)):
        for target in re.findall(r"\]\(([^)#\s]+)", text):
            assert ((DOCS / name).parent / target).exists(), f"{name}: {target}"
