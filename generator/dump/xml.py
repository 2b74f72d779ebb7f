"""The plain data of a device as XML and back, and the XML Schema for it.

There is one definition of the shape, ``language/show.schema.json``; the XML has the same members and names. How
each is written follows from its place in that schema:

* an object is an element; a list of objects is an element that holds one element for each, named after its type;
* running text (``text`` in the schema) is an element, every other single value an attribute, a list of words or numbers
  an attribute with spaces;
* a map is an element of ``entry`` elements with a name each;
* a number with the form ``hexadecimal`` in the schema, and a parameter that is one, is written as ``0x11``, every other
  in decimal;
* what is null, empty, an empty list, or what the schema calls its default is left out;
* ``source`` elements cite the manual; what has none has those of the element around it.

``dump/xsd.py`` derives the XML Schema from the same definition.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from lxml import etree

from .shape import Kind, Member, Shape, is_hexadecimal, members, resolved, show_schema, types_of

NAMESPACE = "urn:codewheel:device-description:1"
XSD_NAME = "device-description.xsd"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_INTEGER = re.compile(r"-?[0-9]+")
_HEXADECIMAL = re.compile(r"0x[0-9A-F]+")
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def clean(text: str) -> str:
    """``text`` without characters that XML has no place for."""
    return _NOT_XML.sub("\ufffd", text)


def _scalar(value: object, hexadecimal: bool = False) -> str:
    if hexadecimal and isinstance(value, int):
        return f"0x{value:02X}"
    return str(value).lower() if isinstance(value, bool) else clean(str(value))


def to_xml(dump: Mapping[str, Any]) -> str:
    """The data of a device as an XML document."""
    namespaces: Any = {None: NAMESPACE, "xsi": _XSI}
    root = etree.Element(_tag("device_description"), nsmap=namespaces)
    root.set(f"{{{_XSI}}}schemaLocation", f"{NAMESPACE} {XSD_NAME}")
    codes = frozenset(item["name"] for item in dump["parameter_definitions"] if item["hexadecimal"])
    _write(root, dump, show_schema(), (), codes)
    text: str = etree.tostring(root, pretty_print=True, encoding="unicode")
    about = f"Made by codewheel from the spec. {XSD_NAME} beside this file says what each element is."
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {about} -->\n{text}'


def _sources(item: Mapping[str, Any]) -> tuple[tuple[tuple[str, Any], ...], ...]:
    listed = item.get("sources") or ([item["source"]] if item.get("source") else [])
    return tuple(tuple(source.items()) for source in listed)


def _write(
    element: Any, item: Mapping[str, Any], shape: Shape, inherited: tuple[Any, ...], codes: frozenset[str]
) -> None:
    """The members of an object; ``codes`` are the parameters that are written in hexadecimal."""
    own = inherited
    if "source" in shape["properties"]:
        own = _sources(item)
        for source in own if own != inherited else ():
            etree.SubElement(
                element, _tag("source"), {key: _scalar(value) for key, value in source if value not in ("", None)}
            )
    for member in members(shape):
        value = item[member.name]
        if (
            value is None
            or value == ""
            or (isinstance(value, (list, dict)) and not value)
            or _is_default(member, value)
        ):
            continue
        if member.kind is Kind.ATTRIBUTE:
            element.set(member.name, _scalar(value, is_hexadecimal(member.shape)))
        elif member.kind is Kind.LIST:
            element.set(member.name, " ".join(_scalar(one, is_hexadecimal(member.shape)) for one in value))
        elif member.kind is Kind.OBJECT:
            _write(etree.SubElement(element, _tag(member.name)), value, member.shape, own, codes)
        else:
            _write_inside(etree.SubElement(element, _tag(member.name)), value, member, own, codes)


def _write_inside(element: Any, value: Any, member: Member, own: tuple[Any, ...], codes: frozenset[str]) -> None:
    if member.kind is Kind.TEXT:
        element.text = clean(value)
    elif member.kind is Kind.TEXTS:
        for text in value:
            etree.SubElement(element, _tag("text")).text = clean(text)
    elif member.kind is Kind.MAP:
        for key, inner in value.items():
            entry = etree.SubElement(element, _tag("entry"), {"name": _scalar(key)})
            entry.text = (
                " ".join(map(_scalar, inner))
                if isinstance(inner, list)
                else _scalar(inner, key in codes and _types(member) == ("integer",))
            )
            if len(_types(member)) > 1:
                entry.set("type", {bool: "boolean", int: "integer", str: "string"}[type(inner)])
    else:
        for inner in value.values() if member.kind is Kind.KEYED else value:
            _write(etree.SubElement(element, _tag(member.type_name)), inner, member.shape, own, codes)


def _is_default(member: Member, value: object) -> bool:
    return "default" in member.shape and value == member.shape["default"]


def _types(member: Member) -> tuple[str, ...]:
    return types_of(resolved(member.shape)[0])


def read_xml(data: bytes) -> Any:
    """The root element of an XML document, read without entities, DTD or network."""
    return etree.fromstring(
        data, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False)
    )


def from_xml(data: bytes) -> dict[str, Any]:
    """The data of a device from its XML document."""
    return _read(read_xml(data), show_schema(), [])


def _read(element: Any, shape: Shape, inherited: list[dict[str, Any]]) -> dict[str, Any]:
    own = [_read_source(item) for item in element.findall(_tag("source"))] or inherited
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
    inner = element.find(_tag(member.name))
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
    return _value(element.text or "", (stated,) if stated else _types(member))


def _value(text: str, types: tuple[str, ...]) -> Any:
    """A written value by the JSON types that it may have."""
    if "boolean" in types and text in ("true", "false"):
        return text == "true"
    if "integer" in types and _INTEGER.fullmatch(text):
        return int(text)
    if "integer" in types and "string" not in types and _HEXADECIMAL.fullmatch(text):
        return int(text, 16)
    return text
