"""What the tests share: the library of our specs, and the generated Python package."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from codewheel.load import load_library
from codewheel.model import Device
from codewheel.targets import Library

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def library() -> Library:
    """Everything that ``specs/`` describes."""
    devices, report = load_library([ROOT / "specs"])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    return Library(devices)


@pytest.fixture(scope="session")
def devices(library: Library) -> Mapping[str, Device]:
    return {device.name: device for device in library.devices}


@pytest.fixture(scope="session")
def vectors() -> list[dict[str, Any]]:
    """Frames and CRCs that others have published, each with its source."""
    rows: list[dict[str, Any]] = json.loads((ROOT / "tests" / "vectors.json").read_text(encoding="utf-8"))
    return rows


@pytest.fixture(scope="session")
def import_generated(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Library, str], tuple[Path, ModuleType]]:
    """Writes the Python package of a library to a folder of its own and imports it; gives the folder and the package."""
    from codewheel.targets.python import generate

    def made(library: Library, package: str) -> tuple[Path, ModuleType]:
        folder = tmp_path_factory.mktemp("generated")
        for path, text in generate(library).items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        for name in [name for name in sys.modules if name.partition(".")[0] == package]:
            del sys.modules[name]
        sys.path.insert(0, str(folder / "python"))
        importlib.invalidate_caches()
        try:
            imported = importlib.import_module(package)
        finally:
            sys.path.remove(str(folder / "python"))
        return folder / "python", imported

    return made


@pytest.fixture(scope="session")
def generated_python(library: Library, import_generated: Callable[[Library, str], tuple[Path, ModuleType]]) -> tuple[Path, ModuleType]:
    """The folder of the generated package, and the package."""
    return import_generated(library, "lika_encoders")
