"""Mistakes in the pins of shipped specs are reported, even if both readings have them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from codewheel.language.check import check_document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document

LIKA = Path(__file__).parents[2] / "specs" / "lika"
RULES = {"signal-twice", "incomplete-pair", "missing-signal"}
#: Family, contact and signal as printed (AMM5 4.1.1, AM36 4.1, ASC85 4.1, SMA21 4.4 and 4.5), and a wrong signal.
MISTAKES = [
    ("amm5", '"12", signal: not connected', '"12", signal: Clock IN + / MA +', "signal-twice"),
    ("amm5", '"2", signal: Data OUT - / SLO -', '"2", signal: Data OUT -', "incomplete-pair"),
    ("amm5", "Black, signal: /B (sin -)", "Black, signal: B (sin +)", "signal-twice"),
    ("amm5", "Blue, signal: 0Vb", "Blue, signal: not used", "missing-signal"),
    ("am36", "Grey, signal: Counting direction", "Grey, signal: Zero setting/Preset", "signal-twice"),
    ("am36", '"5", signal: Data OUT +', '"5", signal: Data OUT -', "signal-twice"),
    ("asc85", "Green, signal: DATA OUT + / SLO +", "Green, signal: not connected", "incomplete-pair"),
    ("asc85", '"2", signal: CLOCK IN + / MA +', '"2", signal: CLOCK IN - / MA -', "signal-twice"),
    ("sma21", "Black, signal: /B", "Black, signal: /A", "signal-twice"),
    ("sma21", '"6", signal: B (REQ- / SD-)', '"6", signal: reserved', "incomplete-pair"),
]


def rules_broken(folder: Path, text: str, family: str) -> set[str]:
    report = ProblemReport()
    path = folder / f"{family}.yaml"
    path.write_text(text, encoding="utf-8")
    document = read_document(path, report)
    assert document is not None
    check_document(document, report)
    return {problem.rule for problem in report.problems} & RULES


@pytest.mark.one_in(10, "slow")
@pytest.mark.parametrize(("family", "printed", "mistake", "rule"), MISTAKES)
def test_a_wrong_pin_is_reported(tmp_path: Path, family: str, printed: str, mistake: str, rule: str) -> None:
    text = (LIKA / f"{family}.yaml").read_text(encoding="utf-8")
    contact, _, signal = printed.partition(", signal: ")
    wrong_signal = mistake.partition(", signal: ")[2]
    pattern = rf"(contact: {re.escape(contact)}, signal: (?:\")?){re.escape(signal)}(?=[\",}}])"
    changed, count = re.subn(pattern, lambda match: match[1] + wrong_signal, text, count=1)
    assert count == 1
    assert rules_broken(tmp_path, text, family) == set()
    assert rule in rules_broken(tmp_path, changed, family)


def test_a_signal_with_one_of_several_names_is_not_missing(tmp_path: Path) -> None:
    """ASC85 4: the lines of a table for SSI and BiSS have two names each, and a cable may print only one of them."""
    text = (LIKA / "asc85.yaml").read_text(encoding="utf-8")
    cable = text[text.index("  - name: m8_cable") :]
    with_one_name = re.sub(r"(?:CLOCK IN|DATA OUT) ([+-]) / (MA|SLO) \1", r"\2 \1", cable)
    assert with_one_name.count("MA +") == cable.count("MA +")
    assert with_one_name.count("CLOCK IN +") == cable.count("CLOCK IN +") - 1
    assert rules_broken(tmp_path, text.replace(cable, with_one_name), "asc85") == set()
