"""Migration of specs to the current language: keys with a new name. Comments and layout stay as they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

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
    """Give the keys of a document their current names, and return the same edits for its text."""
    edits = []
    for path, new in renamed_keys(document):
        *parent, old = path
        holder = value_at(document.data, tuple(parent))
        line, column = document.position(path, at_key=True)
        if old not in holder:
            continue  # An alias repeats a map that has been migrated.
        edits.append(Edit(line, column, str(old), new))
        marks = document.mark(tuple(parent)).children
        for mapping in (holder, marks):
            old_items = list(mapping.items())
            mapping.clear()
            for key, value in old_items:
                mapping[new if key == old else key] = value
    return tuple(edits)


def edited(text: str, edits: Iterable[Edit]) -> str:
    """Return the text of a file after these edits. A key may be in quotes."""
    starts = [0, *(line_break.end() for line_break in LINE_BREAK.finditer(text))]
    for edit in sorted(edits, key=lambda edit: (edit.line, edit.column), reverse=True):
        start = text.index(edit.old, starts[edit.line - 1] + edit.column - 1)
        text = text[:start] + edit.new + text[start + len(edit.old) :]
    return text
