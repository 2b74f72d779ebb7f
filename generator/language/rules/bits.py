"""Rules for single bits: flags and their effect on the position, flags described as numbers, and Gray code."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import INTERFACES
from ..problems import DocumentReport, quoted, suggest_word
from ..schema_files import is_second
from ..written_codes import WrittenCodeValue
from ..written_interfaces import WrittenSsi
from ..written_layouts import WrittenField, WrittenGray
from ..written_parts import WrittenSpec
from .parts import (
    FieldList,
    FieldOwner,
    by_name,
    field_lists,
    field_names,
    interfaces,
    layouts_of_interfaces,
    owner_of_alarm,
    position_names,
)

#: Words in the name of a flag that signals an error. BiSS calls it nE.
_ERROR_WORDS = re.compile(r"(?<![A-Za-z])(?:nE|n?Err|(?i:errors?|faults?|failures?))(?![A-Za-z])")
#: Words before such a word that say the opposite.
_NO_ERROR = re.compile(r"(?i:\b(?:no|not|without|free)\b)")


def check_missing_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag in a frame with a position gives the verdict on the position while it is active.

    The flags that an interface itself defines have a known verdict.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    positions = {interface: position_names(spec, interface) for interface, _ in interfaces(spec)}
    for frame in layouts_of_interfaces(spec):
        has_position = not positions[frame.interface].isdisjoint(field_names(frame, groups))
        if not frame.is_from_encoder or not has_position:
            continue
        flags_with_known_verdict = INTERFACES[frame.interface].flags
        for field in _with_groups(frame, spec):
            if not field.active or field.makes_position or not field.name:
                continue
            if field.name not in flags_with_known_verdict:
                problem = f"{quoted(field.name)} is in a frame that contains the position; set 'makes_position'"
                problem += " to the verdict on the position while this flag is active:"
                remedy = "not_usable, usable_with_warning or usable"
                report.add("makes-position-missing", field.path, f"{problem} {remedy}")


def check_usable_errors(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag or value called an error does not leave the position usable, unless a note explains it."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            report_usable_values(field, report)
            is_error = field.active and names_error(field.name, field.printed_name)
            if is_error and field.makes_position == "usable" and not field.note:
                problem = (
                    f"{quoted(field.name)} leaves the position usable while it is active; "
                    "write 'makes_position: not_usable'"
                )
                remedy = "or usable_with_warning. If the position is usable, explain it in a 'note' of the flag"
                report.add("error-usable", field.place_of("makes_position"), f"{problem}, {remedy}")


def report_usable_values(field: WrittenField, report: DocumentReport) -> None:
    """Report named values that are errors but leave the position usable, unless a note of the field explains it."""
    for name, value in field.values.items():
        is_usable = value.makes_position == "usable"
        if is_usable and names_error(name, value.printed_name) and not field.note:
            problem = f"the value {quoted(name)} leaves the position usable; write 'makes_position: not_usable'"
            remedy = "or usable_with_warning. If the position is usable, explain it in a 'note' of the field"
            report.add("error-usable", value.place_of("makes_position"), f"{problem}, {remedy}")


def names_error(field_name: str, printed_name: str) -> bool:
    """Return True if the name of a flag or value, or its name in the manual, says that it is an error."""
    texts = (field_name.replace("_", " "), printed_name)
    return any(_ERROR_WORDS.search(text) and not _NO_ERROR.search(text) for text in texts)


def check_flag_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the flags that another flag combines exist in some list of fields."""
    flags: list[str] = []
    for field_list in field_lists(spec.with_invalid_parts):
        flags += [field.name for field in field_list.fields if field.is_flag and field.name]
    for field_list in field_lists(spec):
        for field in field_list.fields:
            other_flags = [name for name in dict.fromkeys(flags) if name != field.name]
            for index, name in enumerate(field.sums_up):
                if name not in other_flags:
                    problem = f"there is no other flag {quoted(name)}{suggest_word(name, other_flags)}"
                    report.add("undefined-reference", (*field.place_of("sums_up"), index), problem, cause=name)


