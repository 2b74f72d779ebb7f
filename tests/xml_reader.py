"""Reader of the XML documents that describe devices, with which tests show that these contain everything."""

from __future__ import annotations

import re
from typing import Any

from codewheel.dump.schema import (
    DataMember,
    MemberForm,
    Schema,
    json_types_of,
    resolve_reference,
    schema_members,
    schema_of_device_data,
)
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
    return _read(read_xml(data), schema_of_device_data(), [])


def _read(node: Any, schema: Schema, inherited: list[dict[str, Any]]) -> dict[str, Any]:
    sources = [_read_source(source) for source in node.findall(tag("source"))] or inherited
    values = {member.name: _read_member(node, member, sources) for member in schema_members(schema)}
    if "source" in schema["properties"]:
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
    if member.form in (MemberForm.ATTRIBUTE, MemberForm.LIST):
        text = node.get(member.name)
        if text is None:
            return member.empty
        if member.form is MemberForm.LIST:
            return [_value(word, member.types) for word in text.split()]
        return _value(text, member.types)
    inner = node.find(tag(member.name))
    if inner is None:
        return member.empty
    if member.form is MemberForm.OBJECT:
        return _read(inner, member.schema, sources)
    if member.form is MemberForm.TEXT:
        return inner.text or ""
    if member.form is MemberForm.TEXTS:
        return [child.text or "" for child in inner]
    if member.form is MemberForm.MAP:
        return {child.get("name"): _read_entry(child, member) for child in inner}
    read = [_read(child, member.schema, sources) for child in inner]
    return (
        {member_value[member.schema["x-key"]]: member_value for member_value in read}
        if member.form is MemberForm.KEYED
        else read
    )


def _read_entry(node: Any, member: DataMember) -> Any:
    schema = resolve_reference(member.schema)[0]
    if schema.get("type") == "array":
        return (node.text or "").split()
    stated = node.get("type")
    return _value(node.text or "", (stated,) if stated else json_types_of(resolve_reference(member.schema)[0]))


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
