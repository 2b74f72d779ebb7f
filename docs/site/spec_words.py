"""Walk through specs and the schema of their language: the words that each spec uses, and where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from codewheel.language.files import is_second, is_word_sheet

ROOT = Path(__file__).resolve().parents[2]
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Node(NamedTuple):
    """A node of a schema, and the values that specs have there.

    ``owner`` is its name in the schema, such as ``field``, or for a node without a name, that of the node above it with
    its key, such as ``layout.gray``. ``values`` is None if specs are not looked at.
    """

    owner: str
    schema: Mapping[str, Any]
    values: Sequence[Any] | None

    @property
    def maps(self) -> list[dict[str, Any]]:
        """The values that are mappings."""
        return [value for value in self.values or () if isinstance(value, dict)]

    @property
    def words(self) -> Iterator[str]:
        """The keys of the node, and the words of its enumeration: all of them, or those among the values."""
        used_keys = set(chain.from_iterable(self.maps))
        scalars = [value for value in self.values or () if not isinstance(value, dict | list)]
        for key in self.schema.get("properties", ()):
            if self.values is None or key in used_keys:
                yield f"{self.owner}.{key}"
        for word in self.schema.get("enum", ()):
            if self.values is None or word in scalars:
                yield f"{self.owner}.{word}"


def nodes_of(schema: Mapping[str, Any], specs: Sequence[Any] | None) -> Iterator[Node]:
    """Yield each node of the schema of a spec, or each node that specs have, with their values."""
    visited_names: set[str] = set()

    def below(node: Node) -> Iterator[Node]:
        if node.values is not None and not node.values:
            return
        owner, node_schema, values = node
        if "$ref" in node_schema:
            owner = node_schema["$ref"].rsplit("/", 1)[1]
            if values is None and owner in visited_names:
                return
            visited_names.add(owner)
            node_schema = schema["$defs"][owner]
        named_node = Node(owner, node_schema, values)
        is_one_or_list = "items" in node_schema and "properties" in node_schema
        if not is_one_or_list:
            yield named_node
        for child in _children(named_node):
            yield from below(child)

    yield from below(Node("device", schema, specs))


def _children(node: Node) -> Iterator[Node]:
    """Yield the alternatives, the members and the items of a node."""
    owner, schema, values = node
    for alternative in (*schema.get("oneOf", ()), *schema.get("anyOf", ())):
        yield Node(owner, alternative, values)
    lists = [value for value in values or () if isinstance(value, list)]
    items = list(chain.from_iterable(lists))
    if "items" in schema and "properties" in schema:  # One part or a list of them.
        yield Node(owner, schema["items"], None if values is None else [*node.maps, *items])
        return
    properties = schema.get("properties", {})
    for key, member in properties.items():
        member_values = [mapping[key] for mapping in node.maps if key in mapping]
        yield Node(f"{owner}.{key}", member, None if values is None else member_values)
    any_member = schema.get("additionalProperties")
    if isinstance(any_member, dict):
        unlisted = [value for mapping in node.maps for key, value in mapping.items() if key not in properties]
        yield Node(owner, any_member, None if values is None else unlisted)
    if "items" in schema:
        yield Node(owner, schema["items"], None if values is None else items)


def read_specs() -> dict[str, list[dict[str, Any]]]:
    """Return the specs of all real encoders, by manufacturer."""
    specs_by_manufacturer: dict[str, list[dict[str, Any]]] = {}
    for path in sorted((ROOT / "specs").glob("*/*.yaml")):
        if is_second(path) or is_word_sheet(path):
            continue
        spec = yaml.load(path.read_text(encoding="utf-8"), LOADER)
        if "device" in spec:
            specs_by_manufacturer.setdefault(path.parent.name, []).append(spec)
    return specs_by_manufacturer
