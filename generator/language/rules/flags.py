"""Rules for flags and their effect on the position in the same frame."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import INTERFACES
from ..problems import DocumentReport, Path, quoted, suggestion
from .walk import Fields, Spec, by_name, field_lists, field_names, items, layouts, mapping

#: Words in the name of a flag that signals an error. BiSS calls it nE.
_ERROR = re.compile(r"(?<![A-Za-z])(?:nE|n?Err|(?i:errors?|faults?|failures?))(?![A-Za-z])")
#: Words before such a word that say the opposite.
_NO_ERROR = re.compile(r"(?i:\b(?:no|not|without|free)\b)")


def makes_position_missing(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a flag in a frame with a position gives the verdict on the position while it is active."""
    groups = by_name(raw, "field_groups")
    positions = {interface: position_names(spec, interface) for interface in mapping(spec, "interfaces")}
    for fields in layouts(spec):
        has_position = not positions[fields.interface].isdisjoint(field_names(fields, groups))
        if fields.owner.get("from") != "encoder" or not has_position:
            continue
        for path, field in _with_groups(fields, spec):
            if "active" in field and "makes_position" not in field and "name" in field:
                if field["name"] in INTERFACES[fields.interface].flags:
                    continue
                problem = f"{quoted(field['name'])} is in a frame that contains the position; set 'makes_position'"
                problem += " to the verdict on the position while this flag is active:"
                remedy = "not_usable, usable_with_warning or usable"
                report.add("makes-position-missing", path, f"{problem} {remedy}")


def error_usable(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an active error does not leave the position usable, unless a note explains it."""
    for fields in field_lists(spec):
        for path, field in fields:
            name = str(field.get("name", ""))
            report_usable_values(path, field, report)
            is_error = "active" in field and names_error(name, field)
            if not is_error or field.get("makes_position") != "usable" or "note" in field:
                continue
            problem = (
                f"{quoted(name)} leaves the position usable while it is active; write 'makes_position: not_usable'"
            )
            remedy = "or usable_with_warning. If the position is usable, explain it in a 'note' of the flag"
            report.add("error-usable", (*path, "makes_position"), f"{problem}, {remedy}")


def report_usable_values(path: Path, field: Spec, report: DocumentReport) -> None:
    """Report named values that are errors but leave the position usable, unless a note of the field explains it."""
    for name, value in mapping(field, "values").items():
        if names_error(name, value) and value.get("makes_position") == "usable" and "note" not in field:
            problem = f"the value {quoted(name)} leaves the position usable; write 'makes_position: not_usable'"
            remedy = "or usable_with_warning. If the position is usable, explain it in a 'note' of the field"
            report.add("error-usable", (*path, "values", name, "makes_position"), f"{problem}, {remedy}")


def names_error(name: str, flag_or_value: Spec) -> bool:
    """Return True if the name of a flag or value, or its name in the manual, says that it is an error."""
    texts = (name.replace("_", " "), str(flag_or_value.get("printed_name", "")))
    return any(_ERROR.search(text) and not _NO_ERROR.search(text) for text in texts)


def flag_sums(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the flags combined by another one exist."""
    all_fields = (field for fields in field_lists(raw) for _, field in fields)
    flags = [field["name"] for field in all_fields if "active" in field and _has_name(field)]
    for fields in field_lists(spec):
        for path, field in fields:
            other_flags = [name for name in dict.fromkeys(flags) if name != field.get("name")]
            for index, name in enumerate(field.get("sums_up", ())):
                if name not in other_flags:
                    problem = f"there is no other flag {quoted(name)}{suggestion(name, other_flags)}"
                    report.add("undefined-reference", (*path, "sums_up", index), problem)


def alarm_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an alarm with the name of a flag in its group or register is about that flag."""
    for path, alarm in items(spec, "alarms"):
        kind = "group" if "group" in alarm else "register"
        owner = by_name(spec, "field_groups" if kind == "group" else "registers").get(alarm.get(kind, ""), {})
        if alarm["name"] in by_name(owner, "fields") and alarm.get("field", alarm["name"]) != alarm["name"]:
            problem = (
                f"the alarm {quoted(alarm['name'])} has the same name as a flag of {quoted(alarm[kind])}, but describes"
                f" {quoted(alarm['field'])}; use that flag, or rename the alarm"
            )
            report.add("alarm-name", (*path, "field"), problem)


def _has_name(field: Spec) -> bool:
    return isinstance(field.get("name"), str)


def position_names(spec: Spec, interface: str) -> set[str]:
    """Return the fields and joins that form the position: the measured ones, otherwise those named ``position``."""
    measurement = mapping(spec, "interfaces", interface, "measurement") or mapping(spec, "measurement")
    measured_name = measurement.get("of", "position")
    joins = (mapping(fields.owner, "join") for fields in layouts(spec) if fields.interface == interface)
    return {measured_name}.union(*(join.get(measured_name, ()) for join in joins))


def _with_groups(fields: Fields, spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the fields, each with its own path. Fields of a group have their path inside the group."""
    groups = {group["name"]: (path, group) for path, group in items(spec, "field_groups")}
    for path, field in fields:
        if field.get("use") in groups:
            start, group = groups[field["use"]]
            yield from (((*start, *below), inner) for below, inner in items(group, "fields"))
        else:
            yield path, field
