"""Rules for single bits: flags and their effect on the position, flags described as numbers, and Gray code."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import INTERFACES
from ..problems import DocumentReport, quoted, suggest_word
from ..written_codes import WrittenCodeValue
from ..written_interfaces import WrittenSsi
from ..written_layouts import WrittenField, WrittenGray
from ..written_parts import WrittenSpec
from .parts import (
    FieldList,
    FieldOwner,
    by_name,
    field_lists,
    fields_by_name,
    interfaces,
    is_second_reading,
    layouts_of_interfaces,
    owner_of_alarm,
    position_names,
)

#: Words in the name of a flag that signals an error. BiSS calls it nE.
_ERROR_WORDS = re.compile(r"(?<![A-Za-z])(?:nE|n?Err|(?i:errors?|faults?|failures?))(?![A-Za-z])")
#: Words before such a word that say the opposite.
_NO_ERROR = re.compile(r"(?i:\b(?:no|not|without|free)\b)")


def check_missing_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each flag in a frame with a position has ``makes_position``: the verdict on it while active.

    That is, whether the position is usable. The verdicts of flags that the interface itself defines are known.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        names_of_position = position_names(spec, frame.interface)
        has_position = not names_of_position.isdisjoint(fields_by_name(frame, groups))
        if not frame.is_from_encoder or not has_position:
            continue
        flags_with_known_verdict = INTERFACES[frame.interface].flags
        for field in _yield_fields(frame, spec):
            is_flag = bool(field.active)
            has_verdict = bool(field.makes_position) or field.name in flags_with_known_verdict
            if is_flag and field.name and not has_verdict:
                message = (
                    f"{quoted(field.name)} is in a frame that contains the position; set 'makes_position'"
                    " to the verdict on the position while this flag is active:"
                    " not_usable, usable_with_warning or usable"
                )
                report.add("makes-position-missing", field.path, message)


def check_usable_errors(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a flag or value called an error does not leave the position usable, unless a note explains it."""
    for field_list in field_lists(spec):
        for field in field_list.fields:
            _report_usable_values(field, report)
            is_flag = bool(field.active)
            is_error = is_flag and names_error(field.name, field.printed_name)
            if is_error and field.makes_position == "usable" and not field.note:
                message = (
                    f"{quoted(field.name)} leaves the position usable while it is active; "
                    "write 'makes_position: not_usable', or usable_with_warning. "
                    "If the position is usable, explain it in a 'note' of the flag"
                )
                report.add("error-usable", field.place_of("makes_position"), message)


def _report_usable_values(field: WrittenField, report: DocumentReport) -> None:
    """Report named values that are errors but leave the position usable, unless a note of the field explains it."""
    for name, value in field.values.items():
        is_usable = value.makes_position == "usable"
        if is_usable and names_error(name, value.printed_name) and not field.note:
            message = (
                f"the value {quoted(name)} leaves the position usable; write 'makes_position: not_usable', "
                "or usable_with_warning. If the position is usable, explain it in a 'note' of the field"
            )
            report.add("error-usable", value.place_of("makes_position"), message)


def names_error(name: str, printed_name: str) -> bool:
    """Return True if the name of a flag or value, or its name in the manual, has a word such as "error" or "fault".

    The result is False for a name that denies the error, such as "No error".
    """
    texts = (name.replace("_", " "), printed_name)
    return any(_ERROR_WORDS.search(text) and not _NO_ERROR.search(text) for text in texts)


