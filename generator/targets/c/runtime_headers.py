"""The texts of the headers of the runtime and of their self-tests, and the version of the headers."""

from __future__ import annotations

import re
from collections.abc import Iterable
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


#: Headers for every encoder: order codes, results, and the use of positions.
_FOR_ALL = ("bits.h", "result.h", "result.hpp", "encoder.h", "angle.h", "tracker.h")
_RUNTIME_INCLUDE = re.compile(rf'^#include "(?:{FOLDER}/)?(\w+\.hp*)"', re.MULTILINE)


def needed_runtime(headers_of_interfaces: Iterable[str]) -> dict[str, str]:
    """Return the texts of the headers of the runtime that some interfaces need, by their file names.

    They are the headers for all encoders, those for the interfaces, those for the self-tests, and all headers that
    these include.
    """
    texts_by_header = runtime_headers()
    unvisited_headers = [*_FOR_ALL, *headers_of_interfaces]
    for test_text in runtime_tests().values():
        unvisited_headers += _RUNTIME_INCLUDE.findall(test_text)
    needed_headers: set[str] = set()
    while unvisited_headers:
        header = unvisited_headers.pop()
        if header not in needed_headers:
            needed_headers.add(header)
            unvisited_headers += _RUNTIME_INCLUDE.findall(texts_by_header[header])
    return {header: text for header, text in texts_by_header.items() if header in needed_headers}
