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
    place = history_beside(spec)
    if not place.is_file():
        return ()
    try:
        found = tuple(_release(item) for item in json.loads(place.read_text(encoding="utf-8"))["releases"])
        if all(_is_text(release) for release in found):
            return found
    except (OSError, ValueError, TypeError, KeyError):
        pass
    wrong = "the file was edited; undo the edit, or remove it and write it again: codewheel diff --record"
    report.add_at(str(place), 1, 1, RULE, wrong)
    return ()


def _release(item: dict[str, object]) -> Release:
    changes = item["changes"]
    if not isinstance(changes, list):
        raise TypeError
    made = tuple(ReleasedChange(**change) for change in changes)
    return Release(**{**item, "changes": made})  # type: ignore[arg-type]


def _is_text(release: Release) -> bool:
    texts = (release.version, release.since, release.manual)
    parts = (text for change in release.changes for text in asdict(change).values())
    return all(isinstance(text, str) for text in (*texts, *parts))


def with_release(releases: Sequence[Release], release: Release) -> tuple[Release, ...]:
    """Return the history with the version added first. An earlier record of the same version is replaced."""
    return (release, *(item for item in releases if item.version != release.version))


def history_text(releases: Sequence[Release]) -> str:
    """Return the history in the format of the file."""
    data = {"releases": [asdict(item) for item in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
