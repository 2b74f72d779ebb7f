"""Rules for single bits: flags and their effect on the position, flags described as numbers, and Gray code."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import INTERFACES
from ..document import Path
from ..problems import DocumentReport, quoted, suggestion
from ..schema_files import is_second
from .walk import Fields, Has, Spec, by_name, field_lists, field_names, items, layouts, mapping, owner_of_alarm

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
        flags_with_known_verdict = INTERFACES[fields.interface].flags
        for path, field in _with_groups(fields, spec):
            if "active" not in field or "makes_position" in field or "name" not in field:
                continue
            if field["name"] not in flags_with_known_verdict:
                problem = f"{quoted(field['name'])} is in a frame that contains the position; set 'makes_position'"
                problem += " to the verdict on the position while this flag is active:"
                remedy = "not_usable, usable_with_warning or usable"
                report.add("makes-position-missing", path, f"{problem} {remedy}")


def error_usable(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an active error does not leave the position usable, unless a note explains it."""
    for fields in field_lists(spec):
        for path, field in fields:
            report_usable_values(path, field, report)
            name = str(field.get("name", ""))
            is_error = "active" in field and names_error(name, field)
            if is_error and field.get("makes_position") == "usable" and "note" not in field:
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
    flags: list[str] = []
    for fields in field_lists(raw):
        flags += [field["name"] for _, field in fields if "active" in field and _has_name(field)]
    for fields in field_lists(spec):
        for path, field in fields:
            other_flags = [name for name in dict.fromkeys(flags) if name != field.get("name")]
            for index, name in enumerate(field.get("sums_up", ())):
                if name not in other_flags:
                    problem = f"there is no other flag {quoted(name)}{suggestion(name, other_flags)}"
                    report.add("undefined-reference", (*path, "sums_up", index), problem, cause=name)


def alarm_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an alarm with the name of a flag in its group or register is about that flag."""
    for path, alarm in items(spec, "alarms"):
        name, flag = alarm["name"], alarm.get("field", alarm["name"])
        flags = by_name(owner_of_alarm(spec, alarm), "fields")
        if name != flag and name in flags and flag in flags:
            owner_name = alarm["group"] if "group" in alarm else alarm["register"]
            problem = (
                f"the alarm {quoted(name)} has the same name as a flag of {quoted(owner_name)}, but describes"
                f" {quoted(flag)}; use that flag, or rename the alarm"
            )
            report.add("alarm-name", (*path, "field"), problem)


def _has_name(field: Spec) -> bool:
    return isinstance(field.get("name"), str)


def position_names(spec: Spec, interface: str) -> set[str]:
    """Return the fields and joins that form the position: the measured ones, otherwise those named ``position``."""
    measurement = mapping(spec, "interfaces", interface, "measurement") or mapping(spec, "measurement")
    measured_name = measurement.get("of", "position")
    names = {measured_name}
    for fields in layouts(spec):
        if fields.interface == interface:
            joined_names = mapping(fields.owner, "join").get(measured_name, ())
            names.update(joined_names)
    return names


def _with_groups(fields: Fields, spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """Yield the fields, each with its own path. Fields of a group have their path inside the group."""
    groups = {group["name"]: (path, group) for path, group in items(spec, "field_groups")}
    for path, field in fields:
        if field.get("use") not in groups:
            yield path, field
            continue
        group_path, group = groups[field["use"]]
        for path_in_group, group_field in items(group, "fields"):
            yield (*group_path, *path_in_group), group_field


_FLAG = re.compile(r"(?:n_?)?(?:e|w|err|error|fault|failure|warn|warning|alarm)(?:_(?:bit|flag))?")
_PARITY = re.compile(r"(?:(?:even|odd)_)?(?:par|parity)(?:_bit)?")
#: The only keys of a field that is just a number. Every other key says how the bit is used.
_PLAIN = frozenset(("name", "printed_name", "names", "bits", "at", "meaning", "source"))


def plain_bits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a bit of an encoder's frame that is called error or parity is described as one.

    A plain number has no effect on the verdict, and no decoder checks it. A note explains a bit that is neither.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    for fields in field_lists(spec):
        if not _is_received(fields):
            continue
        for path, field in fields:
            name = str(field.get("name", ""))
            is_plain_bit = _bits(field) == 1 and _PLAIN.issuperset(field)
            if not is_plain_bit or _is_fixed(fields, name):
                continue
            problem = f"{quoted(name)} is a plain number, so decoders ignore it"
            if _PARITY.fullmatch(name):
                remedy = "write 'parity_of: [FIELDS]' instead of 'bits: 1', or add a 'note' that it is not a parity bit"
                report.add("plain-bit", path, f"{problem}; {remedy}")
            elif _FLAG.fullmatch(name):
                remedy = (
                    "write 'active: high' or 'active: low' instead of 'bits: 1', or add a 'note' that it is not a flag"
                )
                report.add("plain-bit", path, f"{problem}; {remedy}")


def _is_received(fields: Fields) -> bool:
    """Return True for the fields of a frame from an encoder, and of a group, which may be part of one."""
    return fields.kind is Has.GROUP or (fields.kind is Has.LAYOUT and fields.owner.get("from") == "encoder")


def _is_fixed(fields: Fields, name: str) -> bool:
    """Return True for a field with a fixed meaning in the frames of its interface."""
    return fields.interface in INTERFACES and name in INTERFACES[fields.interface].flags


def _bits(field: Spec) -> object:
    """Return the number of bits of a field, given by its width or as the place of one bit."""
    return 1 if isinstance(field.get("at"), int) else field.get("bits")


_GRAY = re.compile(r"\bGray\b", re.IGNORECASE)
#: Gray can also be a colour, except in the meaning of an interface.
_GRAY_CODE = re.compile(r"\bGray[ -]code\b", re.IGNORECASE)
_BINARY = re.compile(r"\bbinary\b", re.IGNORECASE)
#: Placeholder for the name of the position in a message.
_UNKNOWN_POSITION = "POSITION"


def output_code(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that ``output_code`` of an interface is the code in which its layouts send the position."""
    for kind, interface in mapping(spec, "interfaces").items():
        code = interface.get("output_code")
        position_layouts = _with_position(spec, raw, kind)
        has_gray = any("gray" in layout.owner for layout in position_layouts)
        for layout in position_layouts:
            contradiction = _contradiction(code, layout, spec, raw, has_gray=has_gray)
            if contradiction:
                message = f"'output_code' is {code}, but {quoted(layout.owner['name'])} {contradiction}"
                report.add("output-code", ("interfaces", kind, "output_code"), message)
                break


