"""Disagreements with one cause are one problem: a widened constant, a name, texts of an example that is gone."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import main

SPECS = Path(__file__).parents[2] / "specs" / "lika"
MEND = "; check the manual; if it prints both, add an erratum with both under 'readings'"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the SMA21 and its second reading, which agree."""
    for name in ("manufacturer.yaml", "sma21.yaml", "sma21.second.yaml"):
        shutil.copy(SPECS / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def edit(file: Path, *edits: tuple[str, str]) -> None:
    text = file.read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")


def disagreements(capsys: pytest.CaptureFixture[str]) -> list[str]:
    main(["check", "sma21.yaml"])
    lines = capsys.readouterr().out.splitlines()
    return [line.partition(" readings-disagree: ")[2] for line in lines if "readings-disagree" in line]


def without(lines: list[str], start: str) -> list[str]:
    return [line for line in lines if not line.startswith(start)]


def test_a_widened_constant_is_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The reply with data ID A has 9 fields of 8 bits. All alarms after the constant are at other bits of it."""
    edit(folder / "sma21.yaml", ("printed_name: ENID2, bits: 8,", "printed_name: ENID2, bits: 16,"))
    (problem,) = disagreements(capsys)
    assert problem.startswith("bits of 'identification_reply': 80 here, 72 in sma21.second.yaml:")


@pytest.mark.slow
def test_a_difference_in_another_frame_stays(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edit(
        folder / "sma21.yaml",
        ("printed_name: ENID2, bits: 8,", "printed_name: ENID2, bits: 16,"),
        ("max_hz: 10000000, source", "max_hz: 5000000, source"),
    )
    problems = disagreements(capsys)
    assert len(problems) == 2
    assert problems[0].startswith("highest clock over BiSS: 5000000 Hz here, 10000000 Hz in sma21.second.yaml:")


@pytest.mark.slow
def test_a_printed_name_that_differs_everywhere_is_one_problem(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is the printed name of a bit and of an alarm, and an entry of the contents."""
    edit(
        folder / "sma21.yaml",
        ("printed_name: Overspeed", "printed_name: Speed limit"),
        ("Overspeed: 41", "Speed limit: 41"),
    )
    (problem,) = disagreements(capsys)
    assert ": speed limit here, overspeed in sma21.second.yaml:" in problem
    assert re.search(
        rf" more with the same cause in line \d+, line \d+ of sma21\.second\.yaml{re.escape(MEND)}$", problem
    )


@pytest.mark.slow
def test_texts_of_an_example_that_is_gone_are_one_problem_in_the_second_reading(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / "sma21.yaml").read_text(encoding="utf-8")
    start = text.index("  - {name: profile_id_2_um, kind: register")
    end = text.index("  - {name: profile_id_1_um", start)
    (folder / "sma21.yaml").write_text(text[:start] + text[end:], encoding="utf-8")
    (problem,) = disagreements(capsys)
    assert problem.startswith("numbers in examples.profile_id_2_um.source: 6.4 here, nothing in sma21.yaml")
    assert problem.endswith("; remove entries for texts that the spec no longer has")


@pytest.mark.slow
def test_revision_and_date_of_an_edition_are_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edit(folder / "sma21.second.yaml", ('revision: "1.2"\n  date: 2024-05-10', 'revision: "1.1"\n  date: 2023-11-10'))
    (problem,) = disagreements(capsys)
    assert problem.startswith("revision of the edition 'it': 1.2 here, 1.1 in sma21.second.yaml:")
    assert re.search(rf", and 1 more with the same cause in line \d+{re.escape(MEND)}$", problem)


AM36_COPIED = ("manufacturer.yaml", "am36.yaml", "am36.second.yaml", "am36.words.yaml")
#: Edits of the AM36 after which each disagreement of a kind has the same cause, and the number of the others.
ONE_CAUSE = {
    "a wait in the register and in all procedures": (
        [("at_least_ms: 30", "at_least_ms: 50"), ("at_least_us: 30000", "at_least_us: 50000")],
        "delay after a write of register 0x48: 50 ms here, 30 ms in ",
    ),
    "a supply in volts, millivolts and at two contacts": (
        [
            ("min_mv: 10000", "min_mv: 5000"),
            ("+10VDC +30VDC}", "+5VDC +30VDC}"),
            ("quantity: supply, min: 10,", "quantity: supply, min: 5,"),
            ("value: +10 V DC", "value: +5 V DC"),
            ("+10 V to +30 V.", "+5 V to +30 V."),
        ],
        "supply: 5000 to 30000 mV here, 10000 to 30000 mV in ",
    ),
    "two colours exchanged": (
        [
            ("{contact: White, signal: Zero setting/Preset}", "{contact: Grey, signal: Zero setting/Preset}"),
            ("{contact: Grey, signal: Counting direction}", "{contact: White, signal: Counting direction}"),
        ],
        "contact ",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("edits", "start"), ONE_CAUSE.values(), ids=ONE_CAUSE)
def test_one_change_of_a_manual_is_one_disagreement(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    edits: list[tuple[str, str]],
    start: str,
) -> None:
    for name in AM36_COPIED:
        shutil.copy(SPECS / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    edit(tmp_path / "am36.yaml", *edits)
    main(["check", "am36.yaml"])
    lines = capsys.readouterr().out.splitlines()
    texts = [line.partition(" readings-disagree: ")[2] for line in lines if " readings-disagree: " in line]
    about_change = [text for text in texts if not text.startswith("numbers in errata.")]
    assert len(about_change) == 1, texts
    assert about_change[0].startswith(start)


@pytest.mark.slow
def test_a_row_that_a_table_no_longer_has_is_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """SMA21 4.10 and 8: without the resolution of 10 µm, the later rows of both tables move up."""
    lines = (folder / "sma21.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    rows = [line for line in lines if line.lstrip().startswith("- [SMA21") and "-0010-" in line]
    assert len(rows) == 2
    edit(folder / "sma21.yaml", *((row, "") for row in rows))
    found = disagreements(capsys)
    assert len(found) == 2
    assert found[0].startswith("the table 'speeds': 4 rows here, 5 rows in sma21.second.yaml:")
    assert found[1].startswith("the table 'ab_signals': 4 rows here, 5 rows in sma21.second.yaml:")
    assert all("more with the same cause" in problem for problem in found)


@pytest.mark.slow
def test_a_wrong_cell_next_to_a_missing_row_stays(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = (folder / "sma21.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    (row,) = [line for line in lines if line.lstrip().startswith("- [SMA21-xxx-0010-")]
    edit(folder / "sma21.yaml", (row, ""), ('- [SMA21-xxx-0002-..., 2, "4.7"', '- [SMA21-xxx-0002-..., 2, "4.8"'))
    found = disagreements(capsys)
    assert len(found) == 2
    assert "column 3 of the table 'speeds': 4.8 here, 4.7 in sma21.second.yaml:" in found[1]


@pytest.mark.slow
def test_a_wider_position_of_one_model_is_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """SMA21 6.2: at 1 µm, the position has 25 bits in a field of 25. One more bit changes the frame and the limits."""
    edit(
        folder / "sma21.yaml",
        ("position_bits: 25, scd_padding_bits: 0", "position_bits: 25, scd_padding_bits: 1"),
        ("33 bits at 1 µm", "34 bits at 1 µm"),
    )
    found = [problem for problem in disagreements(capsys) if not problem.startswith("numbers in")]
    assert len(found) == 1
    assert "and 6 more with the same cause" in found[0]


@pytest.mark.slow
def test_a_text_about_another_parameter_stays(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edit(
        folder / "sma21.yaml",
        ("position_bits: 25, scd_padding_bits: 0", "position_bits: 25, scd_padding_bits: 1"),
        ("33 bits at 1 µm", "34 bits at 1 µm"),
        ("24 or 25 bits", "24 or 26 bits"),
        ("SSI word: 1 for Gray code", "SSI word: 2 for Gray code"),
    )
    found = disagreements(capsys)
    assert any(problem.startswith("numbers in parameters.ssi_gray.meaning: 2 0 here, 1 0 in ") for problem in found)


@pytest.mark.slow
def test_a_register_that_moves_is_one_problem(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Six alarms of the ASC85 are in its error register, and five procedures read it."""
    for name in ("asc85.yaml", "asc85.second.yaml"):
        shutil.copy(SPECS / name, folder)
    edit(
        folder / "asc85.yaml",
        ("address: 0x69\n    addresses: 0x69", "address: 0x6A\n    addresses: 0x6A"),
        ("register (69h)", "register"),
    )
    main(["check", "asc85.yaml"])
    lines = capsys.readouterr().out.splitlines()
    (problem,) = [line for line in lines if ": readings-disagree: register 0x69: " in line]
    assert ", and 11 more with the same cause in lines " in problem
    assert "of asc85.second.yaml; " in problem
    assert not any("alarm at register" in line or "a procedure over" in line for line in lines)
