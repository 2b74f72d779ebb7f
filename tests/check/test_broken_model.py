"""Each rule that looks at the model has a spec that breaks it, and the exact message in its first lines."""

from __future__ import annotations

from pathlib import Path

import pytest

from codewheel.load import load_library

FOLDER = Path(__file__).parent / "broken_model"


@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.glob("*.yaml") if path.name != "manufacturer.yaml"))
def test_broken(name: str) -> None:
    path = FOLDER / name
    expected = [line.removeprefix("# expect: ") for line in path.read_text().splitlines() if line.startswith("# expect: ")]
    _, report = load_library([path])
    assert [f"{item.line}:{item.column}: {item.rule}: {item.message}" for item in report.problems] == expected
    assert expected
    assert all("Traceback" not in item.format() and max(map(len, item.format().splitlines()[1:])) <= 80 for item in report.problems)
