"""Find values in specs that still come from the template of ``codewheel new``: they contain the word TODO."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, slots=True)
class Placeholder:
    """A value that still comes from the template. ``name`` is the name of the fact in its spec."""

    file: str
    line: int
    column: int
    name: str


def placeholders_in(files: Iterable[str]) -> Iterator[Placeholder]:
    """Yield the placeholders in these specs, spec by spec in the order of their lines. A repeated file counts once."""
    for file in dict.fromkeys(files):
        path = Path(file)
        if path.is_file() and b"TODO" in path.read_bytes():
            yield from _placeholders_of(path)


def _placeholders_of(path: Path) -> Iterator[Placeholder]:
    """Yield the placeholders in a spec. A file that cannot be read contains none."""
    from ..language.problems import ProblemReport
    from ..language.read import read_document
    from ..language.rules.walk import placeholder_name, placeholder_paths

    document = read_document(path, ProblemReport())
    if document is None:
        return
    placeholders = []
    for path_in_spec in placeholder_paths(document.data):
        line, column = document.position(path_in_spec)
        name = placeholder_name(document.data, path_in_spec)
        placeholders.append(Placeholder(file=document.file, line=line, column=column, name=name))
    yield from sorted(placeholders, key=lambda placeholder: (placeholder.line, placeholder.column))


def placeholders_data(files: Iterable[str]) -> list[dict[str, Any]]:
    """Return the placeholders in these specs in the form that ``check --json`` prints."""
    return [asdict(placeholder) for placeholder in placeholders_in(files)]


def placeholder_lines(files: Iterable[str]) -> list[str]:
    """Return a line with the number of placeholders, and one for each. Empty if there are none."""
    lines = [f"  {placeholder.file}:{placeholder.line}: {placeholder.name}" for placeholder in placeholders_in(files)]
    if not lines:
        return []
    return [f"{_counted_placeholders(len(lines))} (each has the word TODO):", *lines]


def placeholder_line(files: Iterable[str]) -> str:
    """Return one line with the number of placeholders and the first one, or an empty string if there are none."""
    placeholders = list(placeholders_in(files))
    if not placeholders:
        return ""
    first_placeholder = placeholders[0]
    place = f"{first_placeholder.file}:{first_placeholder.line}"
    count_text = _counted_placeholders(len(placeholders))
    return f"{count_text}, the first at {place}; codewheel check lists them"


def _counted_placeholders(number: int) -> str:
    return "1 value is still from the template" if number == 1 else f"{number} values are still from the template"
