"""Write the files that ``generate`` renders, or compare them with the output folder or with files of other specs.

A run removes no outputs of families that it has not read, unless there is ``--prune``. Outputs contain pages and tables
about all families, so they must be written from all families or not at all. The list in each target's folder records
the families that it was written from. Lists of earlier versions do not record them. Then a file belongs to a family if
its name contains the name of the family. Which files are no longer outputs and are therefore removed is decided in
``write_and_remove.list_changes``.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from ...cache import Cache
from ...changes.names import name_changes
from ...changes.report import Files as FileCounts
from ...language.problems import TemplateFault
from ...loading.configuration import BUILT_IN, NO_FILTERS, FamilyFilters
from ...loading.stored import digest_of as model_digest_of
from ...model import Device
from ...output_folder import WriteError, families_in
from ...say import count_with_unit, first_of
from ...targets import Library, TargetError
from ...targets.registry import load_target
from ...write_and_remove import FileChange, left_stages, list_changes, write
from ..outputs import FamilyParts, accepted_devices, owners
from ..terminal import CommandError
from . import Families, Files, print_summary


def _changes_to_write(
    files: Files, output: Path, refuse_removals: Callable[[Mapping[str, Sequence[FileChange]]], None]
) -> list[FileChange]:
    """Return the changes that writing these files would make, with what a killed run left in the folder."""
    changes_by_target = {name: list_changes(output, name, texts) for name, texts in files.items()}
    refuse_removals(changes_by_target)
    return [*chain.from_iterable(changes_by_target.values()), *left_stages(output)]


def write_or_compare(
    arguments: argparse.Namespace, files: Files, families: Families, gate: Callable[[], None], guard: Guard
) -> int:
    """Write or, with ``--check``, only compare the files of each target. Return the exit code, which is 0.

    Args:
        arguments: The arguments of the command.
        files: The files of each target.
        families: The families that each target was rendered from.
        gate: Called if a file would change. It raises ``CommandError`` for specs that must not be released.
        guard: Refuses to remove outputs of other families, unless there is ``--prune``.

    Raises:
        CommandError: The disk fails, a compared file differs, ``gate`` or ``guard`` refuses the changes, or an idbiss
            file is not valid.
    """

    def refuse_removals(changes_by_target: Mapping[str, Sequence[FileChange]]) -> None:
        if not arguments.prune:
            guard.check(changes_by_target)

    try:
        if arguments.check:
            file_changes = _changes_to_write(files, arguments.output, refuse_removals)
        else:
            file_changes = write(
                arguments.output,
                files,
                force=arguments.force,
                before_waiting=lambda: _print_wait(arguments.output),
                before_writing=gate,
                check_changes=refuse_removals,
                families=families,
            )
    except WriteError as error:
        raise CommandError(str(error), 1) from None
    _print_changes(file_changes, arguments)
    if arguments.biss_dtd is not None:
        _validate_idbiss(files["biss"], arguments.output, arguments.biss_dtd)
    return 0


def _print_wait(output: Path) -> None:
    print(f"codewheel: waiting for another run that is writing to {output.as_posix()}", file=sys.stderr, flush=True)


def _print_changes(file_changes: Sequence[FileChange], arguments: argparse.Namespace) -> None:
    """Print the files that changed or, if they were only compared, differ, and a summary.

    Raises:
        CommandError: A file that was only compared differs.
    """
    word_by_change = {"written": "differs", "removed": "left over"} if arguments.check else {}
    changed_files = [change for change in file_changes if change.state != "unchanged"]
    for change in changed_files:
        word = word_by_change.get(change.state, change.state)
        print(f"{word:<10} {(arguments.output / change.path).as_posix()}")
    if arguments.check and changed_files:
        _print_targets_by_state(file_changes)
    print_summary(arguments, len(file_changes), len(changed_files))


def _print_targets_by_state(file_changes: Iterable[FileChange]) -> None:
    """Print which targets match the specs and which do not, if there are both.

    This happens after a run that was killed between two targets. The first folder in the path of a file is its target.
    """
    states_by_target: dict[str, set[str]] = {}
    for change in file_changes:
        target, slash, _ = change.path.partition("/")
        is_in_target = bool(slash)
        if is_in_target:
            states_by_target.setdefault(target, set()).add(change.state)
    current_targets = [target for target, states in states_by_target.items() if states == {"unchanged"}]
    outdated_targets = [target for target in states_by_target if target not in current_targets]
    if current_targets and outdated_targets:
        print(f"up to date: {', '.join(current_targets)}; out of date: {', '.join(outdated_targets)}")


def _validate_idbiss(files: Mapping[str, str], output: Path, dtd: Path) -> None:
    """Validate every idbiss file in ``files``, texts by path, against the document type ``dtd``.

    Raises:
        CommandError: A file is not valid (exit code 1), or ``dtd`` cannot be used (exit code 2).
    """
    from ...targets.biss.files import DtdError, read_dtd, validation_errors

    idbiss_texts: dict[str, str] = {}
    for path, text in files.items():
        if Path(path).name.startswith("idbiss"):
            idbiss_texts[(output / path).as_posix()] = text
    dtd_errors: list[str] = []
    try:
        dtd_text = read_dtd(dtd)
        for path, text in idbiss_texts.items():
            dtd_errors += validation_errors(text, path, dtd_text, dtd_name=dtd.as_posix())
    except DtdError as error:
        raise CommandError(str(error), 2) from None
    for dtd_error in dtd_errors:
        print(dtd_error, file=sys.stderr)
    if dtd_errors:
        number_of_errors = count_with_unit(len(dtd_errors), "error")
        raise CommandError(f"not valid against {dtd}: {number_of_errors}", 1)
    for path in idbiss_texts:
        print(f"valid against {dtd}: {path}")


def changed_files(
    old_devices: Sequence[Device], new_devices: Sequence[Device], cache: Cache, filters: FamilyFilters = NO_FILTERS
) -> FileCounts | None:
    """Return which files of the built-in targets differ between two versions of the specs, and which names in them do.

    ``filters`` are the conditions for the families of each target. The result is None if a target cannot express a
    family or a template fails.
    """
    family_parts = FamilyParts(cache, only_paths=unchanged_families(old_devices, new_devices))
    try:
        old_files = _rendered_files(old_devices, family_parts, filters)
        new_files = _rendered_files(new_devices, family_parts, filters)
    except (TargetError, TemplateFault):
        return None
    paths = sorted({*old_files, *new_files})
    changed_paths = tuple(path for path in paths if old_files.get(path) != new_files.get(path))
    family_names = {device.name for device in (*old_devices, *new_devices)}
    changed_names = name_changes(old_files, new_files, family_names)
    return FileCounts(changed_paths=changed_paths, file_count=len(paths), name_changes=changed_names)


def unchanged_families(old_devices: Sequence[Device], new_devices: Sequence[Device]) -> frozenset[str]:
    """Return the names of the families that are the same in both versions of the specs."""
    new_by_name = {device.name: device for device in new_devices}
    unchanged_names = set()
    for old_device in old_devices:
        new_device = new_by_name.get(old_device.name)
        if new_device is not None and _have_same_model(old_device, new_device):
            unchanged_names.add(old_device.name)
    return frozenset(unchanged_names)


def _have_same_model(device: Device, other_device: Device) -> bool:
    """Return whether two devices have the same digest, which is a hash of the model.

    If a device has no digest, the result is False, because the models may differ.
    """
    digest = model_digest_of(device)
    if not digest:
        return False
    return device is other_device or digest == model_digest_of(other_device)


def _rendered_files(devices: Sequence[Device], family_parts: FamilyParts, filters: FamilyFilters) -> Mapping[str, str]:
    """Return the files of all built-in targets, as texts by path, without families that a filter excludes."""
    files: dict[str, str] = {}
    for target_name in BUILT_IN:
        devices_of_target = accepted_devices(target_name, devices, filters)
        target = load_target(target_name)
        if devices_of_target:
            files |= family_parts.files_of(target, Library(devices_of_target), target.defaults)
    return files


# -- outputs of families that were not read

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
class Guard:
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
