"""Builds the site as make does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def build(target: Path) -> None:
    """Build the site. A warning is an error."""
    command = [sys.executable, str(ROOT / "docs" / "site" / "build_site.py"), str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
