"""The page of rules is what the broken specs of the tests yield today, and has each rule that they break."""

from __future__ import annotations

from pathlib import Path

from rules_page import examples, rules_page

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_is_that_of_today() -> None:
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == rules_page(), "make rules-page"


def test_a_known_rule() -> None:
    shown = examples()["crc-impossible"]
    assert "poly" in shown.lines[-1]
    assert f"\n### crc-impossible\n\n{shown.message}" in rules_page().replace("\\", "")


def test_each_shows_the_line_that_is_at_fault() -> None:
    assert len(examples()) > 70
    assert all(item.lines[-1].strip() for rule, item in examples().items() if rule != "yaml-syntax")
