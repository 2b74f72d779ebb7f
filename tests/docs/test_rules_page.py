"""The page of rules follows from the broken specs of the tests, and has each rule that they break."""

from __future__ import annotations

from codewheel.commands.explain import explain, rules_of_check
from rules_page import DATA, PAGE, examples, rules_data, rules_page


def test_the_page_is_that_of_today() -> None:
    assert PAGE.read_text(encoding="utf-8") == rules_page(), "make rules-page"
    assert DATA.read_text(encoding="utf-8") == rules_data(), "make rules-page"


def test_a_known_rule() -> None:
    example = examples()["crc-impossible"]
    assert "poly" in example.lines[-1]
    assert f"\n### crc-impossible\n\n{example.message}" in rules_page().replace("\\", "")


def test_each_shows_the_line_that_is_at_fault() -> None:
    assert len(examples()) > 70
    assert all(example.lines[-1].strip() for rule, example in examples().items() if rule != "yaml-syntax")


def test_explain_shows_what_the_page_shows() -> None:
    for rule, example in examples().items():
        assert explain(rule).startswith(f"{rule}, a rule of check. Example message:\n  {example.message[:20]}"), rule
        assert explain(rule).endswith(example.lines[-1])
    assert [*rules_of_check()] == [*examples()]


def test_explain_has_the_rules_about_several_files_and_masters() -> None:
    for rule in ("readings-disagree", "overlay-conflict", "coverage-file", "writing-shape", "setting-shape"):
        assert explain(rule).startswith(f"{rule}, a rule of check")
