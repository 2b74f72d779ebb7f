"""Files of specs: those that ship with the tool, and those on which the model of a family depends."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from pathlib import Path

from ..language.files import find_files, is_folder


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
    """Yield the files that a run with these paths reads as specs."""
    for path in paths:
        yield from find_files(path).specs if is_folder(path) else (path,)


def family_files(spec: Path, names_in: Callable[[Path], Iterable[str]] = os.listdir) -> list[Path]:
    """Return all files on which the model of a family depends: its own, and its manufacturer's.

    ``names_in`` returns the names in a folder.
    """
    own_names = sorted(name for name in names_in(spec.parent) if name.startswith(f"{spec.stem}."))
    return [*(spec.with_name(name) for name in own_names), spec.with_name(MANUFACTURER)]
