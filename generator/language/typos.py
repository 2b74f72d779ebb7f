"""Obvious mistakes in YAML, fixed while reading. Each is reported once, and the rest is read as intended.

Without this, a comma in text would look like an unknown key, and a missing dash like an item full of duplicate keys.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

from .problems import quoted

_DIGITS = re.compile("[0-9]+")
_THOUSANDS = re.compile("[0-9]{3}")
#: Number of events to look ahead. A longer value is not a mistake.
_FURTHEST = 2000

#: Called with an event, a rule and a message.
Complain = Callable[[Any, str, str], None]


@dataclass(slots=True)
class _Container:
    """An open map or list. ``nodes`` counts its keys and values so far."""

    is_map: bool
    flow: bool
    in_list: bool
    nodes: int = 0
    keys: dict[str, int] = field(default_factory=dict)

    @property
    def awaits_key(self) -> bool:
        return self.is_map and self.nodes % 2 == 0


class CorrectedEvents:
    """The events of a parser with mistakes fixed.

    Args:
        events: The events as they come.
        lines: The lines of the text.
        is_text: Returns True if an unquoted scalar is text, not a number or the like.
        complain: Called for each mistake.
    """

    def __init__(
        self, events: Iterator[Any], lines: list[str], is_text: Callable[[str], bool], complain: Complain
    ) -> None:
        self._events = events
        self._ahead: deque[Any] = deque()
        self._lines = lines
        self._is_text = is_text
        self._complain = complain
        self._open: list[_Container] = []

    def __iter__(self) -> Iterator[Any]:
        while (event := self._next()) is not None:
            container = self._open[-1] if self._open else None
            if isinstance(event, (yaml.MappingEndEvent, yaml.SequenceEndEvent)):
                self._open.pop()
                self._count()
            elif isinstance(event, (yaml.MappingStartEvent, yaml.SequenceStartEvent)):
                in_list = container is not None and not container.is_map
                self._open.append(
                    _Container(isinstance(event, yaml.MappingStartEvent), bool(event.flow_style), in_list)
                )
            elif isinstance(event, yaml.ScalarEvent) and container is not None and container.is_map:
                if container.awaits_key:
                    yield from self._insert_item_end(event, container)
                    container.keys.setdefault(event.value, _line(event))
                elif container.flow:
                    self._skip_text_after_comma(event)
                container.nodes += 1
            elif isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)):
                self._count()
            yield event

    def _count(self) -> None:
        if self._open:
            self._open[-1].nodes += 1

    def _next(self) -> Any:
        return self._ahead.popleft() if self._ahead else next(self._events, None)

    def _peek(self, index: int) -> Any:
        while len(self._ahead) <= index:
            self._ahead.append(next(self._events, None))
        return self._ahead[index]

    def _insert_item_end(self, key: Any, container: _Container) -> Iterator[Any]:
        """Yield the end of the item and the start of the next if its keys repeat, beginning with the first one."""
        if not container.in_list or container.flow or len(container.keys) < 2:
            return
        first_key = next(iter(container.keys))
        if key.value != first_key or self._key_after_next() not in container.keys:
            return
        message = (
            f"this item has a key twice: {quoted(key.value)} is already on line {container.keys[key.value]}; "
            "put '-' before it if a new item begins here"
        )
        self._complain(key, "duplicate-key", message)
        container.keys.clear()
        yield yaml.MappingEndEvent(key.start_mark, key.start_mark)
        yield yaml.MappingStartEvent(None, None, True, key.start_mark, key.start_mark, flow_style=False)

    def _key_after_next(self) -> str | None:
        depth = index = 0
        while True:
            event = self._peek(index)
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            index += 1
            if event is None or depth < 0 or index > _FURTHEST:
                return None
            if depth == 0:
                break
        following = self._peek(index)
        return following.value if isinstance(following, yaml.ScalarEvent) else None

    def _skip_text_after_comma(self, value: Any) -> None:
        """Skip the text after a comma in an unquoted text or number in {...}, which would be a key without a value."""
        if value.style or value.tag or value.anchor:
            return
        first_skipped, is_number = None, _DIGITS.fullmatch(value.value) is not None
        while self._is_key_without_colon(self._peek(0), self._peek(1)):
            skipped = self._ahead[0]
            if is_number and _THOUSANDS.fullmatch(skipped.value):
                value.value += skipped.value
            elif is_number or not self._is_text(value.value):
                break  # As in {12: , 16}, where keys may come alone.
            first_skipped = first_skipped or skipped
            self._ahead.popleft()
            self._ahead.popleft()
        if first_skipped is not None:
            self._complain(first_skipped, "yaml-syntax", _about_comma(first_skipped, value.value if is_number else ""))

    def _is_key_without_colon(self, key: Any, value: Any) -> bool:
        """Return True for a key without a colon and without a value."""
        if not isinstance(key, yaml.ScalarEvent) or not isinstance(value, yaml.ScalarEvent):
            return False
        if key.style or value.style or value.value:
            return False
        end: Any = key.end_mark
        text_after = self._lines[end.line][end.column :]
        return key.value != "" and not text_after.lstrip().startswith(":")


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _about_comma(skipped: Any, number: str) -> str:
    if number:
        return f"numbers are written without commas; write {number}"
    rule = "A comma ends an unquoted string inside {...}: if this is part of the string, quote the whole string"
    return f"{quoted(skipped.value)} has no colon. {rule}"