def check_alarm_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alarm with the name of a flag in its group or register is about that flag.

    ``field`` is the flag of an alarm. Without it, it is the flag of the same name.
    """
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        name = alarm.name
        flag_name = alarm.field or alarm.name
        owner = owner_of_alarm(spec, located_alarm)
        flags = by_name(owner.fields) if owner is not None else {}
        if name != flag_name and name in flags and flag_name in flags:
            owner_name = alarm.group or alarm.register
            problem = (
                f"the alarm {quoted(name)} has the same name as a flag of {quoted(owner_name)}, but describes"
                f" {quoted(flag_name)}; use that flag, or rename the alarm"
            )
            report.add("alarm-name", (*located_alarm.path, "field"), problem)


def _with_groups(fields: FieldList, spec: WrittenSpec) -> Iterator[WrittenField]:
    """Yield the fields. Fields of a group have their path inside the group."""
    groups = {group.name: group for group in spec.field_groups}
    for field in fields.fields:
        if field.use in groups:
            yield from groups[field.use].fields
        else:
            yield field


_FLAG_NAME = re.compile(r"(?:n_?)?(?:e|w|err|error|fault|failure|warn|warning|alarm)(?:_(?:bit|flag))?")
_PARITY_NAME = re.compile(r"(?:(?:even|odd)_)?(?:par|parity)(?:_bit)?")
#: The only keys of a field that is just a number. Every other key says how the bit is used.
_KEYS_OF_PLAIN_NUMBER = frozenset(("name", "printed_name", "names", "bits", "at", "meaning", "source"))


def check_plain_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a bit of an encoder's frame that is called error or parity is described as such.

    A plain number has no effect on the verdict, and no decoder checks it. A note explains a bit that is neither.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    for field_list in field_lists(spec):
        if field_list.kind is not FieldOwner.GROUP and not field_list.is_from_encoder:
            continue
        for field in field_list.fields:
            name = field.name
            is_plain_bit = _width_of_field(field) == 1 and _KEYS_OF_PLAIN_NUMBER.issuperset(field.data)
            if not is_plain_bit or _is_fixed(field_list, name):
                continue
            problem = f"{quoted(name)} is a plain number, so decoders ignore it"
            if _PARITY_NAME.fullmatch(name):
                remedy = "write 'parity_of: [FIELDS]' instead of 'bits: 1', or add a 'note' that it is not a parity bit"
                report.add("plain-bit", field.path, f"{problem}; {remedy}")
            elif _FLAG_NAME.fullmatch(name):
                remedy = (
                    "write 'active: high' or 'active: low' instead of 'bits: 1', or add a 'note' that it is not a flag"
                )
                report.add("plain-bit", field.path, f"{problem}; {remedy}")


def _is_fixed(fields: FieldList, field_name: str) -> bool:
    """Return True for a flag that the interface itself defines, such as the error bit of BiSS."""
    return fields.interface in INTERFACES and field_name in INTERFACES[fields.interface].flags


def _width_of_field(field: WrittenField) -> int | str | None:
    """Return the number of bits of a field, given by its width or as the place of one bit, or None if neither is."""
    # ``at`` is the number of one bit, or a text such as 7:6.
    is_at_one_bit = isinstance(field.at, int)
    return 1 if is_at_one_bit else field.bits


_GRAY_WORD = re.compile(r"\bGray\b", re.IGNORECASE)
#: Gray can also be a colour, except in the meaning of an interface.
_GRAY_CODE = re.compile(r"\bGray[ -]code\b", re.IGNORECASE)
_BINARY_WORD = re.compile(r"\bbinary\b", re.IGNORECASE)
#: Placeholder for the name of the position in a message.
_UNKNOWN_POSITION = "POSITION"


def check_output_code(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``output_code`` of SSI is the code in which its layouts send the position, up to the first error."""
    for kind, interface in interfaces(spec):
        if not isinstance(interface, WrittenSsi) or not interface.output_code:
            continue
        position_layouts = _with_position(spec, kind)
        has_gray = any(_gray_of(frame) is not None for frame in position_layouts)
        for frame in position_layouts:
            contradiction = _find_contradiction(interface.output_code, frame, spec, has_gray=has_gray)
            if contradiction:
                message = f"'output_code' is {interface.output_code}, but {quoted(frame.name)} {contradiction}"
                report.add("output-code", interface.place_of("output_code"), message)
                break


