"""An output folder: the list of its files, its lock, and its stages.

A stage is a temporary folder in which the new content of a target's folder is assembled. It contains a file as a mark,
by which a later run recognises the stage of a killed run and removes it. Files of the user are never lost with a stage.

The lock is on the folder itself, so it leaves no file behind. The system releases it when the process ends for any
reason. If the file system cannot lock folders, as on some network drives, there is no lock.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

LIST = ".codewheel"
LIST_HEAD = "# Written by codewheel generate, which removes files of this list that it no longer writes.\n"
LIST_SIGN = b"# Written by codewheel generate"
#: Beginning of the line with the families that the target's folder was written from.
_FAMILIES_LINE = "# Families: "
#: Paths that stay inside the folder, and that are the same on every system.
_SAFE_PATH = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*(/[A-Za-z0-9_.][A-Za-z0-9._-]*)*")


class WriteError(Exception):
    """The output could not be written or compared. The message states whether anything has changed."""


def list_text(paths: Iterable[str], families: Sequence[str]) -> str:
    """Return the text of the list with these paths, which are relative to the target's folder."""
    families_line = f"{_FAMILIES_LINE}{' '.join(families)}\n" if families else ""
    path_lines = [f"{path}\n" for path in sorted(paths)]
    return LIST_HEAD + families_line + "".join(path_lines)


def is_safe(path: str) -> bool:
    """Return True if a path stays inside the folder."""
    return _SAFE_PATH.fullmatch(path) is not None and ".." not in path.split("/")


def listed_in(target_folder: Path) -> list[str]:
    """Return the paths in the list of a target's folder, relative to that folder. Paths outside it are ignored.

    Raises:
        WriteError: The list cannot be read.
    """
    list_content = read_file(target_folder / LIST) or b""
    return [line for line in list_content.decode("utf-8", "replace").splitlines() if is_safe(line)]


def families_in(target_folder: Path) -> list[str]:
    """Return the families that a target's folder was written from. Lists of earlier versions do not record them.

    Raises:
        WriteError: The list cannot be read.
    """
    list_content = (read_file(target_folder / LIST) or b"").decode("utf-8", "replace")
    family_lines = [line for line in list_content.splitlines() if line.startswith(_FAMILIES_LINE)]
    return family_lines[0].removeprefix(_FAMILIES_LINE).split() if family_lines else []


def read_file(path: str | Path) -> bytes | None:
    """Return the content of a file, or None if there is no regular file at the path.

    Raises:
        WriteError: The file cannot be read.
    """
    try:
        if not stat.S_ISREG(os.lstat(path).st_mode):
            return None
        with open(path, "rb") as file:
            return file.read()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise WriteError(f"cannot read {path}: {error.strerror}") from None


#: A run writes for a few seconds. A run that takes longer has been suspended or has a very slow disk.
PATIENCE_S = 60.0
_PAUSE_S = 0.1


class Busy(Exception):
    """Another process held the lock for the whole wait."""


if sys.platform == "win32":
    import hashlib
    import msvcrt

    def _open_lock(folder: Path) -> int:
        """Open a file in the user's temporary folder that represents ``folder``, since Windows cannot lock folders."""
        real_path = os.path.normcase(os.path.realpath(folder))
        name = hashlib.sha256(real_path.encode()).hexdigest()[:16]
        lock_path = os.path.join(tempfile.gettempdir(), f"codewheel-{name}.lock")
        return os.open(lock_path, os.O_RDWR | os.O_CREAT)

    def _try_to_take_lock(handle: int, folder: Path) -> bool:
        """Lock the first byte of the open file. Return False if another process holds the lock."""
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        return True

else:
    import fcntl

    def _open_lock(folder: Path) -> int:
        return os.open(folder, os.O_RDONLY)

    def _try_to_take_lock(handle: int, folder: Path) -> bool:
        """Lock the open folder. Return False if another process holds the lock, or if ``folder`` has been replaced."""
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            return True  # this file system cannot lock folders
        try:
            return os.path.samestat(os.fstat(handle), os.stat(folder))
        except FileNotFoundError:
            return False


