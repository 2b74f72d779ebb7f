"""Lines about the specs that a command reads: their names, and values that still come from a template.

The templates of ``codewheel new`` have the word TODO in such values.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..say import count_with_unit, first_of

if TYPE_CHECKING:
    from ..language.problems import ProblemReport


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


#: Highest number of files in the line about the specs that were read. The others are counted.
_MAX_FILES = 8


def read_line(
    families: Iterable[str], report: ProblemReport, packaged: Sequence[str] = (), packaged_files: Sequence[Path] = ()
) -> str:
    """Return a line that names the specs that were read, so that users notice a forgotten path.

    ``packaged`` are the names given with ``--packaged``, and ``packaged_files`` are the specs that they refer to.
    """
    # A file that was skipped in a folder may have been read because the user named it.
    skipped_files = [file for file in report.passed_over if file not in report.files]
    skipped_text = f"; skipped: {first_of(skipped_files, _MAX_FILES)}" if skipped_files else ""
    if packaged:
        packaged_text = _packaged_text(families, report, packaged, packaged_files)
        return f"{packaged_text}{skipped_text}"
    number_of_specs = count_with_unit(len(report.files), "spec")
    listed_files = first_of(report.files, _MAX_FILES)
    return f"read {number_of_specs}: {listed_files}{skipped_text}"


def _packaged_text(
    families: Iterable[str], report: ProblemReport, packaged: Sequence[str], packaged_files: Sequence[Path]
) -> str:
    """Return a text on the packaged families and the user's specs that were read.

    ``packaged`` are the names of families or manufacturers on the command line. Files outside the folders of
    ``packaged_files`` are the user's.
    """
    # A file is named after its family.
    packaged_families_found = {path.stem for path in packaged_files}
    families_read = ", ".join(name for name in families if name in packaged_families_found)
    beginning = f"read the packaged specs of {', '.join(packaged)}: {families_read}"
    packaged_folders = {os.path.realpath(path.parent) for path in packaged_files}
    user_files = [file for file in report.files if os.path.dirname(os.path.realpath(file)) not in packaged_folders]
    if not user_files:
        return beginning
    number_of_files = count_with_unit(len(user_files), "spec")
    return f"{beginning}, and {number_of_files} of yours: {first_of(user_files, _MAX_FILES)}"
