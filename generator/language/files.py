"""The files of specs: how their names belong together, which files in a folder are specs, and the specs of the tool.

A file given by name is always read. Folders also contain other YAML files, such as CI settings, so specs are recognized
by their keys.
"""

from __future__ import annotations

import os
import re
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path, PurePath

SUFFIXES = (".yaml", ".yml")
#: Any of these keys at the top level makes a YAML file a spec.
NAMING_KEYS = frozenset({"codewheel", "device", "manufacturer", "master", "overlay"})
#: Folders in which tools build or install. They may contain copies of specs, but none that anyone edits.
_BUILD_FOLDERS = frozenset({"build", "dist", "node_modules", "site-packages", "_build", "__pycache__"})
#: A file with one of these names marks a virtual environment, a cache, or a folder that generate writes.
_MARKER_FILES = frozenset({"pyvenv.cfg", "CACHEDIR.TAG", ".codewheel"})
#: Folder, or file, at the root of a git repository.
REPOSITORY = ".git"
#: File with the settings of a project, which is not a spec.
CONFIGURATION = "codewheel.yaml"
#: Reasons why a folder was not searched, for those that may contain specs of the user.
LINK, NESTED, UNREADABLE = "a link", "a repository of its own", "unreadable"
#: Number of bytes inspected at the start of a file.
_MOST_BYTES_READ = 2**20
#: The indentation and first character of the first line that is not a comment, a directive or a mark of YAML.
_FIRST_CONTENT_LINE = re.compile(rb"^([ \t]*)[^\s#%-]", re.MULTILINE)
#: A key, perhaps in quotes, with its colon.
_KEY_WITH_COLON = rb"""["']?(?<![a-z_])([a-z_]+)["']?[ \t]*:(?=\s|$)"""


@dataclass(frozen=True, slots=True)
class FoundFiles:
    """Files below a folder in sorted order: the specs, and the other YAML files, which are skipped.

    ``not_entered`` contains the folders that may contain specs but were not searched, each with the reason.
    ``is_complete`` is False if the search ended at its limit.
    """

    specs: tuple[Path, ...]
    passed_over: tuple[Path, ...]
    not_entered: tuple[tuple[Path, str], ...] = ()
    is_complete: bool = True


def is_spec(path: Path) -> bool:
    """Return True if a YAML file in a folder is a spec, or cannot be read, which is reported when it is read."""
    keys = top_keys(path)
    return keys is None or _names_a_spec(keys)


def find_files(
    folder: Path,
    is_spec: Callable[[Path], bool] = is_spec,
    outputs: Collection[str] = (),
    most_names: float = float("inf"),
) -> FoundFiles:
    """Find every ``*.yaml`` and ``*.yml`` in the folder and below it.

    Names that begin with a dot, second readings, sheets of turning words, virtual environments, folders of builds and
    caches, outputs, links to folders, and other repositories are omitted. The folder itself is always searched.

    Args:
        folder: The folder.
        is_spec: Tests whether a YAML file is a spec.
        outputs: Real paths of further folders that are outputs.
        most_names: Number of names, of files and folders, after which the search ends.
    """
    search = _Search(outputs, most_names)
    search.run(folder)
    spec_paths = {path for path in search.files if is_spec(path)}
    other_files = (path for path in search.files if path not in spec_paths and path.name != CONFIGURATION)
    not_entered = tuple(sorted(search.not_entered))
    return FoundFiles(
        specs=tuple(sorted(spec_paths)),
        passed_over=tuple(sorted(other_files)),
        not_entered=not_entered,
        is_complete=search.is_complete,
    )


def is_folder(path: Path) -> bool:
    """Return True if a path names a folder. A path with a NUL is not."""
    try:
        return os.path.isdir(path)
    except ValueError:  # A NUL in the name.
        return False


