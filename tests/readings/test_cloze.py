"""Sheets of turning words: the gaps of a text, the sheet that is written, and each message about a filled sheet."""

from __future__ import annotations

import pathlib
import shutil

import pytest
from codewheel.commands.check.specs import check_specs
from codewheel.commands.cli import main
from codewheel.commands.cloze import Vocabulary
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from mutation.words import opposites

pytestmark = pytest.mark.slow

HERE = pathlib.Path(__file__).parent
LIKA = HERE.parents[1] / "specs" / "lika"
SPEC = """\
characteristics:
  - {name: battery, value: "The battery is on. Do not remove it before the supply is off", source: "3"}
  - {name: handling, value: With care, source: "4"}
leds:
  - name: power
    title: LED
    states:
      - {state: "on", meaning: "Supply above 4 V, or an error"}
    source: "9"
"""
#: The lines of these texts, after the 204 lines of the spec without them.
BATTERY, POWER = "twice.yaml:206:", "twice.yaml:212:"
REFILL = "run 'codewheel cloze twice' and fill it again from the manual"


@pytest.fixture
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A spec whose sheet is filled from the manual."""
    for name in ("manufacturer.yaml", "twice.yaml"):
        shutil.copy(HERE / "specs" / name, tmp_path)
    with (tmp_path / "twice.yaml").open("a", encoding="utf-8") as file:
        file.write(SPEC)
    monkeypatch.chdir(tmp_path)
    assert main(["cloze", "twice"]) == 0
    sheet = tmp_path / "twice.words.yaml"
    fill(sheet, "characteristics.battery.value", '["on", "not", "before", "off"]')
    fill(sheet, "leds.power.states.0.meaning", '["above", "error"]')
    # The texts of tests/readings/specs/twice.yaml: "First issue", "More", "1 for Gray", "After a reset", and others.
    fill(sheet, "manual.history.1.0.changes", '["first"]')
    fill(sheet, "manual.history.1.1.changes", '["more"]')
    fill(sheet, "parameters.gray.meaning", '["Gray"]')
    fill(sheet, "parameters.all_bits.meaning", '["first"]')
    fill(sheet, "interfaces.rs485.timings.settle.meaning", '["after", "reset"]')
    fill(sheet, "alarms.fault.meaning", '["error"]')
    fill(sheet, "procedures.set_preset.title", '["set"]')
    fill(sheet, "procedures.reset_all.title", '["reset"]')
    fill(sheet, "inputs.zero_input.meaning", '["set"]')
    fill(sheet, "errata.limit.why", '["not"]')
    return tmp_path


def fill(sheet: pathlib.Path, path: str, words: str) -> None:
    lines = sheet.read_text(encoding="utf-8").split("\n")
    index = lines.index(f'  "{path}":') + 2
    lines[index] = f"    words: {words}"
    sheet.write_text("\n".join(lines), encoding="utf-8")


def problem_lines() -> list[str]:
    report = check_specs([pathlib.Path()], []).report
    return [problem.format().splitlines()[0] for problem in report.problems]


def replace_in_file(path: pathlib.Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_a_filled_sheet_agrees(folder: pathlib.Path) -> None:
    assert problem_lines() == []


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        (
            "remove it before the",
            "remove it after the",
            BATTERY,
            "words-disagree: 'ttery is on. Do not remove it [order] the supply is off': 'after' here, 'before' in",
        ),
        (
            "supply is off",
            "supply is on",
            BATTERY,
            "words-disagree: 'emove it before the supply is [switch]': 'on' here",
        ),
        (
            "above 4 V",
            "below 4 V",
            POWER,
            "words-disagree: 'Supply [place] 4 V, or an error': 'below' here, 'above' in",
        ),
        ("or an error", "or a warning", POWER, "words-outdated: this text has changed since twice.words.yaml:"),
        ("Do not remove", "Do remove", BATTERY, "words-outdated: this text has changed since twice.words.yaml:"),
        (
            "With care",
            "Not with care",
            "twice.yaml:207:",
            f"words-outdated: this text is not in twice.words.yaml, and has 1 turning word; {REFILL}",
        ),
    ],
)
def test_an_opposite_word_is_found(folder: pathlib.Path, old: str, new: str, place: str, message: str) -> None:
    replace_in_file(folder / "twice.yaml", old, new)
    (line,) = problem_lines()
    assert line.startswith(place)
    assert message in line


def test_a_text_that_is_gone_is_found_in_the_sheet(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.yaml", "Supply above 4 V, or an error", "Supply")
    (line,) = problem_lines()
    assert line.startswith("twice.words.yaml:")
    assert f": words-outdated: the spec has no such text with turning words; {REFILL}" in line


def test_a_gap_must_have_a_word_of_its_kind(folder: pathlib.Path) -> None:
    fill(folder / "twice.words.yaml", "leds.power.states.0.meaning", '["?", "before"]')
    empty_gap, other_kind = problem_lines()
    assert empty_gap.endswith("words-outdated: gap 1 has '?'; valid values for place: above, below")
    assert other_kind.endswith("words-outdated: gap 2 has 'before'; valid values for report: error, warning")


def test_a_sheet_has_a_schema(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.words.yaml", 'words: ["above", "error"]', "wrds: []")
    assert [line.split(": ")[1] for line in problem_lines()] == ["unknown-key"]


def test_the_command_keeps_what_is_filled(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    replace_in_file(folder / "twice.yaml", "Supply above 4 V, or an error", "Supply below 5 V")
    assert main(["cloze", "twice"]) == 0
    assert capsys.readouterr().out == "written    twice.words.yaml: 1 gap to fill, in 12 texts\n"
    text = (folder / "twice.words.yaml").read_text(encoding="utf-8")
    assert 'words: ["on", "not", "before", "off"]' in text
    assert '    text: "Supply {1 place} 5 V"\n    words: ["?"]' in text


def test_what_is_filled_moves_with_its_text(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The new first state takes the path of the old one, whose text it does not have."""
    state = '      - {state: "on", meaning: "Supply above 4 V, or an error"}\n'
    new_state = '      - {state: "off", meaning: "Supply below 4 V"}\n'
    replace_in_file(folder / "twice.yaml", state, new_state + state)
    assert main(["cloze", "twice"]) == 0
    assert capsys.readouterr().out == "written    twice.words.yaml: 2 gaps to fill, in 14 texts\n"
    text = (folder / "twice.words.yaml").read_text(encoding="utf-8")
    assert (
        'states.1.meaning":\n    text: "Supply {1 place} 4 V, or an {2 report}"\n    words: ["above", "error"]' in text
    )


