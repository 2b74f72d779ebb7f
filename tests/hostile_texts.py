"""A model in which every running text tries to break out of its output."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from codewheel.model.by_hand import has_steps

#: Members that are running text in the spec language. The others are words that schema and rules restrict.
TEXTS = frozenset(
    """
    title meaning note printed_name when_active when_inactive printed used why content changes signal contact only
    remedy detected precondition result mating publisher special signals profile symbol unit state
    where
    """.split()
)


def spoilt(item: Any, text: str, names: frozenset[str] = TEXTS) -> Any:
    """Return the same value, with ``text`` in place of all texts of these members."""
    if dataclasses.is_dataclass(item) and not isinstance(item, type):
        changes = {}
        for member in dataclasses.fields(item):
            value = getattr(item, member.name)
            is_text = member.name in names or (member.name == "value" and type(item).__name__ == "Characteristic")
            changes[member.name] = _spoilt_text(value, text, names) if is_text else spoilt(value, text, names)
        return dataclasses.replace(item, **changes)
    if isinstance(item, tuple):
        return tuple(spoilt(entry, text, names) for entry in item)
    if isinstance(item, Mapping):
        return {key: spoilt(entry, text, names) for key, entry in item.items()}
    return item


def _spoilt_text(value: Any, text: str, names: frozenset[str]) -> Any:
    if isinstance(value, str):
        # Numbers of steps stay, because links refer to them.
        return f"1. {text} 2. {text} 3. {text}" if has_steps(value) else text if value else value
    if isinstance(value, tuple) and all(isinstance(entry, str) for entry in value):
        return tuple(text for _ in value)
    return spoilt(value, text, names)
