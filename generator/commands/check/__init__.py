"""``codewheel check``: report all problems in specs and second readings, and facts that targets cannot express.

Other commands also use the line about the specs that were read, and the formats for review tools.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from ...say import count_with_unit, first_of
from ..cli import FORMATS, FORMATS_HELP, Parser, add_cache_option, add_specs, cache_for
from ..review_formats import ReviewFinding, as_review
from ..terminal import CommandError, Progress, print_json

if TYPE_CHECKING:
    import argparse

    from ...cache import Cache, CachedResult
    from ...language.problems import Problem, ProblemReport
    from ...loading.configuration import Configuration
    from ...readings.second_readings import Coverage

JSON_VERSION = 1
EXAMPLES = ("codewheel check my_encoder.yaml", "codewheel check .", "codewheel check --json")


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Report all problems in the specs."
    add_specs(parser)
    parser.add_argument(
        "--target",
        action="append",
        metavar="NAME",
        help="check that this output can express the specs (see below, may be repeated)",
    )
    output_group = parser.add_mutually_exclusive_group()
    output_group.add_argument("--json", action="store_true", help="print the problems as JSON")
    output_group.add_argument("--format", choices=FORMATS, default="text", help=FORMATS_HELP)
    add_cache_option(parser)
    parser.add_argument(
        "--coverage",
        action="store_true",
        help="count how often each fact was read, and exit 1 if a fact that needs two readings was read only once",
    )
    parser.add_argument(
        "--write",
        action="store_true",
        help="with --coverage: save the counts next to the specs, for the documentation pages",
    )
    parser.more_help = _targets_help


def _targets_help() -> str:
    from ..outputs import targets_help

    return targets_help()


def run(arguments: argparse.Namespace) -> int:
    """Print the problems. The exit code is 1 if there are any.

    Raises:
        CommandError: There are no specs, options contradict each other, or a target fails.
    """
    from ...cache import NO_CACHE, CachedResult
    from ...loading.configuration import filters_as_texts
    from ..read_specs import specs_to_judge

    if arguments.write and not arguments.coverage:
        raise CommandError("--write needs --coverage", 2)
    named_paths = [*arguments.specs, *arguments.more_specs]
    specs = specs_to_judge(named_paths, "check")
    # If the user names specs, the settings may refer to families in other specs.
    settings = None if named_paths else specs.settings
    if arguments.format in ("github", "sarif") and arguments.coverage:
        raise CommandError(f"--format {arguments.format} lists problems only; leave --coverage out", 2)
    arguments.json = arguments.json or arguments.format == "json"
    cache = cache_for(arguments)
    # The coverage and the problems of chosen targets depend on more than the inputs of the cached result.
    is_storable = not arguments.coverage and not arguments.target
    options = filters_as_texts(settings.only) if settings is not None else []
    cached_check = CachedResult(cache if is_storable else NO_CACHE, "check", specs.paths, options=options)
    if _print_stored(cached_check, arguments):
        # Only runs without problems are stored.
        return 0
    return _check_and_print(arguments, specs.paths, settings=settings, cache=cache, result=cached_check)


def _print_stored(result: CachedResult, arguments: argparse.Namespace) -> bool:
    """Print the cached result of a run with the same specs, and return whether there is one.

    Only results without problems are cached.
    """
    specs_read = result.get()
    if specs_read is None:
        return False
    no_coverage: dict[str, Any] = {}
    _print_problems(specs_read["families"], report_of(specs_read), no_coverage, arguments)
    return True


def _check_and_print(
    arguments: argparse.Namespace,
    paths: Sequence[Path],
    *,
    settings: Configuration | None,
    cache: Cache,
    result: CachedResult,
) -> int:
    """Check the specs, print and cache the result, and return the exit code.

    ``settings`` is None if the user named specs. ``result`` is the place in the cache for a result without problems.
    """
    from ...cache import NO_CACHE
    from ...targets.registry import WITH_PROBLEMS
    from ..outputs import are_built_in, targets_named
    from ..read_specs import report_unknown_families
    from . import specs as spec_checks

    targets = targets_named(arguments.target, WITH_PROBLEMS)
    with Progress("codewheel: checking the specs"):
        checked_specs = spec_checks.check_specs(paths, targets, NO_CACHE if arguments.coverage else cache)
    report = checked_specs.report
    family_names = [family.device.name for family in checked_specs.families]
    report_unknown_families(settings, family_names, report)
    coverage_by_family: Sequence[Coverage] = []
    coverage_data: dict[str, Any] = {}
    if arguments.coverage:
        spec_checks.check_counts(checked_specs, write=arguments.write)
        coverage_by_family = checked_specs.readings
        coverage_data = spec_checks.as_data(coverage_by_family)
    _print_problems(family_names, report, coverage_data, arguments)
    if arguments.coverage and not arguments.json:
        print(spec_checks.as_text(coverage_by_family, checked_specs))
    # With other targets, or without the packages of some, the next run may find other problems.
    if not report and are_built_in(targets, WITH_PROBLEMS):
        result.put(specs_read(family_names, report))
    return 0 if spec_checks.is_complete(coverage_by_family, report) else 1


def _print_problems(
    family_names: Sequence[str], report: ProblemReport, coverage_data: dict[str, Any], arguments: argparse.Namespace
) -> None:
    """Print the problems as text or as JSON.

    The JSON also contains ``coverage_data``, which is empty without ``--coverage``.
    """
    if arguments.json:
        print_json({"version": JSON_VERSION} | as_data(report) | coverage_data)
    else:
        print(as_text(family_names, report, arguments.format))


def as_data(report: ProblemReport) -> dict[str, Any]:
    """Return the problems as plain data for ``--json``."""
    from ..new import placeholders_data

    return {
        "files": report.files,
        "passed_over": report.passed_over,
        "problems": [problem.to_json() for problem in report.shown],
        "placeholders": placeholders_data(report.files),
    }


def as_text(families: Sequence[str], report: ProblemReport, form: str = "text") -> str:
    """Return the problems as text with a summary, or in a format for review tools.

    ``families`` are the names of all families. ``form`` is ``text``, ``github`` or ``sarif``.
    """
    if form in ("github", "sarif"):
        return _review_text(report, form)
    from ..new import placeholder_lines

    lines = [problem.format() for problem in report.shown]
    lines += placeholder_lines(report.files)
    lines.append(specs_read_line(families, report))
    if report:
        lines.append(count_with_unit(len(report.by_cause), "problem"))
    elif families:
        family_count = "1 family" if len(families) == 1 else f"{len(families)} families"
        lines.append(f"no problems in {family_count}: {', '.join(families)}")
    else:  # The files may define no family. They may describe masters, for example.
        lines.append("no problems")
    return "\n".join(lines)


def _review_text(report: ProblemReport, form: str) -> str:
    """Return the problems in a form for review tools, ``github`` or ``sarif``."""
    return as_review([_review_finding(problem) for problem in report.shown], form)


def _review_finding(problem: Problem) -> ReviewFinding:
    """Return a problem in the form for review tools."""
    return ReviewFinding(
        file=problem.file,
        line=problem.line,
        column=problem.column,
        rule=problem.rule,
        message=problem.message,
    )


#: Highest number of files in the line about the specs that were read. The others are counted.
_MAX_FILES = 8


def specs_read_line(
    families: Iterable[str], report: ProblemReport, packaged: Sequence[str] = (), packaged_files: Sequence[Path] = ()
) -> str:
    """Return a line that names the specs that were read, so that users notice a forgotten path.

    ``packaged`` are the names given with ``--packaged``, and ``packaged_files`` are the specs that they refer to.
    """
    # A file that was skipped in a folder may have been read because the user named it.
    skipped_files = [file for file in report.passed_over if file not in report.files]
    skipped_text = f"; skipped: {first_of(skipped_files, _MAX_FILES)}" if skipped_files else ""
    if packaged:
        packaged_text = _packaged_specs_text(families, report, packaged, packaged_files)
        return f"{packaged_text}{skipped_text}"
    number_of_specs = count_with_unit(len(report.files), "spec")
    listed_files = first_of(report.files, _MAX_FILES)
    return f"read {number_of_specs}: {listed_files}{skipped_text}"


def _packaged_specs_text(
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


class SpecsRead(TypedDict):
    """Names of families without problems, and the files that were read and skipped."""

    families: list[str]
    files: list[str]
    skipped: list[str]


def specs_read(families: Sequence[str], report: ProblemReport) -> SpecsRead:
    """Return the result of reading specs without problems."""
    return SpecsRead(families=list(families), files=report.files, skipped=report.passed_over)


def report_of(specs: SpecsRead) -> ProblemReport:
    """Return the report of a run that read these specs."""
    from ...language.problems import ProblemReport

    report = ProblemReport()
    report.files += specs["files"]
    report.passed_over += specs["skipped"]
    return report


# -- findings for review tools
