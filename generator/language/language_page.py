"""The reference page of the spec language, made from its JSON Schemas.

``python -m codewheel.language.language_page`` prints it; with a path it writes the page there,
which is what ``make spec-page`` does.
"""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..say.markdown import anchor, code, link, paragraph, table, text
from .schema import load_schema
from .second_reading import NO_FACTS, PROSE

Shape = Mapping[str, Any]

_INTRODUCTION = """\
A spec is one YAML file for one manual, read beside it. It says what the manual says, in the manual's order and with the
manual's names; what can be worked out, such as masks and totals, is left to the tool. Scalars are those of YAML 1.2:
`7:0` is text, `no` is text, `0x1F` is a number. A key may stand once in its map.

A bit range has the high bit first (`7:6`), and bit 0 is the least significant. Fields without a position stand in the
order in which they are sent: the first is the most significant, or, with `byte_order: low_byte_first`, the least. Units
are part of a key (`min_hz`, `at_least_us`); a number with another unit does not fit under it.

The first line of a file lets an editor complete and explain keys while you type:

```yaml
# yaml-language-server: $schema=../../generator/language/device.schema.json
```

`codewheel check FILE` says everything that is wrong, with file, line and column."""


_SECOND = """\
`FAMILY.second.yaml` beside a device file is what another reader read in the same manual. It is written in the same
language and read by `codewheel check` alone, which tells what the two have differently. It holds facts: of the keys
above it has all but `manufacturer`, those for people, and parts that tell, work out or explain.

For people: {prose}.

Parts: {lists}."""


def spec_page() -> str:
    """The page as ``docs/spec-language.md`` holds it."""
    device, maker, overlay = load_schema("device"), load_schema("manufacturer"), load_schema("overlay")
    lines = [
        "<!-- Made from generator/language/*.schema.json by: make spec-page -->",
        "",
        "# The spec language, version 1",
        "",
        _INTRODUCTION,
        "",
    ]
    lines += [
        "## The device file",
        "",
        paragraph(text(device["description"])),
        "",
        _properties(device, device["$defs"]),
        "",
    ]
    for name in _in_order(device):
        lines += _definition(name, device["$defs"][name], device["$defs"])
    lines += _other_files(maker, overlay)
    return "\n".join(lines).rstrip() + "\n"


def _other_files(maker: Mapping[str, Any], overlay: Mapping[str, Any]) -> list[str]:
    """The files beside a device file."""
    return [
        "## The manufacturer file",
        "",
        paragraph(text(maker["description"])),
        "",
        "It lies beside the device files as `manufacturer.yaml`.",
        "",
        _properties(maker, {}),
        "",
        "## The overlay",
        "",
        paragraph(text(overlay["description"])),
        "",
        "[A page of its own](overlays.md) shows one at work.",
        "",
        _properties(overlay, overlay["$defs"]),
        "",
        "## The second reading",
        "",
        _SECOND.format(prose=_coded(PROSE), lists=_coded(NO_FACTS)),
        "",
    ]


def _coded(words: Iterable[str]) -> str:
    lines = textwrap.wrap(", ".join(f"`{word}`" for word in sorted(words)), 110)
    return "\n".join(lines)


def _in_order(schema: Shape) -> list[str]:
    """The definitions in the order in which a reader of the page meets them; each once."""
    found: list[str] = []

    def visit(shape: Any) -> None:
        if isinstance(shape, Mapping):
            name = _referred(shape)
            if name and name not in found:
                found.append(name)
                visit(schema["$defs"][name])
            for key, inner in shape.items():
                if key != "$defs":
                    visit(inner)
        elif isinstance(shape, list):
            for inner in shape:
                visit(inner)

    visit(schema)
    return found


def _definition(name: str, shape: Shape, definitions: Shape) -> list[str]:
    lines = [anchor(name), "", f"### {code(name)}", "", paragraph(text(shape.get("description", "")))]
    limits = _limits(shape)
    kind = _kind(shape)
    if "properties" not in shape:
        lines += ["", f"{kind[0].upper() + kind[1:]}{': ' + limits if limits else ''}."]
    return [*lines, "", _properties(shape, definitions), ""] if "properties" in shape else [*lines, ""]


def _properties(shape: Shape, definitions: Shape) -> str:
    return table(["Key", "", "Value", "Meaning"], _members(shape, definitions))


def _referred(shape: Shape) -> str:
    """The name of the definition that a shape refers to, or empty."""
    return str(shape.get("$ref", "")).removeprefix("#/$defs/")


def _members(shape: Shape, definitions: Shape, prefix: str = "") -> Iterator[tuple[str, str, str, str]]:
    """A row for each key, and below it one for each key of what it holds where that has no section of its own."""
    required = shape.get("required", ())
    for name, inner in shape.get("properties", {}).items():
        limits = _limits(inner)
        value = _kind(inner) + (f"; {limits}" if limits else "")
        meaning = inner.get("description") or definitions.get(_referred(inner), {}).get("description", "")
        yield code(prefix + name), "required" if name in required else "", value, text(meaning)
        items = inner.get("items", {})
        yield from _members(inner, definitions, f"{prefix}{name}.")
        yield from _members(items, definitions, f"{prefix}{name}[].")
    other = shape.get("additionalProperties")
    if isinstance(other, Mapping) and "properties" in other:
        yield from _members(other, definitions, f"{prefix}<name>.")


def _kind(shape: Shape) -> str:
    """What a value is, in words, with a link where it has a section of its own."""
    reference = _referred(shape)
    if reference:
        return link(code(reference), f"#{reference}")
    if "const" in shape:
        return code(json.dumps(shape["const"]))
    if "enum" in shape:
        return ", ".join(code(value) for value in shape["enum"])
    words = {
        "integer": "whole number",
        "string": "text",
        "boolean": "`true` or `false`",
        "array": "list",
        "object": "map",
        "number": "number",
        "null": "nothing",
    }
    if not shape.keys() - {"description"}:
        return "any value"
    types = shape.get("type", "string")
    named = " or ".join(words[item] for item in ([types] if isinstance(types, str) else types))
    if "items" in shape:
        one = "" if types == "array" else "one, or a "
        return f"{one}list of {_plural(shape['items'])}"
    other = shape.get("additionalProperties")
    if isinstance(other, Mapping):
        return f"map from names to {_plural(other)}"
    return named


def _plural(shape: Shape) -> str:
    if "properties" in shape:
        return "maps"
    kind = _kind(shape)
    return {"whole number": "whole numbers", "text": "texts", "list": "lists"}.get(kind, kind)


def _limits(shape: Shape) -> str:
    parts = []
    if "minimum" in shape or "maximum" in shape:
        low, high = shape.get("minimum"), shape.get("maximum")
        if high is None:
            parts.append(f"{low} or more")
        else:
            parts.append(f"at most {high}" if low is None else f"{low} to {high}")
    if "pattern" in shape:
        parts.append(f"matches {code(shape['pattern'])}")
    if shape.get("maxLength"):
        parts.append(f"at most {shape['maxLength']} characters")
    if shape.get("minItems", 0) > 0:
        parts.append("not empty")
    return ", ".join(parts)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(spec_page(), encoding="utf-8")
    else:
        sys.stdout.write(spec_page())
