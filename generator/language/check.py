"""Check documents against the schema, then against every rule, and report all problems at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .document import Document
from .files import family_of
from .keys_of_specs import WrittenSpec
from .problems import MAX_FOUND, TOO_MANY, DocumentReport, Path, ProblemReport
from .rules import FOUNDATIONS, RULES, SHAPES
from .rules.master import check_master
from .rules.numbers import check_number_base
from .rules.order_code import are_codes_complete
from .schema_check import SOME_SOURCE, FileKind, SchemaResult, check_schema, data_without_paths, path_to_remove
from .schemas import PROSE, schema_without_references

#: Stand-ins for missing keys at the top level, so that the rest can be built and checked.
_STAND_INS: dict[str, Any] = {
    "title": "",
    "movement": "rotary",
    "manufacturer": "",
    "manual": {"title": "", "revision": "", "language": "en"},
    "interfaces": {},
}
#: Order codes and parameters of a device if they are broken.
_EMPTY_CODES_AND_PARAMETERS: dict[str, Any] = {"parameters": {}, "order_code": {"pattern": "", "parts": []}}


def check_document(document: Document, report: ProblemReport) -> dict[str, Any] | None:
    """Check a document and add its problems to ``report``.

    Returns:
        The data without the broken parts, which can be built to find further problems. If the order codes or
        parameters of a device are broken, both are empty. None if nothing can be built: a device with too many
        problems, or a file of another kind with any.
    """
    schema_result = check_schema(document, report)
    if schema_result is None:
        return None
    if schema_result.file_kind is FileKind.DEVICE:
        return _remove_broken_parts(schema_result, document, report)
    problems_before = len(report)
    if schema_result.file_kind is FileKind.MASTER:
        check_master(schema_result.data, report.for_document(document))
    check_number_base(WrittenSpec(schema_result.data), report.for_document(document))
    return schema_result.data if schema_result.is_complete and len(report) == problems_before else None


def check_overlay(document: Document, report: ProblemReport) -> bool:
    """Check an overlay by itself, and return True if it has no errors, so that it can be applied to a spec."""
    schema_result = check_schema(document, report, FileKind.OVERLAY)
    return (
        schema_result is not None
        and schema_result.is_complete
        and not schema_result.removed_paths
        and not report.faults(document)
    )


def check_second(document: Document, report: ProblemReport) -> dict[str, Any] | None:
    """Check a second reading. Stand-ins replace the prose that it lacks.

    Returns:
        The same as ``check_document``.
    """
    schema_result = check_schema(document, report, FileKind.SECOND)
    return _remove_broken_parts(schema_result, document, report) if schema_result is not None else None


class _TooManyProblems(Exception):
    """A document has the largest number of problems, so no further rule is checked."""


class _RecordingReport(DocumentReport):
    """A report that records the places in which a rule has found problems, as paths in the file."""

    def __init__(self, report: ProblemReport, document: Document) -> None:
        super().__init__(report, document)
        self.reported_paths_of_rule: list[Path] = []
        self._problems_before = len(report)

    def add(self, rule: str, path: Path, message: str, *, at_key: bool = False, cause: str = "") -> None:
        """Add a problem at ``path``.

        Raises:
            _TooManyProblems: The rules have already reported the largest number of problems. One that says so is added.
        """
        if len(self) - self._problems_before >= MAX_FOUND:
            super().add(TOO_MANY, path, "there are more problems; they are reported once these are fixed")
            raise _TooManyProblems
        self.reported_paths_of_rule.append(self.document.path_in_file(path))
        super().add(rule, path, message, at_key=at_key, cause=cause)

    def mark(self, path: Path) -> None:
        """Mark a place as faulty without a message, because another problem explains it."""
        self.reported_paths_of_rule.append(self.document.path_in_file(path))
        super().mark(path)


def _remove_broken_parts(
    schema_result: SchemaResult, document: Document, report: ProblemReport
) -> dict[str, Any] | None:
    """Return the data of a device without the broken parts, or None if it has too many problems."""
    try:
        return _check_device(schema_result, document, report)
    except _TooManyProblems:
        return None


def _check_device(schema_result: SchemaResult, document: Document, report: ProblemReport) -> dict[str, Any]:
    """Check a device with every rule, and return its data without the parts that cannot be built.

    If a rule in ``FOUNDATIONS`` reports order codes or parameters, the result has neither. A rule in ``SHAPES`` that
    reports a problem removes the part with the problem. Other rules remove nothing.

    Raises:
        _TooManyProblems: It has too many problems.
    """
    has_valid_codes = are_codes_complete(schema_result.data, document.data)
    report.mark(document, schema_result.removed_paths)
    all_removed_paths = set(schema_result.removed_paths)
    completed_data = _with_prose(schema_result.data, schema_result.file_kind)
    recording_report = _RecordingReport(report, document)
    spec = WrittenSpec(completed_data, with_invalid_parts=WrittenSpec(document.data))
    for rule in RULES:
        recording_report.reported_paths_of_rule = []
        rule(spec, recording_report)
        reported_paths = recording_report.reported_paths_of_rule
        reports_codes_or_parameters = any(path[0] in _EMPTY_CODES_AND_PARAMETERS for path in reported_paths)
        if rule in FOUNDATIONS and reports_codes_or_parameters:
            has_valid_codes = False
        if rule in SHAPES:
            all_removed_paths.update(path_to_remove(path) for path in reported_paths)
    if all_removed_paths != schema_result.removed_paths:
        remaining_data = data_without_paths(document, all_removed_paths, schema_result.stand_ins)
        completed_data = _with_prose(remaining_data, schema_result.file_kind)
    return _with_stand_ins(completed_data, has_valid_codes, document)


def _with_prose(checked_data: dict[str, Any], file_kind: FileKind) -> dict[str, Any]:
    """Return the data of a file. In a second reading, add stand-ins for the prose that only device files must have."""
    if file_kind is not FileKind.SECOND:
        return checked_data
    completed_data: dict[str, Any] = with_stand_ins(checked_data, schema_without_references(FileKind.DEVICE.value))
    return completed_data


def _with_stand_ins(checked_data: dict[str, Any], has_valid_codes: bool, document: Document) -> dict[str, Any]:
    """Return the data of a device with stand-ins for missing keys of the file and of its interfaces.

    If ``has_valid_codes`` is False, order codes or parameters are invalid, and the result has neither.
    """
    family = document.family or family_of(document.file)
    # Later maps take precedence: a stand-in is used only for a key that the data lack.
    completed_data = {"device": family, **_STAND_INS, **checked_data}
    if not has_valid_codes:
        completed_data |= _EMPTY_CODES_AND_PARAMETERS
    interfaces = completed_data["interfaces"]
    completed_data["interfaces"] = {
        interface_name: {"layouts": [], **interface} for interface_name, interface in interfaces.items()
    }
    return completed_data


def with_stand_ins(file_data: Any, schema: Mapping[str, Any]) -> Any:
    """Return the data of a second reading with a stand-in for each missing key for prose that device files must have.

    ``schema`` is the schema of the same data in device files, without references.
    """
    if isinstance(file_data, list):
        return [with_stand_ins(list_item, schema.get("items", {})) for list_item in file_data]
    if not isinstance(file_data, dict):
        return file_data
    schema_by_key = schema.get("properties", {})
    schema_of_other_keys = schema.get("additionalProperties")
    if not isinstance(schema_of_other_keys, dict):  # False: no other keys are allowed.
        schema_of_other_keys = {}
    completed_data = {}
    for key, value in file_data.items():
        completed_data[key] = with_stand_ins(value, schema_by_key.get(key) or schema_of_other_keys)
    for key in schema.get("required", ()):
        if key not in completed_data and key in PROSE:
            completed_data[key] = SOME_SOURCE if key == "source" else "?"
    return completed_data
