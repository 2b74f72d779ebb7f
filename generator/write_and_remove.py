"""Decide which outputs are written and which are removed; ``output_folder.Stage`` carries it out.

Each target has its own folder in the output folder. Its complete new content is first assembled in a stage, a temporary
folder next to it. The folders are exchanged when all targets are complete. Only one process at a time does this.

Each target's folder has a list of the files that codewheel wrote. All other files and folders belong to the user. They
are never overwritten or removed unless the user requests it. Whether outputs of families that a run has not read may be
removed is decided in ``commands/generate/removal_guard``.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from types import MappingProxyType

from .output_folder import (
    LIST,
    LIST_SIGN,
    PATIENCE_S,
    STAGE_PREFIX,
    Busy,
    Stage,
    WriteError,
    families_in,
    is_safe,
    list_text,
    listed_in,
    locked,
    read_file,
    stages_in,
)

_A_FOLDER = ", a folder in place of a file"


@dataclass(frozen=True, slots=True)
class FileChange:
    """Change of one file: ``written``, ``unchanged`` or ``removed``."""

    path: str
    state: str


def list_changes(folder: Path, target_name: str, text_by_path: Mapping[str, str]) -> list[FileChange]:
    """Return the changes that writing ``text_by_path`` would make in the target's folder, ordered by path.

    Args:
        folder: The output folder.
        target_name: Name of the target, which is the first part of every path.
        text_by_path: Text of each file, keyed by its path relative to the output folder, with slashes.

    Raises:
        WriteError: A path is outside the target's folder, or the folder cannot be read.
    """
    _refuse_bad_paths(folder, {target_name: text_by_path})
    file_changes: list[FileChange] = []
    for path, text in text_by_path.items():
        is_unchanged = read_file(folder / path) == text.encode()
        file_changes.append(FileChange(path, state="unchanged" if is_unchanged else "written"))
    for path in _listed_paths(folder, target_name):
        is_obsolete = path not in text_by_path
        if is_obsolete and (folder / path).is_file():
            file_changes.append(FileChange(path, state="removed"))
    return sorted(file_changes, key=lambda change: change.path)


def digest_of(targets: Mapping[str, Mapping[str, str]], families: Mapping[str, Sequence[str]]) -> str:
    """Return a hash of the files that ``write`` leaves with these arguments, for comparison with ``digest_on_disk``."""
    return _digest(_files_to_write(targets, families))


def digest_on_disk(folder: Path, targets: Iterable[str]) -> str:
    """Return a hash of the listed files of these targets. It is empty if a file is missing or a run left a stage.

    Args:
        folder: The output folder.
        targets: Names of the targets.
    """
    try:
        has_stages = any(name.startswith(STAGE_PREFIX) for name in os.listdir(folder))
        return "" if has_stages else _digest(_files_on_disk(folder, targets))
    except (OSError, WriteError):
        return ""


def _digest(files: Iterable[tuple[str, bytes]]) -> str:
    """Return a hash of the paths and contents."""
    digest = hashlib.sha256()
    for path, content in files:
        digest.update(f"{path}\0{len(content)}\0".encode())
        digest.update(content)
    return digest.hexdigest()


def _files_to_write(
    files_by_target: Mapping[str, Mapping[str, str]], families_by_target: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, bytes]]:
    """Yield the path and the content of each list and file."""
    for target_name, text_by_path in sorted(files_by_target.items()):
        # The paths in the target's folder, such as "include/x.h" for "c/include/x.h".
        paths_in_target = [path.partition("/")[2] for path in text_by_path]
        text_of_list = list_text(paths_in_target, families_by_target.get(target_name, ()))
        yield f"{target_name}/{LIST}", text_of_list.encode()
        for path in sorted(text_by_path):
            yield path, text_by_path[path].encode()


def _files_on_disk(folder: Path, target_names: Iterable[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the path and the content of each list, and of each file in it.

    Raises:
        WriteError: A file is missing or cannot be read, or a target's folder is not a real folder.
    """
    for target_name in sorted(target_names):
        if _kind_of(folder / target_name) != "folder":
            raise WriteError(f"{folder / target_name} is not a folder")
        for path in (f"{target_name}/{LIST}", *_listed_paths(folder, target_name)):
            content = read_file(os.path.join(folder, path))
            if content is None:
                raise WriteError(f"{folder / path} is not a file")
            yield path, content


