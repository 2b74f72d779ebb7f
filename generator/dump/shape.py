"""Shape of the plain data, as described by the table of members: members of objects and their form in XML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import Enum, auto
from typing import Any

from ..model.record import dataclass
from .schema import show_schema

Shape = Mapping[str, Any]


class Kind(Enum):
    """Form of a member in XML. LIST is also an attribute. KEYED is a map of objects, keyed by one of their members."""

    ATTRIBUTE = auto()
    LIST = auto()
    TEXT = auto()
    TEXTS = auto()
    OBJECT = auto()
    OBJECTS = auto()
    KEYED = auto()
    MAP = auto()


@dataclass(frozen=True)
class Member:
    """Member of an object: its form in XML, and the shape of its value."""

    name: str
    kind: Kind
    shape: Shape
    type_name: str = ""

    @property
    def types(self) -> tuple[str, ...]:
        """JSON types of the value."""
        return types_of(self.shape)

    @property
    def empty(self) -> Any:
        """Value that stands for a missing member."""
        if self.kind in (Kind.LIST, Kind.TEXTS, Kind.OBJECTS):
            return []
        if self.kind in (Kind.KEYED, Kind.MAP):
            return {}
        if self.kind is Kind.OBJECT or "null" in self.types:
            return None
        return self.shape.get("default", "")


def filled(dumped: Mapping[str, Any], type_name: str) -> dict[str, Any]:
    """Return an object with every member of its type, in schema order. Missing members are empty."""
    shape = show_schema()["$defs"][type_name]
    filled_members = {member.name: dumped.get(member.name, member.empty) for member in members(shape)}
    return filled_members | {name: dumped[name] for name in ("source", "sources") if name in dumped}


def members(shape: Shape) -> Iterator[Member]:
    """Yield the members of an object in schema order, without its sources."""
    for name, inner in shape["properties"].items():
        if name not in ("source", "sources"):
            yield _member(name, inner)


def resolved(shape: Shape) -> tuple[Shape, str]:
    """Return the shape to which a reference leads, and the name of the reference.

    The null alternative of an optional object is dropped.
    """
    reference = shape.get("$ref") or next(
        (alternative["$ref"] for alternative in shape.get("anyOf", ()) if "$ref" in alternative), ""
    )
    name = reference.rpartition("/")[2]
    return (show_schema()["$defs"][name], name) if name else (shape, "")


def _member(name: str, unresolved: Shape) -> Member:
    shape, type_name = resolved(unresolved)
    if type_name == "text":
        return Member(name, Kind.TEXT, shape)
    if shape.get("type") == "array":
        items, item_type = resolved(shape["items"])
        return Member(name, _kind_of_list(items, item_type), items, item_type)
    if "properties" in shape:
        return Member(name, Kind.OBJECT, shape, type_name)
    if "additionalProperties" in shape:
        if "x-key" in shape:
            items, item_type = resolved(shape["additionalProperties"])
            return Member(name, Kind.KEYED, {**items, "x-key": shape["x-key"]}, item_type)
        return Member(name, Kind.MAP, shape["additionalProperties"])
    return Member(name, Kind.ATTRIBUTE, shape, type_name)


def _kind_of_list(items: Shape, item_type: str) -> Kind:
    if item_type == "text":
        return Kind.TEXTS
    return Kind.OBJECTS if "properties" in items else Kind.LIST


def types_of(shape: Shape) -> tuple[str, ...]:
    """Return the JSON types of a value of this shape."""
    json_types = shape.get("type", "integer" if isinstance(shape.get("const"), int) else "string")
    return tuple(json_types) if isinstance(json_types, list) else (json_types,)


def is_hexadecimal(shape: Shape) -> bool:
    """Return whether a number of this shape is written in hexadecimal."""
    return shape.get("x-form") == "hexadecimal"
