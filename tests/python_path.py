"""The generated packages on the path of processes that tests start."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import pytest


def python_path(folder: Path) -> str:
    """Return the value of PYTHONPATH with which a process finds the package in a folder, and its runtime."""
    return os.pathsep.join([str(folder), str(folder / "runtime")])


def import_anew(package: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Import a generated package, even if another test has imported a package of the same name from another folder."""
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    return importlib.import_module(package)


@contextmanager
def new_packages() -> Iterator[None]:
    """Import generated packages anew inside. Afterwards, those that other tests have imported are found again."""
    older_modules = _generated_modules()
    _forget(older_modules)
    try:
        yield
    finally:
        _forget(_generated_modules())
        sys.modules.update(older_modules)


def _generated_modules() -> dict[str, ModuleType]:
    return {name: module for name, module in sys.modules.items() if name.partition(".")[0].endswith("_encoders")}


def _forget(modules: Iterable[str]) -> None:
    for name in modules:
        del sys.modules[name]
