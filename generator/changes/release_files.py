"""Files about a release: changes that a maintainer has accepted, and the files of ``diff --record``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from ..language.document import Document
from ..language.problems import Report, listed, quoted, suggestion
from ..language.read import read_document
from ..loading.history import history_beside, history_text, with_release
from ..loading.overlays import Family
from ..model import Manual, Release, ReleasedChange
from .change import Change, Package
from .report import DiffResult, outputs
from .rules import RULES

#: Name of the file next to the new specs.
NAME = "accepted.yaml"
_KEYS = ("family", "rule", "path", "why", "until")


class NotAccepted(ValueError):
    """The file with accepted changes is not valid. The message says where and why."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """An accepted change. It counts again after the day ``until``."""

    family: str
    rule: str
    path: str
    why: str
    until: date

    def covers(self, change: Change) -> bool:
        return (self.family, self.rule, self.path) == (change.family, change.rule.name, change.path)


def read_accepted(file: Path) -> list[Accepted]:
    """Return the accepted changes in a file.

    Raises:
        NotAccepted: The file cannot be read, or an entry lacks a key, names no rule of ``diff``, or has no date.
    """
    report = Report()
    document = read_document(file, report)
    if document is None or report:
        raise NotAccepted(report.problems[0].format().splitlines()[0])
    entries = document.data.get("accepted")
    if set(document.data) != {"accepted"} or not isinstance(entries, list):
        raise NotAccepted(f"{file}:1: the file must have only the key 'accepted', with a list of accepted changes")
    return [_entry(document, index, definition) for index, definition in enumerate(entries)]


def _entry(document: Document, index: int, definition: object) -> Accepted:
    location = f"{document.file}:{document.position(('accepted', index))[0]}"
    if not isinstance(definition, dict) or set(definition) != set(_KEYS) or not _has_texts(definition):
        raise NotAccepted(f"{location}: an accepted change has the keys {listed(_KEYS)}, each with text")
    rule, until = definition["rule"], definition["until"]
    if rule not in RULES:
        raise NotAccepted(f"{location}: there is no rule {quoted(rule)}{suggestion(rule, RULES)}")
    try:
        return Accepted(**{**definition, "until": date.fromisoformat(until)})
    except ValueError:
        raise NotAccepted(f"{location}: 'until' is a date such as 2027-03-31, not {quoted(until)}") from None


def _has_texts(definition: dict[object, object]) -> bool:
    return all(isinstance(value, str) for value in definition.values())


def still_open(
    changes: Sequence[Change], accepted: Sequence[Accepted], today: date
) -> tuple[list[Change], Sequence[str]]:
    """Return the changes without a valid entry on this day, and a notice about each entry."""
    current = [acceptance for acceptance in accepted if acceptance.until >= today]
    open_changes = [change for change in changes if not _is_accepted(change, current)]
    return open_changes, tuple(_notices(changes, accepted, today))


def _is_accepted(change: Change, accepted: Sequence[Accepted]) -> bool:
    return any(acceptance.covers(change) for acceptance in accepted)


def _notices(changes: Sequence[Change], accepted: Sequence[Accepted], today: date) -> Iterator[str]:
    for acceptance in accepted:
        name = f"{acceptance.family}: {acceptance.rule} {acceptance.path}"
        if not any(map(acceptance.covers, changes)):
            yield f"accepted, but not found: {name}{_suggestion(acceptance, changes)}"
        elif acceptance.until < today:
            yield f"accepted until {acceptance.until} only, so asked again: {name}: {acceptance.why}"
        else:
            yield f"accepted until {acceptance.until}: {name}: {acceptance.why}"


def _suggestion(acceptance: Accepted, changes: Sequence[Change]) -> str:
    """Return a suggestion for the family of an entry if it has no changes, or else for the path."""
    families = {change.family for change in changes}
    if acceptance.family not in families:
        return suggestion(acceptance.family, sorted(families), "families with changes")
    of_family = [change for change in changes if change.family == acceptance.family]
    paths = (change.path for change in of_family if change.rule.name == acceptance.rule)
    return suggestion(acceptance.path, paths, "paths of this rule")


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
