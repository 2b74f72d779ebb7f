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
        return {str(key): plain(member) for key, member in value.items()}
    if isinstance(value, (tuple, list)):
        return [plain(member) for member in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {member.name: plain(getattr(value, member.name)) for member in fields(value) if member.name != "source"}
    return value


def short_value(value: Any, notation: str = "") -> str:
    """Return a value as short text, in the given notation of manuals if there is one."""
    if value is None or value in ("", (), [], {}):
        return "none"
    if isinstance(value, (bool, int)):
        return _number_text(value, notation)
    if isinstance(value, Enum):
        return str(value.value).replace("_", " ")
    if isinstance(value, (tuple, list)):
        return _shorten(", ".join(short_value(member, notation) for member in value))
    if isinstance(value, (Expression, Supply, Scale, CodedValue)):
        return _quantity_text(value)
    if is_dataclass(value):
        value = {key: member for key, member in without_words(value).items() if member not in (None, "", [], {})}
        if len(value) == 1:
            return short_value(next(iter(value.values())), notation)
    if isinstance(value, Mapping):
        return _shorten(", ".join(f"{key} = {short_value(member)}" for key, member in value.items()))
    return _shorten(str(value).replace("_", " ") if notation == "word" else str(value))


def _number_text(value: int, notation: str) -> str:
    if isinstance(value, bool):
        yes, no = ("low", "high") if notation == "level" else ("yes", "no")
        return yes if value else no
    return _FORMS[notation](value) if notation in _FORMS else f"{value}"


def _quantity_text(value: Expression | Supply | Scale | CodedValue) -> str:
    match value:
        case Expression():
            return value.render()
        case Supply():
            return f"{volts(value.min_mv)} to {volts(value.max_mv)}"
        case Scale():
            return f"{formula(value)} {value.unit}"
        case CodedValue():
            return f"{value.code} = {value.value}"


def _shorten(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def without_words(value: Any) -> Any:
    """Return a part of the model as data, without its texts."""
    if isinstance(value, tuple):
        return [without_words(member) for member in value]
    if is_dataclass(value) and not isinstance(value, type):
        data = plain(value)
        return {key: member for key, member in data.items() if key not in _SAID}
    return value


def differing_items(old: Any, new: Any) -> tuple[Any, Any]:
    """Return two values, reduced to the items that differ if both are sequences of parts."""
    if isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_dataclass, (*old, *new))):
        old_only, new_only = _items_not_in(old, new), _items_not_in(new, old)
        return (old_only, new_only) if old_only or new_only else (old, new)
    return old, new


def _items_not_in(items: tuple[Any, ...], other_items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the items that are not among others, apart from their texts."""
    known_items = [without_words(other_item) for other_item in other_items]
    return tuple(part for part in items if without_words(part) not in known_items)


def arrow(old: Any, new: Any, notation: str = "") -> str:
    """Return ``old → new``."""
    return f"{short_value(old, notation)} → {short_value(new, notation)}"
