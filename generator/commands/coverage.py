"""``codewheel check --coverage``: count how often each fact of the specs was read."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, astuple
from pathlib import Path
from typing import Any

from ..cache import NO_CACHE, Cache, content_of
from ..language.problems import Report
from ..language.second_reading import coverage_path
from ..loading.family_files import family_files
from ..loading.library import Family
from ..loading.reading_counts import RULE, counts_text
from ..model import TimesRead
from ..readings.coverage import Coverage, added
from ..readings.fact import Sort
from ..say.words import counted
from .check import Checked, look_at
from .editions import check_all
from .terminal import Stop

#: Kind of entry for a family that may be released.
_PROVED = "proved family"
_HEADINGS = ("twice", "explained", "decided", "once", "derived")
_OLD = "the counts do not match the readings; update them with codewheel check --coverage --write"


def cover(checked: Checked, write: bool) -> Sequence[Coverage]:
    """Return the coverage. Write the counts next to the specs, or report those that are out of date."""
    for reading in checked.readings:
        place = coverage_path(Path(reading.spec.file))
        if write:
            place.write_text(counts_text(reading.total), encoding="utf-8")
        elif place.is_file() and place.read_text(encoding="utf-8") != counts_text(reading.total):
            checked.report.add_at(str(place), 1, 1, RULE, _OLD)
    return checked.readings


def refuse_unproved(families: Sequence[Family], participle: str, cache: Cache = NO_CACHE) -> None:
    """Refuse to release valid specs if ``check`` finds problems in their other editions, second readings or counts.

    Args:
        families: Families whose specs have no other problems.
        participle: Participle of the refused action, such as ``written``.
        cache: Cache of families without such problems. They are not checked again until a file changes.

    Raises:
        Stop: There are problems. The exit code is 1.
    """
    report = Report()
    # Check one family at a time, because a second reading needs as much memory as its spec.
    for family in families:
        if family.content and cache.get(_PROVED, family.content) is True:
            continue
        problems_before = len(report)
        check_all([family], report)
        cover(look_at([family], (), report), write=False)
        # A second reading may have changed since the content was read.
        is_same = family.content and content_of(family_files(Path(family.document.file))) == family.content
        if is_same and len(report) == problems_before:
            cache.put(_PROVED, family.content, True)
    if report:
        for problem in report.shown:
            print(problem.format(), file=sys.stderr)
        problems = f"'codewheel check --coverage' reports {counted(len(report), 'problem')}"
        raise Stop(f"nothing {participle}: {problems}; correct them, or add --unchecked", 1)


def is_complete(covered: Sequence[Coverage], report: Report) -> bool:
    """Return whether there are no problems and every fact that needs two readings has them."""
    return not report and not any(family_coverage.lacking for family_coverage in covered)


def as_data(covered: Sequence[Coverage]) -> dict[str, Any]:
    """Return the coverage in the form that ``--json`` prints."""
    return {
        "coverage": [_family_data(family_coverage) for family_coverage in covered],
        "total": asdict(added(family_coverage.total for family_coverage in covered)),
    }


def _family_data(family_coverage: Coverage) -> dict[str, Any]:
    once = [
        {
            "class": sort.value,
            "file": family_coverage.spec.file,
            "line": family_coverage.spec.position(place)[0],
            "path": family_coverage.spec.name_path(place),
            "needed": sort.is_needed,
        }
        for sort, place in family_coverage.once
    ]
    classes = {sort.value: asdict(count) | {"needed": sort.is_needed} for sort, count in family_coverage.counts.items()}
    return {
        "family": family_coverage.family.device.name,
        "classes": classes,
        "total": asdict(family_coverage.total),
        "once": once,
    }


def as_text(covered: Sequence[Coverage], checked: Checked) -> str:
    """Return the coverage as text: by class, by family, and the facts that need a second reading."""
    unread_families = [family.device.name for family in checked.families if family.device.name not in _names(covered)]
    without = [f"not read twice: {', '.join(unread_families)}"] if unread_families else []
    if not covered:
        return "\n".join(without)
    rows = [(f"{sort.value}{' *' if sort.is_needed else ''}", count) for sort, count in _by_class(covered).items()]
    rows += [(family_coverage.family.device.name, family_coverage.total) for family_coverage in covered]
    rows += [("total", added(family_coverage.total for family_coverage in covered))] if len(covered) > 1 else []
    lines = ["facts by number of readings (*: two are required)", _line("", _HEADINGS)]
    lines += [_line(name, astuple(count)) for name, count in rows]
    return "\n".join([*lines, *without, *_lacking(covered)])


def _names(covered: Sequence[Coverage]) -> set[str]:
    return {family_coverage.family.device.name for family_coverage in covered}


def _by_class(covered: Sequence[Coverage]) -> Mapping[Sort, TimesRead]:
    return {sort: added(family_coverage.counts[sort] for family_coverage in covered) for sort in Sort}


def _line(name: str, cells: Sequence[object]) -> str:
    return f"{name:<17}" + "".join(f"{cell:>11}" for cell in map(str, cells))


def _lacking(covered: Sequence[Coverage]) -> list[str]:
    lines = []
    for coverage in covered:
        for sort, place in coverage.lacking:
            line, column = coverage.spec.position(place)
            lines.append(
                f"{coverage.spec.file}:{line}:{column}: read once: {sort.value}, {coverage.spec.name_path(place)}"
            )
    return [*lines, f"{counted(len(lines), 'fact')} to read a second time"] if lines else []
