"""The pages of rules follow from the broken specs of the tests, and have each rule that they break."""

from __future__ import annotations

from codewheel.changes.rules import RULES
from codewheel.commands.explain import explain, rules_of_check
from rules_page import DATA, FOLDER, examples, rules_data, rules_pages


def test_the_pages_are_those_of_today() -> None:
    pages = {path.name: path.read_text(encoding="utf-8") for path in FOLDER.glob("rules*.md")}
    assert pages == rules_pages(), "make rules-page"
    assert DATA.read_text(encoding="utf-8") == rules_data(), "make rules-page"


def test_a_known_rule() -> None:
    example = examples()["crc-impossible"]
    assert "poly" in example.lines[-1]
    assert f"\n## crc-impossible\n\n{example.message}" in rules_pages()["rules-a-to-c.md"].replace("\\", "")


def test_each_rule_is_on_one_page_and_in_the_list() -> None:
    pages = rules_pages()
    for rule in examples():
        (page,) = [name for name, text in pages.items() if f"\n## {rule}\n" in text]
        assert f"[`{rule}`]({page}#{rule})" in pages["rules.md"]
    for rule in RULES:
        assert pages["rules-of-diff.md"].count(f"\n| `{rule}` |") == 1


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
