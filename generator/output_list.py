"""The list in each target's folder: the files that codewheel wrote, and the families that they were written from."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable, Sequence
from pathlib import Path

LIST = ".codewheel"
LIST_HEAD = "# Written by codewheel generate, which removes files of this list that it no longer writes.\n"
LIST_SIGN = b"# Written by codewheel generate"
#: Begins the line of a list with the families that the target's folder was written from.
_FAMILIES = "# Families: "
#: Paths that lead out of no folder, and that are the same on every system.
_SAFE_PATH = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*(/[A-Za-z0-9_.][A-Za-z0-9._-]*)*")


class WriteError(Exception):
    """The output could not be written or compared. The message states if anything has changed."""


def list_text(paths: Iterable[str], families: Sequence[str]) -> str:
    """Return the text of the list with these paths, which are relative to the target's folder."""
    families_line = f"{_FAMILIES}{' '.join(families)}\n" if families else ""
    return LIST_HEAD + families_line + "".join(f"{path}\n" for path in sorted(paths))


def is_safe(path: str) -> bool:
    """Return True if a path leads out of no folder."""
    return _SAFE_PATH.fullmatch(path) is not None and ".." not in path.split("/")


def listed_in(target_folder: Path) -> list[str]:
    """Return the paths in the list of a target's folder, relative to that folder. Paths outside it are ignored.

    Raises:
        WriteError: The list cannot be read.
    """
    text = read_file(target_folder / LIST) or b""
    return [line for line in text.decode("utf-8", "replace").splitlines() if is_safe(line)]


def families_in(target_folder: Path) -> list[str]:
    """Return the families that a target's folder was written from. Lists of earlier versions do not record them.

    Raises:
        WriteError: The list cannot be read.
    """
    text = (read_file(target_folder / LIST) or b"").decode("utf-8", "replace")
    family_lines = [line for line in text.splitlines() if line.startswith(_FAMILIES)]
    return family_lines[0].removeprefix(_FAMILIES).split() if family_lines else []


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
