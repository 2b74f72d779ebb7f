"""The user's settings: the section ``[tool.codewheel]`` of a ``pyproject.toml``, or a file ``codewheel.yaml``.

Both have the same keys. The nearest of these files holds, in the current folder or above it, but not above the
repository that the current folder is in. Every command looks for it, so settings that were read before are kept, and
the parsers are imported only for new ones.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..cache import Cache
from ..language.files import CONFIGURATION, REPOSITORY, is_spec
from ..typed import fits

PYPROJECT = "pyproject.toml"
#: Text that a pyproject.toml with the section must contain. Others are not parsed.
_NEEDED = b"tool.codewheel"
#: Kind of entry in the cache for settings without errors.
_KIND = "configuration"


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
            settings = _known(files[0], cache)
            if settings is not None:
                return settings
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
    cached = cache.get(_KIND, content)
    if fits(cached, dict[str, list[str]]):
        settings = settings_in(file, cached)
        if all(map(exists, settings.specs)):
            return settings
    from .configuration_file import read_configuration

    values = read_configuration(file)
    if values is None:
        return None
    cache.put(_KIND, content, values)
    return settings_in(file, values)


def exists(path: Path) -> bool:
    """Return True if there is something at a path."""
    with suppress(OSError, ValueError):
        return os.path.lexists(path)
    return False


def settings_in(file: Path, values: Mapping[str, list[str]]) -> Configuration:
    """Return the settings with these values, which are lists of texts by their keys."""
    output = next((file.parent / text for text in values.get("output", ())), None)
    specs = tuple(file.parent / text for text in values.get("specs", ()))
    return Configuration(file, specs, output, tuple(values.get("targets", ())))
