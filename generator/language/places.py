"""Places in a spec as an overlay names them, and what is put there or taken away.

Nothing is changed in place: along the path each map and list is copied, with its marks, so that the spec
as it was read stays as it is. What is put in keeps the marks of the file that it comes from.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import Any

from .document import Mark, Path, label_of

_STEP = re.compile(r"\[([0-9]+)\]|\.?([^.\[\]]+)")
#: Lists and maps that the path of an erratum leaves out: what is in them is called by its name.
_LEFT_OUT = frozenset("layouts fields values parts steps arguments meanings data_ids contacts timings".split())
_UNNAMED = re.compile(r"[^a-z0-9_]")

#: Gives what a map or list is to be, of what it is.
_Edit = Callable[[Any, Mark], tuple[Any, Mark]]


class NothingThere(LookupError):
    """There is nothing at a path; ``step`` is what is missing, ``known`` what could have stood there."""

    def __init__(self, step: str, known: list[str], found: Path) -> None:
        super().__init__(step)
        self.step, self.known, self.found = step, known, found


def steps_of(text: str) -> tuple[str | int, ...]:
    """``procedures.preset.steps[3]`` as keys, names and places counted from 0."""
    return tuple(int(number) - 1 if number else word for number, word in _STEP.findall(text))


def resolve(data: Any, text: str) -> Path:
    """The path to what a text names, with an index for each item of a list.

    Raises:
        NothingThere: A step leads nowhere.
    """
    path: Path = ()
    for step in steps_of(text):
        inside = _inside(data)
        if step not in inside:
            shown = f"[{step + 1}]" if isinstance(step, int) else step
            raise NothingThere(shown, [str(key) for key in inside if isinstance(key, str)], path)
        key = inside[step]
        path, data = (*path, key), data[key]
    return path


def _inside(data: Any) -> dict[str | int, str | int]:
    """What may follow in a path, and the key or index that it stands for."""
    if isinstance(data, dict):
        return {key: key for key in data}
    if not isinstance(data, list):
        return {}
    found: dict[str | int, str | int] = {index: index for index in range(len(data))}
    for index, item in enumerate(data):
        found.setdefault(label_of(item) or index, index)
    return found


def named(data: Any, path: Path) -> Path:
    """The path with the names of items in the place of their indices; its last step need not lead anywhere yet."""
    found: Path = ()
    for step in path:
        inside: Any = data[step] if isinstance(step, int) or step in data else None
        found += ((label_of(inside) or step) if isinstance(step, int) else step,)
        data = inside
    return found


def value_at(data: Any, path: Path) -> Any:
    """What stands at a path that leads somewhere."""
    for step in path:
        data = data[step]
    return data


def mark_at(mark: Mark, path: Path) -> Mark:
    """The mark of what stands at a path that leads somewhere."""
    for step in path:
        mark = mark.children[step]
    return mark


def from_file(mark: Mark, file: str) -> Mark:
    """A mark and all inside as one of another file."""
    children = {key: from_file(child, file) for key, child in mark.children.items()}
    return replace(mark, children=children, file=file)


def put(data: Any, marks: Mark, path: Path, value: Any, mark: Mark) -> tuple[Any, Mark]:
    """Data and marks with a value at ``path``: in the place of what is there, at a new key, or after the last item."""

    def edit(holder: Any, held: Mark) -> tuple[Any, Mark]:
        key = path[-1]
        made: Any = [*holder, None] if isinstance(holder, list) and key == len(holder) else copy(holder)
        made[key] = value
        return made, replace(held, children={**held.children, key: mark})

    return _edited(data, marks, path[:-1], edit)


def taken_away(data: Any, marks: Mark, path: Path) -> tuple[Any, Mark]:
    """Data and marks without what stands at ``path``."""

    def edit(holder: Any, held: Mark) -> tuple[Any, Mark]:
        key = path[-1]
        if isinstance(holder, dict):
            left = {name: item for name, item in holder.items() if name != key}
            return left, replace(held, children={name: item for name, item in held.children.items() if name != key})
        kept = [index for index in range(len(holder)) if index != key]
        children: dict[str | int, Mark] = {
            place: held.children[index] for place, index in enumerate(kept) if index in held.children
        }
        return [holder[index] for index in kept], replace(held, children=children)

    return _edited(data, marks, path[:-1], edit)


def _edited(data: Any, mark: Mark, path: Path, edit: _Edit) -> tuple[Any, Mark]:
    if not path:
        return edit(data, mark)
    key = path[0]
    inside, marked = _edited(data[key], mark.children[key], path[1:], edit)
    made = copy(data)
    made[key] = inside
    return made, replace(mark, children={**mark.children, key: marked})


def as_affected(data: Any, path: Path) -> str:
    """A path as an erratum has it: ``registers.preset`` or ``interfaces.biss.word.crc``.

    It ends before the first step that has no name there; empty where the first has none.
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
    """Whether a path of an erratum names something in these data."""
    nodes = [data]
    for step in affected.split("."):
        nodes = [found for node in nodes for found in _named(node, step)]
    return bool(nodes)


def _named(node: Any, step: str) -> list[Any]:
    """What a step of an erratum's path may mean below ``node``: a key, a name, or a name in one of its lists."""
    if isinstance(node, list):
        return [item for item in node if isinstance(item, dict) and item.get("name") == step]
    if not isinstance(node, dict):
        return []
    found = [node[step]] if step in node else []
    for key, item in node.items():
        if isinstance(item, list):
            found += _named(item, step)
        elif key == "values" and isinstance(item, dict) and step in item:
            found.append(item[step])
    return found
