"""Rules for Gray code: what an interface says about its code, and the layouts that decoders follow."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..problems import DocumentReport, quoted
from .flags import position_names
from .walk import Fields, Spec, by_name, field_names, items, layouts, mapping

_GRAY = re.compile(r"\bGray\b", re.IGNORECASE)
#: Gray can also be a colour, except in the meaning of an interface.
_GRAY_CODE = re.compile(r"\bGray[ -]code\b", re.IGNORECASE)
_BINARY = re.compile(r"\bbinary\b", re.IGNORECASE)


def output_code(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that ``output_code`` of an interface is the code in which its layouts send the position."""
    for kind, interface in mapping(spec, "interfaces").items():
        code, sent_layouts = interface.get("output_code"), list(_with_position(spec, raw, kind))
        has_gray = any("gray" in layout.owner for layout in sent_layouts)
        for layout in sent_layouts:
            contradiction = _contradiction(code, layout, spec, raw, has_gray=has_gray)
            if contradiction:
                message = f"'output_code' is {code}, but {quoted(layout.owner['name'])} {contradiction}"
                report.add("output-code", ("interfaces", kind, "output_code"), message)
                break


def _contradiction(code: object, layout: Fields, spec: Spec, raw: Spec, *, has_gray: bool) -> str:
    """Return how a layout contradicts ``output_code``, or an empty string.

    ``has_gray`` is set if any layout of the interface is in Gray code.
    """
    gray = mapping(layout.owner, "gray")
    when = gray.get("when")
    if code == "binary" and gray:
        return f"has 'gray'; write 'output_code: {'by_order_code' if when else 'gray'}', or leave 'gray' out"
    if not gray and (code == "gray" or (code == "by_order_code" and not has_gray)):
        condition = "" if code == "gray" else ", when: PARAMETER"
        example = f"'gray: {{of: {_position(layout, spec, raw)}{condition}}}'"
        return f"has no 'gray', so decoders take the position as binary; add {example} to it"
    if code == "by_order_code" and gray and not when:
        return "is always in Gray code; write 'output_code: gray', or add 'when' to 'gray'"
    if code == "gray" and 0 in _numbers_set(spec, layout.interface, str(when)):
        return f"is binary where {quoted(str(when))} is 0; write 'output_code: by_order_code'"
    return ""


def gray_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an interface whose order codes name Gray code has a layout in Gray code."""
    kinds = [*mapping(spec, "interfaces")]
    default_kind = kinds[0] if len(kinds) == 1 else ""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            kind, meaning = value.get("interface", default_kind), value.get("meaning", "")
            is_named = (_GRAY if "interface" in value else _GRAY_CODE).search(meaning) and not _BINARY.search(meaning)
            sent_layouts = list(_with_position(spec, raw, kind)) if is_named else []
            if sent_layouts and not any("gray" in fields.owner for fields in sent_layouts):
                message = (
                    f"the meaning of {quoted(text)} says Gray, but no layout of {kind} has 'gray', "
                    "so decoders take it as binary"
                )
                report.add("output-code", (*path, "values", text, "meaning"), message)


def _with_position(spec: Spec, raw: Spec, kind: str) -> Iterator[Fields]:
    """Yield the layouts of the encoder that contain the position, or all of them if none is known to do so."""
    interface_layouts = [layout for layout in layouts(spec) if layout.interface == kind]
    sent_layouts = [layout for layout in interface_layouts if layout.owner.get("from") == "encoder"]
    with_position = [layout for layout in sent_layouts if _position(layout, spec, raw) != "POSITION"]
    yield from with_position or sent_layouts


def _position(fields: Fields, spec: Spec, raw: Spec) -> str:
    """Return the name of the position in a layout, or a placeholder."""
    joins, names = mapping(fields.owner, "join"), field_names(fields, by_name(raw, "field_groups"))
    known_names = position_names(spec, fields.interface)
    return next((name for name in (*joins, *names) if name in known_names), "POSITION")


def _numbers_set(spec: Spec, kind: str, parameter: str) -> set[int]:
    """Return the numbers to which the order codes of an interface set a parameter."""
    values = (value for _, part in items(spec, "order_code", "parts") for value in part["values"].values())
    sets = (mapping(value, "sets") for value in values if value.get("interface", kind) == kind)
    return {numbers[parameter] for numbers in sets if parameter in numbers}