def _contradiction(code: object, layout: Fields, spec: Spec, raw: Spec, *, has_gray: bool) -> str:
    """Return how a layout contradicts ``output_code``, or an empty string.

    ``has_gray`` is set if any layout of the interface is in Gray code.
    """
    gray = mapping(layout.owner, "gray")
    condition = gray.get("when")
    if not gray:
        if code == "gray":
            example = f"'gray: {{of: {_position(layout, spec, raw)}}}'"
            return f"has no 'gray', so decoders take the position as binary; add {example} to it"
        if code == "by_order_code" and not has_gray:
            example = f"'gray: {{of: {_position(layout, spec, raw)}, when: PARAMETER}}'"
            return f"has no 'gray', so decoders take the position as binary; add {example} to it"
        return ""
    if code == "binary":
        correct_code = "by_order_code" if condition else "gray"
        return f"has 'gray'; write 'output_code: {correct_code}', or leave 'gray' out"
    if code == "by_order_code" and not condition:
        return "is always in Gray code; write 'output_code: gray', or add 'when' to 'gray'"
    if code == "gray" and 0 in _numbers_set(spec, layout.interface, str(condition)):
        return f"is binary where {quoted(str(condition))} is 0; write 'output_code: by_order_code'"
    return ""


def gray_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an interface whose order codes name Gray code has a layout in Gray code."""
    kinds = [*mapping(spec, "interfaces")]
    default_kind = kinds[0] if len(kinds) == 1 else ""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            if not _names_gray(value):
                continue
            kind = value.get("interface", default_kind)
            position_layouts = _with_position(spec, raw, kind)
            if position_layouts and not any("gray" in fields.owner for fields in position_layouts):
                message = (
                    f"the meaning of {quoted(text)} says Gray, but no layout of {kind} has 'gray', "
                    "so decoders take it as binary"
                )
                report.add("output-code", (*path, "values", text, "meaning"), message)


def _names_gray(value: Spec) -> bool:
    """Return True if the meaning of an order code value names Gray code, and not binary code too."""
    meaning = value.get("meaning", "")
    gray = _GRAY if "interface" in value else _GRAY_CODE
    return gray.search(meaning) is not None and _BINARY.search(meaning) is None


def _with_position(spec: Spec, raw: Spec, kind: str) -> list[Fields]:
    """Return the layouts of the encoder that contain the position, or all of them if none is known to do so."""
    interface_layouts = [layout for layout in layouts(spec) if layout.interface == kind]
    sent_layouts = [layout for layout in interface_layouts if layout.owner.get("from") == "encoder"]
    with_position = [layout for layout in sent_layouts if _position(layout, spec, raw) != _UNKNOWN_POSITION]
    return with_position or sent_layouts


def _position(fields: Fields, spec: Spec, raw: Spec) -> str:
    """Return the name of the position in a layout, or a placeholder."""
    known_names = position_names(spec, fields.interface)
    joins = mapping(fields.owner, "join")
    names = field_names(fields, by_name(raw, "field_groups"))
    for name in (*joins, *names):
        if name in known_names:
            return name
    return _UNKNOWN_POSITION


def _numbers_set(spec: Spec, kind: str, parameter: str) -> set[int]:
    """Return the numbers to which the order codes of an interface set a parameter."""
    numbers: set[int] = set()
    for _, part in items(spec, "order_code", "parts"):
        for value in part["values"].values():
            parameters = mapping(value, "sets")
            if value.get("interface", kind) == kind and parameter in parameters:
                numbers.add(parameters[parameter])
    return numbers
