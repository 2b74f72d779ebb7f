"""The language of second readings: the keys of a device file. Those for prose are optional.

It is derived from the schema of device files, so that each key is described only once. Other required keys of a device
file are filled in with stand-ins, so that rules and build can treat a second reading like a device file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

#: Suffix of a second reading, next to the file that it belongs to: ``encoder.second.yaml``.
SUFFIX = ".second"

#: Keys for prose, at any place. Of their texts, only the numbers and the cited sections are compared.
PROSE = frozenset(
    """
    source alignment_source output_code_source meaning note title names where changes content why
    special publisher mating detected remedy precondition result when_active when_inactive low high when_unused
    hexadecimal profile signals
    """.split()
)
#: Parts of a device file that explain or calculate.
NO_FACTS = frozenset("evidence documents lost_figures examples errata editions".split())
#: Keys that a spec must have and its second reading does not need.
_NOT_NEEDED = frozenset(("manufacturer",))

#: Parts that only a second reading has.
ONLY_SECOND: dict[str, dict[str, Any]] = {
    "sections": {
        "description": "Sections of the manual, each with the paths of the facts that come from there. A path applies"
        " to everything under it, unless a more specific path is listed.",
        "type": "object",
        "additionalProperties": {"type": "array", "minItems": 1, "items": {"type": "string", "maxLength": 200}},
    },
    "found": {
        "description": "Numbers in texts, and cited sections, by path, that were not read a second time. They are"
        " compared, so that no later typo passes, but count as read once.",
        "type": "object",
        "additionalProperties": {"type": "string", "maxLength": 500},
    },
    "decided": {
        "description": "Facts that the manual does not print, so that both readings contain a decision: paths, or"
        " classes of facts such as verdict.",
        "type": "array",
        "items": {"type": "string", "maxLength": 200},
    },
}

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
    made: dict[str, Any] = _prose_optional(schema)
    made["properties"] = {key: item for key, item in made["properties"].items() if key not in NO_FACTS}
    made["properties"] |= ONLY_SECOND
    made["required"] = [key for key in made["required"] if key not in _NOT_NEEDED | NO_FACTS]
    return made


def is_left_out(key: str) -> bool:
    """Return True if device files have this key and second readings do not."""
    return key in NO_FACTS


def _prose_optional(schema: Any) -> Any:
    """Return a part of the schema in which no key for prose is required."""
    if isinstance(schema, list):
        return [_prose_optional(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    return {
        key: [word for word in item if word not in PROSE] if key == "required" else _prose_optional(item)
        for key, item in schema.items()
    }


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
        if key not in made and key in PROSE:
            made[key] = _SOME_SOURCE if key == "source" else "?"
    return made
