"""Iterators over a spec, shared by several rules.

Rules check the pruned data, which follows the schema. Existing names are looked up in the data as read, because a name
is still defined if something else about its item is wrong. That data may have any shape, so every function here checks
shapes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import islice
from typing import Any

from ...model import INTERFACES, Biss
from ..document import Document
from ..problems import DocumentReport, Path
from ..schema_files import is_second

#: A spec, or part of one.
Spec = dict[str, Any]
#: A rule, called with the pruned data, the data as read, and the report.
Rule = Callable[[Spec, Spec, DocumentReport], None]

INTERFACE_OF_REGISTERS = Biss.name
#: Largest number of fields of a layout or register, with those of its groups. Without these, the schema limits it.
MAX_FIELDS = 512


def mapping(data: Any, *keys: str) -> Spec:
    """Return the map found by following ``keys``, or an empty one."""
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return data if isinstance(data, dict) else {}


def items(data: Any, *keys: str) -> Iterator[tuple[Path, Spec]]:
    """Yield the maps in the list found by following ``keys``, each with its path."""
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


def owner_of_alarm(spec: Spec, alarm: Spec) -> Spec:
    """Return the field group or register that contains the flag of an alarm, or an empty map if it does not exist."""
    if "group" in alarm:
        return by_name(spec, "field_groups").get(alarm["group"], {})
    return by_name(spec, "registers").get(alarm.get("register", ""), {})


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
    """Yield every list of fields, in the order of the language."""
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
    return str(register.get("interface", INTERFACE_OF_REGISTERS))


def last_address(register: Mapping[str, Any]) -> int:
    """Return the last address of a register. Not every interface has an address for each byte."""
    first: int = register["address"]
    interface = INTERFACES.get(interface_of(register))
    if interface is not None and not interface.byte_addresses:
        return first
    last: int = first + register["length"] - 1
    return last


def expanded(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, Spec]]:
    """Yield the fields with groups included. The path of a field from a group is the path of its ``use``.

    Another rule reports a list that is longer than its limit. Its other fields are omitted.
    """
    return islice(_expanded(fields, groups), MAX_FIELDS)


def _expanded(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, Spec]]:
    for path, field in fields:
        group = groups.get(field["use"]) if isinstance(field.get("use"), str) else None
        if group is None:
            yield path, field
        else:
            yield from ((path, inner) for _, inner in items(group, "fields"))


def field_names(fields: Fields, groups: Mapping[str, Spec]) -> dict[str, Spec]:
    """Return the fields by name, with groups included."""
    return {field["name"]: field for _, field in expanded(fields, groups) if isinstance(field.get("name"), str)}


def readable_names(fields: Fields, groups: Mapping[str, Spec]) -> list[str]:
    """Return the names of all values of a decoder: fields, joins and runs of digits.

    A register without fields is one number.
    """
    if fields.kind is Has.REGISTER and "fields" not in fields.owner:
        return [str(fields.owner.get("name"))]
    fields_by_name = field_names(fields, groups)
    names = [*fields_by_name, *mapping(fields.owner, "join")]
    for field in fields_by_name.values():
        names += [run["name"] for _, run in items(field, "digits") if isinstance(run.get("name"), str)]
    return names


def named_values(register: Spec, groups: Mapping[str, Spec], field_name: str | None = None) -> list[str]:
    """Return the names of values of all fields of a register, or of the field of this name."""
    names: list[str] = []
    for _, field in expanded(Fields(Has.REGISTER, register, (), ""), groups):
        if field_name is None or field.get("name") == field_name:
            names += mapping(field, "values")
    return names


def measurements(spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the measurements of the device and its interfaces, each with its path."""
    if mapping(spec, "measurement"):
        yield ("measurement",), mapping(spec, "measurement")
    for kind, interface in mapping(spec, "interfaces").items():
        if mapping(interface, "measurement"):
            yield ("interfaces", kind, "measurement"), mapping(interface, "measurement")


def position_ranges(spec: Spec) -> Iterator[tuple[Path, str, Spec]]:
    """Yield the ranges that layouts have for themselves, each with its path and the interface."""
    for fields in layouts(spec):
        if mapping(fields.owner, "position_range"):
            yield (*fields.path, "position_range"), fields.interface, mapping(fields.owner, "position_range")


def bank_select(data: Spec) -> Any:
    """Return the name of the register that selects banks, or None."""
    return mapping(data, "interfaces", Biss.name).get("bank_select")


def bits_of(register: Spec, groups: Mapping[str, Spec]) -> list[str]:
    """Return the names allowed after the dot in ``register.field``: the fields, or the register's own name."""
    if "fields" in register:
        return list(field_names(Fields(Has.REGISTER, register, (), ""), groups))
    return [str(register.get("name"))]


def has_other_bits(register: Spec, groups: Mapping[str, Spec]) -> bool:
    """Return True if a register has more bits than those of one field."""
    return len(bits_of(register, groups)) > 1 or "other_bits" in register


def explained(document: Document, *keys: str) -> bool:
    """Return True if an erratum affects exactly this place, given by keys and names.

    A second reading has no errata. It repeats the printed values, and its spec must agree or explain the difference.
    """
    if is_second(document.file):
        return True
    place = ".".join(keys)
    for _, erratum in items(document.data, "errata"):
        affects = erratum.get("affects")
        if isinstance(affects, list) and place in affects:
            return True
    return False


def leaves_of(spec: Spec, report: DocumentReport) -> Sequence[tuple[Path, Any]]:
    """Return the leaves of a whole spec. The report keeps them, because one rule after another needs them."""
    if report.leaves[0] is not spec:
        report.leaves = (spec, leaves(spec))
    return report.leaves[1]


def leaves(data: Any) -> list[tuple[Path, Any]]:
    """Return every text, number and boolean with its path."""
    located_values: list[tuple[Path, Any]] = []
    _add_leaves(data, (), located_values)
    return located_values


def _add_leaves(node: Any, path: Path, located_values: list[tuple[Path, Any]]) -> None:
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
