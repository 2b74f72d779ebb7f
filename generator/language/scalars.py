"""Values of unquoted scalars, by the core schema of YAML 1.2: null, Booleans, numbers and text."""

from __future__ import annotations

import re

_NULL_WORDS = frozenset(("", "~", "null", "Null", "NULL"))
_BOOLEAN_WORDS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
INTEGER_TEXT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT_TEXT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def resolve_scalar(scalar_text: str) -> str | int | float | bool | None:
    """Return the value of an unquoted scalar: None, a boolean, a number or text, by the core schema of YAML 1.2."""
    if scalar_text in _NULL_WORDS:
        return None
    if scalar_text in _BOOLEAN_WORDS:
        return _BOOLEAN_WORDS[scalar_text]
    if INTEGER_TEXT.fullmatch(scalar_text):
        base = {"0x": 16, "0o": 8}.get(scalar_text[:2], 10)
        return int(scalar_text, base)
    if _FLOAT_TEXT.fullmatch(scalar_text):
        return float(scalar_text)
    # Python writes infinities and NaN without the point.
    return float(scalar_text.replace(".", "")) if _SPECIAL_FLOAT.fullmatch(scalar_text) else scalar_text


def is_text(scalar: str) -> bool:
    """Return True if an unquoted scalar is text, not a number or the like."""
    return isinstance(resolve_scalar(scalar), str)
