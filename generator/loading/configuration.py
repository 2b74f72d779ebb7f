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
#: Built-in targets, in the order in which they are listed and run. They run by default. Targets of other packages only
#: run on request.
BUILT_IN = ("python", "c", "biss", "docs", "browser", "masters")


class Faulty(Exception):
    """The settings contain errors. ``files`` are the files with settings in one folder."""

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
        """Return whether a family meets both conditions. ``grade`` is the grade of its evidence."""
        accepts_family = not self.families or family in self.families
        accepts_grade = not self.grades or grade in self.grades
        return accepts_family and accepts_grade


#: The condition of each target with a condition, by the name of the target.
FamilyFilters = Mapping[str, FamilyFilter]
NO_FILTERS: FamilyFilters = MappingProxyType({})


def filters_as_texts(filters: FamilyFilters) -> list[str]:
    """Return the conditions as a list of texts, from which the key of a cached result is computed."""
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
    """Return whether there is a file, folder or link at a path. A path that is not valid does not exist."""
    with suppress(OSError, ValueError):
        return os.path.lexists(path)
    return False
