"""Writing: the only module that touches the output folder.

Each target owns one folder of the output. Its new content is put together beside the old one, in full, and only when every target is
complete do the folders change places. Files of a target folder that are not ours are kept; a list in the folder names those that are.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_LIST = ".codewheel"
_LIST_HEAD = "# Written by codewheel generate, which removes files of this list that it no longer writes.\n"
_SAFE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*(/[A-Za-z0-9_.][A-Za-z0-9._-]*)*")
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


class WriteError(Exception):
    """The output could not be written or compared; the old files are as they were."""


@dataclass(frozen=True, slots=True)
class Change:
    """What happens to one file: ``written``, ``unchanged`` or ``removed``."""

    path: str
    what: str


def changes(folder: Path, target: str, files: Mapping[str, str]) -> list[Change]:
    """What writing ``files`` would do to the target's folder, in order of path.

    Args:
        folder: The output folder.
        target: The target's name, which is the first part of every path.
        files: Text by path, relative to the output folder, parted by slashes.

    Raises:
        WriteError: A path leads out of the target's folder, or the folder cannot be read.
    """
    _refuse_bad_paths(folder, target, files)
    found = [Change(path, "unchanged" if _read(folder / path) == text.encode() else "written") for path, text in files.items()]
    found += [Change(path, "removed") for path in _ours(folder, target) if path not in files and (folder / path).is_file()]
    return sorted(found, key=lambda item: item.path)


def write(folder: Path, targets: Mapping[str, Mapping[str, str]]) -> list[Change]:
    """Make the folders of ``targets`` hold exactly their files, besides files that are not ours.

    Raises:
        WriteError: Something could not be written. Nothing has changed then.
    """
    done: list[Change] = []
    stages: list[tuple[Path, Path]] = []
    try:
        for target, files in targets.items():
            found = changes(folder, target, files)
            done += found
            if any(item.what != "unchanged" for item in found) or _ours(folder, target) != sorted(files):
                folder.mkdir(parents=True, exist_ok=True)
                _clear(folder, target)
                stage = Path(tempfile.mkdtemp(prefix=f".{target}-", dir=folder))
                stages.append((stage, folder / target))
                _fill(stage, folder, target, files, {item.path for item in found if item.what == "unchanged"})
        while stages:
            stage, place = stages[0]
            _exchange(stage, place)
            stages.pop(0)
            shutil.rmtree(stage, ignore_errors=True)
    except OSError as error:
        raise WriteError(f"cannot write {error.filename or folder}: {error.strerror or error}") from None
    finally:
        for stage, _ in stages:
            shutil.rmtree(stage, ignore_errors=True)
    return done


def _clear(folder: Path, target: str) -> None:
    """Remove what a killed run has left behind."""
    for left in folder.glob(f".{target}-????????*"):
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)


def _refuse_bad_paths(folder: Path, target: str, files: Mapping[str, str]) -> None:
    for path in files:
        if not _SAFE.fullmatch(path) or ".." in path.split("/") or path.split("/")[0] != target:
            raise WriteError(f"the target '{target}' asks for the path '{path}', which is not one inside its folder '{target}/'")
    if (folder / target).is_symlink():
        raise WriteError(f"{folder / target} is a link; the output goes into real folders only")


def _read(path: Path) -> bytes | None:
    try:
        return path.read_bytes() if stat.S_ISREG(os.lstat(path).st_mode) else None
    except FileNotFoundError:
        return None
    except OSError as error:
        if isinstance(error, NotADirectoryError):
            return None
        raise WriteError(f"cannot read {path}: {error.strerror}") from None


def _ours(folder: Path, target: str) -> list[str]:
    """The paths that the folder's list names; what is not a path inside the folder is passed over."""
    text = _read(folder / target / _LIST) or b""
    lines = text.decode("utf-8", "replace").splitlines()
    return sorted(f"{target}/{line}" for line in lines if _SAFE.fullmatch(line) and ".." not in line.split("/"))


def _fill(stage: Path, folder: Path, target: str, files: Mapping[str, str], unchanged: set[str]) -> None:
    """Put into ``stage`` all that the target's folder shall hold; what stays as it is becomes a second name of the same file."""
    ours = set(_ours(folder, target)) | set(files)
    stage.chmod(0o777 & ~_umask())
    for path, text in files.items():
        place = stage / path.removeprefix(f"{target}/")
        place.parent.mkdir(parents=True, exist_ok=True)
        if path in unchanged:
            _same(folder / path, place)
        else:
            with open(place, "x", encoding="utf-8", newline="\n") as file:
                file.write(text)
    (stage / _LIST).write_text(_LIST_HEAD + "".join(f"{path.removeprefix(f'{target}/')}\n" for path in sorted(files)), encoding="utf-8", newline="\n")
    for root, folders, names in os.walk(folder / target):
        here = Path(root).relative_to(folder / target)
        names += [name for name in folders if (Path(root) / name).is_symlink()]
        for name in names:
            path = (here / name).as_posix()
            if f"{target}/{path}" not in ours and path != _LIST and not (stage / path).exists():
                (stage / path).parent.mkdir(parents=True, exist_ok=True)
                _same(Path(root) / name, stage / path)


def _same(old: Path, new: Path) -> None:
    try:
        os.link(old, new, follow_symlinks=False)
    except OSError:
        shutil.copy2(old, new, follow_symlinks=False)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _exchange(stage: Path, place: Path) -> None:
    """Let the two folders change places, in one step where the system can; ``place`` need not exist yet."""
    if not place.exists():
        os.rename(stage, place)
        return
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
        if rename(_AT_FDCWD, os.fsencode(stage), _AT_FDCWD, os.fsencode(place), _RENAME_EXCHANGE) == 0:
            return
    except (AttributeError, OSError, TypeError):
        pass
    # No exchange here: two renames, and back again if the second one fails.
    old = stage.with_name(stage.name + "-old")
    os.rename(place, old)
    try:
        os.rename(stage, place)
    except OSError:
        os.rename(old, place)
        raise
    os.rename(old, stage)
