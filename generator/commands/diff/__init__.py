"""``codewheel diff``: list the changes between two versions of specs, with their impact on users."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import datetime
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from ...changes.rules import IMPACTS, Impact
from ..cli import FORMATS, FORMATS_HELP, Parser, a_path, add_cache_option, cache_for
from ..terminal import CommandError, Progress, print_json, refuse_missing

if TYPE_CHECKING:
    from ...cache import Cache
    from ...changes.report import DiffResult, Files
    from ...changes.rules import Change
    from ...language.document import Document
    from ...language.document import Path as SpecPath
    from ...language.problems import Problem, ProblemReport
    from ...loading.configuration import FamilyFilters
    from ...loading.library import Family
    from ...model import Device
    from ..review_formats import ReviewFinding

EXAMPLES = (
    "codewheel diff old/my_encoder.yaml my_encoder.yaml",
    "codewheel diff old/my_encoder.yaml my_encoder.yaml --fail-on behaviour",
)
#: Highest number of problems in one version that are printed.
_MAX_PROBLEMS = 3
#: Levels of GitHub by impact. All others are notices.
_GITHUB_LEVEL_BY_IMPACT = {Impact.BREAKING: "error", Impact.BEHAVIOUR: "warning"}


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "List each change with the outputs and order codes that it affects. The exit code is 1 if there are changes."
    )
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
        help="changes that do not affect the exit code (default: accepted.yaml next to the specs of NEW)",
    )
    parser.add_argument(
        "--lenient",
        action="store_true",
        help="compare the valid parts of specs that have problems in the current spec language",
    )
    add_cache_option(parser)


def _add_record_options(parser: Parser) -> None:
    """Add the options that save the changes and the next version."""
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
    """One version of the specs in a comparison."""

    families: tuple[Family, ...]
    #: Original names of files from a git revision, by the names of the temporary files that were read.
    file_names: Mapping[str, str]
    notices: tuple[str, ...] = ()
    #: Names of families that have problems, and are not compared.
    excluded_names: frozenset[str] = frozenset()


def run(arguments: argparse.Namespace) -> int:
    """Compare two versions of specs, print the changes, and return the exit code.

    It is 1 if a change that is not accepted has at least the impact of ``--fail-on`` (by default, any impact).

    Raises:
        CommandError: Something cannot be read, or families that must not be released would be recorded.
    """
    if arguments.record and not Path(arguments.new).is_dir():
        raise CommandError("--record needs a folder of specs: all families of a manufacturer share a version", 2)
    cache = cache_for(arguments)
    old, new, comparison = _compare_sides(arguments, cache)
    if arguments.record:
        if not arguments.unchecked:
            _require_releasable(new.families, cache)
        comparison = _write_records(comparison, new)
    relevant_changes, notices_about_accepted = _without_accepted(comparison.changes, arguments)
    comparison = replace(comparison, notices=(*comparison.notices, *notices_about_accepted))
    if arguments.format in ("github", "sarif"):
        from ..review_formats import as_review

        print(as_review(_findings_in_new_specs(relevant_changes, new), arguments.format))
    else:
        _print_comparison(comparison, old, new, arguments)
    # Every change has at least the impact DOCUMENTATION.
    lowest_impact = Impact[arguments.fail_on.upper()] if arguments.fail_on else Impact.DOCUMENTATION
    has_failed = any(change.impact >= lowest_impact for change in relevant_changes)
    return 1 if has_failed else 0


def _compare_sides(arguments: argparse.Namespace, cache: Cache) -> tuple[_Side, _Side, DiffResult]:
    """Read and compare both versions, and show the current step on the terminal."""
    with Progress(f"codewheel: reading {arguments.old}") as progress:
        old = _load_side(arguments.old, cache, lenient=arguments.lenient, old_side=None)
        progress.text = f"codewheel: reading {arguments.new}"
        new = _load_side(arguments.new, cache, lenient=arguments.lenient, old_side=old)
        progress.text = "codewheel: comparing the specs and what they generate"
        return old, new, _compare_families(old, new, cache, _filters_for(arguments.new))


def _print_comparison(comparison: DiffResult, old_side: _Side, new_side: _Side, arguments: argparse.Namespace) -> None:
    """Print the changes as JSON, Markdown or text. With ``--editions``, the entries for the spec follow the text."""
    if arguments.json or arguments.format == "json":
        from ...changes.report import as_data

        print_json(as_data(comparison))
    elif arguments.markdown:
        from ...changes.report import as_markdown

        print(as_markdown(comparison))
    else:
        from ...changes.report import as_text
        from ..terminal import with_coloured_impacts

        print(with_coloured_impacts(as_text(comparison)))
        if arguments.editions:
            from .spec_entries import edition_entries

            for entry in edition_entries(old_side.families, new_side.families, comparison.changes):
                print(f"\n{entry}")


# The comparison loads targets only if something has changed or is recorded, so it imports these modules by their names.


def _changed_files(
    olds: Sequence[Device], news: Sequence[Device], cache: Cache, filters: FamilyFilters
) -> Files | None:
    """Return the generated files that differ, or None if nothing can be generated."""
    files: Files | None = import_module("codewheel.commands.generate.files").changed_files(olds, news, cache, filters)
    return files


def _filters_for(specs: str) -> FamilyFilters:
    """Return the conditions on the families of each output, from the settings for the current folder.

    ``specs`` is NEW of the command line. If this is a path outside the folder of the settings, the specs belong to a
    different project, and there are no conditions.
    """
    from ...loading.configuration import NO_FILTERS
    from ..read_specs import find_settings

    settings = find_settings()
    path = Path(specs)
    if settings is None:
        return NO_FILTERS
    # A path in a git revision does not exist on the disk, and belongs to this project.
    is_elsewhere = path.exists() and not path.resolve().is_relative_to(settings.folder.resolve())
    return NO_FILTERS if is_elsewhere else settings.only


def _require_releasable(families: Sequence[Family], cache: Cache) -> None:
    """Raise ``CommandError`` if second readings of families disagree, or their coverage is out of date."""
    import_module("codewheel.commands.check.specs").refuse_unproved(families, "recorded", cache)


def _without_accepted(
    changes: Sequence[Change], arguments: argparse.Namespace
) -> tuple[Sequence[Change], Sequence[str]]:
    """Return the changes that no one has accepted, and notices about accepted changes.

    The accepted changes are in the file given with ``--accepted``, or by default in ``accepted.yaml`` next to the new
    specs. Without such a file, no changes are accepted.

    Raises:
        CommandError: The file with accepted changes is missing or not valid. The exit code is 2.
    """
    from ...changes.report import ACCEPTED_FILE, NotAccepted, changes_to_accept, read_accepted

    accepted_file = arguments.accepted
    if accepted_file is None:
        new = Path(arguments.new)
        folder_of_specs = new if new.is_dir() else new.parent
        accepted_file = folder_of_specs / ACCEPTED_FILE
        if not accepted_file.is_file():
            return changes, ()
    today = datetime.now().astimezone().date()
    try:
        return changes_to_accept(changes, read_accepted(accepted_file), today)
    except NotAccepted as error:
        raise CommandError(str(error), 2) from None


def _compare_families(old_side: _Side, new_side: _Side, cache: Cache, filters: FamilyFilters) -> DiffResult:
    """Return the changes in the families that could be read in both versions, with the notices about both.

    Generated files are only compared if the families differ. ``files`` of the result is None if they are not compared
    or cannot be generated.
    """
    from ...changes.families import compare
    from ...changes.report import DiffResult
    from ...changes.rules import packages

    old_devices, new_devices = _comparable_devices(old_side, new_side), _comparable_devices(new_side, old_side)
    changes = compare(old_devices, new_devices)
    files = _changed_files(old_devices, new_devices, cache, filters) if changes else None
    return DiffResult(
        changes=changes,
        packages=packages(old_devices, new_devices, changes),
        files=files,
        notices=(*old_side.notices, *new_side.notices),
    )


def _comparable_devices(side: _Side, other_side: _Side) -> tuple[Device, ...]:
    """Return the devices of one version, without those that have problems in either version."""
    excluded_names = side.excluded_names | other_side.excluded_names
    return tuple(family.device for family in side.families if family.device.name not in excluded_names)


def _write_records(comparison: DiffResult, new_side: _Side) -> DiffResult:
    """Record the changes in files, and return the comparison with notices about these files and with the new versions.

    If the comparison already has notices, something was not compared, and nothing is written.

    Raises:
        CommandError: Part of a family could not be compared, or a file cannot be written.
    """
    from .spec_entries import NotRecorded, files_of_release

    if comparison.notices:
        raise CommandError(f"nothing is recorded: {comparison.notices[0]}", 1)
    try:
        # All texts are composed before the first file is written.
        paths_and_texts = list(files_of_release(comparison, new_side.families))
        for path, text in paths_and_texts:
            path.write_text(text, encoding="utf-8")
    except NotRecorded as error:
        raise CommandError(str(error), 1) from None
    notices = tuple(f"recorded in {path.as_posix()}" for path, _ in paths_and_texts)
    packages = [replace(package, stated=package.new) for package in comparison.packages]
    return replace(comparison, packages=packages, notices=notices)


def _load_side(text: str, cache: Cache, *, lenient: bool, old_side: _Side | None) -> _Side:
    """Read the families of one version. ``text`` is OLD or NEW of the command line.

    If the specs have problems, the first ones are printed. If ``lenient`` is true, all families are kept without their
    faulty parts. Otherwise, problems in the new version are an error, and the old version only keeps families without
    problems. ``old_side`` is None while the old version itself is read.

    Raises:
        CommandError: The specs do not exist, or have problems that prevent a comparison.
    """
    from ...loading.library import families_without_problems
    from ...say import count_with_unit

    is_old = old_side is None
    families, report, file_names = _read_side(text, cache, old_side)
    problems = []
    for problem in report.problems:
        original_name = file_names.get(problem.file, problem.file)
        problems.append(replace(problem, file=original_name))
    if not problems:
        return _Side(tuple(families), file_names)
    problems_text = count_with_unit(len(problems), "problem")
    if lenient and families:
        _print_first_problems(problems)
        omission = "The faulty parts are left out and may be listed as new"
        notice = f"the current spec language finds {problems_text} in {text}. {omission}"
        return _Side(tuple(families), file_names, notices=(notice,))
    valid_families = families_without_problems(families, report)
    if not is_old or not valid_families:
        raise _not_comparable_error(text, problems, is_old=is_old)
    excluded_names = [family.device.name for family in families if family not in valid_families]
    reason = f"because of {problems_text} in the current spec language"
    notice = f"not compared {reason}: {', '.join(excluded_names)} of {text}"
    _print_first_problems(problems)
    return _Side(tuple(valid_families), file_names, notices=(notice,), excluded_names=frozenset(excluded_names))


def _read_side(
    text: str, cache: Cache, old_side: _Side | None
) -> tuple[Sequence[Family], ProblemReport, Mapping[str, str]]:
    """Return the families of one version, the problems in them, and the original names of files from a git revision.

    ``text`` is a path, or a revision and a path such as ``v1.0:specs``. Files from a revision are written to a
    temporary folder, and the names map each of them to its name in the revision. Specs of the old version (``old_side``
    is None) are first migrated to the current spec language. Families that are the same in both versions are only built
    once.

    Raises:
        CommandError: There is no such file, folder or revision. The exit code is 2.
    """
    from tempfile import TemporaryDirectory

    from ...language.schema_check import migrate
    from ...loading.library import load_families
    from ...loading.revisions import RevisionError, revision_in, write_revision

    place_in_revision = revision_in(text)
    with ExitStack() as stack:
        file_names: Mapping[str, str] = {}
        if place_in_revision is None:
            path = Path(text)
            refuse_missing([path])
        else:
            folder = stack.enter_context(TemporaryDirectory(prefix="codewheel-"))
            try:
                written_files = write_revision(place_in_revision, Path(folder))
            except RevisionError as error:
                raise CommandError(str(error), 2) from None
            path = written_files.place
            file_names = written_files.names
        if old_side is None:
            # With an empty sequence, families keep the content of their files, which the new version is compared with.
            no_shared_families: tuple[Family, ...] = ()
            families, report = load_families([path], cache, migrate, others=no_shared_families)
        else:
            families, report = load_families([path], cache, others=old_side.families)
    return families, report, file_names


def _print_first_problems(problems: Sequence[Problem]) -> None:
    for problem in problems[:_MAX_PROBLEMS]:
        print(problem.format(), file=sys.stderr)
    if len(problems) > _MAX_PROBLEMS:
        print(f"and {len(problems) - _MAX_PROBLEMS} more", file=sys.stderr)


def _not_comparable_error(text: str, problems: Sequence[Problem], *, is_old: bool) -> CommandError:
    """Print the first problems in a version, and return the error. For the old version, it suggests a remedy."""
    from ...say import count_with_unit

    _print_first_problems(problems)
    problems_text = count_with_unit(len(problems), "problem")
    if not is_old:
        return CommandError(f"{text} has {problems_text} and is not compared", 1)
    return CommandError(
        f"{text} is not compared, because the current spec language finds {problems_text} in it. It may use an older "
        "form of the language: add --lenient, use a later revision, or run the version of codewheel from that time",
        1,
    )


def _findings_in_new_specs(changes: Sequence[Change], side: _Side) -> list[ReviewFinding]:
    """Return the changes with their places in the new specs. For a removed item, this is the nearest remaining place.

    A change in a family that is not in the new specs is reported at the beginning of the first spec.
    """
    from ..review_formats import place_in_spec

    documents = {family.device.name: family.document for family in side.families}
    if not documents:
        return []
    first_document = next(iter(documents.values()))
    findings = []
    for change in changes:
        document = documents.get(change.family, first_document)
        is_in_new_specs = change.family in documents
        path = place_in_spec(document, change.path) if is_in_new_specs else ()
        finding = _review_finding(change, document, path, original_names=side.file_names)
        findings.append(finding)
    return findings


def _review_finding(
    change: Change, document: Document, path: SpecPath, *, original_names: Mapping[str, str]
) -> ReviewFinding:
    """Return a change in the form for review tools, at its place in the new spec.

    ``original_names`` has the names of files from a git revision, by the names of the temporary files that were read.
    """
    from ...changes.report import describe_effect
    from ..review_formats import ReviewFinding

    line_number, column = document.position(path)
    file = document.file_of(path) or document.file
    return ReviewFinding(
        file=original_names.get(file, file),
        line=line_number,
        column=column,
        rule=change.rule.name,
        message=f"{change.text} ({change.impact.word}: {describe_effect(change)})",
        level=_GITHUB_LEVEL_BY_IMPACT.get(change.impact, "notice"),
    )
