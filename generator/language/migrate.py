"""Migration of specs to the current language: keys with a new name. Comments and layout stay as they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from .document import Document
from .read import LINE_BREAK
from .schema_check import renamed_keys, value_at


@dataclass(frozen=True, slots=True)
class Edit:
    """A key with a new name, at a line and a column that count from 1."""

    line: int
    column: int
    old: str
    new: str


def migrate(document: Document) -> tuple[Edit, ...]:
    """Rename keys of a document from earlier versions of the spec language, and return the edits for its text.

    The data and the marks of the document are changed in place.
    """
    edits = []
    for path, new_key in renamed_keys(document):
        *steps_to_parent, old_key = path
        parent_path = tuple(steps_to_parent)
        mapping = value_at(document.data, parent_path)
        line, column = document.position(path, at_key=True)
        if old_key not in mapping:
            continue  # An alias repeats a map that has been migrated.
        edits.append(Edit(line=line, column=column, old=str(old_key), new=new_key))
        _rename_key(mapping, old_key, new_key)
        _rename_key(document.mark(parent_path).children, old_key, new_key)
    return tuple(edits)


def _rename_key(mapping: dict[Any, Any], old_key: str | int, new_key: str) -> None:
    """Rename a key of a map, in place, without changing the order of its entries."""
    renamed = {new_key if key == old_key else key: value for key, value in mapping.items()}
    mapping.clear()
    mapping.update(renamed)


def edited(spec_text: str, edits: Iterable[Edit]) -> str:
    """Return the text of a spec after these edits."""
    line_starts = [0, *(line_break.end() for line_break in LINE_BREAK.finditer(spec_text))]
    # The last edit first, so that the positions of the others stay valid.
    for edit in sorted(edits, key=lambda edit: (edit.line, edit.column), reverse=True):
        position = line_starts[edit.line - 1] + edit.column - 1  # Lines and columns count from 1.
        key_start = spec_text.index(edit.old, position)  # A key may be in quotes.
        key_end = key_start + len(edit.old)
        spec_text = spec_text[:key_start] + edit.new + spec_text[key_end:]
    return spec_text
