"""Files that ``diff --record`` writes: the version in the manufacturer's file, and each family's changes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..loading.history import history_beside, history_text, with_release
from ..loading.library import Family
from ..model import Manual, Release, ReleasedChange
from .change import Change
from .report import Found, outputs
from .version import Package

_VERSION = re.compile(r"^(version:[ \t]*)(['\"]?)[0-9.]+\2", re.MULTILINE)


class NotRecorded(ValueError):
    """A file cannot be updated. The message says which one."""


def records(found: Found, families: Sequence[Family]) -> Iterator[tuple[Path, str]]:
    """Yield the files to write with their new texts, except for manufacturers without changes.

    Raises:
        NotRecorded: A manufacturer's file has no version to replace.
    """
    for package in found.packages:
        own = [item for item in families if item.device.manufacturer.name == package.maker]
        changed = [(item, [each for each in found.changes if each.family == item.device.name]) for item in own]
        if not any(changes for _, changes in changed):
            continue
        yield from _version(package, {name for item in own for name in item.files - {item.document.file}})
        for item, changes in changed:
            if changes:
                release = _release(package, item.device.manual, changes)
                text = history_text(with_release(item.device.releases, release))
                yield history_beside(Path(item.document.file)), text


def _version(package: Package, files: set[str]) -> Iterator[tuple[Path, str]]:
    if package.new == package.stated:
        return
    for place in map(Path, sorted(files)):
        text, count = _VERSION.subn(rf'\g<1>"{package.new}"', place.read_text(encoding="utf-8"))
        if count != 1:
            raise NotRecorded(f'{place} has no line like version: "{package.stated}"; set it to {package.new} by hand')
        yield place, text


def _release(package: Package, manual: Manual, changes: Sequence[Change]) -> Release:
    about = f"{manual.revision}{f' of {manual.date}' if manual.date else ''}"
    kept = tuple(
        ReleasedChange(change.rule.name, change.impact.word, change.text, change.reach, outputs(change))
        for change in changes
    )
    return Release(package.new, package.old, about, kept)
