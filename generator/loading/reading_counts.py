"""Counts of how often the facts of a spec were read, as ``check --coverage --write`` stores them next to the spec."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path

from ..language.problems import Report
from ..language.schema_files import coverage_path
from ..model import TimesRead

RULE = "coverage-file"


def read_counts(spec: Path, report: Report) -> TimesRead | None:
    """Return the counts stored next to a spec, or None if there are none or the file was changed."""
    file = coverage_path(spec)
    if not file.is_file():
        return None
    names = [member.name for member in fields(TimesRead)]
    try:
        counts = json.loads(file.read_text(encoding="utf-8"))
        if set(counts) == set(names) and all(type(counts[name]) is int for name in names):
            return TimesRead(**counts)
    except (OSError, ValueError, TypeError):
        pass
    message = "the file was edited; write it again: codewheel check --coverage --write"
    report.add_at(str(file), 1, 1, RULE, message)
    return None


def counts_text(counts: TimesRead) -> str:
    """Return the counts in the format of the file."""
    return json.dumps(asdict(counts)) + "\n"
