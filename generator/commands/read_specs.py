"""The specs that a command reads: found from its arguments, and named in its output with their placeholders."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..say.numbers import counted, first_of

if TYPE_CHECKING:
    from ..language.problems import Report
    from .which_specs import Specs

_MOST_FILES = 8


def specs_to_judge(named: Sequence[Path], command: str) -> Specs:
    """Return the specs for a command that writes or judges, after a check of the targets in the settings.

    Raises:
        Stop: As for ``which_specs.specs_to_judge``, or there is no such target.
    """
    from . import which_specs
    from .settings_targets import refuse_unknown_targets

    specs = which_specs.specs_to_judge(named, command)
    refuse_unknown_targets(specs.settings)
    return specs


def specs_to_read(named: Sequence[Path]) -> Specs:
    """Return the specs for a command that only reads, after a check of the targets in the settings.

    Raises:
        Stop: As for ``which_specs.specs_to_read``, or there is no such target.
    """
    from . import which_specs
    from .settings_targets import refuse_unknown_targets

    specs = which_specs.specs_to_read(named)
    refuse_unknown_targets(specs.settings)
    return specs


def read_line(
    families: Iterable[str], report: Report, packaged: Sequence[str] = (), packaged_files: Sequence[Path] = ()
) -> str:
    """Return one line that names the specs that were read, so that users notice a forgotten path.

    ``packaged`` are the names given with ``--packaged``, and ``packaged_files`` the specs of these names.
    """
    skipped_files = [file for file in report.passed_over if file not in report.files]
    skipped = f"; skipped: {first_of(skipped_files, _MOST_FILES)}" if skipped_files else ""
    if not packaged:
        return f"read {counted(len(report.files), 'spec')}: {first_of(report.files, _MOST_FILES)}{skipped}"
    packaged_names = {path.stem for path in packaged_files}
    packaged_folders = {os.path.realpath(path.parent) for path in packaged_files}
    own_files = [file for file in report.files if os.path.dirname(os.path.realpath(file)) not in packaged_folders]
    own = f", and {counted(len(own_files), 'spec')} of yours: {first_of(own_files, _MOST_FILES)}" if own_files else ""
    read_names = ", ".join(name for name in families if name in packaged_names)
    return f"read the packaged specs of {', '.join(packaged)}: {read_names}{own}{skipped}"


# -- values that are still those of the template of ``new``


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
    from ..language.document import placeholder_name, placeholder_paths
    from ..language.problems import Report
    from ..language.read import read_document

    document = read_document(path, Report())
    if document is None:
        return
    paths = placeholder_paths(document.data)
    for line, column, place in sorted((*document.position(place), place) for place in paths):
        name = placeholder_name(document.data, place)
        yield Placeholder(file=document.file, line=line, column=column, name=name)


def placeholders_data(files: Iterable[str]) -> list[dict[str, Any]]:
    """Return the placeholders in these specs in the form that ``check --json`` prints."""
    return [asdict(placeholder) for placeholder in placeholders_in(files)]


def placeholder_lines(files: Iterable[str]) -> list[str]:
    """Return a line with the number of placeholders, and one for each. Empty if there are none."""
    places = [f"  {placeholder.file}:{placeholder.line}: {placeholder.name}" for placeholder in placeholders_in(files)]
    return [f"{_counted_placeholders(len(places))} (each has the word TODO):", *places] if places else []


def placeholder_line(files: Iterable[str]) -> str:
    """Return one line with the number of placeholders and the first one, or an empty text if there are none."""
    placeholders = list(placeholders_in(files))
    if not placeholders:
        return ""
    first = placeholders[0]
    number = _counted_placeholders(len(placeholders))
    return f"{number}, the first at {first.file}:{first.line}; codewheel check lists them"


def _counted_placeholders(number: int) -> str:
    return "1 value is still the template's" if number == 1 else f"{number} values are still the template's"
