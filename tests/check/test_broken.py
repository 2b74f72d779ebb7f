"""Each spec in ``broken`` begins with the exact messages about it."""

from __future__ import annotations

import pathlib
import re

import pytest
from codewheel.language.check import check_document
from codewheel.language.problems import Problem, ProblemReport
from codewheel.language.read import read_document

HERE = pathlib.Path(__file__).parent
BROKEN = sorted((HERE / "broken").glob("*.yaml"))
EXPECT = "# expect: "

#: All rules of reading, of the schema and beyond. A rule without a broken spec fails here,
#: and so does a spec for a rule that is not listed. Rules for which no file can be stored are missing: rules about
#: unreadable, empty and binary files, and about folders.
RULES_WITH_BROKEN_SPECS = """
    access-mismatch addresses-mismatch alarm-implemented alarm-latch alarm-name alias
    alignment-mismatch
    also-written alternative-default alternative-use argument-not-written argument-register
    bad-expression bad-key bad-pattern bad-source bank-not-selected biss-protocol
    byte-order-missing cable-limit cable-order cited-place clock-range column-units combination contact-interface
    contact-kind contact-numbers contact-wire
    crc-impossible data-id-frames date default-mismatch description-file device-name
    duplicate-address duplicate-key duplicate-name error-usable evidence-grade example-shape
    explains-twice figure-number flag-differs implausible-rate incomplete-pair interface-mismatch
    label-mismatch layout-keys left-behind level-differs limit-does-not-fit limit-source
    makes-position-missing meaning-mismatch measurement-shape memory-access-repeated merge-key
    missing-key missing-signal misspelt-name monoflop network-mismatch not-a-map not-allowed
    not-opened not-summed not-text number-base number-too-long open-quotation
    order-code-ambiguous order-code-pattern out-of-range output-code pair-order parameter-cycle
    parameter-interface parameter-origin parity-coverage plain-bit port-mismatch printed-number procedure-name
    quantity-repeated quantity-text register-range repeated-item repeated-text request-purpose
    revision-not-in-history rs485-exchange same-answers saved-too-early sender several-documents signal-twice
    spi-exchange step-shape summed-twice summed-verdict supply-range table-arithmetic table-shape tag
    time-repeated timeout-mismatch timing-order timing-without-bound too-deep too-large too-long
    too-short typographic-quotes undefined-reference unit-mismatch unknown-key unknown-standard
    unused-bits unused-crc value-clash value-too-wide value-verdict verdict-choice wait-mismatch
    wait-too-short words-contradict writes-mismatch wrong-type yaml-syntax
""".split()


def problems_of(path: pathlib.Path) -> tuple[list[str], ProblemReport]:
    """Return each problem as ``line:column: rule: message``, and the report."""
    report = ProblemReport()
    document = read_document(path, report, path.name)
    if document is not None:
        check_document(document, report)
    return [problem.format().splitlines()[0].removeprefix(f"{path.name}:") for problem in report.problems], report


def expected_of(path: pathlib.Path) -> list[str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.removeprefix(EXPECT) for line in lines if line.startswith(EXPECT)]


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_broken_spec_is_refused_in_the_words_expected(path: pathlib.Path) -> None:
    expected = expected_of(path)
    problem_lines, report = problems_of(path)
    assert expected, "say in the first lines what is expected: # expect: line:column: rule: message"
    assert problem_lines == expected
    for problem in report.problems:
        check_caret(problem)


def check_caret(problem: Problem) -> None:
    """The caret is under the first character of the fault, and the lines fit a terminal."""
    _, *lines = problem.format().splitlines()
    assert max(map(len, lines)) <= 80
    source_line, caret = lines[-2:]
    assert caret.strip() == "^"
    fault = problem.text[problem.column - 1 : problem.column]
    if fault.isprintable() and fault:
        assert source_line[caret.index("^")] == fault


def test_every_rule_has_a_broken_spec() -> None:
    rules = {line.split(": ")[1] for path in BROKEN for line in expected_of(path)}
    assert sorted(rules) == sorted(RULES_WITH_BROKEN_SPECS)


def test_every_rule_in_the_code_is_listed() -> None:
    """Rules whose name is a literal, which most of them are."""
    rules = HERE.parents[1] / "generator" / "language" / "rules"
    text = "".join(path.read_text(encoding="utf-8") for path in rules.rglob("*.py"))
    named_rules = set(re.findall(r'report\.add\(\s*"([a-z0-9-]+)"', text))
    assert len(named_rules) > 50
    # The last two are about masters. Their broken specs are in tests/masters/broken.
    assert named_rules - set(RULES_WITH_BROKEN_SPECS) == {"setting-shape", "writing-shape"}


@pytest.mark.parametrize("path", sorted((HERE / "ok").glob("*.yaml")), ids=lambda path: path.stem)
def test_sound_spec_is_clean(path: pathlib.Path) -> None:
    report = ProblemReport()
    document = read_document(path, report)
    assert document is not None
    assert check_document(document, report) == document.data
    assert report.problems == ()


@pytest.mark.parametrize(
    ("start_value", "is_right"), [("111111", True), ("63", True), ("3Fh", True), ("111110", False)]
)
def test_a_start_value_may_be_written_in_binary(tmp_path: pathlib.Path, start_value: str, is_right: bool) -> None:
    text = (HERE / "broken" / "left_behind.yaml").read_text(encoding="utf-8")
    path = tmp_path / "left_behind.yaml"
    path.write_text(
        text.replace("The start value 0 is from", f"The start value {start_value} is from"), encoding="utf-8"
    )
    problems, _ = problems_of(path)
    assert any(f"'start value {start_value}'" in problem for problem in problems) is not is_right
