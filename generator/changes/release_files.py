"""Files that ``diff --record`` writes: the version in the manufacturer's file, and each family's changes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..loading.history import history_beside, history_text, with_release
from ..loading.library import Family
from ..model import Manual, Release, ReleasedChange
from .change import Change
from .report import DiffResult, outputs
from .version import Package

_VERSION = re.compile(r"^(version:[ \t]*)(['\"]?)[0-9.]+\2", re.MULTILINE)


class NotRecorded(ValueError):
    """A file cannot be updated. The message says which one."""


def records(findings: DiffResult, families: Sequence[Family]) -> Iterator[tuple[Path, str]]:
    """Yield the files to write with their new texts, except for manufacturers without changes.

    Raises:
        NotRecorded: A manufacturer's file has no version to replace.
    """
    for package in findings.packages:
        families_of_maker = [family for family in families if family.device.manufacturer.name == package.maker]
        changed_names = {change.family for change in findings.changes}
        changed_families = [family for family in families_of_maker if family.device.name in changed_names]
        if not changed_families:
            continue
        files: set[str] = set()
        for family in families_of_maker:
            files |= family.files - {family.document.file}
        yield from _version_text(package, files)
        for family in changed_families:
            changes = [change for change in findings.changes if change.family == family.device.name]
            release = _release(package, family.device.manual, changes)
            text = history_text(with_release(family.device.releases, release))
            yield history_beside(Path(family.document.file)), text


def _version_text(package: Package, files: set[str]) -> Iterator[tuple[Path, str]]:
    if package.new == package.stated:
        return
    for file in map(Path, sorted(files)):
        text, count = _VERSION.subn(rf'\g<1>"{package.new}"', file.read_text(encoding="utf-8"))
        if count != 1:
            raise NotRecorded(f'{file} has no line like version: "{package.stated}"; set it to {package.new} by hand')
        yield file, text


def _release(package: Package, manual: Manual, changes: Sequence[Change]) -> Release:
    manual_text = f"{manual.revision}{f' of {manual.date}' if manual.date else ''}"
    return Release(package.new, package.old, manual_text, tuple(map(_released_change, changes)))


def _released_change(change: Change) -> ReleasedChange:
    return ReleasedChange(change.rule.name, change.impact.word, change.text, change.reach, outputs(change))
