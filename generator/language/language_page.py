"""The reference pages of the spec language, generated from its JSON Schemas.

``python -m codewheel.language.language_page FOLDER`` writes the pages into the folder, as ``make spec-page`` does.
"""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..say.text import anchor_of, code_span, escape, markdown_link, table, wrap_markdown
from .problems import join_words
from .schemas import NO_FACTS, ONLY_SECOND, PROSE, load_schema

JsonSchema = Mapping[str, Any]
#: Largest number of entries of a list or mapping, unless its description gives another limit.
_MOST_ENTRIES = 2000
#: The JSON types, in the singular and in the plural.
_NOUNS_OF_JSON_TYPES = {
    "integer": ("whole number", "whole numbers"),
    "number": ("number", "numbers"),
    "string": ("string", "strings"),
    "boolean": ("`true` or `false`", "booleans"),
    "array": ("list", "lists"),
    "object": ("mapping", "mappings"),
}

_INTRODUCTION = """\
A spec is one YAML file for one manual. It is read side by side with the manual, so it keeps the manual's order and
names. Do not write values that can be calculated, such as masks and totals. The tool calculates them. Scalars follow
YAML 1.2: `7:0` and `no` are strings, `0x1F` is a number. Duplicate keys are errors.

A bit range has the high bit first (`7:6`), and bit 0 is the least significant. Fields without a position are listed in
sending order: the first is the most significant, or the least significant with `byte_order: low_byte_first`. Units are
part of a key (`min_hz`, `at_least_us`). Convert numbers that have other units.

Some limits bound the time to check a file, and are far above those of any known encoder. A list or mapping has at
most {most} entries, unless another limit is given. A list of fields has at most 512, including those of its groups.
The parts of an order code combine to at most 10,000 codes. Order codes, registers and alternatives combine to at
most 20,000 different sets of parameters, and the number of these sets times the number of all fields is at most
500,000. The same bound applies to the number of editions times the number of values in the file.

The language cannot describe a word that is repeated within one SSI frame, or Gray code over several
revolutions if the counts per turn are not a power of two. A CRC has one start value. If it depends on the order code,
write several CRCs, each in a field with `bits` that is 0 for the other order codes. [Another
page](../encoder/encoders.md#limits-of-the-spec-language) lists all the limits, with workarounds.

If a file begins with the following line, editors can complete and explain keys while you type:

```yaml
# yaml-language-server: $schema=../../generator/language/device.schema.json
```

`codewheel check FILE` reports all problems, with file, line and column."""


#: File name of the first page, which describes everything that no other page does.
FIRST_PAGE = "spec-language.md"
_OTHER_FILES = "spec-language-other-files.md"
#: The other pages on the device file: their titles and the definitions that they describe.
_OTHER_PAGES = {
    "spec-language-frames.md": (
        "Layouts, fields and CRCs",
        {"crc", "crc_number", "digits", "field", "field_group", "layout", "join", "combination", "names", "other_bits"}
        | {"position_range", "scale", "values"},
    ),
    "spec-language-interfaces.md": (
        "Interfaces and times",
        {"interfaces", "ssi", "biss", "rs485", "spi", "clock", "measurement", "timing", "timeout"},
    ),
    "spec-language-registers.md": (
        "Registers, procedures and open questions",
        {"register", "alarm", "procedure", "step", "printed_default", "hex_bytes", "alternative", "input"},
    ),
    "spec-language-hardware.md": (
        "Hardware, examples, errata and editions",
        {"table", "connector", "led", "characteristic", "quantity", "example", "erratum", "manual_edition", "change"}
        | {"places", "place", "edition_test"},
    ),
}
_PAGE_BY_DEFINITION = {name: page for page, (_, names) in _OTHER_PAGES.items() for name in names}

_OTHER_FILES_TITLE = "Manufacturer file, overlay and second reading"
_MADE_FROM = "<!-- Made from generator/language/*.schema.json by: make spec-page -->"
_LINK_TO_FIRST_PAGE = f"Part of [the spec language]({FIRST_PAGE})."

_SECOND_READING_INTRODUCTION = """\
`FAMILY.second.yaml`, in the same folder as the device file, is an independent transcription of the same manual by
another reader. It uses the same language. Only `codewheel check` reads it, and reports the differences between the two
files. It has no `manufacturer` and none of these parts, which explain or calculate: {lists}.

Keys for prose are optional. Of their texts, only the numbers and the cited sections are compared: {prose}.

Only a second reading has these keys:

{only}"""


