"""Bits before the position, for masters whose documents say how to set them."""

from __future__ import annotations

import json
from typing import Any

import pytest
from codewheel.commands.cli import main

Capture = pytest.CaptureFixture[str]


def sheet_of(capsys: Capture, line: str, master: str) -> dict[str, Any]:
    main(["master", line, "--master", master, "--json"])
    (sheet,) = json.loads(capsys.readouterr().out)["masters"]
    result: dict[str, Any] = sheet
    return result


def value_of(sheet: dict[str, Any], name: str) -> object:
    return next(setting["value"] for setting in sheet["settings"] if setting["name"] == name)


def test_status_bits_that_lead_the_data(capsys: Capture) -> None:
    """Galil's note 2438: "Negative # designates status bits as leading the SSI data", and the total includes them."""
    sheet = sheet_of(capsys, "ssi,left,clock=1MHz:state=3,multiturn=12,singleturn=13", "galil_ssi")
    assert value_of(sheet, "si3") == -3
    assert value_of(sheet, "si1") == 3 + 12 + 13
    # Multi-turn bits = total - single-turn - status bits.
    assert 28 - 13 - 3 == 12
    assert any("before the position are counted as status bits" in note for note in sheet["notes"])


def test_status_bits_that_trail_the_data(capsys: Capture) -> None:
    sheet = sheet_of(capsys, "ssi,left,clock=1MHz:multiturn=12,singleturn=13,error=high,state=2", "galil_ssi")
    assert value_of(sheet, "si3") == 3


@pytest.mark.parametrize("behind", ["error=high", "state=2", "parity=even", "crc=6:0x43"])
def test_bits_on_both_sides_cannot_be_set(behind: str, capsys: Capture) -> None:
    sheet = sheet_of(capsys, f"ssi,left,clock=1MHz:life=3,position=13,{behind}", "galil_ssi")
    reasons = [refusal["reason"] for refusal in sheet["refusals"]]
    assert any(reason.startswith("Status bits either precede or follow the data") for reason in reasons)


def test_a_leading_flag_is_a_status_bit_too(capsys: Capture) -> None:
    sheet = sheet_of(capsys, "ssi,left,clock=1MHz:error=high,position=13", "galil_ssi")
    assert value_of(sheet, "si3") == -1


def test_zeros_before_the_position_count_as_revolutions(capsys: Capture) -> None:
    """KEB F6 manual p. 246: of 32 bits, "the first 8 bits are always 0", and the drive expects the overflow at 32 bits.

    So ec40 and ec41 have these 32 bits together.
    """
    for line in ("biss:zero=8,position=24,error,warning,crc=6:0x43", "ssi,clock=1MHz:zero=8,position=24"):
        sheet = sheet_of(capsys, line, "keb_f6")
        assert value_of(sheet, "Singleturn resolution") == 24
        assert value_of(sheet, "Multiturn resolution") == 32 - 24
        assert any("can only be used if its position does not pass the overflow" in note for note in sheet["notes"])
