"""Find the settings that hold for the current folder.

The nearest file with settings holds, in the current folder or above it, but not above the repository that the current
folder is in. The parsers are imported only for a file with settings, because every command looks for it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from ..language.files import CONFIGURATION, REPOSITORY, is_spec
from .configuration import PYPROJECT, Configuration, Faulty

#: Text that a pyproject.toml with the section must contain. Others are not parsed.
_NEEDED = b"tool.codewheel"


def configuration_above() -> Configuration | None:
    """Return the settings that hold for the current folder, or None if there are none.

    Raises:
        Faulty: There are errors in the settings.
    """
    for folder in _folders_above():
        files = [path for path in (folder / PYPROJECT, folder / CONFIGURATION) if _has_settings(path)]
        if len(files) > 1:
            raise Faulty(*files)
        if files:
            from .configuration_file import read_configuration

            configuration = read_configuration(files[0])
            if configuration is not None:
                return configuration
        if os.path.lexists(folder / REPOSITORY):
            return None
    return None


def _folders_above() -> Iterator[Path]:
    """Yield the current folder and those above it, relative to it, so that messages have short paths."""
    try:
        above = len(Path.cwd().parents)
    except OSError:  # The current folder has been removed.
        return
    yield Path()
    for count in range(1, above + 1):
        yield Path(*[os.pardir] * count)


def _has_settings(file: Path) -> bool:
    """Return True if a file may have settings.

    Raises:
        Faulty: The file cannot be read.
    """
    if not os.path.isfile(file):
        return False
    if file.name == CONFIGURATION:
        return not is_spec(file)
    try:
        return _NEEDED in file.read_bytes()
    except OSError:
        raise Faulty(file) from None
