"""Find the specs in a folder.

A file given by name is always read. Folders also contain other YAML files, such as those of CI, so specs are
recognised by their keys.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from .schema_files import keys_of
from .second_reading import is_second

SUFFIXES = (".yaml", ".yml")
#: Any of these keys at the top level makes a YAML file a spec.
NAMING_KEYS = frozenset({"codewheel", "device", "manufacturer", "master", "overlay"})
#: File that marks a virtual environment. It may contain codewheel's own specs, but none of the user's.
_ENVIRONMENT = "pyvenv.cfg"
#: Number of bytes inspected at the start of a file.
_LOOKED_AT = 2**20
_CONTENT = re.compile(rb"^([ \t]*)[^\s#%-]", re.MULTILINE)
_KEY = rb"""["']?(?<![a-z_])([a-z_]+)["']?[ \t]*:(?=\s|$)"""


@dataclass(frozen=True, slots=True)
class Found:
    """Files below a folder in sorted order: the specs, and the other YAML files, which are skipped."""

    specs: tuple[Path, ...]
    passed_over: tuple[Path, ...]


def is_spec(path: Path) -> bool:
    """Return whether a YAML file in a folder is a spec. An unreadable one is, so that reading it reports the reason."""
    keys = top_keys(path)
    return keys is None or _names_a_spec(keys)


def below(folder: Path, is_spec: Callable[[Path], bool] = is_spec) -> Found:
    """Find every ``*.yaml`` and ``*.yml`` in the folder and below it.

    Names that begin with a dot, virtual environments, generated files and second readings are omitted.
    """
    files = sorted(_files_below(folder, set()))
    specs = {path for path in files if is_spec(path)}
    return Found(tuple(path for path in files if path in specs), tuple(path for path in files if path not in specs))


def own_specs(folder: Path) -> list[Path]:
    """Return the specs directly in the folder if at least one describes a device, otherwise an empty list."""
    try:
        named = (path for path in folder.iterdir() if path.suffix in SUFFIXES and not path.name.startswith("."))
        files = sorted(path for path in named if not is_second(path))
    except OSError:
        return []
    found = {path: top_keys(path) for path in files if path.is_file()}
    if not any(_is_device(keys) for keys in found.values()):
        return []
    return [path for path, keys in found.items() if _names_a_spec(keys)]


def is_folder(path: Path) -> bool:
    try:
        return os.path.isdir(path)
    except ValueError:  # A NUL in the name.
        return False


def _files_below(folder: Path, visited: set[tuple[int, int]]) -> Iterator[Path]:
    """Yield the YAML files below a folder. A folder reached again through links is entered only once."""
    try:
        status = os.stat(folder)
        names = os.listdir(folder)
    except OSError:
        # Treated as a file, so that reading it reports why it cannot be read.
        yield folder
        return
    if (status.st_dev, status.st_ino) in visited or (visited and _ENVIRONMENT in names):
        return
    visited.add((status.st_dev, status.st_ino))
    generated = _generated(folder) if ".codewheel" in names else set()
    for name in names:
        path = folder / name
        if name.startswith("."):
            continue
        if os.path.isdir(path):
            yield from (file for file in _files_below(path, visited) if file not in generated)
        elif name.endswith(SUFFIXES) and path not in generated and not is_second(name):
            yield path


def _generated(folder: Path) -> set[Path]:
    """Return the generated files in a target's folder."""
    from ..write import WriteError, listed_in

    try:
        return {folder / path for path in listed_in(folder)}
    except WriteError:
        return set()


def _names_a_spec(keys: frozenset[str] | None) -> bool:
    """Return True if a file with these keys at the top level is a spec, even if the naming key is missing."""
    return keys is not None and (bool(keys & NAMING_KEYS) or _has_parts_of_a_device(keys))


def _is_device(keys: frozenset[str] | None) -> bool:
    return (
        keys is not None
        and keys.isdisjoint({"master", "overlay"})
        and ("device" in keys or _has_parts_of_a_device(keys))
    )


def _has_parts_of_a_device(keys: frozenset[str]) -> bool:
    """Return True for two or more keys that only devices have. Other tools may use one, such as ``parameters``."""
    return len(keys & keys_of("device") - keys_of("manufacturer")) >= 2


def top_keys(path: Path) -> frozenset[str] | None:
    """Return the keys at the top level of a YAML file, or None if it cannot be read.

    The keys are found in the text, because a spec with a syntax error is still a spec, and other files need no parsing.
    """
    try:
        if not path.is_file():
            return None
        with open(path, "rb") as file:
            # Specs are not UTF-16, but such a file must be rejected and not skipped.
            text = re.sub(rb"\r\n?", b"\n", file.read(_LOOKED_AT).replace(b"\0", b"").lstrip(b"\xef\xbb\xbf\xff\xfe"))
    except (OSError, ValueError):
        return None
    start = _CONTENT.search(text)
    if start is None:
        return frozenset()
    in_braces = text[start.end() - 1 : start.end()] == b"{"
    # A line break is found faster than the beginning of a line.
    found = re.findall(_KEY if in_braces else rb"\n" + re.escape(start[1]) + _KEY, b"\n" + text, re.MULTILINE)
    return frozenset(key.decode() for key in found)
