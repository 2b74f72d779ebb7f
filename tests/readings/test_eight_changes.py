"""Eight changes of a manual that were carried into the data of a spec, but not into its texts and its second reading.

``check`` names what the changes leave behind, one problem for each cause, and few problems with the second reading.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import main

SPECS = Path(__file__).parents[2] / "specs" / "lika"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the SMA21, whose 2 µm models an invented edition 1.3 removes."""
    for name in ("manufacturer.yaml", "sma21.yaml", "sma21.second.yaml"):
        shutil.copy(SPECS / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def change(file: Path, *changes: tuple[str, str]) -> None:
    """Replace regular expressions in a file. Each must occur."""
    text = file.read_text(encoding="utf-8")
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, flags=re.MULTILINE)
        assert count, pattern
    file.write_text(text, encoding="utf-8")


def problems(capsys: pytest.CaptureFixture[str]) -> list[str]:
    main(["check", "sma21.yaml"])
    lines = capsys.readouterr().out.splitlines()
    return [line for line in lines if re.match(r"sma21(\.second)?\.yaml:\d+", line)]


CHANGES = (
    (r'revision: "1\.2"\n  date: 2024-05-10', 'revision: "1.3"\n  date: 2026-11-12'),
    (r"name: sine_cosine_resolution$", "name: sine_cosine_period"),
    (r"wait_at_least_ms: 30", "wait_at_least_ms: 50"),
    (r"at_most_ns: 16000", "at_most_ns: 20000"),
    (r"max_hz: 1000000,", "max_hz: 2000000,"),
    (r'        "0002":\n.*\n.*\n', ""),
    (r'\{contact: Grey, signal: "Data OUT \+ / SLO \+"\}', '{contact: Pink, signal: "Data OUT + / SLO +"}'),
    (r'\{contact: Pink, signal: "Data OUT - / SLO -"\}', '{contact: Grey, signal: "Data OUT - / SLO -"}'),
    (r"(- name: counting_direction\n        at: )6", r"\g<1>7"),
    (r"name: unused_7, at: 7,", "name: unused_6, at: 6,"),
    (r"min_mv: 5000, max_mv: 30000", "min_mv: 10000, max_mv: 30000"),
)
#: Beginnings of the messages about what the changes leave behind.
LEFT_BEHIND = (
    "the manual has revision '1.3', but its history lists 1.0, 1.1, 1.2",
    "the meaning of '4' says 5000 to 30000 mV, but here it is 10000 to 30000",
    "'SMA21-xxx-0002-...' names '0002'",
    "'SMA21-G1x-0002-...' names '0002'",
    "contact '5' and wire 'Grey' carry the same signal on another interface",
    "the text says 'The word has 21, 23, 24, 25 or 26 bits', but the frame has 21, 23, 24 or 26 bits",
    "the text lists 2 µm, but no order code has it",
    "'counting_direction' is at 7, but 6 is printed",
    "there is no register 'sine_cosine_resolution'",
    "'command' needs a wait of 50 ms after a write, but the wait here is 30 ms",
    "the text says '1 MHz', but the affected facts have",
    "the text says 16 µs, but the time here is 20 µs",
    "the text says bit 6, but 'at' of the field is 7",
    "'at_least_us' is 30000, but 'wait_at_least_ms' of 'command' is 50",
)


@pytest.mark.slow
def test_each_thing_that_the_changes_leave_behind_is_one_problem(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change(folder / "sma21.yaml", *CHANGES)
    lines = problems(capsys)
    for message in LEFT_BEHIND:
        assert len([line for line in lines if f": {message}" in line]) == 1, message
    assert len(lines) <= 17
    (resolution,) = [line for line in lines if "lists 2 µm" in line]
    assert resolution.count(",") >= 8  # The lines of nine other texts.


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        # The two bits are exchanged. Their names, defaults and values are at other bits, too.
        (
            (
                (r"(- name: counting_direction\n        at: )6", r"\g<1>7"),
                (r"name: unused_7, at: 7,", "name: unused_6, at: 6,"),
                (r"at: 6, field: counting_direction,", "at: 7, field: counting_direction,"),
                (r"at: 7, field: unused_7,", "at: 6, field: unused_6,"),
                (r'bytes: "60"', "bytes: A0"),
                (r"0x60\b", "0xA0"),
                (r"note: The value is 01100000", "note: The value is 10100000"),
                (r"used: Counting direction is bit 6", "used: Counting direction is bit 7"),
            ),
            "name of bit 6 of 'configuration': 'unused_6' here",
        ),
        # Three texts lack a number that the second reading has.
        (((r"50 µm to 2 µm", "50 µm to 5 µm"),), "numbers in interfaces.biss.profile"),
        # The clock and the two texts that repeat it.
        (
            (
                (r"max_hz: 1000000,", "max_hz: 2000000,"),
                (r"(printed: With cables .*)1 MHz", r"\g<1>2 MHz"),
            ),
            "highest clock over SSI: 2000000 Hz here, 1000000 Hz",
        ),
        # A register with another name and another printed name.
        (
            (
                (r"sine_cosine_resolution\b", "sine_cosine_period"),
                (r"names: \{it: Risoluzione SENO-COSENO\}", "names: {it: Periodo SENO-COSENO}"),
            ),
            "name of register 0x58: 'sine_cosine_period' here",
        ),
    ],
)
def test_disagreements_of_a_change_are_one_problem(
    folder: Path, capsys: pytest.CaptureFixture[str], changes: tuple[tuple[str, str], ...], message: str
) -> None:
    change(folder / "sma21.yaml", *changes)
    # A text that only the second reading has is another problem with another remedy, and so is a note in other words.
    of_data = re.compile(r"sma21\.yaml:.* readings-disagree: (?!numbers in e)")
    disagreements = [line for line in problems(capsys) if of_data.match(line)]
    assert [message in line and "with the same cause" in line for line in disagreements] == [True]