class _Search:
    """Search for YAML files in a folder and below it, level by level.

    ``files`` contains the YAML files and unreadable folders, ``not_entered`` the folders to report, with the reason.
    """

    def __init__(self, outputs: Collection[str], most_names: float) -> None:
        self.files: list[Path] = []
        self.not_entered: list[tuple[Path, str]] = []
        self.is_complete = True
        self._outputs = outputs
        self._names_left = most_names

    def run(self, root: Path) -> None:
        """Search ``root``, then the folders in it, and so on, until the limit of names is reached."""
        folders = deque([root])
        while folders:
            folder = folders.popleft()
            entries = self._list_entries(folder)
            names_in_folder = {folder_entry.name for folder_entry in entries}
            # The root is searched even if it is an environment or a repository.
            if folder != root and self._is_left_out(folder, names_in_folder):
                continue
            self._names_left -= len(entries)
            if self._names_left < 0:
                self.is_complete = False
                return
            for folder_entry in entries:
                if not folder_entry.name.startswith("."):
                    self._add_entry(folder_entry, folder / folder_entry.name, folders)

    def _list_entries(self, folder: Path) -> list[os.DirEntry[str]]:
        """Return the entries of a folder. An unreadable folder has no entries and is noted."""
        try:
            with os.scandir(folder) as listing:
                return list(listing)
        except OSError:
            # Also treated as a file, so that reading it reports why it cannot be read.
            self.files.append(folder)
            self.not_entered.append((folder, UNREADABLE))
            return []

    def _is_left_out(self, folder: Path, names: Collection[str]) -> bool:
        """Return True for a folder that is not searched: an environment, a cache, an output or another repository.

        ``names`` are the names in the folder. A repository is added to ``not_entered``, because it may contain specs of
        the user.
        """
        if not _MARKER_FILES.isdisjoint(names):
            return True
        if self._outputs and os.path.realpath(folder) in self._outputs:
            return True
        if REPOSITORY in names:
            self.not_entered.append((folder, NESTED))
            return True
        return False

    def _add_entry(self, folder_entry: os.DirEntry[str], path: Path, folders: deque[Path]) -> None:
        """Add an entry to the YAML files if it is one, or to ``folders`` if it is a folder that is to be searched.

        A link to a folder is added to ``not_entered``.
        """
        if _is_folder_entry(folder_entry):
            if folder_entry.name in _BUILD_FOLDERS or folder_entry.name.endswith(".egg-info"):
                return
            if folder_entry.is_symlink():
                self.not_entered.append((path, LINK))
            else:
                folders.append(path)
        elif folder_entry.name.endswith(SUFFIXES) and not _belongs_to_spec(folder_entry.name):
            self.files.append(path)


def _belongs_to_spec(file_name: str) -> bool:
    return is_second(file_name) or is_word_sheet(file_name)


def _is_folder_entry(folder_entry: os.DirEntry[str]) -> bool:
    """Return True if an entry is a folder, or a link to one."""
    try:
        return folder_entry.is_dir()
    except OSError:  # A link to itself. Reading it reports the error.
        return False


def _names_a_spec(keys: frozenset[str] | None) -> bool:
    """Return True if a file with these keys at the top level is a spec, even if the naming key is missing."""
    return keys is not None and (bool(keys & NAMING_KEYS) or _has_parts_of_a_device(keys))


def describes_encoders(path: Path) -> bool:
    """Return True if a spec describes or changes an encoder, or cannot be read. Other specs are not about one."""
    keys = top_keys(path)
    return keys is None or "overlay" in keys or ("master" not in keys and _is_device(keys))


def _is_device(keys: frozenset[str]) -> bool:
    return "device" in keys or _has_parts_of_a_device(keys)


def _has_parts_of_a_device(keys: frozenset[str]) -> bool:
    """Return True for two or more keys that only devices have. Other tools may use one, such as ``parameters``."""
    from .schemas import keys_of_file_kind  # Decoding with a stored model loads no schema.

    return len(keys & (keys_of_file_kind("device") - keys_of_file_kind("manufacturer"))) >= 2


