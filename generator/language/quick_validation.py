"""A quick test whether data follows a schema, for files without errors.

It supports only the keywords that our schemas use. In any doubt the answer is no, and jsonschema decides and finds the
errors. Importing jsonschema takes several times as long as this test takes for a whole spec.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

_TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
}


def follows_schema(value: Any, schema: Mapping[str, Any]) -> bool:
    """Return True if a value follows a schema without references, and False if it may not."""
    return all(key in _TESTS and _TESTS[key](value, expected, schema) for key, expected in schema.items())


def matches(pattern: str, text: str) -> bool:
    """Return True if a pattern of a schema matches the whole text.

    JSON Schema searches for the pattern, so that a name could end in a line break.
    """
    return re.fullmatch(pattern, text.replace("\n", "\0")) is not None


def _is_of_type(value: Any, expected: str | list[str], _: object) -> bool:
    names = [expected] if isinstance(expected, str) else expected
    return any(type(value) in _TYPES.get(name, ()) for name in names)


def _is_one_of(value: Any, expected: list[Any], _: object) -> bool:
    return any(type(value) is type(allowed_value) and value == allowed_value for allowed_value in expected)


def _has_properties(value: Any, expected: Mapping[str, Any], _: object) -> bool:
    if not isinstance(value, dict):
        return True
    return all(follows_schema(value[key], expected[key]) for key in value if key in expected)


def _has_additional(value: Any, expected: Any, schema: Mapping[str, Any]) -> bool:
    if not isinstance(value, dict):
        return True
    additional_values = [inner for key, inner in value.items() if key not in schema.get("properties", ())]
    return not additional_values or (
        isinstance(expected, dict) and all(follows_schema(inner, expected) for inner in additional_values)
    )


def _only_for_type(kind: str, test: Callable[[Any, Any], bool]) -> Callable[[Any, Any, object], bool]:
    """Return a test that values of other types pass."""
    return lambda value, expected, _: type(value) not in _TYPES[kind] or test(value, expected)


_TESTS: Mapping[str, Callable[[Any, Any, Any], bool]] = {
    **dict.fromkeys(("$schema", "$id", "title", "description"), lambda value, expected, schema: True),
    "type": _is_of_type,
    "enum": _is_one_of,
    "const": lambda value, expected, schema: _is_one_of(value, [expected], schema),
    "properties": _has_properties,
    "additionalProperties": _has_additional,
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
