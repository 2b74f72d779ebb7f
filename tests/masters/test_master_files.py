"""Descriptions of masters: broken ones are rejected with exact messages, and adding a master needs no code.

Each file in ``broken`` begins with the exact messages about it, as in ``tests/check``.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.language.check import check_document
from codewheel.language.keys_of_masters import NUMBERS, WORDS
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.masters.sheet import Master

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BROKEN = sorted((HERE / "broken").glob("*.yaml"))
EXPECT = "# expect: "


def problems_of(path: Path) -> tuple[list[str], ProblemReport]:
    report = ProblemReport()
    document = read_document(path, report, path.name)
    if document is not None:
        check_document(document, report)
    return [problem.format().splitlines()[0].removeprefix(f"{path.name}:") for problem in report.problems], report


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_broken_master_is_refused_in_the_words_expected(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    expected = [line.removeprefix(EXPECT) for line in lines if line.startswith(EXPECT)]
    messages, report = problems_of(path)
    assert expected
    assert messages == expected
    for problem in report.problems:
        *_, quoted_line, caret = problem.format().splitlines()
        fault = problem.text[problem.column - 1 : problem.column]
        assert caret.strip() == "^"
        assert not fault or quoted_line[caret.index("^")] == fault


@pytest.mark.parametrize("path", sorted((ROOT / "specs" / "masters").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_master_is_sound(path: Path) -> None:
    assert problems_of(path)[0] == []


def test_a_sound_master_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(ROOT / "specs" / "masters" / "moteus.yaml")]) == 0
    assert capsys.readouterr().out.endswith("moteus.yaml\nno problems\n")


def test_every_rule_of_every_master_is_used_with_care(masters: dict[str, Master]) -> None:
    """No master has been tested on hardware yet. Whoever tests one changes its file and this test."""
    for master in masters.values():
        rules = (*master.limits, *master.settings)
        assert "tried" not in {master.standing, *(rule.get("standing") for rule in rules)}, master.name
        assert all(document.title for document in master.documents)


@pytest.mark.slow
def test_no_code_knows_a_master(masters: dict[str, Master]) -> None:
    """A master is only a file: its name is neither in the generator nor in a template."""
    titles = " ".join(master.title for master in masters.values())
    words = {*re.findall(r"[A-Za-z][A-Za-z0-9-]{4,}", titles), *masters}
    words -= {
        "Combivert",
        "controllers",
        "command",
        "drives",
        "cards",
        "motor-control",
        "Circulo",
        "Node",
        "iC-Haus",
        "bissc",
    }
    assert {"Beckhoff", "hostmot2", "Synapticon", "Novanta", "moteus"} <= words
    named = re.compile(rf"\b({'|'.join(map(re.escape, words))})\b")
    for folder, pattern in (("generator", "*.py"), ("generator", "*.json"), ("templates", "*.jinja")):
        for path in (ROOT / folder).rglob(pattern):
            text = path.read_text(encoding="utf-8")
            if path.suffix == ".py" and named.search(text):
                # A comment may cite a document. A public test vector cites its source, which is the firmware of a
                # master.
                text = ast.unparse(ast.parse(text)).replace("mjbots/moteus: fw/test", "")
            assert named.findall(text) == [], path


def test_every_item_is_explained() -> None:
    """The page on adding a master names every item that a rule can use, and every word."""
    page = (ROOT / "docs/extend/how-to-add-a-master.md").read_text(encoding="utf-8")
    for name in (*WORDS, *NUMBERS, *(word for words in WORDS.values() for word in words)):
        assert f"`{name}`" in page, name
    example = re.search(r"```yaml\n(codewheel: 1\nmaster: .*?)```", page, re.DOTALL)
    assert example is not None


def test_the_example_of_the_page(tmp_path: Path) -> None:
    page = (ROOT / "docs/extend/how-to-add-a-master.md").read_text(encoding="utf-8")
    example = re.search(r"```yaml\n(codewheel: 1\nmaster: (\w+)\n.*?)```", page, re.DOTALL)
    assert example is not None
    path = tmp_path / f"{example[2]}.yaml"
    path.write_text(example[1], encoding="utf-8")
    assert problems_of(path)[0] == []
