"""Write the output folder. No other module changes it.

Each target has its own folder in the output. Its complete new content is first assembled in a stage next to the old
folder. The folders are exchanged only when every target is complete. One process at a time does this. Each target's
folder has a list of the files written by codewheel. All other files and folders are never overwritten or removed unless
the user requests it.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread

from .lock import PATIENCE_S, Busy, locked

LIST = ".codewheel"
_LIST_HEAD = "# Written by codewheel generate, which removes files of this list that it no longer writes.\n"
_LIST_SIGN = b"# Written by codewheel generate"
#: Begins the line of a list with the families that the target's folder was written from.
_FAMILIES = "# Families: "
#: The first file in a stage. It lets a later run tell the stage of a killed run from a user's folder.
_MARK = ".codewheel-stage"
_PREFIX = ".codewheel-"
_STAGE = re.compile(rf"{re.escape(_PREFIX)}([A-Za-z0-9_.-]+)-[a-z0-9_]{{8}}")
_MARK_TEXT = "Temporary folder of codewheel generate. Its next run removes it.\n"
_NEW, _OLD = "new", "old"
_MOST_THREADS = 8
_A_FOLDER = ", a folder in place of a file"
_SAFE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*(/[A-Za-z0-9_.][A-Za-z0-9._-]*)*")
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


class WriteError(Exception):
    """The output could not be written or compared. The message states if anything has changed."""


@dataclass(frozen=True, slots=True)
class Change:
    """Change of one file: ``written``, ``unchanged`` or ``removed``."""

    path: str
    what: str


def changes(folder: Path, target: str, files: Mapping[str, str]) -> list[Change]:
    """Return the changes that writing ``files`` would make in the target's folder, ordered by path.

    Args:
        folder: The output folder.
        target: Name of the target, which is the first part of every path.
        files: Text of each file, keyed by its path relative to the output folder, with slashes.

    Raises:
        WriteError: A path is outside the target's folder, or the folder cannot be read.
    """
    _refuse_bad_paths(folder, target, files)
    file_changes = [
        Change(path, "unchanged" if _read(folder / path) == text.encode() else "written")
        for path, text in files.items()
    ]
    file_changes += [
        Change(path, "removed") for path in _ours(folder, target) if path not in files and (folder / path).is_file()
    ]
    return sorted(file_changes, key=lambda change: change.path)


def hashes(files: Mapping[str, str]) -> dict[str, str]:
    """Return a hash of each text, for ``is_as_written``."""
    return {path: hashlib.sha256(text.encode()).hexdigest() for path, text in files.items()}


def is_as_written(
    folder: Path,
    targets: Mapping[str, Mapping[str, str]],
    known_hash: Callable[[str, Callable[[], str]], object] = lambda _, hash_of_file: hash_of_file(),
    families: Sequence[str] = (),
) -> bool:
    """Return whether writing files with these hashes would change nothing.

    Args:
        folder: The output folder.
        targets: The hashes, keyed as for ``write``.
        known_hash: Returns the hash of the file at a path if it is known, and otherwise calls its second argument.
        families: As for ``write``.
    """

    def hash_of(path: str) -> object:
        place = os.path.join(folder, path)
        return known_hash(place, lambda: _hash_of(Path(place))) if stat.S_ISREG(os.lstat(place).st_mode) else ""

    try:
        return not any(name.startswith(_PREFIX) for name in os.listdir(folder)) and all(
            _ours(folder, target) == sorted(files)
            and (not families or families_in(folder / target) == list(families))
            and all(hash_of(path) == expected for path, expected in files.items())
            for target, files in targets.items()
        )
    except (OSError, WriteError):
        return False


def _hash_of(path: Path) -> str:
    content = _read(path)
    return "" if content is None else hashlib.sha256(content).hexdigest()


def write(
    folder: Path,
    targets: Mapping[str, Mapping[str, str]],
    force: bool = False,
    waiting: Callable[[], None] = lambda: None,
    gate: Callable[[], None] = lambda: None,
    guard: Callable[[Mapping[str, Sequence[Change]]], None] = lambda _: None,
    families: Sequence[str] = (),
) -> list[Change]:
    """Write the files of ``targets`` to their folders, remove obsolete ones, and keep foreign files.

    Args:
        folder: The output folder.
        targets: The files of each target, keyed by the name of the target.
        force: True to overwrite foreign files that are in the way.
        waiting: Called before the function waits for another run that is writing to the folder.
        gate: Called before a file changes. An error that it raises ends the function, and nothing has changed.
        guard: Called with the changes of each target, before ``gate``. An error has the same effect.
        families: The families that the files are written from, as ``manufacturer/family``, for the lists.

    Raises:
        WriteError: A foreign file is in the way, another run does not end, or a file cannot be written. In that case
            nothing has changed, or the message lists the targets that could not be restored.
    """
    for target, files in targets.items():
        _refuse_bad_paths(folder, target, files)
    is_new = not os.path.lexists(folder)
    try:
        with locked(folder, waiting):
            try:
                return _written(folder, targets, force, gate, guard, families)
            finally:
                if is_new:
                    with suppress(OSError):  # a folder that is not empty stays
                        folder.rmdir()
    except Busy:
        problem = f"another run of codewheel has been writing to {folder} for {PATIENCE_S:.0f} s"
        raise WriteError(f"{problem}; nothing has changed; try again when it has ended") from None
    except OSError as error:
        raise WriteError(
            f"cannot write {error.filename or folder}: {error.strerror or error}; nothing has changed"
        ) from None


def _written(
    folder: Path,
    targets: Mapping[str, Mapping[str, str]],
    force: bool,
    gate: Callable[[], None],
    guard: Callable[[Mapping[str, Sequence[Change]]], None],
    families: Sequence[str],
) -> list[Change]:
    """Write the targets to the folder. This process must hold its lock."""
    _clear(folder)
    changes_by_target = {target: changes(folder, target, files) for target, files in targets.items()}
    guard(changes_by_target)
    if any(change.what != "unchanged" for of_target in changes_by_target.values() for change in of_target):
        gate()
    to_write = [
        name
        for name, files in targets.items()
        if _needs_writing(folder, name, files, changes_by_target[name], families)
    ]
    _refuse_what_is_in_the_way(folder, {name: targets[name] for name in to_write}, changes_by_target, force)
    stages: list[_Stage] = []
    exchanged: list[_Stage] = []
    try:
        for target in to_write:
            stages.append(_Stage(Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{target}-", dir=folder)), folder / target))
            stages[-1].fill(
                targets[target],
                families,
                {change.path for change in changes_by_target[target] if change.what == "unchanged"},
            )
        for stage in stages:
            _exchange(stage.new, stage.place)
            exchanged.append(stage)
    except BaseException as error:
        written = [stage.place.name for stage in exchanged if not _taken_back(stage)]
        if not isinstance(error, OSError):
            raise
        place = _shown(error, stages, folder)
        raise WriteError(f"cannot write {place}: {error.strerror or error}; {_state(written)}") from None
    finally:
        _remove({stage.folder: stage.place for stage in stages})
    return [change for changed in changes_by_target.values() for change in changed]


def _needs_writing(
    folder: Path, target: str, files: Mapping[str, str], target_changes: Iterable[Change], families: Sequence[str]
) -> bool:
    if any(change.what != "unchanged" for change in target_changes) or _ours(folder, target) != sorted(files):
        return True
    return bool(families) and families_in(folder / target) != list(families)


def _shown(error: OSError, stages: Iterable[_Stage], folder: Path) -> str:
    """Return the path of an error in the user's folder, also for an error in a stage."""
    path = str(error.filename or folder)
    for stage in stages:
        for stage_folder in (stage.new, stage.folder):
            if Path(path).is_relative_to(stage_folder):
                return (stage.place / Path(path).relative_to(stage_folder)).as_posix()
    return path


