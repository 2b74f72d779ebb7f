"""The plain data of a device as XML and back, and the XML Schema for it.

There is one definition of the shape, ``spec/show.schema.json``; the XML has the same members under the same names. How each is written follows
from its place in that schema:

* an object is an element; a list of objects is an element that holds one element for each, named after its type;
* running text (``text`` in the schema) is an element, every other single value an attribute, a list of words or numbers an attribute with spaces;
* a map is an element of ``entry`` elements with a name each;
* a number with the form ``hexadecimal`` in the schema, and a parameter that is one, is written as ``0x11``, every other in decimal;
* what is null, empty, an empty list, or what the schema calls its default is left out;
* ``source`` elements cite the manual; what has none has those of the element around it.

``spec/device-description.xsd`` is made from the same schema by ``python -m codewheel.xsd``, and a test holds the two together.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

from lxml import etree

NAMESPACE = "urn:codewheel:device-description:1"
XSD_NAME = "device-description.xsd"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_INTEGER = re.compile(r"-?[0-9]+")
_HEXADECIMAL = re.compile(r"0x[0-9A-F]+")
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

Shape = Mapping[str, Any]


@lru_cache(maxsize=None)
def show_schema() -> Shape:
    """The JSON Schema of what ``show --json`` prints."""
    found: Shape = json.loads((resources.files("codewheel.spec") / "show.schema.json").read_text(encoding="utf-8"))
    return found


@dataclass(frozen=True)
class Member:
    """A member of an object: how it is written, and the shape of what it holds.

    ``kind`` is ``attribute``, ``list`` (an attribute), ``text``, ``texts``, ``object``, ``objects``, ``keyed`` (objects by one of their members) or ``map``.
    """

    name: str
    kind: str
    shape: Shape
    type_name: str = ""

    @property
    def types(self) -> tuple[str, ...]:
        """JSON types of the value."""
        found = self.shape.get("type", "integer" if isinstance(self.shape.get("const"), int) else "string")
        return tuple(found) if isinstance(found, list) else (found,)


def members(shape: Shape) -> Iterator[Member]:
    """The members of an object but for its sources, in the order of the schema."""
    for name, inner in shape["properties"].items():
        if name not in ("source", "sources"):
            yield _member(name, inner)


def _resolve(shape: Shape) -> tuple[Shape, str]:
    """The shape with a reference followed, and the name of what it refers to; the null of an optional object is dropped."""
    reference = shape.get("$ref") or next((item["$ref"] for item in shape.get("anyOf", ()) if "$ref" in item), "")
    name = reference.rpartition("/")[2]
    return (show_schema()["$defs"][name], name) if name else (shape, "")


def _member(name: str, shape: Shape) -> Member:
    found, type_name = _resolve(shape)
    if type_name == "text":
        return Member(name, "text", found)
    if found.get("type") == "array":
        items, item_type = _resolve(found["items"])
        kind = "texts" if item_type == "text" else "objects" if "properties" in items else "list"
        return Member(name, kind, items, item_type)
    if "properties" in found:
        return Member(name, "object", found, type_name)
    if "additionalProperties" in found:
        if "x-key" in found:
            items, item_type = _resolve(found["additionalProperties"])
            return Member(name, "keyed", {**items, "x-key": found["x-key"]}, item_type)
        return Member(name, "map", found["additionalProperties"])
    return Member(name, "attribute", found, type_name)


def _tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def clean(text: str) -> str:
    """``text`` without characters that XML has no place for."""
    return _NOT_XML.sub("\ufffd", text)


def is_hexadecimal(shape: Shape) -> bool:
    """Whether a number of this shape is written in hexadecimal."""
    return shape.get("x-form") == "hexadecimal"


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
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- Made by codewheel from the spec. {XSD_NAME} beside this file says what each element is. -->\n{text}'


def _sources(item: Mapping[str, Any]) -> tuple[tuple[tuple[str, Any], ...], ...]:
    listed = item.get("sources") or ([item["source"]] if item.get("source") else [])
    return tuple(tuple(source.items()) for source in listed)


def _write(element: Any, item: Mapping[str, Any], shape: Shape, inherited: tuple[Any, ...], codes: frozenset[str]) -> None:
    """The members of an object; ``codes`` are the parameters that are written in hexadecimal."""
    own = inherited
    if "source" in shape["properties"]:
        own = _sources(item)
        for source in own if own != inherited else ():
            etree.SubElement(element, _tag("source"), {key: _scalar(value) for key, value in source if value not in ("", None)})
    for member in members(shape):
        value = item[member.name]
        if value is None or value == "" or (isinstance(value, (list, dict)) and not value) or _is_default(member, value):
            continue
        if member.kind == "attribute":
            element.set(member.name, _scalar(value, is_hexadecimal(member.shape)))
        elif member.kind == "list":
            element.set(member.name, " ".join(_scalar(one, is_hexadecimal(member.shape)) for one in value))
        elif member.kind == "object":
            _write(etree.SubElement(element, _tag(member.name)), value, member.shape, own, codes)
        else:
            _write_inside(etree.SubElement(element, _tag(member.name)), value, member, own, codes)


def _write_inside(element: Any, value: Any, member: Member, own: tuple[Any, ...], codes: frozenset[str]) -> None:
    if member.kind == "text":
        element.text = clean(value)
    elif member.kind == "texts":
        for text in value:
            etree.SubElement(element, _tag("text")).text = clean(text)
    elif member.kind == "map":
        for key, inner in value.items():
            entry = etree.SubElement(element, _tag("entry"), {"name": _scalar(key)})
            entry.text = " ".join(map(_scalar, inner)) if isinstance(inner, list) else _scalar(inner, key in codes and _types(member) == ("integer",))
            if len(_types(member)) > 1:
                entry.set("type", {bool: "boolean", int: "integer", str: "string"}[type(inner)])
    else:
        for inner in value.values() if member.kind == "keyed" else value:
            _write(etree.SubElement(element, _tag(member.type_name)), inner, member.shape, own, codes)


def _is_default(member: Member, value: object) -> bool:
    return "default" in member.shape and value == member.shape["default"]


def _types(member: Member) -> tuple[str, ...]:
    return Member(member.name, "", _resolve(member.shape)[0]).types


def read_xml(data: bytes) -> Any:
    """The root element of an XML document, read without entities, DTD or network."""
    return etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False))


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
    return {"document": element.get("document", ""), "section": element.get("section", ""), "page": None if page is None else int(page)}


def _read_member(element: Any, member: Member, own: list[dict[str, Any]]) -> Any:
    if member.kind in ("attribute", "list"):
        text = element.get(member.name)
        if member.kind == "list":
            return [_value(word, Member("", "", member.shape).types) for word in (text or "").split()]
        return member.shape["default"] if text is None and "default" in member.shape else _value(text, member.types)
    inner = element.find(_tag(member.name))
    if member.kind == "object":
        return None if inner is None else _read(inner, member.shape, own)
    if member.kind == "text":
        return "" if inner is None else inner.text or ""
    items = [] if inner is None else list(inner)
    if member.kind == "texts":
        return [item.text or "" for item in items]
    if member.kind == "map":
        return {item.get("name"): _read_entry(item, member) for item in items}
    read = [_read(item, member.shape, own) for item in items]
    return {item[member.shape["x-key"]]: item for item in read} if member.kind == "keyed" else read


def _read_entry(element: Any, member: Member) -> Any:
    shape = _resolve(member.shape)[0]
    if shape.get("type") == "array":
        return (element.text or "").split()
    stated = element.get("type")
    return _value(element.text or "", (stated,) if stated else _types(member))


def _value(text: str | None, types: tuple[str, ...]) -> Any:
    """A written value by the JSON types that it may have; what was left out is null where that is one of them, else an empty text."""
    if text is None:
        return None if "null" in types else ""
    if "boolean" in types and text in ("true", "false"):
        return text == "true"
    if "integer" in types and _INTEGER.fullmatch(text):
        return int(text)
    if "integer" in types and "string" not in types and _HEXADECIMAL.fullmatch(text):
        return int(text, 16)
    return text
