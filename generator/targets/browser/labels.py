"""Grammar of the order codes of a family for the script: the possible labels, and the parts of each code.

Regular expressions are those of ``order_codes.labels`` in the notation of JavaScript.
"""

from __future__ import annotations

from ...model import CodePart, Device, Spelling
from ...order_codes.labels import AFTER, as_listed, regex
from .plain import Data, without_empty


def label_grammar(device: Device) -> Data:
    """Return the notations of the order codes of a family."""
    order_code = device.order_code
    listed_spelling = as_listed(order_code)
    spellings = (listed_spelling, *order_code.also_written)
    return {
        "pattern": order_code.pattern,
        "written": [_spelling_data(device, spelling) for spelling in spellings],
        "wrong": [_javascript_pattern(regex(order_code, listed_spelling, part.name)) for part in order_code.parts],
        "parts": [_part_data(part) for part in order_code.parts],
    }


def _part_data(part: CodePart) -> Data:
    values = [value.text for value in part.values]
    return without_empty(name=part.name, values=values, only_with=dict(part.open_only_with))


def _spelling_data(device: Device, spelling: Spelling) -> Data:
    values: dict[str, dict[str, str]] = {}
    for value in spelling.values:
        values.setdefault(value.part, {})[value.text.upper()] = value.value
    return without_empty(
        label=_javascript_pattern(regex(device.order_code, spelling)), where=spelling.where, values=values
    )


def _javascript_pattern(expression: str) -> str:
    """Return a regular expression for a whole label in the notation of JavaScript."""
    return f"^{expression}{AFTER}$".replace("(?P<", "(?<")