def write(
    folder: Path,
    targets: Mapping[str, Mapping[str, str]],
    force: bool = False,
    before_waiting: Callable[[], None] = lambda: None,
    before_writing: Callable[[], None] = lambda: None,
    check_changes: Callable[[Mapping[str, Sequence[FileChange]]], None] = lambda _: None,
    families: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> list[FileChange]:
    """Write the files of ``targets`` to their folders, remove obsolete files, and keep files of the user.

    Args:
        folder: The output folder.
        targets: The files of each target, keyed by the name of the target.
        force: True to overwrite files of the user at the same paths.
        before_waiting: Called before the function waits for another run that is writing to the folder.
        before_writing: Called before a file changes. An error that it raises ends the function without a change.
        check_changes: Called with the changes of each target, before ``before_writing``. An error has the same effect.
        families: The families that the files of each target are written from, as ``manufacturer/family``, for its list.

    Raises:
        WriteError: A file of the user has the path of an output, another run does not end, or a file cannot be written.
            Nothing has changed, or the message lists the targets that could not be restored.
    """
    _refuse_bad_paths(folder, targets)
    is_new = not os.path.lexists(folder)
    try:
        with locked(folder, before_waiting):
            try:
                return _write_locked(folder, targets, families, check_changes, before_writing, force=force)
            finally:
                if is_new:
                    with suppress(OSError):  # a folder that is not empty stays
                        folder.rmdir()
    except Busy:
        problem = f"another run of codewheel has been writing to {folder} for {PATIENCE_S:.0f} s"
        raise WriteError(f"{problem}; nothing has changed; try again when it has ended") from None
    except OSError as error:
        problem = f"cannot write {error.filename or folder}: {error.strerror or error}"
        raise WriteError(f"{problem}; nothing has changed") from None


def _write_locked(
    folder: Path,
    files_by_target: Mapping[str, Mapping[str, str]],
    families_by_target: Mapping[str, Sequence[str]],
    check_changes: Callable[[Mapping[str, Sequence[FileChange]]], None],
    before_writing: Callable[[], None],
    *,
    force: bool,
) -> list[FileChange]:
    """Write the targets to the folder, and return all changes. This process must hold its lock.

    ``check_changes`` and ``before_writing`` are called before anything changes, as in ``write``.
    """
    _remove_left_stages(folder)
    changes_by_target = {
        target_name: list_changes(folder, target_name, text_by_path)
        for target_name, text_by_path in files_by_target.items()
    }
    check_changes(changes_by_target)
    if any(map(_has_changes, changes_by_target.values())):
        before_writing()
    files_by_target_to_write: dict[str, Mapping[str, str]] = {}
    for target_name, text_by_path in files_by_target.items():
        has_new_list = _has_new_list(folder, target_name, text_by_path, families_by_target.get(target_name, ()))
        if has_new_list or _has_changes(changes_by_target[target_name]):
            files_by_target_to_write[target_name] = text_by_path
    _refuse_what_is_in_the_way(folder, files_by_target_to_write, changes_by_target, force=force)
    _exchange_folders(folder, files_by_target_to_write, changes_by_target, families_by_target)
    return list(chain.from_iterable(changes_by_target.values()))


def _exchange_folders(
    folder: Path,
    files_by_target: Mapping[str, Mapping[str, str]],
    changes_by_target: Mapping[str, Sequence[FileChange]],
    families_by_target: Mapping[str, Sequence[str]],
) -> None:
    """Assemble the new content of each target's folder in a stage, and then exchange all folders.

    Raises:
        WriteError: A folder or file cannot be written. Folders that were exchanged are restored.
    """
    stages: list[Stage] = []
    exchanged_stages: list[Stage] = []
    try:
        for target_name, text_by_path in files_by_target.items():
            stage = Stage.create(folder / target_name)
            stages.append(stage)
            unchanged_paths = {change.path for change in changes_by_target[target_name] if change.state == "unchanged"}
            stage.fill(text_by_path, families_by_target.get(target_name, ()), unchanged_paths)
        for stage in stages:
            stage.exchange()
            exchanged_stages.append(stage)
    except BaseException as error:
        unrestored_targets = [stage.target_folder.name for stage in exchanged_stages if not stage.take_back()]
        if not isinstance(error, OSError):
            raise
        path = _path_in_output(error, stages, folder)
        problem = f"cannot write {path}: {error.strerror or error}"
        raise WriteError(f"{problem}; {_state_of_output(unrestored_targets)}") from None
    finally:
        for stage in stages:
            stage.remove()


def _has_changes(target_changes: Iterable[FileChange]) -> bool:
    return any(change.state != "unchanged" for change in target_changes)


def _has_new_list(folder: Path, target_name: str, paths: Iterable[str], families: Sequence[str]) -> bool:
    """Return whether the list in a target's folder has other files, or other families, than a run writes.

    Without ``families``, the families in the list do not matter.
    """
    if _listed_paths(folder, target_name) != sorted(paths):
        return True
    return bool(families) and families_in(folder / target_name) != list(families)


def _path_in_output(error: OSError, stages: Iterable[Stage], folder: Path) -> str:
    """Return the path of an error, or the output folder if the error has no path.

    A path in a stage becomes the path that the file would have had in the target's folder.
    """
    error_path = Path(str(error.filename or folder))
    for stage in stages:
        for stage_folder in (stage.new, stage.folder):
            if error_path.is_relative_to(stage_folder):
                path_in_target = error_path.relative_to(stage_folder)
                return (stage.target_folder / path_in_target).as_posix()
    return str(error.filename or folder)


def _state_of_output(unrestored_targets: Sequence[str]) -> str:
    """Return the end of an error message: nothing has changed, or these targets could not be restored."""
    if not unrestored_targets:
        return "nothing has changed"
    return f"written before that: {', '.join(unrestored_targets)}; the rest is as it was"


def _remove_left_stages(folder: Path) -> None:
    """Remove stages left by a killed run."""
    for stage in stages_in(folder):
        with suppress(OSError, WriteError):
            stage.remove()


def left_stages(folder: Path) -> list[FileChange]:
    """Return the stages of a killed run, as files that the next run removes."""
    return [FileChange(stage.folder.name, "removed") for stage in stages_in(folder)]


def _refuse_bad_paths(folder: Path, paths_by_target: Mapping[str, Iterable[str]]) -> None:
    """Refuse paths outside the folder of their target, and folders that are links or files."""
    for target_name, paths in paths_by_target.items():
        for path in paths:
            if not is_safe(path) or path.split("/")[0] != target_name:
                problem = f"the target '{target_name}' uses the path '{path}'"
                raise WriteError(f"{problem}, which is not inside its folder '{target_name}/'")
        target_folder = folder / target_name
        if target_folder.is_symlink():
            raise WriteError(f"{target_folder} is a link; output is written to real folders only")
        for path_of_folder in (folder, target_folder):
            if _kind_of(path_of_folder) == "file":
                raise WriteError(f"{path_of_folder} is a file, but must be a folder; nothing has changed")


def _refuse_what_is_in_the_way(
    folder: Path,
    files_by_target: Mapping[str, Mapping[str, str]],
    changes_by_target: Mapping[str, list[FileChange]],
    *,
    force: bool,
) -> None:
    """Refuse to overwrite anything that is not in our lists. ``force`` permits this for files, but not for folders."""
    message_lines: list[str] = []
    are_all_folders = True
    for target_name, text_by_path in files_by_target.items():
        paths_to_write = {change.path for change in changes_by_target[target_name] if change.state == "written"}
        for path, note in _in_the_way(folder, target_name, text_by_path, paths_to_write):
            is_folder = note == _A_FOLDER
            if is_folder or not force:
                message_lines.append(f"\n  {(folder / path).as_posix()}{note}")
                are_all_folders = are_all_folders and is_folder
    if message_lines:
        remedy = "move it away" if are_all_folders else "move it away, or overwrite files with --force"
        raise WriteError(
            f"in the way and not written by codewheel; nothing has changed; {remedy}:{''.join(message_lines)}"
        )


def _in_the_way(
    folder: Path, target_name: str, text_by_path: Mapping[str, str], paths_to_write: set[str]
) -> Iterator[tuple[str, str]]:
    """Yield the path of each file or folder in the way that codewheel did not write, with a note for the message.

    The note is ``, in place of a folder``, ``, a folder in place of a file``, or empty for a file in place of a file.

    Args:
        folder: The output folder.
        target_name: Name of the target.
        text_by_path: Text of each file of the target.
        paths_to_write: Paths of the files that would be written.
    """
    # Codewheel wrote these files in an earlier run. One of them may be where a folder is needed now.
    listed_paths = set(_listed_paths(folder, target_name))
    # The output folder and the target's folder were checked before.
    needed_folders = _folders_of(text_by_path) - {".", target_name}
    for path in sorted(needed_folders - listed_paths):
        if _kind_of(folder / path) in ("file", "link"):
            yield path, ", in place of a folder"
    for path in sorted(paths_to_write):
        kind_of_path = _kind_of(folder / path)
        if kind_of_path == "folder":
            yield path, _A_FOLDER
        elif kind_of_path and path not in listed_paths:
            yield path, ""
    # The list does not contain itself. Our lists are recognised by their first line.
    list_path = f"{target_name}/{LIST}"
    kind_of_list = _kind_of(folder / list_path)
    if kind_of_list == "folder":
        yield list_path, _A_FOLDER
    elif kind_of_list:
        list_content = read_file(folder / list_path) or b""
        if not list_content.startswith(LIST_SIGN):
            yield list_path, ""


def _folders_of(paths: Iterable[str]) -> set[str]:
    """Return all folders on the way to these paths, such as ``.``, ``c`` and ``c/include`` for ``c/include/x.h``."""
    folders: set[str] = set()
    for path in paths:
        folders.update(folder.as_posix() for folder in Path(path).parents)
    return folders


def _kind_of(path: Path) -> str:
    """Return ``folder``, ``link``, ``file`` (for anything else), or an empty string if nothing exists."""
    try:
        mode = os.lstat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return ""
    except OSError as error:
        raise WriteError(f"cannot read {path}: {error.strerror}") from None
    if stat.S_ISDIR(mode):
        return "folder"
    return "link" if stat.S_ISLNK(mode) else "file"


def _listed_paths(folder: Path, target: str) -> list[str]:
    """Return the paths in the list of a target, relative to the output folder."""
    return sorted(f"{target}/{path}" for path in listed_in(folder / target))
