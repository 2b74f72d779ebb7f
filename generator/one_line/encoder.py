"""Build the device that a line describes, through its spec, so that every command works on it."""

from __future__ import annotations

from dataclasses import replace

from ..language.problems import Problem, ProblemReport
from ..language.read import document_of_text
from ..loading.library import families_of
from ..model import Device
from ..order_codes.labels import LabelMatch
from .line import EncoderLine, LineError, LineProblem
from .parse import parse_line
from .spec import spec_text

#: Names of the family and of the manufacturer. No output contains them.
_FAMILY_NAME, _MANUFACTURER_NAME = "one_line", "example"
_MANUFACTURER_TEXT = f"codewheel: 1\nmanufacturer: {_MANUFACTURER_NAME}\ntitle: manufacturer not stated\nsource: line\n"


def device_of_line(text: str) -> tuple[Device, LabelMatch]:
    """Return the device that a line describes, and its order code, which is the line itself.

    Raises:
        LineError: The line has problems.
    """
    line = parse_line(text)
    report = ProblemReport()
    texts = {
        f"{_FAMILY_NAME}.yaml": spec_text(line, _FAMILY_NAME, _MANUFACTURER_NAME),
        "manufacturer.yaml": _MANUFACTURER_TEXT,
    }
    documents = [document_of_text(file, file_text, report) for file, file_text in texts.items()]
    families = families_of([document for document in documents if document is not None], report)
    if report or not families:
        raise LineError(line.text, _problems_in_line(line, report))
    device = families[0].device
    variant = replace(device.variants[0], code=line.text)
    # Placeholders are facts that the line does not state. Outputs for one line state this themselves.
    evidence = replace(device.evidence, placeholders=())
    device = replace(device, variants=(variant,), evidence=evidence, title="Encoder described in one line")
    return device, LabelMatch(variant, unlisted=(), tail="", special=False)


def _problems_in_line(line: EncoderLine, report: ProblemReport) -> list[LineProblem]:
    """Return the problems in the spec of a line as problems of the line, each at the column of its field."""
    column_by_field = {field.name: field.column for field in line.fields}
    return [LineProblem(_column_of(problem, column_by_field), problem.message) for problem in report.problems]


def _column_of(problem: Problem, column_by_field: dict[str, int]) -> int:
    """Return the column of the field that the path of a problem names, or 1 if it names no field of the line."""
    _, _, path_in_fields = problem.path.partition(".fields.")
    field_name = path_in_fields.partition(".")[0]
    return column_by_field.get(field_name, 1)
