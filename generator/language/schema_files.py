"""The JSON Schemas as data, and the language of second readings. This module loads no validator.

The keys of each part of a spec are in device.schema.json. The language of second readings is derived from it, so that
each key is described only once. Its other required keys are filled with stand-ins, so that rules and build can treat a
second reading like a device file.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

#: Suffix of a second reading, next to the file that it belongs to: ``encoder.second.yaml``.
SUFFIX = ".second"
#: Suffix of a sheet of turning words, next to the file that it belongs to: ``encoder.words.yaml``.
WORDS_SUFFIX = ".words"

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

_SOME_SOURCE = "Cover"


def is_second(file: Path | str) -> bool:
    """Return True if a file has the name of a second reading."""
    return PurePath(file).stem.endswith(SUFFIX)


def second_reading_path(spec: Path) -> Path:
    """Return the path of the second reading of a spec."""
    return spec.with_name(f"{spec.stem}{SUFFIX}{spec.suffix}")


def is_word_sheet(file: Path | str) -> bool:
    """Return True if a file has the name of a sheet of turning words."""
    return PurePath(file).stem.endswith(WORDS_SUFFIX)


def word_sheet_path(spec: Path) -> Path:
    """Return the path of the sheet of turning words of a spec."""
    return spec.with_name(f"{spec.stem}{WORDS_SUFFIX}{spec.suffix}")


def coverage_path(spec: Path) -> Path:
    """Return the path of the file that counts the readings of the facts of a spec."""
    return spec.with_name(f"{spec.stem}.coverage.json")


def family_of(file: str) -> str:
    """Return the name of the family in a file: the stem, without the suffix of a second reading or of a sheet."""
    return PurePath(file).stem.removesuffix(SUFFIX).removesuffix(WORDS_SUFFIX)


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


def with_stand_ins(file_data: Any, schema: Mapping[str, Any]) -> Any:
    """Return the data of a second reading with a stand-in for each missing key for prose that device files must have.

    ``schema`` is the schema of the same data in device files, without references.
    """
    if isinstance(file_data, list):
        return [with_stand_ins(inner, schema.get("items", {})) for inner in file_data]
    if not isinstance(file_data, dict):
        return file_data
    schema_by_key = schema.get("properties", {})
    schema_of_other_keys = schema.get("additionalProperties")
    if not isinstance(schema_of_other_keys, dict):  # False: no other keys are allowed.
        schema_of_other_keys = {}
    completed_data = {}
    for key, value in file_data.items():
        completed_data[key] = with_stand_ins(value, schema_by_key.get(key) or schema_of_other_keys)
    for key in schema.get("required", ()):
        if key not in completed_data and key in PROSE:
            completed_data[key] = _SOME_SOURCE if key == "source" else "?"
    return completed_data


@functools.cache
def load_schema(file_kind: str) -> dict[str, Any]:
    """Load the JSON Schema of this name, such as ``device``. Do not modify the result.

    The schema of second readings, ``second``, is derived from ``device``.
    """
    if file_kind == "second":
        return second_reading_schema(load_schema("device"))
    text = (Path(__file__).parent / f"{file_kind}.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


@functools.cache
def keys_of(file_kind: str) -> frozenset[str]:
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
