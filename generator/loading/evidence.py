"""Evidence and history of a spec: its placeholders, the number of readings of each fact, and its released versions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path

from ..language.problems import DocumentReport, ProblemReport
from ..language.rules.walk import is_placeholder, placeholder_names
from ..language.schema_files import coverage_path
from ..model import Device, Release, ReleasedChange, TimesRead
from ..say import first_of
from .from_mapping import Raw

RULE = "coverage-file"


def read_counts(spec: Path, report: ProblemReport) -> TimesRead | None:
    """Return how often the facts of a spec were read from the manual, from a file next to it, or None without a file.

    If the file does not contain such counts, it is reported as edited.
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
    except (OSError, ValueError, TypeError, RecursionError):  # A TypeError means that the content is not a map.
        pass
    message = "the file was edited; write it again: codewheel check --coverage --write"
    report.add_at(str(file), RULE, message)
    return None


def counts_text(counts: TimesRead) -> str:
    """Return the counts in the format of the file."""
    return json.dumps(asdict(counts)) + "\n"


#: The only grade of a spec that is still being filled in.
_LOWEST_GRADE = "uncorroborated"
#: Highest number of placeholders that a message names.
_MAX_SHOWN_NAMES = 3


def with_placeholders(raw_spec: Raw, device: Device, report: DocumentReport) -> Device:
    """Return the device with its placeholders listed in its evidence, and report a grade that is too high.

    A placeholder is a text from the template for new specs that was not replaced. A spec with placeholders can only
    have the lowest grade.
    """
    if not raw_spec.get("evidence"):
        return device
    names = placeholder_names(report.document.data)
    if is_placeholder(device.manufacturer.title):
        names.append("manufacturer.title")
    grade = device.evidence.grade
    if names and grade != _LOWEST_GRADE:
        names_text = first_of(names, _MAX_SHOWN_NAMES)
        message = f"values left over from the template are not allowed with grade '{grade}': {names_text}"
        remedy = f"replace every text that contains TODO, or write 'grade: {_LOWEST_GRADE}' until all are replaced"
        report.add("evidence-grade", ("evidence", "grade"), f"{message}; {remedy}")
    return replace(device, evidence=replace(device.evidence, placeholders=tuple(names)))


CHANGES_RULE = "changes-file"


def history_beside(spec: Path) -> Path:
    """Return the path of the history of a family: ``FAMILY.changes.json``."""
    return spec.with_name(f"{spec.stem}.changes.json")


def read_history(spec: Path, report: ProblemReport) -> tuple[Release, ...]:
    """Return the released versions of a spec, newest first, from a file next to it, or ``()`` without a file.

    If the file does not contain such versions, it is reported as edited.
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
    report.add_at(str(file), CHANGES_RULE, message)
    return ()


def _build_release(release_data: dict[str, object]) -> Release:
    """Return a released version from its data in the file.

    Raises:
        TypeError: The changes or names are not lists, or their members differ from the model.
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
    """Return whether all members of a released version and of its changes are texts."""
    texts: list[object] = [release.version, release.since, release.manual, *release.names]
    for change in release.changes:
        texts += asdict(change).values()
    return all(isinstance(text, str) for text in texts)


def with_release(releases: Sequence[Release], release: Release) -> tuple[Release, ...]:
    """Return the history with a new version at its beginning. An earlier record of the same version is replaced."""
    other_releases = [other_release for other_release in releases if other_release.version != release.version]
    return (release, *other_releases)


def history_text(releases: Sequence[Release]) -> str:
    """Return the history in the format of the file."""
    data = {"releases": [asdict(release) for release in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
