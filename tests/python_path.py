"""The generated packages on the path of processes that tests start."""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest


def python_path(folder: Path) -> str:
    """Return the value of PYTHONPATH with which a process finds the package in a folder, and its runtime."""
    return os.pathsep.join([str(folder), str(folder / "runtime")])


def import_anew(package: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Import a generated package, even if another test has imported one of the same name from another folder."""
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    return importlib.import_module(package)
