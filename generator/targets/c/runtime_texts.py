"""The texts of the headers of the runtime and of their self-tests, and the version of the headers."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources

from .names import FOLDER


@cache
def runtime_headers() -> dict[str, str]:
    """Return the texts of the headers by their file names."""
    return _read_texts(FOLDER)


@cache
def runtime_tests() -> dict[str, str]:
    """Return the texts of the self-tests of the headers by their file names."""
    return _read_texts("selftest")


@cache
def runtime_version() -> tuple[int, int]:
    """Return the major and minor version of the headers."""
    text = runtime_headers()["version.h"]
    numbers = dict(re.findall(r"#define CW_RUNTIME_(MAJOR|MINOR) (\d+)", text))
    return int(numbers["MAJOR"]), int(numbers["MINOR"])


def _read_texts(folder: str) -> dict[str, str]:
    """Return the texts of the files in a folder of the C runtime, by their file names in alphabetical order."""
    texts_folder = resources.files("codewheel.runtime") / "c" / folder
    paths = sorted(texts_folder.iterdir(), key=lambda path: path.name)
    return {path.name: path.read_text(encoding="utf-8") for path in paths}
