"""Files on which the model of a family depends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ..language.files import below, is_folder
from .shipped import packaged_families

MANUFACTURER = "manufacturer.yaml"


def spec_files(paths: Sequence[Path]) -> Iterator[Path]:
    """Yield the files that a run with these paths reads as specs."""
    for given in paths or packaged_families():
        yield from below(given).specs if is_folder(given) else (given,)


def family_files(spec: Path) -> list[Path]:
    """Return all files on which the model of a family depends: its own, and its manufacturer's."""
    own = sorted(path for path in spec.parent.iterdir() if path.name.startswith(f"{spec.stem}."))
    return [*own, spec.with_name(MANUFACTURER)]