def top_keys(path: Path) -> frozenset[str] | None:
    """Return the keys at the top level of a YAML file, or of all levels of a JSON file. None if it cannot be read.

    The keys are found in the text, because a spec with a syntax error is still a spec, and other files need no parsing.
    Only the first mebibyte is read.
    """
    try:
        if not path.is_file():
            return None
        with open(path, "rb") as file:
            content = file.read(_MOST_BYTES_READ)
    except (OSError, ValueError):
        return None
    # Specs are not UTF-16, but such a file must be rejected and not skipped. Without its NULs and its byte order mark,
    # the keys are found.
    plain_text = content.replace(b"\0", b"").lstrip(b"\xef\xbb\xbf\xff\xfe")
    plain_text = re.sub(rb"\r\n?", b"\n", plain_text)
    first_content_line = _FIRST_CONTENT_LINE.search(plain_text)
    if first_content_line is None:
        return frozenset()
    is_json = first_content_line[0].endswith(b"{")
    if is_json:
        key_pattern = _KEY_WITH_COLON
    else:
        # Keys at the top level have the same indentation as the first one.
        # A line break is found faster than the beginning of a line.
        indentation = first_content_line[1]
        key_pattern = rb"\n" + re.escape(indentation) + _KEY_WITH_COLON
    keys = re.findall(key_pattern, b"\n" + plain_text, re.MULTILINE)
    return frozenset(key.decode() for key in keys)


def packaged_specs() -> Path:
    """Return the folder of the specs that ship with the tool. In an editable install this is ``specs``."""
    return Path(import_module("codewheel.specs").__path__[0])


def packaged_masters() -> Path:
    """Return the folder of the master descriptions that ship with the tool."""
    return packaged_specs() / "masters"


def packaged_families() -> list[Path]:
    """Return the folders of the families that ship with the tool, one for each manufacturer."""
    folders = [path for path in packaged_specs().iterdir() if path.is_dir() and path != packaged_masters()]
    return sorted(folder for folder in folders if any(folder.glob("*.yaml")))


MANUFACTURER = "manufacturer.yaml"


def spec_files(paths: Sequence[Path]) -> Iterator[Path]:
    """Yield the files that a run with these paths reads as specs: specs in folders, and each file given by name."""
    for path in paths:
        yield from find_files(path).specs if is_folder(path) else (path,)


def family_files(spec_path: Path, names_in: Callable[[Path], Iterable[str]] = os.listdir) -> list[Path]:
    """Return the paths of all files on which the model of a family may depend.

    These are the files with its name and any suffixes, such as ``x24.second.yaml``, and the manufacturer file, which
    need not exist. ``names_in`` returns the names in a folder.
    """
    file_names = sorted(name for name in names_in(spec_path.parent) if name.startswith(f"{spec_path.stem}."))
    family_paths = [spec_path.with_name(name) for name in file_names]
    return [*family_paths, spec_path.with_name(MANUFACTURER)]


#: Suffix of a second reading, next to the file that it belongs to: ``encoder.second.yaml``.
SECOND_READING_SUFFIX = ".second"
#: Suffix of a sheet of turning words, next to the file that it belongs to: ``encoder.words.yaml``.
WORD_SHEET_SUFFIX = ".words"


def is_second(file: Path | str) -> bool:
    """Return True if a file has the name of a second reading."""
    return PurePath(file).stem.endswith(SECOND_READING_SUFFIX)


def second_reading_path(spec: Path) -> Path:
    """Return the path of the second reading of a spec."""
    return spec.with_name(f"{spec.stem}{SECOND_READING_SUFFIX}{spec.suffix}")


def is_word_sheet(file: Path | str) -> bool:
    """Return True if a file has the name of a sheet of turning words."""
    return PurePath(file).stem.endswith(WORD_SHEET_SUFFIX)


def word_sheet_path(spec: Path) -> Path:
    """Return the path of the sheet of turning words of a spec."""
    return spec.with_name(f"{spec.stem}{WORD_SHEET_SUFFIX}{spec.suffix}")


def coverage_path(spec: Path) -> Path:
    """Return the path of the file that counts the readings of the facts of a spec."""
    return spec.with_name(f"{spec.stem}.coverage.json")


def family_of(file: str) -> str:
    """Return the name of the family in a file: the stem, without the suffix of a second reading or of a sheet."""
    return PurePath(file).stem.removesuffix(SECOND_READING_SUFFIX).removesuffix(WORD_SHEET_SUFFIX)
