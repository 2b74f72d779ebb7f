"""The check of a file against its JSON Schema, and the migration of keys that had another name.

Most files pass a quick test (see ``schemas.py``). For others, jsonschema finds the errors. Editors use the same JSON
Schemas. We write our own messages, because the messages of a validator talk about instances and properties to someone
who is transcribing a manual.
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from .document import Document, Path
from .files import is_second
from .messages import RENAMED, RuleFinding, explain
from .problems import MAX_PROBLEMS, MISSING_PROSE, TOO_MANY, WORDS_ONLY, ProblemReport
from .schemas import follows_schema, load_schema, matches, schema_without_references
from .yaml_text import LINE_BREAK

if TYPE_CHECKING:
    from jsonschema import ValidationError

#: A source that passes every rule.
SOME_SOURCE = "Cover"


class FileKind(Enum):
    """Kind of file. Each kind has a schema of its name. The schema of second readings is derived from ``device``."""

    DEVICE = "device"
    SECOND = "second"
    MANUFACTURER = "manufacturer"
    MASTER = "master"
    OVERLAY = "overlay"
    WORDS = "words"


@dataclass(frozen=True, slots=True)
class SchemaResult:
    """Result of the schema check.

    ``data`` is a deep copy without the broken parts. It follows the schema, except that keys may be missing at the top
    level or at the top level of an interface. ``is_complete`` is set if none is missing. ``removed_paths`` contains
    the paths of the broken parts, and ``stand_ins`` the stand-ins for missing prose, keyed by the path of the item. The
    document records which list items were removed, so that paths into ``data`` still find their lines.
    """

    data: dict[str, Any]
    file_kind: FileKind
    is_complete: bool
    removed_paths: frozenset[Path] = frozenset()
    stand_ins: Mapping[Path, Mapping[str, str]] = field(default_factory=dict)


def check_schema(document: Document, report: ProblemReport, file_kind: FileKind | None = None) -> SchemaResult | None:
    """Check a document against the schema of its kind, report each error, and remove the broken parts.

    Args:
        document: The document.
        report: Receives all problems.
        file_kind: The kind of file. Default: derived from its keys.

    Returns:
        The remaining data, or None if the kind of file cannot be derived, or the file has too many errors.
    """
    file_kind = file_kind or _kind_of_file(document.data)
    if file_kind is None:
        message = (
            "'device' is missing; a device file names its family with 'device', and a manufacturer file has only"
            " 'manufacturer'"
        )
        report.add("missing-key", document, (), message)
        return None
    document.kept_indices.clear()
    unread_paths = set(document.broken)
    if not unread_paths and follows_schema(document.data, schema_without_references(file_kind.value)):
        return SchemaResult(data_without_paths(document, frozenset()), file_kind, is_complete=True)
    validator = _build_validator(file_kind.value)
    findings = _collect_findings(validator, document.data, unread_paths, file_kind.value)
    _report_findings(findings, document, report)
    if len(findings) > MAX_PROBLEMS:
        return None
    if not findings and not unread_paths:
        return SchemaResult(data_without_paths(document, frozenset()), file_kind, is_complete=True)
    return _remove_broken_items(validator, document, _paths_to_remove(unread_paths, findings), file_kind)


def _paths_to_remove(unread_paths: set[Path], findings: Sequence[RuleFinding]) -> set[Path]:
    """Return the places of a document with errors that later checks cannot use.

    A missing key of a file or an interface, and missing prose, are tolerated. If the part with an error can still be
    used, as with an extra key, only the place of the error itself is removed.
    """
    removed_paths = set(map(path_to_remove, unread_paths))
    for finding in findings:
        if _can_be_incomplete(finding.path) or _is_missing_prose(finding):
            continue
        removed_paths.add(finding.path if finding.is_rest_usable else path_to_remove(finding.path))
    return removed_paths


def _report_findings(findings: Sequence[RuleFinding], document: Document, report: ProblemReport) -> None:
    """Report each finding that no other finding explains. If there are too many, report only the first ones."""
    for finding in findings[:MAX_PROBLEMS]:
        if not _is_explained(finding, findings, document.data):
            in_words = _is_missing_prose(finding)
            report.add(finding.rule, document, finding.path, finding.message, at_key=finding.at_key, in_words=in_words)
    if len(findings) > MAX_PROBLEMS:
        message = "there are more problems from here on; they are reported once these are fixed"
        report.add(TOO_MANY, document, findings[MAX_PROBLEMS].path, message)


def renamed_keys(document: Document) -> list[tuple[Path, str]]:
    """Return the paths of keys that had another name in earlier versions of the language, with their current names.

    A key is renamed where the schema has the new name and not the old one. The keys are in the order of the file.
    """
    file_kind = FileKind.SECOND if is_second(document.file) else _kind_of_file(document.data)
    if file_kind is None or follows_schema(document.data, schema_without_references(file_kind.value)):
        return []
    new_name_by_path: dict[Path, str] = {}
    for error in _build_validator(file_kind.value).iter_errors(document.data):
        has_unknown_key = error.validator == "additionalProperties" and "properties" in error.schema
        if not has_unknown_key:
            continue
        known_keys = error.schema["properties"]
        map_with_unknown_key = error.instance
        for old_name, new_name in RENAMED.items():
            is_old_name = old_name in map_with_unknown_key and old_name not in known_keys
            if is_old_name and new_name in known_keys and new_name not in map_with_unknown_key:
                new_name_by_path[(*error.absolute_path, old_name)] = new_name

    def position_of(renamed: tuple[Path, str]) -> tuple[int, int]:
        path, _ = renamed
        return document.position(path, at_key=True)

    return sorted(new_name_by_path.items(), key=position_of)


def _kind_of_file(file_data: dict[str, Any]) -> FileKind | None:
    """Return the kind of a file by its keys, or None if no key decides it.

    A key that only device files have makes it a device file, even without ``device``.
    """
    if "master" in file_data or "takes" in file_data:
        return FileKind.MASTER
    if "overlay" in file_data or "changes" in file_data:
        return FileKind.OVERLAY
    keys_of_devices, keys_of_manufacturers = (load_schema(name)["properties"] for name in ("device", "manufacturer"))
    only_in_devices = keys_of_devices.keys() - keys_of_manufacturers.keys()
    if "device" in file_data or not only_in_devices.isdisjoint(file_data):
        return FileKind.DEVICE
    return FileKind.MANUFACTURER if "manufacturer" in file_data else None


def data_without_paths(
    document: Document,
    removed_paths: Collection[Path],
    stand_ins: Mapping[Path, Mapping[str, str]] = MappingProxyType({}),
) -> dict[str, Any]:
    """Return a copy of the data of a document without the values at ``removed_paths``.

    The document records the original indices of the elements that remain in lists. ``stand_ins`` contains values to add
    for missing keys, by the path of the map that lacks them.
    """
    document.kept_indices.clear()
    data: dict[str, Any] = _copy_without(document.data, removed_paths, (), document.kept_indices)
    for path, stand_ins_by_key in stand_ins.items():
        mapping = remaining_value_at(data, path, document.kept_indices)
        if isinstance(mapping, dict):
            mapping.update(stand_ins_by_key)
    return data


def _remove_broken_items(
    validator: Any, document: Document, removed_paths: set[Path], file_kind: FileKind
) -> SchemaResult:
    """Return the data of a document without ``removed_paths`` and without further parts that break the schema.

    The remaining data are checked again after each removal, because it can cause new errors, such as a list that is too
    short. Missing prose gets stand-ins instead. A missing key of a file or an interface only makes the result
    incomplete.
    """
    stand_ins: dict[Path, Mapping[str, str]] = {}
    while True:
        remaining_data = data_without_paths(document, removed_paths, stand_ins)
        is_complete = True
        further_broken_paths: set[Path] = set()
        stand_ins_before = len(stand_ins)
        for error in validator.iter_errors(remaining_data):
            path = _find_original_path(tuple(error.absolute_path), document.kept_indices)
            is_missing_key = error.validator == "required"
            if file_kind is FileKind.DEVICE and path and is_missing_key and _lacks_only_prose(error):
                stand_ins[path] = _stand_ins_for_missing_keys(error)
            elif is_missing_key and _can_be_incomplete(path):
                is_complete = False
            elif path:  # The file as a whole cannot be removed.
                further_broken_paths.add(path)
        needs_another_check = not further_broken_paths <= removed_paths or len(stand_ins) > stand_ins_before
        if not needs_another_check:
            return SchemaResult(
                data=remaining_data,
                file_kind=file_kind,
                is_complete=is_complete,
                removed_paths=frozenset(removed_paths),
                stand_ins=stand_ins,
            )
        removed_paths |= further_broken_paths


def _stand_ins_for_missing_keys(error: Any) -> dict[str, str]:
    """Return a stand-in for each missing key that an error reports: a valid source, or a marker for other prose."""
    missing_keys = [key for key in error.validator_value if key not in error.instance]
    stand_ins = dict.fromkeys(missing_keys, MISSING_PROSE)
    if "source" in stand_ins:
        stand_ins["source"] = SOME_SOURCE
    return stand_ins


def _is_missing_prose(finding: RuleFinding) -> bool:
    """Return True for a finding about missing keys that all contain only prose, such as ``note``."""
    return finding.is_rest_usable and finding.rule == "missing-key"


def _lacks_only_prose(error: Any) -> bool:
    """Return True if all missing keys that an error reports contain only prose, for which there are stand-ins."""
    return WORDS_ONLY.issuperset(key for key in error.validator_value if key not in error.instance)


def _can_be_incomplete(path: Path) -> bool:
    """Return True for the whole file and for an interface, where one missing key must not prevent further checks."""
    return not path or (len(path) == 2 and path[0] == "interfaces")


def path_to_remove(path: Path) -> Path:
    """Return the path of the part to remove because of an error at ``path``.

    It is the register, layout or group around an error in its fields: the error ``("registers", 2, "fields", 0,
    "bits")`` removes the register, because fields without a width would cause further errors. Otherwise it is the
    nearest element of a list. Prose, and a value outside of both, is removed by itself.
    """
    is_prose = bool(path) and path[-1] in WORDS_ONLY
    if is_prose:
        return path
    if "fields" in path[:-1]:
        return path[: path.index("fields")]
    for length in range(len(path), 0, -1):  # From the innermost place outwards.
        is_list_item = isinstance(path[length - 1], int)
        if is_list_item:
            return path[:length]
    return path


def _copy_without(
    node: Any, removed_paths: Collection[Path], path: Path, kept_indices: dict[Path, tuple[int, ...]]
) -> Any:
    """Return a copy of ``node``, the value at ``path``, without the values at ``removed_paths``.

    For each list that loses elements, the original indices of the others are added to ``kept_indices``.
    """

    def copy_child(step: str | int) -> Any:
        return _copy_without(node[step], removed_paths, (*path, step), kept_indices)

    if isinstance(node, dict):
        remaining_keys = [key for key in node if (*path, key) not in removed_paths]
        return {key: copy_child(key) for key in remaining_keys}
    if isinstance(node, list):
        remaining_indices = tuple(index for index in range(len(node)) if (*path, index) not in removed_paths)
        if len(remaining_indices) < len(node):
            kept_indices[path] = remaining_indices
        return [copy_child(index) for index in remaining_indices]
    return node


def remaining_value_at(
    remaining_data: Any, path: Path, kept_indices: Mapping[Path, Sequence[int]] = MappingProxyType({})
) -> Any:
    """Return the value at a path of the file in data from which parts were removed, or None if it was removed itself.

    ``kept_indices`` contains, by the path of each list that lost elements, the original indices of the others.
    """
    node = remaining_data
    for depth, step in enumerate(path):
        if isinstance(node, list) and isinstance(step, int):
            original_indices = kept_indices.get(path[:depth], range(len(node)))
            node = node[original_indices.index(step)] if step in original_indices else None
        elif isinstance(node, dict):
            node = node.get(step)
        else:
            return None
    return node


def _find_original_path(path: Path, kept_indices: dict[Path, tuple[int, ...]]) -> Path:
    """Return the path that a value has in the file, given its path in data from which parts were removed.

    The indices differ in lists that lost elements. ``kept_indices`` contains their original indices.
    """
    original_path: Path = ()
    for step in path:
        if isinstance(step, int) and original_path in kept_indices:
            original_path += (kept_indices[original_path][step],)
        else:
            original_path += (step,)
    return original_path


def _collect_findings(
    validator: Any, file_data: dict[str, Any], unread_paths: set[Path], file_kind: str
) -> list[RuleFinding]:
    """Return the first finding of the schema check for each place of a file.

    ``unread_paths``, which the reader of the file has already reported, and places in them are left out. At most
    ``MAX_PROBLEMS`` plus one findings are returned, so that the caller notices that there are more.
    """
    first_finding_by_place: dict[tuple[Path, bool], RuleFinding] = {}
    for error in validator.iter_errors(file_data):
        for finding in explain(error, file_kind):
            enclosing_paths = [finding.path[:length] for length in range(len(finding.path))]
            if finding.path not in unread_paths and unread_paths.isdisjoint(enclosing_paths):
                first_finding_by_place.setdefault((finding.path, finding.at_key), finding)
            if (
                len(first_finding_by_place) > MAX_PROBLEMS
            ):  # One error can have a finding for each of thousands of keys.
                return list(first_finding_by_place.values())
    return list(first_finding_by_place.values())


def _is_explained(finding: RuleFinding, all_findings: Sequence[RuleFinding], file_data: dict[str, Any]) -> bool:
    """Return True if the finding follows from another one, so that it need not be reported.

    This is the case for a value under a wrong key, and for the name of an interface whose own key is wrong.
    """
    wrong_key_paths = {key_finding.path for key_finding in all_findings if key_finding.at_key}
    if not finding.at_key and finding.path in wrong_key_paths and finding.rule != "missing-key":
        return True
    names_interface = "interface" in finding.path[-2:] or "interfaces" in finding.path[-2:]
    if finding.rule != "not-allowed" or not names_interface:
        return False
    interface = remaining_value_at(file_data, finding.path)
    return isinstance(interface, str) and ("interfaces", interface) in wrong_key_paths


@functools.cache
def _build_validator(file_kind: str) -> Any:
    """Return a validator for a kind of file, which is stricter than JSON Schema in two points.

    A pattern must match the whole text, and 1.0 is not an integer.
    """
    from jsonschema import Draft202012Validator, ValidationError, validators

    def check_pattern(_: Any, expected_pattern: str, instance: Any, __: Any) -> Iterator[ValidationError]:
        if isinstance(instance, str) and not matches(expected_pattern, instance):
            yield ValidationError("pattern")

    def is_integer(_: Any, instance: Any) -> bool:
        # In JSON Schema, 1.0 is an integer.
        return isinstance(instance, int) and not isinstance(instance, bool)

    type_checker = Draft202012Validator.TYPE_CHECKER.redefine("integer", is_integer)
    extend: Any = validators.extend  # Its stub has no types.
    return extend(Draft202012Validator, validators={"pattern": check_pattern}, type_checker=type_checker)(
        schema_without_references(file_kind)
    )


@dataclass(frozen=True, slots=True)
class Edit:
    """A key with a new name, at a line and a column that count from 1."""

    line: int
    column: int
    old: str
    new: str


def migrate(document: Document) -> tuple[Edit, ...]:
    """Rename keys of a document from earlier versions of the spec language, and return the edits for its text.

    The data and the marks of the document are changed in place.
    """
    edits = []
    for path, new_key in renamed_keys(document):
        *steps_to_parent, old_key = path
        parent_path = tuple(steps_to_parent)
        mapping = remaining_value_at(document.data, parent_path)
        line, column = document.position(path, at_key=True)
        if old_key not in mapping:
            continue  # An alias repeats a map that has been migrated.
        edits.append(Edit(line=line, column=column, old=str(old_key), new=new_key))
        _rename_key(mapping, old_key, new_key)
        _rename_key(document.mark(parent_path).children, old_key, new_key)
    return tuple(edits)


def _rename_key(mapping: dict[Any, Any], old_key: str | int, new_key: str) -> None:
    """Rename a key of a map, in place, without changing the order of its entries."""
    renamed = {new_key if key == old_key else key: value for key, value in mapping.items()}
    mapping.clear()
    mapping.update(renamed)


def edited(spec_text: str, edits: Iterable[Edit]) -> str:
    """Return the text of a spec after these edits."""
    line_starts = [0, *(line_break.end() for line_break in LINE_BREAK.finditer(spec_text))]
    # The last edit first, so that the positions of the others stay valid.
    for edit in sorted(edits, key=lambda edit: (edit.line, edit.column), reverse=True):
        position = line_starts[edit.line - 1] + edit.column - 1  # Lines and columns count from 1.
        key_start = spec_text.index(edit.old, position)  # A key may be in quotes.
        key_end = key_start + len(edit.old)
        spec_text = spec_text[:key_start] + edit.new + spec_text[key_end:]
    return spec_text
