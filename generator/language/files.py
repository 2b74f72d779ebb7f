"""Which files below a folder are specs.

A file that is given by name is always read. Below a folder lie other YAML files too, such as those of CI;
a spec is known by its keys.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .schema import keys_of
from .second_reading import is_second

SUFFIXES = (".yaml", ".yml")
#: Any one of these at the top makes a YAML file a spec.
NAMING_KEYS = frozenset({"codewheel", "device", "manufacturer", "master", "overlay"})
#: What makes a folder a virtual environment, in which nobody keeps specs but where codewheel's own may lie.
_ENVIRONMENT = "pyvenv.cfg"
#: As much of a file as is looked at.
_LOOKED_AT = 2**20
_CONTENT = re.compile(rb"^([ \t]*)[^\s#%-]", re.MULTILINE)
_KEY = rb"""["']?([a-z_]+)["']?[ \t]*:(?=\s|$)"""


@dataclass(frozen=True, slots=True)
class Found:
    """The files below a folder in sorted order: those to read, and the YAML files that are no specs."""

    specs: tuple[Path, ...]
    passed_over: tuple[Path, ...]


def below(folder: Path) -> Found:
    """Every ``*.yaml`` and ``*.yml`` in the folder and below it.

    Left out are names that begin with a dot, virtual environments, files that generate wrote, and second readings.
    What cannot be read counts as a spec: reading it says why.
    """
    files = sorted(_files_below(folder, set()))
    specs = {path for path in files if _is_spec(path)}
    return Found(tuple(path for path in files if path in specs), tuple(path for path in files if path not in specs))


def own_specs(folder: Path) -> list[Path]:
    """The specs that lie in the folder itself, if there is one of a device among them, else none."""
    try:
        named = (path for path in folder.iterdir() if path.suffix in SUFFIXES and not path.name.startswith("."))
        files = sorted(path for path in named if not is_second(path))
    except OSError:
        return []
    found = {path: _keys(path) for path in files if path.is_file()}
    if not any(_is_device(keys) for keys in found.values()):
        return []
    return [path for path, keys in found.items() if _names_a_spec(keys)]


def is_folder(path: Path) -> bool:
    try:
        return os.path.isdir(path)
    except ValueError:  # A NUL in the name.
        return False


def _files_below(folder: Path, visited: set[tuple[int, int]]) -> Iterator[Path]:
    """The YAML files below a folder; a folder that links lead back to is entered once."""
    try:
        status = os.stat(folder)
        names = os.listdir(folder)
    except OSError:
        # Handed on as if it were a file: reading it says why it cannot be read.
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
    """The files of a target's folder that generate wrote."""
    from ..write import WriteError, listed_in

    try:
        return {folder / path for path in listed_in(folder)}
    except WriteError:
        return set()


def _is_spec(path: Path) -> bool:
    keys = _keys(path)
    return keys is None or _names_a_spec(keys)


def _names_a_spec(keys: frozenset[str] | None) -> bool:
    """Whether a file with these keys at its top is a spec: it says so, or its name was forgotten."""
    return keys is not None and (bool(keys & NAMING_KEYS) or _has_parts_of_a_device(keys))


def _is_device(keys: frozenset[str] | None) -> bool:
    return (
        keys is not None
        and keys.isdisjoint({"master", "overlay"})
        and ("device" in keys or _has_parts_of_a_device(keys))
    )


def _has_parts_of_a_device(keys: frozenset[str]) -> bool:
    """Two of the keys that only specs of devices have; other tools, too, have a single one such as ``parameters``."""
    return len(keys & keys_of("device") - keys_of("manufacturer")) >= 2


def _keys(path: Path) -> frozenset[str] | None:
    """The keys at the top of a YAML file; None where it cannot be read.

    Found in its text, since a spec with an error in its syntax is one nevertheless, and others' files need not be read.
    """
    try:
        if not path.is_file():
            return None
        with open(path, "rb") as file:
            # UTF-16 is no spec's encoding, but such a file is to be refused and not passed over.
            text = re.sub(rb"\r\n?", b"\n", file.read(_LOOKED_AT).replace(b"\0", b"").lstrip(b"\xef\xbb\xbf\xff\xfe"))
    except (OSError, ValueError):
        return None
    start = _CONTENT.search(text)
    if start is None:
        return frozenset()
    in_braces = text[start.end() - 1 : start.end()] == b"{"
    found = re.findall(_KEY if in_braces else rb"^" + re.escape(start[1]) + _KEY, text, re.MULTILINE)
    return frozenset(key.decode() for key in found)
