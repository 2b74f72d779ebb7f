"""Find the settings that hold for the current folder.

The nearest file with settings holds, in the current folder or above it, but not above the repository that the current
folder is in. Every command looks for it, so settings that were read before are kept, and the parsers are imported only
for new ones.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from ..cache import Cache
from ..language.files import CONFIGURATION, REPOSITORY, is_spec
from ..typed import fits
from .configuration import PYPROJECT, SETTINGS, Configuration, Faulty, exists, settings_in

#: Text that a pyproject.toml with the section must contain. Others are not parsed.
_NEEDED = b"tool.codewheel"
#: Kind of entry in the cache for settings without errors.
_KIND = "configuration"


def configuration_above(cache: Cache) -> Configuration | None:
    """Return the settings that hold for the current folder, or None if there are none.

    Raises:
        Faulty: There are errors in the settings.
    """
    for folder in _folders_above():
        files = [path for path in (folder / PYPROJECT, folder / CONFIGURATION) if _has_settings(path)]
        if len(files) > 1:
            raise Faulty(*files)
        if files:
            configuration = _known(files[0], cache)
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


def _known(file: Path, cache: Cache) -> Configuration | None:
    """Return the settings in a file from the cache, or read them. None if the file has no settings.

    Raises:
        Faulty: There are errors in the settings.
    """
    try:
        content: list[bytes | str] = [file.name, file.read_bytes()]
    except OSError:
        raise Faulty(file) from None
    cached_settings = cache.get(_KIND, content)
    if fits(cached_settings, dict[str, list[str]]) and cached_settings.keys() == SETTINGS:
        settings = settings_in(file, cached_settings)
        if all(map(exists, settings.specs)):
            return settings
    from .configuration_file import read_configuration

    read_settings = read_configuration(file)
    if read_settings is None:
        return None
    cache.put(_KIND, content, read_settings)
    return settings_in(file, read_settings)
