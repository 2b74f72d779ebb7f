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


def filled(item: Mapping[str, Any], type_name: str) -> dict[str, Any]:
    """Return an object with every member of its type, in schema order. Missing members are empty."""
    shape = show_schema()["$defs"][type_name]
    made = {member.name: item.get(member.name, member.empty) for member in members(shape)}
    return made | {name: item[name] for name in ("source", "sources") if name in item}


def members(shape: Shape) -> Iterator[Member]:
    """Yield the members of an object in schema order, without its sources."""
    for name, inner in shape["properties"].items():
        if name not in ("source", "sources"):
            yield _member(name, inner)


def resolved(shape: Shape) -> tuple[Shape, str]:
    """Return the shape to which a reference leads, and the name of the reference.

    The null alternative of an optional object is dropped.
    """
    reference = shape.get("$ref") or next((item["$ref"] for item in shape.get("anyOf", ()) if "$ref" in item), "")
    name = reference.rpartition("/")[2]
    return (show_schema()["$defs"][name], name) if name else (shape, "")


def _member(name: str, shape: Shape) -> Member:
    found, type_name = resolved(shape)
    if type_name == "text":
        return Member(name, Kind.TEXT, found)
    if found.get("type") == "array":
        items, item_type = resolved(found["items"])
        kind = Kind.TEXTS if item_type == "text" else Kind.OBJECTS if "properties" in items else Kind.LIST
        return Member(name, kind, items, item_type)
    if "properties" in found:
        return Member(name, Kind.OBJECT, found, type_name)
    if "additionalProperties" in found:
        if "x-key" in found:
            items, item_type = resolved(found["additionalProperties"])
            return Member(name, Kind.KEYED, {**items, "x-key": found["x-key"]}, item_type)
        return Member(name, Kind.MAP, found["additionalProperties"])
    return Member(name, Kind.ATTRIBUTE, found, type_name)


def types_of(shape: Shape) -> tuple[str, ...]:
    """Return the JSON types of a value of this shape."""
    found = shape.get("type", "integer" if isinstance(shape.get("const"), int) else "string")
    return tuple(found) if isinstance(found, list) else (found,)


def is_hexadecimal(shape: Shape) -> bool:
    """Return whether a number of this shape is written in hexadecimal."""
    return shape.get("x-form") == "hexadecimal"
