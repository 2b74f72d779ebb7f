"""The C runtime: headers that are the same for all manufacturers, copied unchanged, and their version."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources

#: Folder of the headers, and the folder in which they are installed.
FOLDER = "codewheel"
#: Prefix of all names in the headers. No name from a spec begins like this.
PREFIX = "cw_"
#: Names that no manufacturer can have, since the runtime uses them.
TAKEN = (FOLDER, PREFIX.rstrip("_"))


@cache
def runtime_headers() -> dict[str, str]:
    """Return the texts of the headers by their file names."""
    return _texts(FOLDER)


@cache
def runtime_tests() -> dict[str, str]:
    """Return the texts of the self-tests of the headers by their file names."""
    return _texts("selftest")


@cache
def runtime_version() -> tuple[int, int]:
    """Return the major and minor version of the headers."""
    major, minor = (
        int(re.findall(rf"#define CW_RUNTIME_{part} (\d+)", runtime_headers()["version.h"])[0])
        for part in ("MAJOR", "MINOR")
    )
    return major, minor


def _texts(folder: str) -> dict[str, str]:
    found = resources.files("codewheel.runtime") / "c" / folder
    return {item.name: item.read_text(encoding="utf-8") for item in sorted(found.iterdir(), key=lambda item: item.name)}
