"""Decide whether ``generate`` may remove or replace outputs: those of families that it has not read are kept.

A run removes no outputs of families that it has not read, unless there is ``--prune``. Outputs contain pages and tables
about all families, so they must be written from all families or not at all. The list in each target's folder records
the families that it was written from. Lists of earlier versions do not record them. Then a file belongs to a family if
its name contains the name of the family. Which files are no longer outputs is decided in
``write_and_remove.list_changes``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from ...model import Device
from ...output_folder import WriteError, families_in
from ...say import count_with_unit, first_of
from ...write_and_remove import FileChange
from ..outputs import owners

_MOST_SHOWN = 5
#: Parts of the names of files that belong to no family.
_SHARED_NAME_PARTS = frozenset(("codewheel", "codewheel_runtime", "runtime"))
_WORD_IN_PATH = re.compile(r"[a-z0-9_]+")
#: Start of a family's data in the script of the decode page, which has no file of its own for each family.
_TEXT = r'"(?:[^"\\]|\\.)*"'
_FAMILY_IN_DECODE_PAGE = re.compile(
    rf'\{{"name":"([a-z][a-z0-9_]*)","title":{_TEXT},(?:"special_codes":{_TEXT},)?"evidence":'
)
_DECODE_PAGE = "decode.js"


@dataclass(frozen=True, slots=True)
class RemovalGuard:
    """Check that a run does not remove or replace outputs of families that it has not read.

    Attributes:
        folder: The output folder.
        devices: The families that were read.
        files: The specs that were read.
        command_with: Returns the command that also reads the families with these names, for messages.
        is_comparison: True if the run writes nothing, so that messages need not say that nothing has changed.
    """

    folder: Path
    devices: Sequence[Device]
    files: Sequence[str]
    command_with: Callable[[Sequence[str]], str]
    is_comparison: bool = False

    def check(self, changes: Mapping[str, Sequence[FileChange]]) -> None:
        """Check the changes of each target.

        Raises:
            WriteError: Files of other families would be removed or replaced, or a spec is in a folder that is written.
        """
        self._refuse_specs_inside(changes)
        families_read = set(owners(self.devices))
        unread_families: set[str] = set()
        removed_files: list[str] = []
        unknown_files: list[str] = []
        for target, target_changes in changes.items():
            recorded_families = families_in(self.folder / target)
            if recorded_families:
                missing_families = set(recorded_families) - families_read
                removed_files += self._files_of_missing(missing_families, target_changes)
            else:
                # An earlier version wrote the folder. Only its decode page contains the names of families.
                missing_families = self._families_in_decode_page(target_changes)
                unknown_files += self._files_without_record(target_changes)
            unread_families |= missing_families
        if unread_families:
            raise WriteError(
                self._message_about_families(sorted(unread_families), sorted([*removed_files, *unknown_files]))
            )
        if unknown_files:
            raise WriteError(self._message_without_record(sorted(unknown_files)))

    def _files_of_missing(self, missing_families: Iterable[str], changes: Iterable[FileChange]) -> list[str]:
        """Return the files to remove that belong to missing families, which are given as ``manufacturer/family``.

        The path of such a file contains one of these two words. Words that are also names of families or manufacturers
        that were read do not count.
        """
        missing_words = set(chain.from_iterable(name.split("/") for name in missing_families))
        missing_words -= self._names_of_families_read()
        return [path for path in _removed_paths(changes) if _has_name(path, missing_words)]

    def _families_in_decode_page(self, changes: Iterable[FileChange]) -> set[str]:
        """Return the names of families in the decode page that would be replaced and that were not read."""
        written_paths = [change.path for change in changes if change.state == "written"]
        family_names: set[str] = set()
        for path in written_paths:
            if path.endswith(f"/{_DECODE_PAGE}"):
                old_page = _read_text(self.folder / path)
                family_names.update(_FAMILY_IN_DECODE_PAGE.findall(old_page))
        return family_names - self._names_of_families_read()

    def _files_without_record(self, changes: Iterable[FileChange]) -> list[str]:
        """Return the files to remove whose names contain no family that was read. An earlier version wrote them."""
        known_names = {device.name for device in self.devices} | _SHARED_NAME_PARTS
        return [path for path in _removed_paths(changes) if not _has_name(path, known_names)]

    def _names_of_families_read(self) -> set[str]:
        """Return the names of the families read, of their manufacturers, and of their packages."""
        names: set[str] = set()
        for device in self.devices:
            names |= {device.name, device.manufacturer.name, device.manufacturer.python_package}
        return names

    def _message_about_families(self, families: Sequence[str], files: Sequence[str]) -> str:
        """Return the message about outputs of families that were not read. ``files`` are examples of these outputs."""
        examples = f" ({self._examples_of_files(files)})" if files else ""
        problem = f"{self.folder.as_posix()} has outputs of {', '.join(families)}, which were not read{examples}."
        remedy = f"Read these specs too ({self.command_with(families)}), write elsewhere with -o, or drop these outputs"
        return f"{problem}{self._nothing_changed_text()} {remedy} with --prune"

    def _message_without_record(self, files: Sequence[str]) -> str:
        """Return the message about files that a run would remove although no record or name shows their family."""
        examples = self._examples_of_files(files)
        problem = f"{self.folder.as_posix()} has files of an earlier version whose family is not known ({examples})."
        remedy = "Remove them with --prune. If they are outputs of other specs, read these too"
        return f"{problem}{self._nothing_changed_text()} {remedy} ({self.command_with(())}) or write elsewhere with -o"

    def _nothing_changed_text(self) -> str:
        """Return the sentence that nothing has changed, unless the run only compares files."""
        return "" if self.is_comparison else " Nothing has changed."

    def _examples_of_files(self, files: Sequence[str]) -> str:
        """Return the number of files with the first of them: ``7 files: out/c/a.h, out/c/b.h and 5 more``."""
        paths = [(self.folder / path).as_posix() for path in files]
        number_of_files = count_with_unit(len(files), "file")
        return f"{number_of_files}: {first_of(paths, _MOST_SHOWN)}"

    def _refuse_specs_inside(self, targets: Iterable[str]) -> None:
        """Refuse to write a folder that contains a spec, because no later run would search it for specs.

        Raises:
            WriteError: There is such a spec.
        """
        for target in targets:
            target_folder = os.path.join(os.path.realpath(self.folder / target), "")
            for file in self.files:
                if os.path.realpath(file).startswith(target_folder):
                    written_folder = (self.folder / target).as_posix()
                    problem = f"the spec {file} is in {written_folder}, which generate writes"
                    state = "" if self.is_comparison else "; nothing has changed"
                    raise WriteError(f"{problem}{state}; choose another output folder with -o")


def _removed_paths(changes: Iterable[FileChange]) -> list[str]:
    """Return the paths of the files that the changes remove."""
    return [change.path for change in changes if change.state == "removed"]


def _has_name(path: str, names: Collection[str]) -> bool:
    """Return whether a word in a path is one of the names, or one with a suffix: ``demo_biss`` for ``demo``."""
    beginnings = tuple(f"{name}_" for name in names)
    words = _WORD_IN_PATH.findall(path.lower())
    return any(f"{word}_".startswith(beginnings) for word in words)


def _read_text(path: Path) -> str:
    """Return the text of a file, or an empty one if it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
