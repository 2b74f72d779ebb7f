"""Source files of the runtime. They are the same for every device and manufacturer, and targets copy them."""

from __future__ import annotations

from importlib import resources
from pathlib import Path


def our_runtime(language: str) -> Path:
    """Return the folder of the runtime for a language."""
    return Path(str(resources.files("codewheel.runtime"))) / language


def copied(folder: Path, to: str) -> dict[str, str]:
    """Return the text of each file in a folder and its subfolders, keyed by its path in the folder ``to``."""
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]
    return {f"{to}/{path.relative_to(folder).as_posix()}": path.read_text(encoding="utf-8") for path in paths}