def _state(written: list[str]) -> str:
    return f"written before that: {', '.join(written)}; the rest is as it was" if written else "nothing has changed"


def _taken_back(stage: _Stage) -> bool:
    """Restore the old content of a target's folder, and return True if that succeeded."""
    try:
        if os.path.lexists(stage.old):
            os.rename(stage.place, stage.new)
            os.rename(stage.old, stage.place)
        elif os.path.lexists(stage.new):
            _exchange(stage.new, stage.place)
        else:
            os.rename(stage.place, stage.new)
    except OSError:
        return False
    return True


def _clear(folder: Path) -> None:
    """Remove stages left by a killed run."""
    for stage, target in _stages_in(folder):
        with suppress(OSError, WriteError):
            _remove({stage: folder / target})


def left_stages(folder: Path) -> list[Change]:
    """Return the stages of a killed run, as files that the next run removes."""
    return [Change(stage.name, "removed") for stage, _ in _stages_in(folder)]


def _stages_in(folder: Path) -> list[tuple[Path, str]]:
    """Return each stage in the output folder, and its target. These folders have our name and our mark."""
    target_stages = []
    try:
        with os.scandir(folder) as listing:
            entries = sorted(listing, key=lambda folder_entry: folder_entry.name)
    except OSError:
        return []
    for folder_entry in entries:
        stage_name = _STAGE.fullmatch(folder_entry.name)
        if stage_name and folder_entry.is_dir(follow_symlinks=False):
            with suppress(OSError, WriteError):
                if _is_a_stage(Path(folder_entry.path)):
                    target_stages.append((Path(folder_entry.path), stage_name[1]))
    return target_stages


