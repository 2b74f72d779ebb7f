"""Verdicts of named values and combinations on the pages, on the terminal, and in the data."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets.docs.verdict_page import page_values

TESTS = Path(__file__).resolve().parents[1]
ENCODERS = TESTS.parent / "specs"
MT6701 = ENCODERS / "magntek" / "mt6701.yaml"


def device_of(path: Path) -> Device:
    devices, report = load_library([path, path.parent / "manufacturer.yaml"])
    assert not report
    (device,) = devices
    return device


def test_the_page_of_verdicts_lists_values_and_combinations() -> None:
    rows = page_values(device_of(TESTS / "specs" / "signs.yaml"))["decides_rows"]
    conditions = {row[2].partition("<br>")[0]: row[3:5] for row in rows}
    assert conditions["`light_dark`"] == ("`light` is 3 (`dark`)", "✕ **not usable**")
    assert conditions["`light_good`"] == ("`light` is 0 (`good`)", "✓ usable")
    combination = "`increasing` is 1 and `decreasing` is 1"
    assert conditions["`field_out_of_range`"] == (combination, "▲ usable with a warning")
    # The flag is active low.
    three = "`quality` is 1 (`fair`) and `moving` is 1 and `cold` is 1"
    assert conditions["`fair_while_moving`"] == (three, "✕ **not usable**")


def test_a_verdict_of_a_value_links_to_the_erratum_about_its_field() -> None:
    rows = page_values(device_of(MT6701))["decides_rows"]
    errata = {row[2]: row[6] for row in rows}
    assert "status_and_position" in errata["`field_too_weak`"]


def test_decode_shows_the_value_that_decides(capsys: pytest.CaptureFixture[str]) -> None:
    """Position 1000, a field that is too weak (2), and the CRC 0, which is correct for these bits."""
    assert main(["decode", "MT6701", "0xfa080", "--specs", str(ENCODERS)]) == 3
    lines = capsys.readouterr().out.splitlines()
    assert "  - field_too_weak: The magnetic field is too weak to measure the angle" in lines
    assert "so the position is not usable" in lines


def test_the_data_have_both(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "signs", "--json", "--specs", str(TESTS / "specs")]) == 0
    layouts = {layout["name"]: layout for layout in json.loads(capsys.readouterr().out)["layouts"]}
    (combination,) = layouts["word"]["combinations"]
    assert combination["when"] == ["increasing.active", "decreasing.active"]
    assert combination["makes_position"] == "usable_with_warning"
    quality = next(field for field in layouts["gray_word"]["fields"] if field["name"] == "quality")
    assert {value["name"]: value["makes_position"] for value in quality["values"]} == {
        "good": "",
        "fair": "",
        "poor": "usable_with_warning",
        "none": "not_usable",
    }
