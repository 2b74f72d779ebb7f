"""The parts of the spec language that are described by classes, as JSON Schema.

``python -m codewheel.language.part_schema`` writes them into ``device.schema.json``. Editors and commands read that
file. A test compares the two.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..model import facts, fields, interface_parts, interfaces, kinds, manual, measurement
from ..model.keys_and_members import JsonSchema, KeyType, key_type, limits_in_schema, name_of_part
from ..model.part import DescribedKey, SpecKey, description_of, is_part, keys_of
from . import written_codes, written_interfaces, written_layouts, written_parts

#: Modules with parts.
_MODULES_WITH_PARTS = (
    interface_parts,
    interface_parts,
    manual,
    manual,
    facts,
    fields,
    interfaces,
    kinds,
    measurement,
    written_layouts,
    written_interfaces,
    written_codes,
    written_parts,
)
#: Places of parts in the definitions of the schema, if they are not called like the class.
_DEFINITION_PLACES: Mapping[str, str] = MappingProxyType(
    {
        "Edition": "manual.editions.items",
        "LayoutRange": "position_range",
        "Revision": "manual.history.items",
        "WrittenValue": "values.additionalProperties",
    }
)
#: Largest number of rows of a fact that depends on the order code.
_MOST_ROWS = 100
#: Line of the schema after which the definitions begin.
_START_OF_DEFINITIONS = '  "$defs": {'
_SCHEMA_FILE = Path(__file__).parent / "device.schema.json"


def described_parts() -> dict[str, Any]:
    """Return the classes that describe the parts of a spec, by name. Imported classes are returned only once."""
    classes = {}
    for module in _MODULES_WITH_PARTS:
        for member in vars(module).values():
            if is_part(member) and member.__module__ == module.__name__:
                classes[member.__name__] = member
    return classes


def part_schema(part_class: Any) -> JsonSchema:
    """Return the JSON Schema of a part: an object with its written keys and no others."""
    part_description = description_of(part_class)
    written_keys = [described for described in keys_of(part_class) if described.key.is_written]
    required_keys = [described.name for described in written_keys if described.is_required]
    description_text = f"{part_description.about} {part_description.writing}".strip()
    schema: JsonSchema = {"type": "object", "additionalProperties": False}
    if required_keys:
        schema["required"] = required_keys
    if part_description.needs_a_key:
        schema["minProperties"] = 1
    if description_text:
        schema["description"] = description_text
    return schema | {"properties": {described.name: _key_schema(described) for described in written_keys}}


def _key_schema(described: DescribedKey) -> JsonSchema:
    """Return the JSON Schema of a key: its description, and its own schema or the schema of its type and limits."""
    key = described.key
    value_type = key_type(described.notation)
    description_text = f"{key.about} {key.writing}".rstrip()
    schema: JsonSchema = {"description": description_text} if description_text else {}
    if key.schema:
        return {**schema, **key.schema}
    return schema | _value_schema(value_type, key) | limits_in_schema(key)


def _value_schema(value_type: KeyType, key: SpecKey) -> JsonSchema:
    """Return the JSON Schema of a value of this type, with the limits of ``key`` for the length of a list or map.

    A part that has a definition in the schema is referred to. Other parts are described inline.
    """
    if value_type.container == "list":
        lowest_count: JsonSchema = {"minItems": key.least} if key.least else {}
        elements = _value_schema(value_type.inner, SpecKey(""))  # A key without a description and limits.
        return {"type": "array"} | lowest_count | {"maxItems": key.most, "items": elements}
    if value_type.container == "one_or_more":
        return _one_or_more_schema(value_type.inner)
    if value_type.container == "map":
        lowest_count = {"minProperties": key.least} if key.least else {}
        keys_and_values = {
            "propertyNames": value_type.key_schema,
            "additionalProperties": _value_schema(value_type.inner, SpecKey("")),
        }
        return {"type": "object"} | lowest_count | {"maxProperties": key.most} | keys_and_values
    if not value_type.part:
        return value_type.schema
    name = _DEFINITION_PLACES.get(value_type.class_name, value_type.part)
    if name in _read_definitions():
        return {"$ref": f"#/$defs/{name}"}
    return part_schema(described_parts()[value_type.class_name])


def _one_or_more_schema(value_type: KeyType) -> JsonSchema:
    """Return the JSON Schema of a value that is a part or a list of such parts.

    It contains the keywords of both, because JSON Schema applies each keyword only to its own type.
    """
    schema_of_part = part_schema(described_parts()[value_type.class_name])
    schema_of_part.pop("description", None)
    schema_of_list = {"minItems": 1, "maxItems": _MOST_ROWS, "items": _value_schema(value_type, SpecKey(""))}
    return schema_of_part | {"type": ["object", "array"]} | schema_of_list


def _read_definitions() -> Mapping[str, Any]:
    """Return the definitions of the schema file, which is read each time."""
    definitions: Mapping[str, Any] = json.loads(_SCHEMA_FILE.read_text(encoding="utf-8"))["$defs"]
    return definitions


def schema_with_parts(text: str) -> str:
    """Return the text of a schema in which the keys of a spec and the definitions of parts follow their classes.

    A part that has no block in ``$defs`` is skipped. Other lines remain as they are.
    """
    lines = text.splitlines()
    definitions = json.loads(text)["$defs"]
    spec_keys = part_schema(written_parts.WrittenSpec)["properties"]
    lines = _with_block(lines, 0, ["properties"], lambda indent: _value_text("properties", spec_keys, indent))
    for name, part_class in described_parts().items():
        # Such as ``field``, or ``manual.editions`` for a part inside the definition of another one.
        definition_path = _DEFINITION_PLACES.get(name, name_of_part(name))
        definition, _, _ = definition_path.partition(".")
        if definition in definitions:
            schema = part_schema(part_class)
            definitions_line = lines.index(_START_OF_DEFINITIONS)
            lines = _with_block(lines, definitions_line, definition_path.split("."), partial(_format_schema, schema))
    return "\n".join(lines) + "\n"


def _with_block(
    lines: Sequence[str], line_before: int, keys: Sequence[str], format_value: Callable[[int], str]
) -> list[str]:
    """Return the lines of a schema in which the block at the path ``keys``, after ``line_before``, is replaced.

    A block consists of the lines from ``"key": {`` to the brace with the same indentation. Each key is searched in the
    block of the key before it: for ``["manual", "editions"]``, the block ``editions`` in ``manual`` is replaced.
    ``format_value`` returns the text of the new value, from its opening brace, for a given indentation.
    """
    block = range(line_before, len(lines))
    for key in keys:
        block = _find_block(lines, key, possible_lines=block[1:])
    first_line, last_line = block[0], block[-1]
    indentation = _indentation_of(lines[first_line])
    comma = "," if lines[last_line].endswith(",") else ""
    new_block = f'{" " * indentation}"{keys[-1]}": {format_value(indentation)}{comma}'
    return [*lines[:first_line], *new_block.splitlines(), *lines[last_line + 1 :]]


def _find_block(lines: Sequence[str], key: str, *, possible_lines: range) -> range:
    """Return the numbers of the lines from ``"key": {`` to its closing brace, which has the same indentation."""
    first_line = _find_line(lines, possible_lines, lambda line: line.strip() == f'"{key}": {{')
    closing_brace = " " * _indentation_of(lines[first_line]) + "}"
    lines_below = range(first_line, possible_lines.stop)
    last_line = _find_line(lines, lines_below, lambda line: line.startswith(closing_brace))
    return range(first_line, last_line + 1)


def _find_line(lines: Sequence[str], possible_lines: range, is_wanted: Callable[[str], bool]) -> int:
    """Return the number of the first of the possible lines that is wanted. There must be one."""
    return next(number for number in possible_lines if is_wanted(lines[number]))


def _indentation_of(line: str) -> int:
    """Return the number of spaces at the start of a line."""
    return len(line) - len(line.lstrip())


def _format_schema(schema: JsonSchema, indent: int) -> str:
    """Return the text of a schema. Only objects with properties, and their containers, take several lines.

    Inside them, each description and each nested object is on a line of its own, and other keywords share a line.
    """
    if '"properties"' not in json.dumps(schema):
        return json.dumps(schema, ensure_ascii=False)
    lines: list[str] = []
    words_on_line: JsonSchema = {}
    for word, value in schema.items():
        has_own_line = word == "description" or isinstance(value, dict)
        if has_own_line:
            lines += [*_on_one_line(words_on_line), f"{json.dumps(word)}: {_value_text(word, value, indent + 2)}"]
            words_on_line = {}
        else:
            words_on_line[word] = value
    return _in_braces([*lines, *_on_one_line(words_on_line)], indent)


def _on_one_line(words: JsonSchema) -> list[str]:
    """Return the words as one line without braces, or no line if there are none."""
    return [json.dumps(words, ensure_ascii=False)[1:-1]] if words else []


def _value_text(word: str, schema_value: Any, indent: int) -> str:
    """Return the text of a value in a schema. Each of the ``properties`` is on a line of its own."""
    if word == "properties":
        lines = [f"{json.dumps(name)}: {_format_schema(inner, indent + 2)}" for name, inner in schema_value.items()]
        return _in_braces(lines, indent)
    if isinstance(schema_value, dict):
        return _format_schema(schema_value, indent)
    return json.dumps(schema_value, ensure_ascii=False)


def _in_braces(lines: Sequence[str], indent: int) -> str:
    """Return lines in braces, separated by commas. ``indent`` is the indentation of the closing brace."""
    margin = " " * (indent + 2)
    return "{\n" + ",\n".join(margin + line for line in lines) + "\n" + " " * indent + "}"


def main() -> int:
    """Write the parts into the schema."""
    _SCHEMA_FILE.write_text(schema_with_parts(_SCHEMA_FILE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
