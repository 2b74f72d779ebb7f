"""Cache of results in the user's own folder, so that nothing is computed twice.

A key is a hash of everything that the result depends on: the content of the specs, the code of this tool, its packages
and the interpreter. An entry that is missing, damaged, too large, or that another user could have written is ignored,
and the result is computed again. Entries are JSON, so reading one runs no code. Several processes can share the folder,
and it can be deleted at any time.

The result of a whole command is used again if no file that the command would read has changed. Only results of runs
without problems are stored, because messages depend on more than the content of the specs.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import stat
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .language.files import family_files, find_files, is_folder, packaged_masters, top_keys

if TYPE_CHECKING:
    from importlib.machinery import ModuleSpec

#: Largest entry that is read or written, and largest size of all entries, in bytes.
MAX_ENTRY = 32 * 2**20
MAX_SIZE = 256 * 2**20
#: Highest number of entries.
MAX_ENTRIES = 4096
#: Age in seconds from which an unfinished file is considered to be left by a killed process.
_ABANDONED_S = 3600
_UNFINISHED_PREFIX = ".new-"
#: Size of the hash in hexadecimal digits.
_HASH_DIGITS = 64
#: Packages of this tool that a checkout has in folders of their own.
_OWN_PACKAGES = ("templates", "runtime")
#: Packages outside the standard library on which results depend.
_PACKAGES = ("yaml", "jsonschema", "jinja2", "lxml", "markupsafe")


def default_folder() -> Path | None:
    """Return the folder of the cache, or None if the user has no such folder.

    It is ``codewheel`` in ``$XDG_CACHE_HOME``, by default in ``~/.cache``, and on Windows in ``%LOCALAPPDATA%``.
    """
    windows_folder = os.environ.get("LOCALAPPDATA", "") if os.name == "nt" else ""
    parent_folder = os.environ.get("XDG_CACHE_HOME") or windows_folder
    with suppress(RuntimeError):
        cache_parent = Path(parent_folder) if parent_folder else Path.home() / ".cache"
        if cache_parent.is_absolute():
            return cache_parent / "codewheel"
    return None


class Cache:
    """Results by key. Without a folder, the cache stores nothing. No method raises an error of the file system."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._written: tuple[int, int] | None = None

    def __bool__(self) -> bool:
        return self._folder is not None

    def get(self, kind_of_result: str, content: Iterable[bytes | str]) -> Any:
        """Return the data that ``put`` stored for the same kind and content, or None."""
        if self._folder is None:
            return None
        try:
            return _read(self._folder, key_of(kind_of_result, content))
        except (OSError, ValueError, RecursionError):
            return None

    def put(self, kind_of_result: str, content: Iterable[bytes | str], data: Any) -> None:
        """Store data that JSON can express. Other entries may be removed because of the limits."""
        if self._folder is None:
            return
        key = key_of(kind_of_result, content)
        with suppress(OSError, ValueError, RecursionError):
            entry_json = json.dumps({"key": key, "data": data}, separators=(",", ":")).encode()
            if len(entry_json) > MAX_ENTRY:
                return
            self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if _is_ours(os.stat(self._folder)):
                hash_of_entry = hashlib.sha256(entry_json).hexdigest().encode()
                _write(self._folder, key, hash_of_entry + entry_json)
                self._keep_limits(self._folder, len(entry_json))

    def _keep_limits(self, folder: Path, entry_size: int) -> None:
        """Apply the limits after the first entry of this process, and each time it has written 1/16 of a limit."""
        # Number and size of the entries since the last check. The first number is so high that there is a check.
        count_since_check, size_since_check = self._written or (MAX_ENTRIES, 0)
        total_size = size_since_check + entry_size
        self._written = (count_since_check + 1, total_size)
        if count_since_check >= MAX_ENTRIES // 16 or total_size >= MAX_SIZE // 16:
            _remove_oldest(folder)
            self._written = (0, 0)


#: A cache that stores nothing.
NO_CACHE = Cache(None)


def key_of(kind_of_result: str, content: Iterable[bytes | str]) -> str:
    """Return the key of a result: a hash of its kind, of all content that it depends on, and of this tool."""
    digest = hashlib.sha256(f"{kind_of_result}\0{_hash_of_tool()}".encode())
    for content_part in content:
        content_bytes = (
            content_part if isinstance(content_part, bytes) else content_part.encode("utf-8", "surrogateescape")
        )
        digest.update(b"%d\0" % len(content_bytes))
        digest.update(content_bytes)
    return digest.hexdigest()