def spec_pages() -> dict[str, str]:
    """Return the pages of ``docs/transcribe`` about the spec language, by file name."""
    device_schema = load_schema("device")
    definition_names = _definitions_in_order(device_schema)
    first_page_parts = [
        "# The spec language, version 1",
        _INTRODUCTION.format(most=_MOST_ENTRIES),
        _list_of_pages(definition_names),
        "## The device file",
        wrap_markdown(escape(device_schema["description"])),
        _format_table(device_schema, device_schema["$defs"]),
        *_describe_definitions(FIRST_PAGE, definition_names, device_schema["$defs"]),
    ]
    parts_by_page = {FIRST_PAGE: first_page_parts}
    for page, (title, _) in _OTHER_PAGES.items():
        parts_by_page[page] = [
            f"# {title}",
            _LINK_TO_FIRST_PAGE,
            *_describe_definitions(page, definition_names, device_schema["$defs"]),
        ]
    parts_by_page[_OTHER_FILES] = _other_files()
    # The parts of a page are separated by empty lines.
    return {page: "\n\n".join([_MADE_FROM, *parts]).rstrip() + "\n" for page, parts in parts_by_page.items()}


def _list_of_pages(names: Iterable[str]) -> str:
    """Return a list of links to the other pages, with the definitions that each describes."""
    list_items = []
    for page, (title, own_names) in _OTHER_PAGES.items():
        keys = ", ".join(markdown_link(code_span(name), f"{page}#{name}") for name in names if name in own_names)
        list_items.append(f"- {markdown_link(title, page)}: {keys}")
    list_items.append(f"- {markdown_link(_OTHER_FILES_TITLE, _OTHER_FILES)}")
    introduction = "This page describes the device file as a whole, its manual and its order codes. The others:"
    return "\n".join([introduction, "", *list_items])


def _describe_definitions(page: str, names: Iterable[str], definitions: JsonSchema) -> Iterator[str]:
    """Yield the sections on the definitions that a page describes."""
    for name in names:
        if _PAGE_BY_DEFINITION.get(name, FIRST_PAGE) == page:
            yield from _describe_definition(name, definitions[name], definitions)


def _other_files() -> list[str]:
    """Return the page on all files other than the device file."""
    manufacturer_schema = load_schema("manufacturer")
    overlay_schema = load_schema("overlay")
    return [
        f"# {_OTHER_FILES_TITLE}",
        _LINK_TO_FIRST_PAGE,
        "## The manufacturer file",
        wrap_markdown(escape(manufacturer_schema["description"])),
        "It is in the same folder as the device files and is called `manufacturer.yaml`.",
        _format_table(manufacturer_schema, {}),
        "## The overlay",
        wrap_markdown(escape(overlay_schema["description"])),
        "See [Overlays](how-to-revise.md#overlays-facts-from-outside-the-manual) for an example.",
        _format_table(overlay_schema, overlay_schema["$defs"]),
        "## The second reading",
        _SECOND_READING_INTRODUCTION.format(
            prose=_as_code(PROSE), lists=_as_code(NO_FACTS), only=_keys_of_second_readings()
        ),
    ]


def _keys_of_second_readings() -> str:
    return "\n".join(f"- `{key}`: {member['description']}" for key, member in ONLY_SECOND.items())


def _as_code(words: Iterable[str]) -> str:
    """Return words in alphabetical order, as code and separated by commas, in lines of at most 110 characters."""
    lines = textwrap.wrap(", ".join(f"`{word}`" for word in sorted(words)), 110)
    return "\n".join(lines)


def _definitions_in_order(schema: JsonSchema) -> list[str]:
    """Return the names of the definitions, each once, in the order of their first use on the page.

    A definition comes before the definitions that it uses.
    """
    definition_names: list[str] = []

    def add_names(schema_or_list: Any) -> None:
        if isinstance(schema_or_list, Mapping):
            name = _definition_name(schema_or_list)
            if name and name not in definition_names:
                definition_names.append(name)
                add_names(schema["$defs"][name])
            for key, inner in schema_or_list.items():
                if key != "$defs":
                    add_names(inner)
        elif isinstance(schema_or_list, list):
            for inner in schema_or_list:
                add_names(inner)

    add_names(schema)
    return definition_names


def _describe_definition(name: str, schema: JsonSchema, definitions: JsonSchema) -> Iterator[str]:
    """Yield the paragraphs of the section on a definition of the schema: its meaning, then its keys or its type.

    ``schema`` is the definition, a part of a JSON Schema.
    """
    yield anchor_of(name)
    yield f"### {code_span(name)}"
    yield wrap_markdown(escape(schema.get("description", "")))
    if "properties" in schema:
        yield _format_table(schema, definitions)
    else:
        type_text = _describe_type(schema)
        limits = _describe_limits(schema)
        capitalized_type = type_text[0].upper() + type_text[1:]
        yield f"{capitalized_type}: {limits}." if limits else f"{capitalized_type}."


