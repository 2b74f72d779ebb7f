"""``codewheel diff``: list the changes between two versions of specs, with their impact on users."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import datetime
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..changes.rules import IMPACTS, Impact
from .arguments import FORMATS, FORMATS_HELP, Parser, a_path, add_cache_option, cache_for
from .terminal import Progress, Stop, print_json, refuse_missing

if TYPE_CHECKING:
    from ..cache import Cache
    from ..changes.report import DiffResult, Files
    from ..changes.rules import Change
    from ..language.document import Document
    from ..language.document import Path as SpecPath
    from ..language.problems import Problem, Report
    from ..loading.library import Family
    from ..model import Device
    from .review_formats import Finding

EXAMPLES = (
    "codewheel diff old/my_encoder.yaml my_encoder.yaml",
    "codewheel diff old/my_encoder.yaml my_encoder.yaml --fail-on behaviour",
)
#: Most problems of a side that are printed.
_MOST_PROBLEMS = 3
#: Levels of GitHub by impact. All others are notices.
_LEVELS = {Impact.BREAKING: "error", Impact.BEHAVIOUR: "warning"}
_STEPS = re.compile(r"[^.\[\]]+")


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "List each change with the outputs and order codes that it affects. Exit 1 if there are any."
    place = "a file, a folder, or either in a git revision, such as v1.0:specs/lika"
    parser.add_argument("old", metavar="OLD", help=f"the old specs: {place}")
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
    _add_record_options(parser)
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


def _add_record_options(parser: Parser) -> None:
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


@dataclass(frozen=True)
class _Side:
    """One side of the comparison: the families that were read, and the names of those that could not be.

    ``file_names`` has the original names of files from a git revision.
    """

    families: tuple[Family, ...]
    file_names: Mapping[str, str]
    notices: tuple[str, ...] = ()
    excluded_names: frozenset[str] = frozenset()


def run(chosen: argparse.Namespace) -> int:
    """Compare, print, and return the exit code.

    Raises:
        Stop: Something cannot be read, or families that must not be released would be recorded.
    """
    if chosen.record and not Path(chosen.new).is_dir():
        raise Stop("--record needs a folder of specs: all families of a manufacturer share a version", 2)
    cache = cache_for(chosen)
    before, after, comparison = _compare_sides(chosen, cache)
    if chosen.record:
        if not chosen.unchecked:
            _refuse_unproved(after.families, cache)
        comparison = _record(comparison, after)
    relevant_changes, notices = _without_accepted(comparison.changes, chosen)
    comparison = replace(comparison, notices=(*comparison.notices, *notices))
    if chosen.format in ("github", "sarif"):
        from .review_formats import as_review

        print(as_review(_findings(relevant_changes, after), chosen.format))
    else:
        _print_comparison(comparison, before, after, chosen)
    threshold = Impact[chosen.fail_on.upper()] if chosen.fail_on else Impact.DOCUMENTATION
    return int(any(change.impact >= threshold for change in relevant_changes))


def _compare_sides(chosen: argparse.Namespace, cache: Cache) -> tuple[_Side, _Side, DiffResult]:
    """Read and compare both sides, with a line on a terminal about what takes time."""
    with Progress(f"codewheel: reading {chosen.old}") as progress:
        before = _load_side(chosen.old, cache, chosen.lenient)
        progress.text = f"codewheel: reading {chosen.new}"
        after = _load_side(chosen.new, cache, chosen.lenient, before)
        progress.text = "codewheel: comparing the specs and what they generate"
        return before, after, _compare(before, after, cache)


def _print_comparison(comparison: DiffResult, before: _Side, after: _Side, chosen: argparse.Namespace) -> None:
    if chosen.json or chosen.format == "json":
        from ..changes.report import as_data

        print_json(as_data(comparison))
    elif chosen.markdown:
        from ..changes.report import as_markdown

        print(as_markdown(comparison))
    else:
        from ..changes.report import as_text
        from .colours import with_coloured_impacts

        print(with_coloured_impacts(as_text(comparison)))
        if chosen.editions:
            from .edition_entry import edition_entries

            for entry in edition_entries(before.families, after.families, comparison.changes):
                print(f"\n{entry}")


# The comparison loads targets only if something has changed or is recorded, so it imports these modules by their names.


def _changed_files(olds: Sequence[Device], news: Sequence[Device], cache: Cache) -> Files | None:
    """Return the generated files that differ, or None if nothing can be generated."""
    files: Files | None = import_module(f"{__package__}.generate.files").changed_files(olds, news, cache)
    return files


def _refuse_unproved(families: Sequence[Family], cache: Cache) -> None:
    """Raise ``Stop`` if families must not be released."""
    import_module(f"{__package__}.check.specs").refuse_unproved(families, "recorded", cache)


def _without_accepted(changes: Sequence[Change], chosen: argparse.Namespace) -> tuple[Sequence[Change], Sequence[str]]:
    """Return the changes that count, and the notices about accepted ones.

    Raises:
        Stop: The file with accepted changes is missing or not valid. The exit code is 2.
    """
    from ..changes.accepted import NAME, NotAccepted, changes_to_accept, read_accepted

    new = Path(chosen.new)
    place = chosen.accepted or (new if new.is_dir() else new.parent) / NAME
    if chosen.accepted is None and not place.is_file():
        return changes, ()
    try:
        return changes_to_accept(changes, read_accepted(place), datetime.now().astimezone().date())
    except NotAccepted as error:
        raise Stop(str(error), 2) from None


def _compare(before: _Side, after: _Side, cache: Cache) -> DiffResult:
    """Return the changes in the families that could be read on both sides."""
    from ..changes.families import compare
    from ..changes.report import DiffResult
    from ..changes.rules import packages

    olds, news = _devices(before, after), _devices(after, before)
    changes = compare(olds, news)
    files = _changed_files(olds, news, cache) if changes else None
    return DiffResult(
        changes=changes,
        packages=packages(olds, news, changes),
        files=files,
        notices=(*before.notices, *after.notices),
    )


def _devices(side: _Side, other_side: _Side) -> tuple[Device, ...]:
    excluded_names = side.excluded_names | other_side.excluded_names
    return tuple(family.device for family in side.families if family.device.name not in excluded_names)


def _record(comparison: DiffResult, after: _Side) -> DiffResult:
    """Write the records, and return ``comparison`` with notices about them and with the version that was written.

    Raises:
        Stop: Part of a family could not be compared, or a file cannot be written.
    """
    from ..changes.report import NotRecorded, files_of_release

    if comparison.notices:
        raise Stop(f"nothing is recorded: {comparison.notices[0]}", 1)
    try:
        # Compose all texts before touching the first file.
        record_texts = list(files_of_release(comparison, after.families))
        for place, text in record_texts:
            place.write_text(text, encoding="utf-8")
    except NotRecorded as error:
        raise Stop(str(error), 1) from None
    notices = tuple(f"recorded in {place.as_posix()}" for place, _ in record_texts)
    packages = [replace(package, stated=package.new) for package in comparison.packages]
    return replace(comparison, packages=packages, notices=notices)


def _load_side(text: str, cache: Cache, lenient: bool, before: _Side | None = None) -> _Side:
    """Return the families of one side. For the old side, those that the current language can still read.

    ``before`` is the old side, and None while that is loaded.

    Raises:
        Stop: The specs do not exist, or have problems that prevent a comparison.
    """
    from ..loading.library import sound_families
    from ..say.plain_text import counted

    is_old = before is None
    families, report, file_names = _read_side(text, cache, before)
    problems = [replace(problem, file=file_names.get(problem.file, problem.file)) for problem in report.problems]
    if not problems:
        return _Side(tuple(families), file_names)
    count = counted(len(problems), "problem")
    if lenient and families:
        _print_first(problems)
        omission = "The faulty parts are omitted and may be listed as new"
        notice = f"the current spec language finds {count} in {text}. {omission}"
        return _Side(tuple(families), file_names, notices=(notice,))
    sound = sound_families(families, report)
    if not is_old or not sound:
        raise _not_comparable(text, problems, is_old)
    excluded_names = [family.device.name for family in families if family not in sound]
    reason = f"because of {count} in the current spec language"
    notice = f"not compared {reason}: {', '.join(excluded_names)} of {text}"
    _print_first(problems)
    return _Side(tuple(sound), file_names, notices=(notice,), excluded_names=frozenset(excluded_names))


def _read_side(text: str, cache: Cache, before: _Side | None) -> tuple[Sequence[Family], Report, Mapping[str, str]]:
    """Read specs from the disk or from a git revision, with the original names of files from the latter.

    Raises:
        Stop: There is no such file, folder or revision. The exit code is 2.
    """
    from tempfile import TemporaryDirectory

    from ..language.migrate import migrate
    from ..loading.library import load_families
    from ..loading.revisions import RevisionError, revision_in, write_revision

    place_in_revision = revision_in(text)
    with ExitStack() as stack:
        file_names: Mapping[str, str] = {}
        if place_in_revision is None:
            path = Path(text)
            refuse_missing([path])
        else:
            folder = stack.enter_context(TemporaryDirectory(prefix="codewheel-"))
            try:
                laid_out = write_revision(place_in_revision, Path(folder))
            except RevisionError as error:
                raise Stop(str(error), 2) from None
            path, file_names = laid_out.place, laid_out.names
        prepare, others = (migrate, ()) if before is None else (None, before.families)
        families, report = load_families([path], cache, prepare, others)
    return families, report, file_names


def _print_first(problems: Sequence[Problem]) -> None:
    for problem in problems[:_MOST_PROBLEMS]:
        print(problem.format(), file=sys.stderr)
    if len(problems) > _MOST_PROBLEMS:
        print(f"and {len(problems) - _MOST_PROBLEMS} more", file=sys.stderr)


def _not_comparable(text: str, problems: Sequence[Problem], is_old: bool) -> Stop:
    from ..say.plain_text import counted

    _print_first(problems)
    count = counted(len(problems), "problem")
    if not is_old:
        return Stop(f"{text} has {count} and is not compared", 1)
    return Stop(
        f"{text} is not compared, because the current spec language finds {count} in it. It may use an older form of "
        "the language: add --lenient, use a later revision, or run the version of codewheel from that time",
        1,
    )


# -- places in the new specs, for review tools


def _findings(changes: Sequence[Change], side: _Side) -> list[Finding]:
    """Return the changes with their places in the new specs. A removed item is at the nearest place that is left."""
    documents = {family.device.name: family.document for family in side.families}
    if not documents:
        return []
    first_document = next(iter(documents.values()))
    findings = []
    for change in changes:
        document = documents.get(change.family, first_document)
        path = _place_in_spec(document, change.path) if change.family in documents else ()
        findings.append(_finding(change, document, path, side.file_names))
    return findings


def _finding(change: Change, document: Document, path: SpecPath, file_names: Mapping[str, str]) -> Finding:
    from ..changes.report import describe_effect
    from .review_formats import Finding

    line, column = document.position(path)
    file = document.file_of(path) or document.file
    return Finding(
        file=file_names.get(file, file),
        line=line,
        column=column,
        rule=change.rule.name,
        message=f"{change.text} ({change.impact.word}: {describe_effect(change)})",
        level=_LEVELS.get(change.impact, "notice"),
    )


def _place_in_spec(document: Document, text: str) -> SpecPath:
    """Return the place of a path of keys and names, as far as it exists."""
    from ..language.schema_check import value_at

    path: SpecPath = ()
    for step in _STEPS.findall(text):
        relative_path = next(_paths_to(step, value_at(document.data, path)), None)
        if relative_path is None:
            break
        path = (*path, *relative_path)
    return path


def _paths_to(step: str, node: Any) -> Iterator[SpecPath]:
    """Yield the paths to a key or name in a map or list, or in a list or map that is a value of the map."""
    yield from _children_named(step, node)
    if isinstance(node, dict):
        for key, inner_node in node.items():
            yield from ((key, *path) for path in _children_named(step, inner_node))


def _children_named(step: str, node: Any) -> Iterator[SpecPath]:
    from ..language.document import label_of

    if isinstance(node, list):
        yield from ((index,) for index, child in enumerate(node) if label_of(child) == step)
    elif isinstance(node, dict) and step in node:
        yield (step,)
