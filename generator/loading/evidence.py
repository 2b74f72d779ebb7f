"""Evidence of a spec: placeholders that are left, and how often its facts were read."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, replace
from pathlib import Path

from ..language.document import is_placeholder, placeholder_names
from ..language.problems import DocumentReport, Report
from ..language.schema_files import coverage_path
from ..model import Device, TimesRead
from ..say.plain_text import first_of
from .from_mapping import Raw

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


#: The only grade of a spec that is still being filled in.
_LOWEST_GRADE = "uncorroborated"
_MOST_NAMES = 3


def with_placeholders(raw: Raw, device: Device, report: DocumentReport) -> Device:
    """Return the device with the names of its placeholders in its evidence. Report a grade that is too high."""
    if not raw.get("evidence"):
        return device
    names = placeholder_names(report.document.data)
    if is_placeholder(device.manufacturer.title):
        names.append("manufacturer.title")
    grade = device.evidence.grade
    if names and grade != _LOWEST_GRADE:
        message = (
            f"the grade '{grade}' cannot have values that are still the template's: {first_of(names, _MOST_NAMES)}"
        )
        remedy = f"replace each text with TODO, or write 'grade: {_LOWEST_GRADE}' until then"
        report.add("evidence-grade", ("evidence", "grade"), f"{message}; {remedy}")
    return replace(device, evidence=replace(device.evidence, placeholders=tuple(names)))
