"""Derive the JSON Schema of the plain data from the table of members.

python -m codewheel.dump.schema generator/language/show.schema.json     writes it, as ``make spec-page`` does
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from ..model.members import FAMILY, PARTS, Member, Part

Shape = dict[str, Any]

_SIMPLE: dict[str, Shape] = {
    "string": {"type": "string"},
    "integer": {"type": "integer"},
    "number": {"type": "number"},
    "boolean": {"type": "boolean"},
    "hex": {"type": "integer", "x-form": "hexadecimal"},
    "scalar": {"type": ["integer", "string", "boolean"]},
}
_NULL: Shape = {"type": "null"}
#: Types that are not parts of the model.
_BASIC: dict[str, Shape] = {
    "name": {"description": "A word: a name, a key or a path.", "type": "string", "pattern": "^\\S*$"},
    "text": {"description": "Running text. Empty if there is none.", "type": "string"},
    "expression": {
        "description": "A whole number. In a family, if it depends on the order code, a sum of numbers, parameters, "
        "powers of two and products of these, such as 48 - singleturn_bits.",
        "type": ["integer", "string"],
    },
    "names": {
        "description": "Text by language code.",
        "type": "object",
        "additionalProperties": {"$ref": "#/$defs/text"},
    },
}
_SOURCE = Member("source", "source?", "First source. An item without its own source inherits the source of its parent.")
_SOURCES = Member("sources", "[source]", "All sources, if there are several.")


@cache
def show_schema() -> Shape:
    """Return the JSON Schema of the output of ``show --json``."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:codewheel:show:1",
        "title": "Output of codewheel show --json, version 1",
    }
    return head | _object(FAMILY) | {"$defs": _BASIC | {part.name: _object(part) for part in PARTS}}


def _object(part: Part) -> Shape:
    """Return the schema of an object with the members of a part."""
    members = [member for member in part.members if member.shape]
    sources = [_SOURCE, _SOURCES] if part.is_sourced else []
    properties = {}
    for member in (*members, *sources):
        properties[member.name] = {"description": member.about} | _shape(member.shape)
    return {
        "description": part.about,
        "type": "object",
        "additionalProperties": False,
        "required": [member.name for member in (*members, *sources[:1])],
        "properties": properties,
    }


def _shape(notation: str) -> Shape:
    """Return the schema of a type, given in the notation of ``Member.shape``."""
    if notation.startswith("="):
        return {"const": int(notation[1:])}
    notation, _, default = notation.partition("=")
    shape = _without_default(notation)
    return shape | {"default": json.loads(default)} if default else shape


def _without_default(notation: str) -> Shape:
    if notation.startswith("["):
        return {"type": "array", "items": _shape(notation[1:-1])}
    if notation.startswith("{"):
        key, colon, inner = notation[1:-1].rpartition(":")
        key_member = {"x-key": key} if colon else {}
        return {"type": "object"} | key_member | {"additionalProperties": _shape(inner)}
    if notation.endswith("?"):
        return _or_null(notation[:-1])
    if "|" in notation:
        return {"enum": notation.split("|")}
    return _SIMPLE.get(notation) or {"$ref": f"#/$defs/{notation}"}


def _or_null(notation: str) -> Shape:
    if notation == "expression":
        return {"type": ["integer", "string", "null"]}
    shape = _without_default(notation)
    if "type" not in shape:
        return {"anyOf": [shape, _NULL]}
    return shape | {"type": [shape["type"], "null"]}


def schema_text() -> str:
    """Return the schema as text, with one member per line."""
    return "".join(_lines(show_schema(), "")) + "\n"


def _lines(value: Any, indent: str) -> Iterator[str]:
    """Yield the text of a schema, in which only objects and maps of schemas take several lines."""
    takes_several_lines = isinstance(value, dict) and (
        "properties" in value or all(isinstance(member, dict) for member in value.values())
    )
    if not takes_several_lines:
        yield json.dumps(value, ensure_ascii=False)
        return
    yield "{\n"
    for index, (key, member) in enumerate(value.items()):
        yield f"{indent}  {json.dumps(key)}: "
        yield from _lines(member, f"{indent}  ")
        yield ",\n" if index < len(value) - 1 else "\n"
    yield indent + "}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(schema_text(), encoding="utf-8")