def _is_a_stage(folder: Path) -> bool:
    """Return whether a folder has the mark of a stage. A run killed early may have left only part of the mark."""
    mark = _read(folder / _MARK)
    if mark == _MARK_TEXT.encode():
        return True
    return set(os.listdir(folder)) <= {_MARK} and _MARK_TEXT.encode().startswith(mark or b"")


def _remove(stages: Mapping[Path, Path]) -> None:
    """Remove stages, keyed by their folders, each with the target's folder.

    The mark is removed last, so that a run killed here leaves a recognisable stage.
    """
    obsolete_trees = []
    for stage, place in stages.items():
        _save_from(stage, place)
        obsolete_trees += [stage / _NEW, *([stage / _OLD] if os.path.lexists(place) else [])]
    _remove_trees(obsolete_trees)
    for stage in stages:
        if not os.path.lexists(stage / _OLD):
            with suppress(OSError):
                (stage / _MARK).unlink(missing_ok=True)
                stage.rmdir()


def _save_from(stage: Path, place: Path) -> None:
    """Move all content of a stage that must not be lost to the target's folder, and let the rest be removed."""
    if os.path.lexists(stage / _OLD) and not os.path.lexists(place):
        with suppress(OSError):  # the run was killed between two renames
            os.rename(stage / _OLD, place)
    for saved_folder in (stage / _NEW, stage / _OLD):
        _save_late_files(saved_folder, place)
    for root, folders, _ in os.walk(stage):
        for name in folders:
            with suppress(OSError):
                if not os.path.islink(os.path.join(root, name)):
                    # A read-only folder from the old content may prevent the removal.
                    os.chmod(os.path.join(root, name), 0o700)


def _remove_trees(folders: Sequence[Path]) -> None:
    """Remove folders as far as possible, several subfolders at a time, because disks can take 3 ms for each folder."""
    todo = [Path(root, name) for folder in folders for root, names, _ in os.walk(folder) for name in names]
    todo.sort(key=lambda path: len(path.parts))

    def work() -> None:
        with suppress(IndexError):
            while True:
                shutil.rmtree(todo.pop(), ignore_errors=True)

    workers = [Thread(target=work) for _ in range(min(len(todo), _MOST_THREADS))]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


def _save_late_files(saved_folder: Path, place: Path) -> None:
    """Move foreign files to the target's folder that were saved in its old content after it had been copied."""
    if not (saved_folder / LIST).is_file() or not place.is_dir():
        return
    ours = {*listed_in(saved_folder), *listed_in(place), LIST}
    for path in _files_in(saved_folder):
        if path not in ours and _is_later(saved_file := saved_folder / path, target_file := place / path):
            target_file.parent.mkdir(parents=True, exist_ok=True)
            os.replace(saved_file, target_file)


def _files_in(folder: Path) -> Iterator[str]:
    """Yield the path of each file in a folder, as text, because making a ``Path`` takes longer than walking."""
    for root, _, names in os.walk(folder):
        relative_folder = Path(root).relative_to(folder)
        yield from names if relative_folder == Path() else (f"{relative_folder.as_posix()}/{name}" for name in names)


def _is_later(saved_file: Path, target_file: Path) -> bool:
    """Return whether a file is missing in the target's folder, or older there."""
    if not os.path.lexists(target_file):
        return True
    new, old = os.lstat(saved_file), os.lstat(target_file)
    are_files = stat.S_ISREG(new.st_mode) and stat.S_ISREG(old.st_mode)
    return are_files and new.st_ino != old.st_ino and new.st_mtime_ns > old.st_mtime_ns


