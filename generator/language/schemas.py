"""The JSON Schemas as data: of each kind of file, of second readings, and of the parts that classes describe.

The keys of each part of a spec are in device.schema.json. ``python -m codewheel.language.schemas`` writes the parts
that classes describe into it, and a test compares the two. The language of second readings is derived from it, so that
each key is described only once. A quick test tells whether data follow a schema. It supports only the keywords that our
schemas use. In any doubt its answer is no, and jsonschema decides. Importing jsonschema takes several times as long as
this test takes for a whole spec.
"""

from __future__ import annotations

import functools
import json
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..model import facts, fields, interface_parts, interfaces, kinds, manual, measurement
from ..model.keys_and_members import JsonSchema, KeyType, key_type, limits_in_schema, name_of_part
from ..model.part import DescribedKey, SpecKey, description_of, is_part, keys_of
from . import keys_of_fields, keys_of_order_codes, keys_of_specs

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
        "description": "Numbers in texts and cited sections that were not read a second time, by path. They are still"
        " compared, which catches later typos, but they count as having been read only once.",
        "type": "object",
        "additionalProperties": {"type": "string", "maxLength": 500},
    },
    "decided": {
        "description": "Facts that the manual does not print, for which each reading contains a decision: paths, or"
        " classes of facts such as verdict.",
        "type": "array",
        "items": {"type": "string", "maxLength": 200},
    },
}


