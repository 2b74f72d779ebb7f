"""``codewheel migrate``: update specs to the current language, and list what only a person can decide."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ..language.files import find_files, is_folder
from ..language.migrate import edited, migrate
from ..language.problems import Report
from ..language.read import read_document
from ..language.second_reading import second_reading_path
from ..say.numbers import counted
from . import check
from .outputs import targets_named
from .terminal import Stop


def run(paths: Sequence[Path], only_check: bool) -> int:
    """Migrate specs with their second readings, print each change and each decision, and return the exit code.

    Raises:
        Stop: A file cannot be written.
    """
    changes = sum(_migrate(path, only_check) for path in _files(paths))
    if only_check:
        print(f"{counted(changes, 'change')} to apply")
        return 1 if changes else 0
    problems = check.run(paths, targets_named()).report.problems
    for problem in problems:
        print(problem.format())
    decisions = f"{counted(len(problems), 'place')} to decide by hand" if problems else "nothing to decide"
    print(f"{counted(changes, 'change')} applied, {decisions}")
    return 1 if problems else 0


def _files(paths: Iterable[Path]) -> Iterator[Path]:
    for spec_path in paths:
        for spec in find_files(spec_path).specs if is_folder(spec_path) else (spec_path,):
            yield from (path for path in (spec, second_reading_path(spec)) if path == spec or path.is_file())


def _migrate(path: Path, only_check: bool) -> int:
    """Print and apply the changes to one file, and return their number."""
    document = read_document(path, Report())
    edits = migrate(document) if document is not None else ()
    for edit in edits:
        print(f"{path}:{edit.line}:{edit.column}: {edit.old} is now {edit.new}")
    if edits and not only_check:
        content = path.read_bytes()
        mark = b"\xef\xbb\xbf" if content.startswith(b"\xef\xbb\xbf") else b""
        text = edited(content[len(mark) :].decode("utf-8"), edits)
        place = path.resolve()
        new = place.with_name(f".{place.name}.new")
        try:
            new.write_bytes(mark + text.encode("utf-8"))
            shutil.copymode(place, new)
            new.replace(place)
        except OSError as error:
            raise Stop(f"cannot write {path}: {error.strerror or error}", 1) from None
    return len(edits)