@contextmanager
def locked(folder: Path, before_waiting: Callable[[], None]) -> Iterator[None]:
    """Hold the lock on a folder, and create the folder if it does not exist.

    Args:
        folder: The folder. Links to the folder share its lock.
        before_waiting: Called once if another process has the lock.

    Raises:
        Busy: Another process has held the lock for ``PATIENCE_S``.
        OSError: The folder cannot be created or opened.
    """
    deadline_s = time.monotonic() + PATIENCE_S
    lock_descriptor = _try_to_lock(folder)
    if lock_descriptor is None:
        before_waiting()
    while lock_descriptor is None:
        if time.monotonic() > deadline_s:
            raise Busy
        time.sleep(_PAUSE_S)
        lock_descriptor = _try_to_lock(folder)
    try:
        yield
    finally:
        os.close(lock_descriptor)


def _try_to_lock(folder: Path) -> int | None:
    """Create the folder if it does not exist. Return the descriptor of its lock, or None if another process has it."""
    folder.mkdir(parents=True, exist_ok=True)
    lock_descriptor = _open_lock(folder)
    if _try_to_take_lock(lock_descriptor, folder):
        return lock_descriptor
    os.close(lock_descriptor)
    return None


#: Beginning of the name of a stage.
STAGE_PREFIX = ".codewheel-"
_STAGE_NAME = re.compile(rf"{re.escape(STAGE_PREFIX)}([A-Za-z0-9_.-]+)-[a-z0-9_]{{8}}")
#: The first file in a stage. The mark lets a later run distinguish the stage of a killed run from a user's folder.
_STAGE_MARK = ".codewheel-stage"
_MARK_TEXT = "Temporary folder of codewheel generate. Its next run removes it.\n"
_NEW_FOLDER, _OLD_FOLDER = "new", "old"
_AT_FDCWD = -100
_RENAME_EXCHANGE = 2


