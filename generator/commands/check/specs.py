"""Check specs against rules, targets and second readings, and count how often each fact was read."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, astuple, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ...cache import NO_CACHE, Cache, content_of
from ...language.document import Document
from ...language.document import Path as SpecPath
from ...language.files import coverage_path, family_files, second_reading_path, word_sheet_path
from ...language.problems import ProblemReport
from ...loading.history import RULE, counts_text
from ...loading.library import contents, is_clean, load_families
from ...loading.overlays import Family
from ...model import TimesRead
from ...readings.reading import FactClass
from ...readings.second_readings import (
    Coverage,
    Reader,
    SecondReading,
    add_counts,
    comparable_specs,
    compare_readings,
    read_beside,
)
from ...say import count_with_unit
from ...targets import Target
from ..cloze import Reader as SheetReader
from ..cloze import check_sheets, read_sheet
from ..families_in_specs import check_editions
from ..outputs import report_unfit_parts
from ..terminal import CommandError

#: Kind of entry in the cache for a family whose editions and second reading have no problems.
_CLEAN_ENTRY = "clean family"


@dataclass(frozen=True)
class CheckedSpecs:
    """Families and second readings that were checked, with their problems."""

    families: Sequence[Family]
    readings: Sequence[Coverage]
    report: ProblemReport


def check_specs(paths: Sequence[Path], targets: Iterable[Target], cache: Cache = NO_CACHE) -> CheckedSpecs:
    """Check the specs at ``paths`` and the second readings next to them.

    Families that the cache lists as free of problems are not checked again, and their second readings are not in the
    result.

    Raises:
        CommandError: A target fails. The exit code is 1.
    """
    contents_before = contents(paths)
    clean_files = {file for file, content in contents_before.items() if cache.get(_CLEAN_ENTRY, content)}
    families, report = load_families(paths, cache)
    to_check: list[Family] = []
    for family in families:
        has_overlay = family.without_overlays is not None
        # The key in the cache does not depend on the content of overlays.
        if has_overlay or family.document.file not in clean_files:
            to_check.append(family)
    check_editions(to_check, report)
    files_to_check = [family.document.file for family in to_check]
    checked = check_families(
        families,
        targets,
        report,
        read=partial(_read_second_of, files_to_check),
        read_words=partial(_read_sheet_of, files_to_check),
    )
    for family in to_check:
        file = family.document.file
        # A family is not stored if its content is not known, or if its files have changed during the check.
        content_now = content_of(family_files(Path(file)))
        is_unchanged = bool(family.content) and content_now == contents_before[file]
        if is_unchanged and is_clean(family, report):
            cache.put(_CLEAN_ENTRY, contents_before[file], True)
    return checked


def _read_second_of(files_to_check: Sequence[str], family: Family, report: ProblemReport) -> SecondReading | None:
    """Return the second reading of a family, or None if the family has none or need not be checked.

    If it need not be checked, the file is only listed as read.
    """
    if family.document.file in files_to_check:
        return read_beside(family, report)
    second_path = second_reading_path(Path(family.document.file))
    if second_path.is_file():
        report.files.append(str(second_path))
    return None


def _read_sheet_of(files_to_check: Sequence[str], family: Family, report: ProblemReport) -> Document | None:
    """Return the word sheet of a family, or None if the family has none or need not be checked.

    If it need not be checked, the file is only listed as read.
    """
    if family.document.file in files_to_check:
        return read_sheet(family, report)
    sheet_path = word_sheet_path(Path(family.document.file))
    if sheet_path.is_file():
        report.files.append(str(sheet_path))
    return None


def check_families(
    families: Sequence[Family],
    targets: Iterable[Target],
    report: ProblemReport,
    read: Reader = read_beside,
    read_words: SheetReader = read_sheet,
) -> CheckedSpecs:
    """Check whether the targets can express the families, and compare these with their second readings and word sheets.

    ``read`` and ``read_words`` return the second reading and the word sheet of a family, or None if there is none.
    Problems are added to ``report``. The result contains the coverage of each family with a second reading.

    Raises:
        CommandError: A target fails. The exit code is 1.
    """
    comparable_files = comparable_specs(families, report)
    report_unfit_parts(families, targets, report)
    readings = compare_readings(families, comparable_files, report, read)
    check_sheets(families, comparable_files, report, read_words)
    return CheckedSpecs(families=families, readings=readings, report=report)


#: Kind of entry in the cache for a family that may be released.
_PROVED_ENTRY = "proved family"
_COVERAGE_COLUMNS = ("twice", "explained", "decided", "once", "derived")
_OUT_OF_DATE = "the counts do not match the readings; update them with codewheel check --coverage --write"


def check_counts(checked: CheckedSpecs, *, write: bool) -> None:
    """Report files next to specs whose counts of readings are out of date, or write these files if ``write`` is true.

    A family without such a file is not reported.
    """
    for family_coverage in checked.readings:
        counts_path = coverage_path(Path(family_coverage.spec.file))
        counts = counts_text(family_coverage.total)
        if write:
            counts_path.write_text(counts, encoding="utf-8")
        elif counts_path.is_file() and counts_path.read_text(encoding="utf-8") != counts:
            checked.report.add_at(str(counts_path), RULE, _OUT_OF_DATE)


def refuse_unproved(families: Sequence[Family], participle: str, cache: Cache = NO_CACHE) -> None:
    """Raise an error if families must not be released: their other editions, second readings or counts have problems.

    Args:
        families: Families whose specs have no other problems.
        participle: Participle for the action in the message, such as ``written``.
        cache: Cache of families without such problems. These families are not checked again until a file changes.

    Raises:
        CommandError: There are problems. The exit code is 1.
    """
    report = ProblemReport()
    # Families are checked one at a time, because a second reading needs as much memory as its spec.
    for family in families:
        if family.content and cache.get(_PROVED_ENTRY, family.content) is True:
            continue
        number_of_problems_before = len(report)
        check_editions([family], report)
        no_targets: tuple[Target, ...] = ()
        checked_family = check_families([family], no_targets, report)
        check_counts(checked_family, write=False)
        # A second reading may have changed since the content was read.
        content_now = content_of(family_files(Path(family.document.file)))
        is_unchanged = bool(family.content) and content_now == family.content
        has_no_new_problem = len(report) == number_of_problems_before
        if is_unchanged and has_no_new_problem:
            cache.put(_PROVED_ENTRY, family.content, True)
    if report:
        for problem in report.shown:
            print(problem.format(), file=sys.stderr)
        number_of_problems = count_with_unit(len(report.by_cause), "problem")
        reason = f"'codewheel check --coverage' reports {number_of_problems}"
        raise CommandError(f"nothing {participle}: {reason}; correct them, or add --unchecked", 1)


def is_complete(covered: Sequence[Coverage], report: ProblemReport) -> bool:
    """Return whether there are no problems, and every fact that needs two readings was read twice."""
    return not report and not any(family_coverage.lacking for family_coverage in covered)


def as_data(covered: Sequence[Coverage]) -> dict[str, Any]:
    """Return the coverage, the number of readings of each fact, as plain data for ``--json``."""
    return {
        "coverage": [_family_data(family_coverage) for family_coverage in covered],
        "total": asdict(add_counts(family_coverage.total for family_coverage in covered)),
    }


def _family_data(family_coverage: Coverage) -> dict[str, Any]:
    """Return the counts of a family by class, and the facts that were read only once."""
    data_by_class = {
        fact_class.value: _class_data(fact_class, times_read)
        for fact_class, times_read in family_coverage.counts.items()
    }
    return {
        "family": family_coverage.family.device.name,
        "classes": data_by_class,
        "total": asdict(family_coverage.total),
        "once": [_fact_data(family_coverage, fact_class, path) for fact_class, path in family_coverage.once],
    }


def _class_data(fact_class: FactClass, times_read: TimesRead) -> dict[str, Any]:
    return asdict(times_read) | {"needed": fact_class.is_needed}


def _fact_data(family_coverage: Coverage, fact_class: FactClass, fact_path: SpecPath) -> dict[str, Any]:
    """Return the data about a fact that was read only once."""
    spec = family_coverage.spec
    line_number, _ = spec.position(fact_path)
    return {
        "class": fact_class.value,
        "file": spec.file,
        "line": line_number,
        "path": spec.name_path(fact_path),
        "needed": fact_class.is_needed,
    }


def as_text(covered: Sequence[Coverage], checked: CheckedSpecs) -> str:
    """Return the coverage as text: a table of counts by class and by family, and the facts to read a second time.

    ``covered`` are the families in the table. Other checked families are listed as not read twice.
    """
    covered_names = {family_coverage.family.device.name for family_coverage in covered}
    family_names = [family.device.name for family in checked.families]
    uncovered_names = [name for name in family_names if name not in covered_names]
    lines: list[str] = []
    if covered:
        lines += ["facts by number of readings (*: two are required)", _table_line("", _COVERAGE_COLUMNS)]
        lines += [_table_line(name, astuple(times_read)) for name, times_read in _rows_of_table(covered)]
    if uncovered_names:
        lines.append(f"not read twice: {', '.join(uncovered_names)}")
    return "\n".join([*lines, *_second_reading_lines(covered)])


def _rows_of_table(covered: Sequence[Coverage]) -> Iterator[tuple[str, TimesRead]]:
    """Yield a name and the counts for each class of facts, for each family, and for all families.

    The name of a class ends with ``*`` if its facts need two readings.
    """
    for fact_class in FactClass:
        name = f"{fact_class.value} *" if fact_class.is_needed else fact_class.value
        yield name, add_counts(family_coverage.counts[fact_class] for family_coverage in covered)
    for family_coverage in covered:
        yield family_coverage.family.device.name, family_coverage.total
    if len(covered) > 1:
        yield "total", add_counts(family_coverage.total for family_coverage in covered)


def _table_line(name: str, cells: Sequence[object]) -> str:
    """Return a line of the table: the left-aligned name and the right-aligned cells."""
    columns = "".join(f"{cell!s:>11}" for cell in cells)
    return f"{name:<17}{columns}"


def _second_reading_lines(covered: Sequence[Coverage]) -> list[str]:
    """Return a line for each fact that needs a second reading, and a line with their number."""
    lines = []
    for family_coverage in covered:
        spec = family_coverage.spec
        for fact_class, path in family_coverage.lacking:
            line_number, column = spec.position(path)
            fact_name = spec.name_path(path)
            lines.append(f"{spec.file}:{line_number}:{column}: read once: {fact_class.value}, {fact_name}")
    if lines:
        lines.append(f"{count_with_unit(len(lines), 'fact')} to read a second time")
    return lines
