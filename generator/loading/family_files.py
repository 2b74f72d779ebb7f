"""Files on which the model of a family depends."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from ..language.files import find_files, is_folder

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
