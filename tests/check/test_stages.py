"""One run reports everything: an error in one place does not hide errors in another."""

from __future__ import annotations

import re
from pathlib import Path

from codewheel.commands.outputs import load_for_targets, targets_named

BROKEN = Path(__file__).parent / "broken_model"


def problem_lines(folder: Path) -> list[str]:
    _, report = load_for_targets([folder], targets_named())
    return [f"{Path(problem.file).name}:{problem.line}: {problem.rule}" for problem in report.problems]


def copy(folder: Path, *names: str) -> None:
    for name in (*names, "manufacturer"):
        (folder / f"{name}.yaml").write_text((BROKEN / f"{name}.yaml").read_text())


def test_names_in_c_are_told_of_a_family_beside_a_broken_one(tmp_path: Path) -> None:
    copy(tmp_path, "c_name_procedure")
    alone = problem_lines(tmp_path)
    assert alone
    assert all(line.endswith("c-name") for line in alone)
    copy(tmp_path, "overlap")
    assert set(alone) < set(problem_lines(tmp_path))


def test_a_family_is_looked_at_although_its_manufacturer_file_is_broken(tmp_path: Path) -> None:
    copy(tmp_path, "overlap")
    alone = problem_lines(tmp_path)
    (tmp_path / "manufacturer.yaml").write_text('codewheel: 1\nmanufacturer: acme\ntitel: Acme\nsource: "1"\n')
    assert problem_lines(tmp_path) == sorted([*alone, "manufacturer.yaml:3: unknown-key"])


def test_a_manufacturer_file_whose_name_is_no_text_is_a_problem(tmp_path: Path) -> None:
    copy(tmp_path, "overlap")
    (tmp_path / "manufacturer.yaml").write_text("codewheel: 1\nmanufacturer: [acme]\ntitle: Acme\n")
    assert "manufacturer.yaml:2: wrong-type" in problem_lines(tmp_path)


def test_bits_in_a_meaning_are_not_checked_if_their_interface_has_errors(tmp_path: Path) -> None:
    """The meaning of a label value says the bits of the frame, which only a valid interface has."""
    balluff = Path(__file__).parents[2] / "specs" / "balluff"
    for name in ("manufacturer", "bml_s1g"):
        text = (balluff / f"{name}.yaml").read_text(encoding="utf-8")
        broken_text = re.sub(r"(?m)^  ssi:\n(    .*\n|\n)+", "  ssi: none\n", text)
        (tmp_path / f"{name}.yaml").write_text(broken_text, encoding="utf-8")
    rules = {line.rpartition(": ")[2] for line in problem_lines(tmp_path)}
    assert "wrong-type" in rules
    assert "meaning-mismatch" not in rules
