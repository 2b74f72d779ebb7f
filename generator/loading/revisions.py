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
    revision, colon, path_in_revision = text.partition(":")
    is_path_in_file_system = os.path.lexists(text) or _ON_A_DRIVE.match(text)
    if not colon or is_path_in_file_system:
        return None
    return RevisionPath(revision, path_in_revision)


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
    path_in_repository = _path_in_repository(revision_path)
    spec_blob_by_path = _find_spec_blobs(commit, revision_path, path_in_repository)
    _reject_large_files(revision_path, spec_blob_by_path)
    content_by_hash = _read_contents(spec_blob_by_path.values())
    target_paths = _target_paths(spec_blob_by_path, folder)
    for file_path, target_path in target_paths.items():
        _write_new(target_path, content_by_hash[spec_blob_by_path[file_path]])
    shown_names = {str(folder): str(RevisionPath(revision_path.revision, path_in_repository))}
    for file_path, target_path in target_paths.items():
        shown_names[str(target_path)] = f"{revision_path.revision}:{file_path}"
    return RevisionFiles(target_paths.get(path_in_repository, folder), shown_names)


def _find_spec_blobs(commit: str, revision_path: RevisionPath, path_in_repository: str) -> dict[str, str]:
    """Return the specs of a commit at or below a path, each with the hash of its content, without hidden files.

    Raises:
        RevisionError: There are no files, too many files, or files with unsafe names.
    """
    blob_hash_by_path = _list_files(commit, path_in_repository)
    if not blob_hash_by_path:
        raise RevisionError(f"there is no {visible(path_in_repository) or 'file'} in {visible(revision_path.revision)}")
    is_single_file = path_in_repository in blob_hash_by_path
    manufacturer_path = posixpath.join(posixpath.dirname(path_in_repository), _MANUFACTURER_FILE)
    if is_single_file and path_in_repository != manufacturer_path:
        blob_hash_by_path |= _list_files(commit, manufacturer_path)
    spec_blob_by_path: dict[str, str] = {}
    for file_path, blob_hash in blob_hash_by_path.items():
        # If the path names a single file, it is a spec, whatever its suffix.
        if file_path.endswith(SUFFIXES) or file_path == path_in_repository:
            spec_blob_by_path[file_path] = blob_hash
    _reject_bad_names(revision_path.revision, spec_blob_by_path)  # This includes the names of hidden files.
    if not is_single_file:
        for file_path in list(spec_blob_by_path):
            if _is_hidden(file_path.removeprefix(path_in_repository)):
                del spec_blob_by_path[file_path]
    if len(spec_blob_by_path) > _MAX_FILES:
        raise RevisionError(
            f"{visible(str(revision_path))} contains {len(spec_blob_by_path)} YAML files; name the folder of the specs"
        )
    return spec_blob_by_path


def _reject_bad_names(revision: str, file_paths: Iterable[str]) -> None:
    """Raise a ``RevisionError`` for the first path with a part that is not safe, such as ``..``."""
    for file_path in file_paths:
        unsafe_part = next(filter(_BAD_PART.fullmatch, file_path.split("/")), None)
        if unsafe_part is not None:
            problem = f"{visible(revision)} contains a file '{visible(file_path)}'"
            raise RevisionError(f"{problem}; '{visible(unsafe_part)}' is not a safe name, so the revision is not read")


def _is_hidden(file_name: str) -> bool:
    """Return whether a part of a file's path begins with a dot. Such files are ignored in folders of specs."""
    return any(part.startswith(".") for part in file_name.split("/"))


