"""A spec as plain data, with the place of each value in its file, and the lines of the file as a terminal shows them.

Nothing is modified in place. To change a value, each map and list on its path is copied, together with the marks of its
place in the file. New values keep the marks of the file from which they come.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

#: Place in a spec: keys of maps, and for lists an index or the name of an item.
Path = tuple[str | int, ...]

#: Keys that name an item of a list. The first one present is used.
_ITEM_KEYS = ("name", "id", "revision", "contact")
_INTEGER_AS_WRITTEN = re.compile(r"(?:[&!]\S*\s+)*([-+]?[0-9][0-9A-Za-z]*)")
_PLAIN_LABEL = re.compile(r"[A-Za-z0-9_]+")


@dataclass(slots=True)
class SourceMark:
    """Start of a value and of its key, counted from 1, with the marks of its children. A list item is its own key.

    ``file`` is empty for values in the document's own file. Values from an overlay have another file.
    """

    line: int
    column: int
    key_line: int
    key_column: int
    children: dict[str | int, SourceMark] = field(default_factory=dict)
    file: str = ""


@dataclass
class Document:
    """A spec as read.

    ``data`` consists of dict, list, str, int, float, bool and None. ``broken`` lists the places that the reader has
    already reported. Their values are only stand-ins. ``doubtful`` lists places where something was omitted, such as a
    duplicate key. ``kept_indices`` is filled by the schema check: for a list that lost items, it contains the original
    index of each remaining item, so that paths into the pruned data still find their lines. ``other_files`` contains
    the lines of other files from which changes came. ``family`` is the name of a family derived from the family in the
    file, such as an older edition. It is empty for the family in the file.
    """

    file: str
    lines: tuple[str, ...]
    data: dict[str, Any]
    marks: SourceMark
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

    def line(self, line_number: int, file: str = "") -> str:
        """Return a line, counted from 1, of the document's file or of ``file``. Empty after the last line."""
        lines = self.other_files.get(file, ()) if file else self.lines
        return lines[line_number - 1] if 0 < line_number <= len(lines) else ""

    def file_of(self, path: Path) -> str:
        """Return the file to which the line from ``position`` belongs, or an empty string for the document's file."""
        marks = [mark for _, mark in self._walk_path(path)]
        return marks[-1].file if marks else ""

    def position(self, path: Path, at_key: bool = False) -> tuple[int, int]:
        """Return line and column, both from 1, of the value at ``path``, or of its nearest ancestor if there is none.

        A str instead of a list index selects the item of that name. With ``at_key``, the position is the position of
        the key. For an ancestor, it is always the position of the key, where a reader would look for a missing value.
        """
        marks = [mark for _, mark in self._walk_path(path)]  # Shorter than the path if the value is missing.
        if not path:
            return self.marks.line, self.marks.column
        if not marks:
            return 1, 1
        mark = marks[-1]
        if at_key or len(marks) < len(path):  # With fewer marks than steps, the last mark belongs to an ancestor.
            return mark.key_line, mark.key_column
        return mark.line, mark.column

    def spelling_at(self, path: Path) -> str:
        """Return the number at ``path`` as spelled in the file, such as ``0x0F`` or ``007``, without tag and anchor.

        The result is empty if no number is written there, such as at an alias.
        """
        line, column = self.position(path)
        number_match = _INTEGER_AS_WRITTEN.match(self.line(line, self.file_of(path)), column - 1)
        return number_match[1] if number_match is not None else ""

    def has(self, path: Path) -> bool:
        """Return True if there is a value at ``path``."""
        return len(list(self._walk_path(path))) == len(path)

    def mark(self, path: Path) -> SourceMark:
        """Return the mark of the value at ``path``, or of its nearest ancestor if there is none."""
        nearest_mark = self.marks
        for _, mark in self._walk_path(path):
            nearest_mark = mark
        return nearest_mark

    def name_path(self, path: Path) -> str:
        """Return the path as shown in messages: ``procedures.preset.steps[3]``.

        An element of a list is shown by its name, or by its number, counted from 1, if it has no plain name.
        """
        path_text = ""
        node: Any = self.data
        for step in self.path_in_file(path):
            child = child_at(node, step)
            if isinstance(node, list) and isinstance(step, int):
                label = label_of(child)
                has_plain_label = label is not None and _PLAIN_LABEL.fullmatch(label)
                path_text += f".{label}" if has_plain_label else f"[{step + 1}]"
            else:
                path_text += f".{step}"
            node = child
        return path_text.removeprefix(".")

    def _walk_path(self, path: Path) -> Iterator[tuple[str | int, SourceMark]]:
        """Yield each step of a path with the mark of its place in the file, up to the first missing step."""
        mark = self.marks
        for step in self.path_in_file(path):
            child = mark.children.get(step)
            if child is None:
                return
            yield step, child
            mark = child

    def path_in_file(self, path: Path) -> Path:
        """Return a path with the indices that the elements of lists have in the file.

        In ``path``, an element can be given by its name, or by its index after invalid elements were removed.
        """
        node: Any = self.data
        original_path: Path = ()
        for step in path:
            original_step = self._step_in_file(node, step, original_path)
            node = child_at(node, original_step)
            original_path += (original_step,)
        return original_path

    def _step_in_file(self, node: Any, step: str | int, original_path: Path) -> str | int:
        """Return one step of a path with the index that the element of a list has in the file.

        ``node`` is the list or map in the file at ``original_path``. ``step`` is the name of an element, or its index
        after invalid elements were removed. A key of a map and an unknown name are returned unchanged.
        """
        if not isinstance(node, list):
            return step
        if not isinstance(step, int):
            return self._index_of_label(node, step)
        original_indices = self.kept_indices.get(original_path)
        if original_indices is None or step >= len(original_indices):
            return step
        return original_indices[step]

    def _index_of_label(self, node: list[Any], label: str) -> str | int:
        """Return the index of the first item of a list with this label, or the label if there is none."""
        if id(node) not in self._indices:
            first_index_by_label: dict[str, int] = {}
            for index, list_item in enumerate(node):
                item_label = label_of(list_item)
                if item_label is not None:
                    first_index_by_label.setdefault(item_label, index)
            self._indices[id(node)] = first_index_by_label
        return self._indices[id(node)].get(label, label)


