"""The fictional encoder of docs/transcribe/how-to-transcribe.md: its spec and all outputs, generated once."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device

DOCS = Path(__file__).resolve().parents[2] / "docs"
EXAMPLE = DOCS / "example"


@pytest.fixture(scope="session")
def device() -> Device:
    devices, report = load_library([EXAMPLE])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    assert [device.name for device in devices] == ["tv62"]
    return devices[0]


@pytest.fixture(scope="session")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the output of all four targets, written by the command line."""
    folder = tmp_path_factory.mktemp("fictional")
    assert main(["generate", str(EXAMPLE), "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="session")
def tv62(generated: Path) -> Iterator[ModuleType]:
    """The generated Python module, imported from its own folder."""
    sys.path.insert(0, str(generated / "python"))
    importlib.invalidate_caches()
    try:
        yield importlib.import_module("tolvarn_encoders.tv62")
    finally:
        sys.path.remove(str(generated / "python"))