def check_flag_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the flags listed in ``sums_up``, which another flag combines, exist in some layout, register or group.

    The combining flag is active while one of them is.
    """
    flag_names: list[str] = []
    for field_list in field_lists(spec.with_invalid_parts):
        flag_names += [field.name for field in field_list.fields if field.is_flag and field.name]
    for field_list in field_lists(spec):
        for field in field_list.fields:
            other_flags = [name for name in dict.fromkeys(flag_names) if name != field.name]
            for index, name in enumerate(field.sums_up):
                if name not in other_flags:
                    problem = f"there is no other flag {quoted(name)}{suggest_word(name, other_flags)}"
                    report.add("undefined-reference", (*field.place_of("sums_up"), index), problem, cause=name)


def check_alarm_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alarm with the name of a flag in its group or register describes that flag, and not another one.

    The key ``field`` of an alarm names its flag. Without this key, the flag has the same name as the alarm.
    """
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        name = alarm.name
        flag_name = alarm.field or alarm.name
        group_or_register = owner_of_alarm(spec, located_alarm)
        if group_or_register is None or flag_name == name:
            continue
        flags = by_name(group_or_register.fields)
        if name in flags and flag_name in flags:
            owner_name = alarm.group or alarm.register
            problem = (
                f"the alarm {quoted(name)} has the same name as a flag of {quoted(owner_name)}, but describes"
                f" {quoted(flag_name)}; use that flag, or rename the alarm"
            )
            report.add("alarm-name", (*located_alarm.path, "field"), problem)


def _yield_fields(field_list: FieldList, spec: WrittenSpec) -> Iterator[WrittenField]:
    """Yield the fields of a layout, with the fields of a group instead of the field that includes the group.

    The path of each field from a group is the path inside the group.
    """
    groups = {group.name: group for group in spec.field_groups}
    for field in field_list.fields:
        if field.use in groups:
            yield from groups[field.use].fields
        else:
            yield field


_FLAG_NAME = re.compile(r"(?:n_?)?(?:e|w|err|error|fault|failure|warn|warning|alarm)(?:_(?:bit|flag))?")
_PARITY_NAME = re.compile(r"(?:(?:even|odd)_)?(?:par|parity)(?:_bit)?")
#: The only keys of a field that is just a number. Every other key says how the bit is used.
_KEYS_OF_PLAIN_NUMBER = frozenset(("name", "printed_name", "names", "bits", "at", "meaning", "source"))


def check_plain_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a bit of an encoder's frame called error or parity is described as a flag or as a parity bit.

    Without that, it would be a plain number, which decoders do not check. A note can explain a bit that is neither.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for field_list in field_lists(spec):
        if field_list.owner_kind is not FieldOwner.GROUP and not field_list.is_from_encoder:
            continue
        for field in field_list.fields:
            name = field.name
            is_plain_number = _KEYS_OF_PLAIN_NUMBER.issuperset(field.data)
            is_plain_bit = is_plain_number and _width_of_field(field) == 1
            if not is_plain_bit or _is_defined_by_interface(field_list, name):
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


def _is_defined_by_interface(field_list: FieldList, field_name: str) -> bool:
    """Return True for a flag that the interface itself defines, such as the error bit of BiSS."""
    return field_list.interface in INTERFACES and field_name in INTERFACES[field_list.interface].flags


def _width_of_field(field: WrittenField) -> int | str | None:
    """Return the number of bits of a field: its width, or 1 if it is placed at a single bit.

    The width is text if it depends on the order code. The result is None if the field has no width, or a range of bits.
    """
    # ``at`` is the number of a bit, or text such as 7:6.
    is_at_one_bit = isinstance(field.at, int)
    return 1 if is_at_one_bit else field.bits


_GRAY_WORD = re.compile(r"\bGray\b", re.IGNORECASE)
#: Gray can also be a color, except in the meaning of an interface.
_GRAY_CODE = re.compile(r"\bGray[ -]code\b", re.IGNORECASE)
_BINARY_WORD = re.compile(r"\bbinary\b", re.IGNORECASE)
#: Placeholder for the name of the position in a message.
_UNKNOWN_POSITION = "POSITION"


