"""The user's settings: the section ``[tool.codewheel]`` of a ``pyproject.toml``, or a file ``codewheel.yaml``.

Both have the same keys.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

PYPROJECT = "pyproject.toml"
SETTINGS = frozenset(("specs", "output", "targets"))


class Faulty(Exception):
    """There are errors in the settings. ``files`` are those next to each other that have settings."""

    def __init__(self, *files: Path) -> None:
        super().__init__(*map(str, files))
        self.files = files


@dataclass(frozen=True, slots=True)
class Configuration:
    """The settings in a file.

    Attributes:
        file: The file.
        specs: Paths of specs, relative to the current folder. Empty if the file lists none.
        output: The output folder, or None for the default.
        targets: Names of the targets to write. Empty for the default.
    """

    file: Path
    specs: tuple[Path, ...] = ()
    output: Path | None = None
    targets: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """Folder to which the paths in the file are relative."""
        return self.file.parent


def exists(path: Path) -> bool:
    """Return True if there is something at a path."""
    with suppress(OSError, ValueError):
        return os.path.lexists(path)
    return False


def settings_in(file: Path, values: Mapping[str, list[str]]) -> Configuration:
    """Return the settings with these values, lists of texts by their keys. An empty list means that there are none."""
    output = next((file.parent / text for text in values["output"]), None)
    specs = tuple(file.parent / text for text in values["specs"])
    return Configuration(file, specs, output, tuple(values["targets"]))
