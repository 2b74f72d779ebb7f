"""The library of the specs that ship with the tool, and one whose texts try to break out of every output."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from codewheel.load import load_library
from codewheel.model import Device
from codewheel.targets import Library

SPECS = Path(__file__).parents[2] / "specs"
HOSTILE = "a -- b --> c ]]> d | e <script>alert(1)</script> &amp; \"f\" 'g' `h` [i](j) ${k} *l* é − <!-- m -"

#: Members that are running text in the spec language; the others are words that schema and rules restrict.
_TEXTS = {
    "title", "meaning", "note", "printed_name", "when_active", "when_inactive", "printed", "used", "why", "content", "changes", "signal", "contact", "only",
    "remedy", "detected", "precondition", "result", "mating", "publisher", "special", "signals", "profile", "symbol", "unit", "state", "argument_meaning",
    "where",
}


@pytest.fixture(scope="session")
def devices() -> tuple[Device, ...]:
    found, report = load_library([SPECS])
    assert not report.problems, report.problems[0].format()
    return found


@pytest.fixture(scope="session")
def library(devices: tuple[Device, ...]) -> Library:
    return Library(devices)


@pytest.fixture(scope="session")
def device(devices: tuple[Device, ...]) -> Device:
    return next(item for item in devices if item.name == "amm5")


@pytest.fixture(scope="session")
def hostile(devices: tuple[Device, ...]) -> Library:
    """Every running text of every device replaced by one that holds the marks of all output languages."""
    return Library(tuple(_spoilt(item) for item in devices))


def _spoilt(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        changes = {}
        for item in dataclasses.fields(value):
            old = getattr(value, item.name)
            is_text = isinstance(old, str) and bool(old) and (item.name in _TEXTS or (item.name == "value" and type(value).__name__ == "Characteristic"))
            changes[item.name] = HOSTILE if is_text else _spoilt(old)
        return dataclasses.replace(value, **changes)
    if isinstance(value, tuple):
        return tuple(map(_spoilt, value))
    if isinstance(value, Mapping):
        return {key: _spoilt(item) for key, item in value.items()}
    return value