def _refuse_bad_paths(folder: Path, target: str, files: Mapping[str, str]) -> None:
    for path in files:
        if not _SAFE.fullmatch(path) or ".." in path.split("/") or path.split("/")[0] != target:
            raise WriteError(
                f"the target '{target}' uses the path '{path}', which is not inside its folder '{target}/'"
            )
    place = folder / target
    if place.is_symlink():
        raise WriteError(f"{place} is a link; output is written to real folders only")
    for needed in (folder, place):
        if _kind_of(needed) == "file":
            raise WriteError(f"{needed} is a file, but must be a folder; nothing has changed")


def _refuse_what_is_in_the_way(
    folder: Path, targets: Mapping[str, Mapping[str, str]], changes_by_target: Mapping[str, list[Change]], force: bool
) -> None:
    """Refuse to overwrite anything that is not in our lists. ``force`` permits it for files, but not for folders."""
    blocked: list[str] = []
    for target, files in targets.items():
        differing = {change.path for change in changes_by_target[target] if change.what == "written"}
        for path, why in _in_the_way(folder, target, files, differing):
            if not force or why == _A_FOLDER:
                blocked.append(f"\n  {(folder / path).as_posix()}{why}")
    if blocked:
        all_folders = all(line.endswith(_A_FOLDER) for line in blocked)
        remedy = "move it away" if all_folders else "move it away, or overwrite files with --force"
        raise WriteError(f"in the way and not written by codewheel; nothing has changed; {remedy}:{''.join(blocked)}")


def _in_the_way(folder: Path, target: str, files: Mapping[str, str], differing: set[str]) -> Iterator[tuple[str, str]]:
    """Yield files and folders that codewheel did not write where ``files`` or their folders go, each with a note."""
    ours = set(_ours(folder, target))
    nearest = [Path(path) for path in {os.path.dirname(path) for path in files}]
    folders = {parent_folder.as_posix() for path in nearest for parent_folder in (path, *path.parents)} - {".", target}
    for path in sorted(folders - ours):
        if _kind_of(folder / path) in ("file", "link"):
            yield path, ", in place of a folder"
    for path in sorted(differing):
        kind = _kind_of(folder / path)
        if kind == "folder":
            yield path, _A_FOLDER
        elif kind and path not in ours:
            yield path, ""
    path = f"{target}/{LIST}"
    if _kind_of(folder / path) == "folder":
        yield path, _A_FOLDER
    elif _kind_of(folder / path) and not (_read(folder / path) or b"").startswith(_LIST_SIGN):
        yield path, ""


def _kind_of(place: Path) -> str:
    """Return ``folder``, ``link``, ``file`` (for anything else), or an empty string if nothing exists."""
    try:
        mode = os.lstat(place).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return ""
    except OSError as error:
        raise WriteError(f"cannot read {place}: {error.strerror}") from None
    return "folder" if stat.S_ISDIR(mode) else "link" if stat.S_ISLNK(mode) else "file"


def _read(path: Path) -> bytes | None:
    try:
        return path.read_bytes() if stat.S_ISREG(os.lstat(path).st_mode) else None
    except FileNotFoundError:
        return None
    except OSError as error:
        if isinstance(error, NotADirectoryError):
            return None
        raise WriteError(f"cannot read {path}: {error.strerror}") from None


def listed_in(place: Path) -> list[str]:
    """Return the paths in the list of a target's folder, relative to that folder. Paths outside it are ignored.

    Raises:
        WriteError: The list cannot be read.
    """
    text = _read(place / LIST) or b""
    lines = text.decode("utf-8", "replace").splitlines()
    return [line for line in lines if _SAFE.fullmatch(line) and ".." not in line.split("/")]


def families_in(place: Path) -> list[str]:
    """Return the families that a target's folder was written from. Lists of earlier versions do not record them.

    Raises:
        WriteError: The list cannot be read.
    """
    text = (_read(place / LIST) or b"").decode("utf-8", "replace")
    line = next((line for line in text.splitlines() if line.startswith(_FAMILIES)), _FAMILIES)
    return line.removeprefix(_FAMILIES).split()