def _format_table(schema: JsonSchema, definitions: JsonSchema) -> str:
    """Return the table of the keys of a shape, which is a part of a JSON Schema."""
    return table(["Key", "", "Value", "Meaning"], _yield_rows(schema, definitions))


def _definition_name(schema: JsonSchema) -> str:
    """Return the name of the definition that a shape refers to in ``$ref``, or an empty string."""
    return str(schema.get("$ref", "")).removeprefix("#/$defs/")


def _yield_rows(schema: JsonSchema, definitions: JsonSchema, prefix: str = "") -> Iterator[tuple[str, str, str, str]]:
    """Yield a row of the table of keys for each key of a schema, which is a JSON Schema or a part of one.

    A row contains the key, ``required`` or nothing, the type with its limits, and the meaning. Rows for inner keys
    follow, unless these have a section of their own. They have a prefix: ``clock.``, ``steps[].`` for elements of a
    list, ``<name>.`` for values in a map of names.
    """
    required_keys = schema.get("required", ())
    for key, schema_of_key in schema.get("properties", {}).items():
        limits = _describe_limits(schema_of_key)
        type_and_limits = f"{_describe_type(schema_of_key)}, {limits}" if limits else _describe_type(schema_of_key)
        definition = definitions.get(_definition_name(schema_of_key), {})
        meaning = schema_of_key.get("description") or definition.get("description", "")
        required_text = "required" if key in required_keys else ""
        yield code_span(prefix + key), required_text, type_and_limits, escape(meaning)
        is_one_or_more = "properties" in schema_of_key and "items" in schema_of_key
        if not is_one_or_more:  # Otherwise, the section of its items lists the keys.
            yield from _yield_rows(schema_of_key, definitions, f"{prefix}{key}.")
        yield from _yield_rows(schema_of_key.get("items", {}), definitions, f"{prefix}{key}[].")
    value_schema = schema.get("additionalProperties")
    if isinstance(value_schema, Mapping) and "properties" in value_schema:
        yield from _yield_rows(value_schema, definitions, f"{prefix}<name>.")


def _describe_type(schema: JsonSchema, plural: bool = False) -> str:
    """Return the type of a value in words, such as ``list of numbers``, or as a link if it has a section of its own.

    ``schema`` is the JSON Schema of the value. With ``plural``, the words are in the plural.
    """
    reference = _definition_name(schema)
    if reference:
        return markdown_link(code_span(reference), f"{_PAGE_BY_DEFINITION.get(reference, FIRST_PAGE)}#{reference}")
    if "const" in schema:
        return code_span(json.dumps(schema["const"]))
    if "enum" in schema:
        return ", ".join(code_span(value) for value in schema["enum"])
    if not schema.keys() - {"description"}:
        return "any value"
    json_types = schema.get("type", "string")
    if "items" in schema:
        list_noun = "lists" if plural else "list"
        list_text = f"{list_noun} of {_describe_type(schema['items'], plural=True)}"
        can_be_single = json_types != "array"
        return f"{_describe_type(schema['items'])}, or {list_text}" if can_be_single else list_text
    value_schema = schema.get("additionalProperties")
    if isinstance(value_schema, Mapping):
        map_noun = "mappings" if plural else "mapping"
        return f"{map_noun} of names to {_describe_type(value_schema, plural=True)}"
    names_of_types = [json_types] if isinstance(json_types, str) else json_types
    return join_words([_NOUNS_OF_JSON_TYPES[name_of_type][plural] for name_of_type in names_of_types], "or")


def _describe_limits(schema: JsonSchema) -> str:
    """Return the limits of a value in words, such as ``0 to 255, not empty``, or an empty string.

    The usual largest number of entries is not mentioned.
    """
    limit_texts = []
    if "minimum" in schema or "maximum" in schema:
        limit_texts.append(_range_in_words(schema.get("minimum"), schema.get("maximum")))
    if "pattern" in schema:
        limit_texts.append(f"pattern {code_span(schema['pattern'])}")
    if schema.get("maxLength"):
        limit_texts.append(f"at most {schema['maxLength']} characters")
    if schema.get("minItems", 0) > 0:
        limit_texts.append("not empty")
    max_entries = schema.get("maxItems", schema.get("maxProperties", _MOST_ENTRIES))
    if max_entries != _MOST_ENTRIES:
        noun = "entry" if max_entries == 1 else "entries"
        limit_texts.append(f"at most {max_entries} {noun}")
    return ", ".join(limit_texts)


def _range_in_words(low: int | None, high: int | None) -> str:
    """Return the bounds of a number in words. One of them may be None."""
    if high is None:
        return f"{low} or more"
    return f"at most {high}" if low is None else f"{low} to {high}"


if __name__ == "__main__":
    for page_name, content in spec_pages().items():
        Path(sys.argv[1], page_name).write_text(content, encoding="utf-8")