def _gray_of(fields: FieldList) -> WrittenGray | None:
    """Return the number of a layout that is sent in Gray code, or None."""
    return fields.layout.gray if fields.layout is not None else None


def _find_contradiction(code: str, fields: FieldList, spec: WrittenSpec, *, has_gray: bool) -> str:
    """Return how a layout contradicts ``output_code``, such as ``has no 'gray', …``, or an empty string.

    ``gray`` of a layout means that it is in Gray code, always or if the parameter in ``when`` is not 0. ``has_gray`` is
    True if any layout of the interface has it: with ``by_order_code``, another layout may then have none.
    """
    gray = _gray_of(fields)
    if gray is None:
        if code == "gray":
            example = f"'gray: {{of: {_find_position(fields, spec)}}}'"
            return f"has no 'gray', so decoders read the position as binary; add {example} to it"
        if code == "by_order_code" and not has_gray:
            example = f"'gray: {{of: {_find_position(fields, spec)}, when: PARAMETER}}'"
            return f"has no 'gray', so decoders read the position as binary; add {example} to it"
        return ""
    if code == "binary":
        correct_code = "by_order_code" if gray.when else "gray"
        return f"has 'gray'; write 'output_code: {correct_code}', or remove 'gray'"
    if code == "by_order_code" and not gray.when:
        return "is always in Gray code; write 'output_code: gray', or add 'when' to 'gray'"
    if code == "gray" and 0 in _numbers_set(spec, fields.interface, gray.when):
        return f"is binary where {quoted(gray.when)} is 0; write 'output_code: by_order_code'"
    return ""


def check_named_gray_code(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an interface whose order codes name Gray code has a layout in Gray code.

    A value of an order code belongs to the interface that it selects, or to the only interface. If it selects none of
    several interfaces, it is not checked.
    """
    interface_names = [interface_name for interface_name, _ in interfaces(spec)]
    only_interface = interface_names[0] if len(interface_names) == 1 else ""
    for part in spec.order_code.parts:
        for label, value in part.values.items():
            if not _names_gray(value):
                continue
            # No layout has an empty interface name, so the result then contains no layouts.
            interface_name = value.interface or only_interface
            position_layouts = _with_position(spec, interface_name)
            if position_layouts and all(_gray_of(frame) is None for frame in position_layouts):
                message = (
                    f"the meaning of {quoted(label)} says Gray, but no layout of {interface_name} has 'gray', "
                    "so decoders read it as binary"
                )
                report.add("output-code", value.place_of("meaning"), message)


def _names_gray(code_value: WrittenCodeValue) -> bool:
    """Return True if the meaning of an order code value names Gray code, and not binary code too.

    If the value selects no interface, "Gray" alone may be a colour.
    """
    gray_pattern = _GRAY_WORD if code_value.interface else _GRAY_CODE
    says_gray = gray_pattern.search(code_value.meaning) is not None
    says_binary = _BINARY_WORD.search(code_value.meaning) is not None
    return says_gray and not says_binary


def _with_position(spec: WrittenSpec, interface_name: str) -> list[FieldList]:
    """Return the layouts of the encoder that contain the position, or all of its layouts if none is known to do so."""
    sent_layouts = [
        frame for frame in layouts_of_interfaces(spec) if frame.interface == interface_name and frame.is_from_encoder
    ]
    with_position = [frame for frame in sent_layouts if _find_position(frame, spec) != _UNKNOWN_POSITION]
    return with_position or sent_layouts


def _find_position(fields: FieldList, spec: WrittenSpec) -> str:
    """Return the name of the joined number or field for the position in a layout, or ``POSITION`` if there is none."""
    known_names = position_names(spec, fields.interface)
    for name in (*fields.joins, *field_names(fields, by_name(spec.with_invalid_parts.field_groups))):
        if name in known_names:
            return name
    return _UNKNOWN_POSITION


def _numbers_set(spec: WrittenSpec, interface_name: str, parameter: str) -> set[int]:
    """Return the numbers to which the order codes of an interface set a parameter.

    A value that selects no interface applies to all of them.
    """
    set_numbers: set[int] = set()
    for part in spec.order_code.parts:
        for value in part.values.values():
            applies = not value.interface or value.interface == interface_name
            if applies and parameter in value.sets:
                set_numbers.add(value.sets[parameter])
    return set_numbers
