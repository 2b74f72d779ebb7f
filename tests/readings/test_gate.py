"""``generate`` and ``diff --record`` refuse a spec with problems, even if it can be built."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import main

pytestmark = pytest.mark.slow

TV62 = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"
SLOWER = ("max_hz: 10000000", "max_hz: 5000000")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the specs ``old`` and ``new``, which are the same."""
    monkeypatch.chdir(tmp_path)
    for name in ("old", "new"):
        shutil.copytree(TV62, name)
    return tmp_path


def slow_down_clock(spec: Path) -> None:
    text = spec.read_text(encoding="utf-8")
    assert SLOWER[0] in text
    spec.write_text(text.replace(*SLOWER), encoding="utf-8")


def generate(*more: str) -> int:
    return main(["generate", "new", "-o", "out", "--target", "python", *more])


def test_disagreeing_readings_are_not_generated(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    slow_down_clock(folder / "new" / "tv62.yaml")
    assert generate() == 1
    assert not (folder / "out").exists()
    err = capsys.readouterr().err
    assert "readings-disagree: highest clock over BiSS" in err
    assert err.endswith(
        "codewheel: nothing written: 'codewheel check --coverage' reports 1 problem; correct them, or add --unchecked\n"
    )
    assert generate("--unchecked") == 0
    assert generate("--check") == 0, "comparing needs no release"
    assert generate() == 0, "nothing new is released where no file changes"
    slow_down_clock(folder / "new" / "tv62.second.yaml")
    assert generate() == 0


def test_old_counts_are_not_generated(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "new", "--coverage", "--write"])
    (counts,) = (folder / "new").glob("*.coverage.json")
    counts.write_text(counts.read_text(encoding="utf-8").replace('"once": ', '"once": 1'), encoding="utf-8")
    assert generate() == 1
    assert "coverage-file: the counts do not match the readings" in capsys.readouterr().err
    main(["check", "new", "--coverage", "--write"])
    assert generate() == 0


def test_disagreeing_readings_are_not_recorded(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    slow_down_clock(folder / "new" / "tv62.yaml")
    before = {path.name: path.read_bytes() for path in (folder / "new").iterdir()}
    assert main(["diff", "old", "new", "--record"]) == 1
    assert capsys.readouterr().err.endswith(
        "codewheel: nothing recorded: 'codewheel check --coverage' reports 1 problem; correct them, or add"
        " --unchecked\n"
    )
    assert {path.name: path.read_bytes() for path in (folder / "new").iterdir()} == before
    main(["diff", "old", "new", "--record", "--unchecked"])
    assert "recorded in new/tv62.changes.json" in capsys.readouterr().out
