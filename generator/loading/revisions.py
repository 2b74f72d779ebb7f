"""Read specs from a git revision: write a file or folder such as ``v1.0:specs/acme`` to a temporary folder.

git is used only to read objects, without shell, filters, hooks or network, and user text is never passed where git
expects an option. A tree is untrusted input: its names do not choose folders, and sizes are checked before a file is
read.
"""

from __future__ import annotations

import os
import posixpath
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from threading import Event, Timer
from typing import IO

from ..language.document import visible
from ..language.files import SUFFIXES
from ..language.problems import suggest_word
from ..language.read import MAX_BYTES

_MAX_FILES = 1000
#: Largest total size of the specs in a revision, in bytes.
_MAX_TOTAL_BYTES = 16 * MAX_BYTES
#: Largest list of files in a revision, in bytes. A tree of a few kB can list more files than any disk holds.
_MAX_LIST_BYTES = 16 * 2**20
#: Longest time that git may take.
_TIMEOUT_S = 60
#: Modes of regular files in a tree. Links and submodules have other modes.
_FILE_MODE, _EXECUTABLE_MODE = "100644", "100755"
#: File of the manufacturer, in the folder of its specs.
_MANUFACTURER_FILE = "manufacturer.yaml"
#: A part of a path that git does not check out, or that leads to a different folder on some systems: an empty part,
#: ``..``, ``C:``, or a part with a backslash.
_BAD_PART = re.compile(r"|\.\.?|[A-Za-z]:.*|.*[\\\0].*", re.DOTALL)
#: The beginning of a Windows path. A revision with a name of one letter is not mistaken for a drive, because paths in
#: revisions do not begin with a slash.
_ON_A_DRIVE = re.compile(r"[A-Za-z]:[\\/]")
#: A file name that is safe on every system. It is kept, because a family has the name of its spec file.
_PLAIN_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")
#: git fetches nothing, not even what a partial clone left on the server. A version that does not know GIT_NO_LAZY_FETCH
#: must not use any protocol.
_QUIET = {
    "GIT_TERMINAL_PROMPT": "0",
    "GIT_OPTIONAL_LOCKS": "0",
    "GIT_NO_LAZY_FETCH": "1",
    "GIT_ALLOW_PROTOCOL": "",
    "LC_ALL": "C",
}


class RevisionError(ValueError):
    """The revision or the path in it does not exist or cannot be read. The message names it."""


@dataclass(frozen=True, slots=True)
class RevisionPath:
    """A path in a revision. ``path`` is empty for the whole repository."""

    revision: str
    path: str

    def __str__(self) -> str:
        return f"{self.revision}:{self.path}"


@dataclass(frozen=True, slots=True)
class RevisionFiles:
    """Specs from a revision on disk: the file or folder to read, and the original name of each path."""

    place: Path
    names: Mapping[str, str]


def revision_in(text: str) -> RevisionPath | None:
    """Return the revision and the path in a text such as ``v1.0:specs``, or None.

    A text without a colon is not a revision, and neither is a path that exists or one with a drive, such as
    ``C:\\specs``.
    """
    revision, colon, path = text.partition(":")
    is_path = os.path.lexists(text) or _ON_A_DRIVE.match(text)
    if not colon or is_path:
        return None
    return RevisionPath(revision, path)


def _write_new(file: Path, content: bytes) -> None:
    """Write a file that does not exist yet, and create its folder if needed."""
    file.parent.mkdir(exist_ok=True)
    with open(file, "xb") as target_file:
        target_file.write(content)


def write_revision(revision_path: RevisionPath, folder: Path) -> RevisionFiles:
    """Write the specs of a revision to an empty folder. With a single spec, its manufacturer's file is written too.

    Folders are renamed to numbers. Files keep their names if these are valid on every system.

    Raises:
        RevisionError: The revision cannot be read, or contains names or sizes that specs cannot have.
    """
    commit = _find_commit(revision_path.revision)
    path = _path_in_repository(revision_path)
    blobs_by_path = _list_files(commit, path)
    if not blobs_by_path:
        raise RevisionError(f"there is no {visible(path) or 'file'} in {visible(revision_path.revision)}")
    is_single_file = path in blobs_by_path
    manufacturer_path = posixpath.join(posixpath.dirname(path), _MANUFACTURER_FILE)
    if is_single_file and path != manufacturer_path:
        blobs_by_path |= _list_files(commit, manufacturer_path)
    blobs_of_specs: dict[str, str] = {}
    for name, blob in blobs_by_path.items():
        # If the path names a single file, it is a spec, whatever its suffix.
        if name.endswith(SUFFIXES) or name == path:
            blobs_of_specs[name] = blob
    _reject_bad_names(revision_path.revision, blobs_of_specs)  # This includes the names of hidden files.
    if not is_single_file:
        for name in list(blobs_of_specs):
            if _is_hidden(name.removeprefix(path)):
                del blobs_of_specs[name]
    if len(blobs_of_specs) > _MAX_FILES:
        raise RevisionError(
            f"{visible(str(revision_path))} contains {len(blobs_of_specs)} YAML files; name the folder of the specs"
        )
    _reject_large_files(revision_path, blobs_of_specs)
    content_by_blob = _read_contents(blobs_of_specs.values())
    target_paths = _target_paths(blobs_of_specs, folder)
    for name, file in target_paths.items():
        _write_new(file, content_by_blob[blobs_of_specs[name]])
    shown_names = {str(folder): str(RevisionPath(revision_path.revision, path))}
    shown_names |= {str(file): f"{revision_path.revision}:{name}" for name, file in target_paths.items()}
    return RevisionFiles(target_paths.get(path, folder), shown_names)