def child_at(node: Any, step: str | int) -> Any:
    """Return the value at a key of a map or at an index of a list, or None if there is none."""
    if isinstance(node, list):
        return node[step] if isinstance(step, int) and 0 <= step < len(node) else None
    return node.get(step) if isinstance(node, dict) else None


def label_of(list_item: Any) -> str | None:
    """Return the value that identifies an element of a list, such as its name, or None if it has none.

    It is the value under the first key of ``_ITEM_KEYS`` that the element has.
    """
    if not isinstance(list_item, dict):
        return None
    for key in _ITEM_KEYS:
        if key in list_item:
            return None if isinstance(list_item[key], (dict, list)) else str(list_item[key])
    return None


_PATH_STEP = re.compile(r"\[([0-9]+)\]|\.?([^.\[\]]+)")

#: Function from a map or list to its replacement.
_Edit = Callable[[Any, SourceMark], tuple[Any, SourceMark]]


class MissingPath(LookupError):
    """No value at a path. ``existing_path`` leads to the last value that exists, which has no ``step``.

    ``known_steps`` are the keys and labels that it has.
    """

    def __init__(self, step: str, known_steps: list[str], existing_path: Path) -> None:
        super().__init__(step)
        self.step = step
        self.known_steps = known_steps
        self.existing_path = existing_path


def steps_of(path_text: str) -> tuple[str | int, ...]:
    """Split ``procedures.preset.steps[3]`` into keys, names and indices counted from 0."""
    return tuple(_step_of(match) for match in _PATH_STEP.finditer(path_text))


def _step_of(match: re.Match[str]) -> str | int:
    """Return a step of a path from its text: an index from 0 for a number in brackets, or else the word."""
    number, word = match.groups()
    return int(number) - 1 if number else str(word)


