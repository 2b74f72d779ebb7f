"""Owners of an output: the families that it was written from, so that nothing is removed by accident.

The list of each target's folder records them. An output contains pages and tables of all families, so it is written
from all of its families or not at all. The lists of earlier versions have no record. Then the owner of a file follows
from its name, which contains the name of a family, a manufacturer or a Python package.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .say.numbers import counted, first_of
from .write import Change, WriteError, families_in

if TYPE_CHECKING:
    from .model import Device

_MOST_SHOWN = 5
#: Parts of the names of files that belong to no family.
_SHARED = frozenset(("codewheel", "codewheel_runtime", "runtime"))
_WORD = re.compile(r"[a-z0-9_]+")
#: Start of a family's data in the script of the decode page, which has no file of its own for each family.
_TEXT = r'"(?:[^"\\]|\\.)*"'
_IN_THE_PAGE = re.compile(rf'\{{"name":"([a-z][a-z0-9_]*)","title":{_TEXT},(?:"special_codes":{_TEXT},)?"evidence":')
_PAGE = "decode.js"


def owners(devices: Iterable[Device]) -> list[str]:
    """Return the families as ``manufacturer/family``. Special models and other editions belong to their family."""
    return sorted(f"{device.manufacturer.name}/{device.name}" for device in devices if not device.base)


@dataclass(frozen=True, slots=True)
class Guard:
    """Check that a run removes and replaces nothing that belongs to families that it did not read.

    Attributes:
        folder: The output folder.
        devices: The families that were read.
        files: The specs that were read.
        has_all: True if all of the user's specs were read, so that a missing family no longer has a spec.
        everything: The command that reads all of the user's specs, for messages.
    """

    folder: Path
    devices: Sequence[Device]
    files: Sequence[str]
    has_all: bool
    everything: str

    def check(self, changes: Mapping[str, Sequence[Change]]) -> None:
        """Check the changes of each target.

        Raises:
            WriteError: Files of others would be removed or replaced, or a spec is in a folder that is written.
        """
        self._refuse_specs_inside(changes)
        foreign: set[str] = set()
        files: list[str] = []
        for target, found in changes.items():
            recorded = families_in(self.folder / target)
            if recorded:
                missing = self._missing(recorded)
                foreign |= missing
                names = {word for name in missing for word in name.split("/")} - self._names()
                files += [item.path for item in found if item.what == "removed" and _has_name(item.path, names)]
            else:
                unread, others = self._without_record(found)
                foreign |= unread
                files += others
        if foreign or files:
            raise WriteError(self._message(sorted(foreign), sorted(files)))

    def _missing(self, recorded: Collection[str]) -> set[str]:
        """Return the recorded families that were not read, except those whose spec is gone."""
        read = owners(self.devices)
        makers = {name.partition("/")[0] for name in read}
        missing = set(recorded) - set(read)
        return {name for name in missing if not self.has_all or name.partition("/")[0] not in makers}

    def _without_record(self, changes: Iterable[Change]) -> tuple[set[str], list[str]]:
        """Return the families and the files that an earlier version wrote and that cannot belong to those read."""
        ours = self._names() | _SHARED
        foreign: set[str] = set()
        files: list[str] = []
        for change in changes:
            if change.what == "removed" and not _has_name(change.path, ours):
                files.append(change.path)
            elif change.what == "written" and change.path.endswith(f"/{_PAGE}"):
                foreign |= set(_IN_THE_PAGE.findall(_text(self.folder / change.path))) - ours
        return foreign, files

    def _names(self) -> set[str]:
        """Return the names of the families read, of their manufacturers, and of their packages."""
        makers = {device.manufacturer for device in self.devices}
        names = {device.name for device in self.devices}
        return names | {maker.name for maker in makers} | {maker.python_package for maker in makers}

    def _message(self, foreign: Sequence[str], files: Sequence[str]) -> str:
        shown = first_of([(self.folder / path).as_posix() for path in files], _MOST_SHOWN)
        whose = f"outputs of {', '.join(foreign)}" if foreign else "outputs of other specs"
        example = f" ({counted(len(files), 'file')}: {shown})" if files else ""
        return (
            f"{self.folder.as_posix()} has {whose}, which were not read{example}. Nothing has changed. Read these "
            f"specs too ({self.everything}), write elsewhere with -o, or drop these outputs with --prune"
        )

    def _refuse_specs_inside(self, targets: Iterable[str]) -> None:
        """Refuse to write a folder that contains a spec, because no later run would search it for specs.

        Raises:
            WriteError: There is such a spec.
        """
        for target in targets:
            place = os.path.join(os.path.realpath(self.folder / target), "")
            for file in self.files:
                if os.path.realpath(file).startswith(place):
                    wrong = f"the spec {file} is in {(self.folder / target).as_posix()}, which generate writes"
                    raise WriteError(f"{wrong}; nothing has changed; choose another output folder with -o")


def _has_name(path: str, names: Collection[str]) -> bool:
    """Return True if a word in a path is one of the names, or begins with one, such as ``demo_biss``."""
    beginnings = tuple(f"{name}_" for name in names)
    return any(f"{word}_".startswith(beginnings) for word in _WORD.findall(path.lower()))


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
