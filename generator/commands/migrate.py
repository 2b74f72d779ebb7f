"""``codewheel migrate``: update specs to the current version of the spec language.

What cannot be updated automatically is listed for the user.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..say import count_with_unit
from .cli import Parser, add_specs_argument
from .terminal import CommandError

if TYPE_CHECKING:
    import argparse

    from ..language.schema_check import Edit

EXAMPLES = ("codewheel migrate my_encoder.yaml", "codewheel migrate --check my_encoder.yaml")
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Apply renamed keys to specs, keep comments and layout, and list what only a person can decide."
    )
    add_specs_argument(parser)
    parser.add_argument("--check", action="store_true", help="list what would change, and write nothing")


def run(arguments: argparse.Namespace) -> int:
    """Migrate specs with their second readings, print each change, and return the exit code.

    Then print what only a person can decide. With ``--check``, only count the changes. The exit code is 1 if there are
    decisions or, with ``--check``, changes.

    Raises:
        CommandError: There are no specs, or a file cannot be written.
    """
    from .read_specs import specs_to_judge

    paths = specs_to_judge(arguments.specs, "migrate").paths
    change_count = 0
    for path in _specs_and_second_readings(paths):
        change_count += _migrate_file(path, only_check=arguments.check)
    if arguments.check:
        print(f"{count_with_unit(change_count, 'change')} to apply")
        return 1 if change_count else 0
    return _print_decisions(paths, change_count)


def _print_decisions(paths: Sequence[Path], changes: int) -> int:
    """Print the remaining problems, which only a person can decide, and return the exit code: 1 if there are any.

    ``changes`` is the number of changes that were made.
    """
    from .check.specs import check_specs
    from .outputs import targets_named

    problems = check_specs(paths, targets_named()).report.problems
    for problem in problems:
        print(problem.format())
    decisions = "nothing to decide"
    if problems:
        decisions = f"{count_with_unit(len(problems), 'place')} to decide by hand"
    print(f"{count_with_unit(changes, 'change')} applied, {decisions}")
    return 1 if problems else 0


def _specs_and_second_readings(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield the specs, each followed by its second reading if it has one."""
    from ..language.files import find_files, is_folder, second_reading_path

    for path in paths:
        specs = find_files(path).specs if is_folder(path) else (path,)
        for spec in specs:
            yield spec
            second_path = second_reading_path(spec)
            if second_path.is_file():
                yield second_path


def _migrate_file(path: Path, *, only_check: bool) -> int:
    """Print the changes to one file, apply them unless ``only_check`` is set, and return their number.

    A file that cannot be read has no changes.
    """
    from ..language.problems import ProblemReport
    from ..language.read import read_document
    from ..language.schema_check import migrate

    document = read_document(path, ProblemReport())
    edits = migrate(document) if document is not None else ()
    for edit in edits:
        print(f"{path}:{edit.line}:{edit.column}: {edit.old} is now {edit.new}")
    if edits and not only_check:
        _apply_edits(edits, path)
    return len(edits)


def _apply_edits(edits: Sequence[Edit], path: Path) -> None:
    """Write a new file with the changes next to the old one, and rename it.

    The byte order mark and the mode of the file are kept.

    Raises:
        CommandError: It cannot be written. The exit code is 1.
    """
    from ..language.schema_check import edited

    content = path.read_bytes()
    mark = _BYTE_ORDER_MARK if content.startswith(_BYTE_ORDER_MARK) else b""
    edited_text = edited(content.removeprefix(mark).decode("utf-8"), edits)
    real_path = path.resolve()
    new_path = real_path.with_name(f".{real_path.name}.new")
    try:
        new_path.write_bytes(mark + edited_text.encode("utf-8"))
        shutil.copymode(real_path, new_path)
        new_path.replace(real_path)
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror or error}", 1) from None
