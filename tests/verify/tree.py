"""Subject of the evidence: the C headers and the Python package as generated.

The headers are generated from the present specs. ``CODEWHEEL_GENERATED`` names a folder to use instead, laid out like
``generated/``. A copy that was broken on purpose shows which check detects it.
"""

from __future__ import annotations

import functools
import importlib
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

from c_harness import devices_of, interfaces_of, write
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate as generate_c
from codewheel.targets.python.files import generate as generate_python


@functools.lru_cache
def library() -> Mapping[str, Device]:
    """The families of our specs, read once."""
    return {device.name: device for device in devices_of()}


@functools.lru_cache
def interfaces() -> Mapping[str, Device]:
    """Return each family with only one of its interfaces, as in C, by the stem of its headers."""
    return interfaces_of(library().values())


def generated_tree(folder: Path) -> Path:
    """Return a folder with ``c/include`` and ``python``, written to ``folder`` unless the environment names one."""
    existing = os.environ.get("CODEWHEEL_GENERATED")
    if existing:
        return Path(existing).resolve()
    ours = Library(tuple(library().values()))
    for name, text in {**generate_c(ours), **generate_python(ours)}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def package_of(device: Device, folder: Path) -> ModuleType:
    """Import the package of a device's manufacturer from the Python packages in ``folder``."""
    for path in sorted(project.parent for project in folder.rglob("pyproject.toml")):
        if str(path) not in sys.path:
            sys.path.insert(0, str(path))
    return importlib.import_module(device.manufacturer.python_package)


def include_of(device: Device, folder: Path) -> Path:
    """Return the include folder for a device: of the library's families, or of a made-up device."""
    if device.name in library():
        return (
            (Path(os.environ["CODEWHEEL_GENERATED"]).resolve() if "CODEWHEEL_GENERATED" in os.environ else folder)
            / "c"
            / "include"
        )
    return write(folder / device.name, (device,))


def number_from_environment(name: str, default: int) -> int:
    """Return an amount of the evidence, which can be set from outside."""
    return int(os.environ.get(name, default))
