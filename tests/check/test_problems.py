"""Format of problems."""

from __future__ import annotations

import json

import pytest
from codewheel.language.problems import Problem, ProblemReport, join_words, quoted, suggest_word


def problem(text: str, column: int, *, file: str = "a.yaml", message: str = "wrong", path: str = "") -> Problem:
    return Problem(file, 3, column, "rule", path, message, text)


def test_place_path_line_and_caret() -> None:
    assert problem("  key: value", 8, path="registers.bank.key").format().splitlines() == [
        "a.yaml:3:8: rule: wrong",
        "  in registers.bank.key",
        "    key: value",
        "         ^",
    ]


def test_without_a_line_to_show() -> None:
    assert problem("", 1).format() == "a.yaml:3:1: rule: wrong"


def test_long_lines_are_scrolled_to_the_caret() -> None:
    text = "start " + "x" * 200 + "HERE" + "y" * 200
    _, source_line, caret = problem(text, 207).format(60).splitlines()
    assert len(source_line) <= 60
    assert source_line.strip().startswith("...")
    assert source_line.endswith("...")
    assert source_line[caret.index("^") :].startswith("HERE")


def test_column_beyond_the_line() -> None:
    assert problem("abc", 50).format().splitlines()[-1] == "       ^"


def test_control_characters_are_visible() -> None:
    formatted = problem("a\x1b[2Jb\tc", 8, file="x\ny.yaml", message="no \x07 bell").format()
    assert formatted.split("\n") == ["x\\x0ay.yaml:3:8: rule: no \\x07 bell", "    a\\x1b[2Jb\\tc", "               ^"]


def test_wide_characters_take_two_columns() -> None:
    assert problem("幅: x", 4).format().splitlines()[-1] == "        ^"


def test_report_sorts_and_drops_repetitions() -> None:
    report = ProblemReport()
    assert not report
    for line in (2, 1, 2):
        report.add_at("a.yaml", "rule", "wrong", line=line)
    assert [problem.line for problem in report.problems] == [1, 2]
    assert len(report) == 2


def test_json_has_every_attribute() -> None:
    data = problem("text", 2).to_json()
    assert json.loads(json.dumps(data)) == {
        "file": "a.yaml",
        "line": 3,
        "column": 2,
        "rule": "rule",
        "path": "",
        "message": "wrong",
        "text": "text",
    }


def test_words() -> None:
    assert [join_words("abc"[:count]) for count in range(4)] == ["", "a", "a and b", "a, b and c"]
    assert quoted("x" * 100) == "'" + "x" * 57 + "...'"
    values: list[object] = [True, None, 3, {}, []]
    assert [quoted(value) for value in values] == ["true", "nothing", "3", "a map", "a list"]
    assert suggest_word("adress", ["address", "access"]) == "; did you mean 'address'?"
    assert suggest_word("zzz", ["a", "b"], "use one of") == "; use one of: a, b"
    assert suggest_word("zzz", [f"name_{index}" for index in range(12)]) == ""


@pytest.mark.parametrize(
    ("word", "known_word"),
    [
        ("titel", "title"),
        ("positon_bits", "position_bits"),
        ("form", "from"),
        ("bit", "bits"),
        ("addr", "address"),
        ("readwrite", "read_write"),
        ("ByteOrder", "byte_order"),
        ("numbers_of_turns", "number_of_turns"),
    ],
)
def test_slip_gets_a_hint(word: str, known_word: str) -> None:
    assert suggest_word(word, [known_word, "something_else"]) == f"; did you mean '{known_word}'?"


@pytest.mark.parametrize(
    ("word", "known_word"),
    [
        ("spi", "ssi"),
        ("rs422", "rs485"),
        ("biss_4", "biss_6"),
        ("reset", "preset"),
        ("biss", "bits"),
        ("inactive", "active"),
        ("min_khz", "min_hz"),
        ("at_least_ms", "at_least_us"),
        ("step_nm", "step_um"),
    ],
)
def test_another_word_of_the_trade_is_no_slip(word: str, known_word: str) -> None:
    assert suggest_word(word, [known_word, "something_else"]) == f"; known: {known_word}, something_else"


def test_of_two_words_that_are_as_near_none_is_guessed() -> None:
    assert suggest_word("turn_1s", ["turn_1", "turn_1st"]) == "; known: turn_1, turn_1st"