def content_of(paths: Iterable[Path]) -> list[bytes | str]:
    """Return the names and the content of files, for a key: ``["x.yaml", b"…", "y.yaml", "missing"]``.

    A file that cannot be read is ``missing``.
    """
    names_and_contents: list[bytes | str] = []
    for path in paths:
        names_and_contents.append(path.name)
        try:
            names_and_contents.append(path.read_bytes())
        except (OSError, ValueError):
            names_and_contents.append("missing")
    return names_and_contents


@functools.cache
def _hash_of_tool() -> str:
    """Return a hash of the tool's own code, the versions of its packages, and the interpreter.

    The code is identified by the names, sizes and times of its files, because reading it would take longer than
    decoding a frame. Any change of a file changes its ``st_ctime_ns``, even if its size and modification time are the
    same as before.
    """
    digest = hashlib.sha256(f"{sys.implementation.name} {sys.version} {sys.platform}".encode())
    for folder in (Path(__file__).parent, *_package_folders()):
        for path, status in _files_below(folder):
            file_text = f"{path}\0{status.st_size} {status.st_mtime_ns} {status.st_ctime_ns}\n"
            digest.update(file_text.encode("utf-8", "surrogateescape"))
    for package_text in _locations_and_versions():
        digest.update(package_text.encode("utf-8", "surrogateescape"))
    return digest.hexdigest()


def _package_folders() -> Iterator[Path]:
    """Yield the folders of this tool's packages that may be outside the folder of this module."""
    for name in _OWN_PACKAGES:
        module_spec = _module_spec_of(f"{__package__}.{name}")
        if module_spec is not None:
            yield from map(Path, module_spec.submodule_search_locations or ())


def _files_below(folder: Path | str) -> Iterator[tuple[str, os.stat_result]]:
    """Yield the path and the status of each file in a folder and below it, except compiled files, ordered by name."""
    with os.scandir(folder) as scanned_folder:
        entries_by_name = sorted(scanned_folder, key=lambda entry: entry.name)
    for entry in entries_by_name:
        if entry.is_dir():
            if entry.name != "__pycache__":
                yield from _files_below(entry.path)
        elif not entry.name.endswith(".pyc"):
            yield entry.path, entry.stat()


def _locations_and_versions() -> Iterator[str]:
    """Yield the location of each package that the tool uses, and the folders next to it that are named like it.

    One of them has the version in its name, such as ``PyYAML-6.0.2.dist-info``. No package is imported.
    """
    for package_name in _PACKAGES:
        module_spec = _module_spec_of(package_name)
        init_path = module_spec.origin if module_spec is not None else None
        site_folder = Path(init_path).parent.parent if init_path else None
        yield f"{package_name} {site_folder}"
        if site_folder is not None:
            for folder_name in sorted(os.listdir(site_folder)):
                if folder_name.lower().startswith((package_name, f"py{package_name}")):
                    yield folder_name


def _module_spec_of(name: str) -> ModuleSpec | None:
    """Return the location where Python finds a package, or None if it finds none."""
    from importlib.util import find_spec

    try:
        return find_spec(name)
    except (ImportError, ValueError):
        return None


def _is_ours(status: os.stat_result) -> bool:
    """Return whether no other user can have written a file or folder. On Windows, the user's folder is trusted."""
    if os.name == "nt":
        return True
    is_writable_by_others = bool(status.st_mode & (stat.S_IWGRP | stat.S_IWOTH))
    return status.st_uid == os.getuid() and not is_writable_by_others


def _read(folder: Path, key: str) -> Any:
    """Return the data of an entry, or None if it is damaged, has another key, or another user could have written it.

    A file consists of JSON, ``{"key": …, "data": …}``, after the SHA-256 hash of this JSON in hexadecimal digits.
    """
    if not _is_ours(os.stat(folder)):
        return None
    # Follow no link, and do not wait for a writer if the path is a pipe. Not every system has these flags.
    open_flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(folder / key, open_flags)
    with open(descriptor, "rb") as file:
        status = os.fstat(file.fileno())
        is_trusted_file = stat.S_ISREG(status.st_mode) and _is_ours(status)
        if not is_trusted_file or status.st_size > MAX_ENTRY + _HASH_DIGITS:
            return None
        content = file.read(MAX_ENTRY + _HASH_DIGITS)
    stored_hash, entry_json = content[:_HASH_DIGITS], content[_HASH_DIGITS:]
    if hashlib.sha256(entry_json).hexdigest().encode() != stored_hash:
        return None
    stored_entry = json.loads(entry_json)
    has_requested_key = isinstance(stored_entry, dict) and stored_entry.get("key") == key
    return stored_entry.get("data") if has_requested_key else None


