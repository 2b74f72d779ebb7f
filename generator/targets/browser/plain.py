"""Plain data for the script: numbers and expressions for JSON, without empty members."""

from __future__ import annotations

import json
from dataclasses import fields
from enum import Enum
from typing import Any

from ...model import Scale
from ...model.expressions import Expression, Factor, Term

Data = dict[str, Any]
#: Highest integer that JavaScript represents exactly.
_HIGHEST_EXACT_INTEGER = (1 << 53) - 1
#: Characters that could end the surrounding script element, an HTML comment, or a line of the script.
_ESCAPES = {ord(mark): f"\\u{ord(mark):04x}" for mark in "<>&\u2028\u2029"}


def without_empty(**members: Any) -> Data:
    """Return those members that are not 0, empty or False."""
    return {name.rstrip("_"): value for name, value in members.items() if value not in (None, 0, "", (), [], {})}


def json_number(value: int) -> int | str:
    """Return a number, or a hexadecimal text if JavaScript would round it."""
    return value if abs(value) <= _HIGHEST_EXACT_INTEGER else f"{value:#x}"


def expression_data(value: Expression) -> Any:
    """Return a number, or a list of a number and terms of a multiple and factors.

    ``^name`` is two to the power ``name``.
    """
    if value.is_constant:
        return json_number(value.constant)
    return [json_number(value.constant), *map(_term_data, value.terms)]


def _term_data(term: Term) -> list[int | str]:
    return [json_number(term.multiple), *map(_factor_text, term.factors)]


def _factor_text(factor: Factor) -> str:
    return f"^{factor.parameter}" if factor.power else factor.parameter


def optional_expression_data(value: Expression | None) -> Any:
    """Return a number or an expression, or None if there is none."""
    return None if value is None else expression_data(value)


def plain_data(value: Any) -> Any:
    """Return any part of the plan's description, without members that have their default or are 0, empty or False."""
    match value:
        case Expression():
            return expression_data(value)
        case Enum():
            return value.value
        case bool() | int():
            return json_number(int(value))
        case tuple():
            return [plain_data(element) for element in value]
        case None | str():
            return value
        case Scale(numerator, denominator, offset, unit):
            return [numerator, denominator, offset, unit, value.places]
    members: Data = {}
    for member in fields(value):
        content = getattr(value, member.name)
        if member.compare and content != member.default:
            members[member.name] = plain_data(content)
    return without_empty(**members)


def script_json(value: object, indent: int | None = None) -> str:
    """Return data as JSON that is also valid JavaScript and cannot end the markup around the script."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), indent=indent)
    return text.translate(_ESCAPES)


class SharedParts:
    """Shared parts of layouts, since the frames of an interface have many parts in common."""

    def __init__(self) -> None:
        self.parts: list[Data] = []
        self._indexes: dict[str, int] = {}

    def with_indexes(self, layout: Data) -> Data:
        """Return the layout with indexes in place of its parts."""
        names = [name for name in ("fields", "checks", "tells") if name in layout]
        return layout | {name: list(map(self._index, layout[name])) for name in names}

    def _index(self, part: Data) -> int:
        """Return the index of a part, which is added unless there is an equal one."""
        index = self._indexes.setdefault(script_json(part), len(self.parts))
        if index == len(self.parts):
            self.parts.append(part)
        return index
