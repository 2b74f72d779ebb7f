"""The shipped masters, the encoders of Lika, and their settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import Master, SettingsSheet, load_masters, sheet
from codewheel.model import Device
from codewheel.order_codes.labels import UnknownOrderCode, find_code

ROOT = Path(__file__).parents[2]

ValuesOf = Callable[[str, str], dict[str, Any]]


@pytest.fixture(scope="session")
def masters() -> dict[str, Master]:
    masters, report = load_masters()
    assert not report.problems
    return {master.name: master for master in masters}


@pytest.fixture(scope="session")
def record_of(devices: Mapping[str, Device]) -> Callable[[str], EncoderFacts]:
    def record_of_label(label: str) -> EncoderFacts:
        """Take an order code, and after a space the answer about ASC85's 0 bit, such as ``as_printed``."""
        code, _, decided = label.partition(" ")
        answers = {"zero_bit": decided} if decided else {}
        for device in devices.values():
            try:
                return facts_of_order_code(device, find_code(device, code).variant, answers=answers)
            except UnknownOrderCode:
                continue
        raise LookupError(code)

    return record_of_label


@pytest.fixture(scope="session")
def sheet_of(
    masters: dict[str, Master], record_of: Callable[[str], EncoderFacts]
) -> Callable[[str, str], SettingsSheet]:
    return lambda master, code: sheet(masters[master], record_of(code))


@pytest.fixture(scope="session")
def values_of(sheet_of: Callable[[str, str], SettingsSheet]) -> ValuesOf:
    """Return a master's settings for an order code by name."""

    def setting_values(master: str, code: str) -> dict[str, Any]:
        settings_sheet = sheet_of(master, code)
        assert not settings_sheet.refusals, settings_sheet.refusals
        return {setting.name: setting.value for setting in settings_sheet.settings}

    return setting_values
