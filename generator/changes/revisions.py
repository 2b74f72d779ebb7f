"""Specs as they were: a file or folder of a git revision, such as ``v1.0:specs/lika``, laid out in a folder.

git is only asked for what it holds: no shell, no filter, no hook and no network has a part in it, and no text of the
user's stands where git looks for an option.
"""

from __future__ import annotations

import os
import posixpath
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from ..spec.files import SUFFIXES
from ..spec.problems import suggestion, visible
from ..spec.yaml import MAX_BYTES

_MOST_FILES = 1000
_PATIENCE_S = 60
_FILE, _EXECUTABLE = "100644", "100755"
_BESIDE = "manufacturer.yaml"


class RevisionError(ValueError):
    """There is no such revision, or nothing of that name in it; the message says which."""


@dataclass(frozen=True, slots=True)
class Named:
    """A place in history: ``path`` is empty for the whole repository."""

    revision: str
    path: str

    def __str__(self) -> str:
        return f"{self.revision}:{self.path}"


def named(text: str) -> Named | None:
    """The revision and path that ``text`` names; None where it is a path, or no revision."""
    revision, colon, path = text.partition(":")
    return Named(revision, path) if colon and not os.path.lexists(text) else None


def lay_out(place: Named, folder: Path) -> Path:
    """Write the specs of a revision into ``folder``, each at its path in the repository.

    Returns:
        Where the file or folder lies that was named; a manufacturer's file beside a file is there as well.

    Raises:
        RevisionError: It cannot be read.
    """
    commit = _commit(place.revision)
    path = _in_repository(place)
    entries = _entries(commit, path)
    if not entries:
        raise RevisionError(f"there is no {visible(path) or 'file'} in {visible(place.revision)}")
    if path in entries:
        beside = posixpath.join(posixpath.dirname(path), _BESIDE)
        entries |= {} if path == beside else _entries(commit, beside)
    specs = {name: blob for name, blob in entries.items() if name.endswith(SUFFIXES) or name == path}
    if len(specs) > _MOST_FILES:
        raise RevisionError(f"{visible(str(place))} holds {len(specs)} YAML files; name the folder of the specs")
    for name, blob in specs.items():
        file = folder / PurePosixPath(name)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(_git(["cat-file", "blob", blob])[: MAX_BYTES + 1])
    made = folder / PurePosixPath(path)
    if not made.exists():
        made.mkdir(parents=True)
    return made


def _commit(revision: str) -> str:
    shown = visible(revision)
    if not revision or revision.startswith("-") or "\0" in revision:
        raise RevisionError(f"'{shown}' is no revision; write it as in v1.0:specs/my_encoder.yaml")
    try:
        found = _git(["rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}"])
    except _Refused:
        names = _git(["for-each-ref", "--format=%(refname:short)"]).decode(errors="replace").split("\n")
        near = suggestion(revision, [name for name in names if name][:_MOST_FILES])
        raise RevisionError(f"there is no revision '{shown}' in this repository{visible(near)}") from None
    return found.decode().strip()


def _in_repository(place: Named) -> str:
    """The path from the top of the repository; one that begins with a dot is from the current folder."""
    path = place.path
    if path in (".", "..") or path.startswith(("./", "../")):
        path = posixpath.join(_git(["rev-parse", "--show-prefix"]).decode().removesuffix("\n"), path)
    path = posixpath.normpath(path) if path else ""
    path = "" if path == "." else path
    if path.startswith(("/", "../")) or path == ".." or "\0" in path:
        raise RevisionError(f"{visible(str(place))} is outside of the repository; paths begin at its top")
    return path


def _entries(commit: str, path: str) -> dict[str, str]:
    """The regular files of a commit at or below a path, and the object of each."""
    listed = _git(["ls-tree", "-r", "-z", "--full-tree", commit, *(["--", path] if path else [])])
    found = {}
    for entry in filter(None, listed.split(b"\0")):
        head, _, name = entry.partition(b"\t")
        mode, _, blob = head.decode().split(" ")
        text = os.fsdecode(name)
        if mode in (_FILE, _EXECUTABLE) and (path in ("", text) or text.startswith(f"{path}/")):
            found[text] = blob
    return found


class _Refused(RevisionError):
    """git says no."""


def _git(arguments: Sequence[str]) -> bytes:
    """What git prints.

    Raises:
        RevisionError: There is no git or no repository, or git takes too long.
        _Refused: git ends with an error.
    """
    kept = {name: value for name, value in os.environ.items() if name != "GIT_LITERAL_PATHSPECS"}
    quiet = {"GIT_TERMINAL_PROMPT": "0", "GIT_OPTIONAL_LOCKS": "0", "GIT_NO_LAZY_FETCH": "1", "LC_ALL": "C"}
    command = ["git", "--no-pager", "--no-replace-objects", "--literal-pathspecs", *arguments]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PATIENCE_S, env=kept | quiet
        )
    except FileNotFoundError:
        raise RevisionError("git is not installed; without it only files and folders can be compared") from None
    except subprocess.TimeoutExpired:
        raise RevisionError(f"git did not answer within {_PATIENCE_S} s") from None
    except (OSError, ValueError) as error:
        raise RevisionError(f"git cannot be run: {error}") from None
    if done.returncode == 0:
        return done.stdout
    said = visible(done.stderr.decode(errors="replace").strip().split("\n")[0])
    if "not a git repository" in said:
        raise RevisionError("the current folder is in no git repository, so there are no revisions to read")
    raise _Refused(f"git cannot read that: {said.removeprefix('fatal: ')}")
