"""Reader of the XML documents that describe devices, with which tests show that these contain everything."""

from __future__ import annotations

import re
from typing import Any

from codewheel.dump.schema import show_schema
from codewheel.dump.shape import Kind, Member, Shape, members, resolved, types_of
from codewheel.dump.xml import NAMESPACE
from lxml import etree

_INTEGER = re.compile(r"-?[0-9]+")
_HEXADECIMAL = re.compile(r"0x[0-9A-F]+")


def tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def read_xml(data: bytes) -> Any:
    """Return the root element of an XML document, read without entities, DTD or network."""
    return etree.fromstring(
        data, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False)
    )


def from_xml(data: bytes) -> dict[str, Any]:
    """Return the data of a device from its XML document."""
    return _read(read_xml(data), show_schema(), [])


def _read(element: Any, shape: Shape, inherited: list[dict[str, Any]]) -> dict[str, Any]:
    own = [_read_source(item) for item in element.findall(tag("source"))] or inherited
    made = {member.name: _read_member(element, member, own) for member in members(shape)}
    if "source" in shape["properties"]:
        made["source"] = own[0] if own else None
        if len(own) > 1:
            made["sources"] = own
    return made


def _read_source(element: Any) -> dict[str, Any]:
    page = element.get("page")
    return {
        "document": element.get("document", ""),
        "section": element.get("section", ""),
        "page": None if page is None else int(page),
    }


def _read_member(element: Any, member: Member, own: list[dict[str, Any]]) -> Any:
    if member.kind in (Kind.ATTRIBUTE, Kind.LIST):
        text = element.get(member.name)
        if text is None:
            return member.empty
        if member.kind is Kind.LIST:
            return [_value(word, member.types) for word in text.split()]
        return _value(text, member.types)
    inner = element.find(tag(member.name))
    if inner is None:
        return member.empty
    if member.kind is Kind.OBJECT:
        return _read(inner, member.shape, own)
    if member.kind is Kind.TEXT:
        return inner.text or ""
    if member.kind is Kind.TEXTS:
        return [item.text or "" for item in inner]
    if member.kind is Kind.MAP:
        return {item.get("name"): _read_entry(item, member) for item in inner}
    read = [_read(item, member.shape, own) for item in inner]
    return {item[member.shape["x-key"]]: item for item in read} if member.kind is Kind.KEYED else read


def _read_entry(element: Any, member: Member) -> Any:
    shape = resolved(member.shape)[0]
    if shape.get("type") == "array":
        return (element.text or "").split()
    stated = element.get("type")
    return _value(element.text or "", (stated,) if stated else types_of(resolved(member.shape)[0]))


def _value(text: str, types: tuple[str, ...]) -> Any:
    """Return a value from its text, converted to one of the JSON types that it may have."""
    if "boolean" in types and text in ("true", "false"):
        return text == "true"
    if "integer" in types and _INTEGER.fullmatch(text):
        return int(text)
    if "number" in types:
        return float(text)
    if "integer" in types and "string" not in types and _HEXADECIMAL.fullmatch(text):
        return int(text, 16)
    return text
