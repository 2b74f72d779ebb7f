"""``codewheel diff``: list the changes between two versions of specs, with their impact on users."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache import Cache
from ..changes.impact import IMPACTS, Impact
from .arguments import FORMATS, FORMATS_HELP, Parser, a_path, add_cache_option
from .terminal import Stop, refuse_missing

if TYPE_CHECKING:
    from ..changes.change import Change
    from ..changes.report import DiffResult, Files
    from ..language.problems import Problem
    from ..loading.library import Family
    from ..model import Device

_MOST_SHOWN = 3
#: Return the generated files that differ between old and new devices, or None if nothing can be generated.
Generate = Callable[["Sequence[Device]", "Sequence[Device]"], "Files | None"]


def add_diff(parser: Parser) -> None:
    """Add the command to the command line."""
    parser.description = "List each change with the outputs and order codes that it affects. Exit 1 if there are any."
    where = "a file, a folder, or either in a git revision, such as v1.0:specs/lika"
    parser.add_argument("old", metavar="OLD", help=f"the old specs: {where}")
    parser.add_argument("new", metavar="NEW", help="the new specs, given in the same way")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON")
    form.add_argument("--markdown", action="store_true", help="print a section of a changelog")
    form.add_argument("--format", choices=FORMATS, default="text", help=FORMATS_HELP)
    parser.add_argument(
        "--fail-on",
        metavar="IMPACT",
        choices=IMPACTS,
        help=f"exit 1 only for changes of at least this impact: {', '.join(IMPACTS)} (default: any change)",
    )
    parser.add_argument(
        "--record",
        action="store_true",
        help="save the changes next to the specs of NEW, and the next version in the manufacturer's file",
    )
    parser.add_argument(
        "--unchecked",
        action="store_true",
        help="with --record: record even if second readings disagree or coverage is out of date",
    )
    parser.add_argument(
        "--editions",
        action="store_true",
        help="also print the 'editions' entry for items that a new edition of the manual removed",
    )
    parser.add_argument(
        "--accepted",
        type=a_path,
        metavar="FILE",
        help="changes that do not count for the exit code (default: accepted.yaml next to the specs of NEW)",
    )
    parser.add_argument(
        "--lenient",
        action="store_true",
        help="compare specs even if the current spec language finds problems, without the faulty parts",
    )
    add_cache_option(parser)


@dataclass(frozen=True)
class _Side:
    """One side of the comparison: the families that were read, and the names of those that could not be.

    ``names`` has the original names of files from a git revision.
    """

    families: tuple[Family, ...]
    left_out: frozenset[str]
    notices: tuple[str, ...]
    names: Mapping[str, str]


def run(chosen: argparse.Namespace, generate: Generate, gate: Callable[[Sequence[Family]], None], cache: Cache) -> int:
    """Compare, print, and return the exit code.

    ``gate`` raises ``Stop`` to refuse recording families that must not be released.

    Raises:
        Stop: Something cannot be read.
    """
    if chosen.record and not Path(chosen.new).is_dir():
        raise Stop("--record needs a folder of specs: all families of a manufacturer share a version", 2)
    before = _side(chosen.old, True, cache, chosen.lenient)
    after = _side(chosen.new, False, cache, chosen.lenient)
    comparison = _look(before, after, generate)
    if chosen.record:
        if not chosen.unchecked:
            gate(after.families)
        comparison = _record(comparison, after)
    relevant_changes, notices = _accept(comparison.changes, chosen)
    comparison = replace(comparison, notices=(*comparison.notices, *notices))
    if chosen.format in ("github", "sarif"):
        from .diff_places import findings
        from .formats import as_review

        print(as_review(findings(relevant_changes, after.families, after.names), chosen.format))
    elif chosen.json or chosen.format == "json":
        from ..changes.report import as_data

        print(json.dumps(as_data(comparison), indent=2, ensure_ascii=False))
    elif chosen.markdown:
        from ..changes.report_markdown import as_markdown

        print(as_markdown(comparison))
    else:
        from ..changes.report_text import as_text

        print(as_text(comparison))
        for offer in _offers(before, after, comparison.changes) if chosen.editions else ():
            print(f"\n{offer}")
    least = Impact[chosen.fail_on.upper()] if chosen.fail_on else Impact.DOCUMENTATION
    return 1 if max((change.impact for change in relevant_changes), default=Impact.NONE) >= least else 0


def _offers(before: _Side, after: _Side, changes: Sequence[Change]) -> Iterator[str]:
    from .edition_entry import edition_entries

    return edition_entries(before.families, after.families, changes)


def _accept(changes: Sequence[Change], chosen: argparse.Namespace) -> tuple[Sequence[Change], Sequence[str]]:
    """Return the changes that count, and the notices about accepted ones.

    Raises:
        Stop: The file with accepted changes is missing or not valid. The exit code is 2.
    """
    from ..changes.accepted import NAME, NotAccepted, read_accepted, still_open

    new = Path(chosen.new)
    place = chosen.accepted or (new if new.is_dir() else new.parent) / NAME
    if chosen.accepted is None and not place.is_file():
        return changes, ()
    try:
        return still_open(changes, read_accepted(place), datetime.now().astimezone().date())
    except NotAccepted as error:
        raise Stop(str(error), 2) from None


def _look(before: _Side, after: _Side, generate: Generate) -> DiffResult:
    """Return the changes."""
    from ..changes.families import compare
    from ..changes.report import DiffResult
    from ..changes.version import packages

    left_out = before.left_out | after.left_out
    olds, news = (
        tuple(family.device for family in side.families if family.device.name not in left_out)
        for side in (before, after)
    )
    changes = compare(olds, news)
    files = generate(olds, news) if changes else None
    return DiffResult(changes, packages(olds, news, changes), files, (*before.notices, *after.notices))


def _record(comparison: DiffResult, after: _Side) -> DiffResult:
    """Write the records, and return ``comparison`` with notices about them and with the version that was written.

    Raises:
        Stop: Part of a family could not be compared, or a file cannot be written.
    """
    from ..changes.release_files import NotRecorded, records

    if comparison.notices:
        raise Stop(f"nothing is recorded: {comparison.notices[0]}", 1)
    try:
        # Compose all texts before touching the first file.
        record_texts = list(records(comparison, after.families))
        for place, text in record_texts:
            place.write_text(text, encoding="utf-8")
    except NotRecorded as error:
        raise Stop(str(error), 1) from None
    notices = tuple(f"recorded in {place.as_posix()}" for place, _ in record_texts)
    packages = [replace(package, stated=package.new) for package in comparison.packages]
    return replace(comparison, packages=packages, notices=notices)


def _side(text: str, is_old: bool, cache: Cache, lenient: bool = False) -> _Side:
    """Return the families of one side. For the old side, those that the current language can still read."""
    from tempfile import TemporaryDirectory

    from ..language.migrate import migrate
    from ..loading.library import load_families, sound_families
    from ..loading.revisions import RevisionError, revision_in, write_revision
    from ..say.numbers import counted

    place = revision_in(text)
    with ExitStack() as stack:
        names: Mapping[str, str] = {}
        if place is None:
            path = Path(text)
            refuse_missing([path])
        else:
            folder = stack.enter_context(TemporaryDirectory(prefix="codewheel-"))
            try:
                laid_out = write_revision(place, Path(folder))
            except RevisionError as error:
                raise Stop(str(error), 2) from None
            path, names = laid_out.place, laid_out.names
        families, report = load_families([path], cache, prepare=migrate if is_old else None)
    problems = [replace(problem, file=names.get(problem.file, problem.file)) for problem in report.problems]
    if not problems:
        return _Side(tuple(families), frozenset(), (), names)
    if lenient and families:
        _show(problems)
        count = counted(len(problems), "problem")
        notice = (
            f"the current spec language finds {count} in {text}. The faulty parts are omitted and may be listed as new"
        )
        return _Side(tuple(families), frozenset(), (notice,), names)
    sound = sound_families(families, report)
    if not is_old or not sound:
        raise _unread(text, problems, is_old)
    left_out = [family.device.name for family in families if family not in sound]
    because = f"because of {counted(len(problems), 'problem')} in the current spec language"
    notice = f"not compared {because}: {', '.join(left_out)}"
    _show(problems)
    return _Side(tuple(sound), frozenset(left_out), (f"{notice} of {text}",), names)


def _show(problems: Sequence[Problem]) -> None:
    for problem in problems[:_MOST_SHOWN]:
        print(problem.format(), file=sys.stderr)
    if len(problems) > _MOST_SHOWN:
        print(f"and {len(problems) - _MOST_SHOWN} more", file=sys.stderr)


def _unread(text: str, problems: Sequence[Problem], is_old: bool) -> Stop:
    from ..say.numbers import counted

    _show(problems)
    count = counted(len(problems), "problem")
    if not is_old:
        return Stop(f"{text} has {count} and is not compared", 1)
    return Stop(
        f"{text} is not compared, because the current spec language finds {count} in it. It may use an older form of "
        "the language: add --lenient, use a later revision, or run the version of codewheel from that time",
        1,
    )