def second_reading_schema(schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return the schema of second readings, derived from the schema of device files.

    Prose and the manufacturer are optional, parts that explain or calculate are left out, and parts of second readings
    are added.
    """
    derived_schema: dict[str, Any] = _with_optional_prose(schema)
    properties = derived_schema["properties"]
    derived_schema["properties"] = {key: properties[key] for key in properties if key not in NO_FACTS} | ONLY_SECOND
    optional_keys = _NOT_NEEDED | NO_FACTS
    derived_schema["required"] = [key for key in derived_schema["required"] if key not in optional_keys]
    return derived_schema


def is_only_in_device_files(key: str) -> bool:
    """Return True if device files have this key and second readings do not."""
    return key in NO_FACTS


def _with_optional_prose(schema: Any) -> Any:
    """Return a copy of a JSON Schema, or of a part of it, in which no key for prose, such as ``note``, is required."""
    if isinstance(schema, list):
        return [_with_optional_prose(inner) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    copied_schema = {keyword: _with_optional_prose(inner) for keyword, inner in schema.items()}
    if "required" in schema:
        copied_schema["required"] = [key for key in schema["required"] if key not in PROSE]
    return copied_schema


@functools.cache
def load_schema(file_kind: str) -> dict[str, Any]:
    """Load the JSON Schema of this name, such as ``device``. Do not modify the result.

    The schema of second readings, ``second``, is derived from ``device``.
    """
    if file_kind == "second":
        return second_reading_schema(load_schema("device"))
    schema_text = (Path(__file__).parent / f"{file_kind}.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(schema_text)
    return schema


@functools.cache
def keys_of_file_kind(file_kind: str) -> frozenset[str]:
    """Return the keys allowed at the top level of a ``device``, ``manufacturer``, ``master`` or ``overlay`` file."""
    return frozenset(load_schema(file_kind)["properties"])


@functools.cache
def schema_without_references(file_kind: str) -> dict[str, Any]:
    """Return the JSON Schema of a kind of file without references. Do not modify the result."""
    schema = load_schema(file_kind)
    inlined: dict[str, Any] = _inline_references(schema, schema.get("$defs", {}))
    return inlined


def _inline_references(schema: Any, definitions: dict[str, Any]) -> Any:
    """Return a schema in which each reference is replaced by its definition. This halves the time of the check.

    No definition may refer to itself. The definitions themselves are left out.
    """
    if isinstance(schema, list):
        return [_inline_references(inner, definitions) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    keywords = dict(schema)
    if "$ref" in schema:
        keywords |= definitions[schema["$ref"].removeprefix("#/$defs/")]
    return {
        key: _inline_references(value, definitions) for key, value in keywords.items() if key not in ("$ref", "$defs")
    }


#: Modules with parts.
_MODULES_WITH_PARTS = (
    interface_parts,
    manual,
    facts,
    fields,
    interfaces,
    kinds,
    measurement,
    keys_of_fields,
    keys_of_order_codes,
    keys_of_specs,
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
    class_by_name = {}
    for module in _MODULES_WITH_PARTS:
        for member in vars(module).values():
            if is_part(member) and member.__module__ == module.__name__:
                class_by_name[member.__name__] = member
    return class_by_name


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


def schema_with_parts(schema_text: str) -> str:
    """Return the text of a schema in which the keys of a spec and the definitions of parts follow their classes.

    A part that has no block in ``$defs`` is skipped. Other lines remain as they are.
    """
    lines = schema_text.splitlines()
    definitions = json.loads(schema_text)["$defs"]
    spec_keys = part_schema(keys_of_specs.WrittenSpec)["properties"]
    lines = _replace_block(lines, 0, ["properties"], lambda indent: _format_value("properties", spec_keys, indent))
    for name, part_class in described_parts().items():
        # Such as ``field``, or ``manual.editions`` for a part inside the definition of another one.
        definition_path = _DEFINITION_PLACES.get(name, name_of_part(name))
        definition, _, _ = definition_path.partition(".")
        if definition in definitions:
            schema = part_schema(part_class)
            definitions_line = lines.index(_START_OF_DEFINITIONS)
            lines = _replace_block(lines, definitions_line, definition_path.split("."), partial(_format_schema, schema))
    return "\n".join(lines) + "\n"


def _replace_block(
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
    keywords_on_line: JsonSchema = {}
    for keyword, value in schema.items():
        has_own_line = keyword == "description" or isinstance(value, dict)
        if has_own_line:
            lines += [
                *_on_one_line(keywords_on_line),
                f"{json.dumps(keyword)}: {_format_value(keyword, value, indent + 2)}",
            ]
            keywords_on_line = {}
        else:
            keywords_on_line[keyword] = value
    return _in_braces([*lines, *_on_one_line(keywords_on_line)], indent)


def _on_one_line(words: JsonSchema) -> list[str]:
    """Return the words as one line without braces, or no line if there are none."""
    return [json.dumps(words, ensure_ascii=False)[1:-1]] if words else []


def _format_value(keyword: str, schema_value: Any, indent: int) -> str:
    """Return the text of a value in a schema. Each of the ``properties`` is on a line of its own."""
    if keyword == "properties":
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


_PYTHON_TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
}


def follows_schema(checked_value: Any, schema: Mapping[str, Any]) -> bool:
    """Return True if a value certainly follows a JSON Schema without references. False means that it may not.

    If the schema has a keyword that this quick test does not support, the result is False.
    """
    return all(key in _CHECKS and _CHECKS[key](checked_value, expected, schema) for key, expected in schema.items())


def matches(pattern: str, checked_text: str) -> bool:
    """Return True if a pattern of a schema matches the whole text.

    JSON Schema searches for the pattern, so that a name could end in a line break.
    """
    return re.fullmatch(pattern, checked_text.replace("\n", "\0")) is not None


def _follows_type(checked_value: Any, type_names: str | list[str], _: object) -> bool:
    """Return True if a value has one of the types under the keyword ``type``. True is a boolean, not an integer."""
    names = [type_names] if isinstance(type_names, str) else type_names
    return any(type(checked_value) in _PYTHON_TYPES.get(name, ()) for name in names)


def _follows_enum(checked_value: Any, allowed_values: list[Any], _: object) -> bool:
    """Return True if a value is one of those under the keyword ``enum``, and has the same type."""
    allowed_values_of_type = [allowed for allowed in allowed_values if type(allowed) is type(checked_value)]
    return checked_value in allowed_values_of_type


def _follows_properties(checked_value: Any, schema_by_key: Mapping[str, Any], _: object) -> bool:
    """Return True if the values in a map follow the schemas of their keys under the keyword ``properties``.

    Other keys, and values that are not maps, are accepted.
    """
    if not isinstance(checked_value, dict):
        return True
    known_keys = [key for key in checked_value if key in schema_by_key]
    return all(follows_schema(checked_value[key], schema_by_key[key]) for key in known_keys)


def _follows_additional_properties(checked_value: Any, schema_of_others: Any, schema: Mapping[str, Any]) -> bool:
    """Return True if the keys of a map that are not in ``properties`` follow the keyword ``additionalProperties``.

    The keyword is False if no other keys are allowed, or the schema of their values.
    """
    if not isinstance(checked_value, dict):
        return True
    known_keys = schema.get("properties", ())
    other_values = [inner for key, inner in checked_value.items() if key not in known_keys]
    if not isinstance(schema_of_others, dict):
        return not other_values
    return all(follows_schema(inner, schema_of_others) for inner in other_values)


def _only_for_type(type_name: str, test: Callable[[Any, Any], bool]) -> Callable[[Any, Any, object], bool]:
    """Return a test for a keyword that applies only to one type, such as ``minItems`` to lists.

    Values of other types pass it.
    """
    return lambda value, expected, _: type(value) not in _PYTHON_TYPES[type_name] or test(value, expected)


_CHECKS: Mapping[str, Callable[[Any, Any, Any], bool]] = {
    **dict.fromkeys(("$schema", "$id", "title", "description"), lambda value, expected, schema: True),
    "type": _follows_type,
    "enum": _follows_enum,
    "const": lambda value, expected, schema: _follows_enum(value, [expected], schema),
    "properties": _follows_properties,
    "additionalProperties": _follows_additional_properties,
    "propertyNames": _only_for_type(
        "object", lambda value, expected: all(follows_schema(key, expected) for key in value)
    ),
    "required": _only_for_type("object", lambda value, expected: all(key in value for key in expected)),
    "minProperties": _only_for_type("object", lambda value, expected: len(value) >= expected),
    "maxProperties": _only_for_type("object", lambda value, expected: len(value) <= expected),
    "items": _only_for_type("array", lambda value, expected: all(follows_schema(inner, expected) for inner in value)),
    "minItems": _only_for_type("array", lambda value, expected: len(value) >= expected),
    "maxItems": _only_for_type("array", lambda value, expected: len(value) <= expected),
    "pattern": _only_for_type("string", lambda value, expected: matches(expected, value)),
    "minLength": _only_for_type("string", lambda value, expected: len(value) >= expected),
    "maxLength": _only_for_type("string", lambda value, expected: len(value) <= expected),
    "minimum": _only_for_type("number", lambda value, expected: value >= expected),
    "maximum": _only_for_type("number", lambda value, expected: value <= expected),
}