@dataclass(frozen=True, slots=True)
class Stage:
    """A stage: ``folder``, which contains the mark and the new content of ``target_folder`` in the folder ``new``.

    After the exchange, the old content is in ``new``, or in ``old`` if the system cannot exchange folders in one step.
    """

    folder: Path
    target_folder: Path
    _modes: dict[Path, int] = field(default_factory=dict)

    @classmethod
    def create(cls, target_folder: Path) -> Stage:
        """Create an empty stage for the folder of a target."""
        prefix = f"{STAGE_PREFIX}{target_folder.name}-"
        stage_folder = tempfile.mkdtemp(prefix=prefix, dir=target_folder.parent)
        return cls(Path(stage_folder), target_folder)

    @property
    def new(self) -> Path:
        return self.folder / _NEW_FOLDER

    @property
    def old(self) -> Path:
        return self.folder / _OLD_FOLDER

    def fill(self, files: Mapping[str, str], families: Sequence[str], unchanged_paths: set[str]) -> None:
        """Fill the stage with the whole content of the target's folder: our files, their list, and foreign files.

        ``files`` contains the text by the path in the output folder, such as ``c/include/x.h``. Files that are named in
        ``unchanged_paths`` become hard links to the old files.
        """
        (self.folder / _STAGE_MARK).write_text(_MARK_TEXT, encoding="utf-8", newline="\n")
        self._make_new_folder(Path())
        # The paths in the target's folder, such as "include/x.h" for "c/include/x.h".
        output_path_by_path_in_target = {output_path.partition("/")[2]: output_path for output_path in files}
        # The list is written first. Without it, a later run would treat the files of a killed run as the user's.
        (self.new / LIST).write_text(list_text(output_path_by_path_in_target, families), encoding="utf-8", newline="\n")
        for parent in {os.path.dirname(path_in_target) for path_in_target in output_path_by_path_in_target}:
            self._make_new_folder(Path(parent))
        # Texts, because joining ``Path`` objects is slow.
        new_prefix, old_prefix = os.path.join(self.new, ""), os.path.join(self.target_folder, "")
        for path_in_target, output_path in output_path_by_path_in_target.items():
            if output_path in unchanged_paths:
                _link_or_copy(old_prefix + path_in_target, new_prefix + path_in_target)
            else:
                with open(new_prefix + path_in_target, "x", encoding="utf-8", newline="\n") as file:
                    file.write(files[output_path])
        self._carry_over({*listed_in(self.target_folder), LIST})
        # Read-only folders were writable until now. The innermost ones come first.
        for new_folder, mode in reversed(self._modes.items()):
            if mode & 0o700 != 0o700:
                new_folder.chmod(mode)

    def exchange(self) -> None:
        """Exchange the new content and the target's folder."""
        _exchange(self.new, self.target_folder)

    def take_back(self) -> bool:
        """Restore the old content of the target's folder, and return True if that succeeded."""
        try:
            # The old content is in ``old`` after two renames, and in ``new`` after an exchange. If neither exists, the
            # target's folder did not exist before.
            if os.path.lexists(self.old):
                os.rename(self.target_folder, self.new)
                os.rename(self.old, self.target_folder)
            elif os.path.lexists(self.new):
                _exchange(self.new, self.target_folder)
            else:
                os.rename(self.target_folder, self.new)
        except OSError:
            return False
        return True

    def remove(self) -> None:
        """Remove the stage. The mark is removed last, so that a run killed here leaves a recognisable stage."""
        _save_from(self)
        shutil.rmtree(self.new, ignore_errors=True)
        # Without a target's folder, ``old`` contains the only copy of its content, so the stage stays.
        if os.path.lexists(self.target_folder):
            shutil.rmtree(self.old, ignore_errors=True)
        if not os.path.lexists(self.old):
            with suppress(OSError):
                (self.folder / _STAGE_MARK).unlink(missing_ok=True)
                self.folder.rmdir()

    def _carry_over(self, our_paths: set[str]) -> None:
        """Add the user's files and empty folders in the old content to the new.

        ``our_paths`` are the paths of our files. A folder with only our files is not kept. A link to a folder is
        treated like a file.
        """
        if not self.target_folder.is_dir():
            return
        for old_folder, folder_names, file_names in os.walk(self.target_folder, onerror=_raise):
            relative_folder = Path(old_folder).relative_to(self.target_folder)
            prefix = "" if relative_folder == Path() else f"{relative_folder.as_posix()}/"
            links_to_folders = [
                file_name for file_name in folder_names if os.path.islink(os.path.join(old_folder, file_name))
            ]
            for file_name in (*file_names, *links_to_folders):
                path_in_target = prefix + file_name
                if path_in_target not in our_paths and not os.path.lexists(self.new / path_in_target):
                    self._make_new_folder(relative_folder)
                    _link_or_copy(os.path.join(old_folder, file_name), self.new / path_in_target)
            if not file_names and not folder_names:
                self._make_new_folder(relative_folder)

    def _make_new_folder(self, folder_path: Path) -> None:
        """Create a folder in the new content, if it is not there yet, and the folders above it.

        It gets the owner and mode of the old folder of the same name, but stays writable until ``fill`` ends.
        """
        new_folder, old_folder = self.new / folder_path, self.target_folder / folder_path
        if new_folder in self._modes:
            return
        if folder_path != Path():
            self._make_new_folder(folder_path.parent)
        new_folder.mkdir()
        self._modes[new_folder] = 0o700
        if old_folder.is_dir() and not old_folder.is_symlink():
            old_status = old_folder.stat()
            with suppress(OSError, AttributeError):  # only the owner can do this, and not on every system
                os.chown(new_folder, old_status.st_uid, old_status.st_gid)
            shutil.copystat(old_folder, new_folder)
            self._modes[new_folder] = stat.S_IMODE(old_status.st_mode)
            new_folder.chmod(self._modes[new_folder] | 0o700)


def stages_in(folder: Path) -> list[Stage]:
    """Return the stages in the output folder: folders with a name like ``.codewheel-c-ab12cd34`` that have the mark.

    The result is empty if the folder cannot be read.
    """
    stages = []
    try:
        with os.scandir(folder) as scanned_folder:
            sorted_entries = sorted(scanned_folder, key=lambda entry: entry.name)
    except OSError:
        return []
    for entry in sorted_entries:
        stage_match = _STAGE_NAME.fullmatch(entry.name)
        if stage_match and entry.is_dir(follow_symlinks=False):
            with suppress(OSError, WriteError):
                if _has_mark(Path(entry.path)):
                    target_name = stage_match[1]  # The c of .codewheel-c-ab12cd34.
                    stages.append(Stage(Path(entry.path), folder / target_name))
    return stages


