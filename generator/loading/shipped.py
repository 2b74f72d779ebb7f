"""Folders of the specs that ship with the tool."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path


def packaged_specs() -> Path:
    """Return the folder of the specs that ship with the tool. In an editable install this is ``specs``."""
    return Path(import_module("codewheel.specs").__path__[0])


def packaged_masters() -> Path:
    """Return the folder of the master descriptions that ship with the tool."""
    return packaged_specs() / "masters"


def packaged_families() -> list[Path]:
    """Return the folders of the families that ship with the tool, one for each manufacturer."""
    folders = [path for path in packaged_specs().iterdir() if path.is_dir() and path != packaged_masters()]
    return sorted(folder for folder in folders if any(folder.glob("*.yaml")))