def _reject_bad_names(revision: str, names: Iterable[str]) -> None:
    """Raise a ``RevisionError`` for the first path with a part that is not safe, such as ``..``."""
    for name in names:
        unsafe_part = next(filter(_BAD_PART.fullmatch, name.split("/")), None)
        if unsafe_part is not None:
            problem = f"{visible(revision)} contains a file '{visible(name)}'"
            raise RevisionError(f"{problem}; '{visible(unsafe_part)}' is not a safe name, so the revision is not read")


def _is_hidden(file_name: str) -> bool:
    """Return whether a part of a file's path begins with a dot. Such files are ignored in folders of specs."""
    return any(part.startswith(".") for part in file_name.split("/"))


def _target_paths(names: Iterable[str], folder: Path) -> dict[str, Path]:
    """Return the path to which each file is written, below ``folder``. Files from one folder stay together.

    A file is renamed if its name is not safe on every system, or if an earlier path only differs in case.
    """
    folders: dict[str, Path] = {}
    paths: dict[str, Path] = {}
    used_names: set[str] = set()
    for number, name in enumerate(names):
        parent, _, file_name = name.rpartition("/")
        target_folder = folders.setdefault(parent, folder / str(len(folders)))
        keeps_name = _PLAIN_NAME.fullmatch(file_name) and name.lower() not in used_names
        target_name = file_name if keeps_name else f"{number}.yaml"
        paths[name] = target_folder / target_name
        used_names.add(name.lower())
    return paths


def _find_commit(revision: str) -> str:
    """Return the hash of the commit that a revision names.

    Raises:
        RevisionError: The text does not name a revision, or the revision does not exist.
    """
    revision_text = visible(revision)
    if not revision or revision.startswith("-") or "\0" in revision:
        raise RevisionError(f"'{revision_text}' is not a revision; write it like v1.0:specs/my_encoder.yaml")
    try:
        commit = _run_git(["rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}"])
    except _GitFailed:
        # This lists the names of all branches and tags, one per line.
        listing = _run_git(["for-each-ref", "--format=%(refname:short)"]).decode(errors="replace")
        reference_names = [name for name in listing.split("\n") if name]
        hint = suggest_word(revision, reference_names[:_MAX_FILES])
        raise RevisionError(f"there is no revision '{revision_text}' in this repository{visible(hint)}") from None
    return commit.decode().strip()


def _path_in_repository(revision_path: RevisionPath) -> str:
    """Return the path from the top of the repository, or "" for the whole repository.

    A path that begins with a dot is relative to the current folder. Any other path is relative to the top.

    Raises:
        RevisionError: The path is outside the repository.
    """
    path = revision_path.path
    is_relative = path in (".", "..") or path.startswith(("./", "../"))
    if is_relative:
        current_folder = _run_git(["rev-parse", "--show-prefix"]).decode().removesuffix("\n")
        path = posixpath.join(current_folder, path)
    if path:
        path = posixpath.normpath(path)
    if path == ".":  # The top of the repository.
        path = ""
    if path.startswith(("/", "../")) or path == ".." or "\0" in path:
        raise RevisionError(f"{visible(str(revision_path))} is outside the repository; paths are relative to its top")
    return path


def _list_files(commit: str, path: str) -> dict[str, str]:
    """Return the regular files of a commit at or below a path, each with the hash of its content.

    If ``path`` is empty, all files are returned. Links and submodules are left out.
    """
    limited_to_path = ["--", path] if path else []
    listing = _run_git(["ls-tree", "-r", "-z", "--full-tree", commit, *limited_to_path])
    blobs_by_path = {}
    # A line is ``MODE TYPE HASH``, a tab and the path.
    for tree_line in filter(None, listing.split(b"\0")):
        mode_and_blob, _, name = tree_line.partition(b"\t")
        mode, _, blob = mode_and_blob.decode().split(" ")
        file_path = os.fsdecode(name)
        is_regular_file = mode in (_FILE_MODE, _EXECUTABLE_MODE)
        is_at_or_below = path in ("", file_path) or file_path.startswith(f"{path}/")
        if is_regular_file and is_at_or_below:
            blobs_by_path[file_path] = blob
    return blobs_by_path


