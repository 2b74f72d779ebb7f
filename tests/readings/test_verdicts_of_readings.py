"""Second readings of verdicts on values and combinations, which are compared by their bits."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.check.specs import check_specs

# Reads whole specs twice.
pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[1] / "specs"


@pytest.fixture
def second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A second reading of the spec, which agrees."""
    for name in ("signs.yaml", "manufacturer.yaml"):
        shutil.copy(SPECS / name, tmp_path)
    text = (tmp_path / "signs.yaml").read_text(encoding="utf-8")
    text = re.sub(r"evidence: .*\n", "", text).replace("manufacturer: test\n", "")
    # Conditions have no order.
    text = text.replace("{increasing: active, decreasing: active}", "{decreasing: active, increasing: active}")
    second = tmp_path / "signs.second.yaml"
    second.write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return second


def problems_after_change(second: Path, old: str, new: str) -> list[str]:
    """Return the problems after a change in the second reading, each with both files but without their lines."""
    text = second.read_text(encoding="utf-8")
    assert text.count(old) == 1
    second.write_text(text.replace(old, new), encoding="utf-8")
    problems = check_specs([Path()], []).report.problems
    disagreements = [(Path(problem.file).name, problem.message.partition(";")[0]) for problem in problems]
    return [f"{file}: {message.rpartition(':')[0]}" for file, message in disagreements]


def test_readings_that_agree(second: Path) -> None:
    assert not check_specs([Path()], []).report.problems


def test_the_verdict_of_a_value_is_compared(second: Path) -> None:
    reported = problems_after_change(
        second, "poor: {value: 2, makes_position: usable_with_warning}", "poor: {value: 2, makes_position: not_usable}"
    )
    value = "verdict on the position of value 2 of bits 9:8 of 'gray_word'"
    assert reported == [f"signs.yaml: {value}: usable_with_warning here, not_usable in signs.second.yaml"]


COMBINATION = "the combination of bit 1 = {}, bit 2 = 1 in 'word'"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "makes_position: usable_with_warning\n            remedy",
            "makes_position: not_usable\n            remedy",
            f"signs.yaml: {COMBINATION.format(1)}: usable_with_warning here, not_usable in signs.second.yaml",
        ),
        (
            "{decreasing: active, increasing: active}",
            "{decreasing: inactive, increasing: active}",
            f"signs.second.yaml: {COMBINATION.format(0)}: usable_with_warning here, nothing in signs.yaml",
        ),
    ],
)
def test_a_combination_is_compared(second: Path, old: str, new: str, expected: str) -> None:
    assert problems_after_change(second, old, new) == [expected]
