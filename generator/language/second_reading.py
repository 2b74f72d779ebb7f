"""The language of second readings: the words of a device file that are facts, without those that are for people.

It is made from the schema of device files, so that a word has to be described once. What a device file needs besides is
filled in with stand-ins, so that the rules and the build find in a second reading what they find in a device file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

#: What a second reading is called, beside the file that it belongs to: ``encoder.second.yaml``.
SUFFIX = ".second"

#: Keys for people, wherever they stand.
PROSE = frozenset(
    """
    source alignment_source output_code_source meaning note title names where changes content why
    special publisher mating detected remedy precondition result when_active when_inactive low high when_unused
    hexadecimal profile signals
    """.split()
)
#: Parts of a device file that tell, work out or explain.
NO_FACTS = frozenset("documents lost_figures tables leds characteristics examples errata editions".split())
#: Keys that a spec has to have, and of which its second reading says nothing.
_NOT_NEEDED = frozenset(("manufacturer",))

_SOME_SOURCE = "Cover"


def is_second(file: Path | str) -> bool:
    """Whether a file is a second reading by its name."""
    return PurePath(file).stem.endswith(SUFFIX)


def beside(spec: Path) -> Path:
    """Where the second reading of a spec would stand."""
    return spec.with_name(f"{spec.stem}{SUFFIX}{spec.suffix}")


def counts_beside(spec: Path) -> Path:
    """Where it would be kept how often the facts of a spec were read."""
    return spec.with_name(f"{spec.stem}.coverage.json")


def family_of(file: str) -> str:
    """The name that the family in a file has: the stem, or of a second reading that of its spec."""
    return PurePath(file).stem.removesuffix(SUFFIX)


def facts_only(schema: Mapping[str, Any]) -> dict[str, Any]:
    """The schema of second readings, from that of device files."""
    made: dict[str, Any] = _without_prose(schema)
    made["properties"] = {key: item for key, item in made["properties"].items() if key not in NO_FACTS}
    made["required"] = [key for key in made["required"] if key not in _NOT_NEEDED]
    return made


def is_prose(key: str) -> bool:
    """Whether a device file has this key, and a second reading does not."""
    return key in PROSE or key in NO_FACTS


def _without_prose(schema: Any) -> Any:
    """A part of the schema without the keys for people."""
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
    """Checked data of a second reading, with a stand-in for each word that ``schema``, that of device files, needs."""
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
