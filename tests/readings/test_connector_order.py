"""Connectors of two readings are paired by their names: a new connector is not compared with another one."""

from __future__ import annotations

import shutil
from pathlib import Path

from codewheel.language.problems import Problem, ProblemReport
from codewheel.language.read import read_specs
from codewheel.loading.library import families_of
from codewheel.readings.second_readings import comparable_specs, compare_readings

LIKA = Path(__file__).parents[2] / "specs" / "lika"
NEW_CONNECTOR = """\
  - name: m12_5_pins
    kind: connector
    title: M12 5-pin, male
    interfaces: [ssi, biss]
    note: There is no Shield.
    source: 4 p.13
    contacts:
      - {contact: "1", signal: +Vdc}
      - {contact: "2", signal: 0Vdc}
      - {contact: "3", signal: CLOCK IN + / MA +}
      - {contact: "4", signal: "CLOCK IN - / MA -"}
      - {contact: "5", signal: DATA OUT + / SLO +}
      - {contact: "6", signal: "DATA OUT - / SLO -"}
"""


def problems_with(folder: Path, text: str) -> list[Problem]:
    folder.mkdir()
    for name in ("asc85.second.yaml", "manufacturer.yaml"):
        shutil.copy(LIKA / name, folder)
    (folder / "asc85.yaml").write_text(text, encoding="utf-8")
    report = ProblemReport()
    families = families_of(read_specs([folder], report), report)
    compare_readings(families, comparable_specs(families, report), report)
    return list(report.problems)


def test_a_new_connector_before_others_is_no_disagreement(tmp_path: Path) -> None:
    text = (LIKA / "asc85.yaml").read_text(encoding="utf-8")
    first_connector = "  - name: m12_connector\n"
    assert text.count(first_connector) == 1
    assert problems_with(tmp_path / "lika", text.replace(first_connector, NEW_CONNECTOR + first_connector)) == []


def test_two_connectors_with_exchanged_contacts_disagree(tmp_path: Path) -> None:
    """ASC85 4.1: the M12 connector has 0Vdc on pin 1, and the M23 connector has it on pin 12."""
    text = (LIKA / "asc85.yaml").read_text(encoding="utf-8")
    exchanged = text.replace("name: m12_connector", "name: m0").replace("name: m23_connector", "name: m12_connector")
    exchanged = exchanged.replace("name: m0", "name: m23_connector")
    rules = {problem.rule for problem in problems_with(tmp_path / "lika", exchanged)}
    assert "readings-disagree" in rules
