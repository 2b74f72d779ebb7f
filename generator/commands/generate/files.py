"""Write the files that ``generate`` renders, or compare them with the output folder or with files of other specs.

Whether a run may remove outputs is decided in ``removal_guard``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path

from ...cache import Cache
from ...changes.names import name_changes
from ...changes.report import Files as FileCounts
from ...language.problems import TemplateFault
from ...loading.configuration import BUILT_IN, NO_FILTERS, FamilyFilters
from ...loading.stored import digest_of as model_digest_of
from ...model import Device
from ...output_folder import WriteError
from ...say import count_with_unit
from ...targets import Library, TargetError
from ...targets.registry import load_target
from ...write_and_remove import FileChange, left_stages, list_changes, write
from ..outputs import FamilyParts, accepted_devices
from ..terminal import CommandError
from . import Families, Files, print_summary
from .removal_guard import RemovalGuard


def _changes_to_write(
    files: Files, output: Path, refuse_removals: Callable[[Mapping[str, Sequence[FileChange]]], None]
) -> list[FileChange]:
    """Return the changes that writing these files would make, with what a killed run left in the folder."""
    changes_by_target = {name: list_changes(output, name, texts) for name, texts in files.items()}
    refuse_removals(changes_by_target)
    return [*chain.from_iterable(changes_by_target.values()), *left_stages(output)]


def write_or_compare(
    arguments: argparse.Namespace, files: Files, families: Families, gate: Callable[[], None], guard: RemovalGuard
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