def _target_paths(file_paths: Iterable[str], folder: Path) -> dict[str, Path]:
    """Return the path to which each file is written, below ``folder``. Files from one folder stay together.

    A file is renamed if its name is not safe on every system, or if an earlier path only differs in case.
    """
    target_folder_by_parent: dict[str, Path] = {}
    target_path_by_path: dict[str, Path] = {}
    used_paths: set[str] = set()
    for number, file_path in enumerate(file_paths):
        parent, _, file_name = file_path.rpartition("/")
        target_folder = target_folder_by_parent.setdefault(parent, folder / str(len(target_folder_by_parent)))
        keeps_name = _PLAIN_NAME.fullmatch(file_name) and file_path.lower() not in used_paths
        target_name = file_name if keeps_name else f"{number}.yaml"
        target_path_by_path[file_path] = target_folder / target_name
        used_paths.add(file_path.lower())
    return target_path_by_path


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
        listed_references = _run_git(["for-each-ref", "--format=%(refname:short)"]).decode(errors="replace")
        reference_names = [name for name in listed_references.split("\n") if name]
        hint = suggest_word(revision, reference_names[:_MAX_FILES])
        raise RevisionError(f"there is no revision '{revision_text}' in this repository{visible(hint)}") from None
    return commit.decode().strip()


def _path_in_repository(revision_path: RevisionPath) -> str:
    """Return the path from the top of the repository, or "" for the whole repository.

    A path that begins with a dot is relative to the current folder. Any other path is relative to the top.

    Raises:
        RevisionError: The path is outside the repository.
    """
    repository_path = revision_path.path
    is_relative = repository_path in (".", "..") or repository_path.startswith(("./", "../"))
    if is_relative:
        current_folder = _run_git(["rev-parse", "--show-prefix"]).decode().removesuffix("\n")
        repository_path = posixpath.join(current_folder, repository_path)
    if repository_path:
        repository_path = posixpath.normpath(repository_path)
    if repository_path == ".":  # The top of the repository.
        repository_path = ""
    if repository_path.startswith(("/", "../")) or repository_path == ".." or "\0" in repository_path:
        raise RevisionError(f"{visible(str(revision_path))} is outside the repository; paths are relative to its top")
    return repository_path


def _list_files(commit: str, path: str) -> dict[str, str]:
    """Return the regular files of a commit at or below a path, each with the hash of its content.

    If ``path`` is empty, all files are returned. Links and submodules are left out.
    """
    path_arguments = ["--", path] if path else []
    listing = _run_git(["ls-tree", "-r", "-z", "--full-tree", commit, *path_arguments])
    blob_hash_by_path = {}
    # A line is ``MODE TYPE HASH``, a tab and the path.
    for tree_line in filter(None, listing.split(b"\0")):
        mode_type_and_hash, _, path_bytes = tree_line.partition(b"\t")
        mode, _, blob_hash = mode_type_and_hash.decode().split(" ")
        file_path = os.fsdecode(path_bytes)
        is_regular_file = mode in (_FILE_MODE, _EXECUTABLE_MODE)
        is_at_or_below = path in ("", file_path) or file_path.startswith(f"{path}/")
        if is_regular_file and is_at_or_below:
            blob_hash_by_path[file_path] = blob_hash
    return blob_hash_by_path


def _reject_large_files(revision_path: RevisionPath, blob_hash_by_path: Mapping[str, str]) -> None:
    """Raise a ``RevisionError`` if a file is too large, if all files together are, or if the content of one is missing.

    The content of a file can be missing in a partial clone.
    """
    command = ["cat-file", "--batch-check=%(objectname) %(objecttype) %(objectsize)"]
    replies = _run_git(command, blob_hash_by_path.values()).decode()
    size_by_hash: dict[str, int] = {}
    for reply in replies.splitlines():
        # A reply is ``HASH blob SIZE``, or ``HASH missing``.
        blob_hash, _, type_and_size = reply.partition(" ")
        object_type, _, size_text = type_and_size.partition(" ")
        if object_type == "blob":
            size_by_hash[blob_hash] = int(size_text)
    for file_path, blob_hash in blob_hash_by_path.items():
        file_text = f"{visible(revision_path.revision)}:{visible(file_path)}"
        if blob_hash not in size_by_hash:
            raise RevisionError(f"the content of {file_text} is not in this repository; fetch it first")
        if size_by_hash[blob_hash] > MAX_BYTES:
            message = f"{file_text} is larger than {MAX_BYTES // 2**20} MB and cannot be a spec"
            raise RevisionError(f"{message}; name the folder of the specs")
    if sum(size_by_hash[blob_hash] for blob_hash in blob_hash_by_path.values()) > _MAX_TOTAL_BYTES:
        message = f"the YAML files of {visible(str(revision_path))} exceed {_MAX_TOTAL_BYTES // 2**20} MB in total"
        raise RevisionError(f"{message}; name the folder of the specs")


