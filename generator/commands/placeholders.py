"""Notice of ``check`` and ``generate`` about values that are still those of the template of ``new``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..language.placeholders import placeholder_name, placeholder_paths
from ..language.problems import Report
from ..language.read import read_document


@dataclass(frozen=True, slots=True)
class Placeholder:
    """A value that is still the template's. ``name`` is that of the fact in its spec."""

    file: str
    line: int
    column: int
    name: str


def placeholders_in(files: Iterable[str]) -> Iterator[Placeholder]:
    """Yield the placeholders in these specs, in the order of their lines."""
    for file in dict.fromkeys(files):
        path = Path(file)
        if path.is_file() and b"TODO" in path.read_bytes():
            yield from _placeholders_of(path)


def _placeholders_of(path: Path) -> Iterator[Placeholder]:
    document = read_document(path, Report())
    if document is None:
        return
    paths = placeholder_paths(document.data)
    for line, column, place in sorted((*document.position(place), place) for place in paths):
        yield Placeholder(document.file, line, column, placeholder_name(document.data, place))


def as_data(files: Iterable[str]) -> list[dict[str, Any]]:
    """Return the placeholders in these specs in the form that ``check --json`` prints."""
    return [asdict(placeholder) for placeholder in placeholders_in(files)]


def notice(files: Iterable[str]) -> list[str]:
    """Return a line with the number of placeholders, and one for each. Empty if there are none."""
    places = [f"  {placeholder.file}:{placeholder.line}: {placeholder.name}" for placeholder in placeholders_in(files)]
    return [f"{_counted(len(places))} (each has the word TODO):", *places] if places else []


def short_notice(files: Iterable[str]) -> str:
    """Return one line with the number of placeholders and the first one, or an empty text if there are none."""
    todos = list(placeholders_in(files))
    if not todos:
        return ""
    return f"{_counted(len(todos))}, the first at {todos[0].file}:{todos[0].line}; codewheel check lists them"


def _counted(number: int) -> str:
    return "1 value is still the template's" if number == 1 else f"{number} values are still the template's"
