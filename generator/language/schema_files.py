"""The JSON Schemas as data. Validating with them is in ``schema``, whose validator takes long to import."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

from .second_reading import second_reading_schema


@functools.cache
def load_schema(kind: str) -> dict[str, Any]:
    """Load the JSON Schema of this name, such as ``device``. Do not modify the result.

    The schema of second readings, ``second``, is derived from ``device``.
    """
    if kind == "second":
        return second_reading_schema(load_schema("device"))
    text = (Path(__file__).parent / f"{kind}.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


@functools.cache
def keys_of(kind: str) -> frozenset[str]:
    """Return the keys allowed at the top level of a ``device``, ``manufacturer``, ``master`` or ``overlay`` file."""
    return frozenset(load_schema(kind)["properties"])
