"""Grammar of the order codes of a family for the script: the possible labels, and the parts of each code.

Regular expressions are those of ``order_codes.labels`` in the notation of JavaScript.
"""

from __future__ import annotations

from ...model import CodePart, Device, Spelling
from ...order_codes.labels import AFTER, as_listed, regex
from .plain import Data, without_empty


def labels(device: Device) -> Data:
    """Return the notations of the order codes of a family."""
    code = device.order_code
    listed = as_listed(code)
    return {
        "pattern": code.pattern,
        "written": [_spelling(device, spelling) for spelling in (listed, *code.also_written)],
        "wrong": [_script(regex(code, listed, part.name)) for part in code.parts],
        "parts": [_part(part) for part in code.parts],
    }


def _part(part: CodePart) -> Data:
    values = [value.text for value in part.values]
    return without_empty(name=part.name, values=values, only_with=dict(part.open_only_with))


def _spelling(device: Device, spelling: Spelling) -> Data:
    values: dict[str, dict[str, str]] = {}
    for value in spelling.values:
        values.setdefault(value.part, {})[value.text.upper()] = value.value
    return without_empty(label=_script(regex(device.order_code, spelling)), where=spelling.where, values=values)


def _script(expression: str) -> str:
    """Return a regular expression for a whole label in the notation of JavaScript."""
    return f"^{expression}{AFTER}$".replace("(?P<", "(?<")
