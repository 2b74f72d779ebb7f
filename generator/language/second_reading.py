"""The language of second readings: the keys of a device file that are facts, without those for prose.

It is derived from the schema of device files, so that each key is described only once. Other required keys of a device
file are filled in with stand-ins, so that rules and build can treat a second reading like a device file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

#: Suffix of a second reading, next to the file that it belongs to: ``encoder.second.yaml``.
SUFFIX = ".second"

#: Keys for prose, at any place.
PROSE = frozenset(
    """
    source alignment_source output_code_source meaning note title names where changes content why
    special publisher mating detected remedy precondition result when_active when_inactive low high when_unused
    hexadecimal profile signals
    """.split()
)
#: Parts of a device file that explain or calculate.
NO_FACTS = frozenset("evidence documents lost_figures tables leds characteristics examples errata editions".split())
#: Keys that a spec must have and its second reading does not need.
_NOT_NEEDED = frozenset(("manufacturer",))

_SOME_SOURCE = "Cover"


def is_second(file: Path | str) -> bool:
    """Return True if a file has the name of a second reading."""
    return PurePath(file).stem.endswith(SUFFIX)


def beside(spec: Path) -> Path:
    """Return the path of the second reading of a spec."""
    return spec.with_name(f"{spec.stem}{SUFFIX}{spec.suffix}")


def counts_beside(spec: Path) -> Path:
    """Return the path of the file that counts the readings of the facts of a spec."""
    return spec.with_name(f"{spec.stem}.coverage.json")


def family_of(file: str) -> str:
    """Return the name of the family in a file: the stem, without the suffix of a second reading."""
    return PurePath(file).stem.removesuffix(SUFFIX)


def facts_only(schema: Mapping[str, Any]) -> dict[str, Any]:
    """Derive the schema of second readings from that of device files."""
    made: dict[str, Any] = _without_prose(schema)
    made["properties"] = {key: item for key, item in made["properties"].items() if key not in NO_FACTS}
    made["required"] = [key for key in made["required"] if key not in _NOT_NEEDED | NO_FACTS]
    return made


def is_prose(key: str) -> bool:
    """Return True if device files have this key and second readings do not."""
    return key in PROSE or key in NO_FACTS


def _without_prose(schema: Any) -> Any:
    """Return a part of the schema without the keys for prose."""
    if isinstance(schema, list):
        return [_without_prose(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    made: dict[str, Any] = {}
    for key, item in schema.items():
        if key in ("properties", "$defs"):
            made[key] = {word: _without_prose(part) for word, part in item.items() if word not in PROSE}
        elif key == "required":
            made[key] = [word for word in item if word not in PROSE]
        else:
            made[key] = _without_prose(item)
    return made


def filled(data: Any, schema: Mapping[str, Any]) -> Any:
    """Return checked data of a second reading, with a stand-in for each key required by ``schema`` of device files."""
    if isinstance(data, list):
        return [filled(item, schema.get("items", {})) for item in data]
    if not isinstance(data, dict):
        return data
    inside = schema.get("properties", {})
    others = schema.get("additionalProperties", {})
    made = {
        key: filled(item, inside.get(key) or (others if isinstance(others, dict) else {})) for key, item in data.items()
    }
    for key in schema.get("required", ()):
        if key not in made and is_prose(key):
            made[key] = _SOME_SOURCE if key == "source" else "?"
    return made
