"""Values of the model as plain data, and as text for a sentence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from ..model import CodedValue, Scale, Supply
from ..model.expressions import Expression
from ..say.numbers import formula
from ..say.words import counted, hertz, microseconds, volts

_LONGEST = 60
_SAID = ("meaning", "note")
_FORMS: Mapping[str, Callable[[int], str]] = {
    # In whole bytes.
    "hex": lambda value: f"{value:0{2 * max(1, (value.bit_length() + 7) // 8)}X}h",
    "bytes": lambda value: counted(value, "byte"),
    "mv": volts,
    "us": microseconds,
    "ms": lambda value: microseconds(1000 * value),
    "hz": hertz,
}


def plain(value: Any) -> Any:
    """Return any part of the model as JSON data, without sources."""
    if isinstance(value, Expression):
        return value.constant if value.is_constant else value.render()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, bytes):
        return value.hex(" ").upper()
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [plain(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {item.name: plain(getattr(value, item.name)) for item in fields(value) if item.name != "source"}
    return value


def shown(value: Any, form: str = "") -> str:
    """Return a value as short text, with a form in the notation of manuals."""
    if isinstance(value, bool):
        return ("low" if value else "high") if form == "level" else "yes" if value else "no"
    if value is None or value in ("", (), [], {}):
        return "none"
    if isinstance(value, int):
        return _FORMS[form](value) if form in _FORMS else f"{value}"
    if isinstance(value, Expression):
        return value.render()
    if isinstance(value, Enum):
        return str(value.value).replace("_", " ")
    if isinstance(value, (tuple, list)):
        return _cut(", ".join(shown(item, form) for item in value))
    if isinstance(value, Supply):
        return f"{volts(value.min_mv)} to {volts(value.max_mv)}"
    if isinstance(value, Scale):
        return f"{formula(value)} {value.unit}"
    if isinstance(value, CodedValue):
        return f"{value.code} = {value.value}"
    if is_dataclass(value):
        value = {key: item for key, item in without_words(value).items() if item not in (None, "", [], {})}
        if len(value) == 1:
            return shown(next(iter(value.values())), form)
    if isinstance(value, Mapping):
        return _cut(", ".join(f"{key} = {shown(item)}" for key, item in value.items()))
    return _cut(str(value).replace("_", " ") if form == "word" else str(value))


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def without_words(value: Any) -> Any:
    """Return a part of the model as data, without its texts."""
    if isinstance(value, tuple):
        return [without_words(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        data = plain(value)
        return {key: item for key, item in data.items() if key not in _SAID}
    return value


def differing_items(old: Any, new: Any) -> tuple[Any, Any]:
    """Return two values, reduced to the items that differ if both are sequences of parts."""
    if isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_dataclass, (*old, *new))):
        left, right = _without(old, new), _without(new, old)
        return (left, right) if left or right else (old, new)
    return old, new


def _without(items: tuple[Any, ...], others: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the items that are not among others, apart from their texts."""
    known = [without_words(item) for item in others]
    return tuple(item for item in items if without_words(item) not in known)


def arrow(old: Any, new: Any, form: str = "") -> str:
    """Return ``old → new``."""
    return f"{shown(old, form)} → {shown(new, form)}"
