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
    text = runtime_headers()["version.h"]
    numbers = dict(re.findall(r"#define CW_RUNTIME_(MAJOR|MINOR) (\d+)", text))
    return int(numbers["MAJOR"]), int(numbers["MINOR"])


def _texts(folder: str) -> dict[str, str]:
    texts_folder = resources.files("codewheel.runtime") / "c" / folder
    paths = sorted(texts_folder.iterdir(), key=lambda path: path.name)
    return {path.name: path.read_text(encoding="utf-8") for path in paths}
