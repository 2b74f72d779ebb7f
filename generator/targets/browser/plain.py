"""Plain data for the script: numbers and expressions as JSON has them, without members that say nothing."""

from __future__ import annotations

import json
from typing import Any

from ...model.expressions import Expression, Term

Data = dict[str, Any]
#: The highest number that JavaScript reads exactly.
_EXACT = (1 << 53) - 1
#: What would end a script or a comment of HTML around it, or a line of the script.
_HARMLESS = {ord(mark): f"\\u{ord(mark):04x}" for mark in "<>&\u2028\u2029"}


def kept(**members: Any) -> Data:
    """The members that say something: what is 0, empty or False is left out."""
    return {name.rstrip("_"): value for name, value in members.items() if value not in (None, 0, "", (), [], {})}


def number(value: int) -> int | str:
    """A number; as text in hexadecimal where JavaScript would round it."""
    return value if abs(value) <= _EXACT else f"{value:#x}"


def expression(item: Expression) -> Any:
    """A number, or a list: a number, and terms of a sign and factors; ``^name`` is two to the power of it."""
    if item.is_constant:
        return number(item.constant)
    return [number(item.constant), *map(_term, item.terms)]


def _term(item: Term) -> list[int | str]:
    return [item.sign, *(f"^{factor.parameter}" if factor.power else factor.parameter for factor in item.factors)]


def bound(item: Expression | None) -> Any:
    """A limit, or None where there is none."""
    return None if item is None else expression(item)


def script_json(value: object, indent: int | None = None) -> str:
    """Data as JSON that is also JavaScript, and that no markup around the script can be ended by."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), indent=indent)
    return text.translate(_HARMLESS)


class Pool:
    """The parts of layouts, each once: frames of one interface begin and end alike."""

    def __init__(self) -> None:
        self.items: list[Data] = []
        self._places: dict[str, int] = {}

    def parts(self, layout: Data) -> Data:
        """The layout with the places of its parts instead of these."""
        shared = {name: [*map(self._place, layout[name])] for name in ("fields", "checks", "tells") if name in layout}
        return layout | shared

    def _place(self, part: Data) -> int:
        place = self._places.setdefault(script_json(part), len(self.items))
        if place == len(self.items):
            self.items.append(part)
        return place
