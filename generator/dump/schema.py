"""The shape of the plain data by the table of members, and its JSON Schema.

python -m codewheel.dump.schema                       prints the schema of ``show --json``
python -m codewheel.dump.schema show.schema.json      writes it to a file
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum, auto
from functools import cache
from pathlib import Path
from typing import Any

from ..model.members import FAMILY, PARTS, Member, Part
from ..model.record import dataclass

JsonSchema = dict[str, Any]

_SIMPLE: dict[str, JsonSchema] = {
    "string": {"type": "string"},
    "integer": {"type": "integer"},
    "number": {"type": "number"},
    "boolean": {"type": "boolean"},
    "hex": {"type": "integer", "x-form": "hexadecimal"},
    "scalar": {"type": ["integer", "string", "boolean"]},
}
_NULL: JsonSchema = {"type": "null"}
#: Types that are not parts of the model.
_BASIC: dict[str, JsonSchema] = {
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
def show_schema() -> JsonSchema:
    """Return the JSON Schema of the output of ``show --json``."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:codewheel:show:1",
        "title": "Output of codewheel show --json, version 1",
    }
    return head | _object(FAMILY) | {"$defs": _BASIC | {part.name: _object(part) for part in PARTS}}


def _object(part: Part) -> JsonSchema:
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


def _shape(notation: str) -> JsonSchema:
    """Return the schema of a type, given in the notation of ``Member.shape``."""
    if notation.startswith("="):
        return {"const": int(notation[1:])}
    notation, _, default = notation.partition("=")
    shape = _without_default(notation)
    return shape | {"default": json.loads(default)} if default else shape


def _without_default(notation: str) -> JsonSchema:
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


def _or_null(notation: str) -> JsonSchema:
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


Shape = Mapping[str, Any]


class Kind(Enum):
    """Form of a member in XML. LIST is also an attribute. KEYED is a map of objects, keyed by one of their members."""

    ATTRIBUTE = auto()
    LIST = auto()
    TEXT = auto()
    TEXTS = auto()
    OBJECT = auto()
    OBJECTS = auto()
    KEYED = auto()
    MAP = auto()


@dataclass(frozen=True)
class DataMember:
    """Member of an object: its form in XML, and the shape of its value."""

    name: str
    kind: Kind
    shape: Shape
    type_name: str = ""

    @property
    def types(self) -> tuple[str, ...]:
        """JSON types of the value."""
        return types_of(self.shape)

    @property
    def empty(self) -> Any:
        """Value that stands for a missing member."""
        if self.kind in (Kind.LIST, Kind.TEXTS, Kind.OBJECTS):
            return []
        if self.kind in (Kind.KEYED, Kind.MAP):
            return {}
        if self.kind is Kind.OBJECT or "null" in self.types:
            return None
        return self.shape.get("default", "")


def filled(dumped: Mapping[str, Any], type_name: str) -> dict[str, Any]:
    """Return an object with every member of its type, in schema order. Missing members are empty."""
    shape = show_schema()["$defs"][type_name]
    filled_members = {member.name: dumped.get(member.name, member.empty) for member in members(shape)}
    return filled_members | {name: dumped[name] for name in ("source", "sources") if name in dumped}


def members(shape: Shape) -> Iterator[DataMember]:
    """Yield the members of an object in schema order, without its sources."""
    for name, inner in shape["properties"].items():
        if name not in ("source", "sources"):
            yield _member(name, inner)


def resolved(shape: Shape) -> tuple[Shape, str]:
    """Return the shape to which a reference leads, and the name of the reference.

    The null alternative of an optional object is dropped.
    """
    reference = shape.get("$ref") or next(
        (alternative["$ref"] for alternative in shape.get("anyOf", ()) if "$ref" in alternative), ""
    )
    name = reference.rpartition("/")[2]
    return (show_schema()["$defs"][name], name) if name else (shape, "")


def _member(name: str, unresolved: Shape) -> DataMember:
    shape, type_name = resolved(unresolved)
    if type_name == "text":
        return DataMember(name, Kind.TEXT, shape)
    if shape.get("type") == "array":
        items, item_type = resolved(shape["items"])
        return DataMember(name, _kind_of_list(items, item_type), items, item_type)
    if "properties" in shape:
        return DataMember(name, Kind.OBJECT, shape, type_name)
    if "additionalProperties" in shape:
        if "x-key" in shape:
            items, item_type = resolved(shape["additionalProperties"])
            return DataMember(name, Kind.KEYED, {**items, "x-key": shape["x-key"]}, item_type)
        return DataMember(name, Kind.MAP, shape["additionalProperties"])
    return DataMember(name, Kind.ATTRIBUTE, shape, type_name)


def _kind_of_list(items: Shape, item_type: str) -> Kind:
    if item_type == "text":
        return Kind.TEXTS
    return Kind.OBJECTS if "properties" in items else Kind.LIST


def types_of(shape: Shape) -> tuple[str, ...]:
    """Return the JSON types of a value of this shape."""
    json_types = shape.get("type", "integer" if isinstance(shape.get("const"), int) else "string")
    return tuple(json_types) if isinstance(json_types, list) else (json_types,)


def is_hexadecimal(shape: Shape) -> bool:
    """Return whether a number of this shape is written in hexadecimal."""
    return shape.get("x-form") == "hexadecimal"


def main(arguments: Sequence[str]) -> int:
    """Print the schema of ``show --json``, or write it to the named file, and return the exit code."""
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print("usage: python -m codewheel.dump.schema [FILE]", file=sys.stderr)
        return 2
    if arguments:
        Path(arguments[0]).write_text(schema_text(), encoding="utf-8")
    else:
        print(schema_text(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