def test_a_word_that_is_missing_is_a_gap_to_fill(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    fill(folder / "twice.words.yaml", "leds.power.states.0.meaning", '["above"]')
    assert main(["cloze", "twice"]) == 0
    assert capsys.readouterr().out == "written    twice.words.yaml: 1 gap to fill, in 12 texts\n"
    assert 'words: ["above", "?"]' in (folder / "twice.words.yaml").read_text(encoding="utf-8")


def test_a_spec_without_a_sheet_needs_none(folder: pathlib.Path) -> None:
    (folder / "twice.words.yaml").unlink()
    assert problem_lines() == []


def test_a_sheet_is_not_a_spec(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "twice.words.yaml"]) == 1
    message = "word-sheet: this is a sheet of turning words; give twice.yaml, the spec that it belongs to"
    assert message in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "gaps"),
    [
        ("Never write it AFTER\na reset", ["not", "write", "after", "reset"]),
        ("Read by the master, LSB first, in Gray code", ["read", "master", "least significant", "first", "Gray"]),
        ("The encoder sends the stored multiturn position", ["send", "save", "multiturn"]),
        ("on the connector, up to the LSB", ["at most", "least significant"]),
        ("counts up with counter-clockwise rotation", ["increase", "counter-clockwise"]),
        ("At power-on, the lowest byte is high", ["on", "at least", "high"]),
        ("the notes, another onset", []),
        ("Connect 0Vb to the white wire", ["connected", "0Vb", "white"]),
    ],
)
def test_gaps_of_a_text(text: str, gaps: list[str]) -> None:
    assert [gap.word for gap in Vocabulary(["0Vb", "A"]).cloze(text).gaps] == gaps


@pytest.mark.parametrize("family", ["am36", "amm5", "asc85", "sma21"])
def test_no_gap_of_a_shipped_sheet_is_empty(family: str) -> None:
    document = read_document(LIKA / f"{family}.words.yaml", ProblemReport())
    assert document is not None
    assert not any("?" in text["words"] for text in document.data["texts"].values())


def test_opposites_that_are_planted() -> None:
    assert list(opposites("Do not use it before a reset")) == [
        "Do use it before a reset",
        "Do not use it after a reset",
        "Do not use it before a set",
    ]
    assert list(opposites("It must be read")) == ["It may be read", "It must be written", "It must not be read"]


def test_two_states_of_an_led_that_are_exchanged_are_reported(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SMA21 9.1: the LED is off if the sensor works properly, and red if there is an error."""
    for name in ("manufacturer.yaml", "sma21.yaml", "sma21.words.yaml"):
        shutil.copy(LIKA / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    assert problem_lines() == []
    replace_in_file(tmp_path / "sma21.yaml", '- {state: "off",', "- {state: red,")
    replace_in_file(tmp_path / "sma21.yaml", "- state: red\n", '- state: "off"\n')
    lines = problem_lines()
    assert len(lines) == 2
    assert all("words-outdated: this text has changed since sma21.words.yaml:" in line for line in lines)
