"""Facts in words: quantities, tables, LEDs, numbers in texts and cited sections are compared, and each is counted."""

from __future__ import annotations

import pathlib
import shutil

import pytest
from codewheel.commands.check.specs import check_specs
from codewheel.language.problems import ProblemReport
from codewheel.loading.library import load_families
from codewheel.readings.reading import FactClass
from codewheel.readings.second_readings import Coverage, comparable_specs, compare_readings
from codewheel.readings.stated import numbers_in

pytestmark = pytest.mark.slow

HERE = pathlib.Path(__file__).parent
SPEC = """\
characteristics:
  - name: screw_torque
    value: At most 0.8 Nm
    values:
      - {quantity: torque, max: 0.8, unit: Nm}
    source: "3.4"
  - {name: handling, value: With care, source: "1.2"}
tables:
  - name: speeds
    title: Speed
    columns: [Resolution, Speed]
    units: [µm, m/s]
    rows:
      - ["5", "2.4"]
    source: "4"
leds:
  - name: power
    title: LED
    states:
      - {state: "on", meaning: "Supply above 4 V"}
    source: "9"
"""
SECOND = """\
characteristics:
  - name: screw_torque
    value: Screws to 0.8 Nm
    values:
      - {quantity: torque, max: 0.8, unit: Nm}
  - {name: handling, value: Carefully}
tables:
  - name: speeds
    units: [µm, m/s]
    columns: [A, B]
    rows:
      - ["5", "2.4"]
leds:
  - name: power
    states:
      - {state: "On"}
sections:
  "3.4": [characteristics]
  "1.2": [characteristics.handling]
  "4": [tables]
found:
  leds.power.states.0.meaning: 4 V
  leds.power.source: "9"
decided: [verdict, crcs.six.init]
"""


@pytest.fixture
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    for path in (HERE / "specs").glob("*.yaml"):
        shutil.copy(path, tmp_path)
    for name, added in (("twice.yaml", SPEC), ("twice.second.yaml", SECOND)):
        with (tmp_path / name).open("a", encoding="utf-8") as file:
            file.write(added)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def problem_lines() -> list[str]:
    report = check_specs([pathlib.Path()], []).report
    problems = [problem.format().splitlines()[0] for problem in report.problems]
    of_spec = [line for line in problems if line.startswith("twice.yaml:")]
    return [line.partition(": readings-disagree: ")[2].partition(" in twice")[0] for line in of_spec]


def replace_in_file(path: pathlib.Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", []),
        (
            "value: At most 0.8 Nm\n    values:\n      - {quantity: torque, max: 0.8",
            "value: At most 8 Nm\n    values:\n      - {quantity: torque, max: 8",
            [
                "numbers in characteristics.screw_torque.value: 8Nm here, 0.8Nm",
                "upper bound of torque 1 of the characteristic 'screw_torque': 8 here, 0.8",
            ],
        ),
        ('["5", "2.4"]', '["5", "4.2"]', ["row 1, column 2 of the table 'speeds': 4.2 here, 2.4"]),
        ('state: "on"', 'state: "off"', ["words of state 1 of the LED 'power': off here, on"]),
        ("above 4 V", "above 5 V", ["numbers in leds.power.states.0.meaning: 5V here, 4V"]),
        ('source: "3.4"', 'source: "3.5"', ["section cited at characteristics.screw_torque.source: 3.5 here, 3.4"]),
        ('source: "1.2"', 'source: "3.4"', ["section cited at characteristics.handling.source: 3.4 here, 1.2"]),
        ('source: "9"', 'source: "8"', ["section cited at leds.power.source: 8 here, 9"]),
    ],
)
def test_a_typo_in_words_is_told(folder: pathlib.Path, old: str, new: str, expected: list[str]) -> None:
    if old:
        replace_in_file(folder / "twice.yaml", old, new)
    assert sorted(problem_lines()) == expected


def coverage(folder: pathlib.Path) -> Coverage:
    report = ProblemReport()
    families, _ = load_families([folder])
    (covered,) = compare_readings(families, comparable_specs(families, report), report)
    return covered


def test_what_was_not_read_twice_does_not_count_as_such(folder: pathlib.Path) -> None:
    """Without numbers only a name is compared. Numbers that were found, and decisions, were not read twice."""
    counts = coverage(folder).counts
    once = {
        path for fact_class, path in coverage(folder).once if fact_class in (FactClass.CHARACTERISTIC, FactClass.TEXT)
    }
    assert ("characteristics", "handling") in once
    assert ("leds", "power", "states", 0, "meaning") in once
    # Name, kind, bound and unit of the torque are compared.
    assert (counts[FactClass.CHARACTERISTIC].twice, counts[FactClass.CHARACTERISTIC].once) == (4, 1)
    assert (counts[FactClass.VERDICT].twice, counts[FactClass.VERDICT].decided) == (0, 3)
    assert (counts[FactClass.CRC].decided, counts[FactClass.SECTION].twice) == (1, 3)


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("At most Ø 24 mm", "24mm"),
        ("−15 °C to +80 °C", "-15°C 80°C"),
        ("5.4 mm ±0.1 mm, 65,536 turns", "5.4mm ±0.1mm 65536"),
        ("M2.5 × 6 UNI5931, RS-485", "M2.5 6 UNI5931 RS-485"),
        ("2.4 m/s and 90 Ω/km.", "2.4m/s 90Ω/km"),
        ("2.4m/s", "2.4m/s"),
        ("Directive 2014/30/EU", "2014 30"),
        ("no number", ""),
    ],
)
def test_numbers_of_a_text(text: str, numbers: str) -> None:
    assert numbers_in(text) == numbers
