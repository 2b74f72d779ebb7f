"""Derive the XML Schema of the device description from the JSON Schema of the same data."""

from __future__ import annotations

from functools import cache
from typing import Any

from lxml import etree

from .schema import show_schema
from .shape import Kind, Member, Shape, is_hexadecimal, members
from .xml import NAMESPACE

_XS = "http://www.w3.org/2001/XMLSchema"
_ABOUT = """Full description of an absolute encoder, version 1, by the project codewheel. \
It is not a format of iC-Haus or of any manufacturer.
The root is device_description. Elements and attributes have the same names as in the output of codewheel show --json.
Numbers are decimal, except addresses, IDs, banks, polynomials and bytes, which are hexadecimal as in 0x11. \
Bit 0 is the least significant.
A position or limit that depends on the order code is a sum of numbers, parameters, powers of two and products of \
these, such as 48 - singleturn_bits. Each order_code gives the value of every parameter.
A missing value has the default of this schema, is not given in the manual, or does not apply. \
A source element cites the manual. An element without one has the sources of its parent."""
_EXPRESSION = r"-?(2\^)?[a-z0-9_]+( [+\-*] (2\^)?[a-z0-9_]+)*"


@cache
def schema_text() -> str:
    """Return the text of the schema, which is written next to the descriptions in every output folder."""
    namespaces: Any = {"xs": _XS, None: NAMESPACE}
    root = etree.Element(f"{{{_XS}}}schema", nsmap=namespaces)
    root.set("targetNamespace", NAMESPACE)
    root.set("elementFormDefault", "qualified")
    root.set("version", "1")
    _document(root, _ABOUT)
    _add(root, "element", name="device_description", type="device_description")
    _add_word_types(root)
    _add_type(root, "device_description", show_schema(), show_schema()["description"])
    for name, shape in show_schema()["$defs"].items():
        if "properties" in shape:
            _add_type(root, name, shape, shape["description"])
    text: str = etree.tostring(root, pretty_print=True, encoding="unicode")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + text


def _add(parent: Any, tag: str, **attributes: str) -> Any:
    return etree.SubElement(parent, f"{{{_XS}}}{tag}", attributes)


def _document(parent: Any, text: str) -> None:
    _add(_add(parent, "annotation"), "documentation").text = text


def _add_word_types(root: Any) -> None:
    expression = _add(root, "simpleType", name="expression")
    _document(expression, show_schema()["$defs"]["expression"]["description"])
    _add(_add(expression, "restriction", base="xs:string"), "pattern", value=_EXPRESSION)
    hexadecimal = _add(root, "simpleType", name="hexadecimal")
    _document(
        hexadecimal,
        "A whole number in hexadecimal, such as 0x11; a parameter that is written so has the attribute hexadecimal.",
    )
    _add(_add(hexadecimal, "restriction", base="xs:token"), "pattern", value="0x[0-9A-F]{2,}")
    _add(_add(root, "simpleType", name="number"), "union", memberTypes="xs:integer hexadecimal")
    for name, base in (("words", "xs:token"), ("numbers", "number")):
        _add(_add(root, "simpleType", name=name), "list", itemType=base)


def _add_type(root: Any, name: str, shape: Shape, description: str) -> None:
    complex_type = _add(root, "complexType", name=name)
    _document(complex_type, description)
    sequence = _add(complex_type, "sequence")
    if "source" in shape["properties"]:
        _add(sequence, "element", name="source", type="source", minOccurs="0", maxOccurs="unbounded")
    for member in members(shape):
        description = shape["properties"][member.name]["description"]
        if member.kind in (Kind.ATTRIBUTE, Kind.LIST):
            _add_attribute(complex_type, member, description)
        else:
            _add_element(sequence, member, description)
    if not len(sequence):
        complex_type.remove(sequence)


def _add_element(sequence: Any, member: Member, description: str) -> None:
    element = _add(sequence, "element", name=member.name, minOccurs="0")
    _document(element, description)
    if member.kind in (Kind.TEXT, Kind.OBJECT):
        element.set("type", "xs:string" if member.kind is Kind.TEXT else member.type_name)
        return
    items = _add(_add(element, "complexType"), "sequence")
    if member.kind is Kind.MAP:
        entry_element = _add(items, "element", name="entry", maxOccurs="unbounded")
        extended = _add(
            _add(_add(entry_element, "complexType"), "simpleContent"), "extension", base=_entry_type(member)
        )
        _add(extended, "attribute", name="name", type="xs:string", use="required")
        if len(member.types) > 1:
            kind = _add(extended, "attribute", name="type", use="required")
            _enumerate(kind, member.types)
    else:
        element_name = "text" if member.kind is Kind.TEXTS else member.type_name
        type_name = "xs:string" if member.kind is Kind.TEXTS else member.type_name
        _add(items, "element", name=element_name, type=type_name, maxOccurs="unbounded")


def _entry_type(member: Member) -> str:
    if len(member.types) > 1:
        return "xs:string"
    return {"integer": "number", "array": "words"}.get(member.types[0], "xs:string")


def _enumerate(parent: Any, values: Any) -> None:
    restriction = _add(_add(parent, "simpleType"), "restriction", base="xs:string")
    for value in values:
        _add(restriction, "enumeration", value=value)


def _add_attribute(complex_type: Any, member: Member, description: str) -> None:
    attribute = _add(complex_type, "attribute", name=member.name)
    values = [value for value in member.shape.get("enum", ()) if value]
    types = [name for name in member.types if name != "null"]
    is_always_present = "null" not in member.types and (
        types[0] in ("integer", "boolean") or len(values) == len(member.shape.get("enum", ())) > 0
    )
    if "default" in member.shape:
        attribute.set("default", str(member.shape["default"]).lower())
    elif member.kind is Kind.ATTRIBUTE and (is_always_present or member.name == "name"):
        attribute.set("use", "required")
    if member.kind is Kind.LIST:
        attribute.set("type", "numbers" if types == ["integer"] else "words")
    elif not values:
        single = "hexadecimal" if is_hexadecimal(member.shape) else f"xs:{types[0].replace('number', 'decimal')}"
        attribute.set("type", "expression" if len(types) > 1 else single)
    if "const" in member.shape:
        attribute.set("fixed", str(member.shape["const"]))
    _document(attribute, description)
    if values:
        _enumerate(attribute, values)
