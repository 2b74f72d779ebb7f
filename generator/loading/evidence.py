"""Evidence and history of a spec: placeholders, how often its facts were read, and its versions with their changes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path

from ..language.problems import DocumentReport, ProblemReport
from ..language.rules.walk import is_placeholder, placeholder_names
from ..language.schema_files import coverage_path
from ..model import Device, Release, ReleasedChange, TimesRead
from ..say.plain_text import first_of
from .from_mapping import Raw

RULE = "coverage-file"


def read_counts(spec: Path, report: ProblemReport) -> TimesRead | None:
    """Return the counts stored next to a spec, or None if there are none.

    A file with other content is reported as edited.
    """
    file = coverage_path(spec)
    if not file.is_file():
        return None
    expected_keys = [member.name for member in fields(TimesRead)]
    try:
        counts = json.loads(file.read_text(encoding="utf-8"))
        has_expected_keys = set(counts) == set(expected_keys)
        if has_expected_keys and all(type(counts[name]) is int for name in expected_keys):
            return TimesRead(**counts)
    except (OSError, ValueError, TypeError, RecursionError):  # TypeError: the content is not a map.
        pass
    message = "the file was edited; write it again: codewheel check --coverage --write"
    report.add_at(str(file), 1, 1, RULE, message)
    return None


def counts_text(counts: TimesRead) -> str:
    """Return the counts in the format of the file."""
    return json.dumps(asdict(counts)) + "\n"


#: The only grade of a spec that is still being filled in.
_LOWEST_GRADE = "uncorroborated"
_MOST_NAMES = 3


def with_placeholders(raw_spec: Raw, device: Device, report: DocumentReport) -> Device:
    """Return the device with the names of its placeholders in its evidence. Report a grade that is too high.

    A placeholder is a text of the template that was not replaced. A spec with a placeholder can only have the lowest
    grade.
    """
    if not raw_spec.get("evidence"):
        return device
    names = placeholder_names(report.document.data)
    if is_placeholder(device.manufacturer.title):
        names.append("manufacturer.title")
    grade = device.evidence.grade
    if names and grade != _LOWEST_GRADE:
        message = f"the grade '{grade}' allows no values left over from the template: {first_of(names, _MOST_NAMES)}"
        remedy = f"replace each text with TODO, or write 'grade: {_LOWEST_GRADE}' until then"
        report.add("evidence-grade", ("evidence", "grade"), f"{message}; {remedy}")
    return replace(device, evidence=replace(device.evidence, placeholders=tuple(names)))


CHANGES_RULE = "changes-file"


def history_beside(spec: Path) -> Path:
    """Return the path of the history of a family: ``FAMILY.changes.json``."""
    return spec.with_name(f"{spec.stem}.changes.json")


def read_history(spec: Path, report: ProblemReport) -> tuple[Release, ...]:
    """Return the versions stored next to a spec, newest first, or none if the file is missing.

    A file with other content is reported as edited.
    """
    file = history_beside(spec)
    if not file.is_file():
        return ()
    try:
        history_data = json.loads(file.read_text(encoding="utf-8"))
        releases = tuple(_build_release(release) for release in history_data["releases"])
        if all(_has_only_texts(release) for release in releases):
            return releases
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        pass
    message = "the file was edited; undo the edit, or remove it and write it again: codewheel diff --record"
    report.add_at(str(file), 1, 1, CHANGES_RULE, message)
    return ()


def _build_release(release_data: dict[str, object]) -> Release:
    """Return a version from the data of the file.

    Raises:
        TypeError: The changes or names are not lists, or have other members than in the model.
        KeyError: There are no changes.
    """
    changes = release_data["changes"]
    if not isinstance(changes, list):
        raise TypeError
    released_changes = tuple(ReleasedChange(**change) for change in changes)
    names = release_data.get("names", [])
    if not isinstance(names, list):
        raise TypeError
    members = {**release_data, "changes": released_changes, "names": tuple(names)}
    return Release(**members)  # type: ignore[arg-type]


def _has_only_texts(release: Release) -> bool:
    """Return True if all members of a release and of its changes are texts."""
    texts: list[object] = [release.version, release.since, release.manual, *release.names]
    for change in release.changes:
        texts += asdict(change).values()
    return all(isinstance(text, str) for text in texts)


def with_release(releases: Sequence[Release], release: Release) -> tuple[Release, ...]:
    """Return the history with the version added first. An earlier record of the same version is replaced."""
    return (release, *(earlier_release for earlier_release in releases if earlier_release.version != release.version))


def history_text(releases: Sequence[Release]) -> str:
    """Return the history in the format of the file."""
    data = {"releases": [asdict(release) for release in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
