"""Plain data for the script: numbers and expressions for JSON, without empty members."""

from __future__ import annotations

import json
from dataclasses import fields
from enum import Enum
from typing import Any

from ...model import Scale
from ...model.expressions import Expression, Term

Data = dict[str, Any]
#: Highest integer that JavaScript represents exactly.
_EXACT = (1 << 53) - 1
#: Characters that could end the surrounding script element, an HTML comment, or a line of the script.
_HARMLESS = {ord(mark): f"\\u{ord(mark):04x}" for mark in "<>&\u2028\u2029"}


def without_empty(**members: Any) -> Data:
    """Return those members that are not 0, empty or False."""
    return {name.rstrip("_"): value for name, value in members.items() if value not in (None, 0, "", (), [], {})}


def number(value: int) -> int | str:
    """Return a number, or a hexadecimal text if JavaScript would round it."""
    return value if abs(value) <= _EXACT else f"{value:#x}"


def expression(value: Expression) -> Any:
    """Return a number, or a list of a number and terms of a multiple and factors.

    ``^name`` is two to the power ``name``.
    """
    if value.is_constant:
        return number(value.constant)
    return [number(value.constant), *map(_term, value.terms)]


def _term(term: Term) -> list[int | str]:
    factors = [f"^{factor.parameter}" if factor.power else factor.parameter for factor in term.factors]
    return [number(term.multiple), *factors]


def bound(limit: Expression | None) -> Any:
    """Return a limit, or None if there is none."""
    return None if limit is None else expression(limit)


def described(value: Any) -> Any:
    """Return any part of the plan's description, without members that have their default or are 0, empty or False."""
    match value:
        case Expression():
            return expression(value)
        case Enum():
            return value.value
        case bool() | int():
            return number(int(value))
        case tuple():
            return [described(element) for element in value]
        case None | str():
            return value
        case Scale(numerator, denominator, offset, unit):
            return [numerator, denominator, offset, unit, value.places]
    members = ((member, getattr(value, member.name)) for member in fields(value) if member.compare)
    return without_empty(**{member.name: described(value) for member, value in members if value != member.default})


def script_json(value: object, indent: int | None = None) -> str:
    """Return data as JSON that is also valid JavaScript and cannot end the markup around the script."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), indent=indent)
    return text.translate(_HARMLESS)


class Pool:
    """Shared parts of layouts, since the frames of an interface have many parts in common."""

    def __init__(self) -> None:
        self.items: list[Data] = []
        self._places: dict[str, int] = {}

    def parts(self, layout: Data) -> Data:
        """Return the layout with indexes in place of its parts."""
        shared = {name: [*map(self._place, layout[name])] for name in ("fields", "checks", "tells") if name in layout}
        return layout | shared

    def _place(self, part: Data) -> int:
        place = self._places.setdefault(script_json(part), len(self.items))
        if place == len(self.items):
            self.items.append(part)
        return place