def resolve(root: Any, path_text: str) -> Path:
    """Return the path for a place given as text, with an index for each element of a list.

    ``procedures.preset.steps[3]`` may result in ``("procedures", 0, "steps", 2)``.

    Raises:
        MissingPath: A step does not exist.
    """
    path: Path = ()
    node = root
    for step in steps_of(path_text):
        key_by_step = _possible_steps(node)
        if step not in key_by_step:
            step_text = f"[{step + 1}]" if isinstance(step, int) else step
            known_steps = [known_step for known_step in key_by_step if isinstance(known_step, str)]
            raise MissingPath(step_text, known_steps, path)
        key = key_by_step[step]
        path = (*path, key)
        node = node[key]
    return path


def _possible_steps(node: Any) -> dict[str | int, str | int]:
    """Return the possible next steps of a path, each with its key or index: ``{0: 0, "preset": 0}`` for a list.

    An element of a list can be given by its index, or by its name. If several elements have a name, it is the first.
    """
    if isinstance(node, dict):
        return {key: key for key in node}
    if not isinstance(node, list):
        return {}
    key_by_step: dict[str | int, str | int] = {index: index for index in range(len(node))}
    for index, child in enumerate(node):
        label = label_of(child)
        if label:
            key_by_step.setdefault(label, index)
    return key_by_step


def named_path(root: Any, path: Path) -> Path:
    """Return a path in which elements of lists are given by their names instead of their indices.

    An element without a name keeps its index. The last step need not exist yet.
    """
    named_steps: Path = ()
    node = root
    for step in path:
        child: Any = node[step] if isinstance(step, int) or step in node else None
        label = label_of(child) if isinstance(step, int) else None
        named_steps += (label or step,)
        node = child
    return named_steps


def value_at(root: Any, path: Path) -> Any:
    """Return the value at an existing path."""
    for step in path:
        root = root[step]
    return root


def mark_at(mark: SourceMark, path: Path) -> SourceMark:
    """Return the mark of the value at an existing path."""
    for step in path:
        mark = mark.children[step]
    return mark


def from_file(mark: SourceMark, file: str) -> SourceMark:
    """Return the mark and its children, assigned to another file."""
    children = {key: from_file(child, file) for key, child in mark.children.items()}
    return replace(mark, children=children, file=file)


def with_value(root: Any, marks: SourceMark, path: Path, value: Any, mark: SourceMark) -> tuple[Any, SourceMark]:
    """Return copies of data and marks in which the value at ``path`` is ``value``, which has ``mark``.

    The value can replace another one, or be at a new key, or at the end of a list.
    """
    key = path[-1]

    def put_value(parent: Any, parent_mark: SourceMark) -> tuple[Any, SourceMark]:
        new_parent = copy(parent)
        if isinstance(parent, list) and key == len(parent):
            new_parent.append(value)
        else:
            new_parent[key] = value
        return new_parent, replace(parent_mark, children={**parent_mark.children, key: mark})

    return _with_edited_parent(root, marks, path[:-1], put_value)


def without_value(root: Any, marks: SourceMark, path: Path) -> tuple[Any, SourceMark]:
    """Return copies of data and marks without the value at ``path``. Later elements of its list get lower indices."""
    key = path[-1]

    def remove_value(parent: Any, parent_mark: SourceMark) -> tuple[Any, SourceMark]:
        if isinstance(parent, dict):
            return _without_key(parent, parent_mark, key)
        return _without_item(parent, parent_mark, key)

    return _with_edited_parent(root, marks, path[:-1], remove_value)


def _without_key(
    mapping: dict[str, Any], mark: SourceMark, removed_key: str | int
) -> tuple[dict[str, Any], SourceMark]:
    """Return a map and its mark without one of its keys."""
    remaining = {key: value for key, value in mapping.items() if key != removed_key}
    remaining_marks = {key: child_mark for key, child_mark in mark.children.items() if key != removed_key}
    return remaining, replace(mark, children=remaining_marks)


def _without_item(items: list[Any], mark: SourceMark, removed_index: str | int) -> tuple[list[Any], SourceMark]:
    """Return a list and its mark without one of its items. The marks of later items move to their new indices."""
    remaining: list[Any] = []
    remaining_marks: dict[str | int, SourceMark] = {}
    for index, list_item in enumerate(items):
        if index == removed_index:
            continue
        if index in mark.children:
            remaining_marks[len(remaining)] = mark.children[index]
        remaining.append(list_item)
    return remaining, replace(mark, children=remaining_marks)


