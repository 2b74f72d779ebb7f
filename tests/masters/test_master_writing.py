"""Conditions of writing, with the values and words of the masters' documents."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.masters.places_and_writing import WriteCondition, WriteEffect
from codewheel.masters.sheet import SettingsSheet

SheetOf = Callable[[str, str], SettingsSheet]


def rules_about(settings_sheet: SettingsSheet, name: str) -> list[WriteCondition]:
    return [rule for rule in settings_sheet.writing if name in rule.of]


def effects(rules: list[WriteCondition]) -> list[WriteEffect]:
    return [rule.takes_effect for rule in rules if rule.takes_effect is not None]


def test_supply_of_el5042(sheet_of: SheetOf) -> None:
    """infosys el5042/12438243083: F008 must hold 72657375h ("user"), INIT adopts 8008:12. The default is 5.0 V (50)."""
    for code in ("AMM5A21/65KSC1", "SMA21-SC4-0050"):
        settings_sheet = sheet_of("beckhoff_el5042", code)
        voltage = next(setting for setting in settings_sheet.settings if setting.name == "Supply Voltage")
        assert (voltage.at, voltage.value, voltage.is_default) == ("8008:12", 50, True)
        rules = rules_about(settings_sheet, "Supply Voltage")
        assert [(write.object, write.value) for rule in rules for write in rule.needs] == [
            ("F008", int.from_bytes(b"user", "little"))
        ]
        assert effects(rules) == [WriteEffect(in_state="INIT")]


def test_mode_of_el5042_comes_first(sheet_of: SheetOf) -> None:
    """Mode sets CRC Polynomial and Disable Status Bits by itself, so both are written after it."""
    rules = [rule for rule in sheet_of("beckhoff_el5042", "AMM5A21/65KBG1").writing if rule.after]
    assert [(rule.of, rule.after) for rule in rules] == [(("Disable Status Bits", "CRC Polynomial"), ("Mode",))]


@pytest.mark.parametrize(
    ("master", "code", "name", "effect"),
    [
        # W524, A-28: Y is effective after restart. A-49: 5005 hex has Y.
        ("omron_nx", "AM3619/4096-GG", "Valid Data Length", WriteEffect(restart_of="the NX Unit")),
        ("ti_c2000", "AMM5A21/65KSC1", "positionSTBits", WriteEffect(by_call="PM_bissc_initParams")),
        ("ti_motor_control_sdk", "AMM5A21/65KSC1", "Clock, in MHz", WriteEffect(by_call="bissc_clock_config")),
        ("linuxcnc_hostmot2", "AMM5A21/65KSC1", "biss_chan_0", WriteEffect(by_call="loadrt for the board driver")),
        ("linuxcnc_hostmot2", "AMM5A21/65KBG1", "ssi_chan_0", WriteEffect(by_call="loadrt for the board driver")),
        ("kollmorgen_akd", "AMM5A21/65KSC1", "FB1.SELECT", WriteEffect(restart_of="the drive")),
    ],
)
def test_when_it_takes_effect(sheet_of: SheetOf, master: str, code: str, name: str, effect: WriteEffect) -> None:
    assert effects(rules_about(sheet_of(master, code), name)) == [effect]


def test_of_all_settings(sheet_of: SheetOf) -> None:
    """moteus changes values immediately. The dsPIC33A has CLCHCFG at 1 for BiSS C, and ON and INIT at the end."""
    (at_once,) = sheet_of("moteus", "AMM5A21/65KSC1").writing
    assert (at_once.of, at_once.takes_effect) == ((), WriteEffect(at_once=True))
    settings_sheet = sheet_of("microchip_dspic33a", "AMM5A21/65KSC1")
    needs, then = settings_sheet.shared_writing
    assert [(write.object, write.value) for write in needs.needs] == [("CLCHCFGx", 1)]
    assert [(write.object, write.value) for write in then.then] == [("ON", 1), ("INIT", 1)]
    assert then.text == "After writing all settings, set ON (B1CON) to 1 and INIT (B1INSTR) to 1."


def test_an_order_names_only_settings_of_the_sheet(sheet_of: SheetOf) -> None:
    """CRCPOLYx is not a setting for a polynomial that CRCLENx selects."""
    rules = rules_about(sheet_of("microchip_dspic33a", "AMM5A21/65KSC1"), "SCDENx")
    assert [rule.after for rule in rules] == [("SCDLENx", "CRCSELx", "CRCLENx")]


def test_what_is_printed(capsys: pytest.CaptureFixture[str], pages: dict[str, str]) -> None:
    sentences = [
        "50 is the factory default. Write it only if the setting was changed.",
        "Before writing Supply Voltage, F008 (Code word) must be 0x72657375.",
        "Supply Voltage takes effect only in the INIT state.",
        "Write Disable Status Bits and CRC Polynomial after Mode. ",
    ]
    assert main(["master", "AMM5A21/65KSC1", "--master", "beckhoff_el5042"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    page = pages["docs/amm5-biss-masters.md"]
    for sentence in sentences:
        assert sentence in out
        assert sentence in page
    assert "All settings take effect immediately." in page


def test_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["master", "AMM5A21/65KSC1", "--master", "beckhoff_el5042", "--json"]) == 0
    master_data: dict[str, Any] = json.loads(capsys.readouterr().out)["masters"][0]
    voltage = next(setting for setting in master_data["settings"] if setting["name"] == "Supply Voltage")
    assert voltage["value"] == 50
    defaults = [(setting_place["default"], setting_place["is_default"]) for setting_place in voltage["places"]]
    assert defaults == [(50, True), (50, True)]
    voltage_rules = [rule for rule in master_data["writing"] if rule["of"] == ["Supply Voltage"]]
    assert [write["value"] for rule in voltage_rules for write in rule["needs"]] == [0x72657375]
    assert [rule["takes_effect"]["in_state"] for rule in voltage_rules if rule["takes_effect"]] == ["INIT"]
