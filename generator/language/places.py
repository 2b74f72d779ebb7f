"""Places in a spec as named by an overlay, and functions to put values there or remove them.

Nothing is modified in place. Each map and list along the path is copied, with its marks, so that the spec remains as
read. New values keep the marks of the file that they come from.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import Any

from .document import Mark, Path, label_of

_STEP = re.compile(r"\[([0-9]+)\]|\.?([^.\[\]]+)")
#: Lists and maps that the path of an erratum omits, because their items are identified by name.
_LEFT_OUT = frozenset(
    "layouts fields combinations values parts steps arguments meanings data_ids contacts timings".split()
)
_UNNAMED = re.compile(r"[^a-z0-9_]")

#: Function from a map or list to its replacement.
_Edit = Callable[[Any, Mark], tuple[Any, Mark]]


class MissingPath(LookupError):
    """No value at a path. ``step`` is the missing step, ``known_steps`` are the possible ones."""

    def __init__(self, step: str, known_steps: list[str], existing_path: Path) -> None:
        super().__init__(step)
        self.step, self.known_steps, self.existing_path = step, known_steps, existing_path


def steps_of(text: str) -> tuple[str | int, ...]:
    """Split ``procedures.preset.steps[3]`` into keys, names and indices counted from 0."""
    return tuple(_step_of(match) for match in _STEP.finditer(text))


def _step_of(match: re.Match[str]) -> str | int:
    number, word = match.groups()
    return int(number) - 1 if number else str(word)


def resolve(data: Any, text: str) -> Path:
    """Return the path for a place given as text, with an index for each list item.

    Raises:
        NothingThere: A step does not exist.
    """
    path: Path = ()
    for step in steps_of(text):
        keys_by_step = _inner_steps(data)
        if step not in keys_by_step:
            step_text = f"[{step + 1}]" if isinstance(step, int) else step
            raise MissingPath(step_text, [str(key) for key in keys_by_step if isinstance(key, str)], path)
        key = keys_by_step[step]
        path, data = (*path, key), data[key]
    return path


def _inner_steps(data: Any) -> dict[str | int, str | int]:
    """Return the possible next steps of a path, each with its key or index."""
    if isinstance(data, dict):
        return {key: key for key in data}
    if not isinstance(data, list):
        return {}
    steps: dict[str | int, str | int] = {index: index for index in range(len(data))}
    for index, child in enumerate(data):
        steps.setdefault(label_of(child) or index, index)
    return steps


def named_path(data: Any, path: Path) -> Path:
    """Return the path with names of items instead of indices. The last step need not exist yet."""
    named_path: Path = ()
    for step in path:
        child: Any = data[step] if isinstance(step, int) or step in data else None
        named_path += ((label_of(child) or step) if isinstance(step, int) else step,)
        data = child
    return named_path


def value_at(data: Any, path: Path) -> Any:
    """Return the value at an existing path."""
    for step in path:
        data = data[step]
    return data


def mark_at(mark: Mark, path: Path) -> Mark:
    """Return the mark of the value at an existing path."""
    for step in path:
        mark = mark.children[step]
    return mark


def from_file(mark: Mark, file: str) -> Mark:
    """Return the mark and its children, assigned to another file."""
    children = {key: from_file(child, file) for key, child in mark.children.items()}
    return replace(mark, children=children, file=file)


def with_value(data: Any, marks: Mark, path: Path, value: Any, mark: Mark) -> tuple[Any, Mark]:
    """Return data and marks with a value at ``path``: replaced, at a new key, or appended to a list."""

    def edit(holder: Any, holder_mark: Mark) -> tuple[Any, Mark]:
        key = path[-1]
        edited: Any = [*holder, None] if isinstance(holder, list) and key == len(holder) else copy(holder)
        edited[key] = value
        return edited, replace(holder_mark, children={**holder_mark.children, key: mark})

    return _edited(data, marks, path[:-1], edit)


def without_value(data: Any, marks: Mark, path: Path) -> tuple[Any, Mark]:
    """Return data and marks without the value at ``path``."""

    def edit(holder: Any, holder_mark: Mark) -> tuple[Any, Mark]:
        key = path[-1]
        if isinstance(holder, dict):
            remaining = {name: child for name, child in holder.items() if name != key}
            return remaining, replace(
                holder_mark,
                children={name: child_mark for name, child_mark in holder_mark.children.items() if name != key},
            )
        remaining_indices = [index for index in range(len(holder)) if index != key]
        child_marks = holder_mark.children
        marked = [(place, index) for place, index in enumerate(remaining_indices) if index in child_marks]
        children: dict[str | int, Mark] = {place: child_marks[index] for place, index in marked}
        return [holder[index] for index in remaining_indices], replace(holder_mark, children=children)

    return _edited(data, marks, path[:-1], edit)


def _edited(data: Any, mark: Mark, path: Path, edit: _Edit) -> tuple[Any, Mark]:
    if not path:
        return edit(data, mark)
    key = path[0]
    edited_child, marked = _edited(data[key], mark.children[key], path[1:], edit)
    edited = copy(data)
    edited[key] = edited_child
    return edited, replace(mark, children={**mark.children, key: marked})


def as_affected(data: Any, path: Path) -> str:
    """Return a path in the form used by errata: ``registers.preset`` or ``interfaces.biss.word.crc``.

    The path ends before the first step without a name. It is empty if the first step has none.
    """
    words: list[str] = []
    for depth, step in enumerate(path):
        data = data[step]
        word = label_of(data) if isinstance(step, int) else step
        if word is None or _UNNAMED.search(str(word)):
            break
        if depth == 0 or isinstance(step, int) or word not in _LEFT_OUT:
            words.append(str(word))
    return ".".join(words)


def leads_somewhere(data: Any, affected: str) -> bool:
    """Return True if a path of an erratum refers to something in the data."""
    return bool(Affected(data).at(affected))


class Affected:
    """Finds what the paths of errata refer to, in data that does not change."""

    def __init__(self, data: Any) -> None:
        self._data = data
        #: Items by name, for each list that was searched.
        self._items: dict[int, dict[object, list[Any]]] = {}

    def at(self, affected: str) -> list[Any]:
        """Return everything in the data to which a path refers."""
        nodes = [self._data]
        for step in affected.split("."):
            nodes = [match for node in nodes for match in self._named(node, step)]
        return nodes

    def _named(self, node: Any, step: str) -> list[Any]:
        """Return the matches of a step of a path below ``node``: by key, by name, or by name in a list."""
        if isinstance(node, list):
            return self._items_of(node).get(step, [])
        if not isinstance(node, dict):
            return []
        matches = [node[step]] if step in node else []
        for key, child in node.items():
            if isinstance(child, list):
                matches += self._items_of(child).get(step, [])
            elif key == "values" and isinstance(child, dict) and step in child:
                matches.append(child[step])
        return matches

    def _items_of(self, items: list[Any]) -> dict[object, list[Any]]:
        if id(items) not in self._items:
            named_items: dict[object, list[Any]] = {}
            for list_item in items:
                if isinstance(list_item, dict) and isinstance(list_item.get("name"), str):
                    named_items.setdefault(list_item["name"], []).append(list_item)
            self._items[id(items)] = named_items
        return self._items[id(items)]
