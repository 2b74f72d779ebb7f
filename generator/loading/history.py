"""The versions of a family and their changes, as ``diff --record`` stores them next to the spec."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from ..language.problems import Report
from ..model import Release, ReleasedChange

RULE = "changes-file"


def history_beside(spec: Path) -> Path:
    """Return the path of the history of a family: ``FAMILY.changes.json``."""
    return spec.with_name(f"{spec.stem}.changes.json")


def read_history(spec: Path, report: Report) -> tuple[Release, ...]:
    """Return the versions stored next to a spec, newest first, or none if the file is missing or was changed."""
    file = history_beside(spec)
    if not file.is_file():
        return ()
    try:
        releases = tuple(_release(release) for release in json.loads(file.read_text(encoding="utf-8"))["releases"])
        if all(_is_text(release) for release in releases):
            return releases
    except (OSError, ValueError, TypeError, KeyError):
        pass
    message = "the file was edited; undo the edit, or remove it and write it again: codewheel diff --record"
    report.add_at(str(file), 1, 1, RULE, message)
    return ()


def _release(data: dict[str, object]) -> Release:
    changes = data["changes"]
    if not isinstance(changes, list):
        raise TypeError
    released_changes = tuple(ReleasedChange(**change) for change in changes)
    return Release(**{**data, "changes": released_changes})  # type: ignore[arg-type]


def _is_text(release: Release) -> bool:
    texts = (release.version, release.since, release.manual)
    parts = (text for change in release.changes for text in asdict(change).values())
    return all(isinstance(text, str) for text in (*texts, *parts))


def with_release(releases: Sequence[Release], release: Release) -> tuple[Release, ...]:
    """Return the history with the version added first. An earlier record of the same version is replaced."""
    return (release, *(earlier_release for earlier_release in releases if earlier_release.version != release.version))


def history_text(releases: Sequence[Release]) -> str:
    """Return the history in the format of the file."""
    data = {"releases": [asdict(release) for release in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
