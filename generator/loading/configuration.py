"""The user's settings: the section ``[tool.codewheel]`` of a ``pyproject.toml``, or a file ``codewheel.yaml``.

Both have the same keys.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

PYPROJECT = "pyproject.toml"
#: Built-in targets, in the order in which they are listed and run. They run by default, registered ones only on
#: request.
BUILT_IN = ("python", "c", "biss", "docs", "browser", "masters")


class Faulty(Exception):
    """There are errors in the settings. ``files`` are the files with settings in one folder."""

    def __init__(self, *files: Path) -> None:
        super().__init__(*map(str, files))
        self.files = files


@dataclass(frozen=True, slots=True)
class FamilyFilter:
    """Condition for the families that a target writes.

    Attributes:
        families: Names of the families. Empty for all.
        grades: Grades of their evidence. Empty for all.
    """

    families: tuple[str, ...] = ()
    grades: tuple[str, ...] = ()

    def accepts(self, family: str, grade: str) -> bool:
        """Return True if a family with this grade meets both conditions."""
        return (not self.families or family in self.families) and (not self.grades or grade in self.grades)


#: The condition of each target with a condition, by the name of the target.
FamilyFilters = Mapping[str, FamilyFilter]
NO_FILTERS: FamilyFilters = MappingProxyType({})


def filters_as_texts(filters: FamilyFilters) -> list[str]:
    """Return the conditions as texts, for the key of a stored result."""
    texts = []
    for target, family_filter in sorted(filters.items()):
        texts += [target, "families", *family_filter.families, "grades", *family_filter.grades, ""]
    return texts


@dataclass(frozen=True, slots=True)
class Configuration:
    """The settings in a file.

    Attributes:
        file: The file.
        specs: Paths of specs, relative to the current folder. Empty if the file lists none.
        output: The output folder, or None for the default.
        targets: Names of the targets to write. Empty for the default.
        only: Conditions for the families that targets write to the output folder.
    """

    file: Path
    specs: tuple[Path, ...] = ()
    output: Path | None = None
    targets: tuple[str, ...] = ()
    only: FamilyFilters = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Folder to which the paths in the file are relative."""
        return self.file.parent


def exists(path: Path) -> bool:
    """Return True if there is a value at a path."""
    with suppress(OSError, ValueError):
        return os.path.lexists(path)
    return False
