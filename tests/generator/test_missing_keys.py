"""A missing key in an edition or an overlay is a problem with a place, never a traceback."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from shutil import copy
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.commands.families_in_specs import check_editions, edition_devices
from codewheel.commands.terminal import CommandError
from codewheel.language.read import parse
from codewheel.loading.library import load_families

# Loads a library for each missing key.
pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
BASE = ROOT / "tests" / "changes" / "base"
EDITIONS = """\
editions:
  - revision: "1.0"
    labels: ["DM{size}{turns}{output}"]
    tests:
      - {register: resolution, run: resolution, min: 1, max: 17, why: No other number., source: "1"}
  - revision: "1.1"
    date: "2024-02-01"
    then:
      - set: title
        to: DEMO2 encoder
        why: It has another name.
        severity: wording
        source: "1"
      - {add: registers.configuration.note, value: Never written., why: It says so., source: "1"}
      - {unknown: [supply], why: No page is public., source: "1"}
      - {also: A second connector., why: There is a picture., source: "1"}
"""


@pytest.fixture
def spec(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    copy(BASE / "manufacturer.yaml", tmp_path)
    (tmp_path / "demo.yaml").write_text((BASE / "demo.yaml").read_text(encoding="utf-8") + EDITIONS, encoding="utf-8")
    return tmp_path / "demo.yaml"


@pytest.mark.parametrize("line", ["        why: It has another name.\n", '        source: "1"\n'])
@pytest.mark.parametrize("command", [["check"], ["generate", "--edition", "demo=1.1"]])
def test_a_change_of_an_edition_without_a_reason_or_source(
    spec: Path, capsys: pytest.CaptureFixture[str], line: str, command: list[str]
) -> None:
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace(line, "", 1), encoding="utf-8")
    place = text[: text.index("      - set: title")].count("\n") + 1
    key = line.split(":")[0].strip()
    assert main([*command, str(spec)]) == 1
    done = capsys.readouterr()
    (problem_line,) = [line for line in (done.out + done.err).splitlines() if line.startswith(f"{spec}:")]
    assert problem_line.startswith(f"{spec}:{place}:9: missing-key: '{key}' is missing")


def _places(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    if not isinstance(value, dict | list):
        return
    for key, inside in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        yield from _places(inside, (*path, key))


def _without(value: Any, path: tuple[str | int, ...]) -> Any:
    """Return a copy of the value without the part at the path."""
    first, inner_path = path[0], path[1:]
    changed = value.copy()
    if inner_path:
        changed[first] = _without(value[first], inner_path)
    else:
        del changed[first]
    return changed


def _data(file: Path) -> dict[str, Any]:
    return parse(file.read_text(encoding="utf-8"), lambda _: None, lambda _: None)[0]


@pytest.mark.exhaustive
def test_each_key_of_editions_and_of_the_top(spec: Path) -> None:
    data = _data(spec)
    places = [path for path in _places(data) if len(path) == 1 or path[0] in ("editions", "manual")]
    assert len(places) > 50
    for path in places:
        spec.write_text(json.dumps(_without(data, path)), encoding="utf-8")
        families, report = load_families([spec])
        check_editions(families, report)
        for edition in ("1.0", "1.1"):
            with suppress(CommandError):  # Without its key there is no such edition.
                edition_devices(families, [f"demo={edition}"], report)


def test_each_key_of_an_overlay(tmp_path: Path) -> None:
    tolvarn = ROOT / "docs" / "example" / "tolvarn"
    data = _data(ROOT / "docs" / "example-overlay" / "tv62.s042.overlay.yaml")
    overlay = tmp_path / "tv62.s042.overlay.yaml"
    for path in _places(data):
        overlay.write_text(json.dumps(_without(data, path)), encoding="utf-8")
        families, report = load_families([tolvarn / "tv62.yaml", overlay])
        check_editions(families, report)