def _write(folder: Path, key: str, content: bytes) -> None:
    """Write an entry to a file with a temporary name, and rename it, so that no process reads part of the entry."""
    unfinished_path = folder / f"{_UNFINISHED_PREFIX}{os.getpid()}-{key[:16]}-{time.monotonic_ns()}"
    descriptor = os.open(unfinished_path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600)
    try:
        with open(descriptor, "wb") as file:
            file.write(content)
        os.replace(unfinished_path, folder / key)
    except BaseException:
        with suppress(OSError):
            os.unlink(unfinished_path)
        raise


def _remove_oldest(folder: Path) -> None:
    """Remove the oldest entries if a limit is exceeded, until at most half of each limit is used.

    Unfinished files of killed processes are removed as well.
    """
    # A tuple begins with the time, so the oldest entry comes first.
    entries = sorted(_entries_in(folder))
    entry_count = len(entries)
    total_size = sum(entry_size for _, entry_size, _ in entries)
    if entry_count <= MAX_ENTRIES and total_size <= MAX_SIZE:
        return
    for _, entry_size, entry_path in entries:
        if entry_count <= MAX_ENTRIES // 2 and total_size <= MAX_SIZE // 2:
            break
        with suppress(OSError):
            os.unlink(entry_path)
        entry_count -= 1
        total_size -= entry_size


def _entries_in(folder: Path) -> Iterator[tuple[float, int, str]]:
    """Yield the time, the size and the path of each entry, and remove unfinished files of killed processes."""
    with os.scandir(folder) as scanned_folder:
        for folder_entry in scanned_folder:
            with suppress(OSError):
                status = folder_entry.stat(follow_symlinks=False)
                # The name of an entry is its key.
                if len(folder_entry.name) == _HASH_DIGITS:
                    yield status.st_mtime, status.st_size, folder_entry.path
                elif folder_entry.name.startswith(_UNFINISHED_PREFIX) and status.st_mtime < time.time() - _ABANDONED_S:
                    os.unlink(folder_entry.path)


# -- results of commands

#: Keys that only overlays have. Overlays may refer to specs in other folders.
_OVERLAY_KEYS = frozenset(("overlay", "changes"))


class CachedResult:
    """The result of a command for these specs and options, if the cache has one."""

    def __init__(self, cache: Cache, command: str, paths: Sequence[Path], options: Sequence[str] = ()) -> None:
        """Set the place of the result in the cache.

        Args:
            cache: The cache.
            command: Name of the command.
            paths: The specs.
            options: All options on which the result depends.
        """
        self._cache = cache
        self._command = command
        self._paths = paths
        self._options = options
        # A hash of all files that the command reads. It is empty if no result can be stored.
        self._hash_of_inputs = _hash_of_inputs(paths, options) if cache else ""

    def get(self) -> Any:
        """Return the cached result, or None if there is none."""
        return self._cache.get(self._command, [self._hash_of_inputs]) if self._hash_of_inputs else None

    def put(self, result: Any) -> None:
        """Store the result of a run without problems, unless a file has changed since the run began."""
        if self._hash_of_inputs and _hash_of_inputs(self._paths, self._options) == self._hash_of_inputs:
            self._cache.put(self._command, [self._hash_of_inputs], result)


class _NotStorable(Exception):
    """The result depends on files that are not among the inputs."""


def _hash_of_inputs(paths: Sequence[Path], options: Sequence[str]) -> str:
    """Return a hash of the current folder, the options and all files that a run reads.

    The hash is "" if the files are not known, for example because one of the specs is an overlay.
    """
    try:
        # The empty text ends the options, so that none of them is mistaken for the name of a file.
        options_and_files = chain([os.getcwd(), *options, ""], _names_and_contents(paths))
        return key_of("inputs", options_and_files)
    except (OSError, ValueError, _NotStorable):
        return ""


def _names_and_contents(paths: Sequence[Path]) -> Iterator[bytes | str]:
    """Yield the names and the content of all files that a run with these paths reads, including packaged masters.

    Raises:
        OSError: A folder cannot be read.
        _NotStorable: A spec cannot be read, or is an overlay.
    """
    names_in_folder = functools.cache(os.listdir)
    for spec_or_folder in paths:
        spec_paths: Sequence[Path] = (spec_or_folder,)
        skipped_files: Sequence[Path] = ()
        if is_folder(spec_or_folder):
            search_result = find_files(spec_or_folder)
            spec_paths = search_result.specs
            skipped_files = search_result.passed_over
        # The words between the lists prevent equal hashes if a name moves from one list to the next.
        yield from (str(spec_or_folder), "specs", *map(str, spec_paths), "skipped", *map(str, skipped_files), "content")
        for spec_path in spec_paths:
            first_level_keys = top_keys(spec_path)
            if first_level_keys is None or not first_level_keys.isdisjoint(_OVERLAY_KEYS):
                raise _NotStorable
            yield from content_of(family_files(spec_path, names_in_folder))
    yield from content_of(sorted(packaged_masters().iterdir()))
