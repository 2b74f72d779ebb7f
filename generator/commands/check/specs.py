"""Check specs against their rules, the targets, and the second readings of their manuals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ...cache import NO_CACHE, Cache, content_of
from ...language.problems import Report
from ...language.schema_files import second_reading_path
from ...loading.library import Family, contents, is_clean, load_families
from ...loading.spec_files import family_files
from ...readings.second_readings import Coverage, Reader, SecondReading, comparable_specs, compare_readings, read_beside
from ...targets import Target
from ..editions import check_editions
from ..outputs import tell_unfit

#: Kind of entry for a family whose editions and second reading have no problems.
_CLEAN = "clean family"


@dataclass(frozen=True)
class Checked:
    """Families and second readings that were checked, with their problems."""

    families: Sequence[Family]
    readings: Sequence[Coverage]
    report: Report


def check_specs(paths: Sequence[Path], targets: Iterable[Target], cache: Cache = NO_CACHE) -> Checked:
    """Check the specs at ``paths`` and the second readings next to them.

    Families that are in the cache, which had no problems with the same content, are not checked again. Their second
    readings are then missing from the result.

    Raises:
        Stop: A target fails. The exit code is 1.
    """
    contents_before = contents(paths)
    clean = {file for file, content in contents_before.items() if cache.get(_CLEAN, content)}
    families, report = load_families(paths, cache)
    unproved = [family for family in families if family.plain is not None or family.document.file not in clean]
    check_editions(unproved, report)
    unproved_files = [family.document.file for family in unproved]
    checked = check_families(families, targets, report, partial(_read_second, unproved_files))
    for family in unproved:
        file = family.document.file
        unchanged = family.content and content_of(family_files(Path(file))) == contents_before[file]
        if unchanged and is_clean(family, report):
            cache.put(_CLEAN, contents_before[file], True)
    return checked


def _read_second(unproved_files: Sequence[str], family: Family, report: Report) -> SecondReading | None:
    """Read the second reading of a family that must be checked. For others, only list it as read."""
    if family.document.file in unproved_files:
        return read_beside(family, report)
    second = second_reading_path(Path(family.document.file))
    report.files += [str(second)] if second.is_file() else []
    return None


def check_families(
    families: Sequence[Family], targets: Iterable[Target], report: Report, read: Reader = read_beside
) -> Checked:
    """Check families against the targets and against the second readings next to their specs.

    Raises:
        Stop: A target fails. The exit code is 1.
    """
    sound = comparable_specs(families, report)
    tell_unfit(families, targets, report)
    return Checked(families, compare_readings(families, sound, report, read), report)