def _ours(folder: Path, target: str) -> list[str]:
    return sorted(f"{target}/{line}" for line in listed_in(folder / target))


@dataclass(frozen=True, slots=True)
class _Stage:
    """Folder in which the new content of a target's folder is assembled: ``folder``, marked as ours, contains ``new``.

    The old content ends up in ``new``, or in ``old`` if two folders cannot be exchanged in one step.
    """

    folder: Path
    place: Path
    _modes: dict[Path, int] = field(default_factory=dict)

    @property
    def new(self) -> Path:
        return self.folder / _NEW

    @property
    def old(self) -> Path:
        return self.folder / _OLD

    def fill(self, files: Mapping[str, str], families: Sequence[str], unchanged: set[str]) -> None:
        """Fill the stage with the whole content of the target's folder. Unchanged files become hard links."""
        (self.folder / _MARK).write_text(_MARK_TEXT, encoding="utf-8", newline="\n")
        self._make(Path())
        names_inside = {name.partition("/")[2]: name for name in files}
        # The list comes first: without it, a later run would take the files of a killed run for the user's.
        list_text = "".join(f"{path}\n" for path in sorted(names_inside))
        head = _LIST_HEAD + (f"{_FAMILIES}{' '.join(families)}\n" if families else "")
        (self.new / LIST).write_text(head + list_text, encoding="utf-8", newline="\n")
        for parent in {os.path.dirname(path) for path in names_inside}:
            self._make(Path(parent))
        target_prefix, place = os.path.join(self.new, ""), os.path.join(self.place, "")
        for path, name in names_inside.items():
            new = target_prefix + path
            if name in unchanged:
                _same(place + path, new)
            else:
                with open(new, "x", encoding="utf-8", newline="\n") as file:
                    file.write(files[name])
        self._carry_over({*listed_in(self.place), LIST})
        for new_folder, mode in reversed(self._modes.items()):
            if mode & 0o700 != 0o700:
                new_folder.chmod(mode)

    def _carry_over(self, ours: set[str]) -> None:
        """Keep foreign files and empty folders in the new content. A folder that held only our files is not kept."""
        for root, folders, names in os.walk(self.place, onerror=_raise) if self.place.is_dir() else ():
            relative_folder = Path(root).relative_to(self.place)
            start = "" if relative_folder == Path() else f"{relative_folder.as_posix()}/"
            for name in (*names, *(name for name in folders if os.path.islink(os.path.join(root, name)))):
                path = start + name
                if path not in ours and not os.path.lexists(self.new / path):
                    self._make(relative_folder)
                    _same(os.path.join(root, name), self.new / path)
            if not names and not folders:
                self._make(relative_folder)

    def _make(self, path: Path) -> None:
        """Create a folder in the new content, with the owner and mode of the old folder of the same name."""
        new_folder, old = self.new / path, self.place / path
        if new_folder in self._modes:
            return
        if path != Path():
            self._make(path.parent)
        new_folder.mkdir()
        self._modes[new_folder] = 0o700
        if old.is_dir() and not old.is_symlink():
            old_status = old.stat()
            with suppress(OSError, AttributeError):  # only the owner can do this, and not on every system
                os.chown(new_folder, old_status.st_uid, old_status.st_gid)
            shutil.copystat(old, new_folder)
            self._modes[new_folder] = stat.S_IMODE(old_status.st_mode)
            new_folder.chmod(self._modes[new_folder] | 0o700)


def _raise(error: OSError) -> None:
    raise error


def _same(old: str | Path, new: str | Path) -> None:
    try:
        os.link(old, new, follow_symlinks=False)
    except OSError:
        shutil.copy2(old, new, follow_symlinks=False)


def _exchange(stage: Path, place: Path) -> None:
    """Exchange the two folders, in one step if the system supports that. ``place`` need not exist yet."""
    if not place.exists():
        os.rename(stage, place)
        return
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
        if rename(_AT_FDCWD, os.fsencode(stage), _AT_FDCWD, os.fsencode(place), _RENAME_EXCHANGE) == 0:
            return
    except (AttributeError, OSError, TypeError):
        pass
    # If the system cannot exchange folders, rename twice, and undo the first rename if the second fails.
    old = stage.with_name(_OLD)
    os.rename(place, old)
    try:
        os.rename(stage, place)
    except OSError:
        os.rename(old, place)
        raise
