"""Files that built-in targets share: the licence, the runtime, and file names for order codes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import resources
from itertools import chain, count
from pathlib import Path

_NOT_ALLOWED = re.compile(r"[^A-Za-z0-9.-]+")
_LONGEST = 80


def names_of_codes(order_codes: Iterable[str], reserved_names: Iterable[str] = ()) -> list[str]:
    """Return a file name for each order code. The names are unique even on file systems that ignore case.

    Characters that are not allowed become hyphens. Duplicates are numbered. ``reserved_names`` are in lowercase.
    """
    used_names, names = set(reserved_names), list[str]()
    for order_code in order_codes:
        allowed_text = _NOT_ALLOWED.sub("-", order_code).lstrip(".")
        suffixes = chain([""], (f"-{number}" for number in count(2)))
        candidates = (f"{allowed_text[: _LONGEST - len(suffix)]}{suffix}" for suffix in suffixes)
        name = next(candidate for candidate in candidates if candidate and candidate.casefold() not in used_names)
        names.append(name)
        used_names.add(name.casefold())
    return names


_TEXT = """\
Zero-Clause BSD (0BSD)

Permission to use, copy, modify, and/or distribute this software for any purpose with or without fee is hereby granted.

THE SOFTWARE IS PROVIDED "AS IS" AND THE AUTHOR DISCLAIMS ALL WARRANTIES WITH REGARD TO THIS SOFTWARE INCLUDING ALL
IMPLIED WARRANTIES OF MERCHANTABILITY AND FITNESS. IN NO EVENT SHALL THE AUTHOR BE LIABLE FOR ANY SPECIAL, DIRECT,
INDIRECT, OR CONSEQUENTIAL DAMAGES OR ANY DAMAGES WHATSOEVER RESULTING FROM LOSS OF USE, DATA OR PROFITS, WHETHER IN AN
ACTION OF CONTRACT, NEGLIGENCE OR OTHER TORTIOUS ACTION, ARISING OUT OF OR IN CONNECTION WITH THE USE OR PERFORMANCE OF
THIS SOFTWARE.
"""


def licence_in(folder: str) -> dict[str, str]:
    """Return the licence as a file in this folder."""
    return {f"{folder}/LICENSE": _TEXT}


def our_runtime(language: str) -> Path:
    """Return the folder of the runtime for a language."""
    return Path(str(resources.files("codewheel.runtime"))) / language


def copied(folder: Path, to: str) -> dict[str, str]:
    """Return the text of each file in a folder and its subfolders, keyed by its path in the folder ``to``."""
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]
    return {f"{to}/{path.relative_to(folder).as_posix()}": path.read_text(encoding="utf-8") for path in paths}
