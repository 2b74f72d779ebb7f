"""Iterators over the plain data of a spec, for rules about any text or number, and for loading.

The data may have any shape, so every function here checks shapes. ``parts.py`` has the iterators over typed parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import islice
from typing import Any

from ...model import Biss
from ..problems import DocumentReport, Path

#: A spec, or part of one.
Spec = dict[str, Any]
#: Largest number of fields of a layout or register, with those of its groups. Without these, the schema limits it.
MAX_FIELDS = 512


def mapping(data: Any, *keys: str) -> Spec:
    """Return the map found by following ``keys``, or an empty one."""
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return data if isinstance(data, dict) else {}


def items(data: Any, *keys: str) -> Iterator[tuple[Path, Spec]]:
    """Yield the maps in the list found by following ``keys``, each with its path.

    For ``("manual", "editions")`` these have paths such as ``("manual", "editions", 0)``.
    """
    list_value = mapping(data, *keys[:-1]).get(keys[-1])
    for index, list_item in enumerate(list_value if isinstance(list_value, list) else ()):
        if isinstance(list_item, dict):
            yield (*keys, index), list_item


def by_name(data: Any, *keys: str) -> dict[str, Spec]:
    """Return the items of a list by name. If several have the same name, the first one is used."""
    named_items: dict[str, Spec] = {}
    for _, list_item in items(data, *keys):
        name = list_item.get("name")
        if isinstance(name, str):
            named_items.setdefault(name, list_item)
    return named_items


class Has(Enum):
    """Owners of a list of fields, by their key."""

    LAYOUT = "layouts"
    REGISTER = "registers"
    GROUP = "field_groups"
    CONTROL = "control_data"


@dataclass(frozen=True, slots=True)
class Fields:
    """A list of fields with its owner, its place and its interface, which is empty for groups."""

    kind: Has
    owner: Spec
    path: Path
    interface: str

    def __iter__(self) -> Iterator[tuple[Path, Spec]]:
        """Yield the fields as listed, with ``use`` as a separate item."""
        for path, field in items(self.owner, "fields"):
            yield (*self.path, *path), field


def layouts(data: Spec) -> Iterator[Fields]:
    """Yield the layouts of all interfaces."""
    for interface in mapping(data, "interfaces"):
        for path, layout in items(data, "interfaces", interface, "layouts"):
            yield Fields(Has.LAYOUT, layout, path, interface)


def field_lists(data: Spec) -> Iterator[Fields]:
    """Yield every list of fields: of groups, layouts, control data and registers, in the order of the language."""
    for path, group in items(data, "field_groups"):
        yield Fields(Has.GROUP, group, path, "")
    yield from layouts(data)
    for interface, content in mapping(data, "interfaces").items():
        control = mapping(content, "control_data")
        if control:
            yield Fields(Has.CONTROL, control, ("interfaces", interface, "control_data"), interface)
    for path, register in items(data, "registers"):
        if "fields" in register:
            yield Fields(Has.REGISTER, register, path, interface_of(register))


def interface_of(register: Mapping[str, Any]) -> str:
    """Return the interface of a register. The default is BiSS, the only one that always has registers."""
    return str(register.get("interface", Biss.name))


def expanded(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, Spec]]:
    """Yield the fields with groups included. The path of a field from a group is the path of its ``use``.

    Another rule reports a list that is longer than its limit. Its other fields are omitted.
    """
    return islice(_expanded(fields, groups), MAX_FIELDS)


def _expanded(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, Spec]]:
    """Yield the fields with groups included, without a limit."""
    for path, field in fields:
        group = groups.get(field["use"]) if isinstance(field.get("use"), str) else None
        if group is None:
            yield path, field
        else:
            yield from ((path, inner) for _, inner in items(group, "fields"))


def leaves_of(spec: Spec, report: DocumentReport) -> Sequence[tuple[Path, Any]]:
    """Return the leaves of a whole spec, each with its path.

    The report keeps those of the last spec, because one rule after another needs them.
    """
    if report.leaves[0] is not spec:
        report.leaves = (spec, leaves(spec))
    return report.leaves[1]


def leaves(data: Any) -> list[tuple[Path, Any]]:
    """Return every text, number and boolean with its path."""
    located_values: list[tuple[Path, Any]] = []
    _add_leaves(data, (), located_values)
    return located_values


def _add_leaves(node: Any, path: Path, located_values: list[tuple[Path, Any]]) -> None:
    """Add every text, number and boolean below a place, with its path."""
    if isinstance(node, dict):
        for key, child in node.items():
            _add_leaves(child, (*path, key), located_values)
    elif isinstance(node, list):
        for index, child in enumerate(node):
            _add_leaves(child, (*path, index), located_values)
    else:
        located_values.append((path, node))


def sources(located_values: Iterable[tuple[Path, Any]]) -> Iterator[tuple[Path, str]]:
    """Yield every source among leaves, with its path."""
    for path, value in located_values:
        if isinstance(value, str) and (path[-1] == "source" or str(path[-1]).endswith("_source")):
            yield path, value
