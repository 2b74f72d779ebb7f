"""The generated packages on the path of processes that tests start."""

from __future__ import annotations

import os
from pathlib import Path


def python_path(folder: Path) -> str:
    """Return the value of PYTHONPATH with which a process finds the package in a folder, and its runtime."""
    return os.pathsep.join([str(folder), str(folder / "runtime")])