def _has_mark(folder: Path) -> bool:
    """Return whether a folder has the mark of a stage.

    If a run was killed early, the mark may be incomplete or missing. Then the folder contains no other file.
    """
    mark = read_file(folder / _STAGE_MARK)
    if mark == _MARK_TEXT.encode():
        return True
    return set(os.listdir(folder)) <= {_STAGE_MARK} and _MARK_TEXT.encode().startswith(mark or b"")


def _save_from(stage: Stage) -> None:
    """Move all content of a stage that must not be lost to the target's folder, and make the rest removable.

    This content is the old folder, if the target's folder is missing, and files that the user saved during the run.
    """
    if os.path.lexists(stage.old) and not os.path.lexists(stage.target_folder):
        with suppress(OSError):  # the run was killed between two renames
            os.rename(stage.old, stage.target_folder)
    for saved_folder in (stage.new, stage.old):
        _save_late_files(saved_folder, stage.target_folder)
    for parent_folder, folder_names, _ in os.walk(stage.folder):
        for folder_name in folder_names:
            with suppress(OSError):
                if not os.path.islink(os.path.join(parent_folder, folder_name)):
                    # A read-only folder from the old content may prevent the removal.
                    os.chmod(os.path.join(parent_folder, folder_name), 0o700)


def _save_late_files(saved_folder: Path, target_folder: Path) -> None:
    """Move files to the target's folder that the user saved in its old content after it had been copied.

    If ``saved_folder`` does not contain our list, it is not the old content, and nothing is moved.
    """
    if not (saved_folder / LIST).is_file() or not target_folder.is_dir():
        return
    our_paths = {*listed_in(saved_folder), *listed_in(target_folder), LIST}
    for path_in_target in _files_in(saved_folder):
        if path_in_target in our_paths:
            continue
        saved_file, target_file = saved_folder / path_in_target, target_folder / path_in_target
        if _is_later(saved_file, target_file):
            target_file.parent.mkdir(parents=True, exist_ok=True)
            os.replace(saved_file, target_file)


def _files_in(folder: Path) -> Iterator[str]:
    """Yield the path of each file in a folder and below it, as text, because creating ``Path`` objects is slow."""
    for root, _, names in os.walk(folder):
        relative_folder = Path(root).relative_to(folder)
        prefix = "" if relative_folder == Path() else f"{relative_folder.as_posix()}/"
        yield from (prefix + name for name in names)


def _is_later(saved_file: Path, target_file: Path) -> bool:
    """Return whether a file is missing in the target's folder, or older there."""
    if not os.path.lexists(target_file):
        return True
    saved_status, current_status = os.lstat(saved_file), os.lstat(target_file)
    are_files = stat.S_ISREG(saved_status.st_mode) and stat.S_ISREG(current_status.st_mode)
    # Hard links to the same file have the same inode number, so neither is later.
    are_same_file = saved_status.st_ino == current_status.st_ino
    return are_files and not are_same_file and saved_status.st_mtime_ns > current_status.st_mtime_ns


def _raise(error: OSError) -> None:
    raise error


def _link_or_copy(old: str | Path, new: str | Path) -> None:
    """Make ``new`` a hard link to the file or link ``old``, or a copy of it if the file system has no hard links."""
    try:
        os.link(old, new, follow_symlinks=False)
    except OSError:
        shutil.copy2(old, new, follow_symlinks=False)


def _exchange(new_folder: Path, target_folder: Path) -> None:
    """Exchange two folders, in one step if the system supports that. If not, the old content becomes ``old_folder``.

    If ``target_folder`` does not exist yet, ``new_folder`` is only renamed.
    """
    if not target_folder.exists():
        os.rename(new_folder, target_folder)
        return
    try:
        exchange_paths = ctypes.CDLL(None, use_errno=True).renameat2
        if (
            exchange_paths(_AT_FDCWD, os.fsencode(new_folder), _AT_FDCWD, os.fsencode(target_folder), _RENAME_EXCHANGE)
            == 0
        ):
            return
    except (AttributeError, OSError, TypeError):
        pass
    # If the system cannot exchange folders, rename twice, and undo the first rename if the second fails.
    old_folder = new_folder.with_name(_OLD_FOLDER)
    os.rename(target_folder, old_folder)
    try:
        os.rename(new_folder, target_folder)
    except OSError:
        os.rename(old_folder, target_folder)
        raise
