"""Six changes of a manual, of which only the core facts are edited: few problems, and each stale text is named."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import main

SPECS = Path(__file__).parents[2] / "specs" / "lika"
FILES = ("manufacturer.yaml", "am36.yaml", "am36.second.yaml", "am36.words.yaml")
#: Bounds for the output of ``check`` after six edits.
MOST_PROBLEMS, MOST_LINES = 12, 40
#: A made-up edition 2.0: start value of a CRC, supply, two colours, the name of a bit, a wait, and no more GG codes.
EDITS = (
    ('  revision: "1.0"\n  date: "2014"', '  revision: "2.0"\n  date: "2026"'),
    (
        "    init: 0\n    refin: false\n    refout: false\n    xorout: 0x3F",
        "    init: 0x3F\n    refin: false\n    refout: false\n    xorout: 0x3F",
    ),
    ('"2", signal: +10VDC +30VDC', '"2", signal: +5VDC +30VDC'),
    ("Red, signal: +10VDC +30VDC", "Red, signal: +5VDC +30VDC"),
    ("supply: {min_mv: 10000", "supply: {min_mv: 5000"),
    ("White, signal: Zero setting/Preset", "Grey, signal: Zero setting/Preset"),
    ("Grey, signal: Counting direction", "White, signal: Counting direction"),
    (
        "- name: enable_preset\n        at: 2\n        printed_name: Enable preset",
        "- name: preset_lock\n        at: 2\n        printed_name: Preset lock",
    ),
    ("wait_at_least_ms: 30 ", "wait_at_least_ms: 50 "),
    ('        GG: {meaning: "SSI, Gray code", interface: ssi, sets: {ssi_gray: 1}, source: "5"}\n', ""),
)
#: What the edits leave behind, by the rule that reports it and the text in its line.
LEFT_BEHIND = (
    ("revision-not-in-history", 'revision: "2.0"'),
    ("also-written", "GG: GG"),
    ("quantity-repeated", "quantity: supply, min: 10"),
    ("undefined-reference", "needs: configuration.enable_preset"),
    ("left-behind", "note: >-"),
    ("left-behind", "at_least_us: 30000"),
    ("wait-too-short", "at_least_ms: 30"),
    ("example-contradicts", "check: 7"),
    ("left-behind", "used: The start value is 0."),
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in FILES:
        shutil.copy(SPECS / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def edit(file: Path, *edits: tuple[str, str]) -> None:
    text = file.read_text(encoding="utf-8")
    for old, new in edits:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")


def checked(capsys: pytest.CaptureFixture[str]) -> list[str]:
    main(["check", "am36.yaml"])
    return capsys.readouterr().out.splitlines()


def test_six_careless_edits_give_few_problems_that_name_each_stale_place(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    edit(folder / "am36.yaml", *EDITS)
    lines = checked(capsys)
    problems = [line for line in lines if re.match(r"am36[\w.]*:\d+:\d+: ", line)]
    assert len(problems) <= MOST_PROBLEMS
    assert len(lines) <= MOST_LINES + 2  # The last two lines name the files and the number of problems.
    spec_lines = (folder / "am36.yaml").read_text(encoding="utf-8").splitlines()
    found = []
    for problem in problems:
        line, rule = re.fullmatch(r"am36\.yaml:(\d+):\d+: ([\w-]+): .*", problem).groups()  # type: ignore[union-attr]
        found.append((rule, spec_lines[int(line) - 1]))
    for rule, text in LEFT_BEHIND:
        assert any(rule == found_rule and text in line for found_rule, line in found), (rule, text)


@pytest.mark.slow
def test_lines_of_other_places_with_the_same_cause(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The wait after a command is 30 ms in seven procedures, one of which has it twice."""
    edit(
        folder / "am36.yaml",
        ("wait_at_least_ms: 30 ", "wait_at_least_ms: 50 "),
        ("at_least_us: 30000", "at_least_us: 50000"),
    )
    (problem,) = [line for line in checked(capsys) if "wait-too-short" in line]
    first = int(problem.split(":")[1])
    others = [int(number) for number in re.findall(r"\d+", problem.partition("the same in lines ")[2])]
    text = (folder / "am36.yaml").read_text(encoding="utf-8").splitlines()
    waits = [number for number, line in enumerate(text, 1) if "{do: wait, at_least_ms: 30" in line]
    assert len(waits) == 8
    assert [first, *others] == waits


def test_words_of_a_text_stay_if_the_part_that_has_it_is_renamed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = (folder / "am36.words.yaml").read_text(encoding="utf-8")
    assert '"registers.configuration.fields.output_code.note"' not in old
    text = (folder / "am36.yaml").read_text(encoding="utf-8").replace("enable_preset", "preset_lock")
    (folder / "am36.yaml").write_text(text, encoding="utf-8")
    outdated = [line for line in checked(capsys) if "words-outdated" in line]
    assert len(outdated) == 1
    assert main(["cloze", "am36", "--specs", "am36.yaml"]) == 0
    new = (folder / "am36.words.yaml").read_text(encoding="utf-8")
    assert '"?"' not in new
    assert new == old.replace("enable_preset", "preset_lock")


@pytest.mark.slow
def test_a_word_that_is_no_longer_a_choice_is_asked_for(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (folder / "am36.yaml").read_text(encoding="utf-8").replace("+10VDC +30VDC", "+5VDC +30VDC")
    for old, new in (("+10 V", "+5 V"), ("min_mv: 10000", "min_mv: 5000"), ("supply, min: 10,", "supply, min: 5,")):
        text = text.replace(old, new)
    (folder / "am36.yaml").write_text(text, encoding="utf-8")
    assert main(["cloze", "am36", "--specs", "am36.yaml"]) == 0
    sheet = (folder / "am36.words.yaml").read_text(encoding="utf-8")
    # The signal is in two texts of errata.
    assert sheet.count('"?"') == 2
    assert "+10VDC" not in sheet


@pytest.mark.slow
def test_a_change_of_an_edition_that_fails_is_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Edition 1.5 of the AMM5 has no alarms, and the editions before it are derived from it."""
    shutil.copy(SPECS / "amm5.yaml", folder)
    edit(
        folder / "amm5.yaml",
        ("  - name: ps_error\n    printed_name: PS error", "  - name: count_error\n    printed_name: PS error"),
        ("affects: [alarms.ps_error,", "affects: [alarms.count_error,"),
    )
    main(["check", "amm5.yaml"])
    lines = capsys.readouterr().out.splitlines()
    problems = [line for line in lines if re.match(r"amm5\.yaml:\d+:\d+: ", line)]
    assert [line.split(": ")[1] for line in problems] == ["overlay-unused"]


@pytest.mark.slow
def test_the_odd_one_of_parts_that_are_alike_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The start value of a CRC differs in the first of three families by name."""
    for name in ("amm5.yaml", "asc85.yaml"):
        shutil.copy(SPECS / name, folder)
    edit(
        folder / "am36.yaml",
        *EDITS[1:2],
        ("The start value 0, the bit", "The bit"),
        ("used: The start value is 0.", "used: See above."),
    )
    text = (folder / "am36.yaml").read_text(encoding="utf-8")
    start, end = text.index("  - name: public_biss_crc_6"), text.index("  - name: public_biss_crc_4")
    (folder / "am36.yaml").write_text(text[:start] + text[end:], encoding="utf-8")
    main(["check", "."])
    problems = [line for line in capsys.readouterr().out.splitlines() if ": not-alike: " in line]
    assert len(problems) == 1
    assert problems[0].startswith("am36.yaml:")
    assert "this is 0x3f, but 0x0 in amm5.yaml:" in problems[0]
