"""Add the placeholders of a spec to its evidence, and check that its grade allows them."""

from __future__ import annotations

from dataclasses import replace

from ..language.document import is_placeholder, placeholder_names
from ..language.problems import DocumentReport
from ..model import Device
from ..say.numbers import first_of
from .from_mapping import Raw

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