def check_output_code(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``output_code`` of SSI, Gray or binary, is the code in which its layouts send the position.

    Only the first layout with another code is reported.
    """
    for interface_name, interface in interfaces(spec):
        if not isinstance(interface, WrittenSsi) or not interface.output_code:
            continue
        position_layouts = _layouts_with_position(spec, interface_name)
        has_gray = any(_gray_of(frame) is not None for frame in position_layouts)
        for frame in position_layouts:
            contradiction = _explain_contradiction(interface.output_code, frame, spec, has_gray=has_gray)
            if contradiction:
                message = f"'output_code' is {interface.output_code}, but {quoted(frame.name)} {contradiction}"
                report.add("output-code", interface.place_of("output_code"), message)
                break


def _gray_of(field_list: FieldList) -> WrittenGray | None:
    """Return the key ``gray`` of a layout, which names the number that is sent in Gray code, or None without it."""
    return field_list.layout.gray if field_list.layout is not None else None


def _explain_contradiction(output_code: str, layout: FieldList, spec: WrittenSpec, *, has_gray: bool) -> str:
    """Return how a layout contradicts ``output_code`` of its interface, with the fix. Empty if it does not.

    The key ``gray`` of a layout means that the position is in Gray code, either always or, with ``when``, if that
    parameter of the order code is not 0. ``has_gray`` is True if any layout of the interface has this key.
    """
    gray = _gray_of(layout)
    if gray is None:
        # With ``by_order_code``, it is enough if another layout has the key.
        is_by_order_code = output_code == "by_order_code"
        if output_code == "binary" or (is_by_order_code and has_gray):
            return ""
        position_name = _find_position(layout, spec)
        condition = ", when: PARAMETER" if is_by_order_code else ""
        example = f"'gray: {{of: {position_name}{condition}}}'"
        return f"has no 'gray', so decoders read the position as binary; add {example} to it"
    match output_code:
        case "binary":
            correct_code = "by_order_code" if gray.when else "gray"
            return f"has 'gray'; write 'output_code: {correct_code}', or remove 'gray'"
        case "by_order_code" if not gray.when:
            return "is always in Gray code; write 'output_code: gray', or add 'when' to 'gray'"
        case "gray" if 0 in _numbers_set_by_codes(spec, layout.interface, gray.when):
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
            position_layouts = _layouts_with_position(spec, interface_name)
            has_gray = any(_gray_of(frame) is not None for frame in position_layouts)
            if position_layouts and not has_gray:
                message = (
                    f"the meaning of {quoted(label)} says Gray, but no layout of {interface_name} has 'gray', "
                    "so decoders read it as binary"
                )
                report.add("output-code", value.place_of("meaning"), message)


def _names_gray(code_value: WrittenCodeValue) -> bool:
    """Return True if the meaning of an order code value names Gray code, and not binary code too.

    If the value selects no interface, "Gray" alone may be a color.
    """
    gray_pattern = _GRAY_WORD if code_value.interface else _GRAY_CODE
    says_gray = gray_pattern.search(code_value.meaning) is not None
    says_binary = _BINARY_WORD.search(code_value.meaning) is not None
    return says_gray and not says_binary


def _layouts_with_position(spec: WrittenSpec, interface_name: str) -> list[FieldList]:
    """Return the layouts that the encoder sends over an interface and that contain the position.

    If no layout has a field with the name of the position, all layouts that the encoder sends are returned.
    """
    layouts = [frame for frame in layouts_of_interfaces(spec) if frame.interface == interface_name]
    sent_layouts = [frame for frame in layouts if frame.is_from_encoder]
    with_position = [frame for frame in sent_layouts if _find_position(frame, spec) != _UNKNOWN_POSITION]
    return with_position or sent_layouts


def _find_position(field_list: FieldList, spec: WrittenSpec) -> str:
    """Return the name of the joined number or field for the position in a layout, or ``POSITION`` if there is none."""
    names_of_position = position_names(spec, field_list.interface)
    groups = by_name(spec.with_invalid_parts.field_groups)
    for name in (*field_list.joins, *fields_by_name(field_list, groups)):
        if name in names_of_position:
            return name
    return _UNKNOWN_POSITION


def _numbers_set_by_codes(spec: WrittenSpec, interface_name: str, parameter: str) -> set[int]:
    """Return the numbers to which the order codes for an interface set a parameter.

    A value of an order code that selects no interface applies to every interface.
    """
    numbers: set[int] = set()
    for part in spec.order_code.parts:
        for value in part.values.values():
            applies = not value.interface or value.interface == interface_name
            if applies and parameter in value.sets:
                numbers.add(value.sets[parameter])
    return numbers
