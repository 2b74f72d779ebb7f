"""A model in which every running text tries to break out of its output."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from codewheel.model.registers import has_steps

#: Members that are running text in the spec language. The others are words that schema and rules restrict.
TEXTS = frozenset(
    """
    title meaning note printed_name when_active when_inactive printed used why content changes signal contact only
    remedy detected precondition result mating publisher special signals profile symbol unit state
    where
    """.split()
)


def spoilt(part: Any, text: str, names: frozenset[str] = TEXTS) -> Any:
    """Return the same value, with ``text`` in place of all texts of these members."""
    if dataclasses.is_dataclass(part) and not isinstance(part, type):
        changes = {}
        for member in dataclasses.fields(part):
            member_value = getattr(part, member.name)
            is_text = member.name in names or (member.name == "value" and type(part).__name__ == "Characteristic")
            changes[member.name] = (
                _spoilt_text(member_value, text, names) if is_text else spoilt(member_value, text, names)
            )
        return dataclasses.replace(part, **changes)
    if isinstance(part, tuple):
        return tuple(spoilt(member, text, names) for member in part)
    if isinstance(part, Mapping):
        return {key: spoilt(member, text, names) for key, member in part.items()}
    return part


def _spoilt_text(value: Any, text: str, names: frozenset[str]) -> Any:
    if isinstance(value, str):
        # Numbers of steps stay, because links refer to them.
        if has_steps(value):
            return f"1. {text} 2. {text} 3. {text}"
        return text if value else value
    if isinstance(value, tuple) and all(isinstance(part, str) for part in value):
        return tuple(text for _ in value)
    return spoilt(value, text, names)
