"""Texts that are not the place of a field are reported, and no rule fails at them."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.new import write_spec
from codewheel.language.check import check_document
from codewheel.language.files import packaged_specs
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.loading.library import load_library

BROKEN = Path(__file__).parent / "broken"
#: More digits than Python converts to a number by default.
DIGITS = "1" * 5000


@pytest.mark.parametrize("place", ["6:x", "x", "²", "-1", f"{DIGITS}", f"{DIGITS}:0", f"7:{DIGITS}"])
def test_a_malformed_place_next_to_a_note_on_unused_bits(tmp_path: Path, place: str) -> None:
    text = (BROKEN / "unused_bits.yaml").read_text(encoding="utf-8")
    assert "at: 6:5" in text
    (tmp_path / "unused_bits.yaml").write_text(text.replace("at: 6:5", f'at: "{place}"'), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text("codewheel: 1\nmanufacturer: acme\ntitle: Acme\n", encoding="utf-8")
    _, report = load_library([tmp_path])
    problems = [(problem.rule, problem.path) for problem in report.problems]
    assert ("unused-bits", "registers.status.fields.warm.at") in problems
    assert ("unused-bits", "registers.status.fields.mode.at") not in problems


def test_a_place_with_too_many_digits_in_a_layout_of_bytes(tmp_path: Path) -> None:
    """All fields of the layout have places, and so the highest bit decides whether it needs an order of bytes."""
    text = (BROKEN / "unused_bits.yaml").read_text(encoding="utf-8")
    before_fields, _, fields_and_rest = text.partition("        fields:\n")
    _, _, rest = fields_and_rest.partition("\nregisters:\n")
    layout = f'        carried_as: bytes\n        fields:\n          - {{name: lone, at: "{DIGITS}"}}\n'
    file = tmp_path / "unused_bits.yaml"
    file.write_text(f"{before_fields}{layout}registers:\n{rest}", encoding="utf-8")
    report = ProblemReport()
    document = read_document(file, report)
    assert document is not None
    check_document(document, report)
    (message,) = [problem.message for problem in report.problems if problem.rule == "layout-keys"]
    assert message.startswith("'word' is carried as bytes, so it needs 'byte_order'")


def test_a_text_in_place_of_a_document_is_only_reported(tmp_path: Path) -> None:
    """A problem at a key called ``source`` counts as one of prose, so the spec is still compared with others."""
    write_spec("my_encoder", tmp_path / "my_encoder.yaml", like="biss")
    text = (tmp_path / "my_encoder.yaml").read_text(encoding="utf-8")
    (tmp_path / "my_encoder.yaml").write_text(f"{text}documents: {{source: Name in a file}}\n", encoding="utf-8")
    _, report = load_library([tmp_path])
    assert [problem.path for problem in report.problems if problem.rule == "wrong-type"] == ["documents.source"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("\n  biss:\n", "\n  biss: []\n  ignored:\n", "wrong-type"),
        ("turns: 2^multiturn_bits", f'turns: "{DIGITS}"', "too-long"),
    ],
)
def test_a_part_with_problems_is_only_reported(tmp_path: Path, old: str, new: str, message: str) -> None:
    """An interface that cannot be read is missing where the preset is compared with the position."""
    write_spec("my_encoder", tmp_path / "my_encoder.yaml", like="biss")
    text = (tmp_path / "my_encoder.yaml").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "my_encoder.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    _, report = load_library([tmp_path])
    assert message in {problem.rule for problem in report.problems}


def test_an_open_part_with_an_enormous_count(tmp_path: Path) -> None:
    """The expression is invalid, and texts with order codes are then not compared with it."""
    text = (BROKEN / "order_code_open.yaml").read_text(encoding="utf-8")
    file = tmp_path / "order_code_open.yaml"
    file.write_text(text.replace('"[A-"', f'"[A-Z]{{{10**20}}}"'), encoding="utf-8")
    report = ProblemReport()
    document = read_document(file, report)
    assert document is not None
    check_document(document, report)
    assert [problem.rule for problem in report.problems] == ["order-code-pattern"]


@pytest.mark.parametrize(
    ("name", "rule"), [("my_encoder.changes.json", "changes-file"), ("my_encoder.coverage.json", "coverage-file")]
)
def test_a_record_nested_too_deeply_was_edited(tmp_path: Path, name: str, rule: str) -> None:
    write_spec("my_encoder", tmp_path / "my_encoder.yaml", like="biss")
    (tmp_path / name).write_text("[" * 100_000, encoding="utf-8")
    _, report = load_library([tmp_path])
    assert [problem.rule for problem in report.problems] == [rule]


def test_a_bound_that_is_not_a_number(tmp_path: Path) -> None:
    text = (BROKEN / "numbers_in_texts.yaml").read_text(encoding="utf-8")
    assert "min: 10, max: 10," in text
    file = tmp_path / "numbers_in_texts.yaml"
    file.write_text(text.replace("min: 10, max: 10,", "min: 10, max: .nan,"), encoding="utf-8")
    report = ProblemReport()
    document = read_document(file, report)
    assert document is not None
    check_document(document, report)
    assert "quantity-text" in {problem.rule for problem in report.problems}


def test_a_step_that_writes_a_value_of_a_faulty_register(tmp_path: Path) -> None:
    """The register is left out, and with it the value. An earlier step changes a limit, so the step is looked at."""
    spec = packaged_specs() / "lika" / "sma21.yaml"
    text = spec.read_text(encoding="utf-8")
    register = text[text.index("  - name: command\n") :]
    faulty_register = register.replace("length: 1", "length: one", 1)
    (tmp_path / spec.name).write_text(text.replace(register, faulty_register), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_bytes(spec.with_name("manufacturer.yaml").read_bytes())
    _, report = load_library([tmp_path])
    assert "wrong-type" in {problem.rule for problem in report.problems}
