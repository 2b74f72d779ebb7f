"""A spec as read: plain data, and the place of each value in the file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

#: Place in a spec: keys of maps, and for lists an index or the name of an item.
Path = tuple[str | int, ...]

#: Keys that name an item of a list. The first one present is used.
_ITEM_KEYS = ("name", "id", "revision", "contact")
_WRITTEN = re.compile(r"(?:[&!]\S*\s+)*([-+]?[0-9][0-9A-Za-z]*)")
_PLAIN_LABEL = re.compile(r"[A-Za-z0-9_]+")


@dataclass(slots=True)
class Mark:
    """Start of a value and of its key, counted from 1, with the marks of its children. A list item is its own key.

    ``file`` is empty for values in the document's own file. Values from an overlay have another file.
    """

    line: int
    column: int
    key_line: int
    key_column: int
    children: dict[str | int, Mark] = field(default_factory=dict)
    file: str = ""


@dataclass
class Document:
    """A spec as read.

    ``data`` consists of dict, list, str, int, float, bool and None. ``broken`` lists the places that the reader has
    already reported. Their values are only stand-ins. ``doubtful`` lists places where something was omitted, such as a
    duplicate key. ``kept_indices`` is filled by the schema check: for a list that lost items, it contains the original
    index of each remaining item, so that paths into the pruned data still find their lines. ``other_files`` contains
    the lines of other files from which changes came. ``family`` is the name of a family derived from the one in the
    file, such as an older edition. It is empty for the family in the file.
    """

    file: str
    lines: tuple[str, ...]
    data: dict[str, Any]
    marks: Mark
    broken: tuple[Path, ...] = ()
    doubtful: tuple[Path, ...] = ()
    kept_indices: dict[Path, tuple[int, ...]] = field(default_factory=dict)
    other_files: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    family: str = ""
    _indices: dict[int, dict[str, int]] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def key(self) -> str:
        """Key that identifies the document, also among those derived from the same file."""
        return f"{self.file}\0{self.family}" if self.family else self.file

    def line(self, number: int, file: str = "") -> str:
        """Return a line, counted from 1, of the document's file or of one of the others. Empty after the last line."""
        lines = self.other_files.get(file, ()) if file else self.lines
        return lines[number - 1] if 0 < number <= len(lines) else ""

    def file_of(self, path: Path) -> str:
        """Return the file to which the line from ``position`` belongs, or an empty string for the document's file."""
        files = [mark.file for _, mark in self._walk(path)]
        return files[-1] if files else ""

    def position(self, path: Path, at_key: bool = False) -> tuple[int, int]:
        """Return line and column, both from 1, of the value at ``path``, or of its nearest ancestor if there is none.

        A str instead of a list index selects the item of that name. With ``at_key``, the position is that of the key.
        The position of an ancestor is always that of its key, where a reader would look for a missing value.
        """
        marks = [mark for _, mark in self._walk(path)]
        if not path:
            return self.marks.line, self.marks.column
        if not marks:
            return 1, 1
        mark = marks[-1]
        if at_key or len(marks) < len(path):
            return mark.key_line, mark.key_column
        return mark.line, mark.column

    def spelling_at(self, path: Path) -> str:
        """Return the number at ``path`` as spelled in the file, without tag and anchor.

        The result is empty if no number is written there, such as at an alias.
        """
        line, column = self.position(path)
        number = _WRITTEN.match(self.line(line, self.file_of(path)), column - 1)
        return number[1] if number is not None else ""

    def has(self, path: Path) -> bool:
        """Return True if there is a value at ``path``."""
        return len(list(self._walk(path))) == len(path)

    def mark(self, path: Path) -> Mark:
        """Return the mark of the value at ``path``, or of its nearest ancestor if there is none."""
        return next((mark for _, mark in reversed(list(self._walk(path)))), self.marks)

    def name_path(self, path: Path) -> str:
        """Return the path as shown in messages: ``procedures.preset.steps[3]``.

        A list item is shown by its name, or by its number from 1 if it has none.
        """
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
        """Yield each existing step of the path with its mark."""
        mark = self.marks
        for step in self.original(path):
            child = mark.children.get(step)
            if child is None:
                return
            yield step, child
            mark = child

    def original(self, path: Path) -> Path:
        """Return the path in the data as read, with indices for names and original indices for pruned lists."""
        node: Any = self.data
        original_path: Path = ()
        for asked_step in path:
            step = asked_step
            if isinstance(node, list):
                if isinstance(asked_step, int):
                    original_indices = self.kept_indices.get(original_path)
                    step = (
                        asked_step
                        if original_indices is None or asked_step >= len(original_indices)
                        else original_indices[asked_step]
                    )
                else:
                    step = self._index(node, asked_step)
                node = node[step] if isinstance(step, int) and 0 <= step < len(node) else None
            else:
                node = node.get(step) if isinstance(node, dict) else None
            original_path += (step,)
        return original_path

    def _index(self, node: list[Any], label: str) -> str | int:
        """Return the index of the first item of a list with this label, or the label if there is none."""
        index_by_label = self._indices.get(id(node))
        if index_by_label is None:
            labels = ((label_of(node_item), index) for index, node_item in reversed(list(enumerate(node))))
            index_by_label = self._indices[id(node)] = {label: index for label, index in labels if label is not None}
        return index_by_label.get(label, label)


def label_of(value: Any) -> str | None:
    """Return the label of a list item, or None if it has none."""
    if not isinstance(value, dict):
        return None
    for key in _ITEM_KEYS:
        if key in value:
            return None if isinstance(value[key], (dict, list)) else str(value[key])
    return None
