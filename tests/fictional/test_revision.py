"""The revision described on the page on transcribing: one register moves, first in one reading, then in the other."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import main

DOCS = Path(__file__).resolve().parents[2] / "docs"
TOLVARN = DOCS / "example" / "tolvarn"
PAGE = (DOCS / "transcribe" / "how-to-transcribe.md").read_text(encoding="utf-8")
BLOCKS = (" ".join(text.split()) for text in re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL))
QUOTED = [text for text in BLOCKS if "readings-disagree" in text]
MEND = "; check the manual; if it prints both, add an erratum with both under 'readings'"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for path in TOLVARN.glob("*.yaml"):
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def revise(path: Path, old: str, new: str, address: str) -> None:
    """Another revision of the manual, in which the correction has another address."""
    text = path.read_text(encoding="utf-8").replace(f'revision: "{old}"', f'revision: "{new}"')
    before, correction, after = text.partition("  - name: correction\n")
    after = re.sub(r"address: 0x0\d", f"address: {address}", after, count=1)
    path.write_text(before + correction + after, encoding="utf-8")


@pytest.mark.slow
def test_the_story_of_the_page(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def check() -> list[str]:
        main(["check"])
        *lines, last = capsys.readouterr().out.splitlines()
        disagreements.extend(line for line in lines if "readings-disagree" in line)
        return [line.removesuffix(MEND) for line in lines if "readings-disagree" in line] or [last]

    disagreements: list[str] = []
    silent = ["no problems in 1 family: tv62"]
    spec, second = folder / "tv62.yaml", folder / "tv62.second.yaml"
    assert check() == silent
    revise(spec, "1.1", "1.2", "0x06")
    assert check() == [
        "tv62.second.yaml:104:14: readings-disagree: register 0x04 of bank 2: 1 byte here, nothing in tv62.yaml:218",
        "tv62.yaml:17:13: readings-disagree: revision of the edition 'en': 1.2 here, 1.1 in tv62.second.yaml:6",
    ]
    revise(second, "1.1", "1.2", "0x05")
    assert len(check()) == 1
    revise(second, "1.2", "1.2", "0x06")
    assert check() == silent
    assert main(["check", "--coverage"]) == 0
    assert QUOTED
    assert [text for text in QUOTED if text not in disagreements] == []


@pytest.mark.slow
def test_what_is_new_in_the_spec_alone_is_missed_by_the_coverage(folder: Path) -> None:
    spec = folder / "tv62.yaml"
    new = '    timings: [{name: start, meaning: After power-on, at_most_us: 500, source: "3"}]\n'
    text = spec.read_text(encoding="utf-8").replace("    bank_select: bank\n", f"    bank_select: bank\n{new}")
    spec.write_text(text, encoding="utf-8")
    assert main(["check"]) == 0
    assert main(["check", "--coverage"]) == 1


@pytest.mark.slow
def test_a_mistake_that_the_new_manual_prints_is_an_erratum(folder: Path) -> None:
    """The second reading has the value that is still in the table."""
    spec, second = folder / "tv62.yaml", folder / "tv62.second.yaml"
    revise(spec, "1.1", "1.2", "0x06")
    revise(second, "1.1", "1.2", "0x04")
    assert main(["check"]) == 1
    erratum = """\
  - name: address_of_correction
    title: The table still has the old address of the correction
    source: 4.3 p.3
    printed: The table has 04h, the list of changes 06h.
    used: 06h
    why: The list of changes says that it was moved.
    status: open
    severity: wrong_data
    affects: [registers.correction]
    readings: [{second: 1 byte, used: nothing}]
"""
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace("\nerrata:\n", f"\nerrata:\n{erratum}"), encoding="utf-8")
    assert main(["check"]) == 0
