"""A spec as it was read: plain data, and where each value stands in the file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

#: A place inside a spec: keys of maps, and for lists an index or the name of an item.
Path = tuple[str | int, ...]

#: Keys by which an item of a list is called, the first that it has.
_ITEM_KEYS = ("name", "id", "revision", "contact")
_WRITTEN = re.compile(r"(?:[&!]\S*\s+)*([-+]?[0-9][0-9A-Za-z]*)")
_PLAIN_LABEL = re.compile(r"[A-Za-z0-9_]+")


@dataclass(slots=True)
class Mark:
    """Where a value and its key begin, counted from 1, and the same for what is inside. A list item is its own key.

    ``file`` is empty for what stands in the document's own file; an overlay brings values of another.
    """

    line: int
    column: int
    key_line: int
    key_column: int
    children: dict[str | int, Mark] = field(default_factory=dict)
    file: str = ""


@dataclass
class Document:
    """A spec as it was read.

    ``data`` consists of dict, list, str, int, float, bool and None. ``broken`` lists the places about which the reader
    has already complained; what stands there is only a stand-in. ``doubtful`` lists those where something was left out,
    such as a key that comes twice. ``kept`` is filled by the schema check: for a list that lost items,
    the original index of each item that stayed, so that paths into the pruned data still find their lines.
    ``others`` are the lines of other files from which changes came. ``family`` is the name of a family that was made
    of the one in the file, such as an older edition; empty for the one that the file holds.
    """

    file: str
    lines: tuple[str, ...]
    data: dict[str, Any]
    marks: Mark
    broken: tuple[Path, ...] = ()
    doubtful: tuple[Path, ...] = ()
    kept: dict[Path, tuple[int, ...]] = field(default_factory=dict)
    others: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    family: str = ""

    @property
    def key(self) -> str:
        """What tells it from every other document, also from one that was made of the same file."""
        return f"{self.file}\0{self.family}" if self.family else self.file

    def line(self, number: int, file: str = "") -> str:
        """The text of a line, counted from 1, of the own file or of one of ``others``; empty beyond the end."""
        lines = self.others.get(file, ()) if file else self.lines
        return lines[number - 1] if 0 < number <= len(lines) else ""

    def file_of(self, path: Path) -> str:
        """The file in which that stands for which ``position`` gives the line; empty for the own file."""
        found = [mark.file for _, mark in self._walk(path)]
        return found[-1] if found else ""

    def position(self, path: Path, at_key: bool = False) -> tuple[int, int]:
        """Line and column of what stands at ``path``, both from 1; of its nearest ancestor where there is nothing.

        A str in the place of a list index picks the item of that name. With ``at_key`` the key counts, not its value;
        an ancestor is always found by its key, since that is where a reader would look for what is missing.
        """
        mark, found = self.marks, 0
        for _, child in self._walk(path):
            mark, found = child, found + 1
        if found == 0:
            return (1, 1) if path else (mark.line, mark.column)
        if at_key or found < len(path):
            return mark.key_line, mark.key_column
        return mark.line, mark.column

    def written(self, path: Path) -> str:
        """Return the number at ``path`` as it is spelled in the file, without tag and anchor; empty where no
        number is written there, such as at an alias."""
        line, column = self.position(path)
        found = _WRITTEN.match(self.line(line, self.file_of(path)), column - 1)
        return found[1] if found is not None else ""

    def has(self, path: Path) -> bool:
        """Whether something stands at ``path``."""
        return len(list(self._walk(path))) == len(path)

    def name_path(self, path: Path) -> str:
        """The path as a message shows it: ``procedures.preset.steps[3]``.
        A list item goes by its name where it has one, else it is counted from 1."""
        text = ""
        node: Any = self.data
        for step in self.original(path):
            if isinstance(node, list) and isinstance(step, int):
                node = node[step] if step < len(node) else None
                label = label_of(node)
                text += f".{label}" if label and _PLAIN_LABEL.fullmatch(label) else f"[{step + 1}]"
            else:
                node = node.get(step) if isinstance(node, dict) else None
                text += f".{step}"
        return text.removeprefix(".")

    def _walk(self, path: Path) -> Iterator[tuple[str | int, Mark]]:
        """Each step of the path that exists, with its mark."""
        mark = self.marks
        for step in self.original(path):
            child = mark.children.get(step)
            if child is None:
                return
            yield step, child
            mark = child

    def original(self, path: Path) -> Path:
        """The path in the data as read: names of items as indices, indices of pruned lists as original ones."""
        node: Any = self.data
        result: Path = ()
        for given in path:
            step = given
            if isinstance(node, list):
                if isinstance(given, int):
                    kept = self.kept.get(result)
                    step = given if kept is None or given >= len(kept) else kept[given]
                else:
                    step = next((index for index, item in enumerate(node) if label_of(item) == given), given)
                node = node[step] if isinstance(step, int) and 0 <= step < len(node) else None
            else:
                node = node.get(step) if isinstance(node, dict) else None
            result += (step,)
        return result


def label_of(item: Any) -> str | None:
    """By what an item of a list is called, if it has a name of some sort."""
    if not isinstance(item, dict):
        return None
    key = next((key for key in _ITEM_KEYS if key in item), None)
    return None if key is None or isinstance(item[key], (dict, list)) else str(item[key])
