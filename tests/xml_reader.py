"""Reader of the XML documents that describe devices, with which tests show that these contain everything."""

from __future__ import annotations

import re
from typing import Any

from codewheel.dump.schema import DataMember, Kind, Shape, json_types_of, resolve_reference, schema_members, show_schema
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


def _read(node: Any, shape: Shape, inherited: list[dict[str, Any]]) -> dict[str, Any]:
    sources = [_read_source(source) for source in node.findall(tag("source"))] or inherited
    values = {member.name: _read_member(node, member, sources) for member in schema_members(shape)}
    if "source" in shape["properties"]:
        values["source"] = sources[0] if sources else None
        if len(sources) > 1:
            values["sources"] = sources
    return values


def _read_source(node: Any) -> dict[str, Any]:
    page = node.get("page")
    return {
        "document": node.get("document", ""),
        "section": node.get("section", ""),
        "page": None if page is None else int(page),
    }


def _read_member(node: Any, member: DataMember, sources: list[dict[str, Any]]) -> Any:
    if member.kind in (Kind.ATTRIBUTE, Kind.LIST):
        text = node.get(member.name)
        if text is None:
            return member.empty
        if member.kind is Kind.LIST:
            return [_value(word, member.types) for word in text.split()]
        return _value(text, member.types)
    inner = node.find(tag(member.name))
    if inner is None:
        return member.empty
    if member.kind is Kind.OBJECT:
        return _read(inner, member.shape, sources)
    if member.kind is Kind.TEXT:
        return inner.text or ""
    if member.kind is Kind.TEXTS:
        return [child.text or "" for child in inner]
    if member.kind is Kind.MAP:
        return {child.get("name"): _read_entry(child, member) for child in inner}
    read = [_read(child, member.shape, sources) for child in inner]
    return (
        {member_value[member.shape["x-key"]]: member_value for member_value in read}
        if member.kind is Kind.KEYED
        else read
    )


def _read_entry(node: Any, member: DataMember) -> Any:
    shape = resolve_reference(member.shape)[0]
    if shape.get("type") == "array":
        return (node.text or "").split()
    stated = node.get("type")
    return _value(node.text or "", (stated,) if stated else json_types_of(resolve_reference(member.shape)[0]))


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
