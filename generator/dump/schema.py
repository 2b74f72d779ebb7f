"""JSON Schema of the plain data, derived from the table of members.

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

from ..model.members import FAMILY, PARTS, ModelMember, ModelPart
from ..model.record import dataclass

JsonSchema = dict[str, Any]

_SIMPLE_TYPES: dict[str, JsonSchema] = {
    "string": {"type": "string"},
    "integer": {"type": "integer"},
    "number": {"type": "number"},
    "boolean": {"type": "boolean"},
    "hex": {"type": "integer", "x-form": "hexadecimal"},
    "scalar": {"type": ["integer", "string", "boolean"]},
}
_NULL_TYPE: JsonSchema = {"type": "null"}
#: Types that are not parts of the model.
_BASIC_TYPES: dict[str, JsonSchema] = {
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
_FIRST_SOURCE_MEMBER = ModelMember(
    "source", "source?", "First source. An item without its own source inherits the source of its parent."
)
_ALL_SOURCES_MEMBER = ModelMember("sources", "[source]", "All sources, if there are several.")


@cache
def schema_of_device_data() -> JsonSchema:
    """Return the JSON Schema of the output of ``show --json``."""
    identity = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:codewheel:show:1",
        "title": "Output of codewheel show --json, version 1",
    }
    definitions = _BASIC_TYPES | {part.name: _object_schema(part) for part in PARTS}
    return identity | _object_schema(FAMILY) | {"$defs": definitions}


def _object_schema(part: ModelPart) -> JsonSchema:
    """Return the schema of an object with the members of a part of the model. All are required except ``sources``.

    Members without a type are not in the data.
    """
    members = [member for member in part.members if member.data_type]
    required_members = members
    optional_members = []
    if part.is_sourced:
        required_members = [*members, _FIRST_SOURCE_MEMBER]
        optional_members = [_ALL_SOURCES_MEMBER]
    properties = {}
    for member in (*required_members, *optional_members):
        properties[member.name] = {"description": member.about} | _schema_of(member.data_type)
    return {
        "description": part.about,
        "type": "object",
        "additionalProperties": False,
        "required": [member.name for member in required_members],
        "properties": properties,
    }


def _schema_of(notation: str) -> JsonSchema:
    """Return the schema of a type in the notation of ``ModelMember.data_type``, such as ``=1`` or ``hex=0``."""
    if notation.startswith("="):
        return {"const": int(notation.removeprefix("="))}
    type_notation, _, default_json = notation.partition("=")
    schema = _schema_without_default(type_notation)
    return schema | {"default": json.loads(default_json)} if default_json else schema


def _schema_without_default(notation: str) -> JsonSchema:
    """Return the schema of a list ``[x]``, a map ``{key:x}``, an optional ``x?``, words ``a|b``, or a named type."""
    inside_brackets = notation[1:-1]
    if notation.startswith("["):
        return {"type": "array", "items": _schema_of(inside_brackets)}
    if notation.startswith("{"):
        # ``{text}`` is a map with any keys, and ``{name:register}`` one whose keys are the member ``name``.
        key_name, colon, value_notation = inside_brackets.rpartition(":")
        key_member = {"x-key": key_name} if colon else {}
        return {"type": "object"} | key_member | {"additionalProperties": _schema_of(value_notation)}
    if notation.endswith("?"):
        return _schema_or_null(notation.removesuffix("?"))
    if "|" in notation:
        return {"enum": notation.split("|")}
    return _SIMPLE_TYPES.get(notation) or {"$ref": f"#/$defs/{notation}"}


def _schema_or_null(notation: str) -> JsonSchema:
    """Return the schema of an optional type, of which null is another value."""
    # An expression already has several types.
    if notation == "expression":
        return {"type": ["integer", "string", "null"]}
    schema = _schema_without_default(notation)
    if "type" not in schema:
        return {"anyOf": [schema, _NULL_TYPE]}
    return schema | {"type": [schema["type"], "null"]}


def schema_text() -> str:
    """Return the schema as text, with one member per line."""
    return "".join(_schema_lines(schema_of_device_data(), "")) + "\n"


def _schema_lines(schema_value: Any, indent: str) -> Iterator[str]:
    """Yield pieces of the text of a schema. Only schemas of objects and maps of schemas are divided into several lines.

    ``indent`` is the white space before the closing brace.
    """
    is_object = isinstance(schema_value, dict) and "properties" in schema_value
    is_map_of_schemas = isinstance(schema_value, dict) and all(
        isinstance(member_value, dict) for member_value in schema_value.values()
    )
    if not is_object and not is_map_of_schemas:
        yield json.dumps(schema_value, ensure_ascii=False)
        return
    yield "{\n"
    for index, (member_name, member_value) in enumerate(schema_value.items()):
        is_last = index == len(schema_value) - 1
        yield f"{indent}  {json.dumps(member_name)}: "
        yield from _schema_lines(member_value, f"{indent}  ")
        yield "\n" if is_last else ",\n"
    yield indent + "}"


Schema = Mapping[str, Any]


class MemberForm(Enum):
    """Form of a member in XML.

    ``ATTRIBUTE`` is a single value, and ``LIST`` an attribute with several values. ``TEXT`` and ``OBJECT`` are elements
    with one text or object, and ``TEXTS`` and ``OBJECTS`` elements with several. ``KEYED`` is a map of objects, each
    with its key as a member, and ``MAP`` a map of values.
    """

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
    """Member of an object: its form in XML, and the schema of its value, or of the values in a list or map."""

    name: str
    form: MemberForm
    schema: Schema
    type_name: str = ""

    @property
    def types(self) -> tuple[str, ...]:
        """JSON types of the value."""
        return json_types_of(self.schema)

    @property
    def empty(self) -> Any:
        """Value for a missing member: an empty list or map, null, the default, or else an empty string."""
        if self.form in (MemberForm.LIST, MemberForm.TEXTS, MemberForm.OBJECTS):
            return []
        if self.form in (MemberForm.KEYED, MemberForm.MAP):
            return {}
        if self.form is MemberForm.OBJECT or "null" in self.types:
            return None
        return self.schema.get("default", "")


def fill_members(object_data: Mapping[str, Any], type_name: str) -> dict[str, Any]:
    """Return an object with all members of its type, in the order of the schema, followed by its sources.

    A missing member gets the value ``DataMember.empty``.
    """
    object_schema = schema_of_device_data()["$defs"][type_name]
    filled_members = {
        member.name: object_data.get(member.name, member.empty) for member in schema_members(object_schema)
    }
    return filled_members | {name: object_data[name] for name in ("source", "sources") if name in object_data}


def schema_members(object_schema: Schema) -> Iterator[DataMember]:
    """Yield the members of an object in schema order, without its sources."""
    for name, inner in object_schema["properties"].items():
        if name not in ("source", "sources"):
            yield _data_member(name, inner)


def resolve_reference(schema: Schema) -> tuple[Schema, str]:
    """Return the named schema to which a reference leads, and its name.

    The reference may also be one of two alternatives, the other of which is null. For a schema without a reference,
    return the schema itself and an empty name.
    """
    for alternative in (schema, *schema.get("anyOf", ())):
        if "$ref" in alternative:
            name = alternative["$ref"].removeprefix("#/$defs/")
            named_schemas = schema_of_device_data()["$defs"]
            return named_schemas[name], name
    return schema, ""


def _data_member(name: str, schema_or_reference: Schema) -> DataMember:
    """Return a member with its form in XML. ``schema_or_reference`` may be a reference to a named schema."""
    schema, type_name = resolve_reference(schema_or_reference)
    if type_name == "text":
        return DataMember(name, MemberForm.TEXT, schema=schema)
    if schema.get("type") == "array":
        value_schema, value_type = resolve_reference(schema["items"])
        list_kind = _form_of_list(value_schema, value_type)
        return DataMember(name, list_kind, schema=value_schema, type_name=value_type)
    if "properties" in schema:
        return DataMember(name, MemberForm.OBJECT, schema=schema, type_name=type_name)
    if "additionalProperties" in schema:
        # With ``x-key``, the values are objects, and the keys of the map are a member of them.
        if "x-key" in schema:
            value_schema, value_type = resolve_reference(schema["additionalProperties"])
            schema_with_key = {**value_schema, "x-key": schema["x-key"]}
            return DataMember(name, MemberForm.KEYED, schema=schema_with_key, type_name=value_type)
        return DataMember(name, MemberForm.MAP, schema=schema["additionalProperties"])
    return DataMember(name, MemberForm.ATTRIBUTE, schema=schema, type_name=type_name)


def _form_of_list(value_schema: Schema, value_type: str) -> MemberForm:
    """Return the form of a list in XML: texts, objects, or words in an attribute."""
    if value_type == "text":
        return MemberForm.TEXTS
    return MemberForm.OBJECTS if "properties" in value_schema else MemberForm.LIST


def json_types_of(schema: Schema) -> tuple[str, ...]:
    """Return the JSON types of a value with this schema: ``("integer", "null")``. A list of words is a string."""
    if "type" not in schema:
        return ("integer",) if isinstance(schema.get("const"), int) else ("string",)
    json_types = schema["type"]
    return tuple(json_types) if isinstance(json_types, list) else (json_types,)


def is_hexadecimal(schema: Schema) -> bool:
    """Return whether a number with this schema is written in hexadecimal."""
    return schema.get("x-form") == "hexadecimal"


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
