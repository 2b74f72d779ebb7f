"""Files that ``generate`` rendered: written, compared with those on the disk, or with those of other specs.

Parts of families with the same model are rendered once for both.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypedDict

from ...cache import Cache
from ...changes.names import name_changes
from ...changes.report import Files as FileCounts
from ...family_parts import FamilyParts
from ...language.problems import TemplateFault
from ...loading.configuration import BUILT_IN
from ...loading.stored import digest_of as model_digest_of
from ...model import Device
from ...output_folder import WriteError
from ...removable_outputs import Guard
from ...say.plain_text import counted
from ...targets import Library, TargetError
from ...targets.registry import load_target
from ...write import Change, changes, digest_of, digest_on_disk, left_stages, write
from ..terminal import Stop

#: The files of each target, as texts by path.
Files = Mapping[str, Mapping[str, str]]
#: The families of each target, as ``owners`` returns them.
Families = Mapping[str, Sequence[str]]


class Generated(TypedDict):
    """Result of a run: the line about the specs, the targets, the number of their files, and the digest of these."""

    read_line: str
    targets: list[str]
    count: int
    digest: str


def is_unchanged(arguments: argparse.Namespace, generated: Generated | None) -> bool:
    """Return True if the output is that of an earlier run, and print what that run printed."""
    if generated is None or digest_on_disk(arguments.output, generated["targets"]) != generated["digest"]:
        return False
    print(generated["read_line"])
    _print_summary(arguments, generated["count"], changed=0)
    return True


def result_to_store(read_line: str, files: Files, families: Families) -> Generated:
    """Return the result of a run that rendered these files."""
    count = sum(map(len, files.values()))
    return Generated(read_line=read_line, targets=list(files), count=count, digest=digest_of(files, families))


def write_or_compare(
    arguments: argparse.Namespace, files: Files, families: Families, gate: Callable[[], None], guard: Guard
) -> int:
    """Write or compare the files of each target, and return the exit code.

    ``families`` are those that each target was rendered from. ``gate`` raises ``Stop`` to refuse writing specs that
    must not be released. It is called if a file would change.

    Raises:
        Stop: The disk fails, a file differs, or ``guard`` refuses the changes.
    """
    check: Callable[[Mapping[str, Sequence[Change]]], None] = (lambda _: None) if arguments.prune else guard.check
    try:
        if arguments.check:
            changes_by_target = {name: changes(arguments.output, name, texts) for name, texts in files.items()}
            check(changes_by_target)
            file_changes = [change for target_changes in changes_by_target.values() for change in target_changes]
            file_changes += left_stages(arguments.output)
        else:
            file_changes = write(
                arguments.output,
                files,
                force=arguments.force,
                waiting=lambda: _print_wait(arguments.output),
                gate=(lambda: None) if arguments.unchecked else gate,
                guard=check,
                families=families,
            )
    except WriteError as error:
        raise Stop(str(error), 1) from None
    _print_changes(file_changes, arguments)
    if arguments.biss_dtd is not None:
        _validate_idbiss(files["biss"], arguments.output, arguments.biss_dtd)
    return 0


def _print_wait(output: Path) -> None:
    print(f"codewheel: waiting for another run that is writing to {output.as_posix()}", file=sys.stderr, flush=True)


def _print_changes(file_changes: Sequence[Change], arguments: argparse.Namespace) -> None:
    """Print the files that changed, and a summary.

    Raises:
        Stop: A file that was only compared differs.
    """
    words = {"written": "differs", "removed": "left over"} if arguments.check else {}
    changed = [change for change in file_changes if change.what != "unchanged"]
    for change in changed:
        print(f"{words.get(change.what, change.what):<10} {(arguments.output / change.path).as_posix()}")
    if arguments.check and changed:
        _print_mixture(file_changes)
    _print_summary(arguments, len(file_changes), len(changed))


def _print_summary(arguments: argparse.Namespace, count: int, changed: int) -> None:
    """Print the number of files, or raise ``Stop`` if some of them were only compared and differ."""
    if arguments.check and changed:
        raise Stop(f"{counted(changed, 'file')} out of date; run: {arguments.again}", 1)
    if arguments.check:
        print(f"{counted(count, 'file')} up to date")
    elif changed:
        print(f"{counted(changed, 'file')} changed, {count - changed} unchanged")
    else:
        print(f"all {count} files unchanged")


def _print_mixture(file_changes: Iterable[Change]) -> None:
    """Print which targets match the specs and which do not, as after a run that was killed between two targets."""
    states: dict[str, set[str]] = {}
    for change in file_changes:
        target, is_in_a_target, _ = change.path.partition("/")
        if is_in_a_target:
            states.setdefault(target, set()).add(change.what)
    current = [target for target, state in states.items() if state == {"unchanged"}]
    outdated = [target for target, state in states.items() if state != {"unchanged"}]
    if current and outdated:
        print(f"up to date: {', '.join(current)}; out of date: {', '.join(outdated)}")


def _validate_idbiss(files: Mapping[str, str], output: Path, dtd: Path) -> None:
    """Validate every idbiss file against the document type ``dtd``.

    Raises:
        Stop: A file is not valid (exit code 1), or ``dtd`` cannot be used (exit code 2).
    """
    from ...targets.biss.dtd import DtdError, faults, read_dtd

    names = [name for name in files if Path(name).name.startswith("idbiss")]
    try:
        text = read_dtd(dtd)
        shown_paths = {name: (output / name).as_posix() for name in names}
        dtd_faults = [fault for name in names for fault in faults(files[name], shown_paths[name], text, dtd.as_posix())]
    except DtdError as error:
        raise Stop(str(error), 2) from None
    for fault in dtd_faults:
        print(fault, file=sys.stderr)
    if dtd_faults:
        raise Stop(f"not valid against {dtd}: {counted(len(dtd_faults), 'error')}", 1)
    for name in names:
        print(f"valid against {dtd}: {shown_paths[name]}")


def changed_files(old: Sequence[Device], new: Sequence[Device], cache: Cache) -> FileCounts | None:
    """Return the files that our targets add, remove or change, or None if a target cannot express a family."""
    parts = FamilyParts(cache, only_paths=unchanged_families(old, new))
    try:
        before, after = _files(old, parts), _files(new, parts)
    except (TargetError, TemplateFault):
        return None
    names = sorted({*before, *after})
    changed = tuple(name for name in names if before.get(name) != after.get(name))
    changed_names = name_changes(before, after, {device.name for device in (*old, *new)})
    return FileCounts(changed, len(names), changed_names)


def unchanged_families(old: Sequence[Device], new: Sequence[Device]) -> frozenset[str]:
    """Return the names of the families that have the same model on both sides."""
    new_by_name = {device.name: device for device in new}
    old_in_both = [device for device in old if device.name in new_by_name]
    return frozenset(device.name for device in old_in_both if _are_equal(device, new_by_name[device.name]))


def _are_equal(device: Device, other_device: Device) -> bool:
    digest = model_digest_of(device)
    return bool(digest) and (device is other_device or digest == model_digest_of(other_device))


def _files(devices: Sequence[Device], parts: FamilyParts) -> Mapping[str, str]:
    library = Library(tuple(devices))
    files: dict[str, str] = {}
    for name in BUILT_IN:
        target = load_target(name)
        files |= parts.files_of(target, library, target.defaults)
    return files
