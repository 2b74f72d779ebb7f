"""The shipped masters, the encoders of Lika, and their settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from codewheel.masters.record import Record, record
from codewheel.masters.sheet import Master, Sheet, load_masters, sheet
from codewheel.model import Device
from codewheel.order_codes.labels import UnknownOrderCode, find

ROOT = Path(__file__).parents[2]

Told = Callable[[str, str], dict[str, Any]]


@pytest.fixture(scope="session")
def masters() -> dict[str, Master]:
    found, report = load_masters()
    assert not report.problems
    return {item.name: item for item in found}


@pytest.fixture(scope="session")
def record_of(devices: Mapping[str, Device]) -> Callable[[str], Record]:
    def made(label: str) -> Record:
        """Take an order code, and after a space the answer about ASC85's 0 bit, such as ``as_printed``."""
        code, _, decided = label.partition(" ")
        answers = {"zero_bit": decided} if decided else {}
        for device in devices.values():
            try:
                return record(device, find(device, code).variant, answers=answers)
            except UnknownOrderCode:
                continue
        raise LookupError(code)

    return made


@pytest.fixture(scope="session")
def sheet_of(masters: dict[str, Master], record_of: Callable[[str], Record]) -> Callable[[str, str], Sheet]:
    return lambda master, code: sheet(masters[master], record_of(code))


@pytest.fixture(scope="session")
def told(sheet_of: Callable[[str, str], Sheet]) -> Told:
    """Return a master's settings for an order code by name."""

    def values(master: str, code: str) -> dict[str, Any]:
        found = sheet_of(master, code)
        assert not found.refusals, found.refusals
        return {item.name: item.value for item in found.settings}

    return values