def _reject_large_files(revision_path: RevisionPath, specs: Mapping[str, str]) -> None:
    """Raise a ``RevisionError`` if a file is too large, if all files together are, or if the content of one is missing.

    The content of a file can be missing in a partial clone.
    """
    command = ["cat-file", "--batch-check=%(objectname) %(objecttype) %(objectsize)"]
    replies = _run_git(command, specs.values()).decode()
    sizes: dict[str, int] = {}
    for reply in replies.splitlines():
        # A reply is ``HASH blob SIZE``, or ``HASH missing``.
        blob, _, type_and_size = reply.partition(" ")
        object_type, _, size = type_and_size.partition(" ")
        if object_type == "blob":
            sizes[blob] = int(size)
    for name, blob in specs.items():
        file_text = f"{visible(revision_path.revision)}:{visible(name)}"
        if blob not in sizes:
            raise RevisionError(f"the content of {file_text} is not in this repository; fetch it first")
        if sizes[blob] > MAX_BYTES:
            message = f"{file_text} is larger than {MAX_BYTES // 2**20} MB and cannot be a spec"
            raise RevisionError(f"{message}; name the folder of the specs")
    if sum(sizes[blob] for blob in specs.values()) > _MAX_TOTAL_BYTES:
        message = f"the YAML files of {visible(str(revision_path))} exceed {_MAX_TOTAL_BYTES // 2**20} MB in total"
        raise RevisionError(f"{message}; name the folder of the specs")


def _read_contents(blobs: Iterable[str]) -> dict[str, bytes]:
    """Return the content of each blob by its hash. The sizes of the blobs have already been checked.

    For each blob, git prints a line ``HASH TYPE SIZE``, the content and a newline.
    """
    printed = _run_git(["cat-file", "--batch"], blobs, max_bytes=2 * _MAX_TOTAL_BYTES)
    content_by_blob = {}
    start_of_head = 0
    while start_of_head < len(printed):
        end_of_head = printed.index(b"\n", start_of_head)
        blob, _, size = printed[start_of_head:end_of_head].decode().split(" ")
        start_of_content = end_of_head + 1
        end_of_content = start_of_content + int(size)
        content_by_blob[blob] = printed[start_of_content:end_of_content]
        start_of_head = end_of_content + 1  # After the newline.
    return content_by_blob


class _GitFailed(RevisionError):
    """git failed."""


def _run_git(arguments: Sequence[str], lines: Iterable[str] = (), max_bytes: int = _MAX_LIST_BYTES) -> bytes:
    """Run git with these arguments and lines of input, and return its output.

    Raises:
        RevisionError: There is no git or no repository, or git takes too long or prints more than ``max_bytes`` bytes.
        _GitFailed: git fails.
    """
    environment = {name: value for name, value in os.environ.items() if name != "GIT_LITERAL_PATHSPECS"}
    command = ["git", "--no-pager", "--no-replace-objects", "--literal-pathspecs", *arguments]
    try:
        with TemporaryFile() as input_file, TemporaryFile() as errors:
            input_file.write("".join(f"{line}\n" for line in lines).encode())
            input_file.seek(0)
            code, printed = _run_command(
                command, input_file=input_file, errors=errors, environment=environment | _QUIET, max_bytes=max_bytes
            )
            errors.seek(0)
            first_line, *_ = errors.read(4096).decode(errors="replace").strip().split("\n")
            error_text = visible(first_line)
    except RevisionError:
        raise
    except FileNotFoundError:
        raise RevisionError("git is not installed; only files and folders can be compared") from None
    except (OSError, ValueError) as error:
        raise RevisionError(f"cannot run git: {error}") from None
    if code == 0:
        return printed
    if "not a git repository" in error_text:
        raise RevisionError("the current folder is not in a git repository, so there are no revisions to read")
    raise _GitFailed(f"git failed: {error_text.removeprefix('fatal: ') or f'exit code {code}'}")


def _run_command(
    command: Sequence[str], input_file: IO[bytes], errors: IO[bytes], environment: Mapping[str, str], max_bytes: int
) -> tuple[int, bytes]:
    """Run a command, and return its exit code and output. Stop it if it takes too long or prints too much.

    Raises:
        RevisionError: It takes too long, or prints more than ``max_bytes`` bytes.
    """
    with subprocess.Popen(command, stdin=input_file, stdout=subprocess.PIPE, stderr=errors, env=environment) as running:
        timed_out = Event()
        timer = Timer(_TIMEOUT_S, _stop_command, (running, timed_out))
        timer.start()
        try:
            # One more byte shows that the output is too long.
            printed = running.stdout.read(max_bytes + 1) if running.stdout else b""
            if len(printed) > max_bytes:
                running.kill()
            code = running.wait()
        finally:
            timer.cancel()
    if timed_out.is_set():
        raise RevisionError(f"git did not answer within {_TIMEOUT_S} s")
    if len(printed) > max_bytes:
        raise RevisionError(f"git lists more than {max_bytes // 2**20} MB here; name the folder of the specs")
    return code, printed


def _stop_command(running: subprocess.Popen[bytes], timed_out: Event) -> None:
    """Stop a command that takes too long. Setting ``timed_out`` distinguishes this from a normal end."""
    timed_out.set()
    running.kill()
