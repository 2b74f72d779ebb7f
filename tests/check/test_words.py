"""Words reversed in shipped specs are reported where the fact is data as well."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.language.check import check_document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document

LIKA = Path(__file__).parents[2] / "specs" / "lika"
#: AMM5 4.3.2 step 14, with the wires of 4.1.2: black is /B. AMM5 7.4.1: a battery alarm is raised below a voltage.
MISTAKES = [
    ("(white and blue wires)", "(white and black wires)"),
    ("meaning: The external battery is depleted", "meaning: The external battery is above 3.05 V"),
    ("remedy: Replace the battery, then reset the error with data ID 7 or C", "remedy: The flag clears itself"),
]


def contradictions(folder: Path, text: str) -> list[str]:
    report = ProblemReport()
    path = folder / "amm5.yaml"
    path.write_text(text, encoding="utf-8")
    document = read_document(path, report)
    assert document is not None
    check_document(document, report)
    return [problem.message for problem in report.problems if problem.rule == "words-contradict"]


@pytest.mark.one_in(3, "slow")
@pytest.mark.parametrize(("printed", "mistake"), MISTAKES)
def test_a_reversed_word_is_reported(tmp_path: Path, printed: str, mistake: str) -> None:
    text = (LIKA / "amm5.yaml").read_text(encoding="utf-8")
    assert text.count(printed) == 1
    assert contradictions(tmp_path, text) == []
    assert len(contradictions(tmp_path, text.replace(printed, mistake))) == 1
