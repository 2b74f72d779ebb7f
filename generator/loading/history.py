"""The versions of a family and what each changed, as ``diff --record`` keeps them beside the spec."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from ..language.problems import Report
from ..model import Release, ReleasedChange

RULE = "changes-file"


def history_beside(spec: Path) -> Path:
    """Where the history of a family is kept: ``FAMILY.changes.json``."""
    return spec.with_name(f"{spec.stem}.changes.json")


def read_history(spec: Path, report: Report) -> tuple[Release, ...]:
    """The versions kept beside a spec, the newest first; none where there is no file, or it is not what was written."""
    place = history_beside(spec)
    if not place.is_file():
        return ()
    try:
        found = tuple(_release(item) for item in json.loads(place.read_text(encoding="utf-8"))["releases"])
        if all(_is_text(release) for release in found):
            return found
    except (OSError, ValueError, TypeError, KeyError):
        pass
    wrong = (
        "this is not what was written; take back your edit, or remove the file and write it: codewheel diff --record"
    )
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
    """The history with one more version before the others; one that was recorded before is recorded anew."""
    return (release, *(item for item in releases if item.version != release.version))


def history_text(releases: Sequence[Release]) -> str:
    """The history as the file has it."""
    data = {"releases": [asdict(item) for item in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