def _read_contents(blob_hashes: Iterable[str]) -> dict[str, bytes]:
    """Return the content of each blob by its hash. The sizes of the blobs have already been checked.

    For each blob, git prints a line ``HASH TYPE SIZE``, the content and a newline.
    """
    git_output = _run_git(["cat-file", "--batch"], blob_hashes, max_bytes=2 * _MAX_TOTAL_BYTES)
    content_by_hash = {}
    start_of_head = 0
    while start_of_head < len(git_output):
        end_of_head = git_output.index(b"\n", start_of_head)
        blob_hash, _, size_text = git_output[start_of_head:end_of_head].decode().split(" ")
        start_of_content = end_of_head + 1
        end_of_content = start_of_content + int(size_text)
        content_by_hash[blob_hash] = git_output[start_of_content:end_of_content]
        start_of_head = end_of_content + 1  # After the newline.
    return content_by_hash


class _GitFailed(RevisionError):
    """git failed."""


def _run_git(arguments: Sequence[str], input_lines: Iterable[str] = (), max_bytes: int = _MAX_LIST_BYTES) -> bytes:
    """Run git with these arguments and lines of input, and return its output.

    Raises:
        RevisionError: There is no git or no repository, or git takes too long or prints more than ``max_bytes`` bytes.
        _GitFailed: git fails.
    """
    environment = {name: value for name, value in os.environ.items() if name != "GIT_LITERAL_PATHSPECS"}
    command = ["git", "--no-pager", "--no-replace-objects", "--literal-pathspecs", *arguments]
    try:
        with TemporaryFile() as input_file, TemporaryFile() as error_file:
            input_file.write("".join(f"{line}\n" for line in input_lines).encode())
            input_file.seek(0)
            exit_code, git_output = _run_command(
                command,
                input_file=input_file,
                error_file=error_file,
                environment=environment | _QUIET,
                max_bytes=max_bytes,
            )
            error_file.seek(0)
            first_line, *_ = error_file.read(4096).decode(errors="replace").strip().split("\n")
            error_text = visible(first_line)
    except RevisionError:
        raise
    except FileNotFoundError:
        raise RevisionError("git is not installed; only files and folders can be compared") from None
    except (OSError, ValueError) as error:
        raise RevisionError(f"cannot run git: {error}") from None
    if exit_code == 0:
        return git_output
    if "not a git repository" in error_text:
        raise RevisionError("the current folder is not in a git repository, so there are no revisions to read")
    raise _GitFailed(f"git failed: {error_text.removeprefix('fatal: ') or f'exit exit_code {exit_code}'}")


def _run_command(
    command: Sequence[str], input_file: IO[bytes], error_file: IO[bytes], environment: Mapping[str, str], max_bytes: int
) -> tuple[int, bytes]:
    """Run a command, and return its exit code and output. Stop it if it takes too long or prints too much.

    Raises:
        RevisionError: It takes too long, or prints more than ``max_bytes`` bytes.
    """
    with subprocess.Popen(
        command, stdin=input_file, stdout=subprocess.PIPE, stderr=error_file, env=environment
    ) as process:
        timed_out = Event()
        timer = Timer(_TIMEOUT_S, _stop_command, (process, timed_out))
        timer.start()
        try:
            # One more byte shows that the output is too long.
            output = process.stdout.read(max_bytes + 1) if process.stdout else b""
            if len(output) > max_bytes:
                process.kill()
            exit_code = process.wait()
        finally:
            timer.cancel()
    if timed_out.is_set():
        raise RevisionError(f"git did not answer within {_TIMEOUT_S} s")
    if len(output) > max_bytes:
        raise RevisionError(f"git lists more than {max_bytes // 2**20} MB here; name the folder of the specs")
    return exit_code, output


def _stop_command(running: subprocess.Popen[bytes], timed_out: Event) -> None:
    """Stop a command that takes too long. Setting ``timed_out`` distinguishes this from a normal end."""
    timed_out.set()
    running.kill()
