"""Values that are still those of a template of ``codewheel new``. These are the texts with the word TODO."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from .document import Path
from .places import as_affected

_MARKER = re.compile(r"\bTODO\b")


def is_placeholder(text: object) -> bool:
    """Return True if a value is a text with the marker."""
    return isinstance(text, str) and _MARKER.search(text) is not None


def placeholder_paths(data: Any, path: Path = ()) -> Iterator[Path]:
    """Yield the path of each placeholder in the data of a spec, in its order."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from placeholder_paths(value, (*path, key))
    elif isinstance(data, list):
        for index, value in enumerate(data):
            yield from placeholder_paths(value, (*path, index))
    elif is_placeholder(data):
        yield path


def placeholder_names(data: dict[str, Any]) -> list[str]:
    """Return the names of all placeholders, each once. A source stands for the facts that cite it."""
    names = (placeholder_name(data, path) for path in placeholder_paths(data))
    return list(dict.fromkeys(names))


def placeholder_name(data: dict[str, Any], path: Path) -> str:
    """Return the name of the item whose source is a placeholder, such as ``registers.preset``, or of another text."""
    owner = path[:-1] if path[-1] == "source" and len(path) > 1 else path
    return as_affected(data, owner) or str(path[0])