def _with_edited_parent(root: Any, mark: SourceMark, parent_path: Path, edit: _Edit) -> tuple[Any, SourceMark]:
    """Return copies of data and marks in which ``edit`` has replaced the map or list at ``parent_path``.

    ``edit`` is called with the map or list and its mark, and returns both.
    """
    if not parent_path:
        return edit(root, mark)
    key = parent_path[0]
    new_child, new_child_mark = _with_edited_parent(root[key], mark.children[key], parent_path[1:], edit)
    new_root = copy(root)
    new_root[key] = new_child
    return new_root, replace(mark, children={**mark.children, key: new_child_mark})


def excerpt(line_text: str, column: int, width: int = 80) -> list[str]:
    """Return two lines: the part of a line around a column, and a caret below the column. Empty for a blank line."""
    if not line_text.strip():
        return []
    window, caret = _visible_part(line_text, column, max(width, 20) - 4)
    return [f"    {window}", f"    {' ' * caret}^"]


def visible(text: str) -> str:
    """Return a text in which every character that controls a terminal is replaced by an escape such as ``\\x1b``."""
    return "".join(map(_visible_character, text))


def _visible_character(character: str) -> str:
    """Return a character, or an escape such as ``\\x1b`` if it controls the terminal."""
    if unicodedata.category(character) not in ("Cc", "Cf", "Cs", "Zl", "Zp"):
        return character
    if character == "\t":
        return "\\t"
    code_point = ord(character)
    if code_point < 0x100:
        return f"\\x{code_point:02x}"
    return f"\\u{code_point:04x}" if code_point < 0x10000 else f"\\U{code_point:08x}"


def _measure_columns(text: str) -> int:
    """Return the width of a text in a terminal: two columns for a wide character, none for a combining one."""
    wide_count = sum(unicodedata.east_asian_width(character) in "WF" for character in text)
    combining_count = sum(unicodedata.combining(character) != 0 for character in text)
    return len(text) + wide_count - combining_count


def _visible_part(line_text: str, column: int, width: int) -> tuple[str, int]:
    """Return the part of a line to show, without its indentation, and the offset of the caret in it, in columns.

    A line with more than ``width`` columns is cut so that the caret is visible, with more text before it than after.
    """
    indentation = len(line_text) - len(line_text.lstrip(" "))
    stripped_line = line_text.strip(" ")
    caret_index = max(0, min(column - 1 - indentation, len(stripped_line)))
    # Each character takes at least one column, so nothing farther away can be shown. A line may have millions.
    start = max(0, caret_index - width)
    end = caret_index + width + 1
    characters_before = [_visible_character(character) for character in stripped_line[start:caret_index]]
    characters_after = [_visible_character(character) for character in stripped_line[caret_index:end]]
    is_too_long = start > 0 or _measure_columns("".join(characters_before + characters_after)) > width
    if is_too_long:
        width_before_caret = width * 2 // 3
        characters_before = _cut_at_start(characters_before, width_before_caret, is_cut_already=start > 0)
        remaining_width = width - _measure_columns("".join(characters_before))
        characters_after = _cut_at_end(characters_after, remaining_width)
    text_before = "".join(characters_before)
    text_after = "".join(characters_after)
    return text_before + text_after, _measure_columns(text_before)


def _cut_at_start(characters: list[str], width: int, *, is_cut_already: bool) -> list[str]:
    """Return the last characters that fit in ``width`` columns, after three dots if any were omitted, now or before."""
    fitting_count = _count_fitting(characters[::-1], width)
    if not is_cut_already and fitting_count == len(characters):
        return characters
    return ["...", *characters[len(characters) - fitting_count :]]


def _cut_at_end(characters: list[str], width: int) -> list[str]:
    """Return the characters if they fit in ``width`` columns, otherwise as many as fit before three dots."""
    if _measure_columns("".join(characters)) <= width:
        return characters
    return [*characters[: _count_fitting(characters, width - 3)], "..."]


def _count_fitting(characters: Sequence[str], width: int) -> int:
    """Return the number of characters at the beginning that fit in ``width`` columns."""
    used_columns = 0
    for count, character in enumerate(characters):
        used_columns += _measure_columns(character)
        if used_columns > width:
            return count
    return len(characters)
